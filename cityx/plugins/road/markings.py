"""Road markings as thin regions of the ground, so that they drape and never flicker."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.city.ground import LABEL, SURFACES
from cityx.city.layout import Layout
from cityx.city.roads import RoadNetwork
from cityx.city.section import CARRIAGEWAY, KIND, TRAVELLED
from cityx.geometry.arrangement import Regions, join_regions, regions
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
from cityx.plugins.road.painting import Painting
from cityx.plugins.road.roundabouts import mini_discs, ring_edges, ring_nodes
from cityx.plugins.road.sections import Bands
from cityx.plugins.road.symbols import LENGTH, arrow, bicycle, bus, placed

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]
Shapes = NDArray[Any]
Marks = tuple[Shapes, IntArray]  # polygons and the edge each lies on

LINE = 0.12  # metres, width of a longitudinal line
STOP = 0.4  # metres, width of a stop line
BEFORE = 1.0  # metres from the stop line to the zebra or the junction
BAR = 0.5  # metres, width of a zebra bar and of the gap after it
ZEBRA, WIDE_ZEBRA = 3.0, 4.0  # metres along the road, on a street and on a main road
SETBACK, RING_SETBACK = 0.5, 5.0  # metres from the junction, or a roundabout's, to the zebra
SOLID = 15.0  # metres before a junction along which no line between lanes may be crossed
TOOTH = (0.6, 0.5, 0.4)  # metres: depth and width of a give-way triangle, and the gap after it
GIVE_WAY = (0.3, 0.5, 0.25)  # metres: depth and length of a give-way dash, and the gap after it
BAY = 5.5  # metres, length of a parking bay
WIDE = 7.0  # metres; a narrower residential street has lines only if the map tells its lanes
EVERY = 60.0  # metres between symbols on a bus or cycle lane
LEAST_SYMBOL = 1.2  # metres of a lane with a symbol
EDGE_INSET = 0.35  # metres from the carriageway's edge to its edge line
SIGNAL_REACH = 25.0  # metres from a junction or crossing to the signals or signs that rule it
WHOLE = 0.7  # share of a zebra's bars that must have room; otherwise none is painted
HATCH = (0.4, 1.6, 0.3)  # metres: width, spacing and distance from the sides of a gore's bars
LONG_DASH = ("motorway", "trunk", "motorway_link", "trunk_link")
GORED = (*LONG_DASH, "primary", "primary_link", "secondary_link")
MAIN = ("primary", "secondary", "tertiary", "trunk")
JUNCTION_LINES = (*MAIN, "unclassified")
UNMARKED = ("service", "track", "living_street", "busway", "road", "raceway")
_KERBED = [KIND[name] for name in CARRIAGEWAY]
_MOVING = [KIND[name] for name in TRAVELLED]
_FOR_CARS = [KIND[name] for name in ("drive", "bus")]
_UNLINED = [KIND["parking"]]
RANK = (
    "motorway", "trunk", "primary", "secondary", "tertiary", "unclassified", "residential",
)  # fmt: skip


@dataclass(frozen=True)
class Zebras:
    """Crossings with bars, z of them, and where traffic halts before them.

    Attributes
    ----------
    edge
        (z,) int64.
    along, depth
        (z,) float, metres from the edge's start to the middle, and metres along the road.
    """

    edge: IntArray
    along: FloatArray
    depth: FloatArray


@dataclass(frozen=True)
class Street:
    """What the marks of one network share, e edges.

    Attributes
    ----------
    layout, network, bands
        What is painted.
    lines, length
        Centrelines and their lengths, metres.
    kind
        (e,) class of the road.
    setback
        (e, 2) float, metres from the junctions at both ends to a zebra.
    depth
        (e,) float, metres of a zebra along the road.
    """

    layout: Layout
    network: RoadNetwork
    lines: Polylines
    length: FloatArray
    kind: NDArray[np.str_]
    bands: Bands
    setback: FloatArray
    depth: FloatArray

    @property
    def free(self) -> tuple[FloatArray, FloatArray]:
        """Begin and end of the part of each edge that carries longitudinal lines."""
        network = self.network
        taken = self.setback + self.depth[:, None] + BEFORE + STOP + 0.3
        room = network.trim + np.where(network.crossing, taken, np.where(network.trim > 0, 1.0, 0))
        return room[:, 0], self.length - room[:, 1]


def street_of(layout: Layout, network: RoadNetwork, bands: Bands) -> Street:
    """Gather what marks depend on."""
    lines = Polylines(network.points, network.point_start)
    kind = layout.roads["kind"].to_numpy()[network.edge_road].astype(str)
    main = np.isin(kind, MAIN)
    at_ring = ring_nodes(layout, network)[network.edge_nodes]
    setback = np.where(at_ring & ~ring_edges(layout, network)[:, None], RING_SETBACK, SETBACK)
    depth = np.where(main, WIDE_ZEBRA, ZEBRA)
    # A short arm has no room for the distance from a ring.
    length = arc_lengths(lines)[1]
    tight = (length - network.trim.sum(axis=1))[:, None] < setback + depth[:, None] + 6.0
    return Street(
        layout, network, lines, length, kind, bands, np.where(tight, SETBACK, setback), depth
    )


def painted_edges(street: Street, on_ground: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """(e,) edges on the ground, long enough and paved so that paint holds."""
    room = street.length - street.network.trim.sum(axis=1) > 4.0
    surface = street.layout.roads["surface"].to_numpy()[street.network.edge_road].astype(str)
    return np.asarray(on_ground & room & np.isin(surface, ("asphalt", "concrete", "paved", "")))


def marking_regions(
    street: Street,
    zebras: Zebras,
    painted: NDArray[np.bool_],
    road: Carriageway,
    painting: Painting,
) -> Regions:
    """Paint lane lines, stop lines, zebra crossings and parking bays; none inside junctions.

    Parameters
    ----------
    street
        The network and what its marks share.
    zebras
        The crossings with bars.
    painted
        (e,) bool, edges that are painted at all.
    road
        Their surfaces.
    painting
        What the country paints.
    """
    layout, network, kind = street.layout, street.network, street.kind
    table = layout.roads.iloc[network.edge_road]
    urban = painted & ~np.isin(kind, UNMARKED)
    tags = table["tags"].str
    known = tags.contains('"lanes', regex=False).to_numpy().astype(bool)
    known |= table["section"].to_numpy() != ""
    quiet = (kind == "residential") & ~known & (network.half_width * 2 < WIDE)
    bays = tags.contains('"parking', regex=False).to_numpy().astype(bool) | (kind != "residential")
    walked = (table["sidewalk_left"].to_numpy() + table["sidewalk_right"].to_numpy()) > 0
    lane_lines, centre = _lane_lines(street, urban & ~quiet, walked)
    bars, crossing = _bars(street, zebras)
    white = [
        _edge_lines(street, urban & np.isin(kind, LONG_DASH)),
        _halts(street, urban, painting.give_way),
        _symbols(street, urban),
        _parking_bays(street, painted & bays),
    ]
    gores = _gores(painted & np.isin(kind, GORED), road)
    marks, edge = _together([lane_lines, bars, *white])
    yellow = np.zeros(len(marks), bool)
    yellow[: len(centre)] = centre & painting.yellow_centre
    group = np.full(len(marks), -1)
    group[len(centre) : len(centre) + len(crossing)] = crossing
    clear = _clear(marks, edge, layout, network, road)
    # A crossing is painted as a whole or not at all.
    barred = group >= 0
    count = np.bincount(group[barred], minlength=len(zebras.edge))
    whole = np.bincount(group[barred & clear], minlength=len(count)) >= WHOLE * count
    clear[barred] &= whole[group[barred]]
    label, other = LABEL["marking"], LABEL["marking_yellow"]
    parts = [
        regions(marks[clear], np.where(yellow[clear], other, label), SURFACES[label].priority),
        regions(mini_discs(layout, network), label, SURFACES[label].priority),
        gores,
    ]
    if painting.red_cycleways:
        parts.append(_red_lanes(street, painted))
    return join_regions(parts)


def _lane_lines(
    street: Street, chosen: NDArray[np.bool_], walked: NDArray[np.bool_]
) -> tuple[Marks, NDArray[np.bool_]]:
    """Paint what parts two bands: dashes between lanes of cars, an unbroken line where none cross.

    Unbroken are the middle of roads with four lanes and more, the sides of bus lanes, cycle lanes,
    shoulders and medians, and all lines just before a junction. Parked cars have no line of their
    own. Also returns which marks part the two directions.
    """
    network, lines, bands = street.network, street.lines, street.bands
    begin, end = street.free
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
    gap = np.where(np.isin(street.kind[edge], LONG_DASH) | ~walked[edge], 9.0, 3.0)
    shapes, edges, middle = [], [], []

    def paint(rows: IntArray, cut: Polylines, width: float) -> None:
        shapes.append(line_strips(cut, lateral[rows], width))
        edges.append(edge[rows])
        middle.append(centre[rows])

    for wide in (False, True):
        rows = np.flatnonzero(solid & (bus == wide))
        at = edge[rows]
        paint(rows, pieces(lines, at, begin[at], end[at]), LINE * (1 + wide))
    # Lines that lead to a junction on foot of which they end are unbroken for the last metres.
    junction = (network.node_degree[network.edge_nodes] >= 3) & (network.trim > 0)
    room = (end - begin)[edge] > 2 * SOLID + 12.0
    low, high = begin[edge].copy(), end[edge].copy()
    broken = ~solid & room & np.isin(street.kind[edge], JUNCTION_LINES)
    for side in (0, 1):
        # Of one direction only the end that its traffic arrives at.
        arrives = centre | (bands.direction[first] == (1 if side else -1))
        rows = np.flatnonzero(broken & junction[edge, side] & arrives)
        at = edge[rows]
        from_, to = (begin[at], begin[at] + SOLID) if side == 0 else (end[at] - SOLID, end[at])
        paint(rows, pieces(lines, at, from_, to), LINE)
        if side == 0:
            low[rows] += SOLID
        else:
            high[rows] -= SOLID
    for space in (3.0, 9.0):
        rows = np.flatnonzero(~solid & (gap == space))
        which, along = every((high - low)[rows], 3.0 + space, 1.6)
        rows = rows[which]
        at = low[rows] + along
        paint(rows, pieces(lines, edge[rows], at - 1.5, at + 1.5), LINE)
    return (np.concatenate(shapes), np.concatenate(edges)), np.concatenate(middle)


def _edge_lines(street: Street, chosen: NDArray[np.bool_]) -> Marks:
    """Paint lines along the sides of fast roads; a shoulder has its line where it meets a lane."""
    network, lines, bands = street.network, street.lines, street.bands
    begin, end = street.free
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


def _halts(street: Street, chosen: NDArray[np.bool_], give_way: str) -> Marks:
    """Lines where traffic that arrives halts or gives way.

    A stop line lies before signals, stop signs and the zebras of a junction; at the mouths of
    minor roads and of the arms of a roundabout it is what the country paints to give way.
    """
    network, lines, bands = street.network, street.lines, street.bands
    layout, length, kind = street.layout, street.length, street.kind
    rank = np.full(len(kind), len(RANK))
    for value, word in enumerate(RANK):
        rank[np.char.startswith(kind, word)] = value
    best = np.full(len(network.node_position), len(RANK))
    np.minimum.at(best, network.edge_nodes, rank[:, None] * np.ones(2, int))
    ring, on_ring = ring_edges(layout, network), ring_nodes(layout, network)
    spots = shapely.points(network.node_position)
    ruled = _near(spots, layout, ("traffic_signals", "stop"))
    shapes = []
    for end in (0, 1):
        node = network.edge_nodes[:, end]
        enters = on_ring[node] & ~ring
        minor = ((rank > best[node]) & (best[node] <= 4) & ~ring) | enters
        stops = chosen & (network.node_degree[node] >= 3) & (minor | network.crossing[:, end])
        # Only where lanes arrive at this end: not at the start of a one-way street.
        low, high = spans_of(bands, len(chosen), 1 if end == 1 else -1)
        stops &= high > low
        zebra = network.crossing[:, end]
        behind = network.trim[:, end] + np.where(
            zebra, street.setback[:, end] + street.depth + BEFORE, np.where(enters, 0.3, BEFORE)
        )
        yields = minor & ~ruled[node] & (~zebra | enters)
        # Where the zebra stands back from a ring, one gives way between the two.
        behind = np.where(enters, network.trim[:, end] + 0.3, behind)
        plain = stops & ~(yields & (give_way != "stop"))
        for rows, shape in ((plain, "stop"), (stops & ~plain, give_way)):
            edge = np.flatnonzero(rows)
            shapes.append(
                _line_across(lines, length, edge, end, behind[edge], low[edge], high[edge], shape)
            )
    return _together(shapes)


def _near(spots: Shapes, layout: Layout, kinds: tuple[str, ...]) -> NDArray[np.bool_]:
    """(k,) whether points of some kinds lie near."""
    found = np.zeros(len(spots), bool)
    places = layout.points.geometry.to_numpy()[layout.points["kind"].isin(kinds).to_numpy()]
    if len(places):
        tree = shapely.STRtree(places)
        found[tree.query(spots, predicate="dwithin", distance=SIGNAL_REACH)[0]] = True
    return found


def _line_across(
    lines: Polylines, length: FloatArray, edge: IntArray, end: int, behind: FloatArray,
    low: FloatArray, high: FloatArray, shape: str,
) -> Marks:  # fmt: skip
    """Paint a stop line, a row of give-way triangles or dashes across the lanes that arrive."""
    sign = 1.0 if end == 0 else -1.0
    if shape == "stop":
        back = behind + STOP / 2
        along = back if end == 0 else length[edge] - back
        return _boxes(lines, edge, along, (low + high) / 2, STOP, high - low - 0.3)
    depth, size, gap = TOOTH if shape == "teeth" else GIVE_WAY
    which, at = every(high - low, size + gap, size / 2 + 0.15)
    edge, behind, lateral = edge[which], behind[which], low[which] + at
    back = behind + depth / 2
    along = back if end == 0 else length[edge] - back
    if shape == "dashes":
        return _boxes(lines, edge, along, lateral, depth, np.full(len(edge), size))
    position, direction = locate(lines, edge, along)
    across = np.column_stack([-direction[:, 1], direction[:, 0]])
    centre = position + across * lateral[:, None]
    # The tips point at those who arrive.
    tip = direction * (sign * depth / 2)
    base = across * (size / 2)
    corners = np.stack([centre + tip, centre - tip + base, centre - tip - base], axis=1)
    return np.asarray(shapely.polygons(corners)), edge


def spans_of(bands: Bands, count: int, direction: int) -> tuple[FloatArray, FloatArray]:
    """(e,) lateral bounds of the lanes of one direction; empty where there are none."""
    rows = np.flatnonzero(np.isin(bands.kind, _MOVING) & (bands.direction == direction))
    low, high = np.full(count, np.inf), np.full(count, -np.inf)
    np.minimum.at(low, bands.edge[rows], bands.right[rows])
    np.maximum.at(high, bands.edge[rows], bands.left[rows])
    return low, high


def lane_count(bands: Bands, count: int, direction: int) -> IntArray:
    """(e,) number of lanes for cars in one direction."""
    cars = np.isin(bands.kind, _FOR_CARS) & (bands.direction == direction)
    return np.bincount(bands.edge[cars], minlength=count)


def _symbols(street: Street, chosen: NDArray[np.bool_]) -> Marks:
    """Paint arrows before junctions, and what bus and cycle lanes are for behind them."""
    network, lines, bands = street.network, street.lines, street.bands
    begin, end = street.free
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


def zebras_of(street: Street, chosen: NDArray[np.bool_]) -> Zebras:
    """Find all crossings with bars: at the ends of arms, and those of the map between junctions."""
    network = street.network
    edge, end = np.nonzero(network.crossing & chosen[:, None])
    back = network.trim[edge, end] + street.setback[edge, end] + street.depth[edge] / 2
    along = np.where(end == 0, back, street.length[edge] - back)
    more, there = _mapped_crossings(street, chosen)
    edge, along = np.concatenate([edge, more]), np.concatenate([along, there])
    return Zebras(edge, along, street.depth[edge])


def _bars(street: Street, zebras: Zebras) -> tuple[Marks, IntArray]:
    """Paint the bars of crossings; also returns the crossing of each."""
    width = 2 * street.network.half_width[zebras.edge] - BAR
    which, lateral = every(width, 2 * BAR, BAR / 2)
    lateral = lateral - width[which] / 2
    size = np.full(len(which), BAR)
    marks, edge = _boxes(street.lines, zebras.edge[which], zebras.along[which], lateral,
                         zebras.depth[which], size)  # fmt: skip
    return (marks, edge), which


def _mapped_crossings(street: Street, chosen: NDArray[np.bool_]) -> tuple[IntArray, FloatArray]:
    """Crossings of the map between junctions: edge and distance from its start."""
    points = street.layout.points
    mapped = points[(points["kind"] == "crossing").to_numpy()]
    unmarked = mapped["tags"].str.contains("unmarked", regex=False).to_numpy().astype(bool)
    places = mapped.geometry.to_numpy()[~unmarked]
    edges = np.flatnonzero(chosen)
    if not len(places) or not len(edges):
        return np.zeros(0, np.int64), np.zeros(0)
    shapes = to_linestrings(street.lines)[edges]
    point, row = shapely.STRtree(shapes).query_nearest(places, max_distance=1.0, all_matches=False)
    along = shapely.line_locate_point(shapes[row], places[point])
    edge = edges[row]
    begin, end = street.free
    clear = (along > begin[edge] + ZEBRA) & (along < end[edge] - ZEBRA)
    edge, along = edge[clear], along[clear]
    order = np.lexsort((along, edge))
    edge, along = edge[order], along[order]
    # Crossings mapped once per lane or island are one crossing.
    apart = np.r_[True, (edge[1:] != edge[:-1]) | (np.diff(along) > 2 * ZEBRA)][: len(edge)]
    return edge[apart], along[apart]


def _parking_bays(street: Street, chosen: NDArray[np.bool_]) -> Marks:
    bands = street.bands
    begin, end = street.free
    rows = np.flatnonzero((bands.kind == KIND["parking"]) & chosen[bands.edge])
    which, along = every((end - begin)[bands.edge[rows]], BAY, 4.0)
    rows = rows[which]
    edge = bands.edge[rows]
    return _boxes(street.lines, edge, begin[edge] + along, bands.middle[rows], LINE,
                  bands.width[rows] - 0.1)  # fmt: skip


def _red_lanes(street: Street, chosen: NDArray[np.bool_]) -> Regions:
    """Colour cycle lanes from junction to junction."""
    bands = street.bands
    begin, end = street.free
    rows = np.flatnonzero((bands.kind == KIND["cycle"]) & chosen[bands.edge])
    rows = rows[(end - begin)[bands.edge[rows]] > 3.0]
    edge = bands.edge[rows]
    cut = pieces(street.lines, edge, begin[edge], end[edge])
    strips = []
    for row, line in enumerate(to_linestrings(cut)):
        strips.append(_band(line, bands.left[rows[row]], bands.right[rows[row]]))
    return regions(np.array(strips, object), LABEL["cycle_lane"],
                   SURFACES[LABEL["cycle_lane"]].priority)  # fmt: skip


def _gores(chosen: NDArray[np.bool_], road: Carriageway) -> Regions:
    """Hatch the wedges between a road and the ramp that leaves or joins it."""
    wedge = np.flatnonzero(chosen[road.gore_edge])
    if not len(wedge):
        return Regions()
    width, spacing, inset = HATCH
    shapes = shapely.buffer(road.gores[wedge], -inset, join_style="mitre")
    box = shapely.bounds(shapes)
    bars = []
    for shape, bound in zip(shapes, box, strict=True):
        if shapely.is_empty(shape):
            continue
        x0, y0, x1, y1 = bound
        reach = (x1 - x0) + (y1 - y0)
        start = np.arange(np.ceil((x0 + y0) / spacing) * spacing, x0 + y0 + reach, spacing)
        ends = [np.column_stack([start - y, np.full(len(start), y)]) for y in (y0, y1)]
        line = np.stack(ends, axis=1)
        strokes = shapely.buffer(shapely.linestrings(line), width / 2, cap_style="flat")
        bars.append(shapely.intersection(strokes, shape))
    rim = shapely.difference(shapes, shapely.buffer(shapes, -2 * LINE, join_style="mitre"))
    label = LABEL["marking"]
    painted = shapely.union_all(np.concatenate([rim, *bars]))
    return regions(painted, label, SURFACES[label].priority)


def _band(line: Any, left: float, right: float) -> Any:
    """Strip of a line between two distances to its left."""
    width = left - right
    return shapely.buffer(
        shapely.offset_curve(line, (left + right) / 2, join_style="mitre"),
        width / 2, cap_style="flat", join_style="mitre",
    )  # fmt: skip


def _together(marks: list[Marks]) -> Marks:
    return np.concatenate([mark for mark, _ in marks]), np.concatenate([edge for _, edge in marks])


def _boxes(
    lines: Polylines,
    edge: IntArray,
    along: FloatArray,
    lateral: FloatArray,
    length: FloatArray | float,
    width: FloatArray,
) -> Marks:
    """Rectangles in the frame of their edge, `length` along it and `width` across."""
    keep = width > 0.1
    length = np.broadcast_to(np.asarray(length, float), len(keep))[keep]
    edge, along, lateral, width = edge[keep], along[keep], lateral[keep], width[keep]
    if not len(edge):
        return np.zeros(0, object), edge
    position, direction = locate(lines, edge, along)
    across = np.column_stack([-direction[:, 1], direction[:, 0]])
    centre = position + across * lateral[:, None]
    u, v = direction * (length / 2)[:, None], across * (width / 2)[:, None]
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
