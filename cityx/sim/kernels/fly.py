"""One step of worlds whose agents fly: point masses that follow a wanted velocity with a lag."""

from __future__ import annotations

from math import atan2, cos, exp, floor, hypot, inf, pi, sin, sqrt
from typing import Any

import numpy as np

from cityx.geometry.compiled import borrowing, compiled
from cityx.sim.kernels.boxes import boxes_touch, over_each_other
from cityx.sim.kernels.draws import drawn, mixed
from cityx.sim.kernels.lines import wrapped
from cityx.sim.kernels.observe import bounded
from cityx.sim.kernels.one import world_at
from cityx.sim.kernels.step import nothing
from cityx.sim.kernels.tables import (
    ALIVE,
    ALONG,
    ASIDE,
    CRASH_OBJECT,
    CRASH_VEHICLE,
    CRASHING,
    DRAWS,
    DRIVING,
    DT,
    GOAL,
    GOAL_M,
    GOAL_REACHED,
    GONE,
    HEADING,
    HEIGHT,
    HITTING,
    HORIZON,
    LATE,
    LEAVING,
    LENGTH,
    LIFT,
    OFF_ROAD,
    SPEED,
    SPEEDING,
    STEER,
    STEPS,
    SUCCESS,
    TURNED,
    W_CRASH,
    W_DRIVING,
    W_HIT,
    W_OFF_ROAD,
    W_SPEED,
    W_SUCCESS,
    WAITED,
    WHOLE_RESET,
    WIDTH,
    YAW_RATE,
    X,
    Y,
    Z,
)

# Rows of the state that mean something else of who flies: its velocity, and where it has to go.
VX, VY, VZ = STEER, LIFT, ASIDE
GX, GY, GZ = ALONG, TURNED, WAITED
TOP, CLIMB, TURN = 8.0, 3.0, 1.5  # m/s, m/s and radians per second
LAG, PUSH = 0.35, 5.0  # seconds in which it tilts, and m/s2 at most
SIZE, TALL = 0.5, 0.3  # metres across and high
ARRIVED = 2.0  # metres from the goal
CEILING = 120.0  # metres above what is below
ABOVE = (2.5, 25.0)  # metres above what is below, where one begins and has to go
EDGE = 3.0  # metres from the border of the site
TRIES = 60
WAYS, DISTANCES = 12, (3.0, 6.0, 12.0, 20.0, 30.0)
OVER, SOON, STRIDE = 2.5, 26.0, 1.0  # metres that the rule keeps above, looks ahead, and between


@compiled
def step_worlds(
    top: Any, row: Any, frame: Any, batch: Any, rules: Any, action: Any, out: Any, view: Any,
    final: Any, agents: int, low: int, high: int,
) -> None:  # fmt: skip
    """Step worlds `low` to `high`, as `cityx.sim.kernels.step.step_worlds` does.

    Parameters
    ----------
    top, row, frame
        Raster of what is highest, whose it is, and where it lies.
    action
        (E, A, 4) float64 between -1 and 1: ahead, left, up and turn to the left.
    """
    for e in range(low, high):
        here = world_at(batch, e)
        here.clock[0] += rules[DT]
        for n in range(agents):
            if here.whole[ALIVE, n] != 0:
                soar(here, rules, action[e, n], n)
        for n in range(agents):
            if here.whole[ALIVE, n] != 0:
                judge(top, row, frame, here, rules, out, e, n)
            else:
                nothing(out, e, n)
        for n in range(agents):
            look(top, frame, here, n, view[e, n])
        if len(final) == 0:
            continue
        for n in range(agents):
            if out.ended[e, n] or out.late[e, n]:
                final[e, n] = view[e, n]
                if rules[WHOLE_RESET] > 0:
                    begin_world(top, frame, here, rules, agents)
                else:
                    begin_agent(top, frame, here, rules, n)
                look(top, frame, here, n, view[e, n])


@compiled
def begin_worlds(top: Any, frame: Any, batch: Any, rules: Any, agents: int, chosen: Any) -> None:
    """Begin the next episode of chosen worlds, (E,) bool."""
    for e in np.flatnonzero(chosen):
        begin_world(top, frame, world_at(batch, e), rules, agents)


@compiled
def observe(top: Any, frame: Any, batch: Any, view: Any, agents: int) -> None:
    """Write what agents observe to (E, A, d)."""
    for e in range(view.shape[0]):
        here = world_at(batch, e)
        for n in range(agents):
            look(top, frame, here, n, view[e, n])


@borrowing
def top_at(top: Any, frame: Any, x: float, y: float) -> Any:
    """Return metres of what is highest at a place, minus infinity beyond the site."""
    i, j = floor((x - frame[0]) / frame[2]), floor((y - frame[1]) / frame[2])
    if i < 0 or j < 0 or i >= frame[3] or j >= frame[4]:
        return -inf
    z = float(top[j, i])
    return z if z == z else -inf


@borrowing
def begin_world(top: Any, frame: Any, here: Any, rules: Any, agents: int) -> None:
    """Begin an episode of a world."""
    here.episode[0] += 1
    here.key[0] = mixed(here.seed[0] ^ mixed(np.uint64(here.episode[0])))
    for n in range(here.real.shape[1]):
        here.whole[DRAWS, n] = 0
        here.whole[ALIVE, n] = 0
    here.clock[0] = 3600.0 * drawn(here, 0)
    for n in range(agents):
        begin_agent(top, frame, here, rules, n)


@borrowing
def spot(top: Any, frame: Any, here: Any, n: int, x: float, y: float) -> Any:
    """Return a height at a place that is free about a drone, minus infinity if there is none."""
    highest = about(top, frame, x, y, 1.5)
    if highest == -inf:
        return -inf
    share = drawn(here, n)
    return highest + ABOVE[0] + (ABOVE[1] - ABOVE[0]) * share * share


@borrowing
def begin_agent(top: Any, frame: Any, here: Any, rules: Any, n: int) -> None:
    """Put a drone in the air, and draw where it has to go."""
    real, whole = here.real, here.whole
    for r in range(real.shape[0]):
        real[r, n] = 0.0
    real[LENGTH, n] = real[WIDTH, n] = SIZE
    real[HEIGHT, n] = TALL
    west, south = frame[0] + EDGE, frame[1] + EDGE
    wide, high = frame[3] * frame[2] - 2 * EDGE, frame[4] * frame[2] - 2 * EDGE
    wanted = min(rules[GOAL_M], 0.6 * hypot(wide, high))
    for _ in range(TRIES):
        x, y = west + wide * drawn(here, n), south + high * drawn(here, n)
        angle = 2 * pi * drawn(here, n)
        gx, gy = x + wanted * cos(angle), y + wanted * sin(angle)
        z, gz = spot(top, frame, here, n, x, y), spot(top, frame, here, n, gx, gy)
        inside = west <= gx <= west + wide and south <= gy <= south + high
        real[X, n], real[Y, n], real[Z, n] = x, y, z
        real[GX, n], real[GY, n], real[GZ, n] = gx, gy, gz
        if inside and z > -inf and gz > -inf and apart(here, n):
            break
    real[HEADING, n] = 2 * pi * drawn(here, n) - pi
    real[GOAL, n] = left(here, n)
    whole[STEPS, n], whole[ALIVE, n] = 0, 1


@borrowing
def apart(here: Any, n: int) -> Any:
    """Return whether no other drone is within some metres."""
    for m in range(here.real.shape[1]):
        if m == n or here.whole[ALIVE, m] == 0:
            continue
        if hypot(here.real[X, m] - here.real[X, n], here.real[Y, m] - here.real[Y, n]) < 4.0:
            return False
    return True


@borrowing
def left(here: Any, n: int) -> Any:
    """Return metres to the goal."""
    real = here.real
    dx, dy, dz = real[GX, n] - real[X, n], real[GY, n] - real[Y, n], real[GZ, n] - real[Z, n]
    return sqrt(dx * dx + dy * dy + dz * dz)


@borrowing
def soar(here: Any, rules: Any, action: Any, n: int) -> None:
    """Move a drone: its velocity follows the wanted one, as it tilts and as far as it can push."""
    real, dt = here.real, rules[DT]
    ahead = min(max(action[0], -1.0), 1.0) * TOP
    aside = min(max(action[1], -1.0), 1.0) * TOP
    size = hypot(ahead, aside)
    if size > TOP:
        ahead, aside = ahead * TOP / size, aside * TOP / size
    c, s = cos(real[HEADING, n]), sin(real[HEADING, n])
    share = (1.0 - exp(-dt / LAG)) / dt
    px = (c * ahead - s * aside - real[VX, n]) * share
    py = (s * ahead + c * aside - real[VY, n]) * share
    pz = (min(max(action[2], -1.0), 1.0) * CLIMB - real[VZ, n]) * share
    push = sqrt(px * px + py * py + pz * pz)
    k = min(1.0, PUSH / push) if push > 1e-12 else 0.0
    for axis, pushed in ((0, px), (1, py), (2, pz)):
        speed = VX if axis == 0 else (VY if axis == 1 else VZ)
        place = X if axis == 0 else (Y if axis == 1 else Z)
        after = real[speed, n] + k * pushed * dt
        real[place, n] += (real[speed, n] + after) / 2 * dt
        real[speed, n] = after
    real[YAW_RATE, n] = min(max(action[3], -1.0), 1.0) * TURN
    real[HEADING, n] = wrapped(real[HEADING, n] + real[YAW_RATE, n] * dt)
    real[SPEED, n] = hypot(real[VX, n], real[VY, n])


@borrowing
def touched_top(top: Any, row: Any, frame: Any, here: Any, n: int) -> Any:
    """Return the row of what a drone is in, -1 for nothing."""
    x, y, z, reach = here.real[X, n], here.real[Y, n], here.real[Z, n], SIZE / 2
    i0, i1 = floor((x - reach - frame[0]) / frame[2]), floor((x + reach - frame[0]) / frame[2])
    j0, j1 = floor((y - reach - frame[1]) / frame[2]), floor((y + reach - frame[1]) / frame[2])
    for j in range(max(j0, 0), min(j1, int(frame[4]) - 1) + 1):
        for i in range(max(i0, 0), min(i1, int(frame[3]) - 1) + 1):
            if top[j, i] > z:
                return row[j, i]
    return -1


@borrowing
def judge(top: Any, row: Any, frame: Any, here: Any, rules: Any, out: Any, e: int, n: int) -> None:
    """Find what happened to a drone, and what that is worth."""
    real, whole = here.real, here.whole
    whole[STEPS, n] += 1
    before = real[GONE, n]
    real[GONE, n] = real[GOAL, n] - left(here, n)
    event, touched = 0, -1
    for m in range(real.shape[1]):
        if m == n or whole[ALIVE, m] == 0 or over_each_other(real, n, m):
            continue
        if real[LENGTH, m] <= SIZE:
            meets = hypot(real[X, m] - real[X, n], real[Y, m] - real[Y, n]) < SIZE
        else:
            meets = boxes_touch(
                real[X, n], real[Y, n], real[HEADING, n], SIZE / 2, SIZE / 2, real[X, m],
                real[Y, m], real[HEADING, m], real[LENGTH, m] / 2, real[WIDTH, m] / 2,
            )  # fmt: skip
        if meets:
            event, touched = CRASH_VEHICLE, -2 - m
    if event == 0:
        touched = touched_top(top, row, frame, here, n)
        if touched >= 0:
            event |= CRASH_OBJECT
    under = top_at(top, frame, real[X, n], real[Y, n])
    if under == -inf or real[Z, n] > under + CEILING:
        event |= OFF_ROAD
    if event == 0 and left(here, n) < ARRIVED:
        event |= GOAL_REACHED
    ended = event != 0
    late = not ended and whole[STEPS, n] >= rules[HORIZON]
    if late:
        event |= LATE
    for r in range(6):
        out.term[r, e, n] = 0.0
    if event & GOAL_REACHED:
        out.term[SUCCESS, e, n] = rules[W_SUCCESS]
    elif event & OFF_ROAD:
        out.term[LEAVING, e, n] = -rules[W_OFF_ROAD]
    elif event & CRASH_VEHICLE:
        out.term[CRASHING, e, n] = -rules[W_CRASH]
    elif event & CRASH_OBJECT:
        out.term[HITTING, e, n] = -rules[W_HIT]
    else:
        out.term[DRIVING, e, n] = rules[W_DRIVING] * (real[GONE, n] - before)
        out.term[SPEEDING, e, n] = rules[W_SPEED] * real[SPEED, n] / TOP
    total = 0.0
    for r in range(6):
        total += out.term[r, e, n]
    out.reward[e, n] = total
    out.cost[e, n] = 1.0 if event & (OFF_ROAD | CRASH_VEHICLE | CRASH_OBJECT) else 0.0
    out.event[e, n], out.touched[e, n] = event, touched
    out.ended[e, n], out.late[e, n] = ended, late
    out.completion[e, n] = min(max(real[GONE, n] / max(real[GOAL, n], 1e-6), 0.0), 1.0)


@borrowing
def look(top: Any, frame: Any, here: Any, n: int, view: Any) -> None:
    """Write the preset `fly`."""
    real = here.real
    x, y, z = real[X, n], real[Y, n], real[Z, n]
    c, s = cos(real[HEADING, n]), sin(real[HEADING, n])
    view[0] = bounded((real[VX, n] * c + real[VY, n] * s) / TOP)
    view[1] = bounded((real[VY, n] * c - real[VX, n] * s) / TOP)
    view[2] = bounded(real[VZ, n] / TOP)
    view[3] = bounded(real[YAW_RATE, n] / TURN)
    view[4] = bounded((z - top_at(top, frame, x, y)) / 50.0)
    dx, dy = real[GX, n] - x, real[GY, n] - y
    view[5] = bounded((dx * c + dy * s) / 200.0)
    view[6] = bounded((dy * c - dx * s) / 200.0)
    view[7] = bounded((real[GZ, n] - z) / 200.0)
    view[8] = bounded(left(here, n) / 400.0)
    at = 9
    for k in range(WAYS):
        angle = real[HEADING, n] - 2 * pi * k / WAYS
        for away in DISTANCES:
            there = top_at(top, frame, x + away * cos(angle), y + away * sin(angle))
            view[at] = bounded((z - there) / 30.0)
            at += 1


@borrowing
def about(top: Any, frame: Any, x: float, y: float, reach: float) -> Any:
    """Return what is highest in a square about a place; minus infinity at the border."""
    highest = -inf
    steps = int(2 * reach / frame[2]) + 1
    for j in range(steps + 1):
        for i in range(steps + 1):
            there = top_at(top, frame, x - reach + 2 * reach * i / steps,
                           y - reach + 2 * reach * j / steps)  # fmt: skip
            if there == -inf:
                return -inf
            highest = max(highest, there)
    return highest


@compiled
def rule(top: Any, frame: Any, batch: Any, action: Any, agents: int, low: int, high: int) -> None:
    """Write what a pilot by rule does to (E, A, 4) actions; the state is only read.

    It flies straight to above its goal, over what lies ahead, and comes down there.
    """
    for e in range(low, high):
        here = world_at(batch, e)
        for n in range(agents):
            pilot(top, frame, here, n, action[e, n])


@borrowing
def pilot(top: Any, frame: Any, here: Any, n: int, action: Any) -> None:
    """Write the four numbers of an action."""
    real = here.real
    x, y, z = real[X, n], real[Y, n], real[Z, n]
    dx, dy = real[GX, n] - x, real[GY, n] - y
    flat = hypot(dx, dy)
    ux, uy = (dx / flat, dy / flat) if flat > 1e-9 else (0.0, 0.0)
    speed = min(TOP, 0.8 * flat)
    # What it has to be above on the way, and how fast it may go while it climbs.
    need = about(top, frame, x, y, 1.5) + OVER / 2
    away = 0.0
    while away < min(SOON, flat):
        away += STRIDE
        over = about(top, frame, x + away * ux, y + away * uy, 1.0) + OVER
        need = max(need, over if flat - away > 0.0 else min(over, real[GZ, n]))
        short = over - z
        if short > 0.0 and flat > 1.0:
            room = max(away - 3.0, 0.0)
            speed = min(speed, room / max(short / (0.8 * CLIMB), 0.2))
    wanted = real[GZ, n] if flat < 1.5 else max(need, real[GZ, n])
    if flat < 1.5:
        speed = min(speed, flat)
    angle = wrapped(atan2(dy, dx) - real[HEADING, n]) if flat > 1e-9 else 0.0
    action[0] = speed * cos(angle) / TOP
    action[1] = speed * sin(angle) / TOP
    action[2] = min(max((wanted - z) / 1.2 / CLIMB, -1.0), 1.0)
    action[3] = min(max(angle / 1.0, -1.0), 1.0) if flat > 3.0 else 0.0
