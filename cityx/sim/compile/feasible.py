"""Feasibility: the largest vehicle that fits along each piece, and what stops larger ones."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cityx.geometry.arrays import FloatArray
from cityx.sim.blocks import Blocks
from cityx.sim.compile.lanes import Pieces
from cityx.sim.compile.obstacles import Obstacles
from cityx.sim.dynamics import VEHICLE, vehicle_table
from cityx.sim.kernels import fits

# What a place costs where a vehicle does not fit: a line is led round things for the sake of cars
# before that of lorries.
WEIGHTS = (1000.0, 300.0, 20.0, 4.0)
ON_LANES, ACROSS = 0.6, 2.0  # metres that a line may be moved on a lane, and across a junction
ROUNDS = 60  # in which tight bends are rounded
ENDS = 6  # points of lanes that are looked at with ways across
APART = 0.2  # metres; points nearer to the one before say nothing of where a line leads
SMOOTH = 2  # points to either side over which a moved line is evened


@dataclass(frozen=True)
class Surroundings:
    """What is in the way of vehicles: rasters and segments, as kernels take them."""

    flags: Blocks
    clearance: Blocks
    frame: FloatArray
    obstacles: Obstacles

    @property
    def arrays(self) -> tuple[Any, ...]:
        """The arguments of kernels."""
        held = self.obstacles
        return (self.flags, self.clearance, self.frame, held.segment, held.cell_start,
                held.cell_segment, held.grid)  # fmt: skip


def blocked_by(pieces: Pieces, around: Surroundings) -> NDArray[np.int32]:
    """(n, v) the segment in the way of each vehicle, `fits.FREE` for none; others are negative.

    Along a way across it goes from the end of the lane before to the beginning of the one after,
    rounding the corners between them as a driver does.
    """
    hit = np.asarray(fits.sweep(pieces.point, pieces.point_start, vehicle_table(), *around.arrays))
    across = np.flatnonzero(pieces.junction >= 0)
    if not len(across):
        return hit
    line, start = _with_lanes(pieces, across)
    car = vehicle_table()[VEHICLE["car"]]
    xy, changed = fits.softened(line, start, car, ROUNDS)
    moved = np.maximum.reduceat(np.hypot(*(xy - line[:, :2]).T), start[:-1])
    for row in np.flatnonzero(changed & (moved <= ON_LANES)).tolist():
        own = line[start[row] : start[row + 1]]
        own[:, :2] = xy[start[row] : start[row + 1]]
        fits.measure(own)
    found = fits.sweep(line, start, vehicle_table(), *around.arrays)
    hit[across] = np.where(hit[across] == fits.FREE, found, hit[across])
    return hit


def _with_lanes(pieces: Pieces, across: NDArray[np.int64]) -> tuple[FloatArray, NDArray[np.int64]]:
    """Return ways across with the ends of the lanes that they join, and where each line starts."""
    start, lines = pieces.point_start, []
    for row, before, after in zip(across.tolist(), *_joined(pieces), strict=True):
        tail = pieces.point[max(start[before + 1] - ENDS, start[before]) : start[before + 1]]
        head = pieces.point[start[after] : min(start[after] + ENDS, start[after + 1])]
        line = _spread(np.concatenate([tail, pieces.point[start[row] : start[row + 1]], head]))
        fits.measure(line)
        lines.append(line)
    return np.concatenate(lines), np.cumsum([0, *map(len, lines)]).astype(np.int64)


def _spread(line: FloatArray) -> FloatArray:
    """Leave out points of a line that are where the one before is."""
    kept = [0]
    for k in range(1, len(line)):
        if np.hypot(*(line[k, :2] - line[kept[-1], :2])) > APART:
            kept.append(k)
    return line[kept]


def fitting(hit: NDArray[np.int32]) -> NDArray[np.int64]:
    """(n,) how many vehicles, from the smallest on, nothing is in the way of, of (n, v)."""
    return np.asarray(np.cumprod(hit == fits.FREE, axis=1).sum(axis=1), np.int64)


def led_round(pieces: Pieces, around: Surroundings) -> Pieces:
    """Move the lines of pieces aside where a van would touch something, ends of lanes first.

    Ways across begin and end where the lanes do. Lines that nothing is gained for stay.
    """
    xy, changed = fits.softened(
        pieces.point, pieces.point_start, vehicle_table()[VEHICLE["car"]], ROUNDS
    )
    pieces = _with_points(pieces, xy, np.flatnonzero(changed))
    lane = pieces.junction < 0
    van = blocked_by(pieces, around)[:, VEHICLE["van"]] != fits.FREE
    free = np.full(pieces.count, np.nan)
    aside = _aside(pieces, around, van & lane, ON_LANES, free, free)
    moved = _moved(pieces, aside)
    begin, end = free.copy(), free.copy()
    source, target = _joined(moved)
    across = np.flatnonzero(~lane)
    first, last = pieces.point_start[:-1], pieces.point_start[1:] - 1
    begin[across] = aside[last[source]]
    end[across] = aside[first[target]]
    drawn = np.zeros(pieces.count, bool)
    drawn[across] = (begin[across] != 0) | (end[across] != 0)
    aside = _aside(pieces, around, ~lane & (van | drawn), ACROSS, begin, end) + np.where(
        np.repeat(lane, np.diff(pieces.point_start)), aside, 0.0
    )
    return _rounded_again(_moved(pieces, aside), around)


def _rounded_again(pieces: Pieces, around: Surroundings) -> Pieces:
    """Round bends that came of moving lines aside, where larger vehicles fit along them then."""
    xy, changed = fits.softened(
        pieces.point, pieces.point_start, vehicle_table()[VEHICLE["car"]], ROUNDS
    )
    rows = np.flatnonzero(changed)
    if not len(rows):
        return pieces
    rounded = _with_points(pieces, xy, rows)
    size = np.diff(pieces.point_start)[rows]
    start = np.concatenate([[0], np.cumsum(size)])
    of = np.repeat(pieces.point_start[rows] - start[:-1], size) + np.arange(start[-1])
    now, then = (
        fitting(fits.sweep(each.point[of], start, vehicle_table(), *around.arrays))
        for each in (pieces, rounded)
    )
    return _with_points(pieces, xy, rows[then > now])


def _joined(pieces: Pieces) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return the lanes before and after each way across, in their order."""
    count = np.diff(pieces.next_start)
    owner = np.repeat(np.arange(pieces.count), count)
    before = np.full(pieces.count, -1, np.int64)
    from_lane = pieces.junction[owner] < 0
    before[pieces.next[from_lane]] = owner[from_lane]
    after = np.full(pieces.count, -1, np.int64)
    after[owner[~from_lane]] = pieces.next[~from_lane]
    across = np.flatnonzero(pieces.junction >= 0)
    return before[across], after[across]


def _aside(
    pieces: Pieces, around: Surroundings, wanted: NDArray[np.bool_], room: float,
    begin: FloatArray, end: FloatArray,
) -> FloatArray:  # fmt: skip
    found = fits.ways_round(
        pieces.point, pieces.point_start, wanted, np.full(pieces.count, room), begin, end,
        vehicle_table()[: len(WEIGHTS)], np.array(WEIGHTS), *around.arrays,
    )  # fmt: skip
    return np.asarray(found)


def _moved(pieces: Pieces, aside: FloatArray) -> Pieces:
    """Move points to the left; headings and lengths are measured anew."""
    start = pieces.point_start
    touched = np.flatnonzero(np.logical_or.reduceat(aside != 0, start[:-1]))
    by = aside.copy()
    for row in touched.tolist():
        own = slice(start[row], start[row + 1])
        by[own] = _evened(aside[own])
    heading = pieces.point[:, 3]
    side = np.column_stack([-np.sin(heading), np.cos(heading)])
    return _with_points(pieces, pieces.point[:, :2] + by[:, None] * side, touched)


def _with_points(pieces: Pieces, xy: FloatArray, rows: NDArray[np.int64]) -> Pieces:
    """Put the points of some lines elsewhere in plan."""
    point = pieces.point.copy()
    for row in rows.tolist():
        own = slice(pieces.point_start[row], pieces.point_start[row + 1])
        point[own, :2] = xy[own]
        fits.measure(point[own])
    return replace(pieces, point=point)


def _evened(aside: FloatArray) -> FloatArray:
    """Even steps out; the ends stay."""
    if len(aside) < 3:
        return aside
    padded = np.pad(aside, SMOOTH, mode="edge")
    width = 2 * SMOOTH + 1
    even = np.convolve(padded, np.full(width, 1.0 / width), mode="valid")
    even[0], even[-1] = aside[0], aside[-1]
    return even
