"""Processions: several movers behind one another on one course, which meets nobody on foot.

Who is where on a course at what time follows from the moment at which it passes the beginning. So
each place and time at which somebody else is on the course rules out one such moment, and those
that are left are free for all of the way. Nobody changes pace, nor leaves the path.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from cityx.assets.vehicles.movers import kind_of, size_of
from cityx.city.city import City
from cityx.city.moments import moments_of
from cityx.city.tracks import GAIT, Tracks, join_tracks, no_tracks
from cityx.geometry.arrays import BoolArray, FloatArray
from cityx.ids import stable_id
from cityx.motion.courses import Course, times
from cityx.motion.feasible import ground_height

STEP = 0.1  # seconds between the moments at which others are looked at
NEAR = 0.1  # metres between the places of the course that are looked at
REACH = 0.55, 0.45  # metres kept to the middle of others; the lesser where else nobody gets through
BIN = 0.05  # seconds between the moments of setting out that are told apart
LONGEST = 15.0  # seconds by which somebody sets out sooner or later than was meant
STOREY = 2.0  # metres of height apart from which nobody meets


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


def set_out(
    way: Course, height: FloatArray, moments: FloatArray, wanted: FloatArray, apart: float,
    others: Tracks, seconds: float,
) -> tuple[FloatArray, int]:  # fmt: skip
    """Choose when movers pass the beginning of a course, as near as can be to what is wanted.

    Parameters
    ----------
    way, height
        The course, and (k,) metres at its points.
    moments
        (k,) seconds after its beginning at which who goes there is at its points.
    wanted
        (n,) seconds that each would be on the way when the tracks begin, ascending.
    apart
        Seconds from one to the next.
    others
        Who walks already.
    seconds
        How long the tracks of a closed course are.

    Returns
    -------
    begun, meeting
        (n,) seconds, and how many meet somebody for all that.
    """
    whole = float(moments[-1])
    last = seconds if way.closed else whole
    near = [_blocked(way, height, moments, others, last, reach) for reach in REACH]
    chosen: list[float] = []
    meeting = 0
    for own in wanted.tolist():
        tried = (_nearest_free(blocked, own, chosen, apart, whole, closed=way.closed)
                 for blocked in (*near, np.zeros_like(near[0])))  # fmt: skip
        place, found = next(
            ((at, one) for at, one in enumerate(tried) if one is not None), (len(near), own)
        )
        meeting += place == len(near)
        chosen.append(found)
    return np.array(chosen), meeting


def _blocked(
    way: Course, height: FloatArray, moments: FloatArray, others: Tracks, last: float, reach: float
) -> BoolArray:
    """(b,) whether who sets out so many bins before the tracks begin meets somebody."""
    from scipy.spatial import cKDTree

    whole = float(moments[-1])
    blocked = np.zeros(int(np.ceil(whole / BIN)) + 1, bool)
    along = np.arange(0.0, way.length + NEAR, NEAR)
    spots = np.column_stack([np.interp(along, way.along, column) for column in way.points.T])
    level = np.interp(along, way.along, height)
    passed = np.interp(along, way.along, moments)
    found = moments_of(others, np.arange(0.0, last + STEP, STEP))
    if not len(found.mover):
        return blocked
    pairs = cKDTree(found.position[:, :2]).sparse_distance_matrix(
        cKDTree(spots), reach, output_type="ndarray"
    )  # fmt: skip
    row, place = pairs["i"], pairs["j"]
    same = np.abs(found.position[row, 2] - level[place]) < STOREY
    begun = passed[place[same]] - found.time[row[same]]
    if way.closed:
        begun = np.mod(begun, whole)
    begun = begun[(begun >= 0.0) & (begun <= whole)]
    bins = np.rint(begun / BIN).astype(np.int64)
    blocked[np.minimum(bins, len(blocked) - 1)] = True
    return blocked


def _nearest_free(
    blocked: BoolArray, own: float, chosen: list[float], apart: float, whole: float, *, closed: bool
) -> float | None:
    """Return the free moment next to the one wanted, None without any."""
    free = np.flatnonzero(~blocked) * BIN
    off = np.abs(free - own)
    off = np.minimum(off, whole - off) if closed else off
    order = np.argsort(off, kind="stable")
    for at in order[off[order] <= LONGEST].tolist():
        moment = own if off[at] < BIN / 2 else float(free[at])
        if moment < whole and _kept_apart(moment, chosen, apart, whole, closed=closed):
            return moment
    return None


def _kept_apart(
    moment: float, chosen: list[float], apart: float, whole: float, *, closed: bool
) -> bool:
    gaps = np.abs(np.array(chosen) - moment)
    gaps = np.minimum(gaps, whole - gaps) if closed else gaps
    return bool((gaps >= apart - 1e-9).all())
