"""How far points are from walls, kerbs and shores, and how to make them keep away."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely
from numpy.typing import ArrayLike, NDArray

from cityx.geometry.ranges import counted

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


CELL = 4.0  # metres; points are looked up by such cells
MOST_CELLS = 36  # that a triangle's box may meet; larger triangles ask a search tree
ROWS = np.int64(1 << 24)  # of cells, more than any site has
AT_ONCE = 20_000  # points looked up at once; each may have hundreds of triangles in its cell


@dataclass(frozen=True)
class TriangleCells:
    """(t,) triangles by the cells that their boxes meet, for several questions about them.

    Attributes
    ----------
    vertices, triangles
        (v, 2) float, metres, and the (t, 3) corners among them.
    boxes
        (2, 2, t) float64, metres, of x and of y their least and their greatest.
    cell, triangle
        (c,) int64 each, a cell and a triangle whose box meets it, sorted by cell.
    large, tree
        The triangles that meet too many cells, and an STRtree over them.
    """

    vertices: FloatArray
    triangles: NDArray[np.int32]
    boxes: FloatArray
    cell: NDArray[np.int64]
    triangle: NDArray[np.int64]
    large: NDArray[np.int64]
    tree: Any


def cells_of_triangles(
    vertices: NDArray[np.float64], triangles: NDArray[np.int32]
) -> TriangleCells:
    """Prepare (t, 3) triangles over (v, 2) vertices."""
    a, b, c = _cells(vertices)[triangles].transpose(1, 0, 2)
    low = np.minimum(np.minimum(a, b), c)
    size = np.maximum(np.maximum(a, b), c) - low + 1
    cells = size[:, 0] * size[:, 1]
    small, large = np.flatnonzero(cells <= MOST_CELLS), np.flatnonzero(cells > MOST_CELLS)
    row, part = counted(cells[small])
    row = small[row]
    across = size[row, 1]
    cell = _cell_number(low[row, 0] + part // across, low[row, 1] + part % across)
    order = np.argsort(cell, kind="stable")
    tree = shapely.STRtree(shapely.polygons(vertices[triangles[large]]))
    boxes = np.array([[end(end(*at[:2]), at[2]) for end in (np.minimum, np.maximum)]
                      for at in vertices.T[:, triangles.T]])  # fmt: skip
    return TriangleCells(vertices, triangles, boxes, cell[order], row[order], large, tree)


def _cells(xy: FloatArray) -> NDArray[np.int64]:
    return np.asarray(np.floor(xy / CELL), np.int64)


def _cell_number(i: NDArray[np.int64], j: NDArray[np.int64]) -> NDArray[np.int64]:
    return np.asarray(i * ROWS + j)


def in_triangles(
    xy: ArrayLike, vertices: NDArray[np.float64], triangles: NDArray[np.int32]
) -> BoolArray:
    """Tell which of (n, 2) points lie in or on one of (t, 3) triangles over (v, 2) vertices."""
    return np.asarray(triangle_at(xy, cells_of_triangles(vertices, triangles)) >= 0)


def triangle_at(
    xy: ArrayLike, prepared: TriangleCells, among: BoolArray | None = None
) -> NDArray[np.int64]:
    """Find the triangle under each of (n, 2) points.

    Parameters
    ----------
    xy
        (n, 2) float, metres.
    prepared
        The triangles.
    among
        (t,) those that count; all when left out.

    Returns
    -------
    triangle
        (n,) the highest number of a triangle that holds the point or has it on its rim, -1 for
        none.
    """
    spots = np.asarray(xy, float).reshape(-1, 2)
    found = np.full(len(spots), -1, np.int64)
    for spot, triangle in triangles_at(spots, prepared, among):
        np.maximum.at(found, spot, triangle)
    return found


def triangles_at(
    xy: ArrayLike, prepared: TriangleCells, among: BoolArray | None = None
) -> Iterator[tuple[NDArray[np.int64], NDArray[np.int64]]]:
    """Yield, for some points after the others, all pairs of a point and a triangle that holds it.

    Parameters
    ----------
    xy, prepared, among
        As for `triangle_at`.

    Yields
    ------
    point, triangle
        (k,) each.
    """
    spots = np.asarray(xy, float).reshape(-1, 2)
    for begin in range(0, len(spots), AT_ONCE):
        some = spots[begin : begin + AT_ONCE]
        spot, triangle = _candidates(some, prepared)
        if among is not None:
            wanted = np.flatnonzero(among[triangle])
            spot, triangle = spot[wanted], triangle[wanted]
        for axis in (0, 1):
            near = _within(some[spot, axis], prepared.boxes[axis], triangle)
            spot, triangle = spot[near], triangle[near]
        held = _holds(prepared, triangle, some[spot])
        yield spot[held] + begin, triangle[held]


def _candidates(
    spots: FloatArray, prepared: TriangleCells
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Pairs of points and triangles: small ones of the same cell, large ones whose box holds it."""
    cell = _cell_number(*_cells(spots).T)
    first, last = (np.searchsorted(prepared.cell, cell, side) for side in ("left", "right"))
    spot, number = counted(last - first)
    triangle = prepared.triangle[first[spot] + number]
    if not len(prepared.large):
        return spot, triangle
    held, shape = prepared.tree.query(shapely.points(spots))
    return np.concatenate([spot, held]), np.concatenate([triangle, prepared.large[shape]])


def _within(at: FloatArray, boxes: FloatArray, triangle: NDArray[np.int64]) -> NDArray[np.int64]:
    """Rows of those that lie within the boxes, (2, t), of triangles along an axis."""
    return np.flatnonzero((at >= boxes[0, triangle]) & (at <= boxes[1, triangle]))


def _holds(prepared: TriangleCells, triangle: NDArray[np.int64], xy: FloatArray) -> BoolArray:
    """Tell which triangles have a point in them or on their rim, whichever way round they are."""
    corner = prepared.triangles[triangle].T
    x, y = (prepared.vertices[corner, axis] - xy[:, axis] for axis in (0, 1))  # (3, k) each
    turn = [x[k - 1] * y[k] - y[k - 1] * x[k] for k in range(3)]
    left = np.logical_and.reduce([side >= 0.0 for side in turn])
    right = np.logical_and.reduce([side <= 0.0 for side in turn])
    return np.asarray(left | right)
