"""Going back and a change in one sentence: in order, whole or not at all, one trail of revisions.

The town has the church "St Mary"; two changes are made first: snow, then dusk.
"""

import json

import numpy as np
import pytest
from cityx_bench.drivers import driver_named
from cityx_bench.outcome import Workplace
from cityx_bench.tasks import Task
from copies import copy_of

import cityx
from cityx.checks.predicates import measure
from cityx.city.content import content_hash
from cityx.city.store import read_city
from cityx.errors import CityxError, UsageError
from cityx.language import read_brief
from cityx.language.brief import Clarify
from cityx.options import PlannerChoice
from cityx.projects.desk import Desk
from cityx.projects.edit import edit_city
from cityx.projects.instructions import carry_out_text, plan_text
from cityx.protocol.gate import Call

SNOW = Call("background/weather-v1", {"preset": "snow"})
DUSK = Call("background/sun-v1", {"time": "dusk"})


@pytest.fixture
def folder(built_town, tmp_path):
    folder = copy_of(built_town(lod=0), tmp_path / "town")
    with Desk(folder) as desk:
        desk.change([SNOW], text="snow")
        desk.change([DUSK], text="dusk")
    return folder


def state(folder):
    """Return whether it snows, whether it is dusk, and the buildings that are red."""
    city = read_city(folder / "city")
    red = measure("n(building, color=red) >= 1", city)
    return city.environment.snow > 0, bool(measure("env.time == dusk", city).met), red.met


SENTENCES = {
    "undo the last change and make the tallest building red instead": (True, False, True),
    "go back two steps, then paint the largest building red": (False, False, True),
    "Start over and make it snow.": (True, False, False),
    "Instead of the last change, paint all houses red": (True, False, True),
    "undo twice, redo once and make the tallest building red": (True, False, True),
    "Take it back; paint all buildings red.": (True, False, True),
}


@pytest.mark.parametrize("sentence", SENTENCES)
def test_both_are_carried_out_in_order(folder, sentence):
    report = edit_city(folder, sentence)
    assert state(folder) == SENTENCES[sentence]
    assert report["revision"] == 4
    assert report["change"]["text"] == sentence
    assert not [goal for goal in report["goals_of_change"] if goal["met"] is False]


def test_redo_comes_before_a_change_too(folder):
    with Desk(folder) as desk:
        desk.undo()
    edit_city(folder, "redo it and make the tallest building red")
    assert state(folder) == (True, True, True)


def test_the_trail_goes_back_over_the_change_to_where_it_began(folder):
    edit_city(folder, "Undo the last change and make the tallest building red.")
    with Desk(folder) as desk:
        snow = {item.number: item.content for item in desk.revisions()}[2]
        red = desk.revisions()[-1].content
        assert desk.undo().content == snow
        assert desk.redo().content == red == content_hash(desk.city).total
        with pytest.raises(UsageError, match="nothing to redo"):  # dusk was given up
            desk.redo()


def test_names_are_those_of_the_city_that_is_gone_back_to(folder):
    with Desk(folder) as desk:
        tallest = desk.city.layout.buildings.id[np.argmax(desk.city.layout.buildings.height)]
        desk.change([Call("edit/remove-v1", {"objects": [f"{int(tallest):016x}"]})])
    edit_city(folder, f"undo it and paint {int(tallest):016x} red")
    assert state(folder) == (True, True, True)


REFUSED = {
    "make the tallest building red and then undo": "comes after a change of the same sentence",
    "undo the last nine changes and make it rain": "There are 2 changes to undo, not 9.",
    "redo and make it rain": "There is nothing to redo.",
    "cancel the rain": "How many changes are to be undone?",
    "undo everything but the trees": "How many changes are to be undone?",
    "undo the last change and make b99 red": "b99",
}


@pytest.mark.parametrize("sentence", REFUSED)
def test_what_cannot_be_is_asked_and_changes_nothing(folder, sentence):
    before = content_hash(read_city(folder / "city")).total
    with pytest.raises((Clarify, CityxError)) as told:
        edit_city(folder, sentence)
    assert REFUSED[sentence] in str(told.value)
    with Desk(folder) as desk:
        assert desk.revision == 3
        assert content_hash(desk.city).total == before


def test_a_change_that_fails_takes_the_going_back_with_it(folder, monkeypatch):
    def failing(*_, **__):
        raise UsageError("no paint")

    monkeypatch.setattr("cityx.agents.step_runner.run_action", failing)
    with pytest.raises(UsageError, match="no paint"):
        edit_city(folder, "Undo the last change and make the tallest building red.")
    assert state(folder) == (True, True, False)


def test_python_and_plans_know_it_too(folder):
    sentence = "undo the last change and make the tallest building red"
    plan = plan_text(sentence, folder, PlannerChoice())
    assert ["undo", 1] in plan["asked"]
    assert [item["action"] for item in plan["workflow"]] == ["edit/recolor-v1"]
    assert cityx.open(folder).edit(sentence).number == 4
    told = carry_out_text("go back and paint all houses red", folder, print, lambda: False)
    assert told["revision"] == 5


@pytest.mark.parametrize("driver", ["offline", "replay"])
def test_the_bench_carries_it_out_with_every_driver(folder, tmp_path, driver):
    task = Task("U1", "Undo the last change and make the tallest building red.", base="town",
                setup=("x",), expect=("n(building, color=red) == 1",))  # fmt: skip
    place = Workplace.opened(task, folder, {}, seed=0, lod=0)
    if driver == "replay":  # the rules have read it right, which whoever is asked agrees to
        pytest.importorskip("pydantic_ai", reason="needs the extra llm")
        path = tmp_path / "prompts.jsonl"
        assert driver_named(f"export:{path}").propose(place).faults
        prompt = json.loads(path.read_text())
        path.write_text(json.dumps({**prompt, "answer": {"commands": []}}) + "\n")
        driver = f"replay:{path}"
    outcome = driver_named(driver).propose(place)
    assert outcome.faults == ()
    assert outcome.unsupported == ()
    assert state(folder) == (True, False, True)


@pytest.mark.parametrize(
    ("sentence", "steps"),
    [
        ("Please undo that change for me", 1),
        ("undo both changes", 2),
        ("undo it three times", 3),
        ("back to square one", "all"),
        ("take back the last 2 edits", 2),
    ],
)
def test_how_far_is_read(sentence, steps):
    (edit,) = read_brief(sentence, base=True).edits
    assert dict(edit.change) == {"undo": steps}
