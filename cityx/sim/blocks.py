"""Blocks: a raster in squares, of which those that are the same all over are kept once.

A raster of a site of hundreds of square kilometres with few streets takes as much memory as what is
built there: fields, water and what is far from all that is solid are one square for each value.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cityx.geometry.arrays import IntArray

SIDE = 64  # cells of the side of a block; kernels take the bits of it
WINDOW = 32  # blocks of the side of what is drawn at once
Place = tuple[int, int, int, int]


class Blocks(NamedTuple):
    """A raster of bytes; row 0 is in the south.

    Attributes
    ----------
    table
        (r, c) int32, row of `block` by block of the raster.
    block
        (k, SIDE, SIDE) uint8; cells beyond the raster have any value.
    """

    table: NDArray[np.int32]
    block: NDArray[np.uint8]

    def at(self, row: IntArray, column: IntArray) -> NDArray[np.uint8]:
        """Return the values of cells, rows and columns of any one shape."""
        own = self.table[row // SIDE, column // SIDE]
        return np.asarray(self.block[own, row % SIDE, column % SIDE])

    def within(self, row: int, column: int, height: int, width: int) -> NDArray[np.uint8]:
        """Return (height, width) the cells from one on."""
        own = self.table_within(row, column, height, width)
        whole = self.block[own].swapaxes(1, 2).reshape(own.shape[0] * SIDE, own.shape[1] * SIDE)
        return np.asarray(whole[row % SIDE :, column % SIDE :][:height, :width])

    def table_within(self, row: int, column: int, height: int, width: int) -> NDArray[np.int32]:
        """Return the part of the table that has such cells."""
        last, right = -(-(row + height) // SIDE), -(-(column + width) // SIDE)
        return self.table[row // SIDE : last, column // SIDE : right]


def windows_of(height: int, width: int) -> Iterator[Place]:
    """Yield row, column, height and width of the windows that a raster is drawn in."""
    side = SIDE * WINDOW
    for row in range(0, height, side):
        for column in range(0, width, side):
            yield row, column, min(side, height - row), min(side, width - column)


class Gathered:
    """Blocks as windows are drawn; a class for those that are there already."""

    def __init__(self, height: int, width: int) -> None:
        self._table = np.zeros((-(-height // SIDE), -(-width // SIDE)), np.int32)
        self._even: dict[int, int] = {}
        self._parts: list[NDArray[np.uint8]] = []
        self._count = 0

    def add(self, row: int, column: int, drawn: NDArray[np.uint8] | int) -> None:
        """Take the cells of a window, of as many as blocks have; or one value for all of them."""
        if isinstance(drawn, int):
            own = self._table[row // SIDE : row // SIDE + WINDOW, column // SIDE :][:, :WINDOW]
            own[:] = self._even_row(drawn)
            return
        height, width = (-(-size // SIDE) for size in drawn.shape)
        whole = np.pad(drawn, ((0, height * SIDE - drawn.shape[0]),
                               (0, width * SIDE - drawn.shape[1])), mode="edge")  # fmt: skip
        cut = whole.reshape(height, SIDE, width, SIDE).swapaxes(1, 2).reshape(-1, SIDE * SIDE)
        even = (cut == cut[:, :1]).all(axis=1)
        found = np.empty(len(cut), np.int32)
        for value in np.unique(cut[even, 0]).tolist():
            found[even & (cut[:, 0] == value)] = self._even_row(value)
        found[~even] = self._count + np.arange((~even).sum())
        self._push(cut[~even])
        first = (row // SIDE, column // SIDE)
        self._table[first[0] : first[0] + height, first[1] : first[1] + width] = found.reshape(
            height, width
        )

    def _even_row(self, value: int) -> int:
        if value not in self._even:
            self._even[value] = self._count
            self._push(np.full((1, SIDE * SIDE), value, np.uint8))
        return self._even[value]

    def _push(self, cut: NDArray[np.uint8]) -> None:
        self._parts.append(cut.reshape(-1, SIDE, SIDE))
        self._count += len(cut)

    def blocks(self) -> Blocks:
        """Return what was gathered."""
        return Blocks(self._table, np.concatenate(self._parts))
