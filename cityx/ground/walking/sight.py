"""Kernel of lines of sight over the free cells of a raster."""

import numpy as np

from cityx.geometry.arrays import BoolArray, IntArray
from cityx.geometry.compiled import compiled

BESIDE = 0.2  # cells on both sides of a line: not through the corner between two others


@compiled
def open_between(free: BoolArray, cell: IntArray, pair: IntArray, parts: int) -> BoolArray:
    """Return which straight lines between cells stay in free ones.

    Parameters
    ----------
    free
        (rows, columns) bool.
    cell
        (n, 2) int64, row and column.
    pair
        (k, 2) int64, cells that a line joins.
    parts
        Of a line, between which it is looked at.
    """
    found = np.ones(len(pair), np.bool_)
    for k in range(len(pair)):
        one, other = cell[pair[k, 0]], cell[pair[k, 1]]
        row, column = float(one[0]), float(one[1])
        down, right = float(other[0]) - row, float(other[1]) - column
        for step in range(1, parts):
            share = step / parts
            y, x = row + share * down, column + share * right
            up, low = int(np.rint(y - BESIDE)), int(np.rint(y + BESIDE))
            left, far = int(np.rint(x - BESIDE)), int(np.rint(x + BESIDE))
            if not (free[up, left] and free[up, far] and free[low, left] and free[low, far]):
                found[k] = False
                break
    return found
