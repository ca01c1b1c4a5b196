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

import itertools
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.geometry.arrays import FloatArray, IntArray
from cityx.geometry.parcels.block_splits import Pieces, Strip, joined_pieces, slice_strips
from cityx.geometry.polygons import rings_of
from cityx.geometry.seams import common, subtract
from cityx.ids import UInt64Array

CORNER = np.radians(35.0)  # a sharper bend ends a street
CURVE = np.radians(60.0)  # a street that has turned so far is another one
SHORT = 8.0  # metres; a shorter side, such as a cut corner, has no strip of its own
DUST = 1e-6  # square metres; less is rounding
MEETING = 1.6  # times the wanted depth; strips of a block no deeper meet in its middle
OVER = 0.5  # metres more than half the block, so that the strips meet for certain
FRONTLESS = 1.2  # metres; a strip with less street is none


Side = tuple[FloatArray, float, float]


def strip_blocks(
    blocks: NDArray[Any], ids: UInt64Array, frontage: FloatArray, depth: FloatArray, *, seed: int
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
    strips, rows, rest = _strips(blocks, _sides(blocks), reach)
    sliced = slice_strips(strips, rows, ids, frontage, reach, seed=seed)
    shapes, block = _polygons(rest)
    code = (np.arange(len(block)) - np.searchsorted(block, block)).astype(np.uint64)
    left = Pieces(shapes, block, code, np.full((len(shapes), 2), np.nan))
    return joined_pieces([sliced, left])


def meeting_depth(blocks: NDArray[Any], depth: FloatArray) -> FloatArray:
    """Return the depth of strips: half the block where that is near to the wanted depth."""
    circle = shapely.maximum_inscribed_circle(blocks, 0.25)
    half = shapely.length(circle)
    return np.asarray(np.where(half < MEETING * depth, half + OVER, depth))


def _sides(blocks: NDArray[Any]) -> list[list[Side]]:
    """List the sides of each block, longest first: points, turn at the start and at the end."""
    rings = rings_of(blocks)
    step = rings.points[rings.following()] - rings.points
    before = step[rings.preceding()]
    turns = np.arctan2(
        before[:, 0] * step[:, 1] - before[:, 1] * step[:, 0], (before * step).sum(axis=1)
    )
    lengths = np.hypot(*step.T)
    sides: list[list[tuple[float, Side]]] = [[] for _ in blocks]
    for ring, row in enumerate(rings.polygon.tolist()):
        own = slice(rings.start[ring], rings.start[ring + 1])
        points, turn, length = rings.points[own], turns[own], lengths[own]
        breaks = _breaks(turn)
        for a, b in itertools.pairwise([*breaks, breaks[0] + len(points)]):
            at = np.arange(a, b + 1) % len(points)
            side = (points[at], float(turn[at[0]]), float(turn[at[-1]]))
            sides[row].append((round(float(length[at[:-1]].sum()), 6), side))
    return [[side for _, side in sorted(found, key=_longest_first)] for found in sides]


def _longest_first(found: tuple[float, Side]) -> float:
    return -found[0]


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


def _strips(
    blocks: NDArray[Any], sides: list[list[Side]], depth: FloatArray
) -> tuple[list[Strip], IntArray, NDArray[Any]]:
    """Give each side of each block its land, the longest sides first.

    Returns
    -------
    strips, block
        The strips, and the (s,) row of each one's block, rising.
    rest
        (n,) what none of them took.
    """
    rest = blocks.copy()
    made: list[tuple[int, Strip]] = []
    count = np.zeros(len(blocks), np.int64)
    for rank in range(max(map(len, sides), default=0)):
        empty = shapely.is_empty(rest)
        rows = np.array(
            [row for row, own in enumerate(sides) if rank < len(own) and not empty[row]], np.int64
        )
        turn = [sides[row][rank] for row in rows.tolist()]
        lines = _lines_of([chain for chain, _, _ in turn])
        long = shapely.length(lines) >= SHORT
        rows, lines = rows[long], lines[long]
        turn = [side for side, kept in zip(turn, long.tolist(), strict=True) if kept]
        pieces, of = _polygons(common(rest[rows], _bands(turn, depth[rows])))
        low, high = _spans(pieces, lines[of])
        nth = np.arange(len(of)) - np.searchsorted(of, of)
        for number in range(nth.max(initial=-1) + 1):
            some = np.flatnonzero((nth == number) & (high - low > FRONTLESS))
            block = rows[of[some]]
            for k, row in zip(some.tolist(), block.tolist(), strict=True):
                strip = Strip(
                    pieces[k], turn[of[k]][0], float(low[k]), float(high[k]), int(count[row])
                )
                made.append((row, strip))
            count[block] += 1
            rest[block] = subtract(rest[block], pieces[some])
    made.sort(key=lambda found: (found[0], found[1].number))
    return [strip for _, strip in made], np.array([row for row, _ in made], np.int64), rest


def _lines_of(chains: list[FloatArray]) -> NDArray[Any]:
    """Return chains of points as lines."""
    lines = np.zeros(len(chains), object)
    if chains:
        of = np.repeat(np.arange(len(chains)), [len(chain) for chain in chains])
        lines[:] = shapely.linestrings(np.concatenate(chains), indices=of)
    return lines


def _polygons(shapes: NDArray[Any]) -> tuple[NDArray[Any], IntArray]:
    """Return the polygons of shapes that are more than rounding, and the row of each."""
    parts, outer = shapely.get_parts(shapes, return_index=True)
    parts, inner = shapely.get_parts(parts, return_index=True)
    kept = (shapely.get_type_id(parts) == 3) & (shapely.area(parts) > DUST)
    return parts[kept], outer[inner][kept]


def _bands(sides: list[Side], depth: FloatArray) -> NDArray[Any]:
    """Return the land within a depth of sides that run on past their corners."""
    lines = _lines_of([
        _reaching(*side, reach) for side, reach in zip(sides, depth.tolist(), strict=True)
    ])  # fmt: skip
    return np.asarray(
        shapely.buffer(lines, depth, cap_style="flat", join_style="mitre", mitre_limit=2.0), object
    )


def _reaching(chain: FloatArray, begins: float, ends: float, depth: float) -> FloatArray:
    """Return a side with points that it runs on to past its corners, but not into the block."""
    points = [chain]
    if begins > 0:
        way = chain[0] - chain[1]
        points.insert(0, (chain[0] + way / np.hypot(*way) * _past(begins, depth))[None])
    if ends > 0:
        way = chain[-1] - chain[-2]
        points.append((chain[-1] + way / np.hypot(*way) * _past(ends, depth))[None])
    return np.concatenate(points)


def _past(turn: float, depth: float) -> float:
    """Return how far a side runs on where its street turns."""
    return 3.0 * depth if turn > CORNER else depth * np.tan(turn / 2) * 1.01


def _spans(pieces: NDArray[Any], lines: NDArray[Any]) -> tuple[FloatArray, FloatArray]:
    """Return from where to where along its side each piece has the street, 0 where nowhere."""
    at, of = shapely.get_coordinates(pieces, return_index=True)
    points = shapely.points(at)
    near = shapely.dwithin(points, lines[of], 1e-6)
    of = of[near]
    along = shapely.line_locate_point(lines[of], points[near])
    low, high = np.full(len(pieces), np.inf), np.full(len(pieces), -np.inf)
    np.minimum.at(low, of, along)
    np.maximum.at(high, of, along)
    none = ~np.isfinite(low)
    low[none] = high[none] = 0.0
    return low, high
