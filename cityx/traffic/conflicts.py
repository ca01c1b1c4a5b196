"""Right of way: which path gives way to which where paths across a junction conflict.

SUMO tells conflicts by the order of the arms round a junction. Where several junctions of the map
are one here, or streets part at a small angle, that order does not say which ways cross.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.geometry.arrays import FloatArray, IntArray
from cityx.geometry.ranges import numbered
from cityx.traffic.streets import Streets

HALF_BODY = 1.0  # metres from the middle of a vehicle to its side, with a little air
NARROW = 1.8  # metres between the middles of two ways on which cars do not pass each other
STOREY = 2.5  # metres of height that part two streets
FACING = 4.0  # metres of one way on which somebody comes from ahead, from which on they are told
SPOT = 0.5  # metres between the places where it is looked at
BACKWARD = 0.7  # share of those metres that the other way leads back
GREEN, MINOR = "G", "g"
SIGNALLED = "traffic_light"


@dataclass(frozen=True)
class Conflicts:
    """Pairs of links that cannot be used at once, k of them.

    Attributes
    ----------
    first, second
        (k,) int64, links; the second gives way to the first.
    free
        (l,) float64, metres along each link before it meets any other.
    turn
        (l,) int64, whose turn it is where several wait for each other: the lowest goes first.
    """

    first: IntArray
    second: IntArray
    free: FloatArray
    turn: IntArray


def conflicts_of(streets: Streets, meeting: IntArray | None = None) -> Conflicts:
    """Find the links of each junction that meet on the ground.

    Parameters
    ----------
    streets
        With the links.
    meeting
        (m, 2) int64, pairs of links on which bodies touch, the lower first, where that is known of
        vehicles that drive there; by the lines of the links if None.
    """
    links, ways = streets.links, streets.ways
    none = np.zeros(0, np.int64)
    if not links:
        return Conflicts(none, none, np.zeros(0), none)
    source = np.array([link.source for link in links], np.int64)
    target = np.array([link.target for link in links], np.int64)
    junction = np.array([ways[way].target for way in source[:, 0].tolist()])
    lines = np.array([shapely.LineString(link.shape) for link in links], object)
    bodies = shapely.buffer(shapely.force_2d(lines), HALF_BODY, cap_style="flat")
    if meeting is None:
        meeting = _meeting(lines, bodies, source)
    one, other = meeting.T
    kept = (one < other) & (junction[one] == junction[other])
    kept &= (source[one] != source[other]).any(axis=1)
    one, other = one[kept], other[kept]
    free = _free(lines, bodies, one, other)
    _, lane, share = np.unique(source, axis=0, return_inverse=True, return_counts=True)
    free[share[lane.ravel()] > 1] = 0.0  # others of the lane would pass by who waits ahead of them
    middle = np.array([link.shape[:, 2].mean() for link in links])
    kept = np.abs(middle[one] - middle[other]) < STOREY
    one, other = one[kept], other[kept]
    # The street of the higher rank goes first, then who goes straighter; at last the order decides.
    rank = np.array([ways[way].rank for way in source[:, 0].tolist()])
    onto = np.array([ways[way].rank for way in target[:, 0].tolist()])
    bend = np.round(np.array([bend_of(link.shape) for link in links]), 3)
    key = np.column_stack([-rank, -onto, bend, np.arange(len(links))])
    order = np.empty(len(links), np.int64)
    order[np.lexsort(key.T[::-1])] = np.arange(len(links))
    swap = order[one] > order[other]
    return Conflicts(np.where(swap, other, one), np.where(swap, one, other), free, order)


def _meeting(lines: NDArray[Any], bodies: NDArray[Any], source: IntArray) -> IntArray:
    """(m, 2) pairs of links on whose lines bodies touch.

    Lanes side by side of one street meet only where their ways cross, or have no room for two.
    """
    one, other = shapely.STRtree(bodies).query(bodies, predicate="intersects")
    one, other = one[one < other], other[one < other]
    beside = source[one, 0] == source[other, 0]
    beside &= shapely.distance(lines[one], lines[other]) >= NARROW
    beside &= ~shapely.crosses(lines[one], lines[other])
    return np.column_stack([one[~beside], other[~beside]])


def facing(streets: Streets, conflicts: Conflicts) -> IntArray:
    """(k, 2) pairs of links, of those in conflict, that lead through one lane against each other.

    SUMO takes two ways to meet in one place. Who stops before that one, where they run against
    each other for long, stands in the way.
    """
    lines = np.array([shapely.LineString(link.shape[:, :2]) for link in streets.links], object)
    own, foe = conflicts.first, conflicts.second
    if not len(own):
        return np.zeros((0, 2), np.int64)
    count = np.maximum(shapely.length(lines[own]) // SPOT, 1).astype(np.int64)
    pair = np.repeat(np.arange(len(own)), count)
    along = (numbered(count)) * SPOT
    here, next_ = (shapely.line_interpolate_point(lines[own[pair]], along + step)
                   for step in (0.0, SPOT))  # fmt: skip
    other = lines[foe[pair]]
    back = shapely.line_locate_point(other, here) - shapely.line_locate_point(other, next_)
    against = (shapely.distance(here, other) < NARROW) & (back > BACKWARD * SPOT)
    shared = np.bincount(pair, against, len(own)) * SPOT
    return np.column_stack([own, foe])[shared >= FACING]


def _free(lines: NDArray[Any], bodies: NDArray[Any], one: IntArray, other: IntArray) -> FloatArray:
    """(l,) metres along lines before their bodies touch those of the lines they meet."""
    own, foe = np.concatenate([one, other]), np.concatenate([other, one])
    points, pair = shapely.get_coordinates(
        shapely.intersection(bodies[own], bodies[foe]), return_index=True
    )
    along = shapely.line_locate_point(lines[own[pair]], shapely.points(points))
    free = shapely.length(lines)
    np.minimum.at(free, own[pair], along)
    return np.asarray(free)


def bend_of(shape: FloatArray) -> float:
    """Return the radians between the directions in which a line begins and ends."""
    first, last = shape[1, :2] - shape[0, :2], shape[-1, :2] - shape[-2, :2]
    cross = first[0] * last[1] - first[1] * last[0]
    return abs(float(np.arctan2(cross, first @ last)))


def settle(root: Any, conflicts: Conflicts, lane_of: dict[int, str]) -> None:
    """Write conflicts that SUMO does not know into a network, without circular waiting.

    Parameters
    ----------
    root
        Of the network's XML.
    conflicts
        The conflicts.
    lane_of
        Link to the name of the first of its lanes in the network.
    """
    junctions = {element.get("id"): element for element in root.iter("junction")}
    controlled = {
        (c.get("from"), c.get("fromLane"), c.get("to"), c.get("toLane")):
        (c.get("tl"), int(c.get("linkIndex")))
        for c in root.iter("connection") if c.get("tl") is not None
    }  # fmt: skip
    by_via = {c.get("via"): controlled.get(
        (c.get("from"), c.get("fromLane"), c.get("to"), c.get("toLane")))
        for c in root.iter("connection")}  # fmt: skip
    plans = {element.get("id"): element for element in root.iter("tlLogic")}
    for first, second in zip(conflicts.first.tolist(), conflicts.second.tolist(), strict=True):
        if first not in lane_of or second not in lane_of:
            continue
        names = lane_of[first], lane_of[second]
        junction, before = _index(names[0])
        other, after = _index(names[1])
        if junction != other:
            continue
        requests = junctions[junction].findall("request")
        known = _bit(requests[before].get("foes"), after)
        yields = _bit(requests[before].get("response"), after)
        if not known:
            for here, there in ((before, after), (after, before)):
                _set_bit(requests[here], "foes", there)
            _set_bit(requests[after], "response", before)
        elif yields:
            names = names[::-1]
        _one_green(plans, by_via[names[0]], by_via[names[1]])
    turns: dict[str, dict[int, int]] = {}
    for link, name in lane_of.items():
        junction, place = _index(name)
        turns.setdefault(junction, {})[place] = int(conflicts.turn[link])
    for junction, turn in turns.items():
        if junctions[junction].get("type") != SIGNALLED:  # signals let few of them go at once
            _uncircle(junctions[junction].findall("request"), turn)


def _uncircle(requests: list[Any], turn: dict[int, int]) -> None:
    """Put links that give way to each other in a circle in one order.

    Else, once one stands at each of their lines, nobody ever goes.
    """
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    places = sorted(turn)
    pairs = [(i, j) for i in places for j in places if _bit(requests[i].get("response"), j)]
    if not pairs:
        return
    row, column = np.array(pairs).T
    size = len(requests)
    graph = coo_array((np.ones(len(row), bool), (row, column)), shape=(size, size))
    circle = connected_components(graph, connection="strong")[1]
    for i in places:
        for j in places:
            if i == j or circle[i] != circle[j] or not _bit(requests[i].get("foes"), j):
                continue
            _set_bit(requests[i], "response", j, "1" if turn[i] > turn[j] else "0")


def _one_green(
    plans: dict[str, Any], first: tuple[str, int] | None, second: tuple[str, int] | None
) -> None:
    """Make the second of two signals give way where both would show green."""
    if first is None or second is None or first[0] != second[0]:
        return
    for phase in plans[first[0]].findall("phase"):
        state = phase.get("state")
        if state[first[1]] == GREEN and state[second[1]] == GREEN:
            phase.set("state", state[: second[1]] + MINOR + state[second[1] + 1 :])


def _index(lane: str) -> tuple[str, int]:
    """Return the junction of a lane across it, and its number there."""
    junction, edge, place = lane[1:].rsplit("_", 2)
    return junction, int(edge) + int(place)


def _bit(bits: str, place: int) -> bool:
    return bits[len(bits) - 1 - place] == "1"


def _set_bit(request: Any, name: str, place: int, bit: str = "1") -> None:
    bits = request.get(name)
    at = len(bits) - 1 - place
    request.set(name, f"{bits[:at]}{bit}{bits[at + 1 :]}")
