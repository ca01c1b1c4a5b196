"""The road network: from ways that share coordinates to a graph of carriageways."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Annotated, Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.city.city import City
from cityx.city.roads import RoadNetwork
from cityx.geometry.arrays import BoolArray, FloatArray, IntArray
from cityx.geometry.chains import components, join_segments
from cityx.geometry.polylines import Polylines, arc_lengths, locate, pack, to_linestrings
from cityx.ids import mix
from cityx.places.profiles import keeps_left
from cityx.protocol import Choice, Port, action
from cityx.road.markings.crossing_places import crossed_ends, mouths
from cityx.road.network.medians import parted_halves
from cityx.road.network.warrants import warranted, with_signals
from cityx.road.surface.corners import Arms, Corners, corners_of, trims_of
from cityx.road.surface.roundabouts import narrowed_rings, round_rings

if TYPE_CHECKING:
    from geopandas import GeoDataFrame

    from cityx.city.layout import Layout


DRIVABLE = (
    "motorway", "trunk", "primary", "secondary", "tertiary", "unclassified", "residential",
    "living_street", "service", "road", "track", "busway", "bus_guideway", "raceway",
    "motorway_link", "trunk_link", "primary_link", "secondary_link", "tertiary_link",
)  # fmt: skip
PRIVATE = ("service", "track")  # in a tunnel these lead into garages and mines
# A change in one of these columns is a change of the cross-section, so an edge ends there.
SECTION = (
    "kind", "lanes", "lanes_forward", "width", "sidewalk_left", "sidewalk_right", "parking_left",
    "parking_right", "section", "oneway", "layer", "bridge", "tunnel", "passage", "roundabout",
    "surface",
)  # fmt: skip
# What a street keeps up to the junction even where only its last metres have it.
FIXED = ("oneway", "layer", "bridge", "tunnel", "passage", "roundabout")
SHORT_SECTION = 15.0  # metres; no longer than a junction, or what a change of width takes

PER_METRE = 1000.0  # nodes are shared coordinates to the millimetre
SPUR = 3.0  # metres; a shorter dead end is a drawing mistake
FACADE_CLEARANCE = 0.3  # metres between carriageway and facade
NARROWEST = 1.2  # metres of half width; the least a car passes through
AIM = 6.0  # metres from the node at which an arm's direction is taken


def road_network(layout: Layout, *, left_hand: bool = False) -> RoadNetwork:
    """Build the carriageway graph of a layout.

    Nodes are coordinates that ways share. A way that passes over another at the same coordinate
    and goes on (another layer, or a bridge) does not touch it.

    Parameters
    ----------
    layout
        Roads, and the buildings and points that bear on widths and crossings.
    left_hand
        Whether traffic keeps to the left.

    Returns
    -------
    network
        The graph; edges in the order of their roads and of the points along them.
    """
    roads = layout.roads
    rows = np.flatnonzero(_carries_cars(layout))
    geometry = shapely.force_2d(roads.geometry.to_numpy()[rows])
    geometry, rows = clip_lines(geometry, rows, layout.extent)
    geometry = round_rings(geometry, roads["roundabout"].to_numpy(bool)[rows])
    lines = pack(geometry)
    if not lines.count:
        return _graph_without_edges()
    section, fixed = _codes(roads.iloc[rows], SECTION), _codes(roads.iloc[rows], FIXED)
    level = _codes(roads.iloc[rows], ("layer", "bridge", "tunnel"))
    node, position = shared_nodes(lines, level, np.ones(lines.count, bool))
    owner = lines.line_of_point()
    first = np.flatnonzero(owner[1:] == owner[:-1])
    ends, way = np.column_stack([node[first], node[first + 1]]), owner[first]
    keep = _unrepeated(ends)
    ends, way, first = ends[keep], way[keep], first[keep]
    for _ in range(2):
        ends, way = _continued(ends, way, section, fixed, position)
    for _ in range(2):
        head, rank = join_segments(ends, section[way])
        keep = ~_spurs(ends, head, position, layout.extent)
        if keep.all():
            break
        ends, way = ends[keep], way[keep]
    if not len(ends):
        return _graph_without_edges()
    return _assemble(layout, rows, ends, way, head, rank, position, left_hand=left_hand)


def private_tunnels(roads: GeoDataFrame) -> BoolArray:
    """Return which roads are tunnels into garages and mines, which the network leaves out."""
    tunnel = roads["tunnel"].to_numpy(bool) & ~roads["passage"].to_numpy(bool)
    return np.asarray(tunnel & roads["kind"].isin(PRIVATE).to_numpy())


def _carries_cars(layout: Layout) -> BoolArray:
    roads = layout.roads
    return np.asarray(roads["kind"].isin(DRIVABLE).to_numpy() & ~private_tunnels(roads))


def clip_lines(geometry: NDArray[Any], rows: IntArray, extent: tuple[float, ...]) -> Any:
    """Cut lines at the site's rectangle, with the row of each; a line may fall into several."""
    box = shapely.bounds(geometry)
    inside = (box[:, 0] >= extent[0]) & (box[:, 1] >= extent[1])
    inside &= (box[:, 2] <= extent[2]) & (box[:, 3] <= extent[3])
    if not inside.all():
        geometry = geometry.copy()
        geometry[~inside] = shapely.intersection(geometry[~inside], shapely.box(*extent))
        geometry, part = shapely.get_parts(geometry, return_index=True)
        rows = rows[part]
    good = (shapely.get_type_id(geometry) == 1) & (shapely.length(geometry) > 0)
    return geometry[good], rows[good]


def _codes(table: Any, columns: tuple[str, ...]) -> IntArray:
    """Give each distinct combination of values of some columns a number."""
    code = np.zeros(len(table), np.int64)
    for column in columns:
        values = table[column].to_numpy()
        values = np.unique(values.astype(str) if values.dtype == object else values,
                           return_inverse=True)[1]  # fmt: skip
        code = np.unique(code * (int(values.max(initial=0)) + 1) + values, return_inverse=True)[1]
    return code


def shared_nodes(
    lines: Polylines, level: IntArray, joins: BoolArray
) -> tuple[IntArray, FloatArray]:  # fmt: skip
    """Find the node of each point, (p,), and their positions, (n, 2), sorted by position.

    Levels meet where ways of both end; elsewhere they cross without touching. An end that nothing
    goes on from joins what passes at its place, whatever the level, if its line ``joins``, (l,).
    """
    whole = np.rint(lines.points * PER_METRE).astype(np.int64)
    low = whole.min(axis=0)
    x, y = (whole - low).T
    place = np.unique((x << np.int64(32)) | y, return_inverse=True)[1]
    ends = np.zeros(len(whole), bool)
    ends[lines.start[:-1]] = ends[lines.start[1:] - 1] = True
    point_level = level[lines.line_of_point()]
    pair = place * (int(level.max()) + 1) + point_level
    pairs, which = np.unique(pair, return_inverse=True)
    meets = np.zeros(len(pairs), bool)
    np.logical_or.at(meets, which, ends)
    loose = np.bincount(place, np.where(meets[which], 2 - ends, 0)) == 1
    loose &= np.bincount(place, ends & joins[lines.line_of_point()]) > 0
    joined = meets[which] | loose[place]
    key = place * (int(level.max()) + 2) + np.where(joined, 0, point_level + 1)
    _, sample, node = np.unique(key, return_index=True, return_inverse=True)
    return node, whole[sample] / PER_METRE


def _unrepeated(ends: IntArray) -> BoolArray:
    """Mark segments with length, each pair of nodes once, the first of them."""
    low, high = ends.min(axis=1), ends.max(axis=1)
    _, first = np.unique(low * (int(ends.max()) + 1) + high, return_index=True)
    keep = np.zeros(len(ends), bool)
    keep[first] = True
    return np.asarray(keep & (low != high))


def _continued(
    ends: IntArray, way: IntArray, section: IntArray, fixed: IntArray, position: FloatArray
) -> tuple[IntArray, IntArray]:
    """Give pieces too short for a section of their own that of the longer piece they lead on from.

    Returns
    -------
    ends, way
        (m, 2) and (m,) nodes and way of each segment; turned where the longer piece runs against
        the short one.
    """
    head, _ = join_segments(ends, section[way])
    size = np.hypot(*(position[ends[:, 1]] - position[ends[:, 0]]).T)
    length = np.bincount(head, size, minlength=len(ends))
    order = np.argsort(ends.ravel(), kind="stable")
    count = np.bincount(ends.ravel(), minlength=len(position))
    change = np.flatnonzero(count == 2)
    pair = order[(np.cumsum(count) - 2)[change][:, None] + [0, 1]] // 2  # (k, 2) segments
    against = (ends[pair] == change[:, None, None]).argmax(axis=2)
    against = against[:, 0] == against[:, 1]
    same = (fixed[way[pair[:, 0]]] == fixed[way[pair[:, 1]]]) & (
        head[pair[:, 0]] != head[pair[:, 1]]
    )
    pair, against = pair[same], against[same]
    source, turned = np.arange(len(ends)), np.zeros(len(ends), bool)
    for short, long in (pair.T, pair.T[::-1]):
        taken = (length[head[short]] < SHORT_SECTION) & (length[head[long]] > length[head[short]])
        source[head[short[taken]]] = long[taken]
        turned[head[short[taken]]] = against[taken]
    own = source[head] == head
    way = way[np.where(own, np.arange(len(ends)), source[head])]
    return np.where((turned[head] & ~own)[:, None], ends[:, ::-1], ends), way


def _spurs(
    ends: IntArray, head: IntArray, position: FloatArray, extent: tuple[float, ...]
) -> BoolArray:
    """Mark the segments of short dead-end chains that do not leave the site."""
    length = np.hypot(*(position[ends[:, 1]] - position[ends[:, 0]]).T)
    total = np.bincount(head, length, minlength=len(ends))
    degree = np.bincount(ends.ravel())
    border = np.minimum(position - extent[:2], extent[2:] - position).min(axis=1) < 1.0
    loose = (degree[ends] == 1) & ~border[ends]
    dead = np.zeros(len(ends), bool)
    np.logical_or.at(dead, head, loose.any(axis=1))
    joined = np.zeros(len(ends), bool)
    np.logical_or.at(joined, head, (degree[ends] > 2).any(axis=1))
    return np.asarray((dead & joined & (total < SPUR))[head])


def _assemble(
    layout: Layout,
    rows: IntArray,
    ends: IntArray,
    way: IntArray,
    head: IntArray,
    rank: IntArray,
    position: FloatArray,
    *,
    left_hand: bool,
) -> RoadNetwork:
    """Turn chains of segments into edges with all that is known of them."""
    order = np.lexsort((rank, head))
    ends, way, head = ends[order], way[order], head[order]
    chain = np.unique(head, return_inverse=True)[1]
    begin = np.flatnonzero(np.r_[True, chain[1:] != chain[:-1]])
    finish = np.r_[begin[1:], len(chain)] - 1
    count = finish - begin + 2
    start = np.concatenate([[0], np.cumsum(count)]).astype(np.int64)
    path = np.empty(start[-1], np.int64)
    path[np.arange(len(ends)) + chain] = ends[:, 0]
    path[start[1:] - 1] = ends[finish, 1]
    lines = Polylines(position[path], start)
    used, edge_nodes = np.unique(np.column_stack([ends[begin, 0], ends[finish, 1]]),
                                 return_inverse=True)  # fmt: skip
    edge_nodes = edge_nodes.reshape(-1, 2)
    degree = np.bincount(edge_nodes.ravel(), minlength=len(used))
    road = rows[way[begin]]
    table = layout.roads.iloc[road]
    edge_id = _edge_ids(table["id"].to_numpy(), lines)
    half = _half_widths(layout, table, lines)
    half = parted_halves(table, lines, half)
    half = narrowed_rings(lines, table["roundabout"].to_numpy(bool), half)
    arms, corners, reach = node_corners(
        layout, table["kind"].to_numpy(), lines, edge_nodes, position[used], half
    )
    trim = trims_of(reach, arc_lengths(lines)[1])[0]
    mouth = mouths(arms, corners, half, len(road))
    crossing = crossed_ends(layout, table, lines, edge_nodes, degree, position[used], trim, mouth)
    return RoadNetwork(
        position[used],
        degree.astype(np.int32),
        edge_nodes.astype(np.int32),
        road.astype(np.int32),
        edge_id,
        lines.start,
        lines.points,
        half,
        trim,
        crossing,
        np.full(len(road), left_hand),
        np.zeros(len(lines.points)),
        np.zeros(len(lines.points)),
    )


def _edge_ids(road: NDArray[np.uint64], lines: Polylines) -> NDArray[np.uint64]:
    """Name an edge by its road and its first segment, which no other edge has."""
    found = mix(road)
    for points in (lines.points[lines.start[:-1]], lines.points[lines.start[:-1] + 1]):
        for column in np.rint(points * PER_METRE).astype(np.int64).T:
            found = mix(found ^ column.view(np.uint64))
    return np.maximum(found, np.uint64(1))


def _half_widths(layout: Layout, table: Any, lines: Polylines) -> FloatArray:
    """Half the carriageway's width, less where facades stand closer."""
    half = np.maximum(table["width"].to_numpy() / 2, NARROWEST)
    parts = layout.parts
    ground = (parts["base"].to_numpy() < 0.5) & parts["walls"].to_numpy()
    walls = parts.geometry.to_numpy()[ground]
    free = np.flatnonzero(~table["passage"].to_numpy() & (table["layer"].to_numpy() <= 0))
    if not len(walls) or not len(free):
        return np.asarray(half)
    shapes = to_linestrings(lines)[free]
    line, wall = shapely.STRtree(walls).query(
        shapes, predicate="dwithin", distance=half[free] + FACADE_CLEARANCE
    )
    distance = shapely.distance(shapes[line], walls[wall])
    # A way drawn through a building says nothing about the room beside it.
    beside = distance > 0
    limit = np.full(len(free), np.inf)
    np.minimum.at(limit, line[beside], distance[beside] - FACADE_CLEARANCE)
    half[free] = np.clip(limit, NARROWEST, half[free])
    return np.asarray(np.round(half, 3))


def arms_of(lines: Polylines, edge_nodes: NDArray[Any]) -> tuple[IntArray, IntArray, IntArray]:
    """List the arms of all nodes, node by node, counter-clockwise.

    Returns
    -------
    node, edge, end
        (2e,) int each; `end` is 0 where the edge leaves the node and 1 where it arrives.
    """
    count = len(edge_nodes)
    edge = np.concatenate([np.arange(count)] * 2)
    end = np.repeat([0, 1], count)
    node = edge_nodes.T.ravel().astype(np.int64)
    bearing = arm_bearings(lines, edge, end)
    order = np.lexsort((end, edge, bearing, node))
    return node[order], edge[order], end[order]


def arm_bearings(lines: Polylines, edge: IntArray, end: IntArray) -> FloatArray:
    """(k,) mathematical angle of arms as they leave their node, [-pi, pi), to a microradian."""
    length = arc_lengths(lines)[1][edge]
    reach = np.minimum(AIM, length)
    foot = np.where(end[:, None] == 0, lines.points[lines.start[edge]],
                    lines.points[lines.start[edge + 1] - 1])  # fmt: skip
    ahead = locate(lines, edge, np.where(end == 0, reach, length - reach))[0] - foot
    return np.asarray(np.round(np.arctan2(ahead[:, 1], ahead[:, 0]), 6))


def node_corners(
    layout: Layout, kind: Any, lines: Polylines, edge_nodes: NDArray[Any], position: FloatArray,
    half: FloatArray,
) -> tuple[Arms, Corners, FloatArray]:  # fmt: skip
    """List the arms of all nodes and the corners between them; see `corners_of`."""
    node, edge, end = arms_of(lines, edge_nodes)
    arms = Arms(node, edge, end, arm_bearings(lines, edge, end))
    length = arc_lengths(lines)[1]
    return arms, *corners_of(layout, kind, arms, position, half, length)


def junction_clusters(network: RoadNetwork) -> IntArray:
    """(n,) the lowest node of the junction each node belongs to.

    Edges that lie wholly inside of junction surfaces make one junction of their ends.
    """
    lines = network.lines
    left = arc_lengths(lines)[1] - network.trim.sum(axis=1)
    degree = network.node_degree[network.edge_nodes]
    inside = (left < 0.5) & (degree >= 3).all(axis=1)
    return components(network.edge_nodes[inside], len(network.node_position))


def _graph_without_edges() -> RoadNetwork:
    none = np.zeros(0)
    return RoadNetwork(
        np.zeros((0, 2)), none.astype(np.int32), np.zeros((0, 2), np.int32), none.astype(np.int32),
        none.astype(np.uint64), np.zeros(1, np.int64), np.zeros((0, 2)), none, np.zeros((0, 2)),
        np.zeros((0, 2), bool), np.zeros(0, bool), none, none,
    )  # fmt: skip


@action(
    "road/network-v1",
    limits=["Turn restrictions are not read.", "Service roads and tracks in tunnels are left out."],
    requires=("layout",),
    after=("road/drawn_streets-v1", "road/steps-v1"),
    takes=(Port("roads", "line", role="road_centerline"),),
    gives=(Port("network", "line", role="road_network"),),
)
def network(
    city: City,
    *,
    drive_on: Annotated[str, Choice("auto", "left", "right")] = "auto",
    signals: bool = True,
) -> City:
    """Join the ways that carry cars into a graph of edges and junctions with their widths.

    A map without such ways gets an empty graph.

    Parameters
    ----------
    drive_on
        Side of the road that traffic keeps to; auto follows the country.
    signals
        Whether crossings of main roads in dense town get signals that the map leaves out.
    """
    left = keeps_left(city.frame, drive_on)
    network = road_network(city.layout, left_hand=left)
    if not signals:
        return replace(city, network=network)
    places = warranted(city.layout, network, junction_clusters(network))
    if not len(places):
        return replace(city, network=network)
    layout = replace(city.layout, points=with_signals(city.layout.points, places))
    note = f"{len(places)} junctions have signals that the map does not show."
    return replace(
        city, layout=layout, network=_crossed_anew(layout, network), notes=(*city.notes, note)
    )


def _crossed_anew(layout: Layout, network: RoadNetwork) -> RoadNetwork:
    """Decide again where people cross."""
    lines = network.lines
    table = layout.roads.iloc[network.edge_road]
    arms, corners, _ = node_corners(
        layout, table["kind"].to_numpy(), lines, network.edge_nodes, network.node_position,
        network.half_width,
    )  # fmt: skip
    mouth = mouths(arms, corners, network.half_width, network.edge_count)
    crossing = crossed_ends(layout, table, lines, network.edge_nodes, network.node_degree,
                            network.node_position, network.trim, mouth)  # fmt: skip
    return replace(network, crossing=crossing)
