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

from cityx.geometry.block_slices import Strip, slice_strips
from cityx.geometry.block_splits import Pieces, joined_pieces
from cityx.geometry.identity import UInt64Array
from cityx.geometry.polygons import FloatArray, rings_of
from cityx.geometry.seams import subtract

CORNER = np.radians(35.0)  # a sharper bend ends a street
CURVE = np.radians(60.0)  # a street that has turned so far is another one
SHORT = 8.0  # metres; a shorter side, such as a cut corner, has no strip of its own
DUST = 1e-6  # square metres; less is rounding
MEETING = 1.6  # times the wanted depth; strips of a block no deeper meet in its middle
OVER = 0.5  # metres more than half the block, so that the strips meet for certain
FRONTLESS = 1.2  # metres; a strip with less street is none


Side = tuple[FloatArray, float, float]


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
    for row, sides in enumerate(_sides(blocks)):
        found, rest = _strips(blocks[row], sides, float(reach[row]))
        strips += found
        rows += [row] * len(found)
        rests += [(shape, row, number) for number, shape in enumerate(rest)]
    sliced = slice_strips(strips, np.array(rows, np.int64), ids, frontage, reach, seed=seed)
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


def _strips(block: Any, sides: list[Side], depth: float) -> tuple[list[Strip], list[Any]]:
    """Give each side of a block its land; the strips, and what none of them took."""
    rest = block
    strips: list[Strip] = []
    for chain, begins, ends in sides:
        line = shapely.linestrings(chain)
        if line.length < SHORT:
            continue
        band = shapely.buffer(
            _reaching(chain, begins, ends, depth), depth, cap_style="flat", join_style="mitre",
            mitre_limit=2.0,
        )  # fmt: skip
        for piece in _polygons(shapely.intersection(rest, band)):
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
    return shapely.linestrings(np.concatenate(points))


def _past(turn: float, depth: float) -> float:
    """Return how far a side runs on where its street turns."""
    return 3.0 * depth if turn > CORNER else depth * np.tan(turn / 2) * 1.01


def _span(piece: Any, line: Any) -> tuple[float, float]:
    """Return from where to where along a side a piece has the street."""
    points = shapely.points(shapely.get_coordinates(piece))
    near = points[shapely.dwithin(points, line, 1e-6)]
    along = shapely.line_locate_point(line, near)
    return (float(along.min()), float(along.max())) if len(along) else (0.0, 0.0)
