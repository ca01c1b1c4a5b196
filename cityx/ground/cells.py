"""Lines that cut the ground into cells: small where the terrain bends, large where it is even."""

from __future__ import annotations

from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.city.terrain import Terrain
from cityx.geometry.arrays import FloatArray

Extent = tuple[float, float, float, float]

FINEST = 5.0  # metres; no cell is smaller
TOLERANCE = 0.10  # metres a cell's corners may miss the terrain by before it is quartered
ROUGH = 0.20  # metres that a cell of twice the finest size must miss it by for that
MOST = 100_000  # cells; on a larger or rougher site the tolerance is doubled until so many do


def tile_lines(extent: Extent, step: float) -> NDArray[Any]:
    """Lines of the plane's grid of a step within a rectangle, borders left out."""
    west, south, east, north = extent
    lines = []
    for axis, (low, high) in enumerate(((west, east), (south, north))):
        places = step * np.arange(np.floor(low / step) + 1, np.ceil(high / step))
        ends = np.zeros((len(places), 2, 2))
        ends[:, :, axis] = places[:, None]
        ends[:, :, 1 - axis] = (south, north) if axis == 0 else (west, east)
        lines.append(shapely.linestrings(ends))
    return np.concatenate(lines)


def relief_lines(
    extent: Extent, terrain: Terrain, largest: float, tolerance: float = TOLERANCE
) -> tuple[NDArray[Any], float]:
    """Lines between the cells of a quadtree that follows the terrain.

    Parameters
    ----------
    extent
        (xmin, ymin, xmax, ymax), metres.
    terrain
        Heights; the corners of the smallest cells are nodes of its grid.
    largest
        Metres; no cell is larger.
    tolerance
        Metres a cell's corners may miss the terrain by; doubled until there are few enough cells.

    Returns
    -------
    lines
        (n,) shapely LineStrings, cut at the extent.
    tolerance
        Metres by which the corners of a cell miss the nodes of the terrain inside of it at most;
        cells of twice the smallest size may miss by `ROUGH`, and those of the smallest, which
        cannot be quartered, by more.
    """
    step = terrain.cell * max(1.0, np.ceil(FINEST / terrain.cell))
    levels = max(int(np.log2(largest / step)), 0)
    # Cells lie the same in the plane whatever the extent, if the nodes of the terrain do.
    largest = step * float(1 << levels)
    base = largest * np.floor(np.array(terrain.origin) / largest)
    base += np.mod(terrain.origin, terrain.cell)
    first = np.floor((np.array(extent[:2]) - base) / largest) * (1 << levels)
    count = np.ceil((np.array(extent[2:]) - base) / step) - first
    blocks = np.maximum(np.ceil(count / (1 << levels)), 1).astype(int)
    columns, rows = (blocks << levels) + 1
    x = base[0] + step * (first[0] + np.arange(columns))
    y = base[1] + step * (first[1] + np.arange(rows))
    x, y = np.clip(x, extent[0], extent[2]), np.clip(y, extent[1], extent[3])
    nodes = np.column_stack([np.tile(x, rows), np.repeat(y, columns)])
    heights = terrain.height_at(nodes).reshape(rows, columns)
    errors = [_misses(heights, 1 << level) for level in range(levels + 1)]
    while (leaves := _leaves(errors, tolerance)) and _count(leaves) > MOST:
        tolerance *= 2
    return _sides(leaves, x, y), tolerance


def _misses(heights: FloatArray, size: int) -> FloatArray:
    """(r, c) the most by which the corners of each block of ``size`` steps miss the nodes in it.

    The twist counts besides, as two triangles over four corners leave the surface between them.
    """
    a, b = heights[:-1:size, :-1:size], heights[:-1:size, size::size]
    c, d = heights[size::size, :-1:size], heights[size::size, size::size]
    worst = np.zeros(a.shape)
    for i in range(size + 1):
        v = i / size
        for j in range(size + 1):
            u = j / size
            even = (a * (1 - u) + b * u) * (1 - v) + (c * (1 - u) + d * u) * v
            there = heights[i : i + (len(a) - 1) * size + 1 : size]
            there = there[:, j : j + (a.shape[1] - 1) * size + 1 : size]
            np.maximum(worst, np.abs(there - even), out=worst)
    return np.asarray(worst + np.abs(a - b - c + d) / 4)


def _leaves(errors: list[FloatArray], tolerance: float) -> list[NDArray[np.bool_]]:
    """Say for each level, smallest cells first, which cells are not quartered any more."""
    leaves: list[NDArray[np.bool_]] = []
    divided = np.ones(errors[-1].shape, bool)  # whether the parent of each cell is quartered
    for level in range(len(errors) - 1, -1, -1):
        even = errors[level] <= (max(tolerance, ROUGH) if level == 1 else tolerance)
        even |= level == 0
        leaves.append(divided & even)
        divided = np.repeat(np.repeat(divided & ~even, 2, axis=0), 2, axis=1)
    return leaves[::-1]


def _count(leaves: list[NDArray[np.bool_]]) -> int:
    return sum(int(level.sum()) for level in leaves)


def _sides(leaves: list[NDArray[np.bool_]], x: FloatArray, y: FloatArray) -> NDArray[Any]:
    """Join the sides of all cells to lines as long as can be."""
    along_x = np.zeros((len(y), len(x) - 1), bool)
    along_y = np.zeros((len(x), len(y) - 1), bool)
    for level, leaf in enumerate(leaves):
        size = 1 << level
        for sides, own in ((along_x, leaf), (along_y, leaf.T)):
            reach = np.repeat(own, size, axis=1)
            sides[:-1:size] |= reach
            sides[size::size] |= reach
    lines = []
    for sides, places, across, flip in ((along_x, x, y, False), (along_y, y, x, True)):
        line, begin, end = _runs(sides[1:-1])
        ends = np.empty((len(line), 2, 2))
        ends[:, :, 0] = places[np.column_stack([begin, end])]
        ends[:, :, 1] = across[1:-1][line][:, None]
        ends = ends[:, :, ::-1] if flip else ends
        long = np.ptp(ends, axis=1).max(axis=1) > 0
        lines.append(shapely.linestrings(ends[long]))
    return np.concatenate(lines)


def _runs(marked: NDArray[np.bool_]) -> tuple[NDArray[np.int64], ...]:
    """Return row, first and last step of each run of marked steps."""
    edges = np.diff(np.pad(marked, ((0, 0), (1, 1))).astype(np.int8), axis=1)
    row, begin = np.nonzero(edges == 1)
    return row, begin, np.nonzero(edges == -1)[1]
