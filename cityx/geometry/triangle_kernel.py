"""Triangles by cells, and points in them, compiled; `cityx.geometry.triangle_cells` says more.

Import it lazily: numba alone takes half a second.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from cityx.geometry.arrays import BoolArray, FloatArray, IntArray
from cityx.geometry.compiled import compiled


@compiled
def held_pairs(
    spots: FloatArray, vertices: FloatArray, triangles: NDArray[np.int32], boxes: FloatArray,
    among: BoolArray, size: float, low: NDArray[np.int32], rows: int, cell: IntArray,
    start: NDArray[np.int32], listed: NDArray[np.int32], point: IntArray, found: NDArray[np.int32],
) -> int:  # fmt: skip
    """List pairs of a point and a triangle that holds it or has it on its rim, by one level.

    Parameters
    ----------
    spots, among
        (n, 2) points, and (t,) triangles that count.
    vertices, triangles
        As of `cityx.geometry.triangle_cells.TriangleCells`.
    boxes
        (t, 2, 2), the same turned.
    size, low, rows, cell, start, listed
        As of `cityx.geometry.triangle_cells.Cells`.
    point, found
        Written: the pairs, point by point, as far as there is room.

    Returns
    -------
    count
        Of all pairs, also those without room.
    """
    count, row, last = 0, -1, 0
    for spot in range(len(spots)):
        x, y = spots[spot, 0], spots[spot, 1]
        column, line = math.floor(x / size), math.floor(y / size)
        number = (column - low[0]) * rows + (line - low[1])
        if row < 0 or number != last:
            row, last = np.searchsorted(cell, number), number
        if row == len(cell) or cell[row] != number:
            continue
        for at in range(start[row], start[row + 1]):
            triangle = listed[at]
            if not among[triangle]:
                continue
            if x < boxes[triangle, 0, 0] or x > boxes[triangle, 0, 1]:
                continue
            if y < boxes[triangle, 1, 0] or y > boxes[triangle, 1, 1]:
                continue
            left = right = True
            a = triangles[triangle, 2]
            ax, ay = vertices[a, 0] - x, vertices[a, 1] - y
            for k in range(3):
                b = triangles[triangle, k]
                bx, by = vertices[b, 0] - x, vertices[b, 1] - y
                turn = ax * by - bx * ay
                left &= turn >= 0.0
                right &= turn <= 0.0
                ax, ay = bx, by
            if left or right:
                if count < len(point):
                    point[count], found[count] = spot, triangle
                count += 1
    return count


@compiled
def fill_boxes(vertices: FloatArray, triangles: NDArray[np.int32], boxes: FloatArray) -> None:
    """Write the boxes of triangles, (t, 2, 2): of x and of y their least and their greatest."""
    for row in range(len(triangles)):
        for axis in range(2):
            one = vertices[triangles[row, 0], axis]
            two, three = vertices[triangles[row, 1], axis], vertices[triangles[row, 2], axis]
            boxes[row, axis, 0] = min(one, two, three)
            boxes[row, axis, 1] = max(one, two, three)


@compiled
def met_cells(
    vertices: FloatArray, triangles: NDArray[np.int32], boxes: FloatArray, rows: NDArray[np.int32],
    size: float, limits: tuple[int, int, float, float], corner: NDArray[np.int64], bits: int,
    keys: IntArray, fits: BoolArray,
) -> int:  # fmt: skip
    """List the cells of one size that triangles meet, as `cityx.geometry.triangle_cells` does.

    Parameters
    ----------
    vertices, triangles, boxes
        As of `held_pairs`.
    rows, size
        (r,) triangles that are asked about, and metres of a cell.
    limits
        `FEW_CELLS`, `MOST_CELLS`, `SLACK` and `LEVEL` of `cityx.geometry.triangle_cells`.
    corner
        (4,) the first column and row of cells, the last row, and the last column; written where
        there are no keys to write.
    bits
        Of a triangle's number in a key.
    keys
        Written, if it has room: the numbers of cell and triangle as one, triangle by triangle.
    fits
        (r,) written: whether a triangle meets few enough.

    Returns
    -------
    count
        Of keys.
    """
    few, most, slack, level = limits
    writes = len(keys) > 0
    lines = corner[2] - corner[1] + 1
    begin, end = np.empty(most, np.int64), np.empty(most, np.int64)
    count = 0
    for at in range(len(rows)):
        row = rows[at]
        west, east = math.floor(boxes[row, 0, 0] / size), math.floor(boxes[row, 0, 1] / size)
        south, north = math.floor(boxes[row, 1, 0] / size), math.floor(boxes[row, 1, 1] / size)
        width, height = east - west + 1, north - south + 1
        fits[at] = False
        if width * height > few:
            if max(width, height) > most:
                continue
            total = 0
            for band in range(height):
                least, greatest = _reach(
                    vertices, triangles, row, size * (south + band), size, level
                )
                begin[band] = math.floor((least - slack) / size)
                end[band] = math.floor((greatest + slack) / size)
                total += end[band] - begin[band] + 1
            if total > most:
                continue
        else:
            for band in range(height):
                begin[band], end[band] = west, east
        fits[at] = True
        for band in range(height):
            line = south + band
            if writes:
                for column in range(begin[band], end[band] + 1):
                    cell = (column - corner[0]) * lines + (line - corner[1])
                    keys[count] = (cell << bits) + row
                    count += 1
            else:
                count += end[band] - begin[band] + 1
                corner[0], corner[1] = min(corner[0], begin[band]), min(corner[1], line)
                corner[2], corner[3] = max(corner[2], line), max(corner[3], end[band])
    return count


@compiled
def _reach(
    vertices: FloatArray, triangles: NDArray[np.int32], row: int, south: float, size: float,
    level: float,
) -> tuple[float, float]:  # fmt: skip
    """Return the least and the greatest x of a triangle within a row of cells."""
    north = south + size
    least, greatest = np.inf, -np.inf
    for side in range(3):
        p, q = triangles[row, side], triangles[row, side - 1]
        px, py, qx, qy = vertices[p, 0], vertices[p, 1], vertices[q, 0], vertices[q, 1]
        if max(py, qy) < south or min(py, qy) > north:
            continue
        rise = qy - py
        slanting = abs(rise) > level
        slope = (qx - px) / rise if slanting else 0.0
        one = px + (min(max(py, south), north) - py) * slope if slanting else px
        two = px + (min(max(qy, south), north) - py) * slope if slanting else qx
        least, greatest = min(least, one, two), max(greatest, one, two)
    if least > greatest:  # a corner on the border of two rows may by rounding reach neither
        one, two = vertices[triangles[row, 0], 0], vertices[triangles[row, 1], 0]
        three = vertices[triangles[row, 2], 0]
        least, greatest = min(one, two, three), max(one, two, three)
    return least, greatest


@compiled
def sort_keys(keys: IntArray, other: IntArray, shift: int, bits: int) -> bool:
    """Sort keys by some of their bits, those alike as they are: from the lowest digits on.

    Parameters
    ----------
    keys, other
        (n,) each, both written.
    shift, bits
        The first bit that counts, and how many do.

    Returns
    -------
    swapped
        Whether the sorted keys are in `other`.
    """
    digit = 11
    start = np.empty((1 << digit) + 1, np.int64)
    source, target = keys, other
    swapped = False
    for low in range(shift, shift + bits, digit):
        start[:] = 0
        for at in range(len(source)):
            start[((source[at] >> low) & ((1 << digit) - 1)) + 1] += 1
        for number in range(1 << digit):
            start[number + 1] += start[number]
        for at in range(len(source)):
            number = (source[at] >> low) & ((1 << digit) - 1)
            target[start[number]] = source[at]
            start[number] += 1
        source, target = target, source
        swapped = not swapped
    return swapped
