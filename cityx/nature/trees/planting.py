"""Trees: mapped ones, rows, woods and parks, and streets that ought to have some."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated, Any, Literal

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.city import City, Failure
from cityx.city.asked_goals import asked
from cityx.city.layout import of_kinds
from cityx.errors import ActionFailed, UsageError
from cityx.geometry.arrays import BoolArray, FloatArray, IntArray
from cityx.geometry.clearance import distance_within, nearest_free
from cityx.geometry.noise import gradient_noise
from cityx.geometry.polylines import arc_lengths, every, locate, pack
from cityx.geometry.scatter import (
    Points,
    cell_ids,
    cells_of_polygons,
    near_pairs,
    poisson_in,
    thinned,
)
from cityx.ground.pieces import of_maps
from cityx.ids import choose, hash_ids, uniform
from cityx.nature.furniture.furnishing import CROWDED, MOST_AWAY, lamp_places
from cityx.nature.trees.climate import species_of_tags
from cityx.nature.trees.stands import (
    BUSHES,
    INDEX,
    SPECIES,
    Stand,
    draw_species,
    join_stands,
    rows_of,
    stand_of,
    take_trees,
)
from cityx.nature.trees.town_trees import along_streets, in_yards, roundabout_stands
from cityx.nature.trees.tree_pits import island_stands, with_pits
from cityx.nature.trees.tree_room import Room, room_of
from cityx.places.profiles import climate_of, profile_of
from cityx.protocol import Choice, Port, Range, action
from cityx.road.ground.beds import CORNER, LENGTH, Beds, bed_slots
from cityx.road.heights.tiers import level_network

# Plants in the beds behind walks.

PURPOSE = "nature/bed_plants"
# What grows in a bed, with weights, and metres between its plants.
BEDS = (("tree", 7, 0.8), ("shrub", 2, 1.4), ("boxwood", 1, 0.8))
CORNER_TREES = 0.65  # of the beds at corners have a tree
FREE_END = 0.55  # metres of a bed beyond its last plant
TREE_GAP = 1.0  # metres round a trunk without bushes
TREES = (4.5, 7.5)  # metres
LOW = {"boxwood": (0.6, 0.9), "shrub": (0.7, 1.2)}  # metres; over these one sees


def bed_stands(city: City) -> list[Stand]:
    """Plant the beds that lie on the ground: hedges, bushes and single trees."""
    if city.ground is None or city.network is None or not city.network.edge_count:
        return []
    beds = bed_slots(city.layout, level_network(city.network, city.heights))
    beds = beds.take(city.ground.on(beds.middle, "bed"))
    kind = choose(city.seed, PURPOSE, beds.id, [weight for _, weight, _ in BEDS])
    corner = beds.half[:, 0] <= CORNER
    stands = _at_corners(city, beds.take(corner))
    beds, kind = beds.take(~corner), kind[~corner]
    for number, (name, _, spacing) in enumerate(BEDS):
        rows = np.flatnonzero(kind == number)
        if not len(rows):
            continue
        bush = "boxwood" if name == "tree" else name
        count = int((LENGTH - 2 * FREE_END) / spacing) + 1
        aside = (np.arange(count) - (count - 1) / 2) * spacing
        if name == "tree":
            aside = aside[np.abs(aside) > TREE_GAP]
            trees = Points(beds.middle[rows], hash_ids(0, PURPOSE, beds.id[rows]))
            stands.append(_small_trees(city, trees))
        row, place = np.repeat(rows, len(aside)), np.tile(np.arange(len(aside)), len(rows))
        ids = hash_ids(0, PURPOSE, beds.id[row], place + 1)
        xy = beds.middle[row] + beds.along[row] * aside[place][:, None]
        on = city.ground.on(xy, "bed")
        stands.append(_bushes(city, bush, Points(xy[on], ids[on])))
    return stands


def _at_corners(city: City, beds: Beds) -> list[Stand]:
    """Four bushes in each square bed, and amid most a tree, which drivers see past and below."""
    aside = np.array([(x, y) for x in (-0.5, 0.5) for y in (-0.5, 0.5)]) * CORNER
    across = np.column_stack([-beds.along[:, 1], beds.along[:, 0]])
    axes = np.stack([beds.along, across], axis=1)  # (b, 2, 2)
    xy = (beds.middle[:, None] + aside @ axes).reshape(-1, 2)
    ids = hash_ids(0, PURPOSE, np.repeat(beds.id, len(aside)), np.tile(range(4), len(beds.id)))
    amid = np.flatnonzero(uniform(city.seed, f"{PURPOSE}/corner", beds.id) < CORNER_TREES)
    trees = Points(beds.middle[amid], hash_ids(0, PURPOSE, beds.id[amid], len(aside)))
    return [_bushes(city, "boxwood", Points(xy, ids)), _small_trees(city, trees)]


def _small_trees(city: City, points: Points) -> Stand:
    """Trees that a bed has room for; behind a walk they may stand as near things as mapped ones."""
    low, high = TREES
    height = low + (high - low) * uniform(city.seed, f"{PURPOSE}/tree", points.id)
    species = draw_species("street", city, points.id)
    return stand_of(points, species, height, mapped=True)


def _bushes(city: City, name: str, points: Points) -> Stand:
    """Low bushes; they hide nobody, so that they may stand near junctions as mapped ones do."""
    low, high = LOW[name]
    height = low + (high - low) * uniform(city.seed, f"{PURPOSE}/height", points.id)
    return stand_of(points, INDEX[name], height, mapped=True, light=True)


ACTION = "nature/trees-v2"

ROW_SPACING = 8.0  # metres between the trees of a mapped row
WOOD_SPACING = 5.0  # metres; a grown mixed wood
PACKING = 0.53  # points of `poisson_in` per squared radius, measured
GROVE_SPACING = 11.0  # metres; wider, a single tree leaves the wood's floor bare from the air
NEAR_SHARE = 0.7  # of the budget, for woods beside buildings at most
# Bushes stand so many times closer in thickets than evenly, which are some metres wide.
THICKET, THICKET_SIZE = 2.6, 16.0
SOUNDINGS = 96  # of the noise of thickets along each axis
ANY = "any"
KINDS_OF_TREES = tuple(name for name in SPECIES if name not in (*BUSHES, "grove"))
SHARE_OF_ALL, SHARE_OF_SOME = 0.8, 0.05  # of all trees that are of an asked species at least
MANY = 10_000_000  # trees; more than any site has
FARTHEST = 500.0  # metres between the trees of a street
COMPANY = 21.0  # metres within which a tree that a rule plants along a street has another one
MORE_SPACINGS = (12.0, 9.0, 7.0, 5.5, 4.5)  # metres between trees that are added, tried in turn

# (spacing in metres, share of points kept, kind of mix) by kind of area.
AREAS = {
    "wood": (WOOD_SPACING, 1.0), "park": (9.0, 0.55), "garden": (8.0, 0.40),
    "cemetery": (8.0, 0.45), "golf": (13.0, 0.35), "scrub": (1.7, 0.45), "orchard": (4.5, 0.95),
    "grass": (16.0, 0.18), "residential": (11.0, 0.30),
}  # fmt: skip


def _mapped(city: City) -> list[Stand]:
    """Trees and shrubs mapped as points, and rows of trees."""
    stands = []
    table = city.layout.points
    kind = table["kind"].to_numpy().astype(str)
    rows = np.flatnonzero((kind == "tree") | (kind == "shrub"))
    if len(rows):
        ids = table["id"].to_numpy()[rows]
        species = draw_species("street", city, ids)
        named = [species_of_tags(text) for text in table["tags"].to_numpy()[rows]]
        species = np.array([INDEX[n] if n else s for n, s in zip(named, species, strict=True)])
        species[kind[rows] == "shrub"] = INDEX["shrub"]
        xy = shapely.get_coordinates(table.geometry.to_numpy()[rows])
        stands.append(
            stand_of(Points(xy, ids), species, table["height"].to_numpy()[rows], mapped=True)
        )
    lines = city.layout.lines
    rows = np.flatnonzero(lines["kind"].to_numpy().astype(str) == "tree_row")
    if len(rows):
        packed = pack(lines.geometry.to_numpy()[rows])
        line, along = every(arc_lengths(packed)[1], ROW_SPACING)
        ids = lines["id"].to_numpy()[rows]
        named = [species_of_tags(text) for text in lines["tags"].to_numpy()[rows]]
        species = draw_species("street", city, ids)
        species = np.array([INDEX[n] if n else s for n, s in zip(named, species, strict=True)])
        number = np.arange(len(line)) - np.searchsorted(line, line)
        points = Points(locate(packed, line, along)[0], hash_ids(0, ACTION, ids[line], number))
        height = lines["height"].to_numpy()[rows][line]
        stands.append(
            stand_of(points, species[line], height, mapped=True, line=ids[line], place=number)
        )
    return stands


def _wooded(city: City, budget: int, have: FloatArray) -> list[Stand]:
    """Trees of woods, parks and orchards, none where the map shows single trees already."""
    areas = city.layout.areas
    kinds = areas["kind"].to_numpy().astype(str)
    site = shapely.box(*city.layout.extent)
    stands = []
    for kind, (spacing, share) in AREAS.items():
        rows = np.flatnonzero(kinds == kind)
        if kind == "orchard":  # vines are no trees
            rows = rows[of_kinds(areas.iloc[rows], ["orchard:!vineyard"])]
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
        apart = max(spacing, radius / THICKET) if kind == "scrub" else radius
        points = poisson_in(
            shapes, apart, seed=city.seed, purpose=purpose, bounds=city.layout.extent
        )
        if kind == "scrub":
            density = _thickets(points.xy, share * (apart / radius) ** 2, city.seed)
        else:
            density = share * _clumps(points.xy, city.seed, purpose)
        points = thinned(points, density, seed=city.seed, purpose=purpose)
        if kind == "scrub":
            species = np.full(len(points.id), INDEX["shrub"])
        elif kind == "orchard":
            species = draw_species("orchard", city, points.id)
        else:
            species = draw_species("park", city, points.id)
            bush = uniform(city.seed, purpose, points.id, 7) < 0.22
            species = np.where(bush, INDEX["shrub"], species)
            if kind in ("garden", "cemetery"):
                clipped = uniform(city.seed, purpose, points.id, 8) < 0.35
                species = np.where(bush & clipped, INDEX["boxwood"], species)
        height = np.nan if kind != "orchard" else 4.2
        stands.append(stand_of(points, species, height, light=kind == "scrub"))
    return stands


def _covered(shapes: NDArray[Any], have: FloatArray) -> BoolArray:
    """Mark areas in which single trees are mapped, at least one per 600 square metres."""
    tree = shapely.STRtree(shapely.points(have))
    found = tree.query(shapes, predicate="contains")[0]
    count = np.bincount(found, minlength=len(shapes))
    return np.asarray(count * 600.0 > shapely.area(shapes))


def _clumps(xy: FloatArray, seed: int, purpose: str) -> FloatArray:
    """(n,) density that groups points: one draw per 40 m cell, 1 on average."""
    cells = np.floor(xy / 40.0).astype(np.int64)
    return np.asarray(0.25 + 1.5 * uniform(seed, purpose, cell_ids(cells), 5))


def _thickets(xy: FloatArray, share: float, seed: int) -> FloatArray:
    """(n,) density, 1 within thickets and 0 between them, that keeps a share of the places."""
    # What share of the noise lies above a height is measured at the same places for every site.
    axis = np.arange(SOUNDINGS) * 0.73
    usual = gradient_noise(
        seed, np.stack(np.meshgrid(axis, axis), axis=-1).reshape(-1, 2), octaves=2
    )
    height = gradient_noise(seed, xy / THICKET_SIZE, octaves=2)
    return np.asarray((height >= np.quantile(usual, 1.0 - share)).astype(float))


def _woods(city: City, shapes: NDArray[Any], budget: int, purpose: str) -> list[Stand]:
    """Fill woods: full density within the budget, else dense near buildings, groves farther off."""
    extent = city.layout.extent
    area = float(shapely.area(shapes).sum())
    if PACKING * area / WOOD_SPACING**2 <= budget:
        points = poisson_in(shapes, WOOD_SPACING, seed=city.seed, purpose=purpose, bounds=extent)
        return [stand_of(points, _wood_species(city, points), light=True)]
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
            stands.append(stand_of(points, INDEX["grove"], radius, light=True))
        else:
            stands.append(stand_of(points, _wood_species(city, points), light=True))
    return stands


class _NearBuildings:
    """Returns whether positions lie in a block beside a building, where woods are seen close by."""

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
    share = profile_of(city.frame).trees.conifers[climate_of(city.frame)]
    stranger = uniform(city.seed, "nature/stranger", points.id) < 0.15
    return np.where((patch < share) ^ (stranger & (share > 0)),
                    draw_species("needle", city, points.id),
                    draw_species("broad", city, points.id))  # fmt: skip


def _settled(city: City, stands: list[Stand]) -> tuple[list[Stand], tuple[Failure, ...]]:
    """Move trees of a map that cannot stand where it has them to the nearest room.

    Returns
    -------
    stands, crowded
        All stands, and a failure for each tree that finds no room.
    """
    if city.ground is None or not stands:
        return stands, ()
    every_one = join_stands(stands)
    table = city.layout.points
    own = np.flatnonzero(np.isin(every_one.id, table["id"][of_maps(table)]))
    keep = room_of(city, every_one.xy[own], np.ones(len(own), bool), np.zeros((0, 2)))[1]
    lost = own[~keep]
    if not len(lost):
        return stands, ()

    def is_free(_: IntArray, xy: FloatArray) -> BoolArray:
        moved, free = room_of(city, xy, np.ones(len(xy), bool), np.zeros((0, 2)))[:2]
        return np.asarray(free & (np.hypot(*(moved - xy).T) < 1e-9))

    places = every_one.xy.copy()
    places[lost], found = nearest_free(places[lost], is_free, reach=MOST_AWAY)
    named = every_one.id[lost[~found]].tolist()
    return (
        [replace(every_one, xy=places)],
        tuple(Failure(number, ACTION, CROWDED) for number in named),
    )


def _rooted(city: City, stands: list[Stand]) -> tuple[Stand, Room]:
    """Return the trees that find room in the site, each once, and their room."""
    stand = join_stands(stands)
    xmin, ymin, xmax, ymax = city.layout.extent
    x, y = stand.xy.T
    stand = take_trees(stand, (x >= xmin) & (x <= xmax) & (y >= ymin) & (y <= ymax))
    street = (stand.line > 0) & ~stand.mapped
    xy, keep, room = room_of(city, stand.xy, stand.mapped, lamp_places(city), street)
    order = np.argsort(stand.id, kind="stable")
    order = order[keep[order]]
    order = order[np.unique(stand.id[order], return_index=True)[1]]
    order = order[_in_company(take_trees(replace(stand, xy=xy), order))]
    return take_trees(replace(stand, xy=xy), order), _room_rows(room, order)


def _of_species(stands: list[Stand], species: str) -> list[Stand]:
    """Give trees a species; what is no tree stays."""
    if species == ANY:
        return stands
    return [
        replace(stand, species=np.where(_is_tree(stand), INDEX[species], stand.species))
        for stand in stands
    ]


def _in_company(stand: Stand) -> BoolArray:
    """(n,) trees but for those of a street's row that nothing is left of but themselves."""
    kept = np.ones(len(stand.id), bool)
    row = np.flatnonzero((stand.line > 0) & ~stand.mapped)
    if not len(row):
        return kept
    pairs = near_pairs(stand.xy[row], COMPANY)
    alone = np.ones(len(row), bool)
    alone[pairs.ravel()] = False
    kept[row[alone]] = False
    return kept


def _room_rows(room: Room, rows: Any) -> Room:
    return Room(room.facade[rows], room.road[rows], room.path[rows])


def _counted(city: City, stands: list[Stand], least: int, most: int) -> tuple[Stand, Room]:
    """Return the trees with room, no fewer and no more than asked for.

    Raises
    ------
    ActionFailed
        If the site has no room for as many.
    """
    stands = [_empty(), *(s for s in stands if len(s.id))]
    stand, room = _rooted(city, stands)
    for spacing in MORE_SPACINGS:
        if _is_tree(stand).sum() >= least:
            break
        stand, room = _rooted(city, [*stands, _more(city, stand.xy, spacing)])
    count = int(_is_tree(stand).sum())
    if count < least:
        raise ActionFailed(
            f"There is room for {count} trees, {least} are asked for; ask for fewer, for a larger "
            "site or for less of it to be built on."
        )
    if most == MANY:
        return stand, room
    drawn = uniform(city.seed, f"{ACTION}/most", stand.id)
    tree = np.flatnonzero(_is_tree(stand))
    kept = np.sort(tree[np.argsort(drawn[tree], kind="stable")[:most]])
    return take_trees(stand, kept), _room_rows(room, kept)


def _empty() -> Stand:
    return stand_of(Points(np.zeros((0, 2)), np.zeros(0, np.uint64)), 0)


def _is_tree(stand: Stand) -> BoolArray:
    return ~np.isin(stand.species, [INDEX[name] for name in BUSHES])


def _more(city: City, have: FloatArray, spacing: float) -> Stand:
    """Return trees all over a site's open ground, clear of those there are."""
    site = np.array([shapely.box(*city.layout.extent)], object)
    points = poisson_in(site, spacing, seed=city.seed, purpose=f"{ACTION}/more",
                        bounds=city.layout.extent)  # fmt: skip
    clear = ~np.isfinite(distance_within(points.xy, shapely.points(have), spacing / 2))
    points = Points(points.xy[clear], points.id[clear])
    return stand_of(points, draw_species("park", city, points.id))


@action(
    ACTION,
    limits=[
        "Trees under bridges and in tunnels are left out.",
        "Woods beyond the budget get fewer, wider groups of trees.",
        "Shrubs, palms and boxwood look alike in every season.",
    ],
    requires=("layout",),
    after=("background/weather-v1", "road/ground-v1"),
    takes=(Port("layout", "scene_layout"),),
    gives=(Port("trees", "point", role="tree"),),
    labels=("vegetation", "forest", "park", "plants", "autumn", "spring", "blossom"),
)
def trees(
    city: City,
    *,
    budget: Annotated[int, Range(0, 2_000_000)] = 80_000,
    street_trees: bool = True,
    season: Literal["auto", "spring", "summer", "autumn", "winter"] = "auto",
    least: Annotated[int, Range(0, 100_000)] = 0,
    most: Annotated[int, Range(0, MANY)] = MANY,
    least_apart: Annotated[float, Range(0.0, FARTHEST)] = 0.0,
    most_apart: Annotated[float, Range(2.0, FARTHEST)] = FARTHEST,
    species: Annotated[str, Choice(ANY, *KINDS_OF_TREES)] = ANY,
    street_species: Annotated[str, Choice(ANY, *KINDS_OF_TREES)] = ANY,
    park_species: Annotated[str, Choice(ANY, *KINDS_OF_TREES)] = ANY,
) -> City:
    """Plant mapped trees, tree rows, woods, parks, orchards, yards and bare streets.

    Parameters
    ----------
    city
        City with a layout; the terrain, the road network and the ground are used when there.
    budget
        Trees of woods at most; beyond, they stand wider and in groups. Without any, yards have
        none either.
    street_trees
        Whether wide streets of an urban place get some where none is mapped.
    season
        Leaves, their colour and blossom; "auto" follows the date, the latitude and the snow.
    least
        Trees there must be; more are planted on open ground where there are fewer.
    most
        Trees there may be; where that is asked, no shrub is planted either.
    least_apart, most_apart
        Metres between the trees of a street where none is mapped.
    species
        Kind of the trees of streets, parks, woods and yards, of those that no map names.
    street_species, park_species
        Kind of the trees of streets alone, and of parks.
    """
    if least > most:
        raise UsageError(f"least = {least} trees are more than most = {most}.")
    if least_apart > most_apart:
        raise UsageError(f"least_apart = {least_apart:g} is more than most_apart = {most_apart:g}.")
    done = city.stages_done | {"nature"}
    if city.lod < 1:
        return replace(city, stages_done=done)
    of_streets, of_parks = (
        special if special != ANY else species for special in (street_species, park_species)
    )
    stands, crowded = _settled(city, _mapped(city))
    city = replace(city, failures=(*city.failures, *crowded))
    have = np.concatenate([s.xy for s in stands]) if stands else np.zeros((0, 2))
    if budget:
        stands += _of_species(_wooded(city, budget, have), of_parks)
    if street_trees:
        apart = least_apart, most_apart
        beside = along_streets(city, have, apart=apart) + bed_stands(city) + island_stands(city)
        stands += _of_species(beside, of_streets)
        stands += roundabout_stands(city, have)
    if budget:
        stands += _of_species(in_yards(city, have), species)
    stand, room = _counted(city, stands, least, most)
    for word, kind in (("", species), ("street ", street_species), ("park ", park_species)):
        if kind != ANY:
            chosen, end = f"tree, species={kind}", SHARE_OF_ALL if not word else SHARE_OF_SOME
            city = asked(city, f"{word}trees: {kind}", f"n({chosen}) / n(tree)", least=end)
    if least > 0:
        city = asked(city, f"{least} trees at least", "n(tree)", least=least)
    if most < MANY:
        words = f"{most} trees at most" if most else "no tree"
        city = asked(city, words, "n(tree)", most=most)
    if not len(stand.id):
        return replace(city, stages_done=done)
    prototypes, rows = rows_of(city, stand, room, season)
    scene = city.scene.with_instances("trees", prototypes, rows)
    planted = replace(city, scene=scene, stages_done=done)
    return with_pits(planted, rows) if city.lod > 1 else planted
