"""Which triangles hold points, compiled by numba; see `cityx.geometry.clearance`.

Import it lazily.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from cityx.geometry.compiled import compiled


@compiled
def holds(triangle: int, x: float, y: float, vertices: Any, triangles: Any) -> bool:
    """Tell whether a triangle has a point in it or on its rim, whichever way round it is."""
    left, right = True, True
    for k in range(3):
        a, b = triangles[triangle, k], triangles[triangle, (k + 1) % 3]
        turn = (vertices[b, 0] - vertices[a, 0]) * (y - vertices[a, 1]) - (
            vertices[b, 1] - vertices[a, 1]
        ) * (x - vertices[a, 0])
        left, right = left and turn >= 0.0, right and turn <= 0.0
    return left or right


@compiled
def among_cells(
    spots: Any, first: Any, last: Any, candidate: Any, counts: Any, vertices: Any, triangles: Any
) -> Any:
    """Find the pairs of points and triangles that hold them.

    Parameters
    ----------
    spots
        (n, 2) metres.
    first, last
        (n,) which of the candidates are looked at for each point.
    candidate
        (c,) triangles.
    counts
        (t,) bool, triangles that are asked for; all if it is empty.
    vertices, triangles
        (v, 2) metres and (t, 3) corners.

    Returns
    -------
    point, triangle
        (k,) each, by point, and in the order of the candidates.
    """
    point = np.empty(len(spots) + 64, np.int64)
    found = np.empty(len(spots) + 64, np.int64)
    size = 0
    for i in range(len(spots)):
        for place in range(first[i], last[i]):
            triangle = candidate[place]
            if len(counts) and not counts[triangle]:
                continue
            if not holds(triangle, spots[i, 0], spots[i, 1], vertices, triangles):
                continue
            if size == len(point):
                more, other = np.empty(2 * size, np.int64), np.empty(2 * size, np.int64)
                more[:size], other[:size] = point, found
                point, found = more, other
            point[size], found[size] = i, triangle
            size += 1
    return point[:size], found[:size]
