"""Signals of a world: those of the city, or a plan of two phases where its traffic has none yet."""

from __future__ import annotations

from collections import Counter, defaultdict
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.city.signals import STATE, Signals
from cityx.geometry.arrays import FloatArray, IntArray
from cityx.ids import hash_bits
from cityx.sim.compile.lanes import Pieces
from cityx.traffic.streets import Streets

GREEN, YELLOW, CLEARING = 25.0, 3.0, 3.0  # seconds of each phase
SAME_WAY = 0.7  # cosine between two arms, one way or the other, that go together


@dataclass(frozen=True)
class Programs:
    """Programs of signals, h of them.

    Attributes
    ----------
    signal
        (n,) int32, program that rules a piece, -1 for none.
    cycle, change_start, time, state
        As of `cityx.city.signals.Signals`.
    """

    signal: NDArray[np.int32]
    cycle: FloatArray
    change_start: IntArray
    time: FloatArray
    state: NDArray[np.uint8]


def programs_of(signals: Signals | None, pieces: Pieces, streets: Streets) -> Programs:
    """Return the programs that rule the ways across junctions."""
    if signals is not None:
        return _recorded(signals, pieces)
    return _planned(pieces, streets)


def _recorded(signals: Signals, pieces: Pieces) -> Programs:
    heads = zip(signals.lane.tolist(), signals.onto.tolist(), strict=True)
    row = {pair: number for number, pair in enumerate(heads) if pair[0]}
    pairs = zip(pieces.lane.tolist(), pieces.onto.tolist(), strict=True)
    found = np.array([row.get(pair, -1) for pair in pairs], np.int32)
    return Programs(found, signals.cycle, signals.change_start, signals.time, signals.state)


def _planned(pieces: Pieces, streets: Streets) -> Programs:
    """Let the arms of each junction under signals go in two turns, those that face each other."""
    signal = np.full(pieces.count, -1, np.int32)
    across = np.flatnonzero(pieces.junction >= 0)
    ruled = across[streets.signals[pieces.junction[across]]] if len(across) else across
    whole = 2 * (GREEN + YELLOW + CLEARING)
    half = whole / 2
    programs: list[tuple[list[float], list[int]]] = []
    for junction in np.unique(pieces.junction[ruled]).tolist():
        rows = ruled[pieces.junction[ruled] == junction]
        heading = pieces.point[pieces.point_start[rows], 3]
        first = np.abs(np.cos(heading - heading[0])) > SAME_WAY
        offset = hash_bits(0, "sim/signals", junction) % int(whole)
        for turn, chosen in enumerate((first, ~first)):
            if chosen.any():
                signal[rows[chosen]] = len(programs)
                programs.append(_program(offset + turn * half, whole))
    times = [time for time, _ in programs]
    start = np.concatenate([[0], np.cumsum([len(each) for each in times])]).astype(np.int64)
    return Programs(
        signal, np.full(len(programs), whole), start,
        np.array([t for each in times for t in each]),
        np.array([s for _, states in programs for s in states], np.uint8),
    )  # fmt: skip


def _program(begin: float, cycle: float) -> tuple[list[float], list[int]]:
    """Return when one turn changes, seconds, and to what; it becomes green at `begin`."""
    changes = sorted(((begin + after) % cycle, STATE[name]) for after, name in
                     ((0.0, "green"), (GREEN, "yellow"), (GREEN + YELLOW, "red")))  # fmt: skip
    if changes[0][0] > 0.0:
        changes = [(0.0, changes[-1][1]), *changes]
    return [time for time, _ in changes], [state for _, state in changes]


STOP_LINE = 15.0  # metres before the end of a lane within which a crosswalk lies at its signals


class Crossed(NamedTuple):
    """Pieces of a world that crosswalks may cross; arrays of `cityx.sim.world.World`."""

    point_start: IntArray
    point: FloatArray
    signal: NDArray[np.int32]
    across: NDArray[np.bool_]
    next_start: NDArray[np.int32]
    next: NDArray[np.int32]


def crossing_signals(pieces: Crossed, ends: FloatArray) -> NDArray[np.int32]:
    """Return (c,) the program that stops whoever drives over each crosswalk, -1 for none.

    That of the lanes that end behind it; where it crosses none, as on the way out of a junction,
    the one that most ways across it have.

    Parameters
    ----------
    pieces
        Of the world.
    ends
        (c, 2, 2) metres.
    """
    found = np.full(len(ends), -1, np.int32)
    if not len(ends) or not (pieces.signal >= 0).any():
        return found
    count = np.diff(pieces.point_start)
    owner = np.repeat(np.arange(len(count)), count)
    lines = shapely.linestrings(pieces.point[:, :2], indices=owner)
    axes = shapely.linestrings(ends)
    crosswalk, piece = shapely.STRtree(lines).query(axes, predicate="intersects")
    spot = shapely.intersection(axes[crosswalk], lines[piece])
    left = shapely.length(lines[piece]) - shapely.line_locate_point(
        lines[piece], shapely.centroid(spot)
    )
    votes: dict[int, Counter[tuple[int, int]]] = defaultdict(Counter)
    for one, row, metres in zip(crosswalk.tolist(), piece.tolist(), left.tolist(), strict=True):
        if pieces.across[row]:
            ahead, weight = [row], 0
        elif metres < STOP_LINE:
            ahead, weight = pieces.next[slice(*pieces.next_start[row : row + 2])].tolist(), 1
        else:
            continue
        for way in ahead:
            if pieces.signal[way] >= 0:
                votes[one][weight, int(pieces.signal[way])] += 1
    for one, counted in votes.items():
        (_, program), _ = max(counted.items(), key=lambda item: (item[0][0], item[1], -item[0][1]))
        found[one] = program
    return found
