"""Snap rounding: segments on a grid become edges that meet at grid points alone.

Every end and every crossing of two segments makes a grid point hot; a segment is led through the
hot points whose squares it passes. All predicates are exact on whole numbers.

References
----------
Hobby, "Practical segment intersection with finite precision output", 1999.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import shapely
from numpy.typing import ArrayLike, NDArray

from cityx.geometry.ranges import numbered
from cityx.system.cores import in_threads

IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]

FINE = 128  # parts of a grid step in which segments are given: whole numbers make tests exact
REACH = 1000 * FINE  # the boxes by which slanting segments are compared are no larger
CORNERS = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)])  # of a square; the first is its own
BATCH = 25_000  # boxes that are compared with all others at once, by one thread


def snap_round(begin: ArrayLike, end: ArrayLike) -> tuple[IntArray, IntArray]:
    """Divide segments so that any two have whole edges in common, or end points, or nothing.

    Parameters
    ----------
    begin, end
        (m, 2) int64, ends of segments, in parts of a grid step (`FINE`), below 2**30 apart.

    Returns
    -------
    points
        (n, 2) int64, the places where edges end, in grid steps, in rising order.
    edges
        (k, 2) int64 into the points, each once, the lower end first. They meet at their ends alone.
    """
    first, second = _distinct(np.asarray(begin, np.int64), np.asarray(end, np.int64))
    if not len(first):
        return np.zeros((0, 2), np.int64), np.zeros((0, 2), np.int64)
    boxes, owner = _boxes(first, second)
    tree = shapely.STRtree(boxes)
    crossings, pairs = _crossings(first, second, boxes, owner, tree)
    hot = np.concatenate([_square(first), _square(second), crossings])
    points, at = places(hot)
    at = at[2 * len(first) :]
    segment, point = _passed(first, second, points, boxes, owner)
    segment = np.concatenate([segment, pairs[:, 0], pairs[:, 1]])
    point = np.concatenate([point, at, at])
    ahead = second - first
    along = ((FINE * points[point] - first[segment]) * ahead[segment]).sum(axis=1)
    order = np.lexsort((along, segment))
    segment, point = segment[order], point[order]
    step = (segment[1:] == segment[:-1]) & (point[1:] != point[:-1])
    low = np.minimum(point[:-1], point[1:])[step]
    high = np.maximum(point[:-1], point[1:])[step]
    keys = np.unique(low * len(points) + high)
    return points, np.column_stack([keys // len(points), keys % len(points)])


def _square(spots: NDArray[Any]) -> IntArray:
    """Return the grid points to whose squares places belong."""
    return np.asarray(np.floor((spots + FINE // 2) / FINE).astype(np.int64))


def places(points: IntArray) -> tuple[IntArray, IntArray]:
    """Return the distinct rows of (n, 2) whole numbers in order, and the number of each row."""
    import pandas as pd

    low = points.min(axis=0, initial=0)
    keys = ((points[:, 0] - low[0]) << np.int64(32)) | (points[:, 1] - low[1])
    # Hashing first and sorting what is distinct takes a third of the time of `np.unique`.
    code, found = pd.factorize(keys)
    order = np.argsort(found)
    number = np.empty(len(order), np.int64)
    number[order] = np.arange(len(order))
    spots = found[order]
    return np.column_stack([spots >> 32, spots & 0xFFFFFFFF]) + low, number[code]


def _distinct(begin: IntArray, end: IntArray) -> tuple[IntArray, IntArray]:
    """Return each segment once, its end to the west, or to the south, first."""
    turned = (begin[:, 0] > end[:, 0]) | ((begin[:, 0] == end[:, 0]) & (begin[:, 1] > end[:, 1]))
    low = np.where(turned[:, None], end, begin)
    high = np.where(turned[:, None], begin, end)
    points, number = places(np.concatenate([low, high]))
    one, other = number[: len(low)], number[len(low) :]
    keys = np.unique(
        (one * len(points) + other)[(_square(points)[one] != _square(points)[other]).any(axis=1)]
    )
    return points[keys // max(len(points), 1)], points[keys % max(len(points), 1)]


def _boxes(first: IntArray, second: IntArray) -> tuple[NDArray[Any], IntArray]:
    """Boxes half a step round pieces of the segments, and the segment of each.

    A box is the line between two of its corners, of which search trees take the bounds.
    """
    size = np.abs(second - first)
    count = np.maximum(-(-size.min(axis=1) // REACH), 1)
    owner = np.repeat(np.arange(len(first)), count)
    number = numbered(count)
    ahead = (second - first)[owner] / count[owner][:, None]
    begin = first[owner] + ahead * number[:, None]
    end = begin + ahead
    low, high = np.minimum(begin, end) - FINE / 2, np.maximum(begin, end) + FINE / 2
    return shapely.linestrings(np.stack([low, high], axis=1)), owner


def _crossings(
    first: IntArray, second: IntArray, boxes: NDArray[Any], owner: IntArray, tree: shapely.STRtree
) -> tuple[IntArray, IntArray]:
    """Grid points next to where segments cross inside of both, (c, 2), and the pairs, (c, 2)."""

    def some(start: int) -> tuple[IntArray, IntArray]:
        row, other = tree.query(boxes[start : start + BATCH])
        one, two = owner[row + start], owner[other]
        pair = np.column_stack([one, two])[one < two]
        a, b, c, d = _ends(first, second, pair)
        from_one, to_one = _side(a, b, c), _side(a, b, d)
        apart = np.flatnonzero(np.sign(from_one) * np.sign(to_one) < 0)
        pair, from_one, to_one = pair[apart], from_one[apart], to_one[apart]
        a, b, c, d = _ends(first, second, pair)
        across = np.sign(_side(c, d, a)) * np.sign(_side(c, d, b)) < 0
        share = from_one[across] / (from_one - to_one)[across]
        spot = c[across] + share[:, None] * (d - c)[across]
        return _square(spot), pair[across]

    parts = in_threads(some, range(0, len(boxes), BATCH))
    found, pairs = (np.concatenate(column) for column in zip(*parts, strict=True))
    # Two slanting segments may have met in several pairs of boxes.
    pair, index = np.unique(pairs, axis=0, return_index=True)
    return found[index], pair


def _ends(first: IntArray, second: IntArray, pair: IntArray) -> tuple[IntArray, ...]:
    """Return both ends of the one and of the other segment of pairs, (k, 2) each."""
    one, two = pair.T
    return first[one], second[one], first[two], second[two]


def _side(a: IntArray, b: IntArray, c: IntArray) -> IntArray:
    """Twice the area of triangles: above zero where c lies left of the line from a to b."""
    u, v = b - a, c - a
    return np.asarray(u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0])


def _passed(
    first: IntArray, second: IntArray, points: IntArray, boxes: NDArray[Any], owner: IntArray
) -> tuple[IntArray, IntArray]:
    """Segments and the points whose squares, west and south sides included, they pass."""
    tree = shapely.STRtree(shapely.points(FINE * points.astype(float)))
    half = FINE // 2

    def some(start: int) -> IntArray:
        row, point = tree.query(boxes[start : start + BATCH])
        segment = owner[row + start]
        a, b, centre = first[segment], second[segment], FINE * points[point]
        low, high = np.minimum(a, b), np.maximum(a, b)
        over = ((low < centre + half) & (high >= centre - half)).all(axis=1)
        segment, point = segment[over], point[over]
        a, b, centre = first[segment], second[segment], FINE * points[point]
        corners = [_side(a, b, centre + half * way) for way in CORNERS]
        most, least = np.maximum.reduce(corners), np.minimum.reduce(corners)
        upright = (a == b).any(axis=1)
        inside = upright | ((most > 0) & (least < 0)) | (corners[0] == 0)
        return np.asarray(segment[inside] * len(points) + point[inside])

    keys = np.unique(np.concatenate(in_threads(some, range(0, len(boxes), BATCH))))
    return keys // len(points), keys % len(points)
