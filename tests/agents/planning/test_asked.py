import pytest

from cityx.language import read_brief
from cityx.language.asked import slots_of_brief
from cityx.protocol import registry

ACTIONS = registry(outside=False)


def asked(text):
    return slots_of_brief(read_brief(text))


def calls(text):
    return dict(asked(text)["do"])


def test_towers_that_are_counted_stand_alone_within_their_bounds():
    found = calls("Twenty-five towers between 80 and 150 metres tall around a central plaza.")
    towers = found["layout/towers-v1"]
    assert (towers["count"], towers["around"], towers["alone"]) == (25, "plaza", True)
    assert 80 < towers["lowest"] < towers["highest"] < 150
    assert found["layout/places-v1"] == {"kind": "plaza", "count": 1, "central": True}


def test_numbers_go_over_what_words_mean():
    found = asked("A small village of 300 by 200 metres with 12 buildings")
    assert (found["town.width"], found["town.depth"]) == ((300.0,), (200.0,))
    assert found["town.zone"] == ("suburb",)
    assert dict(found["do"])["layout/buildings_count-v1"] == {"count": 12}


def test_an_area_becomes_a_square():
    assert asked("a town of two hectares")["town.width"] == pytest.approx((141.42,), rel=1e-3)


def test_bounds_of_heights_hold_for_every_building_unless_they_speak_of_towers():
    limits = "layout/building_limits-v1"
    assert calls("a town where everything is at least 20 m tall")[limits] == {"lowest": 20.0}
    assert limits not in calls("a downtown with towers up to 300 m")
    assert calls("a downtown with towers up to 300 m")["layout/highest-v1"]["height"] < 300


def test_what_is_denied_is_not_planted():
    found = asked("a town without any trees")
    assert (found["trees.most"], found["trees.street_trees"]) == ((0,), (False,))


def test_weather_has_a_strength_and_a_season_a_day():
    found = asked("light snow on a winter evening")
    assert found["weather.strength"] == (0.4,)
    assert found["sun.date"] == ("01-10",)
    assert found["trees.season"] == ("winter",)


@pytest.mark.parametrize(
    "text",
    [
        "a river 30 m wide with three bridges", "a beach in the south", "a harbour town",
        "eight avenues and two ring roads", "a boulevard with eight lanes from north to south",
        "a park with a lake, 15 % green", "a dense old town", "a sparse suburb", "low buildings",
    ],
)  # fmt: skip
def test_every_call_is_one_that_the_gate_admits(text):
    for action, args in asked(text)["do"]:
        assert ACTIONS[action].argument_faults(args) == []
    town = ACTIONS["layout/town-v1"]
    found = {key.partition(".")[2]: value[0] for key, value in asked(text).items()
             if key.startswith("town.")}  # fmt: skip
    assert town.argument_faults(found) == []
