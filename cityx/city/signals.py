"""Signals: what traffic lights show over time to those who come to a junction."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import ArrayLike, NDArray

from cityx.city.scene import Instances, Prototype
from cityx.geometry.arrays import FloatArray, IntArray
from cityx.ids import hash_ids

STATES = ("off", "red", "red_yellow", "yellow", "green", "green_yielding")
STATE = {name: number for number, name in enumerate(STATES)}
GO = ("green", "green_yielding")

# A pole stands before the line one halts at, or as a second one beyond the junction.
BEHIND_LINE, BEYOND = 6.0, 45.0  # metres along the way of travel
ASIDE = 20.0  # metres across it
SAME_WAY = 0.8  # cosine between who arrives and whom the lights face
SLIDE = 0.5  # of a metre across, that a metre along counts
TOGETHER = 3.0  # metres by which lanes beside each other differ
CROSSING = 10.0  # metres from the middle of a crossing to where a pole takes it to be
POLES = "traffic_signal"  # how the names of poles with lights begin
ACROSS = 4.0  # metres from a pole over the lanes beside it, where a crossing may be
# What is shown, from little to much; the most that any lane of the arm is let counts.
RANK = ("off", "red", "red_yellow", "yellow", "green_yielding", "green")


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


def vehicle_heads(
    xy: FloatArray, facing: FloatArray, signals: Signals
) -> tuple[IntArray, IntArray]:
    """Return which heads each pole shows to vehicles.

    Parameters
    ----------
    xy
        (n, 2) metres, feet of the poles.
    facing
        (n, 2) unit vectors, where their lights look.
    signals
        The heads of the city.

    Returns
    -------
    pole, head
        (p,) rows of poles and of heads; a pole shows the most that any of its heads lets.
    """
    of = np.flatnonzero(signals.crossing == 0)
    pole, head = _pairs(xy, signals.position[of, :2], BEYOND + ASIDE)
    heading = signals.heading[of][head]
    way = np.column_stack([np.cos(heading), np.sin(heading)])
    offset = xy[pole] - signals.position[of, :2][head]
    along = (offset * way).sum(axis=1)
    across = np.abs(offset[:, 0] * way[:, 1] - offset[:, 1] * way[:, 0])
    fits = (facing[pole] * way).sum(axis=1) < -SAME_WAY
    fits &= (along > -BEHIND_LINE) & (along < BEYOND) & (across < ASIDE)
    pole, head, cost = pole[fits], head[fits], (SLIDE * np.abs(along) + across)[fits]
    least = np.full(len(xy), np.inf)
    np.minimum.at(least, pole, cost)
    near = cost <= least[pole] + TOGETHER
    return pole[near], of[head[near]]


def vehicles_see(xy: FloatArray, facing: FloatArray, signals: Signals, moment: float) -> IntArray:
    """Return what poles show to vehicles.

    Parameters
    ----------
    xy, facing, signals
        As of `vehicle_heads`.
    moment
        Seconds since the tracks begin.

    Returns
    -------
    shown
        (n,) number into `cityx.city.signals.STATES`; -1 where no head is near.
    """
    pole, head = vehicle_heads(xy, facing, signals)
    rank = np.array([RANK.index(name) for name in STATES])[states_at(signals, moment)]
    best = np.full(len(xy), -1)
    np.maximum.at(best, pole, rank[head])
    return np.where(best >= 0, np.array([STATE[name] for name in RANK])[best], -1)


def people_heads(xy: FloatArray, signals: Signals) -> tuple[IntArray, IntArray]:
    """(p,) rows of places with a crossing near them, and of the head that rules the nearest."""
    of = np.flatnonzero(signals.crossing != 0)
    middle = signals.position[of, :2]
    pole, head = _pairs(xy, middle, CROSSING)
    away = np.hypot(*(xy[pole] - middle[head]).T)
    order = np.lexsort((head, away, pole))
    first = order[np.flatnonzero(np.diff(pole[order], prepend=-1))]
    return pole[first], of[head[first]]


def people_see(xy: FloatArray, signals: Signals, moment: float) -> IntArray:
    """(n,) 1 where people may walk over the crossing nearest to a place, 0 where not, else -1."""
    place, head = people_heads(xy, signals)
    go = np.isin(states_at(signals, moment), [STATE[name] for name in GO])
    found = np.full(len(xy), -1)
    found[place] = go[head]
    return found


def poles_of(rows: Instances, prototypes: Sequence[Prototype]) -> IntArray:
    """Return which rows of a layer are poles with lights."""
    named = np.array([each.name.startswith(POLES) for each in prototypes], bool)
    return np.flatnonzero(named[rows.prototype]) if rows.count else np.zeros(0, np.int64)


def sides_of(rows: Instances, poles: IntArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return where poles stand and look.

    Returns
    -------
    foot, facing, over
        (p, 2) metres; unit vectors of where their lights look, along -y of the pole; and metres,
        the places of the crossings that walkers see them from.
    """
    foot, yaw = rows.position[poles, :2].astype(float), rows.rotation[poles, 2].astype(float)
    facing = np.column_stack([np.sin(yaw), -np.cos(yaw)])
    over = foot + ACROSS * np.column_stack([np.cos(yaw), np.sin(yaw)])
    return foot, facing, over


def _pairs(xy: FloatArray, places: FloatArray, reach: float) -> tuple[IntArray, IntArray]:
    """(p,) rows of points and of places within reach of each other."""
    tree = shapely.STRtree(shapely.points(places))
    pole, head = tree.query(shapely.points(xy), predicate="dwithin", distance=reach)
    return pole.astype(np.int64), head.astype(np.int64)
