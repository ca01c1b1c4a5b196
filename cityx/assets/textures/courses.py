"""Courses of blocks: bricks, ashlar, setts, slabs, slates."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cityx.assets.textures.noise import Field, axes, lattice, per_cell


@dataclass(frozen=True)
class Courses:
    """Blocks laid in rows.

    Attributes
    ----------
    index
        (s, s) number of the block of each pixel.
    across, up
        (s, s) metres from the left and the lower edge of the block.
    edge
        (s, s) metres to the nearest edge of the block.
    """

    index: NDArray[np.int64]
    across: Field
    up: Field
    edge: Field
    key: str

    def draw(self, k: int = 0) -> Field:
        """Draw one number in [0, 1) per block."""
        return per_cell(self.key, self.index, k)


def lay(
    key: str,
    size: int,
    tile: float,
    columns: int,
    rows: int,
    *,
    bond: float = 0.5,
    jitter: float = 0.0,
    warp: tuple[Field, Field] | None = None,
) -> Courses:
    """Lay `rows` courses of `columns` blocks on a tile.

    Parameters
    ----------
    bond
        Shift of every second row, in blocks; `rows` must be even unless it is 0.
    jitter
        How far joints between blocks of a row stray, in blocks, below 0.5.
    warp
        Metres by which edges stray across and up, for work that is not quite straight.
    """
    u, v = axes(size)
    du, dv = (0.0, 0.0) if warp is None else (warp[0] / tile, warp[1] / tile)
    y = np.broadcast_to((v + dv) * rows, (size, size))
    row = np.floor(y).astype(np.int64)
    x = np.broadcast_to((u + du) * columns, (size, size)) - np.float32(bond) * (row % 2)
    column = np.floor(x).astype(np.int64)
    stray = (lattice(key, columns, rows, 7) - np.float32(0.5)) * np.float32(2 * jitter)
    r = row % rows
    if jitter > 0:  # the joint at each cell's left end has moved by `stray` cells
        fraction = x - column
        before = fraction < stray[r, column % columns]
        after = fraction >= 1 + stray[r, (column + 1) % columns]
        column = column - before + after
    left = column + stray[r, column % columns]
    right = column + 1 + stray[r, (column + 1) % columns]
    across = (x - left) * np.float32(tile / columns)
    width = (right - left) * np.float32(tile / columns)
    up = (y - row) * np.float32(tile / rows)
    edge = np.minimum(
        np.minimum(across, width - across), np.minimum(up, np.float32(tile / rows) - up)
    )
    index = r * columns + column % columns
    return Courses(
        index, across.astype(np.float32), up.astype(np.float32), edge.astype(np.float32), key
    )
