"""Where height files end before they say so: the sea, and land without heights."""

from __future__ import annotations

from typing import Any

import numpy as np
import shapely

from cityx.city.frame import Frame
from cityx.geometry.arrays import BoolArray, FloatArray, IntArray
from cityx.geometry.raster.patches import depth, label_patches
from cityx.geometry.raster.regions import regions
from cityx.sources.heights.height_mosaic import Raster, spacing

LEVEL = 0.9  # share of the cells of a sea that have one height; polders and marshes have many
LEAST = 25  # cells of a sea
LOW = 3.0  # metres of most of the land round a void that is sea: who maps a coast leaves it out
MOSTLY = 75.0  # per cent
DEEP = 40.0, 4.0  # metres, and cells, from the border of a void that is too wide to be filled
SMOOTH = 1.0  # cells, deviation of the filter along a shore
KINDS = ("", "sea", "void")


def kinds_of(raster: Raster, cell: float) -> IntArray:
    """Return what lies at each cell, an index of `KINDS`: land and small gaps, sea, void.

    Sea is what lies at or below zero, level and joined to the border of the raster, and a void
    joined to it that has low land around it. Other voids are gaps to be filled unless they are
    wide.

    Parameters
    ----------
    cell
        Metres of a cell.
    """
    heights = raster.values
    void = np.isnan(heights)
    kind = np.zeros(heights.shape, np.int64)
    low = np.nan_to_num(heights, nan=1.0) <= 0.0
    for patch in _reaching(low):
        if patch.sum() >= LEAST and _level(heights[patch]):
            kind[patch] = 1
    for patch in _reaching(void):
        rim = heights[_around(patch) & ~void]
        if patch.sum() >= LEAST and len(rim) and np.percentile(rim, MOSTLY) <= LOW:
            kind[patch] = 1
    gaps = void & (kind == 0)
    labels, count = label_patches(gaps)
    if count:
        deep = np.zeros(count + 1)
        np.maximum.at(deep, labels.ravel(), depth(gaps).ravel())
        wide = (deep >= DEEP[1]) & (deep * cell >= DEEP[0])
        wide[0] = False
        kind[wide[labels]] = 2
    return kind


def _reaching(mask: BoolArray) -> list[BoolArray]:
    """Return the patches of a mask that reach the border of the raster."""
    labels, _ = label_patches(mask)
    edge = np.concatenate([labels[0], labels[-1], labels[:, 0], labels[:, -1]])
    return [labels == number for number in np.unique(edge[edge > 0]).tolist()]


def _level(heights: FloatArray) -> bool:
    return bool(np.unique(heights, return_counts=True)[1].max() >= LEVEL * len(heights))


def _around(patch: BoolArray) -> BoolArray:
    from scipy import ndimage

    return np.asarray(ndimage.binary_dilation(patch, np.ones((3, 3))) & ~patch)


def shapes_of(raster: Raster, frame: Frame, box: tuple[float, float, float, float]) -> list[Any]:
    """Return the sea and the wide voids of a raster: (polygon in a frame, kind) of each patch."""
    from pyproj import Transformer

    kind = kinds_of(raster, spacing(raster, frame, box))
    if not kind.any():
        return []
    shapes, label = regions(kind, smooth=SMOOTH, tolerance=0.3 * SMOOTH)
    change = Transformer.from_crs(raster.crs, frame.projection, always_xy=True)

    def placed(points: FloatArray) -> FloatArray:
        # The first cell's middle is half a cell inside the raster's corner.
        x, y = change.transform(*raster.places(points[:, 0] - 0.5, points[:, 1] - 0.5))
        return np.round(np.column_stack([x, y]), 3)

    return [
        (shapely.make_valid(shapely.transform(shape, placed)), KINDS[of])
        for shape, of in zip(shapes.tolist(), label.tolist(), strict=True) if of
    ]  # fmt: skip
