"""How densely a place is built, from footprints and streets in a window of 250 m."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.geometry.arrays import FloatArray
from cityx.sources.features.clipping import Box

CELL = 50.0  # metres; five cells make the window
REACH = 2  # cells on either side
URBAN = 0.18  # share of the ground under buildings; suburbs of houses stay below
CORE_LEVELS = 10  # a building this high
CORE_COUNT = 3  # of them in the window make a high-rise core
STREET_FRONT = 9.0  # metres of built ground that a metre of street stands for, both sides
PLACES = np.array(["low", "urban", "core"], object)


@dataclass(frozen=True)
class Density:
    """Sums over a grid of windows.

    Attributes
    ----------
    origin
        Corner of the grid.
    coverage
        (rows, columns) share of each cell's window that is built over.
    towers
        (rows, columns) number of high buildings in each window.
    """

    origin: FloatArray
    coverage: FloatArray
    towers: FloatArray

    def at(self, points: FloatArray) -> FloatArray:
        """Return the coverage around (n, 2) points."""
        return np.asarray(self.coverage[self._cells(points)])

    def place(self, points: FloatArray) -> NDArray[np.int64]:
        """Return the class around (n, 2) points: 0 low, 1 urban, 2 core."""
        cells = self._cells(points)
        urban = self.coverage[cells] >= URBAN
        core = urban & (self.towers[cells] >= CORE_COUNT)
        return np.asarray(urban.astype(np.int64) + core)

    def _cells(self, points: FloatArray) -> tuple[Any, Any]:
        index = ((points - self.origin) // CELL).astype(np.int64)
        rows, columns = self.coverage.shape
        return np.clip(index[:, 1], 0, rows - 1), np.clip(index[:, 0], 0, columns - 1)


def measure_density(
    box: Box, centres: FloatArray, areas: FloatArray, levels: FloatArray, streets: NDArray[Any]
) -> Density:
    """Measure how densely a site is built, in cells that lie the same whatever the site.

    Parameters
    ----------
    box
        The site.
    centres, areas, levels
        (n, 2), (n,), (n,) of the buildings; levels NaN where unknown.
    streets
        Lines of the streets that have houses along them; they stand in where the map has no
        buildings.
    """
    origin = CELL * np.floor(np.array(box[:2]) / CELL)
    size = np.maximum(np.ceil((np.array(box[2:]) - origin) / CELL), 1).astype(int)
    shape = (int(size[1]), int(size[0]))
    # Of cells at the border the part in the site counts: beyond nobody knows what is built.
    wide, deep = (
        np.diff(np.clip(origin[k] + CELL * np.arange(size[k] + 1), box[k], box[k + 2]))
        for k in (0, 1)
    )
    window = np.maximum(_window(deep[:, None] * wide), 1.0)
    built = _window(_summed(shape, origin, centres, areas)) / window
    high = (np.nan_to_num(levels) >= CORE_LEVELS).astype(float)
    towers = _window(_summed(shape, origin, centres, high))
    points, length = _street_points(streets)
    front = _window(_summed(shape, origin, points, length * STREET_FRONT)) / window
    return Density(origin, np.maximum(built, np.where(built < 0.02, front, 0.0)), towers)


def _street_points(lines: NDArray[Any]) -> tuple[FloatArray, FloatArray]:
    """Return the middles of all segments and their lengths."""
    points, row = shapely.get_coordinates(lines, return_index=True)
    if len(points) < 2:
        return np.zeros((0, 2)), np.zeros(0)
    same = row[1:] == row[:-1]
    length = np.hypot(*np.diff(points, axis=0).T)
    return ((points[1:] + points[:-1]) / 2)[same], length[same]


def _summed(
    shape: tuple[int, int], origin: FloatArray, points: FloatArray, weight: FloatArray
) -> FloatArray:
    index = ((points - origin) // CELL).astype(np.int64)
    inside = ((index >= 0) & (index < [shape[1], shape[0]])).all(axis=1)
    flat = index[inside, 1] * shape[1] + index[inside, 0]
    total = np.bincount(flat, weight[inside], minlength=shape[0] * shape[1])
    return np.asarray(total.reshape(shape), float)


def _window(values: FloatArray) -> FloatArray:
    """Sum a grid over windows of 2 `REACH` + 1 cells."""
    for axis in (0, 1):
        total = np.cumsum(np.insert(values, 0, 0.0, axis=axis), axis=axis)
        index = np.arange(values.shape[axis])
        high = np.minimum(index + REACH + 1, values.shape[axis])
        low = np.maximum(index - REACH, 0)
        values = np.take(total, high, axis=axis) - np.take(total, low, axis=axis)
    return values
