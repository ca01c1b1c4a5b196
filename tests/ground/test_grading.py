import numpy as np
import pytest

from cityx.city.terrain import Terrain
from cityx.ground.grading import FARTHEST, grade_terrain

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


def across(made, step=2.0):
    y = np.arange(0.0, 60.0, step)
    return y, made.height_at(np.column_stack([0 * y, y]))


def test_fill_slopes_one_in_one_and_a_half_down_to_the_land():
    y, z = across(grade_terrain(FLAT, *along_x(6.0), SITE))
    assert np.allclose(z[y <= 6.0], 6.0)
    assert np.allclose(z[y > 16.0], 0.0)
    assert np.abs(np.diff(z)).max() <= 2.0 / 1.5 + 1e-3


def test_fill_too_high_for_the_corridor_ends_at_a_wall_and_slopes_on_below_it():
    y, z = across(grade_terrain(FLAT, *along_x(14.0), SITE))
    step = np.abs(np.diff(z))
    wall = step.argmax()
    assert y[wall] == 6.0  # the last place on the strip of 6.5 metres
    assert 14.0 - 15.0 / 1.5 < step[wall] < 6.0
    assert np.delete(step, wall).max() <= 2.0 / 1.5 + 1e-3


def test_a_cut_into_a_hillside_meets_it_and_leaves_the_land_beyond_alone():
    y = -150.0 + 10.0 * np.arange(31.0)
    hill = Terrain((-150.0, -150.0), 10.0, 0.4 * np.tile(y[:, None], (1, 31)))
    y, z = across(grade_terrain(hill, *along_x(0.0), SITE))
    assert np.allclose(z[y > 20.0], 0.4 * y[y > 20.0])
    assert np.abs(np.diff(z)).max() <= 2.0 / 1.5 + 0.2


def test_between_roads_at_two_heights_soil_stands_and_walls_take_the_rest():
    low, high = along_x(0.0), along_x(8.0)
    beside = [low[0], high[0] + [0.0, 20.0]]
    both = [np.concatenate(pair) for pair in zip(low[1:], high[1:], strict=True)]
    made = grade_terrain(FLAT, np.concatenate(beside), *both, SITE)
    y, z = across(made)
    assert np.allclose(z[y < 6.5], 0.0, atol=0.1)
    assert np.allclose(z[(y > 14.0) & (y < 26.0)], 8.0, atol=0.1)
    between = (y > 6.5) & (y < 13.5)
    assert np.abs(np.diff(z[between])).max() <= 2.0 / 1.5 + 1e-3
    assert np.abs(np.diff(z)).max() > 1.2


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


def test_a_wide_street_stays_level_across_where_a_path_climbs_from_its_end():
    wide, path = along_x(0.0, half=8.0), along_x(0.0, half=3.0)
    keep = wide[0][:, 0] <= 0.0
    up = path[0][path[0][:, 0] >= 0.0][:, ::-1]
    places = np.concatenate([wide[0][keep], up])
    z = np.concatenate([wide[1][keep], 0.15 * up[:, 1]])
    climb = np.concatenate([wide[2][keep], np.tile([0.0, 0.15], (len(up), 1))])
    half = np.concatenate([wide[3][keep], np.full(len(up), 3.0)])
    made = grade_terrain(FLAT, places, z, climb, half, SITE)
    assert abs(made.height_at([[-2.0, 4.0]])[0]) < 0.3
    assert made.height_at([[0.0, 20.0]])[0] == pytest.approx(3.0, abs=0.2)
