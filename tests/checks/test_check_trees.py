from dataclasses import replace

import numpy as np
import pytest
import shapely

from cityx.assets.trees import tree
from cityx.checks.furniture_checks import check_trees
from cityx.checks.terrain_checks import check_ground
from cityx.city import City, Frame, Instances, Layout, Scene, make_table
from cityx.road.ground.ground_surface import ground
from cityx.road.network.lane_graph import lanes
from cityx.road.network.network import network

HOUSE = shapely.box(-20, 12, 20, 22)


@pytest.fixture(scope="module")
def street():
    roads = make_table(
        "roads", [shapely.LineString([(-60, 0), (60, 0)])], id=[1], kind=["residential"],
        name=["A"], width=[8.0], sidewalk_left=[3.0], sidewalk_right=[3.0], lanes=[2],
    )  # fmt: skip
    buildings = make_table("buildings", [HOUSE], id=[2], levels=[3])
    layout = Layout((-60.0, -40.0, 60.0, 40.0), roads=roads, buildings=buildings)
    return ground(lanes(network(City("street", Frame(50.0, 8.0), layout))))


def with_tree(city, x, y, scale=1.0):
    one = np.ones((1, 3), np.float32)
    rows = Instances(np.zeros(1, np.int32), np.ones(1, np.uint64), np.zeros(1, np.uint64),
                     np.array([[x, y, 0.1]]), 0 * one, scale * one, one)  # fmt: skip
    return replace(city, scene=Scene().with_instances("trees", [tree("lime", 0, "light")], rows))


def values(city):
    return {check.name: check.value for check in [*check_trees(city), *check_ground(city)]}


def test_a_tree_on_the_walk_passes(street):
    found = values(with_tree(street, 0.0, 5.0))
    assert [found[name] for name in ("trees_in_walls", "trees_in_lanes", "trees_misplaced")] == [
        0, 0, 0,
    ]  # fmt: skip
    assert found["crowns_in_facades"] == 0.0


def test_a_trunk_in_a_lane_is_counted(street):
    found = values(with_tree(street, 10.0, 2.0))
    assert found["trees_in_lanes"] == 1
    assert found["trees_misplaced"] == 1


def test_a_trunk_in_a_wall_and_a_crown_in_a_facade_are_counted(street):
    assert values(with_tree(street, 0.0, 11.9))["trees_in_walls"] == 1
    assert values(with_tree(street, 0.0, 9.0))["crowns_in_facades"] == 1.0
    assert values(with_tree(street, 0.0, 9.0, 0.5))["crowns_in_facades"] == 0.0


def test_a_city_without_trees_has_no_such_checks(street):
    assert check_trees(replace(street, scene=Scene())) == []
