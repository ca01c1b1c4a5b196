"""How far one can drive on from each piece."""

from __future__ import annotations

from typing import Any

import numpy as np

from cityx.geometry.compiled import compiled


@compiled
def reach_of(next_start: Any, follows: Any, length: Any, usable: Any, most: float) -> Any:
    """Return (n,) metres that can be driven from the start of each piece, `most` at most.

    Parameters
    ----------
    next_start, follows, length
        The pieces.
    usable
        (n,) bool, which may be driven.
    """
    count = len(length)
    found = np.zeros(count)
    changed = True
    while changed:
        changed = False
        for p in range(count):
            if not usable[p]:
                continue
            best = 0.0
            for k in range(next_start[p], next_start[p + 1]):
                best = max(best, found[follows[k]])
            total = min(length[p] + best, most)
            if total > found[p] + 1e-9:
                found[p] = total
                changed = True
    return found
