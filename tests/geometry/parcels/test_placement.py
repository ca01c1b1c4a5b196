import numpy as np
import pytest
import shapely

from cityx.geometry.clearance import distance_within, near_any, push_off
from cityx.geometry.triangle_cells import in_triangles
from cityx.road.surface.kerbs import yaw_facing, yaw_of_compass

ROAD = np.array([shapely.LineString([(0, 0), (100, 0)])], dtype=object)


def test_a_point_in_a_strip_moves_square_out_of_it():
    moved, free = push_off([[50.0, 2.0], [50.0, -1.0], [50.0, 8.0]], ROAD, [4.0], most=5.0)
    assert moved[:, 0] == pytest.approx([50, 50, 50])
    assert moved[:, 1] == pytest.approx([4.0, -4.0, 8.0], abs=0.02)
    assert free.all()


def test_a_point_that_would_go_too_far_is_given_up():
    _, free = push_off([[50.0, 0.5]], ROAD, [4.0], most=2.0)
    assert not free.any()


def test_a_point_on_the_centreline_is_given_up():
    _, free = push_off([[50.0, 0.0]], ROAD, [4.0], most=9.0)
    assert not free.any()


def test_distances_beyond_reach_are_infinite():
    box = np.array([shapely.box(0, 0, 1, 1)], dtype=object)
    assert distance_within([[3, 0.5], [9, 0.5]], box, 5.0).tolist() == [2.0, np.inf]
    assert near_any([[3, 0.5], [9, 0.5]], box, 2.5).tolist() == [True, False]


def test_points_are_found_in_small_and_in_large_triangles():
    vertices = np.array([[0, 0], [1, 0], [0, 1], [100, 0], [600, 0], [100, 500]], float)
    triangles = np.array([[0, 1, 2], [3, 4, 5]], np.int32)
    spots = [[0.2, 0.2], [0.9, 0.9], [110.0, 300.0], [500.0, 400.0]]
    assert in_triangles(spots, vertices, triangles).tolist() == [True, False, True, False]


def test_nothing_is_near_nothing():
    assert not near_any([[0.0, 0.0]], np.zeros(0, object), 5.0).any()
    assert near_any(np.zeros((0, 2)), ROAD, 5.0).shape == (0,)


def test_yaw_turns_the_front_to_the_direction():
    for angle in (0.0, 0.7, 2.0, 4.4):
        way = np.array([np.sin(angle), np.cos(angle)])
        for yaw in (yaw_facing([way])[0], yaw_of_compass(angle)):
            assert [np.sin(yaw), -np.cos(yaw)] == pytest.approx(way)
