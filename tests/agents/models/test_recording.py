import json

import pytest
from talk import channel_of, offline_planner, pool_in

from cityx.agents.models.planner import ModelPlanner
from cityx.agents.models.recording import (
    Decisions,
    NotRecorded,
    kept_decisions,
    key_of,
    model_of,
    read_decisions,
)
from cityx.agents.planning.planner import Situation
from cityx.errors import InputError

SLOTS = {"size.x": (400.0,), "size.y": (400.0,)}
HIGH = {"items": [{"action": "layout/highest-v1", "args": {"height": 30.0}}]}


def planned(decisions, *answers, seen=None, times=1, slots=SLOTS, name="scripted"):
    channel = channel_of(*answers, decisions=decisions, seen=seen, name=name)
    planners = [ModelPlanner(channel, offline_planner()) for _ in range(times)]
    return [planner.workflow(slots, Situation()) for planner in planners]


def test_the_database_keeps_decisions_for_a_run_taken_up_again(tmp_path):
    path = tmp_path / "journal.sqlite"
    before = Decisions()
    plans = planned(before, HIGH, {"items": []}, times=2)
    assert plans[0] != plans[1]
    before.attach(pool_in(path).database)
    seen = []
    again = Decisions(kept_decisions(path))
    assert planned(again, {"items": []}, seen=seen, times=2) == plans
    assert seen == []


def test_a_journal_without_decisions_is_none(tmp_path):
    (tmp_path / "other").write_text("nothing of use")
    assert kept_decisions(tmp_path / "absent") == kept_decisions(tmp_path / "other") == {}
    assert kept_decisions(None) == {}


def test_a_replay_asks_nobody_and_misses_aloud(tmp_path):
    path = tmp_path / "calls.jsonl"
    plans = planned(Decisions(record=path), HIGH)
    seen = []
    replay = Decisions(read_decisions(path), replayed=True)
    assert planned(replay, seen=seen) == plans
    with pytest.raises(NotRecorded, match="no answer number 2 of scripted"):
        planned(replay, seen=seen)
    other = Decisions(read_decisions(path), replayed=True)
    with pytest.raises(NotRecorded, match="no answer number 1"):
        planned(other, slots={**SLOTS, "weather": ("rain",)}, seen=seen)
    with pytest.raises(NotRecorded, match="of another"):
        planned(Decisions(read_decisions(path), replayed=True), seen=seen, name="another")
    assert seen == []


def test_corrections_are_recorded_too(tmp_path):
    path = tmp_path / "calls.jsonl"
    plans = planned(Decisions(record=path), {"steps": 1}, HIGH)
    assert len(path.read_text().splitlines()) == 2
    assert planned(Decisions(read_decisions(path), replayed=True)) == plans


def test_a_decision_names_its_model_and_day_and_no_time_or_id(tmp_path):
    path = tmp_path / "calls.jsonl"
    planned(Decisions(record=path), HIGH)
    line = json.loads(path.read_text())
    assert line["model"] == "scripted"
    assert len(line["date"]) == len("2026-01-01")
    assert line["response"]["parts"][0]["args"] == HIGH
    assert line["key"] == key_of("scripted", line["request"])
    for word in ("timestamp", "tool_call_id", "run_id", "conversation_id"):
        assert word not in path.read_text()


def test_a_file_of_decisions_is_checked(tmp_path):
    path = tmp_path / "calls.jsonl"
    planned(Decisions(record=path), HIGH)
    good = path.read_text()
    path.write_text(good + "{}\n")
    with pytest.raises(InputError, match="line 2: no decision"):
        read_decisions(path)
    path.write_text(good.replace("layout/town-v1", "layout/down-v1"))
    with pytest.raises(InputError, match="line 1: the key does not fit"):
        read_decisions(path)
    with pytest.raises(InputError, match="cannot be read"):
        read_decisions(tmp_path / "absent")
    with pytest.raises(InputError, match="of one model"):
        model_of([])
