"""The choice among candidates by which no asset stands near itself."""

from __future__ import annotations

import numpy as np

from cityx.geometry.arrays import FloatArray, IntArray

ADJACENT = 8  # nearest neighbours that never are the same asset
MOST_SHARE = 0.004  # of all lots that one asset stands on, so that ten make no twentieth of a city
NEIGHBOURS = 24  # nearest lots looked at for repetitions
NONE = -1  # row of no asset and of no lot


def neighbours_of(centre: FloatArray, repeat: float) -> tuple[IntArray, IntArray]:
    """Find the neighbours of lots.

    Parameters
    ----------
    centre
        (n, 2) middles of lots, metres.
    repeat
        Metres within which another lot is a neighbour.

    Returns
    -------
    near, close
        (n, k) lots within ``repeat``, and (n, a) the nearest ones at any distance, -1 for none.
    """
    from scipy.spatial import cKDTree

    count = min(NEIGHBOURS + 1, len(centre))
    distance, near = cKDTree(centre).query(centre, k=count)
    distance, near = distance.reshape(len(centre), -1), near.reshape(len(centre), -1)
    own = near == np.arange(len(centre))[:, None]
    near = np.where(own, NONE, near).astype(np.int64)
    close = near[:, : ADJACENT + 1]
    return np.where(distance <= repeat, near, NONE), close


class Chooser:
    """Chooses a candidate for every lot so that no asset stands near itself.

    Every lot proposes its cheapest candidate; of two near lots with the same asset the one of
    lower rank keeps it, the other crosses it out and proposes the next. Candidates are only ever
    crossed out, so it ends, and as the rank follows from ids, order does not matter. A lot without
    candidates left gets those back that were crossed out for a repetition beyond the next houses.

    Parameters
    ----------
    rows, cost
        (n, k) assets by rising cost, -1 for none, and their costs, inf for those not to be used.
    rank
        (n,) precedence of lots, 0 first.
    near, close
        What `neighbours_of` found.

    Attributes
    ----------
    repeated
        (n,) bool, lots of which a repetition crossed out the last candidate at some time.
    """

    def __init__(
        self, rows: IntArray, cost: FloatArray, rank: IntArray, near: IntArray, close: IntArray
    ) -> None:
        self.rows, self.rank, self.near, self.close = rows, rank, near, close
        self.affordable = np.isfinite(cost)
        self.open = self.affordable.copy()
        self.refused = np.zeros_like(self.open)  # by the outlines, for good
        self.lenient = np.zeros(len(rows), bool)  # lots that may repeat beyond the next houses
        self.repeated = np.zeros(len(rows), bool)

    def choose(self) -> IntArray:
        """Return (n,) the asset of every lot, -1 for none."""
        while True:
            asset = self._proposed()
            clash = self._clashes(asset)
            if not len(clash):
                clash = self._beyond_share(asset)
            if not len(clash):
                return asset
            self._cross_out(clash, asset[clash])

    def refuse(self, lots: IntArray, assets: IntArray) -> None:
        """Cross an asset out for good, lot by lot."""
        same = self.rows[lots] == assets[:, None]
        self.refused[lots] |= same
        self.open[lots] &= ~same

    def _proposed(self) -> IntArray:
        first = self.open.argmax(axis=1)
        row = np.arange(len(self.rows))
        some = self.open[row, first]
        return np.where(some, self.rows[row, first], NONE)

    def _clashes(self, asset: IntArray) -> IntArray:
        """Lots whose asset stands at a neighbour of lower rank."""
        lower = np.zeros(len(asset), bool)
        for neighbours, lenient in ((self.near, ~self.lenient), (self.close, True)):
            other = np.where(neighbours >= 0, asset[neighbours], NONE - 1)
            same = (other == asset[:, None]) & (asset >= 0)[:, None]
            # Neighbourhood by count is one-sided: either side's view makes two lots near.
            mine = same & (self.rank[neighbours] < self.rank[:, None])
            hit = mine.any(axis=1) & lenient
            lower |= hit
            theirs = same & (self.rank[neighbours] > self.rank[:, None])
            lot, column = np.nonzero(theirs)
            them = neighbours[lot, column]
            if neighbours is self.near:
                them = them[~self.lenient[them]]
            lower[them] = True
        return np.flatnonzero(lower)

    def _beyond_share(self, asset: IntArray) -> IntArray:
        """Lots whose asset stands on so many of lower rank that it is seen too often."""
        most = max(3, int(MOST_SHARE * len(asset)))
        order = np.lexsort((self.rank, asset))
        held = asset[order]
        first = np.searchsorted(held, held)
        over = (np.arange(len(held)) - first >= most) & (held >= 0) & ~self.lenient[order]
        return np.sort(order[over])

    def _cross_out(self, lots: IntArray, assets: IntArray) -> None:
        same = self.rows[lots] == assets[:, None]
        self.open[lots] &= ~same
        empty = lots[~self.open[lots].any(axis=1)]
        again = empty[~self.lenient[empty]]
        self.lenient[again] = True
        self.open[again] = self.affordable[again] & ~self.refused[again]
        self.repeated[empty] = True
