"""Traffic keeps to the side that is asked for, whatever the country does."""

from dataclasses import replace

import pytest

from cityx.checks.predicates import measure
from cityx.city import City, Frame, Layout
from cityx.places.profiles import keeps_left, profile_of
from cityx.road.network.lane_graph import lanes
from cityx.road.network.network import network
from cityx.town.town import town
from cityx.town.wishes.driving_side import driving_side

GERMANY, ENGLAND = (50.0, 10.0), (51.5, -0.1)


@pytest.mark.parametrize("at", [GERMANY, ENGLAND])
@pytest.mark.parametrize("side", ["left", "right"])
def test_lanes_are_on_the_side_that_is_asked_for(at, side):
    city = City("Town", Frame(*at), Layout((0.0, 0.0, 1.0, 1.0)), seed=3)
    usual = profile_of(city.frame)
    city = town(driving_side(city, side=side), width=600.0, depth=600.0)
    assert keeps_left(city.frame) == (side == "left")
    assert profile_of(city.frame).streets == usual.streets
    city = lanes(network(city))
    assert measure(f"road.side == {side}", city).met
    assert not measure(f"road.side == {'right' if side == 'left' else 'left'}", city).met


def test_a_profile_of_the_users_own_keeps_what_else_it_says():
    own = '{"inherits":"jp","streets":{"kerb_parking":false}}'
    city = City("Town", replace(Frame(*GERMANY), place=own), Layout((0.0, 0.0, 300.0, 300.0)))
    frame = driving_side(city, side="right").frame
    assert not keeps_left(frame)
    assert "jp" in profile_of(frame).lineage
