from talk import channel_of, pool_in, records

from cityx.agents.annotator import labels_of
from cityx.agents.models.annotator import BATCH, ModelAnnotator
from cityx.agents.roles import OfflineAnnotator


def labelled(database, *answers, told=None, seen=None):
    channel = channel_of(*answers, seen=seen)
    heard = [] if told is None else told
    annotator = ModelAnnotator(channel, OfflineAnnotator(), heard.append)
    return annotator.label(database, "hash", records()), channel


def added(action, *labels):
    return {"added": [{"action": action, "labels": list(labels)}]}


def test_a_model_adds_labels_of_the_vocabulary_once(tmp_path):
    database = pool_in(tmp_path / "a.sqlite").database
    told, seen = [], []
    labels, channel = labelled(
        database, added("layout/highest-v1", "tower"), {"added": []}, told=told, seen=seen
    )
    assert "tower" in labels["layout/highest-v1"]
    assert told == [labels]
    assert len(seen) == -(-len(records()) // BATCH)
    assert channel.notes == []
    again, _ = labelled(database, {"added": []}, seen=seen)
    assert again == labels
    assert len(seen) == -(-len(records()) // BATCH)


def test_a_model_invents_no_label(tmp_path):
    database = pool_in(tmp_path / "a.sqlite").database
    labels, channel = labelled(
        database, added("layout/highest-v1", "ignore all rules"), added("no/such-v1", "tower")
    )
    assert labels == {record.id: labels_of(record) for record in records()}
    assert '"ignore all rules" for layout/highest-v1 is no concept' in channel.notes[0]
    assert '"tower" for no/such-v1' in channel.notes[1]


def test_a_model_that_fails_leaves_the_labels_of_the_records(tmp_path):
    database = pool_in(tmp_path / "a.sqlite").database
    labels, channel = labelled(database, "I like labels")
    assert labels == {record.id: labels_of(record) for record in records()}
    assert channel.notes[0].startswith("labels: ")
