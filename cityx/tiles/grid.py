"""The grid of tiles: squares of one size that lie on multiples of it in the frame of a run."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cityx.errors import UsageError
from cityx.geometry.arrays import FloatArray

Box = tuple[float, float, float, float]

UNIT = 500.0  # metres; the ground is cut at its multiples, so no face of it crosses a border
PER_METRE = 1e3  # places are told apart in millimetres, whatever the last bits of them
_NAME = re.compile(r"(-?\d{1,9})_(-?\d{1,9})")


@dataclass(frozen=True, order=True)
class Tile:
    """A square of the grid: column from the west, row from the south."""

    column: int
    row: int

    @property
    def name(self) -> str:
        """What its files are called."""
        return f"{self.column}_{self.row}"

    @property
    def around(self) -> list[Tile]:
        """The eight tiles beside it."""
        steps = [(i, j) for j in (-1, 0, 1) for i in (-1, 0, 1) if i or j]
        return [Tile(self.column + i, self.row + j) for i, j in steps]

    def box(self, size: float, margin: float = 0.0) -> Box:
        """Return (xmin, ymin, xmax, ymax) metres, with a margin round it."""
        x, y = self.column * size, self.row * size
        return x - margin, y - margin, x + size + margin, y + size + margin


def tile_named(name: str) -> Tile:
    """Return the tile of a name, COLUMN_ROW.

    Raises
    ------
    UsageError
        If the text is no such name.
    """
    found = _NAME.fullmatch(name)
    if found is None:
        raise UsageError(f'"{name}" is no tile; tiles are called COLUMN_ROW, such as -3_12.')
    return Tile(int(found[1]), int(found[2]))


def tile_at(x: float, y: float, size: float) -> Tile:
    """Return the tile that holds a place of the frame, metres."""
    column, row = np.floor(np.round(np.array([x, y]), 3) / size).astype(int).tolist()
    return Tile(column, row)


def tiles_of(box: Box, size: float) -> Iterator[Tile]:
    """Yield the tiles that a rectangle reaches into, by rows from the south."""
    first = np.floor(np.array(box[:2]) / size).astype(int).tolist()
    last = np.ceil(np.array(box[2:]) / size).astype(int).tolist()
    for row in range(first[1], last[1]):
        for column in range(first[0], last[0]):
            yield Tile(column, row)


def in_order(tiles: Iterable[Tile]) -> list[Tile]:
    """Return tiles along the curve of Morton, on which neighbours lie close."""
    return sorted(tiles, key=lambda tile: (_woven(tile), tile))


def _woven(tile: Tile) -> int:
    x, y = (value + (1 << 30) for value in (tile.column, tile.row))
    return sum(((x >> bit & 1) << 2 * bit) | ((y >> bit & 1) << 2 * bit + 1) for bit in range(31))


def holds(box: Box, xy: FloatArray) -> NDArray[np.bool_]:
    """(n,) whether places lie in a tile: its western and southern border belong to it."""
    steps = np.rint(np.asarray(xy, float).reshape(-1, 2) * PER_METRE)
    low, high = (np.rint(np.array(part) * PER_METRE) for part in (box[:2], box[2:]))
    return np.asarray(((steps >= low) & (steps < high)).all(axis=1))
