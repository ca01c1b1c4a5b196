"""Tracks sampled at many moments at once: where every mover is."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Any

import numpy as np
import shapely
from numpy.typing import ArrayLike, NDArray

from cityx.city.tracks import Tracks, between
from cityx.geometry.arrays import FloatArray, IntArray
from cityx.geometry.ranges import numbered


@dataclass(frozen=True)
class Moments:
    """Movers at moments, m pairs of them, ordered by mover and time.

    Attributes
    ----------
    mover
        (m,) int64, row of the tracks.
    number
        (m,) int64, which of the times.
    time
        (m,) float64, seconds.
    position
        (m, 3) float64, metres.
    heading
        (m,) float64, radians counter-clockwise from east.
    place, onto
        (m,) uint64, the lanes that the last sample and the next were on, 0 for none.
    """

    mover: IntArray
    number: IntArray
    time: FloatArray
    position: FloatArray
    heading: FloatArray
    place: NDArray[np.uint64]
    onto: NDArray[np.uint64]

    def by_time(self, count: int) -> list[IntArray]:
        """Return the rows of each of the `count` times, in the order of movers."""
        order = np.argsort(self.number, kind="stable")
        return np.split(order, np.searchsorted(self.number[order], np.arange(1, count)))

    def take(self, rows: NDArray[Any]) -> Moments:
        """Return the given pairs (indices or mask)."""
        return Moments(*(getattr(self, column.name)[rows] for column in fields(self)))

    def boxes(self, size: NDArray[np.float32], more: float = 0.0) -> NDArray[np.object_]:
        """Return (m,) outlines of movers seen from above.

        Parameters
        ----------
        size
            (n, 3) length, width and height of all movers of the tracks, metres.
        more
            Metres added on all sides; less than none where they may touch.
        """
        half = size[self.mover, :2].astype(float) / 2 + more
        ahead = np.column_stack([np.cos(self.heading), np.sin(self.heading)])
        side = np.column_stack([-ahead[:, 1], ahead[:, 0]])
        u, v = ahead * half[:, :1], side * half[:, 1:]
        xy = self.position[:, :2]
        ring = np.stack([xy - u - v, xy + u - v, xy + u + v, xy - u + v], axis=1)
        return np.asarray(shapely.polygons(ring), object)


def moments_of(tracks: Tracks, times: ArrayLike) -> Moments:
    """Return where movers are at times, each while it is in the city.

    Parameters
    ----------
    tracks
        The tracks.
    times
        (k,) seconds since they begin, ascending.
    """
    times = np.asarray(times, float)
    held = np.flatnonzero(np.diff(tracks.sample_start) > 0)
    first = tracks.sample_start[held]
    last = tracks.sample_start[held + 1] - 1
    begin = np.searchsorted(times, tracks.time[first], side="left")
    end = np.searchsorted(times, tracks.time[last], side="right")
    count = np.maximum(end - begin, 0)
    row = np.repeat(np.arange(len(held)), count)
    number = begin[row] + numbered(count)
    time = times[number]
    # One ascending key over all movers: each is moved behind the one before it.
    span = float(tracks.time.max(initial=0.0)) + 1.0
    keys = tracks.time + tracks.mover * span
    low = np.searchsorted(keys, time + held[row] * span, side="right") - 1
    low = np.clip(low, first[row], last[row])
    high = np.minimum(low + 1, last[row])
    _, position, heading = between(tracks, low, high, time)
    return Moments(
        held[row], number, time, position, heading, tracks.place[low], tracks.place[high]
    )
