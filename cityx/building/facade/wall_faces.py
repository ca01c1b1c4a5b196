"""Wall faces: how the drawn wall leaves the straight line that a facade is laid out on.

Facades take a nearly straight run of edges for one wall (`facade.walls`); the shell keeps
every point of the outline. What hangs on a wall follows the drawn face.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cityx.building.facade.walls import WallTable
from cityx.geometry.arrays import FloatArray, IntArray
from cityx.geometry.polygons import corners, rings_of
from cityx.geometry.ranges import numbered

SPAN = 1e5  # metres between two edges on the common axis; longer than any wall
MIN_PIECE = 0.05  # metres; a shorter piece of face is left to its neighbours


@dataclass(frozen=True)
class WallFaces:
    """Profiles of straight walls on one common axis.

    Attributes
    ----------
    at
        (m,) float64, sorted: ``SPAN * edge + metres from the start of the edge``.
    out
        (m,) float64, metres the drawn face lies before (positive) or behind the straight line.
    """

    at: FloatArray
    out: FloatArray

    def before(self, walls: WallTable, wall: IntArray, along: ArrayLike) -> FloatArray:
        """Return how far the face stands before the line, (k,), at places along walls."""
        if not len(self.at):
            return np.zeros(len(wall))
        return np.asarray(np.interp(self._place(walls, wall, along), self.at, self.out))

    def pieces(self, walls: WallTable, wall: IntArray) -> tuple[IntArray, FloatArray, FloatArray]:
        """Cut walls where their drawn face bends: row in `wall`, from and to, metres."""
        begin = self._place(walls, wall, 0.0)
        end = begin + walls.length[wall]
        first = np.searchsorted(self.at, begin + MIN_PIECE, side="right")
        last = np.maximum(np.searchsorted(self.at, end - MIN_PIECE, side="left"), first)
        count = last - first + 1
        row = np.repeat(np.arange(len(wall)), count)
        number = numbered(count)
        point = first[row] + number
        origin = begin[row]
        known = np.append(self.at, 0.0)
        start = np.where(number > 0, known[np.maximum(point - 1, 0)] - origin, 0.0)
        ending = number == count[row] - 1
        finish = np.where(ending, walls.length[wall[row]], known[point] - origin)
        return row, start, finish

    @staticmethod
    def _place(walls: WallTable, wall: IntArray, along: ArrayLike) -> FloatArray:
        return np.asarray(SPAN * walls.edge[wall] + walls.edge_from[wall] + np.asarray(along))


def wall_faces(polygons: NDArray[Any]) -> WallFaces:
    """Read the profiles of the walls of (n,) polygons, those `wall_table` was made of."""
    rings = rings_of(polygons)
    kept = np.flatnonzero(corners(rings))
    if not len(kept):
        return WallFaces(np.zeros(0), np.zeros(0))
    ring = rings.ring_of_point
    first = np.searchsorted(ring[kept], np.arange(len(rings.polygon)))
    last = np.append(first[1:], len(kept)) - 1
    edge = np.searchsorted(kept, np.arange(len(ring)), side="right") - 1
    edge = np.where(edge < first[ring], last[ring], edge)
    following = np.arange(1, len(kept) + 1)
    following[last] = first
    start = rings.points[kept]
    vector = start[following] - start
    length = np.maximum(np.hypot(*vector.T), 1e-9)
    unit = vector / length[:, None]
    offset = rings.points - start[edge]
    along = (offset * unit[edge]).sum(axis=1)
    out = offset[:, 0] * unit[edge, 1] - offset[:, 1] * unit[edge, 0]
    inner = np.ones(len(ring), bool)
    inner[kept] = False
    inner &= (along > 0) & (along < length[edge])
    number = np.arange(len(kept))
    at = np.concatenate([SPAN * number, SPAN * number + length, SPAN * edge[inner] + along[inner]])
    before = np.concatenate([np.zeros(2 * len(kept)), out[inner]])
    order = np.argsort(at, kind="stable")
    return WallFaces(at[order], before[order])
