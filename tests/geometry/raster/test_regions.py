import numpy as np
import shapely
from hypothesis import example, given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from scipy import ndimage

from cityx.geometry.raster.patches import label_patches
from cityx.geometry.raster.regions import filled, parted, regions, without_small_patches
from cityx.geometry.raster.rows import Plots, cut_into_houses


def blobs(seed, count=4, size=60, grain=5.0):
    noise = np.random.default_rng(seed).normal(size=(count, size, size + 9))
    return ndimage.gaussian_filter(noise, (0, grain, grain)).argmax(axis=0)


def check_partition(shapes, labels):
    assert shapely.is_valid(shapes).all()
    assert abs(shapely.area(shapes).sum() - labels.size) < 1e-6 * labels.size
    assert abs(shapely.union_all(shapes).area - labels.size) < 1e-6 * labels.size
    assert shapely.coverage_is_valid(shapes)


@given(st.integers(0, 2**32 - 1), st.floats(0.5, 4), st.floats(0, 2))
@settings(max_examples=60, deadline=None)
def test_regions_cover_the_raster_once(seed, smooth, tolerance):
    labels = without_small_patches(blobs(seed), 20)
    shapes, label = regions(labels, smooth=smooth, tolerance=tolerance)
    check_partition(shapes, labels)
    assert set(label) <= set(np.unique(labels))


@given(arrays(np.int64, (9, 11), elements=st.integers(0, 3)))
@settings(max_examples=60, deadline=None)
def test_noise_is_covered_once_too(labels):
    shapes, _ = regions(labels, smooth=1.5, tolerance=0.4)
    check_partition(shapes, labels)


def test_smoothing_takes_stairs_and_keeps_areas():
    y, x = np.mgrid[:80, :100]
    labels = (x + 2 * y > 130).astype(int)
    shapes, label = regions(labels, smooth=2, tolerance=0.5)
    assert shapely.get_num_coordinates(shapes).max() < 12
    for word in (0, 1):
        assert abs(shapely.area(shapes[label == word]).sum() - (labels == word).sum()) < 30


def test_small_patches_join_their_surroundings():
    labels = np.zeros((20, 20), int)
    labels[5:8, 5:8], labels[10:20, 10:20] = 1, 2
    assert np.unique(without_small_patches(labels, 30)).tolist() == [0, 2]


def test_unknown_pixels_take_the_nearest_label():
    labels = np.array([[1, 0, 0, 0, 2]])
    assert filled(labels, labels == 0).tolist() == [[1, 1, 1, 2, 2]] or filled(
        labels, labels == 0
    ).tolist() == [[1, 1, 2, 2, 2]]
    assert filled(labels, np.ones_like(labels, bool)).tolist() == labels.tolist()


def test_neighbours_share_one_straight_wall():
    parts = np.zeros((40, 60), int)
    parts[10:30, 10:30], parts[10:30, 30:50] = 1, 2
    bodies = (parts > 0).astype(int)
    house = shapely.box(10, 10, 50, 30)
    shapes, number = parted(np.array([house], object), bodies, parts)
    assert number.tolist() == [1, 2]
    assert shapely.area(shapes).tolist() == [400, 400]
    assert shapely.intersection(*shapes).equals(shapely.LineString([(30, 10), (30, 30)]))


@given(st.integers(0, 2**32 - 1))
@settings(max_examples=40, deadline=None)
@example(176510)
def test_parts_fill_their_bodies_without_overlap(seed):
    labels = blobs(seed, count=3)
    mask = ndimage.gaussian_filter(np.random.default_rng(seed).normal(size=labels.shape), 6) > 0
    bodies, _ = label_patches(mask)
    from skimage.measure import label

    parts = label(np.where(mask, bodies * 4 + labels, 0), background=0, connectivity=1)
    from cityx.geometry.raster.mask_outlines import outlines

    outer, _ = outlines(bodies, jog=2)
    shapes, number = parted(outer, bodies, parts)
    assert (np.diff(number) >= 0).all()
    assert shapely.is_valid(shapes).all()
    joined = shapely.union_all(shapes).area
    # Straightened outlines of two bodies may share a corner; cutting them adds nothing to that.
    shared = shapely.area(outer).sum() - shapely.union_all(outer).area
    assert abs(shapely.area(shapes).sum() - joined - shared) < 1e-3 * max(joined, 1)
    assert joined > 0.9 * shapely.union_all(outer).area


def test_a_row_is_cut_into_houses_with_gaps():
    mask = np.zeros((60, 260), bool)
    mask[20:40, 10:250] = True
    labels, _ = label_patches(mask)
    houses = cut_into_houses(labels, np.array([1]), Plots(24.0, 22.0, 4.0))
    _, count = label_patches(houses)
    assert 9 <= count <= 11
    assert not (houses & ~mask).any()
    assert (cut_into_houses(labels, np.zeros(0, int), Plots(24.0, 22.0, 4.0)) == mask).all()


def test_a_deep_row_has_houses_back_to_back():
    mask = np.zeros((90, 260), bool)
    mask[20:70, 10:250] = True
    labels, _ = label_patches(mask)
    houses = cut_into_houses(labels, np.array([1]), Plots(24.0, 22.0, 4.0))
    assert 16 <= label_patches(houses)[1] <= 24
