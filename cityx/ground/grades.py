"""Heights along a graph of ways within the greatest grade of each way."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.sparse import coo_matrix, csr_matrix
from scipy.sparse.csgraph import dijkstra

from cityx.geometry.arrays import FloatArray, IntArray

LEAST_RISE = 1e-6  # metres; a sparse graph takes an edge of weight zero for none
STEEP_COST, LACK_COST = 1e3, 1e5  # of a metre climbed too much, and of clearance, in metres moved


@dataclass(frozen=True)
class Slopes:
    """How much the heights of neighbouring stations may differ, each pair once.

    Attributes
    ----------
    pairs
        (m, 2) int64, stations that follow each other on a way.
    rise
        (m,) float64, metres by which their heights may differ at most.
    """

    pairs: IntArray
    rise: FloatArray

    def take(self, rows: NDArray[np.bool_] | IntArray) -> Slopes:
        """Return some of the pairs."""
        return Slopes(self.pairs[rows], self.rise[rows])


def slopes_of(pairs: ArrayLike, rise: ArrayLike) -> Slopes:
    """Keep of pairs that are given more than once the least rise, and none of a station alone."""
    ends = np.sort(np.asarray(pairs, dtype=np.int64).reshape(-1, 2), axis=1)
    weight = np.asarray(rise, dtype=float)
    order = np.lexsort((weight, ends[:, 1], ends[:, 0]))
    ends, weight = ends[order], weight[order]
    first = np.r_[True, (ends[1:] != ends[:-1]).any(axis=1)][: len(ends)]
    first &= ends[:, 0] != ends[:, 1]
    return Slopes(ends[first], np.maximum(weight[first], LEAST_RISE))


def rise_to(slopes: Slopes, wanted: ArrayLike, floor: float = -np.inf) -> FloatArray:
    """Return the lowest heights that reach what is wanted and keep every grade.

    Parameters
    ----------
    slopes
        The stations and how steep it may be between them.
    wanted
        (n,) float, metres that a station must reach; minus infinity where nothing is wanted.
    floor
        Heights below it are not looked for, which saves time on a large graph.

    Returns
    -------
    height
        (n,) float, ``max over w of wanted[w] - climb(v, w)``, where the climb is the least sum of
        rises from v to w; minus infinity where that is below the floor or nothing is connected.
    """
    wanted = np.asarray(wanted, dtype=float)
    count = len(wanted)
    asked = np.flatnonzero(np.isfinite(wanted))
    if not len(asked):
        return np.full(count, -np.inf)
    a, b = slopes.pairs.T
    top = float(wanted[asked].max())
    # A station above all others, as far from each as that one is below it.
    rows = np.concatenate([a, np.full(len(asked), count)])
    columns = np.concatenate([b, asked])
    weights = np.concatenate([slopes.rise, top - wanted[asked] + 1.0])
    graph = coo_matrix((weights, (rows, columns)), shape=(count + 1, count + 1)).tocsr()
    limit = max(top - floor, 0.0) + 2.0
    drop = dijkstra(graph, directed=False, indices=count, limit=limit)[:count] - 1.0
    return np.asarray(np.maximum(top - drop, np.where(np.isfinite(wanted), wanted, -np.inf)))


def fall_to(slopes: Slopes, wanted: ArrayLike, ceiling: float = np.inf) -> FloatArray:
    """Return the highest heights that go down to what is wanted and keep every grade.

    As `rise_to`, upside down; plus infinity where nothing is wanted.
    """
    return -rise_to(slopes, -np.asarray(wanted, dtype=float), -ceiling)


def graded(slopes: Slopes, height: ArrayLike) -> FloatArray:
    """Return heights near the given ones that keep every grade, cut and fill in balance.

    They lie halfway between the lowest such heights that are nowhere below the given ones, and the
    highest that are nowhere above. That moves the worst places least, but all within their reach as
    well; so it is done twice, the second time for heights from which the worst are already cut, as
    far as no place moves more than at first. Stations whose height is NaN are carried along.
    """
    height = np.asarray(height, dtype=float)
    moved = np.abs(_between(slopes, height) - height)  # NaN where nothing is given
    known = np.isfinite(height)
    low = rise_to(slopes, np.where(known, height - moved, -np.inf))
    high = fall_to(slopes, np.where(known, height + moved, np.inf))
    return _between(slopes, np.where(known, np.clip(height, low, high), np.nan))


def _between(slopes: Slopes, height: FloatArray) -> FloatArray:
    """Return heights halfway between the lowest over and the highest under the given ones."""
    known = np.isfinite(height)
    over = rise_to(slopes, np.where(known, height, -np.inf))
    under = fall_to(slopes, np.where(known, height, np.inf))
    # Far from every known station only the grades count, and the two differ without end.
    middle = np.zeros(len(height))
    near = np.isfinite(over)
    middle[near] = (over[near] + under[near]) / 2
    return middle


def evened(slopes: Slopes, height: ArrayLike, free: ArrayLike, rounds: int) -> FloatArray:
    """Round crests and sags off: each free station moves halfway to the mean of its neighbours.

    No grade grows beyond the steepest of the pairs around it.
    """
    a, b = slopes.pairs.T
    z = np.asarray(height, dtype=float).copy()
    near = np.bincount(a, minlength=len(z)) + np.bincount(b, minlength=len(z))
    moved = np.asarray(free, bool) & (near > 0)
    for _ in range(rounds):
        total = np.bincount(a, z[b], minlength=len(z)) + np.bincount(b, z[a], minlength=len(z))
        z[moved] = (z[moved] + total[moved] / near[moved]) / 2
    return z


@dataclass(frozen=True)
class Gaps:
    """Pairs of stations of which one must lie above the other, g of them.

    Attributes
    ----------
    upper, lower
        (g,) int64, stations.
    need
        (g,) float64, metres.
    """

    upper: IntArray
    lower: IntArray
    need: FloatArray

    def and_those(self, other: Gaps) -> Gaps:
        """Return these pairs and those of others."""
        parts = zip((self.upper, self.lower, self.need),
                    (other.upper, other.lower, other.need), strict=True)  # fmt: skip
        return Gaps(*(np.concatenate(pair) for pair in parts))


def parted(
    slopes: Slopes, height: ArrayLike, gaps: Gaps, *, more: ArrayLike, weight: ArrayLike,
    floor: ArrayLike, free: ArrayLike,
) -> FloatArray:  # fmt: skip
    """Return the heights nearest to the given ones that keep gaps and grades.

    A linear program. Where both cannot be kept, what lacks is as little as can be: first of the
    gaps, then of the grades, then of the way that stations move.

    Parameters
    ----------
    slopes
        The stations and how steep it may be between them.
    height
        (n,) float, metres.
    gaps
        What must pass over what.
    more
        (m,) float, metres that a pair of stations may climb besides its rise where a gap asks it.
    weight
        (n,) float, what it costs to move a station by a metre.
    floor
        (n,) float, metres below which no station sinks.
    free
        (n,) bool, stations that may move.
    """
    height, floor = np.asarray(height, dtype=float), np.asarray(floor, dtype=float)
    moves = np.flatnonzero(np.asarray(free, bool))
    column = np.full(len(height), -1)
    column[moves] = np.arange(len(moves))
    steps = np.flatnonzero((column[slopes.pairs] >= 0).any(axis=1))
    rows = np.flatnonzero((column[gaps.upper] >= 0) | (column[gaps.lower] >= 0))
    a, b = slopes.pairs[steps].T
    upper, lower = gaps.upper[rows], gaps.lower[rows]
    # Each row says: height of one station less that of another, less what is let go, at most so.
    above, below = np.concatenate([b, a, lower]), np.concatenate([a, b, upper])
    limit = np.concatenate([slopes.rise[steps], slopes.rise[steps], -gaps.need[rows]])
    count, size = len(moves), len(steps) + len(rows)
    let = 2 * count + np.concatenate([np.arange(len(steps)), np.arange(size)])
    line = np.arange(len(limit))
    entries = [(line, let, -np.ones(len(line)))]
    for station, sign in ((above, 1.0), (below, -1.0)):
        own = np.flatnonzero(column[station] >= 0)
        at = column[station[own]]
        entries += [(line[own], at, np.full(len(own), sign)),
                    (line[own], count + at, np.full(len(own), -sign))]  # fmt: skip
    row, at, value = (np.concatenate(part) for part in zip(*entries, strict=True))
    matrix = csr_matrix((value, (row, at)), shape=(len(line), 2 * count + size))
    cost = np.asarray(weight, float)[moves]
    sinks = np.maximum(height - floor, 0.0)[moves]
    most = np.concatenate([np.full(count, np.inf), sinks, np.asarray(more, float)[steps],
                           np.full(len(rows), np.inf)])  # fmt: skip
    from scipy.optimize import linprog  # slow to import, and few maps need it

    found = linprog(
        np.concatenate([cost, cost, np.full(len(steps), STEEP_COST),
                        np.full(len(rows), LACK_COST)]),
        A_ub=matrix, b_ub=limit - height[above] + height[below],
        bounds=np.column_stack([np.zeros(len(most)), most]), method="highs-ds",
    )  # fmt: skip
    moved = height.copy()
    if found.x is not None:
        moved[moves] += found.x[:count] - found.x[count : 2 * count]
    return moved
