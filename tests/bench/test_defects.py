"""Seeded defects, planted into a small built town."""

from dataclasses import replace

import numpy as np
import pytest
from cityx_bench import planting
from cityx_bench.defects import (
    HARMLESS,
    KINDS,
    Case,
    alarms,
    base_of,
    plant_kind,
    rows_of,
    table,
)

from cityx.building.shell import shell
from cityx.city import Goal
from cityx.city.content import content_hash
from cityx.protocol.example_city import example_city
from cityx.road.ground.ground_surface import ground
from cityx.road.heights.way_heights import heights
from cityx.road.network.lane_graph import lanes
from cityx.road.network.network import network

SOME = (
    "shell 30 % too high", "building without mesh", "two buildings in one place",
    "floating building", "buried building", "building in the road", "open solid", "floating tree",
    "tree in the road", "wrong weather", "wrong time", "wrong count", "missing park",
    "junction no lane leads over",
)  # fmt: skip


@pytest.fixture(scope="module")
def base():
    trees = example_city(built=True).scene
    city = example_city()
    layout = replace(city.layout, points=city.layout.points.iloc[:0])
    city = shell(ground(lanes(heights(network(replace(city, layout=layout))))))
    return base_of("example", replace(city, scene=with_trees(city.scene, trees)))


def with_trees(scene, trees):
    """The scene with those of the example's trees that stand in its park."""
    rows = trees.instances["trees"]
    kept = planting.taken(rows, np.arange(rows.count) < 3)
    return scene.with_instances("trees", trees.prototypes, kept)


def test_the_example_is_good(base):
    assert "building_overlap" not in base.known
    assert not {"floating_building", "building_buried", "building_height_off"} & set(base.known)


@pytest.mark.parametrize("name", SOME)
def test_a_defect_is_found_and_named(base, name):
    (case,) = plant_kind(name, [base], 1)
    assert case.found, case.turned


def test_the_same_key_plants_the_same_defect_and_leaves_the_city_alone(base):
    before = content_hash(base.city).total
    for name in SOME:
        first, again = (KINDS[name].plant(base.city, 5) for _ in range(2))
        assert first is not None, name
        assert content_hash(first.city).total == content_hash(again.city).total != before, name
    assert content_hash(base.city).total == before


def test_harmless_changes_raise_no_alarm(base):
    for name in ("repainted", "tree turned", "minutes later"):
        changed = HARMLESS[name](base.city, 3)
        assert alarms(changed.city) == alarms(base.city), name


def test_a_city_without_a_place_for_a_defect_is_passed_over(base):
    assert plant_kind("window on a blind wall", [base], 2) == []
    assert plant_kind("bridge without its deck", [base], 2) == []


def test_goals_that_the_city_never_kept_are_not_asked(base):
    city = replace(base.city, goals=(Goal("a", "n(building) == 4"), Goal("b", "n(park) == 9")))
    assert base_of("example", city).goals == ("n(building) == 4",)


def test_rows_count_what_was_found_and_what_was_said_without_a_reason():
    cases = [
        Case("floating tree", "a", True),
        Case("floating tree", "b", False),
        Case("open solid", "a", True, ("things_off_ground",)),
        Case("", "b", False, ("building_overlap",)),
    ]
    rows = {row.kind: row for row in rows_of(cases)}
    assert (rows["floating tree"].recall, rows["floating tree"].precision) == (0.5, 0.5)
    assert (rows["open solid"].recall, rows["open solid"].precision) == (1.0, 1.0)
    assert rows["two buildings in one place"].false == 1
    assert (rows["all"].planted, rows["all"].found, rows["all"].false) == (3, 2, 2)
    assert table(list(rows.values())).splitlines()[-1].split() == [
        "all", "3", "2", "2", "0.500", "0.667",
    ]  # fmt: skip
