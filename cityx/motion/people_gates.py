"""Gap acceptance of pedestrians: when they may cross, since vehicles do not give way to them."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from cityx.city.moments import moments_of
from cityx.city.signals import GO, STATE, Signals, states_at
from cityx.city.tracks import MOVER, Tracks
from cityx.geometry.arrays import BoolArray, FloatArray, IntArray
from cityx.ground.walking.crosswalks import heads_of
from cityx.ground.walking.walkable import CELL, Walkable

TICK = 0.2  # seconds between the moments at which vehicles are looked for
ROOM = 0.6  # metres that people keep from vehicles before they step onto a roadway
SOON = 1.0  # seconds before a vehicle comes, and after it has gone, in which nobody steps there
FORESEEN = 1.4  # seconds ahead in which people see where vehicles are going to be
BODY = 0.3  # metres from the middle of a person that are kept from those places
USUAL = 1.1  # metres per second at which it is reckoned when one could cross
ON_FOOT = ("pedestrian", "animal")
CLEARED = 3.0  # seconds before red in which who passes by a crosswalk gets off its rim
LONG = 120.0  # seconds; whether one waits still longer makes no difference
NEVER = np.int32(1 << 30)  # ticks


@dataclass(frozen=True)
class Gates:
    """When people may step onto crosswalks, c of them, over n ticks, and what comes their way.

    Attributes
    ----------
    tick
        Seconds between ticks.
    shut
        (c, n) bool, whether signals forbid to begin.
    taken
        (c, n) bool, whether a vehicle is on the crosswalk, or about to be.
    seconds
        (c,) float, that it takes to cross.
    boxes
        (b, 6) outlines of vehicles that reach over where people walk, with what is kept from them,
        as of `cityx.motion.crowd.stepped`.
    start
        (n + 1,) int64, first box of each tick.
    """

    tick: float
    shut: BoolArray
    taken: BoolArray
    seconds: FloatArray
    boxes: FloatArray
    start: IntArray

    def open(self, crosswalk: IntArray, now: float, seconds: FloatArray) -> BoolArray:
        """Return (k,) whether a crossing that takes so many seconds may begin."""
        first = self._at(now)
        free = self._free_for[crosswalk, first] * self.tick
        return np.asarray(~self.shut[crosswalk, first] & (free >= seconds))

    def left(self, crosswalk: IntArray, now: float) -> FloatArray:
        """(k,) seconds until crosswalks are taken by a vehicle."""
        return np.asarray(self._free_for[crosswalk, self._at(now)] * self.tick)

    def opens_in(self, crosswalk: IntArray, now: float) -> FloatArray:
        """(k,) seconds until one may begin to cross at the usual pace."""
        return np.asarray(self._opens_in[crosswalk, self._at(now)] * self.tick)

    @property
    def waits(self) -> FloatArray:
        """(c,) seconds that one waits before each crosswalk, whenever one comes there."""
        return np.asarray(np.minimum(self._opens_in * self.tick, LONG).mean(axis=1))

    def closing(self, now: float) -> BoolArray:
        """(c + 1,) by number from 1, crosswalks that signals forbid to step onto, now or soon."""
        first = self._at(now)
        last = first + round(CLEARED / self.tick) + 1
        return np.concatenate([np.zeros(1, bool), self.shut[:, first:last].any(axis=1)])

    def boxes_at(self, now: float) -> FloatArray:
        """(b, 6) where vehicles are from now on for a while."""
        first = self._at(now)
        last = min(first + round(FORESEEN / self.tick), len(self.start) - 2)
        return self.boxes[self.start[first] : self.start[last + 1]]

    def _at(self, now: float) -> int:
        return min(int(now / self.tick + 1e-6), self.taken.shape[1] - 1)

    @cached_property
    def _free_for(self) -> NDArray[np.int32]:
        """(c, n) ticks until the next that is taken; `NEVER` where none is known."""
        return _ticks_until(self.taken)

    @cached_property
    def _opens_in(self) -> NDArray[np.int32]:
        """(c, n) ticks until the next at which one may begin."""
        enough = self._free_for * self.tick >= self.seconds[:, None]
        return _ticks_until(enough & ~self.shut)


def _ticks_until(found: BoolArray) -> NDArray[np.int32]:
    """(c, n) ticks from each to the next that is found."""
    count = found.shape[1]
    index = np.where(found, np.arange(count, dtype=np.int32), NEVER)
    following = np.minimum.accumulate(index[:, ::-1], axis=1)[:, ::-1]
    return np.where(following == NEVER, NEVER, following - np.arange(count, dtype=np.int32))


def gates_of(tracks: Tracks, signals: Signals | None, walkable: Walkable, duration: float) -> Gates:
    """Find when signals let people onto crosswalks, and when these are free of vehicles.

    Parameters
    ----------
    tracks
        What moves already; it does not give way.
    signals
        What signals show, None without any.
    walkable
        The walkable area with its crosswalks.
    duration
        Seconds.
    """
    from cityx.motion.crowd_kernel import swept

    ticks = int(np.ceil(duration / TICK)) + 1
    taken = np.zeros((walkable.crosswalks.count, ticks), bool)
    driving = tracks.take(~np.isin(tracks.kind, [MOVER[name] for name in ON_FOOT]))
    found = moments_of(driving, np.arange(ticks) * TICK)
    boxes = np.column_stack([
        found.position[:, :2], np.cos(found.heading), np.sin(found.heading),
        driving.size[found.mover, :2].astype(float) / 2 + BODY,
    ])  # fmt: skip
    order = np.argsort(found.number, kind="stable")
    boxes, number = boxes[order], found.number[order]
    reaches = swept(boxes, number, ROOM - BODY, taken, walkable.free, walkable.crosswalk,
                    walkable.grid.west, walkable.grid.north, CELL)  # fmt: skip
    start = np.searchsorted(number[reaches], np.arange(ticks + 1)).astype(np.int64)
    wide = taken.copy()
    for shift in range(1, round(SOON / TICK) + 1):
        wide[:, shift:] |= taken[:, :-shift]
        wide[:, :-shift] |= taken[:, shift:]
    seconds = walkable.crosswalks.length / USUAL + SOON
    return Gates(TICK, _shut(signals, walkable, ticks), wide, seconds, boxes[reaches], start)


def in_boxes(boxes: FloatArray, spots: FloatArray) -> BoolArray:
    """Return which of (n, 2) places lie in one of (b, 6) boxes."""
    gap = spots[:, None] - boxes[None, :, :2]
    east, north = boxes[:, 2], boxes[:, 3]
    along = np.abs(gap[:, :, 0] * east + gap[:, :, 1] * north) < boxes[:, 4]
    across = np.abs(gap[:, :, 1] * east - gap[:, :, 0] * north) < boxes[:, 5]
    return np.asarray((along & across).any(axis=1))


def _shut(signals: Signals | None, walkable: Walkable, ticks: int) -> BoolArray:
    """(c, ticks) whether signals keep people off crosswalks."""
    shut = np.zeros((walkable.crosswalks.count, ticks), bool)
    head = heads_of(walkable.crosswalks, signals)
    ruled = np.flatnonzero(head >= 0)
    if signals is not None and len(ruled):
        go = [STATE[name] for name in (*GO, "off")]
        for number in range(ticks):
            shown = states_at(signals, number * TICK)[head[ruled]]
            shut[ruled, number] = ~np.isin(shown, go)
    return shut
