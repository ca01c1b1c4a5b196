"""Selection: which generator a building gets.

By purpose first (what the input's tags say it is), else drawn from the table of its use group and
the style family of the brief, or the ways of building of the region. Footprint, storeys and width
exclude what makes no sense there; words of the brief and the class of the place shift the weights;
neighbours wall to wall share one draw where their generator builds rows.
"""

from __future__ import annotations

import json
import re
from collections.abc import Mapping, Sequence
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.assets.styles.palettes import GROUPS, building_groups, family_of, is_regional, owner_rows
from cityx.assets.styles.style_shares import (
    ALWAYS,
    STRAY,
    STYLE_WORDS,
    TABLE,
    Weights,
    outside_weight,
    speaking_of,
)
from cityx.building.catalogue import USUAL, generators
from cityx.city.layout import is_mesh
from cityx.geometry.arrays import FloatArray
from cityx.ids import hash_ids, uniform
from cityx.places.profile import Buildings, Profile
from cityx.places.profiles import profile_of

if TYPE_CHECKING:
    from cityx.assets.styles.generators import Generator
    from cityx.city.city import City
    from cityx.city.layout import Layout

Words = NDArray[np.str_]

# What takes a building that nothing of its row of the table fits, first that fits.
SPARE = ("mixed_use", "office_slab", "glass_tower", "suburban_house", "big_box", "shed")

# Words of building=* (and of amenity, leisure, ...) that name the generator itself.
PURPOSE: Mapping[str, str] = MappingProxyType(
    {
        word: name
        for name, words in {
            "church": "church cathedral chapel basilica monastery presbytery",
            "mosque": "mosque",
            "temple": "temple shrine pagoda buddhist hindu",
            "school": "school kindergarten university college",
            "hospital": "hospital clinic",
            "stadium": "stadium",
            "station_hall": "train_station station transportation",
            "parking": "parking parking_garage multi-storey",
            "petrol_station": "fuel",
            "townhall": "townhall courthouse",
            "greenhouse": "greenhouse conservatory",
            "barn": "barn farm_auxiliary stable cowshed sty",
            "big_box": "supermarket mall",
            "warehouse": "warehouse hangar depot",
            "sawtooth_factory": "factory manufacture works",
            "bungalow": "bungalow static_caravan",
            "cottage": "cabin cottage",
            "suburban_house": "villa detached semidetached_house",
        }.items()
        for word in words.split()
    }
)
_KEYS = ("amenity", "leisure", "tourism", "shop", "religion", "railway", "healthcare", "parking")
_TELLING = re.compile("|".join(f'"{key}"' for key in _KEYS))
_GENERAL = ("yes", "roof", "public", "civic", "religious", "retail", "commercial", "garage",
            "garages", "service", "industrial", "farm")  # fmt: skip
_FAITHS = {"muslim": "mosque", "buddhist": "temple", "shinto": "temple", "hindu": "temple",
           "taoist": "temple", "sikh": "mosque"}  # fmt: skip

# Class of the surroundings -> generators that it favours or does not.
PLACES: Mapping[str, Weights] = MappingProxyType(
    {
        "low": {"glass_tower": 0.3, "palazzo": 0.4, "setback_skyscraper": 0.2, "shop_house": 0.5,
                "postmodern_tower": 0.3, "suburban_house": 1.5, "bungalow": 1.5},
        "urban": {"bungalow": 0.4},
        "core": {"bungalow": 0.1, "suburban_house": 0.5, "panel_slab": 0.5, "glass_tower": 1.3},
    }
)  # fmt: skip
TOUCH = 0.3  # metres between neighbours wall to wall
# Generators whose houses stand in rows of one design; next to each other, others differ.
IN_ROWS = ("georgian_terrace", "walk_up", "shop_house", "suburban_house", "cottage", "bungalow",
           "panel_slab", "warehouse", "shed")  # fmt: skip
# Generators that mostly stand free, and their weight where a neighbour touches.
FREE_STANDING: Weights = MappingProxyType(
    {"panel_slab": 0.12, "mixed_use": 0.5, "asian_block": 0.6}
)
ROW_SHARE = 0.85  # of the houses of a row that follow its design
ROW_REACH = 6  # neighbours along a row whose design is shared
ASKED = 3.0  # weight of generators that speak of the style asked for, against a region's usual one
LARGE_PARKING = 250.0  # square metres; smaller garages are sheds


def generators_of(city: City) -> Words:
    """Return the name of the generator of every building, (n,).

    Those that an earlier action chose stay.
    """
    layout = city.layout
    chosen = layout.buildings["generator"].to_numpy(str)
    if len(chosen) and (chosen != "").all():
        return np.asarray(chosen)
    found = choose_generators(
        layout, city.seed, style=city.style, place=profile_of(city.frame)
    )  # fmt: skip
    return np.where(chosen == "", found, chosen)


def designs_of_parts(city: City) -> Words:
    """Return the key of the look of every part: its generator, with its zone; (n,)."""
    parts = city.layout.parts
    owner, described = owner_rows(city.layout)
    name = np.full(len(parts), USUAL, "U40")
    if len(city.layout.buildings):
        own = generators_of(city)
        own = np.where(np.isin(own, list(generators())), own, USUAL)
        name = np.where(described, own[owner], name)
    zone = parts["zone"].to_numpy(str)
    zoned = np.char.add(np.char.add(name, "/"), zone)
    known = [key for each in generators().values() for key in each.looks()]
    return np.where((zone != "") & np.isin(zoned, known), zoned, name).astype("U40")


def choose_generators(
    layout: Layout,
    seed: int,
    *,
    style: str = "",
    place: Profile | None = None,
    without: Sequence[str] = (),
) -> Words:
    """Choose the generator of every building; see the tables of this module.

    Parameters
    ----------
    place
        The profile of the place, None when it is unknown.
    without
        Generators that are not chosen.

    Raises
    ------
    UsageError
        If there is no such style.
    """
    buildings = layout.buildings
    names = np.array(list(generators()), "U32")
    local = place.buildings if place else Buildings()
    lineage = place.lineage if place else ()
    family = family_of(style, local.family)
    if not len(buildings):
        return np.zeros(0, "U32")
    group = building_groups(layout, seed)
    own = local.generators if is_regional(style) else {}
    base = np.array([_row({**TABLE[family], **own}, word, names) for word in GROUPS])
    base += np.array([[outside_weight(name, word, style, family, lineage)
                       for name in names.tolist()] for word in GROUPS])  # fmt: skip
    weight = base[group]
    weight = weight * _favoured(names, buildings["place"].to_numpy(str), PLACES)
    ids = buildings["id"].to_numpy(np.uint64)
    touching = _touching(buildings.geometry.to_numpy())
    joined = np.zeros(len(ids), bool)
    joined[touching[0]] = True
    free = np.array([FREE_STANDING.get(name, 1.0) for name in names.tolist()])
    weight = np.where(joined[:, None], weight * free, weight)
    word = style.strip().lower().replace(" ", "_")
    boost = np.array([STYLE_WORDS.get(word, {}).get(name, 1.0) for name in names.tolist()])
    weight = weight * boost + (boost > 1) * STRAY * boost * (base[group] == 0)
    if word:
        weight *= np.array([_spoken(word, each, names) for each in GROUPS])[group]
    fits = admitted(layout) & ~np.isin(names, list(without))
    weight = np.where(fits, weight, 0.0)
    lost = weight.sum(axis=1) <= 0
    for name in reversed(SPARE):
        column = int(np.flatnonzero(names == name)[0])
        weight[lost & fits[:, column]] = 0.0
        weight[lost & fits[:, column], column] = 1.0
    lost = weight.sum(axis=1) <= 0
    weight[lost, int(np.flatnonzero(names == SPARE[0])[0])] = 1.0
    found = names[
        _drawn(weight, uniform(seed, "building/generator", _row_keys(layout, seed, touching)))
    ]
    single = np.where(np.isin(names, list(IN_ROWS)), 0.0, weight)
    other = names[_drawn(single, uniform(seed, "building/generator alone", ids))]
    found = np.where(np.isin(found, list(IN_ROWS)) | (single.sum(axis=1) <= 0), found, other)
    purpose = _purposes(layout)
    known = np.isin(purpose, names)
    number = {name: at for at, name in enumerate(names.tolist())}
    columns = np.array([number.get(name, 0) for name in purpose.tolist()], np.int64)
    known &= fits[np.arange(len(buildings)), columns]
    return np.where(known, purpose, found)


def _drawn(weight: FloatArray, share: FloatArray) -> NDArray[np.int64]:
    """Return the column that numbers from 0 to 1 draw by the weights of their rows, (n,)."""
    edges = np.cumsum(weight, axis=1)
    at = (edges <= (share * edges[:, -1])[:, None]).sum(axis=1)
    return np.asarray(np.minimum(at, weight.shape[1] - 1))


def admitted(layout: Layout, floors: int = 0) -> NDArray[np.bool_]:
    """Return which generators make sense on which footprints, (n, g) bool.

    Parameters
    ----------
    floors
        Storeys that all buildings shall have, 0 for their own.
    """
    size = sizes_of(layout, floors)
    glass = _said_wall(layout)
    # A mesh takes the place of one plain volume, not of those that a map describes.
    mapped = layout.parts["building"].to_numpy(np.uint64)[~is_mesh(layout)]
    several, count = np.unique(mapped, return_counts=True)
    plain = ~np.isin(layout.buildings["id"].to_numpy(np.uint64), several[count > 1])
    columns = []
    for each in generators().values():
        fit = fits_size(each, *size)
        if each.outside is not None:
            fit &= plain
        if each.look.facade.mode == "curtain" and each.look.walls[0][1] == "glass_wall":
            fit &= np.isin(glass, ["", "glass"])
        columns.append(fit)
    return np.stack(columns, axis=1)


def sizes_of(layout: Layout, floors: int = 0) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return footprint, square metres, storeys, and shorter side, metres, of buildings, (n,)."""
    shapes = layout.buildings.geometry.to_numpy()
    levels = layout.buildings["levels"].to_numpy(float)
    levels = np.full(len(levels), float(floors)) if floors else levels
    return shapely.area(shapes), levels, widths_of(shapes)


def fits_size(
    kind: Generator, area: FloatArray, levels: FloatArray, width: FloatArray
) -> NDArray[np.bool_]:
    """Return whether a generator makes sense on buildings of a size, (n,); see `sizes_of`."""
    fit = (area >= kind.area[0]) & (area <= kind.area[1])
    fit &= (levels >= kind.levels[0]) & (levels <= kind.levels[1])
    return np.asarray(fit & (width >= kind.width[0]) & (width <= kind.width[1]))


def widths_of(shapes: NDArray[Any]) -> FloatArray:
    """Return the shorter sides of the smallest boxes around outlines, (n,) metres."""
    boxes = shapely.oriented_envelope(shapes)
    good = (shapely.get_type_id(boxes) == 3) & ~shapely.is_empty(boxes)
    width = np.zeros(len(shapes))
    corner = shapely.get_coordinates(boxes[good]).reshape(-1, 5, 2)
    width[good] = np.linalg.norm(np.diff(corner[:, :3], axis=1), axis=2).min(axis=1)
    return width


def _said_wall(layout: Layout) -> Words:
    """Return the wall material that the input names for the first part of each building, (n,)."""
    said = np.full(len(layout.buildings), "", "U32")
    owner, described = owner_rows(layout)
    rows = np.flatnonzero(described)[::-1]
    said[owner[rows]] = layout.parts["wall_material"].to_numpy(str)[rows]
    return said


def _row(table: Mapping[str, Weights], group: str, names: Words) -> FloatArray:
    weights = ALWAYS.get(group) or table[group]
    return np.array([weights.get(name, 0.0) for name in names.tolist()])


def _spoken(style: str, group: str, names: Words) -> FloatArray:
    """Return what the generators of a use gain by a style that is asked for, (g,)."""
    return np.where(np.isin(names, list(speaking_of(style).get(group, ()))), ASKED, 1.0)


def _favoured(names: Words, words: Words, table: Mapping[str, Weights]) -> FloatArray:
    known, index = np.unique(words, return_inverse=True)
    rows = [[table.get(word, {}).get(name, 1.0) for name in names.tolist()] for word in known]
    return np.asarray(np.array(rows)[index])


def _purposes(layout: Layout) -> Words:
    """Return the generator that the tags of each building name, or "", (n,)."""
    buildings = layout.buildings
    use = buildings["use"].to_numpy(str)
    known, index = np.unique(use, return_inverse=True)
    found = np.array([PURPOSE.get(word, "") for word in known.tolist()], "U32")[index]
    area = shapely.area(buildings.geometry.to_numpy())
    tags = buildings["tags"].to_numpy(object)
    vague = np.isin(use, _GENERAL) | (found == "church")
    for row in np.flatnonzero(vague).tolist():
        if not _TELLING.search(tags[row]):
            continue
        own = json.loads(tags[row])
        faith = _FAITHS.get(str(own.get("religion", "")), "")
        words = [str(own.get(key, "")) for key in _KEYS]
        named = [PURPOSE[word] for word in words if word in PURPOSE]
        if own.get("amenity") == "place_of_worship":
            named.append("church")
        named = [faith or name if name == "church" else name for name in named]
        if found[row] == "church":
            named.append(faith or "church")
        if named:
            found[row] = named[0]
    many = np.isin(use, ["garages", "garage"]) & (area >= LARGE_PARKING)
    many &= buildings["levels"].to_numpy(int) >= 2
    found = np.where(many, "parking", found)
    small = (found == "parking") & (area < LARGE_PARKING)
    return np.where(small, "", found)


def _touching(shapes: NDArray[Any]) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Pairs of different buildings wall to wall, each both ways."""
    a, b = shapely.STRtree(shapes).query(shapes, predicate="dwithin", distance=TOUCH)
    return a[a != b], b[a != b]


def _row_keys(
    layout: Layout, seed: int, touching: tuple[NDArray[np.int64], NDArray[np.int64]]
) -> NDArray[np.uint64]:
    """Key of the draw of each building: its own, or that of its row of houses, (n,).

    Rows reach as far as `ROW_REACH` neighbours, so that a tile needs to know no more.
    """
    shapes = layout.buildings.geometry.to_numpy()
    ids = layout.buildings["id"].to_numpy(np.uint64)
    levels = layout.buildings["levels"].to_numpy(int)
    area = shapely.area(shapes)
    a, b = touching
    # Houses of a row have about the same size and height.
    alike = (np.abs(levels[a] - levels[b]) <= 1) & (area[a] < 1.7 * area[b])
    alike &= area[b] < 1.7 * area[a]
    a, b = a[alike], b[alike]
    joins = uniform(seed, "building/row", ids) < ROW_SHARE
    own = hash_ids(seed, "building/row rank", ids)
    least = own.copy()
    for _ in range(ROW_REACH):
        reached = least.copy()
        np.minimum.at(reached, a, least[b])
        least = reached
    return np.where(joins, least, own)
