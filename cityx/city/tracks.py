"""Tracks: where everything that moves by itself is over time."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cityx.geometry.ranges import ranges

FRAME_RATE = 25  # frames per second of what moves
MOVER_KINDS = (
    "car", "van", "truck", "bus", "motorcycle", "bicycle", "tram", "pedestrian", "animal",
)  # fmt: skip
ON_FOOT = ("pedestrian", "animal")
MOVER = {name: number for number, name in enumerate(MOVER_KINDS)}
GAITS = ("still", "walk", "run", "ride", "sit", "push")
GAIT = {name: number for number, name in enumerate(GAITS)}
AT_REST = (GAIT["still"], GAIT["sit"])  # of those who get nowhere


@dataclass(frozen=True)
class Tracks:
    """The ways of n movers, s samples in all; those of one mover follow each other in time.

    Before its first sample and after its last a mover is not in the city. Between two samples it
    goes straight, and turns the shorter way.

    Attributes
    ----------
    object_id
        (n,) uint64, stable, ascending.
    kind
        (n,) uint8 into `MOVER_KINDS`.
    look
        (n,) str, the prototype that shows it, such as ``car_hatchback``.
    origin
        (n,) str, id of the action that put it there.
    tint
        (n, 3) float32, linear RGB of its paint or clothes.
    size
        (n, 3) float32, metres: length, width and height.
    sample_start
        (n + 1,) int64 into the samples.
    time
        (s,) float64, seconds since the tracks begin, ascending within a mover.
    position
        (s, 3) float64, metres: the middle of its outline, on what it stands on.
    heading
        (s,) float64, radians counter-clockwise from east, of where it faces.
    speed
        (s,) float32, metres per second.
    gait
        (s,) uint8 into `GAITS`.
    place
        (s,) uint64, the lane it is on by `LaneGraph.lane_id`; 0 where there is none, as on a
        pavement or across a junction.
    """

    object_id: NDArray[np.uint64]
    kind: NDArray[np.uint8]
    look: NDArray[np.str_]
    origin: NDArray[np.str_]
    tint: NDArray[np.float32]
    size: NDArray[np.float32]
    sample_start: NDArray[np.int64]
    time: NDArray[np.float64]
    position: NDArray[np.float64]
    heading: NDArray[np.float64]
    speed: NDArray[np.float32]
    gait: NDArray[np.uint8]
    place: NDArray[np.uint64]

    @property
    def count(self) -> int:
        """Number of movers."""
        return len(self.object_id)

    @property
    def mover(self) -> NDArray[np.int64]:
        """(s,) row of the mover of each sample."""
        return np.repeat(np.arange(self.count), np.diff(self.sample_start))

    @property
    def on_foot(self) -> NDArray[np.bool_]:
        """(n,) which movers are people or animals."""
        return np.isin(self.kind, [MOVER[name] for name in ON_FOOT])

    @property
    def duration(self) -> float:
        """Seconds from the beginning to the last sample."""
        return float(self.time.max()) if len(self.time) else 0.0

    def take(self, rows: NDArray[np.int64] | NDArray[np.bool_]) -> Tracks:
        """Return the tracks of some movers, in the order of `rows`."""
        rows = np.arange(self.count)[rows]
        samples, start = ranges(self.sample_start, rows)
        changed = {name: getattr(self, name)[rows] for name in _OF_MOVERS}
        changed |= {name: getattr(self, name)[samples] for name in _OF_SAMPLES}
        return replace(self, **changed, sample_start=start)


@dataclass(frozen=True)
class Poses:
    """Where the m movers are that the city holds at one moment.

    Attributes
    ----------
    row
        (m,) int64 into the movers of the tracks.
    position, heading, speed, gait
        As of `Tracks`.
    travelled
        (m,) float64, metres that each has gone since its first sample; wheels and legs follow it.
    climb
        (m,) float64, radians by which the way that it goes rises.
    """

    row: NDArray[np.int64]
    position: NDArray[np.float64]
    heading: NDArray[np.float64]
    speed: NDArray[np.float64]
    gait: NDArray[np.uint8]
    travelled: NDArray[np.float64]
    climb: NDArray[np.float64]


_OF_SAMPLES = ("time", "position", "heading", "speed", "gait", "place")
_OF_MOVERS = tuple(f.name for f in fields(Tracks) if f.name not in (*_OF_SAMPLES, "sample_start"))


def no_tracks() -> Tracks:
    """Return tracks without a mover."""
    return Tracks(
        np.zeros(0, np.uint64),
        np.zeros(0, np.uint8),
        np.zeros(0, "<U1"),
        np.zeros(0, "<U1"),
        np.zeros((0, 3), np.float32),
        np.zeros((0, 3), np.float32),
        np.zeros(1, np.int64),
        np.zeros(0),
        np.zeros((0, 3)),
        np.zeros(0),
        np.zeros(0, np.float32),
        np.zeros(0, np.uint8),
        np.zeros(0, np.uint64),
    )


def join_tracks(parts: Sequence[Tracks]) -> Tracks:
    """Join tracks, ordered by object id.

    Raises
    ------
    ValueError
        If an object is in two of them.
    """
    parts = [no_tracks(), *parts]
    held = {
        name: np.concatenate([getattr(part, name) for part in parts])
        for name in (*_OF_MOVERS, *_OF_SAMPLES)
    }
    lengths = np.concatenate([np.diff(part.sample_start) for part in parts])
    start = np.concatenate([[0], np.cumsum(lengths)]).astype(np.int64)
    ids = held["object_id"]
    if len(np.unique(ids)) < len(ids):
        raise ValueError("an object moves on two tracks")
    return Tracks(**held, sample_start=start).take(np.argsort(ids))


def poses_at(tracks: Tracks, moment: float) -> Poses:
    """Return where movers are at a moment.

    Parameters
    ----------
    tracks
        The tracks.
    moment
        Seconds since they begin.
    """
    held, low, high = held_at(tracks, moment)
    share, position, heading = between(tracks, low, high, moment)
    step = tracks.position[high] - tracks.position[low]
    run = np.hypot(*step[:, :2].T)
    return Poses(
        held,
        position,
        heading,
        tracks.speed[low] + share * (tracks.speed[high] - tracks.speed[low]),
        tracks.gait[low],
        travelled(tracks)[low] + share * run,
        np.arctan2(step[:, 2], run),
    )


def held_at(
    tracks: Tracks, moment: float
) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.int64]]:
    """Return the (m,) movers that a city holds at a moment, and their samples around it."""
    start, time = tracks.sample_start, tracks.time
    held = np.flatnonzero(np.diff(start) > 0)
    held = held[(time[start[held]] <= moment) & (moment <= time[start[held + 1] - 1])]
    before = np.bincount(tracks.mover[time <= moment], minlength=tracks.count)[held]
    low = start[held] + before - 1
    return held, low, np.minimum(low + 1, start[held + 1] - 1)


def between(
    tracks: Tracks, low: NDArray[np.int64], high: NDArray[np.int64], time: ArrayLike
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Return where movers are between two samples of theirs.

    Parameters
    ----------
    tracks
        The tracks.
    low, high
        (k,) samples, the same where there is but one.
    time
        (k,) seconds or one time for all, from the one sample to the other.

    Returns
    -------
    share, position, heading
        (k,) of the way between the samples in time, (k, 3) metres, (k,) radians the shorter way.
    """
    time = np.asarray(time, float)
    span = tracks.time[high] - tracks.time[low]
    share = np.where(span > 0, (time - tracks.time[low]) / np.where(span > 0, span, 1.0), 0.0)
    turn = np.remainder(tracks.heading[high] - tracks.heading[low] + np.pi, 2 * np.pi) - np.pi
    step = tracks.position[high] - tracks.position[low]
    position = tracks.position[low] + share[:, None] * step
    return share, position, tracks.heading[low] + share * turn


def travelled(tracks: Tracks) -> NDArray[np.float64]:
    """Return (s,) metres that its mover has gone up to each sample."""
    gone = np.zeros(len(tracks.time))
    gone[1:] = np.cumsum(np.hypot(*np.diff(tracks.position[:, :2], axis=0).T))
    first = tracks.sample_start[:-1]
    filled = np.diff(tracks.sample_start) > 0
    base = np.zeros(tracks.count)
    base[filled] = gone[first[filled]]
    return np.asarray(gone - base[tracks.mover])
