"""Signals: what traffic lights show over time to those who come to a junction."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cityx.ids import hash_ids

STATES = ("off", "red", "red_yellow", "yellow", "green", "green_yielding")
STATE = {name: number for number, name in enumerate(STATES)}
GO = ("green", "green_yielding")


@dataclass(frozen=True)
class Signals:
    """h signal heads; each repeats its sequence of states.

    A head is what rules one way over a junction: from a lane into another, or over a crossing.

    Attributes
    ----------
    head_id
        (h,) uint64, stable, ascending.
    lane, onto
        (h,) uint64, the lane it rules and the one it lets it into, by `LaneGraph.lane_id`; 0 for
        people.
    crossing
        (h,) uint64, the crossing it rules as `crossing_ids` has it, 0 for vehicles.
    position
        (h, 3) float64, metres: the middle of the line one halts before; of crossings their middle.
    heading
        (h,) float64, radians counter-clockwise from east, of who arrives there.
    cycle
        (h,) float64, seconds after which it begins anew.
    change_start
        (h + 1,) int64 into the changes.
    time
        (c,) float64, seconds since the tracks begin, ascending from 0 within a head.
    state
        (c,) uint8 into `STATES`, from then on.
    """

    head_id: NDArray[np.uint64]
    lane: NDArray[np.uint64]
    onto: NDArray[np.uint64]
    crossing: NDArray[np.uint64]
    position: NDArray[np.float64]
    heading: NDArray[np.float64]
    cycle: NDArray[np.float64]
    change_start: NDArray[np.int64]
    time: NDArray[np.float64]
    state: NDArray[np.uint8]

    @property
    def count(self) -> int:
        """Number of heads."""
        return len(self.head_id)

    @property
    def head(self) -> NDArray[np.int64]:
        """(c,) row of the head of each change."""
        return np.repeat(np.arange(self.count), np.diff(self.change_start))


def crossing_ids(edge_id: ArrayLike, end: ArrayLike) -> NDArray[np.uint64]:
    """Return the ids of crossings near the starts (0) or ends (1) of edges of the network."""
    return hash_ids(0, "crossing", edge_id, end)


def states_at(signals: Signals, moment: float) -> NDArray[np.uint8]:
    """Return (h,) what heads show at a moment, seconds since the tracks begin."""
    within = np.mod(moment, signals.cycle)
    shown = signals.time <= within[signals.head] + 1e-9
    count = np.bincount(signals.head[shown], minlength=signals.count)
    return np.asarray(signals.state[signals.change_start[:-1] + count - 1])
