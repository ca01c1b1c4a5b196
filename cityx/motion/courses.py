"""Courses: the smooth way of something that goes along a path, and when it is where.

The direction is that of the tangent. Curvature only limits the speed: everywhere else it is the
speed asked for, measured along the arc.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from cityx.geometry.arrays import FloatArray
from cityx.geometry.ranges import numbered

ARC_STEP = np.radians(8.0)  # of turn between two points of a rounded corner
SAME = 1e-6  # metres; nearer points are one


@dataclass(frozen=True)
class Course:
    """A smooth polyline of k points; the last of a closed one is the first again.

    Attributes
    ----------
    points
        (k, 2) float64, metres.
    heading
        (k,) float64, radians counter-clockwise from east, of the tangent; it never jumps by a turn.
    curvature
        (k,) float64, 1/m, not signed.
    along
        (k,) float64, metres from the start.
    closed
        Whether it ends where it began.
    """

    points: FloatArray
    heading: FloatArray
    curvature: FloatArray
    along: FloatArray
    closed: bool

    @property
    def length(self) -> float:
        """Metres."""
        return float(self.along[-1])


def course(points: ArrayLike, *, closed: bool, slack: float, spacing: float) -> Course:
    """Round the corners of a path.

    Parameters
    ----------
    points
        (n, 2) float, metres; of a closed path the first is not repeated.
    closed
        Whether it ends where it began.
    slack
        Metres by which a corner may be cut.
    spacing
        Metres between points on straights, at most.

    Raises
    ------
    ValueError
        If fewer than two points (three of a closed path) differ.
    """
    xy = _distinct(np.asarray(points, float).reshape(-1, 2), closed)
    if len(xy) < 2 + closed:
        raise ValueError("a course needs two points, a closed one three")
    before, after = np.roll(xy, 1, axis=0) - xy, np.roll(xy, -1, axis=0) - xy
    turn = _turns(before, after)
    # Each corner takes at most half of both its sides, so that neighbours do not meet.
    room = np.minimum(np.hypot(*before.T), np.hypot(*after.T)) / 2
    half = np.abs(turn) / 2
    straight = half < 1e-4
    secant = np.where(straight, 1.0, 1 / np.cos(np.minimum(half, 1.55)) - 1)
    radius = np.minimum(slack / secant, room / np.tan(np.where(straight, 1.0, half)))
    if not closed:
        straight[[0, -1]] = True
    rows = [
        _corner(xy[i], before[i], after[i], float(turn[i]), float(radius[i]), bool(straight[i]))
        for i in range(len(xy))
    ]
    line, bend = np.concatenate([r[0] for r in rows]), np.concatenate([r[1] for r in rows])
    if closed:
        line, bend = np.concatenate([line, line[:1]]), np.append(bend, bend[0])
    return _measured(*_divided(line, bend, spacing), closed)


def _distinct(xy: FloatArray, closed: bool) -> FloatArray:
    step = np.hypot(*np.diff(xy, axis=0).T)
    kept = xy[np.concatenate([[True], step > SAME])]
    if closed and len(kept) > 1 and np.hypot(*(kept[0] - kept[-1])) <= SAME:
        kept = kept[:-1]
    return np.asarray(kept)


def _turns(before: FloatArray, after: FloatArray) -> FloatArray:
    """(n,) radians by which a path turns at its points, left positive."""
    cross = -before[:, 0] * after[:, 1] + before[:, 1] * after[:, 0]
    return np.asarray(np.arctan2(cross, -(before * after).sum(axis=1)))


def _corner(
    at: FloatArray, before: FloatArray, after: FloatArray, turn: float, radius: float,
    straight: bool,
) -> tuple[FloatArray, FloatArray]:  # fmt: skip
    """Return the points of the arc at a corner and their curvature."""
    if straight or radius < SAME:
        return at[None], np.zeros(1)
    cut = radius * np.tan(abs(turn) / 2)
    start = at + cut * before / np.hypot(*before)
    end = at + cut * after / np.hypot(*after)
    way = -before / np.hypot(*before)
    inward = np.sign(turn) * np.array([-way[1], way[0]])
    count = max(2, int(np.ceil(abs(turn) / ARC_STEP)) + 1)
    angle = np.linspace(0.0, abs(turn), count)[:, None]
    arc = start + radius * (np.sin(angle) * way + (1 - np.cos(angle)) * inward)
    arc[-1] = end
    return arc, np.full(count, 1 / radius)


def _divided(line: FloatArray, bend: FloatArray, spacing: float) -> tuple[FloatArray, FloatArray]:
    """Drop points that meet and divide what is longer than the spacing."""
    step = np.hypot(*np.diff(line, axis=0).T)
    kept = np.concatenate([[True], step > SAME])
    line, bend = line[kept], bend[kept]
    step = np.hypot(*np.diff(line, axis=0).T)
    parts = np.maximum(1, np.ceil(step / spacing - 1e-9).astype(int))
    row = np.repeat(np.arange(len(step)), parts)
    share = (numbered(parts)) / parts[row]
    found = line[row] + share[:, None] * (line[row + 1] - line[row])
    # Between two points of one arc the way bends as they do, elsewhere it is straight.
    bent = np.where((share == 0) | np.isclose(bend[row], bend[row + 1]), bend[row], 0.0)
    return np.concatenate([found, line[-1:]]), np.append(bent, bend[-1])


def _measured(line: FloatArray, bend: FloatArray, closed: bool) -> Course:
    step = np.diff(line, axis=0)
    way = np.unwrap(np.arctan2(step[:, 1], step[:, 0]))
    middle = (way[1:] + way[:-1]) / 2
    if closed:
        shift = np.remainder(way[0] - way[-1] + np.pi, 2 * np.pi) - np.pi
        ends = way[0] - shift / 2, way[-1] + shift / 2
    else:
        ends = way[0], way[-1]
    heading = np.concatenate([[ends[0]], middle, [ends[1]]])
    along = np.concatenate([[0.0], np.cumsum(np.hypot(*step.T))])
    return Course(line, heading, bend, along, closed)


def paces(way: Course, wanted: float, *, sideways: float, pull: float) -> FloatArray:
    """Return (k,) speeds along a course, metres per second.

    Parameters
    ----------
    way
        The course.
    wanted
        Metres per second asked for.
    sideways
        Metres per second squared that a bend may ask for: it limits the speed there.
    pull
        Metres per second squared of speeding up and slowing down before and after.
    """
    with np.errstate(divide="ignore"):
        limit = np.sqrt(sideways / way.curvature)
    speed = np.minimum(wanted, limit)
    step = np.diff(way.along)
    for _ in range(2 if way.closed else 1):
        for row in range(len(step)):
            speed[row + 1] = min(speed[row + 1], np.sqrt(speed[row] ** 2 + 2 * pull * step[row]))
        for row in reversed(range(len(step))):
            speed[row] = min(speed[row], np.sqrt(speed[row + 1] ** 2 + 2 * pull * step[row]))
        if way.closed:
            speed[[0, -1]] = speed[[0, -1]].min()
    return np.asarray(speed)


def times(way: Course, speed: FloatArray) -> FloatArray:
    """(k,) seconds from the start at which speeds, (k,), bring it to the points of a course."""
    mean = (speed[1:] + speed[:-1]) / 2
    return np.concatenate([[0.0], np.cumsum(np.diff(way.along) / mean)])
