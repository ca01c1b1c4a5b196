"""People as tracks: who they are, how they face and go, and where the ground is under them."""

from __future__ import annotations

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.assets.vehicles.movers import person_look, size_of
from cityx.city import City
from cityx.city.tracks import GAIT, MOVER, Tracks
from cityx.geometry.polylines import Polylines, to_linestrings
from cityx.ids import hash_ids
from cityx.motion.feasible import ground_height

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]
UInt64Array = NDArray[np.uint64]

LOOKS = 48  # different people in one city; each is a mesh
SLACK = 0.01  # metres that a sample may lie off the line between its neighbours to be left out
STILL, RUNNING = 0.12, 2.1  # metres per second: below one stands, above one runs
SMOOTH = 5  # samples to each side over which direction and speed are evened out
EVERY = 3  # samples from one height of the ground that is looked up to the next, some 0.4 m
TIME_SCALE = 1e4  # metres per second in which time is drawn, so that only offsets count
TURN_SLACK = 0.05  # radians that a heading may be off


def look_of(person: UInt64Array, seed: int) -> NDArray[np.str_]:
    """Return (n,) looks of people, as of `cityx.assets.vehicles.movers`."""
    number = (hash_ids(seed, "people/look", person) % np.uint64(LOOKS)).astype(int)
    return np.array([person_look(value) for value in number.tolist()] or [""])[: len(number)]


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
