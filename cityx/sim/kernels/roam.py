"""One step of worlds whose agents go on walks: they move, meet steps and others, and arrive."""

from __future__ import annotations

from math import atan2, cos, floor, hypot, inf, sin
from typing import Any

import numpy as np

from cityx.geometry.compiled import borrowing, compiled
from cityx.sim import travellers
from cityx.sim.kernels.boxes import boxes_touch, cell_value, first_touched, over_each_other
from cityx.sim.kernels.draws import drawn, mixed
from cityx.sim.kernels.lines import wrapped
from cityx.sim.kernels.observe import ON_FOOT
from cityx.sim.kernels.one import world_at
from cityx.sim.kernels.paths import AREA, crossing_at, flags_at, follow_path, height_at, light
from cityx.sim.kernels.people import begin_person, set_on_route, walk_people
from cityx.sim.kernels.roam_look import EXPLORED, NEIGHBOURS, look_about, mark
from cityx.sim.kernels.spawn import begin_traffic
from cityx.sim.kernels.step import nothing
from cityx.sim.kernels.tables import (
    ALIVE,
    CONTROL,
    CRASH_OBJECT,
    CRASH_VEHICLE,
    CRASHING,
    DRAWS,
    DRIVING,
    DT,
    EXPLORE,
    FALL,
    GOAL,
    GOAL_M,
    GOAL_REACHED,
    GONE,
    HEADING,
    HEIGHT,
    HELD,
    HITTING,
    HORIZON,
    KERB,
    KIND,
    LATE,
    LEAVING,
    LENGTH,
    OFF_ROAD,
    PEDAL_ACTION,
    PEOPLE,
    PIECE,
    RED_ENDS,
    RED_LIGHT,
    SPEED,
    SPEEDING,
    STEER_ACTION,
    STEPS,
    SUCCESS,
    VEHICLE,
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
from cityx.sim.kernels.traffic import drive_traffic

ARRIVED = 0.6  # metres from the end of a route
SLOWEST = 0.02  # m/s below which one stands
NEAR = 45.0  # metres from an agent that people begin
TRIES = 40
SHORT, LONG, SPARE = 0.6, 1.1, 32  # shares of the metres asked for, and routes where none has them
WHEELS_OFF = 2  # wheels beside the walks, from which one has left them
APART = 1.5  # metres between two agents that begin


@compiled
def step_worlds(
    world: Any, paths: Any, batch: Any, rules: Any, action: Any, out: Any, view: Any, final: Any,
    agents: int, low: int, high: int,
) -> None:  # fmt: skip
    """Step worlds `low` to `high`, as `cityx.sim.kernels.step.step_worlds` does.

    Parameters
    ----------
    action
        (E, A, 2) float64 between -1 and 1: of wheels turn, then speed; on foot ahead, then left.
        Where agents are held, (E, A, 3): bits of what happened to them as they were moved, what
        they touched as of `Outcome.touched`, and the number of the crosswalk they were on before.
    view, final
        (E, A, d) float32: what is observed, and what those observed last whose episodes ended;
        these begin anew. Where `final` has no world, nobody does.
    """
    near = np.empty(batch.real.shape[2], np.int64)
    nearest, square = np.empty(NEIGHBOURS, np.int64), np.empty(NEIGHBOURS)
    feet = agents + int(rules[PEOPLE])
    for e in range(low, high):
        here = world_at(batch, e)
        here.clock[0] += rules[DT]
        drive_traffic(world, here, rules, feet, agents, near)
        walk_people(world, paths, here, rules, agents, 0, feet, NEAR)
        for n in range(agents):
            if here.whole[ALIVE, n] != 0:
                if rules[CONTROL] == HELD:
                    bits, touched = int(action[e, n, 0]), int(action[e, n, 1])
                    before = int(action[e, n, 2])
                else:
                    before = crossing_at(paths, here.real[X, n], here.real[Y, n])
                    bits = go(paths, here, rules, action[e, n, 0], action[e, n, 1], n)
                    touched = touched_any(world, here, n)
                    if touched != -1:
                        bits |= CRASH_VEHICLE if touched < 0 else CRASH_OBJECT
                judge(world, paths, here, rules, out, e, n, before, bits, touched)
            else:
                nothing(out, e, n)
        for n in range(agents):
            look_about(world, paths, here, rules, n, 0, feet, view[e, n], nearest, square)
        if len(final) == 0:
            continue
        for n in range(agents):
            if out.ended[e, n] or out.late[e, n]:
                final[e, n] = view[e, n]
                if rules[WHOLE_RESET] > 0:
                    begin_world(world, paths, here, rules, agents)
                else:
                    begin_agent(paths, here, rules, n, agents)
                look_about(world, paths, here, rules, n, 0, feet, view[e, n], nearest, square)


@compiled
def begin_worlds(world: Any, paths: Any, batch: Any, rules: Any, agents: int, chosen: Any) -> None:
    """Begin the next episode of chosen worlds, (E,) bool."""
    for e in np.flatnonzero(chosen):
        begin_world(world, paths, world_at(batch, e), rules, agents)


@compiled
def observe(world: Any, paths: Any, batch: Any, rules: Any, view: Any, agents: int) -> None:
    """Write what agents observe to (E, A, d)."""
    nearest, square = np.empty(NEIGHBOURS, np.int64), np.empty(NEIGHBOURS)
    feet = agents + int(rules[PEOPLE])
    for e in range(view.shape[0]):
        here = world_at(batch, e)
        for n in range(agents):
            look_about(world, paths, here, rules, n, 0, feet, view[e, n], nearest, square)


@borrowing
def begin_world(world: Any, paths: Any, here: Any, rules: Any, agents: int) -> None:
    """Begin an episode of a world: its agents, then its people, then its traffic."""
    here.episode[0] += 1
    here.key[0] = mixed(here.seed[0] ^ mixed(np.uint64(here.episode[0])))
    feet = agents + int(rules[PEOPLE])
    for n in range(here.real.shape[1]):
        here.whole[DRAWS, n] = 0
        here.whole[ALIVE, n] = 0
    here.clock[0] = 3600.0 * drawn(here, 0)
    for n in range(feet, here.real.shape[1]):
        begin_traffic(world, here, n, feet, 0.0)
    for n in range(agents):
        begin_agent(paths, here, rules, n, agents)
    for n in range(agents, feet):
        here.whole[PIECE, n] = -1
        begin_person(paths, here, n, agents, NEAR, True)


@borrowing
def begin_agent(paths: Any, here: Any, rules: Any, n: int, agents: int) -> None:
    """Put an agent before a door, with the way to another before it."""
    kind = int(rules[VEHICLE])
    first, last = paths.first[kind], paths.first[kind + 1]
    low = first + np.searchsorted(paths.length[first:last], SHORT * rules[GOAL_M])
    high = first + np.searchsorted(paths.length[first:last], LONG * rules[GOAL_M])
    if high <= low:
        low, high = max(low - SPARE // 2, first), min(low + SPARE // 2, last)
    for _ in range(TRIES):
        route = low + min(int(drawn(here, n) * (high - low)), high - low - 1)
        set_on_route(paths, here, n, kind, route, 1 if drawn(here, n) < 0.5 else 0, 0.0)
        if far_off_all(here, n, agents):
            break
    here.whole[ALIVE, n] = 1
    if rules[EXPLORE] > 0:
        for k in range(EXPLORED, here.path.shape[1]):
            here.path[n, k] = -1
        here.real[GOAL, n], here.real[GONE, n] = rules[EXPLORE], 0.0
        mark(paths, here, n)


@borrowing
def far_off_all(here: Any, n: int, agents: int) -> Any:
    """Return whether no other agent, nor anybody else, is where an agent begins."""
    for m in range(here.real.shape[1]):
        if m == n or here.whole[ALIVE, m] == 0:
            continue
        least = APART if m < agents else APART + here.real[LENGTH, m] / 2
        if hypot(here.real[X, m] - here.real[X, n], here.real[Y, m] - here.real[Y, n]) < least:
            return False
    return True


@borrowing
def go(paths: Any, here: Any, rules: Any, one: float, two: float, n: int) -> Any:
    """Move an agent; return the bits of what the ground did to it.

    A step up, or no ground, ahead of a wheel is a wall: it stops. A step down is a fall.
    """
    real = here.real
    own = paths.travellers[here.whole[KIND, n]]
    one, two = min(max(one, -1.0), 1.0), min(max(two, -1.0), 1.0)
    real[STEER_ACTION, n], real[PEDAL_ACTION, n] = one, two
    dt, reach = rules[DT], own[travellers.WHEELS]
    x, y, heading, speed = real[X, n], real[Y, n], real[HEADING, n], real[SPEED, n]
    most = own[travellers.ACCEL] * dt
    if reach > 0.0:
        wanted = (two + 1.0) / 2.0 * own[travellers.TOP]
        speed += min(max(wanted - speed, -most), most)
        turn = one * own[travellers.TURN]
        turned = wrapped(heading + turn * dt)
        way = heading + turn * dt / 2
    else:
        # On foot: a velocity, and the body turns to where it leads.
        px, py = one * own[travellers.TOP], two * own[travellers.TOP]
        size = hypot(px, py)
        if size > own[travellers.TOP]:
            px, py = px * own[travellers.TOP] / size, py * own[travellers.TOP] / size
        c, s = cos(heading), sin(heading)
        vx, vy = speed * c, speed * s
        ax, ay = c * px - s * py - vx, s * px + c * py - vy
        size = hypot(ax, ay)
        k = min(1.0, most / size) if size > 1e-12 else 0.0
        vx, vy = vx + k * ax, vy + k * ay
        speed = hypot(vx, vy)
        way = atan2(vy, vx) if speed > SLOWEST else heading
        turned = way
    nx, ny = x + speed * dt * cos(way), y + speed * dt * sin(way)
    bits = 0
    if reach > 0.0:
        total = 0.0
        for k in range(4):
            u, v = (reach if k < 2 else -reach), (reach if k % 2 else -reach)
            c, s, tc, ts = cos(heading), sin(heading), cos(turned), sin(turned)
            was = height_at(paths, x + c * u - s * v, y + s * u + c * v)
            now = height_at(paths, nx + tc * u - ts * v, ny + ts * u + tc * v)
            bits |= met_step(was, now, own[travellers.STEP])
            total += now
        z = total / 4
    else:
        z = height_at(paths, nx, ny)
        bits |= met_step(real[Z, n], z, own[travellers.STEP])
    if bits & KERB:
        bits &= ~FALL
        real[SPEED, n] = real[YAW_RATE, n] = 0.0
    else:
        real[X, n], real[Y, n], real[HEADING, n], real[SPEED, n] = nx, ny, turned, speed
        real[YAW_RATE, n] = wrapped(turned - heading) / dt
        if z > -inf:
            real[Z, n] = z
    real[WAITED, n] = real[WAITED, n] + dt if real[SPEED, n] < SLOWEST else 0.0
    return bits


@borrowing
def met_step(was: float, now: float, most: float) -> Any:
    """Return what a step from one height of the ground to another is, `KERB`, `FALL` or 0."""
    if was == -inf:
        return 0
    if now == -inf or now - was > most:
        return KERB
    return FALL if was - now > most else 0


@borrowing
def left_walks(paths: Any, here: Any, n: int) -> Any:
    """Return whether an agent is off the walks: its middle on foot, two of its wheels else."""
    real = here.real
    reach = paths.travellers[here.whole[KIND, n], travellers.WHEELS]
    x, y = real[X, n], real[Y, n]
    if reach <= 0.0:
        return flags_at(paths, x, y) & AREA == 0
    c, s, off = cos(real[HEADING, n]), sin(real[HEADING, n]), 0
    for k in range(4):
        u, v = (reach if k < 2 else -reach), (reach if k % 2 else -reach)
        if flags_at(paths, x + c * u - s * v, y + s * u + c * v) & AREA == 0:
            off += 1
    return off >= WHEELS_OFF


@borrowing
def touched_other(here: Any, n: int) -> Any:
    """Return the first mover that an agent touches, -1 for none; people are round."""
    real = here.real
    for m in range(real.shape[1]):
        if m == n or here.whole[ALIVE, m] == 0 or over_each_other(real, n, m):
            continue
        if real[LENGTH, m] < ON_FOOT and real[LENGTH, n] < ON_FOOT:
            away = hypot(real[X, m] - real[X, n], real[Y, m] - real[Y, n])
            if away < (real[LENGTH, m] + real[LENGTH, n]) / 2:
                return m
        elif boxes_touch(
            real[X, n], real[Y, n], real[HEADING, n], real[LENGTH, n] / 2, real[WIDTH, n] / 2,
            real[X, m], real[Y, m], real[HEADING, m], real[LENGTH, m] / 2, real[WIDTH, m] / 2,
        ):  # fmt: skip
            return m
    return -1


@borrowing
def touched_solid(world: Any, here: Any, n: int) -> Any:
    """Return the first segment that an agent stands in, -1 for none."""
    real = here.real
    frame = world.frame
    i, j = floor((real[X, n] - frame[0]) / frame[2]), floor((real[Y, n] - frame[1]) / frame[2])
    reach = hypot(real[LENGTH, n], real[WIDTH, n]) / 2
    if 0 <= i < frame[3] and 0 <= j < frame[4] and cell_value(world.clear, j, i) * 0.1 > reach:
        return -1
    return first_touched(
        real[X, n], real[Y, n], real[Z, n], real[HEADING, n], real[LENGTH, n] / 2,
        real[WIDTH, n] / 2, real[HEIGHT, n], world.segment, world.cell_start, world.cell_segment,
        world.grid,
    )  # fmt: skip


@borrowing
def touched_any(world: Any, here: Any, n: int) -> Any:
    """Return the mover that an agent overlaps as -2 - row, else a segment's row, else -1."""
    other = touched_other(here, n)
    return -2 - other if other >= 0 else touched_solid(world, here, n)


@borrowing
def judge(
    world: Any, paths: Any, here: Any, rules: Any, out: Any, e: int, n: int, before: int,
    event: int, touched: int,
) -> None:  # fmt: skip
    """Find what happened to an agent, and what that is worth.

    Parameters
    ----------
    before
        Number of the crosswalk that it was on before this step.
    event, touched
        Bits of what the ground did to it and whether it hit something, and what that is.
    """
    real, whole = here.real, here.whole
    done = real[GONE, n]
    if rules[EXPLORE] > 0:
        mark(paths, here, n)
    else:
        follow_path(paths, here, n)
    whole[STEPS, n] += 1
    if left_walks(paths, here, n):
        event |= OFF_ROAD
    on = crossing_at(paths, real[X, n], real[Y, n])
    if on > 0 and on != before and light(world, paths, on, here.clock[0]) == 1:
        event |= RED_LIGHT
    if real[GONE, n] >= real[GOAL, n] - (0.0 if rules[EXPLORE] > 0 else ARRIVED):
        event |= GOAL_REACHED
    crash = event & (CRASH_VEHICLE | CRASH_OBJECT)
    gone_off = event & (OFF_ROAD | FALL)
    if crash or gone_off:
        event &= ~GOAL_REACHED
    ended = crash != 0 or gone_off != 0 or event & GOAL_REACHED != 0
    if event & RED_LIGHT and rules[RED_ENDS] > 0:
        ended = True
    late = not ended and whole[STEPS, n] >= rules[HORIZON]
    if late:
        event |= LATE
    for row in range(6):
        out.term[row, e, n] = 0.0
    if event & GOAL_REACHED:
        out.term[SUCCESS, e, n] = rules[W_SUCCESS]
    elif gone_off:
        out.term[LEAVING, e, n] = -rules[W_OFF_ROAD]
    elif event & CRASH_VEHICLE:
        out.term[CRASHING, e, n] = -rules[W_CRASH]
    elif event & CRASH_OBJECT:
        out.term[HITTING, e, n] = -rules[W_HIT]
    else:
        top = paths.travellers[whole[KIND, n], travellers.TOP]
        out.term[DRIVING, e, n] = rules[W_DRIVING] * (real[GONE, n] - done)
        out.term[SPEEDING, e, n] = rules[W_SPEED] * real[SPEED, n] / top
    total = 0.0
    for row in range(6):
        total += out.term[row, e, n]
    out.reward[e, n] = total
    out.cost[e, n] = (1.0 if crash else 0.0) + (1.0 if gone_off else 0.0) + (
        1.0 if event & RED_LIGHT else 0.0)  # fmt: skip
    out.event[e, n], out.touched[e, n] = event, touched
    out.ended[e, n], out.late[e, n] = ended, late
    out.completion[e, n] = min(max(real[GONE, n] / max(real[GOAL, n], 1e-6), 0.0), 1.0)
