import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from cityx.geometry import noding
from cityx.geometry.noding import FINE, join_ends, node_lines, places, snap_round, with_points


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


def rounded(*lines):
    ends = np.array(lines, float).reshape(-1, 2, 2)
    spots = np.rint(ends * FINE).astype(np.int64)
    return snap_round(spots[:, 0], spots[:, 1])


def edges_of(points, edges):
    return {tuple(map(tuple, points[pair].tolist())) for pair in edges}


def test_segments_that_cross_meet_in_the_nearest_grid_point():
    points, edges = rounded([(0, 0), (10, 9)], [(0, 9), (10, 0)])
    assert [5, 4] in points.tolist() or [5, 5] in points.tolist()
    assert len(points) == 5
    assert len(edges) == 4


def test_a_segment_is_led_through_an_end_that_lies_on_it():
    assert edges_of(*rounded([(0, 0), (10, 0)], [(4, 0.3), (4, 7)])) == {
        ((0, 0), (4, 0)), ((4, 0), (10, 0)), ((4, 0), (4, 7)),
    }  # fmt: skip


def test_what_runs_abreast_within_half_a_step_is_one_edge():
    assert edges_of(*rounded([(0, 0), (20, 7)], [(0, 0.2), (20, 7.2)])) == {((0, 0), (20, 7))}


def test_what_has_no_length_leaves_nothing():
    points, edges = rounded([(3.1, 4.2), (2.9, 3.8)])
    assert len(points) == len(edges) == 0


def test_the_order_and_direction_of_segments_do_not_show():
    rng = np.random.default_rng(3)
    lines = rng.uniform(0, 50, (30, 2, 2))
    one, other = rounded(*lines), rounded(*lines[::-1, ::-1])
    assert np.array_equal(one[0], other[0])
    assert np.array_equal(one[1], other[1])


def test_a_long_slanting_segment_meets_what_its_pieces_are_near():
    lines = [[(0, 0), (9000, 7000)]]
    lines += [[(9 * k, 7 * k - 40), (9 * k, 7 * k + 40)] for k in range(50, 1000, 50)]
    points, edges = rounded(*lines)
    assert len(edges) == 20 + 2 * 19
    assert [4500, 3500] in points.tolist()


spot = st.tuples(st.floats(0, 40), st.floats(0, 40))


@settings(max_examples=60, deadline=None, derandomize=True)
@given(st.lists(st.tuples(spot, spot), min_size=1, max_size=25))
def test_edges_meet_at_their_ends_alone(lines):
    points, edges = rounded(*lines)
    if not len(edges):
        return
    shapes = shapely.linestrings(points[edges].astype(float))
    one, other = shapely.STRtree(shapes).query(shapes, predicate="intersects")
    one, other = one[one < other], other[one < other]
    shared = (edges[one][:, :, None] == edges[other][:, None, :]).any(axis=(1, 2))
    assert shared.all()
    assert shapely.touches(shapes[one], shapes[other]).all()
    # No line is led further than a point's square is wide from where it was.
    given_ = shapely.union_all(shapely.linestrings(np.array(lines)))
    assert shapely.distance(given_, shapely.points(points.astype(float))).max() < 0.71


@pytest.mark.parametrize("seed", range(8))
def test_kernels_find_what_search_trees_do(seed, monkeypatch):
    rng = np.random.default_rng(seed)
    reach = 10.0 ** (1 + seed / 2)
    begin = rng.uniform(-reach, reach, (120, 2))
    spots = np.rint(np.stack([begin, begin + rng.normal(0, reach / 4, (120, 2))]) * FINE)
    spots[:, ::3] = spots[:, ::3] // FINE * FINE + FINE // 2  # on the sides of squares
    spots[1, ::5, 0] = spots[0, ::5, 0]  # upright
    first, second = spots.astype(np.int64)
    several = []
    for many in (len(begin) + 1, 0):
        monkeypatch.setattr(noding, "MANY", many)
        several.append(snap_round(first, second))
    for one, other in zip(*several, strict=True):
        assert np.array_equal(one, other)


@pytest.mark.parametrize("angle", [0.0, 0.4, 2.1])
@pytest.mark.parametrize("size", [3000, 11_000])
def test_no_segment_of_a_ring_is_lost_whose_corner_lies_on_the_side_of_a_square(angle, size):
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    rng = np.random.default_rng(size)
    for _ in range(40):
        corners = np.rint(rng.uniform(0.2, 1.0, (4, 1)) * [[1, 0], [0, 1], [-1, 0], [0, -1]]
                          @ turn * size) - 0.5  # fmt: skip
        spots = (corners * FINE).astype(np.int64)
        _, edges = snap_round(spots, np.roll(spots, -1, axis=0))
        assert len(edges) == 4


@pytest.mark.parametrize("far", [(0, 0), (2**33, 2**34), (-(2**33), 2**34)])
def test_places_are_numbered_wherever_they_lie(far):
    near = np.array([[3, 1], [0, 5], [3, 1], [0, 4]])
    distinct, number = places(near + np.array(far))
    assert (distinct - np.array(far)).tolist() == [[0, 4], [0, 5], [3, 1]]
    assert number.tolist() == [2, 1, 2, 0]
