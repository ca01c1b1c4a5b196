"""Streets as a simulator of traffic needs them: one-way edges between junctions, and links.

The lane graph has a lane from every junction to the next, however near. A vehicle that halts on a
lane shorter than itself blocks what crosses behind it, so lanes shorter than a car belong to the
junction here, and lanes end where one halts: before the zebra.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.ops import substring

from cityx.city.section import KIND
from cityx.geometry.chains import components
from cityx.geometry.identity import id_text
from cityx.geometry.polylines import (
    Polylines,
    arc_lengths,
    miters,
    pieces,
    to_linestrings,
    values_along,
)

if TYPE_CHECKING:
    from cityx.city.city import City
    from cityx.city.lanes import LaneGraph
    from cityx.city.roads import RoadNetwork

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]

SHORTEST = 5.0  # metres, a car: shorter lanes belong to the junction
PASSING = 4.0  # metres of a lane for both ways on which two cars pass each other
LONGEST_CHAIN = 12  # short lanes that one way across a junction runs over at most
BESIDE = 0.3  # metres between two lanes over which one still changes from one to the other


@dataclass(frozen=True)
class Halts:
    """Where traffic halts before junctions, and what rules them.

    Attributes
    ----------
    gap
        (e, 2) float64, metres from where the lanes of an edge begin and end, at its start and its
        end, to the line before which one halts there.
    signals
        (n,) bool, whether signals rule a node of the network.
    rank
        (e,) int64, the higher the more important; traffic from lower ranks gives way.
    """

    gap: FloatArray
    signals: BoolArray
    rank: IntArray


@dataclass(frozen=True)
class Lane:
    """A lane as the simulator has it.

    Attributes
    ----------
    row
        Of the lane graph.
    kind
        One of `cityx.city.section.BAND_KINDS`.
    width
        Metres.
    speed
        Metres per second.
    shape
        (k, 3) float64, its middle in the direction of travel.
    narrow
        Whether it is driven in both directions and two cars cannot pass each other on it.
    """

    row: int
    kind: str
    width: float
    speed: float
    shape: FloatArray
    narrow: bool

    @property
    def length(self) -> float:
        """Metres."""
        return float(np.linalg.norm(np.diff(self.shape, axis=0), axis=1).sum())


@dataclass(frozen=True)
class Way:
    """One direction of an edge of the network.

    Attributes
    ----------
    name
        Id of the edge of the network, with a minus where it is driven against it.
    edge
        Row of the network.
    source, target
        Junctions it leads from and to.
    rank
        As of `Halts`.
    lanes
        From the kerb to the middle of the road; walks come first.
    apart
        For each lane but the last, whether something lies between it and the next.
    """

    name: str
    edge: int
    source: int
    target: int
    rank: int
    lanes: tuple[Lane, ...]
    apart: tuple[bool, ...]

    @property
    def length(self) -> float:
        """Metres, the mean of its lanes."""
        return float(np.mean([lane.length for lane in self.lanes]))


@dataclass(frozen=True)
class Link:
    """A way across a junction from one lane to another.

    Attributes
    ----------
    source, target
        Way and lane on it.
    shape
        (k, 3) float64, from the end of the one lane to the start of the other.
    """

    source: tuple[int, int]
    target: tuple[int, int]
    shape: FloatArray


@dataclass(frozen=True)
class Streets:
    """What a simulator knows of the streets of a city.

    Attributes
    ----------
    ways
        The ways.
    links
        The links between their lanes.
    place
        (j, 3) float64, the junctions.
    signals
        (j,) bool, whether signals rule them.
    left_hand
        Whether traffic keeps to the left.
    """

    ways: tuple[Way, ...]
    links: tuple[Link, ...]
    place: FloatArray
    signals: BoolArray
    left_hand: bool


def streets_of(city: City, halts: Halts) -> Streets:
    """Gather the streets of a city that has lanes.

    Parameters
    ----------
    city
        City with a network and a lane graph; heights of streets are its network's.
    halts
        Where traffic halts.

    Returns
    -------
    streets
        In the order of the network's edges; the same city gives the same streets.
    """
    network, graph = city.network, city.lanes
    assert network is not None
    assert graph is not None
    lines = _lane_lines(network, graph, halts)
    length = arc_lengths(lines)[1]
    moving = np.asarray(graph.travelled & (graph.direction != 0))
    longest = np.zeros(network.edge_count)
    np.maximum.at(longest, graph.edge[moving], length[moving])
    short = longest < SHORTEST
    junction = components(network.edge_nodes[short].astype(np.int64), len(network.node_position))
    _, junction = np.unique(junction, return_inverse=True)
    heights = _Heights(city, network)
    open_lane = moving & ~short[graph.edge]
    ways, place_of = _ways(network, graph, lines, open_lane, junction, halts, heights)
    links = _links(graph, lines, open_lane, place_of, ways, moving)
    place, signals = _junctions(city, network, junction, halts)
    left_hand = bool(network.left_hand.any())
    return _unlooped(Streets(ways, links, place, signals, left_hand))


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
    """Divide ways that lead back to where they come from: no simulator knows such edges."""
    ways, links, place = list(streets.ways), list(streets.links), list(streets.place)
    for number, way in enumerate(streets.ways):
        if way.source != way.target:
            continue
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
    return replace(streets, ways=tuple(ways), links=tuple(links), place=np.array(place),
                   signals=signals)  # fmt: skip


def _halves(shape: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Divide a line in its middle."""
    whole = shapely.LineString(shape)
    parts = (substring(whole, *ends, normalized=True) for ends in ((0.0, 0.5), (0.5, 1.0)))
    near, far = (np.round(shapely.get_coordinates(part, include_z=True), 3) for part in parts)
    return near, far


def _lane_lines(network: RoadNetwork, graph: LaneGraph, halts: Halts) -> Polylines:
    """Middles of lanes from where one has crossed to where one halts, in the direction of travel.

    Where two cars pass each other on a lane for both ways, each keeps to its side of it.
    """
    lines = Polylines(graph.points, graph.point_start)
    side = np.where(_shared(graph) & (graph.left - graph.right >= PASSING), 0.25, 0.0)
    side *= np.where(network.left_hand[graph.edge], 1.0, -1.0) * (graph.left - graph.right)
    owner = lines.line_of_point()
    moved = Polylines(lines.points + miters(lines) * side[owner][:, None], lines.start)
    length = arc_lengths(moved)[1]
    ahead = graph.direction >= 0
    begin = np.where(ahead, halts.gap[graph.edge, 0], halts.gap[graph.edge, 1])
    end = np.where(ahead, halts.gap[graph.edge, 1], halts.gap[graph.edge, 0])
    # A street too short for its zebras keeps its middle, so that the two ends never cross.
    scale = np.minimum(1.0, 0.5 * length / np.maximum(np.maximum(begin, end), 1e-9))
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


class _Heights:
    """Heights of carriageways, found by edge and place along it; a class for what is prepared."""

    def __init__(self, city: City, network: RoadNetwork) -> None:
        self.terrain = city.terrain
        self.lines = Polylines(network.points, network.point_start)
        self.network = network
        self.shapes = to_linestrings(self.lines)

    def lifted(self, edge: IntArray, points: FloatArray) -> FloatArray:
        """(k, 3) places of edges at the height of the carriageway."""
        along = shapely.line_locate_point(self.shapes[edge], shapely.points(points))
        lift = values_along(self.lines, self.network.lift, edge, along)
        own = values_along(self.lines, self.network.z, edge, along)
        z = np.where(lift != 0.0, own, self.terrain.height_at(points))
        return np.column_stack([points, np.round(z, 3)])


def _ways(
    network: RoadNetwork, graph: LaneGraph, lines: Polylines, open_lane: BoolArray,
    junction: IntArray, halts: Halts, heights: _Heights,
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
                     float(graph.speed[row]) / 3.6, shape, bool(narrow[row]))
                for row, shape in zip(ordered.tolist(), shapes, strict=True)
            )  # fmt: skip
            place_of |= {row: (len(ways), k) for k, row in enumerate(ordered.tolist())}
            ends = network.edge_nodes[edge][:: 1 if direction > 0 else -1]
            ways.append(
                Way(("" if direction > 0 else "-") + id_text(int(network.edge_id[edge])), edge,
                    int(junction[ends[0]]), int(junction[ends[1]]), int(halts.rank[edge]), lanes,
                    _apart(graph, ordered))
            )  # fmt: skip
    return tuple(ways), place_of


def _apart(graph: LaneGraph, rows: IntArray) -> tuple[bool, ...]:
    """Tell of neighbours whether something lies between them."""
    near, far = rows[:-1], rows[1:]
    gap = np.maximum(graph.right[near] - graph.left[far], graph.right[far] - graph.left[near])
    return tuple((gap > BESIDE).tolist())


def _links(
    graph: LaneGraph, lines: Polylines, open_lane: BoolArray,
    place_of: dict[int, tuple[int, int]], ways: tuple[Way, ...], moving: BoolArray,
) -> tuple[Link, ...]:  # fmt: skip
    """Lead each lane over the curves and the short lanes of its junction to the next lanes."""
    onward: dict[int, list[tuple[int, int]]] = {}
    for row, (lane, goal) in enumerate(graph.connection.tolist()):
        onward.setdefault(lane, []).append((goal, row))
    whole = Polylines(graph.points, graph.point_start)
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
    return tuple(links)


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
    """Let a way across a junction rise evenly from the one lane to the other."""
    along = np.r_[0.0, np.cumsum(np.hypot(*np.diff(path, axis=0).T))]
    share = along / max(along[-1], 1e-9)
    z = ends[0][-1, 2] + share * (ends[1][0, 2] - ends[0][-1, 2])
    shape = np.column_stack([path, z])
    shape[0], shape[-1] = ends[0][-1], ends[1][0]
    return np.round(shape, 3)
