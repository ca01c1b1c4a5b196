"""Parts: the volumes of each building, with every height and roof resolved."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.city.layout import make_table
from cityx.geometry.arrays import FloatArray, IntArray
from cityx.geometry.polygons import cut_at_waists
from cityx.ids import UInt64Array, hash_ids
from cityx.places.profile import Buildings
from cityx.sources.features.building_heights import (
    TOWER_HEIGHT,
    building_types,
    fill_levels,
    height_of_levels,
    levels_of_height,
)
from cityx.sources.features.density import PLACES, Density
from cityx.sources.features.kinds import PLACE, type_word, use_of
from cityx.sources.features.roofs import SHAPE, SHAPES, directions_of, fill_shapes, roof_heights
from cityx.sources.features.shells import Shells, separate_volumes
from cityx.sources.features.tagged import MIN_SOLID, Tagged, Tags, number_pieces, polygons_of
from cityx.sources.features.vertical import Vertical, read_vertical
from cityx.sources.features.vocabulary import ROOF_ONLY

if TYPE_CHECKING:
    from geopandas import GeoDataFrame

UNCOVERED = 0.10  # share of an outline without parts from which the rest is raised too
OPENING = 0.2  # metres; thinner leftovers between parts and outline are drawing noise
MIN_EAVE = 0.1  # metres between a base and its eave
MIN_HEIGHT = 0.5  # metres of any volume
STEP = 0.5  # metres; what begins lower stands on the ground, which is no more even than that
ROOF_SHARE = 0.5  # of its height that a roof nobody measured may take
POSTS = 4.0  # metres to the top of a canopy without tags
HIGH_SHARE = 0.95  # an outline as high as its highest part names the part's height, not its own
PODIUM = 0.35  # of the height of the only part on the ground, how high the rest beside it is
PODIUM_HEIGHT = 4.0  # metres at least
BODY, PART, REST = 0, 1, 2


@dataclass(frozen=True)
class Pieces:
    """What is to be raised, n polygons.

    Attributes
    ----------
    polygons
        (n,).
    building
        (n,) row of the outline.
    part
        (n,) row of the building:part, -1 for a body or a rest.
    kind
        (n,) `BODY`, `PART` or `REST`.
    """

    polygons: NDArray[Any]
    building: IntArray
    part: IntArray
    kind: IntArray


def building_tables(
    shells: Shells, density: Density, industrial: NDArray[Any], *, local: Buildings, seed: int
) -> tuple[GeoDataFrame, GeoDataFrame]:
    """Resolve every building and make the tables of buildings and parts.

    Parameters
    ----------
    density
        Of the site.
    industrial
        Polygons of industrial land.
    local
        Of the profile of the place.
    """
    outlines = shells.outlines
    if len(outlines.shapes) == 0:
        none = np.zeros(0, object)
        return make_table("buildings", none), make_table("parts", none)
    ids = outlines.ids()
    tags = outlines.tags()
    said = read_vertical(tags)
    centres = shapely.get_coordinates(shapely.centroid(outlines.shapes))
    place = _places(tags, density.place(centres))
    uses = [use_of(own) for own in tags]
    words = [type_word(own) for own in tags]
    on_industry = np.zeros(len(ids), bool)
    on_industry[
        shapely.STRtree(industrial).query(shapely.points(centres), predicate="within")[0]
    ] = True
    types = building_types(words, shapely.area(outlines.shapes), place, on_industry)
    pieces = _pieces(shells)
    said_parts = read_vertical(shells.parts.tags())
    known = _known_levels(said, said_parts, shells, types)
    levels = fill_levels(known, outlines.shapes, types, place, ids, seed=seed)
    parts = _resolve(
        shells, pieces, said, said_parts, uses, types, place, levels, ids,
        local=local, seed=seed,
    )  # fmt: skip
    highest = np.zeros(len(ids))
    np.maximum.at(highest, parts["row"], parts["top"])
    most = np.zeros(len(ids))
    np.maximum.at(most, parts["row"], parts["total"])
    standing = highest > 0
    rows = np.flatnonzero(standing)
    kept = outlines.take(rows)
    buildings = make_table(
        "buildings",
        kept.shapes,
        use=[uses[row] for row in rows.tolist()],
        levels=np.maximum(most[rows], 1).astype(np.int16),
        height=highest[rows],
        place=PLACES[place[rows]],
        **kept.columns(),
    )
    del parts["row"], parts["total"]
    return buildings, make_table("parts", parts.pop("geometry"), **parts)


def _places(tags: list[Tags], measured: IntArray) -> IntArray:
    """Return the class of the surroundings of buildings: what the source says, else as measured."""
    known = {word: index for index, word in enumerate(PLACES.tolist())}
    said = [known.get(own.get(PLACE, ""), -1) for own in tags]
    return np.where(np.array(said, np.int64) >= 0, said, measured).astype(np.int64)


def known_levels(said: Vertical, types: IntArray) -> FloatArray:
    """Return the levels that tags give, directly or by a height; NaN elsewhere."""
    roof = np.nan_to_num(said.roof_height)
    by_height = levels_of_height(np.maximum(said.height - roof, 1.0), types)
    by_height = np.where(np.isnan(said.height), np.nan, by_height)
    return np.where(np.isnan(said.levels), by_height, said.levels)


def _known_levels(
    said: Vertical, said_parts: Vertical, shells: Shells, types: IntArray
) -> FloatArray:
    """Levels of buildings from their own tags, else from those of their highest part."""
    known = known_levels(said, types)
    of_parts = known_levels(said_parts, types[shells.building])
    most = np.full(len(known), -1.0)
    usable = ~np.isnan(of_parts)
    np.maximum.at(most, shells.building[usable], of_parts[usable])
    return np.where(np.isnan(known) & (most >= 0), most, known)


def _pieces(shells: Shells) -> Pieces:
    """List bodies, parts, and the rests of outlines that their parts leave uncovered."""
    count = len(shells.outlines.shapes)
    divided = np.bincount(shells.building, minlength=count) > 0
    whole = np.flatnonzero(~divided)
    rows = np.flatnonzero(divided)
    rests = np.zeros(0, object)
    if len(rows):
        order = np.argsort(shells.building, kind="stable")
        collected = shapely.multipolygons(
            shells.parts.shapes[order], indices=np.searchsorted(rows, shells.building[order])
        )
        cover = shapely.unary_union(collected.reshape(-1, 1), axis=1)
        outline = shells.outlines.shapes[rows]
        rest = shapely.difference(outline, cover)
        large = shapely.area(rest) > UNCOVERED * shapely.area(outline)
        eroded = shapely.buffer(rest[large], -OPENING, join_style="mitre")
        opened = shapely.buffer(eroded, OPENING * 1.01, join_style="mitre")
        rests_shapes = shapely.intersection(rest[large], opened)
        rests, owner = polygons_of(rests_shapes)
        rest_rows = rows[large][owner]
    else:
        rest_rows = rows
    none = np.full(len(whole), -1, np.int64)
    return Pieces(
        np.concatenate([shells.outlines.shapes[whole], shells.parts.shapes, rests]),
        np.concatenate([whole, shells.building, rest_rows]).astype(np.int64),
        np.concatenate(
            [none, np.arange(len(shells.parts.shapes)), np.full(len(rest_rows), -1)]
        ).astype(np.int64),
        np.repeat([BODY, PART, REST], [len(whole), len(shells.building), len(rest_rows)]),
    )


def _resolve(
    shells: Shells,
    pieces: Pieces,
    said: Vertical,
    said_parts: Vertical,
    uses: list[str],
    types_of: IntArray,
    place_of: IntArray,
    levels_of: FloatArray,
    building_ids: UInt64Array,
    *,
    local: Buildings,
    seed: int,
) -> dict[str, Any]:
    """Resolve the heights, roofs and surfaces of all pieces; columns of the table of parts."""
    building, kind = pieces.building, pieces.kind
    is_part = kind == PART
    parent = said.take(building)
    own = _own_or_parent(parent, said_parts, pieces)
    types, place = types_of[building], place_of[building]
    ids = _piece_ids(shells.parts, pieces, building_ids)
    part_uses = [use_of(found) for found in shells.parts.tags()]
    use = np.array([uses[row] for row in building.tolist()], object)
    use[is_part] = [
        word if word != "yes" else uses[row]
        for word, row in zip(part_uses, building[is_part].tolist(), strict=True)
    ]
    walls = ~np.isin(use, sorted(ROOF_ONLY))

    # Heights: a part that says nothing of its own has the building's.
    silent = is_part & ~own.has_height
    height = np.where(silent, parent.height, own.height)
    levels = np.where(silent, parent.levels, own.levels)
    height = np.where(kind == REST, _rest_height(pieces, own, parent), height)
    given = ~np.isnan(levels)
    stated = ~np.isnan(height)
    levels = np.where(given, levels, levels_of[building])
    min_level = np.nan_to_num(own.min_level)
    base = np.where(
        np.isnan(own.min_height),
        np.where(min_level > 0, height_of_levels(min_level, types), 0.0),
        own.min_height,
    )
    shapes = np.where(own.roof_shape >= 0, own.roof_shape, np.where(is_part, SHAPE["flat"], -1))
    tower = np.array([TOWER_HEIGHT.get(word, np.nan) for word in use.tolist()], float)
    raised = (np.nan_to_num(own.roof_height) > 0) | (np.nan_to_num(own.roof_levels) > 0)
    raised |= ~np.isnan(own.roof_angle)
    shapes = np.where((own.roof_shape < 0) & ~raised & (~walls | ~np.isnan(tower)), SHAPE["flat"], shapes)  # fmt: skip  # noqa: E501
    shapes = fill_shapes(shapes, pieces.polygons, types, place, levels, ids, local=local, seed=seed)
    shapes = np.where(raised & (own.roof_shape < 0), _raised_shape(shapes), shapes)
    usual = roof_heights(shapes, pieces.polygons, types, ids, own.roof_angle, seed=seed)
    measured = ~np.isnan(own.roof_height)
    by_levels = np.nan_to_num(own.roof_levels) * 2.8
    roof = np.where(measured, own.roof_height, np.where(by_levels > 0, by_levels, usual))
    roof = np.where(shapes == SHAPE["flat"], 0.0, roof)

    eave = height_of_levels(np.maximum(levels, 0.0), types)
    eave = np.where(levels <= 0, np.where(roof > 0, 0.5, 2.5), eave)
    eave = np.where(walls, eave, POSTS)
    eave = np.where(np.isnan(tower) | given, eave, tower)
    top = np.where(stated, height, eave + roof)
    # A base above the top (levels counted from the part's own foot) lifts the top.
    base = np.where(stated & (base >= height - MIN_HEIGHT), 0.0, base)
    lifted = ~stated & (top <= base + MIN_HEIGHT)
    top = np.where(lifted, base + eave + roof, np.maximum(top, base + MIN_HEIGHT))
    base = np.where(base < STEP, 0.0, base)
    span = top - base
    guessed = stated & ~measured & np.isnan(own.roof_angle)
    roof = np.where(guessed, np.minimum(roof, ROOF_SHARE * span), roof)
    roof = np.clip(roof, 0.0, np.maximum(span - MIN_EAVE, 0.0))
    polygons, base = separate_volumes(pieces.polygons, base, top, roof, walls, ids)
    roof = np.minimum(roof, np.maximum(top - base - MIN_EAVE, 0.0))
    storeys = np.where(
        given & ~silent & (levels > min_level),
        levels - min_level,
        levels_of_height(top - roof - base, types, on_ground=base < 0.1),
    )
    gone = top - base < MIN_HEIGHT
    polygons = cut_at_waists(np.where(gone, shapely.Polygon(), polygons))
    split, row = polygons_of(polygons, least=MIN_SOLID)
    k = number_pieces(row)
    numbered = np.where(k > 0, hash_ids(0, "osm/piece", ids[row], k), ids[row])
    own_row = own.take(row)
    direction = directions_of(pieces.polygons, own.roof_direction, own.across, own.along)
    return {
        "geometry": shapely.orient_polygons(split),
        "row": building[row],
        "total": np.where(given, levels, storeys)[row],
        "id": numbered,
        "building": building_ids[building[row]],
        "use": use[row],
        "base": base[row],
        "top": top[row],
        "levels": np.maximum(storeys[row], 1).astype(np.int16),
        "roof_shape": np.array(SHAPES, object)[shapes[row]],
        "roof_height": roof[row],
        "roof_direction": direction[row],
        "roof_across": own_row.across,
        "walls": walls[row],
        "wall_color": own_row.wall_color,
        "wall_material": own_row.wall_material,
        "roof_color": own_row.roof_color,
        "roof_material": own_row.roof_material,
    }


def _raised_shape(shapes: IntArray) -> IntArray:
    """Replace flat roofs of which a height is known."""
    return np.where(shapes == SHAPE["flat"], SHAPE["gabled"], shapes)


def body_ids(building_ids: UInt64Array) -> UInt64Array:
    """Return the ids of the parts that are whole buildings of which no part is described, (n,)."""
    return hash_ids(0, "osm/body", building_ids)


def _piece_ids(parts: Tagged, pieces: Pieces, building_ids: UInt64Array) -> UInt64Array:
    found = np.zeros(len(pieces.kind), np.uint64)
    is_part = pieces.kind == PART
    found[is_part] = parts.ids()[pieces.part[is_part]]
    rest = pieces.kind == REST
    found[~is_part] = body_ids(building_ids[pieces.building[~is_part]])
    k = number_pieces(pieces.building[rest])
    found[rest] = hash_ids(0, "osm/rest", building_ids[pieces.building[rest]], k)
    return found


def _own_or_parent(parent: Vertical, said_parts: Vertical, pieces: Pieces) -> Vertical:
    """Take a part's own words, and the building's for surfaces the part does not mention."""
    is_part = pieces.kind == PART
    rows = np.where(is_part, pieces.part, 0)
    if len(said_parts.height) == 0:
        return parent
    own = said_parts.take(rows)
    merged: dict[str, Any] = {}
    for name in Vertical.__dataclass_fields__:
        merged[name] = np.where(is_part, getattr(own, name), getattr(parent, name))
    for name in ("wall_color", "roof_color"):
        silent = is_part & (merged[name] == -1)
        merged[name] = np.where(silent, getattr(parent, name), merged[name])
    for name in ("wall_material", "roof_material"):
        silent = is_part & (merged[name] == "")
        merged[name] = np.where(silent, getattr(parent, name), merged[name])
    return Vertical(**merged)


def _rest_height(pieces: Pieces, own: Vertical, parent: Vertical) -> FloatArray:
    """Return the height of what parts leave uncovered, NaN where its levels say more.

    The height of an outline is usually that of its highest part. Then the rest is as high as the
    lowest of several parts on the ground, and a podium beside a single one. An outline higher than
    all of its parts names the height of the rest.
    """
    size = int(pieces.building.max()) + 1 if len(pieces.building) else 0
    is_part = pieces.kind == PART
    tall = is_part & ~np.isnan(own.height)
    grounded = tall & (np.nan_to_num(own.min_height) < 1.0)
    lowest, highest, count = np.full(size, np.inf), np.zeros(size), np.zeros(size)
    np.minimum.at(lowest, pieces.building[grounded], own.height[grounded])
    np.add.at(count, pieces.building[grounded], 1)
    np.maximum.at(highest, pieces.building[tall], own.height[tall])
    low, high = lowest[pieces.building], highest[pieces.building]
    single = count[pieces.building] == 1
    guess = np.where(single, np.maximum(PODIUM * low, PODIUM_HEIGHT), low)
    unknown = np.isnan(parent.height) & np.isnan(parent.levels)
    of_part = (parent.height >= HIGH_SHARE * high) & (high >= HIGH_SHARE * parent.height)
    return np.where(np.isfinite(low) & (unknown | of_part), guess, parent.height)
