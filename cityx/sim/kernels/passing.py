"""Passing places: where one on a walk lets by who comes head on, and which of the two does."""

from __future__ import annotations

from math import hypot, inf
from typing import Any

from cityx.geometry.compiled import borrowing
from cityx.sim.kernels.paths import crossing_at, fits_at, on_path
from cityx.sim.kernels.roam_look import size_about
from cityx.sim.kernels.tables import ALIVE, GOAL, GONE, KIND, WIDTH, X, Y, Z

MEETS = 5.0  # metres ahead on either route within which two are about to meet
COMES = 12.0  # metres ahead on the route of the other that have to be free of who makes way
BACK = 24.0  # metres back on its route that one looks for a place
SPOT = 0.4  # metres between places looked at along a route
ASIDE, FARTHER = 0.15, 1.2  # metres aside: more than the bodies need at least, and at most
SIDES = 4  # places aside, on either side
AGAINST = 0.5  # cosine of the angle between two ways from which on they are against each other
STOREY = 2.0  # metres between heights from which on two do not meet


@borrowing
def meets(paths: Any, here: Any, n: int, first: int, agents: int) -> Any:
    """Return the agent on walks that one is about to meet head on, -1 for none."""
    real = here.real
    for m in range(first, agents):
        if m == n or here.whole[ALIVE, m] == 0 or abs(real[Z, m] - real[Z, n]) > STOREY:
            continue
        reach = 2.0 * (MEETS + FARTHER)
        if hypot(real[X, m] - real[X, n], real[Y, m] - real[Y, n]) < reach and head_on(
            paths, here, n, m
        ):
            return m
    return -1


@borrowing
def head_on(paths: Any, here: Any, n: int, m: int) -> Any:
    """Return whether the ways ahead of two lie on one another, in opposite directions."""
    near = room_for(here, n, m)
    for j in range(int(MEETS / SPOT) + 1):
        if j * SPOT > here.real[GOAL, n] - here.real[GONE, n]:
            return False
        x, y, _ = on_path(paths, here, n, j * SPOT)
        for k in range(int(MEETS / SPOT) + 1):
            px, py, _ = on_path(paths, here, m, k * SPOT)
            if hypot(px - x, py - y) < near:
                ux, uy = way_of(paths, here, n, j * SPOT)
                vx, vy = way_of(paths, here, m, k * SPOT)
                if ux * vx + uy * vy < -AGAINST:
                    return True
    return False


@borrowing
def way_of(paths: Any, here: Any, n: int, ahead: float) -> Any:
    """Return the direction of a route, so many metres ahead."""
    x, y, _ = on_path(paths, here, n, ahead + SPOT)
    px, py, _ = on_path(paths, here, n, ahead - SPOT)
    size = max(hypot(x - px, y - py), 1e-9)
    return (x - px) / size, (y - py) / size


@borrowing
def room_for(here: Any, n: int, m: int) -> Any:
    """Return metres from the route of `m` at which `n` lets it pass, however it is turned."""
    return here.real[WIDTH, m] / 2 + size_about(here, n) + ASIDE


@borrowing
def is_clear(paths: Any, here: Any, n: int, m: int, x: float, y: float) -> Any:
    """Return whether `m` gets past one that stands at a place."""
    near = room_for(here, n, m)
    for k in range(int(COMES / SPOT) + 1):
        px, py, _ = on_path(paths, here, m, k * SPOT)
        if hypot(px - x, py - y) < near:
            return False
    return True


@borrowing
def is_taken(here: Any, n: int, m: int, first: int, agents: int, x: float, y: float) -> Any:
    """Return whether a third agent is where `n`, who makes way for `m`, would be."""
    real = here.real
    for k in range(first, agents):
        if k in (n, m) or here.whole[ALIVE, k] == 0 or abs(real[Z, k] - real[Z, n]) > STOREY:
            continue
        if hypot(real[X, k] - x, real[Y, k] - y) < size_about(here, n) + size_about(here, k):
            return True
    return False


@borrowing
def passing_place(paths: Any, here: Any, n: int, m: int, first: int, agents: int) -> Any:
    """Return the nearest place, back on its route, where one lets another pass.

    It is where it stands already, or beside its route, to the right rather than to the left, or on
    it where the other's way has left it. Nobody goes back over a roadway for it, nor through who
    comes behind.

    Returns
    -------
    back, x, y
        Metres back on the route, infinite where there is no such place; and the place.
    """
    real = here.real
    kind = here.whole[KIND, n]
    x, y = real[X, n], real[Y, n]
    on = crossing_at(paths, x, y)
    if on == 0 and is_clear(paths, here, n, m, x, y):
        return 0.0, x, y
    step = FARTHER / SIDES
    for k in range(int(BACK / SPOT) + 1):
        back = k * SPOT
        if back > real[GONE, n]:
            break
        x, y, over = on_path(paths, here, n, -back)
        if (over > 0 and on == 0) or is_taken(here, n, m, first, agents, x, y):
            break
        if over > 0:
            continue
        on = 0
        ux, uy = way_of(paths, here, n, -back)
        for i in range(2 * SIDES + 1):
            off = step * ((i + 1) // 2) * (1.0 if i % 2 else -1.0)
            px, py = x + off * uy, y - off * ux
            if (fits_at(paths, px, py, kind) and crossing_at(paths, px, py) == 0
                    and is_clear(paths, here, n, m, px, py)
                    and not is_taken(here, n, m, first, agents, px, py)):  # fmt: skip
                return back + SPOT, px, py
    return inf, x, y


@borrowing
def way_made(paths: Any, here: Any, n: int, first: int, agents: int) -> Any:
    """Return whether one makes way for an agent that comes head on, and the place where it does.

    Of the two the one does whose place is nearer, else the later of them.

    Returns
    -------
    makes, back, x, y
        Whether it does; and as of `passing_place`.
    """
    m = meets(paths, here, n, first, agents)
    if m < 0:
        return False, 0.0, 0.0, 0.0
    back, x, y = passing_place(paths, here, n, m, first, agents)
    other, _, _ = passing_place(paths, here, m, n, first, agents)
    return back < other or (back == other and n > m and back < inf), back, x, y
