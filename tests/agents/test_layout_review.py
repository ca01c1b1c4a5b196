"""What was measured stands against what is seen."""

import pytest

from cityx.agents.evaluator import measured_of, of_layout
from cityx.agents.verdict import Seen, merge
from cityx.city import Goal

CHECKS = {"floating_building": {"ok": False}, "building_overlap": {"ok": True}}
REPORT = {"checks": CHECKS, "goals": [{"goal": "weather = rain", "met": True}]}


def test_a_failed_check_is_measured_under_its_name_and_answers_its_question():
    assert measured_of(REPORT) == {
        "weather=rain": True, "floating_building": False, "look.standing": False,
    }  # fmt: skip
    good = {**REPORT, "checks": {"building_overlap": {"ok": True}}}
    assert measured_of(good) == {"weather=rain": True}


@pytest.mark.parametrize("look", [Seen("yes"), Seen("yes", 2), Seen("cannot tell", 2)])
def test_no_look_lets_a_floating_building_pass(look):
    verdict = merge(measured_of(REPORT), {"look.standing": look, "floating_building": look})
    assert not verdict.ok
    for goal in ("look.standing", "floating_building"):
        found = verdict.findings[goal]
        assert (found.met, found.severity, found.origin) == (False, "block", "check")


@pytest.mark.parametrize(("predicate", "early"), [
    ("cover(building) >= 0.35", True),
    ("stat(road, width, p50) <= 7", True),
    ("n(street) >= 3", True),  # no tree, though it ends like one
    ("dist(plaza, center) <= 20", True),
    ("n(tree) >= 60", False),
    ("share(building, style=modern) >= 0.7", False),
    ("env.weather == rain", False),
    ("n(car) == 0", False),
    ("iou(building, town.osm) >= 0.9", False),
])  # fmt: skip
def test_what_a_layout_can_be_asked_for_is_known_before_anything_is_built(predicate, early):
    goal = Goal("wish", predicate)
    assert of_layout([goal]) == ((goal,) if early else ())
