"""Numbers that fill intervals and squares evenly, however many of them are taken.

References
----------
Roberts, "The unreasonable effectiveness of quasirandom sequences", 2018 (sequences of the
generalised golden ratio). Cranley and Patterson, SIAM J. Numer. Anal. 13, 1976 (their rotation).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cityx.ids import uniform

_BITS = 16  # of each coordinate along the curve of `nearby_order`


def _ratio(dimensions: int) -> float:
    """Return the root of x ** (dimensions + 1) = x + 1: the golden ratio for 1."""
    x = 1.5
    for _ in range(60):
        x = (1.0 + x) ** (1.0 / (dimensions + 1))
    return x


def spread(seed: int, purpose: str, numbers: ArrayLike, dimensions: int = 1) -> NDArray[np.float64]:
    """Return points of a sequence of low discrepancy, (n, dimensions) in [0, 1).

    Parameters
    ----------
    seed, purpose
        Turn the whole sequence round the unit cube, so that two plans begin at other places.
    numbers
        (n,) int, places in the sequence from 0. A point depends on its own number alone, and those
        of 0 to any k fill the cube evenly.
    dimensions
        Of the cube.
    """
    place = np.asarray(numbers, np.int64).reshape(-1, 1)
    step = _ratio(dimensions) ** -np.arange(1.0, dimensions + 1)
    turn = uniform(seed, purpose, np.arange(1, dimensions + 1))
    return np.asarray(np.mod(turn + (place + 1) * step, 1.0))


def nearby_order(points: ArrayLike) -> NDArray[np.int64]:
    """Return the order of (n, 2) points along a Z-curve, which keeps neighbours together.

    Points that share a cell of the curve stay in their order.
    """
    places = np.asarray(points, float).reshape(-1, 2)
    if not len(places):
        return np.zeros(0, np.int64)
    low = places.min(axis=0)
    side = max(float((places.max(axis=0) - low).max()), 1e-9)
    cell = np.minimum((places - low) / side * (1 << _BITS), (1 << _BITS) - 1).astype(np.uint64)
    code = np.zeros(len(places), np.uint64)
    for bit in range(_BITS):
        for axis in (0, 1):
            digit = (cell[:, axis] >> np.uint64(bit)) & np.uint64(1)
            code |= digit << np.uint64(2 * bit + axis)
    return np.argsort(code, kind="stable").astype(np.int64)
