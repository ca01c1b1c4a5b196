"""Refuges: islands in the middle of crossings, and ways through medians, cut down to the road."""

from __future__ import annotations

from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.city.ground import KERB_WIDTH, LABEL
from cityx.geometry.arrangement import Regions, join_regions, regions
from cityx.geometry.polylines import locate
from cityx.plugins.road.drops import FREE_SIDE, RIBS, patches
from cityx.plugins.road.marks import Street, lane_count, spans_of
from cityx.plugins.road.medians import NARROW, Twins, twins_of
from cityx.plugins.road.roundabouts import LANE_LEFT, SPLITTER_PRIORITY
from cityx.plugins.road.zebras import Zebras

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

LEAST_ISLAND, WIDEST_ISLAND = 1.2, 2.0  # metres; room for one person, and for a bicycle
ISLAND_END = 2.5  # metres of island on both sides of the crossing
NEAR = 15.0  # metres along the street from a mapped island to the crossing it belongs to
WAY_PRIORITY = 53  # above medians and kerbs, below dropped kerbs
CHORDS = 4  # per quarter circle of an island's end


def refuge_regions(street: Street, zebras: Zebras, *, yellow: bool) -> Regions:
    """Lay refuges where the map tells of an island, and ways through the medians of crossings.

    Parameters
    ----------
    street
        The network and what its marks share.
    zebras
        The crossings.
    yellow
        Whether the ribs are yellow.
    """
    if not len(zebras.edge):
        return Regions()
    ribs = LABEL["tactile" if yellow else "tactile_pale"]
    return join_regions([_islands(street, zebras, ribs), _median_ways(street, zebras, ribs)])


def _islands(street: Street, zebras: Zebras, ribs: int) -> Regions:
    """Build an island before and behind each crossing that has one, and ribs between them."""
    middle, width = _room(street)
    rows = _told(street, zebras)
    rows = rows[width[zebras.edge[rows]] >= LEAST_ISLAND]
    edge, depth = zebras.edge[rows], zebras.depth[rows]
    half = width[edge] / 2
    ends = [
        _capsules(street, edge, zebras.along[rows] + sign * (depth + ISLAND_END) / 2,
                  middle[edge], ISLAND_END / 2, half)
        for sign in (-1, 1)
    ]  # fmt: skip
    stones = np.concatenate(ends)
    floor = patches(street, zebras, rows, middle[edge] - half, middle[edge] + half)
    return join_regions([
        regions(floor, ribs, SPLITTER_PRIORITY),
        regions(stones, LABEL["kerb"], SPLITTER_PRIORITY + 1),
        regions(shapely.buffer(stones, -KERB_WIDTH), LABEL["courtyard"], SPLITTER_PRIORITY + 2),
    ])  # fmt: skip


def _told(street: Street, zebras: Zebras) -> IntArray:
    """Crossings that the map gives an island, by row."""
    points = street.layout.points
    crossing = points[(points["kind"] == "crossing").to_numpy()]
    tags = crossing["tags"].str
    island = tags.contains(r'"crossing:island": *"yes"|"traffic_calming": *"island"', regex=True)
    places = crossing.geometry.to_numpy()[island.to_numpy().astype(bool)]
    spots, _ = locate(street.lines, zebras.edge, zebras.along)
    if not len(places):
        return np.zeros(0, np.int64)
    row = shapely.STRtree(shapely.points(spots)).query_nearest(places, max_distance=NEAR)[1]
    return np.asarray(np.unique(row))


def _room(street: Street) -> tuple[FloatArray, FloatArray]:
    """(e,) where the two directions of edges part, and the width that lanes leave an island."""
    count = street.network.edge_count
    spans = [spans_of(street.bands, count, direction) for direction in (1, -1)]
    lanes = [lane_count(street.bands, count, direction) for direction in (1, -1)]
    both = (lanes[0] > 0) & (lanes[1] > 0)
    (low, high), (other_low, other_high) = [np.where(both, span, 0.0) for span in spans]
    forward_left = low + high > other_low + other_high
    middle = np.where(forward_left, low + other_high, high + other_low) / 2
    room = np.full(count, np.inf)
    for span, number in zip(((low, high), (other_low, other_high)), lanes, strict=True):
        outer = np.abs(np.stack(span) - middle).max(axis=0)
        room = np.minimum(room, outer - number * LANE_LEFT)
    return middle, np.where(both, np.minimum(2 * room, WIDEST_ISLAND), 0.0)


def _capsules(
    street: Street, edge: IntArray, along: FloatArray, lateral: FloatArray, reach: float,
    half: FloatArray,
) -> NDArray[Any]:  # fmt: skip
    """Shapes with round ends, twice `reach` long and twice `half` wide, beside edges."""
    at, ahead = locate(street.lines, edge, along)
    left = np.column_stack([-ahead[:, 1], ahead[:, 0]])
    centre = at + left * lateral[:, None]
    step = ahead * (reach - half)[:, None]
    axis = shapely.linestrings(np.stack([centre - step, centre + step], axis=1))
    return np.asarray(shapely.buffer(axis, half, quad_segs=CHORDS))


def _median_ways(street: Street, zebras: Zebras, ribs: int) -> Regions:
    """Lower the median in line with crossings: ribs behind both kerbs, and paving between."""
    twins = twins_of(street.layout, street.network)
    rows, side, gap = _beside_medians(zebras, twins)
    if not len(rows):
        return Regions()
    near = street.network.half_width[zebras.edge[rows]] + KERB_WIDTH
    far = near + gap - 2 * KERB_WIDTH
    ribbed = np.minimum(RIBS, (far - near) / 2)
    parts = []
    for label, begin, end in (
        (ribs, near, near + ribbed),
        (LABEL["ramp"], near + ribbed, far - ribbed),
        (ribs, far - ribbed, far),
    ):
        shapes = patches(street, zebras, rows, side * begin, side * end)
        parts.append(regions(shapes[end - begin > FREE_SIDE], label, WAY_PRIORITY))
    return join_regions(parts)


def _beside_medians(zebras: Zebras, twins: Twins) -> tuple[IntArray, FloatArray, FloatArray]:
    """Rows of crossings with a median beside them, its side (1 left) and its width in metres."""
    edge = np.concatenate([twins.first, twins.second])
    side = twins.side.T.ravel()
    gap = np.concatenate([twins.gap, twins.gap])
    wide = gap > NARROW
    order = np.lexsort((gap[wide], edge[wide]))
    known, first = np.unique(edge[wide][order], return_index=True)
    at = np.minimum(np.searchsorted(known, zebras.edge), max(len(known) - 1, 0))
    rows = np.flatnonzero(known[at] == zebras.edge) if len(known) else np.zeros(0, np.int64)
    chosen = first[at[rows]] if len(rows) else rows
    return rows, side[wide][order][chosen], gap[wide][order][chosen]
