"""A driver by rule: it pursues its route and keeps the rules that the traffic keeps."""

from __future__ import annotations

from math import atan, atan2, tan
from typing import Any

import numpy as np

from cityx.geometry.compiled import borrowing, compiled
from cityx.sim import dynamics
from cityx.sim.kernels.idm import acceleration
from cityx.sim.kernels.lines import on_route, wrapped
from cityx.sim.kernels.one import world_at
from cityx.sim.kernels.step import ANSWER, FASTEST_TARGET
from cityx.sim.kernels.tables import (
    ALONG,
    AT,
    CONTROL,
    DT,
    HEADING,
    KIND,
    POINT,
    SPEED,
    TARGET,
    X,
    Y,
)

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

    Its middle goes straight for a place ahead on the route; of a bicycle it goes aside of where
    the body heads by half the tangent of the steering.
    """
    real = here.real
    own = world.vehicles[here.whole[KIND, n]]
    speed, heading = real[SPEED, n], real[HEADING, n]
    ahead = min(max(speed * SECONDS, NEAREST), FARTHEST)
    there, _, _ = on_route(
        world, here, n, real[ALONG, n] + ahead, here.whole[AT, n], here.whole[POINT, n]
    )
    aside = wrapped(atan2(there[1] - real[Y, n], there[0] - real[X, n]) - heading)
    turn = atan(2.0 * tan(min(max(aside, -1.2), 1.2)))
    steer = min(max(turn / own[dynamics.STEER], -1.0), 1.0)
    give, free = acceleration(world, here, n, near, False)
    give = min(give, (max(free - 0.5, 0.0) / rules[DT] - speed) / rules[DT])
    if rules[CONTROL] == TARGET:
        wanted = min(max(speed + give * ANSWER, 0.0), FASTEST_TARGET)
        return steer, 2.0 * wanted / FASTEST_TARGET - 1.0
    most = own[dynamics.ACCEL] if give > 0 else own[dynamics.BRAKE]
    return steer, min(max(give / most, -1.0), 1.0)
