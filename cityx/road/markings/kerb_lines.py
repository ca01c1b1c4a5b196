"""No-parking lines: yellow lines along kerbs, and round the kerb return of junctions."""

from __future__ import annotations

import numpy as np
import shapely

from cityx.city.section import KIND
from cityx.geometry.polylines import arc_lengths, line_strips, pack, pieces
from cityx.geometry.ranges import numbered
from cityx.road.markings.marks import (
    QUIET,
    BoolArray,
    FloatArray,
    IntArray,
    Marks,
    Shapes,
    Street,
    together,
)
from cityx.road.surface.carriageway import Carriageway, joined_by, widened
from cityx.road.surface.roundabouts import ring_nodes

WIDTH = 0.1  # metres (TSRGD 2016, diagrams 1017 and 1018.1)
FROM_KERB = (0.25, 0.45)  # metres from the kerb to the middles of the two lines
SINGLE = ("residential", "unclassified", "living_street")  # may be waited in at night
NARROW = 6.5  # metres; on a narrower street a parked car is in the way at any time
STEP = 12.0  # metres of one mark, so that what crosses one leaves the others
LEAST = 1.0  # metres
OFF = 1.0  # metres from junctions and zebras
PIECE, LEAST_PIECE = 3.0, 0.25  # metres of one mark round a corner
BEYOND = 6.0  # metres of its arms that a junction is looked at with
_FORBIDDEN = '"parking:(?:left|right|both)(?::restriction)?": *"no'


def kerb_lines(street: Street, chosen: BoolArray) -> Marks:
    """Paint one or two lines along both kerbs of the chosen edges, but beside parked cars.

    Two stand for no waiting at any time: on classified roads, on narrow streets, and where the map
    forbids parking.
    """
    bands = street.bands
    double = _double(street)
    parked = bands.kind == KIND["parking"]
    found = []
    for sign in (1.0, -1.0):
        free = chosen.copy()
        free[bands.edge[parked & (sign * bands.middle > 0)]] = False
        for number, gap in enumerate(FROM_KERB):
            edge = np.flatnonzero(free & (double if number else True))
            found.append(_along(street, edge, sign, gap))
    return together(found)


def corner_lines(street: Street, chosen: BoolArray, road: Carriageway) -> Marks:
    """Continue lines along kerbs round the corners of junctions whose streets are all chosen.

    They are two where any of the arms has two.
    """
    network = street.network
    cluster = street.cluster
    ends = cluster[network.edge_nodes]
    other = ~chosen & ~np.isin(street.kind, QUIET)
    none = np.bincount(ends[other].ravel(), minlength=len(cluster)) == 0
    none &= np.bincount(cluster[ring_nodes(street.layout, network)], minlength=len(cluster)) == 0
    star = np.flatnonzero(none[road.node])
    edge, end = np.nonzero(np.isin(ends, road.node[star]) & (ends[:, :1] != ends[:, 1:]))
    if not len(edge):
        return np.zeros(0, object), np.zeros(0, np.int64)
    hub = ends[edge, end]
    short, long = (_arms(street, edge, end, beyond) for beyond in (OFF, BEYOND))
    bent = np.isin(road.curve_node, road.node[star])
    inner = np.concatenate([road.stars[star], road.curves[bent]])
    node = np.concatenate([road.node[star], road.curve_node[bent]])
    zones, hubs = joined_by(np.concatenate([inner, short]), np.concatenate([node, hub]))
    whole, _ = joined_by(np.concatenate([inner, long]), np.concatenate([node, hub]))
    double = np.zeros(len(cluster), bool)
    double[hub[_double(street)[edge]]] = True
    first = np.zeros(len(cluster), np.int64)
    first[hub[::-1]] = edge[::-1]
    surface, _ = joined_by(inner, node)
    found = []
    for number, gap in enumerate(FROM_KERB):
        rows = np.flatnonzero(double[hubs]) if number else np.arange(len(hubs))
        # One line each: what lies at that distance from the kerbs of the junction and its arms.
        rims = shapely.boundary(shapely.buffer(whole[rows], -gap, quad_segs=16))
        rims = shapely.line_merge(shapely.intersection(rims, zones[rows]))
        parts, row = shapely.get_parts(rims, return_index=True)
        line = shapely.get_type_id(parts) == 1
        marks, of = _cut(parts[line])
        at = rows[row[line]][of]
        # None lies on the junction and on an arm at once, so that each stays one surface.
        halves = (shapely.intersection(marks, surface[at]), shapely.difference(marks, surface[at]))
        for cut in halves:
            kept = shapely.area(cut) > LEAST_PIECE * WIDTH
            found.append((cut[kept], first[hubs[at[kept]]]))
    return together(found)


def _arms(street: Street, edge: IntArray, end: IntArray, beyond: float) -> Shapes:
    """Carriageways of arms from their nodes to `beyond` metres behind the junction."""
    far = np.minimum(street.network.trim[edge, end] + beyond, street.length[edge])
    begin = np.where(end == 0, 0.0, street.length[edge] - far)
    return widened(pieces(street.lines, edge, begin, begin + far), street.network.half_width[edge])


def _cut(lines: Shapes) -> tuple[Shapes, IntArray]:
    """Paint lines in pieces, so that what crosses one leaves the others; also the line of each."""
    whole = pack(lines)
    length = arc_lengths(whole)[1]
    owner, begin, end = _parts(np.zeros(len(length)), length, PIECE)
    strips = line_strips(pieces(whole, owner, begin, end), np.zeros(len(owner)), WIDTH)
    valid = shapely.is_valid(strips)
    return strips[valid], owner[valid]


def _parts(
    begin: FloatArray, end: FloatArray, longest: float
) -> tuple[IntArray, FloatArray, FloatArray]:
    """Cut spans into equal parts: the span of each part, and its bounds."""
    count = np.ceil((end - begin) / longest).astype(np.int64)
    span = np.repeat(np.arange(len(count)), count)
    number = numbered(count)
    step = (end - begin)[span] / count[span]
    low = begin[span] + number * step
    return span, low, low + step


def _double(street: Street) -> BoolArray:
    """(e,) whether nobody may wait at any time."""
    network = street.network
    table = street.layout.roads.iloc[network.edge_road]
    forbidden = table["tags"].str.contains(_FORBIDDEN, regex=True).to_numpy().astype(bool)
    narrow = 2 * network.half_width < NARROW
    return np.asarray(~np.isin(street.kind, SINGLE) | narrow | forbidden)


def _along(street: Street, edge: IntArray, sign: float, gap: float) -> Marks:
    """Lines beside one kerb, from junction to junction but for zebras, in short pieces."""
    network = street.network
    open_ = np.where(
        street.marked, np.maximum(street.setback + street.depth[:, None], 0) + OFF, OFF
    )
    open_ += network.trim
    begin, end = open_[edge, 0], street.length[edge] - open_[edge, 1]
    row, low, high = _parts(begin, np.where(end - begin > LEAST, end, begin), STEP)
    cut = pieces(street.lines, edge[row], low, high)
    lateral = sign * (network.half_width[edge[row]] - gap)
    return line_strips(cut, lateral, WIDTH), edge[row]
