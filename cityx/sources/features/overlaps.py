"""Overlapping outlines and volumes, made disjoint."""

from __future__ import annotations

from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.ids import UInt64Array
from cityx.sources.features.clipping import FloatArray, IntArray

TOLERANCE = 0.5  # square metres of overlap that is drawing noise
SAME = 0.9  # intersection over union from which two outlines are one building drawn twice
INSIDE = 0.8  # share of the smaller outline within the larger from which it is kept whole
LEVEL = 0.1  # metres by which heights must differ to count
ROUNDS = 3  # an extended volume may meet another one; three rounds settle every map tried


def overlapping_pairs(polygons: NDArray[Any]) -> IntArray:
    """Return (p, 2) rows i < j of polygons that share more than `TOLERANCE`, in row order."""
    first, second = shapely.STRtree(polygons).query(polygons, predicate="intersects")
    ordered = first < second
    first, second = first[ordered], second[ordered]
    # Neighbours that share a wall are most of the pairs; they are told without an intersection.
    real = ~shapely.touches(polygons[first], polygons[second])
    first, second = first[real], second[real]
    shared = shapely.area(_intersection(polygons[first], polygons[second]))
    pairs = np.column_stack([first, second])[shared > TOLERANCE]
    return np.asarray(pairs[np.lexsort((pairs[:, 1], pairs[:, 0]))], np.int64)


def _intersection(first: Any, second: Any) -> Any:
    return shapely.intersection(first, second)


def separate_outlines(
    polygons: NDArray[Any], worth: IntArray
) -> tuple[NDArray[Any], NDArray[np.bool_]]:
    """Make outlines disjoint: duplicates go, overlaps belong to one of the two.

    Of two that lie one in the other the smaller is kept whole, else the larger.

    Parameters
    ----------
    polygons, worth
        (n,) outlines, in an order that the file does not decide, and how much is known of each.

    Returns
    -------
    separated
        (n,) geometries, empty where the outline is used up.
    duplicate
        (n,) bool, dropped as a building drawn twice.
    """
    shapes = polygons.copy()
    duplicate = np.zeros(len(shapes), bool)
    pairs = overlapping_pairs(shapes) if len(shapes) else np.zeros((0, 2), np.int64)
    area = shapely.area(polygons)
    rank = np.lexsort((np.arange(len(shapes)), -np.round(area, 3)))
    order = np.empty(len(rank), np.int64)
    order[rank] = np.arange(len(rank))
    # From the largest pair down, so that the order of rows does not count.
    keyed = sorted(
        (tuple(sorted((order[i], order[j]))) for i, j in pairs.tolist()), key=lambda p: p
    )
    for large_rank, small_rank in keyed:
        large, small = int(rank[large_rank]), int(rank[small_rank])
        shared = shapely.area(_intersection(shapes[large], shapes[small]))
        if shared <= TOLERANCE:
            continue
        if shared > SAME * (area[large] + area[small] - shared):
            better = (worth[large], -order[large]) >= (worth[small], -order[small])
            lost = small if better else large
            duplicate[lost] = True
            shapes[lost] = shapely.Polygon()
        elif shared > INSIDE * area[small]:
            shapes[large] = shapely.difference(shapes[large], shapes[small])
        else:
            shapes[small] = shapely.difference(shapes[small], shapes[large])
    return shapes, duplicate


def separate_volumes(
    polygons: NDArray[Any],
    base: FloatArray,
    top: FloatArray,
    roof: FloatArray,
    walls: NDArray[np.bool_],
    ids: UInt64Array,
) -> tuple[NDArray[Any], FloatArray]:
    """Make volumes that overlap in plan and in height disjoint, and keep their union.

    Of two from the same base the higher keeps the ground they share. One that begins within
    another goes down to the other's base where they overlap, or starts on its flat roof.

    Returns
    -------
    polygons, base
        (n,) each; polygons may have become empty or of several pieces.
    """
    shapes, base = polygons.copy(), base.copy()
    if len(shapes) == 0:
        return shapes, base
    pairs = overlapping_pairs(shapes)
    for _ in range(ROUNDS):
        low = np.maximum(base[pairs[:, 0]], base[pairs[:, 1]])
        high = np.minimum(top[pairs[:, 0]], top[pairs[:, 1]])
        meeting = pairs[high - low > LEVEL]
        keys = np.column_stack([ids[meeting].min(axis=1), ids[meeting].max(axis=1)])
        meeting = meeting[np.lexsort((keys[:, 1], keys[:, 0]))]
        changed = False
        for i, j in meeting.tolist():
            changed |= _separate(int(i), int(j), shapes, base, top, roof, walls, ids)
        if not changed:
            break
    return shapes, base


def _separate(
    i: int,
    j: int,
    shapes: NDArray[Any],
    base: FloatArray,
    top: FloatArray,
    roof: FloatArray,
    walls: NDArray[np.bool_],
    ids: UInt64Array,
) -> bool:
    shared = shapely.area(_intersection(shapes[i], shapes[j]))
    if shared <= TOLERANCE or min(top[i], top[j]) - max(base[i], base[j]) <= LEVEL:
        return False
    if walls[i] != walls[j]:  # a canopy gives way to what has walls
        lost, kept = (j, i) if walls[i] else (i, j)
        shapes[lost] = shapely.difference(shapes[lost], shapes[kept])
        return True
    key_i = (round(base[i], 2), -round(top[i], 2), round(shapely.area(shapes[i]), 2), int(ids[i]))
    key_j = (round(base[j], 2), -round(top[j], 2), round(shapely.area(shapes[j]), 2), int(ids[j]))
    lower, upper = (i, j) if key_i < key_j else (j, i)
    if base[upper] - base[lower] <= LEVEL or top[upper] - top[lower] <= LEVEL:
        # From one base the first is the higher; swallowed ones lose what they share.
        shapes[upper] = shapely.difference(shapes[upper], shapes[lower])
    elif roof[lower] <= LEVEL:
        base[upper] = top[lower]
    elif shared > INSIDE * shapely.area(shapes[upper]):
        base[upper] = base[lower]
        shapes[lower] = shapely.difference(shapes[lower], shapes[upper])
    else:
        shapes[upper] = shapely.difference(shapes[upper], shapes[lower])
    return True
