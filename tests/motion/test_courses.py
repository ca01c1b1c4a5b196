import numpy as np
import pytest
import shapely

from cityx.motion.courses import course, paces, times

SQUARE = [(0, 0), (20, 0), (20, 20), (0, 20)]
BEND = [(0, 0), (20, 0), (20, 20)]


@pytest.mark.parametrize("closed", [False, True])
def test_a_course_keeps_near_its_path(closed):
    way = course(SQUARE, closed=closed, slack=0.4, spacing=1.0)
    corner = shapely.Point(20, 20)
    assert shapely.distance(shapely.LineString(way.points), corner) == pytest.approx(0.4, abs=0.01)
    line = shapely.LinearRing(SQUARE) if closed else shapely.LineString(SQUARE)
    assert shapely.distance(shapely.points(way.points), line).max() < 0.4
    assert np.diff(way.along).max() <= 1.0 + 1e-9


def test_an_open_course_begins_and_ends_where_its_path_does():
    way = course(BEND, closed=False, slack=0.4, spacing=1.0)
    assert way.points[[0, -1]].tolist() == [[0, 0], [20, 20]]


def test_a_closed_course_turns_once_around_and_ends_where_it_began():
    way = course(SQUARE, closed=True, slack=0.4, spacing=1.0)
    assert way.points[0].tolist() == way.points[-1].tolist()
    assert way.heading[-1] - way.heading[0] == pytest.approx(2 * np.pi)


def test_a_circle_of_chords_has_the_curvature_of_the_circle():
    angle = np.linspace(0, 2 * np.pi, 64, endpoint=False)
    ring = 45 * np.column_stack([np.cos(angle), np.sin(angle)])
    way = course(ring, closed=True, slack=0.3, spacing=1.0)
    assert way.curvature == pytest.approx(1 / 45, rel=0.02)


def test_the_heading_is_the_tangent_and_turned_input_turns_it():
    turn = np.array([[0.0, 1.0], [-1.0, 0.0]])
    way = course(BEND, closed=False, slack=0.4, spacing=1.0)
    other = course(np.array(BEND, float) @ turn, closed=False, slack=0.4, spacing=1.0)
    assert way.heading[[0, -1]] == pytest.approx([0, np.pi / 2])
    assert other.heading - way.heading == pytest.approx(np.pi / 2)
    assert np.abs(np.diff(way.heading)).max() < np.radians(10)


def test_the_pace_is_the_one_asked_for_but_in_bends_and_near_them():
    way = course(BEND, closed=False, slack=0.4, spacing=0.5)
    speed = paces(way, 4.0, sideways=2.0, pull=1.5)
    assert speed[[0, -1]].tolist() == [4.0, 4.0]
    assert (speed**2 * way.curvature).max() <= 2.0 + 1e-9
    pull = np.abs(np.diff(speed**2)) / (2 * np.diff(way.along))
    assert pull.max() <= 1.5 + 1e-9


def test_times_are_those_of_the_speeds():
    way = course([(0, 0), (30, 0)], closed=False, slack=0.4, spacing=1.0)
    assert times(way, np.full(len(way.along), 3.0))[-1] == pytest.approx(10.0)


def test_a_path_of_one_place_is_no_course():
    with pytest.raises(ValueError, match="two points"):
        course([(1, 1), (1, 1)], closed=False, slack=0.3, spacing=1.0)
