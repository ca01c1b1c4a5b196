"""The terrain: a height field over the site."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

PER_METRE = 1e3  # places of a profile are told apart in millimetres


@dataclass(frozen=True)
class Profile:
    """Heights that streets have on the ground, known for a wider land than the terrain shows.

    Attributes
    ----------
    place
        (p, 2) int64, millimetres of the frame, by x and y, each once.
    z
        (p,) float64, metres above the site's reference height.
    """

    place: NDArray[np.int64]
    z: NDArray[np.float64]

    @classmethod
    def of(cls, points: ArrayLike, z: ArrayLike) -> Profile:
        """Return the profile of (n, 2) places and (n,) heights, metres; the lowest of a place."""
        steps = np.rint(np.asarray(points, float).reshape(-1, 2) * PER_METRE).astype(np.int64)
        heights = np.asarray(z, float)
        order = np.lexsort((heights, steps[:, 1], steps[:, 0]))
        steps, heights = steps[order], heights[order]
        first = np.r_[True, (steps[1:] != steps[:-1]).any(axis=1)][: len(steps)]
        return cls(steps[first], heights[first])

    def at(self, points: ArrayLike) -> NDArray[np.float64]:
        """Return (n,) heights at (n, 2) places, metres; NaN where none is known."""
        if not len(self.place):
            return np.full(len(np.asarray(points).reshape(-1, 2)), np.nan)
        steps = np.rint(np.asarray(points, float).reshape(-1, 2) * PER_METRE).astype(np.int64)
        both = np.concatenate([self.place, steps])
        _, first, number = np.unique(both, axis=0, return_index=True, return_inverse=True)
        row = first[number.reshape(-1)[len(self.place) :]]
        known = row < len(self.place)
        return np.where(known, self.z[np.where(known, row, 0)], np.nan)

    def within(self, box: tuple[float, float, float, float]) -> Profile:
        """Return what lies in a rectangle, metres."""
        low, high = (np.rint(np.array(part) * PER_METRE) for part in (box[:2], box[2:]))
        inside = ((self.place >= low) & (self.place <= high)).all(axis=1)
        return Profile(self.place[inside], self.z[inside])


@dataclass(frozen=True)
class Terrain:
    """Heights on a regular grid, bilinear between nodes, constant beyond the border.

    Attributes
    ----------
    origin
        (x, y) of node [0, 0], the south-west corner, metres.
    cell
        Distance between nodes, metres.
    heights
        (rows, columns) float64, metres; row 0 is south. Zero is the site's reference height.
    datum
        Metres above sea level of height zero (0 when unknown).
    streets
        Heights that streets are to have on it, None where they follow from it.
    """

    origin: tuple[float, float]
    cell: float
    heights: NDArray[np.float64]
    datum: float = 0.0
    streets: Profile | None = None

    @property
    def is_flat(self) -> bool:
        """Whether every height is the same."""
        return bool(np.ptp(self.heights) == 0.0)

    def height_at(self, points: ArrayLike) -> NDArray[np.float64]:
        """Return (n,) heights at (n, 2) points."""
        points = np.asarray(points, dtype=float).reshape(-1, 2)
        rows, columns = self.heights.shape
        if rows * columns == 1:
            return np.full(len(points), self.heights[0, 0])
        u = np.clip((points[:, 0] - self.origin[0]) / self.cell, 0, columns - 1)
        v = np.clip((points[:, 1] - self.origin[1]) / self.cell, 0, rows - 1)
        j = np.minimum(u.astype(int), max(columns - 2, 0))
        i = np.minimum(v.astype(int), max(rows - 2, 0))
        du, dv = u - j, v - i
        i1, j1 = np.minimum(i + 1, rows - 1), np.minimum(j + 1, columns - 1)
        south = self.heights[i, j] * (1 - du) + self.heights[i, j1] * du
        north = self.heights[i1, j] * (1 - du) + self.heights[i1, j1] * du
        return np.asarray(south * (1 - dv) + north * dv)


@dataclass(frozen=True)
class Survey:
    """What a height file says of a site and of the land round it, before streets cut and fill it.

    Attributes
    ----------
    points
        (k, 3) float64, cells of the file on the site, or some of them evenly spread.
    around
        The site and the land round it; its zero is that of the site's terrain.
    bound
        Metres by which the terrain of the site, as it was read, misses the file at most.
    tolerance, far_tolerance
        Metres by which the ground misses the terrain, and the land beyond the site its heights, at
        the corners of their cells; 0 until they are meshed.
    """

    points: NDArray[np.float64]
    around: Terrain
    bound: float
    tolerance: float = 0.0
    far_tolerance: float = 0.0


def flat_terrain() -> Terrain:
    """Return the terrain of a site without height data."""
    return Terrain((0.0, 0.0), 1.0, np.zeros((1, 1)))
