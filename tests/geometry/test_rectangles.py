import numpy as np
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from shapely.affinity import rotate, translate

from cityx.geometry.rectangles import inner_rectangles, rectangles_of


@settings(max_examples=50, deadline=None, derandomize=True)
@given(st.floats(1, 80), st.floats(1, 80), st.floats(0, 179.9), st.floats(-500, 500))
def test_a_turned_rectangle_is_found_again(a, b, turn, shift):
    shape = translate(rotate(shapely.box(0, 0, a, b), turn), shift, -shift)
    box = rectangles_of([shape])
    assert np.allclose([box.length[0], box.width[0]], [max(a, b), min(a, b)], atol=1e-6)
    assert np.allclose(box.centre[0], shapely.get_coordinates(shape.centroid)[0], atol=1e-6)
    if abs(a - b) > 0.01:
        long_side = np.radians(turn if a > b else turn + 90)
        assert abs(np.sin(box.angle[0] - long_side)) < 1e-6


def test_an_empty_outline_has_no_rectangle():
    assert np.isnan(rectangles_of([shapely.Polygon()]).length[0])


def test_the_inner_rectangle_lies_inside_and_is_large():
    shape = shapely.box(0, 0, 20, 12).difference(shapely.box(16, 0, 20, 6))
    centre, size = inner_rectangles(
        np.array([shape], object), np.array([[10.0, 6.0]]), np.array([[1.0, 0.0]]),
        np.array([[20.0, 12.0]]),
    )  # fmt: skip
    low, high = centre[0] - size[0] / 2, centre[0] + size[0] / 2
    inner = shapely.box(*low, *high)
    assert inner.difference(shape.buffer(0.01)).area < 0.05 * shape.area
    assert inner.area > 0.85 * 16 * 12
