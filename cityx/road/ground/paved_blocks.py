"""Paved land: narrow and dense blocks between carriageways, walks, the ground before houses.

References
----------
Senate of Berlin, "Ausführungsvorschriften zu § 7 des Berliner Straßengesetzes über Geh- und
Radwege", 2013: slabs between an upper and a lower band of small stones.
Department for Transport, "Manual for Streets 2", 2010: flags to the building line in old centres.
Ministry of Land, Infrastructure, Transport and Tourism, guideline on guiding blocks, 1985.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.assets.styles.materials import state_of
from cityx.city.ground import LABEL, PAINT, ROADWAY, SURFACES, Ground
from cityx.city.layout import Layout, in_town
from cityx.city.roads import RoadNetwork
from cityx.geometry.arrays import BoolArray, FloatArray, IntArray
from cityx.geometry.chains import components
from cityx.geometry.scatter import cell_ids
from cityx.ground.arrangement import (
    BEYOND,
    Regions,
    edge_lengths,
    face_areas,
    inner_edges,
    inner_points,
    regions,
)
from cityx.ground.drape import Paving
from cityx.ids import choose, hash_ids, mix
from cityx.places.profile import Land
from cityx.road.ground.joints import courses

ROAD = (*ROADWAY, "tramway")
ON_ROAD = tuple(LABEL[name] for name in (*PAINT, "tramway"))
HARD = (*ROAD, "kerb", "sidewalk", "path", "plaza", "parking", "building", "courtyard", "trail",
        "furnishing", "gravel", "edging", "frontage")  # fmt: skip
NARROW = 1.5  # metres; narrower islands between carriageways are not built
BUILT_ISLAND = ("courtyard", "tactile", "tactile_pale")  # refuges and splitters are, however narrow
DENSE = 0.35  # share of a block that is built over; gardens fill the rest of a looser one
DENSE_URBAN = 0.12  # the same where most of what is built stands in urban surroundings
TOWN_CELL = 50.0  # metres; about half a block
STRIP = 5.0  # metres; narrower leftovers between pavements are paved in town
ENCLOSED = 0.6  # share of such a strip's rim that pavement or walls take
WALK_STRIP = 4.0  # metres; narrower leftovers beside a walk belong to it
SCRAP = 40.0  # square metres of a leftover beside a walk that belongs to it, however broad
BESIDE = 0.25  # share of its rim along walks from which a leftover belongs to them
BESIDE_SMALL, SMALL = 0.12, 500.0  # the same of leftovers of so many square metres at most
TOWN_REACH = 25.0  # metres within which an urban building makes a place a part of the town
# What lies about the lawns of courts enclosed by houses, and how often.
YARDS = (("courtyard", 6), ("grass", 3))
OPEN_YARD = 0.15  # share of its rim along streets from which a court belongs to the street
LEAST_YARD = 25.0  # square metres
AMID_WALKS = 12.0  # square metres of a scrap of frontage amid walks that is a part of them
WALKED = 0.97  # share of its rim that runs along them
LARGEST = 60_000.0  # square metres; more is open country with a town in it, not a block
# Hot rolled asphalt of the British Isles has pale chippings rolled into it, laid bare by tyres.
CHIPPED = state_of("asphalt", age=0.75, wear=0.0)
CHIPPED_WORD = "chipped_asphalt"  # how profiles of places call it
BENT = {"slab_walk": "mosaic"}
# What lies before houses where each was paved by itself, with weights.
FORECOURTS = {"yard": 2.0, "asphalt_light": 3.0, "mosaic": 0.8, "clinker": 1.2, "pavers": 1.0}
# The same of large ones, which are laid out to be seen.
LARGE, LARGE_FORECOURTS = 30.0, (0.3, 0.6, 2.0, 3.0, 3.0)
PURPOSE = "ground/forecourt"
MAIN = ("primary", "secondary", "tertiary", "trunk")
LEAST_GUIDED, WIDE = 2.0, 2.8  # metres of walk with such a line, of main streets and of any


def pave_blocks(ground: Ground, layout: Layout) -> Ground:
    """Return the ground with narrow islands filled and the open land of dense blocks paved."""
    road = ground.labelled(*ROAD)
    block = _blocks(ground, road)
    ground, dense = _paved(_filled(ground, road, block), layout, block)
    ground = _off_lawns(ground, dense)
    return _scraps_walked(_yards(_walks_widened(_strips_paved(ground, layout))))


def town_regions(layout: Layout) -> Regions:
    """Return dense ground as cells of a grid, for an arrangement that holds no houses."""
    low = _dense_cells(layout) * TOWN_CELL
    if not len(low):
        return Regions()
    squares = shapely.box(low[:, 0], low[:, 1], low[:, 0] + TOWN_CELL, low[:, 1] + TOWN_CELL)
    label = LABEL["courtyard"]
    return regions(shapely.unary_union(squares), label, SURFACES[label].priority)


def _dense_cells(layout: Layout) -> IntArray:
    """(n, 2) cells of the plane that lie in town by what stands in them and about them."""
    buildings = layout.buildings
    urban = in_town(buildings)
    shapes = buildings.geometry.to_numpy()[urban]
    if not len(shapes):
        return np.zeros((0, 2), np.int64)
    box = shapely.bounds(shapes)
    cell = np.floor((box[:, :2] + box[:, 2:]) / (2 * TOWN_CELL)).astype(np.int64)
    # A cell is dense by what stands in it and in its eight neighbours.
    spread = np.array([(i, j) for i in (-1, 0, 1) for j in (-1, 0, 1)])
    around = (cell[:, None] + spread).reshape(-1, 2)
    cells, index = np.unique(around, axis=0, return_inverse=True)
    built = np.bincount(index.ravel(), np.repeat(shapely.area(shapes), 9), minlength=len(cells))
    return np.asarray(cells[built > DENSE_URBAN * 9 * TOWN_CELL**2], np.int64)


def _blocks(ground: Ground, road: NDArray[np.bool_]) -> IntArray:
    """(f,) the block of each face that is not road."""
    left, right = ground.edge_faces.T.astype(np.int64)
    inside = (right != BEYOND) & ~road[left] & ~road[np.maximum(right, 0)]
    return components(np.column_stack([left, right])[inside], len(ground.face_label))


def _filled(ground: Ground, road: NDArray[np.bool_], block: IntArray) -> Ground:
    """Give islands that nobody could stand on the surface around them."""
    size = len(ground.face_label)
    area = np.bincount(block, np.where(road, 0.0, face_areas(ground)), minlength=size)
    left, right = ground.edge_faces.T.astype(np.int64)
    length = edge_lengths(ground)
    beside = road[left] != road[np.maximum(right, 0)]
    beside &= right != BEYOND
    inner = np.where(road[left], right, left)[beside]
    outer = np.where(road[left], left, right)[beside]
    rim = np.bincount(block[inner], length[beside], minlength=size)
    border = np.zeros(size, bool)
    border[block[left[right == BEYOND]]] = True
    # Of a long strip, twice the area over its rim is the width.
    narrow = ~border & (2 * area < NARROW * rim)
    meant = np.zeros(size, bool)
    meant[block[ground.labelled(*BUILT_ISLAND)]] = True
    island = ~road & (narrow & ~meant)[block] & (ground.face_label != LABEL["building"])
    order = np.lexsort((outer, -np.round(length[beside], 6), block[inner]))
    first = np.unique(block[inner][order], return_index=True)
    around = np.zeros(size, np.int64)
    around[first[0]] = outer[order][first[1]]
    source = around[block[island]]
    label, object_id = ground.face_label.copy(), ground.face_object.copy()
    taken = ground.face_label[source]
    taken = np.where(np.isin(taken, ON_ROAD), LABEL["carriageway"], taken)
    label[island], object_id[island] = taken, ground.face_object[source]
    return replace(ground, face_label=label, face_object=object_id)


def _paved(ground: Ground, layout: Layout, block: IntArray) -> tuple[Ground, BoolArray]:
    """Pave what nothing is known of in blocks that are dense with buildings, and mark these."""
    size = len(ground.face_label)
    area = face_areas(ground)
    house = ground.face_label == LABEL["building"]
    ids = layout.buildings["id"].to_numpy()
    urban = in_town(layout.buildings)
    at = np.minimum(np.searchsorted(ids, ground.face_object), max(len(ids) - 1, 0))
    town = house & urban[at] & (ids[at] == ground.face_object) if len(ids) else house
    open_area = np.where(ground.labelled(*ROAD), 0.0, area)
    whole = np.maximum(np.bincount(block, open_area, minlength=size), 1e-6)
    built = np.bincount(block, np.where(house, area, 0.0), minlength=size)
    built_up = np.bincount(block, np.where(town, area, 0.0), minlength=size)
    cover = built / whole
    dense = (cover > DENSE) | ((cover > DENSE_URBAN) & (built_up > 0.5 * built))
    dense |= _at_border(ground, block) & _in_town(ground, layout, block, whole)
    dense &= whole < LARGEST
    paved = (ground.face_label == LABEL["block"]) & dense[block]
    label = np.where(paved, LABEL["courtyard"], ground.face_label).astype(np.uint8)
    return replace(ground, face_label=label), dense[block]


def _at_border(ground: Ground, block: IntArray) -> BoolArray:
    """(f,) blocks that the border of the site cuts, whose houses the map may have left out."""
    border = np.zeros(len(block), bool)
    border[block[ground.edge_faces[ground.edge_faces[:, 1] == BEYOND, 0]]] = True
    return border


def _in_town(ground: Ground, layout: Layout, block: IntArray, whole: FloatArray) -> BoolArray:
    """(f,) blocks most of whose land lies in cells of the plane that are dense."""
    face = ground.triangle_face
    corners = ground.vertices[ground.triangles]  # (t, 3, 2)
    cell = np.floor(corners.mean(axis=1) / TOWN_CELL).astype(np.int64)
    land = np.isin(cell_ids(cell), cell_ids(_dense_cells(layout))) & ~ground.labelled(*ROAD)[face]
    area = shapely.area(shapely.polygons(corners[land]))
    held = np.bincount(block[face[land]], area, minlength=len(block))
    return np.asarray(held > 0.5 * whole)


def _off_lawns(ground: Ground, dense: BoolArray) -> Ground:
    """Leave car parks, gravel and beds to paved yards: in the open land is as nobody left it."""
    left, right, length = inner_edges(ground)
    own = ground.labelled("parking", "bare", "gravel", "bed") & (ground.face_object == 0) & ~dense
    lawn = ground.labelled("block", "grass") & ~dense
    patch = components(np.column_stack([left, right])[own[left] & own[right]], len(own))
    rim, green = np.zeros(len(own)), np.zeros(len(own))
    for face, other in ((left, right), (right, left)):
        outer = own[face] & ~own[other]
        np.add.at(rim, patch[face[outer]], length[outer])
        np.add.at(green, patch[face[outer]], (length * lawn[other])[outer])
    gone = own & (green > 0.5 * rim)[patch]
    label = np.where(gone, LABEL["block"], ground.face_label)
    return replace(ground, face_label=label.astype(np.uint8))


def _walks_widened(ground: Ground) -> Ground:
    """Make frontage of narrow leftovers and scraps beside walks, whatever tiles cut them."""
    court = ground.labelled("courtyard", "bed")
    if not court.any():
        return ground
    left, right = ground.edge_faces.T.astype(np.int64)
    within = (right != BEYOND) & court[left] & court[np.maximum(right, 0)]
    piece = components(np.column_stack([left, right])[within], len(court))
    size = len(court)
    length = edge_lengths(ground)
    rim, beside = np.zeros(size), np.zeros(size)
    walk = ground.labelled("sidewalk", "plaza", "furnishing", "edging")
    for face, other in ((left, right), (right, left)):
        mine = (face != BEYOND) & ~within
        mine[mine] &= court[face[mine]]
        np.add.at(rim, piece[face[mine]], length[mine])
        walked = (other[mine] != BEYOND) & walk[np.maximum(other[mine], 0)]
        np.add.at(beside, piece[face[mine]], length[mine] * walked)
    area = np.bincount(piece, np.where(court, face_areas(ground), 0.0), minlength=size)
    slight = (2 * area < WALK_STRIP * rim) | (area < SCRAP)
    least = np.where(area < SMALL, BESIDE_SMALL, BESIDE)
    taken = (ground.face_label == LABEL["courtyard"]) & (slight & (beside > least * rim))[piece]
    label = np.where(taken, LABEL["frontage"], ground.face_label).astype(np.uint8)
    return replace(ground, face_label=label)


def _scraps_walked(ground: Ground) -> Ground:
    """Turn scraps of frontage, and the stones along it, into walk where walks enclose them."""
    scrap = ground.labelled("frontage", "edging")
    walk = ground.labelled(
        "sidewalk", "ramp", "landing", "guide_strip", "furnishing", "kerb", "path", "plaza"
    )
    left, right, length = inner_edges(ground)
    size = len(scrap)
    piece = components(np.column_stack([left, right])[scrap[left] & scrap[right]], size)
    rim, walked = np.zeros(size), np.zeros(size)
    for face, other in ((left, right), (right, left)):
        outer = scrap[face] & ~scrap[other]
        np.add.at(rim, piece[face[outer]], length[outer])
        np.add.at(walked, piece[face[outer]], (length * walk[other])[outer])
    area = np.bincount(piece, np.where(scrap, face_areas(ground), 0.0), minlength=size)
    taken = scrap & ((walked > WALKED * rim) & (rim > 0) & (area < AMID_WALKS))[piece]
    label = np.where(taken, LABEL["sidewalk"], ground.face_label).astype(np.uint8)
    return replace(ground, face_label=label)


def _yards(ground: Ground) -> Ground:
    """Give courts that houses enclose ground of their own: lawns, paving, asphalt, gravel."""
    court = ground.face_label == LABEL["courtyard"]
    if not court.any():
        return ground
    left, right = ground.edge_faces.T.astype(np.int64)
    inner = right != BEYOND
    within = inner & court[left] & court[np.maximum(right, 0)]
    yard = components(np.column_stack([left, right])[within], len(court))
    size = len(court)
    length = edge_lengths(ground)
    rim, street = np.zeros(size), np.zeros(size)
    outer = ground.labelled(*ROAD, "kerb", "sidewalk", "plaza", "furnishing", "edging", "frontage")
    for face, other in ((left, right), (right, left)):
        mine = (face != BEYOND) & ~within
        mine[mine] &= court[face[mine]]
        np.add.at(rim, yard[face[mine]], length[mine])
        open_side = (other[mine] == BEYOND) | outer[np.maximum(other[mine], 0)]
        np.add.at(street, yard[face[mine]], length[mine] * open_side)
    area = np.bincount(yard, np.where(court, face_areas(ground), 0.0), minlength=size)
    enclosed = court & (street[yard] < OPEN_YARD * rim[yard]) & (area[yard] > LEAST_YARD)
    corner = np.full((size, 2), np.inf)
    faces = ground.triangle_face
    np.minimum.at(corner, yard[faces], ground.vertices[ground.triangles[:, 0]])
    place = np.round(np.where(np.isfinite(corner), corner, 0.0) * 100).astype(np.int64)
    key = mix(mix(place[:, 0].view(np.uint64)) ^ np.ascontiguousarray(place[:, 1]).view(np.uint64))
    kind = choose(0, "ground/yard", key, [weight for _, weight in YARDS])
    labels = np.array([LABEL[name] for name, _ in YARDS], np.uint8)
    return replace(ground, face_label=np.where(enclosed, labels[kind[yard]], ground.face_label))


def _strips_paved(ground: Ground, layout: Layout) -> Ground:
    """Pave the leftovers between kerbs, footways and facades in town."""
    place = layout.buildings["place"].to_numpy().astype(str)
    town = layout.buildings.geometry.to_numpy()[np.isin(place, ("urban", "core"))]
    if not len(town):
        return ground
    hard = ground.labelled(*HARD)
    left, right, length = inner_edges(ground)
    size = len(hard)
    rim = np.bincount(left, length, minlength=size) + np.bincount(right, length, minlength=size)
    held = np.bincount(left, length * hard[right], minlength=size)
    held += np.bincount(right, length * hard[left], minlength=size)
    strip = (ground.face_label == LABEL["block"]) & (2 * face_areas(ground) < STRIP * rim)
    rows = np.flatnonzero(strip & (held > ENCLOSED * rim))
    # Any corner of a strip is near enough to say where it lies.
    corner = np.zeros(size, np.int64)
    corner[ground.triangle_face] = ground.triangles[:, 0]
    spots = shapely.points(ground.vertices[corner[rows]])
    near = shapely.STRtree(town).query(spots, predicate="dwithin", distance=TOWN_REACH)[0]
    label = ground.face_label.copy()
    label[rows[np.unique(near)]] = LABEL["courtyard"]
    return replace(ground, face_label=label)


def paved(ground: Ground, network: RoadNetwork, layout: Layout, land: Land) -> Paving:
    """Return how the faces of a ground are paved.

    Parameters
    ----------
    ground, network, layout
        The ground, the streets on it, and the layout that they come from.
    land
        Of the profile of the place.
    """
    laid = {
        surface: CHIPPED if material == CHIPPED_WORD else material
        for surface, material in land.paving.items()
    }
    if not land.guided:
        return courses(ground, network, laid, bent=BENT if "slab_walk" in laid.values() else {})
    found = courses(ground, network, laid, guided="guided_blocks", main=_guided(layout, network))
    rows = np.flatnonzero(ground.labelled("frontage"))
    cell = np.round(inner_points(ground)[rows] * 10).astype(np.int64).view(np.uint64)
    ids = hash_ids(0, PURPOSE, cell[:, 0], cell[:, 1])
    kind = np.where(
        face_areas(ground)[rows] > LARGE,
        choose(0, PURPOSE, ids, list(LARGE_FORECOURTS)),
        choose(0, PURPOSE, ids, list(FORECOURTS.values())),
    )
    material = found.material.copy()
    material[rows] = len(found.materials) + kind
    return replace(found, material=material, materials=(*found.materials, *FORECOURTS))


def _guided(layout: Layout, network: RoadNetwork) -> NDArray[np.bool_]:
    """(e,) whether the walks of edges have a line of ribs."""
    table = layout.roads.iloc[network.edge_road]
    wide = table[["sidewalk_left", "sidewalk_right"]].to_numpy(float).max(axis=1, initial=0.0)
    return np.asarray(
        (table["kind"].isin(MAIN).to_numpy() & (wide >= LEAST_GUIDED)) | (wide >= WIDE)
    )
