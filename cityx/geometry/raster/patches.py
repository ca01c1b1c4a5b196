"""Patches: connected pixels of a mask, cleaned of specks and pinholes, split at necks."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from cityx.geometry.arrays import BoolArray

NECK = 0.15  # of the greatest depth of a patch; bodies joined by less are two
BODY = 3.0  # depths of the neck that each of the bodies it joins is deep
SOLID = 0.8  # share of its hull from which a patch is one body whatever its depth
SHALLOW = 2.0  # pixels; patches not deeper than this have no neck that could be told from noise


def label_patches(mask: BoolArray) -> tuple[NDArray[np.int32], int]:
    """Return the 4-connected patches of a mask, numbered from 1, and their count."""
    from scipy import ndimage

    labels, count = ndimage.label(mask)
    return labels, int(count)


def without_specks(mask: BoolArray, least: float) -> BoolArray:
    """Drop patches of fewer than `least` pixels."""
    labels, count = label_patches(mask)
    large = np.bincount(labels.ravel(), minlength=count + 1) >= least
    large[0] = False
    return np.asarray(large[labels])


def without_holes(mask: BoolArray, least: float) -> BoolArray:
    """Fill holes of fewer than `least` pixels; what is open to the border is no hole.

    Patches are 4-connected, so the gaps between them are 8-connected: a slanting gap one pixel wide
    is no row of holes.
    """
    from scipy import ndimage

    labels, count = ndimage.label(~mask, np.ones((3, 3)))
    small = np.bincount(labels.ravel(), minlength=count + 1) < least
    border = np.concatenate([labels[0], labels[-1], labels[:, 0], labels[:, -1]])
    small[border] = False
    small[0] = False
    return np.asarray(mask | small[labels])


def depth(mask: BoolArray) -> NDArray[np.float64]:
    """Return the distance of each pixel to the border of its mask, pixels, 0 outside.

    Distances run from middle to middle of pixels less half a pixel, so the depth along the middle
    of a strip is half its width. Beyond the border of the raster there is no mask.
    """
    from scipy import ndimage

    far = ndimage.distance_transform_edt(np.pad(mask, 1))[1:-1, 1:-1]
    return np.asarray(np.maximum(far - 0.5, 0.0))


def split_at_necks(labels: NDArray[Any], solidity: NDArray[np.float64]) -> NDArray[Any]:
    """Split touching bodies: a patch with several separate cores becomes one patch for each.

    Parameters
    ----------
    labels
        (rows, columns) int, patches numbered from 1.
    solidity
        (count,) share of its convex hull that each patch fills.

    Returns
    -------
    labels
        (rows, columns) int; parts of a patch are numbered anew after the last, the first keeps the
        number.
    """
    from scipy import ndimage
    from skimage.segmentation import watershed

    found = labels.copy()
    count = int(labels.max(initial=0))
    boxes = ndimage.find_objects(labels)
    for index in np.flatnonzero(solidity < SOLID).tolist():
        window = boxes[index]
        mask = labels[window] == index + 1
        deep = depth(mask)
        if deep.max() <= SHALLOW:
            continue
        seeds, bodies = _bodies(deep)
        if bodies < 2:
            continue
        parts = watershed(-deep, seeds, mask=mask)
        view = found[window]
        for body in range(2, bodies + 1):
            count += 1
            view[parts == body] = count
    return found


def _bodies(deep: NDArray[np.float64]) -> tuple[NDArray[Any], int]:
    """Return the numbered middles of the bodies of one patch by its depth, and their count."""
    from scipy import ndimage

    neck = NECK * deep.max()
    seeds, count = label_patches(deep > neck)
    peak = np.asarray(ndimage.maximum(deep, seeds, np.arange(count + 1)))
    body = (peak > BODY * neck) & (np.arange(count + 1) > 0)
    number = np.where(body, np.cumsum(body), 0)
    return number[seeds], int(body.sum())
