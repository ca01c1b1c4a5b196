"""What vehicles sweep over in bends and on their ways across junctions."""

from types import SimpleNamespace

import numpy as np
import pytest
import shapely

from cityx.traffic.shared_ground import HALF_BODY
from cityx.traffic.streets import Link, Streets
from cityx.traffic.sweeps import HALF, LENGTH, clear_links, swept_into, turns_back

TURN = np.linspace(-np.pi / 2, 0.0, 13)
ARC = np.column_stack([4.0 * np.cos(TURN), 4.0 + 4.0 * np.sin(TURN), 0.0 * TURN])  # to the left
EAST = np.array([[-20.0, 0.0, 0.0], [0.0, 0.0, 0.0]])
NORTH = np.array([[4.0, 4.0, 0.0], [4.0, 24.0, 0.0]])


def wall(gap):
    """A wall so many metres inside of the middle of the bend."""
    at = ARC[6, :2] + gap * np.array([-np.sqrt(0.5), np.sqrt(0.5)])
    return shapely.STRtree([shapely.box(at[0] - 5.0, at[1], at[0], at[1] + 5.0)])


@pytest.mark.parametrize(("gap", "clear"), [(1.1, False), (2.5, True)])
def test_a_bend_is_closed_where_the_rear_of_a_car_would_be_in_a_wall(gap, clear):
    walls = wall(gap)
    bend = shapely.LineString(np.concatenate([EAST, ARC[1:-1], NORTH]))
    follows = shapely.buffer(shapely.force_2d(bend), HALF_BODY, cap_style="flat")
    assert not len(walls.query(follows, predicate="intersects"))  # the strip of its width is free
    assert swept_into(np.array([bend]), walls).tolist() == [not clear]
    ways = [SimpleNamespace(lanes=(SimpleNamespace(shape=shape),)) for shape in (EAST, NORTH)]
    link = Link((0, 0), (1, 0), ARC)
    streets = Streets(tuple(ways), (link,), (), np.zeros((0, 3)), np.zeros(0, bool), False)
    assert clear_links(streets, walls).links == ((link,) if clear else ())


def test_the_rear_of_a_bus_reaches_farther_into_a_bend_than_that_of_a_car():
    bend = np.array([shapely.LineString(np.concatenate([EAST, ARC[1:-1], NORTH]))])
    walls = wall(2.0)
    assert not swept_into(bend, walls).any()
    assert swept_into(bend, walls, LENGTH, HALF).all()
    assert not swept_into(bend, wall(6.0), LENGTH, HALF).any()


@pytest.mark.parametrize(("across", "tight"), [(12.4, True), (25.0, False)])
def test_a_bus_turns_back_only_where_it_gets_round(across, tight):
    turn = np.linspace(-np.pi / 2, np.pi / 2, 13)
    loop = across / 2 * np.column_stack([np.cos(turn), 1.0 + np.sin(turn)])
    assert turns_back(loop) == tight
    assert not turns_back(ARC[:, :2])
