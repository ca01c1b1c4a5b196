"""Islands between the two directions of a street: refuges, splitters, ways through medians."""

from __future__ import annotations

from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.city.ground import KERB_WIDTH, LABEL
from cityx.geometry.arrays import BoolArray, FloatArray, IntArray
from cityx.geometry.polylines import locate, to_linestrings
from cityx.ground.arrangement import GRID, Regions, join_regions, regions
from cityx.places.painting import Ribs
from cityx.road.markings.marks import Street, lane_count, spans_of
from cityx.road.markings.zebras import Zebras
from cityx.road.network.medians import NARROW, Twins, twins_of
from cityx.road.surface.carriageway import joined_by
from cityx.road.surface.drops import FREE_SIDE, patches
from cityx.road.surface.roundabouts import ring_edges, ring_nodes

ISLAND_PRIORITY = 82  # above the carriageway and what is painted on it
LANE_LEFT = 2.5  # metres that each lane for cars keeps beside an island
SPLITTER = (1.5, 9.0)  # metres from the ring between which the island at an arm lies
SPLITTER_WIDTH = (1.8, 0.5)  # metres at the ring and at the far end
LEAST_SPLITTER = 0.8  # metres at the ring; a narrower one is no island
BESIDE_SPLIT = 0.4  # metres of an island between one-way halves of an arm to the lanes beside it
LEAST_SPLIT = 2.0  # square metres of such an island
LEAST_ISLAND, WIDEST_ISLAND = 1.2, 2.0  # metres; room for one person, and for a bicycle
ISLAND_END = 2.5  # metres of island on both sides of the crossing
NEAR = 15.0  # metres along the street from a mapped island to the crossing it belongs to
WAY_PRIORITY = 53  # above medians and kerbs, below dropped kerbs
CHORDS = 8  # per quarter circle of an island's end


def refuge_regions(street: Street, zebras: Zebras, ribs: Ribs) -> Regions:
    """Lay splitters at roundabouts, mapped refuges, and ways through medians.

    Parameters
    ----------
    street
        The network and what its marks share.
    zebras
        The crossings.
    ribs
        What blind people feel before crossings.
    """
    splitters = join_regions([_splitter_regions(street), _split_arms(street)])
    if not len(zebras.edge):
        return splitters
    return join_regions(
        [_islands(street, zebras, ribs), _median_ways(street, zebras, ribs), splitters]
    )


def _splitter_regions(street: Street) -> Regions:
    """Build the islands between the two directions of arms of roundabouts."""
    arm, end = np.nonzero(_splitter_arms(street))
    if not len(arm):
        return Regions()
    kerbed, inner = (_splitters(street, arm, end, inset) for inset in (0.0, KERB_WIDTH))
    return join_regions(
        [
            regions(kerbed, LABEL["kerb"], ISLAND_PRIORITY),
            regions(inner, LABEL["courtyard"], ISLAND_PRIORITY + 1),
        ]
    )


def _split_arms(street: Street) -> Regions:
    """Build the islands between the two one-way halves of arms that part before a roundabout."""
    layout, network = street.layout, street.network
    ring = ring_edges(layout, network)
    oneway = layout.roads["oneway"].to_numpy(bool)[network.edge_road]
    at_ring = ring_nodes(layout, network)[network.edge_nodes]
    arm = np.flatnonzero(oneway & ~ring & (at_ring.sum(axis=1) == 1))
    rows = np.concatenate([np.flatnonzero(ring), arm])
    if not len(arm):
        return Regions()
    lines = to_linestrings(street.lines)
    faces = shapely.get_parts(shapely.polygonize(lines[rows]))
    beside = shapely.STRtree(lines[arm]).query(faces, predicate="intersects")[0]
    # Two arms and the ring between them; the ring's own middle touches the arms at points alone.
    own = shapely.length(
        shapely.intersection(shapely.boundary(faces), shapely.union_all(lines[arm]))
    )
    faces = faces[(own > SPLITTER[1]) & (np.bincount(beside, minlength=len(faces)) >= 2)]
    face, edge = shapely.STRtree(lines).query(faces, predicate="intersects")
    driven = shapely.buffer(lines[edge], network.half_width[edge] + BESIDE_SPLIT)
    taken, group = joined_by(driven, face)
    free = shapely.difference(faces[group], taken)
    whole = shapely.buffer(shapely.buffer(free, -LEAST_SPLITTER / 2), LEAST_SPLITTER / 2 - GRID)
    parts = shapely.get_parts(whole)
    parts = parts[shapely.area(parts) > LEAST_SPLIT]
    inner = shapely.buffer(parts, -KERB_WIDTH)
    return join_regions(
        [
            regions(parts, LABEL["kerb"], ISLAND_PRIORITY),
            regions(inner, LABEL["courtyard"], ISLAND_PRIORITY + 1),
        ]
    )


def _splitter_arms(street: Street) -> BoolArray:
    """(e, 2) ends of two-way edges at a ring that are wide and long enough for an island."""
    layout, network = street.layout, street.network
    ring = ring_edges(layout, network)
    at_ring = ring_nodes(layout, network)[network.edge_nodes] & ~ring[:, None]
    free = street.length - network.trim.sum(axis=1)
    room = (free > SPLITTER[1] + 2.0) & (_room(street)[1] > LEAST_SPLITTER)
    return np.asarray(at_ring & room[:, None])


def _splitters(street: Street, edge: IntArray, end: IntArray, inset: float) -> NDArray[Any]:
    """Long islands between the two directions of arms, broad towards the ring."""
    length, trim = street.length[edge], street.network.trim[edge, end]
    middle, room = (of_edge[edge] for of_edge in _room(street))
    near = np.minimum(trim, SPLITTER[0] + 1.0) + inset
    corners = []
    for along, width, sides in (
        (near, SPLITTER_WIDTH[0], (-1, 1)),
        (trim + SPLITTER[1] - inset, SPLITTER_WIDTH[1], (1, -1)),
    ):
        at, ahead = locate(street.lines, edge, np.where(end == 0, along, length - along))
        left = np.column_stack([-ahead[:, 1], ahead[:, 0]])
        wide = np.maximum(np.minimum(width, room) / 2 - inset, 0.05)
        corners += [at + left * (middle + side * wide)[:, None] for side in sides]
    return np.asarray(shapely.polygons(np.stack(corners, axis=1)))


def _islands(street: Street, zebras: Zebras, ribs: Ribs) -> Regions:
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
        regions(floor, LABEL[ribs.painted], ISLAND_PRIORITY),
        regions(stones, LABEL["kerb"], ISLAND_PRIORITY + 1),
        regions(shapely.buffer(stones, -KERB_WIDTH), LABEL["courtyard"], ISLAND_PRIORITY + 2),
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


def _median_ways(street: Street, zebras: Zebras, ribs: Ribs) -> Regions:
    """Lower the median in line with crossings: ribs behind both kerbs, and paving between."""
    twins = twins_of(street.layout, street.network)
    rows, side, gap = _beside_medians(zebras, twins)
    if not len(rows):
        return Regions()
    near = street.network.half_width[zebras.edge[rows]] + KERB_WIDTH
    far = near + gap - 2 * KERB_WIDTH
    ribbed = np.minimum(ribs.depth, (far - near) / 2)
    parts = []
    for label, begin, end in (
        (LABEL[ribs.painted], near, near + ribbed),
        (LABEL["ramp"], near + ribbed, far - ribbed),
        (LABEL[ribs.painted], far - ribbed, far),
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
