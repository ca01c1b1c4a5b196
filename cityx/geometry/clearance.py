"""How far points are from walls, kerbs and shores, and how to make them keep away."""

from __future__ import annotations

from collections.abc import Iterator
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


CELL = 10.0  # metres; points are looked up by such cells
MOST_CELLS = 16  # that a triangle's box may meet; larger triangles ask a search tree
ROWS = np.int64(1 << 24)  # of cells, more than any site has
AT_ONCE = 20_000  # points looked up at once; each may have hundreds of triangles in its cell


@dataclass(frozen=True)
class TriangleCells:
    """(t,) triangles by the cells that their boxes meet, for several questions about them.

    Attributes
    ----------
    vertices, triangles
        (v, 2) float, metres, and the (t, 3) corners among them.
    cell, triangle
        (c,) int64 each, a cell and a triangle whose box meets it, sorted by cell.
    large, tree
        The triangles that meet too many cells, and an STRtree over them.
    """

    vertices: FloatArray
    triangles: NDArray[np.int32]
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
    row, part = _counted(cells[small])
    row = small[row]
    across = size[row, 1]
    cell = _cell_number(low[row, 0] + part // across, low[row, 1] + part % across)
    order = np.argsort(cell, kind="stable")
    tree = shapely.STRtree(shapely.polygons(vertices[triangles[large]]))
    return TriangleCells(vertices, triangles, cell[order], row[order], large, tree)


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
    from cityx.geometry.triangle_kernel import among_cells

    spots = np.ascontiguousarray(np.asarray(xy, float).reshape(-1, 2))
    counts = np.zeros(0, bool) if among is None else np.asarray(among, bool)
    shapes = prepared.vertices, prepared.triangles
    for begin in range(0, len(spots), AT_ONCE):
        some = spots[begin : begin + AT_ONCE]
        cell = _cell_number(*_cells(some).T)
        first, last = _span(prepared.cell, cell)
        parts = [among_cells(some, first, last, prepared.triangle, counts, *shapes)]
        if len(prepared.large):  # those whose box holds it
            held, shape = prepared.tree.query(shapely.points(some))
            order = np.argsort(held, kind="stable")
            first, last = _span(held[order], np.arange(len(some)))
            large = prepared.large[shape[order]]
            parts.append(among_cells(some, first, last, large, counts, *shapes))
        spot, triangle = (np.concatenate(column) for column in zip(*parts, strict=True))
        yield spot + begin, triangle


def _span(
    ascending: NDArray[np.int64], value: NDArray[np.int64]
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return where each value begins and ends among ascending ones."""
    return np.searchsorted(ascending, value, "left"), np.searchsorted(ascending, value, "right")


def _counted(count: NDArray[np.int64]) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return each row as often as it counts, and the running number within it."""
    row = np.repeat(np.arange(len(count)), count)
    return row, np.arange(len(row)) - np.repeat(np.cumsum(count) - count, count)
