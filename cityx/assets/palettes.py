"""Finishes of buildings: materials and colours by use, place and style family.

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

from cityx.assets.materials import MATERIALS, srgb_to_linear
from cityx.assets.palette_tables import (
    ACCENTS,
    ALWAYS,
    FACADES,
    FAMILIES,
    FLAT,
    FRAMES,
    GROUP_OF,
    GROUPS,
    HALL_AREA,
    HALL_ROOF,
    HOUSE_AREA,
    OWN_COLORS,
    PITCHED,
    PLAIN_FRAMES,
    REGIONS,
    ROOF_WORDS,
    SELF_COLORED,
    SHED_AREA,
    STYLES,
    SYNONYMS,
    TRIMS,
    WALL_WORDS,
    WALLS,
    Surfaces,
)
from cityx.errors import UsageError, nearest
from cityx.geometry.identity import choose, hash_ids, uniform

if TYPE_CHECKING:
    from cityx.city.layout import Layout

__all__ = [
    "FACADES",
    "GROUPS",
    "REGIONS",
    "STYLES",
    "Finishes",
    "family_of",
    "finishes_for",
    "groups_of",
    "landuse_of",
    "owner_rows",
    "region_of",
]

Words = NDArray[np.str_]
Colors = NDArray[np.float32]


BRIGHTEST = 0.72  # linear; fresh white paint on a wall
DARKEST = 0.02  # linear; black paint
PUREST = 0.16  # least share of the weakest channel in the strongest: outdoor paint is no laser


def _lookup(table: Mapping[str, str]) -> dict[str, str]:
    return {word: material for material, text in table.items() for word in text.split()}


_WALL_OF, _ROOF_OF = _lookup(WALL_WORDS), _lookup(ROOF_WORDS)


@dataclass(frozen=True)
class Finishes:
    """What the parts of a layout are finished with, one entry per row of ``layout.parts``.

    Attributes
    ----------
    wall_material, roof_material
        (n,) str, names in `cityx.assets.materials.MATERIALS`.
    wall_tint, roof_tint
        (n, 3) float32, linear RGB, multiplies the material's base colour.
    trim_tint, frame_tint, accent_tint
        (n, 3) float32, of cornices and sills; of window frames; of doors and shopfronts.
    facade
        (n,) str, facade style, one of `FACADES`.
    """

    wall_material: Words
    wall_tint: Colors
    roof_material: Words
    roof_tint: Colors
    trim_tint: Colors
    frame_tint: Colors
    accent_tint: Colors
    facade: Words


def region_of(latitude: float, longitude: float) -> str:
    """Name the building region of a place (WGS84 degrees), a key of `REGIONS`."""
    boxes = (  # south, west, north, east; the first that holds the place wins
        ("british isles", 49.8, -11.0, 61.0, 1.8),
        ("mediterranean", 28.0, -19.0, 43.8, 48.0),
        ("mediterranean", 43.8, 6.8, 46.0, 14.0),
        ("northern/central europe", 43.8, -6.0, 72.0, 66.0),
        ("north america", 24.0, -170.0, 72.0, -52.0),
        ("east asia", 20.0, 98.0, 54.0, 150.0),
        ("south-east asia", -11.0, 92.0, 20.0, 142.0),
        ("oceania", -48.0, 110.0, -11.0, 180.0),
    )
    for name, south, west, north, east in boxes:
        if south <= latitude <= north and west <= longitude <= east:
            return name
    return "other"


def family_of(style: str, region: str = "") -> str:
    """Return the style family of a style word, or the region's own when the word is empty.

    Raises
    ------
    UsageError
        If there is no such style.
    """
    word = style.strip().lower().replace(" ", "_")
    if not word:
        return REGIONS.get(region, "european")
    word = SYNONYMS.get(word, word)
    if word not in STYLES:
        hint = nearest(word, [*STYLES, *SYNONYMS])
        raise UsageError(f'There is no style "{style}". Known: {", ".join(STYLES)}.{hint}')
    return word


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


def finishes_for(layout: Layout, seed: int, style: str = "", *, region: str = "") -> Finishes:
    """Choose facade style, materials and colours of every part.

    Parameters
    ----------
    layout
        The layout; colours and materials of its parts win over any choice.
    seed
        Seed of the city.
    style
        One of `STYLES`, or "" for the region's own.
    region
        One of `REGIONS` (see `region_of`), or "" when the place is unknown.

    Raises
    ------
    UsageError
        If there is no such style.
    """
    family = family_of(style, region)
    parts = layout.parts
    ids = parts["building"].to_numpy(np.uint64)
    group = groups_of(layout, seed)
    facade = _facades(seed, ids, group, family, layout)
    wall, wall_rgb = _draw_by(seed, "wall", ids, facade, WALLS)
    given = _given(parts["wall_material"].to_numpy(str), _WALL_OF)
    wall, wall_rgb = _with_material(seed, "wall", ids, wall, wall_rgb, given)
    color = parts["wall_color"].to_numpy(np.int64)
    # A colour without a material is paint; reddish ones in brick country are brick.
    said = (color >= 0) & (given == "")
    reddish = ((color >> 16) & 255) > 1.25 * ((color & 255) + 8)
    painted = np.where(reddish & np.isin(facade, ["georgian", "walkup", "cottage"]), "brick", wall)
    wall = np.where(said, np.where(painted == "glass_wall", "plaster", painted), wall)
    wall_rgb = _with_color(wall_rgb, color, bricks=wall == "brick")
    glazed = (wall == "glass_wall") & (given == "glass_wall") & (group != GROUPS.index("shed"))
    facade = np.where(glazed, "curtain", facade)
    facade = np.where((facade == "curtain") & (wall != "glass_wall"), "office", facade)

    roof, roof_rgb = _roofs(seed, ids, layout, group, family)
    given = _given(parts["roof_material"].to_numpy(str), _ROOF_OF)
    roof, roof_rgb = _with_material(seed, "roof", ids, roof, roof_rgb, given)
    roof_rgb = _with_color(roof_rgb, parts["roof_color"].to_numpy(np.int64))

    trim = _linear(TRIMS)[_index(seed, "trim", ids, len(TRIMS))]
    # Stone dressings of a plastered front are the wall's own colour, a shade lighter or darker.
    own = np.isin(facade, ["plain", "mediterranean", "slab", "modern", "asian", "house"])
    near = uniform(seed, "palette/trim shade", ids)[:, None]
    trim = np.where(own[:, None], wall_rgb * np.where(near < 0.6, 1.18, 0.72), trim)
    frame = _pick(seed, "frame", ids, facade, FRAMES, PLAIN_FRAMES)
    accent = _linear(ACCENTS)[_index(seed, "accent", ids, len(ACCENTS))]
    return Finishes(
        wall,
        _tints(seed, "wall", ids, wall, wall_rgb, parts["wall_color"].to_numpy(np.int64) < 0),
        roof,
        _tints(seed, "roof", ids, roof, roof_rgb, parts["roof_color"].to_numpy(np.int64) < 0),
        _over_base(trim, np.full(len(ids), "trim")),
        _over_base(frame, np.full(len(ids), "frame_paint")),
        _over_base(accent, np.full(len(ids), "door_paint")),
        facade,
    )


def _facades(
    seed: int, ids: NDArray[np.uint64], group: NDArray[np.int64], family: str, layout: Layout
) -> Words:
    facade = np.full(len(ids), "plain", "U16")
    table = {**FAMILIES[family], **ALWAYS}
    for row, name in enumerate(GROUPS):
        of = np.flatnonzero(group == row)
        choice = table[name]
        drawn = choose(seed, f"palette/facade/{name}", ids[of], list(choice.values()))
        facade[of] = np.array(list(choice), "U16")[drawn]
    # Towers of the core are glass and grid, not plaster with cornices.
    owner, described = owner_rows(layout)
    levels = layout.parts["levels"].to_numpy(np.int64)
    if len(layout.buildings):
        whole = layout.buildings["levels"].to_numpy(np.int64)[owner]
        levels = np.where(described, whole, levels)
    tall = (levels >= 10) & np.isin(facade, ["classic", "plain", "georgian", "mediterranean"])
    towers = np.array(["slab", "office", "modern", "curtain"], "U16")
    facade[tall] = towers[choose(seed, "palette/tower", ids[tall], [3, 3, 3, 2])]
    low = (levels <= 2) & np.isin(facade, ["curtain", "office"])
    facade[low] = "modern"
    return facade


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
    seed: int, ids: NDArray[np.uint64], layout: Layout, group: NDArray[np.int64], family: str
) -> tuple[Words, NDArray[np.float64]]:
    flat = layout.parts["roof_shape"].to_numpy(str) == "flat"
    material, rgb = _draw(seed, "roof", ids, PITCHED[family])
    level = _draw(seed, "flat roof", ids, FLAT)
    material, rgb = np.where(flat, level[0], material), np.where(flat[:, None], level[1], rgb)
    hall = group == GROUPS.index("industry")
    wide = _draw(seed, "hall roof", ids, HALL_ROOF)
    return np.where(hall, wide[0], material), np.where(hall[:, None], wide[1], rgb)


def _given(words: Words, table: Mapping[str, str]) -> Words:
    """Translate material words of the input; "" where nothing usable is said."""
    known, index = np.unique(words, return_inverse=True)
    found = [table.get(word.strip().lower().replace(" ", "_"), "") for word in known.tolist()]
    return np.array(found or [""], "U16")[index] if len(words) else np.zeros(0, "U16")


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
    rgb: NDArray[np.float64],
    color: NDArray[np.int64],
    *,
    bricks: NDArray[np.bool_] | None = None,
) -> NDArray[np.float64]:
    """Use the colours the input gives; bricks keep half of their own."""
    if not len(color):
        return rgb
    known, index = np.unique(color, return_inverse=True)
    given = _weathered(_linear([max(value, 0) for value in known.tolist()]))[index]
    if bricks is not None:
        given = np.where(bricks[:, None], np.sqrt(given * rgb), given)
    return np.asarray(np.where((color >= 0)[:, None], given, rgb))


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
    default: tuple[int, ...],
) -> NDArray[np.float64]:
    rgb = np.ones((len(ids), 3))
    for key in np.unique(keys).tolist():
        of = np.flatnonzero(keys == key)
        colors = _linear(table.get(key, default))
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
    light = 1 + 0.16 * (uniform(seed, f"palette/{purpose} light", ids) - 0.5)
    warm = 0.06 * (uniform(seed, f"palette/{purpose} warm", ids) - 0.5)
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
