import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from cityx.geometry.raster.patches import (
    depth,
    label_patches,
    split_at_necks,
    without_holes,
    without_specks,
)

MASKS = arrays(bool, st.tuples(st.integers(1, 12), st.integers(1, 12)))


def test_specks_go_and_houses_stay():
    mask = np.zeros((10, 12), bool)
    mask[1:4, 1:5] = mask[8, 8:10] = True
    assert without_specks(mask, 3).sum() == 12


def test_pinholes_are_filled_but_slanting_gaps_stay():
    mask = np.ones((9, 9), bool)
    mask[4, 4] = False
    assert without_holes(mask, 3).all()
    slanting = ~np.eye(9, dtype=bool)
    assert (without_holes(slanting, 3) == slanting).all()


@pytest.mark.parametrize("width", [1, 2, 3, 8, 9])
def test_the_depth_of_a_strip_is_half_its_width(width):
    mask = np.zeros((30, 40), bool)
    mask[10 : 10 + width] = True
    assert abs(depth(mask)[:, 20].max() - width / 2) <= 0.5


def test_two_bodies_at_a_neck_are_parted_and_an_angle_is_not():
    mask = np.zeros((60, 60), bool)
    mask[5:25, 5:25] = mask[30:55, 5:35] = mask[25:30, 12:15] = True
    parts = split_at_necks(label_patches(mask)[0], np.array([0.6]))
    assert len(np.unique(parts[mask])) == 2
    angle = np.zeros((60, 60), bool)
    angle[5:55, 5:20] = angle[40:55, 5:55] = True
    assert split_at_necks(label_patches(angle)[0], np.array([0.6])).max() == 1


@given(MASKS, st.integers(1, 30))
@settings(max_examples=150, deadline=None)
def test_cleaning_only_takes_specks_and_only_fills_holes(mask, least):
    kept, full = without_specks(mask, least), without_holes(mask, least)
    assert not (kept & ~mask).any()
    assert not (mask & ~full).any()
    sizes = np.bincount(label_patches(kept)[0].ravel())[1:]
    assert (sizes >= least).all()


@given(st.integers(0, 2**32 - 1))
@settings(max_examples=40, deadline=None)
def test_parting_keeps_every_pixel(seed):
    from scipy import ndimage

    noise = np.random.default_rng(seed).normal(size=(50, 60))
    labels, count = label_patches(ndimage.gaussian_filter(noise, 3) > 0)
    parts = split_at_necks(labels, np.zeros(count))
    assert ((parts > 0) == (labels > 0)).all()
    for part in np.unique(parts[parts > 0]):
        assert len(np.unique(labels[parts == part])) == 1
