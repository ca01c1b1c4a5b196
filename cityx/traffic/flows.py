"""Flows of requested vehicles: from one place to another, or along streets."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np
import shapely
from numpy.typing import ArrayLike, NDArray

from cityx.errors import ActionFailed
from cityx.geometry.arrays import FloatArray
from cityx.ids import choose, hash_ids, id_text
from cityx.traffic.demand import Drivable
from cityx.traffic.kinds import DRIVING, LARGE
from cityx.traffic.plain import allowed_on
from cityx.traffic.simulation import Look, Trip
from cityx.traffic.streets import Lane

UInt64Array = NDArray[np.uint64]

ACROSS = 10.0  # metres more to the other side of the street, when that one leads on
REACH = 60.0  # metres from a place to the lane on which one sets out or arrives
AT_THE_STREET = REACH + ACROSS  # metres from a place to who sets out from it or has arrived
AIR = 2.0  # metres between vehicles that stand one behind the other
HEADWAY = 3.0  # seconds between vehicles that set out from one place
UNTRIED: Mapping[int, int] = MappingProxyType({})


@dataclass(frozen=True)
class Slot:
    """A place on a lane where a vehicle is when the tracks begin.

    Attributes
    ----------
    way, lane
        The way and the place of the lane on it.
    at
        Metres from the lane's start to the vehicle's foremost point.
    """

    way: int
    lane: int
    at: float


def between(
    net: Drivable, look: Look, ids: UInt64Array, start: FloatArray, goal: FloatArray,
    tried: Mapping[int, int] = UNTRIED,
) -> tuple[Trip, ...]:  # fmt: skip
    """Start vehicles from one place to another, one after the other.

    Parameters
    ----------
    net
        The streets.
    look
        Type of vehicle.
    ids
        (n,) uint64 of the vehicles.
    start, goal
        (2,) float64, metres.
    tried
        For each id how often it has been in the way of others; so much later it sets out.

    Raises
    ------
    ActionFailed
        If no street is near, or no way leads from the one to the other; says where.
    """
    starts, goals = _near(net, start, "start"), _near(net, goal, "goal")
    pairs = sorted(((one, other) for one in starts for other in goals),
                   key=lambda pair: pair[0].off + pair[1].off)  # fmt: skip
    for one, other in pairs:
        route = _quickest(net, one.way, other.way, look)
        if route is not None:
            break
    else:
        raise ActionFailed(
            f"No way for cars leads from {_said(start)} to {_said(goal)}: one-way streets or gaps "
            "between streets part them."
        )
    names = tuple(net.streets.ways[way].name for way in route)
    return tuple(
        Trip(id_text(int(own)), 0, names, rolling=False,
             depart=HEADWAY * (number + tried.get(int(own), 0)), at=one.along,
             until=other.along)
        for number, own in enumerate(ids.tolist())
    )  # fmt: skip


def along(
    net: Drivable, look: Look, ids: UInt64Array, edges: Sequence[Sequence[int]],
    taken: Sequence[shapely.Geometry], *, pace: float | None, said: str, exact: bool,
    tried: Mapping[int, int] = UNTRIED,
) -> tuple[Trip, ...]:  # fmt: skip
    """Spread vehicles evenly over the lanes of streets, under way when the tracks begin.

    Parameters
    ----------
    net
        The streets.
    look
        Type of vehicle.
    ids
        (n,) uint64 of the vehicles.
    edges
        Edges of the network, in groups such as bridges; each group gets its share.
    taken
        Ground on which something moves already.
    pace
        Metres per second at the beginning, None for what is allowed.
    said
        What the streets are called, for errors.
    exact
        Whether all must find room, rather than those for whom there is some.
    tried
        For each id how many places and ways it has had already; it gets others.

    Raises
    ------
    ActionFailed
        If they do not fit; says how many do.
    """
    slots = [_slots(net, group, look, taken) for group in edges]
    room = sum(map(len, slots))
    if room < len(ids) and not exact:
        ids = ids[:room]
    if room < max(len(ids), 1):
        raise ActionFailed(
            f"{len(ids)} vehicles of {look.size[0]:g} m do not fit on {said}: there is room for "
            f"{room}."
        )
    chosen = [_spread(own, count) for own, count in zip(slots, _shares(slots, len(ids)),
                                                        strict=True)]  # fmt: skip
    spare = [[slot for slot in own if slot not in part]
             for own, part in zip(slots, map(frozenset, chosen), strict=True)]  # fmt: skip
    places = [(slot, left) for part, left in zip(chosen, spare, strict=True) for slot in part]
    trips = []
    for own, (first, left) in zip(ids.tolist(), places, strict=True):
        tries = tried.get(own, 0)
        slot = left.pop(_drawn(net, own, tries, np.ones(len(left)))) if tries and left else first
        route = _onward(net, slot.way, own, look, tries)
        names = tuple(net.streets.ways[way].name for way in route)
        trips.append(Trip(id_text(int(own)), 0, names, depart=0.0, lane=slot.lane, at=slot.at,
                          pace=pace))  # fmt: skip
    return tuple(trips)


def flow_ids(seed: int, purpose: str, count: int) -> UInt64Array:
    """Return (n,) uint64 ids of the vehicles of a flow."""
    return hash_ids(seed, purpose, np.arange(count))


@dataclass(frozen=True)
class _Near:
    """A way near a place, metres from it, and metres along the way to where it is nearest."""

    way: int
    off: float
    along: float


def _near(net: Drivable, place: FloatArray, what: str) -> list[_Near]:
    """Return the ways near a place, on either side of the street."""
    rows, lines = net.lines
    spot = shapely.Point(place)
    off = np.round(shapely.distance(lines, spot), 3) if len(lines) else np.array([np.inf])
    if off.min() > REACH:
        near = "" if not len(lines) else f" The nearest lies {off.min():.0f} m away."
        raise ActionFailed(f"No street for cars lies within {REACH:g} m of the {what} "
                           f"{_said(place)}.{near}")  # fmt: skip
    return [
        _Near(int(rows[row]), float(off[row]), float(shapely.line_locate_point(lines[row], spot)))
        for row in np.flatnonzero(off <= min(off.min() + ACROSS, REACH)).tolist()
    ]


def _said(place: FloatArray) -> str:
    return f"({place[0]:.1f}, {place[1]:.1f})"


def route_between(net: Drivable, start: int, goal: int) -> list[int] | None:
    """Return the quickest ways from one to another, both included; None when there are none."""
    return _route(net, start, goal, large=False)


def _quickest(net: Drivable, start: int, goal: int, look: Look) -> list[int] | None:
    """Return the quickest ways for a vehicle; a long one takes tight ones where it has to."""
    wide = _route(net, start, goal, large=True) if look.kind in LARGE else None
    return wide or route_between(net, start, goal)


def _route(net: Drivable, start: int, goal: int, *, large: bool) -> list[int] | None:
    from scipy.sparse.csgraph import dijkstra

    seconds, before = dijkstra(net.matrix(0, large=large), indices=start,
                               return_predecessors=True)  # fmt: skip
    if not np.isfinite(seconds[goal]):
        return None
    route = [goal]
    while route[-1] != start:
        route.append(int(before[route[-1]]))
    return route[::-1]


def _onward(net: Drivable, start: int, own: int, look: Look, tries: int) -> list[int]:
    """Return the way out of the site from a street, one of those there are."""
    from scipy.sparse.csgraph import dijkstra

    for large in (True, False) if look.kind in LARGE else (False,):
        reached = np.isfinite(dijkstra(net.matrix(0, large=large), indices=start))
        weight = net.exits & reached
        if weight.any():
            break
    else:
        weight = reached
    goal = _drawn(net, own, tries, weight)
    return _quickest(net, start, goal, look) or [start]


def _drawn(net: Drivable, own: int, tries: int, weight: ArrayLike) -> int:
    """Draw for a vehicle, another time for each of its tries."""
    return int(choose(net.city.seed, "traffic/onward", [np.uint64(own)], weight, tries)[0])


def _slots(
    net: Drivable, edges: Sequence[int], look: Look, taken: Sequence[shapely.Geometry]
) -> list[Slot]:
    """Return the places on lanes of edges that are free for vehicles, and open to them."""
    tree, length = shapely.STRtree(list(taken)), look.size[0]
    driven = DRIVING[look.kind].sumo_class
    found = []
    for number, way in enumerate(net.streets.ways):
        if way.edge not in edges or not net.usable[number]:
            continue
        for index, lane in enumerate(way.lanes):
            if not (lane.public or lane.kind == "bus") or driven not in allowed_on(lane).split():
                continue
            count = int((lane.length - AIR) // (length + AIR))
            gap = lane.length / max(count, 1)
            for place in range(count):
                front = (place + 0.5) * gap + length / 2
                body = _body(lane, front, length)
                if not len(tree.query(body, predicate="intersects")):
                    found.append(Slot(number, index, front))
    return found


def _body(lane: Lane, front: float, length: float) -> shapely.Geometry:
    from shapely.ops import substring

    line = shapely.LineString(lane.shape[:, :2])
    return substring(line, max(front - length - AIR, 0.0), front + AIR).buffer(lane.width / 2)


def _shares(slots: list[list[Slot]], count: int) -> list[int]:
    """Divide vehicles among groups by their room; as many groups as can get one."""
    room = np.array([len(own) for own in slots])
    shares = np.minimum(room, 1) if count >= (room > 0).sum() else np.zeros(len(room), int)
    while shares.sum() < count:
        left = np.where(shares < room, (shares + 1) / np.maximum(room, 1), np.inf)
        shares[int(np.argmin(left))] += 1
    return [int(share) for share in shares]


def _spread(slots: list[Slot], count: int) -> list[Slot]:
    """Choose some of the places, evenly over all."""
    if not count:
        return []
    step = (np.arange(count) + 0.5) * len(slots) / count
    return [slots[place] for place in step.astype(int).tolist()]
