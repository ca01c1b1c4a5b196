"""Drivers: vehicles that go to a place, leave it, or go from one to another by the streets."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Annotated, Literal

import numpy as np
import shapely

from cityx.assets.vehicles.movers import SPECIAL
from cityx.city import City
from cityx.city.tracks import Tracks
from cityx.edit.life.places import ground_of
from cityx.errors import ActionFailed
from cityx.geometry.arrays import FloatArray
from cityx.ids import id_text
from cityx.motion.traffic import held_tracks
from cityx.motion.vehicle_flow import Driven, keeping, with_vehicles
from cityx.protocol import ObjectName, Port, Range, Serves, action, has_network
from cityx.protocol.objects import find_objects
from cityx.road.network.lane_graph import lanes
from cityx.traffic.demand import Drivable
from cityx.traffic.flows import AIR, HEADWAY, REACH, UNTRIED, UInt64Array, between, flow_ids
from cityx.traffic.kinds import DRIVING, LARGE
from cityx.traffic.simulation import Look, Trip

ACTION = "dynamic/drivers-v1"
TRIED = 6  # streets by a place of which one leads on, at most
APART = 8.0  # metres between those who set out together
AT_THE_END = 0.9  # share of a street far away behind who arrives there, ahead of who sets out
CLOSE = 0.1  # metres from objects to their ground
PACE = 4.0  # metres per second on the way, with stops at junctions
WAIT = 45.0  # seconds for one long stop besides, such as half a cycle of signals
SHORTEST = 15.0  # metres of a way
LONGEST = 300.0  # seconds of tracks that are made longer so that vehicles arrive


@action(
    ACTION,
    limits=[
        "What moves already keeps its way; the new vehicles give way to it.",
        "They set out from and arrive on the street by a place, not in its yard.",
    ],
    requires=("layout", has_network()),
    takes=(Port("lanes", "line", role="lane_graph", optional=True),),
    gives=(Port("vehicles", "line", role="vehicle_tracks"),),
    labels=("vehicles", "driving to", "route", "ambulance run", "bus line", "from", "to"),
    serves=tuple(
        Serves(
            "edit=add_agent",
            f"agent={kind}",
            *ends,
            "!mode",
            kind={"vehicle": "car"}.get(kind, kind),
        )
        for kind in (*DRIVING, *SPECIAL, "vehicle")
        for ends in (("to",), ("from", "!to"))
    ),
    binds={
        "count": "count",
        "speed": "speed",
        "goal": "walk.goal",
        "origin": "walk.origin",
    },
    needs=("libsumo",),
)
def drivers(
    city: City,
    *,
    kind: Literal[
        "car",
        "van",
        "truck",
        "bus",
        "motorcycle",
        "bicycle",
        "taxi",
        "police",
        "ambulance",
        "fire_engine",
        "snow_plough",
    ] = "car",
    origin: Annotated[tuple[str, ...] | None, ObjectName()] = None,
    goal: Annotated[tuple[str, ...] | None, ObjectName()] = None,
    count: Annotated[int, Range(1, 100)] = 1,
    speed: Annotated[float | None, Range(1.0, 70.0)] = None,
    duration: Annotated[float, Range(1.0, 3600.0)] = 60.0,
) -> City:
    """Let vehicles drive to some objects, from some, or from these to those, by the rules.

    The same call once more adds as many others.

    Parameters
    ----------
    city
        City with a road network and lanes.
    kind
        Of vehicle.
    origin, goal
        Buildings, squares, streets and other objects that they leave, and that they go to; where
        one is left out, the farthest street from which, or to which, a way leads; without both
        they come from there to the middle of the site. Those for whom
        the streets next to the place have room set out at once, the others after them.
    count
        How many.
    speed
        Metres per second that they keep where they can, None for what is allowed.
    duration
        Seconds that they drive at most, or as long as others move, if that is longer; more where
        the way takes longer, up to five minutes. Tracks end with the last arrival; a note tells
        how many have not arrived by then.

    Raises
    ------
    ActionFailed
        If no street is near, or no way leads from the one to the other.
    """
    city = city if city.lanes is not None else lanes(city)
    ends = [_place_of(city, names) if names else None for names in (origin, goal)]
    if not origin and not goal:
        ends[1] = _middle_of(city)
    if ends[0] is not None and ends[1] is not None and ends[0].ids == ends[1].ids:
        raise ActionFailed("The vehicles would arrive where they set out; name two places.")
    held = held_tracks(city)
    said = ">".join(" ".join(map(id_text, end.ids)) if end else "" for end in ends)
    ids = flow_ids(city.seed, f"{ACTION}/{kind}/{said}/{speed}", count + held.count)
    ids = ids[~np.isin(ids, held.object_id)][:count]  # those of earlier calls drive on
    seconds = max(duration, held.duration)

    def plan(net: Drivable, look: Look, _: Tracks) -> Driven:
        trips, first = _way(net, look, ids, *ends)
        look = keeping(look, net.streets, first.route)
        takes = _metres(net, first) / min(speed or PACE, PACE) + WAIT + HEADWAY * count
        return Driven(look, trips, max(seconds, min(takes, LONGEST)))

    return with_vehicles(city, plan, ids, action=ACTION, kind=kind, speed=speed)


@dataclass(frozen=True)
class _Place:
    """Where vehicles set out or arrive: as it is called, ids of its objects, their ground."""

    said: str
    ids: tuple[int, ...]
    ground: shapely.Geometry


@dataclass(frozen=True)
class _Spot:
    """A place on a street: the way, and (2,) metres."""

    way: int
    xy: FloatArray


def _place_of(city: City, names: Sequence[str]) -> _Place:
    ground = ground_of(city, names, around=CLOSE, beside=CLOSE)
    if ground.is_empty:
        raise ActionFailed(f"{', '.join(names)} lies outside the site.")
    ids = np.unique(find_objects(city, names))
    return _Place(", ".join(names), tuple(ids[ids > 0].tolist()), ground)


def _middle_of(city: City) -> _Place:
    """Return the place on a street nearest to the middle of a site."""
    centre = shapely.box(*city.layout.extent).centroid
    streets = shapely.union_all(city.layout.roads.geometry.to_numpy())
    if streets.is_empty:
        raise ActionFailed("There is no street to drive on.")
    ground = shapely.get_point(shapely.shortest_line(streets, centre), 0)
    return _Place("the middle of the site", (), ground)


def _way(
    net: Drivable, look: Look, ids: UInt64Array, origin: _Place | None, goal: _Place | None
) -> tuple[Callable[[Mapping[int, int]], tuple[Trip, ...]], Trip]:
    """Return the trips by the first of the nearest streets that lead on, and the whole of one."""
    why: ActionFailed | None = None
    for start, end in _pairs(net, look, origin, goal):
        around = shapely.Point(start.xy) if origin is None else origin.ground
        trips = partial(_in_a_row, net, look, ids, start, end, around)
        try:
            (first, *_) = between(net, look, ids[:1], start.xy, end.xy)
        except ActionFailed as error:
            why = why or error
            continue
        if _metres(net, first) >= SHORTEST:
            return trips, first
        why = why or ActionFailed("Both ends of the way lie at one place of a street.")
    assert why is not None
    raise why


def _metres(net: Drivable, trip: Trip) -> float:
    """Return how long the way of a trip is."""
    known = {way.name: way.length for way in net.streets.ways}
    last = known[trip.route[-1]]
    unused = (trip.at or 0.0) + last - (last if trip.until is None else trip.until)
    return sum(known[name] for name in trip.route) - unused


def _in_a_row(
    net: Drivable, look: Look, ids: UInt64Array, start: _Spot, end: _Spot,
    around: shapely.Geometry, tried: Mapping[int, int] = UNTRIED,
) -> tuple[Trip, ...]:  # fmt: skip
    """Return trips: as many as have room by the place set out at once, one before the other.

    Nobody begins farther than `REACH` from there, nor beyond half of the way.
    """
    trips = between(net, look, ids, start.xy, end.xy, tried)
    first, long = trips[0], look.size[0]
    named = {way.name: way for way in net.streets.ways}
    ways = [named[name] for name in first.route]
    half = _metres(net, first) / 2
    behind = -(first.at or 0.0)  # metres of the way before the street
    rows: list[Trip] = []
    way, at = 0, max(first.at or 0.0, long)
    for trip in trips:
        while way < len(ways) - 1 and at > ways[way].length - AIR:
            behind, way, at = behind + ways[way].length, way + 1, long  # the next has room
        line = shapely.LineString(ways[way].lanes[-1].shape[:, :2])
        here = shapely.line_interpolate_point(line, at)
        room = at <= ways[way].length - AIR and behind + at <= half
        if not room or shapely.distance(here, around) > REACH or tried.get(int(trip.name, 16)):
            rows.append(trip)  # sets out later
            continue
        rows.append(replace(trip, route=first.route[way:], at=at, depart=0.0))
        at += long + APART
    return tuple(rows)


def _pairs(
    net: Drivable, look: Look, origin: _Place | None, goal: _Place | None
) -> Iterator[tuple[_Spot, _Spot]]:
    """Yield places on streets where a way may begin and end, the best first."""
    if origin is not None and goal is not None:
        goals = _near(net, goal)
        yield from ((one, other) for one in _near(net, origin) for other in goals)
    elif origin is not None:
        yield from ((one, _far(net, look, one, origin, back=False)) for one in _near(net, origin))
    elif goal is not None:
        yield from ((_far(net, look, one, goal, back=True), one) for one in _near(net, goal))


def _near(net: Drivable, place: _Place) -> list[_Spot]:
    """Return places on the nearest streets next to a place; the middle of those that it names.

    Raises
    ------
    ActionFailed
        If none is near; says how far away the nearest is.
    """
    rows, lines = net.lines
    off = np.round(shapely.distance(lines, place.ground), 3) if len(rows) else np.array([np.inf])
    if off.min() > REACH:
        near = f" The nearest lies {off.min():.0f} m away." if len(rows) else ""
        raise ActionFailed(f"No street for cars lies within {REACH:g} m of {place.said}.{near}")
    network, roads = net.city.network, net.city.layout.roads
    assert network is not None
    edges = [net.streets.ways[row].edge for row in rows.tolist()]
    own = np.isin(roads["id"].to_numpy(np.uint64)[network.edge_road[edges]],
                  np.array(place.ids, np.uint64))  # fmt: skip
    order = np.lexsort((off, ~own))
    found = []
    for row in order[off[order] <= REACH][:TRIED].tolist():
        spot = shapely.line_interpolate_point(lines[row], 0.5, normalized=True)
        if not own[row]:
            spot = shapely.get_point(shapely.shortest_line(lines[row], place.ground), 0)
        found.append(_Spot(int(rows[row]), shapely.get_coordinates(spot)[0]))
    return found


def _far(net: Drivable, look: Look, near: _Spot, place: _Place, *, back: bool) -> _Spot:
    """Return the place farthest from another to which a way leads, or from which (`back`)."""
    from scipy.sparse.csgraph import dijkstra

    rows, lines = net.lines
    share = 1.0 - AT_THE_END if back else AT_THE_END
    ends = shapely.line_interpolate_point(lines, share, normalized=True)
    away = np.round(shapely.distance(ends, place.ground), 3)
    reached = np.zeros(len(rows), bool)
    for large in (True, False) if look.kind in LARGE else (False,):
        ways = net.matrix(0, large=large)
        seconds = dijkstra(ways.T if back else ways, indices=near.way)
        reached = np.isfinite(seconds[rows])
        if (reached & (rows != near.way)).any():
            break
    row = int(np.argmax(np.where(reached, away, -1.0)))
    return _Spot(int(rows[row]), shapely.get_coordinates(ends[row])[0])
