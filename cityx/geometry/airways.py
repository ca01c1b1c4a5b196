"""Airways: flight paths through free air over a height field, from layer to layer."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cityx.geometry.arrays import FloatArray

CLIMB = 2.0  # times as costly as going level is a metre of height
_LOOKS = (64, 32, 16, 8, 4, 2)  # points of a way that a straight line may replace


@dataclass(frozen=True)
class Airspace:
    """Free air above what stands on a site, as a lattice.

    Attributes
    ----------
    low
        (3,) float64, metres, of the lattice's first point.
    cell, rise
        Metres between points, level and upwards.
    top, ceiling
        (rows, columns) float64, metres: the lowest free height over each cell, margin included,
        and the highest that may be flown at; row 0 is south.
    layers
        How many heights there are.
    """

    low: FloatArray
    cell: float
    rise: float
    top: FloatArray
    ceiling: FloatArray
    layers: int

    def wider(self) -> Airspace:
        """Return the air that is one cell farther from everything."""
        from scipy.ndimage import maximum_filter

        return replace(self, top=maximum_filter(self.top, size=3, mode="nearest"))

    def free(self, points: FloatArray) -> NDArray[np.bool_]:
        """Return which of (n, 3) points lie in free air over the site."""
        rows, columns = self.top.shape
        cell = np.floor((points[:, :2] - self.low[:2]) / self.cell + 0.5).astype(np.int64)
        on = (cell >= 0).all(axis=1) & (cell < (columns, rows)).all(axis=1)
        x, y = np.clip(cell, 0, (columns - 1, rows - 1)).T
        level = points[:, 2]
        return np.asarray(on & (level >= self.top[y, x]) & (level <= self.ceiling[y, x]))

    def straight(self, a: FloatArray, b: FloatArray) -> bool:
        """Return whether the straight line from one point to another is free."""
        count = int(np.ceil(np.linalg.norm(b - a) / (self.cell / 4))) + 1
        return bool(self.free(np.linspace(a, b, count)).all())


@dataclass(frozen=True)
class Airways:
    """The free points of an airspace and the ways between neighbours.

    Attributes
    ----------
    points
        (n, 3) float64, metres.
    matrix
        (n, n) sparse, what it costs to fly from one to the next.
    component
        (n,) int32, number of the piece of the air that each lies in.
    """

    air: Airspace
    points: FloatArray
    matrix: Any
    component: NDArray[np.int32]


def airways(air: Airspace) -> Airways:
    """Join the free points of an airspace with their neighbours on all sides."""
    from scipy.sparse import csr_array
    from scipy.sparse.csgraph import connected_components

    heights = air.low[2] + air.rise * np.arange(air.layers)
    level = heights[:, None, None]
    free = (level >= air.top) & (level <= air.ceiling)  # (layers, rows, columns)
    number = np.full(free.shape, -1, np.int64)
    number[free] = np.arange(int(free.sum()))
    layer, row, column = np.nonzero(free)
    points = air.low + np.column_stack([column * air.cell, row * air.cell, layer * air.rise])
    one, other, cost = [], [], []
    steps = [(k, j, i) for k in (0, 1) for j in (-1, 0, 1) for i in (-1, 0, 1)]
    for k, j, i in [step for step in steps if step > (0, 0, 0)]:
        to = np.column_stack([layer + k, row + j, column + i])
        on = ((to >= 0) & (to < free.shape)).all(axis=1)
        here = np.flatnonzero(on)
        there = number[tuple(to[here].T)]
        # In the cells between nothing may rise above the lower end, and the upper one be allowed.
        y, x = np.minimum(row, row + j)[here], np.minimum(column, column + i)[here]
        cells = [(y + v, x + u) for v in range(abs(j) + 1) for u in range(abs(i) + 1)]
        kept = there >= 0
        for cell in cells:
            kept &= (points[here, 2] >= air.top[cell]) & (points[there, 2] <= air.ceiling[cell])
        here, there = here[kept], there[kept]
        one.append(here)
        other.append(there)
        metres = np.hypot(np.hypot(i, j) * air.cell, CLIMB * k * air.rise)
        cost.append(np.full(len(here), metres))
    a, b, w = (np.concatenate(column) for column in (one, other, cost))
    matrix = csr_array((np.r_[w, w], (np.r_[a, b], np.r_[b, a])), shape=(len(points), len(points)))
    return Airways(air, points, matrix, connected_components(matrix, directed=False)[1])


def airway(ways: Airways, origin: int, goal: int) -> FloatArray | None:
    """Find the way of least cost between two free points, drawn straight where the air is free.

    Returns
    -------
    corners
        (k, 3) float64, metres; None where there is no way.
    """
    from scipy.sparse.csgraph import dijkstra

    if ways.component[origin] != ways.component[goal]:
        return None
    before = dijkstra(ways.matrix, indices=goal, return_predecessors=True)[1]
    chain = [origin]
    while chain[-1] != goal:
        chain.append(int(before[chain[-1]]))
    points = ways.points[chain]
    kept, here = [0], 0
    while here < len(points) - 1:
        ahead = min(here + 1, len(points) - 1)
        for look in _LOOKS:
            reach = min(here + look, len(points) - 1)
            if reach > ahead and ways.air.straight(points[here], points[reach]):
                ahead = reach
                break
        kept.append(ahead)
        here = ahead
    return np.asarray(points[kept])


def rounded(air: Airspace, corners: FloatArray, step: float, rounds: int) -> FloatArray:
    """Space the points of a way evenly and round its corners as far as the air is free.

    Parameters
    ----------
    air
        The airspace; ways that were found in its `wider` form have room for round corners.
    corners
        (k, 3) float64, metres, with free air between them.
    step
        Metres between the points.
    rounds
        Of averaging each point with its neighbours; fewer where that leads through something.
    """
    gone = np.r_[0.0, np.cumsum(np.linalg.norm(np.diff(corners, axis=0), axis=1))]
    place = np.linspace(0.0, gone[-1], int(np.ceil(gone[-1] / step)) + 1)
    sharp = np.column_stack([np.interp(place, gone, column) for column in corners.T])
    while rounds:
        points = sharp.copy()
        for _ in range(rounds):
            points[1:-1] = (points[:-2] + 2 * points[1:-1] + points[2:]) / 4
        if air.free(points).all():
            return points
        rounds //= 2
    return sharp
