"""Walls: the upright rectangles around buildings, cut where a neighbour covers them."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.geometry.arrays import FloatArray, IntArray
from cityx.geometry.polygons import corners, rings_of, run_along
from cityx.geometry.ranges import numbered

TOUCHING = 0.3  # metres; neighbours drawn closer than this share a wall
MIN_PIECE = 0.3  # metres; cuts closer together than this are one cut
MIN_HEIGHT = 0.05  # metres; a lower strip is no wall


@dataclass(frozen=True)
class WallTable:
    """Rectangles of walls, w of them.

    Attributes
    ----------
    part
        (w,) int32, row of the part.
    edge
        (w,) int32, number of the straight wall the rectangle was cut from.
    start, end
        (w, 2) float64, foot of the wall; seen from outside, the start is on the left.
    normal
        (w, 2) float64, outward unit normal.
    length
        (w,) float64, metres.
    along
        (w,) float64, metres run along the ring up to ``start``.
    edge_from, edge_length
        (w,) float64, where the rectangle starts on its straight wall, and that wall's length.
    z_low, z_high
        (w,) float64, foot and eave.
    blind_to
        (w,) float64, height up to which a neighbour covers the wall; ``z_low`` where none does.
    open_to
        (w,) float64, height from which a neighbour above (a bridge, a jetty) covers the wall;
        ``z_high`` where none does. Openings belong between ``blind_to`` and ``open_to``.
    """

    part: NDArray[np.int32]
    edge: NDArray[np.int32]
    start: FloatArray
    end: FloatArray
    normal: FloatArray
    length: FloatArray
    along: FloatArray
    edge_from: FloatArray
    edge_length: FloatArray
    z_low: FloatArray
    z_high: FloatArray
    blind_to: FloatArray
    open_to: FloatArray

    @property
    def count(self) -> int:
        """Number of rectangles."""
        return len(self.part)

    def take(self, rows: Any) -> WallTable:
        """Return the table of the given rows (indices or mask)."""
        return WallTable(*(getattr(self, column.name)[rows] for column in fields(self)))


def wall_table(polygons: NDArray[Any], z_low: FloatArray, z_high: FloatArray) -> WallTable:
    """List the walls of parts, nearly straight runs of edges merged.

    Parameters
    ----------
    polygons
        (n,) valid shapely polygons, metres.
    z_low, z_high
        (n,) foot and eave of each part; a part lower than `MIN_HEIGHT` has no wall.
    """
    rings = rings_of(polygons)
    kept = np.flatnonzero(corners(rings))
    ring = rings.ring_of_point[kept]
    first = np.searchsorted(ring, np.arange(len(rings.polygon)))
    following = np.arange(1, len(kept) + 1)
    if len(kept):
        last = np.append(first[1:], len(kept)) - 1
        following[last] = first
    start = rings.points[kept]
    end = start[following]
    vector = end - start
    length = np.hypot(*vector.T)
    along = run_along(rings)[kept]
    part = rings.polygon[ring]
    normal = np.column_stack([vector[:, 1], -vector[:, 0]]) / np.maximum(length, 1e-9)[:, None]
    table = WallTable(
        part.astype(np.int32),
        np.arange(len(part), dtype=np.int32),
        start,
        end,
        normal,
        length,
        along,
        np.zeros(len(part)),
        length,
        z_low[part],
        z_high[part],
        z_low[part],
        z_high[part],
    )
    return table.take((table.z_high - table.z_low >= MIN_HEIGHT) & (length > 1e-6))


def party_spans(
    walls: WallTable, polygons: NDArray[Any], z_low: FloatArray, z_high: FloatArray
) -> WallTable:
    """Cut walls where neighbours touch them and note how far up they are covered.

    Parameters
    ----------
    walls
        From `wall_table` over the same parts.
    polygons, z_low, z_high
        (n,) the parts that can cover a wall; a part without walls may be given an empty polygon.
    """
    if walls.count == 0:
        return walls
    wall, low, high, begin, finish = _covers(walls, polygons, z_low, z_high)
    if len(wall) == 0:
        return walls
    # Cut positions of every wall: its ends, and the ends of covers that are not near them.
    number = np.arange(walls.count)
    row = np.concatenate([wall, wall])
    at = np.concatenate([begin, finish])
    inside = (at > MIN_PIECE) & (at < walls.length[row] - MIN_PIECE)
    row, at = row[inside], at[inside]
    order = np.lexsort((at, row))
    row, at = row[order], at[order]
    spaced = np.ones(len(row), bool)
    spaced[1:] = (row[1:] != row[:-1]) | (at[1:] - at[:-1] >= MIN_PIECE)
    row = np.concatenate([number, row[spaced], number])
    at = np.concatenate([np.zeros(walls.count), at[spaced], walls.length])
    order = np.lexsort((at, row))
    row, at = row[order], at[order]
    inner = np.flatnonzero(row[1:] == row[:-1])
    piece_row, piece_from, piece_to = row[inner], at[inner], at[inner + 1]
    direction = (walls.end - walls.start) / walls.length[:, None]
    base = walls.start[piece_row]
    cut = walls.take(piece_row)
    whole = (piece_from == 0) & (piece_to == walls.length[piece_row])
    start = base + direction[piece_row] * piece_from[:, None]
    end = base + direction[piece_row] * piece_to[:, None]
    blind, opened = _heights(cut, piece_row, piece_from, piece_to, wall, low, high, begin, finish)
    return replace(
        cut,
        start=np.where(whole[:, None], cut.start, start),
        end=np.where(whole[:, None], cut.end, end),
        length=piece_to - piece_from,
        along=cut.along + piece_from,
        edge_from=piece_from,
        blind_to=blind,
        open_to=opened,
    )


def _covers(
    walls: WallTable, polygons: NDArray[Any], z_low: FloatArray, z_high: FloatArray
) -> tuple[IntArray, FloatArray, FloatArray, FloatArray, FloatArray]:
    """Stretches of walls that lie against another part: wall, low, high, begin, finish."""
    shift = walls.normal * TOUCHING
    lines = shapely.linestrings(np.stack([walls.start + shift, walls.end + shift], axis=1))
    tree = shapely.STRtree(polygons)
    wall, other = tree.query(lines, predicate="intersects")
    useful = (
        (walls.part[wall] != other)
        & (z_high[other] > walls.z_low[wall] + MIN_HEIGHT)
        & (z_low[other] < walls.z_high[wall] - MIN_HEIGHT)
    )
    wall, other = wall[useful], other[useful]
    inside = shapely.intersection(lines[wall], polygons[other])
    pieces, of_pair = shapely.get_parts(inside, return_index=True)
    lengthy = shapely.length(pieces) >= MIN_PIECE / 3
    pieces, of_pair = pieces[lengthy], of_pair[lengthy]
    wall, other = wall[of_pair], other[of_pair]
    ends = np.stack(
        [
            shapely.get_coordinates(shapely.get_point(pieces, 0)),
            shapely.get_coordinates(shapely.get_point(pieces, -1)),
        ],
        axis=1,
    )  # (p, 2, 2)
    direction = (walls.end - walls.start)[wall] / walls.length[wall, None]
    reach = ((ends - (walls.start + shift)[wall][:, None]) * direction[:, None]).sum(axis=2)
    begin, finish = reach.min(axis=1), reach.max(axis=1)
    order = np.lexsort((finish, begin, z_high[other], z_low[other], wall))
    wall, other = wall[order], other[order]
    return wall, z_low[other], z_high[other], begin[order], finish[order]


def _heights(
    cut: WallTable,
    piece_row: IntArray,
    piece_from: FloatArray,
    piece_to: FloatArray,
    wall: IntArray,
    low: FloatArray,
    high: FloatArray,
    begin: FloatArray,
    finish: FloatArray,
) -> tuple[FloatArray, FloatArray]:
    """Open band of each piece, from the covers of its wall."""
    first = np.searchsorted(piece_row, wall)
    count = np.searchsorted(piece_row, wall, side="right") - first
    cover = np.repeat(np.arange(len(wall)), count)
    offset = numbered(count)
    piece = first[cover] + offset
    middle = (piece_from[piece] + piece_to[piece]) / 2
    over = (begin[cover] <= middle) & (middle <= finish[cover])
    piece, cover = piece[over], cover[over]
    blind = cut.z_low.copy()
    for _ in range(3):  # neighbours stacked on neighbours
        reached = low[cover] <= blind[piece] + 0.5
        np.maximum.at(blind, piece[reached], high[cover][reached])
    blind = np.minimum(blind, cut.z_high)
    opened = cut.z_high.copy()
    above = low[cover] > blind[piece] + 0.5
    np.minimum.at(opened, piece[above], low[cover][above])
    return blind, np.maximum(opened, blind)
