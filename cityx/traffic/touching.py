"""Collisions of bodies, step by step, compiled by numba. Import it lazily.

A body is (x, y, east, north, half length, half width, height) of its middle and its direction.
"""

from __future__ import annotations

from math import hypot
from typing import Any

import numpy as np

from cityx.geometry.compiled import compiled


@compiled
def apart(one: Any, other: Any, into: float, storey: float) -> bool:
    """Return whether two bodies overlap by no more than `into` metres."""
    dx, dy = other[0] - one[0], other[1] - one[1]
    if abs(other[6] - one[6]) >= storey:
        return True
    far = hypot(dx, dy)
    if far >= hypot(one[4], one[5]) + hypot(other[4], other[5]):
        return True
    c = abs(one[2] * other[2] + one[3] * other[3])
    s = abs(one[2] * other[3] - one[3] * other[2])
    for first, second in ((one, other), (other, one)):
        along = abs(dx * first[2] + dy * first[3])
        if along > first[4] + second[4] * c + second[5] * s - into:
            return True
        across = abs(dy * first[2] - dx * first[3])
        if across > first[5] + second[4] * s + second[5] * c - into:
            return True
    return False


@compiled
def touching(boxes: Any, order: Any, start: Any, into: float, storey: float) -> Any:
    """Find all pairs of bodies that touch.

    Parameters
    ----------
    boxes
        (p, 7) bodies.
    order, start
        (p,) rows ordered by step, and (s + 1,) where each step begins among them.
    into, storey
        Metres that two may reach into each other, and of height apart from which none meet.

    Returns
    -------
    first, second
        (k,) int64 rows.
    """
    first, second = [0], [0]
    first.pop()
    second.pop()
    for step in range(len(start) - 1):
        rows = order[start[step] : start[step + 1]]
        if len(rows) < 2:
            continue
        by_x = rows[np.argsort(boxes[rows, 0], kind="mergesort")]
        reach = 0.0
        for row in rows:
            reach = max(reach, hypot(boxes[row, 4], boxes[row, 5]))
        for i in range(len(by_x)):
            one = by_x[i]
            limit = boxes[one, 0] + hypot(boxes[one, 4], boxes[one, 5]) + reach
            for j in range(i + 1, len(by_x)):
                other = by_x[j]
                if boxes[other, 0] > limit:
                    break
                if not apart(boxes[one], boxes[other], into, storey):
                    first.append(one)
                    second.append(other)
    return np.array(first, np.int64), np.array(second, np.int64)


@compiled
def touches(
    moved: Any, rows: Any, step: Any, mover: Any, boxes: Any, order: Any, start: Any, into: float,
    storey: float,
) -> Any:  # fmt: skip
    """Return (k,) whether moved bodies, of some rows, touch any of another mover."""
    found = np.zeros(len(rows), np.bool_)
    for k in range(len(rows)):
        own = rows[k]
        for place in range(start[step[own]], start[step[own] + 1]):
            other = order[place]
            if mover[other] != mover[own] and not apart(moved[k], boxes[other], into, storey):
                found[k] = True
                break
    return found
