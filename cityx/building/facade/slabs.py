"""Facings: thin slabs of stone or paint on walls, cut out around the openings."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cityx.geometry.arrays import FloatArray, IntArray
from cityx.geometry.ranges import numbered

LEAST = 0.01  # metres; narrower or lower pieces are left out


@dataclass(frozen=True)
class Pieces:
    """Rectangles on walls, p of them.

    Attributes
    ----------
    source
        (p,) int64, row of the rectangle each was cut from.
    x0, x1, z0, z1
        (p,) metres along the wall from its start, heights.
    """

    source: IntArray
    x0: FloatArray
    x1: FloatArray
    z0: FloatArray
    z1: FloatArray


def around(rectangles: Pieces, wall: IntArray, holes: Pieces) -> Pieces:
    """Cut rectangles so that they leave holes free.

    Parameters
    ----------
    rectangles
        r rectangles; ``source`` is not read.
    wall
        (r,) wall of each.
    holes
        The holes; ``source`` is their wall.

    Returns
    -------
    pieces
        Rectangles that together cover what lies beside, below and above the holes; where holes
        stand above one another, also what lies between counts as hole.
    """
    count = len(wall)
    row, hole = _pairs(wall, holes.source)
    meets = (holes.x0[hole] < rectangles.x1[row]) & (holes.x1[hole] > rectangles.x0[row])
    meets &= (holes.z0[hole] < rectangles.z1[row]) & (holes.z1[hole] > rectangles.z0[row])
    row, hole = row[meets], hole[meets]
    number = np.arange(count)
    at = np.concatenate([rectangles.x0, rectangles.x1, holes.x0[hole], holes.x1[hole]])
    of = np.concatenate([number, number, row, row])
    at = np.clip(at, rectangles.x0[of], rectangles.x1[of])
    order = np.lexsort((at, of))
    at, of = at[order], of[order]
    column = np.flatnonzero((of[1:] == of[:-1]) & (at[1:] - at[:-1] > LEAST))
    source, x0, x1 = of[column], at[column], at[column + 1]
    # The lowest foot and the highest head of the holes over the middle of each column.
    low, high = np.full(len(column), np.inf), np.full(len(column), -np.inf)
    mine, pair = _pairs(source, row)
    middle = (x0 + x1)[mine] / 2
    over = (holes.x0[hole[pair]] < middle) & (middle < holes.x1[hole[pair]])
    np.minimum.at(low, mine[over], holes.z0[hole[pair[over]]])
    np.maximum.at(high, mine[over], holes.z1[hole[pair[over]]])
    bottom, top = rectangles.z0[source], rectangles.z1[source]
    whole = np.isinf(low)
    upper = ~whole & (high < top - LEAST)
    lower = ~whole & (low > bottom + LEAST)
    parts = [(whole, bottom, top), (upper, np.maximum(high, bottom), top),
             (lower, bottom, np.minimum(low, top))]  # fmt: skip
    pick = np.concatenate([np.flatnonzero(mask) for mask, _, _ in parts])
    z0 = np.concatenate([foot[mask] for mask, foot, _ in parts])
    z1 = np.concatenate([head[mask] for mask, _, head in parts])
    order = np.lexsort((z0, x0[pick], source[pick]))
    pick = pick[order]
    return Pieces(source[pick], x0[pick], x1[pick], z0[order], z1[order])


def _pairs(wanted: IntArray, offered: IntArray) -> tuple[IntArray, IntArray]:
    """All pairs of rows with equal keys."""
    order = np.argsort(offered, kind="stable")
    first = np.searchsorted(offered[order], wanted)
    number = np.searchsorted(offered[order], wanted, side="right") - first
    left = np.repeat(np.arange(len(wanted)), number)
    step = numbered(number)
    return left, order[first[left] + step]


def coursed(pieces: Pieces, zero: FloatArray, course: float) -> Pieces:
    """Cut pieces at the bed joints of courses; `zero` (p,) is the height of a joint."""
    first = np.floor((pieces.z0 - zero) / course + 1e-6)
    last = np.ceil((pieces.z1 - zero) / course - 1e-6)
    count = np.maximum(last - first, 1).astype(np.int64)
    of = np.repeat(np.arange(len(count)), count)
    step = first[of] + numbered(count)
    low = np.maximum(pieces.z0[of], zero[of] + step * course)
    high = np.minimum(pieces.z1[of], zero[of] + (step + 1) * course)
    tall = high - low > LEAST
    of, low, high = of[tall], low[tall], high[tall]
    return Pieces(pieces.source[of], pieces.x0[of], pieces.x1[of], low, high)


def slabs(
    left: FloatArray, right: FloatArray, normal: FloatArray, z0: FloatArray, z1: FloatArray,
    out: float, chamfer: float,
) -> tuple[FloatArray, NDArray[np.int64]]:  # fmt: skip
    """Make closed slabs on walls with chamfered upper and lower edges.

    Parameters
    ----------
    left, right
        (p, 2) feet of the ends on the wall, as seen from outside.
    normal
        (p, 2) outward unit normals.
    z0, z1
        (p,) heights.
    out, chamfer
        How far a slab stands out, and how much of its edges is cut; metres.

    Returns
    -------
    vertices, faces
        (p, 12, 3) and (10, 4) int64, the same faces for every slab.
    """
    cut = np.minimum(chamfer, 0.3 * (z1 - z0))
    steps = np.stack(
        [
            np.stack([np.zeros_like(z0), z0], 1),
            np.stack([np.full_like(z0, out) - cut, z0], 1),
            np.stack([np.full_like(z0, out), z0 + cut], 1),
            np.stack([np.full_like(z0, out), z1 - cut], 1),
            np.stack([np.full_like(z0, out) - cut, z1], 1),
            np.stack([np.zeros_like(z0), z1], 1),
        ],
        axis=1,
    )  # (p, 6, 2): outward, height
    ends = []
    for foot in (left, right):
        plan = foot[:, None] + normal[:, None] * steps[:, :, :1]
        ends.append(np.concatenate([plan, steps[:, :, 1:]], axis=2))
    around_it = [[i, i + 6, (i + 1) % 6 + 6, (i + 1) % 6] for i in range(6)]
    caps = [[0, 1, 2, 3], [0, 3, 4, 5], [9, 8, 7, 6], [11, 10, 9, 6]]
    return np.concatenate(ends, axis=1), np.array(around_it + caps, np.int64)
