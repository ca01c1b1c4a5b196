"""A driver by rule: it pursues its route and keeps the rules that the traffic keeps."""

from __future__ import annotations

from math import atan, atan2, cos, hypot, sin, tan
from typing import Any

import numpy as np

from cityx.geometry.compiled import borrowing, compiled
from cityx.sim import dynamics
from cityx.sim.kernels.changes import OUT, abreast, passing_lane, steepest
from cityx.sim.kernels.idm import acceleration, held_back, on_lane
from cityx.sim.kernels.lines import on_route, pose, wrapped
from cityx.sim.kernels.one import world_at
from cityx.sim.kernels.step import ANSWER, FASTEST_TARGET, HARDEST_JERK, SLEW
from cityx.sim.kernels.tables import (
    ALONG,
    ASIDE,
    AT,
    CONTROL,
    DT,
    HEADING,
    JERK,
    KIND,
    LENGTH,
    PEDAL_ACTION,
    POINT,
    SPEED,
    STEER,
    TARGET,
    X,
    Y,
)

HOLD = 10.0  # metres before the end of the lane beside at which it waits to come back
NEAREST, FARTHEST, SECONDS = 1.8, 8.0, 0.5  # metres and seconds ahead that it steers for


@compiled
def pursue(
    world: Any, batch: Any, rules: Any, action: Any, agents: int, low: int, high: int
) -> None:
    """Write what the driver does to (E, A, 2) actions; the state is only read."""
    near = np.empty(batch.real.shape[2], np.int64)
    for e in range(low, high):
        here = world_at(batch, e)
        for n in range(agents):
            steer, pedal = driver(world, here, rules, n, near)
            action[e, n, 0], action[e, n, 1] = steer, pedal


@borrowing
def driver(world: Any, here: Any, rules: Any, n: int, near: Any) -> Any:
    """Return the two numbers of an action.

    Its middle goes along an arc to a place ahead on the route; of a bicycle it goes aside of where
    the body heads by an angle whose tangent is half that of the steering, and the arc bends by
    twice the sine of that angle over the wheelbase. Whoever went straight for the place would run
    inside of every bend.

    References
    ----------
    Coulter, "Implementation of the pure pursuit path tracking algorithm", CMU-RI-TR-92-01, 1992.
    """
    real = here.real
    own = world.vehicles[here.whole[KIND, n]]
    speed, heading = real[SPEED, n], real[HEADING, n]
    ahead = min(max(speed * SECONDS, NEAREST), FARTHEST)
    there, _, _ = on_route(
        world, here, n, real[ALONG, n] + ahead, here.whole[AT, n], here.whole[POINT, n]
    )
    x, y = there[0], there[1]
    lane, holds = passing_lane(world, here, n, near)
    if lane >= 0 or abs(real[ASIDE, n]) > OUT:
        x, y = on_the_way_over(world, here, n, lane, ahead)
    x, y = x - real[X, n], y - real[Y, n]
    aside = min(max(wrapped(atan2(y, x) - heading), -1.2), 1.2)
    turn = atan(2.0 * tan(aside / (1.0 + hypot(x, y) / own[dynamics.WHEELBASE])))
    steer = min(max(turn / own[dynamics.STEER], -1.0), 1.0)
    give, free = wish(world, here, n, lane, holds, near)
    give = min(give, (max(free - 0.5, 0.0) / rules[DT] - speed) / rules[DT])
    if rules[CONTROL] == TARGET:
        wanted = min(max(speed + give * ANSWER, 0.0), FASTEST_TARGET)
        return steer, 2.0 * wanted / FASTEST_TARGET - 1.0
    most = own[dynamics.ACCEL] if give > 0 else own[dynamics.BRAKE]
    pedal = min(max(give / most, -1.0), 1.0)
    if rules[CONTROL] == JERK:
        turn = (steer * own[dynamics.STEER] - real[STEER, n]) / (SLEW * rules[DT])
        limit = own[dynamics.ACCEL] if real[PEDAL_ACTION, n] > 0 else own[dynamics.BRAKE]
        push = (pedal - real[PEDAL_ACTION, n]) * limit / (HARDEST_JERK * rules[DT])
        return min(max(turn, -1.0), 1.0), min(max(push, -1.0), 1.0)
    return steer, pedal


@borrowing
def on_the_way_over(world: Any, here: Any, n: int, lane: int, ahead: float) -> Any:
    """Return a place ahead towards the lane beside, or back to the route if `lane` is -1."""
    real, whole = here.real, here.whole
    along, aside = real[ALONG, n], real[ASIDE, n]
    if lane < 0:
        place, _, _ = on_route(world, here, n, along + ahead, whole[AT, n], whole[POINT, n])
    else:
        along, aside = abreast(world, here, n, lane)
        place = pose(world, lane, along + ahead, world.point_start[lane])
    most = steepest(real[SPEED, n]) * ahead
    left = aside - min(max(aside, -most), most)
    return place[0] - sin(place[3]) * left, place[1] + cos(place[3]) * left


@borrowing
def wish(world: Any, here: Any, n: int, lane: int, holds: bool, near: Any) -> Any:
    """Return the m/s2 that it wants, and metres that are surely free ahead, on its lane or beside.

    Beside it keeps the rules as if its route led there; until it is out it heeds who is ahead on
    either lane.
    """
    real, whole, path = here.real, here.whole, here.path
    if lane < 0:
        give, free, _, _, _ = acceleration(world, here, n, near, False)
        return give, free
    at = whole[AT, n]
    piece, along, point = path[n, at], real[ALONG, n], whole[POINT, n]
    left = world.length[piece] - along - real[LENGTH, n] / 2
    beside, aside = abreast(world, here, n, lane)
    path[n, at], real[ALONG, n], whole[POINT, n] = lane, beside, world.point_start[lane]
    give, free, _, _, count = acceleration(world, here, n, near, False)
    path[n, at], real[ALONG, n], whole[POINT, n] = piece, along, point
    speed, most = real[SPEED, n], world.vehicles[whole[KIND, n], dynamics.ACCEL]
    if abs(aside) > OUT:
        gap, ahead, _, _ = on_lane(world, here, n, piece, along, near, count)
        if gap > 0.0:
            give, free = min(give, held_back(speed, ahead, gap, most, 1.0)), min(free, gap)
    if holds:
        line = max(left - HOLD, 0.0)
        give, free = min(give, held_back(speed, 0.0, line + 1.2, most, 1.0)), min(free, line)
    return give, free
