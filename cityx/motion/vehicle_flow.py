"""Vehicles on request: so many of a kind, along streets or from place to place."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Annotated, Literal

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.assets.vehicles.movers import SPECIAL, looks_named, size_of
from cityx.checks.movement_checks import EVERY, Scene, overlapping
from cityx.checks.predicates.words import ROAD_CLASSES
from cityx.city import City
from cityx.city.moments import moments_of
from cityx.city.tracks import Tracks, poses_at
from cityx.errors import ActionFailed, nearest
from cityx.geometry.chains import components
from cityx.motion.traffic import held_tracks, told, with_tracks
from cityx.motion.vehicles import driven_streets, movers_of
from cityx.places.profile import Vehicles
from cityx.places.profiles import profile_of
from cityx.protocol import Port, Range, Serves, Text, action, has_network
from cityx.road.markings.marks import RANK
from cityx.road.network.lane_graph import lanes
from cityx.traffic.demand import Drivable
from cityx.traffic.flows import UInt64Array, between, flow_ids
from cityx.traffic.flows import along as trips_along
from cityx.traffic.kinds import DRIVING
from cityx.traffic.session import driven
from cityx.traffic.simulation import Look, Run, Trip
from cityx.traffic.streets import Streets

ACTION = "dynamic/vehicle_flow-v1"
BRIDGES, MAIN_STREET = ("bridge", "bridges"), ("main_street", "main street", "main road")
JOINED = 1.0  # metres between pieces of one bridge
USUAL = 10  # vehicles of a flow that nobody counted
ROUNDS = 6  # runs until nothing that keeps its way comes upon the new vehicles


@action(
    ACTION,
    limits=[
        "What moves already keeps its way; the new vehicles give way to it. Where it would run "
        "into one from behind, that one gets another place and way, or sets out later.",
        "Vehicles along streets leave the site by any way out once they have passed the streets.",
    ],
    requires=("layout", has_network()),
    takes=(Port("lanes", "line", role="lane_graph", optional=True),),
    gives=(Port("vehicles", "line", role="vehicle_tracks"),),
    labels=("vehicles", "flow", "buses", "cars", "convoy"),
    serves=(
        *(
            Serves("edit=add_agent", f"agent={kind}", "!mode", "!to", "!from", kind=kind)
            for kind in (*DRIVING, *SPECIAL)
        ),
        Serves("edit=add_agent", "agent=vehicle", "!to", "!from"),
        Serves("edit=add_traffic", "path"),
        Serves("edit=add_traffic", "speed"),
    ),
    binds={"count": "count", "along": "path", "speed": "speed"},
    needs=("libsumo",),
)
def vehicle_flow(
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
    count: Annotated[int | None, Range(1, 500)] = None,
    along: Annotated[str, Text()] = "",
    start: Annotated[tuple[float, float] | None, Range(-1e5, 1e5)] = None,
    goal: Annotated[tuple[float, float] | None, Range(-1e5, 1e5)] = None,
    speed: Annotated[float | None, Range(1.0, 70.0)] = None,
    duration: Annotated[float, Range(1.0, 3600.0)] = 60.0,
) -> City:
    """Add vehicles of a kind along streets, or from one place to another.

    The same call once more replaces what it made; any other is added to it.

    Parameters
    ----------
    city
        City with a road network and lanes.
    kind
        Of vehicle.
    count
        How many; None for as many as there is room for, ten at most.
    along
        Streets they are on when the tracks begin: "bridge", "main_street", a class of road such as
        "primary", or the name of a street; "" for all streets, or for `start` and `goal`.
    start, goal
        (x, y), metres: where they set out one after the other, and where they arrive.
    speed
        Metres per second that they keep where they can, None for what is allowed.
    duration
        Seconds of the tracks.
    """
    if (start is None) != (goal is None) or (start is not None and along):
        raise ActionFailed("Give both start and goal, or the streets along which vehicles drive.")

    def plan(net: Drivable, look: Look, kept: Tracks) -> Driven:
        if start is not None and goal is not None:
            tries = partial(between, net, look, ids, np.array(start), np.array(goal))
            return Driven(keeping(look, net.streets, tries()[0].route), tries, duration)
        groups = _edges(city, along)
        look = replace(look, allowed=_allowed(net.streets, groups))
        tries = partial(trips_along, net, look, ids, groups, _bodies(kept), pace=speed,
                        said=along or "the streets", exact=count is not None)  # fmt: skip
        return Driven(look, lambda tried: tries(tried=tried), duration)

    city = city if city.lanes is not None else lanes(city)
    purpose = f"{ACTION}/{kind}/{along}/{start}/{goal}/{speed}"
    ids = flow_ids(city.seed, purpose, count or USUAL)
    return with_vehicles(city, plan, ids, action=ACTION, kind=kind, speed=speed)


@dataclass(frozen=True)
class Driven:
    """How new vehicles drive.

    Attributes
    ----------
    look
        Their type, with the speed that they keep.
    trips
        From how often each has been in the way of others, by its id, their trips.
    duration
        Seconds of the tracks.
    """

    look: Look
    trips: Callable[[Mapping[int, int]], tuple[Trip, ...]]
    duration: float


def with_vehicles(
    city: City,
    plan: Callable[[Drivable, Look, Tracks], Driven],
    ids: UInt64Array,
    *,
    action: str,
    kind: str,
    speed: float | None,
) -> City:
    """Return a city with vehicles that make trips among what moves already.

    Parameters
    ----------
    city
        City with lanes.
    plan
        From the streets, the usual look and the tracks that stay returns how they drive.
    ids
        (n,) uint64 of the vehicles; those that move already by these ids are replaced.
    action, kind, speed
        What makes them; their kind, metres per second.

    Raises
    ------
    ActionFailed
        If the trips find no street or no way.
    """
    streets = driven_streets(city)
    net = Drivable(city, streets)
    held = held_tracks(city)
    kept = held.take(~np.isin(held.object_id, ids))
    found = plan(net, _look(kind, speed, profile_of(city.frame).vehicles), kept)
    tight = tuple(number for number, link in enumerate(streets.links) if link.tight)
    run = Run((found.look,), barred=net.barred, tight=tight, duration=found.duration,
              seed=city.seed)  # fmt: skip
    return _with_trips(city, streets, run, kept, found, action)


def _with_trips(
    city: City, streets: Streets, run: Run, kept: Tracks, plan: Driven, action: str
) -> City:
    """Run trips until nobody is in the way of what keeps its own; the best run counts.

    What has been recorded does not brake for who is slow ahead of it, and no driver foresees that.
    """
    tried: dict[int, int] = {}
    best: tuple[int, City] | None = None
    for _ in range(ROUNDS):
        own = replace(run, trips=plan.trips(tried))
        plates = profile_of(city.frame).vehicles.plates
        movers = movers_of(own.trips, own.looks, city.seed, plates)
        found = driven(city, streets, own, movers, action, kept)
        changed = with_tracks(city, kept, found.tracks)
        hit = _in_the_way(changed, kept)
        if best is None or len(hit) < best[0]:
            said = [f"traffic: {len(hit)} of {len(own.trips)} new vehicles are in the way of what "
                    "moves already"] if hit else []  # fmt: skip
            said += _late(own, found.tracks)
            notes = (*city.notes, *told(found.outcome, streets), *said)
            best = len(hit), replace(changed, signals=found.signals, notes=notes)
        if not hit:
            break
        tried |= {vehicle: tried.get(vehicle, 0) + 1 for vehicle in hit}
    assert best is not None
    return best[1]


def _late(run: Run, tracks: Tracks) -> list[str]:
    """Say how many of those who go to a place are still on their way when the tracks end."""
    bound = {int(trip.name, 16) for trip in run.trips if trip.until is not None}
    ends = tracks.time[tracks.sample_start[1:] - 1]
    there = bound.intersection(tracks.object_id[ends < run.duration - run.step].tolist())
    late = len(bound) - len(there)
    return [f"traffic: {late} of {len(bound)} new vehicles have not arrived when the tracks end "
            f"after {run.duration:.0f} s"] if late else []  # fmt: skip


def keeping(look: Look, streets: Streets, route: Sequence[str]) -> Look:
    """Return a look that keeps the speed it wants on ways of some names."""
    edges = [way.edge for way in streets.ways if way.name in route]
    return replace(look, allowed=_allowed(streets, [edges]))


def _in_the_way(city: City, kept: Tracks) -> list[int]:
    """Return the ids of new vehicles which something that keeps its way runs into."""
    tracks = city.tracks
    if tracks is None or not kept.count:
        return []
    times = np.arange(0.0, tracks.duration + EVERY / 2, EVERY)
    scene = Scene(city, tracks, moments_of(tracks, times))
    pairs = scene.at.mover[overlapping(scene)]  # (k, 2) rows of the tracks
    new = ~np.isin(tracks.object_id, kept.object_id)
    met = pairs[new[pairs].sum(axis=1) == 1]
    return [int(own) for own in np.unique(tracks.object_id[met[new[met]]])]


def _look(kind: str, speed: float | None, vehicles: Vehicles) -> Look:
    name = looks_named(kind, vehicles)[0][0]
    driven = SPECIAL.get(kind, (kind, ""))[0]
    return Look(name, driven, size_of(name), speed, speed or 0.0)


def _allowed(streets: Streets, groups: list[list[int]]) -> float:
    """Greatest speed that is allowed on edges, metres per second."""
    edges = {edge for group in groups for edge in group}
    speeds = [lane.speed for way in streets.ways if way.edge in edges for lane in way.lanes]
    return max(speeds, default=0.0)


def _edges(city: City, along: str) -> list[list[int]]:
    """Return the edges of the network that words mean; those of each bridge apart.

    Raises
    ------
    ActionFailed
        If they mean none; names what there is.
    """
    network, roads = city.network, city.layout.roads
    assert network is not None
    table = roads.iloc[network.edge_road]
    kinds = table["kind"].to_numpy().astype(str)
    names = table["name"].to_numpy().astype(str)
    word = along.strip()
    if not word:
        chosen = np.ones(len(kinds), bool)
    elif word.lower() in BRIDGES:
        chosen = table["bridge"].to_numpy(bool)
    elif word.lower() in MAIN_STREET:
        best = next((rank for rank in RANK if (kinds == rank).any()), "")
        chosen = kinds == best
    elif word.lower() in ROAD_CLASSES:
        chosen = np.isin(kinds, ROAD_CLASSES[word.lower()])
    else:
        chosen = (np.char.lower(names) == word.lower()) | (table["source"].to_numpy() == word)
    rows = np.flatnonzero(chosen)
    if not len(rows):
        known = sorted({*names.tolist(), *kinds.tolist(), *BRIDGES[:1]} - {""})
        hint = nearest(word, known) or f" There are {', '.join(known[:8])}."
        raise ActionFailed(f'No street of the city is meant by "{along}".{hint}')
    return _grouped(city, rows)


def _grouped(city: City, rows: NDArray[np.int64]) -> list[list[int]]:
    """Put edges together that hang together."""
    network = city.network
    assert network is not None
    lines = np.array([shapely.LineString(network.edge_points(row)) for row in rows.tolist()])
    pairs = np.column_stack(shapely.STRtree(lines).query(lines, "dwithin", JOINED))
    label = components(pairs, len(rows))
    return [rows[label == part].tolist() for part in np.unique(label).tolist()]


def _bodies(tracks: Tracks) -> list[shapely.Geometry]:
    """Return the ground that movers stand on when the tracks begin."""
    poses = poses_at(tracks, 0.0)
    if not len(poses.row):
        return []
    ahead = np.column_stack([np.cos(poses.heading), np.sin(poses.heading)])
    left = np.column_stack([-ahead[:, 1], ahead[:, 0]])
    size = tracks.size[poses.row].astype(float) / 2
    u, v, at = ahead * size[:, :1], left * size[:, 1:2], poses.position[:, :2]
    corners = np.stack([at - u - v, at + u - v, at + u + v, at - u + v], axis=1)
    return list(shapely.polygons(corners))
