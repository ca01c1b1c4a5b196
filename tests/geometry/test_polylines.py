import numpy as np
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from cityx.geometry.polylines import (
    arc_lengths,
    bends,
    every,
    line_strips,
    locate,
    nearest_on,
    pack,
    pieces,
    segment_bounds,
    to_linestrings,
)

CORNER = pack(
    [shapely.LineString([(0, 0), (10, 0), (10, 5)]), shapely.LineString([(0, 9), (4, 9)])]
)


def test_lengths_are_measured_line_by_line():
    along, length = arc_lengths(CORNER)
    assert along.tolist() == [0, 10, 15, 0, 4]
    assert length.tolist() == [15, 4]


def test_a_position_behind_the_end_is_the_end():
    position, direction = locate(CORNER, [0, 0, 1], [12, 99, -1])
    assert position.tolist() == [[10, 2], [10, 5], [0, 9]]
    assert direction.tolist() == [[0, 1], [0, 1], [1, 0]]


def test_a_piece_keeps_the_corner_between_its_ends():
    cut = pieces(CORNER, [0, 1], [8, 1], [12, 2])
    assert to_linestrings(cut)[0].equals(shapely.LineString([(8, 0), (10, 0), (10, 2)]))
    assert to_linestrings(cut)[1].equals(shapely.LineString([(1, 9), (2, 9)]))


def test_marks_are_centred_and_keep_the_margin():
    line, along = every([10.0, 1.0], 3.0, 1.0)
    assert line.tolist() == [0, 0, 0]
    assert along.tolist() == [2, 5, 8]


def test_the_nearest_place_is_told_by_line_and_way():
    places = shapely.points([[11.0, -1.0], [3.0, 7.0], [50.0, 50.0], [6.0, 3.0], [2.0, 4.5]])
    place, line, along = nearest_on(CORNER, places, 4.5)
    assert place.tolist() == [0, 1, 3, 4]
    assert line.tolist() == [0, 1, 0, 0]  # the last is as near to both
    assert along.tolist() == [10.0, 3.0, 6.0, 2.0]


def test_bounds_of_segments_come_line_by_line():
    assert segment_bounds(to_linestrings(CORNER)).tolist() == [
        [0, 0, 10, 0], [10, 0, 10, 5], [0, 9, 4, 9]
    ]  # fmt: skip


def test_a_strip_keeps_its_width_round_a_corner():
    strip = line_strips(CORNER, np.array([0.0, 0.0]), 1.0)
    assert np.isclose(strip[0].area, 15.0)
    assert strip[0].is_valid


@settings(max_examples=40, deadline=None, derandomize=True)
@given(st.lists(st.tuples(st.integers(-50, 50), st.integers(-50, 50)), min_size=2, max_size=8,
                unique=True))  # fmt: skip
def test_pieces_of_a_line_add_up_to_it(points):
    lines = pack([shapely.LineString(points)])
    length = arc_lengths(lines)[1]
    cut = pieces(lines, [0, 0], [0.0, length[0] / 3], [length[0] / 3, length[0]])
    assert np.isclose(arc_lengths(cut)[1].sum(), length[0], atol=0.05)


def test_values_bend_where_their_grade_changes_and_at_the_ends():
    lines = pack(
        [
            shapely.LineString([(x, 0) for x in range(5)]),
            shapely.LineString([(0, y) for y in range(3)]),
        ]
    )
    rising = [0.0, 0.1, 0.2, 0.2, 0.2, 5.0, 6.0, 7.0]
    assert bends(lines, rising, 0.01).tolist() == [
        True, False, True, False, True, True, False, True
    ]  # fmt: skip
    assert np.flatnonzero(bends(lines, rising, 0.2)).tolist() == [0, 4, 5, 7]
