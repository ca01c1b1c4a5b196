"""Crowds in a city: refuse those that do not fit, simulate the others, keep their tracks."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.assets.vehicles.movers import person_look, size_of
from cityx.city import City
from cityx.city.moments import moments_of
from cityx.city.tracks import GAIT, MOVER, Tracks, join_tracks, no_tracks
from cityx.errors import ActionFailed
from cityx.geometry.arrays import FloatArray, IntArray
from cityx.geometry.polylines import Polylines, to_linestrings
from cityx.ground.walking.walkable import Walkable, walkable_of
from cityx.ids import hash_ids
from cityx.motion.crowd import SQUEEZED
from cityx.motion.feasible import ground_height
from cityx.motion.kinds_of_people import gaits_of
from cityx.motion.people_gates import Gates, gates_of
from cityx.motion.people_trips import Trips
from cityx.motion.people_walk import STEP, walked
from cityx.places.profiles import keeps_left

LOOK = 0.25  # seconds between the moments at which it is looked who is in a vehicle's way
NEAR = 0.2  # metres from a vehicle, half the depth of a body
STOREY = 2.0  # metres of height apart from which nobody meets
CROWDED = 0.3  # people per free square metre up to which a crowd still walks (Fruin, level D)
UInt64Array = NDArray[np.uint64]

LOOKS = 48  # different people in one city; each is a mesh
SLACK = 0.01  # metres that a sample may lie off the line between its neighbours to be left out
STILL, RUNNING = 0.12, 2.1  # metres per second: below one stands, above one runs
SMOOTH = 5  # samples to each side over which direction and speed are evened out
EVERY = 3  # samples from one height of the ground that is looked up to the next, some 0.4 m
TIME_SCALE = 1e4  # metres per second in which time is drawn, so that only offsets count
TURN_SLACK = 0.05  # radians that a heading may be off


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
    """Simulate pedestrians among what moves already, and add their tracks to the city.

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
    """Return who comes too near to movers that do not give way.

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


def look_of(person: UInt64Array, seed: int) -> NDArray[np.str_]:
    """Return (n,) looks of people, as of `cityx.assets.vehicles.movers`."""
    number = (hash_ids(seed, "people/look", person) % np.uint64(LOOKS)).astype(int)
    return np.array([person_look(value) for value in number.tolist()] or [""])[: len(number)]


def dressed(city: City, ids: UInt64Array, looks: NDArray[np.str_]) -> City:
    """Give people, by (n,) ids ascending, (n,) looks and the gaits of those with gear."""
    tracks = city.tracks
    if tracks is None:
        return city
    row = np.minimum(np.searchsorted(ids, tracks.object_id), len(ids) - 1)
    own = ids[row] == tracks.object_id
    look = np.where(own, looks[row], tracks.look)
    size = np.where(own[:, None], sizes_of(look), tracks.size).astype(np.float32)
    gait = np.where(own[tracks.mover], gaits_of(look[tracks.mover], tracks.gait), tracks.gait)
    return replace(city, tracks=replace(tracks, look=look, size=size, gait=gait.astype(np.uint8)))


def sizes_of(look: NDArray[np.str_]) -> NDArray[np.float32]:
    """(n, 3) metres: depth, width and height of people, from their looks."""
    words, row = np.unique(look, return_inverse=True)
    table = np.array([size_of(word) for word in words.tolist()]).reshape(-1, 3)
    return np.asarray(table[row], np.float32)


def tracks_of_people(
    city: City,
    origin: str,
    ids: UInt64Array,
    walker: IntArray,
    time: FloatArray,
    position: FloatArray,
) -> Tracks:
    """Make tracks of where people were at even steps of time.

    Parameters
    ----------
    city
        Whose ground they are on.
    origin
        The action that puts them there.
    ids
        (n,) of the people.
    walker
        (s,) row into `ids` of each sample, ascending; those with fewer than two samples are left
        out.
    time
        (s,) seconds, ascending within a walker.
    position
        (s, 2) metres.
    """
    count = np.bincount(walker, minlength=len(ids))
    kept = count[walker] >= 2
    # Rounded before the ground is looked up: it may lie higher a hair's breadth beside.
    walker, time, position = walker[kept], time[kept], np.round(position[kept], 4)
    rows, walker = np.unique(walker, return_inverse=True)
    start = np.searchsorted(walker, np.arange(len(rows) + 1)).astype(np.int64)
    speed, heading = _motion(start, time, position)
    place = np.column_stack([position, _heights(city, start, time, position, heading)])
    kept = _telling(start, time, place, heading)
    size = np.add.reduceat(kept, start[:-1]) if len(rows) else np.zeros(0, np.int64)
    gait = np.where(speed > RUNNING, GAIT["run"], GAIT["walk"])
    gait = np.where(speed < STILL, GAIT["still"], gait)
    look = look_of(ids[rows], city.seed)
    found = Tracks(
        ids[rows], np.full(len(rows), MOVER["pedestrian"], np.uint8), look,
        np.full(len(rows), origin), np.ones((len(rows), 3), np.float32), sizes_of(look),
        np.concatenate([[0], np.cumsum(size)]).astype(np.int64), time[kept],
        place[kept], np.round(heading[kept], 4), speed[kept].astype(np.float32),
        gait[kept].astype(np.uint8), np.zeros(int(kept.sum()), np.uint64),
    )  # fmt: skip
    return found.take(np.argsort(found.object_id))


def _heights(
    city: City, start: IntArray, time: FloatArray, position: FloatArray, heading: FloatArray
) -> FloatArray:
    """(s,) heights of the ground, looked up at some samples, and at all where they differ."""
    count = len(time)
    look = _telling(start, time, position, heading)
    look |= np.arange(count) % EVERY == 0
    place = np.arange(count)
    # First and last of each walker are looked up, so that nothing is interpolated between two.
    known = place[look]
    height = ground_height(city, position[look])
    low = np.searchsorted(known, place, side="right") - 1
    high = np.minimum(low + (known[low] < place), len(known) - 1) if count else low
    step = np.abs(height[high] - height[low]) > SLACK
    more = np.flatnonzero(step & ~look)
    found = np.interp(place, known, height)
    found[more] = ground_height(city, position[more])
    return np.round(found, 4)


def _motion(
    start: IntArray, time: FloatArray, position: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """(s,) speeds and headings, evened out over half a second to each side."""
    if not len(time):
        return np.zeros(0), np.zeros(0)
    owner = np.repeat(np.arange(len(start) - 1), np.diff(start))
    number = np.arange(len(time))
    low = np.maximum(number - SMOOTH, start[owner])
    high = np.minimum(number + SMOOTH, start[owner + 1] - 1)
    step = (position[high] - position[low]) / np.maximum(time[high] - time[low], 1e-9)[:, None]
    speed = np.hypot(*step.T)
    # Who stands keeps facing where the last steps led; who never walks faces where they began.
    moves = speed >= STILL
    moves[start[:-1]] = True
    last = np.maximum.accumulate(np.where(moves, number, 0))
    angle = np.arctan2(step[:, 1], step[:, 0])[last]
    return speed, np.asarray(angle)


def _telling(
    start: IntArray, time: FloatArray, place: FloatArray, heading: FloatArray
) -> NDArray[np.bool_]:
    """(s,) samples that are not what lies halfway between their neighbours anyway."""
    kept = np.zeros(len(time), bool)
    if not len(time):
        return kept
    kept[start[:-1]] = kept[start[1:] - 1] = True
    owner = np.repeat(np.arange(len(start) - 1), np.diff(start))
    # Walkers follow each other on one axis of time, so that a sample is known by where it lies.
    begin = np.concatenate([[0.0], np.cumsum(time[start[1:] - 1] - time[start[:-1]] + 1.0)])[:-1]
    axis = (time - time[start[:-1]][owner] + begin[owner]) * TIME_SCALE
    smooth = np.unwrap(heading) * SLACK / TURN_SLACK
    for column in (*place.T, smooth):
        lines = to_linestrings(Polylines(np.column_stack([axis, column]), start))
        thin = shapely.get_coordinates(shapely.simplify(lines, SLACK, preserve_topology=False))
        kept[np.searchsorted(axis, thin[:, 0] - 0.01)] = True
    return kept
