"""Cells of a jittered lattice: a random division of the plane of which any part can be made alone.

Places are whole millimetres, so that they are the same from wherever one looks: the sums of whole
numbers are exact to lattice indices of 10^8 and beyond.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cityx.geometry.arrays import FloatArray, IntArray
from cityx.ids import hash_ids, uniform

Key = tuple[int, int]
Corner = tuple[Key, Key, Key]

PER_METRE = 1000  # places are whole millimetres
# Rings of cells that decide a cell: its neighbours, theirs by the circles through three sites, and
# one more for each round of joining corners.
RINGS = 5
ROUNDS = 2


@dataclass(frozen=True)
class Lattice:
    """A square lattice, turned, each of its points shaken.

    Attributes
    ----------
    seed
        Chooses the shaking.
    pitch
        Metres between the points before they are shaken.
    jitter
        Share of the pitch by which a point is shaken at most, in both directions.
    angle
        Radians the lattice is turned by.
    joined
        Metres; corners of cells nearer than that are joined, so that four cells meet in one place.
    """

    seed: int
    pitch: float
    jitter: float = 0.35
    angle: float = 0.0
    joined: float = 0.0

    def sites(self, keys: IntArray) -> IntArray:
        """Return the points of lattice indices, (n, 2) whole millimetres."""
        keys = np.asarray(keys, np.int64).reshape(-1, 2)
        ids = hash_ids(self.seed, "lattice", keys[:, 0].astype(np.uint64), keys[:, 1])
        shaken = np.stack([uniform(self.seed, "lattice/jitter", ids, k) for k in (0, 1)], axis=1)
        at = (keys + self.jitter * (2 * shaken - 1)) * self.pitch
        c, s = math.cos(self.angle), math.sin(self.angle)
        # Term by term: a matrix product may sum in another order on another machine.
        x, y = c * at[:, 0] - s * at[:, 1], s * at[:, 0] + c * at[:, 1]
        return _whole(np.stack([x, y], axis=1))

    def keys_near(self, box: tuple[float, float, float, float], reach: float) -> list[Key]:
        """Return the indices of all points within `reach` metres of a box, and of a few more."""
        xmin, ymin, xmax, ymax = box
        corner = np.array([(x, y) for x in (xmin, xmax) for y in (ymin, ymax)])
        c, s = math.cos(self.angle), math.sin(self.angle)
        u = (c * corner[:, 0] + s * corner[:, 1]) / self.pitch
        v = (c * corner[:, 1] - s * corner[:, 0]) / self.pitch
        more = reach / self.pitch + self.jitter
        i = range(math.ceil(u.min() - more), math.floor(u.max() + more) + 1)
        j = range(math.ceil(v.min() - more), math.floor(v.max() + more) + 1)
        return [(a, b) for a in i for b in j]

    def nearest(self, places: IntArray) -> IntArray:
        """Return the index of the site nearest to each place, (n, 2), ties to the lower index.

        Parameters
        ----------
        places
            (n, 2) whole millimetres.
        """
        at = np.asarray(places, np.int64).reshape(-1, 2)
        c, s = math.cos(self.angle), math.sin(self.angle)
        metres = at / PER_METRE
        u = (c * metres[:, 0] + s * metres[:, 1]) / self.pitch
        v = (c * metres[:, 1] - s * metres[:, 0]) / self.pitch
        base = np.rint(np.stack([u, v], axis=1)).astype(np.int64)
        around = np.array([(i, j) for i in (-2, -1, 0, 1, 2) for j in (-2, -1, 0, 1, 2)])
        keys = base[:, None] + around  # (n, 25, 2)
        away = (self.sites(keys) - np.repeat(at, len(around), axis=0)) / PER_METRE
        distance = (away**2).sum(axis=1).reshape(-1, len(around))
        return np.asarray(keys[np.arange(len(at)), distance.argmin(axis=1)])


@dataclass(frozen=True)
class Cell:
    """What lies nearer to one point of a lattice than to the others; k corners.

    Attributes
    ----------
    key
        Lattice index of its point.
    site
        (2,) the point, whole millimetres.
    corners
        (k,) names of the corners, counter-clockwise: the three cells that meet there, the first
        three by name where corners were joined.
    places
        (k, 2) of the corners, whole millimetres.
    beyond
        (k,) lattice index of the cell across the side from each corner to the next.
    """

    key: Key
    site: IntArray
    corners: tuple[Corner, ...]
    places: IntArray
    beyond: tuple[Key, ...]


def lattice_cell(lattice: Lattice, key: Key) -> Cell:
    """Make one cell of a lattice; see `lattice_cells`."""
    return lattice_cells(lattice, [key])[0]


def lattice_cells(lattice: Lattice, keys: Sequence[Key]) -> list[Cell]:
    """Make cells of a lattice, each the same whatever others are made with it.

    Parameters
    ----------
    keys
        Lattice indices near each other: all that lie between them are looked at.

    References
    ----------
    The Voronoi diagram of the points; corners nearer than ``lattice.joined`` are joined two by
    two, the shortest sides first, which only neighbours have a say in.
    """
    from scipy.spatial import Delaunay

    if not keys:
        return []
    wanted = np.array(keys, np.int64).reshape(-1, 2)
    low, high = wanted.min(axis=0) - RINGS, wanted.max(axis=0) + RINGS + 1
    i, j = (np.arange(a, b) for a, b in zip(low.tolist(), high.tolist(), strict=True))
    around = np.stack(np.meshgrid(i, j, indexing="ij"), -1).reshape(-1, 2)
    sites = lattice.sites(around)
    mesh = Delaunay((sites - sites[len(sites) // 2]) / PER_METRE)
    # Rows of `around` rise by lattice index, so sorted rows are the order of names.
    triple = np.sort(mesh.simplices, axis=1)
    raw = _circumcentres(sites, triple)
    first, second = _sides(mesh.neighbors)
    place = raw.copy()
    into = _joined(place, triple, first, second, lattice.joined)
    corners = _Corners(around, triple, raw, place, into)
    rows = (wanted - low) @ np.array([len(j), 1])
    order = np.argsort(triple.ravel(), kind="stable")
    begin = np.searchsorted(triple.ravel()[order], [rows, rows + 1])
    return [
        corners.cell(own, sites[own], order[a:b] // 3)
        for own, a, b in zip(rows.tolist(), *begin.tolist(), strict=True)
    ]


def _circumcentres(sites: IntArray, triple: IntArray) -> IntArray:
    """Return where three cells meet, (n, 2) whole millimetres, seen from the first of the three."""
    base = sites[triple[:, 0]]
    b, c = ((sites[triple[:, k]] - base) / PER_METRE for k in (1, 2))
    double = 2 * (b[:, 0] * c[:, 1] - b[:, 1] * c[:, 0])
    bb, cc = (b**2).sum(axis=1), (c**2).sum(axis=1)
    x = (c[:, 1] * bb - b[:, 1] * cc) / double
    y = (b[:, 0] * cc - c[:, 0] * bb) / double
    return np.asarray(base + _whole(np.stack([x, y], axis=1)))


def _sides(neighbours: NDArray[np.int32]) -> tuple[IntArray, IntArray]:
    """Return the pairs of corners at the ends of each side."""
    first, k = np.nonzero(neighbours >= 0)
    second = neighbours[first, k]
    once = first < second
    return first[once].astype(np.int64), second[once].astype(np.int64)


def _joined(
    place: IntArray, triple: IntArray, first: IntArray, second: IntArray, least: float
) -> IntArray:
    """Join corners with short sides in `place`; return the corner that each became."""
    into = np.arange(len(place))
    name = np.lexsort(triple.T[::-1]).argsort()  # rank of each corner by name
    for _ in range(ROUNDS if least > 0 else 0):
        a, b = into[first], into[second]
        length = np.hypot(*((place[a] - place[b]) / PER_METRE).T)
        short = np.flatnonzero((length < least) & (a != b))
        low, high = np.minimum(name[a], name[b]), np.maximum(name[a], name[b])
        order = short[np.lexsort((high[short], low[short], length[short]))]
        rank = np.full(len(place), len(order))  # of the shortest side at each corner
        np.minimum.at(rank, a[order], np.arange(len(order)))
        np.minimum.at(rank, b[order], np.arange(len(order)))
        turn = np.arange(len(order))
        chosen = order[(rank[a[order]] == turn) & (rank[b[order]] == turn)]
        kept = np.where(name[a[chosen]] < name[b[chosen]], a[chosen], b[chosen])
        gone = a[chosen] + b[chosen] - kept
        place[kept] += (place[gone] - place[kept]) // 2
        target = np.arange(len(place))
        target[gone] = kept
        into = target[into]
    return into


@dataclass(frozen=True)
class _Corners:
    """Where three cells meet, n places over k sites.

    Attributes
    ----------
    keys
        (k, 2) lattice indices.
    triple
        (n, 3) rows of keys, rising.
    raw, place
        (n, 2) before and after near ones were joined, whole millimetres.
    into
        (n,) the corner that each became.
    """

    keys: IntArray
    triple: IntArray
    raw: IntArray
    place: IntArray
    into: IntArray

    def cell(self, own: int, site: IntArray, mine: IntArray) -> Cell:
        """Return the cell of a row of keys, which has these corners."""
        away = self.raw[mine] - site
        mine = mine[np.argsort(np.arctan2(away[:, 1], away[:, 0]))]
        ring, beyond = [], []
        for here, there in zip(mine.tolist(), np.roll(mine, -1).tolist(), strict=True):
            if self.into[here] == self.into[there]:
                continue
            shared = set(self.triple[here].tolist()) & set(self.triple[there].tolist()) - {own}
            ring.append(int(self.into[here]))
            beyond.append(_key(self.keys[min(shared)]))
        names = self.keys[self.triple[ring]].tolist()  # (corner, 3, 2)
        corners = tuple((_key(a), _key(b), _key(c)) for a, b, c in names)
        return Cell(_key(self.keys[own]), site, corners, self.place[ring], tuple(beyond))


def _whole(metres: FloatArray) -> IntArray:
    return np.asarray(np.rint(metres * PER_METRE).astype(np.int64))


def _key(values: Sequence[int] | IntArray) -> Key:
    return int(values[0]), int(values[1])
