"""Other buildings in the place of buildings."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from types import MappingProxyType
from typing import Annotated

import numpy as np
import shapely

from cityx.building.catalogue import NAMES, OUTSIDE, generators
from cityx.building.lots import cleared
from cityx.building.roofs.shapes import SHAPES
from cityx.city.city import City
from cityx.city.layout import Layout
from cityx.edit.buildings.designing import Wish, redesigned
from cityx.edit.buildings.given_way import with_ground_freed
from cityx.edit.buildings.rebuilding import Ids
from cityx.edit.buildings.set_material import WORDS
from cityx.edit.buildings.set_roof import COVERINGS
from cityx.edit.targets import buildings_named
from cityx.errors import ActionFailed
from cityx.protocol import Choice, Color, ObjectName, Port, Range, action
from cityx.protocol.serving import Serves
from cityx.system.extensions import refusals
from cityx.town.elements import ELEMENTS

SAID = ("building.type",)  # what a sentence says of the new building
SPACIOUS = 1.5  # times the largest usual plot, from which a footprint is drawn in to it
# Word of a kind of building -> its generator, where that has another name.
KINDS: Mapping[str, str] = MappingProxyType(
    {
        "house": "suburban_house", "terrace": "georgian_terrace", "villa": "suburban_house",
        "apartment": "walk_up", "tower": "glass_tower", "office": "office_slab",
        "hotel": "postmodern_tower", "shop": "shop_house", "mall": "big_box",
        "factory": "sawtooth_factory", "cathedral": "church", "university": "school",
        "station": "station_hall", "town_hall": "townhall", "museum": "palazzo",
        "library": "palazzo", "theatre": "palazzo", "castle": "palazzo", "garage": "shed",
        "market_hall": "station_hall",
    }
)  # fmt: skip
BUILT = frozenset((*KINDS, *NAMES))  # kinds that are built on the footprint of others
USES: Mapping[str, str] = MappingProxyType(
    {
        **{kind: ELEMENTS[kind].building["building"] for kind in KINDS
           if kind in ELEMENTS and "building" in ELEMENTS[kind].building},
        "villa": "villa", "cathedral": "cathedral", "university": "university", "museum": "museum",
     "library": "library", "theatre": "theatre", "castle": "castle", "hotel": "hotel",
     "terrace": "terrace", "garage": "garage", "mall": "retail"}
)  # fmt: skip


@action(
    "edit/replace_building-v1",
    limits=[
        "A plot larger than such a building needs stays open around it.",
        "The new building keeps the id of the old.",
    ],
    takes=(Port("object", "complex_geometry"),),
    gives=(Port("object", "complex_geometry"),),
    labels=("replace", "rebuild", "turn into", "instead"),
    serves=tuple(Serves("edit=replace", "family=building", said) for said in SAID),
    binds={
        "objects": "objects", "kind": "building.type", "floors": "building.floors",
        "height": "building.height", "material": "material", "color": "rgb", "style": "style",
        "shape": "roof", "covering": "roof", "roof_color": "roof.rgb",
    },
)  # fmt: skip
def replace_building(
    city: City,
    *,
    objects: Annotated[tuple[str, ...], ObjectName()],
    kind: Annotated[str | None, Choice(*sorted({*KINDS, *NAMES}), outside=OUTSIDE)] = None,
    floors: Annotated[int | None, Range(1, 200)] = None,
    height: Annotated[float | None, Range(2.2, 1000.0)] = None,
    material: Annotated[str | None, Choice(*WORDS)] = None,
    color: Annotated[int | None, Color(), Range(0, 0xFFFFFF)] = None,
    style: str | None = None,
    shape: Annotated[str | None, Choice(*SHAPES)] = None,
    covering: Annotated[str | None, Choice(*COVERINGS)] = None,
    roof_color: Annotated[int | None, Color(), Range(0, 0xFFFFFF)] = None,
) -> City:
    """Build other buildings in the place of buildings.

    Parameters
    ----------
    city
        The city.
    objects
        The buildings that go.
    kind
        Kind of the new ones; that of the style, or the old, when left out.
    floors
        Storeys; usual ones when left out.
    height
        Metres from the ground to the top.
    material, color
        Of the walls.
    style
        A style word such as "japanese".
    shape, covering, roof_color
        Of the roofs.
    """
    ids, before = buildings_named(city, objects), city.layout
    name = kind if kind in generators() else KINDS.get(kind or "", kind)
    if name is not None and name not in generators():
        why = "".join(f" {sentence}" for sentence in refusals())
        raise ActionFailed(f'"{name}" builds nothing here.{why}')
    if kind is not None and name is not None:
        city = cleared(replace(city, layout=_on_plots(city.layout, ids, name, kind)), ids)
        usual = round(sum(generators()[name].floors) / 2)
        floors = usual if floors is None and height is None else floors
    wish = Wish(
        height=None if height is None else np.full(len(ids), height),
        floors=None if floors is None else np.full(len(ids), floors, np.int64),
        generator=name, style=style if name is None else None, material=material, color=color,
    )  # fmt: skip
    city = redesigned(city, ids, wish)
    roof = Wish(roof=shape, roof_material=covering, roof_color=roof_color)
    city = city if roof == Wish() else redesigned(city, ids, roof)
    return with_ground_freed(city, before, ids)


def _on_plots(layout: Layout, ids: Ids, name: str, kind: str) -> Layout:
    """Draw footprints in to what a kind of building needs, and say what they are for."""
    made = generators()[name]
    needed = made.plot[1] * made.plot[3]  # square metres of its largest usual plot
    rows = np.isin(layout.buildings["id"].to_numpy(np.uint64), ids)
    shapes = layout.buildings.geometry.to_numpy().copy()
    area = shapely.area(shapes)
    spacious = rows & (area > SPACIOUS * needed)
    factor = np.where(spacious, np.sqrt(needed / np.maximum(area, 1e-6)), 1.0)
    for row in np.flatnonzero(factor < 1.0).tolist():
        middle = shapely.get_coordinates(shapes[row].centroid)[0]
        size = float(factor[row])
        shapes[row] = shapely.transform(shapes[row], lambda xy, m=middle, f=size: m + (xy - m) * f)
    word = USES.get(kind, made.use)
    use = np.where(rows, word, layout.buildings["use"].to_numpy(str))
    of_part = np.isin(layout.parts["building"].to_numpy(np.uint64), ids)
    parts = layout.parts.assign(use=np.where(of_part, word, layout.parts["use"].to_numpy(str)))
    buildings = layout.buildings.assign(use=use).set_geometry(shapes)
    return replace(layout, buildings=buildings, parts=parts)
