"""Travellers by rule: they try some motions ahead and take the best that meets nobody.

References
----------
Fox, Burgard and Thrun, "The dynamic window approach to collision avoidance", IEEE Robotics and
Automation Magazine 4, 1997.
"""

from __future__ import annotations

from math import atan2, cos, floor, hypot, sin
from typing import Any

import numpy as np

from cityx.geometry.compiled import borrowing, compiled
from cityx.sim import travellers
from cityx.sim.kernels.lines import wrapped
from cityx.sim.kernels.one import world_at
from cityx.sim.kernels.passing import way_made
from cityx.sim.kernels.paths import crossing_ahead, crossing_at, fits_at, may_cross, on_path
from cityx.sim.kernels.roam_look import CELL, code_of, size_about, was_there
from cityx.sim.kernels.tables import (
    ALIVE,
    EXPLORE,
    GOAL,
    GONE,
    HEADING,
    KIND,
    LENGTH,
    PEOPLE,
    SPEED,
    WIDTH,
    X,
    Y,
    Z,
)

AHEAD, TIME, TICKS = 1.3, 1.4, 10  # metres on the route that it heads for; s foreseen, in steps
CAREFUL_AHEAD, CAREFUL_TIME, CAREFUL = (
    0.45,
    0.7,
    0.25,
)  # the same where it stands; share of its pace
TIGHT, AIR = 0.15, 0.4  # metres kept from others at least, and gladly
HAIR = 0.005  # metres that are no nearer
NEAR, THERE = 6.0, 0.2  # metres within which others are heeded, and from a place that is reached
LINE = 0.95  # metres before a roadway at which it waits
STANDS = 0.1  # m/s below which one stands
TURNS, SPEEDS = 9, 4  # motions tried
WINDOW = 32.0  # metres to each side in which what is unexplored is looked for
BLOCK, LOOK = 0.4, 0.1  # metres of the cells of that search, and between looks along a line


@compiled
def rule(
    world: Any, paths: Any, batch: Any, rules: Any, action: Any, agents: int, low: int, high: int
) -> None:
    """Write what travellers by rule do to (E, A, 2) actions; the state is only read."""
    feet = agents + int(rules[PEOPLE])
    side = 2 * int(WINDOW / BLOCK) + 1
    queue, before = np.empty(side * side, np.int64), np.empty(side * side, np.int64)
    for e in range(low, high):
        here = world_at(batch, e)
        for n in range(agents):
            if rules[EXPLORE] > 0:
                tx, ty = unexplored(paths, here, n, queue, before, side)
                on = crossing_at(paths, here.real[X, n], here.real[Y, n])
                over = crossing_at(paths, tx, ty)
                if on == 0 and over > 0 and not may_cross(world, paths, here, 0, feet, over):
                    one, two = stand(paths, here, n)
                else:
                    one, two = best_motion(paths, here, n, 0, feet, tx, ty, 0.0, TIME, 1.0)
            else:
                one, two = follower(world, paths, here, n, 0, agents, feet)
            action[e, n, 0], action[e, n, 1] = one, two


@borrowing
def follower(
    world: Any, paths: Any, here: Any, n: int, first: int, agents: int, feet: int
) -> Any:  # fmt: skip
    """Return the action of one that follows its route.

    Rows `first` to `feet` are on walks, those up to `agents` are agents.
    """
    makes, back, px, py = way_made(paths, here, n, first, agents)
    if makes:
        if hypot(px - here.real[X, n], py - here.real[Y, n]) < THERE:
            return stand(paths, here, n)
        if back > AHEAD:
            px, py, _ = on_path(paths, here, n, -AHEAD)
        return best_motion(paths, here, n, first, feet, px, py, 0.0, TIME, 1.0)
    tx, ty, _ = on_path(paths, here, n, AHEAD)
    on = crossing_at(paths, here.real[X, n], here.real[Y, n])
    away, over = crossing_ahead(paths, here, n, LINE + 0.6, 0.2)
    slow = 0.0
    if on == 0 and over > 0 and not may_cross(world, paths, here, first, feet, over):
        if away < LINE:
            return stand(paths, here, n)
        slow = 0.5
    left = here.real[GOAL, n] - here.real[GONE, n]
    if left < AHEAD:
        tx, ty, _ = on_path(paths, here, n, left)
    one, two = best_motion(paths, here, n, first, feet, tx, ty, slow, TIME, 1.0)
    if one * one + two * two < 1e-12 or (two == -1.0 and on_wheels(paths, here, n)):
        # Nothing gets it on: in a narrow bend it feels its way from cell to cell.
        tx, ty, _ = on_path(paths, here, n, min(CAREFUL_AHEAD, left))
        return best_motion(paths, here, n, first, feet, tx, ty, slow, CAREFUL_TIME, CAREFUL)
    return one, two


@borrowing
def on_wheels(paths: Any, here: Any, n: int) -> Any:
    """Return whether a traveller turns and rolls instead of stepping aside."""
    return paths.travellers[here.whole[KIND, n], travellers.WHEELS] > 0.0


@borrowing
def stand(paths: Any, here: Any, n: int) -> Any:
    """Return the action of one that stops."""
    return 0.0, -1.0 if on_wheels(paths, here, n) else 0.0


@borrowing
def best_motion(
    paths: Any, here: Any, n: int, first: int, feet: int, tx: float, ty: float, slow: float,
    time: float, share_of_top: float,
) -> Any:  # fmt: skip
    """Return the action, of some that are tried, that gets nearest to a place and hits nobody.

    Parameters
    ----------
    first, feet
        Rows on walks.
    tx, ty
        The place.
    slow
        More than 0 before a crosswalk that is not free.
    time, share_of_top
        Seconds foreseen, and the fastest that is tried.
    """
    real = here.real
    kind = here.whole[KIND, n]
    own = paths.travellers[kind]
    wheels = on_wheels(paths, here, n)
    x, y, heading = real[X, n], real[Y, n], real[HEADING, n]
    top = own[travellers.TOP] * (0.35 if slow > 0.0 else 1.0) * share_of_top
    inside = fits_at(paths, x, y, kind)
    best, ahead, aside = 1e9, 0.0, -1.0 if wheels else 0.0
    bearing = wrapped(atan2(ty - y, tx - x) - heading)
    for i in range(TURNS):
        share = 2.0 * i / (TURNS - 1) - 1.0
        for j in range(SPEEDS):
            speed = top * (SPEEDS - 1 - j) / (SPEEDS - 1)
            if wheels:
                rate = share * own[travellers.TURN]
                cost = tried(
                    paths, here, n, first, feet, tx, ty, speed, heading, rate, kind, inside, time
                )
                # Who does not get on at least turns to where it has to go, in small steps too.
                if j == SPEEDS - 1:
                    cost += 0.05 * abs(wrapped(bearing - rate * time / TICKS))
                one, two = share, 2.0 * speed / own[travellers.TOP] - 1.0
            else:
                angle = bearing + share * 1.8
                cost = tried(
                    paths,
                    here,
                    n,
                    first,
                    feet,
                    tx,
                    ty,
                    speed,
                    heading + angle,
                    0.0,
                    kind,
                    inside,
                    time,
                )
                one = speed * cos(angle) / own[travellers.TOP]
                two = speed * sin(angle) / own[travellers.TOP]
            if cost < best - 1e-12:
                best, ahead, aside = cost, one, two
    return ahead, aside


@borrowing
def tried(
    paths: Any, here: Any, n: int, first: int, feet: int, tx: float, ty: float, speed: float,
    heading: float, rate: float, kind: int, inside: bool, time: float,
) -> Any:  # fmt: skip
    """Return what a motion costs: how far from a place it ends, and much if it hits somebody."""
    real = here.real
    x, y, angle = real[X, n], real[Y, n], heading
    dt = time / TICKS
    pace, cost, reached = real[SPEED, n], 0.0, 1e9
    most = paths.travellers[kind, travellers.ACCEL] * dt
    for k in range(TICKS):
        pace += min(max(speed - pace, -most), most)
        angle += rate * dt
        x += pace * dt * cos(angle)
        y += pace * dt * sin(angle)
        if (pace > 0.0 or not inside) and not fits_at(paths, x, y, kind):
            cost += 40.0 - k
        for m in range(real.shape[1]):
            if m == n or here.whole[ALIVE, m] == 0 or abs(real[Z, m] - real[Z, n]) > 2.0:
                continue
            if pace < STANDS and first <= m < feet:
                continue  # people go round who stands
            dx, dy = real[X, m] - real[X, n], real[Y, m] - real[Y, n]
            near = NEAR + real[SPEED, m] * time
            if dx * dx + dy * dy > near * near:
                continue
            # Whom it is near already it need only not get nearer to.
            least = min(TIGHT, gap_to(here, n, m, real[X, n], real[Y, n], real[HEADING, n], 0.0))
            gap = gap_to(here, n, m, x, y, angle, (k + 1) * dt)
            if gap < least - HAIR:
                cost += 8.0 - 0.5 * k
            elif gap < AIR:
                cost += (AIR - max(gap, 0.0)) * (3.0 if least == TIGHT else 0.3)
        reached = min(reached, hypot(tx - x, ty - y))
        if reached < THERE:
            speed = 0.0  # and there it has to come to a stop before anybody
    return cost + reached + (0.0 if reached < THERE else 0.2 * hypot(tx - x, ty - y))


@borrowing
def gap_to(here: Any, n: int, m: int, x: float, y: float, angle: float, after: float) -> Any:
    """Return metres between one that stands somewhere and another after so many seconds.

    The longer of the two counts as a box, the other as round about it.
    """
    real = here.real
    ox = x - real[X, m] - real[SPEED, m] * after * cos(real[HEADING, m])
    oy = y - real[Y, m] - real[SPEED, m] * after * sin(real[HEADING, m])
    box, turned, other = n, angle, m
    if real[LENGTH, m] > real[LENGTH, n]:
        box, turned, other = m, real[HEADING, m], n
    c, s = cos(turned), sin(turned)
    along = max(abs(ox * c + oy * s) - real[LENGTH, box] / 2, 0.0)
    aside = max(abs(oy * c - ox * s) - real[WIDTH, box] / 2, 0.0)
    return hypot(along, aside) - size_about(here, other)


@borrowing
def unexplored(paths: Any, here: Any, n: int, queue: Any, before: Any, side: int) -> Any:
    """Return a place on the way to the nearest cell that an agent has not explored."""
    real = here.real
    kind = here.whole[KIND, n]
    x, y = real[X, n], real[Y, n]
    half = side // 2
    for k in range(side * side):
        before[k] = -1
    begin = half * side + half
    queue[0], before[begin] = begin, begin
    head, tail = 0, 1
    found = -1
    while head < tail and found < 0:
        cell = queue[head]
        head += 1
        i, j = cell % side, cell // side
        for k in range(4):
            a, b = i + (k == 0) - (k == 1), j + (k == 2) - (k == 3)
            if a < 0 or b < 0 or a >= side or b >= side or before[b * side + a] >= 0:
                continue
            px, py = x + (a - half) * BLOCK, y + (b - half) * BLOCK
            if not fits_at(paths, px, py, kind):
                continue
            before[b * side + a] = cell
            queue[tail] = b * side + a
            tail += 1
            if not was_there(here, n, code_of(floor(px / CELL), floor(py / CELL))):
                found = b * side + a
                break
    if found < 0:
        return x, y
    # Back along the way until it is as far off as one heads for, and straight ahead.
    cell = found
    while before[cell] != begin and cell != begin:
        px, py = x + (cell % side - half) * BLOCK, y + (cell // side - half) * BLOCK
        if hypot(px - x, py - y) < AHEAD + BLOCK and is_straight(paths, x, y, px, py, kind):
            break
        cell = before[cell]
    return x + (cell % side - half) * BLOCK, y + (cell // side - half) * BLOCK


@borrowing
def is_straight(paths: Any, x: float, y: float, px: float, py: float, kind: int) -> Any:
    """Return whether a traveller fits all along the straight way between two places."""
    count = int(hypot(px - x, py - y) / LOOK) + 1
    for k in range(1, count):
        if not fits_at(paths, x + k * (px - x) / count, y + k * (py - y) / count, kind):
            return False
    return True
