"""Road markings as thin regions of the ground, so that they drape and never flicker."""

from __future__ import annotations

from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.city.ground import LABEL, SURFACES
from cityx.city.layout import Layout
from cityx.city.roads import RoadNetwork
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

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]
Shapes = NDArray[Any]
Marks = tuple[Shapes, IntArray]  # polygons and the edge each lies on

LINE = 0.12  # metres, width of a longitudinal line
STOP = 0.4  # metres, width of a stop line
BAR = 0.5  # metres, width of a zebra bar and of the gap after it
ZEBRA = 3.0  # metres along the road
PARKING = 2.1  # metres, width of a parking lane
BAY = 5.5  # metres, length of a parking bay
WIDE = 7.0  # metres; a narrower residential street has lines only if the map tells its lanes
TWO_LANES = 5.5  # metres; narrower two-way streets have no centre line
NARROWEST_LANE = 2.4  # metres
EDGE_INSET = 0.35  # metres from the carriageway's edge to its edge line
LONG_DASH = ("motorway", "trunk", "motorway_link", "trunk_link")
UNMARKED = ("service", "track", "living_street", "busway", "road", "raceway")
RANK = (
    "motorway", "trunk", "primary", "secondary", "tertiary", "unclassified", "residential",
)  # fmt: skip


def marking_regions(
    layout: Layout, network: RoadNetwork, on_ground: NDArray[np.bool_], road: Carriageway
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
    section = _Section(network, table)
    tags = table["tags"].str
    known = tags.contains('"lanes', regex=False).to_numpy().astype(bool)
    quiet = (kind == "residential") & ~known & (network.half_width * 2 < WIDE)
    bays = tags.contains('"parking', regex=False).to_numpy().astype(bool) | (kind != "residential")
    shapes = [
        _lane_lines(network, lines, urban & ~quiet, kind, section),
        _edge_lines(network, lines, urban & np.isin(kind, LONG_DASH)),
        _stop_lines(network, lines, urban, kind, section),
        _zebras(layout, network, lines, painted),
        _parking_bays(network, lines, painted & bays, table),
    ]
    marks = np.concatenate([shape for shape, _ in shapes])
    edge = np.concatenate([edge for _, edge in shapes]).astype(np.int64)
    marks = marks[_clear(marks, edge, layout, network, road)]
    return regions(marks, LABEL["marking"], SURFACES[LABEL["marking"]].priority)


class _Section:
    """Lanes across each edge: their number and where the first begins, seen along the edge."""

    def __init__(self, network: RoadNetwork, table: Any) -> None:
        half = network.half_width
        left = PARKING * table["parking_left"].to_numpy()
        right = PARKING * table["parking_right"].to_numpy()
        narrow = 2 * half - left - right < 2.5
        left, right = np.where(narrow, 0, left), np.where(narrow, 0, right)
        self.right_edge = -half + right  # lateral position, left positive
        self.width = 2 * half - left - right
        tagged = np.maximum(table["lanes"].to_numpy().astype(int), 1)
        oneway = table["oneway"].to_numpy()
        two_way = ~oneway & (2 * half >= TWO_LANES) & (self.width >= 2 * NARROWEST_LANE)
        wanted = np.where(two_way, np.maximum(tagged, 2), tagged)
        self.lanes = np.clip(wanted, 1, np.maximum(self.width // NARROWEST_LANE, 1)).astype(int)
        share = table["lanes_forward"].to_numpy() / tagged
        forward = np.clip(np.rint(self.lanes * share), 1, np.maximum(self.lanes - 1, 1))
        self.forward = np.where(oneway, self.lanes, forward).astype(int)
        self.oneway = oneway
        walk = table["sidewalk_left"].to_numpy() + table["sidewalk_right"].to_numpy()
        self.walked = walk > 0


def _free(network: RoadNetwork, length: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Begin and end of the part of each edge that carries longitudinal lines."""
    room = np.where(network.crossing, ZEBRA + 2.2, np.where(network.trim > 0, 1.0, 0.0))
    return network.trim[:, 0] + room[:, 0], length - network.trim[:, 1] - room[:, 1]


def _lane_lines(
    network: RoadNetwork,
    lines: Polylines,
    chosen: NDArray[np.bool_],
    kind: NDArray[np.str_],
    section: _Section,
) -> Marks:
    begin, end = _free(network, arc_lengths(lines)[1])
    dividers = np.where(chosen & (end - begin > 3.0), section.lanes - 1, 0)
    edge = np.repeat(np.arange(len(chosen)), dividers)
    number = np.arange(len(edge)) - np.repeat(np.cumsum(dividers) - dividers, dividers) + 1
    lateral = section.right_edge[edge] + section.width[edge] * number / section.lanes[edge]
    centre = ~section.oneway[edge] & (number == section.forward[edge])
    solid = centre & (section.lanes[edge] >= 4)
    gap = np.where(np.isin(kind[edge], LONG_DASH) | ~section.walked[edge], 9.0, 3.0)
    rows = np.flatnonzero(solid)
    at = edge[rows]
    whole = pieces(lines, at, begin[at], end[at])
    shapes, edges = [line_strips(whole, lateral[rows], LINE)], [at]
    for space in (3.0, 9.0):
        rows = np.flatnonzero(~solid & (gap == space))
        which, along = every((end - begin)[edge[rows]], 3.0 + space, 1.6)
        at = edge[rows][which]
        middle = begin[at] + along
        dashes = pieces(lines, at, middle - 1.5, middle + 1.5)
        shapes.append(line_strips(dashes, lateral[rows][which], LINE))
        edges.append(at)
    return np.concatenate(shapes), np.concatenate(edges)


def _edge_lines(network: RoadNetwork, lines: Polylines, chosen: NDArray[np.bool_]) -> Marks:
    begin, end = _free(network, arc_lengths(lines)[1])
    edge = np.flatnonzero(chosen & (end - begin > 3.0) & (network.half_width > 2.0))
    solid = pieces(lines, edge, begin[edge], end[edge])
    lateral = network.half_width[edge] - EDGE_INSET
    sides = [line_strips(solid, sign * lateral, LINE) for sign in (1, -1)]
    return np.concatenate(sides), np.concatenate([edge, edge])


def _stop_lines(
    network: RoadNetwork,
    lines: Polylines,
    chosen: NDArray[np.bool_],
    kind: NDArray[np.str_],
    section: _Section,
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
        stops &= (network.half_width * 2 >= TWO_LANES) | section.oneway
        # Against the direction of the edge nobody arrives at a one-way street's start.
        stops &= ~(section.oneway & (end == 0))
        edge = np.flatnonzero(stops)
        back = np.where(network.crossing[edge, end], ZEBRA + 1.5, 0.5) + STOP / 2
        back += network.trim[edge, end]
        along = back if end == 0 else length[edge] - back
        cut = section.right_edge + section.width * section.forward / section.lanes
        low = np.where(end == 1, section.right_edge, cut)[edge]
        high = np.where(end == 1, cut, section.right_edge + section.width)[edge]
        shapes.append(_boxes(lines, edge, along, (low + high) / 2, STOP, high - low - 0.3))
    return _together(shapes)


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
    network: RoadNetwork, lines: Polylines, chosen: NDArray[np.bool_], table: Any
) -> Marks:
    length = arc_lengths(lines)[1]
    begin, end = _free(network, length)
    shapes = []
    for column, sign in (("parking_left", 1.0), ("parking_right", -1.0)):
        edge = np.flatnonzero(chosen & table[column].to_numpy() & (network.half_width > PARKING))
        which, along = every((end - begin)[edge], BAY, 4.0)
        edge = edge[which]
        lateral = sign * (network.half_width[edge] - PARKING / 2)
        size = np.full(len(edge), PARKING - 0.1)
        shapes.append(_boxes(lines, edge, begin[edge] + along, lateral, LINE, size))
    return _together(shapes)


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
