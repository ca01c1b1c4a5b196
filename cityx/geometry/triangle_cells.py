"""Find the triangles under points, by the grid cells that triangles intersect."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cityx.geometry.arrays import BoolArray, FloatArray, IntArray
from cityx.geometry.ranges import counted
from cityx.geometry.scatter import cells_of_boxes

CELL, COARSER = 3.0, 8  # metres of the finest cells, and how many times larger the next ones are
FEW_CELLS = 16  # of a box; a triangle counts to all of them, a larger one to those it reaches
MOST_CELLS = 36  # that a triangle may reach; larger ones are looked up by larger cells
AT_ONCE = 20_000  # points looked up at once; each may have hundreds of triangles in its cell
# Points, or triangles, from which compiled kernels do the work: up to four times as fast where
# triangles lie dense, for the second that it takes to load numba and the few to compile them once.
MANY = 1_000_000
SOME = 1_000  # points from which those find them among many triangles
RUNS = 1_000_000  # rows of cells that are told cell by cell at once
BATCH = 50_000  # triangles whose rows of cells are found at once
SLACK, LEVEL = 1e-6, 1e-6  # metres by which a row of cells is taken longer; rise of a level side


@dataclass(frozen=True)
class Cells:
    """Some triangles by cells of one size.

    Attributes
    ----------
    size, low, rows
        Metres of a cell; column and row of the first one, and how many rows are numbered.
    cell, start, triangle
        (c,) cells that triangles meet, rising; (c + 1,) where each begins in (k,) triangles.
    """

    size: float
    low: NDArray[np.int32]
    rows: int
    cell: IntArray
    start: NDArray[np.int32]
    triangle: NDArray[np.int32]


@dataclass(frozen=True)
class TriangleCells:
    """(t,) triangles by the cells that they meet, for several questions about them.

    Attributes
    ----------
    vertices, triangles
        (v, 2) float, metres, and the (t, 3) corners among them.
    boxes
        (2, 2, t) float64, metres, of x and of y their least and their greatest.
    levels
        All of them, the larger by larger cells.
    """

    vertices: FloatArray
    triangles: NDArray[np.int32]
    boxes: FloatArray
    levels: tuple[Cells, ...]


def reaching(points: FloatArray, corners: NDArray[np.int32], box: ArrayLike) -> BoolArray:
    """Return which of (t, k) shapes have a box that meets (xmin, ymin, xmax, ymax).

    Parameters
    ----------
    points
        (v, 2) float.
    corners
        Rows of points of each shape.
    """
    low, high = np.asarray(box, float).reshape(2, 2)
    # The sides of the box beyond which each point lies, a bit each: what has all of its points
    # beyond the same side does not meet it (Cohen and Sutherland).
    beyond = np.zeros(len(points), np.uint8)
    for axis in (0, 1):
        beyond |= (points[:, axis] > high[axis]).astype(np.uint8) << (2 * axis)
        beyond |= (points[:, axis] < low[axis]).astype(np.uint8) << (2 * axis + 1)
    shared = np.full(len(corners), 15, np.uint8)
    for column in corners.T:
        shared &= beyond[column]
    return np.asarray(shared == 0)


def near_boxes(
    points: FloatArray, corners: NDArray[np.int32], boxes: FloatArray, edge: float
) -> IntArray:
    """Return the rows of (t, k) shapes whose box meets one of many, and of some close by.

    Parameters
    ----------
    points, corners
        (v, 2) float, and the rows of points of each shape.
    boxes
        (n, 4) float, xmin, ymin, xmax, ymax.
    edge
        Metres, of the cells by which they are compared; shapes much larger are all returned.
    """
    if not len(boxes) or not len(corners):
        return np.zeros(0, np.int64)
    cells = cells_of_boxes(boxes, edge)
    corner, rows = cells.min(axis=0), int(np.ptp(cells[:, 1])) + 1
    known = _cell_number(cells[:, 0], cells[:, 1], corner, rows)
    low, high = (
        np.stack([end(points[:, axis][corners.T], axis=0) for axis in (0, 1)], axis=1) / edge
        for end in (np.min, np.max)
    )
    low = np.maximum(np.floor(low).astype(np.int64), corner)
    high = np.minimum(np.floor(high).astype(np.int64), cells.max(axis=0))
    size = np.maximum(high - low + 1, 0).prod(axis=1)
    large = size > MOST_CELLS
    row, number = counted(np.where(large, 0, size))
    width = (high - low + 1)[row, 0]
    cell = _cell_number(low[row, 0] + number % width, low[row, 1] + number // width, corner, rows)
    at = np.minimum(np.searchsorted(known, cell), len(known) - 1)
    large[row[known[at] == cell]] = True
    return np.flatnonzero(large)


def cells_of_triangles(
    vertices: NDArray[np.float64], triangles: NDArray[np.int32]
) -> TriangleCells:
    """Prepare (t, 3) triangles over (v, 2) vertices."""
    # The box of a triangle lies in one place, since they are asked for one here, one there.
    boxes = np.empty((len(triangles), 2, 2))
    many = len(triangles) >= MANY
    if many:
        from cityx.geometry.triangle_kernel import fill_boxes

        fill_boxes(*_of_one_kind(vertices, triangles), boxes)
    boxes = boxes.transpose(1, 2, 0)
    for axis, at in enumerate(() if many else vertices.T):
        one, two, three = at[triangles.T]
        boxes[axis, 0] = np.minimum(np.minimum(one, two), three)
        boxes[axis, 1] = np.maximum(np.maximum(one, two), three)
    rows, size = np.arange(len(triangles), dtype=np.int32), CELL
    levels: list[Cells] = []
    while len(rows) or not levels:
        listed = (_listed_many if many else _listed)(vertices, triangles, boxes, rows, size)
        level, rows = _level(size, listed), rows[~listed.fits]
        levels.append(level)
        size *= COARSER
    return TriangleCells(vertices, triangles, boxes, tuple(levels))


class _Listed(NamedTuple):
    """Cells of one size that triangles meet.

    Attributes
    ----------
    keys, bits
        (k,) int64 pairs, rising: the number of a cell, and in the last bits that of a triangle.
    low, rows
        As of `Cells`.
    fits
        (r,) which of the triangles are not too large.
    """

    keys: IntArray
    bits: int
    low: NDArray[np.int32]
    rows: int
    fits: BoolArray


def _level(size: float, listed: _Listed) -> Cells:
    keys, bits = listed.keys, listed.bits
    triangle = np.empty(len(keys), np.int32)
    np.bitwise_and(keys, (1 << bits) - 1, out=triangle, casting="unsafe")
    keys >>= bits
    start = np.flatnonzero(np.r_[True, keys[1:] != keys[:-1]][: len(keys)])
    ends = np.r_[start, len(keys)].astype(np.int32)
    return Cells(size, listed.low, listed.rows, keys[start], ends, triangle)


def _listed(
    vertices: FloatArray, triangles: NDArray[np.int32], boxes: FloatArray,
    rows: NDArray[np.int32], size: float,
) -> _Listed:  # fmt: skip
    """Find the cells of one size that triangles, given by their rows, meet."""
    low, high = _cells(boxes[:, :, rows], size).swapaxes(0, 1)
    span = high - low + 1
    few = span.prod(axis=0, dtype=np.int64) <= FEW_CELLS
    # One reaches a cell at least of each row and column of its box.
    wide = np.flatnonzero(~few & (span.max(axis=0) <= MOST_CELLS)).astype(np.int32)
    row, part = counted(np.where(few, span[1], 0), np.int32)
    found = [(row, low[1, row] + part, low[0, row], high[0, row])]
    fits = few.copy()
    for begin in range(0, len(wide), BATCH):
        some = wide[begin : begin + BATCH]
        band, part = counted(span[1, some], np.int32)
        own = some[band]
        height = low[1, own] + part
        reach = _reaches(vertices, triangles[rows[some]], band, size * height, size)
        first, last = _cells(reach, size)
        fits[some] = np.bincount(band, last - first + 1, len(some)) <= MOST_CELLS
        kept = np.flatnonzero(fits[own])
        found.append((own[kept], height[kept], first[kept], last[kept]))
    row, height, first, last = (np.concatenate(column) for column in zip(*found, strict=True))
    most = np.iinfo(np.int32).max
    corner = np.array([first.min(initial=most), height.min(initial=most)], np.int32)
    count = int(height.max(initial=corner[1]) - corner[1]) + 1
    run, part = counted(last - first + 1, np.int32)
    # One number of a cell and a triangle sorts faster than rows, and holds both.
    keys = _cell_number(first[run] + part, height[run], corner, count)
    bits = len(triangles).bit_length()
    keys <<= bits
    keys += rows[row[run]]
    keys.sort()
    return _Listed(keys, bits, corner, count, fits)


def _listed_many(
    vertices: FloatArray, triangles: NDArray[np.int32], boxes: FloatArray,
    rows: NDArray[np.int32], size: float,
) -> _Listed:  # fmt: skip
    """Do what `_listed` does by compiled kernels."""
    from cityx.geometry.triangle_kernel import met_cells, sort_keys

    vertices, triangles = _of_one_kind(vertices, triangles)
    given = vertices, triangles, np.ascontiguousarray(boxes.transpose(2, 0, 1)), rows, float(size)
    limits = FEW_CELLS, MOST_CELLS, SLACK, LEVEL
    fits, bits = np.zeros(len(rows), bool), len(triangles).bit_length()
    far = np.iinfo(np.int32).max
    reach = np.array([far, far, -far, -far])  # first column and row, last row and column
    total = met_cells(*given, limits, reach, bits, np.zeros(0, np.int64), fits)
    if not total:
        return _Listed(np.zeros(0, np.int64), bits, reach[:2].astype(np.int32), 1, fits)
    keys, other = np.empty((2, total), np.int64)
    met_cells(*given, limits, reach, bits, keys, fits)
    count = int(reach[2] - reach[1]) + 1
    cells = (int(reach[3] - reach[0]) + 1) * count
    # Triangles rise already.
    keys = other if sort_keys(keys, other, bits, cells.bit_length()) else keys
    return _Listed(keys, bits, reach[:2].astype(np.int32), count, fits)


def _of_one_kind(
    vertices: NDArray[Any], triangles: NDArray[Any]
) -> tuple[FloatArray, NDArray[np.int32]]:
    """Return vertices and triangles as kernels take them, so that there is one of each."""
    return (
        np.ascontiguousarray(vertices, np.float64),
        np.ascontiguousarray(triangles, np.int32),
    )


def _reaches(
    vertices: FloatArray, triangles: NDArray[np.int32], band: NDArray[np.int32],
    south: FloatArray, size: float,
) -> FloatArray:  # fmt: skip
    """(2, r) the least and the greatest x of triangles within rows of cells, a little more.

    Parameters
    ----------
    vertices, triangles
        The (w, 3) triangles.
    band, south
        (r,) triangle and lower border of each row of cells that one meets.
    size
        Metres of a cell.
    """
    north = south + size
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
    # A corner on the border of two rows may be counted to one and, by rounding, reach the other.
    missed = np.flatnonzero(least > most)
    across = np.asarray(vertices[triangles[band[missed]], 0], float)
    least[missed], most[missed] = across.min(axis=1), across.max(axis=1)
    return np.stack([least - SLACK, most + SLACK])


def _cells(xy: FloatArray, size: float) -> NDArray[np.int32]:
    return np.asarray(np.floor(xy / size), np.int32)


def _cell_number(
    column: NDArray[Any], line: NDArray[Any], corner: NDArray[Any], rows: int
) -> IntArray:
    """Return the (n,) numbers of cells, by columns; what lies beyond may share a number."""
    number = column.astype(np.int64)
    number -= corner[0]
    number *= rows
    number += line
    number -= corner[1]
    return number


def in_triangles(
    xy: ArrayLike, vertices: NDArray[np.float64], triangles: NDArray[np.int32]
) -> BoolArray:
    """Return which of (n, 2) points lie in or on one of (t, 3) triangles over (v, 2) vertices."""
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
) -> Iterator[tuple[IntArray, NDArray[np.int32]]]:
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
    if len(spots) >= (SOME if len(prepared.triangles) >= MANY else MANY):
        yield from _many(np.ascontiguousarray(spots), prepared, among)
        return
    for begin in range(0, len(spots), AT_ONCE):
        some = spots[begin : begin + AT_ONCE]
        pairs = [_candidates(some, level) for level in prepared.levels]
        spot, triangle = (np.concatenate(column) for column in zip(*pairs, strict=True))
        if among is not None:
            wanted = np.flatnonzero(among[triangle])
            spot, triangle = spot[wanted], triangle[wanted]
        for axis in (0, 1):
            near = _within(some[spot, axis], prepared.boxes[axis], triangle)
            spot, triangle = spot[near], triangle[near]
        held = _holds(prepared, triangle, some[spot])
        yield spot[held] + begin, triangle[held]


def _many(
    spots: FloatArray, prepared: TriangleCells, among: BoolArray | None
) -> Iterator[tuple[IntArray, NDArray[np.int32]]]:
    """Yield the pairs of many points by a compiled kernel, level by level."""
    from cityx.geometry.triangle_kernel import held_pairs

    vertices, triangles = _of_one_kind(prepared.vertices, prepared.triangles)
    boxes = np.ascontiguousarray(prepared.boxes.transpose(2, 0, 1))
    wanted = np.ones(len(triangles), bool) if among is None else np.ascontiguousarray(among)
    # Points of one cell after each other: what they ask for is in the cache then.
    finest = prepared.levels[0]
    column, line = _cells(spots, finest.size).T
    order = np.argsort(_cell_number(column, line, finest.low, finest.rows), kind="stable")
    spots = spots[order]
    for level in prepared.levels:
        room = 2 * len(spots)
        while True:
            point, found = np.empty(room, np.int64), np.empty(room, np.int32)
            count = held_pairs(
                spots, vertices, triangles, boxes, wanted, level.size, level.low, level.rows,
                level.cell, level.start, level.triangle, point, found,
            )  # fmt: skip
            if count <= room:
                break
            room = count
        yield order[point[:count]], found[:count]


def _candidates(spots: FloatArray, level: Cells) -> tuple[IntArray, NDArray[np.int32]]:
    """Pairs of points and triangles of the same cell."""
    column, line = _cells(spots, level.size).T
    cell = _cell_number(column, line, level.low, level.rows)
    row = np.searchsorted(level.cell, cell)
    known = np.flatnonzero(row < len(level.cell))
    known = known[level.cell[row[known]] == cell[known]]
    row = row[known]
    spot, number = counted(np.diff(level.start)[row])
    return known[spot], level.triangle[level.start[row][spot] + number]


def _within(at: FloatArray, boxes: FloatArray, triangle: IntArray) -> IntArray:
    """Rows of those that lie within the boxes, (2, t), of triangles along an axis."""
    return np.flatnonzero((at >= boxes[0, triangle]) & (at <= boxes[1, triangle]))


def _holds(prepared: TriangleCells, triangle: IntArray, xy: FloatArray) -> BoolArray:
    """Return which triangles have a point in them or on their rim, whichever way round they are."""
    corner = prepared.triangles[triangle].T
    x, y = (prepared.vertices[corner, axis] - xy[:, axis] for axis in (0, 1))  # (3, k) each
    turn = [x[k - 1] * y[k] - y[k - 1] * x[k] for k in range(3)]
    left = np.logical_and.reduce([side >= 0.0 for side in turn])
    right = np.logical_and.reduce([side <= 0.0 for side in turn])
    return np.asarray(left | right)
