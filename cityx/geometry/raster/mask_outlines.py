"""Outlines: masks of buildings become polygons with straight walls and right angles.

A ring of cracks is cut at the corners that Douglas and Peucker find; a line is fitted through the
middles of the cracks of each run, which are unbiased where corners of pixels are not; lines near
one of the two axes of the building take its direction; neighbouring lines meet in the corners.
All points are (column, row).

References
----------
Douglas and Peucker, "Algorithms for the reduction of the number of points required to represent a
digitized line", 1973.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.geometry.arrays import FloatArray, IntArray
from cityx.geometry.polygons import Rings, polygons_of
from cityx.geometry.raster.cracks import rings

CORNER = 1.3  # pixels; a staircase strays less than this from the wall it stands for
SNAP = np.radians(40.0)  # walls nearer than this to an axis of the building lie along it
PARALLEL = np.radians(15.0)  # lines nearer than this in direction have no trustworthy corner
WEIGHT = 1.5  # power of the length by which a wall counts for the axes; long walls decide
LEAST_IOU = 0.82  # with the pixels, for an outline of right angles
WORSE = 0.08  # IoU that right angles may cost against walls of any direction
USELESS = 0.6  # IoU below which the pixels themselves are the better outline
MORE = (
    1.3  # times as many corners as walls of any direction need; more are stairs, not right angles
)
FEWEST = 4  # walls that a ring keeps
ROUNDS = 64  # of taking away short walls; each takes a share of those left
STEP = 1e-3  # pixels of wall that a step between parallel walls begins with

_FREE = 2  # kind of a run of any direction; 0 and 1 are the axes


@dataclass(frozen=True)
class _Runs:
    """r straight runs of cracks, ring after ring, in order.

    Attributes
    ----------
    ring
        (r,) ascending.
    moments
        (r, 6) sums of 1, x, y, xx, xy, yy over the middles of cracks.
    kind
        (r,) 0 or 1 for the axes of the ring, 2 for free.
    begin
        (r, 2) point at which the run begins.
    heading
        (r, 2) from its begin to its end.
    """

    ring: IntArray
    moments: FloatArray
    kind: IntArray
    begin: FloatArray
    heading: FloatArray

    def take(self, rows: Any) -> _Runs:
        return _Runs(
            self.ring[rows], self.moments[rows], self.kind[rows], self.begin[rows],
            self.heading[rows],
        )  # fmt: skip

    def around(self) -> tuple[IntArray, IntArray]:
        """Return the previous and the next run of each in its ring, (r,) each."""
        count = len(self.ring)
        first = np.ones(count, bool)
        first[1:] = self.ring[1:] != self.ring[:-1]
        begin = np.flatnonzero(first)
        last = np.append(begin[1:], count) - 1
        previous, following = np.arange(count) - 1, np.arange(count) + 1
        previous[begin], following[last] = last, begin
        return previous, following


def outlines(labels: NDArray[Any], *, jog: float) -> tuple[NDArray[Any], NDArray[Any]]:
    """Draw a polygon around every label of a raster.

    Parameters
    ----------
    labels
        (rows, columns) int; each label above 0 is one 4-connected patch, and patches meet at
        corners only. They are numbered from 1 without gaps.
    jog
        Pixels; shorter walls are drawing noise.

    Returns
    -------
    regular
        (n,) polygons with straight walls, right-angled where that fits.
    exact
        (n,) polygons along the edges of the pixels; of several pieces where pixels meet at corners.
    """
    count = int(labels.max(initial=0))
    if count == 0:
        return np.zeros(0, object), np.zeros(0, object)
    cracks, chains = rings(labels)
    start, middle = cracks.points(cracks.start)[chains.crack], cracks.middles()[chains.crack]
    owner = cracks.left[chains.crack[chains.begin[:-1]]] - 1
    ring = np.repeat(np.arange(len(owner)), np.diff(chains.begin))
    # A ring may touch itself where pixels meet at a corner.
    exact = shapely.make_valid(_polygons(start, ring, owner, count), method="structure")
    runs = _runs(start, middle, ring, chains.begin)
    axis = _axes(runs, owner, count)
    square = _snapped(runs, axis[owner])
    axis = _refined(square, axis, owner)
    right = _drawn(_settled(_stepped(square), axis[owner], jog), axis[owner], owner, count)
    free = replace(runs, kind=np.full(len(runs.kind), _FREE))
    fitted = _drawn(_settled(free, axis[owner], jog), axis[owner], owner, count)
    plain = _polygons(runs.begin, runs.ring, owner, count)
    return _best(right, fitted, plain, exact), exact


def _polygons(points: FloatArray, ring: IntArray, owner: IntArray, count: int) -> NDArray[Any]:
    """Build polygons from rings; the ring of each owner with the largest area is its shell."""
    size = np.bincount(ring, minlength=len(owner))
    usable = size >= 3
    if not usable.any():
        return np.full(count, shapely.Polygon(), object)
    points, size, owner = points[usable[ring]], size[usable], owner[usable]
    begin = np.concatenate([[0], np.cumsum(size)]).astype(np.int64)
    following = np.arange(len(points)) + 1
    following[begin[1:] - 1] = begin[:-1]
    cross = points[:, 0] * points[following, 1] - points[following, 0] * points[:, 1]
    area = np.add.reduceat(cross, begin[:-1])
    order = np.lexsort((-np.abs(area), owner))
    hole = np.ones(len(order), bool)
    hole[np.flatnonzero(np.diff(owner[order], prepend=-1))] = False
    rows = np.concatenate([np.arange(begin[i], begin[i + 1]) for i in order.tolist()])
    starts = np.concatenate([[0], np.cumsum(size[order])]).astype(np.int64)
    return polygons_of(Rings(points[rows.astype(np.int64)], starts, owner[order], hole), count)


def _runs(start: FloatArray, middle: FloatArray, ring: IntArray, begin: IntArray) -> _Runs:
    """Cut rings at their corners."""
    # A ring is cut where it begins, so it begins at a corner: the point farthest from its middle.
    size = np.diff(begin)
    centre = np.add.reduceat(start, begin[:-1]) / size[:, None]
    far = np.hypot(*(start - centre[ring]).T)
    head = np.lexsort((-far, ring))[begin[:-1]] - begin[:-1]
    place = np.arange(len(ring)) - begin[ring]
    order = begin[ring] + (place + head[ring]) % size[ring]
    start, middle = start[order], middle[order]
    kept = _corners(start, ring, begin)
    corner = np.flatnonzero(kept)
    x, y = (middle - centre[ring]).T  # near zero, so that squares keep their digits
    terms = np.column_stack([np.ones(len(x)), x, y, x * x, x * y, y * y])
    moments = np.add.reduceat(terms, corner)
    moments = _moved(moments, centre[ring[corner]])
    runs = _Runs(ring[corner], moments, np.full(len(corner), _FREE), start[corner], start[corner])
    _, following = runs.around()
    return replace(runs, heading=runs.begin[following] - runs.begin)


def _moved(moments: FloatArray, by: FloatArray) -> FloatArray:
    """Return moments about an origin that lies at minus `by`."""
    n, sx, sy, sxx, sxy, syy = moments.T
    x, y = by.T
    return np.column_stack([
        n, sx + n * x, sy + n * y, sxx + 2 * x * sx + n * x * x,
        sxy + x * sy + y * sx + n * x * y, syy + 2 * y * sy + n * y * y,
    ])  # fmt: skip


def _corners(start: FloatArray, ring: IntArray, begin: IntArray) -> NDArray[np.bool_]:
    """Mark the points of rings at which they turn for good."""
    closed = np.insert(start, begin[1:], start[begin[:-1]], axis=0)
    number = np.insert(np.arange(len(start)), begin[1:], begin[:-1])
    lines = shapely.linestrings(
        np.column_stack([closed, number]),
        indices=np.insert(ring, begin[1:], np.arange(len(begin) - 1)),
    )
    plain = shapely.simplify(lines, CORNER, preserve_topology=False)
    kept = np.zeros(len(start), bool)
    kept[shapely.get_coordinates(plain, include_z=True)[:, 2].astype(np.int64)] = True
    return kept


def _axes(runs: _Runs, owner: IntArray, count: int) -> FloatArray:
    """Return the direction of each polygon's first axis, radians, from its walls by length."""
    length = np.hypot(*runs.heading.T) ** WEIGHT
    turned = 4 * np.arctan2(runs.heading[:, 1], runs.heading[:, 0])
    polygon = owner[runs.ring]
    real = np.bincount(polygon, length * np.cos(turned), minlength=count)
    imaginary = np.bincount(polygon, length * np.sin(turned), minlength=count)
    return np.asarray(np.arctan2(imaginary, real) / 4)


def _snapped(runs: _Runs, axis: FloatArray) -> _Runs:
    """Give runs near an axis of their ring to it."""
    away = np.arctan2(runs.heading[:, 1], runs.heading[:, 0]) - axis[runs.ring]
    quarter = np.rint(away / (np.pi / 2))
    near = np.abs(away - quarter * np.pi / 2) <= SNAP
    return replace(runs, kind=np.where(near, quarter.astype(np.int64) % 2, _FREE))


def _refined(runs: _Runs, axis: FloatArray, owner: IntArray) -> FloatArray:
    """Turn the axes so that the cracks of all snapped walls scatter least about their walls."""
    n, sx, sy, sxx, sxy, syy = runs.moments.T
    xx, xy, yy = sxx - sx * sx / n, sxy - sx * sy / n, syy - sy * sy / n
    sign = np.choose(runs.kind, [1.0, -1.0, 0.0])  # a quarter turn flips both terms
    polygon = owner[runs.ring]
    real = np.bincount(polygon, sign * (xx - yy), minlength=len(axis))
    imaginary = np.bincount(polygon, sign * 2 * xy, minlength=len(axis))
    found = np.arctan2(imaginary, real) / 2
    quarter = np.rint((found - axis) / (np.pi / 2)) * np.pi / 2
    return np.where(real**2 + imaginary**2 > 0, found - quarter, axis)


def _stepped(runs: _Runs) -> _Runs:
    """Put a short wall across between neighbouring walls of one axis."""
    previous, _ = runs.around()
    between = np.flatnonzero((runs.kind < _FREE) & (runs.kind == runs.kind[previous]))
    x, y = runs.begin[between].T
    moments = STEP * np.column_stack([np.ones(len(x)), x, y, x * x, x * y, y * y])
    across = runs.take(between)
    across = replace(across, moments=moments, kind=1 - across.kind, heading=np.zeros((len(x), 2)))
    both = _Runs(*(
        np.concatenate([getattr(across, name), getattr(runs, name)])
        for name in ("ring", "moments", "kind", "begin", "heading")
    ))  # fmt: skip
    order = np.argsort(np.concatenate([between - 0.5, np.arange(len(runs.ring))]), kind="stable")
    return both.take(order)


def _lines(runs: _Runs, axis: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return a point on the line of each run and its direction, (r, 2) each."""
    n, sx, sy, sxx, sxy, syy = runs.moments.T
    xx, xy, yy = sxx - sx * sx / n, sxy - sx * sy / n, syy - sy * sy / n
    fitted = np.arctan2(2 * xy, xx - yy) / 2
    single = n < 2  # one crack has no direction of its own
    fitted = np.where(single, np.arctan2(runs.heading[:, 1], runs.heading[:, 0]), fitted)
    angle = np.where(runs.kind == _FREE, fitted, axis[runs.ring] + runs.kind * np.pi / 2)
    return np.column_stack([sx, sy]) / n[:, None], np.column_stack([np.cos(angle), np.sin(angle)])


def _vertices(runs: _Runs, axis: FloatArray) -> tuple[FloatArray, NDArray[np.bool_]]:
    """Return where each run meets the previous one, and which pairs are parallel."""
    point, along = _lines(runs, axis)
    previous, _ = runs.around()
    other, turned = point[previous], along[previous]
    cross = turned[:, 0] * along[:, 1] - turned[:, 1] * along[:, 0]
    parallel = np.abs(cross) < np.sin(PARALLEL)
    apart = point - other
    way = (apart[:, 0] * along[:, 1] - apart[:, 1] * along[:, 0]) / np.where(parallel, 1.0, cross)
    met = other + way[:, None] * turned
    return np.where(parallel[:, None], runs.begin, met), parallel


def _settled(runs: _Runs, axis: FloatArray, jog: float) -> _Runs:
    """Take away short walls, the shortest first, until none is left."""
    for _ in range(ROUNDS):
        vertex, _ = _vertices(runs, axis)
        previous, following = runs.around()
        walls = np.bincount(runs.ring, minlength=len(axis))[runs.ring]
        edge = vertex[following] - vertex
        length = np.hypot(*edge.T)
        length[(edge * runs.heading).sum(axis=1) < 0] = 0.0  # a wall turned about is none
        rank = np.empty(len(length), np.int64)
        rank[np.lexsort((np.arange(len(length)), length))] = np.arange(len(length))
        # Two walls that are near in the ring never go in one round.
        least = np.minimum.reduce([
            rank[previous], rank[following], rank[previous[previous]], rank[following[following]],
        ])  # fmt: skip
        gone = (length < jog) & (walls > FEWEST) & (rank < least)
        if not gone.any():
            break
        runs = _without(runs, np.flatnonzero(gone))
    return runs


def _without(runs: _Runs, gone: IntArray) -> _Runs:
    """Drop walls; where this leaves two of one axis next to each other they become one."""
    previous, following = runs.around()
    before, after = previous[gone], following[gone]
    one = (runs.kind[before] == runs.kind[after]) & (runs.kind[before] < _FREE)
    before, after = before[one], after[one]
    moments, heading = runs.moments.copy(), runs.heading.copy()
    moments[before] += moments[after]
    heading[before] += heading[after]
    kept = np.ones(len(runs.ring), bool)
    kept[gone] = False
    kept[after] = False
    return replace(runs, moments=moments, heading=heading).take(kept)


def _drawn(runs: _Runs, axis: FloatArray, owner: IntArray, count: int) -> NDArray[Any]:
    vertex, _ = _vertices(runs, axis)
    return _polygons(vertex, runs.ring, owner, count)


def _best(
    right: NDArray[Any], fitted: NDArray[Any], plain: NDArray[Any], exact: NDArray[Any]
) -> NDArray[Any]:
    """Choose the outline of each polygon: the most regular one that fits the pixels."""
    fits = np.stack([_iou(shape, exact) for shape in (plain, fitted, right)])
    simple = _corner_count(right) <= MORE * _corner_count(fitted) + FEWEST
    chosen = np.where(fits[1] >= fits[0] - WORSE, 1, 0)
    square = (fits[2] >= LEAST_IOU) & (fits[2] >= fits[:2].max(axis=0) - WORSE) & simple
    chosen = np.where(square, 2, chosen)
    rows = np.arange(len(exact))
    best = np.stack([plain, fitted, right])[chosen, rows]
    return np.asarray(np.where(fits[chosen, rows] >= USELESS, best, exact), object)


def _corner_count(shapes: NDArray[Any]) -> IntArray:
    return np.asarray(shapely.get_num_coordinates(shapes), np.int64)


def _iou(shapes: NDArray[Any], exact: NDArray[Any]) -> FloatArray:
    """Return area shared over area covered; 0 for what is no valid polygon."""
    sound = shapely.is_valid(shapes) & ~shapely.is_empty(shapes) & ~shapely.is_missing(shapes)
    shapes = np.where(sound, shapes, exact)
    shared = shapely.area(shapely.intersection(shapes, exact))
    iou = shared / (shapely.area(shapes) + shapely.area(exact) - shared)
    return np.asarray(np.where(sound, iou, 0.0))
