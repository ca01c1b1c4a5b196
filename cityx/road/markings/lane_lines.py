"""Lines along streets: dashes between lanes of cars, unbroken lines, no-parking lines at kerbs."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely

from cityx.city.section import CARRIAGEWAY, KIND
from cityx.geometry.arrays import BoolArray, FloatArray, IntArray
from cityx.geometry.polylines import Polylines, arc_lengths, every, line_strips, pack, pieces
from cityx.geometry.ranges import numbered
from cityx.road.markings.crossing_places import MAIN
from cityx.road.markings.marks import LINE, QUIET, Marks, Shapes, Street, together
from cityx.road.surface.carriageway import Carriageway, joined_by, widened
from cityx.road.surface.roundabouts import ring_nodes

SOLID = 25.0  # metres before a junction along which no line between lanes may be crossed
LEAST_SOLID = 6.0  # metres; shorter ones say nothing
DASHED = 12.0  # metres between the unbroken ends of a line that stay broken
FAR_DASHES = (3.0, 9.0)  # metres of dash and gap outside towns
LONG_DASH = ("motorway", "trunk", "motorway_link", "trunk_link")
JUNCTION_LINES = (*MAIN, "unclassified")
_KERBED = [KIND[name] for name in CARRIAGEWAY]
_FOR_CARS = [KIND[name] for name in ("drive", "bus")]
_UNLINED = [KIND["parking"]]
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


@dataclass(frozen=True)
class Partings:
    """Where two bands of an edge meet at a line, p of them. Parked cars have none of their own.

    Attributes
    ----------
    edge
        (p,) int64.
    lateral
        (p,) float, metres to the left of the centreline.
    direction
        (p,) int64, of the band on the left.
    centre
        (p,) bool, whether the line parts the two directions.
    bus
        (p,) bool, whether one of the two is a lane for buses.
    cycle
        (p,) bool, whether one of the two is a lane for bicycles.
    mixed
        (p,) bool, whether the two are anything but two lanes for cars.
    dash, gap
        (p,) float, metres of its dashes, and between them.
    """

    edge: IntArray
    lateral: FloatArray
    direction: IntArray
    centre: BoolArray
    bus: BoolArray
    cycle: BoolArray
    mixed: BoolArray
    dash: FloatArray
    gap: FloatArray


def partings_of(
    street: Street, chosen: BoolArray, kerbed: BoolArray, dashes: tuple[float, float] = (3.0, 3.0)
) -> Partings:
    """Find what parts the bands of the chosen edges.

    The lines have `dashes`, metres of dash and gap, between kerbs, and longer gaps elsewhere.
    """
    bands = street.bands
    begin, end = street.free
    inside = np.flatnonzero(np.isin(bands.kind, _KERBED))
    first, second = inside[:-1], inside[1:]
    edge = bands.edge[first]
    beside = edge == bands.edge[second]
    beside &= ~np.isin(bands.kind[first], _UNLINED) & ~np.isin(bands.kind[second], _UNLINED)
    beside &= chosen[edge] & ((end - begin)[edge] > 3.0)
    first, second, edge = first[beside], second[beside], edge[beside]
    kinds = bands.kind[first], bands.kind[second]
    drive, bus, cycle = KIND["drive"], KIND["bus"], KIND["cycle"]
    far = np.isin(street.kind[edge], LONG_DASH) | ~kerbed[edge]
    return Partings(
        edge,
        bands.right[first],
        bands.direction[first].astype(np.int64),
        bands.direction[first] * bands.direction[second] < 0,
        (kinds[0] == bus) != (kinds[1] == bus),
        (kinds[0] == cycle) != (kinds[1] == cycle),
        (kinds[0] != drive) | (kinds[1] != drive),
        *(np.where(far, other, own) for other, own in zip(FAR_DASHES, dashes, strict=True)),
    )


def lane_lines(street: Street, found: Partings, *, closing: bool = True) -> tuple[Marks, BoolArray]:
    """Paint what parts two bands.

    Unbroken are the middle of roads with four lanes and more, the sides of bus lanes, cycle lanes,
    shoulders and medians, and where `closing` all lines just before a junction. Also returns which
    marks part the two directions.
    """
    lines, bands, edge = street.lines, street.bands, found.edge
    begin, end = street.free
    cars = np.isin(bands.kind, _FOR_CARS)
    lanes = np.bincount(bands.edge[cars], minlength=len(begin))
    solid = (found.centre & (lanes[edge] >= 4)) | found.mixed
    shapes, edges, middle = [], [], []

    def paint(rows: IntArray, cut: Polylines, width: float) -> None:
        shapes.append(line_strips(cut, found.lateral[rows], width))
        edges.append(edge[rows])
        middle.append(found.centre[rows])

    for wide in (False, True):
        rows = np.flatnonzero(solid & (found.bus == wide))
        at = edge[rows]
        paint(rows, pieces(lines, at, begin[at], end[at]), LINE * (1 + wide))
    low, high = begin[edge].copy(), end[edge].copy()
    for side, rows in enumerate(_closing(street, found, solid) if closing else ()):
        at = edge[rows]
        size = _solid_length(end[at] - begin[at])
        if side == 0:
            low[rows] += size
            paint(rows, pieces(lines, at, begin[at], low[rows]), LINE)
        else:
            high[rows] -= size
            paint(rows, pieces(lines, at, high[rows], end[at]), LINE)
    for dash, gap in np.unique(np.column_stack([found.dash, found.gap]), axis=0).tolist():
        rows = np.flatnonzero(~solid & (found.dash == dash) & (found.gap == gap))
        which, along = every((high - low)[rows], dash + gap, dash / 2 + 0.1)
        rows = rows[which]
        middles = low[rows] + along
        cut = pieces(lines, edge[rows], middles - dash / 2, middles + dash / 2)
        paint(rows, cut, LINE)
    return (np.concatenate(shapes), np.concatenate(edges)), np.concatenate(middle)


def _closing(street: Street, found: Partings, solid: BoolArray) -> list[IntArray]:
    """Broken lines that are unbroken before the junction at the start, and at the end of an edge.

    Lines between lanes of one direction are so only where their traffic arrives.
    """
    network, edge = street.network, found.edge
    begin, end = street.free
    junction = street.joint[network.edge_nodes] & (network.trim > 0)
    ruled = np.isin(street.kind, JUNCTION_LINES)[:, None] | street.signalled[network.edge_nodes]
    closed = junction & ruled & (_solid_length(end - begin) >= LEAST_SOLID)[:, None]
    return [
        np.flatnonzero(~solid & closed[edge, side] & (found.centre | (found.direction == arriving)))
        for side, arriving in ((0, -1), (1, 1))
    ]


def _solid_length(room: FloatArray) -> FloatArray:
    """Metres of unbroken line at each end of a free part, which leave dashes between them."""
    return np.asarray(np.minimum(SOLID, (room - DASHED) / 2))


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
