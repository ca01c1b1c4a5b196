"""Collision avoidance of characters: choose start times so that nobody on foot is met on a course.

Who is where on a course at what time follows from the moment at which it passes the beginning. So
each place and time at which somebody else is on the course rules out one such moment, and those
that are left are free for all of the way. Nobody changes pace, nor leaves the path.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cityx.city.moments import moments_of
from cityx.city.tracks import Tracks
from cityx.motion.courses import Course

FloatArray = NDArray[np.float64]
BoolArray = NDArray[np.bool_]

STEP = 0.1  # seconds between the moments at which others are looked at
NEAR = 0.1  # metres between the places of the course that are looked at
REACH = 0.55, 0.45  # metres kept to the middle of others; the lesser where else nobody gets through
BIN = 0.05  # seconds between the moments of setting out that are told apart
LONGEST = 15.0  # seconds by which somebody sets out sooner or later than was meant
STOREY = 2.0  # metres of height apart from which nobody meets


def set_out(
    way: Course, height: FloatArray, moments: FloatArray, wanted: FloatArray, apart: float,
    others: Tracks, seconds: float,
) -> tuple[FloatArray, int]:  # fmt: skip
    """Choose when movers pass the beginning of a course, as near as can be to what is wanted.

    Parameters
    ----------
    way, height
        The course, and (k,) metres at its points.
    moments
        (k,) seconds after its beginning at which who goes there is at its points.
    wanted
        (n,) seconds that each would be on the way when the tracks begin, ascending.
    apart
        Seconds from one to the next.
    others
        Who walks already.
    seconds
        How long the tracks of a closed course are.

    Returns
    -------
    begun, meeting
        (n,) seconds, and how many meet somebody for all that.
    """
    whole = float(moments[-1])
    last = seconds if way.closed else whole
    near = [_blocked(way, height, moments, others, last, reach) for reach in REACH]
    chosen: list[float] = []
    meeting = 0
    for own in wanted.tolist():
        tried = (_nearest_free(blocked, own, chosen, apart, whole, closed=way.closed)
                 for blocked in (*near, np.zeros_like(near[0])))  # fmt: skip
        place, found = next(
            ((at, one) for at, one in enumerate(tried) if one is not None), (len(near), own)
        )
        meeting += place == len(near)
        chosen.append(found)
    return np.array(chosen), meeting


def _blocked(
    way: Course, height: FloatArray, moments: FloatArray, others: Tracks, last: float, reach: float
) -> BoolArray:
    """(b,) whether who sets out so many bins before the tracks begin meets somebody."""
    from scipy.spatial import cKDTree

    whole = float(moments[-1])
    blocked = np.zeros(int(np.ceil(whole / BIN)) + 1, bool)
    along = np.arange(0.0, way.length + NEAR, NEAR)
    spots = np.column_stack([np.interp(along, way.along, column) for column in way.points.T])
    level = np.interp(along, way.along, height)
    passed = np.interp(along, way.along, moments)
    found = moments_of(others, np.arange(0.0, last + STEP, STEP))
    if not len(found.mover):
        return blocked
    pairs = cKDTree(found.position[:, :2]).sparse_distance_matrix(
        cKDTree(spots), reach, output_type="ndarray"
    )  # fmt: skip
    row, place = pairs["i"], pairs["j"]
    same = np.abs(found.position[row, 2] - level[place]) < STOREY
    begun = passed[place[same]] - found.time[row[same]]
    if way.closed:
        begun = np.mod(begun, whole)
    begun = begun[(begun >= 0.0) & (begun <= whole)]
    bins = np.rint(begun / BIN).astype(np.int64)
    blocked[np.minimum(bins, len(blocked) - 1)] = True
    return blocked


def _nearest_free(
    blocked: BoolArray, own: float, chosen: list[float], apart: float, whole: float, *, closed: bool
) -> float | None:
    """Return the free moment next to the one wanted, None without any."""
    free = np.flatnonzero(~blocked) * BIN
    off = np.abs(free - own)
    off = np.minimum(off, whole - off) if closed else off
    order = np.argsort(off, kind="stable")
    for at in order[off[order] <= LONGEST].tolist():
        moment = own if off[at] < BIN / 2 else float(free[at])
        if moment < whole and _kept_apart(moment, chosen, apart, whole, closed=closed):
            return moment
    return None


def _kept_apart(
    moment: float, chosen: list[float], apart: float, whole: float, *, closed: bool
) -> bool:
    gaps = np.abs(np.array(chosen) - moment)
    gaps = np.minimum(gaps, whole - gaps) if closed else gaps
    return bool((gaps >= apart - 1e-9).all())
