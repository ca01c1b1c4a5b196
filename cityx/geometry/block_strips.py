"""Strips of blocks: land along each street of a block, sliced at right angles to the street.

The street with the longest side takes its strip first, past the corners, so that no strip ends in a
diagonal; the shorter sides share what is left. These are the faces of a straight skeleton with the
diagonal corners given to one of the two streets.

References
----------
Vanegas, Kelly, Weber, Halatsch, Aliaga and Müller, "Procedural generation of parcels in urban
modeling", Computer Graphics Forum 31(2), 2012: strips along the street.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.geometry.block_splits import Pieces, joined_pieces
from cityx.geometry.identity import UInt64Array, uniform
from cityx.geometry.polygons import FloatArray, IntArray, rings_of
from cityx.geometry.seams import subtract

CORNER = np.radians(35.0)  # a sharper bend ends a street
CURVE = np.radians(60.0)  # a street that has turned so far is another one
SHORT = 8.0  # metres; a shorter side, such as a cut corner, has no strip of its own
DUST = 1e-6  # square metres; less is rounding
THIN = 0.01  # metres; width of the line along which contact is measured
SMOOTH = 4.0  # metres to each side over which the direction of a street is taken
JITTER = 0.10  # of the frontage, how far a boundary may move
CORNER_LOT = 1.15  # times as wide, a lot that has two streets
MEETING = 1.6  # times the wanted depth; strips of a block no deeper meet in its middle
OVER = 0.5  # metres more than half the block, so that the strips meet for certain
BEYOND = 1.5  # depths that cuts run into the block
FAR = 2.0  # depths and lengths of a strip that its outermost cells reach past its ends
FRONTLESS = 1.2  # metres; a strip with less street is none
ROOM = 0.35  # of the frontage by which the backs of neighbouring cuts must lie apart at least
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


def strip_blocks(
    blocks: NDArray[Any],
    ids: UInt64Array,
    frontage: FloatArray,
    depth: FloatArray,
    *,
    seed: int,
) -> Pieces:
    """Cut blocks into strips along their streets and the strips into parcels.

    Parameters
    ----------
    blocks
        (n,) polygons near the origin of a frame of their own.
    ids
        (n,) key of the draws.
    frontage, depth
        (n,) wanted metres of a parcel along the street and away from it.

    Returns
    -------
    pieces
        They cover the blocks; what lies too far inside, and now and then a corner, has no street.
    """
    reach = meeting_depth(blocks, depth)
    rows: list[int] = []
    strips: list[Strip] = []
    rests: list[tuple[Any, int, int]] = []
    for row, block in enumerate(blocks):
        found, rest = _strips(block, float(reach[row]))
        strips += found
        rows += [row] * len(found)
        rests += [(shape, row, number) for number, shape in enumerate(rest)]
    sliced = _sliced(strips, np.array(rows, np.int64), ids, frontage, reach, seed=seed)
    return joined_pieces([sliced, _rest_pieces(rests)])


def _rest_pieces(rests: list[tuple[Any, int, int]]) -> Pieces:
    shapes = np.empty(len(rests), object)
    shapes[:] = [shape for shape, _, _ in rests]
    block = np.array([row for _, row, _ in rests], np.int64)
    code = np.array([number for _, _, number in rests], np.uint64)
    return Pieces(shapes, block, code, np.full((len(rests), 2), np.nan))


def meeting_depth(blocks: NDArray[Any], depth: FloatArray) -> FloatArray:
    """Return the depth of strips: half the block where that is near to the wanted depth."""
    circle = shapely.maximum_inscribed_circle(blocks, 0.25)
    half = shapely.length(circle)
    return np.asarray(np.where(half < MEETING * depth, half + OVER, depth))


def _sides(block: Any) -> list[tuple[FloatArray, float, float]]:
    """List the sides of a block, longest first: points, turn at the start and at the end."""
    rings = rings_of(np.array([block], object))
    sides = []
    for first, last in zip(rings.start[:-1], rings.start[1:], strict=True):
        points = rings.points[first:last]
        step = np.roll(points, -1, axis=0) - points
        before = np.roll(step, 1, axis=0)
        turn = np.arctan2(
            before[:, 0] * step[:, 1] - before[:, 1] * step[:, 0], (before * step).sum(axis=1)
        )
        breaks = _breaks(turn)
        for a, b in zip(breaks, [*breaks[1:], breaks[0] + len(points)], strict=True):
            chain = points[np.arange(a, b + 1) % len(points)]
            sides.append((chain, float(turn[a % len(points)]), float(turn[b % len(points)])))
    lengths = [round(float(np.hypot(*np.diff(chain, axis=0).T).sum()), 6) for chain, _, _ in sides]
    return [sides[i] for i in sorted(range(len(sides)), key=lambda i: (-lengths[i], i))]


def _breaks(turn: FloatArray) -> list[int]:
    """Return the points of a ring where one side ends and the next begins."""
    corners = np.flatnonzero(np.abs(turn) > CORNER)
    begin = int(corners[0]) if len(corners) else int(np.argmax(np.abs(turn)))
    breaks, turned = [begin], 0.0
    for step in range(1, len(turn)):
        at = (begin + step) % len(turn)
        turned += float(turn[at])
        if abs(turn[at]) > CORNER or abs(turned) > CURVE:
            breaks.append(begin + step)
            turned = 0.0
    return breaks


def _strips(block: Any, depth: float) -> tuple[list[Strip], list[Any]]:
    """Give each side of a block its land; the strips, and what none of them took."""
    rest = block
    strips: list[Strip] = []
    for chain, begins, ends in _sides(block):
        line = shapely.LineString(chain)
        if line.length < SHORT:
            continue
        band = shapely.buffer(
            _reaching(chain, begins, ends, depth), depth, cap_style="flat", join_style="mitre",
            mitre_limit=2.0,
        )  # fmt: skip
        touch = shapely.buffer(line, THIN, cap_style="flat")
        pieces = _polygons(shapely.intersection(rest, band))
        pieces = [p for p in pieces if shapely.intersection(p, touch).area > FRONTLESS * THIN]
        for piece in pieces:
            low, high = _span(piece, line)
            if high - low > FRONTLESS:
                strips.append(Strip(piece, chain, low, high, len(strips)))
                rest = subtract(rest, piece)
        if rest.is_empty:
            break
    return strips, _polygons(rest)


def _polygons(shape: Any) -> list[Any]:
    """List the polygons of a shape that are more than rounding."""
    parts = shapely.get_parts(shapely.get_parts(shape))
    return [part for part in parts if part.geom_type == "Polygon" and part.area > DUST]


def _reaching(chain: FloatArray, begins: float, ends: float, depth: float) -> Any:
    """Return a side as a line that runs on past its corners, but not into the block."""
    points = [chain]
    if begins > 0:
        way = chain[0] - chain[1]
        points.insert(0, (chain[0] + way / np.hypot(*way) * _past(begins, depth))[None])
    if ends > 0:
        way = chain[-1] - chain[-2]
        points.append((chain[-1] + way / np.hypot(*way) * _past(ends, depth))[None])
    return shapely.LineString(np.concatenate(points))


def _past(turn: float, depth: float) -> float:
    """Return how far a side runs on where its street turns."""
    return 3.0 * depth if turn > CORNER else depth * np.tan(turn / 2) * 1.01


def _span(piece: Any, line: Any) -> tuple[float, float]:
    """Return from where to where along a side a piece has the street."""
    points = shapely.points(shapely.get_coordinates(piece))
    near = points[shapely.dwithin(points, line, 1e-6)]
    along = shapely.line_locate_point(line, near)
    return (float(along.min()), float(along.max())) if len(along) else (0.0, 0.0)


def _sliced(
    strips: list[Strip],
    block: IntArray,
    ids: UInt64Array,
    frontage: FloatArray,
    depth: FloatArray,
    *,
    seed: int,
) -> Pieces:
    """Cut strips across, square to the street where it runs, or all alike if that fails."""
    none = np.zeros(0, np.int64)
    made = [Pieces(np.zeros(0, object), none, none.astype(np.uint64), np.zeros((0, 2)))]
    at = [
        _places(strip, ids[row], float(frontage[row]), seed=seed)
        for strip, row in zip(strips, block.tolist(), strict=True)
    ]
    todo = np.arange(len(strips))
    for parallel in (False, True):
        if len(todo):
            cut, failed = _cut(strips, todo, at, block, depth, parallel=parallel)
            made.append(cut)
            todo = failed
    return joined_pieces(made)


def _cut(
    strips: list[Strip],
    chosen: IntArray,
    at: list[FloatArray],
    block: IntArray,
    depth: FloatArray,
    *,
    parallel: bool,
) -> tuple[Pieces, IntArray]:
    """Cut some strips at given places; the pieces, and the strips that these cuts do not cover."""
    cells, headings = zip(
        *(_cells(strips[i], at[i], float(depth[block[i]]), parallel=parallel) for i in chosen),
        strict=True,
    )
    strip = np.repeat(chosen, [len(found) for found in cells])
    slot = np.arange(len(strip)) - np.searchsorted(strip, strip)
    shapes = np.empty(len(strips), object)
    shapes[:] = [found.shape for found in strips]
    quads = shapely.polygons(np.concatenate(cells))
    cut = shapely.intersection(
        shapes[strip], np.where(shapely.is_valid(quads), quads, shapely.Polygon())
    )
    short = np.bincount(strip, shapely.area(cut), minlength=len(strips)) - shapely.area(shapes)
    failed = np.abs(short) > DUST
    pieces, cell = shapely.get_parts(cut, return_index=True)
    kept = (shapely.get_type_id(pieces) == 3) & (shapely.area(pieces) > DUST)
    kept &= ~failed[strip[cell]]
    pieces, cell = pieces[kept], cell[kept]
    number = np.array([found.number + 1 for found in strips], np.uint64)[strip[cell]]
    nth = (np.arange(len(cell)) - np.searchsorted(cell, cell)).astype(np.uint64)
    code = number * STRIP_CODES + slot[cell].astype(np.uint64) * PIECE_CODES + nth
    heading = np.concatenate(headings)[cell]
    return Pieces(pieces, block[strip[cell]], code, heading), chosen[failed[chosen]]


def _places(strip: Strip, block_id: np.uint64, frontage: float, *, seed: int) -> FloatArray:
    """Return (k + 1,) metres along the side where parcels begin and end."""
    length = strip.high - strip.low
    count = max(1, round(length / frontage))
    width = np.ones(count)
    if count > 2:
        width[[0, -1]] = CORNER_LOT
    edges = np.concatenate([[0.0], np.cumsum(width)]) / width.sum()
    shift = uniform(seed, f"parcel/strip{strip.number}", block_id, np.arange(count - 1))
    edges[1:-1] += JITTER * (2 * shift - 1) / count
    return np.asarray(strip.low + edges * length)


def _cells(
    strip: Strip, at: FloatArray, depth: float, *, parallel: bool
) -> tuple[FloatArray, FloatArray]:
    """Return (k, 4, 2) cells between the cuts and (k, 2) direction of the street in each."""
    chain = strip.chain
    run = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(chain, axis=0).T))])

    def direction(s: FloatArray) -> FloatArray:
        ahead, behind = _points(chain, run, s + SMOOTH), _points(chain, run, s - SMOOTH)
        return np.asarray((ahead - behind) / np.hypot(*(ahead - behind).T)[:, None])

    foot = _points(chain, run, at)
    chord = (foot[-1] - foot[0]) / np.hypot(*(foot[-1] - foot[0]))
    straight = parallel or len(at) == 2
    along = np.broadcast_to(chord, foot.shape) if straight else direction(at)
    normal = np.column_stack([-along[:, 1], along[:, 0]])
    outer, inner = foot - normal * depth, foot + normal * depth * BEYOND
    for edge in (outer, inner):
        if (np.diff(edge, axis=0) @ chord < ROOM * np.diff(at)).any():
            inner = outer = np.zeros_like(foot)  # cuts that meet within the strip cover nothing
    reach = FAR * (depth + strip.high - strip.low)
    for end, sign in ((0, -1.0), (-1, 1.0)):
        outer[end] = foot[end] + along[end] * sign * reach - normal[end] * reach
        inner[end] = foot[end] + along[end] * sign * reach + normal[end] * reach
    quads = np.stack([outer[:-1], outer[1:], inner[1:], inner[:-1]], axis=1)
    return quads, direction((at[1:] + at[:-1]) / 2)


def _points(chain: FloatArray, run: FloatArray, s: FloatArray) -> FloatArray:
    """Return the points of a line at distances from its start, straight on beyond its ends."""
    inside = np.clip(s, 0.0, run[-1])
    at = np.column_stack([np.interp(inside, run, chain[:, 0]), np.interp(inside, run, chain[:, 1])])
    first, last = chain[1] - chain[0], chain[-1] - chain[-2]
    past = s - inside
    way = np.where((past < 0)[:, None], first / np.hypot(*first), last / np.hypot(*last))
    return np.asarray(at + past[:, None] * way)
