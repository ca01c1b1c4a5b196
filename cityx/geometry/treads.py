"""Treads: flights of stairs along lines that climb."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cityx.geometry.polylines import Polylines, arc_lengths

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]

RISE = 0.16  # metres of a step outdoors; BS 8300 and DIN 18065 have 0.15 to 0.17
GOING = 0.32  # metres of a tread where the slope leaves the choice: 2 rises and a going are 0.64
FLIGHT = 16  # steps between landings, DIN 18065 has 18 at most
LEAST = 0.3  # metres of climb; less is a ramp


@dataclass(frozen=True)
class Treads:
    """Treads of stairs, t of them, in the order in which one climbs each of c climbs.

    Attributes
    ----------
    climbs
        The lines of the climbs, upwards.
    climb
        (t,) int64, the climb of each tread.
    begin, end
        (t,) float64, metres along the climb from the riser to the next one.
    top
        (t,) float64, height of the tread, metres.
    """

    climbs: Polylines
    climb: IntArray
    begin: FloatArray
    end: FloatArray
    top: FloatArray


def climbs_of(lines: Polylines, z: FloatArray) -> tuple[Polylines, FloatArray, IntArray]:
    """Cut lines where they turn from up to down, and turn all pieces upwards.

    Returns
    -------
    climbs, z, line
        The pieces that climb at least `LEAST`, heights at their points, the line of each.
    """
    owner, z = lines.line_of_point(), np.round(z, 3)
    first = np.flatnonzero(owner[1:] == owner[:-1])
    slope = np.sign(z[first + 1] - z[first])
    steep = np.flatnonzero(slope)
    first, slope = first[steep], slope[steep]
    turns = (owner[first][1:] != owner[first][:-1]) | (slope[1:] != slope[:-1])
    starts, ends = (np.ones(len(first), bool) for _ in range(2))
    starts[1:] = ends[:-1] = turns
    begin, end = first[starts], first[ends] + 1
    high = np.abs(z[end] - z[begin]) >= LEAST
    begin, end, up = begin[high], end[high], slope[starts][high] > 0
    size = end - begin + 1
    start = np.concatenate([[0], np.cumsum(size)]).astype(np.int64)
    rank = np.arange(int(start[-1])) - np.repeat(start[:-1], size)
    row = np.where(np.repeat(up, size), np.repeat(begin, size) + rank, np.repeat(end, size) - rank)
    return Polylines(lines.points[row], start), z[row], owner[begin]


def treads_of(climbs: Polylines, z: FloatArray) -> Treads:
    """Divide climbs into equal steps, with a landing after each flight where there is room.

    Parameters
    ----------
    climbs, z
        Lines that climb, and the (p,) heights of their points, never falling; see `climbs_of`.

    Returns
    -------
    treads
        They lie on the slope or above it.
    """
    along, length = arc_lengths(climbs)
    low = z[climbs.start[:-1]]
    rise = z[climbs.start[1:] - 1] - low
    count = np.maximum(np.rint(rise / RISE), 1).astype(np.int64)
    first = np.concatenate([[0], np.cumsum(count)])
    climb = np.repeat(np.arange(climbs.count), count)
    number = np.arange(len(climb)) - first[climb]
    step = (rise / count)[climb]
    riser = _where_at(climbs, z, along, climb, low[climb] + number * step)
    # A flight keeps together at its foot; what is left of its length is the landing.
    flight = first[climb] + number // FLIGHT * FLIGHT
    after = np.minimum(flight + FLIGHT, first[climb + 1])
    last = after == first[climb + 1]
    beyond = np.where(last, length[climb], riser[np.minimum(after, len(riser) - 1)])
    going = np.minimum((beyond - riser[flight]) / (after - flight), GOING)
    begin = riser[flight] + (np.arange(len(climb)) - flight) * going
    ends = np.r_[climb[1:] != climb[:-1], True] if len(climb) else np.zeros(0, bool)
    end = np.where(ends, length[climb], np.r_[begin[1:], 0.0])
    return Treads(climbs, climb, begin, end, low[climb] + (number + 1) * step)


def _where_at(
    climbs: Polylines, z: FloatArray, along: FloatArray, climb: IntArray, height: FloatArray
) -> FloatArray:
    """(k,) metres along climbs at which they reach heights."""
    # One sorted key over all climbs: heights of each are moved above those of the one before.
    low, high = z[climbs.start[:-1]], z[climbs.start[1:] - 1]
    shift = np.concatenate([[0.0], np.cumsum(high - low + 1.0)])[:-1] - low
    owner = climbs.line_of_point()
    key = z + shift[owner]
    wanted = height + shift[climb]
    after = np.clip(np.searchsorted(key, wanted, side="right"), climbs.start[climb] + 1,
                    climbs.start[climb + 1] - 1)  # fmt: skip
    gap = key[after] - key[after - 1]
    share = np.clip((wanted - key[after - 1]) / np.where(gap > 0, gap, 1.0), 0.0, 1.0)
    return np.asarray(along[after - 1] + share * (along[after] - along[after - 1]))
