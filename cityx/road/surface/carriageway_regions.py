"""Carriageways, junctions, kerbs and sidewalks as labelled regions of the ground."""

from __future__ import annotations

from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.city.ground import KERB_WIDTH, LABEL, SURFACES
from cityx.city.layout import Layout
from cityx.city.roads import RoadNetwork
from cityx.geometry.arrays import FloatArray, IntArray
from cityx.geometry.polylines import arc_lengths, pieces, to_linestrings
from cityx.geometry.simplified import simplified
from cityx.ground.arrangement import GRID, Regions, join_regions, regions
from cityx.ids import mix
from cityx.road.network.network import junction_clusters
from cityx.road.surface.carriageway import FINE, MITRE, ROUND, Carriageway, past_border, widened

STONE = ("sett", "cobblestone", "unhewn_cobblestone", "paving_stones", "bricks", "brick")
LOOSE = (
    "gravel", "fine_gravel", "compacted", "unpaved", "dirt", "earth", "ground", "grass", "mud",
    "sand", "pebblestone", "rock", "woodchips", "grass_paver",
)  # fmt: skip
DRIVES = ("service", "track")
BUILDING_PRIORITY = 74  # a facade wins over a carriageway drawn too wide
PASSAGE_PRIORITY = 76  # but not where the carriageway runs through the house
BATCH = 500.0  # metres; carriageways are joined in squares of this size
COARSE = 1.0  # metres by which centrelines are simplified at detail level 0
BETWEEN_HOUSES = 20.0  # metres from a centreline to the houses that make its road a street
EDGING = 0.12  # metres of stone behind a walk
CURVE_PRIORITY = 68  # below the arms, whose surfaces a curve overlaps
JUNCTION_PRIORITY = 72  # above every kind of carriageway, whatever the junction is paved with


def road_labels(surface: Any) -> NDArray[np.uint8]:
    """Return the label of the carriageway for values of the ``surface`` column.

    Parameters
    ----------
    surface
        (n,) words of OpenStreetMap; unknown ones and none mean asphalt.

    Returns
    -------
    label
        (n,) rows of `SURFACES`.
    """
    words = np.asarray(surface).astype(str)
    stone, loose = np.isin(words, STONE), np.isin(words, LOOSE)
    choice = np.where(loose, LABEL["gravel_road"], LABEL["carriageway"])
    return np.where(stone, LABEL["setts"], choice).astype(np.uint8)


def plain_carriageways(
    layout: Layout, network: RoadNetwork, on_ground: NDArray[np.bool_]
) -> Regions:
    """Return carriageways without junctions, one region per kind of surface (detail level 0)."""
    edges = np.flatnonzero(on_ground)
    lines = to_linestrings(network.lines)[edges]
    strips = shapely.buffer(shapely.simplify(lines, COARSE), network.half_width[edges],
                            quad_segs=1, join_style="mitre", mitre_limit=MITRE)  # fmt: skip
    label = road_labels(layout.roads["surface"].to_numpy()[network.edge_road[edges]])
    # Joined batch by batch: what still overlaps costs less than one large union.
    middle = (shapely.bounds(strips)[:, :2] + shapely.bounds(strips)[:, 2:]) / 2
    keys = np.column_stack([label, np.floor(middle / BATCH)])
    batches, batch = np.unique(keys, axis=0, return_inverse=True)
    order = np.argsort(batch, kind="stable")
    begin = np.searchsorted(batch[order], np.arange(len(batches)))
    parts = np.split(strips[order], begin)[1:]  # none where no edge lies on the ground
    kinds = batches[:, 0].astype(np.uint8)
    priority = [SURFACES[kind].priority for kind in kinds]
    return regions([shapely.unary_union(part) for part in parts], kinds, priority)


def junction_labels(
    layout: Layout,
    network: RoadNetwork,
    labels: NDArray[np.uint8],
    hubs: IntArray,
    on_ground: NDArray[np.bool_],
) -> NDArray[np.int64]:
    """Pave a junction with asphalt if one street has it; else with stone before gravel.

    Drives decide only where no street meets them.
    """
    street = ~layout.roads["kind"].isin(DRIVES).to_numpy()[network.edge_road]
    rank = np.select([labels == LABEL["carriageway"], labels == LABEL["setts"]], [2, 1], default=0)
    names = np.array([LABEL["gravel_road"], LABEL["setts"], LABEL["junction"]])
    rank = rank + len(names) * street
    best = np.zeros(len(network.node_position), np.int64)
    cluster = junction_clusters(network)
    for side in (0, 1):
        np.maximum.at(best, cluster[network.edge_nodes[on_ground, side]], rank[on_ground])
    return np.asarray(names[best[hubs] % len(names)])


def node_ids(network: RoadNetwork) -> NDArray[np.uint64]:
    """(n,) stable id of each node, of its place."""
    x, y = np.rint(network.node_position * 1000).astype(np.int64).T
    own = mix(mix(x.view(np.uint64)) ^ y.view(np.uint64))
    return np.asarray(np.maximum(own, np.uint64(1)))


def junction_ids(network: RoadNetwork) -> NDArray[np.uint64]:
    """(n,) stable id of the junction of each node; edges inside of one join their ends."""
    return np.asarray(node_ids(network)[junction_clusters(network)])


def carriageway_regions(
    layout: Layout, network: RoadNetwork, on_ground: NDArray[np.bool_], road: Carriageway
) -> Regions:
    """Return the regions of carriageways, junctions, passages, kerbs and sidewalks."""
    table = layout.roads.iloc[network.edge_road]
    lines = network.lines
    labels, ids = road_labels(table["surface"].to_numpy()), table["id"].to_numpy()
    priority = np.array([surface.priority for surface in SURFACES])
    passage = np.flatnonzero(table["passage"].to_numpy() & on_ground)
    through = widened(
        pieces(lines, passage, *_between_open_junctions(layout, network, passage)),
        network.half_width[passage],
    )
    hub_label = junction_labels(layout, network, labels, road.node, on_ground)
    curve_label = junction_labels(layout, network, labels, road.curve_node, on_ground)
    own, bend = labels[road.edge], labels[road.disc_edge]
    return join_regions(
        [
            regions(road.strips, own, priority[own], ids[road.edge]),
            regions(road.discs, bend, priority[bend], ids[road.disc_edge]),
            regions(road.heads, labels[road.head_edge], JUNCTION_PRIORITY, ids[road.head_edge]),
            regions(road.gores, labels[road.gore_edge], CURVE_PRIORITY, ids[road.gore_edge]),
            regions(road.bends, labels[road.bend_edge], CURVE_PRIORITY, ids[road.bend_edge]),
            regions(road.stars, hub_label, JUNCTION_PRIORITY, junction_ids(network)[road.node]),
            regions(
                road.curves, curve_label, CURVE_PRIORITY, junction_ids(network)[road.curve_node]
            ),
            regions(through, labels[passage], PASSAGE_PRIORITY, ids[passage]),
            _kerbs(network, kerbed_edges(layout, network) & on_ground, road),
            _sidewalks(network, on_ground, table, layout.extent),
        ]
    )


def _between_open_junctions(
    layout: Layout, network: RoadNetwork, edges: IntArray
) -> tuple[FloatArray, FloatArray]:
    """Return the metres along edges between the junctions at their ends that no house covers."""
    houses = shapely.STRtree(layout.buildings.geometry.to_numpy())
    covered = np.zeros(len(network.node_position), bool)
    covered[houses.query(shapely.points(network.node_position), predicate="intersects")[0]] = True
    length = arc_lengths(network.lines)[1][edges]
    kept = np.where(covered[network.edge_nodes[edges]], 0.0, network.trim[edges])
    kept[kept.sum(axis=1) >= length] = 0.0
    return kept[:, 0], length - kept[:, 1]


def kerbed_edges(layout: Layout, network: RoadNetwork) -> NDArray[np.bool_]:
    """Return which edges have kerbs: those with sidewalks, and paved streets between houses."""
    table = layout.roads.iloc[network.edge_road]
    walk = table["sidewalk_left"].to_numpy() + table["sidewalk_right"].to_numpy()
    lines = to_linestrings(network.lines)
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
    known[junction_clusters(network)[network.edge_nodes[walked]]] = True
    kerbed = [
        road.strips[walked[road.edge]],
        road.discs[walked[road.disc_edge]],
        road.gores[walked[road.gore_edge]],
        road.bends[walked[road.bend_edge]],
        road.stars[known[road.node]],
        road.curves[known[road.curve_node]],
    ]
    with np.errstate(divide="ignore", invalid="ignore"):  # a needle's mitre is cut off
        stones = shapely.buffer(np.concatenate(kerbed), KERB_WIDTH, join_style="mitre")
    label = LABEL["kerb"]
    joined = simplified(shapely.unary_union(stones), GRID)
    return regions(joined, label, SURFACES[label].priority)


def _sidewalks(
    network: RoadNetwork, on_ground: NDArray[np.bool_], table: Any, extent: tuple[float, ...]
) -> Regions:
    """Lay bands that reach over the carriageways, which win, to the backs of the sidewalks."""
    left, right = table["sidewalk_left"].to_numpy(), table["sidewalk_right"].to_numpy()
    base = network.half_width + KERB_WIDTH
    lines = past_border(network, extent, base + np.maximum(left, right))
    shapes = shapely.simplify(to_linestrings(lines), FINE)
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
    joined = simplified(shapely.unary_union(np.concatenate(bands)), FINE)
    label, edging = LABEL["sidewalk"], LABEL["edging"]
    rim = shapely.buffer(joined, EDGING, join_style="mitre", mitre_limit=MITRE)
    return join_regions([
        regions(joined, label, SURFACES[label].priority),
        regions(rim, edging, SURFACES[edging].priority),
    ])  # fmt: skip
