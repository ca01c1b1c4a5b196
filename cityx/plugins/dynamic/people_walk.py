"""People under way: a crowd that follows its walks, waits where roadways are taken, and arrives."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from cityx.city.walkable import Walkable
from cityx.city.walks import SPACING
from cityx.geometry.crowd import APART, SQUEEZED, Crowd, stepped
from cityx.plugins.dynamic.people_trips import Trips

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]

STEP = 0.1  # seconds
SIGHT = np.array([0.15, 0.3, 0.45, 0.6, 0.8, 1.0])  # shares of a line at which it is looked at
AHEAD = 3  # points of the way, 1.5 m, to the place that walkers head for
WINDOW = 6  # points of the way ahead among which a walker finds where it is
ARRIVED = 0.6  # metres from the end of the way
BEFORE = 0.9  # metres of way before a roadway at which one waits
KEEP = (0.25, 0.9)  # metres beside the middle of the way that people keep to their own side
ELBOW = 0.1  # metres that they keep off walls while they do
TIGHT = 0.5  # metres of clearance below which one turns the shoulders to pass others
SQUEEZE_AFTER = 1.0  # seconds without getting on after which one turns the shoulders
GIVES_WAY = np.array([-0.8, -0.6])  # direction in which those walk who turn back first
SLOW = 0.2  # of the pace; who gets on by less is hindered
PATIENCE = 5.0  # seconds after which one tries the other side


@dataclass(frozen=True)
class Gates:
    """When people may step onto crosswalks, c of them, over n ticks.

    Attributes
    ----------
    tick
        Seconds between ticks.
    shut
        (c, n) bool, whether signals forbid to begin.
    taken
        (c, n) bool, whether a vehicle is on the crosswalk, or about to be.
    """

    tick: float
    shut: BoolArray
    taken: BoolArray

    def open(self, crosswalk: IntArray, now: float, seconds: FloatArray) -> BoolArray:
        """Tell (k,) whether one may begin to cross, who needs so many seconds."""
        last = self.taken.shape[1] - 1
        first = np.minimum(int(now / self.tick), last)
        until = np.minimum(((now + seconds) / self.tick).astype(np.int64) + 1, last)
        before = self._counted[crosswalk, first]
        return np.asarray(
            ~self.shut[crosswalk, first] & (self._counted[crosswalk, until + 1] == before)
        )

    @cached_property
    def _counted(self) -> IntArray:
        """(c, n + 1) ticks taken before each, so that spans of time are looked up."""
        sums = np.zeros((self.taken.shape[0], self.taken.shape[1] + 1), np.int64)
        np.cumsum(self.taken, axis=1, out=sums[:, 1:])
        return sums


@dataclass(frozen=True)
class Steps:
    """Where walkers were, s samples, ordered by walker and time.

    Attributes
    ----------
    trip
        (s,) int64, row of the trips.
    time
        (s,) float, seconds.
    position
        (s, 2) float, metres.
    late
        Walkers that were not under way in time, since no place was free where they come from.
    """

    trip: IntArray
    time: FloatArray
    position: FloatArray
    late: int


Others = Callable[[float], FloatArray]
"""From a time to the (m, 2) places of people who do not heed this crowd."""


def walked(
    trips: Trips, walkable: Walkable, gates: Gates, others: Others, duration: float, side: float
) -> Steps:
    """Let people walk.

    Parameters
    ----------
    trips
        Their ways; those of one place in the crowd start when the one before has arrived.
    walkable
        Where they may be.
    gates
        When they may cross.
    others
        Who is in the way besides.
    duration
        Seconds.
    side
        1 where people keep to the right, -1 to the left.
    """
    walk = _Walk(trips, walkable, gates, side)
    walk.begin(others(0.0))
    count = round(duration / STEP)
    rows, places = [], []
    for number in range(count + 1):
        now = number * STEP
        if number:
            walk.advance(now, others(now))
        rows.append(walk.present.copy())
        places.append(walk.position[walk.present])
    trip = np.concatenate(rows)
    time = np.repeat(np.arange(count + 1) * STEP, [len(r) for r in rows])
    order = np.lexsort((time, trip))
    return Steps(trip[order], np.round(time[order], 6), np.concatenate(places)[order],
                 int((~walk.started).sum()))  # fmt: skip


class _Walk:
    """A crowd while it walks; a class because it lives from step to step."""

    def __init__(self, trips: Trips, walkable: Walkable, gates: Gates, side: float) -> None:
        self.trips, self.walkable, self.gates = trips, walkable, gates
        count = len(trips.id)
        self.points: FloatArray
        self.first: IntArray
        self.last: IntArray
        # Behind all ways lie the same ways back, for those who give up.
        self.points = np.concatenate([trips.walks.points, trips.walks.points[::-1]])
        self.first, self.last = trips.walks.start[:-1].copy(), trips.walks.start[1:] - 1
        ends = np.concatenate([self.first, len(self.points) - 1 - self.last])
        lasts = np.concatenate([self.last, len(self.points) - 1 - self.first])
        self.at: IntArray = self.first.copy()  # point of the way that each is at
        self.position: FloatArray = self.points[self.first].copy()
        self.hand, self.side = side, np.full(count, side)
        self.keep = KEEP[0] + (KEEP[1] - KEEP[0]) * _share(trips)
        self.granted = np.full(count, 0)  # number of the crosswalk that each may be on
        self.stuck = np.zeros(count)
        self.back = np.zeros(count, bool)
        self.started, self.arrived = np.zeros(count, bool), np.zeros(count, bool)
        self.present = np.zeros(0, np.int64)
        self.over: IntArray = walkable.at(walkable.crosswalk, self.points).astype(np.int64)
        self.next_over = _next_set(self.over, lasts)
        self.right = _rights(self.points, ends, lasts)
        self.room = np.maximum(
            walkable.at(walkable.clearance, self.points).astype(float) - ELBOW, 0.0
        )

    def begin(self, others: FloatArray) -> None:
        """Set those under way on their ways, apart from each other and off the roadways."""
        head = np.flatnonzero(np.r_[True, np.diff(self.trips.place) > 0][: len(self.trips.id)])
        taken = [others]
        for row in head.tolist():
            first, last = int(self.first[row]), int(self.last[row])
            size = last - first + 1
            begin = first + int(self.trips.begun[row] * (size - 1))
            # From there on, then from the start of the way, the first place that is free.
            for at in (*range(begin, last), *range(first, begin)):
                spot = self.points[at]
                near = np.concatenate(taken) - spot
                if self.over[at] == 0 and (np.hypot(*near.T) >= APART).all():
                    self.at[row], self.position[row] = at, spot
                    self.started[row] = True
                    taken.append(spot[None])
                    break
        self.present = np.flatnonzero(self.started)

    def advance(self, now: float, others: FloatArray) -> None:
        """Let everybody take one step."""
        self._enter(others)
        rows = self.present
        self._locate(rows)
        waits = self._wait(rows, now)
        target = self._targets(rows)
        pace = np.where(waits, 0.0, self.trips.pace[rows])
        tight = self.walkable.at(self.walkable.clearance, self.position[rows]) < TIGHT
        tight |= self.walkable.at(self.walkable.clearance, target) < TIGHT
        apart = np.where(tight | (self.stuck[rows] > SQUEEZE_AFTER), SQUEEZED, APART)
        crowd = Crowd(self.position[rows], target, pace, self.side[rows], apart)
        before = self.position[rows]
        self.position[rows] = stepped(crowd, others, STEP, lambda of, to: self._may(rows[of], to))
        self._lose_patience(rows, before, target, waits)
        end = self.points[self.last[rows]]
        done = np.hypot(*(self.position[rows] - end).T) < ARRIVED
        done |= self.at[rows] >= self.last[rows]
        self.arrived[rows[done]] = True
        self.present = rows[~done]

    def _lose_patience(
        self, rows: IntArray, before: FloatArray, target: FloatArray, waits: BoolArray
    ) -> None:
        """Count the time in which people do not get on, and let them try the other side."""
        ahead = target - before
        ahead /= np.maximum(np.hypot(*ahead.T), 1e-9)[:, None]
        gone = ((self.position[rows] - before) * ahead).sum(axis=1)
        slow = (gone < SLOW * self.trips.pace[rows] * STEP) & ~waits
        self.stuck[rows] = np.where(slow, self.stuck[rows] + STEP,
                                    np.maximum(self.stuck[rows] - STEP, 0.0))  # fmt: skip
        self.side[rows[self.stuck[rows] == 0.0]] = self.hand
        # Of two files that meet, those to the east and north go on and the others turn back.
        yields = (ahead @ GIVES_WAY > 0) | (self.stuck[rows] > 2 * PATIENCE)
        gives_up = rows[(self.stuck[rows] > PATIENCE) & yields & ~self.back[rows]]
        self.at[gives_up] = len(self.points) - 1 - self.at[gives_up]
        first = self.first[gives_up]
        self.first[gives_up] = len(self.points) - 1 - self.last[gives_up]
        self.last[gives_up] = len(self.points) - 1 - first
        self.back[gives_up] = True
        self.stuck[gives_up] = 0.0
        turned = rows[self.stuck[rows] > 2 * PATIENCE]
        self.side[turned] *= -1
        self.stuck[turned] = PATIENCE

    def _enter(self, others: FloatArray) -> None:
        """Let the next of each place of the crowd begin, if nobody stands where its way begins."""
        place = self.trips.place
        waiting = np.flatnonzero(~self.started)
        waiting = waiting[np.r_[True, place[waiting][1:] != place[waiting][:-1]][: len(waiting)]]
        busy = np.zeros(int(place.max(initial=-1)) + 1, bool)
        busy[place[self.present]] = True
        waiting = waiting[~busy[place[waiting]]]
        if not len(waiting):
            return
        taken = np.concatenate([self.position[self.present], others])
        entered = []
        for row in waiting.tolist():
            spot = self.points[self.first[row]]
            if (np.hypot(*(taken - spot).T) >= APART).all():
                taken = np.concatenate([taken, spot[None]])
                entered.append(row)
        self.started[entered] = True
        self.present = np.sort(np.concatenate([self.present, np.array(entered, np.int64)]))

    def _locate(self, rows: IntArray) -> None:
        """Find the point of the way that each is nearest to, never one behind."""
        ahead = np.minimum(self.at[rows, None] + np.arange(WINDOW), self.last[rows, None])
        far = np.hypot(*(self.points[ahead] - self.position[rows, None]).transpose(2, 0, 1))
        self.at[rows] = ahead[np.arange(len(rows)), np.argmin(far, axis=1)]

    def _wait(self, rows: IntArray, now: float) -> BoolArray:
        """(r,) whether each stands before a roadway that may not be stepped onto now."""
        at = self.at[rows]
        ahead = self.next_over[at]
        crosswalk = self.over[ahead]
        here = self.walkable.at(self.walkable.crosswalk, self.position[rows]).astype(np.int64)
        # Until one is on it leave may be taken back; once on it, nobody stops.
        asks: BoolArray = (crosswalk > 0) & (crosswalk != here) & ((ahead - at) * SPACING <= BEFORE)
        self.granted[rows] = here
        asking = np.flatnonzero(asks)
        number = crosswalk[asking] - 1
        way = self.walkable.crosswalks.length[number] + BEFORE
        let = asking[self.gates.open(number, now, way / self.trips.pace[rows[asking]])]
        self.granted[rows[let]] = crosswalk[let]
        asks[let] = False
        return asks

    def _targets(self, rows: IntArray) -> FloatArray:
        """(r, 2) places ahead that are in sight, on one's own side of the way where they can be."""
        at, last = self.at[rows], self.last[rows]
        ahead = np.minimum(at + AHEAD, last)
        aside = np.minimum(self.keep[rows], self.room[ahead]) * self.hand
        aside[ahead == last] = 0.0
        found: FloatArray = self.points[ahead]
        open_ = np.ones(len(rows), bool)
        for far, share in ((AHEAD, 1.0), (AHEAD, 0.5), (2, 0.0), (1, 0.0)):
            of = np.flatnonzero(open_)
            point = np.minimum(at + far, last)[of]
            to = self.points[point] + share * aside[of, None] * self.right[point]
            seen = self._sees(self.position[rows[of]], to)
            found[of[seen]] = to[seen]
            open_[of[seen]] = False
        return found

    def _sees(self, here: FloatArray, there: FloatArray) -> BoolArray:
        """(k,) whether straight lines between places stay free."""
        spots = here[:, None] + SIGHT[:, None] * (there - here)[:, None]
        return np.asarray(
            self.walkable.holds(spots.reshape(-1, 2)).reshape(len(here), len(SIGHT)).all(axis=1)
        )

    def _may(self, rows: IntArray, to: FloatArray) -> BoolArray:
        """(k,) whether walkers may be at places."""
        index = self.walkable.index(to)
        over = self.walkable.crosswalk.ravel()[index]
        here = self.walkable.at(self.walkable.crosswalk, self.position[rows])
        known = (over == 0) | (over == self.granted[rows]) | (over == here)
        return np.asarray(self.walkable.free.ravel()[index] & known)


def _share(trips: Trips) -> FloatArray:
    """(t,) numbers in [0, 1) from ids."""
    return np.asarray((trips.id >> np.uint64(11)).astype(float) / float(1 << 53))


def _next_set(over: IntArray, last: IntArray) -> IntArray:
    """(p,) index of the next point on a roadway, itself included; the last point where none is."""
    count = len(over)
    stop = over > 0
    stop[last] = True
    index = np.where(stop, np.arange(count), count)
    return np.asarray(np.minimum.accumulate(index[::-1])[::-1])


def _rights(points: FloatArray, first: IntArray, last: IntArray) -> FloatArray:
    """(p, 2) unit vectors to the right of the way at its points."""
    number = np.arange(len(points))
    low, high = number - 1, number + 1
    low[first], high[last] = first, last
    ahead = points[high] - points[low]
    ahead = ahead / np.maximum(np.hypot(*ahead.T), 1e-9)[:, None]
    return np.column_stack([ahead[:, 1], -ahead[:, 0]])
