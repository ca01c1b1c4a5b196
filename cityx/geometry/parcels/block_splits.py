"""Splitting blocks: halves of halves, each with a door to the street.

References
----------
Vanegas, Kelly, Weber, Halatsch, Aliaga and Müller, "Procedural generation of parcels in urban
modeling", Computer Graphics Forum 31(2), 2012: recursive subdivision by the oriented box.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.geometry.parcels.street_edges import street_lengths
from cityx.geometry.polygons import FloatArray, IntArray
from cityx.geometry.rectangles import rectangles_of
from cityx.ids import UInt64Array, uniform

JITTER = 0.12  # of the side, how far a cut may lie from the middle
ENOUGH, SPREAD = 1.3, 0.5  # times the wanted area from which a piece is halved; a draw adds more
SMALLEST = 0.5  # of the wanted area that a half must have
# Cuts that are tried: whether across the longer side, and how far beside the middle.
TRIES = ((True, 0.0), (False, 0.0), (True, -0.2), (True, 0.2), (False, -0.2), (False, 0.2))
MOST = 32  # halvings; a block of 4,000 km2 is a parcel by then
SLENDER = 3.0  # times as long as wide, a half is refused
REACH = 2.0  # times its diagonal, how far a cut runs beyond a block


@dataclass(frozen=True)
class Pieces:
    """m pieces of blocks.

    Attributes
    ----------
    shapes
        (m,) polygons.
    block
        (m,) row of each piece's block.
    code
        (m,) uint64 number of the piece in its block, whatever other blocks there are.
    heading
        (m, 2) direction of the street it is laid out along, NaN where it is along none.
    """

    shapes: NDArray[Any]
    block: IntArray
    code: UInt64Array
    heading: FloatArray

    def take(self, rows: Any) -> Pieces:
        """Return some of the pieces."""
        return Pieces(self.shapes[rows], self.block[rows], self.code[rows], self.heading[rows])


def joined_pieces(given: Sequence[Pieces]) -> Pieces:
    """Put pieces together."""
    return Pieces(
        np.concatenate([found.shapes for found in given]),
        np.concatenate([found.block for found in given]),
        np.concatenate([found.code for found in given]),
        np.concatenate([found.heading for found in given]),
    )


def split_blocks(
    blocks: NDArray[Any],
    streets: NDArray[Any],
    ids: UInt64Array,
    area: FloatArray,
    front: FloatArray,
    *,
    seed: int,
) -> Pieces:
    """Cut blocks across their longer side until the pieces are small.

    Where a cut leaves a piece without street, too small or too slender, others are tried (`TRIES`);
    a piece that none suits stays whole.

    Parameters
    ----------
    blocks
        (n,) polygons near the origin of a frame of their own.
    streets
        (n,) their borders.
    ids
        (n,) key of the draws.
    area, front
        (n,) wanted square metres of a piece, and metres of street that it needs.

    Returns
    -------
    pieces
        At least one per block.
    """
    shapes, block = blocks.copy(), np.arange(len(blocks))
    code = np.ones(len(blocks), np.uint64)
    done: list[tuple[NDArray[Any], IntArray, UInt64Array]] = []
    for _ in range(MOST):
        limit = area[block] * (ENOUGH + SPREAD * uniform(seed, "parcel/limit", ids[block], code))
        large = shapely.area(shapes) > limit
        done.append((shapes[~large], block[~large], code[~large]))
        shapes, block, code = shapes[large], block[large], code[large]
        if not len(shapes):
            break
        share = 0.5 + JITTER * (2 * uniform(seed, "parcel/cut", ids[block], code) - 1)
        halves = np.empty((len(shapes), 2), object)
        fine = np.zeros(len(shapes), bool)
        for across, shift in TRIES:
            rows = np.flatnonzero(~fine)
            if not len(rows):
                break
            halves[rows], fine[rows] = _halved(
                shapes[rows], block[rows], streets, area, front, share[rows] + shift, across=across
            )
        done.append((shapes[~fine], block[~fine], code[~fine]))
        doubled = code[fine] * np.uint64(2)
        shapes = halves[fine].ravel()
        block = np.repeat(block[fine], 2)
        code = np.column_stack([doubled, doubled + np.uint64(1)]).ravel()
    else:
        done.append((shapes, block, code))
    found = [np.concatenate(part) for part in zip(*done, strict=True)]
    return Pieces(found[0], found[1], found[2], np.full((len(found[0]), 2), np.nan))


def _halved(
    shapes: NDArray[Any],
    block: IntArray,
    streets: NDArray[Any],
    area: FloatArray,
    front: FloatArray,
    share: FloatArray,
    *,
    across: bool,
) -> tuple[NDArray[Any], NDArray[np.bool_]]:
    """Cut shapes in two; (n, 2) halves and whether both will do."""
    box = rectangles_of(shapes)
    angle = box.angle if across else box.angle + np.pi / 2
    length = box.length if across else box.width
    along = np.column_stack([np.cos(angle), np.sin(angle)])
    middle = box.centre + ((share - 0.5) * length)[:, None] * along
    side = np.column_stack([-along[:, 1], along[:, 0]])
    far = (REACH * np.hypot(box.length, box.width))[:, None]
    low, high = middle - far * side, middle + far * side
    back = shapely.polygons(np.stack([low, high, high - far * along, low - far * along], axis=1))
    ahead = shapely.polygons(np.stack([low, low + far * along, high + far * along, high], axis=1))
    halves = np.column_stack(
        [shapely.intersection(shapes, back), shapely.intersection(shapes, ahead)]
    )
    flat, owner = halves.ravel(), np.repeat(block, 2)
    fine = (shapely.get_type_id(flat) == 3) & (shapely.area(flat) > SMALLEST * area[owner])
    rows = np.flatnonzero(fine)
    fine[rows] = street_lengths(flat[rows], streets, owner[rows]) >= front[owner[rows]]
    rows = np.flatnonzero(fine)
    shape = rectangles_of(flat[rows])
    fine[rows] = shape.length < SLENDER * shape.width
    return halves, fine.reshape(-1, 2).all(axis=1)
