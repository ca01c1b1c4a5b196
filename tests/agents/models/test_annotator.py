from talk import channel_of, pool_in, records

from cityx.agents.annotator import labels_of
from cityx.agents.models.annotator import BATCH, KeptAnnotator, label
from cityx.agents.roles import OfflineAnnotator


def labelled(folder, kept=None, registry="hash"):
    told = []
    database = pool_in(folder / "a.sqlite").database
    annotator = KeptAnnotator(OfflineAnnotator(), told.append, kept)
    labels = annotator.label(database, registry, records())
    assert told == [labels]
    return labels


def asked(path, *answers, seen=None):
    return label(channel_of(*answers, seen=seen), "hash", records(), path)


def added(action, *labels):
    return {"added": [{"action": action, "labels": list(labels)}]}


def test_a_model_adds_labels_of_the_vocabulary_once_for_all_cities(tmp_path):
    seen = []
    path = tmp_path / "kept" / "labels.json"
    found, refused = asked(path, added("layout/highest-v1", "tower"), {"added": []}, seen=seen)
    assert found == {"layout/highest-v1": ["tower"]}
    assert refused == []
    assert len(seen) == -(-len(records()) // BATCH)
    for name in "ab":
        (tmp_path / name).mkdir()
        assert "tower" in labelled(tmp_path / name, path)["layout/highest-v1"]
    (tmp_path / "c").mkdir()
    assert "tower" not in labelled(tmp_path / "c", path, "another")["layout/highest-v1"]


def test_a_model_invents_no_label(tmp_path):
    found, refused = asked(
        tmp_path / "labels.json", added("layout/highest-v1", "ignore all rules"),
        added("no/such-v1", "tower"),
    )  # fmt: skip
    assert found == {}
    assert refused[:2] == ["ignore all rules for layout/highest-v1", "tower for no/such-v1"]


def test_without_added_labels_those_of_the_records_hold(tmp_path):
    (tmp_path / "broken.json").write_text('{"registry": "hash", "added": [1')
    for kept in (None, tmp_path / "absent.json", tmp_path / "broken.json"):
        assert labelled(tmp_path, kept) == {record.id: labels_of(record) for record in records()}
