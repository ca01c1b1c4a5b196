"""Grade separation: where one way passes over another, and the clearance between them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely

from cityx.geometry.arrays import BoolArray, FloatArray, IntArray
from cityx.ground.grades import Gaps
from cityx.road.network.stations import STATION, Ways, nearest_station, walk_to

BESIDE = 4.0  # metres past the edge of what is crossed over which a deck keeps its height
PARTING = 80.0  # metres from where two ways part within which one does not pass over the other
ACUTE = 0.25  # sine of the angle of a crossing below which it reaches no farther
STACKED = 1.0  # metres
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

    @property
    def pairs(self) -> IntArray:
        """(c, 2) ways of each place, the upper first."""
        return np.column_stack([self.upper, self.lower])

    def between(self, pairs: IntArray) -> BoolArray:
        """(c,) whether the two ways are one of (k, 2) pairs."""
        return pairs_among(self.pairs, pairs)

    def take(self, rows: BoolArray | IntArray) -> Crossings:
        """Return some of the places."""
        return Crossings(**{name: getattr(self, name)[rows] for name in self.__dataclass_fields__})


def pairs_among(pairs: IntArray, known: IntArray) -> BoolArray:
    """(k,) whether each of (k, 2) pairs of ways is among known ones."""
    size = 1 + max(int(pairs.max(initial=0)), int(known.max(initial=0)))
    return np.asarray(np.isin(pairs @ [size, 1], known @ [size, 1]))


def find_crossings(ways: Ways) -> Crossings:
    """Find where centrelines cross, and where one way runs under another along its side."""
    across = _across(ways)
    parts = [across, _drawn_short(ways), *_beside(ways, across)]
    upper, lower, over, under, high, low = np.concatenate(parts, axis=1)
    part = np.repeat(np.arange(len(parts)), [each.shape[1] for each in parts])
    near = np.array([0.0, 0.0, 2.0, 0.0])[part] * STATION
    found = Crossings(
        upper, lower, over, under, high, low,
        ways.clear[lower] + ways.deck[upper],
        np.where(part < 2, ways.half[lower] + BESIDE, near),
        np.where(part < 2, ways.half[upper] + BESIDE, near),
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


def _beside(ways: Ways, across: IntArray) -> tuple[IntArray, IntArray]:
    """Find stations of streets that lie under the side of a bridge, or over that of a cutting.

    Ways that part from each other there, or join close by, are left out unless they cross.

    Parameters
    ----------
    ways
        The ways.
    across
        Where they cross, as `_across` has it.

    Returns
    -------
    along, about
        (6, c) as `_across`, each: along the side of a way, and about a place where the two cross.
    """
    found, way, station = over_streets(ways)
    apart = ~parting(ways, way, station) & ~_joining(ways, found)
    apart &= (ways.level[way] > 0) | ~ways.light[way]
    about = ~apart & _about(ways, found, across)
    found = np.concatenate([found, ways.level[found[:2]]])
    return found[:, apart], found[:, about]


def stacked(ways: Ways, z: FloatArray) -> Gaps:
    """List stations of streets and of ways over or under them, as far apart as they are.

    Parameters
    ----------
    ways
        The ways.
    z
        (n,) heights of nodes; what lies nearer than `STACKED` there is one surface.
    """
    upper, lower, over, under = over_streets(ways)[0]
    gap = z[ways.node[over]] - z[ways.node[under]]
    rows = gap > STACKED
    need = np.minimum(gap, ways.clear[lower] + ways.deck[upper])
    return Gaps(ways.node[over][rows], ways.node[under][rows], need[rows])


def over_streets(ways: Ways) -> tuple[IntArray, IntArray, IntArray]:
    """Find stations of streets in the width of ways of another level off the ground.

    Returns
    -------
    found
        (4, k) ways and stations, the upper first.
    way, station
        (k,) the way off the ground, and the station of the street.
    """
    off, owner = np.flatnonzero(ways.level), ways.owner
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
    return found, way, station


def _about(ways: Ways, found: IntArray, across: IntArray) -> BoolArray:
    """(k,) whether places lie about a crossing of the same two ways, where one is over the other.

    The more acute the angle at which they cross, the farther that goes.
    """
    upper, lower, over = found[:3]
    across = across[:, ways.node[across[2]] != ways.node[across[3]]]
    count, points = ways.lines.count, ways.lines.points
    one, other = (_directions(ways, station) for station in across[2:4])
    turn = np.abs(one[:, 0] * other[:, 1] - one[:, 1] * other[:, 0])
    wide = ways.half[across[0]] + ways.half[across[1]]
    reach = wide / np.maximum(turn, ACUTE) + BESIDE
    known, place = across[0] * count + across[1], points[across[2]]
    order = np.argsort(known, kind="stable")
    begin, end = (np.searchsorted(known[order], upper * count + lower, side)
                  for side in ("left", "right"))  # fmt: skip
    near = np.zeros(len(upper), bool)
    for k in range(int((end - begin).max(initial=0))):
        rows = np.flatnonzero(begin + k < end)
        which = order[begin[rows] + k]
        near[rows] |= np.hypot(*(points[over[rows]] - place[which]).T) < reach[which]
    return near


def _directions(ways: Ways, station: IntArray) -> FloatArray:
    """(k, 2) unit vectors along ways at stations."""
    owner, points = ways.owner[station], ways.lines.points
    before = np.maximum(station - 1, ways.lines.start[owner])
    after = np.minimum(station + 1, ways.lines.start[owner + 1] - 1)
    step = points[after] - points[before]
    return np.asarray(step / np.maximum(np.hypot(*step.T), 1e-9)[:, None])


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
