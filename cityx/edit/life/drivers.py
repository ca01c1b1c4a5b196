"""Drivers: vehicles that go to a place, leave it, or go from one to another by the streets."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from functools import partial
from typing import Annotated, Any, Literal

import numpy as np
import shapely

from cityx.assets.vehicles.movers import SPECIAL
from cityx.city import City
from cityx.city.tracks import Tracks
from cityx.edit.life.places import ground_of
from cityx.errors import ActionFailed
from cityx.geometry.arrays import FloatArray
from cityx.motion.traffic import held_tracks
from cityx.motion.vehicle_flow import Driven, with_vehicles
from cityx.protocol import ObjectName, Port, Range, Serves, action, has_network
from cityx.road.network.lane_graph import lanes
from cityx.traffic.demand import Drivable
from cityx.traffic.flows import AIR, HEADWAY, REACH, UNTRIED, between, flow_ids
from cityx.traffic.kinds import DRIVING
from cityx.traffic.simulation import Look, Trip

ACTION = "dynamic/drivers-v1"
TRIED = 6  # streets by a place of which one leads on, at most
FAR = 40  # streets far away of which one leads there, at most
APART = 8.0  # metres between those who set out together
AT_THE_END = 0.9  # share of a street behind those who set out, in a row
CLOSE = 0.1  # metres from objects to their ground
PACE = 5.0  # metres per second on the way, with stops at junctions
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

    The same call once more replaces what it made; any other is added to it.

    Parameters
    ----------
    city
        City with a road network and lanes.
    kind
        Of vehicle.
    origin, goal
        Buildings, squares, streets and other objects that they leave, one after the other, and
        that they go to; where one is left out, the farthest street from which, or to which, a way
        leads.
    count
        How many.
    speed
        Metres per second that they keep where they can, None for what is allowed.
    duration
        Seconds of the tracks, at least; more where the way takes longer, up to five minutes.

    Raises
    ------
    ActionFailed
        If no street is near, or no way leads from the one to the other.
    """
    if not origin and not goal:
        raise ActionFailed("Say where the vehicles come from, or where they go.")
    if origin and goal and set(origin) == set(goal):
        raise ActionFailed("The vehicles would arrive where they set out; name two places.")
    city = city if city.lanes is not None else lanes(city)
    grounds = [ground_of(city, names, around=CLOSE) if names else None for names in (origin, goal)]
    ids = flow_ids(city.seed, f"{ACTION}/{kind}/{origin}/{goal}/{speed}", count)
    seconds = max(duration, held_tracks(city).duration)

    def plan(net: Drivable, look: Look, _: Tracks) -> Driven:
        trips, length = _way(net, look, ids, grounds)
        takes = length / min(speed or PACE, PACE) + HEADWAY * count
        return Driven(look, trips, max(seconds, min(takes, LONGEST)))

    return with_vehicles(city, plan, ids, action=ACTION, kind=kind, speed=speed)


def _way(
    net: Drivable, look: Look, ids: Any, grounds: list[Any]
) -> tuple[Callable[[Mapping[int, int]], tuple[Trip, ...]], float]:
    """Return the trips by the first of the nearest streets that lead on, and their metres."""
    why: ActionFailed | None = None
    for start, goal in _pairs(net, grounds):
        trips = partial(_in_a_row, net, look, ids, start, goal)
        try:
            (first, *_) = trips({})
        except ActionFailed as error:
            why = why or error
            continue
        named = {way.name: way.length for way in net.streets.ways}
        unused = (first.at or 0.0) + named[first.route[-1]] - (first.until or 0.0)
        length = sum(named[name] for name in first.route) - unused
        if length >= SHORTEST:
            return trips, length
        why = why or ActionFailed("Both ends of the way lie at one place of a street.")
    raise why or ActionFailed(f"No street for cars lies within {REACH:g} m of it.")


def _in_a_row(
    net: Drivable, look: Look, ids: Any, start: FloatArray, goal: FloatArray,
    tried: Mapping[int, int] = UNTRIED,
) -> tuple[Trip, ...]:  # fmt: skip
    """Return trips of which all that have room on the way set out at once, one before the other."""
    trips = between(net, look, ids, start, goal, tried)
    first, long = trips[0], look.size[0]
    known = {way.name: way.length for way in net.streets.ways}
    lengths = np.array([known[name] for name in first.route])
    ends = lengths.copy()
    ends[-1] = lengths[-1] if first.until is None else first.until
    rows: list[Trip] = []
    way, at = 0, max(first.at or 0.0, long)
    for trip in trips:
        while way < len(ends) - 1 and at > ends[way] - AIR:
            way, at = way + 1, long  # the next street has room
        if at > ends[way] - AIR:
            rows.append(trip)  # sets out later
            continue
        rows.append(replace(trip, route=first.route[way:], at=at, depart=0.0))
        at += long + APART
    return tuple(rows)


def _pairs(net: Drivable, grounds: list[Any]) -> Iterator[tuple[FloatArray, FloatArray]]:
    """Yield places on streets where a way may begin and end, the best first."""
    origin, goal = grounds
    if origin is None:
        yield from ((far, near) for near in _near(net, goal) for far in _far(net, goal))
    elif goal is None:
        yield from ((near, far) for near in _near(net, origin) for far in _far(net, origin))
    else:
        yield from ((one, other) for one in _near(net, origin) for other in _near(net, goal))


def _lines(net: Drivable) -> Any:
    """(n,) lines of the ways that cars drive along."""
    rows = np.flatnonzero(net.usable).tolist()
    return np.array(
        [shapely.LineString(net.streets.ways[row].lanes[-1].shape[:, :2]) for row in rows], object
    )


def _near(net: Drivable, ground: Any) -> list[FloatArray]:
    """Return the places on the nearest streets, next to some ground."""
    lines = _lines(net)
    off = np.round(shapely.distance(lines, ground), 3) if len(lines) else np.zeros(0)
    order = np.argsort(off, kind="stable")
    near = order[off[order] <= REACH][:TRIED]
    return [
        shapely.get_coordinates(shapely.shortest_line(lines[row], ground))[0]
        for row in near.tolist()
    ]


def _far(net: Drivable, ground: Any) -> list[FloatArray]:
    """Return places on the streets that lie farthest from some ground."""
    lines = _lines(net)
    off = np.round(shapely.distance(lines, ground), 3)
    order = np.argsort(-off, kind="stable")[:FAR]
    ends = shapely.line_interpolate_point(lines[order], AT_THE_END, normalized=True)
    return list(shapely.get_coordinates(ends))
