"""Traffic moves: along its way, from lane to lane, and elsewhere where it is stuck."""

from __future__ import annotations

from math import atan, cos, hypot, sin
from typing import Any

from cityx.geometry.compiled import borrowing
from cityx.sim.kernels.changes import OUT, better_lane, change_to, slope_towards
from cityx.sim.kernels.idm import STANDS, acceleration
from cityx.sim.kernels.lines import pose
from cityx.sim.kernels.spawn import begin_traffic, look_ahead
from cityx.sim.kernels.tables import (
    ALIVE,
    ALONG,
    ASIDE,
    BEFORE,
    CLEARED,
    DT,
    GONE,
    HEADING,
    LEAVES,
    LIFT,
    LIMIT,
    OUTSIDE,
    PIECE,
    POINT,
    SIZE,
    SPEED,
    TURNED,
    WAITED,
    YAW_RATE,
    X,
    Y,
    Z,
)

STUCK, UNSEEN = 60.0, 40.0  # seconds one stands before it goes elsewhere, metres out of sight
ANEW = 1.0  # seconds after which who found no place looks for one again
EVERY = 10  # steps between two looks at the lanes beside
STRAIGHT = 0.02  # metres aside, and of slope, from which on one is on the line


@borrowing
def drive_traffic(world: Any, here: Any, rules: Any, first: int, agents: int, near: Any) -> None:
    """Move the traffic of a world, rows from `first` on, by one step, one after the other.

    What goes elsewhere does so out of sight of the first `agents` movers. Traffic from outside is
    moved by who knows it.
    """
    if rules[OUTSIDE] > 0:
        return
    real, whole = here.real, here.whole
    dt = rules[DT]
    now = int(here.clock[0] / dt + 0.5)
    for n in range(first, real.shape[1]):
        if whole[ALIVE, n] == 0:
            real[WAITED, n] += dt
            if real[WAITED, n] > ANEW:
                begin_traffic(world, here, n, agents, UNSEEN)
            continue
        give, free, gap, ahead, count = acceleration(world, here, n, near, True)
        speed = max(real[SPEED, n] + give * dt, 0.0)
        speed = min(speed, max(free - 0.2, 0.0) / dt)
        real[SPEED, n] = speed
        real[WAITED, n] = real[WAITED, n] + dt if speed < STANDS else 0.0
        if real[WAITED, n] > STUCK and unseen(here, n, agents):
            begin_traffic(world, here, n, agents, UNSEEN)
            continue
        advance(world, here, n, agents, speed * dt)
        piece = here.path[n, 0]
        if (now + n) % EVERY == 0 and (world.beside[piece, 0] >= 0 or world.beside[piece, 1] >= 0):
            lane = better_lane(world, here, n, gap, ahead, near, count)
            if lane >= 0:
                change_to(world, here, n, lane)


@borrowing
def unseen(here: Any, n: int, agents: int) -> Any:
    """Return whether no agent is near a mover."""
    real = here.real
    for m in range(agents):
        if hypot(real[X, m] - real[X, n], real[Y, m] - real[Y, n]) < UNSEEN:
            return False
    return True


@borrowing
def advance(world: Any, here: Any, n: int, agents: int, metres: float) -> None:
    """Move a vehicle along its way; where that ends it goes elsewhere."""
    real, whole, path = here.real, here.whole, here.path
    along = real[ALONG, n] + metres
    real[GONE, n] += metres
    piece = path[n, 0]
    while along > world.length[piece]:
        if whole[SIZE, n] < 2:
            begin_traffic(world, here, n, agents, UNSEEN)
            return
        along -= world.length[piece]
        whole[BEFORE, n] = piece
        for k in range(1, whole[SIZE, n]):
            path[n, k - 1] = path[n, k]
        whole[SIZE, n] -= 1
        look_ahead(world, here, n)
        piece = path[n, 0]
        whole[POINT, n] = world.point_start[piece]
        whole[LEAVES, n] = -1
        if whole[CLEARED, n] == piece:
            whole[CLEARED, n] = -1
    x, y, z, heading, lift, point = pose(world, piece, along, whole[POINT, n])
    real[YAW_RATE, n] = 0.0
    if real[ASIDE, n] != 0.0:
        slope = slope_towards(real[ASIDE, n], real[TURNED, n], real[SPEED, n], metres)
        aside = real[ASIDE, n] + slope * metres
        if abs(aside) < STRAIGHT and abs(slope) < STRAIGHT:
            slope = aside = 0.0
        if abs(aside) < OUT:
            whole[LEAVES, n] = -1
        real[ASIDE, n], real[TURNED, n] = aside, slope
        x, y = x - sin(heading) * aside, y + cos(heading) * aside
        heading += atan(slope)
    real[X, n], real[Y, n], real[Z, n] = x, y, z
    real[HEADING, n], real[LIFT, n] = heading, lift
    real[ALONG, n], real[LIMIT, n] = along, world.speed[piece]
    whole[PIECE, n], whole[POINT, n] = piece, point
