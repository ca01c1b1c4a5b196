"""The surfaces of streets, the same on the ground and on structures."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.city.ground import KERB_WIDTH, LABEL, SURFACES
from cityx.city.layout import Layout
from cityx.city.roads import RoadNetwork
from cityx.city.section import KIND
from cityx.geometry.polylines import arc_lengths, line_strips, pack, pieces, to_linestrings
from cityx.ground.arrangement import Regions, join_regions, regions
from cityx.places.painting import Painting
from cityx.road.ground.landcover import kerbed_areas
from cityx.road.markings.markings import marking_regions
from cityx.road.markings.marks import PLAIN, USUAL, boxes, lowered_edges, painted_edges, street_of
from cityx.road.markings.zebras import joined, mouth_crossings, zebras_of
from cityx.road.network.medians import median_regions
from cityx.road.network.network import junction_clusters
from cityx.road.network.sections import Bands, bands_of
from cityx.road.parking.kerb_bays import runs_of
from cityx.road.surface.carriageway import FINE, Carriageway, build_carriageway
from cityx.road.surface.carriageway_regions import (
    carriageway_regions,
    junction_labels,
    kerbed_edges,
    road_labels,
)
from cityx.road.surface.drops import drive_regions, dropped_regions
from cityx.road.surface.junction_paving import junction_paving, paved_mouths, setts_at
from cityx.road.surface.refuges import refuge_regions
from cityx.road.surface.roundabouts import roundabout_regions

# Verges: green strips of a cross-section between the carriageway and the sidewalk or the land.

PRIORITY = 52  # above the sidewalk and its strip for furniture
UNDER_KERB = 51  # where there is no kerb, grass begins at the carriageway
GUTTER = 0.32  # metres; two courses of stones
GUTTERED = ("primary", "secondary", "tertiary", "residential", "unclassified", "living_street")
GUTTER_PRIORITY = 71  # above the carriageway, below junctions
RIM_PRIORITY = 55  # above road areas of the map, below carriageways
INSIDE = 0.6  # metres within a road area where its carriageway has no kerb
WIDE = 2.9  # metres of walk from which a strip at the kerb is paved apart
STRIP = 1.0  # metres
BEFORE = 2.5  # metres that the strip ends before a junction
ZEBRA = 5.0  # metres more where a crossing lies there
SHORTEST = 4.0  # metres
ROW = 0.32  # metres of the gutter of two courses before a lane of parked cars
THRESHOLD = 0.3  # metres of stones across a carriageway


def verge_regions(network: RoadNetwork, bands: Bands) -> Regions:
    """Return the verges of edges, short of junctions and crossings.

    Parameters
    ----------
    network
        The road network.
    bands
        Its cross-sections.
    """
    found = []
    verges = bands.take(bands.kind == KIND["verge"])
    for sign in (1.0, -1.0):
        rows = verges.take(sign * verges.middle > 0)
        for size in np.unique(np.round(rows.width, 3)).tolist():
            chosen = rows.take(np.round(rows.width, 3) == size)
            inner, edges = np.zeros(network.edge_count), chosen.edge
            inner[edges] = sign * np.where(sign > 0, chosen.right, -chosen.left)
            for at, wide, priority in (
                (size / 2, size, PRIORITY),
                (-KERB_WIDTH / 2, KERB_WIDTH, UNDER_KERB),
            ):
                lateral = inner + sign * at
                found.append(edge_strips(network, edges, lateral, wide, "grass", priority, BEFORE))
    return join_regions(found)


def street_regions(
    layout: Layout, network: RoadNetwork, painting: Painting = USUAL
) -> tuple[Regions, Carriageway]:
    """Return carriageways, junctions, kerbs, walks and markings of all edges of a network.

    Parameters
    ----------
    layout
        The layout.
    network
        Its roads, or pieces of them.
    painting
        What the country paints.
    """
    chosen = np.ones(network.edge_count, bool)
    road = build_carriageway(layout, network, chosen)
    road = replace(road, drawn=kerbed_areas(layout, network, road))
    bands = bands_of(layout, network)
    street = street_of(layout, network, bands, painting)
    painted = painted_edges(street, chosen)
    crossed = painted | lowered_edges(street, chosen)
    zebras = zebras_of(street, crossed, road)
    zebras = replace(zebras, kind=np.where(painted[zebras.edge], zebras.kind, PLAIN))
    mouths = mouth_crossings(street, crossed, road)
    crossings = joined(zebras, mouths)
    setts = paved_mouths(street, crossings, painting)
    ends = setts_at(street, crossings, setts)
    found = join_regions([
        carriageway_regions(layout, network, chosen, road),
        strip_regions(layout, network, bands, chosen, gutters=painting.gutters),
        threshold_regions(layout, network, chosen),
        verge_regions(network, bands),
        marking_regions(street, zebras, painted, road, painting, ends),
        junction_paving(street, crossings, setts, road, painting),
        dropped_regions(street, zebras, mouths, road, painting.ribs),
        drive_regions(street, road),
        refuge_regions(street, zebras, painting.ribs),
        median_regions(layout, network, chosen),
        roundabout_regions(layout, network, chosen),
    ])  # fmt: skip
    return found, road


def strip_regions(
    layout: Layout, network: RoadNetwork, bands: Bands, on_ground: NDArray[np.bool_], *,
    gutters: bool = True,
) -> Regions:  # fmt: skip
    """Return gutters, lanes of parked cars and strips for furniture beside edges on the ground.

    Parameters
    ----------
    layout, network
        The layout and its road network.
    bands
        Its cross-sections.
    on_ground
        (e,) bool, edges that do not run on decks.
    gutters
        Whether carriageways have gutters.
    """
    roads = layout.roads
    row = network.edge_road
    kind = roads["kind"].to_numpy().astype(str)
    open_air = ~(roads["tunnel"].to_numpy() | roads["passage"].to_numpy())
    street = on_ground & (np.isin(kind, GUTTERED) & open_air)[row]
    paved = road_labels(roads["surface"].to_numpy())[row] != LABEL["gravel_road"]
    ring = roads["roundabout"].to_numpy()[row]  # between whose arms a gutter is cut into stubs
    guttered = np.flatnonzero(
        street & paved & kerbed_edges(layout, network) & ~ring & np.bool_(gutters)
    )
    wider = _wider_areas(layout)
    found = [_rims(wider, network, guttered)]
    for sign, column in ((1.0, "sidewalk_left"), (-1.0, "sidewalk_right")):
        walk = roads[column].to_numpy()[row]
        lateral = sign * (network.half_width - GUTTER / 2)
        found.append(edge_strips(network, guttered, lateral, GUTTER, "gutter", GUTTER_PRIORITY,
                                 0.0, without=shapely.buffer(wider, -INSIDE)))  # fmt: skip
        edges = np.flatnonzero(street & (walk >= WIDE))
        lateral = sign * (network.half_width + KERB_WIDTH + STRIP / 2)
        priority = SURFACES[LABEL["furnishing"]].priority
        found.append(edge_strips(network, edges, lateral, STRIP, "furnishing", priority, BEFORE))
    stone = road_labels(roads["surface"].to_numpy())[row] == LABEL["setts"]
    return join_regions([*found, _stone_lanes(network, bands, street & stone)])


def _stone_lanes(network: RoadNetwork, bands: Bands, chosen: NDArray[np.bool_]) -> Regions:
    """Lay lanes of parked cars beside setts with small stones, behind a gutter of large ones."""
    runs = runs_of(network, bands.take(chosen[bands.edge]))
    middle = to_linestrings(pieces(network.lines, runs.edge, runs.low, runs.high))
    middle = shapely.simplify(middle, FINE)
    outer = runs.kerb - runs.side * GUTTER
    inner = runs.road + runs.side * ROW
    found = []
    for label, one, other in (("parking_lane", outer, inner), ("gutter", inner, runs.road)):
        for width in np.unique(np.round(np.abs(one - other), 3)).tolist():
            rows = np.flatnonzero((np.round(np.abs(one - other), 3) == width) & (width > 0))
            if not len(rows):
                continue
            strips = line_strips(pack(middle[rows]), ((one + other) / 2)[rows], width)
            strips = strips[shapely.is_valid(strips)]
            found.append(regions(strips, LABEL[label], GUTTER_PRIORITY))
    return join_regions(found)


def _wider_areas(layout: Layout) -> NDArray[Any]:
    """Road areas of the map, drawn from kerb to kerb, as one or several polygons."""
    areas = layout.areas
    chosen = areas.geometry.to_numpy()[(areas["kind"] == "road_area").to_numpy()]
    return np.asarray(shapely.get_parts(shapely.unary_union(chosen)))


def _rims(areas: NDArray[Any], network: RoadNetwork, edges: NDArray[np.int64]) -> Regions:
    """Gutters along the rims of road areas through which some edges run."""
    lines = to_linestrings(network.lines)[edges]
    met = np.unique(shapely.STRtree(areas).query(lines, predicate="intersects")[1])
    if not len(met):
        return Regions()
    inner = shapely.buffer(areas[met], -GUTTER, join_style="mitre")
    return regions(shapely.difference(areas[met], inner), LABEL["gutter"], RIM_PRIORITY)


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
    label: str, priority: int, before: float, *, without: Any = None,
) -> Regions:  # fmt: skip
    """Lay strips along edges, `before` metres short of the junctions and of zebras there.

    What lies in polygons `without` is left out.
    """
    lines = network.lines
    length = arc_lengths(lines)[1]
    gap = network.trim + (before + ZEBRA * network.crossing) * (before > 0)
    begin, end = gap[:, 0], length - gap[:, 1]
    edges = edges[(end - begin)[edges] > SHORTEST]
    if not len(edges):
        return Regions()
    middle = shapely.simplify(to_linestrings(pieces(lines, edges, begin[edges], end[edges])), FINE)
    strips = line_strips(pack(middle), lateral[edges], width)
    strips = strips[shapely.is_valid(strips)]
    if without is not None and len(without):
        strips = shapely.difference(strips, shapely.union_all(without))
    return regions(strips, LABEL[label], priority)
