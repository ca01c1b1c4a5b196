"""Routes on the lane graph: which lanes lead from one to another, and what nothing leads to."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cityx.city.lanes import LaneGraph
from cityx.city.section import KIND
from cityx.errors import UsageError
from cityx.geometry.arrays import FloatArray, IntArray

CHANGE_S = 3.0  # seconds that a change of lane costs


@dataclass(frozen=True)
class Route:
    """A way along lanes.

    Attributes
    ----------
    lanes
        Lanes in order.
    seconds
        Time at the lanes' speeds.
    points
        (k, 2) float64, metres, from the start of the first lane to the end of the last.
    """

    lanes: tuple[int, ...]
    seconds: float
    points: FloatArray


def _lengths(start: IntArray, points: FloatArray) -> FloatArray:
    step = np.zeros(len(points))
    step[1:] = np.hypot(*np.diff(points, axis=0).T)
    step[start[:-1]] = 0.0
    return np.add.reduceat(step, start[:-1]) if len(start) > 1 else np.zeros(0)


def lane_lengths(graph: LaneGraph) -> FloatArray:
    """(l,) metres along the middles of lanes."""
    return _lengths(graph.point_start, graph.points)


def cars(graph: LaneGraph) -> NDArray[np.bool_]:
    """(l,) whether cars drive along the lane."""
    return np.asarray((graph.kind == KIND["drive"]) & (graph.direction != 0))


def _matrix(graph: LaneGraph) -> Any:
    """Seconds from the start of a lane to the start of each that cars may take next."""
    from scipy.sparse import csr_array

    speed = np.maximum(graph.speed.astype(float), 1.0) / 3.6
    drive = lane_lengths(graph) / speed
    open_to_cars = cars(graph)
    pairs = graph.connection[open_to_cars[graph.connection].all(axis=1)]
    kept = open_to_cars[graph.connection].all(axis=1)
    cross = (_lengths(graph.curve_start, graph.curve) / speed[graph.connection[:, 0]])[kept]
    weight = np.maximum(drive[pairs[:, 0]] + cross, 1e-3)
    beside = side_by_side(graph)
    pairs = np.concatenate([pairs, beside, beside[:, ::-1]])
    weight = np.concatenate([weight, np.full(2 * len(beside), CHANGE_S)])
    return csr_array((weight, (pairs[:, 0], pairs[:, 1])), shape=(graph.count, graph.count))


def side_by_side(graph: LaneGraph) -> IntArray:
    """(k, 2) lanes of one edge and direction between which cars may change."""
    first = np.flatnonzero(cars(graph)[:-1] & cars(graph)[1:])
    same = graph.edge[first] == graph.edge[first + 1]
    same &= graph.direction[first] == graph.direction[first + 1]
    return np.asarray(np.column_stack([first, first + 1])[same])


def route(graph: LaneGraph, origin: int, goal: int) -> Route | None:
    """Find the quickest way of a car from one lane to another; None when there is none.

    Raises
    ------
    UsageError
        If no car drives along one of the lanes.
    """
    from scipy.sparse.csgraph import dijkstra

    open_to_cars = cars(graph)
    for lane in (origin, goal):
        if not (0 <= lane < graph.count and open_to_cars[lane]):
            raise UsageError(f"lane {lane} is none that cars drive along")
    seconds, before = dijkstra(_matrix(graph), indices=origin, return_predecessors=True)
    if not np.isfinite(seconds[goal]):
        return None
    lanes = [goal]
    while lanes[-1] != origin:
        lanes.append(int(before[lanes[-1]]))
    lanes.reverse()
    speed = max(float(graph.speed[goal]), 1.0) / 3.6
    total = float(seconds[goal]) + float(lane_lengths(graph)[goal]) / speed
    return Route(tuple(lanes), total, _path(graph, lanes))


def _path(graph: LaneGraph, lanes: list[int]) -> FloatArray:
    pieces = [graph.lane_points(lanes[0])]
    for here, there in pairwise(lanes):
        rows = np.flatnonzero((graph.connection == (here, there)).all(axis=1))
        if not len(rows):  # a change of lane: over the length of the first
            pieces[-1] = np.stack([pieces[-1][0], graph.lane_points(there)[-1]])
            continue
        row = int(rows[0])
        pieces.append(graph.curve[graph.curve_start[row] : graph.curve_start[row + 1]])
        pieces.append(graph.lane_points(there))
    points = np.concatenate(pieces)
    moved = np.r_[True, np.hypot(*np.diff(points, axis=0).T) > 1e-6]
    return np.asarray(points[moved])


def nearest_lane(graph: LaneGraph, place: FloatArray) -> int:
    """Return the lane for cars whose middle passes nearest to a place, (2,) metres."""
    import shapely

    rows = np.flatnonzero(cars(graph))
    if not len(rows):
        raise UsageError("the lane graph has no lane that cars drive along")
    owner = np.repeat(np.arange(graph.count), np.diff(graph.point_start))
    chosen = np.isin(owner, rows)
    lines = shapely.linestrings(graph.points[chosen], indices=np.searchsorted(rows, owner[chosen]))
    return int(rows[np.argmin(shapely.distance(lines, shapely.Point(place)))])


def pieces_of(graph: LaneGraph) -> IntArray:
    """(l,) number of the piece of the graph that each lane for cars lies in, -1 for the others.

    Lanes of one piece are joined by connections, whichever way those lead.
    """
    from scipy.sparse.csgraph import connected_components

    found = np.full(graph.count, -1, np.int64)
    rows = np.flatnonzero(cars(graph))
    if len(rows):
        _, label = connected_components(_matrix(graph), directed=True, connection="weak")
        found[rows] = np.unique(label[rows], return_inverse=True)[1]
    return found


def stranded(graph: LaneGraph, entries: IntArray, exits: IntArray) -> IntArray:
    """Return the lanes for cars that cannot be reached, or not be left for good.

    Parameters
    ----------
    entries, exits
        Lanes that traffic from beyond the site comes in by, and leaves by. In a piece of the graph
        that lacks one of them its largest circuit is home.
    """
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    rows = np.flatnonzero(cars(graph))
    if not len(rows):
        return rows
    piece = pieces_of(graph)
    inner = _matrix(graph).tocoo()
    beyond = graph.count
    origin = np.concatenate([inner.row, exits, np.full(len(entries), beyond)])
    goal = np.concatenate([inner.col, np.full(len(exits), beyond), entries])
    whole = coo_array((np.ones(len(origin)), (origin, goal)), shape=(beyond + 1, beyond + 1))
    _, label = connected_components(whole, directed=True, connection="strong")
    opened = np.isin(piece, np.intersect1d(piece[entries], piece[exits]))
    length = lane_lengths(graph)
    size = np.bincount(label[rows], length[rows], minlength=int(label.max()) + 1)
    best = np.full(int(piece.max()) + 1, -1.0)
    np.maximum.at(best, piece[rows], size[label[rows]])
    home = np.where(opened[rows], label[rows] == label[beyond],
                    size[label[rows]] >= best[piece[rows]])  # fmt: skip
    return rows[~home]
