"""What stands where a building stands now gives way to it; what a change breaks is told."""

from dataclasses import replace

import numpy as np
import pytest
import shapely

from cityx.checks import broken
from cityx.checks.predicates import measure
from cityx.city.rows import take_rows
from cityx.protocol import registry
from cityx.protocol.gate import Call
from cityx.protocol.running import run_action

BUILDING = "b02"


def edited(city, action, **args):
    return run_action(city, Call(f"edit/{action}-v1", args), registry()).city


def outline(city):
    table = city.layout.buildings
    return table.geometry.to_numpy()[table["name"].to_numpy(str) == BUILDING][0]


def with_tree(city, distance):
    """Put a tree so far before the middle of a building's longest wall, and return its id."""
    ring = shapely.get_coordinates(shapely.set_precision(outline(city), 0.01).exterior)
    sides = np.diff(ring, axis=0)
    row = int(np.argmax(np.hypot(*sides.T)))
    along = sides[row] / np.hypot(*sides[row])
    out = np.array([along[1], -along[0]])
    middle = ring[row] + sides[row] / 2
    if outline(city).contains(shapely.Point(middle + 0.1 * out)):
        out = -out
    trees = city.scene.instances["trees"]
    position = trees.position.copy()
    position[0, :2] = middle + distance * out
    rows = replace(trees, position=position)
    scene = city.scene.with_instances("trees", city.scene.prototypes, rows)
    return replace(city, scene=scene), int(trees.object_id[0])


def test_a_tree_that_a_larger_building_reaches_goes_and_is_told(scene):
    city, tree = with_tree(scene("park_s"), 1.0)
    made = edited(city, "scale", objects=[BUILDING], factor=1.2)
    trees = made.scene.instances["trees"]
    assert shapely.distance(outline(made), shapely.points(trees.position[:, :2])).min() > 0.3
    assert tree not in trees.object_id.tolist()
    assert trees.count == city.scene.instances["trees"].count - 1
    assert made.notes[-1] == f"To {BUILDING} gave way: trees (1)."


def test_what_gave_way_is_no_other_change(scene):
    city, _ = with_tree(scene("park_s"), 1.0)
    made = edited(city, "scale", objects=[BUILDING], factor=1.2)
    goals = [f"changed({BUILDING})", "same(others)"]
    from cityx.checks.predicates import measure_all

    assert [one.met for one in measure_all(goals, made, before=city)] == [True, True]
    trees = made.scene.instances["trees"]
    fewer = made.scene.with_instances(
        "trees", made.scene.prototypes, take_rows(trees, np.arange(trees.count) > 0)
    )
    other = replace(made, scene=fewer)
    assert [one.met for one in measure_all(goals, other, before=city)] == [True, False]
    assert measure("same(tree)", made, before=city).met is False


@pytest.mark.parametrize("most", [0, 600])
def test_a_check_that_a_change_breaks_is_told_once(scene, monkeypatch, most):
    monkeypatch.setattr(broken, "MOST", most)
    city = scene("park_s")
    bad, tree = with_tree(city, -1.0)
    found, whole = broken.broken_by_change(city, bad)
    assert found["trees_in_walls"]["value"] == 1.0
    assert found["trees_in_walls"]["ids"] == [f"{tree:016x}"]
    assert (whole is None) == (most == 0)
    assert broken.broken_by_change(bad, bad)[0] == {}
