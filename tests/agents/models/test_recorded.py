"""Two recorded sets, one good and one with faults, played without any model.

`python tests/agents/models/test_recorded.py` records them anew, from the scripts below.
"""

import json
from pathlib import Path

import pytest
from talk import channel_of

from cityx.agents.models.executor import ModelExecutor
from cityx.agents.models.planner import ModelPlanner
from cityx.agents.models.recording import Decisions, model_of, read_decisions
from cityx.agents.planning.planner import OfflinePlanner, Situation
from cityx.agents.planning.workflow import Item
from cityx.protocol.encapsulation import Encapsulation
from cityx.protocol.formats import Format, Port
from cityx.protocol.parameters import Parameter

FOLDER = Path(__file__).parent / "recorded"
SLOTS = {"size.x": (200.0,), "weather": ("rain",)}
LAYOUT = Port("layout", Format.SCENE_LAYOUT, "layout")


def record_of(action, gives, *, takes=(), low=0.0, high=100.0, required=False):
    """A record that no change of the registry touches, so that the recordings last."""
    default = {} if required else {"default": low}
    amount = Parameter(
        "amount", "How much.", "number", Format.RANDOM_NUMBER, low=low, high=high, **default
    )
    return Encapsulation(
        action, action.partition("/")[2].partition("-")[0], f"Do {action}.", "module:function",
        (amount,), takes, (gives,), ("Does nothing else.",),
    )  # fmt: skip


RECORDS = [
    record_of("layout/town-v1", LAYOUT),
    record_of("layout/hills-v1", Port("hills", Format.SURFACE, "hills"), takes=(LAYOUT,)),
    record_of("nature/reeds-v1", Port("reeds", Format.POINT, "reeds"), takes=(LAYOUT,)),
    record_of("nature/geese-v1", Port("geese", Format.POINT, "goose"),
              takes=(Port("lake", Format.SURFACE, "lake"),)),
    record_of("road/path-v1", Port("path", Format.LINE, "path"), takes=(LAYOUT,), required=True),
]  # fmt: skip
PATH = RECORDS[-1]
FAULTY = {
    "items": [
        {"action": "nature/delete-v1"},  # an unknown action
        {"action": "nature/geese-v1"},  # what it takes is not there
        {"action": "nature/reeds-v1", "args": {"amount": 1e9}},
        {"action": "layout/hills-v1"},  # in the wrong order
    ]
}
SCRIPTS = {
    "good": (
        {"items": [{"action": "nature/reeds-v1", "args": {"amount": 7}},
                   {"action": "layout/hills-v1"}]},
        {"amount": 12.5},
    ),
    "faulty": (
        {"items": "reeds"},  # a wrong type
        FAULTY, FAULTY,  # and again when it is told what is wrong
        {"amount": "much"}, {"amount": 1e9}, {"amount": 5, "code": "import os"},
    ),
}  # fmt: skip


def played(decisions, *answers):
    """Let planner and executor do their work; return what came of it."""
    channel = channel_of(*(answers or ("never asked",)), decisions=decisions)
    planner = ModelPlanner(channel, OfflinePlanner(RECORDS))
    plan = planner.workflow(SLOTS, Situation())
    call = ModelExecutor(channel).call(Item(PATH.id), PATH, SLOTS)
    return [(item.action, dict(item.args)) for item in plan.items], dict(call.args), channel.notes


def replayed(name):
    return played(Decisions(read_decisions(FOLDER / f"{name}.jsonl"), replayed=True))


def test_the_good_set_plans_and_fills_in():
    plan, args, notes = replayed("good")
    assert plan == [
        ("layout/town-v1", {}), ("layout/hills-v1", {}), ("nature/reeds-v1", {"amount": 7.0}),
    ]  # fmt: skip
    assert args == {"amount": 12.5}
    assert notes == []


def test_the_faulty_set_is_repaired_and_told():
    plan, args, notes = replayed("faulty")
    assert [action for action, _ in plan] == [
        "layout/town-v1", "layout/hills-v1", "nature/reeds-v1",
    ]  # fmt: skip
    assert dict(plan)["nature/reeds-v1"] == {}
    assert args == {}
    assert len(notes) == 4
    assert "nature/delete-v1" in notes[0]
    assert "nothing makes surface lake" in notes[1]
    assert "outside 0 to 100" in notes[2]
    assert notes[3].startswith("path: ")


@pytest.mark.parametrize("name", SCRIPTS)
def test_a_set_names_its_model_and_its_day(name):
    path = FOLDER / f"{name}.jsonl"
    assert model_of(read_decisions(path).values()) == "scripted"
    assert all(json.loads(line)["date"] > "2026-01-01" for line in path.read_text().splitlines())


if __name__ == "__main__":
    FOLDER.mkdir(exist_ok=True)
    for name, answers in SCRIPTS.items():
        path = FOLDER / f"{name}.jsonl"
        path.unlink(missing_ok=True)
        played(Decisions(record=path), *answers)
