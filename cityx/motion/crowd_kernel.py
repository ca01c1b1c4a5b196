"""Steps of a crowd, compiled by numba; `cityx.motion.crowd` says what they mean.

Import it lazily. Everybody is looked at in turn and every sum runs in that order, so that the same
crowd steps the same way each time.
"""

from __future__ import annotations

from math import cos, exp, floor, hypot, inf, sin
from typing import Any

import numpy as np

from cityx.geometry.compiled import compiled

NOTICE = 3.0  # metres within which people heed each other
GAP = 0.5  # seconds of way that are kept to whoever is ahead
TOUCHING = 0.5  # metres between the middles of two people from which they bend away steeply
STRENGTH, RANGE = 2.5, 0.35  # of the bending away from neighbours, and metres over which it falls
ASIDE = 0.5  # of the stepping aside for somebody who comes towards one
FACING = 0.3  # cosine from which two go against each other
ROOM_FOR = 1.6  # metres within which who stands makes room for who comes towards them
# Steps tried, to one's own side first; far aside to that side only, or one would sway on the spot.
TURNS = np.radians(np.array([0.0, 20.0, -20.0, 45.0, -45.0, 75.0, 100.0]))
SLOWER = np.array([1.0, 0.9, 0.9, 0.7, 0.7, 0.5, 0.35])  # pace of each
LAST = np.radians(np.array([0.0, 35.0, -35.0]))  # turns from where one wants to go, tried last
FLEEING = 2.0  # metres per second, at least, of who is in the way of a vehicle
AWAY = np.radians(np.array([0.0, 30.0, -30.0, 60.0, -60.0, 90.0, -90.0]))  # turns of who flees
AWAY_FROM = 0.3  # cosine to straight away of a step that leads off a rim
NEAR_BOXES = 32  # that one person heeds


@compiled
def neighbours(xy: Any, count: int) -> Any:
    """Find for each of the first people everybody within `NOTICE` metres.

    Parameters
    ----------
    xy
        (n, 2) float64, metres.
    count
        Of those for whom it is asked.

    Returns
    -------
    start, other
        (count + 1,) first neighbour of each, and (k,) rows, ascending.
    """
    n = len(xy)
    west, south, east, north = inf, inf, -inf, -inf
    for i in range(n):
        west, east = min(west, xy[i, 0]), max(east, xy[i, 0])
        south, north = min(south, xy[i, 1]), max(north, xy[i, 1])
    columns = int((east - west) / NOTICE) + 3
    rows = int((north - south) / NOTICE) + 3
    cell = np.empty(n, np.int64)
    first = np.zeros(columns * rows + 1, np.int64)
    for i in range(n):
        across = int((xy[i, 0] - west) / NOTICE) + 1
        cell[i] = (int((xy[i, 1] - south) / NOTICE) + 1) * columns + across
        first[cell[i] + 1] += 1
    for c in range(columns * rows):
        first[c + 1] += first[c]
    used = first[:-1].copy()
    member = np.empty(n, np.int64)
    for i in range(n):
        member[used[cell[i]]] = i
        used[cell[i]] += 1
    start = np.zeros(count + 1, np.int64)
    other = np.empty(16 * count + 64, np.int64)
    found = 0
    for i in range(count):
        begin = found
        for row in range(-1, 2):
            for column in range(-1, 2):
                c = cell[i] + row * columns + column
                for k in range(first[c], first[c + 1]):
                    j = member[k]
                    if j == i or hypot(xy[j, 0] - xy[i, 0], xy[j, 1] - xy[i, 1]) > NOTICE:
                        continue
                    if found == len(other):
                        more = np.empty(2 * found, np.int64)
                        more[:found] = other
                        other = more
                    other[found] = j
                    found += 1
        other[begin:found] = np.sort(other[begin:found])
        start[i + 1] = found
    return start, other[:found]


@compiled
def cell_of(x: float, y: float, west: float, north: float, size: float, shape: Any) -> Any:
    """Return row and column of a place, on the rim where it is beyond."""
    scale = 1.0 / size
    row = min(max(floor((north - y) * scale), 0), shape[0] - 1)
    column = min(max(floor((x - west) * scale), 0), shape[1] - 1)
    return row, column


@compiled
def depth_in(box: Any, x: float, y: float) -> float:
    """Return metres that a place lies within a box (x, y, east, north, half length, half width)."""
    dx, dy = x - box[0], y - box[1]
    along = box[4] - abs(dx * box[2] + dy * box[3])
    across = box[5] - abs(dy * box[2] - dx * box[3])
    return float(min(along, across))


@compiled
def step(
    here: Any, others: Any, target: Any, pace: Any, stride: Any, side: Any, apart: Any,
    keep: float, leave: Any, awaits: Any, free: Any, zone: Any, rim: Any, west: float, north: float,
    size: float, boxes: Any, shut: Any, seconds: float,
) -> Any:  # fmt: skip
    """Return (n, 2) places of a crowd after a step; see `cityx.motion.crowd.stepped`."""
    n = len(here)
    everyone = np.concatenate((here, others))
    start, other = neighbours(everyone, n)
    wish, ahead = np.empty((n, 2)), np.empty((n, 2))
    for i in range(n):
        x, y = target[i, 0] - here[i, 0], target[i, 1] - here[i, 1]
        far = max(hypot(x, y), 1e-9)
        wish[i, 0], wish[i, 1] = x / far, y / far
    heed = np.empty(NEAR_BOXES, np.int64)
    order = np.argsort(boxes[:, 0], kind="mergesort")
    middle = boxes[order, 0]
    widest = 0.0
    for b in range(len(boxes)):
        widest = max(widest, boxes[b, 4] + boxes[b, 5] + 1.0)
    there = here.copy()
    for i in range(n):
        count, worst, deepest = 0, -1, 0.0
        low = np.searchsorted(middle, here[i, 0] - widest)
        high = np.searchsorted(middle, here[i, 0] + widest)
        for q in range(low, high):
            b = order[q]
            reach = boxes[b, 4] + boxes[b, 5] + 1.0
            if abs(boxes[b, 0] - here[i, 0]) < reach and abs(boxes[b, 1] - here[i, 1]) < reach:
                depth = depth_in(boxes[b], here[i, 0], here[i, 1])
                if depth > deepest:
                    worst, deepest = b, depth
                if count < NEAR_BOXES:
                    heed[count] = b
                    count += 1
        straight, aside, flees = 0.0, 0.0, worst >= 0
        if flees:
            _flee(boxes[worst], here[i], ahead[i])
            straight = aside = max(pace[i], FLEEING)
        elif pace[i] > 0.0:
            _bend(i, here, everyone, wish, side, start, other, ahead[i])
            straight = _pace(i, here, everyone, pace, ahead[i], apart, keep, start, other)
            aside = max(straight, stride[i])
        elif stride[i] > 0.0 and _makes_room(i, here, wish, pace, side, start, other, ahead[i]):
            straight = aside = stride[i]
        if aside <= 1e-6:
            continue
        row, column = cell_of(here[i, 0], here[i, 1], west, north, size, free.shape)
        own, edge = zone[row, column], rim[row, column] if pace[i] > 0.0 else 0
        for k in range(len(TURNS) + len(LAST)):
            if k < len(TURNS):
                angle = AWAY[k] if flees else -TURNS[k] * side[i]
                long = (straight if k == 0 else aside) * (1.0 if flees else SLOWER[k]) * seconds
                u, v = ahead[i, 0], ahead[i, 1]
            else:  # where the others do not push
                angle, long = -LAST[k - len(TURNS)] * side[i], min(aside, stride[i]) * seconds
                u, v = wish[i, 0], wish[i, 1]
            if long <= 1e-6 or (k >= len(TURNS) and pace[i] <= 0.0):
                continue
            c, s = cos(angle), sin(angle)
            x, y = here[i, 0] + long * (c * u - s * v), here[i, 1] + long * (s * u + c * v)
            row, column = cell_of(x, y, west, north, size, free.shape)
            over = rim[row, column]
            if not free[row, column]:
                continue
            known = over == 0 or over == own or over == leave[i]
            closed = over < len(shut) and shut[over]
            past = zone[row, column] == 0 and (over == edge or (over != awaits[i] and not closed))
            if past and closed:
                past = _leads_off(here[i], x, y, zone, over, west, north, size)
            if not known and (not past or pace[i] <= 0.0):
                continue
            fits = True
            for q in range(count):
                depth = depth_in(boxes[heed[q]], x, y)
                if depth > 0 and depth >= depth_in(boxes[heed[q]], here[i, 0], here[i, 1]):
                    fits = False
                    break
            for q in range(start[i], start[i + 1]):
                if not fits:
                    break
                j = other[q]
                least = min(apart[i], apart[j] if j < n else keep)
                gap = hypot(x - everyone[j, 0], y - everyone[j, 1])
                if gap < least:
                    was = hypot(here[i, 0] - everyone[j, 0], here[i, 1] - everyone[j, 1])
                    fits = gap >= was
            if fits:
                there[i, 0], there[i, 1] = x, y
                break
    _take_back(here, there, everyone, apart, keep, start, other)
    return there


@compiled
def _leads_off(
    here: Any, x: float, y: float, zone: Any, number: int, west: float, north: float, size: float
) -> bool:  # fmt: skip
    """Return whether a step of who is on the rim of a zone leads away from it."""
    row, column = cell_of(here[0], here[1], west, north, size, zone.shape)
    east, up = 0.0, 0.0
    for i in range(max(row - 1, 0), min(row + 2, zone.shape[0])):
        for j in range(max(column - 1, 0), min(column + 2, zone.shape[1])):
            if zone[i, j] == number:
                east += j - column
                up += row - i
    far = hypot(east, up) * hypot(x - here[0], y - here[1])
    return bool((x - here[0]) * east + (y - here[1]) * up <= -AWAY_FROM * far)


@compiled
def _flee(box: Any, here: Any, ahead: Any) -> None:
    """Point out of a box by its nearer side; not by its front, which comes after."""
    across = (here[1] - box[1]) * box[2] - (here[0] - box[0]) * box[3]
    turn = 1.0 if across >= 0 else -1.0
    ahead[0], ahead[1] = -turn * box[3], turn * box[2]


@compiled
def _bend(
    i: int, here: Any, everyone: Any, wish: Any, side: Any, start: Any, other: Any, ahead: Any
) -> None:
    """Point to where one goes, bent away from those near."""
    x, y = wish[i, 0], wish[i, 1]
    for q in range(start[i], start[i + 1]):
        j = other[q]
        dx, dy = here[i, 0] - everyone[j, 0], here[i, 1] - everyone[j, 1]
        far = max(hypot(dx, dy), 1e-6)
        push = STRENGTH * exp((TOUCHING - far) / RANGE) / far
        x += push * dx
        y += push * dy
        # Somebody straight ahead who comes nearer is passed on one's own side.
        before = -(dx * wish[i, 0] + dy * wish[i, 1])
        if j >= len(wish) or before <= 0 or before <= 0.8 * far:
            continue
        if -(wish[i, 0] * wish[j, 0] + wish[i, 1] * wish[j, 1]) > FACING:
            turn = ASIDE * (1.0 - far / NOTICE) * side[i]
            x += turn * wish[i, 1]
            y -= turn * wish[i, 0]
    far = max(hypot(x, y), 1e-9)
    ahead[0], ahead[1] = x / far, y / far


@compiled
def _pace(
    i: int, here: Any, everyone: Any, pace: Any, ahead: Any, apart: Any, keep: float, start: Any,
    other: Any,
) -> float:  # fmt: skip
    """Return the metres per second that the gap ahead allows."""
    room = inf
    for q in range(start[i], start[i + 1]):
        j = other[q]
        dx, dy = everyone[j, 0] - here[i, 0], everyone[j, 1] - here[i, 1]
        least = min(apart[i], apart[j] if j < len(here) else keep)
        if dx * ahead[0] + dy * ahead[1] > 0 and abs(dx * ahead[1] - dy * ahead[0]) < least:
            room = min(room, hypot(dx, dy) - least)
    return float(min(pace[i], max(room, 0.0) / GAP))


@compiled
def _makes_room(
    i: int, here: Any, wish: Any, pace: Any, side: Any, start: Any, other: Any, ahead: Any
) -> bool:
    """Point aside for those who come towards somebody that waits; false if nobody does."""
    x, y = 0.0, 0.0
    for q in range(start[i], start[i + 1]):
        j = other[q]
        if j >= len(here) or pace[j] <= 0.0:
            continue
        dx, dy = here[i, 0] - here[j, 0], here[i, 1] - here[j, 1]
        far = max(hypot(dx, dy), 1e-6)
        facing = -(wish[i, 0] * wish[j, 0] + wish[i, 1] * wish[j, 1])
        if far > ROOM_FOR or facing < FACING or dx * wish[j, 0] + dy * wish[j, 1] < 0.0:
            continue
        left = wish[j, 0] * dy - wish[j, 1] * dx  # metres to the left of the line that they walk
        turn = side[i] if abs(left) < 0.05 else (1.0 if left > 0 else -1.0)
        x += -turn * wish[j, 1] + 0.3 * wish[j, 0]
        y += turn * wish[j, 0] + 0.3 * wish[j, 1]
    far = hypot(x, y)
    if far < 1e-6:
        return False
    ahead[0], ahead[1] = x / far, y / far
    return True


@compiled
def _take_back(
    here: Any, there: Any, everyone: Any, apart: Any, keep: float, start: Any, other: Any
) -> None:
    """Take back steps of pairs that would meet, until none would; where all stood, none did."""
    n = len(here)
    back = np.zeros(n, np.bool_)
    while True:
        found = False
        for i in range(n):
            for q in range(start[i], start[i + 1]):
                j = other[q]
                least = min(apart[i], apart[j] if j < n else keep)
                end = there[j] if j < n else everyone[j]
                gap = hypot(there[i, 0] - end[0], there[i, 1] - end[1])
                was = hypot(here[i, 0] - everyone[j, 0], here[i, 1] - everyone[j, 1])
                if gap < least and gap < was - 1e-12:
                    for k in (i, j):
                        if k < n and (there[k, 0] != here[k, 0] or there[k, 1] != here[k, 1]):
                            back[k] = found = True
        if not found:
            return
        for i in range(n):
            if back[i]:
                there[i, 0], there[i, 1] = here[i, 0], here[i, 1]
                back[i] = False


@compiled
def sees(
    x: float, y: float, to_x: float, to_y: float, shares: Any, mine: int, free: Any, zones: Any,
    west: float, north: float, size: float,
) -> bool:  # fmt: skip
    """Return whether a straight line stays free, at some shares of it, and off zones of others."""
    row, column = cell_of(x, y, west, north, size, free.shape)
    own = zones[row, column]
    for k in range(len(shares)):
        row, column = cell_of(x + shares[k] * (to_x - x), y + shares[k] * (to_y - y), west, north,
                              size, free.shape)  # fmt: skip
        number = zones[row, column]
        if not free[row, column] or (number != 0 and number != mine and number != own):
            return False
    return True


@compiled
def follow(
    rows: Any, at: Any, last: Any, position: Any, points: Any, right: Any, room: Any, zone: Any,
    aside: Any, window: int, ahead: int, shares: Any, free: Any, zones: Any, west: float,
    north: float, size: float,
) -> Any:  # fmt: skip
    """Find where people are on their ways, and the places that they head for.

    Parameters
    ----------
    rows
        (r,) the people.
    at, last
        (n,) points of the ways that people are at, and their ends; `at` is written.
    position
        (n, 2) metres.
    points, right, room, zone
        (p, 2) metres, (p, 2) directions to the right of the ways, (p,) metres of room there, and
        (p,) the zone that the way is on or comes to next.
    aside
        (n,) metres to the right of their ways that people keep, negative to the left; those of
        0 go by every point of the way, seen or not.
    window
        Points ahead among which one looks for where one is, never back.
    ahead
        Points ahead to the place that one heads for.
    shares
        Of a line, where it must be free.
    free, zones, west, north, size
        Rasters.

    Returns
    -------
    target
        (r, 2) metres; in sight where anything is.
    """
    target = np.empty((len(rows), 2))
    for k in range(len(rows)):
        i = rows[k]
        x, y = position[i, 0], position[i, 1]
        best, nearest = inf, at[i]
        for point in range(at[i], min(at[i] + window, last[i] + 1)):
            far = hypot(points[point, 0] - x, points[point, 1] - y)
            if far < best:
                best, nearest = far, point
        at[i] = nearest
        goal = min(nearest + ahead, last[i])
        off = 0.0 if goal == last[i] else min(abs(aside[i]), room[goal])
        off = off if aside[i] > 0 else -off
        # Nearer and nearer, at last back to the way itself for who was pushed behind a corner.
        target[k, 0], target[k, 1] = points[nearest, 0], points[nearest, 1]
        if aside[i] == 0.0:  # who sways between what is seen from here and there takes the next
            point = min(nearest + 1, last[i])
            target[k, 0], target[k, 1] = points[point, 0], points[point, 1]
            continue
        for trial in range(ahead + 3):
            share = 1.0 if trial == 0 else 0.5 if trial == 1 else 0.0
            point = min(nearest + ahead - max(trial - 2, 0), last[i])
            to_x = points[point, 0] + share * off * right[point, 0]
            to_y = points[point, 1] + share * off * right[point, 1]
            if sees(x, y, to_x, to_y, shares, zone[nearest], free, zones, west, north, size):
                target[k, 0], target[k, 1] = to_x, to_y
                break
    return target


@compiled
def swept(
    boxes: Any, tick: Any, more: float, taken: Any, free: Any, zone: Any, west: float,
    north: float, size: float,
) -> Any:  # fmt: skip
    """Find which boxes reach over places where people may be.

    Parameters
    ----------
    boxes
        (b, 6) as of `cityx.motion.crowd.stepped`.
    tick
        (b,) of each.
    more
        Metres about the boxes that count for zones.
    taken
        (zones, ticks) bool; written where a box reaches over the zone.
    free, zone, west, north, size
        Rasters.

    Returns
    -------
    reaches
        (b,) bool.
    """
    reaches = np.zeros(len(boxes), np.bool_)
    for b in range(len(boxes)):
        x, y, east, up, half, wide = boxes[b]
        along = int(2 * (half + more) / (2 * size)) + 1
        across = int(2 * (wide + more) / (2 * size)) + 1
        for i in range(along + 1):
            u = (half + more) * (2.0 * i / along - 1.0)
            for j in range(across + 1):
                v = (wide + more) * (2.0 * j / across - 1.0)
                row, column = cell_of(x + u * east - v * up, y + u * up + v * east, west, north,
                                      size, free.shape)  # fmt: skip
                number = zone[row, column]
                if number > 0:
                    taken[number - 1, tick[b]] = True
                if free[row, column] and abs(u) <= half and abs(v) <= wide:
                    reaches[b] = True
    return reaches
