import numpy as np
import pytest

from cityx.geometry.airways import Airspace, airway, airways, rounded


def over(top, ceiling=95.0):
    top = np.asarray(top, float)
    return Airspace(np.array([0.0, 0.0, 40.0]), 5.0, 10.0, top, np.full_like(top, ceiling), 6)


def walled(height):
    """Air over 20 x 20 cells with a wall across, but for a gap at its northern end."""
    top = np.full((20, 20), 40.0)
    top[:18, 10] = height
    return over(top)


def point(ways, xyz):
    return int(np.argmin(((ways.points - xyz) ** 2).sum(axis=1)))


def test_open_air_is_crossed_straight():
    ways = airways(over(np.full((20, 20), 40.0)))
    corners = airway(ways, point(ways, (0, 0, 40)), point(ways, (95, 60, 80)))
    assert len(corners) == 2
    assert corners[-1] == pytest.approx((95, 60, 80))


def test_a_low_wall_is_flown_over_and_a_high_one_round():
    for height, crossed_at in ((50.0, 0.0), (95.0, 90.0)):
        air = walled(height)
        ways = airways(air)
        corners = airway(ways, point(ways, (10, 0, 40)), point(ways, (90, 0, 40)))
        line = rounded(air, corners, 1.0, 0)
        crossing = line[np.argmin(np.abs(line[:, 0] - 50.0))]
        assert crossing[1] == pytest.approx(crossed_at, abs=3.0)
        assert air.free(line).all()


def test_rounded_ways_stay_in_free_air_and_turn_less():
    air = walled(90.0)
    ways = airways(air.wider())
    corners = airway(ways, point(ways, (10, 10, 40)), point(ways, (90, 10, 40)))
    sharp, smooth = rounded(air, corners, 1.0, 0), rounded(air, corners, 1.0, 60)
    assert air.free(smooth).all()
    assert smooth[[0, -1]] == pytest.approx(sharp[[0, -1]])

    def turn(line):
        way = np.diff(line, axis=0)
        way /= np.linalg.norm(way, axis=1, keepdims=True)
        return np.degrees(np.arccos(np.clip((way[1:] * way[:-1]).sum(axis=1), -1, 1)).max())

    assert turn(smooth) < 0.5 * turn(sharp)


def test_what_is_cut_off_is_not_reached():
    top = np.full((20, 20), 40.0)
    top[:, 10] = 200.0
    ways = airways(over(top))
    assert airway(ways, point(ways, (0, 0, 40)), point(ways, (95, 0, 40))) is None


def test_nothing_flies_above_the_ceiling():
    air = over(walled(80.0).top, ceiling=75.0)
    ways = airways(air)
    assert ways.points[:, 2].max() <= 75.0
    corners = airway(ways, point(ways, (10, 0, 40)), point(ways, (90, 0, 40)))
    assert corners[:, 1].max() == pytest.approx(90.0)  # round the wall that it may not cross


def test_beyond_the_site_no_air_is_free():
    air = over(np.full((20, 20), 40.0))
    spots = np.array([[50, 50, 45], [-10, 50, 45], [50, 50, 39], [50, 120, 45.0]])
    assert air.free(spots).tolist() == [True, False, False, False]
