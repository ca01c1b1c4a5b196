"""One step of the worlds: agents move, touch, leave the road, arrive, and begin anew."""

from __future__ import annotations

from math import cos, sin, tan
from typing import Any

import numpy as np

from cityx.geometry.compiled import borrowing, compiled
from cityx.sim import dynamics
from cityx.sim.kernels.boxes import (
    boxes_touch,
    cell_of,
    cell_value,
    first_touched,
    over_each_other,
    wheels_off,
)
from cityx.sim.kernels.idm import GREEN, let_on, shown
from cityx.sim.kernels.lines import follow, wrapped
from cityx.sim.kernels.observe import NEIGHBOURS, ON_FOOT, look
from cityx.sim.kernels.one import world_at
from cityx.sim.kernels.people import begin_person, walk_people
from cityx.sim.kernels.spawn import begin_agent, begin_world
from cityx.sim.kernels.tables import (
    ALIVE,
    ASIDE,
    CONTROL,
    CRASH_HUMAN,
    CRASH_OBJECT,
    CRASH_VEHICLE,
    CRASHING,
    DRIVING,
    DT,
    GOAL,
    GOAL_REACHED,
    GONE,
    HEADING,
    HEIGHT,
    HITTING,
    HORIZON,
    JERK,
    KIND,
    LATE,
    LEAVING,
    LENGTH,
    LIFT,
    OFF_ROAD,
    OFF_ROUTE,
    PEDAL_ACTION,
    PEOPLE,
    RED_ENDS,
    RED_LIGHT,
    SPEED,
    SPEEDING,
    STEER,
    STEER_ACTION,
    STEPS,
    SUCCESS,
    TARGET,
    TOP_REWARD,
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
    WRONG_WAY,
    YAW_RATE,
    X,
    Y,
    Z,
)
from cityx.sim.kernels.traffic import drive_traffic

SLEW = 1.2  # radians per second that front wheels turn
HARDEST_JERK = 15.0  # m/s3
ANSWER = 0.5  # seconds in which a wanted speed is reached
FASTEST_TARGET = 15.0  # m/s of the greatest action where it is a speed
WHEELS, ALL = 2, 4  # beside the roadway, from which one has left it; a bicycle has two, as four
ASTRAY = 10.0  # metres from its route at which an agent has lost it
AGAINST = 1.75  # radians to its route from which one goes the wrong way
ARRIVED = 0.5  # metres
STANDS = 0.3
NEAR = 45.0  # metres from an agent that people begin


@compiled
def step_worlds(
    world: Any, paths: Any, batch: Any, rules: Any, action: Any, out: Any, preset: int, view: Any,
    final: Any, agents: int, low: int, high: int,
) -> None:  # fmt: skip
    """Step worlds `low` to `high`; see `cityx.sim.kernels.tables` for what the tuples hold.

    Parameters
    ----------
    paths
        `cityx.sim.kernels.paths.Paths` where there are people, else None.
    action
        (E, A, 2) float64 between -1 and 1: steer, then pedals or speed.
    preset, view
        Of `cityx.sim.kernels.observe`, and (E, A, d) float32 that takes what is observed.
    final
        As `view`: what those observed last whose episodes ended; these begin anew. Where it has
        no world, nobody does.
    agents
        A.
    """
    near = np.empty(batch.real.shape[2], np.int64)
    nearest, square = np.empty(NEIGHBOURS, np.int64), np.empty(NEIGHBOURS)
    feet = agents + int(rules[PEOPLE])
    for e in range(low, high):
        here = world_at(batch, e)
        here.clock[0] += rules[DT]
        drive_traffic(world, here, rules, feet, agents, near)
        if paths is not None:
            walk_people(world, paths, here, rules, agents, agents, feet, NEAR)
        for n in range(agents):
            if here.whole[ALIVE, n] != 0:
                move(world, here, rules, action[e, n, 0], action[e, n, 1], n)
        for n in range(agents):
            if here.whole[ALIVE, n] != 0:
                judge(world, here, rules, out, e, n)
            else:
                nothing(out, e, n)
        for n in range(agents):
            look(world, here, rules, preset, n, view[e, n], nearest, square)
        if len(final) == 0:
            continue
        for n in range(agents):
            if out.ended[e, n] or out.late[e, n]:
                final[e, n] = view[e, n]
                if rules[WHOLE_RESET] > 0:
                    begin_all(world, paths, here, rules, agents)
                else:
                    begin_agent(world, here, rules, n)
                look(world, here, rules, preset, n, view[e, n], nearest, square)


@compiled
def begin_worlds(world: Any, paths: Any, batch: Any, rules: Any, agents: int, chosen: Any) -> None:
    """Begin the next episode of chosen worlds, (E,) bool."""
    for e in np.flatnonzero(chosen):
        begin_all(world, paths, world_at(batch, e), rules, agents)


@borrowing
def begin_all(world: Any, paths: Any, here: Any, rules: Any, agents: int) -> None:
    """Begin an episode of a world with its people, if it has any."""
    begin_world(world, here, rules, agents)
    if paths is not None:
        for n in range(agents, agents + int(rules[PEOPLE])):
            begin_person(paths, here, n, agents, NEAR, True)


@borrowing
def nothing(out: Any, e: int, n: int) -> None:
    """Note that nothing happened to an agent that has left the world."""
    out.reward[e, n] = out.cost[e, n] = 0.0
    out.event[e, n], out.touched[e, n] = 0, -1
    out.ended[e, n] = out.late[e, n] = False
    for row in range(out.term.shape[0]):
        out.term[row, e, n] = 0.0


@borrowing
def move(world: Any, here: Any, rules: Any, steering: float, pedal: float, n: int) -> None:
    """Move an agent as a bicycle does about its rear axle, its middle being half of that ahead."""
    real = here.real
    own = world.vehicles[here.whole[KIND, n]]
    dt = rules[DT]
    one = min(max(steering, -1.0), 1.0)
    two = min(max(pedal, -1.0), 1.0)
    if rules[CONTROL] == JERK:
        one = min(max(real[STEER, n] + one * SLEW * dt, -own[dynamics.STEER]), own[dynamics.STEER])
        one /= own[dynamics.STEER]
        limit = own[dynamics.ACCEL] if real[PEDAL_ACTION, n] > 0 else own[dynamics.BRAKE]
        two = min(max(real[PEDAL_ACTION, n] + two * HARDEST_JERK * dt / limit, -1.0), 1.0)
        if real[SPEED, n] <= 0.0:
            two = max(two, 0.0)  # who stands need not let go of the brake first
    turn = one * own[dynamics.STEER] - real[STEER, n]
    steer = real[STEER, n] + min(max(turn, -SLEW * dt), SLEW * dt)
    speed = real[SPEED, n]
    if rules[CONTROL] == TARGET:
        wanted = (two + 1.0) / 2.0 * FASTEST_TARGET
        push = min(max((wanted - speed) / ANSWER, -own[dynamics.BRAKE]), own[dynamics.ACCEL])
    else:
        push = two * (own[dynamics.ACCEL] if two > 0 else own[dynamics.BRAKE])
    after = min(max(speed + push * dt, 0.0), own[dynamics.TOP])
    mean = (speed + after) / 2
    base = own[dynamics.WHEELBASE]
    rate = mean * tan(steer) / base
    heading = real[HEADING, n]
    rear_x = real[X, n] - base / 2 * cos(heading)
    rear_y = real[Y, n] - base / 2 * sin(heading)
    middle = heading + rate * dt / 2
    rear_x += mean * dt * cos(middle)
    rear_y += mean * dt * sin(middle)
    heading = wrapped(heading + rate * dt)
    real[X, n] = rear_x + base / 2 * cos(heading)
    real[Y, n] = rear_y + base / 2 * sin(heading)
    real[HEADING, n], real[SPEED, n], real[STEER, n] = heading, after, steer
    real[YAW_RATE, n] = rate
    real[STEER_ACTION, n], real[PEDAL_ACTION, n] = one, two
    real[WAITED, n] = real[WAITED, n] + dt if after < STANDS else 0.0


@borrowing
def touched_mover(here: Any, n: int) -> Any:
    """Return the first mover that an agent overlaps, -1 for none."""
    real = here.real
    for m in range(real.shape[1]):
        if m == n or here.whole[ALIVE, m] == 0:
            continue
        if over_each_other(real, n, m):
            continue
        if boxes_touch(real[X, n], real[Y, n], real[HEADING, n], real[LENGTH, n] / 2,
                       real[WIDTH, n] / 2, real[X, m], real[Y, m], real[HEADING, m],
                       real[LENGTH, m] / 2, real[WIDTH, m] / 2):  # fmt: skip
            return m
    return -1


@borrowing
def touched_segment(world: Any, here: Any, n: int) -> Any:
    """Return the first segment that an agent stands in, -1 for none."""
    real = here.real
    x, y = real[X, n], real[Y, n]
    half_length, half_width = real[LENGTH, n] / 2, real[WIDTH, n] / 2
    row, column = cell_of(x, y, world.frame)
    if row >= 0 and cell_value(world.clear, row, column) * 0.1 > half_length + half_width:
        return -1
    return first_touched(
        x, y, real[Z, n], real[HEADING, n], half_length, half_width, real[HEIGHT, n],
        world.segment, world.cell_start, world.cell_segment, world.grid,
    )  # fmt: skip


@borrowing
def judge(world: Any, here: Any, rules: Any, out: Any, e: int, n: int) -> None:
    """Find what happened to an agent, and what that is worth."""
    real, whole = here.real, here.whole
    own = world.vehicles[whole[KIND, n]]
    before = real[GONE, n]
    crossed = follow(world, here, n)
    let_on(world, here, n)
    whole[STEPS, n] += 1
    event, touched = 0, -1
    other = touched_mover(here, n)
    if other >= 0:
        event |= CRASH_HUMAN if real[LENGTH, other] < ON_FOOT else CRASH_VEHICLE
        touched = -2 - other
    else:
        touched = touched_segment(world, here, n)
        if touched >= 0:
            event |= CRASH_OBJECT
    if wheels_off(real[X, n], real[Y, n], real[HEADING, n], own[dynamics.WHEELBASE] / 2,
                  own[dynamics.TRACK] / 2, real[LIFT, n], world.flags, world.frame) >= (
        WHEELS if own[dynamics.TRACK] > 0.0 else ALL
    ):  # fmt: skip
        event |= OFF_ROAD
    if abs(real[ASIDE, n]) > ASTRAY:
        event |= OFF_ROUTE
    if abs(real[TURNED, n]) > AGAINST and real[SPEED, n] > STANDS:
        event |= WRONG_WAY
    if crossed >= 0 and world.signal[crossed] >= 0 and shown(
        world, world.signal[crossed], here.clock[0]
    ) < GREEN - 1:  # fmt: skip
        event |= RED_LIGHT
    if real[GONE, n] >= real[GOAL, n] - ARRIVED:
        event |= GOAL_REACHED
    crash = event & (CRASH_VEHICLE | CRASH_OBJECT | CRASH_HUMAN)
    gone_off = event & (OFF_ROAD | OFF_ROUTE)
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
    elif event & (CRASH_VEHICLE | CRASH_HUMAN):
        out.term[CRASHING, e, n] = -rules[W_CRASH]
    elif event & CRASH_OBJECT:
        out.term[HITTING, e, n] = -rules[W_HIT]
    else:
        right = 0.0 if event & WRONG_WAY else 1.0
        out.term[DRIVING, e, n] = rules[W_DRIVING] * (real[GONE, n] - before)
        out.term[SPEEDING, e, n] = rules[W_SPEED] * right * real[SPEED, n] / rules[TOP_REWARD]
    total = 0.0
    for row in range(6):
        total += out.term[row, e, n]
    out.reward[e, n] = total
    out.cost[e, n] = (1.0 if crash else 0.0) + (1.0 if gone_off else 0.0) + (
        1.0 if event & RED_LIGHT else 0.0) + (1.0 if event & WRONG_WAY else 0.0)  # fmt: skip
    out.event[e, n], out.touched[e, n] = event, touched
    out.ended[e, n], out.late[e, n] = ended, late
    out.completion[e, n] = min(max(real[GONE, n] / max(real[GOAL, n], 1e-6), 0.0), 1.0)
