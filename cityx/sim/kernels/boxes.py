"""Upright boxes against segments and against each other, and what a place of a raster says."""

from __future__ import annotations

from math import cos, floor, sin
from typing import Any

from cityx.geometry.compiled import borrowing
from cityx.sim.blocks import SIDE
from cityx.sim.kernels.tables import HEIGHT, Z

# Columns of segments: both ends, and the heights between which it is solid.
X0, Y0, X1, Y1, LOW, HIGH = range(6)


@borrowing
def crosses(
    u0: float, v0: float, u1: float, v1: float, half_length: float, half_width: float
) -> Any:
    """Return whether a segment, in the frame of a box about the origin, reaches into it."""
    begin, end = 0.0, 1.0
    du, dv = u1 - u0, v1 - v0
    for axis in range(2):
        at = u0 if axis == 0 else v0
        step = du if axis == 0 else dv
        half = half_length if axis == 0 else half_width
        if abs(step) < 1e-12:
            if abs(at) > half:
                return False
            continue
        one, other = (-half - at) / step, (half - at) / step
        begin = max(begin, min(one, other))
        end = min(end, max(one, other))
        if begin > end:
            return False
    return True


@borrowing
def first_touched(
    x: float, y: float, z: float, heading: float, half_length: float, half_width: float,
    height: float, segment: Any, cell_start: Any, cell_segment: Any, grid: Any,
) -> Any:  # fmt: skip
    """Return the lowest row of the segments that a box stands in, -1 for none.

    Parameters
    ----------
    x, y, z, heading
        Middle of its foot, metres, and radians.
    half_length, half_width, height
        Metres.
    segment
        (s, 6) columns above.
    cell_start, cell_segment
        Segments by cell, row by row.
    grid
        (5,) west, south, metres of a cell, columns and rows.
    """
    c, s = cos(heading), sin(heading)
    reach_x = abs(c) * half_length + abs(s) * half_width
    reach_y = abs(s) * half_length + abs(c) * half_width
    west, south, size = grid[0], grid[1], grid[2]
    columns, rows = int(grid[3]), int(grid[4])
    i0 = max(floor((x - reach_x - west) / size), 0)
    i1 = min(floor((x + reach_x - west) / size), columns - 1)
    j0 = max(floor((y - reach_y - south) / size), 0)
    j1 = min(floor((y + reach_y - south) / size), rows - 1)
    foot, head = z + STEP, z + height
    found = -1
    for j in range(j0, j1 + 1):
        for i in range(i0, i1 + 1):
            cell = j * columns + i
            for k in range(cell_start[cell], cell_start[cell + 1]):
                row = cell_segment[k]
                if found >= 0 and row >= found:
                    continue
                if segment[row, HIGH] <= foot or segment[row, LOW] >= head:
                    continue
                ax, ay = segment[row, X0] - x, segment[row, Y0] - y
                bx, by = segment[row, X1] - x, segment[row, Y1] - y
                if crosses(ax * c + ay * s, ay * c - ax * s, bx * c + by * s, by * c - bx * s,
                           half_length, half_width):  # fmt: skip
                    found = row
    return found


STEP = 0.25  # metres that wheels roll over, or by which a way rises along a body


@borrowing
def boxes_touch(
    ax: float, ay: float, a_heading: float, a_length: float, a_width: float,
    bx: float, by: float, b_heading: float, b_length: float, b_width: float,
) -> Any:  # fmt: skip
    """Return whether two rectangles, given by half sizes, overlap: no axis separates them."""
    dx, dy = bx - ax, by - ay
    reach = a_length + a_width + b_length + b_width
    if dx * dx + dy * dy > reach * reach:
        return False
    ac, as_, bc, bs = cos(a_heading), sin(a_heading), cos(b_heading), sin(b_heading)
    along, across = abs(ac * bc + as_ * bs), abs(ac * bs - as_ * bc)  # cosine and sine between
    if abs(dx * ac + dy * as_) > a_length + b_length * along + b_width * across:
        return False
    if abs(dy * ac - dx * as_) > a_width + b_length * across + b_width * along:
        return False
    if abs(dx * bc + dy * bs) > b_length + a_length * along + a_width * across:
        return False
    return abs(dy * bc - dx * bs) <= b_width + a_length * across + a_width * along


@borrowing
def over_each_other(real: Any, n: int, m: int) -> Any:
    """Return whether one of two movers is above the other.

    Of those that fly the heights of the bodies tell; others stand on ground that may slope between
    the middles of two bodies that touch.
    """
    up = real[Z, m] - real[Z, n]
    if min(real[HEIGHT, m], real[HEIGHT, n]) < FLAT:
        return up > real[HEIGHT, n] or -up > real[HEIGHT, m]
    return abs(up) > LEVEL


@borrowing
def cell_of(x: float, y: float, frame: Any) -> Any:
    """Return row and column of a place in a raster, (-1, -1) beyond it.

    Parameters
    ----------
    x, y
        Metres.
    frame
        (5,) west, south, metres of a cell, columns and rows.
    """
    i = floor((x - frame[0]) / frame[2])
    j = floor((y - frame[1]) / frame[2])
    if i < 0 or j < 0 or i >= frame[3] or j >= frame[4]:
        return -1, -1
    return j, i


@borrowing
def cell_value(raster: Any, row: int, column: int) -> Any:
    """Return the value of a cell of a raster in blocks, `cityx.sim.blocks.Blocks`."""
    own = raster.table[row >> BITS, column >> BITS]
    return raster.block[own, row & (SIDE - 1), column & (SIDE - 1)]


@borrowing
def wheels_off(
    x: float, y: float, heading: float, half_length: float, half_width: float, lift: float,
    flags: Any, frame: Any,
) -> Any:  # fmt: skip
    """Return how many of four wheels are on no roadway.

    Parameters
    ----------
    x, y, heading
        Middle, metres and radians.
    half_length, half_width
        Half of wheelbase and of track, metres.
    lift
        Metres above the ground of the way it is on: on a deck the ground below does not count.
    flags, frame
        Raster of `cityx.sim.world.FLAGS` in blocks, and where it lies.
    """
    c, s = cos(heading), sin(heading)
    off = 0
    for k in range(4):
        u = half_length if k < 2 else -half_length
        v = half_width if k % 2 else -half_width
        row, column = cell_of(x + c * u - s * v, y + s * u + c * v, frame)
        if row < 0:
            off += 1
            continue
        flag = cell_value(flags, row, column)
        wanted = DECK if abs(lift) > STOREY else ROAD | DECK
        if flag & wanted == 0:
            off += 1
    return off


LEVEL = 2.0  # metres of height within which bodies touch
FLAT = 0.5  # metres of height below which a body is one that flies
ROAD, DECK = 1, 2  # bits of `cityx.sim.world.FLAGS`
BITS = SIDE.bit_length() - 1  # of a row or column within a block
STOREY = 2.5  # metres above or below the ground from which a way is another level
