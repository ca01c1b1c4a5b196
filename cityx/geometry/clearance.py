"""Clearance: distances of points from walls, kerbs and shores, and how to keep it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely
from numpy.typing import ArrayLike, NDArray

from cityx.geometry.arrays import BoolArray, FloatArray, IntArray


@dataclass(frozen=True)
class Spots:
    """Points with their search tree, for several questions about the same points.

    Attributes
    ----------
    xy
        (n, 2) float, metres.
    points
        (n,) shapely Points.
    tree
        STRtree over ``points``.
    """

    xy: FloatArray
    points: NDArray[Any]
    tree: Any


def spots_of(xy: ArrayLike | Spots) -> Spots:
    """Make spots of (n, 2) points; spots are returned as they are."""
    if isinstance(xy, Spots):
        return xy
    array = np.asarray(xy, float).reshape(-1, 2)
    points = shapely.points(array)
    return Spots(array, points, shapely.STRtree(points))


def distance_within(xy: ArrayLike | Spots, shapes: ArrayLike, reach: float) -> FloatArray:
    """Measure the distance of (n, 2) points to the nearest of some shapes; inf beyond `reach`."""
    spots = spots_of(xy)
    nearest = np.full(len(spots.xy), np.inf)
    geometry = np.asarray(shapes, dtype=object)
    if not len(spots.xy) or not len(geometry):
        return nearest
    shape, spot = spots.tree.query(geometry, predicate="dwithin", distance=reach)
    np.minimum.at(nearest, spot, shapely.distance(spots.points[spot], geometry[shape]))
    return nearest


def near_any(xy: ArrayLike | Spots, shapes: ArrayLike, distance: ArrayLike) -> BoolArray:
    """Return which of (n, 2) points lie nearer to a shape than `distance`, one or one per shape."""
    spots = spots_of(xy)
    near = np.zeros(len(spots.xy), bool)
    geometry = np.asarray(shapes, dtype=object)
    if not len(spots.xy) or not len(geometry):
        return near
    near[spots.tree.query(geometry, predicate="dwithin", distance=distance)[1]] = True
    return near


def push_off(
    xy: ArrayLike | Spots, lines: ArrayLike, half_width: ArrayLike, *, most: float
) -> tuple[FloatArray, BoolArray]:
    """Move points out of strips along lines, square to the line.

    Parameters
    ----------
    xy
        (n, 2) float, metres.
    lines
        (m,) shapely LineStrings.
    half_width
        (m,) float, half widths of the strips.
    most
        Metres; a point that would have to go farther is given up.

    Returns
    -------
    moved, free
        (n, 2) points, and whether each is outside every strip now.
    """
    before = spots_of(xy)
    moved = before.xy.copy()
    geometry: NDArray[Any] = np.asarray(lines, dtype=object)
    width = np.broadcast_to(np.asarray(half_width, float), (len(geometry),))
    free = np.ones(len(moved), bool)
    if not len(moved) or not len(geometry):
        return moved, free
    slack = 0.01  # metres beyond the edge, so that the second look finds the point outside
    now = before
    for _ in range(2):
        line, spot = now.tree.query(geometry, predicate="dwithin", distance=width)
        if not len(spot):
            break
        gap = shapely.distance(now.points[spot], geometry[line])
        need = width[line] - gap
        # Only the strip that asks for the longest way counts; ties go to the first line.
        order = np.lexsort((line, -need, spot))
        first = order[np.r_[True, spot[order][1:] != spot[order][:-1]]]
        spot, line, gap = spot[first], line[first], gap[first]
        foot = shapely.get_coordinates(
            shapely.line_interpolate_point(
                geometry[line], shapely.line_locate_point(geometry[line], now.points[spot])
            )
        )
        away = moved[spot] - foot
        ok = gap > 0.05  # nearer than that, no side is the right one
        away /= np.maximum(gap, 0.05)[:, None]
        moved[spot] = np.where(ok[:, None], foot + away * (width[line] + slack)[:, None],
                               moved[spot])  # fmt: skip
        now = spots_of(moved)
    free = ~near_any(now, geometry, np.maximum(width - slack, 0.0))
    free &= np.hypot(*(moved - before.xy).T) <= most
    return moved, free


RING_STEP, RING_WAYS = 0.5, 16  # metres between the rings that are searched, and places on each


def nearest_free(
    xy: FloatArray, is_free: Callable[[IntArray, FloatArray], BoolArray], *, reach: float
) -> tuple[FloatArray, BoolArray]:
    """Find the nearest free place to each of some points, on rings about them.

    Parameters
    ----------
    xy
        (n, 2) float, metres.
    is_free
        Tells of the (k,) rows of points and (k, 2) places for them which places are free.
    reach
        Metres that a point may be moved at most.

    Returns
    -------
    moved, found
        (n, 2) places, and whether each is free; the others stay where they are.
    """
    angle = np.arange(RING_WAYS) * 2 * np.pi / RING_WAYS
    ring = np.column_stack([np.cos(angle), np.sin(angle)])  # (w, 2)
    moved, left = np.array(xy, float), np.arange(len(xy))
    for radius in np.arange(0.0, reach + 1e-9, RING_STEP).tolist():
        if not len(left):
            break
        spots = moved[left, None] + radius * (ring if radius else ring[:1])  # (l, w, 2)
        size = spots.shape[1]
        free = is_free(np.repeat(left, size), spots.reshape(-1, 2)).reshape(-1, size)
        hit = free.any(axis=1)
        moved[left[hit]] = spots[hit, free.argmax(axis=1)[hit]]
        left = left[~hit]
    found = np.ones(len(moved), bool)
    found[left] = False
    return moved, found
