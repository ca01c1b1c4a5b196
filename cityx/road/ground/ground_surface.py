"""The ground: every surface of the site in one arrangement, draped over the terrain."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.city.city import City
from cityx.city.ground import LABEL, ON_ROADWAY, SURFACES, Ground
from cityx.city.heights import WayHeights
from cityx.city.layout import Layout
from cityx.city.mesh import concatenate
from cityx.city.roads import RoadNetwork
from cityx.city.terrain import Terrain, flat_terrain
from cityx.geometry.polylines import to_linestrings
from cityx.ground.arrangement import (
    GRID,
    Regions,
    absorb_scraps,
    arrange,
    join_regions,
    regions,
    take_regions,
)
from cityx.ground.cells import relief_lines, tile_lines
from cityx.ground.drape import drape
from cityx.ground.standing import find_by_ground
from cityx.ground.surroundings import surroundings
from cityx.places.profile import TOP, Profile
from cityx.places.profiles import keeps_left, profile_named, profile_of
from cityx.protocol import Port, action, has_network
from cityx.road.ground.beds import bed_regions
from cityx.road.ground.joints import seam_lines
from cityx.road.ground.landcover import (
    area_regions,
    building_regions,
    garden_regions,
    kerbside_regions,
    road_area_kerbs,
    way_regions,
)
from cityx.road.ground.park_paths import park_regions
from cityx.road.ground.paved_blocks import pave_blocks, paved, town_regions
from cityx.road.ground.yards import patch_regions
from cityx.road.heights.retaining_walls import find_walls
from cityx.road.heights.stairs import build_stairs
from cityx.road.heights.structures import Structures, body_batch, build_structures, grounded_lines
from cityx.road.heights.tiers import level_network
from cityx.road.heights.way_heights import kept_share, way_heights
from cityx.road.network.contradictions import left_out_notes
from cityx.road.network.network import road_network
from cityx.road.surface.carriageway_regions import COARSE as ROAD_COARSE
from cityx.road.surface.carriageway_regions import plain_carriageways
from cityx.road.surface.mapped_kerbs import kerb_notes
from cityx.road.surface.street_surfaces import street_regions
from cityx.road.surface.surface_material import DRIVEN

TILE = 500.0  # metres; the largest face, so that none takes long to triangulate
RELIEF_TILE = 128.0  # metres; a cell at the border is another one for want of the heights beyond
PLAIN_TILE = 1000.0  # the same at detail level 0, where faces have fewer corners
ROADWAY = tuple(LABEL[name] for name in DRIVEN)
SCRAP = 3.0  # square metres of a junction's surface that something cut off from the rest
WALL_STONE = "stone"  # of retaining walls
COARSE = 2.0  # metres by which land cover is simplified at detail level 0


@action(
    "road/ground-v1",
    limits=[
        "Ways that cross without a shared node at one level melt into one surface.",
        "Detail level 0 leaves out kerbs, and tracks through fields and woods.",
        "Land misses its heights by 0.2 m at most; on sites of many square kilometres by what the "
        "report says.",
        "Underground paths and tracks are built as far as one sees into their mouths, if there is "
        "room.",
    ],
    requires=("layout", has_network()),
    after=("road/heights-v1",),
    takes=(Port("network", "line", role="road_network"),),
    gives=(Port("ground", "surface", role="ground"), Port("mesh", "complex_geometry", "ground")),
)
def ground(city: City) -> City:
    """Lay roads, junctions, kerbs, sidewalks, markings, water and greens over the terrain.

    Ways that leave it get decks, ramps, cuttings and tunnels.
    """
    city = _with_heights(city)
    network = city.network
    assert network is not None
    assert city.heights is not None
    lines, tolerance = cell_lines(city.layout, city.terrain, city.lod)
    profile = profile_of(city.frame)
    built = build_structures(
        city.layout,
        network,
        city.heights,
        city.terrain,
        seed=city.seed,
        detail=city.lod > 0,
        painting=profile.painting,
    )
    level = level_network(network, city.heights)
    found = _regions(city.layout, level, city.heights, built, city.lod, profile)
    walls = find_walls(city.layout, level, city.terrain)
    if city.lod > 0:
        seams = seam_lines(city.layout, level)
        lines = np.concatenate([lines, walls.lines, seams])
    arranged = arrange(found, city.layout.extent, lines=lines)
    if city.lod > 0:
        arranged = pave_blocks(arranged, city.layout)
        arranged = absorb_scraps(arranged, LABEL["junction"], SCRAP, ON_ROADWAY, DRIVEN)
    base = city.terrain.height_at(arranged.vertices)
    if city.lod > 0:
        base = walls.heights(arranged.vertices, base)
    laid = paved(arranged, network, city.layout, profile.land) if city.lod > 0 else None
    base = np.round(base, 4)
    draped = drape(arranged, city.terrain, city.seed, flush=city.lod == 0, base=base, paving=laid)
    if city.lod > 0:
        find_by_ground(arranged, draped)
    scene = city.scene.with_mesh("ground", draped)
    survey = city.survey
    around = survey.around if survey is not None else None
    beyond, far_tolerance = surroundings(arranged, city.terrain, around)
    scene = scene.with_mesh("surroundings", beyond)
    if survey is not None:
        survey = replace(survey, tolerance=tolerance, far_tolerance=far_tolerance)
    layers = {"decks": built.surfaces, "structures": built.bodies}
    if city.lod > 0:
        held = body_batch(walls.bodies(), "retaining walls", WALL_STONE)
        layers["structures"] = concatenate([built.bodies, held])
    if city.lod > 1:
        layers["stairs"] = build_stairs(city.layout, city.heights, city.terrain)
    for layer, mesh in layers.items():
        if mesh.count:
            scene = scene.with_mesh(layer, mesh)
    told = left_out_notes(city.layout, built.left_out)
    if city.lod > 0:
        told += kerb_notes(city.layout, arranged)
    notes = city.notes + tuple(note for note in told if note not in city.notes)
    return replace(city, ground=arranged, scene=scene, survey=survey, notes=notes)


def _with_heights(city: City) -> City:
    """Return the city with a network and its heights, made now where they are missing."""
    network = city.network
    if network is None:
        network = road_network(city.layout, left_hand=keeps_left(city.frame))
        city = replace(city, heights=None)
    if city.heights is not None:
        return replace(city, network=network)
    network, heights, terrain, told = way_heights(
        city.layout, network, city.terrain, share=kept_share(city)
    )
    notes = city.notes + told
    return replace(city, network=network, heights=heights, terrain=terrain, notes=notes)


def _regions(
    layout: Layout,
    level: RoadNetwork,
    heights: WayHeights,
    built: Structures,
    lod: int,
    profile: Profile | None = None,
) -> Regions:
    """Return what covers the site: the pieces of roads on the ground, and openings for the rest."""
    label = LABEL["void"]
    opened = regions(built.opening, label, SURFACES[label].priority)
    if lod == 0:
        return join_regions([plain_regions(layout, level), opened])
    ways = grounded_lines(layout, heights)
    return join_regions([detailed_regions(layout, level, ways, profile), opened])


def plain_regions(layout: Layout, network: RoadNetwork) -> Regions:
    """Return roads and land cover without detail, and the houses that reach into a road."""
    tracks = (layout.roads["kind"] == "track").to_numpy()
    on_ground = ~tracks[network.edge_road]
    roads, houses = plain_carriageways(layout, network, on_ground), building_regions(layout)
    areas = area_regions(layout, COARSE)
    lines = to_linestrings(network.lines)[on_ground]
    tree = shapely.STRtree(houses.polygons)
    reach = network.half_width[on_ground] + ROAD_COARSE + GRID
    near = [tree.query(lines, predicate="dwithin", distance=reach)[1]]
    shapes = areas.polygons[np.isin(areas.label, ROADWAY)]
    near.append(tree.query(shapes, predicate="dwithin", distance=GRID)[1])
    return join_regions([
        roads,
        areas,
        town_regions(layout),
        take_regions(houses, np.unique(np.concatenate(near))),
    ])  # fmt: skip


def detailed_regions(
    layout: Layout, network: RoadNetwork, ways: NDArray[Any], profile: Profile | None = None
) -> Regions:
    """Return every surface of the site, markings included.

    Parameters
    ----------
    layout
        The layout.
    network
        The pieces of its roads that lie on the ground.
    ways
        (n,) what of each way of the layout does.
    profile
        Of the place, None for that of the world.
    """
    profile = profile or profile_named(TOP)
    streets, road = street_regions(layout, network, profile.painting)
    strips = np.concatenate([road.strips, road.stars])
    return join_regions([
        streets,
        area_regions(layout),
        park_regions(layout),
        kerbside_regions(layout, strips),
        road_area_kerbs(layout, network, road),
        garden_regions(layout),
        patch_regions(layout, network, profile.land),
        bed_regions(layout, network, road, profile.land),
        building_regions(layout),
        way_regions(layout, ways, strips),
    ])  # fmt: skip


def cell_lines(layout: Layout, terrain: Terrain, lod: int) -> tuple[NDArray[Any], float]:
    """Return lines at which faces are cut, and the tolerance of the cells between them.

    They are large tiles, and smaller cells where there is relief, which tiles cut as well.
    """
    tiles = tile_lines(layout.extent, TILE if lod > 0 else PLAIN_TILE)
    if terrain.is_flat:
        return tiles, 0.0
    lines, tolerance = relief_lines(layout.extent, terrain, RELIEF_TILE)
    return np.concatenate([lines, tiles]), tolerance


def ground_of(layout: Layout, *, terrain: Terrain | None = None, lod: int = 2) -> Ground:
    """Arrange the ground of a layout without the rest of a city."""
    terrain = terrain if terrain is not None else flat_terrain()
    network, heights, terrain, _ = way_heights(layout, road_network(layout), terrain)
    built = build_structures(layout, network, heights, terrain, detail=lod > 0)
    found = _regions(layout, level_network(network, heights), heights, built, lod)
    arranged = arrange(found, layout.extent, lines=cell_lines(layout, terrain, lod)[0])
    return pave_blocks(arranged, layout) if lod > 0 else arranged
