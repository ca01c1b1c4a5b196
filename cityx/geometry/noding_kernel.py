"""Segments by cells, which of them cross, and which points they pass, compiled.

`cityx.geometry.noding` says more. Import it lazily: numba alone takes half a second.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from cityx.geometry.arrays import IntArray
from cityx.geometry.compiled import compiled


@compiled
def list_cells(
    first: IntArray, second: IntArray, half: int, size: int, low: IntArray, rows: int,
    at: IntArray, listed: NDArray[np.int32],
) -> None:  # fmt: skip
    """Count segments by the cells that come near them, or list them, cell after cell.

    Parameters
    ----------
    first, second
        (m, 2) ends.
    half
        How far from a segment its cells reach.
    size, low, rows
        Edge of a cell; the least corner of all of them, and how many there are in a column.
    at
        (c,) written: how many segments each cell has, or where it begins in `listed` and, when that
        is filled, ends.
    listed
        Written: the segments of each cell, rising; nothing to count alone.
    """
    counts = len(listed) == 0
    for row in range(len(first)):
        ax, ay, bx, by = first[row, 0], first[row, 1], second[row, 0], second[row, 1]
        west, east, south, north = min(ax, bx), max(ax, bx), min(ay, by), max(ay, by)
        slope = (bx - ax) / (by - ay) if by != ay else 0.0
        begin, end = (south - half - low[1]) // size, (north + half - low[1]) // size
        for band in range(begin, end + 1):
            left, right = float(west), float(east)
            if by != ay:  # what of it lies so near the band
                floor, ceiling = low[1] + band * size - half, low[1] + (band + 1) * size + half
                one = ax + (min(max(floor, south), north) - ay) * slope
                other = ax + (min(max(ceiling, south), north) - ay) * slope
                left, right = min(one, other), max(one, other)
            # One more, since quotients are rounded.
            here = math.floor((left - half - 1 - low[0]) / size)
            there = math.floor((right + half + 1 - low[0]) / size)
            for column in range(here, there + 1):
                cell = column * rows + band
                if not counts:
                    listed[at[cell]] = row
                at[cell] += 1


@compiled
def _side(a: IntArray, b: IntArray, x: int, y: int) -> int:
    """Twice the area of a triangle: above zero where (x, y) lies left of the line from a to b."""
    return int((b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0]))


@compiled
def crossing_pairs(
    first: IntArray, second: IntArray, start: IntArray, listed: NDArray[np.int32], begin: int,
    end: int, found: IntArray,
) -> int:  # fmt: skip
    """List pairs of segments that cross inside of both; those that share cells several times.

    Parameters
    ----------
    first, second, listed
        As of `list_cells`.
    start
        (c + 1,) where each cell begins in `listed`.
    begin, end
        The cells that are looked at.
    found
        (k, 2) written, as far as there is room: the lower segment first.

    Returns
    -------
    count
        Of all pairs, also those without room.
    """
    count = 0
    for cell in range(begin, end):
        for i in range(start[cell], start[cell + 1]):
            one = listed[i]
            a, b = first[one], second[one]
            west, east = min(a[0], b[0]), max(a[0], b[0])
            south, north = min(a[1], b[1]), max(a[1], b[1])
            for j in range(i + 1, start[cell + 1]):
                other = listed[j]
                c, d = first[other], second[other]
                if min(c[0], d[0]) > east or max(c[0], d[0]) < west:
                    continue
                if min(c[1], d[1]) > north or max(c[1], d[1]) < south:
                    continue
                from_one, to_one = _side(a, b, c[0], c[1]), _side(a, b, d[0], d[1])
                if not ((from_one < 0 and to_one > 0) or (from_one > 0 and to_one < 0)):
                    continue
                from_one, to_one = _side(c, d, a[0], a[1]), _side(c, d, b[0], b[1])
                if not ((from_one < 0 and to_one > 0) or (from_one > 0 and to_one < 0)):
                    continue
                if count < len(found):
                    found[count, 0], found[count, 1] = one, other
                count += 1
    return count


@compiled
def passed_points(
    first: IntArray, second: IntArray, points: IntArray, half: int, size: int, low: IntArray,
    rows: int, start: IntArray, listed: NDArray[np.int32], begin: int, end: int, found: IntArray,
) -> int:  # fmt: skip
    """List which segments pass the squares of which points, west and south sides included.

    Parameters
    ----------
    first, second, half, size, low, rows, start, listed
        As of `list_cells` and `crossing_pairs`; squares reach `half` from their middles.
    points
        (n, 2) grid points.
    begin, end
        The points that are looked at.
    found
        Written, as far as there is room: the number of a segment times n, and of a point.

    Returns
    -------
    count
        Of all of them, also those without room.
    """
    count = 0
    for point in range(begin, end):
        x, y = 2 * half * points[point, 0], 2 * half * points[point, 1]
        cell = (x - low[0]) // size * rows + (y - low[1]) // size
        for at in range(start[cell], start[cell + 1]):
            row = listed[at]
            a, b = first[row], second[row]
            if min(a[0], b[0]) >= x + half or max(a[0], b[0]) < x - half:
                continue
            if min(a[1], b[1]) >= y + half or max(a[1], b[1]) < y - half:
                continue
            own = _side(a, b, x - half, y - half)
            if not (a[0] == b[0] or a[1] == b[1] or own == 0):
                two, three = _side(a, b, x + half, y - half), _side(a, b, x + half, y + half)
                four = _side(a, b, x - half, y + half)
                most, least = max(own, two, three, four), min(own, two, three, four)
                if not (most > 0 and least < 0):
                    continue
            if count < len(found):
                found[count] = np.int64(row) * len(points) + point
            count += 1
    return count
