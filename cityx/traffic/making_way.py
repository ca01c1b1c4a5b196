"""Collision avoidance: a vehicle that would touch another is moved back or on along its path.

SUMO separates vehicles by lanes; seen from above, bodies that turn sweep over
corners that belong to others. So one of two that would touch is where it would have been a moment
earlier or later, as if its driver had seen the other; its way stays the same. Where that does not
help, as beside who stands half way into another lane, it keeps a little aside, or those behind it
hold back with it.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from cityx.city.moments import Moments
from cityx.geometry.arrays import BoolArray, FloatArray, IntArray

INTO = 0.01  # metres that bodies may reach into each other
STOREY = 2.0  # metres of height apart from which nobody meets
# Metres by which one holds back or, where it is negative, gets on; the least that helps is taken.
OFFSETS = (
    0.15,
    -0.15,
    0.3,
    -0.3,
    0.6,
    -0.6,
    1.0,
    -1.0,
    1.5,
    -1.5,
    2.5,
    -2.5,
    4.0,
    -4.0,
    6.0,
    8.0,
    12.0,
)
ASIDE = (
    0.1,
    -0.1,
    0.2,
    -0.2,
    0.35,
    -0.35,
    0.5,
    -0.5,
    0.75,
    -0.75,
)  # metres that one keeps to the left of its way then
# Metres over which one falls back, and over which it catches up, for each metre; the longer first.
EASING = (10.0, 10.0), (3.0, 3.0)
BRAKING = 1.5, 3.0  # the same of who does not make way for one alone
LEAST = 6.0  # metres over which one falls back at least
ROUNDS = 6  # in which whoever touches then makes way as well
HELD_UP = (1.0, 2.5, 4.0, 6.0, 8.0, 12.0)  # metres that one holds back, and who follows it
FILE = 3  # so many of them, one behind the other
PERSON = 0.17  # metres from the middle of somebody on foot that vehicles never reach


@dataclass(frozen=True)
class Bodies:
    """Where bodies are in every step, p rows ordered by mover and time.

    Attributes
    ----------
    mover
        (p,) int64, ascending.
    step
        (p,) int64, number of the step, ascending within a mover.
    position
        (p, 3) float64, metres, middles.
    heading
        (p,) float64, radians counter-clockwise from east.
    half
        (p, 2) float64, metres, half of length and width.
    """

    mover: IntArray
    step: IntArray
    position: FloatArray
    heading: FloatArray
    half: FloatArray

    @property
    def boxes(self) -> FloatArray:
        """(p, 7) of what kernels need: x, y, east, north, half length, half width, height."""
        return np.column_stack([
            self.position[:, :2], np.cos(self.heading), np.sin(self.heading), self.half,
            self.position[:, 2],
        ])  # fmt: skip


def standing_by(found: Moments, size: NDArray[np.float32], on_foot: BoolArray) -> Bodies:
    """Return movers that make no way for anybody, at steps of their own numbers.

    Parameters
    ----------
    found
        Where they are.
    size
        (n, 3) metres, of the movers of their tracks.
    on_foot
        (n,) of them as well.
    """
    half = size[:, :2].astype(float) / 2
    half[on_foot] = PERSON
    return Bodies(found.mover, found.number, found.position, found.heading, half[found.mover])


def made_way(
    bodies: Bodies, begin: int, others: Bodies | None = None
) -> tuple[FloatArray, FloatArray]:  # fmt: skip
    """Make vehicles that would touch give way to each other, and to others.

    Parameters
    ----------
    bodies
        Who makes way.
    begin
        The step from which on it is looked whether they touch.
    others
        Who makes no way, at the same steps; None for nobody.

    Returns
    -------
    at
        (p,) float64, the row of each mover's own, between which it may lie, where it is in that
        step. Rows in ascending order where nobody touches.
    aside
        (p,) float64, metres to the left of that place.
    """
    at = np.arange(len(bodies.mover), dtype=float)
    if not len(at):
        return at, np.zeros(0)
    scene = _Scene(bodies, begin, others)
    for _ in range(ROUNDS):
        meetings = scene.meetings()
        if not sum(scene.make_way(*meeting) for meeting in meetings):
            break
    return scene.at, scene.aside


def interpolated(values: FloatArray, at: FloatArray) -> FloatArray:
    """Return (p, ...) values at rows between which places may lie."""
    low = np.floor(at).astype(np.int64)
    share = (at - low).reshape(-1, *(1,) * (values.ndim - 1))
    high = np.minimum(low + 1, len(values) - 1)
    return np.asarray(values[low] + share * (values[high] - values[low]))


def beside(position: FloatArray, heading: FloatArray, aside: FloatArray) -> FloatArray:
    """Return (p, 2 or 3) places so many metres to the left of others, seen along headings."""
    moved = position.copy()
    moved[:, :2] += aside[:, None] * np.column_stack([-np.sin(heading), np.cos(heading)])
    return moved


class _Scene:
    """Bodies while they make way; a class since it knows where each of them has come to."""

    def __init__(self, bodies: Bodies, begin: int, others: Bodies | None) -> None:
        self.bodies, self.begin, self.count = bodies, begin, len(bodies.mover)
        self.before: list[tuple[IntArray, FloatArray, FloatArray, FloatArray]] = []  # to undo
        self.heading = _unwound(bodies.heading, bodies.mover)
        self.at, self.aside = np.arange(self.count, dtype=float), np.zeros(self.count)
        self.start = np.searchsorted(bodies.mover, np.arange(int(bodies.mover[-1]) + 2))
        self.boxes, self.step, self.mover = bodies.boxes, bodies.step, bodies.mover
        if others is not None and len(others.mover):
            self.boxes = np.concatenate([self.boxes, others.boxes])
            self.step = np.concatenate([self.step, others.step])
            self.mover = np.concatenate([self.mover, others.mover + int(bodies.mover[-1]) + 1])
        self.order = np.argsort(self.step, kind="stable")
        self.by_step = np.searchsorted(self.step[self.order], np.arange(self.step.max() + 2))

    def _pairs(self, begin: int, end: int | None = None) -> tuple[IntArray, IntArray]:
        """Return rows, the lower and the higher, of bodies that touch in some steps."""
        from cityx.traffic.touching import touching

        first, second = touching(self.boxes, self.order, self.by_step[begin:end], INTO, STOREY)
        return np.minimum(first, second), np.maximum(first, second)

    def meetings(self) -> list[tuple[int, int, int, int]]:
        """Return who touches whom, and the first and the last row of the one while it does."""
        one, other = self._pairs(self.begin)
        one, other = one[one < self.count], other[one < self.count]
        pairs: dict[tuple[int, int], list[tuple[int, int]]] = {}
        for a, b in zip(one.tolist(), other.tolist(), strict=True):
            pairs.setdefault((int(self.mover[a]), int(self.mover[b])), []).append((a, b))
        found = []
        for _, rows in sorted(pairs.items()):
            steps = self.step[[row for row, _ in rows]]
            last = int(np.flatnonzero(np.diff(np.sort(steps), append=steps.max() + 99) > 20)[0])
            rows = sorted(rows, key=lambda pair: int(self.step[pair[0]]))
            found.append((*rows[0], *rows[last]))
        return found

    def make_way(self, one: int, other: int, one_last: int, other_last: int) -> bool:
        """Move one of two touching vehicles back, on or aside by the least that helps.

        Where neither helps it holds back together with those behind it.
        """
        both = (one, one_last, other), (other, other_last, one)
        sides = [side for side in both if side[0] < self.count]
        spans = [(first, last) for first, last, _ in sides]
        self.before.clear()
        return (
            self._makes_way(spans)
            or any(self._keeps_aside(first, last, offset)
                   for offset in ASIDE for first, last in spans)
            or any(self._holds_up(first, last, int(self.mover[meets]), FILE, 0.0)
                   for first, last, meets in sides)
        )  # fmt: skip

    def _makes_way(self, spans: list[tuple[int, int]]) -> bool:
        return any(self._try(first, last, offset, easing)
                   for offset in OFFSETS for easing in EASING for first, last in spans)  # fmt: skip

    def _holds_up(self, first: int, last: int, meets: int, behind: int, least: float) -> bool:
        """Hold back a body for another that it meets, and those behind it as well."""
        for offset in HELD_UP:
            place = self._offset(first, last, offset, BRAKING) if offset >= least else None
            if place is None:
                continue
            known = len(self.before)
            self._place(*place)
            rows = place[0][self.step[place[0]] >= self.begin]
            if self._is_let_by(rows, meets, behind, offset):
                return True
            while len(self.before) > known:
                self._put_back(*self.before.pop())
        return False

    def _is_let_by(self, rows: IntArray, meets: int, behind: int, least: float) -> bool:
        """Let those whom a body touches in some rows make way, but not whom it makes way for."""
        if not len(rows):
            return True
        own = int(self.mover[rows[0]])
        touched = self._touched(rows)
        if any(first >= self.count or self.mover[first] == meets for first, _ in touched):
            return False
        return all(
            self._makes_way([span])
            or (behind > 0 and self._holds_up(*span, own, behind - 1, least))
            for span in touched
        ) and not self._touched(rows)  # fmt: skip

    def _touched(self, rows: IntArray) -> list[tuple[int, int]]:
        """Return the first and the last row of each whom a body touches in some of its rows."""
        one, other = self._pairs(int(self.step[rows[0]]), int(self.step[rows[-1]]) + 2)
        own = self.mover[rows[0]]
        found = np.concatenate([other[self.mover[one] == own], one[self.mover[other] == own]])
        mover = self.mover[found]
        return [(int(found[mover == each].min()), int(found[mover == each].max()))
                for each in np.unique(mover).tolist()]  # fmt: skip

    def _eased(
        self, first: int, last: int, easing: float, after: float
    ) -> tuple[IntArray, FloatArray, FloatArray] | None:
        """Rows of a mover, the way it has gone, and how far it makes way; None where it cannot."""
        mover = int(self.mover[first])
        rows = np.arange(self.start[mover], self.start[mover + 1])
        gone = np.r_[0.0, np.cumsum(np.hypot(*np.diff(self.boxes[rows, :2], axis=0).T))]
        begin, end = gone[first - rows[0]], gone[last - rows[0]]
        if easing > begin:
            return None
        share = np.interp(gone, [begin - easing, begin, end, end + after], [0.0, 1.0, 1.0, 0.0])
        return rows, gone, share

    def _keeps_aside(self, first: int, last: int, offset: float) -> bool:
        eased = self._eased(first, last, LEAST, LEAST)
        if eased is None:
            return False
        rows, _, share = eased
        moved = rows[share > 0.0]
        aside = self.aside[moved] + offset * share[share > 0.0]
        return self._taken(moved, self.at[moved], aside, first, last)

    def _offset(
        self, first: int, last: int, offset: float, each: tuple[float, float]
    ) -> tuple[IntArray, FloatArray, FloatArray] | None:
        """Rows of a body that holds back, where it is then and how far aside, if it can."""
        easing, after = (max(metres * abs(offset), LEAST) for metres in each)
        eased = self._eased(first, last, easing, after)
        if eased is None:
            return None
        rows, gone, share = eased
        wanted = gone - offset * share
        moved = np.flatnonzero(share > 0.0)
        # Where one stands many rows are one place: the row is found by the way that is gone.
        ahead, keep = np.unique(gone, return_index=True)
        if wanted[moved].min() < 0.0 or wanted[moved].max() > ahead[-1]:
            return None
        at = np.interp(wanted[moved], ahead, self.at[rows][keep])
        return rows[moved], at, self.aside[rows[moved]]

    def _try(self, first: int, last: int, offset: float, each: tuple[float, float]) -> bool:
        place = self._offset(first, last, offset, each)
        return place is not None and self._taken(*place, first, last)

    def _taken(
        self, rows: IntArray, at: FloatArray, aside: FloatArray, first: int, last: int
    ) -> bool:
        """Move a body in some steps, if it touches nobody then in those from `first` to `last`."""
        before = self._touches(rows, self.boxes[rows])
        boxes = self._boxes(at, aside, rows)
        after = self._touches(rows, boxes)
        span = np.isin(rows, np.arange(first, last + 1))
        if after[span].any() or after.sum() > max(before.sum() - span.sum(), 0):
            return False
        self._place(rows, at, aside)
        return True

    def _place(self, rows: IntArray, at: FloatArray, aside: FloatArray) -> None:
        self.before.append((rows, self.at[rows], self.aside[rows], self.boxes[rows]))
        self._put_back(rows, at, aside, self._boxes(at, aside, rows))

    def _put_back(
        self, rows: IntArray, at: FloatArray, aside: FloatArray, boxes: FloatArray
    ) -> None:
        self.at[rows], self.aside[rows], self.boxes[rows] = at, aside, boxes

    def _boxes(self, at: FloatArray, aside: FloatArray, rows: IntArray) -> FloatArray:
        """(k, 7) bodies at rows between which places may lie, and aside of them."""
        heading = interpolated(self.heading, at)
        place = beside(interpolated(self.bodies.position, at), heading, aside)
        return np.column_stack([place[:, :2], np.cos(heading), np.sin(heading),
                                self.bodies.half[rows], place[:, 2]])  # fmt: skip

    def _touches(self, rows: IntArray, boxes: FloatArray) -> BoolArray:
        """(k,) whether a body at some rows would touch anybody."""
        from cityx.traffic.touching import touches

        return np.asarray(touches(boxes, rows, self.step, self.mover, self.boxes, self.order,
                                  self.by_step, INTO, STOREY))  # fmt: skip


def _unwound(heading: FloatArray, mover: IntArray) -> FloatArray:
    """Unwrap headings beyond a full turn, for each mover."""
    first = np.r_[0, np.flatnonzero(np.diff(mover)) + 1, len(mover)]
    parts = [np.unwrap(heading[a:b]) for a, b in pairwise(first.tolist())]
    return np.concatenate(parts)
