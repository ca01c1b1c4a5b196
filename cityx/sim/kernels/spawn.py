"""Where movers begin: a place on a lane that their body fits along, and a way from there."""

from __future__ import annotations

from math import hypot
from typing import Any

import numpy as np

from cityx.geometry.compiled import borrowing
from cityx.sim import dynamics
from cityx.sim.kernels.draws import drawn, mixed
from cityx.sim.kernels.lines import pose
from cityx.sim.kernels.tables import (
    ALIVE,
    ALONG,
    ASIDE,
    AT,
    BEFORE,
    CLEARED,
    DRAWS,
    GOAL,
    GOAL_M,
    GONE,
    HEADING,
    HEIGHT,
    KIND,
    LEAVES,
    LENGTH,
    LIFT,
    LIMIT,
    OUTSIDE,
    PEDAL_ACTION,
    PEOPLE,
    PIECE,
    POINT,
    SIZE,
    SPEED,
    STEER,
    STEER_ACTION,
    STEPS,
    TURNED,
    VEHICLE,
    WAITED,
    WIDTH,
    YAW_RATE,
    X,
    Y,
    Z,
)

TRIES = 40  # places that are drawn until one is free
FREE, FAR = 14.0, 60.0  # metres to others, and of traffic that comes anew to agents
ENDS = 0.5  # metres of a lane before and behind a body
AHEAD = 8  # pieces that the way of traffic is known ahead
SMALL, CAR, VAN = 0, 1, 2  # rows of vehicles
SHARES = (0.18, 0.88)  # of traffic: small cars, then with cars; the rest are vans


@borrowing
def begin_world(world: Any, here: Any, rules: Any, agents: int) -> None:
    """Begin an episode of a world: a new stream, then its agents, then its traffic.

    Rows between them are for people, who are not there yet. Traffic from outside is put there by
    who knows it.
    """
    here.episode[0] += 1
    here.key[0] = mixed(here.seed[0] ^ mixed(np.uint64(here.episode[0])))
    movers = here.real.shape[1]
    for n in range(movers):
        here.whole[DRAWS, n] = 0
        here.whole[ALIVE, n] = 0
    here.clock[0] = 3600.0 * drawn(here, 0)
    for n in range(agents):
        begin_agent(world, here, rules, n)
    if rules[OUTSIDE] > 0:
        return
    for n in range(agents + int(rules[PEOPLE]), movers):
        begin_traffic(world, here, n, agents, 0.0)


@borrowing
def begin_agent(world: Any, here: Any, rules: Any, n: int) -> None:
    """Put an agent on a lane with a route before it."""
    kind = int(rules[VEHICLE])
    dress(world, here, n, kind)
    wanted = rules[GOAL_M]
    for tried in range(TRIES):
        piece, along = place_to_start(world, here, n, kind)
        # In the first half of the tries only where a whole route leads on.
        if world.reach[piece, kind] - along < wanted + 3.0 and tried < TRIES // 2:
            continue
        set_down(world, here, n, piece, along)
        if tried == TRIES - 1 or is_free(here, n, here.real.shape[1], FREE):
            break
    here.real[GOAL, n] = route(world, here, n, kind, wanted)
    here.whole[ALIVE, n] = 1


@borrowing
def begin_traffic(world: Any, here: Any, n: int, agents: int, far: float) -> None:
    """Put a vehicle of the traffic on a lane; where there is no room it waits out of the world."""
    share = drawn(here, n)
    kind = SMALL if share < SHARES[0] else (CAR if share < SHARES[1] else VAN)
    dress(world, here, n, kind)
    here.whole[ALIVE, n] = 0
    here.whole[STEPS, n] = -1  # who counts no steps is no agent
    piece = -1
    for _ in range(TRIES):
        piece, along = place_to_start(world, here, n, kind)
        if piece < 0 or world.usable[piece, kind] < 2:
            continue
        set_down(world, here, n, piece, along)
        if not is_free(here, n, here.real.shape[1], FREE):
            continue
        if far > 0.0 and not is_free(here, n, agents, far):
            continue
        here.whole[ALIVE, n] = 1
        break
    if here.whole[ALIVE, n]:
        look_ahead(world, here, n)
        here.real[SPEED, n] = 0.5 * world.speed[piece]


@borrowing
def dress(world: Any, here: Any, n: int, kind: int) -> None:
    """Make a mover one of a kind, as new."""
    real, whole = here.real, here.whole
    for row in (SPEED, STEER, ALONG, ASIDE, TURNED, GONE, GOAL, LIFT, WAITED, YAW_RATE,
                STEER_ACTION, PEDAL_ACTION):  # fmt: skip
        real[row, n] = 0.0
    real[LENGTH, n] = world.vehicles[kind, dynamics.LENGTH]
    real[WIDTH, n] = world.vehicles[kind, dynamics.WIDTH]
    real[HEIGHT, n] = world.vehicles[kind, dynamics.HEIGHT]
    whole[KIND, n] = kind
    whole[AT, n] = 0
    whole[SIZE, n] = 0
    whole[POINT, n] = 0
    whole[BEFORE, n] = -1
    whole[CLEARED, n] = -1
    whole[LEAVES, n] = -1
    whole[STEPS, n] = 0


@borrowing
def place_to_start(world: Any, here: Any, n: int, kind: int) -> Any:
    """Draw a lane by its length, and metres along it; -1 where none is offered."""
    total = world.start[kind]
    if total[-1] <= 0.0:
        return -1, 0.0
    piece = np.searchsorted(total, drawn(here, n) * total[-1], side="right")
    piece = min(piece, len(total) - 1)
    half = here.real[LENGTH, n] / 2 + ENDS
    size = world.length[piece]
    share = drawn(here, n)
    return piece, size / 2 if size < 2 * half else half + share * (size - 2 * half)


@borrowing
def set_down(world: Any, here: Any, n: int, piece: int, along: float) -> None:
    """Put a mover on the line of a piece."""
    real, whole = here.real, here.whole
    x, y, z, heading, lift, point = pose(world, piece, along, world.point_start[piece])
    real[X, n], real[Y, n], real[Z, n], real[HEADING, n] = x, y, z, heading
    real[LIFT, n], real[ALONG, n], real[LIMIT, n] = lift, along, world.speed[piece]
    whole[PIECE, n], whole[POINT, n] = piece, point
    here.path[n, 0] = piece
    whole[SIZE, n] = 1


@borrowing
def is_free(here: Any, n: int, count: int, away: float) -> Any:
    """Return whether the first movers that are there are so far from one, in plan or in height."""
    real = here.real
    for m in range(count):
        if m == n or here.whole[ALIVE, m] == 0 or abs(real[Z, m] - real[Z, n]) > 3.0:
            continue
        if hypot(real[X, m] - real[X, n], real[Y, m] - real[Y, n]) < away:
            return False
    return True


@borrowing
def route(world: Any, here: Any, n: int, kind: int, wanted: float) -> Any:
    """Draw a way on for so many metres, never into what leads less far; return its metres."""
    whole, path = here.whole, here.path
    most = path.shape[1]
    piece = path[n, 0]
    left = world.length[piece] - here.real[ALONG, n]
    size = 1
    while left < wanted + 3.0 and size < most:
        need = wanted + 3.0 - left
        chosen, ways, far, longest = -1, 0, -1, -1.0
        for k in range(world.next_start[piece], world.next_start[piece + 1]):
            follow = world.next[k]
            if world.usable[follow, kind] == 0:
                continue
            if world.reach[follow, kind] > longest:
                far, longest = follow, world.reach[follow, kind]
            if world.reach[follow, kind] >= need:
                ways += 1
                if drawn(here, n) * ways < 1.0:
                    chosen = follow
        if chosen < 0:
            chosen = far
        if chosen < 0:
            break
        path[n, size] = chosen
        left += world.length[chosen]
        size += 1
        piece = chosen
    whole[SIZE, n] = size
    return min(wanted, left - 0.5)


@borrowing
def look_ahead(world: Any, here: Any, n: int) -> None:
    """Let traffic choose its way on, by chance, as far as it looks."""
    path, whole = here.path, here.whole
    kind = whole[KIND, n]
    size = whole[SIZE, n]
    while size < AHEAD:
        piece = path[n, size - 1]
        if piece < 0:
            break
        chosen, ways = -1, 0
        for k in range(world.next_start[piece], world.next_start[piece + 1]):
            follow = world.next[k]
            if world.usable[follow, kind] < 2:
                continue
            # Ways that lead nowhere are taken where there is no other.
            if world.across[follow] and world.reach[follow, kind] < 1.0:
                continue
            ways += 1
            if drawn(here, n) * ways < 1.0:
                chosen = follow
        if chosen < 0:
            break
        path[n, size] = chosen
        size += 1
    whole[SIZE, n] = size
