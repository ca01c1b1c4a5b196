"""Slices of strips: land along a street cut at right angles to it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.geometry.parcels.block_splits import Pieces, joined_pieces
from cityx.geometry.polygons import FloatArray, IntArray
from cityx.geometry.polylines import Polylines, locate
from cityx.ids import UInt64Array, uniform

SMOOTH = 4.0  # metres to each side over which the direction of a street is taken
JITTER = 0.10  # of the frontage, how far a boundary may move
CORNER_LOT = 1.15  # times as wide, a lot that has two streets
ROOM = 0.35  # of the frontage by which the backs of neighbouring cuts must lie apart at least
BEYOND = 1.5  # depths that cuts run into the block
FAR = 2.0  # depths and lengths of a strip that its outermost cells reach past its ends
DUST = 1e-6  # square metres; less is rounding
STRIP_CODES, PIECE_CODES = np.uint64(1 << 40), np.uint64(1 << 20)


@dataclass(frozen=True)
class Strip:
    """Land along one side of a block.

    Attributes
    ----------
    shape
        Polygon.
    chain
        (k, 2) the side, interior on its left.
    low, high
        Metres along the side between which the strip has the street.
    number
        Of the strip in its block.
    """

    shape: Any
    chain: FloatArray
    low: float
    high: float
    number: int


@dataclass(frozen=True)
class _Cuts:
    """Strips to be cut, s of them, at c places, the two ends of each included.

    Attributes
    ----------
    shapes, block, number
        (s,) polygons, row of the block, number in the block.
    lines
        Their sides.
    depth
        (s,) metres.
    strip, at
        (c,) strip and metres along its side.
    """

    shapes: NDArray[Any]
    block: IntArray
    number: IntArray
    lines: Polylines
    depth: FloatArray
    strip: IntArray
    at: FloatArray

    @property
    def ends(self) -> tuple[IntArray, IntArray]:
        """(s,) first and last place of each strip."""
        rows = np.arange(len(self.shapes))
        return np.searchsorted(self.strip, rows), np.searchsorted(self.strip, rows, "right") - 1

    def direction(self, strip: IntArray, at: FloatArray) -> FloatArray:
        """(k, 2) unit vectors along sides."""
        way = locate(self.lines, strip, at + SMOOTH)[0] - locate(self.lines, strip, at - SMOOTH)[0]
        return np.asarray(way / np.hypot(*way.T)[:, None])


def slice_strips(
    strips: list[Strip],
    block: IntArray,
    ids: UInt64Array,
    frontage: FloatArray,
    depth: FloatArray,
    *,
    seed: int,
) -> Pieces:
    """Cut strips across, square to the street where it runs, or all alike if that fails.

    Parameters
    ----------
    block
        (s,) row of each strip's block.
    ids, frontage, depth
        (n,) of the blocks: key of the draws, wanted metres along the street, metres of a strip.
    """
    none = np.zeros(0, np.int64)
    nothing = Pieces(np.zeros(0, object), none, none.astype(np.uint64), np.zeros((0, 2)))
    if not strips:
        return nothing
    cuts = _cuts_of(strips, block, ids, frontage, depth, seed=seed)
    made = []
    left = np.ones(len(strips), bool)
    for parallel in (False, True):
        pieces, strip = _cut(cuts, parallel=parallel)
        area = np.bincount(strip, shapely.area(pieces.shapes), minlength=len(strips))
        covered = left & (np.abs(area - shapely.area(cuts.shapes)) < DUST)
        made.append(pieces.take(covered[strip]))
        left &= ~covered
        if not left.any():
            return joined_pieces(made)
    whole = np.flatnonzero(left)
    code = (cuts.number[whole] + 1).astype(np.uint64) * STRIP_CODES
    none_of_them = np.full((len(whole), 2), np.nan)
    return joined_pieces([*made, Pieces(cuts.shapes[whole], block[whole], code, none_of_them)])


def _cuts_of(
    strips: list[Strip],
    block: IntArray,
    ids: UInt64Array,
    frontage: FloatArray,
    depth: FloatArray,
    *,
    seed: int,
) -> _Cuts:
    """Choose where parcels begin and end: about as wide as wanted, wider at the corners."""
    shapes = np.empty(len(strips), object)
    shapes[:] = [strip.shape for strip in strips]
    low, high = np.array([(strip.low, strip.high) for strip in strips]).T
    number = np.array([strip.number for strip in strips], np.int64)
    count = np.maximum(np.rint((high - low) / frontage[block]), 1).astype(np.int64)
    strip = np.repeat(np.arange(len(strips)), count + 1)
    k = np.arange(len(strip)) - np.searchsorted(strip, strip)
    many = count[strip]
    extra = np.where(many > 2, CORNER_LOT - 1.0, 0.0)
    edge = (k + extra * ((k > 0) + (k == many))) / (many + 2 * extra)
    draw = uniform(seed, "parcel/edge", ids[block[strip]], number[strip] * (1 << 20) + k)
    edge += np.where((k > 0) & (k < many), JITTER * (2 * draw - 1) / many, 0.0)
    points = [found.chain for found in strips]
    start = np.concatenate([[0], np.cumsum([len(chain) for chain in points])])
    return _Cuts(
        shapes, block, number, Polylines(np.concatenate(points), start), depth[block], strip,
        low[strip] + edge * (high - low)[strip],
    )  # fmt: skip


def _cut(cuts: _Cuts, *, parallel: bool) -> tuple[Pieces, IntArray]:
    """Cut strips at their places; the pieces and the strip of each."""
    cells, fine, first = _cells(cuts, parallel=parallel)
    strip = cuts.strip[first]
    cut = shapely.intersection(cuts.shapes[strip[fine]], shapely.polygons(cells[fine]))
    pieces, index = shapely.get_parts(cut, return_index=True)
    kept = (shapely.get_type_id(pieces) == 3) & (shapely.area(pieces) > DUST)
    pieces, index = pieces[kept], np.flatnonzero(fine)[index[kept]]
    of, cell = strip[index], first[index]
    slot = cell - np.searchsorted(cuts.strip, of)
    nth = np.arange(len(index)) - np.searchsorted(index, index)
    code = (cuts.number[of] + 1).astype(np.uint64) * STRIP_CODES
    code += slot.astype(np.uint64) * PIECE_CODES + nth.astype(np.uint64)
    heading = cuts.direction(of, (cuts.at[cell] + cuts.at[cell + 1]) / 2)
    return Pieces(pieces, cuts.block[of], code, heading), of


def _cells(cuts: _Cuts, *, parallel: bool) -> tuple[FloatArray, NDArray[np.bool_], IntArray]:
    """Return (k, 4, 2) cells between cuts, (k,) whether they are sound, and the first cut of each.

    The outermost cells of a strip reach far past its ends.
    """
    strip, (begin, end) = cuts.strip, cuts.ends
    foot, _ = locate(cuts.lines, strip, cuts.at)
    chord = foot[end] - foot[begin]
    chord /= np.hypot(*chord.T)[:, None]
    straight = parallel | (end - begin == 1)
    along = np.where(straight[strip][:, None], chord[strip], cuts.direction(strip, cuts.at))
    normal = np.column_stack([-along[:, 1], along[:, 0]])
    depth = cuts.depth[strip][:, None]
    outer, inner = foot - normal * depth, foot + normal * depth * BEYOND
    first = np.flatnonzero(strip[1:] == strip[:-1])
    # Cuts must not meet within the strip.
    least = ROOM * (cuts.at[first + 1] - cuts.at[first])
    fine = np.ones(len(first), bool)
    for edge in (outer, inner):
        fine &= ((edge[first + 1] - edge[first]) * chord[strip[first]]).sum(axis=1) >= least
    reach = (FAR * (cuts.depth + cuts.at[end] - cuts.at[begin]))[:, None]
    for at, sign in ((begin, -1.0), (end, 1.0)):
        outer[at] = foot[at] + reach * (sign * along[at] - normal[at])
        inner[at] = foot[at] + reach * (sign * along[at] + normal[at])
    cells = np.stack([outer[first], outer[first + 1], inner[first + 1], inner[first]], axis=1)
    return cells, fine & shapely.is_valid(shapely.polygons(cells)), first
