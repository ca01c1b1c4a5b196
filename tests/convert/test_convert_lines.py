import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from cityx.convert.lines import (
    line_to_face_conversion,
    line_to_layout_conversion,
    line_to_point_conversion,
)
from cityx.convert.points import point_to_line_conversion
from cityx.protocol.values import make_lines

quick = settings(max_examples=40, deadline=None, derandomize=True)


@quick
@given(
    angle=st.floats(0, 6.28), length=st.floats(1, 500), width=st.floats(0.1, 30),
)  # fmt: skip
def test_the_band_of_a_straight_line_has_its_length_times_its_width(angle, length, width):
    end = length * np.array([np.sin(angle), np.cos(angle)])
    faces = line_to_face_conversion(make_lines([shapely.LineString([(0, 0), end])], "road", width))
    assert shapely.area(faces.geometry[0]) == pytest.approx(length * width, rel=1e-6)
    assert faces.kind.tolist() == ["road"]


def test_a_width_of_its_own_goes_before_the_default():
    lines = make_lines([shapely.LineString([(0, 0), (10, 0)])] * 2, "", [np.nan, 2.0], [7, 8])
    faces = line_to_face_conversion(lines, width=4.0)
    assert shapely.area(faces.geometry).tolist() == pytest.approx([40.0, 20.0])
    assert faces.object_id.tolist() == [7, 8]


def test_the_band_lies_within_half_the_width_of_the_line():
    line = shapely.LineString([(0, 0), (50, 0), (60, 40), (20, 70)])
    (band,) = line_to_face_conversion(make_lines([line]), width=6.0).geometry
    assert line.buffer(3.001).contains(band)


def test_lines_and_points_are_inverse():
    shapes = [shapely.LineString([(0, 0), (1, 2), (5, 5)]), shapely.LineString([(9, 9), (8, 1)])]
    points = line_to_point_conversion(make_lines(shapes, ["a", "b"]))
    again = point_to_line_conversion(points)
    assert again.geometry.tolist() == shapes
    assert again.kind.tolist() == ["a", "b"]


def test_barriers_and_roads_go_into_their_tables():
    line = shapely.LineString([(0, 0), (30, 0)])
    layout = line_to_layout_conversion(make_lines([line] * 3, ["fence", "", "primary"], [1, 3, 13]))
    assert layout.lines["kind"].tolist() == ["fence"]
    assert sorted(layout.roads["kind"]) == ["primary", "residential"]
    assert sorted(layout.roads["lanes"]) == [1, 4]
    assert layout.roads["id"].is_unique
