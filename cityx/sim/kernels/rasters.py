"""Rasters: triangles, strips and segments drawn into cells, and the distance to what was drawn."""

from __future__ import annotations

from math import ceil, floor, hypot
from typing import Any

import numpy as np

from cityx.geometry.compiled import compiled

FARTHEST = 255  # decimetres that a byte of clearance holds
DIAGONAL = 1.4142135623730951


@compiled
def draw_triangles(
    flags: Any, frame: Any, vertices: Any, triangles: Any, bits: Any, row: int, column: int
) -> None:
    """Set bits in the cells whose middles lie in triangles.

    Parameters
    ----------
    flags
        (h, w) uint8, changed: the cells of the raster from `row` and `column` on.
    frame
        (5,) west, south, metres of a cell, columns and rows.
    vertices, triangles
        (v, 2) metres and (t, 3).
    bits
        (t,) uint8.
    """
    west, south, size = frame[0], frame[1], frame[2]
    top, right = row + flags.shape[0] - 1, column + flags.shape[1] - 1
    for t in range(len(triangles)):
        if bits[t] == 0:
            continue
        ax, ay = vertices[triangles[t, 0], 0], vertices[triangles[t, 0], 1]
        bx, by = vertices[triangles[t, 1], 0], vertices[triangles[t, 1], 1]
        cx, cy = vertices[triangles[t, 2], 0], vertices[triangles[t, 2], 1]
        j0 = max(ceil((min(ay, by, cy) - south) / size - 0.5), row)
        j1 = min(floor((max(ay, by, cy) - south) / size - 0.5), top)
        for j in range(j0, j1 + 1):
            y = south + (j + 0.5) * size
            low, high = np.inf, -np.inf
            for k in range(3):
                px, py = (ax, ay) if k == 0 else ((bx, by) if k == 1 else (cx, cy))
                qx, qy = (bx, by) if k == 0 else ((cx, cy) if k == 1 else (ax, ay))
                if (py <= y) != (qy <= y) or py == y:
                    x = px if py == qy else px + (qx - px) * (y - py) / (qy - py)
                    low, high = min(low, x), max(high, x)
            i0 = max(ceil((low - west) / size - 0.5), column) if low <= high else 0
            i1 = min(floor((high - west) / size - 0.5), right) if low <= high else -1
            for i in range(i0, i1 + 1):
                flags[j - row, i - column] |= bits[t]


@compiled
def draw_strips(
    flags: Any, frame: Any, line: Any, half_width: Any, bit: int, row: int, column: int
) -> None:
    """Set a bit in the cells within half a width of segments: (k, 4) ends and (k,) metres.

    `flags`, `row` and `column` as of `draw_triangles`.
    """
    west, south, size = frame[0], frame[1], frame[2]
    top, right = row + flags.shape[0] - 1, column + flags.shape[1] - 1
    for k in range(len(line)):
        ax, ay, bx, by = line[k, 0], line[k, 1], line[k, 2], line[k, 3]
        reach = half_width[k]
        dx, dy = bx - ax, by - ay
        square = max(dx * dx + dy * dy, 1e-12)
        j0 = max(floor((min(ay, by) - reach - south) / size), row)
        j1 = min(floor((max(ay, by) + reach - south) / size), top)
        i0 = max(floor((min(ax, bx) - reach - west) / size), column)
        i1 = min(floor((max(ax, bx) + reach - west) / size), right)
        for j in range(j0, j1 + 1):
            for i in range(i0, i1 + 1):
                x, y = west + (i + 0.5) * size, south + (j + 0.5) * size
                t = min(max(((x - ax) * dx + (y - ay) * dy) / square, 0.0), 1.0)
                if hypot(x - ax - t * dx, y - ay - t * dy) <= reach:
                    flags[j - row, i - column] |= bit


@compiled
def draw_segments(mask: Any, frame: Any, segment: Any, row: int, column: int) -> None:
    """Set the cells that segments (s, 4 or more columns) run through.

    `mask`, (h, w) bool, has the cells of the raster from `row` and `column` on.
    """
    west, south, size = frame[0], frame[1], frame[2]
    height, width = mask.shape
    for k in range(len(segment)):
        ax, ay, bx, by = segment[k, 0], segment[k, 1], segment[k, 2], segment[k, 3]
        steps = max(ceil(hypot(bx - ax, by - ay) / (0.5 * size)), 1)
        for n in range(steps + 1):
            x, y = ax + (bx - ax) * n / steps, ay + (by - ay) * n / steps
            i, j = floor((x - west) / size), floor((y - south) / size)
            if 0 <= i - column < width and 0 <= j - row < height:
                mask[j - row, i - column] = True


@compiled
def draw_tops(height: Any, row: Any, frame: Any, vertices: Any, triangles: Any, owner: Any) -> None:
    """Write the height of triangles to the cells whose middles they cover, the highest counts.

    Parameters
    ----------
    height, row
        (h, w) float32 and int32, changed; NaN counts as nothing.
    owner
        (t,) what is written to `row`; nothing is where it is empty.
    frame
        (5,) west, south, metres of a cell, columns and rows.
    vertices, triangles
        (v, 3) metres and (t, 3).
    """
    west, south, size = frame[0], frame[1], frame[2]
    rows, columns = height.shape
    for t in range(len(triangles)):
        a, b, c = triangles[t, 0], triangles[t, 1], triangles[t, 2]
        ax, ay = vertices[a, 0], vertices[a, 1]
        ux, uy = vertices[b, 0] - ax, vertices[b, 1] - ay
        vx, vy = vertices[c, 0] - ax, vertices[c, 1] - ay
        area = ux * vy - uy * vx
        if abs(area) < 1e-9:
            continue
        uz, vz = vertices[b, 2] - vertices[a, 2], vertices[c, 2] - vertices[a, 2]
        j0 = max(ceil((ay + min(0.0, uy, vy) - south) / size - 0.5), 0)
        j1 = min(floor((ay + max(0.0, uy, vy) - south) / size - 0.5), rows - 1)
        i0 = max(ceil((ax + min(0.0, ux, vx) - west) / size - 0.5), 0)
        i1 = min(floor((ax + max(0.0, ux, vx) - west) / size - 0.5), columns - 1)
        for j in range(j0, j1 + 1):
            dy = south + (j + 0.5) * size - ay
            for i in range(i0, i1 + 1):
                dx = west + (i + 0.5) * size - ax
                one, other = (dx * vy - dy * vx) / area, (dy * ux - dx * uy) / area
                if one < -1e-9 or other < -1e-9 or one + other > 1.0 + 1e-9:
                    continue
                z = vertices[a, 2] + one * uz + other * vz
                if not height[j, i] >= z:
                    height[j, i] = z
                    if len(owner):
                        row[j, i] = owner[t]


@compiled
def steps_over(height: Any, most: float) -> Any:
    """(h, w) bool, cells from which the ground steps up or down by more, or where there is none."""
    rows, columns = height.shape
    found = np.empty((rows, columns), np.bool_)
    for j in range(rows):
        for i in range(columns):
            z, over = height[j, i], False
            for k in range(9):  # corners too: a wheel that crosses one makes the whole step
                y, x = j + k // 3 - 1, i + k % 3 - 1
                if 0 <= y < rows and 0 <= x < columns and not abs(height[y, x] - z) <= most:
                    over = True
            found[j, i] = over
    return found


@compiled
def clearance(mask: Any, size: float) -> Any:
    """(h, w) uint8 decimetres that every place of a cell is surely away from set cells.

    Two passes of a chamfer distance, which is never more than a tenth too long; that tenth and the
    two halves of cells are taken off.
    """
    height, width = mask.shape
    far = 1e6
    away = np.empty((height, width), np.float32)
    for j in range(height):
        for i in range(width):
            best = 0.0 if mask[j, i] else far
            if j > 0:
                best = min(best, away[j - 1, i] + 1.0)
                if i > 0:
                    best = min(best, away[j - 1, i - 1] + DIAGONAL)
                if i < width - 1:
                    best = min(best, away[j - 1, i + 1] + DIAGONAL)
            if i > 0:
                best = min(best, away[j, i - 1] + 1.0)
            away[j, i] = best
    found = np.empty((height, width), np.uint8)
    for j in range(height - 1, -1, -1):
        for i in range(width - 1, -1, -1):
            best = away[j, i]
            if j < height - 1:
                best = min(best, away[j + 1, i] + 1.0)
                if i > 0:
                    best = min(best, away[j + 1, i - 1] + DIAGONAL)
                if i < width - 1:
                    best = min(best, away[j + 1, i + 1] + DIAGONAL)
            if i < width - 1:
                best = min(best, away[j, i + 1] + 1.0)
            away[j, i] = best
            metres = (best / 1.0824 - DIAGONAL) * size
            found[j, i] = min(max(int(metres * 10.0), 0), FARTHEST)
    return found


@compiled
def grid_cells(segment: Any, grid: Any) -> Any:
    """Sort segments into the cells that their bounds reach.

    Parameters
    ----------
    segment
        (s, 4 or more) both ends, metres.
    grid
        (5,) west, south, metres of a cell, columns and rows.

    Returns
    -------
    start, row
        (cells + 1,) int32 and (k,) int32, ascending in each cell.
    """
    west, south, size = grid[0], grid[1], grid[2]
    columns, rows = int(grid[3]), int(grid[4])
    start = np.zeros(columns * rows + 1, np.int32)
    row = np.empty(0, np.int32)
    for fill in range(2):
        at = start[:-1].copy()
        for k in range(len(segment)):
            i0 = max(floor((min(segment[k, 0], segment[k, 2]) - west) / size), 0)
            i1 = min(floor((max(segment[k, 0], segment[k, 2]) - west) / size), columns - 1)
            j0 = max(floor((min(segment[k, 1], segment[k, 3]) - south) / size), 0)
            j1 = min(floor((max(segment[k, 1], segment[k, 3]) - south) / size), rows - 1)
            for j in range(j0, j1 + 1):
                for i in range(i0, i1 + 1):
                    cell = j * columns + i
                    if fill == 0:
                        start[cell + 1] += 1
                    else:
                        row[at[cell]] = k
                        at[cell] += 1
        if fill == 0:
            for cell in range(columns * rows):
                start[cell + 1] += start[cell]
            row = np.empty(start[-1], np.int32)
    return start, row
