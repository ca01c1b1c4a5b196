"""Sensors in kernels: what lies about seen from above, and a LiDAR of many rings."""

from __future__ import annotations

from math import cos, floor, inf, pi, sin, sqrt, tan
from typing import Any

from cityx.geometry.compiled import borrowing, compiled
from cityx.sim.kernels.boxes import cell_of, cell_value
from cityx.sim.kernels.one import world_at
from cityx.sim.kernels.rays2d import box_along
from cityx.sim.kernels.tables import ALIVE, HEADING, HEIGHT, LENGTH, WIDTH, X, Y, Z

X0, Y0, X1, Y1, LOW, HIGH = range(6)
ROAD, DECK, WALK, KERB = 1, 2, 4, 8  # bits of `cityx.sim.compile.rasters.FLAGS`
ON = 255  # what a channel holds where it is so
AHEAD = 0.25  # share of the picture's side that lies behind the agent


@compiled
def from_above(
    flags: Any, clear: Any, frame: Any, batch: Any, agents: int, pixel: float, found: Any
) -> None:
    """Write pictures from above, the agent's heading up: roadway, walk, kerb, solid and movers.

    Parameters
    ----------
    flags, clear, frame
        Rasters of the world in blocks, and where they lie.
    pixel
        Metres of a pixel.
    found
        (E, A, 6, h, w) uint8; the last channel is left to the route.
    """
    worlds, _, _, height, width = found.shape
    for e in range(worlds):
        here = world_at(batch, e)
        for n in range(agents):
            x, y, c, s = pose_of(here, n)
            for j in range(height):
                u = ((1.0 - AHEAD) * height - j - 0.5) * pixel
                for i in range(width):
                    v = (width / 2 - i - 0.5) * pixel
                    px, py = x + c * u - s * v, y + s * u + c * v
                    row, column = cell_of(px, py, frame)
                    flag = cell_value(flags, row, column) if row >= 0 else 0
                    found[e, n, 0, j, i] = ON if flag & (ROAD | DECK) else 0
                    found[e, n, 1, j, i] = ON if flag & WALK else 0
                    found[e, n, 2, j, i] = ON if flag & KERB else 0
                    solid = row >= 0 and cell_value(clear, row, column) == 0
                    solid = solid and not flag & (ROAD | DECK)
                    found[e, n, 3, j, i] = ON if solid else 0
                    found[e, n, 4, j, i] = ON if is_taken(here, n, px, py) else 0


@borrowing
def pose_of(here: Any, n: int) -> Any:
    """Return where a mover is, and the cosine and sine of its heading."""
    real = here.real
    return real[X, n], real[Y, n], cos(real[HEADING, n]), sin(real[HEADING, n])


@borrowing
def is_taken(here: Any, n: int, px: float, py: float) -> Any:
    """Return whether the body of another mover at about the same height is at a place."""
    real = here.real
    for m in range(real.shape[1]):
        if m == n or here.whole[ALIVE, m] == 0:
            continue
        dx, dy = px - real[X, m], py - real[Y, m]
        if dx * dx + dy * dy > 36.0 or abs(real[Z, m] - real[Z, n]) > 4.0:
            continue
        c, s = cos(real[HEADING, m]), sin(real[HEADING, m])
        if abs(dx * c + dy * s) <= real[LENGTH, m] / 2 and (
            abs(dy * c - dx * s) <= real[WIDTH, m] / 2
        ):
            return True
    return False


@compiled
def route_above(batch: Any, e: int, n: int, line: Any, pixel: float, found: Any) -> None:
    """Draw a route, (k, 2) metres, to one channel (h, w) of what is seen from above."""
    height, width = found.shape
    x, y, c, s = pose_of(world_at(batch, e), n)
    for k in range(len(line)):
        dx, dy = line[k, 0] - x, line[k, 1] - y
        j = floor((1.0 - AHEAD) * height - (dx * c + dy * s) / pixel)
        i = floor(width / 2 - (dy * c - dx * s) / pixel)
        if 0 <= j < height and 0 <= i < width:
            found[j, i] = ON


@compiled
def sweep(
    segment: Any, cell_start: Any, cell_segment: Any, grid: Any, batch: Any, agents: int,
    eye: float, rings: Any, reach: float, found: Any,
) -> None:  # fmt: skip
    """Sweep with a LiDAR over sides of solids, bodies of movers, and the ground as a plane.

    Parameters
    ----------
    segment, cell_start, cell_segment, grid
        Sides of solids with the heights between which they are, by cell.
    eye
        Metres above the foot of the agent.
    rings
        (r,) radians above the horizon.
    found
        (E, A, r, k) float32 metres / `reach`; the first straight ahead, then clockwise.
    """
    worlds, _, count, around = found.shape
    for e in range(worlds):
        here = world_at(batch, e)
        real = here.real
        for n in range(agents):
            x, y, z = real[X, n], real[Y, n], real[Z, n] + eye
            for k in range(around):
                angle = real[HEADING, n] - 2 * pi * k / around
                ux, uy = cos(angle), sin(angle)
                for r in range(count):
                    down = -tan(rings[r])
                    far = reach * cos(rings[r])
                    found[e, n, r, k] = min(eye / down, far) if down > 1e-9 else far
                along_cells(segment, cell_start, cell_segment, grid, x, y, z, ux, uy, reach,
                            rings, found[e, n], k)  # fmt: skip
                bodies(here, n, x, y, z, ux, uy, reach, rings, found[e, n], k)
                for r in range(count):
                    found[e, n, r, k] /= reach * cos(rings[r])


@borrowing
def along_cells(
    segment: Any, cell_start: Any, cell_segment: Any, grid: Any, x: float, y: float, z: float,
    ux: float, uy: float, reach: float, rings: Any, found: Any, k: int,
) -> None:  # fmt: skip
    """Shorten the rays of one direction, metres in plan, by the sides that they meet."""
    west, south, size = grid[0], grid[1], grid[2]
    columns, rows = int(grid[3]), int(grid[4])
    i, j = floor((x - west) / size), floor((y - south) / size)
    step_i, step_j = (1 if ux > 0 else -1), (1 if uy > 0 else -1)
    next_x = ((i + (1 if ux > 0 else 0)) * size + west - x) / ux if abs(ux) > 1e-12 else inf
    next_y = ((j + (1 if uy > 0 else 0)) * size + south - y) / uy if abs(uy) > 1e-12 else inf
    wide_x = size / abs(ux) if abs(ux) > 1e-12 else inf
    wide_y = size / abs(uy) if abs(uy) > 1e-12 else inf
    begin = 0.0
    while begin < reach:
        if 0 <= i < columns and 0 <= j < rows:
            cell = j * columns + i
            for p in range(cell_start[cell], cell_start[cell + 1]):
                row = cell_segment[p]
                ax, ay = segment[row, X0] - x, segment[row, Y0] - y
                bx, by = segment[row, X1] - segment[row, X0], segment[row, Y1] - segment[row, Y0]
                cross = ux * by - uy * bx
                if abs(cross) < 1e-12:
                    continue
                t, w = (ax * by - ay * bx) / cross, (ax * uy - ay * ux) / cross
                if not (0.0 <= t < reach and 0.0 <= w <= 1.0):
                    continue
                for r in range(len(rings)):
                    at = z + t * tan(rings[r])
                    if t < found[r, k] and segment[row, LOW] <= at <= segment[row, HIGH]:
                        found[r, k] = t
        if next_x < next_y:
            begin, next_x, i = next_x, next_x + wide_x, i + step_i
        else:
            begin, next_y, j = next_y, next_y + wide_y, j + step_j


@borrowing
def bodies(
    here: Any, n: int, x: float, y: float, z: float, ux: float, uy: float, reach: float,
    rings: Any, found: Any, k: int,
) -> None:  # fmt: skip
    """Shorten the rays of one direction by the bodies of other movers."""
    real = here.real
    for m in range(real.shape[1]):
        if m == n or here.whole[ALIVE, m] == 0:
            continue
        dx, dy = real[X, m] - x, real[Y, m] - y
        radius = sqrt(real[LENGTH, m] ** 2 + real[WIDTH, m] ** 2) / 2
        if dx * ux + dy * uy < -radius or abs(dx * uy - dy * ux) > radius:
            continue
        if dx * dx + dy * dy > (reach + radius) ** 2:
            continue
        c, s = cos(real[HEADING, m]), sin(real[HEADING, m])
        away = box_along(-(dx * c + dy * s), -(dy * c - dx * s), ux * c + uy * s,
                         uy * c - ux * s, real[LENGTH, m] / 2, real[WIDTH, m] / 2)  # fmt: skip
        for r in range(len(rings)):
            at = z + away * tan(rings[r])
            if away < found[r, k] and real[Z, m] <= at <= real[Z, m] + real[HEIGHT, m]:
                found[r, k] = away


@compiled
def sweep_tops(
    top: Any, frame: Any, batch: Any, agents: int, rings: Any, reach: float, found: Any
) -> None:
    """Sweep as `sweep` does from who flies, over the raster of what is highest."""
    worlds, _, count, around = found.shape
    stride = frame[2]
    for e in range(worlds):
        real = world_at(batch, e).real
        for n in range(agents):
            for k in range(around):
                angle = real[HEADING, n] - 2 * pi * k / around
                for r in range(count):
                    c, up = cos(rings[r]), sin(rings[r])
                    away = 0.0
                    while away < reach:
                        flat = away * c
                        px, py = real[X, n] + flat * cos(angle), real[Y, n] + flat * sin(angle)
                        row, column = cell_of(px, py, frame)
                        if row >= 0 and top[row, column] > real[Z, n] + away * up:
                            break
                        away += stride
                    found[e, n, r, k] = min(away / reach, 1.0)
