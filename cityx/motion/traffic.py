"""Traffic: vehicles that keep the streets as full as asked, driven by SUMO."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from types import MappingProxyType
from typing import Annotated, Literal

import numpy as np

from cityx.city import City
from cityx.city.tracks import MOVER, Tracks, join_tracks, no_tracks
from cityx.motion.vehicles import driven_streets, looks_of_kinds, movers_of
from cityx.places.profiles import profile_of
from cityx.protocol import Port, Range, action, has_network
from cityx.road.network.lane_graph import lanes
from cityx.traffic.demand import PER_KM, demand_of, per_km_at
from cityx.traffic.kinds import DRIVING
from cityx.traffic.laying import MOST_LINKS
from cityx.traffic.session import driven
from cityx.traffic.simulation import WARM, Outcome, Run
from cityx.traffic.streets import Streets

ACTION = "dynamic/traffic-v1"
MIXED = ("van", "truck", "bus", "motorcycle", "bicycle")  # kinds of which a share can be asked


def with_tracks(city: City, kept: Tracks, new: Tracks) -> City:
    """Put new tracks into a city beside those that are kept."""
    joined = join_tracks([kept, new])
    return replace(city, tracks=joined if joined.count else None,
                   stages_done=city.stages_done | {"dynamic"})  # fmt: skip


def told(outcome: Outcome, streets: Streets) -> tuple[str, ...]:
    """Return what a reader of the report should know of a run."""
    found = []
    if streets.undriven:
        found.append(f"traffic: {streets.undriven} turns of junctions with more than {MOST_LINKS} "
                     "are not driven")  # fmt: skip
    if outcome.teleported:
        found.append(f"traffic: {len(outcome.teleported)} vehicles could not go on for two minutes "
                     "and were taken out")  # fmt: skip
    if outcome.halted:
        found.append(f"traffic: {len(outcome.halted)} vehicles stood for a minute at the end")
    return tuple(found)


def held_tracks(city: City) -> Tracks:
    """Return what moves in a city."""
    return city.tracks if city.tracks is not None else no_tracks()


@action(
    ACTION,
    limits=[
        "A lane for both directions on which two cars cannot pass is driven in one direction.",
        "Nobody turns on the spot: trips that enter a dead end stay there.",
    ],
    requires=("layout", has_network()),
    takes=(Port("lanes", "line", role="lane_graph", optional=True),),
    gives=(Port("traffic", "line", role="vehicle_tracks"),),
    labels=("traffic", "vehicles", "cars", "SUMO"),
    serves=("traffic", *(f"{kind}.share" for kind in MIXED)),
    binds={
        "density": "traffic",
        **{f"{kind}s".replace("buss", "buses"): f"{kind}.share" for kind in MIXED},
    },
    needs=("libsumo",),
)
def traffic(
    city: City,
    *,
    density: Literal["usual", "none", "light", "medium", "heavy"] = "usual",
    per_km: Annotated[float | None, Range(0.0, 60.0)] = None,
    duration: Annotated[float, Range(1.0, 3600.0)] = 60.0,
    hour: Annotated[float | None, Range(0.0, 24.0)] = None,
    vans: Annotated[float | None, Range(0.0, 1.0)] = None,
    trucks: Annotated[float | None, Range(0.0, 1.0)] = None,
    buses: Annotated[float | None, Range(0.0, 1.0)] = None,
    motorcycles: Annotated[float | None, Range(0.0, 1.0)] = None,
    bicycles: Annotated[float | None, Range(0.0, 1.0)] = None,
) -> City:
    """Let vehicles drive in the streets by their rules; earlier traffic of this action is replaced.

    Parameters
    ----------
    city
        City with a road network and lanes.
    density
        How full the streets are; "usual" is what the hour brings, "none" takes every moving
        vehicle away.
    per_km
        Vehicles per kilometre of all streets together, which goes before `density`; main roads get
        more and side streets fewer.
    duration
        Seconds of the tracks.
    hour
        Of the day, which decides where trips begin and end; None for that of the city's light.
    vans, trucks, buses, motorcycles, bicycles
        Share of them among the vehicles; usual for the place when left out.
    """
    held = held_tracks(city)
    if per_km is None and density == "none":
        vehicles = np.isin(held.kind, [MOVER[kind] for kind in DRIVING])
        return with_tracks(city, held.take(~vehicles), no_tracks())
    kept = held.take(held.origin != ACTION)
    if per_km == 0.0:
        return with_tracks(city, kept, no_tracks())
    city = city if city.lanes is not None else lanes(city)
    streets = driven_streets(city)
    asked = {"van": vans, "truck": trucks, "bus": buses, "motorcycle": motorcycles,
             "bicycle": bicycles}  # fmt: skip
    mix = {kind: share for kind, share in asked.items() if share is not None}
    run = run_of(city, streets, duration, density=density, per_km=per_km, hour=hour, mix=mix)
    trips = tuple(trip for group in run.groups for trip in group.trips)
    plates = profile_of(city.frame).vehicles.plates
    movers = movers_of(trips, run.looks, city.seed, plates)
    found = driven(city, streets, run, movers, ACTION, kept)
    notes = tuple(note for note in city.notes if not note.startswith("traffic: "))
    changed = with_tracks(city, kept, found.tracks)
    return replace(changed, signals=found.signals, notes=(*notes, *told(found.outcome, streets)))


def run_of(
    city: City, streets: Streets, duration: float, *, density: str = "usual",
    per_km: float | None = None, hour: float | None = None,
    mix: Mapping[str, float] = MappingProxyType({}),
) -> Run:  # fmt: skip
    """Return a run that keeps the streets of a city as full as asked.

    Parameters
    ----------
    city, streets
        The city and its streets.
    duration
        Seconds for which there are vehicles to be sent.
    density, per_km, hour
        As of `traffic`.
    mix
        Shares of kinds of vehicles; usual for the place where they are not named.
    """
    profile = profile_of(city.frame)
    hour = city.environment.hour if hour is None else hour
    demand = demand_of(
        city, streets, looks_of_kinds(profile.vehicles), hour=hour, seconds=WARM + duration,
        purpose=ACTION, per_km=_per_km(city, density, per_km, hour),
        cyclists=profile.streets.cyclists, mix=mix,
    )  # fmt: skip
    return Run(demand.looks, demand.groups, barred=demand.barred, tight=demand.tight,
               duration=duration, seed=city.seed)  # fmt: skip


def _per_km(city: City, density: str, per_km: float | None, hour: float) -> dict[str, float]:
    """Return vehicles per kilometre of each class of road."""
    if per_km is None:
        return per_km_at(density, hour)
    usual = per_km_at("medium", hour)
    roads = city.layout.roads
    kinds = roads["kind"].str.replace("_link", "", regex=False)
    lengths = roads.geometry.length.groupby(kinds).sum()
    known = {road: float(length) for road, length in lengths.items() if road in PER_KM}
    mean = sum(usual[road] * length for road, length in known.items()) / max(
        sum(known.values()), 1e-9
    )
    return {road: value * per_km / max(mean, 1e-9) for road, value in usual.items()}
