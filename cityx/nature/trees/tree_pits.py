"""Tree pits where trees stand on paving: soil in an edging, an iron grate, an island of a lot.

Where trees are clipped, strips of soil with bushes lie along the kerb between the trees of a row.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.assets.furniture.tree_pits import (
    LOT_ISLAND,
    OTHERS,
    PITS,
    STRIP,
    STRIP_HALF,
    TREE_STRIP,
    pit,
)
from cityx.city import City, Instances, Prototype
from cityx.city.rows import join_rows
from cityx.geometry.clearance import near_any
from cityx.geometry.polylines import to_linestrings
from cityx.geometry.scatter import Points
from cityx.ground.pieces import heights, room_along, walk_rims, ways_to_doors
from cityx.ground.standing import stand_on
from cityx.ground.walking.passage import FREE
from cityx.ids import hash_ids, uniform
from cityx.nature.furniture.furnishing import lamp_places
from cityx.nature.trees.stands import Stand, draw_species, stand_of
from cityx.nature.trees.tree_room import CLIPPED, custom_of
from cityx.road.parking.bays import lot_islands

PAVED = ("sidewalk", "furnishing", "plaza", "frontage", "courtyard")
BUSHES = ("shrub_", "boxwood_", "grove_")  # prototypes that need no pit
PLANTED = 0.35  # share of the pits that have plants
YOUNG = 0.62  # of its grown height, below which a tree is held by stakes
STREET_REACH = 20.0  # metres to the street a pit is square to
NARROW = 0.62  # breadth of pits right behind a kerb, as a share of their length
STRIPS_AT = (1.6, 3.2, 4.8)  # metres along the street from a trunk to the strips behind it
TO_TRUNK = STRIP / 2 + 0.65  # metres from the middle of a strip to the middles of other pits
TO_KERB = STRIP_HALF + 0.25  # metres from it to what must be a raised kerb
TO_THINGS, TO_DOORS = 1.2, 1.5  # metres from it to what the map shows, to ways to doors
PURPOSE = "nature/lot_islands"
TALL = (5.5, 9.0)  # metres; their crowns leave headroom over the bays beside them


def with_pits(city: City, trees: Instances) -> City:
    """Put a pit under every tree that stands on paving, and islands into large car parks.

    Parameters
    ----------
    city
        City with its trees; without a ground it is returned as it is.
    trees
        Rows of its trees, counting the scene's prototypes or the offered ones.
    """
    counted = replace(trees, prototype=city.scene.instances["trees"].prototype)
    found, islands = pits_of(city, counted), island_rows(city)
    kinds, groups = ([], []) if found is None else (found[0], [found[1]])
    if found is not None and custom_of(city.frame) == CLIPPED:
        groups.append(_strips(city, found[1], trees.position[:, :2]))
        kinds = [*kinds, pit(TREE_STRIP)]
    if islands is not None:
        made, rows = islands
        groups.append(replace(rows, prototype=rows.prototype + len(kinds)))
        kinds = [*kinds, made]
    if not groups:
        return city
    pits = join_rows(groups)
    return replace(city, scene=city.scene.with_instances("tree_pits", kinds, pits))


def pits_of(city: City, trees: Instances) -> tuple[list[Prototype], Instances] | None:
    """Return the pits of trees that stand on paving, with their kinds; None where none does.

    Parameters
    ----------
    city
        City with its ground.
    trees
        Rows that count the scene's prototypes.
    """
    if city.ground is None or not trees.count:
        return None
    bush = np.array([p.name.startswith(BUSHES) for p in city.scene.prototypes])
    on = city.ground.on(trees.position[:, :2], *PAVED)
    chosen = np.flatnonzero(on & ~bush[trees.prototype])
    if not len(chosen):
        return None
    # One kind for the whole place, as a city buys its grates once; residents plant some of them.
    kind = list(PITS)[int(uniform(city.seed, "nature/tree_pits", np.uint64(1)) * len(PITS))]
    ids = hash_ids(0, "nature/tree_pits", trees.object_id[chosen])
    order = np.argsort(ids)
    chosen, ids = chosen[order], ids[order]
    count = len(chosen)
    rotation = np.zeros((count, 3), np.float32)
    rotation[:, 2] = _along_street(city, trees.position[chosen, :2])
    planted = uniform(city.seed, "nature/tree_pits/planted", trees.object_id[chosen]) < PLANTED
    scale = np.ones((count, 3), np.float32)
    if custom_of(city.frame) == CLIPPED:
        scale[:, 1] = NARROW
    young = trees.scale[chosen, 2] < YOUNG
    number = np.where(young, 2, np.where(planted, 1, 0)).astype(np.int32)
    return [pit(name) for name in (kind, *OTHERS)], Instances(
        number, ids, trees.object_id[chosen], trees.position[chosen], rotation,
        scale, np.ones((count, 3), np.float32),
    )  # fmt: skip


def _strips(city: City, pits: Instances, trunks: NDArray[np.float64]) -> Instances:
    """Lay strips behind trees where they leave the walk, doors and dropped kerbs alone."""
    ground = city.ground
    assert ground is not None
    yaw = np.repeat(pits.rotation[:, 2].astype(float), len(STRIPS_AT))
    along = np.column_stack([np.cos(yaw), np.sin(yaw)])
    shift = np.tile(STRIPS_AT, pits.count)[:, None] * along
    xy = np.repeat(pits.position[:, :2], len(STRIPS_AT), axis=0) + shift
    left = np.column_stack([-along[:, 1], along[:, 0]])
    lies = np.zeros(len(xy), bool)
    rims = walk_rims(ground)
    for out in (left, -left):  # the kerb is on one of both sides
        behind = ground.on(xy - TO_KERB * out, "kerb")
        behind &= room_along(xy, out, rims, 4.0) >= STRIP_HALF + FREE
        lies |= behind
    for corner in ((1, 1), (1, -1), (-1, 1), (-1, -1)):
        spot = xy + corner[0] * STRIP / 2 * along + corner[1] * (STRIP_HALF + 0.02) * left
        lies &= ground.on(spot, *PAVED)
    points = city.layout.points.geometry.to_numpy()
    for things, gap in (
        (shapely.points(lamp_places(city)), TO_THINGS),
        (points, TO_THINGS),
        (ways_to_doors(city), TO_DOORS),
        (shapely.points(trunks), TO_TRUNK),
    ):
        lies &= ~near_any(xy, things, gap)
    rows = np.flatnonzero(lies)
    position = np.column_stack([xy[rows], heights(city, xy[rows])])
    rotation = np.zeros((len(rows), 3), np.float32)
    rotation[:, 2] = yaw[rows]
    tree, place = rows // len(STRIPS_AT), rows % len(STRIPS_AT)
    ones = np.ones((len(rows), 3), np.float32)
    return Instances(
        np.full(len(rows), 1 + len(OTHERS), np.int32),
        hash_ids(0, "nature/tree_pits/strip", pits.object_id[tree], place),
        pits.owner[tree], position, rotation, ones, ones,
    )  # fmt: skip


def _along_street(city: City, xy: NDArray[np.float64]) -> NDArray[np.float64]:
    """(n,) angle of the nearest street, radians counter-clockwise from east; 0 far from any."""
    angle = np.zeros(len(xy))
    network = city.network
    if network is None or not network.edge_count:
        return angle
    lines = to_linestrings(network.lines)
    spots = shapely.points(xy)
    spot, edge = shapely.STRtree(lines).query_nearest(spots, max_distance=STREET_REACH,
                                                      all_matches=False)  # fmt: skip
    at = shapely.line_locate_point(lines[edge], spots[spot])
    ends = [shapely.get_coordinates(shapely.line_interpolate_point(lines[edge], at + shift))
            for shift in (-0.5, 0.5)]  # fmt: skip
    way = ends[1] - ends[0]
    angle[spot] = np.arctan2(way[:, 1], way[:, 0])
    return angle


def island_stands(city: City) -> list[Stand]:
    """Plant a tree in the middle of every island; all trees of a car park are of one species."""
    islands = lot_islands(city)
    if not len(islands.id):
        return []
    low, high = TALL
    height = low + (high - low) * uniform(city.seed, f"{PURPOSE}/height", islands.id)
    areas = city.layout.areas
    lot = shapely.STRtree(areas.geometry.to_numpy()[areas["kind"] == "parking"])
    island, row = lot.query(shapely.points(islands.xy), predicate="within")
    kin = np.zeros(len(islands.id), np.uint64)
    kin[island] = areas["id"].to_numpy()[areas["kind"] == "parking"][row]
    species = draw_species("street", city, kin)
    points = Points(islands.xy, hash_ids(0, f"{PURPOSE}/tree", islands.id))
    # They stand where a bay was, nearer to driven ground than any other tree that a rule plants.
    return [stand_of(points, species, height, mapped=True)]


def island_rows(city: City) -> tuple[Prototype, Instances] | None:
    """Return the islands themselves, as rows of their one prototype; None where there is none."""
    islands = lot_islands(city)
    count = len(islands.id)
    if not count:
        return None
    order = np.argsort(islands.id)
    islands = islands.take(order)
    z = stand_on(city.scene.meshes.get("ground"), islands.xy).z
    rotation = np.zeros((count, 3), np.float32)
    rotation[:, 2] = islands.yaw
    ones = np.ones((count, 3), np.float32)
    return pit(LOT_ISLAND), Instances(
        np.zeros(count, np.int32), hash_ids(0, PURPOSE, islands.id), np.zeros(count, np.uint64),
        np.column_stack([islands.xy, z]), rotation, ones, ones,
    )  # fmt: skip
