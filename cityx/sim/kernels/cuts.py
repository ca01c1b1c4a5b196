"""Cuts of meshes: the segments in plan of faces between two heights."""

from __future__ import annotations

from math import hypot
from typing import Any

import numpy as np

from cityx.geometry.compiled import compiled

FLAT = 0.95  # upward part of a normal from which a face is a top or an underside, not a side
THIN = 0.05  # metres in plan within which a face is a wall and one segment


@compiled
def side_segments(vertices: Any, faces: Any, low: Any, high: Any) -> Any:
    """Return the sides of meshes in plan.

    Parameters
    ----------
    vertices, faces
        (v, 3) metres and (f, 4), of triangles the last is -1.
    low, high
        (f,) heights between which each face counts, metres.

    Returns
    -------
    segment, face
        (s, 6) both ends and the heights between which it is solid, and (s,) face of each.
    """
    most = 1024
    segment, owner, count = np.empty((most, 6)), np.empty(most, np.int64), 0
    one, other = np.empty((12, 3)), np.empty((12, 3))
    for f in range(len(faces)):
        corners = 4 if faces[f, 3] >= 0 else 3
        least, greatest = np.inf, -np.inf
        for k in range(corners):
            z = vertices[faces[f, k], 2]
            least, greatest = min(least, z), max(greatest, z)
        if least >= high[f] or greatest <= low[f] or greatest - least < 0.02:
            continue
        a, b, c = vertices[faces[f, 0]], vertices[faces[f, 1]], vertices[faces[f, 2]]
        nx = (b[1] - a[1]) * (c[2] - a[2]) - (b[2] - a[2]) * (c[1] - a[1])
        ny = (b[2] - a[2]) * (c[0] - a[0]) - (b[0] - a[0]) * (c[2] - a[2])
        nz = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
        if abs(nz) > FLAT * (hypot(hypot(nx, ny), nz) + 1e-12):
            continue
        for k in range(corners):
            one[k] = vertices[faces[f, k]]
        n = _clipped(one, corners, low[f], 1.0, other)
        n = _clipped(other, n, -high[f], -1.0, one)
        if n < 2:
            continue
        i, j, width = _widest(one, n)
        size = n if width > THIN else 1
        if count + size > most:
            most *= 2
            longer, owners = np.empty((most, 6)), np.empty(most, np.int64)
            longer[:count], owners[:count] = segment[:count], owner[:count]
            segment, owner = longer, owners
        least, greatest = np.inf, -np.inf
        for k in range(n):
            least, greatest = min(least, one[k, 2]), max(greatest, one[k, 2])
        for k in range(size):
            p, q = (i, j) if size == 1 else (k, (k + 1) % n)
            segment[count, 0], segment[count, 1] = one[p, 0], one[p, 1]
            segment[count, 2], segment[count, 3] = one[q, 0], one[q, 1]
            segment[count, 4], segment[count, 5] = least, greatest
            owner[count] = f
            count += 1
    return segment[:count].copy(), owner[:count].copy()


@compiled
def _clipped(polygon: Any, n: int, limit: float, sign: float, into: Any) -> Any:
    """Keep what of a convex polygon has sign * z >= limit; return how many corners are left."""
    count = 0
    for k in range(n):
        p, q = polygon[k], polygon[(k + 1) % n]
        here, there = sign * p[2] - limit, sign * q[2] - limit
        if here >= 0.0:
            into[count] = p
            count += 1
        if (here >= 0.0) != (there >= 0.0):
            t = here / (here - there)
            for axis in range(3):
                into[count, axis] = p[axis] + t * (q[axis] - p[axis])
            count += 1
    return count


@compiled
def _widest(polygon: Any, n: int) -> Any:
    """Return the two corners farthest from each other in plan, and how wide it is across."""
    first, second, far = 0, 1, -1.0
    for i in range(n):
        for j in range(i + 1, n):
            away = hypot(polygon[j, 0] - polygon[i, 0], polygon[j, 1] - polygon[i, 1])
            if away > far:
                first, second, far = i, j, away
    width = 0.0
    dx, dy = polygon[second, 0] - polygon[first, 0], polygon[second, 1] - polygon[first, 1]
    for k in range(n):
        across = dx * (polygon[k, 1] - polygon[first, 1]) - dy * (polygon[k, 0] - polygon[first, 0])
        width = max(width, abs(across) / max(far, 1e-9))
    return first, second, width
