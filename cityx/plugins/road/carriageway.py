"""Carriageways, junction surfaces, kerbs and sidewalks as regions of the ground.

Each edge becomes a strip from one junction to the next; each junction joins its arms up to their
trims and rounds the corners. The arrangement resolves what overlaps.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.city.ground import KERB_WIDTH, LABEL, SURFACES
from cityx.city.layout import Layout
from cityx.city.roads import RoadNetwork
from cityx.geometry.arrangement import GRID, Regions, join_regions, regions
from cityx.geometry.identity import mix
from cityx.geometry.polylines import Polylines, arc_lengths, pieces, to_linestrings
from cityx.plugins.road.network import KERB_RADIUS, arm_bearings, arms_of, junction_clusters

IntArray = NDArray[np.int64]
Shapes = NDArray[Any]

STONE = ("sett", "cobblestone", "unhewn_cobblestone", "paving_stones", "bricks", "brick")
LOOSE = (
    "gravel", "fine_gravel", "compacted", "unpaved", "dirt", "earth", "ground", "grass", "mud",
    "sand", "pebblestone", "rock", "woodchips", "grass_paver",
)  # fmt: skip
ROUND = 4  # chords per quarter circle; 3 cm off at the radius of a kerb return
BUILDING_PRIORITY = 74  # a facade wins over a carriageway drawn too wide
PASSAGE_PRIORITY = 76  # but not where the carriageway runs through the house
MITRE = 2.0  # longest mitre, in half widths; sharper bends are cut off
BATCH = 500.0  # metres; carriageways are joined in squares of this size
FINE, COARSE = 0.03, 1.0  # metres by which centrelines are simplified, in detail and without
OVERLAP = 0.05  # metres that a carriageway reaches into the junction surface
BETWEEN_HOUSES = 20.0  # metres from a centreline to the houses that make its road a street
SHORTEST = 0.5  # metres; a shorter piece between two junctions belongs to them
BEND = 0.05  # radians; below it the wedge at a bend is thinner than the kerb's joint
JUNCTION_PRIORITY = 72  # above every kind of carriageway, whatever the junction is paved with


@dataclass(frozen=True)
class Carriageway:
    """The surfaces of all roads on the ground.

    Attributes
    ----------
    edge
        (k,) edges of the network that have a piece between junctions.
    strips
        (k,) polygons, their carriageways.
    node
        (j,) nodes of the network that are junctions.
    stars
        (j,) polygons, the junction surfaces with round corners.
    discs, disc_edge
        Polygons that close the wedge at a bend, and the edge each belongs to.
    """

    edge: IntArray
    strips: Shapes
    node: IntArray
    stars: Shapes
    discs: Shapes
    disc_edge: IntArray


def road_labels(surface: Any) -> NDArray[np.uint8]:
    """Label of the carriageway for values of the ``surface`` column, (n,)."""
    words = np.asarray(surface).astype(str)
    stone, loose = np.isin(words, STONE), np.isin(words, LOOSE)
    choice = np.where(loose, LABEL["gravel_road"], LABEL["carriageway"])
    return np.where(stone, LABEL["setts"], choice).astype(np.uint8)


def plain_carriageways(
    layout: Layout, network: RoadNetwork, on_ground: NDArray[np.bool_]
) -> Regions:
    """Return carriageways without junctions, one region per kind of surface (detail level 0)."""
    edges = np.flatnonzero(on_ground)
    lines = to_linestrings(Polylines(network.points, network.point_start))[edges]
    strips = shapely.buffer(shapely.simplify(lines, COARSE), network.half_width[edges],
                            quad_segs=1, join_style="mitre", mitre_limit=MITRE)  # fmt: skip
    label = road_labels(layout.roads["surface"].to_numpy()[network.edge_road[edges]])
    # Joined batch by batch: what still overlaps costs less than one large union.
    middle = (shapely.bounds(strips)[:, :2] + shapely.bounds(strips)[:, 2:]) / 2
    keys = np.column_stack([label, np.floor(middle / BATCH)])
    batches, batch = np.unique(keys, axis=0, return_inverse=True)
    order = np.argsort(batch, kind="stable")
    parts = np.split(strips[order], np.searchsorted(batch[order], np.arange(1, len(batches))))
    kinds = batches[:, 0].astype(np.uint8)
    priority = [SURFACES[kind].priority for kind in kinds]
    return regions([shapely.unary_union(part) for part in parts], kinds, priority)


def build_carriageway(network: RoadNetwork, on_ground: NDArray[np.bool_]) -> Carriageway:
    """Widen the edges on the ground to strips that end where the junction surfaces begin."""
    lines = Polylines(network.points, network.point_start)
    length = arc_lengths(lines)[1]
    begin, end = network.trim[:, 0], length - network.trim[:, 1]
    edge = np.flatnonzero(on_ground & (end - begin > SHORTEST))
    # A little overlap, so that rounding leaves no crack; the junction wins there.
    centre = pieces(lines, edge, begin[edge] - OVERLAP, end[edge] + OVERLAP)
    strips = _widened(centre, network.half_width[edge])
    node, arm, side = arms_of(lines, network.edge_nodes)
    ground = on_ground[arm]
    node, arm, side = node[ground], arm[ground], side[ground]
    hubs, stars = _stars(network, lines, node, arm, side)
    discs, disc_edge = _discs(network, lines, node, arm, side)
    return Carriageway(edge, strips, hubs, stars, discs, disc_edge)


def _widened(lines: Polylines, half: Any) -> Shapes:
    centre = shapely.simplify(to_linestrings(lines), FINE)
    return np.asarray(
        shapely.buffer(centre, half, cap_style="flat", join_style="mitre", mitre_limit=MITRE)
    )


def _discs(
    network: RoadNetwork, lines: Polylines, node: IntArray, edge: IntArray, end: IntArray
) -> tuple[Shapes, IntArray]:
    """Close the wedge where two edges meet at an angle."""
    degree = np.bincount(node, minlength=len(network.node_position))
    first = np.flatnonzero((degree[node] == 2) & np.r_[node[1:] == node[:-1], False][: len(node)])
    bearing = arm_bearings(lines, edge, end)
    turn = np.abs(np.mod(bearing[first + 1] - bearing[first], 2 * np.pi) - np.pi)
    first = first[turn > BEND]
    radius = np.minimum(network.half_width[edge[first]], network.half_width[edge[first + 1]])
    centre = shapely.points(network.node_position[node[first]])
    return np.asarray(shapely.buffer(centre, radius, quad_segs=ROUND)), edge[first]


def _stars(
    network: RoadNetwork, lines: Polylines, node: IntArray, edge: IntArray, end: IntArray
) -> tuple[IntArray, Shapes]:
    """Join the arms of each junction as far as their trims and round the corners."""
    degree = np.bincount(node, minlength=len(network.node_position))
    arm = np.flatnonzero(degree[node] >= 3)
    if not len(arm):
        return np.zeros(0, np.int64), np.zeros(0, object)
    node, edge, end = node[arm], edge[arm], end[arm]
    length = arc_lengths(lines)[1][edge]
    reach = np.minimum(np.maximum(network.trim[edge, end], SHORTEST), length)
    begin = np.where(end == 0, 0.0, length - reach)
    strips = _widened(pieces(lines, edge, begin, begin + reach), network.half_width[edge])
    first = np.searchsorted(node, node)
    hubs, row = np.unique(node, return_inverse=True)
    table = np.full((len(hubs), int(degree.max())), None, dtype=object)
    table[row, np.arange(len(node)) - first] = strips
    stars = shapely.union_all(table, axis=1)
    grown = shapely.buffer(stars, KERB_RADIUS, join_style="mitre", mitre_limit=MITRE)
    closed = shapely.buffer(grown, -KERB_RADIUS, quad_segs=ROUND)
    return hubs, np.asarray(shapely.simplify(closed, GRID))


def _junction_labels(
    network: RoadNetwork, labels: NDArray[np.uint8], hubs: IntArray, on_ground: NDArray[np.bool_]
) -> NDArray[np.int64]:
    """Pave a junction with asphalt if one arm has it; else with stone before gravel."""
    rank = np.select([labels == LABEL["carriageway"], labels == LABEL["setts"]], [2, 1], default=0)
    best = np.zeros(len(network.node_position), np.int64)
    for side in (0, 1):
        np.maximum.at(best, network.edge_nodes[on_ground, side], rank[on_ground])
    names = np.array([LABEL["gravel_road"], LABEL["setts"], LABEL["junction"]])
    return np.asarray(names[best[hubs]])


def junction_ids(network: RoadNetwork) -> NDArray[np.uint64]:
    """(n,) stable id of the junction of each node; edges inside of one join their ends."""
    x, y = np.rint(network.node_position * 1000).astype(np.int64).T
    own = np.maximum(mix(mix(x.view(np.uint64)) ^ y.view(np.uint64)), np.uint64(1))
    return np.asarray(own[junction_clusters(network)])


def carriageway_regions(
    layout: Layout, network: RoadNetwork, on_ground: NDArray[np.bool_], road: Carriageway
) -> Regions:
    """Return the regions of carriageways, junctions, passages, kerbs and sidewalks."""
    table = layout.roads.iloc[network.edge_road]
    lines = Polylines(network.points, network.point_start)
    labels, ids = road_labels(table["surface"].to_numpy()), table["id"].to_numpy()
    priority = np.array([surface.priority for surface in SURFACES])
    passage = np.flatnonzero(table["passage"].to_numpy() & on_ground)
    through = _widened(
        pieces(lines, passage, np.zeros(len(passage)), arc_lengths(lines)[1][passage]),
        network.half_width[passage],
    )
    hub_label = _junction_labels(network, labels, road.node, on_ground)
    own, bend = labels[road.edge], labels[road.disc_edge]
    return join_regions(
        [
            regions(road.strips, own, priority[own], ids[road.edge]),
            regions(road.discs, bend, priority[bend], ids[road.disc_edge]),
            regions(road.stars, hub_label, JUNCTION_PRIORITY, junction_ids(network)[road.node]),
            regions(through, labels[passage], PASSAGE_PRIORITY, ids[passage]),
            _kerbs(network, kerbed_edges(layout, network) & on_ground, road),
            _sidewalks(network, on_ground, table, lines),
        ]
    )


def kerbed_edges(layout: Layout, network: RoadNetwork) -> NDArray[np.bool_]:
    """Tell which edges have kerbs: those with sidewalks, and paved streets between houses."""
    table = layout.roads.iloc[network.edge_road]
    walk = table["sidewalk_left"].to_numpy() + table["sidewalk_right"].to_numpy()
    lines = to_linestrings(Polylines(network.points, network.point_start))
    near = shapely.STRtree(layout.buildings.geometry.to_numpy()).query(
        lines, predicate="dwithin", distance=BETWEEN_HOUSES
    )[0]
    housed = np.bincount(near, minlength=len(lines)) >= 2
    paved = road_labels(table["surface"].to_numpy()) != LABEL["gravel_road"]
    street = ~table["kind"].isin(("motorway", "motorway_link", "track", "service")).to_numpy()
    return np.asarray((walk > 0) | (housed & paved & street))


def _kerbs(network: RoadNetwork, walked: NDArray[np.bool_], road: Carriageway) -> Regions:
    """Lay a ring of kerb stones round every piece of the kerbed edges."""
    known = np.zeros(len(network.node_position), bool)
    known[network.edge_nodes[walked]] = True
    kerbed = [
        road.strips[walked[road.edge]],
        road.discs[walked[road.disc_edge]],
        road.stars[known[road.node]],
    ]
    stones = shapely.buffer(np.concatenate(kerbed), KERB_WIDTH, join_style="mitre")
    label = LABEL["kerb"]
    return regions(shapely.unary_union(stones), label, SURFACES[label].priority)


def _sidewalks(
    network: RoadNetwork, on_ground: NDArray[np.bool_], table: Any, lines: Polylines
) -> Regions:
    """Lay bands that reach over the carriageways, which win, to the backs of the sidewalks."""
    left, right = table["sidewalk_left"].to_numpy(), table["sidewalk_right"].to_numpy()
    shapes = shapely.simplify(to_linestrings(lines), FINE)
    base = network.half_width + KERB_WIDTH
    even = np.abs(left - right) < GRID
    both = np.flatnonzero(on_ground & (left > 0) & even)
    bands = [
        shapely.buffer(
            shapes[both], (base + left)[both], cap_style="flat", join_style="mitre",
            mitre_limit=MITRE,
        )
    ]  # fmt: skip
    for width, sign in ((left, 1.0), (right, -1.0)):
        one = np.flatnonzero(on_ground & (width > 0) & ~even)
        bands.append(
            shapely.buffer(
                shapes[one], sign * (base + width)[one], cap_style="flat", single_sided=True,
                quad_segs=ROUND,
            )
        )  # fmt: skip
    # At a bend the bands leave a wedge open.
    ends = network.edge_nodes[both].ravel().astype(np.int64)
    size = np.repeat((base + left)[both], 2)[network.node_degree[ends] == 2]
    ends = ends[network.node_degree[ends] == 2]
    least = np.full(len(network.node_position), np.inf)
    np.minimum.at(least, ends, size)
    twice = np.flatnonzero(np.bincount(ends, minlength=len(least)) == 2)
    centre = shapely.points(network.node_position[twice])
    bands.append(shapely.buffer(centre, least[twice], quad_segs=ROUND))
    joined = shapely.unary_union(np.concatenate(bands))
    return regions(joined, LABEL["sidewalk"], SURFACES[LABEL["sidewalk"]].priority)
