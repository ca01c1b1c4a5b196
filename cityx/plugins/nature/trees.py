"""Trees: mapped ones, rows, woods and parks, and streets that ought to have some."""

from __future__ import annotations

import json
from dataclasses import dataclass, replace
from typing import Annotated, Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.city import City, Instances, Prototype
from cityx.city.ground import KERB_HEIGHT, LABEL
from cityx.geometry.clearance import (
    distance_within,
    in_triangles,
    near_any,
    push_off,
    spots_of,
)
from cityx.geometry.identity import choose, hash_ids, uniform
from cityx.geometry.polylines import arc_lengths, every, locate, pack, to_linestrings
from cityx.geometry.scatter import Points, cell_ids, cells_of_polygons, poisson_in
from cityx.plugins.road.kerbs import edge_lengths, edge_lines, join_places, places_along
from cityx.protocol import Port, Range, action

ACTION = "nature/trees-v1"
FloatArray = NDArray[np.float64]
BoolArray = NDArray[np.bool_]

ROW_SPACING = 8.0  # metres between the trees of a mapped row
WOOD_SPACING = 5.0  # metres; a grown mixed wood
PACKING = 0.53  # points of `poisson_in` per squared radius, measured
NEAR_LIMIT = 20_000  # trees with many leaves; beyond, all take the light form
GROVE_SPACING = 11.0  # metres; wider, a single tree leaves the wood's floor bare from the air
NEAR_SHARE = 0.7  # of the budget, for woods beside buildings at most
KERB_CLEARANCE = 0.8  # metres from trunk to kerb
FACADE_CLEARANCE = 2.5  # metres from trunk to facade for trees nobody mapped
LEAST_FACADE = 0.6  # metres, the same for mapped ones: they are where they are
CROWN_REACH = 7.0  # metres, the widest crown
MOST_PUSH = 1.6  # metres a mapped tree may be moved out of a carriageway
# Surfaces of the ground on which no trunk stands, whatever the map says.
TREELESS = ("carriageway", "setts", "junction", "marking", "marking_yellow",
            "cycle_lane", "tramway", "water")  # fmt: skip
SNOWED = 0.3  # snow cover from which deciduous trees are bare
STREET_SPACING = 10.0  # metres; every third place is left to a lamp
STREET_SHARE = 1 / 3
STREET_KINDS = ("residential", "tertiary", "secondary", "primary", "unclassified", "living_street")

SPECIES = ("lime", "plane", "maple", "oak", "poplar", "birch", "cherry", "pine", "spruce",
           "cypress", "palm", "shrub", "grove")  # fmt: skip
_INDEX = {name: index for index, name in enumerate(SPECIES)}
STREET_MIX = {"lime": 5.0, "plane": 3.0, "maple": 3.0, "cherry": 1.0, "oak": 0.6}
PARK_MIX = {"lime": 2.0, "oak": 2.0, "maple": 2.0, "birch": 1.5, "plane": 1.0, "cherry": 0.8,
            "pine": 0.7, "spruce": 0.4, "poplar": 0.4}  # fmt: skip
BROAD_MIX = {"oak": 3.0, "maple": 2.0, "lime": 2.0, "birch": 1.5}
NEEDLE_MIX = {"spruce": 3.0, "pine": 1.6}
TROPIC_MIX = {"palm": 2.0, "plane": 2.0, "maple": 2.0, "lime": 1.0}
TROPIC = 24.0  # degrees of latitude within which palms grow and spruces do not
GENUS = {
    "tilia": "lime", "lime": "lime", "linden": "lime", "platanus": "plane", "plane": "plane",
    "acer": "maple", "maple": "maple", "ahorn": "maple", "quercus": "oak", "oak": "oak",
    "fagus": "oak", "beech": "oak", "aesculus": "oak", "castanea": "oak", "ulmus": "lime",
    "fraxinus": "maple", "ash": "maple", "robinia": "maple", "populus": "poplar",
    "poplar": "poplar", "betula": "birch", "birch": "birch", "salix": "birch",
    "prunus": "cherry", "malus": "cherry",
    "pyrus": "cherry", "sorbus": "cherry", "crataegus": "cherry", "cherry": "cherry",
    "magnolia": "cherry", "pinus": "pine", "pine": "pine", "larix": "spruce", "picea": "spruce",
    "abies": "spruce", "spruce": "spruce", "fir": "spruce", "cupressus": "cypress",
    "thuja": "cypress", "taxus": "cypress", "juniperus": "cypress", "chamaecyparis": "cypress",
    "ginkgo": "lime", "zelkova": "lime", "celtis": "lime", "carpinus": "lime", "alnus": "birch",
    "phoenix": "palm", "washingtonia": "palm", "trachycarpus": "palm", "palm": "palm",
    "arecaceae": "palm", "cocos": "palm", "roystonea": "palm",
}  # fmt: skip
NAMING = ("genus", "species", "taxon", "genus:en", "species:en", "species:de")
# (spacing in metres, share of points kept, kind of mix) by kind of area.
AREAS = {
    "wood": (WOOD_SPACING, 1.0), "park": (9.0, 0.55), "garden": (8.0, 0.40),
    "cemetery": (8.0, 0.45), "golf": (13.0, 0.35), "scrub": (3.2, 0.55), "orchard": (4.5, 0.95),
    "grass": (16.0, 0.18), "residential": (11.0, 0.30),
}  # fmt: skip
OPEN_AREAS = ("water", "sea", "river", "pool", "pitch", "parking", "road_area", "railway",
              "playground", "pier", "construction", "farmland", "sand")  # fmt: skip


@dataclass(frozen=True)
class _Stand:
    """Trees that share an origin; (n,) each. Heights of NaN are drawn later."""

    xy: FloatArray
    id: NDArray[np.uint64]
    species: NDArray[np.int64]
    height: FloatArray
    mapped: BoolArray
    light: BoolArray


def _stand(points: Points, species: Any, height: Any = np.nan, *, mapped: bool = False,
           light: bool = False) -> _Stand:  # fmt: skip
    count = len(points.id)
    return _Stand(points.xy.reshape(-1, 2), points.id, np.broadcast_to(species, (count,)),
                  np.broadcast_to(np.asarray(height, float), (count,)), np.full(count, mapped),
                  np.full(count, light))  # fmt: skip


def _join(stands: list[_Stand]) -> _Stand:
    names = ("xy", "id", "species", "height", "mapped", "light")
    return _Stand(*(np.concatenate([getattr(s, name) for s in stands]) for name in names))


def _rows(stand: _Stand, keep: Any) -> _Stand:
    names = ("xy", "id", "species", "height", "mapped", "light")
    return _Stand(*(getattr(stand, name)[keep] for name in names))


def _draw(mix: dict[str, float], city: City, ids: NDArray[np.uint64]) -> NDArray[np.int64]:
    """Draw species by weight; tropical places have their own."""
    if abs(city.frame.latitude) < TROPIC:
        mix = TROPIC_MIX
    table = np.array([_INDEX[name] for name in mix])
    return table[choose(city.seed, "nature/species", ids, list(mix.values()))]


def species_of_tags(tags: str) -> str:
    """Return the habit that the tags of a tree name, or "" when they name none."""
    if len(tags) < 3:
        return ""
    try:
        known = json.loads(tags)
    except ValueError:
        return ""
    text = " ".join(str(known.get(key, "")) for key in NAMING).lower()
    for word in text.replace(",", " ").split():
        if word in GENUS:
            return GENUS[word]
    if known.get("leaf_type") == "needleleaved":
        return "spruce"
    return "palm" if known.get("leaf_type") == "palm" else ""


def _mapped(city: City) -> list[_Stand]:
    """Trees and shrubs mapped as points, and rows of trees."""
    stands = []
    table = city.layout.points
    kind = table["kind"].to_numpy().astype(str)
    rows = np.flatnonzero((kind == "tree") | (kind == "shrub"))
    if len(rows):
        ids = table["id"].to_numpy()[rows]
        species = _draw(STREET_MIX, city, ids)
        named = [species_of_tags(text) for text in table["tags"].to_numpy()[rows]]
        species = np.array([_INDEX[n] if n else s for n, s in zip(named, species, strict=True)])
        species[kind[rows] == "shrub"] = _INDEX["shrub"]
        xy = shapely.get_coordinates(table.geometry.to_numpy()[rows])
        stands.append(
            _stand(Points(xy, ids), species, table["height"].to_numpy()[rows], mapped=True)
        )
    lines = city.layout.lines
    rows = np.flatnonzero(lines["kind"].to_numpy().astype(str) == "tree_row")
    if len(rows):
        packed = pack(lines.geometry.to_numpy()[rows])
        line, along = every(arc_lengths(packed)[1], ROW_SPACING)
        ids = lines["id"].to_numpy()[rows]
        named = [species_of_tags(text) for text in lines["tags"].to_numpy()[rows]]
        species = _draw(STREET_MIX, city, ids)
        species = np.array([_INDEX[n] if n else s for n, s in zip(named, species, strict=True)])
        number = np.arange(len(line)) - np.searchsorted(line, line)
        points = Points(locate(packed, line, along)[0], hash_ids(0, ACTION, ids[line], number))
        height = lines["height"].to_numpy()[rows][line]
        stands.append(_stand(points, species[line], height, mapped=True))
    return stands


def _wooded(city: City, budget: int, have: FloatArray) -> list[_Stand]:
    """Trees of woods, parks and orchards, none where the map shows single trees already."""
    areas = city.layout.areas
    kinds = areas["kind"].to_numpy().astype(str)
    site = shapely.box(*city.layout.extent)
    stands = []
    for kind, (spacing, share) in AREAS.items():
        rows = np.flatnonzero(kinds == kind)
        shapes = areas.geometry.to_numpy()[rows]
        shapes = shapes[shapely.intersects(shapes, site)]
        if kind != "wood" and len(have) and len(shapes):
            shapes = shapes[~_covered(shapes, have)]
        if not len(shapes):
            continue
        purpose = f"{ACTION}/{kind}"
        if kind == "wood":
            stands.extend(_woods(city, shapes, budget, purpose))
            continue
        area = float(shapely.area(shapes).sum())
        radius = max(spacing, float(np.sqrt(PACKING * share * area / (0.3 * budget))))
        points = poisson_in(
            shapes, radius, seed=city.seed, purpose=purpose, bounds=city.layout.extent
        )
        keep = _clumped(points, share, city.seed, purpose)
        points = Points(points.xy[keep], points.id[keep])
        if kind == "scrub":
            species = np.full(len(points.id), _INDEX["shrub"])
        elif kind == "orchard":
            species = np.full(len(points.id), _INDEX["cherry"])
        else:
            species = _draw(PARK_MIX, city, points.id)
            bush = uniform(city.seed, purpose, points.id, 7) < 0.22
            species = np.where(bush, _INDEX["shrub"], species)
        height = np.nan if kind != "orchard" else 4.2
        stands.append(_stand(points, species, height, light=kind == "scrub"))
    return stands


def _covered(shapes: NDArray[Any], have: FloatArray) -> BoolArray:
    """Mark areas in which single trees are mapped, at least one per 600 square metres."""
    tree = shapely.STRtree(shapely.points(have))
    found = tree.query(shapes, predicate="contains")[0]
    count = np.bincount(found, minlength=len(shapes))
    return np.asarray(count * 600.0 > shapely.area(shapes))


def _clumped(points: Points, share: float, seed: int, purpose: str) -> BoolArray:
    """Keep a share of points in groups: one draw per point, tilted by a draw per 40 m cell."""
    cells = np.floor(points.xy / 40.0).astype(np.int64)
    group = uniform(seed, purpose, cell_ids(cells), 5)
    chance = np.clip(share * (0.25 + 1.5 * group), 0, 1)
    return np.asarray(uniform(seed, purpose, points.id, 6) < chance)


def _woods(city: City, shapes: NDArray[Any], budget: int, purpose: str) -> list[_Stand]:
    """Fill woods: full density within the budget, else dense near buildings, groves farther off."""
    extent = city.layout.extent
    area = float(shapely.area(shapes).sum())
    if PACKING * area / WOOD_SPACING**2 <= budget:
        points = poisson_in(shapes, WOOD_SPACING, seed=city.seed, purpose=purpose, bounds=extent)
        return [_stand(points, _wood_species(city, points), light=True)]
    near = _NearBuildings(city)
    share = near.share_of(shapes)
    stands = []
    left = float(budget)
    # What is seen from close by may take most of the budget; the rest is for the far woods.
    for part, most, name, where in (
        (share * area, NEAR_SHARE, purpose, near),
        ((1 - share) * area, 1.0, f"{purpose}/far", lambda xy: ~near(xy)),
    ):
        if not part:
            continue
        radius = max(WOOD_SPACING, float(np.sqrt(PACKING * part / (most * left))))
        left -= PACKING * part / radius**2
        points = poisson_in(
            shapes, radius, seed=city.seed, purpose=name, bounds=extent, where=where
        )
        if radius > GROVE_SPACING:
            stands.append(_stand(points, _INDEX["grove"], radius, light=True))
        else:
            stands.append(_stand(points, _wood_species(city, points), light=True))
    return stands


class _NearBuildings:
    """Tells whether positions lie in a block beside a building, where woods are seen close by."""

    EDGE = 100.0  # metres of a block
    WIDTH = np.int64(1 << 24)  # blocks in a row of keys, more than the Earth has

    def __init__(self, city: City) -> None:
        boxes = shapely.bounds(city.layout.buildings.geometry.to_numpy()).reshape(-1, 4)
        blocks = np.floor(boxes[:, :2] / self.EDGE).astype(np.int64)
        around = np.array([(i, j) for i in (-1, 0, 1) for j in (-1, 0, 1)])
        blocks = (blocks[:, None, :] + around).reshape(-1, 2)
        self.keys = np.unique(blocks[:, 0] * self.WIDTH + blocks[:, 1])

    def __call__(self, xy: FloatArray) -> BoolArray:
        """(n,) answers for (n, 2) positions."""
        blocks = np.floor(xy / self.EDGE).astype(np.int64)
        keys = blocks[:, 0] * self.WIDTH + blocks[:, 1]
        at = np.searchsorted(self.keys, keys)
        found = np.zeros(len(xy), bool)
        inner = at < len(self.keys)
        found[inner] = self.keys[at[inner]] == keys[inner]
        return found

    def share_of(self, shapes: NDArray[Any]) -> float:
        """Return the share of the polygons' area that is near, by a grid of samples."""
        blocks = cells_of_polygons(shapes, self.EDGE)
        step = (np.arange(3) + 0.5) / 3
        offset = np.stack(np.meshgrid(step, step, indexing="ij"), axis=-1).reshape(-1, 2)
        xy = ((blocks[:, None, :] + offset) * self.EDGE).reshape(-1, 2)
        inside = np.zeros(len(xy), bool)
        tree = shapely.STRtree(shapely.points(xy))
        inside[tree.query(shapes, predicate="contains")[1]] = True
        return float(self(xy[inside]).mean()) if inside.any() else 1.0


def _wood_species(city: City, points: Points) -> NDArray[np.int64]:
    """Broadleaved and conifer patches of 120 m, a few strangers in each."""
    patch = uniform(
        city.seed, "nature/patch", cell_ids(np.floor(points.xy / 120.0).astype(np.int64))
    )
    latitude = abs(city.frame.latitude)
    share = 0.12 if latitude < 40 else 0.30 if latitude < 56 else 0.65
    stranger = uniform(city.seed, "nature/stranger", points.id) < 0.15
    needle = (patch < share) ^ stranger
    return np.where(needle & (latitude >= TROPIC), _draw(NEEDLE_MIX, city, points.id),
                    _draw(BROAD_MIX, city, points.id))  # fmt: skip


def _street_trees(city: City, mapped: int) -> list[_Stand]:
    """Plant a third of the streets of an urban place whose map shows next to no trees."""
    network = city.network
    if network is None or not network.edge_count:
        return []
    roads = city.layout.roads
    kind = roads["kind"].to_numpy().astype(str)[network.edge_road]
    streets = np.isin(kind, STREET_KINDS)
    length = edge_lengths(network)
    if mapped > length[kind == "residential"].sum() / 100.0:
        return []
    flat = (roads["layer"].to_numpy() == 0) & ~roads["bridge"].to_numpy()
    road_id = roads["id"].to_numpy()[network.edge_road]
    name = roads["name"].to_numpy().astype(str)[network.edge_road]
    key = np.array([hash_name(n) if n else int(i) for n, i in zip(name, road_id, strict=True)],
                   np.uint64)  # fmt: skip
    green = uniform(city.seed, f"{ACTION}/street", key) < STREET_SHARE
    groups = []
    for side, column in ((1, "sidewalk_left"), (-1, "sidewalk_right")):
        width = roads[column].to_numpy()[network.edge_road]
        edges = np.flatnonzero(streets & green & flat[network.edge_road] & (width >= 1.8))
        groups.append(
            places_along(network, edges, side, spacing=STREET_SPACING, beyond=KERB_CLEARANCE + 0.1,
                         margin=7.0)
        )  # fmt: skip
    places = join_places(*groups)
    places = places.take(places.number % 3 != np.where(places.side > 0, 0, 1))
    # A street has trees only where it has houses on its side.
    houses = city.layout.buildings.geometry.to_numpy()
    places = places.take(np.isfinite(distance_within(places.xy, houses, 25.0)))
    ids = hash_ids(0, f"{ACTION}/street", network.edge_id[places.edge],
                   2 * places.number + (places.side > 0))  # fmt: skip
    return [_stand(Points(places.xy, ids), _draw(STREET_MIX, city, key[places.edge]))]


def hash_name(name: str) -> int:
    """Return the id of a street name, so that all its edges draw alike."""
    from cityx.geometry.identity import stable_id

    return stable_id("street", name)


def _strips(city: City) -> tuple[NDArray[Any], FloatArray]:
    """Centrelines of everything one moves on, with half widths."""
    roads = city.layout.roads
    kind = roads["kind"].to_numpy().astype(str)
    shapes = roads.geometry.to_numpy()
    half = roads["width"].to_numpy() / 2
    rail = np.isin(kind, ("rail", "light_rail", "tram"))
    half = np.where(rail, np.fmax(half, 2.6), np.where(np.isfinite(half), half, 1.0))
    here = ~roads["tunnel"].to_numpy() & (kind != "subway")
    if city.network is None or not city.network.edge_count:
        return shapes[here], half[here]
    # The network knows narrowed widths; the layout still has paths and rails.
    used = np.zeros(len(roads), bool)
    used[city.network.edge_road] = True
    rest = here & ~used
    lines = to_linestrings(edge_lines(city.network))
    return (np.concatenate([shapes[rest], lines]),
            np.concatenate([half[rest], city.network.half_width]))  # fmt: skip


def _cleared(city: City, stand: _Stand) -> tuple[_Stand, FloatArray]:
    """Drop or move what stands in the way; return the rest and its distance to facades."""
    areas = city.layout.areas
    open_ = areas.geometry.to_numpy()[np.isin(areas["kind"].to_numpy().astype(str), OPEN_AREAS)]
    water = areas.geometry.to_numpy()[
        np.isin(areas["kind"].to_numpy().astype(str), ("water", "sea", "river", "pool"))
    ]
    houses = city.layout.buildings.geometry.to_numpy()
    spots = spots_of(stand.xy)
    facade = distance_within(spots, houses, CROWN_REACH)
    keep = facade > np.where(stand.mapped, LEAST_FACADE, FACADE_CLEARANCE)
    keep &= ~near_any(spots, water, 0.5)
    keep &= stand.mapped | ~near_any(spots, open_, 0.5)
    lines, half = _strips(city)
    xy, free = push_off(spots, lines, half + KERB_CLEARANCE, most=MOST_PUSH)
    keep &= free & (stand.mapped | (np.hypot(*(xy - stand.xy).T) < 1e-9))
    changed = (xy != stand.xy).any()
    after = spots_of(xy) if changed else spots
    if city.network is not None:
        network = city.network
        arms = network.edge_nodes.ravel()
        radius = np.zeros(len(network.node_position))
        np.maximum.at(radius, arms, np.repeat(network.half_width, 2))
        joint = network.node_degree >= 3
        nodes = shapely.points(network.node_position[joint])
        keep &= ~near_any(after, nodes, radius[joint] + 1.8)
    if changed:
        keep &= ~near_any(after, houses, LEAST_FACADE)
    if city.ground is not None:
        ground = city.ground
        bare = np.isin(ground.face_label, [LABEL[name] for name in TREELESS])
        keep &= ~in_triangles(xy, ground.vertices, ground.triangles[bare[ground.triangle_face]])
    return _rows(replace(stand, xy=xy), keep), facade[keep]


def _prototypes(
    stand: _Stand, bare: bool, light: bool, fine: bool
) -> tuple[list[Prototype], NDArray[np.int32]]:
    """Make the prototypes in use and number them for every tree."""
    from cityx.assets import trees

    variant = (stand.id % np.uint64(trees.VARIANTS)).astype(np.int64)
    thin = stand.light | light
    code = (stand.species * trees.VARIANTS + variant) * 2 + thin
    used, number = np.unique(code, return_inverse=True)
    found = []
    for value in used.tolist():
        species, which = divmod(value // 2, trees.VARIANTS)
        form = ("bare" if bare else "") + ("_" if bare and value % 2 else "")
        form += "light" if value % 2 else "" if bare else "fine" if fine else "near"
        found.append(trees.plant(SPECIES[species], which, form))
    return found, number.astype(np.int32)


@action(
    ACTION,
    limits=[
        "Trees under bridges and in tunnels are left out.",
        "Woods beyond the budget get fewer, wider groups of trees.",
    ],
    requires=("layout",),
    takes=(Port("layout", "scene_layout"),),
    gives=(Port("trees", "point", role="tree"),),
    labels=("vegetation", "forest", "park", "plants"),
)
def trees(
    city: City,
    *,
    budget: Annotated[int, Range(0, 2_000_000)] = 80_000,
    street_trees: bool = True,
) -> City:
    """Plant mapped trees, tree rows, woods, parks, orchards and bare streets.

    Parameters
    ----------
    city
        City with a layout; the terrain and the road network are used when there.
    budget
        Trees of woods at most; beyond, they stand wider and in groups.
    street_trees
        Whether streets of an urban place without mapped trees get some.
    """
    from cityx.assets import trees as library

    done = city.stages_done | {"nature"}
    if city.lod < 1:
        return replace(city, stages_done=done)
    stands = _mapped(city)
    mapped = sum(len(s.id) for s in stands)
    have = np.concatenate([s.xy for s in stands]) if stands else np.zeros((0, 2))
    if budget:
        stands += _wooded(city, budget, have)
    if street_trees:
        stands += _street_trees(city, mapped)
    stands = [s for s in stands if len(s.id)]
    if not stands:
        return replace(city, stages_done=done)
    stand = _join(stands)
    xmin, ymin, xmax, ymax = city.layout.extent
    x, y = stand.xy.T
    stand = _rows(stand, (x >= xmin) & (x <= xmax) & (y >= ymin) & (y <= ymax))
    stand, facade = _cleared(city, stand)
    order = np.argsort(stand.id, kind="stable")
    _, first = np.unique(stand.id[order], return_index=True)
    order = order[first]
    stand, facade = _rows(stand, order), facade[order]
    light = city.lod < 2 or int(np.count_nonzero(~stand.light)) > NEAR_LIMIT
    prototypes, number = _prototypes(stand, city.environment.snow > SNOWED, light, city.lod > 2)

    size = np.array([library.size_of(name) for name in SPECIES])[stand.species]  # (n, 2)
    draw = uniform(city.seed, f"{ACTION}/size", stand.id)
    known = np.isfinite(stand.height) & (stand.height > 0)
    up = np.where(known, np.clip(np.where(known, stand.height, 1.0) / size[:, 0], 0.35, 1.9),
                  0.72 + 0.5 * draw)  # fmt: skip
    grove = stand.species == _INDEX["grove"]
    up[grove] = 0.8 + 0.4 * draw[grove]
    wide = np.where(known, up**0.7, up) * (0.9 + 0.2 * uniform(city.seed, f"{ACTION}/w", stand.id))
    wide[grove] = np.clip(stand.height[grove] / library.GROVE_EDGE, 0.6, 1.8)
    # The crown ends at the facade: 0.3 m of leaves may touch it.
    wide = np.minimum(wide, np.maximum((facade + 0.3) / size[:, 1], 0.3))
    up = np.minimum(up, 2.2 * wide)
    shade = uniform(city.seed, f"{ACTION}/tint", stand.id)[:, None]
    warm = uniform(city.seed, f"{ACTION}/tint", stand.id, 1)[:, None]
    tint = (0.80 + 0.40 * shade) * (1 + (warm - 0.5) * np.array([0.30, 0.08, -0.10]))
    turn = np.zeros((len(stand.id), 3), np.float32)
    turn[:, 2] = uniform(city.seed, f"{ACTION}/yaw", stand.id) * 2 * np.pi
    z = city.terrain.height_at(stand.xy) + KERB_HEIGHT
    rows = Instances(
        number,
        stand.id,
        np.zeros(len(stand.id), np.uint64),
        np.column_stack([stand.xy, z]),
        turn,
        np.column_stack([wide, wide, up]).astype(np.float32),
        tint.astype(np.float32),
    )
    return replace(
        city, scene=city.scene.with_instances("trees", prototypes, rows), stages_done=done
    )
