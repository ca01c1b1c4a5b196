"""Road markings as thin regions of the ground, so that they drape and never flicker."""

from __future__ import annotations

from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.city.ground import LABEL, SURFACES
from cityx.city.layout import Layout
from cityx.city.roads import RoadNetwork
from cityx.city.section import CARRIAGEWAY, KIND, TRAVELLED
from cityx.geometry.arrangement import Regions, regions
from cityx.geometry.polylines import (
    Polylines,
    arc_lengths,
    every,
    line_strips,
    locate,
    pieces,
    to_linestrings,
)
from cityx.plugins.road.carriageway import Carriageway
from cityx.plugins.road.sections import Bands
from cityx.plugins.road.symbols import LENGTH, arrow, bicycle, bus, placed

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]
Shapes = NDArray[Any]
Marks = tuple[Shapes, IntArray]  # polygons and the edge each lies on

LINE = 0.12  # metres, width of a longitudinal line
STOP = 0.4  # metres, width of a stop line
BAR = 0.5  # metres, width of a zebra bar and of the gap after it
ZEBRA = 3.0  # metres along the road
BAY = 5.5  # metres, length of a parking bay
WIDE = 7.0  # metres; a narrower residential street has lines only if the map tells its lanes
EVERY = 60.0  # metres between symbols on a bus or cycle lane
LEAST_SYMBOL = 1.2  # metres of a lane with a symbol
EDGE_INSET = 0.35  # metres from the carriageway's edge to its edge line
LONG_DASH = ("motorway", "trunk", "motorway_link", "trunk_link")
UNMARKED = ("service", "track", "living_street", "busway", "road", "raceway")
_KERBED = [KIND[name] for name in CARRIAGEWAY]
_MOVING = [KIND[name] for name in TRAVELLED]
_FOR_CARS = [KIND[name] for name in ("drive", "bus")]
_UNLINED = [KIND["parking"]]
RANK = (
    "motorway", "trunk", "primary", "secondary", "tertiary", "unclassified", "residential",
)  # fmt: skip


def marking_regions(
    layout: Layout,
    network: RoadNetwork,
    bands: Bands,
    on_ground: NDArray[np.bool_],
    road: Carriageway,
) -> Regions:
    """Paint lane lines, stop lines, zebra crossings and parking bays; none inside junctions."""
    lines = Polylines(network.points, network.point_start)
    table = layout.roads.iloc[network.edge_road]
    length = arc_lengths(lines)[1]
    kind = table["kind"].to_numpy().astype(str)
    painted = on_ground & (length - network.trim.sum(axis=1) > 4.0)
    painted &= np.isin(
        table["surface"].to_numpy().astype(str), ("asphalt", "concrete", "paved", "")
    )
    urban = painted & ~np.isin(kind, UNMARKED)
    tags = table["tags"].str
    known = tags.contains('"lanes', regex=False).to_numpy().astype(bool)
    known |= table["section"].to_numpy() != ""
    quiet = (kind == "residential") & ~known & (network.half_width * 2 < WIDE)
    bays = tags.contains('"parking', regex=False).to_numpy().astype(bool) | (kind != "residential")
    walked = (table["sidewalk_left"].to_numpy() + table["sidewalk_right"].to_numpy()) > 0
    shapes = [
        _lane_lines(network, lines, urban & ~quiet, kind, walked, bands),
        _edge_lines(network, lines, urban & np.isin(kind, LONG_DASH), bands),
        _stop_lines(network, lines, urban, kind, bands),
        _symbols(network, lines, urban, bands),
        _zebras(layout, network, lines, painted),
        _parking_bays(network, lines, painted & bays, bands),
    ]
    marks = np.concatenate([shape for shape, _ in shapes])
    edge = np.concatenate([edge for _, edge in shapes]).astype(np.int64)
    marks = marks[_clear(marks, edge, layout, network, road)]
    return regions(marks, LABEL["marking"], SURFACES[LABEL["marking"]].priority)


def _free(network: RoadNetwork, length: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Begin and end of the part of each edge that carries longitudinal lines."""
    room = np.where(network.crossing, ZEBRA + 2.2, np.where(network.trim > 0, 1.0, 0.0))
    return network.trim[:, 0] + room[:, 0], length - network.trim[:, 1] - room[:, 1]


def _lane_lines(
    network: RoadNetwork,
    lines: Polylines,
    chosen: NDArray[np.bool_],
    kind: NDArray[np.str_],
    walked: NDArray[np.bool_],
    bands: Bands,
) -> Marks:
    """Paint what parts two bands: dashes between lanes of cars, an unbroken line where none cross.

    Unbroken are the middle of roads with four lanes and more, and the sides of bus lanes, cycle
    lanes, shoulders and medians. Parked cars have no line of their own.
    """
    begin, end = _free(network, arc_lengths(lines)[1])
    inside = np.flatnonzero(np.isin(bands.kind, _KERBED))
    first, second = inside[:-1], inside[1:]
    edge = bands.edge[first]
    beside = edge == bands.edge[second]
    codes = bands.kind[first], bands.kind[second]
    beside &= ~(np.isin(codes[0], _UNLINED) | np.isin(codes[1], _UNLINED))
    beside &= chosen[edge] & ((end - begin)[edge] > 3.0)
    first, second, edge = first[beside], second[beside], edge[beside]
    lateral = bands.right[first]
    cars = np.isin(bands.kind, _FOR_CARS)
    lanes = np.bincount(bands.edge[cars], minlength=len(chosen))
    centre = bands.direction[first] * bands.direction[second] < 0
    bus = (bands.kind[first] == KIND["bus"]) != (bands.kind[second] == KIND["bus"])
    mixed = (bands.kind[first] != KIND["drive"]) | (bands.kind[second] != KIND["drive"])
    solid = (centre & (lanes[edge] >= 4)) | mixed
    gap = np.where(np.isin(kind[edge], LONG_DASH) | ~walked[edge], 9.0, 3.0)
    shapes, edges = [], []
    for wide in (False, True):
        rows = np.flatnonzero(solid & (bus == wide))
        at = edge[rows]
        whole = pieces(lines, at, begin[at], end[at])
        shapes.append(line_strips(whole, lateral[rows], LINE * (1 + wide)))
        edges.append(at)
    for space in (3.0, 9.0):
        rows = np.flatnonzero(~solid & (gap == space))
        which, along = every((end - begin)[edge[rows]], 3.0 + space, 1.6)
        at = edge[rows][which]
        middle = begin[at] + along
        dashes = pieces(lines, at, middle - 1.5, middle + 1.5)
        shapes.append(line_strips(dashes, lateral[rows][which], LINE))
        edges.append(at)
    return np.concatenate(shapes), np.concatenate(edges)


def _edge_lines(
    network: RoadNetwork, lines: Polylines, chosen: NDArray[np.bool_], bands: Bands
) -> Marks:
    """Paint lines along the sides of fast roads; a shoulder has its line where it meets a lane."""
    begin, end = _free(network, arc_lengths(lines)[1])
    usual = chosen & (end - begin > 3.0) & (network.half_width > 2.0)
    shouldered = bands.kind == KIND["shoulder"]
    shapes, edges = [], []
    for sign in (1, -1):
        with_shoulder = np.zeros(len(chosen), bool)
        with_shoulder[bands.edge[shouldered & (sign * bands.middle > 0)]] = True
        edge = np.flatnonzero(usual & ~with_shoulder)
        solid = pieces(lines, edge, begin[edge], end[edge])
        lateral = sign * (network.half_width[edge] - EDGE_INSET)
        shapes.append(line_strips(solid, lateral, LINE))
        edges.append(edge)
    return np.concatenate(shapes), np.concatenate(edges)


def _stop_lines(
    network: RoadNetwork,
    lines: Polylines,
    chosen: NDArray[np.bool_],
    kind: NDArray[np.str_],
    bands: Bands,
) -> Marks:
    """Lines where traffic that arrives gives way: at crossings and at the mouths of minor roads."""
    length = arc_lengths(lines)[1]
    rank = np.full(len(kind), len(RANK))
    for value, word in enumerate(RANK):
        rank[np.char.startswith(kind, word)] = value
    best = np.full(len(network.node_position), len(RANK))
    np.minimum.at(best, network.edge_nodes, rank[:, None] * np.ones(2, int))
    shapes = []
    for end in (0, 1):
        node = network.edge_nodes[:, end]
        minor = (rank > best[node]) & (best[node] <= 4)
        stops = chosen & (network.node_degree[node] >= 3) & (minor | network.crossing[:, end])
        # Only where lanes arrive at this end: not at the start of a one-way street.
        low, high = _spans(bands, len(chosen), 1 if end == 1 else -1)
        edge = np.flatnonzero(stops & (high > low))
        low, high = low[edge], high[edge]
        back = np.where(network.crossing[edge, end], ZEBRA + 1.5, 0.5) + STOP / 2
        back += network.trim[edge, end]
        along = back if end == 0 else length[edge] - back
        shapes.append(_boxes(lines, edge, along, (low + high) / 2, STOP, high - low - 0.3))
    return _together(shapes)


def _spans(bands: Bands, count: int, direction: int) -> tuple[FloatArray, FloatArray]:
    """(e,) lateral bounds of the lanes of one direction; empty where there are none."""
    rows = np.flatnonzero(np.isin(bands.kind, _MOVING) & (bands.direction == direction))
    low, high = np.full(count, np.inf), np.full(count, -np.inf)
    np.minimum.at(low, bands.edge[rows], bands.right[rows])
    np.maximum.at(high, bands.edge[rows], bands.left[rows])
    return low, high


def _symbols(
    network: RoadNetwork, lines: Polylines, chosen: NDArray[np.bool_], bands: Bands
) -> Marks:
    """Paint arrows before junctions, and what bus and cycle lanes are for behind them."""
    length = arc_lengths(lines)[1]
    begin, end = _free(network, length)
    lanes = np.flatnonzero(np.isin(bands.kind, _MOVING) & (bands.direction != 0))
    lanes = lanes[chosen[bands.edge[lanes]] & (bands.width[lanes] > LEAST_SYMBOL)]
    edge = bands.edge[lanes]
    ahead = bands.direction[lanes] > 0
    room = (end - begin)[edge]
    shapes, edges = [], []

    def paint(outline: Any, rows: IntArray, along: FloatArray) -> None:
        """Put an outline `along` metres into the free part of lanes, in their direction."""
        own = edge[rows]
        place = np.where(ahead[rows], begin[own] + along, end[own] - along)
        position, direction = locate(lines, own, place)
        sign = np.where(ahead[rows], 1.0, -1.0)
        lateral = bands.middle[lanes[rows]] * sign
        made = placed(outline, position, direction * sign[:, None], lateral)
        shapes.append(made)
        edges.append(np.repeat(own, len(made) // max(len(own), 1)))

    turns = bands.turns[lanes]
    at_node = np.where(ahead, network.edge_nodes[edge, 1], network.edge_nodes[edge, 0])
    junction = network.node_degree[at_node] >= 3
    for bits in np.unique(turns[turns > 0]).tolist():
        for back in (STOP + 1.5 + LENGTH, STOP + 21.5 + LENGTH):
            rows = np.flatnonzero((turns == bits) & junction & (room > back + 2.0))
            paint(arrow(int(bits)), rows, room[rows] - back)
    kind = bands.kind[lanes]
    for name, outline in (("bus", bus()), ("cycle", bicycle())):
        rows = np.flatnonzero(kind == KIND[name])
        which, along = every(room[rows], EVERY, 6.0)
        paint(outline, rows[which], along)
    if not shapes:
        return np.zeros(0, object), np.zeros(0, np.int64)
    return np.concatenate(shapes), np.concatenate(edges).astype(np.int64)


def _zebras(
    layout: Layout, network: RoadNetwork, lines: Polylines, chosen: NDArray[np.bool_]
) -> Marks:
    length = arc_lengths(lines)[1]
    edge, end = np.nonzero(network.crossing & chosen[:, None])
    back = network.trim[edge, end] + 0.5 + ZEBRA / 2
    along = np.where(end == 0, back, length[edge] - back)
    more, there = _mapped_crossings(layout, network, lines, chosen)
    edge, along = np.concatenate([edge, more]), np.concatenate([along, there])
    width = 2 * network.half_width[edge] - BAR
    which, lateral = every(width, 2 * BAR, BAR / 2)
    lateral = lateral - width[which] / 2
    size = np.full(len(which), BAR)
    return _boxes(lines, edge[which], along[which], lateral, ZEBRA, size)


def _mapped_crossings(
    layout: Layout, network: RoadNetwork, lines: Polylines, chosen: NDArray[np.bool_]
) -> tuple[IntArray, FloatArray]:
    """Crossings of the map between junctions: edge and distance from its start."""
    points = layout.points
    mapped = points[(points["kind"] == "crossing").to_numpy()]
    unmarked = mapped["tags"].str.contains("unmarked", regex=False).to_numpy().astype(bool)
    places = mapped.geometry.to_numpy()[~unmarked]
    edges = np.flatnonzero(chosen)
    if not len(places) or not len(edges):
        return np.zeros(0, np.int64), np.zeros(0)
    shapes = to_linestrings(lines)[edges]
    point, row = shapely.STRtree(shapes).query_nearest(places, max_distance=1.0, all_matches=False)
    along = shapely.line_locate_point(shapes[row], places[point])
    edge = edges[row]
    begin, end = _free(network, arc_lengths(lines)[1])
    clear = (along > begin[edge] + ZEBRA) & (along < end[edge] - ZEBRA)
    edge, along = edge[clear], along[clear]
    order = np.lexsort((along, edge))
    edge, along = edge[order], along[order]
    # Crossings mapped once per lane or island are one crossing.
    apart = np.r_[True, (edge[1:] != edge[:-1]) | (np.diff(along) > 2 * ZEBRA)][: len(edge)]
    return edge[apart], along[apart]


def _parking_bays(
    network: RoadNetwork, lines: Polylines, chosen: NDArray[np.bool_], bands: Bands
) -> Marks:
    begin, end = _free(network, arc_lengths(lines)[1])
    rows = np.flatnonzero((bands.kind == KIND["parking"]) & chosen[bands.edge])
    which, along = every((end - begin)[bands.edge[rows]], BAY, 4.0)
    rows = rows[which]
    edge = bands.edge[rows]
    return _boxes(lines, edge, begin[edge] + along, bands.middle[rows], LINE,
                  bands.width[rows] - 0.1)  # fmt: skip


def _together(marks: list[Marks]) -> Marks:
    return np.concatenate([mark for mark, _ in marks]), np.concatenate([edge for _, edge in marks])


def _boxes(
    lines: Polylines,
    edge: IntArray,
    along: FloatArray,
    lateral: FloatArray,
    length: float,
    width: FloatArray,
) -> Marks:
    """Rectangles in the frame of their edge, `length` along it and `width` across."""
    keep = width > 0.1
    edge, along, lateral, width = edge[keep], along[keep], lateral[keep], width[keep]
    if not len(edge):
        return np.zeros(0, object), edge
    position, direction = locate(lines, edge, along)
    across = np.column_stack([-direction[:, 1], direction[:, 0]])
    centre = position + across * lateral[:, None]
    u, v = direction * (length / 2), across * (width / 2)[:, None]
    corners = np.stack([centre - u - v, centre + u - v, centre + u + v, centre - u + v], axis=1)
    return np.asarray(shapely.polygons(corners)), edge


def _clear(marks: Shapes, edge: IntArray, layout: Layout, network: RoadNetwork,
           road: Carriageway) -> NDArray[np.bool_]:  # fmt: skip
    """Mark what lies in no junction, on no other road and in no building."""
    clear = np.ones(len(marks), bool)
    parts = layout.parts
    low = (parts["base"].to_numpy() < 0.5) & parts["walls"].to_numpy()
    for obstacles in (road.stars, parts.geometry.to_numpy()[low]):
        clear[shapely.STRtree(obstacles).query(marks, predicate="intersects")[0]] = False
    mark, strip = shapely.STRtree(road.strips).query(marks, predicate="intersects")
    own, other = network.edge_nodes[edge[mark]], network.edge_nodes[road.edge[strip]]
    # Neighbours along the road touch; anything else that overlaps takes the mark's meaning away.
    joined = (own[:, :, None] == other[:, None, :]).any(axis=(1, 2))
    clear[mark[~joined]] = False
    return clear
