"""Grade separation: where one way passes over another, and the clearance between them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely

from cityx.geometry.arrays import BoolArray, FloatArray, IntArray
from cityx.road.network.stations import STATION, Ways, nearest_station, walk_to

BESIDE = 4.0  # metres past the edge of what is crossed over which a deck keeps its height
PARTING = 80.0  # metres from where two ways part within which one does not pass over the other
DRAWN_SHORT = 15.0  # metres from a bridge or tunnel within which a way still passes over or under


@dataclass(frozen=True)
class Crossings:
    """Places where one way passes over another, c of them."""

    upper: IntArray  # (c,) way
    lower: IntArray
    upper_node: IntArray  # (c,) nearest station
    lower_node: IntArray
    high: IntArray  # (c,) level of the upper way; that of its bridge where this is drawn short
    low: IntArray
    need: FloatArray  # (c,) metres from the lower surface to the upper
    wide: FloatArray  # (c,) metres along the upper way that are over the lower
    under: FloatArray  # (c,) metres along the lower way that are under the upper

    def take(self, rows: BoolArray | IntArray) -> Crossings:
        """Return some of the places."""
        return Crossings(**{name: getattr(self, name)[rows] for name in self.__dataclass_fields__})


def find_crossings(ways: Ways) -> Crossings:
    """Find where centrelines cross, and where one way runs under another along its side."""
    parts = [_across(ways), _drawn_short(ways), _beside(ways)]
    upper, lower, over, under, high, low = np.concatenate(parts, axis=1)
    across = np.arange(len(upper)) < len(upper) - parts[-1].shape[1]
    found = Crossings(
        upper, lower, over, under, high, low,
        ways.clear[lower] + ways.deck[upper],
        np.where(across, ways.half[lower] + BESIDE, 2 * STATION),
        np.where(across, ways.half[upper] + BESIDE, 2 * STATION),
    )  # fmt: skip
    # Ways that share the very place meet there, whatever their levels say.
    return found.take(ways.node[over] != ways.node[under])


def _across(ways: Ways) -> IntArray:
    """(6, c) ways, stations and levels, the upper first, where lines of different rank cross."""
    off = np.flatnonzero(ways.level)
    one, other = shapely.STRtree(ways.shapes).query(ways.shapes[off], predicate="crosses")
    pair = np.unique(np.sort(np.column_stack([off[one], other]), axis=1), axis=0)
    rank = ways.rank
    pair = pair[rank[pair[:, 0]] != rank[pair[:, 1]]]
    high = rank[pair[:, 0]] > rank[pair[:, 1]]
    upper, lower = np.where(high, pair[:, 0], pair[:, 1]), np.where(high, pair[:, 1], pair[:, 0])
    upper, lower, over, under = _meetings(ways, upper, lower)
    return np.stack([upper, lower, over, under, ways.level[upper], ways.level[lower]])


def same_level(
    ways: Ways, *, off: bool = False
) -> tuple[IntArray, IntArray, IntArray, IntArray]:  # fmt: skip
    """Find where streets and railways on the ground, or `off` it, cross without a common node.

    Returns
    -------
    one, other, here, there
        (k,) ways, and the station of each.
    """
    flat = np.flatnonzero(~ways.light & ((ways.level != 0) == off))
    one, other = shapely.STRtree(ways.shapes[flat]).query(ways.shapes[flat], predicate="crosses")
    one, other = flat[one], flat[other]
    pair = (one < other) & (ways.level[one] == ways.level[other])
    return _meetings(ways, one[pair], other[pair])


def _meetings(
    ways: Ways, one: IntArray, other: IntArray
) -> tuple[IntArray, IntArray, IntArray, IntArray]:
    """(k,) ways at each place where pairs of them cross, and the nearest station of each."""
    spots = shapely.intersection(ways.shapes[one], ways.shapes[other])
    points, row = shapely.get_coordinates(spots, return_index=True)
    one, other = one[row], other[row]
    return one, other, nearest_station(ways, one, points), nearest_station(ways, other, points)


def _drawn_short(ways: Ways) -> IntArray:
    """Find crossings of one level where a bridge or tunnel of one of the ways ends too soon.

    Returns
    -------
    crossings
        (6, c) as `_across`.
    """
    one, other, here, there = same_level(ways)
    found = []
    for level in (1, -1):
        far = walk_to(ways, level)
        mine, yours = far[ways.node[here]], far[ways.node[there]]
        for near, beyond, rows in ((mine, yours, (one, other, here, there)),
                                   (yours, mine, (other, one, there, here))):  # fmt: skip
            chosen = (near < DRAWN_SHORT) & (beyond > DRAWN_SHORT)
            moves, stays, at, facing = (row[chosen] for row in rows)
            size = np.full(len(moves), level)
            still = np.zeros(len(moves), np.int64)
            found.append(np.stack([moves, stays, at, facing, size, still])[
                [0, 1, 2, 3, 4, 5] if level > 0 else [1, 0, 3, 2, 5, 4]
            ])  # fmt: skip
    return np.concatenate(found, axis=1)


def _beside(ways: Ways) -> IntArray:
    """Find stations of streets that lie under the side of a bridge, or over that of a cutting.

    Returns
    -------
    crossings
        (6, c) as `_across`.
    """
    off = np.flatnonzero((ways.level > 0) | ((ways.level < 0) & ~ways.light))
    owner = ways.owner
    street = np.flatnonzero((ways.edge >= 0)[owner])
    spots = shapely.points(ways.lines.points[street])
    tree = shapely.STRtree(spots)
    widest = ways.half[ways.edge >= 0].max(initial=0.0) / 2
    way, spot = tree.query(ways.shapes[off], predicate="dwithin", distance=ways.reach[off] + widest)
    way, station = off[way], street[spot]
    other = owner[station]
    near = shapely.distance(ways.shapes[way], spots[spot]) < ways.reach[way] + ways.half[other] / 2
    near &= ways.rank[way] != ways.rank[other]
    way, station, other = way[near], station[near], other[near]
    facing = nearest_station(ways, way, ways.lines.points[station])
    above = ways.rank[way] > ways.rank[other]
    found = np.where(above, [way, other, facing, station], [other, way, station, facing])
    apart = ~parting(ways, way, station) & ~_joining(ways, found)
    upper, lower = found[:2]
    return np.concatenate([found, [ways.level[upper], ways.level[lower]]])[:, apart]


def parting(ways: Ways, way: IntArray, station: IntArray) -> BoolArray:
    """(k,) whether a way shares an end with that of a station near: they are one surface there."""
    other = ways.owner[station]
    ends = np.concatenate([ways.lines.start[:-1], ways.lines.start[1:] - 1])
    place = ways.node[ends].reshape(2, -1)
    at = ways.lines.points[ends].reshape(2, -1, 2)
    found = np.zeros(len(way), bool)
    for mine in (0, 1):
        for theirs in (0, 1):
            meet = place[mine, way] == place[theirs, other]
            far = np.hypot(*(ways.lines.points[station] - at[mine, way]).T)
            found |= meet & (far < PARTING)
    return found


def _joining(ways: Ways, found: IntArray) -> BoolArray:
    """(k,) whether a street beside a bridge or tunnel comes onto that level too close by."""
    upper, lower, over, under = found
    raised = ways.level[upper] > 0
    level = np.where(raised, ways.level[upper], ways.level[lower])
    node = ways.node[np.where(raised, under, over)]
    joining = np.zeros(len(upper), bool)
    for each in np.unique(level).tolist():
        rows = np.flatnonzero(level == each)
        joining[rows] = np.isfinite(walk_to(ways, each)[node[rows]])
    return np.asarray(joining & ~ways.light[upper] & ~ways.light[lower])
