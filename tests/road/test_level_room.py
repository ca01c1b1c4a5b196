"""Whether the map leaves room for one way to pass over another, asked of its lines alone."""

from dataclasses import replace

import numpy as np
import pytest

from cityx.checks.height_checks import check_heights
from cityx.checks.level_room import level_crossings
from cityx.road.ground.ground_surface import ground
from cityx.road.heights.way_heights import heights
from cityx.road.network.network import network

BRIDGE, TUNNEL = {"bridge": True, "layer": 1}, {"tunnel": True, "layer": -1}


def loop(side):
    """Return a ramp that winds round a square and passes over its own start."""
    round_it = [(0, -side), (side, -side), (side, 0)]
    return [([(0, 60), (0, -side)], {}), (round_it, {}), ([(side, 0), (-10, 0)], BRIDGE),
            ([(-10, 0), (-90, 0)], {})]  # fmt: skip


@pytest.mark.parametrize(("side", "tight", "roomless"),
                         [(80, False, False), (10, True, False), (4, True, True)])  # fmt: skip
def test_a_ramp_has_room_over_itself_by_its_length(layout_of, side, tight, roomless):
    found = level_crossings(layout_of(loop(side)))
    at = np.flatnonzero(np.hypot(*found.at.T) < 0.1)
    assert found.tight[at].any() == tight
    assert found.roomless[at].any() == roomless


def test_ways_that_meet_nowhere_always_have_room(layout_of):
    streets = [([(-30, 0), (30, 0)], BRIDGE), ([(0, -30), (0, 30)], {})]
    found = level_crossings(layout_of(streets))
    assert len(found.at) == 1
    assert not found.tight.any()


def test_crossings_that_have_room_one_by_one_may_lack_it_together(layout_of):
    # Each way passes over the next one, and the last over the first: no heights do that.
    streets = [([(-50, 0), (50, 0)], {"layer": 1}), ([(-40, -40), (5, 40)], {"layer": 0}),
               ([(-5, 40), (40, -40)], {"layer": 2})]  # fmt: skip
    assert not level_crossings(layout_of(streets)).roomless.any()
    short = [([(-9, 0), (9, 0)], {"layer": 1}), ([(-9, 0), (-9, -9), (0, 9)], {"layer": 0}),
             ([(9, 0), (9, -9), (0, 9)], {"layer": 2})]  # fmt: skip
    assert (
        level_crossings(layout_of(short)).tight.sum()
        >= level_crossings(layout_of(streets)).tight.sum()
    )


def test_tunnels_of_one_layer_that_cross_without_a_node_have_no_room(layout_of):
    streets = [([(-50, 0), (50, 0)], TUNNEL), ([(1, -50), (1, 50)], TUNNEL)]
    assert level_crossings(layout_of(streets)).roomless.all()
    joined = [([(-50, 0), (1, 0), (50, 0)], TUNNEL), ([(1, -50), (1, 0), (1, 50)], TUNNEL)]
    assert not len(level_crossings(layout_of(joined)).at)


def test_a_crossing_that_was_closed_though_there_is_room_is_found(layout_of, city_of):
    streets = [([(-390, 0), (-60, 0)], {}), ([(-60, 0), (60, 0)], BRIDGE),
               ([(60, 0), (390, 0)], {}),
               ([(0, -390), (0, 390)], {})]  # fmt: skip
    city = ground(heights(network(city_of(layout_of(streets, extent=(-400, -400, 400, 400))))))
    checks = {check.name: check for check in check_heights(city)}
    assert checks["levels_closed"].ok
    flat = replace(city.network, z=np.zeros_like(city.network.z))
    checks = {check.name: check for check in check_heights(replace(city, network=flat))}
    assert checks["levels_closed"].value == 1


def test_words_of_notes_spare_nothing(layout_of, city_of):
    streets = [([(-390, 0), (-60, 0)], {}), ([(-60, 0), (60, 0)], BRIDGE),
               ([(60, 0), (390, 0)], {}),
               ([(0, -390), (0, 390)], {})]  # fmt: skip
    city = ground(heights(network(city_of(layout_of(streets, extent=(-400, -400, 400, 400))))))
    city.scene.meshes["structures"].vertices[:, 2] -= 3.0
    told = replace(city, notes=("map: 1 ways without room: osm/way/1 x osm/way/4",))
    checks = {check.name: check for check in check_heights(told)}
    assert not (checks["streets_blocked"].ok and checks["clearance_short"].ok)
