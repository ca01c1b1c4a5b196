"""The ground: every surface of the site in one arrangement, draped over the terrain."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.city.city import City
from cityx.city.ground import LABEL, Ground
from cityx.city.layout import Layout
from cityx.city.roads import RoadNetwork
from cityx.city.terrain import Terrain, flat_terrain
from cityx.geometry.arrangement import GRID, Regions, arrange, join_regions, take_regions
from cityx.geometry.cells import relief_lines, tile_lines
from cityx.geometry.drape import drape, surroundings
from cityx.geometry.driving import keeps_left
from cityx.geometry.polylines import Polylines, to_linestrings
from cityx.plugins.road.blocks import pave_blocks, town_regions
from cityx.plugins.road.bridges import LOW, deck_mesh, deck_rows, plan_decks
from cityx.plugins.road.carriageway import COARSE as ROAD_COARSE
from cityx.plugins.road.carriageway import (
    build_carriageway,
    carriageway_regions,
    plain_carriageways,
)
from cityx.plugins.road.drops import dropped_regions
from cityx.plugins.road.landcover import (
    area_regions,
    building_regions,
    deck_ground_regions,
    kerbside_regions,
    way_regions,
)
from cityx.plugins.road.markings import marking_regions, painted_edges, street_of, zebras_of
from cityx.plugins.road.medians import median_regions
from cityx.plugins.road.network import road_network
from cityx.plugins.road.painting import Painting, painting_of
from cityx.plugins.road.roundabouts import roundabout_regions
from cityx.plugins.road.sections import bands_of
from cityx.protocol import Port, action, has_network

TILE = 500.0  # metres; the largest face, so that none takes long to triangulate
PLAIN_TILE = 1000.0  # the same at detail level 0, where faces have fewer corners
ROADWAY = tuple(LABEL[name] for name in ("carriageway", "setts", "gravel_road"))
USUAL = Painting()
COARSE = 2.0  # metres by which land cover is simplified at detail level 0


@action(
    "road/ground-v1",
    limits=[
        "Ways that cross without a shared node at one level melt into one surface.",
        "Decks of branching bridges meet without a joint.",
        "Detail level 0 leaves out kerbs, and tracks through fields and woods.",
    ],
    requires=("layout", has_network()),
    takes=(Port("network", "line", role="road_network"),),
    gives=(Port("ground", "surface", role="ground"),),
)
def ground(city: City) -> City:
    """Lay roads, junctions, kerbs, sidewalks, markings, water and greens over the terrain."""
    network = city.network
    if network is None:
        network = road_network(city.layout, left_hand=keeps_left(city.frame))
    lines = cell_lines(city.layout, city.terrain, city.lod)
    decks = deck_rows(city.layout)
    plan = plan_decks(city.layout, city.terrain, decks)
    build: Callable[..., Regions] = plain_regions
    if city.lod > 0:
        build = partial(detailed_regions, painting=painting_of(city.frame))
    found = build(city.layout, network, decks, plan)
    arranged = arrange(found, city.layout.extent, lines=lines)
    if city.lod > 0:
        arranged = pave_blocks(arranged, city.layout)
    draped = drape(arranged, city.terrain, city.seed, flush=city.lod == 0)
    scene = city.scene.with_mesh("ground", draped)
    scene = scene.with_mesh("surroundings", surroundings(arranged, city.terrain))
    bridges = deck_mesh(city.layout, plan)
    if bridges.count:
        scene = scene.with_mesh("bridges", bridges)
    return replace(city, network=network, ground=arranged, scene=scene)


def plain_regions(
    layout: Layout, network: RoadNetwork, decks: NDArray[np.bool_], plan: Any
) -> Regions:
    """Return roads and land cover without detail, and the houses that reach into a road."""
    tracks = (layout.roads["kind"] == "track").to_numpy()
    on_ground = ~(decks | tracks)[network.edge_road]
    roads, houses = plain_carriageways(layout, network, on_ground), building_regions(layout)
    areas, under_decks = area_regions(layout, COARSE), deck_ground_regions(plan, LOW)
    lines = to_linestrings(Polylines(network.points, network.point_start))[on_ground]
    tree = shapely.STRtree(houses.polygons)
    reach = network.half_width[on_ground] + ROAD_COARSE + GRID
    near = [tree.query(lines, predicate="dwithin", distance=reach)[1]]
    for paved in (areas, under_decks):
        shapes = paved.polygons[np.isin(paved.label, ROADWAY)]
        near.append(tree.query(shapes, predicate="dwithin", distance=GRID)[1])
    return join_regions([
        roads,
        areas,
        town_regions(layout),
        take_regions(houses, np.unique(np.concatenate(near))),
        under_decks,
    ])  # fmt: skip


def detailed_regions(
    layout: Layout, network: RoadNetwork, decks: NDArray[np.bool_], plan: Any, *,
    painting: Painting = USUAL,
) -> Regions:  # fmt: skip
    """Return every surface of the site, markings included."""
    on_ground = ~decks[network.edge_road]
    road = build_carriageway(layout, network, on_ground)
    street = street_of(layout, network, bands_of(layout, network))
    painted = painted_edges(street, on_ground)
    zebras = zebras_of(street, painted)
    return join_regions([
        carriageway_regions(layout, network, on_ground, road),
        marking_regions(street, zebras, painted, road, painting),
        dropped_regions(street, zebras, yellow=painting.yellow_tactile),
        median_regions(layout, network, on_ground),
        roundabout_regions(layout, network, on_ground),
        area_regions(layout),
        kerbside_regions(layout, np.concatenate([road.strips, road.stars])),
        building_regions(layout),
        way_regions(layout, decks, np.concatenate([road.strips, road.stars])),
        deck_ground_regions(plan, LOW),
    ])  # fmt: skip


def cell_lines(layout: Layout, terrain: Terrain, lod: int) -> NDArray[Any]:
    """Lines at which faces are cut: large tiles, and smaller cells where there is relief."""
    if terrain.is_flat:
        return tile_lines(layout.extent, TILE if lod > 0 else PLAIN_TILE)
    return relief_lines(layout.extent, terrain, TILE)[0]


def ground_of(layout: Layout, *, terrain: Terrain | None = None, lod: int = 2) -> Ground:
    """Arrange the ground of a layout without the rest of a city."""
    network = road_network(layout)
    decks = deck_rows(layout)
    terrain = terrain if terrain is not None else flat_terrain()
    plan = plan_decks(layout, terrain, decks)
    build = plain_regions if lod == 0 else detailed_regions
    lines = cell_lines(layout, terrain, lod)
    found = build(layout, network, decks, plan)
    arranged = arrange(found, layout.extent, lines=lines)
    return pave_blocks(arranged, layout) if lod > 0 else arranged
