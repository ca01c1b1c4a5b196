"""Observations as vectors; `cityx.sim.observe` says what each field means."""

from __future__ import annotations

from math import cos, hypot, pi, sin
from typing import Any

import numpy as np

from cityx.geometry.compiled import borrowing, compiled
from cityx.sim import dynamics
from cityx.sim.kernels.idm import GREEN, shown
from cityx.sim.kernels.lines import on_route
from cityx.sim.kernels.one import world_at
from cityx.sim.kernels.rays2d import rays_round
from cityx.sim.kernels.tables import (
    ALIVE,
    ALONG,
    ASIDE,
    AT,
    GOAL,
    GOAL_M,
    GONE,
    HEADING,
    KIND,
    LENGTH,
    LIMIT,
    PEDAL_ACTION,
    PEOPLE,
    PIECE,
    POINT,
    SIZE,
    SPEED,
    STEER,
    STEER_ACTION,
    TURNED,
    WIDTH,
    YAW_RATE,
    X,
    Y,
    Z,
)

STATE, METADRIVE, PUFFER = 0, 1, 2
AHEAD = np.array([1.0, 3.0, 6.0, 10.0, 15.0, 21.0, 28.0, 37.0, 47.0, 58.0])  # metres
NEIGHBOURS, SIGHT = 8, 50.0
RAYS, REACH = 240, 50.0
CHECKPOINT = 30.0  # metres between the checkpoints of the preset `metadrive`
PARTNERS, ROADS = 63, 200  # of the preset `puffer`
STOREY = 3.0
FEW = 4  # people among the neighbours at most, so that they hide no vehicle for good
ON_FOOT = 0.5  # metres of length below which a body is a person


@compiled
def observe(
    world: Any, batch: Any, rules: Any, preset: int, view: Any, agents: int, low: int, high: int
) -> None:  # fmt: skip
    """Write what agents of worlds `low` to `high` observe to (E, A, d) float32."""
    nearest, square = np.empty(NEIGHBOURS, np.int64), np.empty(NEIGHBOURS)
    for e in range(low, high):
        here = world_at(batch, e)
        for n in range(agents):
            look(world, here, rules, preset, n, view[e, n], nearest, square)


@borrowing
def look(
    world: Any, here: Any, rules: Any, preset: int, n: int, view: Any, nearest: Any, square: Any
) -> None:
    """Write what one agent observes; `nearest` and `square` are room to work in."""
    if preset == METADRIVE:
        like_metadrive(world, here, n, view)
    elif preset == PUFFER:
        like_puffer(world, here, rules, n, view)
    else:
        state(world, here, rules, n, view, nearest, square)


@borrowing
def bounded(value: float) -> Any:
    """Return a value between -1 and 1."""
    return min(max(value, -1.0), 1.0)


@borrowing
def line_ahead(world: Any, here: Any, n: int) -> Any:
    """Return what is known of the next way across a junction.

    Returns
    -------
    away, stop, gives
        Metres to it; 1.0 if its signal says stop, 0.0 if not, -1.0 without one; and 1.0 if
        somebody it gives way to is on, or just before, a way that crosses it.
    """
    whole, path = here.whole, here.path
    away = -here.real[ALONG, n]
    for j in range(whole[AT, n], whole[SIZE, n]):
        piece = path[n, j]
        if j > whole[AT, n] and world.across[piece]:
            signal = world.signal[piece]
            stop = -1.0
            if signal >= 0:
                stop = 0.0 if shown(world, signal, here.clock[0]) >= GREEN else 1.0
            gives = 0.0
            for k in range(world.conflict_start[piece], world.conflict_start[piece + 1]):
                if not world.yields[k]:
                    continue
                other = world.conflict[k]
                for m in range(here.real.shape[1]):
                    if m == n or whole[ALIVE, m] == 0:
                        continue
                    at = whole[AT, m]
                    if whole[PIECE, m] == other or (
                        at + 1 < whole[SIZE, m] and path[m, at + 1] == other
                    ):
                        gives = 1.0
            return away, stop, gives
        away += world.length[piece]
        if away > SIGHT:
            break
    return SIGHT, -1.0, 0.0


@borrowing
def state(world: Any, here: Any, rules: Any, n: int, view: Any, nearest: Any, square: Any) -> None:
    """Write the preset `state`: 8 of its own, 10 places ahead, 8 neighbours and the goal."""
    real = here.real
    own = world.vehicles[here.whole[KIND, n]]
    x, y = real[X, n], real[Y, n]
    c, s = cos(real[HEADING, n]), sin(real[HEADING, n])
    away, stop, gives = line_ahead(world, here, n)
    view[0] = real[SPEED, n] / 30.0
    view[1] = real[STEER, n] / own[dynamics.STEER]
    view[2] = bounded(real[ASIDE, n] / 5.0)
    view[3] = sin(real[TURNED, n])
    view[4] = bounded(real[LIMIT, n] / 30.0)
    view[5] = stop
    view[6] = bounded(away / SIGHT)
    view[7] = gives
    at = 8
    along, place, near, before = real[ALONG, n], here.whole[AT, n], here.whole[POINT, n], 0.0
    for k in range(len(AHEAD)):
        there, along, place = on_route(world, here, n, along + AHEAD[k] - before, place, near)
        near, before = there[5], AHEAD[k]
        dx, dy = there[0] - x, there[1] - y
        view[at] = bounded((dx * c + dy * s) / 60.0)
        view[at + 1] = bounded((dy * c - dx * s) / 60.0)
        at += 2
    nearest[:] = -1
    square[:] = SIGHT * SIGHT
    people = rules[PEOPLE] > 0
    if people:
        find_people(here, n, nearest, square)
    for m in range(real.shape[1]):
        if m == n or here.whole[ALIVE, m] == 0:
            continue
        dx, dy = real[X, m] - x, real[Y, m] - y
        d = dx * dx + dy * dy
        if d >= square[NEIGHBOURS - 1] or abs(real[Z, m] - real[Z, n]) > STOREY:
            continue
        if people and real[LENGTH, m] < ON_FOOT:
            continue
        k = NEIGHBOURS - 1
        while k > 0 and square[k - 1] > d:
            square[k], nearest[k] = square[k - 1], nearest[k - 1]
            k -= 1
        square[k], nearest[k] = d, m
    for k in range(NEIGHBOURS):
        m = nearest[k]
        if m < 0:
            for i in range(7):
                view[at + i] = 0.0
            at += 7
            continue
        dx, dy = real[X, m] - x, real[Y, m] - y
        mc, ms = cos(real[HEADING, m]), sin(real[HEADING, m])
        view[at] = bounded((dx * c + dy * s) / SIGHT)
        view[at + 1] = bounded((dy * c - dx * s) / SIGHT)
        view[at + 2] = bounded(mc * c + ms * s)
        view[at + 3] = bounded(ms * c - mc * s)
        view[at + 4] = bounded(real[SPEED, m] / 30.0)
        view[at + 5] = real[LENGTH, m] / 20.0
        view[at + 6] = real[WIDTH, m] / 5.0
        at += 7
    left = max(real[GOAL, n] - real[GONE, n], 0.0)
    there, _, _ = on_route(world, here, n, real[ALONG, n] + left, here.whole[AT, n],
                           here.whole[POINT, n])  # fmt: skip
    dx, dy = there[0] - x, there[1] - y
    view[at] = bounded((dx * c + dy * s) / 200.0)
    view[at + 1] = bounded((dy * c - dx * s) / 200.0)
    view[at + 2] = bounded(left / max(rules[GOAL_M], 1.0))


@borrowing
def find_people(here: Any, n: int, nearest: Any, square: Any) -> None:
    """Write the `FEW` people that are nearest: rows by distance, and squares of that."""
    real = here.real
    for m in range(real.shape[1]):
        if here.whole[ALIVE, m] == 0 or real[LENGTH, m] >= ON_FOOT:
            continue
        dx, dy = real[X, m] - real[X, n], real[Y, m] - real[Y, n]
        d = dx * dx + dy * dy
        if d >= square[FEW - 1] or abs(real[Z, m] - real[Z, n]) > STOREY:
            continue
        k = FEW - 1
        while k > 0 and square[k - 1] > d:
            square[k], nearest[k] = square[k - 1], nearest[k - 1]
            k -= 1
        square[k], nearest[k] = d, m


@borrowing
def half(value: float) -> Any:
    """Return a value between -1 and 1 as one between 0 and 1."""
    return (bounded(value) + 1.0) / 2.0


@borrowing
def like_metadrive(world: Any, here: Any, n: int, view: Any) -> None:
    """Write the preset `metadrive`: 9 of its own, 2 checkpoints and 240 rays."""
    real = here.real
    own = world.vehicles[here.whole[KIND, n]]
    width = 2.0 * 1.75
    view[0] = min(max((width - real[ASIDE, n]) / 16.0, 0.0), 1.0)
    view[1] = min(max((width + real[ASIDE, n]) / 16.0, 0.0), 1.0)
    view[2] = half(real[TURNED, n] / pi)
    view[3] = min(max((real[SPEED, n] * 3.6 + 1.0) / 81.0, 0.0), 1.0)
    view[4] = half(real[STEER, n] / own[dynamics.STEER])
    view[5] = half(real[STEER_ACTION, n])
    view[6] = half(real[PEDAL_ACTION, n])
    view[7] = min(max(abs(real[YAW_RATE, n]), 0.0), 1.0)
    view[8] = half(real[ASIDE, n] * 2.0 / 10.0)
    c, s = cos(real[HEADING, n]), sin(real[HEADING, n])
    for k in range(2):
        there, _, at = on_route(world, here, n, real[ALONG, n] + CHECKPOINT * (k + 1),
                                here.whole[AT, n], here.whole[POINT, n])  # fmt: skip
        piece = here.path[n, at]
        dx, dy = there[0] - real[X, n], there[1] - real[Y, n]
        first, last = world.point_start[piece], world.point_start[piece + 1] - 1
        turn = world.point[last, 3] - world.point[first, 3]
        radius = world.length[piece] / abs(turn) if abs(turn) > 0.05 else 0.0
        at = 9 + 5 * k
        view[at] = half((dx * c + dy * s) / 50.0)
        view[at + 1] = half((dy * c - dx * s) / 50.0)
        view[at + 2] = min(radius / 60.0, 1.0)
        view[at + 3] = 0.5 if radius == 0.0 else (1.0 if turn < 0 else 0.0)
        view[at + 4] = half(turn / pi) if radius > 0 else 0.5
    rays_round(world, here, n, RAYS, REACH, view, 19)


@borrowing
def like_puffer(world: Any, here: Any, rules: Any, n: int, view: Any) -> None:
    """Write the preset `puffer`: 7 of its own, 63 partners and 200 segments of roads."""
    real = here.real
    x, y = real[X, n], real[Y, n]
    c, s = cos(real[HEADING, n]), sin(real[HEADING, n])
    left = max(real[GOAL, n] - real[GONE, n], 0.0)
    there, _, _ = on_route(world, here, n, real[ALONG, n] + left, here.whole[AT, n],
                           here.whole[POINT, n])  # fmt: skip
    dx, dy = there[0] - x, there[1] - y
    view[:] = 0.0
    view[0] = (dx * c + dy * s) * 0.005
    view[1] = (dy * c - dx * s) * 0.005
    view[2] = real[SPEED, n] * 0.01
    view[3] = real[WIDTH, n] / 15.0
    view[4] = real[LENGTH, n] / 30.0
    at, people = 7, rules[PEOPLE] > 0
    for turn in range(2 if people else 1):  # vehicles, then who is on foot
        for m in range(real.shape[1]):
            if m == n or here.whole[ALIVE, m] == 0 or at >= 7 + 7 * PARTNERS:
                continue
            dx, dy = real[X, m] - x, real[Y, m] - y
            if dx * dx + dy * dy > SIGHT * SIGHT or abs(real[Z, m] - real[Z, n]) > STOREY:
                continue
            if people and (real[LENGTH, m] < ON_FOOT) != (turn == 1):
                continue
            mc, ms = cos(real[HEADING, m]), sin(real[HEADING, m])
            view[at] = (dx * c + dy * s) * 0.02
            view[at + 1] = (dy * c - dx * s) * 0.02
            view[at + 2] = real[WIDTH, m] / 15.0
            view[at + 3] = real[LENGTH, m] / 30.0
            view[at + 4] = mc * c + ms * s
            view[at + 5] = ms * c - mc * s
            view[at + 6] = real[SPEED, m] / 100.0
            at += 7
    roads(world, x, y, real[Z, n], c, s, view)


@borrowing
def roads(world: Any, x: float, y: float, z: float, c: float, s: float, view: Any) -> None:
    """Write the lines of lanes and the sides of solids near a place, in the order of cells."""
    at, last = 7 + 7 * PARTNERS, 7 + 7 * (PARTNERS + ROADS)
    west, south, size = world.lane_grid[0], world.lane_grid[1], world.lane_grid[2]
    columns, rows = int(world.lane_grid[3]), int(world.lane_grid[4])
    i, j = int((x - west) // size), int((y - south) // size)
    for ring in range(4):
        for row in range(max(j - ring, 0), min(j + ring, rows - 1) + 1):
            for column in range(max(i - ring, 0), min(i + ring, columns - 1) + 1):
                if max(abs(row - j), abs(column - i)) != ring:
                    continue
                cell = row * columns + column
                for k in range(world.lane_start[cell], world.lane_start[cell + 1]):
                    own = world.lane_row[k]
                    if at + 7 > last:
                        return
                    ax, ay = world.lane[own, 0], world.lane[own, 1]
                    bx, by = world.lane[own, 2], world.lane[own, 3]
                    if abs(world.lane[own, 4] - z) > STOREY:
                        continue
                    dx, dy = (ax + bx) / 2 - x, (ay + by) / 2 - y
                    ux, uy = bx - ax, by - ay
                    run = max(hypot(ux, uy), 1e-6)
                    view[at] = (dx * c + dy * s) * 0.02
                    view[at + 1] = (dy * c - dx * s) * 0.02
                    view[at + 2] = run / 2 / 100.0
                    view[at + 3] = 0.1 / 100.0
                    view[at + 4] = (ux * c + uy * s) / run
                    view[at + 5] = (uy * c - ux * s) / run
                    view[at + 6] = world.lane[own, 5]
                    at += 7
