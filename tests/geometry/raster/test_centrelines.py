import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from rasterio.features import rasterize
from scipy import ndimage
from shapely import affinity

from cityx.geometry.raster.centrelines import centrelines

CROSS = [((-80, 0), (80, 0)), ((0, -80), (0, 80))]
TEE = [((-80, 0), (80, 0)), ((0, 0), (0, 80))]


def street_mask(lines, width, size=240, degrees=0.0):
    drawn = affinity.rotate(shapely.MultiLineString(lines), degrees, origin=(0, 0))
    drawn = affinity.translate(drawn, size / 2 + 0.3, size / 2 + 0.2)
    shape = shapely.buffer(drawn, width / 2, cap_style="flat")
    return rasterize([shape], (size, size), dtype=np.uint8).astype(bool), drawn


def degrees_of(lines):
    ends = np.concatenate([shapely.get_coordinates(shapely.get_point(lines, i)) for i in (0, -1)])
    return np.sort(np.unique(ends, axis=0, return_counts=True)[1])[::-1]


@pytest.mark.parametrize("turn", [0, 17, 45])
@pytest.mark.parametrize("width", [7, 12, 19])
@pytest.mark.parametrize(("network", "arms"), [(CROSS, 4), (TEE, 3)])
def test_a_crossing_has_its_arms_its_place_and_their_width(network, arms, width, turn):
    mask, truth = street_mask(network, width, degrees=turn)
    found = centrelines(mask, tolerance=1.0)
    assert len(found.lines) == arms
    assert degrees_of(found.lines).tolist() == [arms] + [1] * arms
    assert np.allclose(found.width, width, atol=1.3)
    assert shapely.hausdorff_distance(shapely.union_all(found.lines), truth) < 2.5
    near = shapely.buffer(truth, 1.5)
    assert shapely.union_all(found.lines).difference(near).length < 4


def test_two_crossings_far_apart_stay_two_and_near_ones_are_one():
    far = [((-80, 0), (80, 0)), ((-30, 0), (-30, 80)), ((30, 0), (30, -80))]
    assert degrees_of(centrelines(street_mask(far, 9)[0], tolerance=1).lines)[:3].tolist() == [
        3,
        3,
        1,
    ]
    near = [((-80, 0), (80, 0)), ((-2, 0), (-2, 80)), ((2, 0), (2, -80))]
    assert degrees_of(centrelines(street_mask(near, 9)[0], tolerance=1).lines)[:2].tolist() == [
        4,
        1,
    ]


def test_a_bump_is_no_side_street():
    mask, _ = street_mask([((-80, 0), (80, 0))], 10)
    mask[124:129, 100:106] = True
    assert len(centrelines(mask, tolerance=1).lines) == 1


def test_a_ring_is_one_closed_line():
    ring = shapely.Point(120.5, 120.5).buffer(60).exterior.buffer(5)
    mask = rasterize([ring], (240, 240), dtype=np.uint8).astype(bool)
    (line,) = centrelines(mask, tolerance=0.5).lines
    assert line.is_closed
    assert abs(line.length - 2 * np.pi * 60) < 8


def test_no_street_gives_no_line():
    assert len(centrelines(np.zeros((20, 20), bool), tolerance=1).lines) == 0


@given(st.integers(0, 2**32 - 1), st.floats(1, 5), st.floats(0, 1))
@settings(max_examples=60, deadline=None)
def test_any_mask_gives_sound_lines_within_it(seed, grain, level):
    noise = np.random.default_rng(seed).normal(size=(60, 70))
    smooth = ndimage.gaussian_filter(noise, grain)
    mask = smooth > level * smooth.std()
    found = centrelines(mask, tolerance=0.5)
    again = centrelines(mask.copy(), tolerance=0.5)
    assert len(found.lines) == len(found.width)
    assert shapely.equals_exact(found.lines, again.lines).all()
    assert (shapely.length(found.lines) > 0).all()
    assert (found.width > 0).all()
    bounds = shapely.total_bounds(found.lines) if len(found.lines) else np.array([0, 0, 1, 1])
    assert (bounds[:2] > -8).all()
    assert (bounds[2:] < 78).all()


def test_a_short_drive_is_a_street_and_a_ragged_border_is_none():
    mask = np.zeros((120, 200), bool)
    mask[50:66] = True  # a street of 16 pixels
    mask[38:50, 97:103] = True  # a drive of 6 that leaves it by 12
    ragged = mask.copy()
    ragged[47:50, 40:60] = ragged[66:68, 130:140] = True  # bumps as flat as they are long
    ragged[38:50, 97:103] = False
    assert len(centrelines(mask, tolerance=1.0).lines) == 3
    assert len(centrelines(ragged, tolerance=1.0).lines) == 1


def test_a_street_that_ends_squarely_has_no_branches_into_its_corners():
    mask = np.zeros((120, 200), bool)
    mask[45:75, 20:180] = True
    (line,) = centrelines(mask, tolerance=1.0).lines
    assert abs(line.length - 160.0) < 12.0
