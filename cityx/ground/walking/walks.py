"""Ways on foot: a graph over the walkable area, and routes that keep clear of walls."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely
from numpy.typing import ArrayLike, NDArray

from cityx.geometry.arrays import BoolArray, FloatArray, IntArray
from cityx.geometry.polylines import Polylines, arc_lengths, locate
from cityx.geometry.ranges import counted
from cityx.ground.walking.walkable import CELL, Walkable
from cityx.system.remembered import Remembered

BLOCK = 2  # cells along each side of what one node of the graph stands for
COMFORT = 0.7  # metres of clearance from which a way is no longer better
TIGHT = 1.5  # what a metre along a wall costs more than one in the open
PASSING = 0.45  # metres of clearance with which two people pass each other, shoulders turned
BOTTLENECK = 1.2  # metres from such a place to the middle of a narrow one that one waits at
NARROW, SINGLE_FILE = (
    0.35,
    12.0,
)  # metres of clearance where two can pass, what one costs more below
OFF_PAVEMENT = 0.6  # what a metre on the land beside a roadway costs more
CROSSING = {True: 1.0, False: 6.0}  # what a metre of a crosswalk costs more, with bars or without
WALKED = 1.3  # metres that one would rather walk than wait for a second
HERE = 1.2  # metres within which a place lies at a node
ROUND = (
    2.5  # metres that a walk feels like for one straight ahead, within which it is looked for first
)
SPACING = 0.5  # metres between the points of a route
LOOKS = (160, 80, 40, 20, 10, 5, 2, 1)  # points of a route that one straight line may replace


@dataclass(frozen=True)
class WalkGraph:
    """Nodes in the free cells of a walkable area, joined where one can walk straight, n of them.

    Attributes
    ----------
    places
        (n, 2) float64, metres.
    matrix
        (n, n) sparse, metres between neighbours as walkers feel them.
    component
        (n,) int32, number of the piece of the area; no way leads from one to another.
    size
        (pieces,) int64, nodes of each.
    """

    places: FloatArray
    matrix: Any
    component: NDArray[np.int32]
    size: IntArray
    tree: Any

    def nearest(self, xy: ArrayLike, most: float = HERE) -> IntArray:
        """Return (n,) nodes next to (n, 2) places, -1 where none lies within `most` metres."""
        far, row = self.tree.query(np.asarray(xy, float).reshape(-1, 2), distance_upper_bound=most)
        return np.where(np.isfinite(far), row, -1).astype(np.int64)


_LAST: Remembered[WalkGraph] = Remembered()


def walk_graph(walkable: Walkable) -> WalkGraph:
    """Return the graph of a walkable area; that of the last one is remembered."""
    return _LAST.get(lambda: _made(walkable), [walkable])


def _made(walkable: Walkable) -> WalkGraph:
    from scipy.sparse import csr_array
    from scipy.sparse.csgraph import connected_components
    from scipy.spatial import cKDTree

    cell, number = _nodes(walkable)
    one, other = _joined(walkable, cell, number)
    places = walkable.places(cell)
    cost = _cost(walkable, cell)
    weight = np.hypot(*(places[one] - places[other]).T) * (cost[one] + cost[other]) / 2
    matrix = csr_array(
        (np.r_[weight, weight], (np.r_[one, other], np.r_[other, one])), shape=(len(cell),) * 2
    )
    count, component = connected_components(matrix, directed=False)
    tree = cKDTree(places if len(places) else np.full((1, 2), np.inf))
    return WalkGraph(
        places, matrix, component, np.bincount(component, minlength=count).astype(np.int64), tree
    )


def _nodes(walkable: Walkable) -> tuple[IntArray, IntArray]:
    """(n, 2) cells that stand for their blocks, the freest of each, and (h, w) numbers of nodes."""
    rows, columns = (-(-size // BLOCK) for size in walkable.free.shape)
    room = np.full((rows * BLOCK, columns * BLOCK), -1.0, np.float16)
    inner = np.where(_passable(walkable), walkable.clearance, np.float16(-1.0))
    room[: inner.shape[0], : inner.shape[1]] = inner
    blocks = room.reshape(rows, BLOCK, columns, BLOCK).transpose(0, 2, 1, 3).reshape(
        rows * columns, BLOCK * BLOCK
    )  # fmt: skip
    best = np.argmax(blocks, axis=1)
    held = np.flatnonzero(blocks[np.arange(len(blocks)), best] >= 0)
    number = np.full(rows * columns, -1, np.int64)
    number[held] = np.arange(len(held))
    row, column = np.divmod(held, columns)
    cell = np.column_stack([row * BLOCK + best[held] // BLOCK, column * BLOCK + best[held] % BLOCK])
    return cell, number.reshape(rows, columns)


def _passable(walkable: Walkable) -> BoolArray:
    """(rows, columns) free cells, but for those of long stretches where no two people can pass."""
    from cityx.geometry.raster.distances import squares_to_closed

    wide = walkable.clearance >= PASSING
    reach = int(np.ceil(BOTTLENECK / CELL))
    near = squares_to_closed(~wide, walkable.free, reach + 1) <= reach**2
    return np.asarray(walkable.free & near)


def _joined(walkable: Walkable, cell: IntArray, number: IntArray) -> tuple[IntArray, IntArray]:
    """Pairs of nodes in neighbouring blocks between which a straight line stays free."""
    from cityx.ground.walking.sight import open_between

    pairs = []
    rows, columns = number.shape
    for down, right in ((0, 1), (1, 0), (1, 1), (1, -1)):
        left = max(-right, 0)
        one = number[: rows - down, left : columns - max(right, 0)]
        other = number[down:, left + right : columns - max(right, 0) + right]
        both = (one >= 0) & (other >= 0)
        pairs.append(np.column_stack([one[both], other[both]]))
    pair = np.concatenate(pairs)
    open_ = open_between(walkable.free, cell, pair, 4 * BLOCK)
    return pair[open_, 0], pair[open_, 1]


def _cost(walkable: Walkable, cell: IntArray) -> FloatArray:
    """(n,) what a metre costs at cells."""
    row, column = cell.T
    room = walkable.clearance[row, column].astype(float)
    cost = 1.0 + TIGHT * np.clip(1.0 - room / COMFORT, 0.0, 1.0)
    cost += SINGLE_FILE * (room < NARROW)
    cost += OFF_PAVEMENT * walkable.verge[row, column]
    over = walkable.crosswalk[row, column].astype(np.int64)
    marked = np.r_[False, walkable.crosswalks.marked]
    more = np.where(marked[over], CROSSING[True], CROSSING[False])
    waits = walkable.waits * WALKED / np.maximum(walkable.crosswalks.length, 1.0)
    more = more + np.r_[0.0, waits][over]
    return np.asarray(cost + np.where(over > 0, more, 0.0))


REACHES = (0.0, 15.0, 30.0, 45.0)  # metres from a ground within which walks by it are looked for


def nodes_by(graph: WalkGraph, ground: Any) -> IntArray:
    """(k,) nodes in a ground, or the first of `REACHES` about it that has some; else none."""
    for reach in REACHES:
        near = shapely.buffer(ground, reach) if reach else ground
        shapely.prepare(near)
        found = np.flatnonzero(shapely.intersects_xy(near, *graph.places.T))
        if len(found):
            return found
    return np.zeros(0, np.int64)


def ways_to(graph: WalkGraph, ground: Any) -> FloatArray:
    """(n,) metres, as walkers feel them, from each node to a ground; infinite without a way."""
    from scipy.sparse.csgraph import dijkstra

    nodes = nodes_by(graph, ground)
    if not len(nodes):
        return np.full(len(graph.places), np.inf)
    return np.asarray(dijkstra(graph.matrix, indices=nodes, min_only=True))


def walks_between(
    walkable: Walkable, origin: IntArray, goal: IntArray, longest: ArrayLike = np.inf
) -> tuple[Polylines, BoolArray]:
    """Find the ways between nodes of the graph of a walkable area.

    Parameters
    ----------
    walkable
        The area.
    origin, goal
        (k,) nodes of `walk_graph`. Few different goals are quick, many origins cost little.
    longest
        Metres, as walkers feel them, beyond which no way is looked for; one, or (k,) of which the
        farthest to each goal counts.

    Returns
    -------
    walks, found
        (k,) lines with a point every `SPACING` metres, in free cells throughout, and whether there
        is a way; where there is none the line is two points at its origin.
    """
    from scipy.sparse.csgraph import dijkstra

    graph = walk_graph(walkable)
    chains: list[IntArray] = [np.array([node, node]) for node in origin.tolist()]
    found = np.zeros(len(origin), bool)
    reach = np.broadcast_to(np.asarray(longest, float), (len(origin),))
    for target in np.unique(goal).tolist():
        mine = np.flatnonzero(goal == target)
        straight = np.hypot(*(graph.places[origin[mine]] - graph.places[target]).T)
        most = float(reach[mine].max())
        for limit in (min(ROUND * float(straight.max()), most), most):
            far, before = dijkstra(
                graph.matrix, indices=target, return_predecessors=True, limit=limit
            )
            if limit == most or np.isfinite(far[origin[mine]]).all():
                break
        for row in mine[np.isfinite(far[origin[mine]]) & (origin[mine] != target)].tolist():
            chains[row], found[row] = _chain(before, int(origin[row]), target), True
    start = np.cumsum([0] + [len(chain) for chain in chains])
    whole = np.concatenate([np.zeros(0, np.int64), *chains])
    return straightened(walkable, Polylines(graph.places[whole], start)), found


def _chain(before: NDArray[np.int32], origin: int, goal: int) -> IntArray:
    """Nodes from an origin to the goal that all `before` lead to."""
    nodes = [origin]
    while nodes[-1] != goal:
        nodes.append(int(before[nodes[-1]]))
    return np.array(nodes)


def straightened(walkable: Walkable, ways: Polylines) -> Polylines:
    """Pull ways straight as far as they stay clear of walls, and space their points evenly.

    Parameters
    ----------
    walkable
        The area.
    ways
        Lines whose points are each in sight of the next.

    Returns
    -------
    walks
        As many lines, with points `SPACING` apart at most; first and last stay.
    """
    if not ways.count:
        return ways
    points = ways.points
    clear = walkable.at(walkable.clearance, points).astype(np.float32)
    over = walkable.at(walkable.crosswalk, points)
    here, last = ways.start[:-1].copy(), ways.start[1:] - 1
    kept = np.zeros(len(points), bool)
    kept[here] = kept[last] = True
    # All ways at once: each goes on as far as it may straight, trying longer after each success.
    level = np.full(ways.count, len(LOOKS) // 2)
    going = np.flatnonzero(here < last)
    while len(going):
        ahead = np.minimum(here[going] + np.array(LOOKS)[level[going]], last[going])
        fits = ahead <= here[going] + 1
        rows = np.flatnonzero(~fits)
        if len(rows):
            fits[rows] = _straight(walkable, points, clear, over, here[going[rows]], ahead[rows])
        here[going[fits]] = ahead[fits]
        kept[ahead[fits]] = True
        level[going] = np.clip(level[going] + np.where(fits, -1, 1), 0, len(LOOKS) - 1)
        going = going[here[going] < last[going]]
    start = np.concatenate([[0], np.cumsum(np.add.reduceat(kept, ways.start[:-1]))])
    return _rounded(walkable, Polylines(points[kept], start.astype(np.int64)))


def _straight(
    walkable: Walkable, points: FloatArray, clear: NDArray[np.float32], over: NDArray[np.int16],
    a: IntArray, b: IntArray,
) -> BoolArray:  # fmt: skip
    """Return whether straight lines may replace (k,) stretches of ways, from points to points.

    They must be as clear as what they replace, and lead over no other roadway, nor longer.
    """
    length = np.hypot(*(points[b] - points[a]).T)
    count = np.ceil(length / (CELL / 2)).astype(np.int64) + 1
    row, number = counted(count)
    share = number / np.maximum(count - 1, 1)[row]
    line = points[a][row] + share[:, None] * (points[b] - points[a])[row]
    room = walkable.at(walkable.clearance, line)
    crossed = walkable.at(walkable.crosswalk, line)
    first = np.concatenate([[0], np.cumsum(count)[:-1]])
    stretch, step = counted(b - a + 1)
    of = a[stretch] + step
    begin = np.concatenate([[0], np.cumsum(b - a + 1)[:-1]])
    least = np.minimum(np.minimum.reduceat(clear[of], begin), COMFORT) - CELL / 2
    fits = np.minimum.reduceat(room, first) >= np.maximum(least, CELL / 4)
    for ends in (np.maximum, np.minimum):  # of one crosswalk at most, which the way takes as well
        was = ends.reduceat(over[of], begin)
        fits &= ends.reduceat(crossed, first) == was
    share_was = np.add.reduceat(over[of] > 0, begin) / (b - a + 1)
    share_now = np.add.reduceat(crossed > 0, first) / count
    return np.asarray(fits & (share_now <= share_was + 0.05))


def _rounded(walkable: Walkable, corners: Polylines) -> Polylines:
    """Round the corners of ways where there is room, with points evenly spaced."""
    length = arc_lengths(corners)[1]
    count = np.maximum(np.ceil(length / SPACING).astype(np.int64), 1) + 1
    line, number = counted(count)
    along = number / (count - 1)[line] * length[line]
    points = locate(corners, line, along)[0]
    # Straight lines may touch the corner of a cell that is not free.
    lost = np.flatnonzero(~walkable.holds(points))
    if len(lost):
        graph = walk_graph(walkable)
        points[lost] = graph.places[graph.nearest(points[lost])]
    least = np.minimum(walkable.at(walkable.clearance, points).astype(float), COMFORT)
    inner = (number > 0) & (number < (count - 1)[line])
    joined = number[1:] > 0
    for _ in range(4):
        smooth = points.copy()
        smooth[1:-1] = (points[:-2] + 2 * points[1:-1] + points[2:]) / 4
        fits = inner & (walkable.at(walkable.clearance, smooth) >= least - CELL / 2)
        fits &= walkable.holds(smooth)
        middles = walkable.holds((smooth[1:] + smooth[:-1]) / 2) | ~joined
        fits[1:] &= middles
        fits[:-1] &= middles
        points = np.where(fits[:, None], smooth, points)
    return Polylines(points, np.concatenate([[0], np.cumsum(count)]).astype(np.int64))
