"""Points in triangles, compiled by numba; `cityx.geometry.triangle_cells` says what is asked.

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
    count = 0
    for spot in range(len(spots)):
        x, y = spots[spot, 0], spots[spot, 1]
        column, line = math.floor(x / size), math.floor(y / size)
        number = (column - low[0]) * rows + (line - low[1])
        row = np.searchsorted(cell, number)
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
