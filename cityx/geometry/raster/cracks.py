"""Cracks: the unit edges between pixels of different labels, joined to arcs and rings.

Points are (column, row) as in `cityx.geometry.raster.grid`; a corner of the lattice is numbered
``row * (columns + 1) + column``. Left and right are meant on the ground, y up.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cityx.geometry.arrays import FloatArray, IntArray
from cityx.geometry.chains import join_segments

OUTSIDE = -1  # label beyond the border of a raster


@dataclass(frozen=True)
class Cracks:
    """m directed unit edges; the higher label lies on the left.

    Attributes
    ----------
    start, end
        (m,) corners.
    left, right
        (m,) labels, left > right.
    row
        (m,) row of the pixel on the left.
    columns
        Of the raster.
    """

    start: IntArray
    end: IntArray
    left: IntArray
    right: IntArray
    row: IntArray
    columns: int

    def points(self, corners: IntArray) -> FloatArray:
        """Return (n, 2) points of (n,) corners."""
        row, column = np.divmod(corners, self.columns + 1)
        return np.column_stack([column, row]).astype(float)

    def middles(self) -> FloatArray:
        """Return the (m, 2) middles of the edges."""
        return (self.points(self.start) + self.points(self.end)) / 2

    def take(self, rows: Any) -> Cracks:
        """Return some of the edges."""
        return Cracks(
            self.start[rows], self.end[rows], self.left[rows], self.right[rows], self.row[rows],
            self.columns,
        )  # fmt: skip


@dataclass(frozen=True)
class Chains:
    """k chains of cracks, one after the other.

    Attributes
    ----------
    crack
        (m,) cracks in order.
    begin
        (k + 1,) offsets of chains into ``crack``.
    closed
        (k,) bool.
    """

    crack: IntArray
    begin: IntArray
    closed: NDArray[np.bool_]


def find_cracks(labels: NDArray[Any]) -> Cracks:
    """Find the edges between pixels of different labels, the border of the raster included.

    Parameters
    ----------
    labels
        (rows, columns) int, 0 or more.
    """
    rows, columns = labels.shape
    wide = columns + 1
    padded = np.full((rows + 2, columns + 2), OUTSIDE, np.int64)
    padded[1:-1, 1:-1] = labels
    # Edges that run north and south, between the pixels west and east of them.
    west, east = padded[1:-1, :-1], padded[1:-1, 1:]
    row, column = np.nonzero(west != east)
    west, east = west[row, column], east[row, column]
    north, south = row * wide + column, (row + 1) * wide + column
    upward = west > east
    standing = (
        np.where(upward, south, north), np.where(upward, north, south),
        np.maximum(west, east), np.minimum(west, east), row,
    )  # fmt: skip
    # Edges that run east and west, between the pixels north and south of them.
    above, below = padded[:-1, 1:-1], padded[1:, 1:-1]
    row, column = np.nonzero(above != below)
    above, below = above[row, column], below[row, column]
    first, second = row * wide + column, row * wide + column + 1
    eastward = above > below
    lying = (
        np.where(eastward, first, second), np.where(eastward, second, first),
        np.maximum(above, below), np.minimum(above, below), row - eastward,
    )  # fmt: skip
    both = [np.concatenate(pair) for pair in zip(standing, lying, strict=True)]
    return Cracks(both[0], both[1], both[2], both[3], both[4], columns)


def arcs(cracks: Cracks) -> Chains:
    """Join cracks to arcs that end where three labels or two diagonal ones meet."""
    pair = cracks.left * (int(cracks.left.max(initial=0)) + 2) + cracks.right
    return _chains(np.column_stack([cracks.start, cracks.end]), pair)


def rings(labels: NDArray[Any]) -> tuple[Cracks, Chains]:
    """Find the closed rings around the labels of a raster; the label lies on the left.

    Pixels of a label that meet at a corner alone are kept apart there, so rings do not cross.

    Parameters
    ----------
    labels
        (rows, columns) int, 0 for none; pixels of different labels may meet at corners only.
    """
    cracks = find_cracks(labels)
    cracks = cracks.take(cracks.left > 0)
    segments = np.column_stack([cracks.start, cracks.end])
    # Where diagonal pixels meet, the corner is two nodes: of the pixel above and of that below.
    crossing = np.flatnonzero(np.bincount(cracks.end) > 1)
    above = cracks.row[:, None] < segments // (cracks.columns + 1)
    nodes = 2 * segments + (np.isin(segments, crossing) & above)
    return cracks, _chains(nodes, cracks.left)


def _chains(segments: IntArray, section: IntArray) -> Chains:
    head, rank = join_segments(segments, section)
    order = np.lexsort((rank, head))
    first = np.flatnonzero(rank[order] == 0)
    begin = np.append(first, len(order))
    last = order[begin[1:] - 1]
    closed = segments[order[first], 0] == segments[last, 1]
    return Chains(order, begin, closed)
