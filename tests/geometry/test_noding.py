import numpy as np
import shapely

from cityx.geometry.noding import join_ends, node_lines, with_points


def lines(*curves):
    return np.array([shapely.LineString(points) for points in curves], object)


def test_lines_that_cross_share_a_point_to_the_last_bit():
    old, new = lines([(0, 0), (10, 3)], [(4, -5), (5.1, 8)])
    noded = node_lines([old, new], [0, 0], [True, False])
    first, second = (set(line.coords) for line in noded)
    (shared,) = first & second
    assert shapely.Point(shared).distance(old) < 1e-3


def test_lines_of_different_levels_and_old_ones_stay_as_they_are():
    given = lines([(0, 0), (10, 0)], [(5, -5), (5, 5)], [(7, -5), (7, 5)])
    noded = node_lines(given, [0, 0, 1], [True, True, False])
    assert [a.equals(b) for a, b in zip(given, noded, strict=True)] == [True] * 3


def test_three_lines_meet_in_one_point():
    given = lines([(-9, 0), (9, 0)], [(-7, -7.001), (7, 7)], [(-7, 7), (7, -7.002)])
    noded = node_lines(given, [0, 0, 0], [True, False, False])
    assert len(set.intersection(*(set(line.coords) for line in noded))) == 1


def test_a_crossing_near_a_point_of_the_older_line_is_that_point():
    noded = node_lines(lines([(0, 0), (5, 0), (9, 0)], [(5.02, -3), (5.02, 3)]), [0, 0], [1, 0])
    assert (5.0, 0.0) in noded[1].coords
    assert len(noded[0].coords) == 3


def test_points_are_inserted_in_order_along_a_closed_line():
    ring = lines([(0, 0), (10, 0), (10, 10), (0, 10), (0, 0)])
    found = with_points(ring, [0, 0, 0], [(0, 5), (4, 0), (0, 0)])[0]
    assert list(found.coords) == [(0, 0), (4, 0), (10, 0), (10, 10), (0, 10), (0, 5), (0, 0)]


def test_ends_are_led_to_what_they_all_but_reach_and_cut_off_beyond_it():
    street, before, beyond = lines([(-50, 0), (50, 0)], [(0, -30), (0, -3)], [(9, -30), (9, 2)])
    joined = join_ends([street, before, beyond], [0, 1, 2], [5, 5, 5], [False, True, True])
    assert list(joined[0].coords) == [(-50, 0), (0, 0), (9, 0), (50, 0)]
    assert [line.coords[-1] for line in joined[1:]] == [(0, 0), (9, 0)]


def test_a_line_between_two_streets_so_near_that_nothing_is_left_stays():
    given = lines([(-50, 0), (50, 0)], [(0, 1), (0, 2.5)])
    joined = join_ends(given, [0, 1], [5, 5], [False, True])
    assert joined[1].length > 0
