"""What agents on walks observe: themselves, the free ground, their way, others, what they saw."""

from __future__ import annotations

from math import cos, floor, hypot, pi, sin
from typing import Any

from cityx.geometry.compiled import borrowing
from cityx.sim import travellers
from cityx.sim.kernels.observe import bounded
from cityx.sim.kernels.paths import (
    crossing_ahead,
    crossing_at,
    fits_at,
    light,
    may_cross,
    on_path,
)
from cityx.sim.kernels.tables import (
    ALIVE,
    ASIDE,
    EXPLORE,
    GOAL,
    GONE,
    HEADING,
    KIND,
    LENGTH,
    SPEED,
    TURNED,
    WIDTH,
    YAW_RATE,
    X,
    Y,
    Z,
)

NEIGHBOURS, SEEN = 8, 25.0  # bodies, and metres within which they are
RAYS, REACH, STRIDE = 24, 8.0, 0.2  # ways round, metres and metres between looks
CROSSING_SIGHT = 20.0  # metres ahead that crosswalks are looked for
STEPS_AHEAD = (0.5, 1.0, 2.0, 3.0, 4.5, 6.0, 8.0, 10.0, 13.0, 16.0)
EXPLORED = 2  # column of `Batch.path` from which on an agent's explored cells are kept
CELL = 4.0  # metres of a cell that is explored
ABOUT = 3  # cells to each side that are told to be explored or not


@borrowing
def look_about(
    world: Any, paths: Any, here: Any, rules: Any, n: int, first: int, feet: int, view: Any,
    nearest: Any, square: Any,
) -> None:  # fmt: skip
    """Write what an agent observes, the presets `walk` and `explore`.

    Rows `first` to `feet` are on walks.
    """
    real = here.real
    kind = here.whole[KIND, n]
    x, y, heading = real[X, n], real[Y, n], real[HEADING, n]
    c, s = cos(heading), sin(heading)
    exploring = rules[EXPLORE] > 0
    for k in range(len(view)):
        view[k] = 0.0
    view[0] = bounded(real[SPEED, n] / paths.travellers[kind, travellers.TOP])
    view[1] = bounded(real[YAW_RATE, n] / 3.0)
    on = crossing_at(paths, x, y)
    view[7] = 1.0 if on > 0 else 0.0
    view[5], view[6] = -1.0, 1.0
    if not exploring:
        view[2] = bounded(real[ASIDE, n] / 5.0)
        view[3], view[4] = sin(real[TURNED, n]), cos(real[TURNED, n])
        away, over = crossing_ahead(paths, here, n, CROSSING_SIGHT, 0.5)
        view[6] = away / CROSSING_SIGHT
        if over > 0:
            view[5] = light(world, paths, over, here.clock[0])
            view[8] = 0.0 if may_cross(world, paths, here, first, feet, over) else 1.0
    at = 9
    for k in range(RAYS):
        angle = heading - 2 * pi * k / RAYS
        view[at + k] = free_ground(paths, x, y, cos(angle), sin(angle), kind) / REACH
    at += RAYS
    at = others(here, n, view, at, nearest, square, c, s)
    if exploring:
        i, j = floor(x / CELL), floor(y / CELL)
        for b in range(-ABOUT, ABOUT + 1):
            for a in range(-ABOUT, ABOUT + 1):
                view[at] = 1.0 if was_there(here, n, code_of(i + a, j + b)) else 0.0
                at += 1
        view[at] = bounded(real[GONE, n] / max(real[GOAL, n], 1e-6))
        return
    for ahead in STEPS_AHEAD:
        px, py, _ = on_path(paths, here, n, ahead)
        view[at] = bounded(((px - x) * c + (py - y) * s) / 20.0)
        view[at + 1] = bounded(((py - y) * c - (px - x) * s) / 20.0)
        at += 2
    px, py, _ = on_path(paths, here, n, 1e6)
    view[at] = bounded(((px - x) * c + (py - y) * s) / 200.0)
    view[at + 1] = bounded(((py - y) * c - (px - x) * s) / 200.0)
    view[at + 2] = bounded(1.0 - real[GONE, n] / max(real[GOAL, n], 1e-6))


@borrowing
def free_ground(paths: Any, x: float, y: float, ux: float, uy: float, kind: int) -> Any:
    """Return metres along which a traveller fits."""
    away = STRIDE
    while away < REACH:
        if not fits_at(paths, x + away * ux, y + away * uy, kind):
            return away - STRIDE
        away += STRIDE
    return REACH


@borrowing
def others(
    here: Any, n: int, view: Any, at: int, nearest: Any, square: Any, c: float, s: float
) -> Any:
    """Write the nearest bodies: place, heading, speed and size of each."""
    real = here.real
    count = 0
    for m in range(real.shape[1]):
        if m == n or here.whole[ALIVE, m] == 0 or abs(real[Z, m] - real[Z, n]) > 3.0:
            continue
        dx, dy = real[X, m] - real[X, n], real[Y, m] - real[Y, n]
        away = dx * dx + dy * dy
        if away > SEEN * SEEN or (count == NEIGHBOURS and away >= square[count - 1]):
            continue
        k = min(count, NEIGHBOURS - 1)
        while k > 0 and square[k - 1] > away:
            square[k], nearest[k] = square[k - 1], nearest[k - 1]
            k -= 1
        square[k], nearest[k] = away, m
        count = min(count + 1, NEIGHBOURS)
    for k in range(count):
        m = nearest[k]
        dx, dy = real[X, m] - real[X, n], real[Y, m] - real[Y, n]
        turn = real[HEADING, m] - real[HEADING, n]
        view[at] = (dx * c + dy * s) / SEEN
        view[at + 1] = (dy * c - dx * s) / SEEN
        view[at + 2], view[at + 3] = cos(turn), sin(turn)
        view[at + 4] = bounded(real[SPEED, m] / 15.0)
        view[at + 5] = bounded(real[LENGTH, m] / 20.0)
        view[at + 6] = bounded(real[WIDTH, m] / 5.0)
        at += 7
    return at + 7 * (NEIGHBOURS - count)


@borrowing
def code_of(i: int, j: int) -> Any:
    """Return the number of a cell that is explored."""
    return (i + 16384) * 32768 + (j + 16384)


@borrowing
def was_there(here: Any, n: int, code: int) -> Any:
    """Return whether an agent has explored a cell; they are kept in an open hash table."""
    room = here.path.shape[1] - EXPLORED
    k = (code * 40503) % room
    for _ in range(room):
        held = here.path[n, EXPLORED + k]
        if held == code:
            return True
        if held < 0:
            return False
        k = (k + 1) % room
    return False


@borrowing
def mark(paths: Any, here: Any, n: int) -> None:
    """Note the cell that an agent is in, and count it if it is new and one of the walks."""
    x, y = here.real[X, n], here.real[Y, n]
    if not fits_at(paths, x, y, here.whole[KIND, n]):
        return
    code = code_of(floor(x / CELL), floor(y / CELL))
    room = here.path.shape[1] - EXPLORED
    k = (code * 40503) % room
    for _ in range(room):
        held = here.path[n, EXPLORED + k]
        if held == code:
            return
        if held < 0:
            here.path[n, EXPLORED + k] = code
            here.real[GONE, n] += 1.0
            return
        k = (k + 1) % room


@borrowing
def size_about(here: Any, m: int) -> Any:
    """Return metres about the middle of a mover that it takes up."""
    return hypot(here.real[LENGTH, m], here.real[WIDTH, m]) / 2
