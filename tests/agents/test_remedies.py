"""What a city misses of its goals becomes changes that bring it about."""

from dataclasses import replace

import numpy as np
import pytest
import shapely

from cityx.agents.remedies import remedies
from cityx.checks.predicates import measure
from cityx.city import City, Frame, Layout, make_table
from cityx.protocol.example_city import example_city


def town(heights, generators=None):
    """A row of houses, of which nothing is built yet."""
    count = len(heights)
    boxes = [shapely.box(20.0 * k, 0.0, 20.0 * k + 10.0, 10.0) for k in range(count)]
    heights = np.asarray(heights, float)
    buildings = make_table(
        "buildings", np.array(boxes, object), id=np.arange(1, count + 1, dtype=np.uint64),
        height=heights, levels=np.maximum(heights // 3, 1),
        generator=np.array(generators or [""] * count),
    )  # fmt: skip
    layout = replace(Layout((0.0, 0.0, 20.0 * count, 10.0)), buildings=buildings)
    return City("Row", Frame(50.0, 10.0), layout)


def carried_out(city, edits):
    """The city with its heights set as edits say."""
    table = city.layout.buildings.copy()
    for edit, chosen in edits:
        ((key, value),) = edit.change
        assert edit.verb == f"set_{key}"
        named = table["id"].isin(chosen.ids)
        table.loc[named, {"height": "height", "floors": "levels"}[key]] = value
    return replace(city, layout=replace(city.layout, buildings=table))


HEIGHTS = [4, 9, 12, 15, 18, 21, 24, 30, 45, 60, 75]


@pytest.mark.parametrize("predicate", [
    "stat(building, height, min) >= 20",
    "stat(building, height, max) <= 50",
    "stat(building, height, p90) <= 40",
    "stat(building, height, p90) >= 70",
    "stat(building, height, p50) >= 33",
    "stat(building, height, p10) <= 5",
    "stat(building, height, max) in [200, 220]",
    "stat(building, floors, max) <= 5",
    "stat(building, floors, p90) <= 3",
])  # fmt: skip
def test_heights_are_set_until_the_goal_is_met(predicate):
    city = town(HEIGHTS)
    assert not measure(predicate, city).met
    edits = remedies(predicate, city)
    assert edits
    assert measure(predicate, carried_out(city, edits)).met


def test_no_more_buildings_change_than_must():
    city = town(HEIGHTS)
    ((_, chosen),) = remedies("stat(building, height, p90) >= 70", city)
    assert chosen.ids.tolist() == [10]  # of eleven; the highest is high enough
    ((_, chosen),) = remedies("stat(building, height, max) <= 50", city)
    assert chosen.ids.tolist() == [10, 11]


@pytest.mark.parametrize("predicate", [
    "road.pattern == grid", "size.x >= 500", "cover(building) >= 0.9", "env.weather == rain",
    "dist(building, center) <= 1", "stat(building, area, max) <= 5", "n(building) == 99",
    "share(building, use=office) >= 0.9", "stat(road, width, p50) <= 3",
])  # fmt: skip
def test_nothing_is_changed_where_no_change_of_objects_helps(predicate):
    assert remedies(predicate, town(HEIGHTS)) == ()


def test_as_many_buildings_take_a_style_as_are_lacking_and_always_the_same():
    kinds = ["glass_tower"] * 3 + ["japanese_lowrise"] * 7
    city = town([20] * 10, kinds)
    asked = "share(building, style=modern) >= 0.6"
    ((edit, chosen),) = remedies(asked, city)
    assert edit.verb == "set_style"
    assert edit.change == (("style", "modern"),)
    assert 0 < len(chosen.ids) <= 6
    ((_, again),) = remedies(asked, city)
    assert again.ids.tolist() == chosen.ids.tolist()


def test_too_few_trees_are_planted():
    ((edit, chosen),) = remedies("n(tree) >= 60", town([5]))
    assert chosen is None
    assert edit.verb == "plant"
    assert dict(edit.change) == {"nature": "tree", "count": 60}


@pytest.mark.parametrize(
    ("look", "verb"),
    [
        ("roof_form=flat", "set_roof"),
        ("material=plaster", "set_material"),
        ("color=white", "set_color"),
    ],
)
def test_a_look_that_none_may_have_becomes_another_usual_one(look, verb):
    city = example_city(built=True)
    found = remedies(f"share(building, {look}) == 0", city)
    assert [one.edit.verb for one in found] == [verb]
    assert not any(value == look.split("=")[1] for one in found for _, value in one.edit.change)
