import numpy as np
import shapely
from hypothesis import given
from hypothesis import strategies as st

from cityx.geometry.raster.grid import Grid

GRID = Grid(rows=20, columns=30, pixel=0.5, west=-7.5, north=5.0)


def test_the_corner_of_the_first_pixel_is_the_north_west_corner():
    assert GRID.to_metres([[0, 0]]).tolist() == [[-7.5, 5.0]]
    assert GRID.to_metres([[30, 20]]).tolist() == [[7.5, -5.0]]
    assert GRID.extent == (-7.5, -5.0, 7.5, 5.0)


def test_the_middle_of_a_pixel_lies_half_a_pixel_in():
    assert GRID.to_metres([[0.5, 0.5]]).tolist() == [[-7.25, 4.75]]
    assert Grid.about_origin(20, 30, 0.5) == GRID


@given(st.floats(-100, 100), st.floats(-100, 100))
def test_metres_and_pixels_are_inverse(x, y):
    assert np.allclose(GRID.to_metres(GRID.to_pixels([[x, y]])), [[x, y]], atol=1e-9)


def test_values_are_those_of_the_pixel_below():
    raster = np.arange(600).reshape(20, 30)
    inside = GRID.to_metres([[3.9, 2.1], [29.5, 19.5]])
    assert GRID.values_at(raster, inside).tolist() == [63, 599]
    assert GRID.values_at(raster, [[-99, 99], [99, -99]]).tolist() == [0, 599]


def test_shapes_keep_their_size():
    shape = GRID.shapes_to_metres([shapely.box(2, 3, 12, 7)])[0]
    assert shape.area == 10 * 4 * 0.25
    assert shape.bounds == (-6.5, 1.5, -1.5, 3.5)


def test_polygons_with_holes_are_drawn_as_shapes_are():
    ring = shapely.difference(shapely.Point(0, 0).buffer(3.1), shapely.Point(0.4, 0).buffer(1.2))
    for shape in (ring, shapely.box(-6, -4, -4.3, 2)):
        several = shapely.multipolygons([shape])  # drawn by what it tells of itself
        assert (GRID.touched(np.array([shape])) == GRID.touched(np.array([several]))).all()
        assert (GRID.numbered(np.array([shape])) == GRID.numbered(np.array([several]))).all()


def test_shapes_of_rasters_are_not_asked_for_their_points_one_by_one(monkeypatch):
    asked = []
    monkeypatch.setattr(shapely.Polygon, "__geo_interface__", property(asked.append))
    assert GRID.touched(np.array([shapely.box(-6, -4, -4.3, 2)])).any()
    assert not asked
