"""Finishes of buildings: materials and colours by generator, place and style family.

What the input says wins; the rest is drawn by the hash of the building's id, so that neighbours
differ and nothing depends on order.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.assets.styles.materials import MATERIALS, oklab, srgb_to_linear
from cityx.assets.styles.palette_tables import (
    ACCENTS,
    GROUP_OF,
    GROUPS,
    HALL_AREA,
    HOUSE_AREA,
    OWN_COLORS,
    PAINTED,
    PITCHED,
    REGIONAL,
    ROOF_WORDS,
    SELF_COLORED,
    SHED_AREA,
    STYLES,
    SYNONYMS,
    TRIMS,
    WALL_WORDS,
    Surfaces,
)
from cityx.assets.styles.style_shares import KNOWN, outside_styles
from cityx.errors import UsageError, nearest
from cityx.ids import choose, hash_ids, uniform
from cityx.places.profile import Buildings

if TYPE_CHECKING:
    from cityx.assets.styles.generators import Generator, Look
    from cityx.city.layout import Layout

__all__ = [
    "GROUPS",
    "STYLES",
    "Finishes",
    "building_groups",
    "family_of",
    "finishes_for",
    "groups_of",
    "is_regional",
    "landuse_of",
    "owner_rows",
    "without_material",
]

Words = NDArray[np.str_]
Colors = NDArray[np.float32]


BRIGHTEST = 0.72  # linear; fresh white paint on a wall
WHITEST = 0.85  # linear; what no coat of paint exceeds
DARKEST = 0.02  # linear; black paint
ALIKE = 0.1  # of the distance from black to white, up to which a colour passes for another
PUREST = 0.16  # least share of the weakest channel in the strongest: outdoor paint is no laser


AGING = ("roof_tiles", "slate")
SETTLED = (0.40, 0.85)  # what dust leaves of the lightness of level roofs, from and to
BARE_CONCRETE = 0.7  # the same besides, of concrete that algae grow on
LICHEN, SOOT = (0.12, 0.115, 0.07), (0.075, 0.065, 0.06)  # linear; what grows and settles on them


def _lookup(table: Mapping[str, str]) -> dict[str, str]:
    return {word: material for material, text in table.items() for word in text.split()}


_WALL_OF, _ROOF_OF = _lookup(WALL_WORDS), _lookup(ROOF_WORDS)


@dataclass(frozen=True)
class Finishes:
    """What the parts of a layout are finished with, one entry per row of ``layout.parts``.

    Attributes
    ----------
    wall_material, roof_material
        (n,) str, names in `cityx.assets.styles.materials.MATERIALS`.
    wall_tint, roof_tint
        (n, 3) float32, linear RGB, multiplies the material's base colour.
    trim_tint, frame_tint, accent_tint
        (n, 3) float32, of cornices and sills; of window frames; of doors and shopfronts.
    """

    wall_material: Words
    wall_tint: Colors
    roof_material: Words
    roof_tint: Colors
    trim_tint: Colors
    frame_tint: Colors
    accent_tint: Colors


def family_of(style: str, usual: str = "european") -> str:
    """Return the style family of a style word, or the usual one of the place when it is empty.

    Raises
    ------
    UsageError
        If there is no such style.
    """
    if is_regional(style):
        return usual
    word = style.strip().lower().replace(" ", "_")
    word = SYNONYMS.get(word, word)
    if word not in STYLES:
        hint = nearest(word, [*STYLES, *SYNONYMS, *REGIONAL, *outside_styles()])
        raise UsageError(f'There is no style "{style}". Known: {", ".join(STYLES)}.{hint}')
    return word


def is_regional(style: str) -> bool:
    """Return whether a style word leaves the ways of building to the place."""
    word = style.strip().lower().replace(" ", "_")
    return not word or word in REGIONAL or (word not in KNOWN and word in outside_styles())


def groups_of(layout: Layout, seed: int) -> NDArray[np.int64]:
    """Sort every part by the use of its building: (n,) index into `GROUPS`."""
    parts, buildings = layout.parts, layout.buildings
    owner, described = owner_rows(layout)
    words = parts["use"].to_numpy(str).astype(object)
    levels = parts["levels"].to_numpy(np.int64)
    area = shapely.area(parts.geometry.to_numpy())
    place = np.full(len(parts), "urban", object)
    whole_area = area.copy()
    if len(buildings):
        of_building = buildings["use"].to_numpy(str).astype(object)[owner]
        vague = np.isin(words.astype(str), ["", "yes", "roof", "tower"])
        words = np.where(described & vague, of_building, words)
        place = np.where(described, buildings["place"].to_numpy(str)[owner], place)
        levels = np.where(described, buildings["levels"].to_numpy(np.int64)[owner], levels)
        outline = shapely.area(buildings.geometry.to_numpy())[owner]
        whole_area = np.where(described, outline, area)
    known, index = np.unique(words.astype(str), return_inverse=True)
    group = np.array([GROUP_OF.get(word, -1) for word in known], np.int64)[index]
    use = landuse_of(layout)
    low = place == "low"
    index_of = GROUPS.index
    draw = uniform(seed, "palette/use", parts["building"].to_numpy(np.uint64))
    guess = np.select(
        [
            (whole_area < SHED_AREA) & (levels <= 1),
            (use == "industrial") & (whole_area > 150),
            (use == "retail") & (levels <= 3) & (whole_area > 250),
            (use == "commercial") & (levels >= 2),
            (levels <= 2) & (whole_area > HALL_AREA),
            (levels >= 14) & (draw < 0.5),
            (levels <= 3) & low & (whole_area < HOUSE_AREA),
            (levels <= 2) & (whole_area < 0.6 * HOUSE_AREA),
        ],
        [
            index_of("shed"),
            index_of("industry"),
            index_of("retail"),
            index_of("office"),
            np.where(low, index_of("industry"), index_of("retail")),
            index_of("office"),
            index_of("house"),
            index_of("house"),
        ],
        index_of("flats"),
    )
    group = np.where(group < 0, guess, group)
    # A tall block tagged with the general word for commerce is an office over shops.
    return np.where((group == index_of("retail")) & (levels >= 4), index_of("office"), group)


def building_groups(layout: Layout, seed: int) -> NDArray[np.int64]:
    """Return the use group of every building, that of its first part: (n,) index into `GROUPS`."""
    group = np.full(len(layout.buildings), GROUPS.index("flats"), np.int64)
    owner, described = owner_rows(layout)
    rows = np.flatnonzero(described)[::-1]
    group[owner[rows]] = groups_of(layout, seed)[rows]
    return group


def owner_rows(layout: Layout) -> tuple[NDArray[np.int64], NDArray[np.bool_]]:
    """Row of each part's building in ``layout.buildings``, and whether there is one; (n,) both."""
    ids = layout.buildings["id"].to_numpy(np.uint64)
    asked = layout.parts["building"].to_numpy(np.uint64)
    if not len(ids):
        return np.zeros(len(asked), np.int64), np.zeros(len(asked), bool)
    row = np.minimum(np.searchsorted(ids, asked), len(ids) - 1)
    return row, ids[row] == asked


def landuse_of(layout: Layout) -> Words:
    """Name the land use around every part: "retail", "commercial", "industrial" or ""; (n,)."""
    found = np.full(len(layout.parts), "", "U10")
    kinds = layout.areas["kind"].to_numpy(str)
    rows = np.flatnonzero(np.isin(kinds, ["retail", "commercial", "industrial"]))
    if not len(rows) or not len(found):
        return found
    tree = shapely.STRtree(shapely.point_on_surface(layout.parts.geometry.to_numpy()))
    areas = layout.areas.geometry.to_numpy()[rows]
    area, part = tree.query(areas, predicate="intersects")
    # Where areas overlap the smallest says most about the place.
    order = np.lexsort((rows[area], -shapely.area(areas)[area]))
    found[part[order]] = kinds[rows][area[order]]
    return found


def finishes_for(
    layout: Layout,
    seed: int,
    design: Words,
    generators: Mapping[str, Generator],
    *,
    style: str = "",
    local: Buildings | None = None,
) -> Finishes:
    """Choose materials and colours of every part.

    Parameters
    ----------
    layout
        The layout; colours and materials of its parts win over any choice.
    seed
        Seed of the city.
    design
        (n,) generator of each part, with its zone where it has one: "church", "church/tower".
    generators
        Generators by name.
    style
        Style word asked for, or "" for that of the place.
    local
        Of the profile of the place, None when it is unknown.

    Raises
    ------
    UsageError
        If there is no such style.
    """
    local = local or Buildings()
    family = family_of(style, local.family)
    parts = layout.parts
    ids = parts["building"].to_numpy(np.uint64)
    looks = {key: look for each in generators.values() for key, look in each.looks().items()}
    present, index = np.unique(design, return_inverse=True)

    def flag(name: str) -> NDArray[np.bool_]:
        values = [bool(getattr(looks[key], name)) for key in present.tolist()]
        return np.array(values, bool)[index] if len(design) else np.zeros(0, bool)

    wall, wall_rgb = _draw_by(seed, "wall", ids, *_walls_of(design, looks))
    given = _given(parts["wall_material"].to_numpy(str), _WALL_OF)
    wall, wall_rgb = _with_material(seed, "wall", ids, wall, wall_rgb, given)
    color = parts["wall_color"].to_numpy(np.int64)
    # A colour without a material is paint; reddish ones in brick country are brick.
    said = (color >= 0) & (given == "")
    reddish = ((color >> 16) & 255) > 1.25 * ((color & 255) + 8)
    painted = np.where(reddish & flag("bricks"), "brick", wall)
    wall = np.where(said, np.where(painted == "glass_wall", "plaster", painted), wall)
    wall_rgb = _with_color(wall_rgb, color, bricks=(wall == "brick") & reddish)
    wall_rgb = _as_stated(wall_rgb, color)
    wall = _paintable(wall, wall_rgb, color)

    pitched = PITCHED[family]
    if is_regional(style):
        pitched = local.pitched or pitched
    roof, roof_rgb = _roofs(seed, ids, layout, design, generators, pitched)
    given = _given(parts["roof_material"].to_numpy(str), _ROOF_OF)
    roof, roof_rgb = _with_material(seed, "roof", ids, roof, roof_rgb, given)
    # A colour that is stated of a roof is not that of copper or straw: sheet metal is painted.
    color = parts["roof_color"].to_numpy(np.int64)
    stated = (color >= 0) & (given == "")
    roof = np.where(stated & np.isin(roof, tuple(SELF_COLORED)), "roof_metal", roof)
    roof_rgb = _with_color(roof_rgb, color)
    roof_rgb = _as_stated(_aged(seed, ids, roof, roof_rgb, color >= 0), color)
    roof = _paintable(roof, roof_rgb, color)

    trim = _linear(TRIMS)[_index(seed, "trim", ids, len(TRIMS))]
    # Stone dressings of a plastered front are the wall's own colour, a shade lighter or darker.
    own = flag("own_trim")
    near = uniform(seed, "palette/trim shade", ids)[:, None]
    trim = np.where(own[:, None], wall_rgb * np.where(near < 0.6, 1.18, 0.72), trim)
    frames = {key: looks[key].frames for key in present.tolist()}
    frame = _pick(seed, "frame", ids, design, frames)
    accent = _linear(ACCENTS)[_index(seed, "accent", ids, len(ACCENTS))]
    return Finishes(
        wall,
        _tints(seed, "wall", ids, wall, wall_rgb, parts["wall_color"].to_numpy(np.int64) < 0),
        roof,
        _tints(seed, "roof", ids, roof, roof_rgb, color < 0),
        _over_base(trim, np.full(len(ids), "trim")),
        _over_base(frame, np.full(len(ids), "frame_paint")),
        _over_base(accent, np.full(len(ids), "door_paint")),
    )


def _walls_of(design: Words, looks: Mapping[str, Look]) -> tuple[Words, dict[str, Surfaces]]:
    """Key of the draw of each part's walls, and the surfaces of each key.

    Zones of the same surfaces as the main look share its draw: a tower is built of one stone.
    """
    known, index = np.unique(design, return_inverse=True)
    keys = []
    for key in known.tolist():
        main = key.partition("/")[0]
        keys.append(main if looks[key].walls == looks[main].walls else key)
    words = np.array(keys, design.dtype)[index] if len(design) else design
    return words, {key: looks[key].walls for key in keys}


def _draw_by(
    seed: int, purpose: str, ids: NDArray[np.uint64], keys: Words, table: Mapping[str, Surfaces]
) -> tuple[Words, NDArray[np.float64]]:
    """Draw material and colour (linear) from the rows of `table` that each id's key names."""
    material = np.full(len(ids), "plaster", "U16")
    rgb = np.ones((len(ids), 3))
    for key in np.unique(keys).tolist():
        of = np.flatnonzero(keys == key)
        material[of], rgb[of] = _draw(seed, f"{purpose}/{key}", ids[of], table[key])
    return material, rgb


def _draw(
    seed: int, purpose: str, ids: NDArray[np.uint64], rows: Surfaces
) -> tuple[Words, NDArray[np.float64]]:
    drawn = choose(seed, f"palette/{purpose}", ids, [row[0] for row in rows])
    material = np.array([row[1] for row in rows], "U16")[drawn]
    rgb = np.ones((len(ids), 3))
    for number, row in enumerate(rows):
        of = np.flatnonzero(drawn == number)
        rgb[of] = _linear(row[2])[_index(seed, f"{purpose} color", ids[of], len(row[2]))]
    return material, rgb


def _roofs(
    seed: int,
    ids: NDArray[np.uint64],
    layout: Layout,
    design: Words,
    generators: Mapping[str, Generator],
    pitched: Surfaces,
) -> tuple[Words, NDArray[np.float64]]:
    flat = layout.parts["roof_shape"].to_numpy(str) == "flat"
    material = np.full(len(ids), "bitumen", "U16")
    rgb = np.ones((len(ids), 3))
    for key in np.unique(design).tolist():
        kind = generators[key.partition("/")[0]]
        rows = design == key
        for purpose, of, surfaces in (
            ("roof", np.flatnonzero(rows & ~flat), kind.pitched or pitched),
            ("flat roof", np.flatnonzero(rows & flat), kind.flat),
        ):
            if len(of):
                material[of], rgb[of] = _draw(seed, purpose, ids[of], surfaces)
    # Rain leaves its dust on level roofs: few are as pale as they were laid.
    low, high = SETTLED
    dust = low + (high - low) * uniform(seed, "palette/roof dust", ids[flat])
    dust = np.where(material[flat] == "concrete", BARE_CONCRETE * dust, dust)
    rgb[flat] *= np.where(material[flat] == "grass", 1.0, dust)[:, None]
    return material, rgb


def _given(words: Words, table: Mapping[str, str]) -> Words:
    """Translate material words of the input; "" where nothing usable is said."""
    known, index = np.unique(words, return_inverse=True)
    found = [_first_known(word, table) for word in known.tolist()]
    return np.array(found or [""], "U16")[index] if len(words) else np.zeros(0, "U16")


def _first_known(text: str, table: Mapping[str, str]) -> str:
    """Return the material of a word, of several as "brick;wood" that of the first known one."""
    words = [word.strip().replace(" ", "_") for word in text.lower().split(";")]
    return next((table[word] for word in words if word in table), "")


def without_material(layout: Layout) -> NDArray[np.bool_]:
    """(n,) whether the input names a material of a part that nothing here is known of."""
    found = np.zeros(len(layout.parts), bool)
    for column, table in (("wall_material", _WALL_OF), ("roof_material", _ROOF_OF)):
        words = layout.parts[column].to_numpy(str)
        found |= (words != "") & (_given(words, table) == "")
    return found


def _with_material(
    seed: int,
    purpose: str,
    ids: NDArray[np.uint64],
    material: Words,
    rgb: NDArray[np.float64],
    given: Words,
) -> tuple[Words, NDArray[np.float64]]:
    rgb = rgb.copy()
    for name in np.unique(given).tolist():
        of = np.flatnonzero((given == name) & (material != name))
        if name and len(of):
            colors = _linear(OWN_COLORS[name])
            rgb[of] = colors[_index(seed, f"{purpose} of {name}", ids[of], len(colors))]
    return np.where(given == "", material, given), rgb


def _with_color(
    rgb: NDArray[np.float64], color: NDArray[np.int64], *, bricks: NDArray[np.bool_] | None = None
) -> NDArray[np.float64]:
    """Use the colours the input gives; unpainted bricks keep half of their own."""
    if not len(color):
        return rgb
    known, index = np.unique(color, return_inverse=True)
    given = _weathered(_linear([max(value, 0) for value in known.tolist()]))[index]
    if bricks is not None:
        given = np.where(bricks[:, None], np.sqrt(given * rgb), given)
    return np.asarray(np.where((color >= 0)[:, None], given, rgb))


def _as_stated(rgb: NDArray[np.float64], color: NDArray[np.int64]) -> NDArray[np.float64]:
    """Return colours, purer ones where weather has taken those that are stated too far off."""
    if not len(color):
        return rgb
    stated = _stated(color)
    far = (color >= 0) & _apart(rgb, stated)
    return np.where(far[:, None], np.clip(stated, DARKEST, BRIGHTEST), rgb)


def _paintable(material: Words, rgb: NDArray[np.float64], color: NDArray[np.int64]) -> Words:
    """Give what is of a stated colour that its material cannot show the painted form of it."""
    rows = np.flatnonzero((color >= 0) & np.isin(material, tuple(PAINTED)))
    if not len(rows):
        return material
    base = np.array([MATERIALS[name].color for name in material[rows].tolist()])
    seen = base * _over_base(rgb[rows], material[rows])
    beyond = rows[_apart(seen, _stated(color[rows]))]
    painted = material.copy()
    painted[beyond] = [PAINTED[name] for name in material[beyond].tolist()]
    return painted


def _stated(color: NDArray[np.int64]) -> NDArray[np.float64]:
    """Return colours as they are stated, those of no paint as near as paint comes, (n, 3)."""
    return np.clip(_linear(np.maximum(color, 0).tolist()), DARKEST, WHITEST)


def _apart(one: NDArray[np.float64], other: NDArray[np.float64]) -> NDArray[np.bool_]:
    """(n,) whether one sees that colours are not the same."""
    return np.asarray(np.linalg.norm(oklab(one) - oklab(other), axis=1) > ALIKE)


def _aged(
    seed: int, ids: NDArray[np.uint64], roof: Words, rgb: NDArray[np.float64],
    said: NDArray[np.bool_],
) -> NDArray[np.float64]:  # fmt: skip
    """Let soot and lichen dull the tiles and slates of old roofs; newly laid ones keep their tone.

    Roofs whose colour is `said` age a fifth as much: else what is red looks brown.
    """
    age = (0.1 + 0.9 * uniform(seed, "palette/roof age", ids)) * np.where(said, 0.2, 1.0)
    age = np.where(np.isin(roof, AGING), age, 0.0)[:, None]
    grown = uniform(seed, "palette/roof lichen", ids)[:, None]
    coat = grown * np.array(LICHEN) + (1 - grown) * np.array(SOOT)
    return np.asarray(rgb * (1 - 0.62 * age) + 0.5 * age * coat)


def _weathered(rgb: NDArray[np.float64]) -> NDArray[np.float64]:
    """Bring screen colours such as "red" into the range of paint and stone in daylight."""
    peak = np.minimum(rgb.max(axis=1, keepdims=True), BRIGHTEST)
    scaled = rgb * peak / np.maximum(rgb.max(axis=1, keepdims=True), 1e-6)
    grey = scaled.mean(axis=1, keepdims=True)
    floor = np.maximum(PUREST * peak, DARKEST)
    # Mix with grey just enough that the weakest channel reaches the floor.
    low = scaled.min(axis=1, keepdims=True)
    share = np.clip((floor - low) / np.maximum(grey - low, 1e-6), 0.0, 0.5)
    return np.asarray(np.maximum(scaled + share * (grey - scaled), DARKEST))


def _pick(
    seed: int,
    purpose: str,
    ids: NDArray[np.uint64],
    keys: Words,
    table: Mapping[str, tuple[int, ...]],
) -> NDArray[np.float64]:
    rgb = np.ones((len(ids), 3))
    for key in np.unique(keys).tolist():
        of = np.flatnonzero(keys == key)
        colors = _linear(table[key])
        rgb[of] = colors[_index(seed, f"{purpose}/{key}", ids[of], len(colors))]
    return rgb


def _index(seed: int, purpose: str, ids: NDArray[np.uint64], count: int) -> NDArray[np.int64]:
    draws = hash_ids(seed, f"palette/{purpose}", ids) >> np.uint64(11)
    return (draws % np.uint64(count)).astype(np.int64)


def _linear(colors: Sequence[int]) -> NDArray[np.float64]:
    return np.array([srgb_to_linear(int(color)) for color in colors]).reshape(-1, 3)


def _tints(
    seed: int,
    purpose: str,
    ids: NDArray[np.uint64],
    material: Words,
    rgb: NDArray[np.float64],
    chosen: NDArray[np.bool_],
) -> Colors:
    """Divide by the base colour and vary each building a little; given colours stay as they are."""
    # Coats of paint age and gather soot: most walls are below the value of the table.
    light = 1 + 0.32 * (uniform(seed, f"palette/{purpose} light", ids) - 0.6)
    warm = 0.10 * (uniform(seed, f"palette/{purpose} warm", ids) - 0.5)
    jitter = light[:, None] * (1 + warm[:, None] * np.array([1.0, 0.1, -1.0]))
    return _over_base(rgb * np.where(chosen[:, None], jitter, 1.0), material)


def _over_base(rgb: NDArray[np.float64], material: Words) -> Colors:
    names, index = np.unique(material, return_inverse=True)
    base = np.array(
        [(1.0, 1.0, 1.0) if n in SELF_COLORED else MATERIALS[n].color for n in names.tolist()]
    ).reshape(-1, 3)
    if not len(names):
        return np.zeros((0, 3), np.float32)
    return np.asarray(np.clip(rgb / base[index], 0.0, 1.0), np.float32)
