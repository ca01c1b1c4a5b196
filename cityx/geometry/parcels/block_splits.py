"""Splitting blocks: halves of halves with a door to the street, and slices along one.

References
----------
Vanegas, Kelly, Weber, Halatsch, Aliaga and Müller, "Procedural generation of parcels in urban
modeling", Computer Graphics Forum 31(2), 2012: recursive subdivision by the oriented box.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.geometry.arrays import FloatArray, IntArray
from cityx.geometry.parcels.street_edges import street_lengths
from cityx.geometry.polylines import Polylines, locate
from cityx.geometry.rectangles import rectangles_of
from cityx.ids import UInt64Array, uniform

JITTER = 0.12  # of the side, how far a cut may lie from the middle
ENOUGH, SPREAD = 1.3, 0.5  # times the wanted area from which a piece is halved; a draw adds more
SMALLEST = 0.5  # of the wanted area that a half must have
# Cuts that are tried: whether across the longer side, and how far beside the middle.
TRIES = ((True, 0.0), (False, 0.0), (True, -0.2), (True, 0.2), (False, -0.2), (False, 0.2))
MOST = 32  # halvings; a block of 4,000 km2 is a parcel by then
SLENDER = 3.0  # times as long as wide, a half is refused
REACH = 2.0  # times its diagonal, how far a cut runs beyond a block
SMOOTH = 4.0  # metres to each side over which the direction of a street is taken
SHIFT = 0.10  # of the frontage, how far a boundary may move
CORNER_LOT = 1.15  # times as wide, a lot that has two streets
ROOM = 0.35  # of the frontage by which the backs of neighbouring cuts must lie apart at least
BEYOND = 1.5  # depths that cuts run into the block
FAR = 2.0  # depths and lengths of a strip that its outermost cells reach past its ends
DUST = 1e-6  # square metres; less is rounding
STRIP_CODES, PIECE_CODES = np.uint64(1 << 40), np.uint64(1 << 20)


@dataclass(frozen=True)
class Pieces:
    """m pieces of blocks.

    Attributes
    ----------
    shapes
        (m,) polygons.
    block
        (m,) row of each piece's block.
    code
        (m,) uint64 number of the piece in its block, whatever other blocks there are.
    heading
        (m, 2) direction of the street it is laid out along, NaN where it is along none.
    """

    shapes: NDArray[Any]
    block: IntArray
    code: UInt64Array
    heading: FloatArray

    def take(self, rows: Any) -> Pieces:
        """Return some of the pieces."""
        return Pieces(self.shapes[rows], self.block[rows], self.code[rows], self.heading[rows])


def joined_pieces(given: Sequence[Pieces]) -> Pieces:
    """Put pieces together."""
    return Pieces(
        np.concatenate([found.shapes for found in given]),
        np.concatenate([found.block for found in given]),
        np.concatenate([found.code for found in given]),
        np.concatenate([found.heading for found in given]),
    )


def split_blocks(
    blocks: NDArray[Any],
    streets: NDArray[Any],
    ids: UInt64Array,
    area: FloatArray,
    front: FloatArray,
    *,
    seed: int,
) -> Pieces:
    """Cut blocks across their longer side until the pieces are small.

    Where a cut leaves a piece without street, too small or too slender, others are tried (`TRIES`);
    a piece that none suits stays whole.

    Parameters
    ----------
    blocks
        (n,) polygons near the origin of a frame of their own.
    streets
        (n,) their borders.
    ids
        (n,) key of the draws.
    area, front
        (n,) wanted square metres of a piece, and metres of street that it needs.

    Returns
    -------
    pieces
        At least one per block.
    """
    shapes, block = blocks.copy(), np.arange(len(blocks))
    code = np.ones(len(blocks), np.uint64)
    done: list[tuple[NDArray[Any], IntArray, UInt64Array]] = []
    for _ in range(MOST):
        limit = area[block] * (ENOUGH + SPREAD * uniform(seed, "parcel/limit", ids[block], code))
        large = shapely.area(shapes) > limit
        done.append((shapes[~large], block[~large], code[~large]))
        shapes, block, code = shapes[large], block[large], code[large]
        if not len(shapes):
            break
        share = 0.5 + JITTER * (2 * uniform(seed, "parcel/cut", ids[block], code) - 1)
        halves = np.empty((len(shapes), 2), object)
        fine = np.zeros(len(shapes), bool)
        for across, shift in TRIES:
            rows = np.flatnonzero(~fine)
            if not len(rows):
                break
            halves[rows], fine[rows] = _halved(
                shapes[rows], block[rows], streets, area, front, share[rows] + shift, across=across
            )
        done.append((shapes[~fine], block[~fine], code[~fine]))
        doubled = code[fine] * np.uint64(2)
        shapes = halves[fine].ravel()
        block = np.repeat(block[fine], 2)
        code = np.column_stack([doubled, doubled + np.uint64(1)]).ravel()
    else:
        done.append((shapes, block, code))
    found = [np.concatenate(part) for part in zip(*done, strict=True)]
    return Pieces(found[0], found[1], found[2], np.full((len(found[0]), 2), np.nan))


def _halved(
    shapes: NDArray[Any],
    block: IntArray,
    streets: NDArray[Any],
    area: FloatArray,
    front: FloatArray,
    share: FloatArray,
    *,
    across: bool,
) -> tuple[NDArray[Any], NDArray[np.bool_]]:
    """Cut shapes in two; (n, 2) halves and whether both will do."""
    box = rectangles_of(shapes)
    angle = box.angle if across else box.angle + np.pi / 2
    length = box.length if across else box.width
    along = np.column_stack([np.cos(angle), np.sin(angle)])
    middle = box.centre + ((share - 0.5) * length)[:, None] * along
    side = np.column_stack([-along[:, 1], along[:, 0]])
    far = (REACH * np.hypot(box.length, box.width))[:, None]
    low, high = middle - far * side, middle + far * side
    back = shapely.polygons(np.stack([low, high, high - far * along, low - far * along], axis=1))
    ahead = shapely.polygons(np.stack([low, low + far * along, high + far * along, high], axis=1))
    halves = np.column_stack(
        [shapely.intersection(shapes, back), shapely.intersection(shapes, ahead)]
    )
    flat, owner = halves.ravel(), np.repeat(block, 2)
    fine = (shapely.get_type_id(flat) == 3) & (shapely.area(flat) > SMALLEST * area[owner])
    rows = np.flatnonzero(fine)
    fine[rows] = street_lengths(flat[rows], streets, owner[rows]) >= front[owner[rows]]
    rows = np.flatnonzero(fine)
    shape = rectangles_of(flat[rows])
    fine[rows] = shape.length < SLENDER * shape.width
    return halves, fine.reshape(-1, 2).all(axis=1)


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
    edge += np.where((k > 0) & (k < many), SHIFT * (2 * draw - 1) / many, 0.0)
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
