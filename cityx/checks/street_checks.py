"""Checks that streets can be driven: a surface under each, and lanes that lead on everywhere."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.checks.check import NAMED, Check
from cityx.checks.furniture_checks import ground_gaps
from cityx.checks.height_checks import carriageway_places, without_room
from cityx.city import City
from cityx.city.ground import ON_ROADWAY, ROADWAY
from cityx.city.lanes import LaneGraph
from cityx.city.routes import cars, pieces_of, stranded
from cityx.geometry.arrays import FloatArray, IntArray
from cityx.geometry.chains import components
from cityx.geometry.polylines import Polylines, every, locate, to_linestrings
from cityx.geometry.ranges import counted

OFF_SURFACE = 0.6  # metres between a carriageway and what carries it; on slopes up to half that
BORDER = 2.0  # metres from the site's rectangle, where streets are cut
APART = 5.0  # metres between the places of a street that are tested; no deck is shorter
SPACING = 2.0  # metres between the places of a turn that are tested
BLOCKED = 0.5  # share of the turns over a junction that leave its surface; corners cut are less
ARMS = 3  # from which a node is a junction


def check_streets(city: City) -> list[Check]:
    """Run every check on streets; none where there is no network or no ground."""
    network = city.network
    if network is None or not network.edge_count or "ground" not in city.scene.meshes:
        return []
    bare = bare_places(city)
    checks = [
        Check("streets_without_surface", float(len(bare)), 0,
              f"places on carriageways over {OFF_SURFACE:g} m from any ground or deck",
              ids=_spots(bare))
    ]  # fmt: skip
    if city.lanes is None or not city.lanes.count:
        return checks
    closed, covered = closed_junctions(city), covered_junctions(city)
    return [
        *checks,
        Check("junctions_closed", float(len(closed)), 0,
              "junctions that cars come to and leave, but over which no way leads",
              ids=_spots(network.node_position[closed])),
        Check("junctions_covered", float(len(covered)), 0,
              f"junctions where over {BLOCKED:.0%} of the ways across lie on no roadway",
              ids=_spots(network.node_position[covered])),
    ]  # fmt: skip


def _spots(points: FloatArray) -> tuple[str, ...]:
    return tuple(f"({x:.1f}, {y:.1f})" for x, y in points[:NAMED].tolist())


def bare_places(city: City) -> FloatArray:
    """Return the (k, 2) places on carriageways that no ground and no deck carries, metres.

    What lies under buildings, where the ground is open whatever passes over or below it, is left
    out, and what lies around crossings for which the map leaves no room. So are tracks at level of
    detail 0, which lays none.
    """
    xy, z = carriageway_places(city, APART, without=("track",) if city.lod == 0 else ())
    xy, z = xy[(inside := _within(city, xy) & ~without_room(city, xy))], z[inside]
    if city.ground is not None:
        level = np.abs(z - city.terrain.height_at(xy)) < OFF_SURFACE
        xy, z = xy[(kept := ~(level & city.ground.on(xy, "building")))], z[kept]
    gap = ground_gaps(city, np.column_stack([xy, z]), OFF_SURFACE)
    return np.asarray(xy[gap > OFF_SURFACE])


def _within(city: City, xy: FloatArray) -> NDArray[np.bool_]:
    low, high = np.array(city.layout.extent[:2]), np.array(city.layout.extent[2:])
    return np.asarray(((xy > low + BORDER) & (xy < high - BORDER)).all(axis=1))


def closed_junctions(city: City) -> IntArray:
    """Return the nodes that cars come to and leave while no connection leads over them, (k,)."""
    graph, network = city.lanes, city.network
    assert graph is not None
    assert network is not None
    drivable = cars(graph)
    first, last = _nodes(city)
    reached, left, crossed = (np.zeros(len(network.node_degree), bool) for _ in range(3))
    reached[last[drivable]] = True
    left[first[drivable]] = True
    crossed[last[graph.connection[drivable[graph.connection].all(axis=1), 0]]] = True
    return np.flatnonzero(reached & left & ~crossed & (network.node_degree >= ARMS))


def _nodes(city: City) -> tuple[IntArray, IntArray]:
    """Return the nodes where each lane begins and ends, (l,) each."""
    assert city.lanes is not None
    assert city.network is not None
    ends = city.network.edge_nodes[city.lanes.edge].astype(np.int64)
    ahead = city.lanes.direction > 0
    return np.where(ahead, ends[:, 0], ends[:, 1]), np.where(ahead, ends[:, 1], ends[:, 0])


def covered_junctions(city: City) -> IntArray:
    """Return the nodes over which cars would drive on something else than a roadway, (k,).

    Ramps and cuttings, for which the ground opens, carry what leads over them. Junctions on bridges
    and in tunnels, which have no face of the ground, aisles in buildings, and turns from and to
    tracks at level of detail 0, which lays none, are left out.
    """
    graph, network, ground = city.lanes, city.network, city.ground
    if graph is None or network is None or ground is None:
        return np.zeros(0, np.int64)
    turning = cars(graph)[graph.connection].all(axis=1)
    if city.lod == 0:
        kind = city.layout.roads["kind"].to_numpy(str)[network.edge_road[graph.edge]]
        turning &= (kind[graph.connection] != "track").all(axis=1)
    turns = np.flatnonzero(turning)
    if not len(turns):
        return np.zeros(0, np.int64)
    lines = Polylines(graph.curve, graph.curve_start)
    turn, along = every(shapely.length(to_linestrings(lines))[turns], SPACING)
    xy = locate(lines, turns[turn], along)[0]
    node = _nodes(city)[1][graph.connection[turns[turn], 0]]
    kept = _within(city, xy) & ~_lifted(city)[node] & ~ground.on(xy, "building")
    off = kept & ~ground.on(xy, *ROADWAY, *ON_ROADWAY, "void")
    total = np.bincount(node[kept], minlength=len(network.node_degree))
    missed = np.bincount(node[off], minlength=len(total))
    return np.flatnonzero((missed > BLOCKED * total) & (network.node_degree >= ARMS))


def _lifted(city: City) -> NDArray[np.bool_]:
    """(n,) whether a street at a node lies off the ground."""
    network = city.network
    assert network is not None
    found = np.zeros(len(network.node_degree), bool)
    for end, point in ((0, network.point_start[:-1]), (1, network.point_start[1:] - 1)):
        found[network.edge_nodes[np.abs(network.lift[point]) > OFF_SURFACE, end]] = True
    return found


def _lead_away(
    edge: IntArray, first: IntArray, last: IntArray, open_to_cars: NDArray[np.bool_]
) -> NDArray[np.bool_]:
    """(n,) whether cars can leave the end of a lane other than by turning back where they came."""
    count = int(max(first.max(initial=-1), last.max(initial=-1))) + 1
    begin = np.bincount(first[open_to_cars], minlength=count)
    here, back = edge * count + first, edge * count + last
    known, number = np.unique(here[open_to_cars], return_counts=True)
    row = np.minimum(np.searchsorted(known, back), len(known) - 1)
    own = np.where(known[row] == back, number[row], 0) if len(known) else 0
    return np.asarray(begin[last] > own)


def check_lanes(city: City) -> list[Check]:
    """Run every check on the lane graph; none where there is no graph."""
    graph, network = city.lanes, city.network
    if graph is None or network is None or not network.edge_count:
        return []
    open_to_cars = cars(graph)
    piece = pieces_of(graph)
    found = _joined(piece[piece >= 0], graph.edge[piece >= 0])
    ends = np.where(graph.direction > 0, 1, 0)
    last = network.edge_nodes[graph.edge, ends]
    first = network.edge_nodes[graph.edge, 1 - ends]
    of_map = _pieces_of_map(
        graph.edge[open_to_cars].astype(np.int64), first[open_to_cars], last[open_to_cars]
    )
    at = network.node_position[last]
    inside = ~_leaves(at, city.layout.extent)
    joined = (network.node_degree[last] >= 2) & inside & open_to_cars
    leads_on = np.zeros(graph.count, bool)
    leads_on[graph.connection[:, 0]] = True
    # A street that ends in the open, or a junction that nothing leads to or from, was cut by the
    # map: its other arms are one-way streets, or lie beyond the clip.
    opened = network.node_degree == 1
    opened |= _leaves(network.node_position, city.layout.extent)
    source = ~np.isin(np.arange(len(opened)), last[open_to_cars])
    sink = ~np.isin(np.arange(len(opened)), first[open_to_cars])
    dead = int(
        (
            joined & ~leads_on & _lead_away(graph.edge.astype(np.int64), first, last, open_to_cars)
        ).sum()
    )
    entries = np.flatnonzero(open_to_cars & (opened | source)[first])
    exits = np.flatnonzero(open_to_cars & (opened | sink)[last])
    lost = np.setdiff1d(
        stranded(graph, entries, exits),
        stranded(_of_map(graph, first, last, network.node_degree), entries, exits),
    )
    total = max(int(open_to_cars.sum()), 1)
    return [
        Check("lane_graph_pieces", float(found - of_map), 0,
              "pieces of the lane graph beyond those of the map's streets"),
        Check("lanes_without_exit", dead / total, 0.05,
              "share of lanes that end at a junction from which none leads on"),
        Check("lanes_stranded", len(lost) / total, 0.25,
              "share of lanes from which, or to which, no way leads within the site, though the "
              "streets of the map and their directions have one"),
    ]  # fmt: skip


def _of_map(
    graph: LaneGraph, first: IntArray, last: IntArray, degree: NDArray[np.int32]
) -> LaneGraph:
    """Return lanes joined at every node, whatever was built there; back only at dead ends.

    Parameters
    ----------
    first, last
        (l,) nodes at which each lane begins and ends.
    degree
        (n,) streets that meet at each node.
    """
    order = np.argsort(first, kind="stable")
    begin, end = (np.searchsorted(first[order], last, side) for side in ("left", "right"))
    come, number = counted(end - begin)
    leave = order[begin[come] + number]
    onward = (graph.edge[come] != graph.edge[leave]) | (degree[last[come]] == 1)
    pairs = np.column_stack([come, leave])[onward]
    return replace(
        graph,
        connection=pairs.astype(graph.connection.dtype),
        curve=np.zeros((2 * len(pairs), graph.curve.shape[1])),
        curve_start=np.arange(0, 2 * len(pairs) + 1, 2),
    )


def _joined(piece: IntArray, edge: NDArray[np.int32]) -> int:
    """Count pieces; the two directions of one street count together, also on a ring road."""
    if not len(piece):
        return 0
    shift = int(piece.max()) + 1
    pairs = np.column_stack([piece, shift + edge.astype(np.int64)])
    label = components(pairs, shift + int(edge.max()) + 1)
    return len(np.unique(label[piece]))


def _pieces_of_map(edge: IntArray, first: IntArray, last: IntArray) -> int:
    """Count the pieces in which streets hang together by junctions one can come to and leave.

    ``edge``, ``first`` and ``last`` are (k,) of lanes: edge, node they begin and node they end at.
    Two one-way streets that meet head on are not joined.
    """
    if not len(edge):
        return 0
    open_nodes = np.intersect1d(first, last)
    pairs = []
    shift = int(edge.max()) + 1
    for node in (first, last):
        rows = np.flatnonzero(np.isin(node, open_nodes))
        pairs.append(np.column_stack([edge[rows], shift + node[rows]]))
    label = components(np.concatenate(pairs), shift + int(max(first.max(), last.max())) + 1)
    return len(np.unique(label[np.unique(edge)]))


def _leaves(
    at: NDArray[np.float64], extent: tuple[float, float, float, float]
) -> NDArray[np.bool_]:
    """(k,) whether places lie at the edge of the site."""
    xmin, ymin, xmax, ymax = extent
    near = (at[:, 0] <= xmin + BORDER) | (at[:, 0] >= xmax - BORDER)
    return np.asarray(near | (at[:, 1] <= ymin + BORDER) | (at[:, 1] >= ymax - BORDER))
