"""The lane graph: middles of lanes between junctions, and the ways across junctions."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.city.city import City
from cityx.city.lanes import MOVEMENTS, LaneGraph
from cityx.city.section import BAND_KINDS, KIND, TRAVELLED, TURN
from cityx.geometry.arrays import FloatArray, IntArray
from cityx.geometry.polylines import Polylines, arc_lengths, miters, pieces
from cityx.geometry.ranges import numbered
from cityx.ids import hash_ids
from cityx.places.profiles import keeps_left
from cityx.protocol import Port, action, has_network
from cityx.road.network.network import DRIVABLE, arm_bearings, arms_of, road_network
from cityx.road.network.sections import Bands, bands_of

if TYPE_CHECKING:
    from cityx.city.layout import Layout
    from cityx.city.roads import RoadNetwork


LEFT, THROUGH, RIGHT, REVERSE = range(4)
STRAIGHT = np.radians(40.0)  # a turn by less goes straight on
BACK = np.radians(165.0)  # a turn by more goes back
ON_WAY = 0.01  # metres from a way to the middle of its segments
STEPS = 8  # pieces of a curve across a junction
SPEED_KMH = {
    "motorway": 120.0, "trunk": 100.0, "primary": 60.0, "secondary": 50.0, "tertiary": 50.0,
    "unclassified": 50.0, "residential": 30.0, "living_street": 15.0, "service": 20.0,
    "track": 30.0, "busway": 50.0,
}  # fmt: skip
USUAL_KMH = 50.0
CYCLE_KMH = 20.0
CYCLED, FROM_KERB = 1.0, 0.2  # metres of a one-way street for bicycles that come towards; off it
# Of streets that bicycles go against without a lane of their own.
_CYCLED = r'"oneway:bicycle": *"no"|"cycleway(?::both|:left|:right)?": *"opposite"'
_BACKWARD = r'"bicycle:backward": *"(?:yes|designated|official|permissive)"'
_TURNED = r'"oneway": *"(?:-1|reverse)"'


@dataclass(frozen=True)
class _Turn:
    """Pairs of arms of one node: traffic that arrives by one may leave by the other.

    Attributes
    ----------
    node, edge_in, side_in, edge_out, side_out
        (t,) int64; `side` is 1 at the end of an edge and 0 at its start.
    angle
        (t,) radians to the left, 0 straight on.
    """

    node: IntArray
    edge_in: IntArray
    side_in: IntArray
    edge_out: IntArray
    side_out: IntArray
    angle: FloatArray


def lane_graph(layout: Layout, network: RoadNetwork) -> LaneGraph:
    """Build the lanes of a network and the connections that turns allow.

    Parameters
    ----------
    layout
        Cross-sections, speeds and turn restrictions.
    network
        Its road network.

    Returns
    -------
    graph
        Lanes edge by edge from left to right. Where the map does not say which lane turns where,
        lanes on the outside turn off and all lanes go straight on.
    """
    bands = _with_cyclists(_both_ways(bands_of(layout, network)), layout, network)
    lines = network.lines
    middle = _middles(network, lines, bands)
    table = layout.roads.iloc[network.edge_road]
    speed = _speeds(table)[bands.edge]
    speed = np.where(bands.kind == KIND["cycle"], np.minimum(speed, CYCLE_KMH), speed)
    ids = _lane_ids(network, bands)
    origin, target, movement = _connections(layout, network, lines, bands)
    curve = ways_between(middle, origin, target)
    return LaneGraph(
        bands.edge.astype(np.int32), bands.kind, bands.direction, bands.left, bands.right,
        bands.turns, speed.astype(np.float32), ids, middle.start, middle.points,
        np.column_stack([origin, target]).astype(np.int32), movement.astype(np.uint8),
        curve.start, curve.points,
    )  # fmt: skip


def _both_ways(bands: Bands) -> Bands:
    """Make two lanes of each that is driven in both directions."""
    travelled = np.isin(bands.kind, [KIND[name] for name in TRAVELLED])
    shared = travelled & (bands.direction == 0)
    row = np.repeat(np.arange(len(bands.edge)), 1 + shared)
    second = np.r_[False, row[1:] == row[:-1]]
    doubled = bands.take(row)
    direction = np.where(shared[row], np.where(second, -1, 1), doubled.direction)
    return replace(doubled, direction=direction.astype(np.int8))


def _with_cyclists(bands: Bands, layout: Layout, network: RoadNetwork) -> Bands:
    """Add lanes in which bicycles go against one-way streets, on lanes of cars.

    Each lies at the kerb on which those who ride there keep, and comes last of its edge.
    """
    roads = layout.roads.iloc[network.edge_road]
    told = roads["oneway"].to_numpy(bool) & np.isin(roads["kind"].to_numpy(str), DRIVABLE)
    told &= _cycled_against(roads["tags"])
    back = (bands.kind == KIND["cycle"]) & (bands.direction <= 0)
    told[bands.edge[back]] = False
    edge = np.flatnonzero(told)
    if not len(edge):
        return bands
    on_right = network.left_hand[edge]
    kerb = np.where(on_right, -1.0, 1.0) * (network.half_width[edge] - FROM_KERB)
    inner = kerb - np.where(on_right, -1.0, 1.0) * CYCLED
    count = len(edge)
    more = Bands(
        edge, np.full(count, KIND["cycle"], np.uint8), np.full(count, -1, np.int8),
        np.zeros(count, np.uint8), np.maximum(kerb, inner), np.minimum(kerb, inner),
    )  # fmt: skip
    joined = Bands(*(np.concatenate([getattr(part, column) for part in (bands, more)])
                     for column in Bands.__dataclass_fields__))  # fmt: skip
    return joined.take(np.argsort(joined.edge, kind="stable"))


def _cycled_against(tags: Any) -> NDArray[np.bool_]:
    """(e,) whether tags let bicycles go against their one-way street."""
    said, back, ahead, turned = (
        tags.str.contains(pattern, regex=True).to_numpy().astype(bool)
        for pattern in (_CYCLED, _BACKWARD, _BACKWARD.replace("backward", "forward"), _TURNED)
    )
    return np.asarray(said | np.where(turned, ahead, back))


def _lane_ids(network: RoadNetwork, bands: Bands) -> NDArray[np.uint64]:
    """(l,) ids from the edge's and the lane's place on it."""
    first = np.searchsorted(bands.edge, bands.edge)
    place = np.arange(len(bands.edge)) - first
    return hash_ids(0, "lane", network.edge_id[bands.edge], place)


def _speeds(table: Any) -> FloatArray:
    """(e,) km/h, of the map or usual for the class."""
    kind = table["kind"].to_numpy().astype(str)
    plain = np.char.replace(kind, "_link", "")
    known, index = np.unique(plain, return_inverse=True)
    usual = np.array([SPEED_KMH.get(word, USUAL_KMH) for word in known.tolist()] or [0.0])
    usual = usual[index] * np.where(np.char.endswith(kind, "_link"), 0.7, 1.0)
    told = table["maxspeed_kmh"].to_numpy(float)
    return np.where(np.isfinite(told) & (told > 0), told, usual)


def _middles(network: RoadNetwork, lines: Polylines, bands: Bands) -> Polylines:
    """Middles of lanes from junction to junction, in their direction of travel."""
    length = arc_lengths(lines)[1]
    begin = np.minimum(network.trim[:, 0], length)[bands.edge]
    end = np.maximum(length - network.trim[:, 1], network.trim[:, 0])[bands.edge]
    cut = pieces(lines, bands.edge, begin, end)
    owner = cut.line_of_point()
    points = cut.points + miters(cut) * bands.middle[owner][:, None]
    # Lanes against the edge run from its end.
    back = bands.direction[owner] < 0
    place = np.arange(len(owner)) - cut.start[owner]
    size = np.diff(cut.start)[owner]
    return Polylines(points[cut.start[owner] + np.where(back, size - 1 - place, place)], cut.start)


def _connections(
    layout: Layout, network: RoadNetwork, lines: Polylines, bands: Bands
) -> tuple[IntArray, IntArray, IntArray]:
    """Lanes that lead into one another: from, to and movement, (c,) each."""
    turns = _turns(network, lines)
    keep = _allowed(layout, network, turns, _passable(bands, turns))
    turns = _Turn(*(getattr(turns, name)[keep] for name in _Turn.__dataclass_fields__))
    movement = _movements(turns)
    pairs: list[tuple[int, int, int]] = []
    streets = _by_arm(bands, KIND["drive"], leaving=True)
    for name in TRAVELLED:
        arriving = _by_arm(bands, KIND[name], leaving=False)
        # Buses and bicycles go on among the cars where they have no lane of their own.
        leaving = streets | _by_arm(bands, KIND[name], leaving=True)
        pairs += _paired(turns, movement, arriving, leaving, bands, network.left_hand)
    for name in ("bus", "cycle"):
        pairs += _onto_own_arms(turns, movement, streets, bands, network.left_hand, KIND[name])
    if not pairs:
        none = np.zeros(0, np.int64)
        return none, none, none
    found = np.unique(np.array(pairs, np.int64), axis=0)
    found = np.unique(np.concatenate([found, _onto_own(found, bands, network.left_hand)]), axis=0)
    return found[:, 0], found[:, 1], found[:, 2]


def _onto_own_arms(
    turns: _Turn, movement: IntArray, streets: dict[tuple[int, int], list[int]], bands: Bands,
    left_hand: NDArray[np.bool_], kind: int,
) -> list[tuple[int, int, int]]:  # fmt: skip
    """Return pairs that lead buses or bicycles from among cars into arms that are theirs alone."""
    alone = {
        arm: lanes
        for arm, lanes in _by_arm(bands, kind, leaving=True).items()
        if arm not in streets
    }
    onward = turns.edge_in != turns.edge_out
    some = _Turn(*(getattr(turns, name)[onward] for name in _Turn.__dataclass_fields__))
    arriving = _by_arm(bands, KIND["drive"], leaving=False)
    return _paired(some, movement[onward], arriving, alone, bands, left_hand) if alone else []


def _onto_own(pairs: IntArray, bands: Bands, left_hand: NDArray[np.bool_]) -> IntArray:
    """(k, 3) pairs that lead bicycles from among the cars into a lane of their own.

    Where one begins behind a junction it is entered from the lane at the kerb of those that lead
    there.
    """
    cycle = np.flatnonzero((bands.kind == KIND["cycle"]) & (bands.direction != 0))
    arm = 2 * bands.edge + (bands.direction > 0)
    inward = bands.middle * bands.direction * np.where(left_hand[bands.edge], -1.0, 1.0)
    cycle = cycle[np.lexsort((inward[cycle], arm[cycle]))]
    arms, first = np.unique(arm[cycle], return_index=True)
    origin, goal, _ = pairs.T
    led = (bands.kind[[origin, goal]] == KIND["drive"]).all(axis=0)
    led &= np.isin(arm[goal], arms) & ~np.isin(arm[origin], arms)
    rows = np.flatnonzero(led)
    rows = rows[np.lexsort((goal[rows], inward[origin[rows]], arm[goal[rows]], arm[origin[rows]]))]
    between = np.column_stack([arm[origin[rows]], arm[goal[rows]]])
    rows = rows[np.sort(np.unique(between, axis=0, return_index=True)[1])]
    found = pairs[rows].copy()
    found[:, 1] = cycle[first[np.searchsorted(arms, arm[goal[rows]])]]
    return np.asarray(found)


def turns_of_lanes(layout: Layout, network: RoadNetwork, bands: Bands) -> IntArray:
    """(b,) bits of `cityx.city.section.TURN`: the movements that each band's traffic may take."""
    lines = network.lines
    origin, target, movement = _connections(layout, network, lines, bands)
    own = (bands.kind[target] != KIND["cycle"]) | (bands.kind[origin] == KIND["cycle"])
    origin, movement = origin[own], movement[own]
    found = np.zeros(len(bands.edge), np.int64)
    np.bitwise_or.at(found, origin, 1 << movement)
    return found


def _turns(network: RoadNetwork, lines: Polylines) -> _Turn:
    """All pairs of arms at all nodes, also each with itself."""
    node, edge, side = arms_of(lines, network.edge_nodes)
    bearing = arm_bearings(lines, edge, side)
    degree = np.bincount(node, minlength=len(network.node_position))
    size = degree[node]
    row = np.repeat(np.arange(len(node)), size)
    first = np.searchsorted(node, node)
    other = first[row] + numbered(size)
    # Arriving runs against the arm's bearing.
    angle = np.mod(bearing[other] - (bearing[row] + np.pi) + np.pi, 2 * np.pi) - np.pi
    return _Turn(node[row], edge[row], side[row], edge[other], side[other], np.round(angle, 6))


def _passable(bands: Bands, turns: _Turn) -> NDArray[np.bool_]:
    """(t,) whether a lane arrives by the one arm of a turn and another leaves by the other."""
    rows = np.isin(bands.kind, [KIND[name] for name in TRAVELLED]) & (bands.direction != 0)
    end = 2 * bands.edge[rows] + (bands.direction[rows] > 0)  # where the lane ends
    arrives = np.isin(2 * turns.edge_in + turns.side_in, end)
    leaves = np.isin(2 * turns.edge_out + turns.side_out, end ^ 1)
    return np.asarray(arrives & leaves)


def _movements(turns: _Turn) -> IntArray:
    """(t,) index into `MOVEMENTS` by the angle."""
    size = np.abs(turns.angle)
    turned = np.where(turns.angle > 0, LEFT, RIGHT)
    found = np.where(size < STRAIGHT, THROUGH, np.where(size > BACK, REVERSE, turned))
    return np.asarray(np.where(turns.edge_in == turns.edge_out, REVERSE, found))


def _allowed(
    layout: Layout, network: RoadNetwork, turns: _Turn, passable: NDArray[np.bool_]
) -> NDArray[np.bool_]:
    """(t,) whether the turn restrictions of the map allow a turn.

    Of what is allowed alone from one way onto several, each is; what names no turn that lanes could
    make would close the street and is a drawing mistake.
    """
    allowed = np.ones(len(turns.node), bool)
    rules = layout.restrictions
    if not len(rules) or not len(allowed):
        return allowed
    from scipy.spatial import cKDTree

    place = np.column_stack([rules.geometry.x, rules.geometry.y])
    gap, node = cKDTree(network.node_position).query(place)
    source = _arm_sources(layout, network)
    arriving = source[turns.edge_in, turns.side_in]
    leaving = source[turns.edge_out, turns.side_out]
    columns = (rules["from_source"], rules["to_source"], rules["only"])
    alone: dict[tuple[int, str], list[str]] = {}
    # The turns of a node follow one another, and rules are about a node each.
    first = np.searchsorted(turns.node, node).tolist()
    stop = np.searchsorted(turns.node, node, side="right").tolist()
    rows = {int(at): slice(*own) for at, *own in zip(node, first, stop, strict=True)}
    for near, at, (begin, end, only) in zip(gap, node, zip(*columns, strict=True), strict=True):
        if near > 0.5:
            continue
        if only:
            alone.setdefault((int(at), begin), []).append(end)
        else:
            own = rows[int(at)]
            allowed[own] &= (arriving[own] != begin) | (leaving[own] != end)
    for (at, begin), ends in alone.items():
        own = rows[at]
        here = arriving[own] == begin
        named = here & np.isin(leaving[own], ends)
        if (named & passable[own]).any():
            allowed[own] &= ~here | named
    return allowed


def _arm_sources(layout: Layout, network: RoadNetwork) -> NDArray[np.str_]:
    """(e, 2) the way of the map that each edge starts and ends with; it may join several."""
    source = layout.roads["source"].to_numpy().astype(str)
    found = np.repeat(source[network.edge_road][:, None], 2, axis=1)
    shapes = layout.roads.geometry.to_numpy()
    tree = shapely.STRtree(shapes)
    for side, step in ((0, 1), (1, -1)):
        end = network.point_start[side:][: network.edge_count] - side
        place = shapely.points((network.points[end] + network.points[end + step]) / 2)
        arm, way = tree.query(place, predicate="dwithin", distance=ON_WAY)
        # Of several ways at one place the edge's own is as good as any.
        other = np.bincount(arm[way == network.edge_road[arm]], minlength=len(found)) == 0
        cars = np.isin(layout.roads["kind"].to_numpy().astype(str)[way], DRIVABLE)
        chosen = other[arm] & cars
        found[arm[chosen], side] = source[way[chosen]]
    return found


def _by_arm(bands: Bands, kind: int, *, leaving: bool) -> dict[tuple[int, int], list[int]]:
    """List the lanes of each arm from left to right as its traffic sees them.

    Keys are (edge, side); lanes that arrive at the end of an edge run along it.
    """
    rows = np.flatnonzero((bands.kind == kind) & (bands.direction != 0))
    found: dict[tuple[int, int], list[int]] = {}
    for row, edge, direction in zip(
        rows.tolist(), bands.edge[rows].tolist(), bands.direction[rows].tolist(), strict=True
    ):
        side = int((direction > 0) != leaving)
        found.setdefault((edge, side), []).append(row)
    for (_, side), lanes in found.items():
        if side == int(leaving):  # they run against the edge, whose bands count from its left
            lanes.reverse()
    return found


def _paired(
    turns: _Turn, movement: IntArray, arriving: dict[tuple[int, int], list[int]],
    leaving: dict[tuple[int, int], list[int]], bands: Bands, left_hand: NDArray[np.bool_],
) -> list[tuple[int, int, int]]:  # fmt: skip
    """Connect the lanes of each arm to those of the arms that its traffic may take.

    Back along the same arm only where nothing else leads on.
    """
    bits = bands.turns.tolist()
    exits: dict[tuple[int, int], list[tuple[int, float, tuple[int, int]]]] = {}
    for edge, side, out, out_side, way, angle in zip(
        turns.edge_in.tolist(), turns.side_in.tolist(), turns.edge_out.tolist(),
        turns.side_out.tolist(), movement.tolist(), turns.angle.tolist(), strict=True,
    ):  # fmt: skip
        if (edge, side) in arriving and (out, out_side) in leaving:
            exits.setdefault((edge, side), []).append((way, angle, (out, out_side)))
    pairs = []
    for arm, found in exits.items():
        ways = [each for each in found if each[2] != arm] or found
        lanes = arriving[arm]
        keeps_left_here = bool(left_hand[arm[0]])
        for way, chosen, target in _shares(lanes, ways, bits, left_hand=keeps_left_here):
            for origin, goal in _matched(chosen, leaving[target], way, left_hand=keeps_left_here):
                pairs.append((origin, goal, way))
    return pairs


def _shares(
    lanes: list[int], ways: list[tuple[int, float, tuple[int, int]]], bits: list[int], *,
    left_hand: bool,
) -> list[tuple[int, list[int], tuple[int, int]]]:  # fmt: skip
    """Return which lanes of an arm serve each of its exits.

    Arrows of the map decide. Without them the outermost lane on either side turns off that way,
    and every lane goes straight on; where nothing lies straight on, the lanes are divided.
    """
    if any(bits[lane] for lane in lanes):
        return _by_arrows(lanes, ways, bits)
    onward = [way for way, _, _ in ways]
    found = []
    for way, _, target in sorted(ways, key=lambda item: (-item[1], item[2])):
        if way == THROUGH or len(lanes) == 1:
            chosen = lanes
        elif way == REVERSE:
            chosen = lanes[-1:] if left_hand else lanes[:1]
        else:
            chosen = _turning(lanes, way, onward)
        found.append((way, chosen, target))
    return found


def _by_arrows(
    lanes: list[int], ways: list[tuple[int, float, tuple[int, int]]], bits: list[int]
) -> list[tuple[int, list[int], tuple[int, int]]]:
    """Follow the arrows of the map.

    An arrow names an exit by its place among the others rather than by its angle: where none turns
    left, the leftmost of several is meant. Exits without an arrow are served from the nearest lane,
    lanes whose arrows mean no exit by the nearest exit.
    """
    ordered = sorted(ways, key=lambda item: (-item[1], item[2]))
    named = [way for way, _, _ in ordered]
    forward = [number for number, way in enumerate(named) if way != REVERSE]
    told = 0
    for lane in lanes:
        told |= bits[lane]
    if len(forward) > 1:
        if told & TURN["left"] and LEFT not in named:
            named[forward[0]] = LEFT
        if told & TURN["right"] and RIGHT not in named:
            named[forward[-1]] = RIGHT
    served = [[lane for lane in lanes if bits[lane] & TURN[MOVEMENTS[way]]] for way in named]
    for number, chosen in enumerate(served):
        if not chosen:
            on_the_left = named[number] in (LEFT, REVERSE) or number < len(served) / 2
            chosen += lanes[:1] if on_the_left else lanes[-1:]
    for lane in lanes:
        if not any(lane in chosen for chosen in served):
            place = 0 if bits[lane] & TURN["left"] else len(served) - 1
            if bits[lane] & TURN["through"] or not bits[lane]:
                place = min(range(len(ordered)), key=lambda number: abs(ordered[number][1]))
            served[place] = [each for each in lanes if each == lane or each in served[place]]
    return [(way, chosen, target) for (way, _, target), chosen in zip(ordered, served, strict=True)]


def _turning(lanes: list[int], way: int, onward: list[int]) -> list[int]:
    """Return the lanes that turn off to one side where no arrows say so."""
    if THROUGH in onward:
        return lanes[:1] if way == LEFT else lanes[-1:]
    if LEFT in onward and RIGHT in onward:
        half = (len(lanes) + 1) // 2
        return lanes[:half] if way == LEFT else lanes[-half:]
    return lanes


def _matched(
    lanes: list[int], goals: list[int], way: int, *, left_hand: bool
) -> list[tuple[int, int]]:
    """Connect lanes to those of the next edge, side by side from the side they turn to."""
    outer_right = way == RIGHT or (way == THROUGH and not left_hand)
    if outer_right:
        lanes, goals = lanes[::-1], goals[::-1]
    pairs = [(lane, goals[min(k, len(goals) - 1)]) for k, lane in enumerate(lanes)]
    if way == THROUGH:  # lanes that begin at the junction are entered from the last one beside them
        pairs += [(lanes[-1], goal) for goal in goals[len(lanes) :]]
    return pairs


def ways_between(middle: Polylines, origin: IntArray, target: IntArray) -> Polylines:
    """Cubic curves from the ends of lanes to the starts of others, along the lanes at both ends."""
    count = len(origin)
    if not count:
        return Polylines(np.zeros((0, 2)), np.zeros(1, np.int64))
    first, last = middle.start[:-1], middle.start[1:] - 1
    a, b = middle.points[last[origin]], middle.points[first[target]]
    ahead = _unit(a - middle.points[last[origin] - 1])
    onward = _unit(middle.points[first[target] + 1] - b)
    reach = np.hypot(*(b - a).T)[:, None]
    # A handle of this share makes a quarter turn a circle within 0.03 % of its radius.
    cosine = np.clip((ahead * onward).sum(axis=1), -1.0, 1.0)
    turn = np.maximum(np.arccos(cosine), 1e-3)
    share = (4.0 / 3.0 * np.tan(turn / 4.0) / (2.0 * np.sin(turn / 2.0)))[:, None]
    c, d = a + ahead * reach * share, b - onward * reach * share
    t = (np.arange(STEPS + 1) / STEPS)[None, :, None]
    p, q, r, s = (point[:, None] for point in (a, c, d, b))
    curve = (1 - t) ** 3 * p + 3 * (1 - t) ** 2 * t * q + 3 * (1 - t) * t**2 * r + t**3 * s
    start = np.arange(count + 1, dtype=np.int64) * (STEPS + 1)
    return Polylines(np.round(curve.reshape(-1, 2), 6), start)


def _unit(vectors: FloatArray) -> FloatArray:
    return np.asarray(vectors / np.maximum(np.hypot(*vectors.T), 1e-9)[:, None])


@action(
    "road/lanes-v1",
    limits=[
        "Turn restrictions over a way, rather than at a node, are read at its first node.",
        "Lanes that change their width along an edge keep the width of its cross-section.",
    ],
    requires=("layout", has_network()),
    takes=(Port("network", "line", role="road_network"),),
    gives=(Port("lanes", "line", role="lane_graph"),),
)
def lanes(city: City) -> City:
    """Divide roads into lanes and connect them across junctions, for traffic and for routes."""
    network = city.network
    if network is None:
        network = road_network(city.layout, left_hand=keeps_left(city.frame))
    return replace(city, network=network, lanes=lane_graph(city.layout, network))


__all__ = ["BAND_KINDS", "lane_graph", "lanes"]
