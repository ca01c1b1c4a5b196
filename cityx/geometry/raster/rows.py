"""Rows: patches too large to be one house are cut into the houses of a row, with gaps between."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.geometry.arrays import BoolArray, IntArray
from cityx.geometry.raster.centrelines import centrelines

WAVY = 2.0  # pixels that the middle of a row may stray


@dataclass(frozen=True)
class Plots:
    """What the houses of a row measure, pixels.

    Attributes
    ----------
    front
        Along the row.
    back
        Across it; a row as deep as two has its houses back to back.
    gap
        Between houses.
    """

    front: float
    back: float
    gap: float


def cut_into_houses(labels: NDArray[Any], rows: IntArray, plots: Plots) -> BoolArray:
    """Return a mask of houses: the patches given cut up, all others whole.

    A patch is cut square to its middle line, and along it where it is deep enough for houses back
    to back.

    Parameters
    ----------
    labels
        (rows, columns) int, patches numbered from 1.
    rows
        (n,) numbers of the patches to cut.
    plots
        What a house takes.
    """
    from scipy import ndimage

    mask = labels > 0
    boxes = ndimage.find_objects(labels)
    for number in rows.tolist():
        window = boxes[number - 1]
        patch = labels[window] == number
        mask[window][patch & _gaps(_houses(patch, plots), plots.gap)] = False
    return mask


def _houses(patch: BoolArray, plots: Plots) -> IntArray:
    """Return the number of the house at each pixel of a patch, 0 outside."""
    rim = 1  # centrelines want a border around the mask
    middle = centrelines(np.pad(patch, rim), tolerance=WAVY)
    houses = np.zeros(patch.shape, np.int64)
    if len(middle.lines) == 0:
        houses[patch] = 1
        return houses
    row, column = np.nonzero(patch)
    place = shapely.points(np.column_stack([column, row]) + 0.5 + rim)
    line = shapely.STRtree(middle.lines).nearest(place)
    length = shapely.length(middle.lines)
    count = np.maximum(np.rint(length / plots.front), 1).astype(np.int64)
    along = shapely.line_locate_point(middle.lines[line], place)
    bay = np.minimum((along / length[line] * count[line]).astype(np.int64), count[line] - 1)
    deep = middle.width[line] > 1.5 * plots.back
    side = deep & _left_of(middle.lines[line], place, along)
    most = int(count.max())
    houses[patch] = 1 + (line * most + bay) * 2 + side
    return houses


def _left_of(lines: NDArray[Any], places: NDArray[Any], along: NDArray[np.float64]) -> BoolArray:
    """Return which places lie left of their lines, pixel by pixel."""
    step = 1.0
    back = shapely.get_coordinates(
        shapely.line_interpolate_point(lines, np.maximum(along - step, 0))
    )
    ahead = shapely.get_coordinates(shapely.line_interpolate_point(lines, along + step))
    way, away = ahead - back, shapely.get_coordinates(places) - back
    return np.asarray(way[:, 0] * away[:, 1] - way[:, 1] * away[:, 0] > 0)


def _gaps(houses: IntArray, gap: float) -> BoolArray:
    """Mark the pixels within half a gap of another house."""
    from scipy import ndimage

    window = max(2 * round(gap / 2) + 1, 3)
    none = houses == 0
    high = ndimage.maximum_filter(houses, window)
    low = ndimage.minimum_filter(np.where(none, houses.max() + 1, houses), window)
    return np.asarray((high != low) & ~none)
