"""Which triangles lie under points, looked up by the cells of a grid that they meet."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely
from numpy.typing import ArrayLike, NDArray

from cityx.geometry.ranges import counted

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]

CELL = 3.0  # metres; points are looked up by such cells
FEW_CELLS = 16  # of a box; a triangle counts to all of them, a larger one to those it reaches
MOST_CELLS = 400  # that a triangle may reach; larger ones ask a search tree
ROWS = np.int64(1 << 24)  # of cells, more than any site has
AT_ONCE = 20_000  # points looked up at once; each may have hundreds of triangles in its cell
SLACK, LEVEL = 1e-6, 1e-6  # metres by which a row of cells is taken longer; rise of a level side


@dataclass(frozen=True)
class TriangleCells:
    """(t,) triangles by the cells that they meet, for several questions about them.

    Attributes
    ----------
    vertices, triangles
        (v, 2) float, metres, and the (t, 3) corners among them.
    boxes
        (2, 2, t) float64, metres, of x and of y their least and their greatest.
    cell, start, triangle
        (c,) cells that triangles meet, rising; (c + 1,) where each begins in (k,) triangles.
    large, tree
        The triangles that meet too many cells, and an STRtree over them.
    """

    vertices: FloatArray
    triangles: NDArray[np.int32]
    boxes: FloatArray
    cell: IntArray
    start: IntArray
    triangle: NDArray[np.int32]
    large: NDArray[np.int32]
    tree: Any


def cells_of_triangles(
    vertices: NDArray[np.float64], triangles: NDArray[np.int32]
) -> TriangleCells:
    """Prepare (t, 3) triangles over (v, 2) vertices."""
    boxes = np.array([[end(end(*at[:2]), at[2]) for end in (np.minimum, np.maximum)]
                      for at in vertices.T[:, triangles.T]], float)  # fmt: skip
    low, high = _cells(boxes).swapaxes(0, 1)
    size = high - low + 1
    few = size.prod(axis=0) <= FEW_CELLS
    row, part = counted(np.where(few, size[1], 0), np.int32)
    first, last = low[0, row], high[0, row]
    level = low[1, row] + part
    wide = np.flatnonzero(~few).astype(np.int32)
    band, part = counted(size[1, wide], np.int32)
    own = wide[band]
    height = low[1, own] + part
    reach = _reaches(vertices, triangles[wide], band, height)
    begin, end = _cells(reach)
    large = np.bincount(band, end - begin + 1, len(wide)) > MOST_CELLS
    kept = np.flatnonzero(~large[band])
    row, level = np.concatenate([row, own[kept]]), np.concatenate([level, height[kept]])
    first, last = np.concatenate([first, begin[kept]]), np.concatenate([last, end[kept]])
    run, part = counted(last - first + 1, np.int32)
    cell, triangle = _cell_number(first[run] + part, level[run]), row[run]
    order = np.argsort(cell, kind="stable")
    cell = cell[order]
    start = np.flatnonzero(np.r_[True, cell[1:] != cell[:-1]][: len(cell)])
    tree = shapely.STRtree(shapely.polygons(vertices[triangles[wide[large]]]))
    return TriangleCells(
        vertices, triangles, boxes, cell[start], np.r_[start, len(cell)], triangle[order],
        wide[large], tree,
    )  # fmt: skip


def _reaches(
    vertices: FloatArray, triangles: NDArray[np.int32], band: NDArray[np.int32],
    height: NDArray[np.int32],
) -> FloatArray:  # fmt: skip
    """(2, r) the least and the greatest x of triangles within rows of cells, a little more.

    Parameters
    ----------
    vertices, triangles
        The (w, 3) triangles.
    band, height
        (r,) triangle and number of each row of cells that one meets.
    """
    south, north = CELL * height, CELL * (height + 1)
    least, most = np.full(len(band), np.inf), np.full(len(band), -np.inf)
    for side in range(3):
        p, q = (np.asarray(vertices[triangles[:, side - k]], float).T for k in range(2))
        rise = q[1] - p[1]
        slanting = np.abs(rise) > LEVEL
        slope = np.where(slanting, q[0] - p[0], 0.0) / np.where(slanting, rise, 1.0)
        (px, py), (qx, qy), slope, slanting = p[:, band], q[:, band], slope[band], slanting[band]
        met = (np.maximum(py, qy) >= south) & (np.minimum(py, qy) <= north)
        for x, y in ((px, py), (qx, qy)):
            at = np.where(slanting, px + (np.clip(y, south, north) - py) * slope, x)
            least = np.where(met, np.minimum(least, at), least)
            most = np.where(met, np.maximum(most, at), most)
    return np.stack([least - SLACK, most + SLACK])


def _cells(xy: FloatArray) -> NDArray[np.int32]:
    return np.asarray(np.floor(xy / CELL), np.int32)


def _cell_number(i: NDArray[np.int32], j: NDArray[np.int32]) -> IntArray:
    return np.asarray(i.astype(np.int64) * ROWS + j)


def in_triangles(
    xy: ArrayLike, vertices: NDArray[np.float64], triangles: NDArray[np.int32]
) -> BoolArray:
    """Tell which of (n, 2) points lie in or on one of (t, 3) triangles over (v, 2) vertices."""
    return np.asarray(triangle_at(xy, cells_of_triangles(vertices, triangles)) >= 0)


def triangle_at(xy: ArrayLike, prepared: TriangleCells, among: BoolArray | None = None) -> IntArray:
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
) -> Iterator[tuple[IntArray, IntArray]]:
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


def _candidates(spots: FloatArray, prepared: TriangleCells) -> tuple[IntArray, IntArray]:
    """Pairs of points and triangles: small ones of the same cell, large ones whose box holds it."""
    cell = _cell_number(*_cells(spots).T)
    row = np.searchsorted(prepared.cell, cell)
    known = np.flatnonzero(row < len(prepared.cell))
    known = known[prepared.cell[row[known]] == cell[known]]
    row = row[known]
    spot, number = counted(np.diff(prepared.start)[row])
    triangle = prepared.triangle[prepared.start[row][spot] + number]
    spot = known[spot]
    if not len(prepared.large):
        return spot, triangle
    held, shape = prepared.tree.query(shapely.points(spots))
    return np.concatenate([spot, held]), np.concatenate([triangle, prepared.large[shape]])


def _within(at: FloatArray, boxes: FloatArray, triangle: IntArray) -> IntArray:
    """Rows of those that lie within the boxes, (2, t), of triangles along an axis."""
    return np.flatnonzero((at >= boxes[0, triangle]) & (at <= boxes[1, triangle]))


def _holds(prepared: TriangleCells, triangle: IntArray, xy: FloatArray) -> BoolArray:
    """Tell which triangles have a point in them or on their rim, whichever way round they are."""
    corner = prepared.triangles[triangle].T
    x, y = (prepared.vertices[corner, axis] - xy[:, axis] for axis in (0, 1))  # (3, k) each
    turn = [x[k - 1] * y[k] - y[k - 1] * x[k] for k in range(3)]
    left = np.logical_and.reduce([side >= 0.0 for side in turn])
    right = np.logical_and.reduce([side <= 0.0 for side in turn])
    return np.asarray(left | right)
