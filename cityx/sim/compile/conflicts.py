"""Conflicts of a world: ways across a junction that cannot be used at once, and who goes first."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cityx.geometry.arrays import BoolArray
from cityx.sim.compile.lanes import Pieces
from cityx.traffic.conflicts import conflicts_of
from cityx.traffic.streets import Streets


def conflicts_by_piece(
    pieces: Pieces, streets: Streets
) -> tuple[NDArray[np.int32], NDArray[np.int32], BoolArray]:
    """Return the conflicts of each piece.

    Returns
    -------
    start, other, yields
        (n + 1,) and (m,) int32, pieces that meet each one, ascending; and (m,) whether it gives
        way to that one.
    """
    found = conflicts_of(streets)
    row = np.full(len(streets.links), -1, np.int64)
    across = np.flatnonzero(pieces.link >= 0)
    row[pieces.link[across]] = across
    first, second = row[found.first], row[found.second]
    kept = (first >= 0) & (second >= 0)
    first, second = first[kept], second[kept]
    one, other = np.concatenate([first, second]), np.concatenate([second, first])
    gives = np.concatenate([np.zeros(len(first), bool), np.ones(len(second), bool)])
    order = np.lexsort((other, one))
    one, other, gives = one[order], other[order], gives[order]
    start = np.searchsorted(one, np.arange(pieces.count + 1)).astype(np.int32)
    return start, other.astype(np.int32), gives
