"""Designing: change rows of the layout as a wish says, and rebuild the buildings by them."""

from __future__ import annotations

import json
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from cityx.assets.styles.materials import MATERIALS, srgb_to_linear
from cityx.assets.styles.palettes import GROUPS, building_groups, owner_rows
from cityx.building.bays import stepped
from cityx.building.catalogue import generator_named, generators
from cityx.building.design import grown_by, with_drawn_roofs
from cityx.building.mesh_designs import with_meshes
from cityx.building.mesh_volumes import ORDER
from cityx.building.selection import admitted, choose_generators
from cityx.building.splicing import SHELLS
from cityx.city.bounds import unbound
from cityx.city.city import City
from cityx.city.layout import Layout, joined_tables
from cityx.city.levels import ground_levels
from cityx.edit.buildings.rebuilding import Ids, buildings_of, rebuilt
from cityx.errors import ActionFailed
from cityx.geometry.arrays import FloatArray, IntArray
from cityx.ids import choose, hash_ids, id_text
from cityx.places.profiles import profile_of

if TYPE_CHECKING:
    from geopandas import GeoDataFrame


PAINT, FELT = "plaster", "bitumen"  # what walls and level roofs are of that have any colour
LOOKS = ("roof:", "building:material", "building:colour", "building:color")  # tags of a look
BOARDS = ("wood", "timber", "weatherboard")
LOWEST, HIGHEST = 2.2, 1000.0  # metres of a building
CLOSE = 0.005  # of a height, by which what is built may miss what is asked
TRIES = 3  # designs until a height is met; parapets and crowns come on top of what is designed
PITCH = 0.7  # rise over half the width of a roof that gets a slope by a wish: 35 degrees
STEEPEST = 0.5  # of a building's height that such a roof may take


@dataclass(frozen=True)
class Wish:
    """What becomes of k buildings; what is None stays.

    Attributes
    ----------
    height
        (k,) metres from the ground to the top.
    floors
        (k,) storeys.
    generator
        Name of the generator of all.
    style
        Style word: each gets a generator of that style.
    material
        Material of the walls, as a map names it: "brick".
    color
        Colour of the walls, sRGB 0xRRGGBB.
    roof
        Shape of the roofs, as a map names it: "gabled".
    roof_material, roof_color
        Covering of the roofs.
    """

    height: FloatArray | None = None
    floors: IntArray | None = None
    generator: str | None = None
    style: str | None = None
    material: str | None = None
    color: int | None = None
    roof: str | None = None
    roof_material: str | None = None
    roof_color: int | None = None

    @property
    def replaces_look(self) -> bool:
        """Whether buildings become others, of materials and under roofs of their own."""
        return self.generator is not None or self.style is not None

    @property
    def changes_form(self) -> bool:
        """Return whether volumes have to be grown again."""
        form = (self.height, self.floors, self.generator, self.style, self.roof)
        return any(value is not None for value in form)


def redesigned(city: City, ids: Ids, wish: Wish) -> City:
    """Return the city with buildings as they are wished for; all others stay byte for byte.

    Parameters
    ----------
    city
        The city.
    ids
        (k,) uint64 of buildings, ascending.
    wish
        What becomes of them.

    Raises
    ------
    ActionFailed
        If a generator or a height makes no sense for one of them.
    """
    if wish.height is None:
        return _built(city, ids, wish)
    if ((wish.height < LOWEST) | (wish.height > HIGHEST)).any():
        worst = wish.height[np.argmax(np.abs(np.log(np.maximum(wish.height, 1e-3) / 20.0)))]
        raise ActionFailed(
            f"A building of {worst:.1f} m is not built; {LOWEST:g} to {HIGHEST:g} m are."
        )
    above = heights_of(city, ids) - _designed_heights(city, ids)
    asked = wish.height - above
    for _ in range(TRIES):
        made = _built(city, ids, replace(wish, height=np.maximum(asked, LOWEST)))
        off = heights_of(made, ids) - wish.height
        if (np.abs(off) <= CLOSE * wish.height).all():
            break
        asked = asked - off
    return made


def heights_of(city: City, ids: Ids) -> FloatArray:
    """(k,) metres from the ground to the top of what is built, as designed where nothing is."""
    height = _designed_heights(city, ids)
    batch = city.scene.meshes.get(SHELLS)
    if batch is None or not batch.count:
        return height
    small = buildings_of(city.layout, ids)
    level = np.full(len(ids), -np.inf)
    owner, _ = owner_rows(small)
    np.maximum.at(level, owner, ground_levels(small, city.terrain))
    row = np.minimum(np.searchsorted(batch.object_id, ids), batch.count - 1)
    for place in np.flatnonzero(batch.object_id[row] == ids).tolist():
        own = slice(*batch.vertex_start[row[place] : row[place] + 2].tolist())
        height[place] = batch.vertices[own, 2].max() - level[place]
    return height


def levels_of(city: City, ids: Ids) -> IntArray:
    """(k,) storeys of buildings."""
    return _column(city.layout, ids, "levels").astype(np.int64)


def _designed_heights(city: City, ids: Ids) -> FloatArray:
    return _column(city.layout, ids, "height").astype(float)


def _column(layout: Layout, ids: Ids, name: str) -> NDArray[Any]:
    row = np.searchsorted(layout.buildings["id"].to_numpy(np.uint64), ids)
    return np.asarray(layout.buildings[name].to_numpy()[row])


def _built(city: City, ids: Ids, wish: Wish) -> City:
    layout = buildings_of(city.layout, ids)
    layout = _finished(layout, wish)
    if wish.changes_form:
        layout = _formed(city, layout, wish)
    return rebuilt(replace(city, layout=_merged(city.layout, layout, ids)), ids)


def _merged(whole: Layout, small: Layout, ids: Ids) -> Layout:
    """Put the rows of some buildings in the place of those a layout has for them."""
    kept = ~np.isin(whole.parts["building"].to_numpy(np.uint64), ids)
    others = whole.parts.iloc[np.flatnonzero(kept)]
    return replace(
        whole,
        buildings=joined_tables(whole.buildings, small.buildings),
        parts=joined_tables(others, small.parts),
    )


def _finished(layout: Layout, wish: Wish) -> Layout:
    """Set the material of walls and roof of every part."""
    parts = layout.parts
    if wish.replaces_look:
        parts = parts.assign(wall_material="", wall_color=np.int32(-1))
        parts = parts.assign(roof_material="", roof_color=np.int32(-1))
    said = {
        "wall_material": wish.material, "roof_material": wish.roof_material,
        "wall_color": wish.color, "roof_color": wish.roof_color,
    }  # fmt: skip
    given: dict[str, Any] = {key: value for key, value in said.items() if value is not None}
    if wish.material is not None and wish.color is None:
        given["wall_color"] = -1  # brick is of the colour of bricks
    if wish.color is not None and wish.material is None:
        given["wall_material"] = _painted(parts["wall_material"].to_numpy(str), wish.color)
    if wish.roof_color is not None and wish.roof_material is None:
        level = parts["roof_shape"].to_numpy(str) == "flat"
        said = parts["roof_material"].to_numpy(str)
        given["roof_material"] = np.where(level, FELT, said).astype(object)
    return replace(layout, parts=_typed(parts.assign(**given), parts))


def _painted(material: NDArray[np.str_], color: int) -> NDArray[np.object_]:
    """Return what painted walls are of, (n,): boards stay boards, all else is rendered.

    Paint on boards can be no lighter than the boards of the material.
    """
    boards = np.isin(material, BOARDS) & all(
        value <= limit
        for value, limit in zip(srgb_to_linear(color), MATERIALS["wood"].color, strict=True)
    )
    return np.where(boards, material, PAINT).astype(object)


def _typed(table: GeoDataFrame, like: GeoDataFrame) -> GeoDataFrame:
    return table.astype({key: like[key].dtype for key in ("wall_color", "roof_color")})


# -- form ------------------------------------------------------------------------------------------


def _formed(city: City, layout: Layout, wish: Wish) -> Layout:
    """Give buildings heights, storeys, roofs and generators, and grow their volumes."""
    old = layout.buildings
    wanted = _grown(layout) | wish.replaces_look
    sized = _sized(old, wish)
    mapped = _stretched(layout, sized, wish, ~wanted)
    if not wanted.any():
        return mapped
    rows = np.flatnonzero(wanted)
    named = _named(city, replace(mapped, buildings=sized), wish, rows)
    plain, part_rows = _plain(replace(mapped, buildings=named), layout, rows)
    only = np.full(len(named), -1, np.int64)
    only[rows] = part_rows
    drawn = with_drawn_roofs(plain, only, city.seed)
    chosen = [generator_named(name) for name in named["generator"].to_numpy(str)[rows]]
    drawn, cut = stepped(drawn, city.terrain, only)
    massive = np.array([bool(kind.mass) for kind in chosen]) & ~cut[rows]
    roads = replace(drawn, roads=city.layout.roads)
    grown, _ = grown_by(roads, rows[massive], city.seed, free=wish.replaces_look)
    outside = rows[np.array([kind.outside is not None for kind in chosen])]
    if wish.roof is None and len(outside):
        grown, lost = with_meshes(grown, outside, city.seed)
        if lost:
            raise ActionFailed(f"{id_text(lost[0].object_id)}: {lost[0].error}.")
    if wish.roof is not None:
        grown = _with_roof(grown, drawn, wish.roof)
    return replace(grown, roads=layout.roads)


def _with_roof(grown: Layout, plain: Layout, shape: str) -> Layout:
    """Leave buildings the plain volume that bears a roof where what was grown does not."""
    without = [
        building
        for building in grown.buildings["id"].tolist()
        if grown.parts["roof_shape"].iloc[_highest(grown, building)] != shape
    ]
    if not without:
        return grown
    ids = np.array(without, np.uint64)
    return _merged(grown, buildings_of(plain, ids), ids)


def _sized(buildings: GeoDataFrame, wish: Wish) -> GeoDataFrame:
    """Set heights and storeys in the rows and tags of buildings; either follows the other."""
    height = buildings["height"].to_numpy(float).copy()
    levels = buildings["levels"].to_numpy(np.int64).copy()
    storey = height / np.maximum(levels, 1)
    if wish.generator is not None:
        storey = np.full(len(levels), generators()[wish.generator].storey)
    tags = [json.loads(text or "{}") for text in buildings["tags"].to_numpy(str).tolist()]
    if wish.floors is not None:
        levels = np.maximum(wish.floors, 1)
        height = height if wish.height is not None else storey * levels
    if wish.height is not None:
        height = wish.height
        if wish.floors is None:
            levels = np.maximum(np.round(height / storey), 1).astype(np.int64)
    for row, own in enumerate(tags):
        if wish.replaces_look:
            tags[row] = own = {key: own[key] for key in own if not key.startswith(LOOKS)}
        if wish.floors is not None or wish.height is not None:
            own["building:levels"] = str(int(levels[row]))
            own.pop("height", None)
            tags[row] = own = unbound(own, "height", "levels")
        if wish.floors is not None or wish.replaces_look:
            own.pop(ORDER, None)  # what a mesh was made for is no more asked
        if wish.height is not None:
            own["height"] = f"{height[row]:.3f}"
        if wish.roof is not None:
            own["roof:shape"] = wish.roof
    return buildings.assign(
        height=height,
        levels=levels.astype(buildings["levels"].dtype),
        tags=[json.dumps(own, sort_keys=True) for own in tags],
    )


def _grown(layout: Layout) -> NDArray[np.bool_]:
    """(k,) whether a generator grew the volumes of a building, so that it may do so again.

    Those that a map describes have ids of their own; of the others the first gives ids to all.
    """
    ids = layout.buildings["id"].to_numpy(np.uint64)
    return np.array([_first_part(layout, one) is not None for one in ids.tolist()], bool)


def _first_part(layout: Layout, building: int) -> int | None:
    """Return the row of the part that a building was grown from, None where it has several."""
    rows = np.flatnonzero(layout.parts["building"].to_numpy(np.uint64) == np.uint64(building))
    own = layout.parts["id"].to_numpy(np.uint64)[rows]
    number = np.arange(1, len(rows), dtype=np.uint64)
    for row, first in zip(rows.tolist(), own, strict=True):
        if np.isin(hash_ids(0, "building/mass", first, number), own).all():
            return int(row)
    return None


def _plain(layout: Layout, old: Layout, rows: IntArray) -> tuple[Layout, IntArray]:
    """Give buildings one plain part each; returns the layout and the rows of those parts."""
    import pandas as pd

    buildings = layout.buildings
    ids = buildings["id"].to_numpy(np.uint64)
    owner = layout.parts["building"].to_numpy(np.uint64)
    first = [_first_part(old, one) for one in ids[rows].tolist()]
    found = [
        int(np.flatnonzero(owner == ids[row])[0]) if at is None else at
        for row, at in zip(rows.tolist(), first, strict=True)
    ]
    highest = [_highest(layout, building) for building in ids[rows].tolist()]
    fresh = layout.parts.iloc[found].copy()
    fresh["base"] = 0.0
    fresh["top"] = buildings["height"].to_numpy(float)[rows]
    fresh["levels"] = buildings["levels"].to_numpy()[rows]
    fresh["zone"] = ""
    fresh["walls"] = True
    for name in ("roof_shape", "roof_direction", "roof_across"):
        fresh[name] = layout.parts[name].to_numpy()[highest]
    rise = layout.parts["roof_height"].to_numpy(float)[highest]
    fresh["roof_height"] = np.minimum(rise, STEEPEST * fresh["top"].to_numpy(float))
    fresh = fresh.set_geometry(buildings.geometry.to_numpy()[rows])
    fresh = _roofed(fresh, buildings["tags"].to_numpy(str)[rows])
    rest = layout.parts.iloc[np.flatnonzero(~np.isin(owner, ids[rows]))]
    joined = pd.concat([rest, fresh], ignore_index=True)
    parts = joined.sort_values("id", kind="stable", ignore_index=True)
    at = np.searchsorted(parts["id"].to_numpy(np.uint64), fresh["id"].to_numpy(np.uint64))
    return replace(layout, parts=parts), at


def _highest(layout: Layout, building: int) -> int:
    rows = np.flatnonzero(layout.parts["building"].to_numpy(np.uint64) == np.uint64(building))
    return int(rows[np.argmax(layout.parts["top"].to_numpy(float)[rows])])


def _roofed(parts: GeoDataFrame, tags: NDArray[np.str_]) -> GeoDataFrame:
    """Draw the roofs that tags name over plain parts that have another."""
    said = [str(json.loads(text).get("roof:shape", "")) for text in tags.tolist()]
    shape = parts["roof_shape"].to_numpy(str).astype(object)
    rise = parts["roof_height"].to_numpy(float).copy()
    width = _widths(parts)
    for row, word in enumerate(said):
        if word and word != shape[row]:
            shape[row] = word
            limit = STEEPEST * float(parts["top"].iloc[row])
            rise[row] = 0.0 if word == "flat" else min(PITCH * width[row] / 2, limit)
    return parts.assign(roof_shape=shape.astype(str), roof_height=rise)


def _widths(parts: GeoDataFrame) -> FloatArray:
    from cityx.building.selection import widths_of

    return widths_of(parts.geometry.to_numpy())


def _stretched(layout: Layout, sized: GeoDataFrame, wish: Wish, rows: NDArray[np.bool_]) -> Layout:
    """Stretch the volumes that a map describes to new heights, and shape their highest roofs."""
    ids = layout.buildings["id"].to_numpy(np.uint64)
    parts = layout.parts
    of = np.searchsorted(ids, parts["building"].to_numpy(np.uint64))
    mine = rows[of]
    factor = (sized["height"] / layout.buildings["height"]).to_numpy(float)[of]
    more = (sized["levels"] / np.maximum(layout.buildings["levels"], 1)).to_numpy(float)[of]
    stretched = {
        name: np.where(mine, parts[name].to_numpy(float) * factor, parts[name].to_numpy(float))
        for name in ("base", "top", "roof_height")
    }
    levels = np.maximum(np.round(parts["levels"].to_numpy(float) * more), 1)
    stretched["levels"] = np.where(mine, levels, parts["levels"]).astype(parts["levels"].dtype)
    parts = parts.assign(**stretched)
    if wish.roof is not None:
        shape = parts["roof_shape"].to_numpy(object).copy()
        for building in ids[rows].tolist():
            shape[_highest(replace(layout, parts=parts), building)] = wish.roof
        parts = parts.assign(roof_shape=shape.astype(str))
    buildings = layout.buildings
    kept = buildings.assign(**{
        name: np.where(rows, sized[name], buildings[name]) for name in ("height", "tags")
    })  # fmt: skip
    levels = np.where(rows, sized["levels"], buildings["levels"])
    kept = kept.assign(levels=levels.astype(buildings["levels"].dtype))
    return replace(layout, parts=parts, buildings=kept.astype({"tags": buildings["tags"].dtype}))


def _named(city: City, layout: Layout, wish: Wish, rows: IntArray) -> GeoDataFrame:
    """Set the generators: those asked for, or another where the old one makes no sense."""
    names = layout.buildings["generator"].to_numpy(str).astype("U32")
    kinds = list(generators())
    fits = admitted(layout)
    place = profile_of(city.frame)
    if wish.generator is not None:
        names[rows] = wish.generator
    elif wish.style is not None:
        names[rows] = _of_style(city, layout, wish.style, fits)[rows]
    else:
        known = np.isin(names, kinds)  # where nothing is designed yet, none has been chosen
        column = np.array([kinds.index(n) if k else 0 for n, k in zip(names, known, strict=True)])
        lost = ~known | ~fits[np.arange(len(names)), column]
        lost &= fits.any(axis=1) & np.isin(np.arange(len(names)), rows)
        if lost.any():
            other = choose_generators(layout, city.seed, style=city.style, place=place)
            names = np.where(lost, other, names)
    return layout.buildings.assign(generator=names.astype(str))


def _of_style(city: City, layout: Layout, style: str, fits: NDArray[np.bool_]) -> NDArray[np.str_]:
    """Draw generators that speak of a style; where none fits, those of the style's towns."""
    from cityx.assets.styles.style_shares import speaking_of

    place = profile_of(city.frame)
    names = choose_generators(layout, city.seed, style=style, place=place).astype("U32")
    word = style.strip().lower().replace(" ", "_")
    kinds = np.array(list(generators()))
    group = building_groups(layout, city.seed)
    ids = layout.buildings["id"].to_numpy(np.uint64)
    for row, name in enumerate(names.tolist()):
        known = speaking_of(word).get(GROUPS[int(group[row])], frozenset())
        able = sorted(set(kinds[fits[row]].tolist()) & known) or _likeliest(layout, row, known)
        if able and name not in able:
            drawn = choose(city.seed, "edit/style", ids[row : row + 1], [1.0] * len(able))
            names[row] = able[int(drawn[0])]
    return names


def _likeliest(layout: Layout, row: int, names: frozenset[str]) -> list[str]:
    """Return the generators whose usual plots and storeys a building misses by least."""
    building = layout.buildings.iloc[row]
    has = {"area": building.geometry.area, "levels": float(building["levels"])}

    def misses(name: str) -> float:
        kind = generators()[name]
        bounds = ((has["area"], kind.area), (has["levels"], kind.levels))
        return sum(
            float(np.log(max(low / max(value, 1e-6), value / high, 1.0)))
            for value, (low, high) in bounds
        )

    return [min(sorted(names), key=misses)] if names else []
