"""Processions: several movers behind one another on one course, as tracks."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from cityx.assets.vehicles.movers import kind_of, size_of
from cityx.city.city import City
from cityx.city.tracks import GAIT, Tracks, join_tracks, no_tracks
from cityx.ids import stable_id
from cityx.motion.courses import Course, times
from cityx.motion.evading import set_out
from cityx.motion.feasible import ground_height

FloatArray = NDArray[np.float64]


@dataclass(frozen=True)
class Cast:
    """n movers along one course.

    Attributes
    ----------
    look
        n looks.
    tint
        (n, 3) linear RGB.
    begin
        (n,) metres along the course where each is when the tracks begin.
    gait
        Of `cityx.city.tracks.GAITS`.
    origin
        Id of the action.
    name
        Of the path, for ids.
    roads
        Rows of ``Layout.roads`` of the path, () for a curve.
    evades
        Metres from one to the next of those who set out so that they meet nobody who walks already;
        0 for those who do not heed others.
    """

    look: tuple[str, ...]
    tint: FloatArray
    begin: FloatArray
    gait: str
    origin: str
    name: str
    roads: tuple[int, ...] = ()
    evades: float = 0.0


def new_ids(city: City, origin: str, name: str, count: int) -> list[int]:
    """Return ids for movers on a path, none of which the city has."""
    taken = set() if city.tracks is None else set(city.tracks.object_id.tolist())
    found: list[int] = []
    number = 0
    while len(found) < count:
        candidate = stable_id(origin, name, number)
        if candidate not in taken:
            found.append(candidate)
        number += 1
    return found


def procession(
    city: City, way: Course, speed: FloatArray, cast: Cast, seconds: float
) -> tuple[City, tuple[int, ...]]:
    """Move along a course; a mover at the end of an open one leaves the city.

    Parameters
    ----------
    city
        The city.
    way
        The course.
    speed
        (k,) metres per second at its points.
    cast
        Who goes.
    seconds
        How long the tracks are on a closed course.

    Returns
    -------
    city, ids
        The city with the tracks, and the ids of the movers in the order of the cast.
    """
    height = ground_height(city, way.points, cast.roads)
    moments = times(way, speed) if speed.any() else way.along
    begin, notes = cast.begin, city.notes
    if cast.evades and speed.any() and city.tracks is not None and city.tracks.on_foot.any():
        walkers = city.tracks.take(city.tracks.on_foot)
        wanted = np.interp(begin, way.along, moments)
        apart = cast.evades / float(speed.max())
        found, meeting = set_out(way, height, moments, wanted, apart, walkers, seconds)
        begin = np.interp(found, moments, way.along)
        if meeting:
            notes += (f"{meeting} of {len(begin)} on the path \"{cast.name}\" meet others, since "
                      "so many walk there that none could wait for a gap.",)  # fmt: skip
    ids = new_ids(city, cast.origin, cast.name, len(cast.look))
    made = [
        _track(way, height, speed, moments, place, seconds)
        for place in begin.tolist()
    ]  # fmt: skip
    lengths = [len(samples[0]) for samples in made]
    columns = [np.concatenate([samples[i] for samples in made]) for i in range(4)]
    total = sum(lengths)
    tracks = Tracks(
        np.array(ids, np.uint64),
        np.array([kind_of(look) for look in cast.look], np.uint8),
        np.array(cast.look),
        np.full(len(ids), cast.origin),
        cast.tint.astype(np.float32),
        np.array([size_of(look) for look in cast.look], np.float32),
        np.concatenate([[0], np.cumsum(lengths)]).astype(np.int64),
        columns[0],
        columns[1],
        columns[2],
        columns[3].astype(np.float32),
        np.full(total, GAIT[cast.gait], np.uint8),
        np.zeros(total, np.uint64),
    )
    joined = join_tracks([city.tracks or no_tracks(), tracks])
    return replace(city, tracks=joined, notes=notes), tuple(ids)


def _track(
    way: Course, height: FloatArray, speed: FloatArray, moments: FloatArray, begin: float,
    seconds: float,
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:  # fmt: skip
    """Return times, positions, headings and speeds of one mover, a sample per point it passes."""
    if not speed.any():
        along = np.array([begin, begin])
        time = np.array([0.0, seconds])
    else:
        start = float(np.interp(begin, way.along, moments))
        round_time = moments[-1]
        laps = int(np.ceil((start + seconds) / round_time)) if way.closed else 1
        lap = np.repeat(np.arange(laps), len(moments) - 1)
        time = np.append(np.tile(moments[:-1], laps) + lap * round_time, laps * round_time) - start
        along = np.append(np.tile(way.along[:-1], laps) + lap * way.length, laps * way.length)
        end = min(seconds, time[-1]) if way.closed else time[-1]
        kept = (time > 0) & (time < end)
        inner = np.concatenate([[0.0], time[kept], [end]])
        along, time = np.interp(inner, time, along), inner
    lap, place = np.divmod(along, way.length) if way.closed else (np.zeros(len(along)), along)
    # The last sample of a lap lies at its end, not at the beginning of the next.
    full = way.heading[-1] - way.heading[0]
    position = np.column_stack(
        [np.interp(place, way.along, column) for column in (*way.points.T, height)]
    )
    heading = np.interp(place, way.along, way.heading) + lap * full
    return time, position, heading, np.interp(place, way.along, speed)
