"""Ways across junctions from arm to arm, also where a junction has several nodes."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.city.lanes import MOVEMENTS, LaneGraph
from cityx.city.section import KIND
from cityx.geometry.arrays import BoolArray, FloatArray, IntArray
from cityx.geometry.polylines import Polylines, to_linestrings
from cityx.geometry.ranges import ranges
from cityx.road.markings.marks import Shapes, Street
from cityx.road.network.lane_graph import LEFT, RIGHT, STRAIGHT, THROUGH, ways_between

MOST_LANES = 5  # short lanes in a row within one junction
AT_KERB = 0.05  # metres between a kerb and what lies along it
CARS = [KIND[name] for name in ("drive", "bus")]


@dataclass(frozen=True)
class JunctionWays:
    """Ways across junctions, w of them.

    Attributes
    ----------
    hub
        (w,) lowest node of the junction, of `Street.cluster`.
    origin, target
        (w,) lanes of the lane graph.
    edge, end
        (w,) the edge that they come from, and its end at the junction.
    movement
        (w,) into `cityx.city.lanes.MOVEMENTS`, by the turn from arm to arm.
    width
        (w,) float, metres of the lane they come from.
    kerbside
        (w,) bool, whether it lies along the kerb on the side that traffic keeps to.
    line
        The ways, in the direction of travel.
    """

    hub: IntArray
    origin: IntArray
    target: IntArray
    edge: IntArray
    end: IntArray
    movement: IntArray
    width: FloatArray
    kerbside: BoolArray
    line: Polylines

    def take(self, rows: Any) -> JunctionWays:
        """Return the given ways (indices or mask)."""
        index = np.arange(len(self.hub))[rows]
        point, start = ranges(self.line.start, index)
        chosen = {column.name: getattr(self, column.name)[index] for column in fields(self)[:-1]}
        return JunctionWays(**chosen, line=Polylines(self.line.points[point], start))


def junction_ways(street: Street, graph: LaneGraph, *, bicycles: bool = False) -> JunctionWays:
    """Find the ways of cars across the junctions of a network, or those of bicycles.

    Parameters
    ----------
    street, graph
        The network and its lanes.
    bicycles
        Whether ways from or to lanes of bicycles are meant.
    """
    cluster = street.cluster
    ends = cluster[street.network.edge_nodes[graph.edge]]
    inside = (ends[:, 0] == ends[:, 1]) if graph.count else np.zeros(0, bool)
    cars, cycled = np.isin(graph.kind, CARS), graph.kind == KIND["cycle"]
    if not bicycles:
        pairs = _pairs(graph, inside, cars)
    elif cycled.any():
        pairs = _pairs(graph, inside, cars | cycled)
        pairs = [(one, other) for one, other in pairs if cycled[one] or cycled[other]]
    else:
        pairs = []
    origin, target = (np.array(column, np.int64) for column in zip(*pairs, strict=True)) if pairs \
        else (np.zeros(0, np.int64),) * 2  # fmt: skip
    line = ways_between(graph.lines, origin, target)
    edge = graph.edge[origin].astype(np.int64)
    end = (graph.direction[origin] > 0).astype(np.int64)
    hub = cluster[street.network.edge_nodes[edge, end]]
    outer, _ = kerbside(
        street, edge, graph.direction[origin], graph.left[origin], graph.right[origin]
    )
    return JunctionWays(hub, origin, target, edge, end, _movements(line),
                        (graph.left - graph.right)[origin], outer, line)  # fmt: skip


def kerbside(
    street: Street, edge: IntArray, direction: NDArray[np.int8], left: FloatArray, right: FloatArray
) -> tuple[BoolArray, FloatArray]:
    """Return which lanes lie along the kerb on the side that traffic keeps to.

    Parameters
    ----------
    street
        The network.
    edge, direction, left, right
        (k,) of the lanes, as of `cityx.city.lanes.LaneGraph`.

    Returns
    -------
    along, side
        (k,) bool, and (k,) 1 where that side is the left of the edge, -1 where it is the right.
    """
    side = np.where(street.network.left_hand[edge] == (direction > 0), 1.0, -1.0)
    away = street.network.half_width[edge] - np.where(side > 0, left, -right)
    return np.abs(away) < AT_KERB, side


def conflicts(ways: JunctionWays) -> Shapes:
    """Return where ways from different arms into different ones cross, points and lines."""
    lines = to_linestrings(ways.line)
    one, other = shapely.STRtree(lines).query(lines, predicate="intersects")
    apart = (one < other) & (ways.edge[one] != ways.edge[other])
    apart &= ways.target[one] != ways.target[other]
    return np.asarray(shapely.intersection(lines[one[apart]], lines[other[apart]]))


def _pairs(graph: LaneGraph, inside: BoolArray, chosen: BoolArray) -> list[tuple[int, int]]:
    """Chosen lanes that lead into a junction and those that one leaves it by, in order."""
    onward: dict[int, list[int]] = {}
    driven = chosen[graph.connection].all(axis=1) & (graph.movement != MOVEMENTS.index("reverse"))
    for origin, target in graph.connection[driven].tolist():
        onward.setdefault(origin, []).append(target)
    found: set[tuple[int, int]] = set()
    for origin in sorted(onward):
        if inside[origin]:
            continue
        reached, border = {origin}, [origin]
        for _ in range(MOST_LANES):
            beyond = [lane for last in border for lane in onward.get(last, ())]
            found.update((origin, lane) for lane in beyond if not inside[lane])
            border = [lane for lane in dict.fromkeys(beyond) if inside[lane]]
            border = [lane for lane in border if lane not in reached]
            reached.update(border)
    edge = graph.edge
    return sorted((one, other) for one, other in found if edge[one] != edge[other])


def _movements(line: Polylines) -> IntArray:
    """(w,) into `MOVEMENTS`, by how far each way turns between its ends."""
    if not line.count:
        return np.zeros(0, np.int64)
    first, last = line.start[:-1], line.start[1:] - 1
    ahead = line.points[first + 1] - line.points[first]
    onward = line.points[last] - line.points[last - 1]
    cross = ahead[:, 0] * onward[:, 1] - ahead[:, 1] * onward[:, 0]
    angle = np.arctan2(cross, (ahead * onward).sum(axis=1))
    turned = np.where(angle > 0, LEFT, RIGHT)
    return np.asarray(np.where(np.abs(angle) < STRAIGHT, THROUGH, turned))
