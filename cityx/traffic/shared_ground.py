"""Where lanes of different streets share ground, and where walls or heights separate them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.geometry.arrays import BoolArray, FloatArray, IntArray
from cityx.geometry.polylines import Polylines, to_linestrings, values_along
from cityx.traffic.streets import Link

if TYPE_CHECKING:
    from cityx.city.city import City
    from cityx.city.lanes import LaneGraph
    from cityx.city.roads import RoadNetwork


OVERLAP = 0.2  # metres from the side of a lane that no vehicle needs
REACHED = 6.0  # metres from the end of a lane within which it lies on another for that end's sake
LONGEST_SHARED = 80.0  # metres of lanes that become part of a junction since they share ground
HALF_BODY = 0.95  # metres from the middle of a car to its side
HEADROOM = 4.0  # metres under a building that traffic needs to pass below it
BRUSHED = 1.5  # square metres in which two bodies may touch before one of their lanes is closed
STOREY = 2.5  # metres of height that part two streets


class Walls:
    """Buildings that stand on the ground; a class for what is prepared."""

    def __init__(self, city: City) -> None:
        parts = city.layout.parts
        low = parts["base"].to_numpy(float) < HEADROOM
        low &= parts["walls"].to_numpy(bool)
        self.tree = shapely.STRtree(parts.geometry.to_numpy()[low])

    def near(self, lines: NDArray[Any], half: float) -> BoolArray:
        """(n,) whether something so wide that follows a line would touch a wall."""
        bodies = shapely.buffer(shapely.force_2d(lines), half, cap_style="flat")
        near = np.zeros(len(lines), bool)
        near[self.tree.query(bodies, predicate="intersects")[0]] = True
        return near

    def clear(self, links: tuple[Link, ...]) -> tuple[Link, ...]:
        """Return the links on which a car touches no wall."""
        lines = np.array([shapely.LineString(link.shape) for link in links], object)
        near = self.near(lines, HALF_BODY).tolist()
        return tuple(link for link, touching in zip(links, near, strict=True) if not touching)


class Heights:
    """Heights of carriageways, found by edge and place along it; a class for what is prepared."""

    def __init__(self, city: City, network: RoadNetwork) -> None:
        self.terrain = city.terrain
        self.lines = network.lines
        self.network = network
        self.shapes = to_linestrings(self.lines)

    def lifted(self, edge: IntArray, points: FloatArray) -> FloatArray:
        """(k, 3) places of edges at the height of the carriageway."""
        along = shapely.line_locate_point(self.shapes[edge], shapely.points(points))
        lift = values_along(self.lines, self.network.lift, edge, along)
        own = values_along(self.lines, self.network.z, edge, along)
        z = np.where(lift != 0.0, own, self.terrain.height_at(points))
        return np.column_stack([points, np.round(z, 3)])


def shared_ground(
    network: RoadNetwork, graph: LaneGraph, lines: Polylines, chosen: BoolArray,
    junction: IntArray, heights: Heights,
) -> FloatArray:  # fmt: skip
    """(e, 2) metres from each end over which lanes lie on those of another edge that meets there.

    Where streets part at a small angle their lanes share ground far beyond the junction.
    """
    rows = np.flatnonzero(chosen)
    found = np.zeros((network.edge_count, 2))
    middle = to_linestrings(lines)[rows]
    half = np.maximum((graph.left - graph.right)[rows] / 2 - OVERLAP, OVERLAP)
    strips = shapely.buffer(middle, half, cap_style="flat")
    one, other = shapely.STRtree(strips).query(strips, predicate="intersects")
    edge = graph.edge[rows]
    apart = edge[one] != edge[other]
    one, other = one[apart], other[apart]
    ends = junction[network.edge_nodes]  # (e, 2)
    for side in (0, 1):
        meets = (ends[edge[one], side, None] == ends[edge[other]]).any(axis=1)
        a, b = one[meets], other[meets]
        ahead = (graph.direction[rows[a]] > 0) == (side == 0)
        pieces_, owner = shapely.get_parts(
            shapely.intersection(strips[a], strips[b]), return_index=True
        )
        points, piece = shapely.get_coordinates(pieces_, return_index=True)
        if not len(points):
            continue
        along = shapely.line_locate_point(middle[a][owner[piece]], shapely.points(points))
        length = shapely.length(middle[a])[owner[piece]]
        away = np.where(ahead[owner[piece]], along, length - along)
        near, far = np.full(len(pieces_), np.inf), np.zeros(len(pieces_))
        np.minimum.at(near, piece, away)
        np.maximum.at(far, piece, away)
        size = shapely.length(middle[a])[owner]
        level = _level(heights, edge.astype(np.int64), a[owner], b[owner], pieces_)
        joined = (near < REACHED) & level
        far = np.minimum(far, np.minimum(LONGEST_SHARED, size))
        np.maximum.at(found[:, side], edge[a[owner[joined]]], far[joined])
    return found


def closed_lanes(
    graph: LaneGraph, lines: Polylines, chosen: BoolArray, rank: IntArray, heights: Heights
) -> BoolArray:
    """(l,) lanes that are closed since they lie on one of another street, the lesser of the two.

    Maps draw the sides of a street nearer to each other than their lanes are wide. The lane of the
    side with more of them is closed, else that of the lower rank.
    """
    closed = np.zeros(graph.count, bool)
    rows = np.flatnonzero(chosen)
    middle = to_linestrings(lines)[rows]
    bodies = shapely.buffer(middle, HALF_BODY, cap_style="flat")
    one, other = shapely.STRtree(bodies).query(bodies, predicate="intersects")
    edge = graph.edge[rows].astype(np.int64)
    kept = (one < other) & (edge[one] != edge[other])
    one, other = one[kept], other[kept]
    ground = shapely.intersection(bodies[one], bodies[other])
    kept = shapely.area(ground) > BRUSHED
    kept[kept] &= _level(heights, edge, one[kept], other[kept], ground[kept])
    side = edge * 2 + (graph.direction[rows] > 0)
    lanes = np.bincount(side)
    for a, b in zip(one[kept].tolist(), other[kept].tolist(), strict=True):
        if closed[rows[[a, b]]].any():
            continue
        keys = [(lanes[side[each]], -rank[edge[each]], each) for each in (a, b)]
        lesser = max(keys)[2]
        closed[rows[lesser]] = True
        lanes[side[lesser]] -= 1
    return closed


def _level(
    heights: Heights, edge: IntArray, one: IntArray, other: IntArray, shapes: NDArray[Any]
) -> BoolArray:
    """(k,) whether two edges lie at one height where their lanes meet."""
    at = shapely.get_coordinates(shapely.centroid(shapes))
    z = [heights.lifted(edge[side], at)[:, 2] for side in (one, other)]
    return np.asarray(np.abs(z[0] - z[1]) < STOREY)
