"""Signal poles at the kerb: the signal heads of each, and what its lights show at a moment."""

from __future__ import annotations

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.city.signals import GO, STATE, STATES, Signals, states_at

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

# A pole stands before the line one halts at, or as a second one beyond the junction.
BEHIND_LINE, BEYOND = 6.0, 45.0  # metres along the way of travel
ASIDE = 20.0  # metres across it
SAME_WAY = 0.8  # cosine between who arrives and whom the lights face
SLIDE = 0.5  # of a metre across, that a metre along counts
TOGETHER = 3.0  # metres by which lanes beside each other differ
CROSSING = 10.0  # metres from the middle of a crossing to where a pole takes it to be
# What is shown, from little to much; the most that any lane of the arm is let counts.
RANK = ("off", "red", "red_yellow", "yellow", "green_yielding", "green")


def vehicles_see(xy: FloatArray, facing: FloatArray, signals: Signals, moment: float) -> IntArray:
    """Return what poles show to vehicles.

    Parameters
    ----------
    xy
        (n, 2) metres, feet of the poles.
    facing
        (n, 2) unit vectors, where their lights look.
    signals
        The heads of the city.
    moment
        Seconds since the tracks begin.

    Returns
    -------
    shown
        (n,) number into `cityx.city.signals.STATES`; -1 where no head is near.
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
    rank = np.array([RANK.index(name) for name in STATES])[states_at(signals, moment)[of]]
    near = cost <= least[pole] + TOGETHER
    best = np.full(len(xy), -1)
    np.maximum.at(best, pole[near], rank[head[near]])
    return np.where(best >= 0, np.array([STATE[name] for name in RANK])[best], -1)


def people_see(xy: FloatArray, signals: Signals, moment: float) -> IntArray:
    """(n,) 1 where people may walk over the crossing nearest to a place, 0 where not, else -1."""
    of = np.flatnonzero(signals.crossing != 0)
    middle = signals.position[of, :2]
    pole, head = _pairs(xy, middle, CROSSING)
    away = np.hypot(*(xy[pole] - middle[head]).T)
    order = np.lexsort((head, away, pole))
    first = order[np.flatnonzero(np.diff(pole[order], prepend=-1))]
    go = np.isin(states_at(signals, moment)[of], [STATE[name] for name in GO])
    found = np.full(len(xy), -1)
    found[pole[first]] = go[head[first]]
    return found


def _pairs(xy: FloatArray, places: FloatArray, reach: float) -> tuple[IntArray, IntArray]:
    """(p,) rows of points and of places within reach of each other."""
    tree = shapely.STRtree(shapely.points(places))
    pole, head = tree.query(shapely.points(xy), predicate="dwithin", distance=reach)
    return pole.astype(np.int64), head.astype(np.int64)
