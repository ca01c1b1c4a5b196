"""Crowds put into a city: refused where they do not fit, walked, and kept as tracks."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.city import City
from cityx.city.moments import moments_of
from cityx.city.tracks import MOVER, Tracks, join_tracks, no_tracks
from cityx.errors import ActionFailed
from cityx.ground.walking.walkable import Walkable, walkable_of
from cityx.motion.crowd import SQUEEZED
from cityx.motion.people_gates import Gates, gates_of
from cityx.motion.people_tracks import tracks_of_people
from cityx.motion.people_trips import Trips
from cityx.motion.people_walk import STEP, walked
from cityx.places.profiles import keeps_left

FloatArray = NDArray[np.float64]

LOOK = 0.25  # seconds between the moments at which it is looked who is in a vehicle's way
NEAR = 0.2  # metres from a vehicle, half the depth of a body
STOREY = 2.0  # metres of height apart from which nobody meets
CROWDED = 0.3  # people per free square metre up to which a crowd still walks (Fruin, level D)


def area_of(city: City) -> Walkable:
    """Return the walkable area of a city.

    Raises
    ------
    ActionFailed
        If nobody can walk in it.
    """
    try:
        walkable = walkable_of(city)
    except ValueError as error:
        raise ActionFailed(f"Nobody can walk here: {error}.") from error
    if not walkable.free.any():
        raise ActionFailed(
            "Nobody can walk here: there is no sidewalk, path, plaza or land beside a street."
        )
    return walkable


def check_room(walkable: Walkable, count: int) -> None:
    """Refuse more people than can still walk.

    Raises
    ------
    ActionFailed
        With how many fit.
    """
    most = int(CROWDED * walkable.room)
    if count > most:
        raise ActionFailed(
            f"{count:,} people do not fit: of {walkable.area:,.0f} m2 of sidewalks, paths and "
            f"plazas {walkable.room:,.0f} m2 are free, on which {most:,} can walk. "
            f"Ask for {most:,} at most."
        )


def among(city: City, walkable: Walkable, duration: float, held: Tracks) -> tuple[Walkable, Gates]:
    """Find when people may cross among what moves already.

    Parameters
    ----------
    city, walkable
        The city and where one walks in it.
    duration
        Seconds.
    held
        Tracks that stay; none of them gives way.

    Returns
    -------
    walkable, gates
        The area, which now tells how long one waits before each crosswalk, and when one may cross.
    """
    gates = gates_of(held, city.signals, walkable, duration)
    return replace(walkable, waits=gates.waits), gates


def with_crowd(
    city: City, walkable: Walkable, gates: Gates, trips: Trips, duration: float, origin: str,
    held: Tracks,
) -> City:  # fmt: skip
    """Let people walk among what moves already, and put their tracks into the city.

    Parameters
    ----------
    city
        The city.
    walkable, gates
        Of `among`.
    trips
        Where they walk.
    duration
        Seconds.
    origin
        Id of the action.
    held
        Tracks that stay; none of them gives way.
    """
    side = -1.0 if keeps_left(city.frame) else 1.0
    walkers = held.take(held.kind == MOVER["pedestrian"])
    others = _PlacesOf(walkers, duration)
    steps = walked(trips, walkable, gates, others, duration, side)
    made = tracks_of_people(city, origin, trips.id, steps.trip, steps.time, steps.position)
    for standing, every in ((walkers, STEP), (held.take(~held.on_foot), LOOK)):
        made = made.take(~met(made, standing, every))
    joined = join_tracks([held, made])
    notes = city.notes
    if steps.lost:
        notes += (f"pedestrians: {steps.lost} people could not go on for a minute and were taken "
                  "out",)  # fmt: skip
    return replace(city, tracks=joined if joined.count else None, notes=notes,
                   stages_done=city.stages_done | {"dynamic"})  # fmt: skip


def without_people(city: City, origin: str | None = None) -> Tracks:
    """Return the tracks of a city less those of people, all or of one action."""
    held = city.tracks if city.tracks is not None else no_tracks()
    gone = held.kind == MOVER["pedestrian"]
    return held.take(~(gone if origin is None else gone & (held.origin == origin)))


def met(made: Tracks, others: Tracks, every: float) -> NDArray[np.bool_]:
    """Tell who comes too near to those who do not give way.

    People are in a vehicle's way where it sweeps over a walk, as on tight corners.

    Parameters
    ----------
    made
        Tracks of n people.
    others
        Tracks of those who do not give way.
    every
        Seconds between the moments that are looked at.

    Returns
    -------
    met
        (n,) bool.
    """
    found = np.zeros(made.count, bool)
    if not others.count or not made.count:
        return found
    times = np.arange(0.0, others.duration + every, every)
    people, theirs = moments_of(made, times), moments_of(others, times)
    on_foot = others.on_foot[theirs.mover]
    shapes = theirs.boxes(others.size)
    shapes[on_foot] = shapely.points(theirs.position[on_foot, :2])
    reach = np.where(on_foot, SQUEEZED, NEAR)
    pairs = zip(people.by_time(len(times)), theirs.by_time(len(times)), strict=True)
    for mine, yours in pairs:
        tree = shapely.STRtree(shapely.points(people.position[mine, :2]))
        other, one = tree.query(shapes[yours], predicate="dwithin", distance=reach[yours])
        apart = np.abs(people.position[mine[one], 2] - theirs.position[yours[other], 2])
        found[people.mover[mine[one[apart < STOREY]]]] = True
    return found


class _PlacesOf:
    """From a time to the places of people who walk on tracks."""

    def __init__(self, walkers: Tracks, duration: float) -> None:
        count = round(duration / STEP) + 1
        found = moments_of(walkers, np.arange(count) * STEP)
        self.places = [found.position[rows, :2] for rows in found.by_time(count)]

    def __call__(self, now: float) -> FloatArray:
        return self.places[min(round(now / STEP), len(self.places) - 1)]
