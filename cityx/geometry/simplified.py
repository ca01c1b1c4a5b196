"""Polygons with fewer points, each stretch of a ring simplified by itself."""

from __future__ import annotations

from typing import Any

import numpy as np
import shapely
from numpy.typing import ArrayLike, NDArray

from cityx.geometry.arrays import BoolArray, FloatArray, IntArray
from cityx.geometry.ranges import counted
from cityx.ids import mix

KEPT = np.uint64(16)  # one point of so many stays in any case, by a hash of its place
PER_METRE = 1000.0  # steps in which places are told apart


def simplified(polygons: ArrayLike, tolerance: float) -> NDArray[Any]:
    """Drop points of polygons that lie within a tolerance of the line between their neighbours.

    The way of Douglas and Peucker looks at a ring as a whole: where a network of streets is one
    polygon, a street far away decides which of two points stays here. So rings are cut at points
    that stay in any case, and only the stretches between them are simplified.

    Parameters
    ----------
    polygons
        Polygons and multipolygons.
    tolerance
        Metres.

    Returns
    -------
    simpler
        (n,) polygons, multipolygons taken apart; one that would not be valid is as it was.
    """
    parts: NDArray[Any] = shapely.get_parts(np.atleast_1d(np.asarray(polygons, object)))
    rings, part = shapely.get_rings(parts, return_index=True)
    if not len(rings):
        return parts
    points, ring = shapely.get_coordinates(rings, return_index=True)
    inner = ring[1:] == ring[:-1]  # the last point of a ring is its first
    points, ring = points[:-1][inner], ring[:-1][inner]
    lines, of_ring = _stretches(points, ring, len(rings))
    simple = shapely.simplify(lines, tolerance, preserve_topology=False)
    points, line = shapely.get_coordinates(simple, return_index=True)
    inner = line[1:] == line[:-1]
    points, ring = points[:-1][inner], of_ring[line[:-1][inner]]
    return _rebuilt(parts, part, points, ring)


def _stretches(points: FloatArray, ring: IntArray, count: int) -> tuple[NDArray[Any], IntArray]:
    """Cut rings at the points that stay: lines, and the ring of each."""
    size = np.bincount(ring, minlength=count)
    start = np.cumsum(size) - size
    stay = np.flatnonzero(_stays(points, ring))
    of_stay = ring[stay]
    last = np.r_[of_stay[1:] != of_stay[:-1], True]
    first = stay[np.searchsorted(of_stay, of_stay)]
    following = np.where(last, first + size[of_stay], np.r_[stay[1:], 0])
    line, number = counted(following - stay + 1)
    begin = start[of_stay[line]]
    place = begin + (stay[line] - begin + number) % size[of_stay[line]]
    return shapely.linestrings(points[place], indices=line), of_stay


def _stays(points: FloatArray, ring: IntArray) -> BoolArray:
    """(n,) points that stay: some by a hash of their places, and the extreme ones of each ring."""
    x, y = np.rint(points * PER_METRE).astype(np.int64).view(np.uint64).T
    stays = mix(mix(x) ^ np.ascontiguousarray(y)) % KEPT == 0
    for keys in ((points[:, 1], points[:, 0]), (-points[:, 1], -points[:, 0])):
        order = np.lexsort((*keys, ring))
        stays[order[np.flatnonzero(np.diff(ring[order], prepend=-1) != 0)]] = True
    return np.asarray(stays)


def _rebuilt(
    parts: NDArray[Any], part: IntArray, points: FloatArray, ring: IntArray
) -> NDArray[Any]:
    """Make polygons of rings again, those that are none any more as they were."""
    size = np.bincount(ring, minlength=len(part))
    broken = np.zeros(len(parts), bool)
    broken[part[size < 3]] = True
    kept = np.flatnonzero(~broken[part])
    if not len(kept):
        return parts
    rows = ~broken[part[ring]]
    made = shapely.linearrings(points[rows], indices=np.searchsorted(kept, ring[rows]))
    shell = np.r_[True, part[kept][1:] != part[kept][:-1]][: len(kept)]
    whole = np.flatnonzero(~broken)
    polygons = shapely.polygons(made[shell])
    holes = np.searchsorted(whole, part[kept][~shell])
    if len(holes):
        pierced, first = np.unique(holes, return_index=True)
        for row, group in zip(pierced, np.split(made[~shell], first[1:]), strict=True):
            polygons[row] = shapely.polygons(made[shell][row], group)
    found = parts.copy()
    sound = shapely.is_valid(polygons)
    found[whole[sound]] = polygons[sound]
    return found
