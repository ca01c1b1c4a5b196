"""Distances in rasters, compiled by numba: only as far as is asked for, and only where."""

from __future__ import annotations

from typing import Any

import numpy as np

from cityx.geometry.compiled import compiled


@compiled
def squares_to_closed(free: Any, wanted: Any, reach: int) -> Any:
    """Return squares of the distance of cells to the nearest that is not free, exactly.

    Parameters
    ----------
    free
        (h, w) bool.
    wanted
        (h, w) bool, cells that are measured.
    reach
        Cells up to which distances are told apart, 255 at most. Beyond the raster all is free.

    Returns
    -------
    square
        (h, w) uint16, square cells, ``reach ** 2`` at most; 0 where it is not wanted.
    """
    height, width = free.shape
    above = np.empty((height, width), np.uint8)  # cells to the nearest in the same column
    for i in range(width):
        above[0, i] = reach if free[0, i] else 0
    for j in range(1, height):
        for i in range(width):
            above[j, i] = min(above[j - 1, i] + 1, reach) if free[j, i] else 0
    for j in range(height - 2, -1, -1):
        for i in range(width):
            if above[j + 1, i] + 1 < above[j, i]:
                above[j, i] = above[j + 1, i] + 1
    found = np.zeros((height, width), np.uint16)
    for j in range(height):
        for i in range(width):
            if not (wanted[j, i] and free[j, i]):
                continue
            best = int(above[j, i]) ** 2
            aside = 1
            while aside * aside < best:
                if i >= aside:
                    best = min(best, aside * aside + int(above[j, i - aside]) ** 2)
                if i + aside < width:
                    best = min(best, aside * aside + int(above[j, i + aside]) ** 2)
                aside += 1
            found[j, i] = best
    return found
