import numpy as np
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from cityx.geometry.snap_rounding import FINE, snap_round


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
