"""Feasibility: the largest vehicle that fits along each piece, and what stops larger ones."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cityx.geometry.arrays import FloatArray
from cityx.sim.blocks import Blocks
from cityx.sim.compile.lanes import LEAST, Pieces
from cityx.sim.compile.obstacles import Obstacles
from cityx.sim.dynamics import VEHICLE, vehicle_table
from cityx.sim.kernels import fits

# What a place costs where a vehicle does not fit: a line is led round things for the sake of cars
# before that of lorries.
WEIGHTS = (1000.0, 300.0, 20.0, 4.0)
ON_LANES, ACROSS = 0.6, 2.0  # metres that a line may be moved on a lane, and across a junction
ROUNDS = 60  # in which tight bends are rounded
ENDS = 8  # points of lanes that are looked at with ways across: what a bend is rounded over
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
    """(n, v) the segment in the way of each vehicle, `fits.FREE` for none; others are negative."""
    return np.asarray(fits.sweep(pieces.point, pieces.point_start, vehicle_table(), *around.arrays))


def kinked(pieces: Pieces, hit: NDArray[np.int32]) -> NDArray[np.int32]:
    """Return what is in the way of vehicles, with joints that are too sharp for them.

    A way across ends where a lane begins, but may head elsewhere: streets meet at any angle, at a
    junction without any room too. Where a vehicle would have to leave the middle of its lane by
    more than half of it to get round, the way across is a bend too tight.

    Parameters
    ----------
    hit
        As of `blocked_by`, for which each piece is a line of its own.
    """
    found = hit.copy()
    before, after = _joined(pieces)
    first, last = pieces.point_start[:-1], pieces.point_start[1:] - 1
    heading = pieces.point[:, 3]
    across = np.flatnonzero(pieces.junction >= 0)
    turn = [
        np.abs((heading[there] - heading[here] + np.pi) % (2 * np.pi) - np.pi)
        for here, there in ((last[before], first[across]), (last[across], first[after]))
    ]
    table = vehicle_table()
    most = np.array([fits.most_slip(vehicle) for vehicle in table])
    sharp = np.flatnonzero(np.maximum(*turn) > most.min())
    for row in sharp.tolist():
        way = across[row]
        line = _over_joints(pieces, int(before[row]), int(way), int(after[row]))
        for number, vehicle in enumerate(table):
            if found[way, number] == fits.FREE and not _rounds(
                line, vehicle, float(pieces.half_width[way])
            ):
                found[way, number] = fits.BEND
    return found


def _over_joints(pieces: Pieces, before: int, way: int, after: int) -> FloatArray:
    """(k, 6) a way across with the ends of the lanes that it joins as one line."""
    start = pieces.point_start
    line: FloatArray = np.concatenate([
        pieces.point[max(start[before], start[before + 1] - ENDS) : start[before + 1]],
        pieces.point[start[way] : start[way + 1]],
        pieces.point[start[after] : min(start[after] + ENDS, start[after + 1])],
    ])  # fmt: skip
    step = np.hypot(*np.diff(line[:, :2], axis=0).T)
    apart: FloatArray = line[np.r_[True, step > LEAST]]
    fits.measure(apart)
    return apart


def _rounds(line: FloatArray, vehicle: FloatArray, room: float) -> bool:
    """Return whether a vehicle can follow a line that is rounded by no more than so much."""
    heading = np.empty(len(line))
    most = fits.most_slip(vehicle)
    if fits.trailed(line, 0, len(line) - 1, vehicle[fits.WHEELBASE], heading) <= most:
        return True
    start = np.array([0, len(line)], np.int64)
    xy, _ = fits.softened(line, start, vehicle, ROUNDS)
    rounded = line.copy()
    rounded[:, :2] = xy
    fits.measure(rounded)
    aside = np.hypot(*(xy - line[:, :2]).T).max()
    slip = fits.trailed(rounded, 0, len(line) - 1, vehicle[fits.WHEELBASE], heading)
    return bool(aside <= room and slip <= most)


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
