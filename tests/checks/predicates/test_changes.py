"""What changed between two states, and what kept still."""

from dataclasses import replace

import numpy as np
import pytest
from made import (
    HOUSES,
    PERSON,
    TREE,
    edited,
    made_city,
    row_of,
    shell,
    with_air,
    with_shells,
    with_things,
    without,
)

from cityx.checks.predicates import measure, measure_all

GLASS = [
    "changed(top(building, height, 3))",
    "share(top(building, height, 3), material=glass) == 1",
    "same(others)",
]
DOUBLE = ["ratio(b07, height) in [1.98, 2.02]", "n(building, id=b03) == 0", "same(others)"]


@pytest.fixture(scope="module")
def city():
    """All houses of concrete."""
    return with_shells(
        made_city(), [shell(k, row, wall="concrete") for k, row in enumerate(HOUSES)]
    )


def dressed(city, *numbers, **changes):
    """The city with other shells for some houses."""
    shells = [
        shell(k, row, **({"wall": "concrete"} | (changes if k in numbers else {})))
        for k, row in enumerate(HOUSES)
    ]
    return with_shells(city, shells)


def mets(asked, city, before):
    return [each.met for each in measure_all(asked, city, before=before)]


def test_the_three_tallest_become_glass_and_nothing_else(city):
    assert mets(GLASS, dressed(city, 3, 4, 5, wall="glass_wall"), city) == [True, True, True]


def test_two_of_three_are_not_all(city):
    assert mets(GLASS, dressed(city, 3, 4, wall="glass_wall"), city) == [False, False, True]


def test_a_fourth_is_one_too_many(city):
    assert mets(GLASS, dressed(city, 2, 3, 4, 5, wall="glass_wall"), city) == [True, True, False]


def test_one_is_doubled_and_one_is_gone(city):
    tall = dressed(city, 6, top=16.0)
    done = without(tall, "buildings", [row_of(tall, "buildings", "made/b03")])
    parts = done.layout.parts
    kept = parts[parts["building"].isin(done.layout.buildings["id"])].reset_index(drop=True)
    done = replace(done, layout=replace(done.layout, parts=kept))
    assert mets(DOUBLE, done, city) == [True, True, True]
    assert mets(DOUBLE, tall, city) == [True, False, True]
    assert mets(DOUBLE, city, city) == [False, False, True]
    felled = with_things(done, "trees", TREE, [(185.0, 5.0)])
    assert mets(DOUBLE, felled, city) == [True, True, False]


def test_a_night_leaves_buildings_as_they_are_but_not_the_light(city):
    night = with_air(city, sun_elevation=-0.5)
    asked = ["env.time == night", "same(building)", "same(others)"]
    assert mets(asked, night, city) == [True, True, True]
    assert mets(["same(others)"], night, city) == [False]
    assert mets(["same(building)"], dressed(night, 0, wall="brick"), city) == [False]


def test_a_kind_that_a_predicate_names_is_no_other(city):
    asked = ["n(pedestrian) == 1", "same(others)"]
    walked = with_things(city, "people", PERSON, [(150.0, 90.0)])
    assert mets(asked, walked, city) == [True, True]
    assert mets(asked[1:], walked, city) == [False]


def test_naming_one_of_a_kind_leaves_the_others_of_it_alone(city):
    asked = ["color(b01) ~ red", "same(others)", "n(building) == 7"]
    red = {"tint": (0.9, 0.05, 0.03), "wall": "plaster"}
    assert mets(asked, dressed(city, 0, **red), city) == [True, True, True]
    assert mets(asked, dressed(city, 0, 1, **red), city) == [True, False, True]


def test_a_row_of_the_layout_counts_as_its_object(city):
    road = row_of(city, "roads", "made/r03")
    wide = edited(city, "roads", "width", road, 9.0)
    assert mets(["changed(r03)", "same(r02)", "same(building)"], wide, city) == [True] * 3
    assert mets(["changed(r02)", "same(road)"], wide, city) == [False, False]


def test_windows_belong_to_their_building(city):
    owner = int(city.layout.buildings["id"].iloc[0])
    source = str(city.layout.buildings["source"].iloc[0]).rpartition("/")[2]
    fitted = with_things(city, "windows", TREE, [(30.0, 30.0)], owner=owner)
    assert mets([f"changed({source})", "same(others)"], fitted, city) == [True, True]


def test_without_an_earlier_state_nothing_is_told(city):
    for asked in ("same(building)", "changed(b01)", "ratio(b01, height) >= 1"):
        found = measure(asked, city)
        assert found.met is None
        assert found.evidence == "cannot tell: there is no earlier state to compare with"


def test_order_of_rows_is_no_change(city):
    batch = city.scene.meshes["buildings"]
    turned = batch.take(np.arange(batch.count)[::-1])
    other = replace(city, scene=city.scene.with_mesh("buildings", turned))
    assert mets(["same(building)", "same(others)"], other, city) == [True, True]


def test_what_stood_there_before_is_not_gained(city):
    two = with_things(city, "people", PERSON, [(150.0, 90.0), (152.0, 90.0)])
    five = with_things(city, "people", PERSON, [(150.0 + k, 90.0) for k in range(5)])
    asked = ["gained(pedestrian) == 3", "n(pedestrian) >= 3"]
    assert mets(asked, five, two) == [True, True]
    assert mets(asked, five, five) == [False, True]  # they stood there: nobody came
    assert mets(["gained(pedestrian) == -3"], two, five) == [True]
    assert measure("gained(pedestrian) == 3", five).met is None  # nothing to compare with


def test_what_is_gained_may_be_narrowed(city):
    more = edited(city, "buildings", "levels", row_of(city, "buildings", "made/b01"), 33)
    asked = ["gained(building, floors=33) == 1", "gained(building) == 0"]
    assert mets(asked, more, city) == [True, True]
