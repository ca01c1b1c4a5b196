"""Ways of different heights beside, over and under each other."""

import numpy as np
import pytest

from cityx.checks.height_checks import check_heights
from cityx.checks.street_checks import bare_places
from cityx.geometry.polylines import values_along
from cityx.road.ground.ground_surface import ground
from cityx.road.heights.way_heights import heights
from cityx.road.network.network import network

BRIDGE, TUNNEL = {"bridge": True, "layer": 1}, {"tunnel": True, "layer": -1}
LONG = (-400, -400, 400, 400)
WALKS = {"sidewalk_left": 3.0, "sidewalk_right": 3.0}
PRIMARY = {"kind": "primary", "oneway": True, "lanes": 1, "lanes_forward": 1, "width": 3.25}
CROSSED = ([(0, -400), (0, 400)], {})


def built(city_of, layout, lod=1):
    return ground(heights(network(city_of(layout, lod=lod))))


def failing(city):
    return [check.name for check in check_heights(city) if not check.ok] + ["bare"] * bool(
        len(bare_places(city))
    )


@pytest.mark.parametrize("middle", [BRIDGE, TUNNEL])
@pytest.mark.parametrize("apart", [4.0, 5.5, 7.0])
def test_a_ramp_leaves_the_street_beside_it_free(layout_of, city_of, middle, apart):
    # The walks of the ramp would reach over the carriageway that stays on the ground.
    ramp = [([(-390, 0), (-15, 0)], PRIMARY | WALKS), ([(-15, 0), (15, 0)], PRIMARY | middle),
            ([(15, 0), (390, 0)], PRIMARY | WALKS)]  # fmt: skip
    level = [([(-390, -apart), (-20, -apart), (-12, -40)], PRIMARY | WALKS)]
    city = built(city_of, layout_of([*ramp, *level, CROSSED], extent=LONG))
    assert np.abs(city.network.lift).max() > 4.0
    assert failing(city) == []


def test_a_carriageway_shares_the_width_with_one_that_is_higher(layout_of, city_of):
    # Two ways part from a node at an acute angle; one of them goes below the other's crossing.
    lane = PRIMARY | {"sidewalk_left": 0.0, "sidewalk_right": 0.0}
    bridge = lane | BRIDGE
    fork = [([(-390, 0), (-130, 0)], lane), ([(-130, 0), (-90, 1.5), (390, 1.5)], lane),
            ([(-130, 0), (-90, -1.5), (-15, -1.5)], lane), ([(-15, -1.5), (15, -1.5)], bridge),
            ([(15, -1.5), (390, -1.5)], lane), ([(0, -390), (0, 0)], {})]  # fmt: skip
    city = built(city_of, layout_of(fork, extent=LONG))
    assert failing(city) == []


@pytest.mark.parametrize("angle", [20, 35, 60, 90])
def test_a_bridge_clears_the_street_under_its_whole_width(layout_of, city_of, angle):
    turn = np.radians(angle)
    ahead = 390 * np.array([np.cos(turn), np.sin(turn)])
    over = [([tuple(-ahead), tuple(-ahead / 5)], WALKS), ([tuple(-ahead / 5), tuple(ahead / 5)],
            BRIDGE | WALKS), ([tuple(ahead / 5), tuple(ahead)], WALKS)]  # fmt: skip
    city = built(city_of, layout_of([*over, ([(-390, 0), (390, 0)], {})], extent=LONG))
    assert failing(city) == []


def test_levels_of_an_interchange_keep_their_grades_together(layout_of, city_of):
    # Three levels within reach of each other's ramps: the middle one is both over and under.
    low, high = {"tunnel": True, "layer": -1}, {"bridge": True, "layer": 1}
    streets = [([(-390, 0), (-40, 0)], {}), ([(-40, 0), (40, 0)], low), ([(40, 0), (390, 0)], {}),
               ([(20, -390), (20, 390)], {}),
               ([(-390, -60), (0, -25)], {}), ([(0, -25), (40, 25)], high),
               ([(40, 25), (390, 60)], {}), ([(40, 0), (60, 23), (70, 28)], {})]  # fmt: skip
    city = built(city_of, layout_of(streets, extent=LONG))
    assert failing(city) == []
    net = city.network
    at = [float(np.ptp(values_along(net.lines, net.z, np.arange(net.edge_count),
                                    np.zeros(net.edge_count))))]  # fmt: skip
    assert at[0] > 4.0


def test_a_pier_stands_in_no_carriageway_that_has_sunk(layout_of, city_of):
    over = [([(-390, 0), (-60, 0)], {}), ([(-60, 0), (60, 0)], BRIDGE), ([(60, 0), (390, 0)], {})]
    streets = [*over, CROSSED, ([(-390, 6), (-30, 6)], {}), ([(-30, 6), (30, -6)], TUNNEL),
               ([(30, -6), (390, -60)], {})]  # fmt: skip
    city = built(city_of, layout_of(streets, extent=LONG))
    blocked = {check.name: check.value for check in check_heights(city)}["streets_blocked"]
    assert blocked == 0
