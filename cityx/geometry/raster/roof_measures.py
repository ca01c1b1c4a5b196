"""Roofs measured from a height grid: how high houses are, and which form their roofs have."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.geometry.arrays import BoolArray, FloatArray
from cityx.geometry.raster.grid import Grid

TOP = 90.0  # percentile of the cells of a roof that is its height; chimneys lie above
FOOT = 5.0  # percentile of the cells round a house that is its ground
RING = 3.0  # metres round a house in which its ground is sought
FEWEST = 4  # cells from which anything can be said
KNOWN = 0.7  # share of the cells of a house that must have a height
FEWEST_ROOF = 16  # cells inside a roof from which its form can be told
LEVEL = 0.6  # metres of deviation up to which a roof is flat
SPREAD = 1.0  # metres that a pitched roof rises at least, and that is more than noise
CLEAR = 0.6  # share of the variance that a form must explain to be the form
STEEP = 2.5  # metres per metre; what rises faster is a wall or a step


@dataclass(frozen=True)
class Roofs:
    """What was measured of n houses.

    Attributes
    ----------
    height
        (n,) metres from the ground to the top, NaN where too little is known.
    shape
        (n,) "flat", "gabled", "hipped" or "" where it is not clear.
    rise
        (n,) metres from eave to ridge, 0 unless pitched.
    across
        (n,) whether the ridge runs across the longer side.
    """

    height: FloatArray
    shape: NDArray[Any]
    rise: FloatArray
    across: BoolArray


def measure_roofs(shapes: NDArray[Any], above: FloatArray, grid: Grid) -> Roofs:
    """Measure the heights and forms of roofs.

    Parameters
    ----------
    shapes
        (n,) polygons, scene frame, metres.
    above
        (rows, columns) metres above the ground, NaN where void.
    grid
        Where the cells lie.
    """
    count = len(shapes)
    height, rise = np.full(count, np.nan), np.zeros(count)
    form, across = np.full(count, "", object), np.zeros(count, bool)
    number = grid.numbered(shapes)
    cells = _cells_of(number, count, above, grid)
    depths = _cells_of(number, count, _depths(number, grid.pixel), grid)
    for index, ((spots, tops), (_, depth)) in enumerate(zip(cells, depths, strict=True)):
        known = np.isfinite(tops)
        if known.sum() < FEWEST or known.mean() < KNOWN:
            continue
        height[index] = np.percentile(tops[known], TOP)
        inner = known & (depth > grid.pixel)
        found = _form(shapes[index], spots[inner], tops[inner], depth[inner])
        form[index], across[index] = found[0], found[2]
        if found[1] > 0:
            rise[index] = found[1]
            height[index] = max(height[index], found[3])
    return Roofs(height, form, rise, across)


def heights_over_ring(
    shapes: NDArray[Any], above: FloatArray, grid: Grid
) -> tuple[FloatArray, FloatArray]:
    """Return (n,) heights of tops and of the ground round houses.

    Parameters
    ----------
    shapes
        (n,) polygons, scene frame, metres.
    above
        (rows, columns) metres above a ground that is known roughly, NaN where void.
    grid
        Where the cells lie.

    Returns
    -------
    top, foot
        (n,) metres above that ground. The foot is sought within 3 m of the wall, where no other
        house stands nearer; NaN where no such place is.
    """
    from scipy import ndimage

    top, foot = np.full(len(shapes), np.nan), np.full(len(shapes), np.nan)
    number = grid.numbered(shapes)
    for index, (_, tops) in enumerate(_cells_of(number, len(shapes), above, grid)):
        known = tops[np.isfinite(tops)]
        if len(known) >= max(FEWEST, KNOWN * len(tops)):
            top[index] = np.percentile(known, TOP)
    away, (row, column) = ndimage.distance_transform_edt(number == 0, return_indices=True)
    # Cells at a wall hold some of the roof.
    beside = (away > 1) & (away * grid.pixel <= RING + grid.pixel) & np.isfinite(above)
    near = np.where(beside, number[row, column], 0)
    for index, (_, low) in enumerate(_cells_of(near, len(shapes), above, grid)):
        if len(low) >= FEWEST:
            foot[index] = np.percentile(low, FOOT)
    return top, foot


def _cells_of(
    number: NDArray[np.int32], count: int, values: FloatArray, grid: Grid
) -> list[tuple[FloatArray, FloatArray]]:
    """Return the middles, (k, 2) metres, and the values of the cells of each number from 1."""
    row, column = np.nonzero(number)
    order = np.argsort(number[row, column], kind="stable")
    row, column = row[order], column[order]
    spots = grid.to_metres(np.column_stack([column, row]) + 0.5)
    begin = np.searchsorted(number[row, column], np.arange(1, count + 2))
    tops = values[row, column]
    return [
        (spots[first:last], tops[first:last])
        for first, last in zip(begin[:-1].tolist(), begin[1:].tolist(), strict=True)
    ]


def _depths(number: NDArray[np.int32], pixel: float) -> FloatArray:
    """Return the metres from the middle of each cell to the wall of its shape, nearly."""
    from scipy import ndimage

    wall = ndimage.maximum_filter(number, 3) != ndimage.minimum_filter(number, 3)
    return np.asarray((ndimage.distance_transform_edt(~wall) + 0.5) * pixel)


def _form(
    shape: Any, spots: FloatArray, tops: FloatArray, depth: FloatArray
) -> tuple[str, float, bool, float]:
    """Return form, rise, whether the ridge runs across, and the height of the ridge."""
    silent = ("", 0.0, False, 0.0)
    if len(tops) < FEWEST_ROOF:
        return silent
    middle = float(np.median(tops))
    if float(np.sqrt(np.mean(np.minimum((tops - middle) ** 2, (3 * LEVEL) ** 2)))) < LEVEL:
        return "flat", 0.0, False, 0.0
    fits = [_fit(room, tops) for room in (*_eave_distances(shape, spots), depth)]
    best = int(np.argmax([share for share, _, _ in fits]))
    share, rise, ridge = fits[best]
    if share < CLEAR or rise < SPREAD:
        return silent
    return ("gabled", "gabled", "hipped")[best], rise, best == 1, ridge


def _eave_distances(shape: Any, spots: FloatArray) -> list[FloatArray]:
    """Return each place's distance to the eaves, for a ridge along the long side and one across."""
    box = shapely.get_coordinates(shapely.oriented_envelope(shape))[:4]
    sides = [box[1] - box[0], box[2] - box[1]]
    sides.sort(key=lambda side: -float(np.hypot(*side)))
    distances = []
    for side in reversed(sides):  # the ridge along the longer side falls across it
        half = float(np.hypot(*side)) / 2
        off = (spots - box.mean(axis=0)) @ (side / (2 * half))
        distances.append(half - np.abs(off))
    return distances


def _fit(room: FloatArray, tops: FloatArray) -> tuple[float, float, float]:
    """Return the share of the variance that a slope explains, its rise and its highest point."""
    spread = float(np.var(room))
    if spread == 0:
        return 0.0, 0.0, 0.0
    slope = float(np.cov(room, tops, bias=True)[0, 1]) / spread
    rest = tops - tops.mean() - slope * (room - room.mean())
    share = 1 - float(np.var(rest)) / float(np.var(tops))
    if not 0 < slope < STEEP:
        return 0.0, 0.0, 0.0
    most = float(room.max())
    return share, slope * most, float(tops.mean()) + slope * (most - float(room.mean()))
