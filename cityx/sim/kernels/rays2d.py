"""Rays in the plane at the height of a vehicle: against segments, and against the other bodies."""

from __future__ import annotations

from math import cos, floor, inf, pi, sin, sqrt
from typing import Any

from cityx.geometry.compiled import borrowing
from cityx.sim.kernels.tables import ALIVE, HEADING, HEIGHT, LENGTH, WIDTH, X, Y, Z

X0, Y0, X1, Y1, LOW, HIGH = range(6)
EYE = 0.6  # metres above the ground that rays run, and see


@borrowing
def rays_round(
    world: Any, here: Any, n: int, count: int, reach: float, found: Any, at: int
) -> None:  # fmt: skip
    """Cast rays round a mover, the first straight ahead and the next ones clockwise.

    Parameters
    ----------
    count, reach
        Number of rays, and metres.
    found, at
        Vector that takes the share of the reach that is free, from that place on.
    """
    real = here.real
    x, y, z = real[X, n], real[Y, n], real[Z, n] + EYE
    heading = real[HEADING, n]
    for k in range(count):
        angle = heading - 2 * pi * k / count
        found[at + k] = free_along(world, x, y, z, cos(angle), sin(angle), reach) / reach
    for m in range(real.shape[1]):
        if m == n or here.whole[ALIVE, m] == 0:
            continue
        if z < real[Z, m] or z > real[Z, m] + real[HEIGHT, m] + 0.5:
            continue
        dx, dy = real[X, m] - x, real[Y, m] - y
        half_length, half_width = real[LENGTH, m] / 2, real[WIDTH, m] / 2
        radius = sqrt(half_length * half_length + half_width * half_width)
        if dx * dx + dy * dy > (reach + radius) * (reach + radius):
            continue
        c, s = cos(real[HEADING, m]), sin(real[HEADING, m])
        ox, oy = -(dx * c + dy * s), -(dy * c - dx * s)  # the eye in the frame of the body
        for k in range(count):
            angle = heading - 2 * pi * k / count
            ux, uy = cos(angle), sin(angle)
            ahead = dx * ux + dy * uy
            if ahead < -radius or abs(dx * uy - dy * ux) > radius:
                continue
            away = box_along(ox, oy, ux * c + uy * s, uy * c - ux * s, half_length, half_width)
            if away < found[at + k] * reach:
                found[at + k] = away / reach


@borrowing
def box_along(ox: float, oy: float, ux: float, uy: float, hx: float, hy: float) -> Any:
    """Return metres from a place to a box about the origin along a way, infinite if it misses."""
    begin, end = 0.0, inf
    for axis in range(2):
        o, u, h = (ox, ux, hx) if axis == 0 else (oy, uy, hy)
        if abs(u) < 1e-12:
            if abs(o) > h:
                return inf
            continue
        one, other = (-h - o) / u, (h - o) / u
        begin, end = max(begin, min(one, other)), min(end, max(one, other))
        if begin > end:
            return inf
    return begin


@borrowing
def free_along(world: Any, x: float, y: float, z: float, ux: float, uy: float, reach: float) -> Any:
    """Return metres that are free of segments along a ray, cell by cell."""
    grid = world.grid
    west, south, size = grid[0], grid[1], grid[2]
    columns, rows = int(grid[3]), int(grid[4])
    i, j = floor((x - west) / size), floor((y - south) / size)
    step_i, step_j = (1 if ux > 0 else -1), (1 if uy > 0 else -1)
    next_x = ((i + (1 if ux > 0 else 0)) * size + west - x) / ux if abs(ux) > 1e-12 else inf
    next_y = ((j + (1 if uy > 0 else 0)) * size + south - y) / uy if abs(uy) > 1e-12 else inf
    wide_x = size / abs(ux) if abs(ux) > 1e-12 else inf
    wide_y = size / abs(uy) if abs(uy) > 1e-12 else inf
    best, begin = reach, 0.0
    while begin < best:
        if 0 <= i < columns and 0 <= j < rows:
            cell = j * columns + i
            for k in range(world.cell_start[cell], world.cell_start[cell + 1]):
                row = world.cell_segment[k]
                if world.segment[row, LOW] > z or world.segment[row, HIGH] < z:
                    continue
                ax, ay = world.segment[row, X0] - x, world.segment[row, Y0] - y
                bx, by = world.segment[row, X1] - world.segment[row, X0], (
                    world.segment[row, Y1] - world.segment[row, Y0])  # fmt: skip
                cross = ux * by - uy * bx
                if abs(cross) < 1e-12:
                    continue
                t, w = (ax * by - ay * bx) / cross, (ax * uy - ay * ux) / cross
                if 0.0 <= t < best and 0.0 <= w <= 1.0:
                    best = t
        if next_x < next_y:
            begin, next_x, i = next_x, next_x + wide_x, i + step_i
        else:
            begin, next_y, j = next_y, next_y + wide_y, j + step_j
    return best
