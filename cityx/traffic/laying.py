"""Make the streets of the traffic simulation from the lane graph of a city.

The lane graph has a lane from every junction to the next, however near. A vehicle that halts on a
lane shorter than itself blocks what crosses behind it, so lanes shorter than a car belong to the
junction here, and lanes end where one halts: before the zebra.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
import shapely
from shapely.ops import substring

from cityx.city.section import KIND
from cityx.geometry.arrays import BoolArray, FloatArray, IntArray
from cityx.geometry.chains import components
from cityx.geometry.polylines import Polylines, arc_lengths, locate, miters, pieces, to_linestrings
from cityx.ids import id_text
from cityx.traffic.conflicts import bend_of
from cityx.traffic.shared_ground import HALF_BODY, Heights, Walls, closed_lanes, shared_ground
from cityx.traffic.streets import Crossing, Halts, Lane, Link, Streets, Way
from cityx.traffic.sweeps import HALF, LENGTH, clear_links, swept_into, tight_links

if TYPE_CHECKING:
    from cityx.city.city import City
    from cityx.city.lanes import LaneGraph
    from cityx.city.roads import RoadNetwork


SHORTEST = 5.0  # metres, a car: shorter lanes belong to the junction
PASSING = 4.8  # metres of a lane for both ways on which two cars pass each other
HALF_LARGE = 1.5  # metres from the middle of a bus in a bend to its side
BESIDE = 0.3  # metres between two lanes over which one still changes from one to the other
MOST_LINKS = 255  # ways across one junction, with its zebras, of which SUMO tells who goes first
# OpenStreetMap's keys of who may use a street, and what cars they let in there.
_WHO = ("access", "vehicle", "motor_vehicle", "motorcar")  # the narrower one decides
_LOCAL = {
    "": "yes|designated|permissive|official",
    "destination": "destination|customers|delivery",
    "private": "private|permit|residents|agricultural|forestry|military|employees",
}
LONGEST_CHAIN = 12  # short lanes that one way across a junction runs over at most


def streets_of(city: City, halts: Halts, *, against: bool = False) -> Streets:
    """Gather the streets of a city that has lanes.

    Parameters
    ----------
    city
        City with a network and a lane graph; heights of streets are its network's.
    halts
        Where traffic halts.
    against
        Whether bicycles go against one-way streets on the lanes of cars.

    Returns
    -------
    streets
        In the order of the network's edges; the same city gives the same streets.
    """
    network, graph = city.network, city.lanes
    assert network is not None
    assert graph is not None
    moving = np.asarray(graph.travelled & (graph.direction != 0))
    heights = Heights(city, network)
    lines = _lane_lines(network, graph, halts.gap)
    short, junction = _short_edges(network, graph, lines, moving)
    gap = np.maximum(halts.gap, shared_ground(network, graph, lines, moving & ~short[graph.edge],
                                               junction, heights) + halts.gap)  # fmt: skip
    lines = _lane_lines(network, graph, gap)
    short, junction = _short_edges(network, graph, lines, moving)
    open_lane = moving & ~short[graph.edge]
    closed = closed_lanes(graph, lines, open_lane, halts.rank, heights)
    if not against:
        closed |= open_lane & _upon_others(graph)
    walls = Walls(city)
    middles = to_linestrings(lines)
    closed |= open_lane & (walls.near(middles, HALF_BODY) | swept_into(middles, walls.tree))
    tight = walls.near(middles, HALF_LARGE) | swept_into(middles, walls.tree, LENGTH, HALF)
    ways, place_of = _ways(
        network, graph, lines, open_lane, closed, tight, junction, halts.rank, heights
    )
    ways = _with_locals(ways, city, network)
    links = walls.clear(links_of(graph, lines, open_lane, place_of, ways, moving))
    place, signals = _junctions(city, network, junction, halts)
    crossings = _crossings(network, halts, ways, heights, signals)
    left_hand = bool(network.left_hand.any())
    streets = Streets(ways, links, crossings, place, signals, left_hand)
    cleared = clear_links(_unlooped(streets), walls.tree)
    return tight_links(with_room_for_links(cleared), walls.tree)


def with_room_for_links(streets: Streets) -> Streets:
    """Leave out ways across junctions that have more of them than the simulator can rule.

    Those between the least streets go first, and of them the sharpest turns; a lane keeps one way
    on and one way in while there is room. A bus station of many bays is such a junction.
    """
    taken = np.array([streets.ways[link.source[0]].target for link in streets.links], np.int64)
    zebras = np.array([crossing.junction for crossing in streets.crossings], np.int64)
    count, room = (np.bincount(of, minlength=len(streets.place)) for of in (taken, zebras))
    room = MOST_LINKS - room
    gone: set[int] = set()
    for junction in np.flatnonzero(count > room).tolist():
        rows = np.flatnonzero(taken == junction).tolist()
        gone |= _least_links(streets, rows, int(count[junction] - room[junction]))
    if not gone:
        return streets
    links = tuple(link for row, link in enumerate(streets.links) if row not in gone)
    return replace(streets, links=links, undriven=len(gone))


def _least_links(streets: Streets, rows: list[int], wanted: int) -> set[int]:
    """Choose which links of a junction go, as many as are wanted."""
    ends = {row: (streets.links[row].source, streets.links[row].target) for row in rows}
    left = Counter(("from", source) for source, _ in ends.values())
    left.update(("to", target) for _, target in ends.values())

    def worth(row: int) -> tuple[int, float, int]:
        least = min(streets.ways[way].rank for way, _ in ends[row])
        return least, -round(bend_of(streets.links[row].shape), 3), -row

    gone: list[int] = []
    ordered = sorted(rows, key=worth)
    for sides in (("from", "to"), ("from",), ()):  # at last lanes lose their only ways
        for row in ordered:
            held = dict(zip(("from", "to"), ends[row], strict=True))
            if len(gone) < wanted and row not in gone and all(
                left[side, held[side]] > 1 for side in sides
            ):  # fmt: skip
                gone.append(row)
                left.subtract(held.items())
    return set(gone)


def _junctions(
    city: City, network: RoadNetwork, junction: IntArray, halts: Halts
) -> tuple[FloatArray, BoolArray]:
    """(j, 3) middles of junctions, and (j,) whether signals rule them."""
    count = int(junction.max(initial=-1)) + 1
    signals = np.zeros(count, bool)
    signals[junction[halts.signals]] = True
    spread = np.bincount(junction, minlength=count)
    middle = np.column_stack(
        [np.bincount(junction, network.node_position[:, axis], count) for axis in (0, 1)]
    ) / np.maximum(spread, 1)[:, None]  # fmt: skip
    place = np.column_stack([middle, city.terrain.height_at(middle)])
    return np.round(place, 3), signals


def _unlooped(streets: Streets) -> Streets:
    """Divide ways that lead back to where they come from: no simulator knows such edges.

    Nobody crosses them, for both their ends lie at one junction.
    """
    ways, links, place = list(streets.ways), list(streets.links), list(streets.place)
    looped = {number for number, way in enumerate(streets.ways) if way.source == way.target}
    crossings = tuple(each for each in streets.crossings if looped.isdisjoint(each.ways))
    for number in sorted(looped):
        way = ways[number]
        halves = [_halves(lane.shape) for lane in way.lanes]
        near = tuple(replace(lane, shape=a) for lane, (a, _) in zip(way.lanes, halves, strict=True))
        far = tuple(replace(lane, shape=b) for lane, (_, b) in zip(way.lanes, halves, strict=True))
        ways[number] = replace(way, target=len(place), lanes=near)
        links = [replace(link, source=(len(ways), link.source[1]))
                 if link.source[0] == number else link for link in links]  # fmt: skip
        links += [Link((number, k), (len(ways), k), np.stack([lane.shape[0]] * 2))
                  for k, lane in enumerate(far) if lane.kind != "walk"]  # fmt: skip
        ways.append(replace(way, name=f"{way.name}#", source=len(place), lanes=far))
        place.append(far[-1].shape[0])
    signals = np.r_[streets.signals, np.zeros(len(place) - len(streets.place), bool)]
    return replace(streets, ways=tuple(ways), links=tuple(links), crossings=crossings,
                   place=np.array(place), signals=signals)  # fmt: skip


def _halves(shape: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Divide a line in its middle."""
    whole = shapely.LineString(shape)
    parts = (substring(whole, *ends, normalized=True) for ends in ((0.0, 0.5), (0.5, 1.0)))
    near, far = (np.round(shapely.get_coordinates(part, include_z=True), 3) for part in parts)
    return near, far


def _short_edges(
    network: RoadNetwork, graph: LaneGraph, lines: Polylines, moving: BoolArray
) -> tuple[BoolArray, IntArray]:
    """(e,) edges that belong to junctions, and (n,) the junction of each node."""
    longest = np.zeros(network.edge_count)
    np.maximum.at(longest, graph.edge[moving], arc_lengths(lines)[1][moving])
    short = longest < SHORTEST
    junction = components(network.edge_nodes[short].astype(np.int64), len(network.node_position))
    return short, np.unique(junction, return_inverse=True)[1]


def _lane_lines(network: RoadNetwork, graph: LaneGraph, gap: FloatArray) -> Polylines:
    """Middles of lanes from where one has crossed to where one halts, in the direction of travel.

    Where two cars pass each other on a lane for both ways, each keeps to its side of it.
    """
    lines = graph.lines
    side = np.where(_shared(graph) & (graph.left - graph.right >= PASSING), 0.25, 0.0)
    side *= np.where(network.left_hand[graph.edge], 1.0, -1.0) * (graph.left - graph.right)
    owner = lines.line_of_point()
    moved = Polylines(lines.points + miters(lines) * side[owner][:, None], lines.start)
    length = arc_lengths(moved)[1]
    ahead = graph.direction >= 0
    begin = np.where(ahead, gap[graph.edge, 0], gap[graph.edge, 1])
    end = np.where(ahead, gap[graph.edge, 1], gap[graph.edge, 0])
    # Of a street too short for both its ends nothing is left, so that it belongs to the junction.
    scale = np.minimum(1.0, length / np.maximum(begin + end, 1e-9))
    whole = np.arange(graph.count)
    return pieces(moved, whole, begin * scale, length - end * scale)


def _shared(graph: LaneGraph) -> BoolArray:
    """(l,) whether a lane is one of the two that lie in the same place."""
    twin = np.zeros(graph.count, bool)
    same = (graph.edge[1:] == graph.edge[:-1]) & (graph.direction[1:] != 0)
    same &= np.isclose(graph.left[1:], graph.left[:-1])
    twin[1:] |= same
    twin[:-1] |= same
    return twin


def _upon_others(graph: LaneGraph) -> BoolArray:
    """(l,) whether a lane for bicycles lies on one for cars of its edge."""
    found = np.zeros(graph.count, bool)
    cars = graph.kind == KIND["drive"]
    for row in np.flatnonzero(graph.kind == KIND["cycle"]).tolist():
        beside = cars & (graph.edge == graph.edge[row])
        found[row] = ((graph.left[beside] > graph.right[row] + BESIDE)
                      & (graph.right[beside] < graph.left[row] - BESIDE)).any()  # fmt: skip
    return found


def _ways(
    network: RoadNetwork, graph: LaneGraph, lines: Polylines, open_lane: BoolArray,
    closed: BoolArray, tight: BoolArray, junction: IntArray, rank: IntArray, heights: Heights,
) -> tuple[tuple[Way, ...], dict[int, tuple[int, int]]]:  # fmt: skip
    """Gather lanes to ways; also say which way and place on it each lane of the graph has."""
    owner = lines.line_of_point()
    spatial = heights.lifted(graph.edge[owner].astype(np.int64), lines.points)
    shared = _shared(graph)
    width = graph.left - graph.right
    narrow = shared & (width < PASSING)
    width = np.where(shared & ~narrow, width / 2, width)
    walk = graph.kind == KIND["walk"]
    names = np.array(list(KIND))
    ways: list[Way] = []
    place_of: dict[int, tuple[int, int]] = {}
    first = np.searchsorted(graph.edge, np.arange(network.edge_count + 1))
    with_lane = np.unique(graph.edge[open_lane])
    for edge in with_lane.tolist():
        rows = np.arange(first[edge], first[edge + 1])
        for direction in (1, -1):
            keeps_left = bool(network.left_hand[edge])
            # The kerb is on the right of those who keep right, whichever way they go.
            kerb_last = keeps_left == (direction < 0)
            own = rows[open_lane[rows] & (graph.direction[rows] == direction)]
            beside = rows[walk[rows] & ((graph.left[rows] <= 0) == kerb_last)]
            ordered = np.concatenate([beside[:1], own[::-1] if kerb_last else own])
            if not len(ordered):
                continue
            shapes = []
            for row in ordered.tolist():
                shape = spatial[lines.start[row] : lines.start[row + 1]]
                shapes.append(shape[::-1] if walk[row] and direction < 0 else shape)
            lanes = tuple(
                Lane(row, str(names[graph.kind[row]]), float(width[row]),
                     float(graph.speed[row]) / 3.6, shape, bool(narrow[row]),
                     bool(closed[row]), bool(tight[row]))
                for row, shape in zip(ordered.tolist(), shapes, strict=True)
            )  # fmt: skip
            place_of |= {row: (len(ways), k) for k, row in enumerate(ordered.tolist())}
            ends = network.edge_nodes[edge][:: 1 if direction > 0 else -1]
            ways.append(
                Way(("" if direction > 0 else "-") + id_text(int(network.edge_id[edge])), edge,
                    int(junction[ends[0]]), int(junction[ends[1]]), int(rank[edge]), lanes,
                    _apart(graph, ordered))
            )  # fmt: skip
    return tuple(ways), place_of


def _with_locals(
    ways: tuple[Way, ...], city: City, network: RoadNetwork
) -> tuple[Way, ...]:  # fmt: skip
    """Tell of the lanes of streets who alone may drive there, where the map says it."""
    tags = city.layout.roads["tags"]
    local = np.full(len(tags), "", object)
    for key in _WHO:
        for name, words in _LOCAL.items():
            said = tags.str.contains(f'"{key}": *"(?:{words})"', regex=True)
            local[said.to_numpy().astype(bool)] = name
    found = []
    for way in ways:
        whose = str(local[network.edge_road[way.edge]])
        lanes = tuple(replace(lane, local=whose) for lane in way.lanes) if whose else way.lanes
        found.append(replace(way, lanes=lanes))
    return tuple(found)


def _apart(graph: LaneGraph, rows: IntArray) -> tuple[bool, ...]:
    """Return for neighbours whether something lies between them."""
    near, far = rows[:-1], rows[1:]
    gap = np.maximum(graph.right[near] - graph.left[far], graph.right[far] - graph.left[near])
    return tuple((gap > BESIDE).tolist())


def _crossings(
    network: RoadNetwork, halts: Halts, ways: tuple[Way, ...], heights: Heights,
    signals: BoolArray,
) -> tuple[Crossing, ...]:  # fmt: skip
    """Place where people cross before the junctions of ways."""
    own: dict[int, list[int]] = {}
    for number, way in enumerate(ways):
        own.setdefault(way.edge, []).append(number)
    found = []
    length = arc_lengths(heights.lines)[1]
    for edge, end in np.argwhere(halts.zebra).tolist():
        if edge not in own:
            continue  # the whole street lies within a junction
        first = ways[own[edge][0]]
        onward = not first.name.startswith("-")
        junction = first.source if (end == 0) == onward else first.target
        along = halts.zebra_at[edge, end] if end == 0 else length[edge] - halts.zebra_at[edge, end]
        middle, ahead = locate(heights.lines, [edge], [along])
        left = np.array([-ahead[0, 1], ahead[0, 0]]) * network.half_width[edge]
        # Counter-clockwise about the junction one comes from the right of who looks away from it.
        ends = np.stack([middle[0] - left, middle[0] + left])
        shape = heights.lifted(np.full(2, edge), ends if end == 0 else ends[::-1])
        crossed = tuple(way for way in own[edge] if ways[way].driven)
        found.append(Crossing(edge, end, junction, crossed,
                              float(halts.zebra_width[edge]), np.round(shape, 3),
                              bool(not halts.bare[edge, end] or signals[junction])))  # fmt: skip
    return tuple(found)


def links_of(
    graph: LaneGraph, lines: Polylines, open_lane: BoolArray,
    place_of: dict[int, tuple[int, int]], ways: tuple[Way, ...], moving: BoolArray,
) -> tuple[Link, ...]:  # fmt: skip
    """Connect each lane over the curves and short lanes of its junction to the next lanes."""
    onward: dict[int, list[tuple[int, int]]] = {}
    for row, (lane, goal) in enumerate(graph.connection.tolist()):
        onward.setdefault(lane, []).append((goal, row))
    whole = graph.lines
    curves = Polylines(graph.curve, graph.curve_start)
    links = []
    for lane in np.flatnonzero(open_lane).tolist():
        found: dict[int, tuple[float, FloatArray]] = {}
        tail = _after(whole, lines, lane)
        todo: list[tuple[int, tuple[int, ...], list[FloatArray]]] = [(lane, (), [tail])]
        while todo:
            here, passed, parts = todo.pop()
            for goal, row in onward.get(here, ()):
                edges = {int(graph.edge[each]) for each in (lane, *passed)}
                if int(graph.edge[goal]) in edges or not moving[goal]:
                    continue  # nobody turns on the spot
                way = [*parts, _line(curves, row)]
                if open_lane[goal]:
                    path = _joined([*way, _before(whole, lines, goal)])
                    size = float(np.hypot(*np.diff(path, axis=0).T).sum())
                    if goal not in found or size < found[goal][0]:
                        found[goal] = (size, path)
                elif len(passed) < LONGEST_CHAIN:
                    todo.append((goal, (*passed, goal), [*way, _line(whole, goal)]))
        for goal in sorted(found):
            source, target = place_of[lane], place_of[goal]
            ends = ways[source[0]].lanes[source[1]].shape, ways[target[0]].lanes[target[1]].shape
            links.append(Link(source, target, _risen(found[goal][1], ends)))
    return _merged(links)


def _merged(links: list[Link]) -> tuple[Link, ...]:
    """Connect one lane alone to each lane of the next edge; the others merge before.

    Nobody gives way within one stream of traffic, so two lanes that lead into one would run into
    each other. The lane with the fewest other ways on keeps its own.
    """
    choices = np.unique([link.source for link in links], axis=0, return_counts=True)
    others = dict(zip(map(tuple, choices[0].tolist()), choices[1].tolist(), strict=True))
    best: dict[tuple[int, tuple[int, int]], Link] = {}
    for link in links:
        key = (link.source[0], link.target)
        if key not in best or others[link.source] < others[best[key].source]:
            if key in best:
                others[best[key].source] -= 1
            best[key] = link
        else:
            others[link.source] -= 1
    kept = {id(link) for link in best.values()}
    return tuple(link for link in links if id(link) in kept)


def _line(lines: Polylines, row: int) -> FloatArray:
    return lines.points[lines.start[row] : lines.start[row + 1]]


def _after(whole: Polylines, lines: Polylines, lane: int) -> FloatArray:
    """Return what follows of a lane behind where one halts."""
    shape, end = shapely.LineString(_line(whole, lane)), _line(lines, lane)[-1]
    rest = substring(shape, shape.project(shapely.Point(end)), shape.length)
    return np.concatenate([end[None], shapely.get_coordinates(rest)[1:]])


def _before(whole: Polylines, lines: Polylines, lane: int) -> FloatArray:
    """Return what precedes of a lane the place where it begins."""
    shape, start = shapely.LineString(_line(whole, lane)), _line(lines, lane)[0]
    rest = substring(shape, 0.0, shape.project(shapely.Point(start)))
    return np.concatenate([shapely.get_coordinates(rest)[:-1], start[None]])


def _joined(parts: list[FloatArray]) -> FloatArray:
    """Join lines end to start; points that repeat are left out."""
    points = np.concatenate(parts)
    kept = np.r_[True, np.hypot(*np.diff(points, axis=0).T) > 1e-3]
    kept[-1] = True
    if kept.sum() < 2:  # two lanes that touch
        return points[[0, -1]]
    return np.asarray(points[kept])


def _risen(path: FloatArray, ends: tuple[FloatArray, FloatArray]) -> FloatArray:
    """Make a path across a junction rise evenly from one lane to the other."""
    along = np.r_[0.0, np.cumsum(np.hypot(*np.diff(path, axis=0).T))]
    share = along / max(along[-1], 1e-9)
    z = ends[0][-1, 2] + share * (ends[1][0, 2] - ends[0][-1, 2])
    shape = np.column_stack([path, z])
    shape[0], shape[-1] = ends[0][-1], ends[1][0]
    return np.round(shape, 3)
