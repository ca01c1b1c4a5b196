"""How far points are from walls, kerbs and shores, and how to make them keep away."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely
from numpy.typing import ArrayLike, NDArray

FloatArray = NDArray[np.float64]
BoolArray = NDArray[np.bool_]


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
    """Tell which of (n, 2) points lie nearer than `distance` (one, or one per shape) to a shape."""
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


CELL = 20.0  # metres; points are looked up by such cells
MOST_TABLE = 4_000_000  # cells of a table of those that are taken
MOST_CELLS = 64  # that a triangle's box may meet; larger triangles ask a search tree


@dataclass(frozen=True)
class TriangleCells:
    """(t,) triangles with the cells that their boxes meet, for several questions about them.

    Attributes
    ----------
    corners
        (t, 3, 2) float, metres.
    low, size
        (t, 2) int, first cell and number of cells along x and y.
    """

    corners: FloatArray
    low: NDArray[np.int64]
    size: NDArray[np.int64]


def cells_of_triangles(
    vertices: NDArray[np.float64], triangles: NDArray[np.int32]
) -> TriangleCells:
    """Prepare (t, 3) triangles over (v, 2) vertices."""
    corners = vertices[triangles]
    low = np.floor(corners.min(axis=1) / CELL).astype(np.int64)
    size = np.floor(corners.max(axis=1) / CELL).astype(np.int64) - low + 1
    return TriangleCells(corners, low, size)


def in_triangles(
    xy: ArrayLike, vertices: NDArray[np.float64], triangles: NDArray[np.int32]
) -> BoolArray:
    """Tell which of (n, 2) points lie in or on one of (t, 3) triangles over (v, 2) vertices."""
    return np.asarray(triangle_at(xy, cells_of_triangles(vertices, triangles)) >= 0)


def triangle_at(xy: ArrayLike, prepared: TriangleCells) -> NDArray[np.int64]:
    """Find the triangle under each of (n, 2) points.

    Parameters
    ----------
    xy
        (n, 2) float, metres.
    prepared
        The triangles.

    Returns
    -------
    triangle
        (n,) the highest number of a triangle that holds the point or has it on its rim, -1 for
        none.
    """
    spots = np.asarray(xy, float).reshape(-1, 2)
    found = np.full(len(spots), -1, np.int64)
    if not len(spots) or not len(prepared.low):
        return found
    low, size = prepared.low, prepared.size
    near = _meets(low, low + size, np.floor(spots / CELL).astype(np.int64))
    low, size, corners = low[near], size[near], prepared.corners[near]
    cells = size[:, 0] * size[:, 1]
    large = np.flatnonzero(cells > MOST_CELLS)
    if len(large):
        shapes = shapely.polygons(corners[large])
        tree = shapely.STRtree(shapely.points(spots))
        shape, spot = tree.query(shapes, predicate="intersects")
        np.maximum.at(found, spot, near[large[shape]])
    small = np.flatnonzero(cells <= MOST_CELLS)
    triangle, part = _counted(cells[small])
    triangle = small[triangle]
    across = size[triangle, 1]
    i, j = low[triangle, 0] + part // across, low[triangle, 1] + part % across
    width = np.int64(1 << 24)
    cell = np.floor(spots / CELL).astype(np.int64)
    key = cell[:, 0] * width + cell[:, 1]
    order = np.argsort(key, kind="stable")
    known, start, count = np.unique(key[order], return_index=True, return_counts=True)
    wanted = i * width + j
    at = np.minimum(np.searchsorted(known, wanted), len(known) - 1)
    met = known[at] == wanted
    pair, number = _counted(count[at[met]])
    spot = order[start[at[met]][pair] + number]
    a, b, c = corners[triangle[met][pair]].transpose(1, 0, 2)
    turns = np.stack([_turn(a, b, spots[spot]), _turn(b, c, spots[spot]), _turn(c, a, spots[spot])])
    hit = (turns >= 0).all(axis=0) | (turns <= 0).all(axis=0)
    np.maximum.at(found, spot[hit], near[triangle[met][pair][hit]])
    return found


def _meets(
    low: NDArray[np.int64], high: NDArray[np.int64], cell: NDArray[np.int64]
) -> NDArray[np.int64]:
    """Rows of those ranges of cells, (t, 2) from `low` to below `high`, that hold a taken cell."""
    first, last = cell.min(axis=0), cell.max(axis=0)
    shape = last - first + 2
    if int(shape[0]) * int(shape[1]) > MOST_TABLE:
        return np.flatnonzero(((low <= last) & (high > first)).all(axis=1))
    table = np.zeros(shape, np.int64)
    at = cell - first + 1
    table[at[:, 0], at[:, 1]] = 1
    table = table.cumsum(axis=0).cumsum(axis=1)
    (i, j), (k, m) = (np.clip(edge - first, 0, shape - 1).T for edge in (low, high))
    return np.flatnonzero(table[k, m] - table[i, m] - table[k, j] + table[i, j] > 0)


def _counted(count: NDArray[np.int64]) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return each row as often as it counts, and the running number within it."""
    row = np.repeat(np.arange(len(count)), count)
    return row, np.arange(len(row)) - np.repeat(np.cumsum(count) - count, count)


def _turn(a: FloatArray, b: FloatArray, p: FloatArray) -> FloatArray:
    """Twice the area of the triangles a, b, p: positive where they turn left."""
    return np.asarray((b[:, 0] - a[:, 0]) * (p[:, 1] - a[:, 1])
                      - (b[:, 1] - a[:, 1]) * (p[:, 0] - a[:, 0]))  # fmt: skip
