"""A motorway crosses a town over its streets, and its ramps lead down to one of them."""

import numpy as np
import pytest
import shapely

from cityx.checks.height_checks import check_heights
from cityx.checks.junction_checks import check_junctions
from cityx.checks.street_checks import check_lanes, check_streets
from cityx.city import City, Frame, Layout
from cityx.city.content import hash_table
from cityx.road.ground.ground_surface import ground
from cityx.road.heights.way_heights import heights
from cityx.road.network.lane_graph import lanes
from cityx.road.network.network import network
from cityx.town.town import town
from cityx.town.wishes.motorway import motorway


def town_of(pattern, seed, *, left=False, size=600.0):
    frame = Frame(51.5, -0.1) if left else Frame(50.0, 10.0)
    bare = City("town", frame, Layout((-1.0, -1.0, 1.0, 1.0)), seed=seed)
    return town(bare, width=size, depth=size, pattern=pattern)


def made(city):
    roads = city.layout.roads
    return roads[roads["source"].str.startswith("made/motorway")]


@pytest.mark.parametrize(
    ("pattern", "seed", "axis", "ramps"),
    [("grid", 3, "north_south", 0), ("superblock", 5, "east_west", 4)],
)
def test_streets_pass_under_it_and_every_way_can_be_driven(pattern, seed, axis, ramps):
    city = motorway(town_of(pattern, seed), axis=axis)
    assert (made(city)["kind"] == "motorway_link").sum() == ramps
    city = ground(lanes(heights(network(city))))
    checks = [*check_heights(city), *check_streets(city), *check_junctions(city),
              *check_lanes(city)]  # fmt: skip
    assert {"clearance_least", "grades_exceeded"} <= {check.name for check in checks}
    assert [check.name for check in checks if not check.ok] == []


@pytest.mark.parametrize("left", [False, True])
def test_traffic_keeps_to_its_side(left):
    city = motorway(town_of("superblock", 5, left=left), axis="north_south", ramps=False)
    lines = made(city).geometry.to_list()
    middle = np.mean([line.coords[0][0] for line in lines])
    assert len(lines) > 1
    for line in lines:
        (x, y0), (_, y1) = line.coords[0], line.coords[-1]
        assert (x > middle) == ((y1 > y0) != left)


def test_no_house_stands_under_it_and_the_others_stay():
    before = town_of("grid", 3)
    after = motorway(before)
    strip = shapely.union_all(shapely.buffer(made(after).geometry.to_numpy(), 5.0))
    assert not shapely.intersects(after.layout.buildings.geometry.to_numpy(), strip).any()
    lost = set(before.layout.buildings["id"]) - set(after.layout.buildings["id"])
    assert 0 < len(lost) < 0.2 * len(before.layout.buildings)


def test_a_motorway_without_room_for_ramps_says_so():
    city = motorway(town_of("grid", 3), axis="north_south")
    assert "motorway: no street that it crosses has room for ramps, so it has none" in city.notes


def test_the_same_seed_gives_the_same_motorway():
    first, second = (motorway(town_of("superblock", 5)).layout.roads for _ in range(2))
    assert len(first)
    for a, b in zip(hash_table(first, "roads"), hash_table(second, "roads"), strict=True):
        assert (a == b).all()
