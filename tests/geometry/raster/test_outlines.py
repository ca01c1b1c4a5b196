import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from rasterio.features import rasterize
from scipy import ndimage
from shapely import affinity

from cityx.geometry.raster.mask_outlines import outlines

HOUSE = shapely.box(0, 0, 40, 24)
ANGLE = shapely.union(shapely.box(0, 0, 60, 20), shapely.box(0, 0, 22, 50))
COURT = shapely.difference(shapely.box(0, 0, 60, 50), shapely.box(18, 16, 42, 34))


def drawn(shape, size=100):
    return rasterize([shape], (size, size), dtype=np.uint8)


def regular(mask, jog=3.2):
    return outlines(ndimage.label(mask)[0], jog=jog)[0]


def iou(one, other):
    return shapely.intersection(one, other).area / shapely.union(one, other).area


def bends(polygon):
    return sum(len(ring.coords) - 1 for ring in [polygon.exterior, *polygon.interiors])


@pytest.mark.parametrize("degrees", [0, 7, 20, 33, 45, 61])
@pytest.mark.parametrize(("shape", "corners"), [(HOUSE, 4), (ANGLE, 6), (COURT, 8)])
def test_a_turned_house_gets_its_walls_and_corners_back(shape, corners, degrees):
    truth = affinity.translate(affinity.rotate(shape, degrees), 30.3, 24.7)
    (found,) = regular(drawn(truth, 130))
    assert bends(found) == corners
    assert iou(found, truth) > 0.95


def test_there_is_no_shift_of_half_a_pixel():
    truth = affinity.translate(affinity.rotate(HOUSE, 20), 30.25, 40.5)
    (found,) = regular(drawn(truth))
    assert np.hypot(*np.subtract(found.centroid.coords[0], truth.centroid.coords[0])) < 0.12


def test_short_jogs_go_and_long_ones_stay():
    jagged = shapely.union(HOUSE, shapely.box(10, 24, 20, 26))
    (found,) = regular(drawn(affinity.translate(jagged, 20, 20)))
    assert bends(found) == 4
    winged = shapely.union(HOUSE, shapely.box(10, 24, 20, 34))
    (found,) = regular(drawn(affinity.translate(winged, 20, 20)))
    assert bends(found) == 8


def test_a_round_tank_is_no_square():
    disc = shapely.Point(50, 50).buffer(30)
    (found,) = regular(drawn(disc))
    assert iou(found, disc) > 0.9


def test_no_label_gives_no_outline():
    found, exact = outlines(np.zeros((5, 5), int), jog=3)
    assert len(found) == len(exact) == 0


def test_a_turned_raster_gives_turned_outlines():
    mask = drawn(affinity.translate(affinity.rotate(ANGLE, 12), 20, 20))
    (one,) = regular(mask)
    (other,) = regular(np.rot90(mask))
    back = affinity.rotate(other, 90, origin=(0, 0))
    assert iou(affinity.translate(back, 100, 0), one) > 0.97


@given(st.integers(0, 2**32 - 1), st.integers(4, 40), st.floats(0.5, 6.0), st.floats(0, 8))
@settings(max_examples=150, deadline=None)
def test_any_mask_gives_valid_outlines_that_fit(seed, size, grain, jog):
    noise = np.random.default_rng(seed).normal(size=(size, size + 3))
    mask = ndimage.gaussian_filter(noise, grain) > 0
    labels, count = ndimage.label(mask)
    found, exact = outlines(labels, jog=jog)
    assert len(found) == len(exact) == count
    assert shapely.is_valid(found).all()
    areas = np.bincount(labels.ravel())[1:]
    assert np.allclose(shapely.area(exact), areas)
    shared = shapely.area(shapely.intersection(found, exact))
    assert (shared > 0.5 * areas).all()
