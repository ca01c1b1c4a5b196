"""Pedestrians: people who are about in a city, from doors, stops and its borders to others."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from types import MappingProxyType
from typing import Annotated, Literal

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.city import City
from cityx.errors import ActionFailed
from cityx.geometry.arrays import FloatArray
from cityx.ground.walking.crosswalks import PATHS
from cityx.ids import hash_ids
from cityx.motion.crowds import (
    LOOKS,
    among,
    area_of,
    check_room,
    dressed,
    with_crowd,
    without_people,
)
from cityx.motion.kinds_of_people import RUNNER, SHARED, WEARS, looks_of_kinds, parts_of
from cityx.motion.people_trips import Trips, activity, drawn_trips, ports_of, running_paces
from cityx.protocol import Choice, Port, Range, Serves, action, has_ground, has_network

ACTION = "dynamic/pedestrians-v1"
# People per kilometre of street; the goal "heavy" of `cityx.checks.predicates.words` asks for 15 on
# sidewalks alone, and who crosses or is on a plaza counts for none of them.
PER_KM: Mapping[str, float] = MappingProxyType({"light": 3.5, "medium": 12.0, "heavy": 45.0})
NOON = 12.5  # hour at which the usual number is the medium one
RAILWAYS = ("rail", "tram", "subway", "light_rail", "narrow_gauge")


@action(
    ACTION,
    limits=[
        "People give way to vehicles and to others that move already; those do not give way.",
        "They walk on the ground, not on bridges nor in tunnels.",
    ],
    requires=("layout", has_network(), has_ground()),
    takes=(
        Port("doors", "point", role="door", optional=True),
        Port("traffic", "line", role="vehicle_tracks", optional=True),  # people wait for it
    ),
    gives=(Port("pedestrians", "line", role="pedestrian_tracks"),),
    labels=("pedestrians", "people", "crowd", "walkers", "sidewalk", "busy"),
    serves=(
        Serves("pedestrians"),
        Serves("pedestrian.count", "!pedestrians"),
        *(Serves(f"{kind}.share", "!pedestrians", "!pedestrian.count") for kind in SHARED),
    ),
    binds={
        "density": "pedestrians",
        "count": "pedestrian.count",
        "speed": "pedestrian.speed",
        "wears": "pedestrian.wears",
        "children": "child.share",
        "elders": "elder.share",
        "wheelchairs": "wheelchair.share",
        "prams": "pram.share",
        "runners": "runner.share",
    },
)
def pedestrians(
    city: City,
    *,
    density: Literal["usual", "none", "light", "medium", "heavy"] = "usual",
    count: Annotated[int | None, Range(0, 1_000_000_000)] = None,
    duration: Annotated[float, Range(1.0, 3600.0)] = 60.0,
    hour: Annotated[float | None, Range(0.0, 24.0)] = None,
    speed: Annotated[float | None, Range(0.3, 6.0)] = None,
    wears: Annotated[str | None, Choice(*WEARS)] = None,
    children: Annotated[float | None, Range(0.0, 1.0)] = None,
    elders: Annotated[float | None, Range(0.0, 1.0)] = None,
    wheelchairs: Annotated[float | None, Range(0.0, 1.0)] = None,
    prams: Annotated[float | None, Range(0.0, 1.0)] = None,
    runners: Annotated[float | None, Range(0.0, 1.0)] = None,
) -> City:
    """Let people walk on sidewalks, crosswalks, paths and plazas; earlier ones are replaced.

    Parameters
    ----------
    city
        City with its ground.
    density
        How busy the sidewalks are; "usual" is what the hour brings, "none" takes out everybody on
        foot, whatever put them there.
    count
        People at a time, which goes before `density`.
    duration
        Seconds of the tracks.
    hour
        Of the day, which decides where people come from and go to; None for that of the city's
        light.
    speed
        Metres per second of all of them; each has an own when left out.
    wears
        What all of them have on, such as jackets in warning colours; their own clothes when left
        out.
    children, elders, wheelchairs, prams, runners
        Share of them among the people; as usual when left out.
    """
    asked = dict(zip(SHARED, (children, elders, wheelchairs, prams, runners), strict=True))
    shares = {kind: share for kind, share in asked.items() if share is not None}
    if sum(shares.values()) > 1.0 + 1e-9:
        raise ActionFailed(
            f"The parts of the people add up to {sum(shares.values()):.0%}: "
            f"{', '.join(f'{kind} {share:.0%}' for kind, share in shares.items())}. "
            "Together they can be 100 % at most."
        )
    hour = city.environment.hour if hour is None else hour
    held = without_people(city, None if density == "none" and count is None else ACTION)
    wanted = _count(city, density, hour) if count is None else count
    city = replace(city, notes=tuple(n for n in city.notes if not n.startswith("pedestrians: ")))
    if not wanted:
        return replace(city, tracks=held if held.count else None,
                       stages_done=city.stages_done | {"dynamic"})  # fmt: skip
    walkable = area_of(city)
    check_room(walkable, wanted)
    walkable, gates = among(city, walkable, duration, held)
    ports = ports_of(city, walkable, hour)
    trips = drawn_trips(city, walkable, ports, wanted, duration, ACTION)
    found = len(np.unique(trips.place))
    if not found:
        raise ActionFailed(
            "Nobody has anywhere to walk: no two doors, stops or borders of the site are joined by "
            "sidewalks and crosswalks."
        )
    notes = []
    if ports.lost:
        notes.append(f"pedestrians: {ports.lost} doors are too far from any sidewalk to come from")
    if found < wanted:
        notes.append(f"pedestrians: {found} of {wanted} found a way to walk")
    people = np.unique(trips.id)
    kinds = parts_of(people, shares, city.seed)
    trips = replace(trips, pace=_paces(city.seed, trips, people, kinds, speed))
    changed = with_crowd(city, walkable, gates, trips, duration, ACTION, held)
    if shares or wears:
        number = (hash_ids(city.seed, "people/look", people) % np.uint64(LOOKS)).astype(np.int64)
        looks = looks_of_kinds(number, kinds, wears=wears or "", apart=tuple(shares))
        changed = dressed(changed, people, looks)
    return replace(changed, notes=(*changed.notes, *notes))


def _paces(
    seed: int, trips: Trips, people: NDArray[np.uint64], kinds: NDArray[np.str_],
    speed: float | None,
) -> FloatArray:  # fmt: skip
    """(t,) metres per second of who makes each trip: those asked for, and of runners their own."""
    pace = trips.pace if speed is None else np.full(len(trips.id), speed)
    runs = kinds[np.searchsorted(people, trips.id)] == RUNNER
    return np.asarray(np.where(runs, running_paces(seed, ACTION, trips.id), pace))


def _count(city: City, density: str, hour: float) -> int:
    """Return how many people a word means in the streets of a city at an hour."""
    if density == "none":
        return 0
    if density == "usual":
        per_km = PER_KM["medium"] * activity("border", hour) / activity("border", NOON)
    else:
        per_km = PER_KM[density]
    roads = city.layout.roads
    streets = ~roads["kind"].isin((*PATHS, *RAILWAYS)).to_numpy()
    length = float(shapely.length(roads.geometry.to_numpy()[streets]).sum()) / 1000.0
    return max(round(per_km * length), 1)
