"""The ground off the carriageways: water, greens, paths, tracks, houses, blocks."""

from __future__ import annotations

import json
from collections.abc import Mapping
from types import MappingProxyType
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.city.ground import KERB_WIDTH, LABEL, SURFACES
from cityx.city.layout import Layout
from cityx.city.roads import RoadNetwork
from cityx.geometry.polylines import line_strips, pack
from cityx.geometry.simplified import simplified
from cityx.ground.arrangement import Regions, join_regions, regions
from cityx.ground.building_passages import open_ways
from cityx.road.surface.carriageway import MITRE, Carriageway
from cityx.road.surface.carriageway_regions import BUILDING_PRIORITY, kerbed_edges, road_labels

Shapes = NDArray[Any]

# Kind of area -> surface. Kinds that say how land is used but not what covers it are left out.
AREA_SURFACE: Mapping[str, str] = MappingProxyType({
    "water": "water", "sea": "water", "river": "water", "pool": "water", "wetland": "meadow",
    "park": "park", "garden": "park", "grass": "grass", "meadow": "meadow", "wood": "wood",
    "scrub": "wood", "orchard": "meadow", "cemetery": "park", "golf": "grass",
    "farmland": "farmland", "sand": "sand", "rock": "bare", "bare": "bare", "pitch": "pitch",
    "playground": "playground", "pedestrian": "plaza", "parking": "parking",
    "road_area": "carriageway", "railway": "railway", "pier": "plaza", "construction": "bare",
    "void": "void",
})  # fmt: skip
# Kinds whose rank is not that of their surface.
AREA_PRIORITY: Mapping[str, int] = MappingProxyType({
    "railway": 8,  # a whole yard, with sheds and weeds: anything drawn inside of it wins
    "pier": 32,  # stands in the water
    "pool": 33,
    "void": 12,  # as a lawn: what is drawn across it stands
    "road_area": 54,  # drawn kerb to kerb: no sidewalk or kerb of ours lies on it
})  # fmt: skip
WITH_GARDEN = ("detached", "semidetached_house", "terrace", "house", "bungalow", "villa", "farm")
TOWN = ("urban", "core")
GARDEN = 5.0  # metres of garden on every side of such a house in a town
GARDEN_PRIORITY = 7  # above the paving of dense blocks, below all that a map shows
BAY_GAP = 0.9  # metres between parking bays and the carriageway they belong to
KERBSIDE_PRIORITY = 53  # parking beside the carriageway lies inside of the kerb
PATHS = ("footway", "path", "cycleway", "steps", "bridleway", "corridor")
TRACKS = ("rail", "light_rail", "subway", "narrow_gauge")
TRAM_BED_PRIORITY = 69  # just below carriageways, which trams share
TRAM_RAIL_PRIORITY = 73
TRACK_BED = 4.5  # metres
TRAM_BED = 2.9
NEAR_STREET = 9.0  # metres from a kerb within which a footway belongs to the street
GAUGE = 1.435
RAIL_WIDTH = 0.07
DRIVEN_SHARE = 0.3  # of a road area that carriageways of streets with kerbs take
ROUND = 2  # chords per quarter circle at the ends of paths
FINE = 0.06  # metres by which paths are simplified


def area_regions(layout: Layout, simplify: float = 0.0) -> Regions:
    """Return the land cover of the map, optionally simplified (metres)."""
    kind = layout.areas["kind"].to_numpy().astype(str)
    known = np.isin(kind, list(AREA_SURFACE))
    kind = kind[known]
    if not len(kind):
        return Regions()
    names = [AREA_SURFACE[word] for word in kind]
    label = np.array([LABEL[name] for name in names])
    road = np.flatnonzero(kind == "road_area")
    label[road] = road_labels(_told_surfaces(layout.areas["tags"].to_numpy()[known][road]))
    priority = [
        AREA_PRIORITY.get(w, SURFACES[k].priority) for w, k in zip(kind, label, strict=True)
    ]
    kerbside = layout.areas["tags"].str.contains('"street_side"', regex=False).to_numpy()[known]
    ranks = np.where(kerbside.astype(bool), KERBSIDE_PRIORITY, priority)
    shapes = layout.areas.geometry.to_numpy()[known]
    if simplify:
        shapes = shapely.simplify(shapes, simplify)
    return regions(shapes, label, ranks, layout.areas["id"].to_numpy()[known])


def _told_surfaces(tags: NDArray[Any]) -> list[str]:
    """Surfaces that tags tell, "" where they tell none."""
    return [str(json.loads(text or "{}").get("surface", "")) for text in tags.tolist()]


def road_area_kerbs(layout: Layout, network: RoadNetwork, road: Carriageway) -> Regions:
    """Return kerb stones round the road areas of the map that kerbed carriageways run through."""
    chosen = kerbed_areas(layout, network, road)
    if not len(chosen):
        return Regions()
    rims = simplified(shapely.unary_union(chosen), FINE)
    stones = shapely.buffer(rims, KERB_WIDTH, join_style="mitre", mitre_limit=MITRE)
    label = LABEL["kerb"]
    return regions(stones, label, SURFACES[label].priority)


def kerbed_areas(layout: Layout, network: RoadNetwork, road: Carriageway) -> Shapes:
    """Return the road areas of the map that carriageways and junctions with kerbs run through.

    Such an area is drawn from kerb to kerb, and is often wider than the carriageway.
    """
    areas = layout.areas.geometry.to_numpy()[(layout.areas["kind"] == "road_area").to_numpy()]
    edges = kerbed_edges(layout, network)
    junction = np.isin(road.node, network.edge_nodes[edges])
    kerbed = np.concatenate([road.strips[edges[road.edge]], road.stars[junction]])
    if not len(areas) or not len(kerbed):
        return np.zeros(0, object)
    met, strip = shapely.STRtree(areas).query(kerbed, predicate="intersects")[::-1]
    common = shapely.area(shapely.intersection(areas[met], kerbed[strip]))
    share = np.bincount(met, common, minlength=len(areas)) / np.maximum(shapely.area(areas), 1e-9)
    return np.asarray(areas[share > DRIVEN_SHARE])


def kerbside_regions(layout: Layout, strips: Shapes) -> Regions:
    """Return what lies between parking bays beside a street and its carriageway: more asphalt.

    Bays are seldom drawn to the very edge of the carriageway; no kerb runs through the gap.
    """
    areas = layout.areas
    beside = areas["tags"].str.contains('"street_side"', regex=False).to_numpy().astype(bool)
    rows = np.flatnonzero(beside & (areas["kind"] == "parking").to_numpy())
    if not len(rows) or not len(strips):
        return Regions()
    shapes = shapely.buffer(areas.geometry.to_numpy()[rows], BAY_GAP, join_style="mitre")
    bay, strip = shapely.STRtree(strips).query(shapes, predicate="intersects")
    reach = shapely.buffer(strips[strip], BAY_GAP, join_style="mitre", quad_segs=ROUND)
    gaps = shapely.intersection(shapes[bay], reach)
    return regions(shapely.unary_union(gaps), LABEL["parking"], KERBSIDE_PRIORITY)


def garden_regions(layout: Layout) -> Regions:
    """Return the gardens round houses of one family, where nothing else is known of the ground."""
    buildings = layout.buildings
    homes = (buildings["use"].isin(WITH_GARDEN) & buildings["place"].isin(TOWN)).to_numpy()
    reach = shapely.buffer(buildings.geometry.to_numpy()[homes], GARDEN, join_style="mitre",
                           mitre_limit=MITRE)  # fmt: skip
    return regions(shapely.unary_union(reach), LABEL["grass"], GARDEN_PRIORITY)


def building_regions(layout: Layout) -> Regions:
    """Return the footprints of everything that has walls and stands on the ground."""
    parts = layout.parts
    standing = (parts["base"].to_numpy() < 0.5) & parts["walls"].to_numpy()
    shapes = parts.geometry.to_numpy()[standing]
    ways = open_ways(layout)[standing]
    opened = ~shapely.is_empty(ways)
    shapes[opened] = shapely.difference(shapes[opened], ways[opened])
    pieces, row = shapely.get_parts(shapes, return_index=True)
    owner = parts["building"].to_numpy()[standing][row]
    return regions(pieces, LABEL["building"], BUILDING_PRIORITY, owner)


def way_regions(layout: Layout, lines: Shapes, strips: Shapes) -> Regions:
    """Return paths, pedestrian streets, railway tracks and tram rails.

    Parameters
    ----------
    layout
        The layout.
    lines
        (n,) what of each way lies on the ground; empty where none of it does.
    strips
        Polygons of carriageways and junctions, in which rails lie flush.
    """
    roads = layout.roads
    kind = roads["kind"].to_numpy().astype(str)
    open_air = ~roads["tunnel"].to_numpy() & (roads["layer"].to_numpy() >= 0)
    open_air &= ~shapely.is_empty(lines)
    width = roads["width"].to_numpy()
    found = []
    on_foot = np.isin(kind, PATHS)
    paved = on_foot & _beside_streets(layout)
    loose = road_labels(roads["surface"].to_numpy()) == LABEL["gravel_road"]
    for chosen, label, least in (
        (on_foot & ~paved & loose, "trail", 1.0),
        (on_foot & ~paved & ~loose, "path", 1.2),
        (paved, "sidewalk", 1.2),
        (kind == "pedestrian", "plaza", 3.0),
    ):
        rows = np.flatnonzero(chosen & open_air)
        half = np.maximum(np.nan_to_num(width[rows], nan=2.0), least) / 2
        bands = shapely.buffer(shapely.simplify(lines[rows], FINE), half, quad_segs=ROUND,
                               join_style="mitre", mitre_limit=MITRE)  # fmt: skip
        joined = shapely.unary_union(bands)
        found.append(regions(joined, LABEL[label], SURFACES[LABEL["path"]].priority))
    track = np.flatnonzero(np.isin(kind, TRACKS) & open_air)
    bed = shapely.unary_union(
        shapely.buffer(lines[track], TRACK_BED / 2, cap_style="flat", join_style="mitre")
    )
    found.append(regions(bed, LABEL["railway"], SURFACES[LABEL["railway"]].priority))
    tram = np.flatnonzero((kind == "tram") & open_air)
    bed = shapely.unary_union(
        shapely.buffer(lines[tram], TRAM_BED / 2, cap_style="flat", join_style="mitre")
    )
    found.append(regions(bed, LABEL["setts"], TRAM_BED_PRIORITY))
    found.append(regions(rail_strips(lines[tram]), LABEL["tramway"], TRAM_RAIL_PRIORITY))
    found.append(
        regions(rail_strips(lines[track]), LABEL["rail"], SURFACES[LABEL["rail"]].priority)
    )
    level = strips[np.unique(shapely.STRtree(strips).query(lines[track], "intersects")[1])]
    if len(level):
        flush = shapely.intersection(rail_strips(lines[track]), shapely.unary_union(level))
        found.append(regions(flush, LABEL["tramway"], TRAM_RAIL_PRIORITY))
    return join_regions(found)


def _beside_streets(layout: Layout) -> NDArray[np.bool_]:
    """(n,) whether a way for people runs along or across streets and is paved like their walks.

    What the map says of its purpose or surface decides; of the others, those that keep near a
    street with sidewalks on most of their length.
    """
    roads = layout.roads
    tags = roads["tags"].str
    said = np.zeros(len(roads), bool)
    for word in ('"sidewalk"', '"crossing"', '"traffic_island"'):
        said |= tags.contains(word, regex=False).to_numpy().astype(bool)
    untold = ~tags.contains('"surface"', regex=False).to_numpy().astype(bool)
    lines = roads.geometry.to_numpy()
    walked = roads["sidewalk_left"].to_numpy() + roads["sidewalk_right"].to_numpy() > 0
    rows = np.flatnonzero(untold & (roads["kind"] == "footway").to_numpy())
    reach = NEAR_STREET + roads["width"].to_numpy(float)[walked] / 2
    tree = shapely.STRtree(shapely.buffer(lines[walked], reach, quad_segs=1, cap_style="flat"))
    near = np.zeros((3, len(rows)), bool)
    for number, share in enumerate((0.15, 0.5, 0.85)):
        at = shapely.line_interpolate_point(lines[rows], share, normalized=True)
        near[number, tree.query(at, predicate="intersects")[0]] = True
    said[rows] |= near.sum(axis=0) >= 2
    return said


def rail_strips(lines: Shapes) -> Shapes:
    """Return the two rails of each track as one geometry, so that crossing tracks merge."""
    single = shapely.get_parts(lines)
    packed = pack(single)
    strips = [line_strips(packed, np.full(len(single), s * GAUGE / 2), RAIL_WIDTH) for s in (-1, 1)]
    return np.array([shapely.unary_union(shapely.make_valid(np.concatenate(strips)))])
