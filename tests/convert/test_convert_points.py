import math

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from cityx.convert.points import (
    point_to_face_conversion,
    point_to_layout_conversion,
    point_to_line_conversion,
)
from cityx.protocol.values import make_points

quick = settings(max_examples=40, deadline=None, derandomize=True)
CELLS = st.sets(st.tuples(st.integers(-8, 8), st.integers(-8, 8)), min_size=1, max_size=60)


@quick
@given(cells=CELLS, spacing=st.sampled_from([0.5, 1.0, 3.0]))
def test_faces_of_grid_points_have_exactly_their_area_and_hold_them(cells, spacing):
    xy = np.array(sorted(cells)) * spacing
    faces = point_to_face_conversion(make_points(xy, "park"), spacing=spacing)
    assert shapely.area(faces.geometry).sum() == pytest.approx(len(cells) * spacing**2)
    assert shapely.is_valid(faces.geometry).all()
    assert set(faces.kind) == {"park"}
    held = shapely.contains_xy(shapely.union_all(faces.geometry), xy)
    assert held.all()


@quick
@given(cells=CELLS, seed=st.integers(0, 99))
def test_faces_do_not_depend_on_the_order_of_points(cells, seed):
    xy = np.array(sorted(cells), float)
    kinds = np.where(xy.sum(axis=1) % 2 == 0, "a", "b")
    order = np.random.default_rng(seed).permutation(len(xy))
    first = point_to_face_conversion(make_points(xy, kinds.tolist()))
    second = point_to_face_conversion(make_points(xy[order], kinds[order].tolist()))
    assert shapely.to_wkt(first.geometry).tolist() == shapely.to_wkt(second.geometry).tolist()
    assert first.kind.tolist() == second.kind.tolist()


def test_classes_stay_apart_and_never_overlap():
    xy = [[0, 0], [1, 0], [2, 0], [3, 0]]
    faces = point_to_face_conversion(make_points(xy, ["building", "building", "park", "park"]))
    assert faces.kind.tolist() == ["building", "park"]
    assert shapely.area(faces.geometry).tolist() == [2.0, 2.0]
    assert shapely.intersection(*faces.geometry).area == 0


def test_cells_that_touch_at_a_corner_stay_apart():
    assert point_to_face_conversion(make_points([[0, 0], [1, 1]])).count == 2


@quick
@given(
    st.lists(
        st.tuples(st.floats(-100, 100), st.floats(-100, 100)), min_size=2, max_size=20, unique=True
    )
)
def test_a_line_has_the_points_of_its_group_in_order(places):
    xy = np.array(places)
    lines = point_to_line_conversion(make_points(xy, "path", 4))
    assert lines.count == 1
    assert np.array_equal(shapely.get_coordinates(lines.geometry), xy)


def test_groups_become_lines_and_lone_points_none():
    points = make_points([[0, 0], [9, 9], [1, 0], [5, 5], [2, 0], [6, 6]], "", [1, 2, 1, 3, 1, 3])
    lines = point_to_line_conversion(points)
    assert lines.count == 2
    assert shapely.length(lines.geometry).tolist() == pytest.approx([2.0, math.sqrt(2)])


def test_things_become_rows_and_unknown_classes_are_left_out():
    layout = point_to_layout_conversion(
        make_points([[0, 0], [1, 0], [0, 0]], ["tree", "x", "tree"])
    )
    assert layout.points["kind"].tolist() == ["tree"]


def test_nothing_becomes_nothing():
    none = make_points(np.zeros((0, 3)))
    assert point_to_face_conversion(none).count == 0
    assert point_to_line_conversion(none).count == 0
    assert len(point_to_layout_conversion(none).points) == 0
