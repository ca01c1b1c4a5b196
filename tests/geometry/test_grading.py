import numpy as np

from cityx.city.terrain import Terrain
from cityx.geometry.grading import FARTHEST, grade_terrain

SITE = (-100.0, -100.0, 100.0, 100.0)
FLAT = Terrain((-150.0, -150.0), 10.0, np.zeros((31, 31)))


def along_x(z, half=4.0):
    x = np.arange(-100.0, 101.0, 5.0)
    level = np.full(len(x), z)
    return np.column_stack([x, 0 * x]), level, np.zeros((len(x), 2)), np.full(len(x), half)


def test_the_ground_meets_a_road_at_its_height_and_stays_far_from_it():
    made = grade_terrain(FLAT, *along_x(3.0), SITE)
    assert np.allclose(made.height_at([[0, 0], [12, 5], [0, -6]]), 3.0)
    assert np.allclose(made.height_at([[0, FARTHEST + 5], [0, -FARTHEST - 5]]), 0.0)


def test_a_high_fill_ends_in_a_slope_not_in_a_cliff():
    made = grade_terrain(FLAT, *along_x(40.0), SITE)
    y = np.arange(0.0, 90.0, 2.0)
    z = made.height_at(np.column_stack([0 * y, y]))
    assert z[-1] == 0.0
    assert np.abs(np.diff(z)).max() <= 2.0 * 40.0 / (FARTHEST - 7.0) + 0.1


def test_a_road_that_climbs_and_bends_keeps_its_grade():
    turn = np.arange(0.0, 2 * np.pi, 5.0 / 12.0)  # a ring, twelve metres in radius
    points = 12.0 * np.column_stack([np.cos(turn), np.sin(turn)])
    slope = np.tile([0.1, 0.0], (len(points), 1))
    ahead = np.column_stack([-np.sin(turn), np.cos(turn)])
    climb = ahead * (slope * ahead).sum(axis=1)[:, None]
    made = grade_terrain(FLAT, points, points @ slope[0], climb, np.full(len(points), 3.0), SITE)
    fine = np.linspace(0.0, 2 * np.pi, 60)
    place = 12.0 * np.column_stack([np.cos(fine), np.sin(fine)])
    assert np.abs(made.height_at(place) - place @ slope[0]).max() < 0.1
