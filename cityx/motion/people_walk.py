"""Pedestrians under way: follow routes, wait at roadways that are not free, arrive."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from cityx.geometry.arrays import BoolArray, FloatArray, IntArray
from cityx.ground.walking.walkable import CELL, Walkable
from cityx.ground.walking.walks import SPACING
from cityx.motion.crowd import APART, CREEP, SQUEEZED, Crowd, Floor, stepped
from cityx.motion.people_gates import Gates, in_boxes
from cityx.motion.people_trips import Trips

STEP = 0.1  # seconds
SIGHT = np.array([0.15, 0.3, 0.45, 0.6, 0.8, 1.0])  # shares of a line at which it is looked at
AHEAD = 3  # points of the way, 1.5 m, to the place that walkers head for
WINDOW = 6  # points of the way ahead among which a walker finds where it is
ARRIVED = 0.6  # metres from the end of the way
BEFORE = (0.6, 2.1)  # metres of way before a roadway at which people wait, not all in one row
QUEUE = 8.0  # metres before it within which one stands in a queue and does not lose patience
KEEP = (0.25, 0.9)  # metres beside the middle of the way that people keep to their own side
ABREAST = 1.4  # metres to both sides of the way in which people stand while they wait to cross
ELBOW = 0.1  # metres that they keep off walls while they do
TIGHT = 0.5  # metres of clearance below which one turns the shoulders to pass others
SQUEEZE_AFTER = 1.0  # seconds without getting on after which one turns the shoulders
GIVES_WAY = np.array([-0.8, -0.6])  # direction in which those walk who turn back first
SLOW = 0.2  # of the pace; who gets on by less is hindered
PATIENCE = 5.0  # seconds after which one tries the other side
TURN_AFTER = 15.0  # seconds after which one turns back
ONWARD = 20.0  # seconds after turning back in which one does not turn back again
LONGEST_WAIT = 40.0  # seconds; before a roadway that stays taken for longer one turns back
SPARE, SLOWED = 1.0, 1.15  # seconds to spare on a roadway, and by how much others hold one up
CAUGHT = 1.5  # seconds without getting on after which somebody on a roadway keeps others off it
ON_THE_SPOT, GONE_AFTER = (
    1.5,
    58.0,
)  # metres within which, and seconds after which, one is taken out
STRAYED = 6.0  # seconds without getting on after which one goes by every point of the way
HASTE = 6.0  # seconds before a vehicle comes from which one hurries off the roadway
HURRY = 1.5  # times one's pace while one does


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
    lost
        Walkers that could not get on for a minute and were taken out.
    """

    trip: IntArray
    time: FloatArray
    position: FloatArray
    late: int
    lost: int


Others = Callable[[float], FloatArray]
"""From a time to the (m, 2) places of people who do not heed this crowd."""


def walked(
    trips: Trips, walkable: Walkable, gates: Gates, others: Others, duration: float, side: float
) -> Steps:
    """Simulate the pedestrians.

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
                 int((~walk.started).sum()), walk.lost)  # fmt: skip


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
        self.stand = ABREAST * (2.0 * np.modf(97.0 * _share(trips))[0] - 1.0)
        self.halt = BEFORE[0] + (BEFORE[1] - BEFORE[0]) * np.modf(389.0 * _share(trips))[0]
        self.granted = np.full(count, 0)  # number of the crosswalk that each may be on
        self.on = np.full(count, 0)  # that each is on, or has been and is on the rim of still
        self.stuck = np.zeros(count)
        self.turned = np.full(count, -ONWARD)  # when each last turned back
        self.floor = Floor(walkable.free, walkable.crosswalk, walkable.rim, walkable.grid.west,
                           walkable.grid.north, CELL)  # fmt: skip
        self.waited = np.zeros(count)  # seconds, before the same roadway
        # Where each was last farther than a few steps from before, and since when.
        self.anchor, self.since = self.position.copy(), np.zeros(count)
        self.lost = 0  # people who were taken out since they could not get on
        self.started, self.arrived = np.zeros(count, bool), np.zeros(count, bool)
        self.present = np.zeros(0, np.int64)
        self.over: IntArray = walkable.at(walkable.crosswalk, self.points).astype(np.int64)
        self.next_over = _next_set(self.over, lasts)
        self.coming = self.over[self.next_over]
        self.leaving = _second_halves(self.over, ends)
        self.right = _rights(self.points, ends, lasts)
        self.axes = walkable.crosswalks.ends[:, 1] - walkable.crosswalks.ends[:, 0]
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
        self.anchor = self.position.copy()

    def advance(self, now: float, others: FloatArray) -> None:
        """Advance every pedestrian by one step."""
        from cityx.motion.crowd_kernel import follow

        boxes = self.gates.boxes_at(now)
        self._enter(now, others, boxes)
        rows = self.present
        before = self.position[rows]
        strays = now - self.since > STRAYED
        aside = np.where(self.waited > 0.0, self.stand, self.keep * self.hand)
        aside[strays] = 0.0
        target = follow(
            rows, self.at, self.last, self.position, self.points, self.right, self.room,
            self.coming, aside, WINDOW, AHEAD, SIGHT, *self.floor.place,
        )  # fmt: skip
        here = self.walkable.at(self.walkable.crosswalk, before).astype(np.int64)
        waits, queues = self._wait(rows, here, now)
        late = (here > 0) & (self.gates.left(here - 1, now) < HASTE)
        own = self.trips.pace[rows]
        pace = np.where(waits, 0.0, own * np.where(late, HURRY, 1.0))
        tight = self.walkable.at(self.walkable.clearance, before) < TIGHT
        tight |= self.walkable.at(self.walkable.clearance, target) < TIGHT
        tight |= late | (self.stuck[rows] > SQUEEZE_AFTER)
        crowd = Crowd(before, target, pace, CREEP * own, self.side[rows],
                      np.where(tight, SQUEEZED, APART), self.granted[rows],
                      self.coming[self.at[rows]])  # fmt: skip
        self.position[rows] = stepped(
            crowd, others, STEP, self.floor, boxes, self.gates.closing(now)
        )
        self._lose_patience(rows, before, target, waits | queues, here > 0, now)
        end = self.points[self.last[rows]]
        done = np.hypot(*(self.position[rows] - end).T) < ARRIVED
        done |= self.at[rows] >= self.last[rows]
        self.arrived[rows[done]] = True
        moved = np.hypot(*(self.position[rows] - self.anchor[rows]).T) > ON_THE_SPOT
        self.anchor[rows[moved]] = self.position[rows[moved]]
        self.since[rows[moved]] = now
        lost = ~done & (now - self.since[rows] > GONE_AFTER)
        self.lost += int(lost.sum())
        done |= lost
        self.present = rows[~done]

    def _lose_patience(
        self, rows: IntArray, before: FloatArray, target: FloatArray, patient: BoolArray,
        over: BoolArray, now: float,
    ) -> None:  # fmt: skip
        """Count the time in which people do not get on, and let them try the other side."""
        ahead = target - before
        ahead /= np.maximum(np.hypot(*ahead.T), 1e-9)[:, None]
        gone = ((self.position[rows] - before) * ahead).sum(axis=1)
        slow = gone < SLOW * self.trips.pace[rows] * STEP
        slow |= now - self.since[rows] > STRAYED  # who sways on the spot gets on and back again
        slow &= ~patient
        was = self.stuck[rows]
        self.stuck[rows] = np.where(slow, self.stuck[rows] + STEP,
                                    np.maximum(self.stuck[rows] - STEP, 0.0))  # fmt: skip
        self.side[rows[self.stuck[rows] == 0.0]] = self.hand
        # Of two files that meet, those to the east and north go on and the others turn back.
        yields = (ahead @ GIVES_WAY > 0) | (self.stuck[rows] > 2 * TURN_AFTER)
        self._turn_back(rows[(self.stuck[rows] > TURN_AFTER) & yields & ~over], now)
        swaps = rows[np.floor(self.stuck[rows] / PATIENCE) > np.floor(was / PATIENCE)]
        self.side[swaps] *= -1

    def _turn_back(self, rows: IntArray, now: float) -> None:
        """Let people walk back to where they come from, who did not turn just now."""
        rows = rows[now - self.turned[rows] > ONWARD]
        top = len(self.points) - 1
        self.at[rows] = top - self.at[rows]
        self.first[rows], self.last[rows] = top - self.last[rows], top - self.first[rows]
        self.turned[rows] = now
        self.stuck[rows] = self.waited[rows] = 0.0

    def _enter(self, now: float, others: FloatArray, boxes: FloatArray) -> None:
        """Let the next of each place of the crowd begin, if nobody stands where its way begins."""
        place = self.trips.place
        waiting = np.flatnonzero(~self.started)
        waiting = waiting[np.r_[True, place[waiting][1:] != place[waiting][:-1]][: len(waiting)]]
        busy = np.zeros(int(place.max(initial=-1)) + 1, bool)
        busy[place[self.present]] = True
        waiting = waiting[~busy[place[waiting]]]
        if not len(waiting):
            return
        spots = self.points[self.first[waiting]]
        clear = ~in_boxes(boxes, spots)
        taken = np.concatenate([self.position[self.present], others])
        entered = []
        for row, spot in zip(waiting[clear].tolist(), spots[clear], strict=True):
            if (np.hypot(*(taken - spot).T) >= APART).all():
                taken = np.concatenate([taken, spot[None]])
                entered.append(row)
        self.started[entered] = True
        self.anchor[entered], self.since[entered] = self.position[entered], now
        self.present = np.sort(np.concatenate([self.present, np.array(entered, np.int64)]))

    def _forth(self, crosswalk: IntArray, point: IntArray) -> IntArray:
        """(k,) 1 where ways lead over crosswalks from their first ends to the second, else 0."""
        along, right = self.axes[crosswalk], self.right[point]
        turn = right[:, 0] * along[:, 1] - right[:, 1] * along[:, 0]
        return np.asarray(turn > 0, np.int64)

    def _leaves(self, rows: IntArray, here: IntArray) -> BoolArray:
        """(r,) whether each gets off the roadway that its way is on.

        The way may be past the middle of a roadway when the walker is not on it: the nearest point
        of the way is there for who stands beside a crosswalk, or turns back before it.
        """
        rim = self.walkable.at(self.walkable.rim, self.position[rows]).astype(np.int64)
        was = self.on[rows]
        self.on[rows] = np.where(here > 0, here, np.where(rim == was, was, 0))
        leaves = np.asarray(self.leaving[self.at[rows]])
        off = np.flatnonzero(leaves & (self.on[rows] != self.over[self.at[rows]]))
        point = self.at[rows[off]]
        number = self.over[point] - 1
        gone = self.position[rows[off]] - self.walkable.crosswalks.ends[number].mean(axis=1)
        forth = 2.0 * self._forth(number, point) - 1.0
        leaves[off] = forth * (gone * self.axes[number]).sum(axis=1) > 0.0
        return leaves

    def _wait(self, rows: IntArray, here: IntArray, now: float) -> tuple[BoolArray, BoolArray]:
        """(r,) whether each stands before a roadway that may not be stepped onto, or in a queue."""
        at = self.at[rows]
        ahead = self.next_over[at]
        crosswalk = self.over[ahead]
        far = (ahead - at) * SPACING
        # Until one is on it leave may be taken back; once on it, nobody stops.
        leaves = self._leaves(rows, here)
        queues: BoolArray = (crosswalk > 0) & (crosswalk != here) & (far <= QUEUE) & ~leaves
        self.granted[rows] = np.where(leaves & (self.on[rows] == self.over[at]),
                                      self.over[at], here)  # fmt: skip
        near = np.flatnonzero(queues)
        number = crosswalk[near] - 1
        halt = self.halt[rows]
        way = self.walkable.crosswalks.length[number] + halt[near]
        seconds = SPARE + SLOWED * way / self.trips.pace[rows[near]]
        # Nobody follows those who cannot get off it, but who comes from there makes room by going.
        held = np.flatnonzero((here > 0) & (self.stuck[rows] > CAUGHT))
        caught = np.zeros((2, self.walkable.crosswalks.count), bool)
        caught[self._forth(here[held] - 1, at[held]), here[held] - 1] = True
        let = self.gates.open(number, now, seconds)
        let &= ~caught[self._forth(number, ahead[near]), number]
        queues[near[let]] = False
        let &= far[near] <= halt[near]
        self.granted[rows[near[let]]] = crosswalk[near[let]]
        waits = queues & (far <= halt)
        # A gap that others take ends no wait.
        short = (crosswalk > 0) & (here == 0) & (far <= QUEUE)
        waited = self.waited[rows]
        self.waited[rows] = np.where(queues, waited + STEP, np.where(short, waited, 0.0))
        shut = near[queues[near]]
        gives_up = self.gates.opens_in(crosswalk[shut] - 1, now) > LONGEST_WAIT
        gives_up |= self.waited[rows[shut]] > LONGEST_WAIT
        self._turn_back(rows[shut[gives_up]], now)
        return waits, queues


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


def _second_halves(over: IntArray, first: IntArray) -> BoolArray:
    """(p,) whether points lie on the second half of what a way goes on a roadway."""
    number = np.arange(len(over))
    new = np.r_[True, over[1:] != over[:-1]]
    new[first] = True
    begin = np.maximum.accumulate(np.where(new, number, 0))
    end = np.r_[np.flatnonzero(new)[1:], len(over)][np.cumsum(new) - 1]
    return np.asarray((over > 0) & (2 * number > begin + end))


def _rights(points: FloatArray, first: IntArray, last: IntArray) -> FloatArray:
    """(p, 2) unit vectors to the right of the way at its points."""
    number = np.arange(len(points))
    low, high = number - 1, number + 1
    low[first], high[last] = first, last
    ahead = points[high] - points[low]
    ahead = ahead / np.maximum(np.hypot(*ahead.T), 1e-9)[:, None]
    return np.column_stack([ahead[:, 1], -ahead[:, 0]])
