"""How a crowd moves: the collision-free speed model, with steps that are never taken into anybody.

Everybody heads for a place ahead, bends away from neighbours, and goes as fast as the gap ahead
allows. A step that would bring two people nearer than they are wide, or lead where nobody may
stand, is turned aside or not taken, so that who stood apart stays apart.

References
----------
Tordeux, Chraibi and Seyfried, "Collision-free speed model for pedestrian dynamics", 2016.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]

APART = 0.5  # metres between the middles of two people, shoulders and what sways
SQUEEZED = 0.36  # metres, of two who turn their shoulders to get past each other
NOTICE = 3.0  # metres within which people heed each other
GAP = 0.5  # seconds of way that are kept to whoever is ahead
STRENGTH, RANGE = 2.5, 0.35  # of the bending away from neighbours, and metres over which it falls
ASIDE = 0.5  # of the stepping aside for somebody who comes towards one
CREEP = 0.3  # of the pace at which somebody who is hindered steps aside
# Steps tried, to one's own side first; far aside to that side only, or one would sway on the spot.
TURNS = np.radians([0.0, 20.0, -20.0, 45.0, -45.0, 75.0, 100.0])
SLOWER = np.array([1.0, 0.9, 0.9, 0.7, 0.7, 0.5, 0.35])  # pace of each


@dataclass(frozen=True)
class Crowd:
    """Who walks at one moment, n people.

    Attributes
    ----------
    position, target
        (n, 2) float64, metres: where they are, and a place ahead that they head for.
    pace
        (n,) float64, metres per second they would like to walk, 0 for those who wait.
    side
        (n,) float64, 1 for those who step aside to the right, -1 to the left.
    apart
        (n,) float64, metres that each keeps to the middle of others; the less of two counts.
    """

    position: FloatArray
    target: FloatArray
    pace: FloatArray
    side: FloatArray
    apart: FloatArray


May = Callable[[IntArray, FloatArray], BoolArray]
"""From (k,) people and (k, 2) places to whether each may stand there."""


def stepped(crowd: Crowd, others: FloatArray, seconds: float, may: May) -> FloatArray:
    """Move a crowd by one step.

    Parameters
    ----------
    crowd
        The people.
    others
        (m, 2) metres, people who do not heed this crowd, where they are after the step.
    seconds
        Length of the step; short, so that nobody goes farther than people are wide.
    may
        Where people may be.

    Returns
    -------
    position
        (n, 2). No two people, and nobody and one of the others, have come nearer than what they
        keep apart.
    """
    count = len(crowd.position)
    if not count:
        return crowd.position.copy()
    everyone = np.concatenate([crowd.position, others])
    one, other = _pairs(everyone, count)
    kept = np.concatenate([crowd.apart, np.full(len(others), APART)])
    kept = np.minimum(kept[one], kept[other])
    ahead = _heading(crowd, everyone, one, other)
    pace = _paces(crowd, everyone, ahead, one, other, kept)
    steps = np.stack([pace, np.maximum(pace, CREEP * crowd.pace)]) * seconds
    return _taken(crowd, everyone, ahead, steps, may, one, other, kept)


def _pairs(everyone: FloatArray, count: int) -> tuple[IntArray, IntArray]:
    """Ordered pairs of a person of the crowd and somebody near."""
    from scipy.spatial import cKDTree

    near = cKDTree(everyone).query_pairs(NOTICE, output_type="ndarray")
    one = np.concatenate([near[:, 0], near[:, 1]])
    other = np.concatenate([near[:, 1], near[:, 0]])
    order = np.lexsort((other, one))
    mine = order[one[order] < count]
    return one[mine], other[mine]


def _heading(crowd: Crowd, everyone: FloatArray, one: IntArray, other: IntArray) -> FloatArray:
    """(n, 2) unit vectors of where people go, bent away from those near."""
    wish = _unit(crowd.target - crowd.position)
    away = crowd.position[one] - everyone[other]
    far = np.maximum(np.hypot(*away.T), 1e-6)
    push = STRENGTH * np.exp((APART - far) / RANGE)
    bent = wish.copy()
    np.add.at(bent, one, push[:, None] * away / far[:, None])
    # Somebody straight ahead who comes nearer is passed on one's own side.
    ahead = -(away * wish[one]).sum(axis=1)
    facing = np.zeros(len(one))
    inner = other < len(wish)
    facing[inner] = -(wish[one[inner]] * wish[other[inner]]).sum(axis=1)
    meeting = (ahead > 0) & (ahead > 0.8 * far) & (facing > 0.3)
    right = np.column_stack([wish[:, 1], -wish[:, 0]]) * crowd.side[:, None]
    near = ASIDE * (1.0 - far / NOTICE) * meeting
    np.add.at(bent, one, near[:, None] * right[one])
    return _unit(bent)


def _paces(
    crowd: Crowd, everyone: FloatArray, ahead: FloatArray, one: IntArray, other: IntArray,
    kept: FloatArray,
) -> FloatArray:  # fmt: skip
    """(n,) metres per second that the gap ahead allows."""
    gap = everyone[other] - crowd.position[one]
    along = (gap * ahead[one]).sum(axis=1)
    across = np.abs(gap[:, 0] * ahead[one, 1] - gap[:, 1] * ahead[one, 0])
    blocks = (along > 0) & (across < kept)
    room = np.full(len(crowd.position), np.inf)
    np.minimum.at(room, one[blocks], (np.hypot(*gap.T) - kept)[blocks])
    return np.minimum(crowd.pace, np.maximum(room, 0.0) / GAP)


def _taken(
    crowd: Crowd, everyone: FloatArray, ahead: FloatArray, steps: FloatArray, may: May,
    one: IntArray, other: IntArray, kept: FloatArray,
) -> FloatArray:  # fmt: skip
    """Take steps that lead into nobody, each the first of some turns that may be taken.

    `steps` holds (2, n) metres, of a step straight ahead and of one aside.
    """
    here = crowd.position
    chosen = here.copy()
    open_ = steps[1] > 1e-6
    for turn, share in zip(TURNS, SLOWER, strict=True):
        rows = np.flatnonzero(open_)
        if not len(rows):
            break
        size = steps[int(turn != 0), rows] * share
        angle = turn * -crowd.side[rows]
        c, s = np.cos(angle), np.sin(angle)
        x, y = ahead[rows].T
        spot = here[rows] + size[:, None] * np.column_stack([c * x - s * y, s * x + c * y])
        fits = (size > 1e-6) & may(rows, spot)
        place = np.full(len(here), -1)
        place[rows] = np.arange(len(rows))
        pair = np.flatnonzero(place[one] >= 0)
        gap = np.hypot(*(spot[place[one[pair]]] - everyone[other[pair]]).T)
        was = np.hypot(*(here[one[pair]] - everyone[other[pair]]).T)
        hits = (gap < kept[pair]) & (gap < was)
        fits[place[one[pair[hits]]]] = False
        chosen[rows[fits]] = spot[fits]
        open_[rows[fits]] = False
    return _apart(here, chosen, everyone[len(here) :], one, other, kept)


def _apart(
    here: FloatArray, there: FloatArray, others: FloatArray, one: IntArray, other: IntArray,
    kept: FloatArray,
) -> FloatArray:  # fmt: skip
    """Take back steps of pairs that would meet, until none would; where all stood, none did."""
    there = there.copy()
    before = np.concatenate([here, others])
    was = np.hypot(*(here[one] - before[other]).T)
    while True:
        now = np.concatenate([there, others])
        gap = np.hypot(*(there[one] - now[other]).T)
        bad = (gap < kept) & (gap < was - 1e-12)
        moved = (there != here).any(axis=1)
        rows = np.unique(np.concatenate([one[bad], other[bad]]))
        rows = rows[rows < len(here)]
        rows = rows[moved[rows]]
        if not len(rows):
            return there
        there[rows] = here[rows]


def _unit(vectors: FloatArray) -> FloatArray:
    return np.asarray(vectors / np.maximum(np.hypot(*vectors.T), 1e-9)[:, None])
