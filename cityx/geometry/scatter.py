"""Poisson-disk points by random priority: the same points whatever window is asked for.

Candidates are drawn per cell by a hash of the cell, so they exist before any window does. A
candidate is kept when no kept neighbour within the radius has a higher priority; that chain of
decisions is cut after a few rounds, which bounds how far away anything can matter.

References
----------
Bowers, Wang, Wei and Maletz, "Parallel Poisson disk sampling with spectrum analysis", 2010.
Roberts, "The unreasonable effectiveness of quasirandom sequences", 2018 (sequences of the
generalised golden ratio). Cranley and Patterson, SIAM J. Numer. Anal. 13, 1976 (their rotation).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely
from numpy.typing import ArrayLike, NDArray

from cityx.ids import hash_ids, mix, uniform

ROUNDS = 3  # decisions deeper than this are dropped: 0.3 % of the points, measured
REACH = 2 * ROUNDS  # radii around a point that can change its fate
HALF_WORD, LOW_HALF = np.uint64(32), np.uint64(0xFFFFFFFF)
PER_CELL = 3  # candidates per cell of one radius; more fill the last gaps at a rising price
_BITS = 16  # of each coordinate along the curve of `nearby_order`


@dataclass(frozen=True)
class Points:
    """Scattered points, sorted by id.

    Attributes
    ----------
    xy
        (n, 2) float64, metres.
    id
        (n,) uint64, from the cell and the candidate's number, the same in every window.
    """

    xy: NDArray[np.float64]
    id: NDArray[np.uint64]


def cell_ids(cells: NDArray[np.int64]) -> NDArray[np.uint64]:
    """Hash (n, 2) integer cells, negative ones too, to (n,) ids."""
    bits = cells.astype(np.int64).view(np.uint64).reshape(-1, 2)
    return np.asarray(mix(mix(bits[:, 0]) ^ (bits[:, 1] * np.uint64(0x9E3779B97F4A7C15))))


def candidates(cells: NDArray[np.int64], radius: float, *, seed: int, purpose: str) -> Points:
    """Draw the candidates of the given cells (edge `radius`), `PER_CELL` each, in no order."""
    ids = hash_ids(
        seed,
        purpose,
        np.repeat(cell_ids(cells), PER_CELL),
        np.tile(np.arange(PER_CELL), len(cells)),
    )
    bits = hash_ids(seed, purpose, ids, 1)  # half of them for each coordinate
    offset = np.column_stack([bits >> HALF_WORD, bits & LOW_HALF]) / float(1 << 32)
    xy = (np.repeat(cells, PER_CELL, axis=0) + offset) * radius
    return Points(np.round(xy, 4), ids)


def near_pairs(xy: NDArray[np.float64], radius: float) -> NDArray[np.int64]:
    """Return the (m, 2) pairs of points closer than `radius`, each once; meant for even density."""
    cell = np.floor(xy / radius).astype(np.int64)
    cell -= cell.min(axis=0) - 1
    width = int(cell[:, 1].max()) + 2
    key = cell[:, 0] * width + cell[:, 1]
    order = np.argsort(key, kind="stable")
    (x, y), keys = np.ascontiguousarray(xy[order].T), key[order]
    unique, start = np.unique(keys, return_index=True)
    start = np.append(start, len(keys))
    position = np.arange(len(keys))
    found = [np.zeros((0, 2), np.int64)]
    for shift in (0, 1, width - 1, width, width + 1):  # half of the neighbourhood: each pair once
        at = np.searchsorted(unique, unique + shift).clip(max=len(unique) - 1)
        there = unique[at] == unique + shift
        first = np.repeat(np.where(there, start[at], 0), np.diff(start))
        stop = np.repeat(np.where(there, start[at + 1], 0), np.diff(start))
        if shift == 0:
            first = position + 1
        for k in range(int((stop - first).max(initial=0))):
            rows = np.flatnonzero(first + k < stop)
            other = first[rows] + k
            close = (x[rows] - x[other]) ** 2 + (y[rows] - y[other]) ** 2 < radius * radius
            found.append(np.column_stack([rows[close], other[close]]))
    return np.asarray(order[np.concatenate(found)])


def thin(points: Points, radius: float) -> Points:
    """Keep the points that win against every neighbour nearer than `radius`, in `ROUNDS` rounds.

    The id is the priority; points still undecided at the end are dropped. The rest is sorted by id.
    """
    count = len(points.id)
    if count == 0:
        return points
    pairs = near_pairs(points.xy, radius)
    higher = points.id[pairs[:, 0]] > points.id[pairs[:, 1]]
    winner = np.where(higher, pairs[:, 0], pairs[:, 1])
    loser = np.where(higher, pairs[:, 1], pairs[:, 0])
    undecided = np.ones(count, bool)
    kept = np.zeros(count, bool)
    for _ in range(ROUNDS):
        both = undecided[winner] & undecided[loser]
        winner, loser = winner[both], loser[both]
        beaten = np.zeros(count, bool)
        beaten[loser] = True
        fresh = undecided & ~beaten
        kept |= fresh
        undecided &= ~fresh
        undecided[loser[fresh[winner]]] = False
    rows = np.flatnonzero(kept)
    rows = rows[np.argsort(points.id[rows], kind="stable")]
    return Points(points.xy[rows], points.id[rows])


def thinned(points: Points, density: ArrayLike, *, seed: int, purpose: str) -> Points:
    """Keep each point with its own chance, for a density that varies over the plane.

    Parameters
    ----------
    points
        n points.
    density
        (n,) float, share of the points that is kept where each lies; above 1 keeps all.
    seed, purpose
        Key of the random numbers; a point's draw depends on its id alone.
    """
    keep = uniform(seed, f"{purpose}/thinned", points.id) < np.asarray(density, float)
    return _rows(points, keep)


def poisson_disk(
    bounds: tuple[float, float, float, float], radius: float, *, seed: int, purpose: str
) -> Points:
    """Scatter points at least `radius` apart over a rectangle.

    Parameters
    ----------
    bounds
        (xmin, ymin, xmax, ymax), half open: points on the upper edges belong to the next window.
    radius
        Metres, least distance of two points.
    seed, purpose
        Key of the random numbers.

    Returns
    -------
    points
        The part of the one infinite point set that lies in the window.
    """
    xmin, ymin, xmax, ymax = bounds
    halo = REACH * radius
    low = np.floor(np.array([xmin - halo, ymin - halo]) / radius).astype(np.int64)
    high = np.floor(np.array([xmax + halo, ymax + halo]) / radius).astype(np.int64)
    i, j = np.meshgrid(
        np.arange(low[0], high[0] + 1), np.arange(low[1], high[1] + 1), indexing="ij"
    )
    cells = np.column_stack([i.ravel(), j.ravel()])
    points = thin(candidates(cells, radius, seed=seed, purpose=purpose), radius)
    x, y = points.xy.T
    inside = (x >= xmin) & (x < xmax) & (y >= ymin) & (y < ymax)
    return Points(points.xy[inside], points.id[inside])


def cells_about(bounds: NDArray[np.float64], edge: float, reach: float) -> NDArray[np.int64]:
    """Return the cells near things, and some beyond, each once.

    Parameters
    ----------
    bounds
        (n, 4) float, xmin, ymin, xmax, ymax of the things, metres.
    edge
        Metres, of the square cells.
    reach
        Metres from a thing up to which all cells are returned; some are as far as twice that.

    Returns
    -------
    cells
        (m, 2) int64.
    """
    each = int(np.ceil(reach / edge))  # cells along a block
    low, high = (np.floor(bounds[:, ends] / (each * edge)).astype(np.int64) + side
                 for ends, side in (((0, 1), -1), ((2, 3), 1)))  # fmt: skip
    wide = high - low  # (n, 2) blocks
    blocks = [np.zeros((0, 2), np.int64)]
    for i, j in np.ndindex(*(wide.max(axis=0, initial=-1) + 1)):
        blocks.append(low[(wide >= (i, j)).all(axis=1)] + (i, j))
    block = _unique_cells(np.concatenate(blocks))
    inner = np.stack(np.meshgrid(np.arange(each), np.arange(each), indexing="ij"), axis=-1)
    return np.asarray((block[:, None, :] * each + inner.reshape(1, -1, 2)).reshape(-1, 2))


NEARLY = 1e-3  # metres; places of candidates are rounded to less


SPLIT = 8  # cells along a large one, a power of two so that their borders are the same numbers


def cells_of_polygons(polygons: ArrayLike, edge: float) -> NDArray[np.int64]:
    """Return the (n, 2) cells of edge `edge`, sorted, that any polygon meets.

    Large cells are asked first, and those within them only where a border runs through: the cost
    follows the cells that are met, not the bounds of a thin diagonal wood.
    """
    shapes = np.asarray(polygons, dtype=object)
    shapes = shapes[~shapely.is_empty(shapes)]
    if not len(shapes):
        return np.zeros((0, 2), np.int64)
    bounds = shapely.bounds(shapes)
    low, high = (np.floor(bounds[:, ends] / edge).astype(np.int64) for ends in ([0, 1], [2, 3]))
    size = high - low + 1
    # One piece whose bounds are one cell wide or high lies in every cell of them.
    plain = (size.min(axis=1) == 1) & (shapely.get_type_id(shapes) == shapely.GeometryType.POLYGON)
    found = [_cells_from_to(low[plain], high[plain])[0]]
    shapely.prepare(shapes[~plain])
    # Of a large cell as many sides as a polygon's bounds are at most `SPLIT` of it wide and high.
    sides = np.maximum(np.ceil(np.emath.logn(SPLIT, size.max(axis=1))).astype(np.int64) - 1, 0)
    sides[plain] = -1
    cells, owner = np.zeros((0, 2), np.int64), np.zeros(0, np.int64)
    for level in range(int(sides.max()), -1, -1):
        across = SPLIT**level
        rows = np.flatnonzero(sides == level)
        fresh, of = _cells_from_to(low[rows] // across, high[rows] // across)
        cells, owner = np.concatenate([cells, fresh]), np.concatenate([owner, rows[of]])
        boxes = shapely.box(*(cells * across * edge).T, *((cells + 1) * across * edge).T)
        met = shapely.intersects(shapes[owner], boxes)
        cells, owner, boxes = cells[met], owner[met], boxes[met]
        if not level:
            break
        whole = shapely.contains_properly(shapes[owner], boxes)
        found.append(_cells_from_to(cells[whole] * across, (cells[whole] + 1) * across - 1)[0])
        cells, owner = cells[~whole] * SPLIT, owner[~whole]
        least, most = low[owner] // (across // SPLIT), high[owner] // (across // SPLIT)
        cells, of = _cells_from_to(np.maximum(cells, least), np.minimum(cells + SPLIT - 1, most))
        owner = owner[of]
    return _unique_cells(np.concatenate([*found, cells]))


def cells_of_boxes(bounds: NDArray[np.float64], edge: float) -> NDArray[np.int64]:
    """Return the (n, 2) cells of edge `edge`, sorted, that any of (k, 4) boxes meets.

    Boxes of nothing, which are NaN, meet none.
    """
    bounds = bounds[np.isfinite(bounds).all(axis=1)]
    cells = (np.floor(bounds[:, ends] / edge).astype(np.int64) for ends in ([0, 1], [2, 3]))
    return _unique_cells(_cells_from_to(*cells)[0])


def cells_of_triangles(corners: NDArray[np.float64], edge: float) -> NDArray[np.int64]:
    """Return the (n, 2) cells of edge `edge`, sorted, that any of (t, 3, 2) triangles meets.

    Triangles turn left. Cells that one misses by less than `NEARLY` are among them.
    """
    low, high = (np.floor(ends / edge).astype(np.int64)
                 for ends in (corners.min(axis=1), corners.max(axis=1)))  # fmt: skip
    cells, owner = _cells_from_to(low, high)
    met = np.ones(len(cells), bool)
    # Where the bounds are more than one cell wide and high, a side may part them from a cell.
    asked = np.flatnonzero((high > low).all(axis=1)[owner])
    middle = (cells[asked] + 0.5) * edge
    for k in range(3):
        foot, side = corners[:, k], corners[:, (k + 1) % 3] - corners[:, k]
        reach = (edge / 2 + NEARLY) * np.abs(side).sum(axis=1)  # of a cell, square to the side
        way, past = side[owner[asked]], middle - foot[owner[asked]]
        inside = way[:, 0] * past[:, 1] - way[:, 1] * past[:, 0] + reach[owner[asked]] >= 0
        met[asked[~inside]] = False
        asked, middle = asked[inside], middle[inside]
    return _unique_cells(cells[met])


def _cells_from_to(
    low: NDArray[np.int64], high: NDArray[np.int64]
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Cells from (k, 2) lowest to highest ones one after the other, and the row of each."""
    size = high - low + 1
    count = size[:, 0] * size[:, 1]
    start = np.concatenate([[0], np.cumsum(count)])
    owner = np.repeat(np.arange(len(low)), count)
    number = np.arange(start[-1]) - start[owner]
    cells = low[owner] + np.column_stack([number // size[owner, 1], number % size[owner, 1]])
    return cells, owner


BLOCK = 8  # radii per block of `poisson_in`: the smaller, the less is drawn beside the polygons


def poisson_in(
    polygons: ArrayLike,
    radius: float,
    *,
    seed: int,
    purpose: str,
    bounds: tuple[float, float, float, float] | None = None,
    where: Callable[[NDArray[np.float64]], NDArray[np.bool_]] | None = None,
) -> Points:
    """Scatter points at least `radius` apart inside polygons.

    Only candidates inside compete, so that a strip narrower than the radius is still filled.

    Parameters
    ----------
    polygons
        (n,) shapely Polygons; they may overlap.
    radius
        Metres, least distance of two points.
    seed, purpose
        Key of the random numbers.
    bounds
        (xmin, ymin, xmax, ymax) of the window, half open; the whole of the polygons when left out.
        Two windows agree wherever both know the polygons within `REACH` radii.
    where
        Narrows the polygons: tells for (m, 2) positions whether a point may lie there.
    """
    shapes = np.asarray(polygons, dtype=object)
    if bounds is not None and len(shapes):
        halo = REACH * radius
        window = shapely.box(bounds[0] - halo, bounds[1] - halo, bounds[2] + halo, bounds[3] + halo)
        shapes = shapes[shapely.intersects(shapes, window)]
    blocks, whole = _blocks(shapes, BLOCK * radius)
    if bounds is not None and len(blocks):
        low = np.floor(np.array([bounds[0] - halo, bounds[1] - halo]) / (BLOCK * radius))
        high = np.floor(np.array([bounds[2] + halo, bounds[3] + halo]) / (BLOCK * radius))
        near = ((blocks >= low) & (blocks <= high)).all(axis=1)
        blocks, whole = blocks[near], whole[near]
    if not len(blocks):
        return Points(np.zeros((0, 2)), np.zeros(0, np.uint64))
    step = np.arange(BLOCK)
    inner = np.stack(np.meshgrid(step, step, indexing="ij"), axis=-1).reshape(-1, 2)

    def drawn(chosen: NDArray[np.int64]) -> Points:
        cells = (chosen[:, None, :] * BLOCK + inner).reshape(-1, 2)
        points = candidates(cells, radius, seed=seed, purpose=purpose)
        return points if where is None else _rows(points, where(points.xy))

    border = drawn(blocks[~whole])
    inside = np.zeros(len(border.id), bool)
    tree = shapely.STRtree(shapely.points(border.xy))
    inside[tree.query(shapes, predicate="contains")[1]] = True
    middle, edge = drawn(blocks[whole]), _rows(border, inside)
    ids = np.concatenate([middle.id, edge.id])
    points = thin(Points(np.concatenate([middle.xy, edge.xy]), ids), radius)
    if bounds is None:
        return points
    x, y = points.xy.T
    return _rows(points, (x >= bounds[0]) & (x < bounds[2]) & (y >= bounds[1]) & (y < bounds[3]))


def _rows(points: Points, keep: NDArray[np.bool_]) -> Points:
    return Points(points.xy[keep], points.id[keep])


def _blocks(shapes: NDArray[Any], edge: float) -> tuple[NDArray[np.int64], NDArray[np.bool_]]:
    """Return the blocks that polygons meet, and which of them lie wholly within one polygon."""
    blocks = cells_of_polygons(shapes, edge)
    whole = np.zeros(len(blocks), bool)
    if len(blocks):
        boxes = shapely.box(*(blocks * edge).T, *((blocks + 1) * edge).T)
        whole[shapely.STRtree(boxes).query(shapes, predicate="contains_properly")[1]] = True
    return blocks, whole


def _unique_cells(cells: NDArray[np.int64]) -> NDArray[np.int64]:
    """Drop repeated rows; one 64-bit key per cell sorts faster than rows do."""
    if not len(cells):
        return cells
    low = cells.min(axis=0)
    width = int(cells[:, 1].max() - low[1] + 1)
    key = np.unique((cells[:, 0] - low[0]) * width + (cells[:, 1] - low[1]))
    return np.asarray(np.column_stack([key // width, key % width]) + low)


def _ratio(dimensions: int) -> float:
    """Return the root of x ** (dimensions + 1) = x + 1: the golden ratio for 1."""
    x = 1.5
    for _ in range(60):
        x = (1.0 + x) ** (1.0 / (dimensions + 1))
    return x


def spread(seed: int, purpose: str, numbers: ArrayLike, dimensions: int = 1) -> NDArray[np.float64]:
    """Return points of a sequence of low discrepancy, (n, dimensions) in [0, 1).

    Parameters
    ----------
    seed, purpose
        Turn the whole sequence round the unit cube, so that two plans begin at other places.
    numbers
        (n,) int, places in the sequence from 0. A point depends on its own number alone, and those
        of 0 to any k fill the cube evenly.
    dimensions
        Of the cube.
    """
    place = np.asarray(numbers, np.int64).reshape(-1, 1)
    step = _ratio(dimensions) ** -np.arange(1.0, dimensions + 1)
    turn = uniform(seed, purpose, np.arange(1, dimensions + 1))
    return np.asarray(np.mod(turn + (place + 1) * step, 1.0))


def nearby_order(points: ArrayLike) -> NDArray[np.int64]:
    """Return the order of (n, 2) points along a Z-curve, which keeps neighbours together.

    Points that share a cell of the curve stay in their order.
    """
    places = np.asarray(points, float).reshape(-1, 2)
    if not len(places):
        return np.zeros(0, np.int64)
    low = places.min(axis=0)
    side = max(float((places.max(axis=0) - low).max()), 1e-9)
    cell = np.minimum((places - low) / side * (1 << _BITS), (1 << _BITS) - 1).astype(np.uint64)
    code = np.zeros(len(places), np.uint64)
    for bit in range(_BITS):
        for axis in (0, 1):
            digit = (cell[:, axis] >> np.uint64(bit)) & np.uint64(1)
            code |= digit << np.uint64(2 * bit + axis)
    return np.argsort(code, kind="stable").astype(np.int64)
