"""Strips along kerbs: gutters of setts in the carriageway, paving for furniture on wide walks."""

from __future__ import annotations

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.city.ground import KERB_WIDTH, LABEL, SURFACES
from cityx.city.layout import Layout
from cityx.city.roads import RoadNetwork
from cityx.geometry.arrangement import Regions, join_regions, regions
from cityx.geometry.polylines import (
    arc_lengths,
    line_strips,
    pack,
    pieces,
    to_linestrings,
)
from cityx.plugins.road.carriageway import FINE
from cityx.plugins.road.carriageway_regions import junction_labels, road_labels
from cityx.plugins.road.marks import boxes
from cityx.plugins.road.network import junction_clusters

GUTTER = 0.30  # metres; two courses of setts
GUTTERED = ("primary", "secondary", "tertiary", "residential", "unclassified", "living_street")
GUTTER_PRIORITY = 71  # above the carriageway, below junctions
WIDE = 2.9  # metres of walk from which a strip at the kerb is paved apart
STRIP = 1.0  # metres
BEFORE = 2.5  # metres that the strip ends before a junction
ZEBRA = 5.0  # metres more where a crossing lies there
SHORTEST = 4.0  # metres
THRESHOLD = 0.3  # metres of stones across a carriageway


def strip_regions(layout: Layout, network: RoadNetwork, on_ground: NDArray[np.bool_]) -> Regions:
    """Return gutters and strips for furniture beside the edges that lie on the ground.

    Parameters
    ----------
    layout, network
        The layout and its road network.
    on_ground
        (e,) bool, edges that do not run on decks.
    """
    roads = layout.roads
    row = network.edge_road
    kind = roads["kind"].to_numpy().astype(str)
    open_air = ~(roads["tunnel"].to_numpy() | roads["passage"].to_numpy())
    street = on_ground & (np.isin(kind, GUTTERED) & open_air)[row]
    asphalt = road_labels(roads["surface"].to_numpy())[row] == LABEL["carriageway"]
    ring = roads["roundabout"].to_numpy()[row]  # between whose arms a gutter is cut into stubs
    found = []
    for sign, column in ((1.0, "sidewalk_left"), (-1.0, "sidewalk_right")):
        walk = roads[column].to_numpy()[row]
        edges = np.flatnonzero(street & asphalt & (walk > 0) & ~ring)
        lateral = sign * (network.half_width - GUTTER / 2)
        found.append(edge_strips(network, edges, lateral, GUTTER, "setts", GUTTER_PRIORITY, 0.0))
        edges = np.flatnonzero(street & (walk >= WIDE))
        lateral = sign * (network.half_width + KERB_WIDTH + STRIP / 2)
        priority = SURFACES[LABEL["furnishing"]].priority
        found.append(edge_strips(network, edges, lateral, STRIP, "furnishing", priority, BEFORE))
    return join_regions(found)


def threshold_regions(
    layout: Layout, network: RoadNetwork, on_ground: NDArray[np.bool_]
) -> Regions:
    """Lay a row of stones across carriageways where setts meet asphalt, at junctions or between.

    Parameters
    ----------
    layout, network
        The layout and its road network.
    on_ground
        (e,) bool, edges that do not run on decks.
    """
    lines = network.lines
    length = arc_lengths(lines)[1]
    own = road_labels(layout.roads["surface"].to_numpy()[network.edge_road])
    stone = own == LABEL["setts"]
    if not stone.any():
        return Regions()
    cluster = junction_clusters(network)
    nodes = cluster[network.edge_nodes].ravel()
    hubs = junction_labels(layout, network, own, nodes, on_ground)
    at_joint = network.node_degree[network.edge_nodes] >= 3
    laid = (hubs.reshape(-1, 2) == LABEL["setts"]) != stone[:, None]
    # Between two pieces of a street the one of stone has the row.
    ends = np.repeat(own != LABEL["gravel_road"], 2) & ~np.repeat(stone, 2)
    smooth = np.bincount(network.edge_nodes.ravel()[ends], minlength=len(network.node_degree)) > 0
    passed = (network.node_degree[network.edge_nodes] == 2) & smooth[network.edge_nodes]
    chosen = np.where(at_joint, laid, passed & stone[:, None])
    chosen &= (on_ground & (own != LABEL["gravel_road"]))[:, None]
    chosen &= (length - network.trim.sum(axis=1) > SHORTEST)[:, None]
    edge, end = np.nonzero(chosen)
    back = network.trim[edge, end] + THRESHOLD / 2
    along = np.where(end == 0, back, length[edge] - back)
    width = 2 * network.half_width[edge]
    shapes, _ = boxes(lines, edge, along, np.zeros(len(edge)), THRESHOLD, width)
    label = LABEL["threshold"]
    return regions(shapes, label, SURFACES[label].priority)


def edge_strips(
    network: RoadNetwork, edges: NDArray[np.int64], lateral: NDArray[np.float64], width: float,
    label: str, priority: int, before: float,
) -> Regions:  # fmt: skip
    """Lay strips along edges, `before` metres short of the junctions and of zebras there."""
    lines = network.lines
    length = arc_lengths(lines)[1]
    gap = network.trim + (before + ZEBRA * network.crossing) * (before > 0)
    begin, end = gap[:, 0], length - gap[:, 1]
    edges = edges[(end - begin)[edges] > SHORTEST]
    if not len(edges):
        return Regions()
    middle = shapely.simplify(to_linestrings(pieces(lines, edges, begin[edges], end[edges])), FINE)
    strips = line_strips(pack(middle), lateral[edges], width)
    return regions(strips[shapely.is_valid(strips)], LABEL[label], priority)
