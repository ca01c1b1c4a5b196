"""People of the background: they follow routes, keep apart, and wait for red and for traffic.

References
----------
Helbing and Molnár, "Social force model for pedestrian dynamics", Physical Review E 51, 1995.
"""

from __future__ import annotations

from math import atan2, cos, exp, hypot, sin, sqrt
from typing import Any

from cityx.geometry.compiled import borrowing
from cityx.sim import travellers
from cityx.sim.kernels.draws import drawn
from cityx.sim.kernels.observe import ON_FOOT
from cityx.sim.kernels.paths import (
    ONWARD,
    ROUTE,
    crossing_ahead,
    crossing_at,
    fits_at,
    follow_path,
    height_at,
    may_cross,
    on_path,
)
from cityx.sim.kernels.tables import (
    ALIVE,
    ALONG,
    BEFORE,
    CLEARED,
    DT,
    GOAL,
    GONE,
    HEADING,
    HEIGHT,
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

PERSON = 0  # row of travellers
RELAX, PUSH, RANGE, SIGHT = 0.5, 2.1, 0.3, 3.0  # s, m/s2, m and m of the force between people
BEHIND = 0.3  # share of the push from those behind
AHEAD, KEEP = 1.2, 0.35  # metres on the route that one heads for, and to the side of it
LINE = 1.1  # metres before a roadway at which one waits
SPACE = 0.06  # metres between two bodies at least
SOON = 0.8  # seconds ahead of a vehicle that nobody steps into its way
OFF = 0.35  # metres from a vehicle that nobody steps nearer to
PACES = (0.9, 1.6)  # m/s
LOST, ARRIVED, UNSEEN = 25.0, 0.8, 30.0  # s without getting on; m to the end; m from agents
PATIENCE, TURN_EVERY = 4.0, 50  # seconds after which one turns back, and steps between
TRIES = 12


@borrowing
def set_on_route(paths: Any, here: Any, n: int, kind: int, route: int, onward: int,
                 share: float) -> None:  # fmt: skip
    """Put a traveller on a route, so much of it behind."""
    real, whole = here.real, here.whole
    own = paths.travellers[kind]
    for row in range(real.shape[0]):
        real[row, n] = 0.0
    real[LENGTH, n], real[WIDTH, n] = own[travellers.LENGTH], own[travellers.WIDTH]
    real[HEIGHT, n] = own[travellers.HEIGHT]
    whole[KIND, n], whole[SIZE, n], whole[STEPS, n] = kind, 0, 0
    whole[PIECE, n] = whole[BEFORE, n] = whole[CLEARED, n] = whole[LEAVES, n] = -1
    here.path[n, ROUTE], here.path[n, ONWARD] = route, onward
    size = paths.length[route]
    real[ALONG, n] = share * size if onward else (1.0 - share) * size
    first, last = paths.start[route], paths.start[route + 1] - 1
    k = first
    while k < last - 1 and paths.point[k + 1, 3] < real[ALONG, n]:
        k += 1
    whole[POINT, n] = k
    x, y, _ = on_path(paths, here, n, 0.0)
    fx, fy, _ = on_path(paths, here, n, 0.5)
    bx, by, _ = on_path(paths, here, n, -0.5)
    real[X, n], real[Y, n], real[Z, n] = x, y, height_at(paths, x, y)
    real[HEADING, n] = atan2(fy - by, fx - bx)
    real[GOAL, n], real[GONE, n] = size, share * size


@borrowing
def begin_person(paths: Any, here: Any, n: int, agents: int, near: float, first: bool) -> None:
    """Put a person somewhere on a route near an agent, or out of sight of all; or leave it out."""
    real, whole = here.real, here.whole
    whole[ALIVE, n] = 0
    count = paths.first[PERSON + 1] - paths.first[PERSON]
    if count == 0:
        return
    for _ in range(TRIES):
        route = paths.first[PERSON] + min(int(drawn(here, n) * count), count - 1)
        onward = 1 if drawn(here, n) < 0.5 else 0
        set_on_route(paths, here, n, PERSON, route, onward, 0.9 * drawn(here, n))
        x, y = real[X, n], real[Y, n]
        if crossing_at(paths, x, y) > 0 or not fits_at(paths, x, y, PERSON):
            continue
        free, seen, close = True, False, agents == 0
        for m in range(real.shape[1]):
            if m == n or whole[ALIVE, m] == 0:
                continue
            away = hypot(real[X, m] - x, real[Y, m] - y)
            if away < 1.2 + (real[LENGTH, m] if m < agents else real[LENGTH, m] / 2):
                free = False
            if m < agents:
                seen = seen or away < UNSEEN
                close = close or away < near
        if free and close and (first or not seen):
            real[LIMIT, n] = PACES[0] + (PACES[1] - PACES[0]) * drawn(here, n)
            whole[ALIVE, n] = 1
            return


@borrowing
def walk_people(
    world: Any, paths: Any, here: Any, rules: Any, agents: int, first: int, feet: int, near: float
) -> None:
    """Move the people of a world, rows `agents` to `feet`, by one step, one after the other.

    Rows `first` to `feet` are on walks: agents among them, or those who drive are not.
    """
    real, whole = here.real, here.whole
    dt = rules[DT]
    for n in range(agents, feet):
        if whole[ALIVE, n] == 0:
            real[WAITED, n] += dt
            if real[WAITED, n] > 1.0:
                begin_person(paths, here, n, agents, near, False)
            continue
        follow_path(paths, here, n)
        if real[GONE, n] > real[GOAL, n] - ARRIVED:
            here.path[n, ONWARD] = 1 - here.path[n, ONWARD]  # on the way back
            real[GONE, n] = real[GOAL, n] - real[GONE, n]
        if real[WAITED, n] > PATIENCE and int(real[WAITED, n] / dt) % TURN_EVERY == 0:
            here.path[n, ONWARD] = 1 - here.path[n, ONWARD]  # who cannot get on turns back
            real[GONE, n] = real[GOAL, n] - real[GONE, n]
        if real[WAITED, n] > LOST and far_off(here, n, agents, UNSEEN):
            begin_person(paths, here, n, agents, near, False)
            continue
        step_person(world, paths, here, n, first, feet, dt)


@borrowing
def far_off(here: Any, n: int, agents: int, away: float) -> Any:
    """Return whether no agent is so near to a mover."""
    for m in range(agents):
        if hypot(here.real[X, m] - here.real[X, n], here.real[Y, m] - here.real[Y, n]) < away:
            return False
    return True


@borrowing
def step_person(
    world: Any, paths: Any, here: Any, n: int, first: int, feet: int, dt: float
) -> None:
    """Let a person take one step: drawn by its route, pushed by bodies, never into any."""
    real, whole = here.real, here.whole
    x, y = real[X, n], real[Y, n]
    on = crossing_at(paths, x, y)
    pace = real[LIMIT, n]
    away, over = crossing_ahead(paths, here, n, LINE + 0.4, 0.25)
    if (
        on == 0
        and over > 0
        and away < LINE
        and not may_cross(world, paths, here, first, feet, over)
    ):
        pace = 0.0
    tx, ty, _ = on_path(paths, here, n, AHEAD)
    dx, dy = tx - x, ty - y
    size = max(hypot(dx, dy), 1e-6)
    kx, ky = tx + KEEP * dy / size, ty - KEEP * dx / size  # to its right
    if fits_at(paths, kx, ky, PERSON) and crossing_at(paths, kx, ky) == crossing_at(paths, tx, ty):
        dx, dy = kx - x, ky - y
        size = max(hypot(dx, dy), 1e-6)
    ex, ey = dx / size, dy / size
    vx, vy = real[SPEED, n] * cos(real[HEADING, n]), real[SPEED, n] * sin(real[HEADING, n])
    fx, fy = (pace * ex - vx) / RELAX, (pace * ey - vy) / RELAX
    for m in range(first, feet):
        if m == n or whole[ALIVE, m] == 0:
            continue
        ox, oy = x - real[X, m], y - real[Y, m]
        gap = sqrt(ox * ox + oy * oy)
        if gap > SIGHT or gap < 1e-6:
            continue
        ox, oy = ox / gap, oy / gap
        share = BEHIND + (1.0 - BEHIND) * (1.0 - (ox * ex + oy * ey)) / 2
        push = PUSH * share * exp((reach(here, n) + reach(here, m) - gap) / RANGE)
        # Those that come head on are passed on one's own right.
        fx += push * (ox + 0.4 * ey)
        fy += push * (oy - 0.4 * ex)
    if pace > 0.0:
        vx, vy = vx + fx * dt, vy + fy * dt
    else:
        vx = vy = 0.0
    speed = hypot(vx, vy)
    most = 1.3 * max(pace, 0.3)
    if speed > most:
        vx, vy, speed = vx * most / speed, vy * most / speed, most
    moved = False
    for turn in range(5):
        # Straight, else aside, else slower: the first that is free.
        c, s = (1.0, 0.0) if turn == 0 else (0.6, 0.8 if turn % 2 else -0.8)
        k = 1.0 if turn < 3 else 0.4
        ux, uy = k * (c * vx + s * vy), k * (c * vy - s * vx)
        nx, ny = x + ux * dt, y + uy * dt
        if fits_at(paths, nx, ny, PERSON) and is_open(here, n, first, feet, x, y, nx, ny) and (
            on > 0 or crossing_at(paths, nx, ny) == 0 or pace > 0.0
        ):  # fmt: skip
            real[X, n], real[Y, n] = nx, ny
            real[SPEED, n] = hypot(ux, uy)
            if real[SPEED, n] > 0.05:
                real[HEADING, n] = atan2(uy, ux)
            moved = real[SPEED, n] > 0.1
            break
        if turn == 4:
            real[SPEED, n] = 0.0
            if not fits_at(paths, x, y, PERSON):  # pushed off by a rounding: back to the route
                real[HEADING, n] = atan2(dy, dx)
    real[Z, n] = height_at(paths, real[X, n], real[Y, n])
    real[WAITED, n] = 0.0 if moved or pace == 0.0 else real[WAITED, n] + dt


@borrowing
def reach(here: Any, m: int) -> Any:
    """Return metres about a mover on foot or small wheels that it takes up."""
    return here.real[LENGTH, m] / 2 if here.real[LENGTH, m] < ON_FOOT else (
        hypot(here.real[LENGTH, m], here.real[WIDTH, m]) / 2)  # fmt: skip


@borrowing
def is_open(
    here: Any, n: int, first: int, feet: int, x: float, y: float, nx: float, ny: float
) -> Any:
    """Return whether a step leads into nobody, nor nearer to whom it is too near already."""
    real, whole = here.real, here.whole
    for m in range(real.shape[1]):
        if m == n or whole[ALIVE, m] == 0:
            continue
        dx, dy = nx - real[X, m], ny - real[Y, m]
        if first <= m < feet:
            least = reach(here, n) + reach(here, m) + SPACE
            after = dx * dx + dy * dy
            if after < least * least:
                ox, oy = x - real[X, m], y - real[Y, m]
                if after < ox * ox + oy * oy:
                    return False
        elif dx * dx + dy * dy < 400.0 and abs(real[Z, m] - real[Z, n]) < 2.0:
            c, s = cos(real[HEADING, m]), sin(real[HEADING, m])
            # Of a body that moves the ground that it is about to be on counts as well.
            half = real[LENGTH, m] / 2 + SOON * real[SPEED, m] / 2
            dx, dy = dx - SOON * real[SPEED, m] / 2 * c, dy - SOON * real[SPEED, m] / 2 * s
            along, across = abs(dx * c + dy * s), abs(dy * c - dx * s)
            if along < half + OFF and across < real[WIDTH, m] / 2 + OFF:
                ox, oy = dx - nx + x, dy - ny + y
                was = max(abs(ox * c + oy * s) - half,
                          abs(oy * c - ox * s) - real[WIDTH, m] / 2)  # fmt: skip
                now = max(along - half, across - real[WIDTH, m] / 2)
                if now < was:
                    return False
    return True
