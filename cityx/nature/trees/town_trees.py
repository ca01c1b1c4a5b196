"""Trees of towns that no map shows: along wide streets, in yards, on islands of roundabouts."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.city import City
from cityx.city.ground import KERB_WIDTH
from cityx.city.layout import in_town
from cityx.geometry.arrays import FloatArray
from cityx.geometry.clearance import distance_within, near_any, spots_of
from cityx.geometry.polylines import to_linestrings
from cityx.geometry.ranges import counted
from cityx.geometry.scatter import Points, candidates, cells_about, thin
from cityx.ground.pieces import room_along, walk_rims, ways_to_doors
from cityx.ground.standing import WALKED
from cityx.ids import choose, hash_ids, stable_id, uniform
from cityx.nature.trees.stands import INDEX, Stand, draw_species, stand_of
from cityx.nature.trees.tree_room import CLIPPED, custom_of, sight_at
from cityx.places.profiles import climate_of, profile_of
from cityx.road.surface.kerbs import join_places, places_along
from cityx.road.surface.roundabouts import Islands, islands_of, ring_edges

STREET, YARD = "nature/trees-v2/street", "nature/trees-v2/yard"
STREET_SPACINGS = (7.0, 8.0, 9.0, 10.0)  # metres between the trees of a street, drawn per street
CLEAR = 1.06  # times a least distance that trees are planted apart, since some are moved a little
STREET_SHARE, MAIN_SHARE = 0.8, 0.95  # of the streets that are wide enough, of the main ones
STREET_KINDS = ("residential", "tertiary", "secondary", "primary", "unclassified", "living_street")
MAIN_KINDS = ("tertiary", "secondary", "primary")
LEAST_WALK = 2.0  # metres of sidewalk; nobody plants trees along narrower ones of side streets
WIDE_WAY = 2.1  # metres from trunks where walks are not told but measured, some 3 m in all
TRUNK_WAY = 1.7  # metres of walk and paved court from the middle of a trunk, so that 1.2 m are left
# The same of clipped trees, which are slender; there each street that bears a name has some.
CLIPPED_WALK, CLIPPED_WAY, CLIPPED_WIDE_WAY = 1.8, 1.35, 1.7
# Metres that they are clipped to, drawn per street, and by which its trees differ.
CLIPPED_HEIGHT, CLIPPED_SPREAD = (6.2, 8.2), 0.6
# Where facades are near, trees are kept small.
NARROW = 19.0  # metres from facade to facade, the median of a street
SMALL_HEIGHT = (5.2, 7.4)  # metres, drawn per street
VERGES = ("grass", "block")  # ground beside carriageways where trees leave the walk alone
HOUSES_WITHIN = 25.0  # metres; a street has trees only where it has houses on its side
MAPPED_WITHIN = 45.0  # metres; where the map shows trees of a street it shows all of them
OF_STREET = 4.5  # metres beside a carriageway in which mapped trees are those of its street
YARD_SPACING = 6.5  # metres between the trees of yards
YARD_REACH = 60.0  # metres from a house of a town
FROM_EDGE = 1.5  # metres from a trunk in paving to where the paving ends
LONE = 5.0  # metres to mapped trees
# Share of the places of yards that have a plant, by what the ground is.
YARD_SHARES = {"grass": 0.75, "block": 0.45, "bare": 0.9, "courtyard": 0.35, "frontage": 0.5,
               "gravel": 0.3}  # fmt: skip
BUSH_SHARE = 0.3  # of the plants on lawns
DOOR_HALF = 1.1  # metres, half the breadth of the way to a door
PURPOSE = "nature/roundabout_plants"
# Lawn behind the kerb on which nothing grows: what rides along sees who comes from its side, and
# trailers of lorries sweep over it.
VERGE = 2.0  # metres
# Rows of bushes one behind the other: of which kind, metres between them, metres behind the first,
# and how high. They hide the far side, so that drivers heed the ring (FGSV, Merkblatt für die
# Anlage von Kreisverkehren, 2006).
ROWS = (("boxwood", 0.7, 0.0, (0.5, 0.7)), ("shrub", 1.2, 1.3, (0.9, 1.4)))
DESIGNS = (6, 1)  # weights of bushes about trees and of mown grass alone
PLANTED = 0
LEAST_ROW = 1.2  # metres of radius of a row of bushes
FOR_ONE, FOR_THREE = 4.0, 8.5  # metres of radius of an island with one tree, and with three
APART = 2.6  # metres from the middle to each of three trees
TREES = (5.5, 8.5)  # metres


def along_streets(
    city: City, mapped: FloatArray, *, apart: tuple[float, float] = (0.0, math.inf)
) -> list[Stand]:
    """Plant some of the wide streets of an urban place, away from the trees that are mapped.

    Parameters
    ----------
    city
        City with its network.
    mapped
        (m, 2) float, trees of the map.
    apart
        Least and greatest metres between the trees of a street.
    """
    network = city.network
    if network is None or not network.edge_count:
        return []
    roads = city.layout.roads
    kind = roads["kind"].to_numpy().astype(str)[network.edge_road]
    flat = (roads["layer"].to_numpy() == 0) & ~roads["bridge"].to_numpy()
    road_id = roads["id"].to_numpy()[network.edge_road]
    name = roads["name"].to_numpy().astype(str)[network.edge_road]
    key = np.array([stable_id("street", n) if n else int(i)
                    for n, i in zip(name, road_id, strict=True)], np.uint64)  # fmt: skip
    custom = custom_of(city.frame)
    clipped = custom == CLIPPED
    major = np.isin(kind, MAIN_KINDS) | (clipped & (name != ""))
    share = np.where(major, MAIN_SHARE, STREET_SHARE)
    green = uniform(city.seed, STREET, key) < share
    green &= np.isin(kind, STREET_KINDS) & flat[network.edge_road]
    nearest, farthest = apart
    nearest = min(CLEAR * nearest, farthest)
    spacings = [one for one in STREET_SPACINGS if nearest <= one <= farthest] or [
        min(max(STREET_SPACINGS[0], nearest), farthest)
    ]
    spacing = choose(city.seed, STREET, key, [1.0] * len(spacings), 1)
    groups = []
    sight = sight_at(city)[network.edge_nodes]
    walks = roads[["sidewalk_right", "sidewalk_left"]].to_numpy(float)[network.edge_road]
    told = walks >= (CLIPPED_WALK if clipped else LEAST_WALK)
    way, wide_way = (CLIPPED_WAY, CLIPPED_WIDE_WAY) if clipped else (TRUNK_WAY, WIDE_WAY)
    for side in (1, -1):
        # Trees of both sides stand in turn.
        walk = walks[:, int(side > 0)]
        wide = (walk >= LEAST_WALK) | (walk == 0.0) | major  # what is not told is measured below
        for number, metres in enumerate(spacings):
            edges = np.flatnonzero(green & wide & (spacing == number))
            groups.append(
                places_along(network, edges, side, spacing=metres, beyond=custom.kerb + 0.1,
                             margin=np.maximum(sight[edges], metres / 2),
                             phase=0.25 * (side < 0))
            )  # fmt: skip
    places = join_places(*groups)
    houses = city.layout.buildings.geometry.to_numpy()
    spots = spots_of(places.xy)
    facade = distance_within(spots, houses, HOUSES_WITHIN)
    keep = np.isfinite(facade) & (facade >= custom.facade)
    half = network.half_width[places.edge] + custom.kerb + np.fmin(facade, HOUSES_WITHIN)
    small = (_median(half, network.edge_id[places.edge]) < NARROW / 2) & (not clipped)
    keep &= ~near_any(spots, shapely.points(mapped), LONE)
    keep[keep] = ~_shown(city, places.xy[keep], key[places.edge[keep]], key, mapped)
    places, small = places.take(keep), small[keep]
    if city.ground is not None:
        rims = walk_rims(city.ground)
        room = room_along(places.xy, -places.toward_road, rims, 2 * TRUNK_WAY)
        least = np.where(told[places.edge, (places.side > 0).astype(int)], way, wide_way)
        free = (room >= least) & city.ground.on(places.xy, *WALKED)
        free |= city.ground.on(places.xy, *VERGES)
        places, small = places.take(free), small[free]
    ids = hash_ids(0, STREET, network.edge_id[places.edge],
                   2 * places.number + (places.side > 0))  # fmt: skip
    species = draw_species("street", city, key[places.edge])
    low, high = CLIPPED_HEIGHT if clipped else SMALL_HEIGHT
    height = low + (high - low) * uniform(city.seed, f"{STREET}/height", key[places.edge])
    height += CLIPPED_SPREAD * (uniform(city.seed, f"{STREET}/spread", ids) - 0.5)
    height = np.where(small | clipped, height, np.nan)
    return [stand_of(Points(places.xy, ids), species, height, line=network.edge_id[places.edge],
                     place=2 * places.number + (places.side > 0))]  # fmt: skip


def _median(value: FloatArray, group: NDArray[np.uint64]) -> FloatArray:
    """(n,) median of the values of each one's group."""
    _, index = np.unique(group, return_inverse=True)
    order = np.lexsort((value, index))
    count = np.bincount(index)
    middle = np.cumsum(count) - count + count // 2
    return np.asarray(value[order][middle][index])


def _shown(
    city: City, xy: FloatArray, street: NDArray[np.uint64], key: NDArray[np.uint64],
    mapped: FloatArray,
) -> NDArray[np.bool_]:  # fmt: skip
    """(n,) whether the map shows the trees of streets, given by (e,) key of edges, at places."""
    network = city.network
    assert network is not None
    points = shapely.points(mapped)
    edge, tree = shapely.STRtree(points).query(
        to_linestrings(network.lines), predicate="dwithin", distance=network.half_width + OF_STREET
    )
    place, near = spots_of(xy).tree.query(points[tree], predicate="dwithin", distance=MAPPED_WITHIN)
    shown = np.zeros(len(xy), bool)
    shown[near[key[edge][place] == street[near]]] = True
    return shown


def in_yards(city: City, mapped: FloatArray) -> list[Stand]:
    """Plant the lawns, beds and courts about the houses of towns.

    Parameters
    ----------
    city
        City with its ground.
    mapped
        (m, 2) float, trees of the map.
    """
    ground = city.ground
    buildings = city.layout.buildings
    houses = buildings.geometry.to_numpy()
    urban = houses[in_town(buildings)]
    if ground is None or not len(urban):
        return []
    cells = cells_about(shapely.bounds(urban), YARD_SPACING, YARD_REACH)
    found = thin(candidates(cells, YARD_SPACING, seed=city.seed, purpose=YARD), YARD_SPACING)
    number = ground.first_of(found.xy, *YARD_SHARES)  # -1, the last of each, stands for none
    name = np.array([*YARD_SHARES, ""])[number]
    share = np.array([*YARD_SHARES.values(), 0.0])[number]
    soft, bed = np.isin(name, ("grass", "block")), name == "bare"
    share *= profile_of(city.frame).trees.yards[climate_of(city.frame)]
    keep = uniform(city.seed, f"{YARD}/some", found.id) < share
    # Land that the map describes has the trees that it is said to have.
    known = city.layout.areas
    known = known.geometry.to_numpy()[(known["kind"] != "residential").to_numpy()]
    for things, gap in (
        (known, 0.5), (shapely.points(mapped), LONE), (ways_to_doors(city), DOOR_HALF),
    ):  # fmt: skip
        rows = np.flatnonzero(keep)
        keep[rows] = ~near_any(found.xy[rows], things, gap)
    rows = np.flatnonzero(keep & ~soft & ~bed)
    keep[rows] = ~near_any(found.xy[rows], walk_rims(ground), FROM_EDGE)
    points = Points(found.xy[keep], found.id[keep])
    bush = bed | (soft & (uniform(city.seed, f"{YARD}/bush", found.id) < BUSH_SHARE))
    species = np.where(bush[keep], INDEX["shrub"], draw_species("park", city, points.id))
    return [stand_of(points, species)]


def roundabout_stands(city: City, have: FloatArray) -> list[Stand]:
    """Plant the islands of roundabouts on which the map has nothing.

    Parameters
    ----------
    city
        City with a ground.
    have
        (n, 2) trees of the map, metres.
    """
    network = city.network
    if city.ground is None or network is None or not network.edge_count:
        return []
    islands = islands_of(network, ring_edges(city.layout, network))
    if not len(islands.id):
        return []
    free = ~islands.crossed & (islands.radius - islands.apron > FOR_ONE)
    told = np.concatenate([shapely.points(have), city.layout.points.geometry.to_numpy()])
    free[shapely.STRtree(islands.within(0.0)).query(told, predicate="within")[1]] = False
    planted = np.flatnonzero(free & (choose(city.seed, PURPOSE, islands.id, DESIGNS) == PLANTED))
    stands = [_trees(city, islands, planted)]
    lawn = islands.apron + KERB_WIDTH + VERGE
    for name, spacing, behind, (low, high) in ROWS:
        rows = islands.within(lawn + behind)[planted]
        points = _along(rows, islands.id[planted], spacing, name)
        on = city.ground.on(points.xy, "grass")
        points = Points(points.xy[on], points.id[on])
        height = low + (high - low) * uniform(city.seed, f"{PURPOSE}/height", points.id)
        # Low bushes of a bed, which may stand as near to a carriageway as mapped ones do.
        stands.append(stand_of(points, INDEX[name], height, mapped=True, light=True))
    return stands


def _along(rows: NDArray[Any], ids: NDArray[np.uint64], spacing: float, name: str) -> Points:
    """Put points along the outlines of round beds, the same distance apart."""
    outline = shapely.get_exterior_ring(rows)  # None of a bed in several parts, which has no points
    length = shapely.length(outline)
    count = np.where(length >= 2 * np.pi * LEAST_ROW, length // spacing, 0).astype(np.int64)
    row, place = counted(count)
    along = shapely.line_interpolate_point(outline[row], place * (length[row] / count[row]))
    ids = hash_ids(0, f"{PURPOSE}/{name}", ids[row], place)
    return Points(shapely.get_coordinates(along), ids)


def _trees(city: City, islands: Islands, rows: NDArray[np.int64]) -> Stand:
    """Put one tree amid a small island, three of one species amid a large one."""
    three = islands.radius[rows] - islands.apron[rows] > FOR_THREE
    which, place = counted(np.where(three, 3, 1))
    row = rows[which]
    turn = 2 * np.pi * (uniform(city.seed, f"{PURPOSE}/turn", islands.id[row]) + place / 3)
    reach = np.where(three[which], APART, 0.0)
    middle = shapely.get_coordinates(shapely.centroid(islands.polygon[row]))
    xy = middle + reach[:, None] * np.column_stack([np.cos(turn), np.sin(turn)])
    ids = hash_ids(0, f"{PURPOSE}/tree", islands.id[row], place)
    low, high = TREES
    height = low + (high - low) * uniform(city.seed, f"{PURPOSE}/tree", ids)
    species = draw_species("street", city, islands.id[row])
    return stand_of(Points(xy, ids), species, height)
