"""Background traffic: vehicles that follow lanes, each other, signals and right of way.

A way across a junction is used by whoever has been let onto it (`CLEARED`) or whose body is on it:
both are states of the vehicle itself, so that nothing is left behind when it goes.

References
----------
Treiber, Hennecke and Helbing, "Congested traffic states in empirical observations and microscopic
simulations", Physical Review E 62, 2000 (the intelligent driver model).
"""

from __future__ import annotations

from math import cos, hypot, sin, sqrt
from typing import Any

from cityx.geometry.compiled import borrowing
from cityx.sim import dynamics
from cityx.sim.kernels.lines import on_route, pose
from cityx.sim.kernels.tables import (
    ALIVE,
    ALONG,
    ASIDE,
    AT,
    BEFORE,
    CLEARED,
    HEADING,
    KIND,
    LEAVES,
    LENGTH,
    LIMIT,
    PIECE,
    POINT,
    SIZE,
    SPEED,
    STEPS,
    WAITED,
    WIDTH,
    X,
    Y,
    Z,
)

HEADWAY, GAP, COMFORT, HARDEST = 1.2, 2.0, 2.5, 8.0  # s, m, m/s2 and m/s2 of braking
SIGHT, LEVEL = 60.0, 2.5  # metres ahead that drivers look, and of height
NEAR = 2.2  # metres between middles within which one is in the way of the other
ARRIVES = 4.0  # seconds within which somebody with right of way counts as arriving
STANDS = 0.3  # m/s below which one stands
PATIENCE = 4.0  # seconds that one waits for others who stand as well

GREEN = 4  # states of signals from which on one may go; 3 is yellow

CORRIDOR, SPOT = 14.0, 1.0  # metres ahead on which agents are looked for, and between places
NOSE = 0.5  # metres over the line before a way across from which on one is in it
AIR, CREEPING = 0.3, 0.1  # metres beside a body, and those at a crawl
PACE_OF_AIR = 0.1  # metres more for each m/s


@borrowing
def shown(world: Any, signal: int, clock: float) -> Any:
    """Return the state that a signal shows."""
    first, last = world.signal_start[signal], world.signal_start[signal + 1]
    within = clock % world.cycle[signal]
    k = first
    while k < last - 1 and world.signal_time[k + 1] <= within + 1e-9:
        k += 1
    return world.signal_state[k]


@borrowing
def neighbours(world: Any, here: Any, n: int, near: Any) -> Any:
    """Write the rows of movers within sight of one at its height; return how many.

    Who is fast, or has a long way across before it, sees as far as somebody may be who was let onto
    a way that crosses it.
    """
    real, whole = here.real, here.whole
    x, y, z, count = real[X, n], real[Y, n], real[Z, n], 0
    asks, at = min(asked_from(real[SPEED, n]), SIGHT), whole[AT, n]
    sight = max(SIGHT, 2.0 * asks)
    if at + 1 < whole[SIZE, n] and world.across[here.path[n, at + 1]]:
        sight = max(sight, asks + 1.5 * world.length[here.path[n, at + 1]])
    for m in range(real.shape[1]):
        dx, dy = real[X, m] - x, real[Y, m] - y
        if m == n or dx * dx + dy * dy > sight * sight or whole[ALIVE, m] == 0:
            continue
        if abs(real[Z, m] - z) < LEVEL:
            near[count] = m
            count += 1
    return count


@borrowing
def asked_from(speed: float) -> Any:
    """Return metres before a junction from which one asks whether it may enter: those to stop."""
    return speed * speed / (2 * COMFORT) + 3.0


@borrowing
def leader(world: Any, here: Any, n: int, begin: float, near: Any, count: int) -> Any:
    """Return metres to the nearest body ahead on the way of a mover, and its speed.

    Parameters
    ----------
    begin
        Metres from the middle of the mover from which on bodies count.
    near, count
        Rows of those in sight, and how many.
    """
    real, whole, path = here.real, here.whole, here.path
    gap, speed = 1e9, 0.0
    at, size = whole[AT, n], whole[SIZE, n]
    own, along = real[LENGTH, n] / 2, real[ALONG, n]
    x, y = real[X, n], real[Y, n]
    for i in range(count):
        m = near[i]
        dx, dy = real[X, m] - x, real[Y, m] - y
        half = own + real[LENGTH, m] / 2
        on, before, leaves = whole[PIECE, m], whole[BEFORE, m], whole[LEAVES, m]
        agent = whole[STEPS, m] >= 0
        if agent and abs(real[ASIDE, m]) >= NEAR:
            on = -1
        to_start = -along
        for j in range(at, size):
            piece = path[n, j]
            if to_start > SIGHT:
                break
            away = 1e9
            if on == piece:
                away = to_start + real[ALONG, m]
            elif leaves == piece:
                away = to_start + along_left(world, here, m)
            elif before == piece:  # it has gone another way, or its tail is here
                away = to_start + world.length[piece] + real[ALONG, m]
                if real[ALONG, m] > real[LENGTH, m] / 2 + 0.5 and not beside(
                    world, here, n, m, j, away - to_start - world.length[piece]
                ):
                    away = 1e9
            if away > begin and away - half < gap:
                gap, speed = away - half, real[SPEED, m]
            to_start += world.length[piece]
        if (
            whole[BEFORE, m] == whole[BEFORE, n] >= 0  # ways across that begin at one lane
            and whole[PIECE, m] != path[n, at]
            and 0.0 < real[ALONG, m] - along < gap + half
            and beside(world, here, n, m, at - 1, real[ALONG, m])
        ):
            gap, speed = real[ALONG, m] - along - half, real[SPEED, m]
        if agent and dx * dx + dy * dy < CORRIDOR * CORRIDOR:
            away = until_in_the_way(world, here, n, m)
            if away - own < gap:
                ahead = cos(real[HEADING, m] - real[HEADING, n])
                gap, speed = away - own, max(real[SPEED, m] * ahead, 0.0)
    return gap, speed


@borrowing
def along_left(world: Any, here: Any, m: int) -> Any:
    """Return metres along the lane that a mover leaves for the one beside it."""
    lane, onto = here.whole[LEAVES, m], here.whole[PIECE, m]
    return here.real[ALONG, m] * world.length[lane] / world.length[onto]


@borrowing
def on_lane(world: Any, here: Any, n: int, lane: int, along: float, near: Any, count: int) -> Any:
    """Return the gaps that a mover would have on a lane, and the speeds of who makes them.

    Parameters
    ----------
    lane, along
        A lane, and metres from its start to the middle of the mover.
    near, count
        Rows of those in sight, and how many.

    Returns
    -------
    gap, ahead, back, behind
        Metres to the body ahead and its m/s, metres to the body behind and its m/s; 1e9 metres
        where there is none, less than 0 where one is beside it. Agents count wherever they are;
        so do vehicles that are yet to come onto the lane.
    """
    real, whole, path = here.real, here.whole, here.path
    gap, ahead, back, behind = 1e9, 0.0, 1e9, 0.0
    x, y, _, heading, _, _ = pose(world, lane, along, world.point_start[lane])
    c, s = cos(heading), sin(heading)
    for i in range(count):
        m = near[i]
        half = (real[LENGTH, n] + real[LENGTH, m]) / 2
        if whole[STEPS, m] >= 0:
            dx, dy = real[X, m] - x, real[Y, m] - y
            if abs(dy * c - dx * s) > NEAR:
                continue
            away = dx * c + dy * s
        elif whole[PIECE, m] == lane:
            away = real[ALONG, m] - along
        elif whole[LEAVES, m] == lane:
            away = along_left(world, here, m) - along
        elif whole[BEFORE, m] == lane:
            away = world.length[lane] + real[ALONG, m] - along
        elif whole[SIZE, m] > 1 and path[m, 1] == lane:
            away = real[ALONG, m] - world.length[whole[PIECE, m]] - along
        else:
            continue
        if away >= 0.0:
            if away - half < gap:
                gap, ahead = away - half, real[SPEED, m]
        elif -away - half < back:
            back, behind = -away - half, real[SPEED, m]
    return gap, ahead, back, behind


@borrowing
def until_in_the_way(world: Any, here: Any, n: int, m: int) -> Any:
    """Return metres on its way until the middle of a mover would be at a body; 1e9 if it misses.

    Agents need not be on lanes, so their bodies count wherever they are.
    """
    real = here.real
    c, s = cos(real[HEADING, m]), sin(real[HEADING, m])
    # Who crawls keeps less air: else it and somebody at the kerb wait for each other for good.
    wide = real[WIDTH, n] / 2 + min(AIR, CREEPING + PACE_OF_AIR * real[SPEED, n])
    long, broad = real[LENGTH, m] / 2 + wide, real[WIDTH, m] / 2 + wide
    along, at, near = real[ALONG, n], here.whole[AT, n], here.whole[POINT, n]
    away = 0.0
    while away < CORRIDOR:
        away += SPOT
        there, along, at = on_route(world, here, n, along + SPOT, at, near)
        near = there[5]
        dx, dy = there[0] - real[X, m], there[1] - real[Y, m]
        if abs(dx * c + dy * s) < long and abs(dy * c - dx * s) < broad:
            return away
    return 1e9


@borrowing
def beside(world: Any, here: Any, n: int, m: int, j: int, beyond: float) -> Any:
    """Return whether who went another way is still beside the one that a mover will take."""
    if j + 1 >= here.whole[SIZE, n]:
        return False
    follow = here.path[n, j + 1]
    if beyond > world.length[follow]:
        return False
    there = pose(world, follow, beyond, world.point_start[follow])
    away = hypot(here.real[X, m] - there[0], here.real[Y, m] - there[1])
    return away < NEAR + abs(here.real[LENGTH, m]) / 4


@borrowing
def is_on(here: Any, m: int, piece: int) -> Any:
    """Return whether a mover has been let onto a way across, or part of it is there."""
    whole = here.whole
    if whole[PIECE, m] == piece or whole[CLEARED, m] == piece:
        return True
    if whole[BEFORE, m] != piece:
        return False
    return here.real[ALONG, m] < here.real[LENGTH, m] / 2 + 0.7


@borrowing
def may_enter(world: Any, here: Any, n: int, j: int, distance: float, near: Any, count: int) -> Any:
    """Return whether a vehicle may go onto the way across that is the j-th of its path.

    Nobody may who has no room behind it, who would meet somebody that is on a way that crosses it,
    or who would make somebody with right of way brake.
    """
    real, whole, path = here.real, here.whole, here.path
    piece = path[n, j]
    signal = world.signal[piece]
    if signal >= 0:
        state = shown(world, signal, here.clock[0])
        if state < GREEN:
            braking = real[SPEED, n] * real[SPEED, n] / (2 * max(distance, 0.1))
            if state != 3 or braking < 3.5:
                return False
    # Room behind it; where its way ends there is nobody in it.
    room, need, taken = 0.0, real[LENGTH, n] + GAP, False
    for k in range(j + 1, whole[SIZE, n]):
        free = world.length[path[n, k]]
        for i in range(count):
            m = near[i]
            if real[SPEED, m] < 3.0 and whole[PIECE, m] == path[n, k]:
                free = min(free, real[ALONG, m] - real[LENGTH, m] / 2)
        room += free
        taken = free < world.length[path[n, k]]
        if taken or room >= need:
            break
    if taken and room < need:
        return False
    mine = (distance + world.length[piece] + real[LENGTH, n]) / max(real[SPEED, n], 4.0)
    for k in range(world.conflict_start[piece], world.conflict_start[piece + 1]):
        other = world.conflict[k]
        for i in range(count):
            m = near[i]
            if is_on(here, m, other):
                return False
            if not world.yields[k]:
                continue
            at = whole[AT, m]
            if at + 1 >= whole[SIZE, m] or path[m, at + 1] != other:
                continue
            signal = world.signal[other]
            if signal >= 0 and shown(world, signal, here.clock[0]) < GREEN:
                continue
            if real[SPEED, m] < STANDS and real[WAITED, n] > PATIENCE + real[WAITED, m]:
                continue
            left = world.length[whole[PIECE, m]] - real[ALONG, m] - real[LENGTH, m] / 2
            if left < max(real[SPEED, m], 2.0) * (ARRIVES if mine < ARRIVES else mine):
                return False
    return True


@borrowing
def let_on(world: Any, here: Any, n: int) -> None:
    """Let an agent onto the way across that its nose is in, if nobody is on one that crosses it.

    Nobody lets agents onto junctions. One whose nose is over the line, and which then has to wait
    for who was let on after it and cannot pass its nose, would wait for good.
    """
    real, whole, path = here.real, here.whole, here.path
    at, held = whole[AT, n], whole[CLEARED, n]
    whole[CLEARED, n] = -1
    if at + 1 >= whole[SIZE, n] or not world.across[path[n, at + 1]]:
        return
    piece = path[n, at + 1]
    if world.length[path[n, at]] - real[ALONG, n] - real[LENGTH, n] / 2 > -NOSE:
        return
    signal = world.signal[piece]
    if signal >= 0 and shown(world, signal, here.clock[0]) < GREEN:
        return
    if held != piece:
        for k in range(world.conflict_start[piece], world.conflict_start[piece + 1]):
            for m in range(real.shape[1]):
                if m != n and whole[ALIVE, m] != 0 and is_on(here, m, world.conflict[k]):
                    return
    whole[CLEARED, n] = piece


@borrowing
def acceleration(world: Any, here: Any, n: int, near: Any, marks: bool) -> Any:
    """Return the m/s2 that a driver wants, and metres that are surely free ahead.

    Beside them are the metres to the body ahead, its m/s, and how many movers are in sight.
    Junctions within the way of braking are asked for; whoever may enter is let onto them, which
    is written to the state if it `marks`.
    """
    real, whole, path = here.real, here.whole, here.path
    kind = whole[KIND, n]
    speed, own = real[SPEED, n], real[LENGTH, n] / 2
    most = world.vehicles[kind, dynamics.ACCEL]
    count = neighbours(world, here, n, near)
    gap, ahead = leader(world, here, n, 0.0, near, count)
    lane = whole[LEAVES, n]
    if lane >= 0:  # it is on the way of those on either lane
        other, its, _, _ = on_lane(world, here, n, lane, along_left(world, here, n), near, count)
        if other < gap:
            gap, ahead = max(other, 0.0), its
    wanted = min(real[LIMIT, n], world.vehicles[kind, dynamics.TOP])
    to_start = -real[ALONG, n]
    at = whole[AT, n]
    line = 1e9
    for j in range(at, whole[SIZE, n]):
        piece = path[n, j]
        if j > at:
            if to_start > SIGHT:
                break
            wanted = min(wanted, sqrt(world.speed[piece] ** 2 + 2 * COMFORT * max(to_start, 0.0)))
            if world.across[piece] and line > 1e8:
                distance = to_start - own
                if whole[CLEARED, n] != piece:
                    asks = asked_from(speed)
                    if distance < asks and distance > -own:
                        if gap > distance and may_enter(world, here, n, j, distance, near, count):
                            if marks:
                                whole[CLEARED, n] = piece
                        else:
                            line = max(distance, 0.0)
                    elif distance >= asks:
                        line = distance  # not asked yet: be able to stop
        to_start += world.length[piece]
    free = gap
    give = most * (1.0 - (speed / max(wanted, 0.5)) ** 4)
    give = min(give, held_back(speed, ahead, gap, most, GAP))
    if line < 1e8:
        give = min(give, held_back(speed, 0.0, line + 1.2, most, 1.0))
        free = min(free, line)
    return max(give, -HARDEST), free, gap, ahead, count


@borrowing
def held_back(speed: float, ahead: float, gap: float, most: float, least: float) -> Any:
    """Return the m/s2 behind something at a distance."""
    if gap > 1e8:
        return most
    wanted = least + max(
        speed * HEADWAY + speed * (speed - ahead) / (2 * sqrt(most * COMFORT)), 0.0
    )
    return most * (1.0 - (speed / 15.0) ** 4 - (wanted / max(gap, 0.1)) ** 2)
