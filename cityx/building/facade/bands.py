"""Bands: upright walls with rectangular holes cut into quads, for all walls at once.

The holes of a wall are gathered into level bands. A band is cut into columns at the sides of its
holes; what lies between bands, below the lowest and above the highest is joined point to point; the
ends of the wall are fans. Corners of the wall stay its only points on its edge.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cityx.geometry.arrays import FloatArray, IntArray

NONE = -1  # fourth corner of a triangle
SAME = 1e-3  # metres; edges of holes that differ by less are level
APART = 0.01  # metres of wall between two bands, at least
FAR = 1e5  # metres between walls laid side by side; more than any wall is long or high


@dataclass(frozen=True)
class Chains:
    """Feet or heads of w walls, from left to right.

    Attributes
    ----------
    start
        (w + 1,) offsets.
    vertex
        (m,) numbers of the vertices.
    at
        (m, 2) metres along the wall and height.
    """

    start: IntArray
    vertex: IntArray
    at: FloatArray

    @property
    def owner(self) -> IntArray:
        """(m,) wall of each point."""
        return np.repeat(np.arange(len(self.start) - 1), np.diff(self.start))


@dataclass(frozen=True)
class Holes:
    """Rectangular holes, h of them.

    Attributes
    ----------
    wall
        (h,) int64.
    low, high
        (h, 2) lower left and upper right corner, metres along the wall and height.
    corner
        (h, 4) numbers of the vertices: lower left, lower right, upper right, upper left.
    """

    wall: IntArray
    low: FloatArray
    high: FloatArray
    corner: IntArray

    def take(self, rows: IntArray) -> Holes:
        """Return the given holes."""
        return Holes(self.wall[rows], self.low[rows], self.high[rows], self.corner[rows])


@dataclass(frozen=True)
class Banded:
    """Walls cut into faces.

    Attributes
    ----------
    cut
        (w,) bool; walls of another build than bands can cut are left alone.
    faces, wall
        (f, 4) counter-clockwise, triangles with -1; and (f,) the wall of each.
    point, point_wall
        (s, 2) and (s,) new points within walls, numbered from `first` on.
    """

    cut: NDArray[np.bool_]
    faces: IntArray
    wall: IntArray
    point: FloatArray
    point_wall: IntArray


def cut_bands(feet: Chains, heads: Chains, holes: Holes, first: int) -> Banded:
    """Cut walls with holes into quads and triangles.

    Parameters
    ----------
    feet, heads
        Lower and upper edges of w walls. They meet upright sides: the first points lie above one
        another and so do the last.
    holes
        Holes well within the walls and apart from one another.
    first
        Number of the first new vertex.
    """
    walls = len(feet.start) - 1
    if not len(holes.wall):
        return _nothing(np.zeros(walls, bool))
    order = np.lexsort((holes.low[:, 0], holes.low[:, 1], holes.wall))
    holes = holes.take(order)
    band = _bands_of(holes)
    cut = _convex(heads, -1.0) & _convex(feet, 1.0) & _clear(feet, heads, holes, walls)
    holes, band, crowded = _across(holes, band)
    cut[crowded] = False
    cut &= np.bincount(holes.wall, minlength=walls) > 0
    rows = np.flatnonzero(cut[holes.wall])
    holes = holes.take(rows)
    _, band = np.unique(band[rows], return_inverse=True)
    if not len(rows):
        return _nothing(cut)
    maker = _Maker(holes, band, first)
    columns = maker.columns()
    gaps = maker.gaps(feet, heads, cut)
    ends = maker.fans(feet, heads)
    return Banded(
        cut,
        np.concatenate([columns[0], gaps[0], ends[0]]),
        np.concatenate([columns[1], gaps[1], ends[1]]),
        maker.point,
        maker.point_wall,
    )


def _nothing(cut: NDArray[np.bool_]) -> Banded:
    none = np.zeros(0, np.int64)
    return Banded(cut, np.zeros((0, 4), np.int64), none, np.zeros((0, 2)), none)


def _bands_of(holes: Holes) -> IntArray:
    """Band of each hole; holes are sorted by wall and lower edge."""
    shift = holes.wall * FAR
    reached = np.maximum.accumulate(holes.high[:, 1] + shift)
    fresh = np.ones(len(shift), bool)
    fresh[1:] = holes.low[1:, 1] + shift[1:] > reached[:-1] + APART
    return np.asarray(np.cumsum(fresh) - 1, np.int64)


def _across(holes: Holes, band: IntArray) -> tuple[Holes, IntArray, IntArray]:
    """Sort holes from left to right within bands; walls where they stand above one another."""
    order = np.lexsort((holes.low[:, 0], band))
    holes, band = holes.take(order), band[order]
    close = (band[1:] == band[:-1]) & (holes.low[1:, 0] < holes.high[:-1, 0] + SAME)
    return holes, band, holes.wall[1:][close]


def _convex(chain: Chains, sign: float) -> NDArray[np.bool_]:
    """Whether the chains of walls bend to one side only, (w,); 1 for up."""
    owner = chain.owner
    found = np.ones(len(chain.start) - 1, bool)
    inner = np.flatnonzero(owner[2:] == owner[:-2])
    a, b, c = chain.at[inner], chain.at[inner + 1], chain.at[inner + 2]
    turn = (b[:, 0] - a[:, 0]) * (c[:, 1] - a[:, 1]) - (b[:, 1] - a[:, 1]) * (c[:, 0] - a[:, 0])
    found[owner[inner[sign * turn < -1e-6]]] = False
    return found


def _clear(feet: Chains, heads: Chains, holes: Holes, walls: int) -> NDArray[np.bool_]:
    """Whether all bands of a wall, drawn out to its outermost holes, lie between foot and head."""
    low, high = np.full((walls, 2), np.inf), np.full((walls, 2), -np.inf)
    np.minimum.at(low, holes.wall, holes.low)
    np.maximum.at(high, holes.wall, holes.high)
    top, bottom = np.full(walls, np.inf), np.full(walls, -np.inf)
    # Bent to one side, head and foot are nearest at the ends of the bands.
    for x in (low[:, 0], high[:, 0]):
        known = np.isfinite(x)
        at = np.where(known, x, 0.0)
        top = np.minimum(top, _height(heads, at))
        bottom = np.maximum(bottom, _height(feet, at))
    return np.asarray((top > high[:, 1] + SAME) & (bottom < low[:, 1] - SAME))


def _height(chain: Chains, x: FloatArray) -> FloatArray:
    """Height of each wall's chain at a place along it, (w,)."""
    axis = chain.at[:, 0] + FAR * chain.owner
    return np.asarray(np.interp(x + FAR * np.arange(len(x)), axis, chain.at[:, 1]))


class _Maker:
    """Faces of banded walls; a class because all pieces draw on the same new points."""

    def __init__(self, holes: Holes, band: IntArray, first: int) -> None:
        self.holes, self.band = holes, band
        count = int(band[-1]) + 1
        start = np.flatnonzero(np.diff(band, prepend=-1))
        self.start = np.append(start, len(band))
        self.band_wall = holes.wall[start]
        self.low = np.minimum.reduceat(holes.low[:, 1], start)
        self.high = np.maximum.reduceat(holes.high[:, 1], start)
        walls = int(holes.wall.max()) + 1
        self.left, self.right = np.full(walls, np.inf), np.full(walls, -np.inf)
        np.minimum.at(self.left, holes.wall, holes.low[:, 0])
        np.maximum.at(self.right, holes.wall, holes.high[:, 0])
        points: list[FloatArray] = []
        owners: list[IntArray] = []
        size = 0

        def number(given: IntArray, wanted: NDArray[np.bool_], x: FloatArray, z: FloatArray,
                   wall: IntArray) -> IntArray:  # fmt: skip
            nonlocal size
            made = given.copy()
            made[wanted] = first + size + np.arange(np.count_nonzero(wanted))
            size += int(np.count_nonzero(wanted))
            points.append(np.column_stack([x[wanted], z[wanted]]))
            owners.append(wall[wanted])
            return made

        # Four points on each side of a hole: foot of the band, the hole's corners, head.
        foot, head = self.low[band], self.high[band]
        under = holes.low[:, 1] > foot + SAME
        over = holes.high[:, 1] < head - SAME
        c, wall = holes.corner, holes.wall
        x0, x1 = holes.low[:, 0], holes.high[:, 0]
        self.sides = np.stack(
            [
                np.stack([number(c[:, 0], under, x0, foot, wall), c[:, 0], c[:, 3],
                          number(c[:, 3], over, x0, head, wall)], 1),
                np.stack([number(c[:, 1], under, x1, foot, wall), c[:, 1], c[:, 2],
                          number(c[:, 2], over, x1, head, wall)], 1),
            ],
            axis=1,
        )  # (h, 2, 4)  # fmt: skip
        # Ends of bands that do not begin or end with the outermost hole.
        head_hole, last_hole = start, self.start[1:] - 1
        bw = self.band_wall
        short = x0[head_hole] > self.left[bw] + SAME
        self.short_left = short
        edge = self.left[bw]
        self.ends = np.empty((count, 2, 2), np.int64)  # left or right, foot or head
        self.ends[:, 0, 0] = number(self.sides[head_hole, 0, 0], short, edge, self.low, bw)
        self.ends[:, 0, 1] = number(self.sides[head_hole, 0, 3], short, edge, self.high, bw)
        short = x1[last_hole] < self.right[bw] - SAME
        self.short_right = short
        edge = self.right[bw]
        self.ends[:, 1, 0] = number(self.sides[last_hole, 1, 0], short, edge, self.low, bw)
        self.ends[:, 1, 1] = number(self.sides[last_hole, 1, 3], short, edge, self.high, bw)
        self.point = np.concatenate(points)
        self.point_wall = np.concatenate(owners)

    def columns(self) -> tuple[IntArray, IntArray]:
        """Faces within bands: below and above holes, and the piers between them."""
        holes, band, sides = self.holes, self.band, self.sides
        faces, wall = [], []
        for k in (0, 2):  # below, above
            quad = np.stack(
                [sides[:, 0, k], sides[:, 1, k], sides[:, 1, k + 1], sides[:, 0, k + 1]], 1
            )
            real = quad[:, 0] != quad[:, 3]
            real |= quad[:, 1] != quad[:, 2]
            faces.append(quad[real])
            wall.append(holes.wall[real])
        next_in = np.flatnonzero(band[1:] == band[:-1])
        pairs = [(sides[next_in, 1], sides[next_in + 1, 0], holes.wall[next_in])]
        twice = np.array([0, 0, 1, 1])
        first, last = self.start[:-1], self.start[1:] - 1
        rows = np.flatnonzero(self.short_left)
        pairs.append((self.ends[rows, 0][:, twice], sides[first[rows], 0], self.band_wall[rows]))
        rows = np.flatnonzero(self.short_right)
        pairs.append((sides[last[rows], 1], self.ends[rows, 1][:, twice], self.band_wall[rows]))
        left = np.concatenate([pair[0] for pair in pairs])
        right = np.concatenate([pair[1] for pair in pairs])
        owner = np.concatenate([pair[2] for pair in pairs])
        for k in range(3):
            quad = np.stack([left[:, k], right[:, k], right[:, k + 1], left[:, k + 1]], 1)
            faces.append(quad)
            wall.append(owner)
        return _without_folds(np.concatenate(faces), np.concatenate(wall))

    def gaps(
        self, feet: Chains, heads: Chains, cut: NDArray[np.bool_]
    ) -> tuple[IntArray, IntArray]:
        """Faces between bands, and between them and the foot and the head of the wall."""
        chains = [self._edge(0), self._edge(1)]  # points along lower and upper edges of bands
        first = np.diff(self.band_wall, prepend=-1) != 0
        last = np.append(first[1:], True)
        count = len(self.low)
        # Gaps are numbered by the band above them; the gap under the head comes after.
        foot = feet.owner
        below = np.full(len(cut), -1, np.int64)
        below[self.band_wall[first]] = np.flatnonzero(first)
        above = np.full(len(cut), -1, np.int64)
        above[self.band_wall[last]] = count + np.arange(np.count_nonzero(last))
        own = cut[foot]
        lower_gap = [below[foot[own]]]
        lower_id, lower_x = [feet.vertex[own]], [feet.at[own, 0]]
        band, vertex, x = chains[1]
        to = np.where(last, -1, np.arange(count) + 1)
        to[last] = above[self.band_wall[last]]
        lower_gap.append(to[band])
        lower_id.append(vertex)
        lower_x.append(x)
        band, vertex, x = chains[0]
        head = heads.owner
        own = cut[head]
        upper_gap = [band, above[head[own]]]
        upper_id, upper_x = [vertex, heads.vertex[own]], [x, heads.at[own, 0]]
        gap_wall = np.concatenate([self.band_wall, self.band_wall[last]])
        faces, gap = _between(
            (np.concatenate(lower_gap), np.concatenate(lower_id), np.concatenate(lower_x)),
            (np.concatenate(upper_gap), np.concatenate(upper_id), np.concatenate(upper_x)),
        )
        return faces, gap_wall[gap]

    def _edge(self, which: int) -> tuple[IntArray, IntArray, FloatArray]:
        """Points along the lower (0) or upper (1) edges of bands: band, vertex, place."""
        slot = 3 * which
        number = np.arange(len(self.low))
        band = [self.band, self.band, number[self.short_left], number[self.short_right]]
        vertex = [self.sides[:, 0, slot], self.sides[:, 1, slot],
                  self.ends[self.short_left, 0, which], self.ends[self.short_right, 1,
                      which]]  # fmt: skip
        x = [self.holes.low[:, 0], self.holes.high[:, 0],
            self.left[self.band_wall[self.short_left]],
             self.right[self.band_wall[self.short_right]]]  # fmt: skip
        return np.concatenate(band), np.concatenate(vertex), np.concatenate(x)

    def fans(self, feet: Chains, heads: Chains) -> tuple[IntArray, IntArray]:
        """Fans from the four corners of walls to the ends of their bands."""
        faces, wall = [], []
        twice = np.array([0, 0, 1, 1])
        outer = (self.start[:-1], self.start[1:] - 1)  # outermost hole of every band
        short = (self.short_left, self.short_right)
        for side, pick in ((0, 0), (1, -1)):
            foot = feet.vertex[feet.start[:-1] if pick == 0 else feet.start[1:] - 1]
            head = heads.vertex[heads.start[:-1] if pick == 0 else heads.start[1:] - 1]
            # What the fan meets: the end of a band, or the side of its outermost hole, upward.
            points = np.where(
                short[side][:, None], self.ends[:, side][:, twice], self.sides[outer[side], side]
            )
            own = np.ones(points.shape, bool)
            own[:, 1:] = points[:, 1:] != points[:, :-1]
            points = points[own]
            wall_of = np.repeat(self.band_wall, own.sum(axis=1))
            begin = np.searchsorted(wall_of, wall_of)
            total = np.searchsorted(wall_of, wall_of, side="right") - begin
            place = np.arange(len(points)) - begin
            lower = np.flatnonzero(place < total - 1)
            # Below the middle points fan out from the foot, above it from the head.
            near = place[lower] < total[lower] // 2
            hub = np.where(near, foot[wall_of[lower]], head[wall_of[lower]])
            triangle = np.stack([hub, points[lower], points[lower + 1]], 1)
            at = np.flatnonzero(place == total // 2)
            closing = np.stack([foot[wall_of[at]], points[at], head[wall_of[at]]], 1)
            every = np.concatenate([triangle, closing])
            faces.append(every[:, ::-1] if side else every)
            wall.append(np.concatenate([wall_of[lower], wall_of[at]]))
        flat = np.concatenate(faces)
        quads = np.column_stack([flat, np.full(len(flat), NONE)])
        return quads, np.concatenate(wall)


def _without_folds(quads: IntArray, wall: IntArray) -> tuple[IntArray, IntArray]:
    """Drop quads whose sides have both shrunk to points; those with one become triangles."""
    left = quads[:, 0] == quads[:, 3]
    right = quads[:, 1] == quads[:, 2]
    found = quads.copy()
    found[left, 3] = NONE
    found[right] = np.column_stack(
        [quads[right, 0], quads[right, 1], quads[right, 3], np.full(np.count_nonzero(right), NONE)]
    )
    keep = ~(left & right)
    return found[keep], wall[keep]


Points = tuple[IntArray, IntArray, FloatArray]


def _between(lower: Points, upper: Points) -> tuple[IntArray, IntArray]:
    """Join two rows of points per gap by triangles, from left to right.

    Parameters
    ----------
    lower, upper
        Gap, vertex and place along the wall of every point.

    Returns
    -------
    faces, gap
        (t, 4) and (t,).
    """
    gap = np.concatenate([lower[0], upper[0]])
    vertex = np.concatenate([lower[1], upper[1]])
    x = np.concatenate([lower[2], upper[2]])
    high = np.repeat([0, 1], [len(lower[0]), len(upper[0])])
    order = np.lexsort((high, x, gap))
    gap, vertex, high = gap[order], vertex[order], high[order]
    number = np.arange(len(gap))
    # The last point before each one on the other row and on its own, within the gap.
    seen_low = np.maximum.accumulate(np.where(high == 0, number, -1))
    seen_high = np.maximum.accumulate(np.where(high == 1, number, -1))
    before_low = np.concatenate([[-1], seen_low[:-1]])
    before_high = np.concatenate([[-1], seen_high[:-1]])
    start = np.searchsorted(gap, gap)
    first_low = np.full(len(gap), -1)
    first_high = np.full(len(gap), -1)
    # Points before the other row has begun are joined to its first point.
    for rank, first in ((0, first_low), (1, first_high)):
        rows = np.flatnonzero(high == rank)
        found, index = np.unique(gap[rows], return_index=True)
        first[:] = rows[index][np.searchsorted(found, gap).clip(max=len(found) - 1)]
    has_low, has_high = before_low >= start, before_high >= start
    low_at = np.where(has_low, before_low, first_low)
    high_at = np.where(has_high, before_high, first_high)
    step_low = np.flatnonzero((high == 0) & has_low)
    step_high = np.flatnonzero((high == 1) & has_high)
    faces = np.concatenate(
        [
            np.stack([vertex[low_at[step_low]], vertex[step_low], vertex[high_at[step_low]]], 1),
            np.stack([vertex[low_at[step_high]], vertex[step_high], vertex[high_at[step_high]]], 1),
        ]
    )
    owner = np.concatenate([gap[step_low], gap[step_high]])
    return np.column_stack([faces, np.full(len(faces), NONE)]), owner
