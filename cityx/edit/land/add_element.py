"""Elements in a city that exists: a hotel, a car park, a playground on land that is free."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated, Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.city import City
from cityx.edit.buildings.traits import (
    BINDS,
    Covering,
    Floors,
    Height,
    Hue,
    Material,
    Shape,
    with_traits,
)
from cityx.edit.land.add import WORDS, round_last
from cityx.edit.land.enclose import KINDS as BARRIERS
from cityx.edit.land.free_lots import BY, Place, grounds_of, placed, with_one
from cityx.edit.land.latest import LAID
from cityx.edit.land.spots import CORNERS
from cityx.errors import ActionFailed
from cityx.geometry.polygons import corners_of
from cityx.geometry.turns import SIDES
from cityx.protocol import Choice, ObjectName, Points, Port, Range, Serves, action
from cityx.protocol.objects import find_objects
from cityx.town.elements import ELEMENTS
from cityx.town.lots import Lot, lot_of, lots_along_streets, lots_on_squares, plans_of
from cityx.town.rebuilding import without_buildings

ACTION = "edit/add_element-v1"
KINDS = tuple(name for name, one in ELEMENTS.items() if not one.builder)
WHERE = (*SIDES, "edge", "middle")
MOST = 20  # elements that one call adds
OTHERS = (*WORDS, *BARRIERS, "lawn", "pond", "lake", "meadow")  # added by actions of their own
LYING = tuple(kind for kind in KINDS if kind not in OTHERS)


@action(
    ACTION,
    limits=[
        "It stands on a lot without houses; what grows and stands there otherwise gives way.",
        "A lot may be smaller than usual, as far as what stands on it admits.",
    ],
    requires=("layout",),
    takes=(Port("layout", "scene_layout"),),
    gives=(Port("layout", "scene_layout"),),
    serves=(
        *(Serves("edit=add", f"element={kind}", kind=kind) for kind in LYING),
        *(Serves("edit=add_building", f"building.type={kind}", kind=kind) for kind in KINDS),
    ),
    binds={
        "count": "count", "near": "within", "along": "beside", "beyond": "from", "ground": "ground",
        "side": "side", "last": "last", **BINDS,
    },
    labels=("add", "build", *LYING),
)  # fmt: skip
def add_element(
    city: City,
    *,
    kind: Annotated[str, Choice(*KINDS)],
    count: Annotated[int, Range(1, MOST)] = 1,
    near: Annotated[tuple[str, ...] | None, ObjectName()] = None,
    along: Annotated[tuple[str, ...] | None, ObjectName()] = None,
    beyond: Annotated[tuple[str, ...] | None, ObjectName()] = None,
    ground: Annotated[tuple[tuple[float, ...], ...] | None, Points(3, CORNERS)] = None,
    side: Annotated[str | None, Choice(*WHERE)] = None,
    last: Annotated[str | None, Choice(*WORDS, *LAID)] = None,
    floors: Floors = None,
    height: Height = None,
    material: Material = None,
    color: Hue = None,
    shape: Shape = None,
    covering: Covering = None,
    roof_color: Hue = None,
) -> City:
    """Build a church, a hotel, a car park, a playground... on a free lot.

    Parameters
    ----------
    city
        The city.
    kind
        What is built.
    count
        How many.
    near
        Areas in which they lie, or objects near which they do.
    along
        Streets along which they lie.
    beyond
        Objects on a side of which they lie.
    ground
        Corners of polygons in which they lie: x, y and which polygon.
    side
        Side of the site, or of what they lie beyond.
    last
        Kind of thing or land near what was added last of which they lie, instead.
    floors
        Storeys of the buildings; usual ones when left out.
    height
        Metres from the ground to the top.
    material, color
        Of the walls; the colour is 0xRRGGBB, sRGB.
    shape, covering, roof_color
        Of the roofs.
    """
    known = city.layout.buildings["id"].to_numpy(np.uint64)
    if last is not None:
        ground = corners_of(round_last(city, last, BY))
    for _ in range(count):
        where = Place(city, near, along, beyond, ground, side)
        city = with_one(city, ELEMENTS[kind], where)
    fresh = np.setdiff1d(city.layout.buildings["id"].to_numpy(np.uint64), known)
    return with_traits(
        city, fresh, kind, floors=floors, height=height, material=material, color=color,
        shape=shape, covering=covering, roof_color=roof_color,
    )  # fmt: skip


@action(
    "edit/replace_by_element-v1",
    limits=["It stands on the ground of what goes and beside it, where no other house stands."],
    requires=("layout",),
    takes=(Port("object", "complex_geometry"),),
    gives=(Port("layout", "scene_layout"),),
    serves=tuple(
        Serves("edit=replace", f"family={family}", f"element={kind}", kind=kind)
        for family in ("building", "land") for kind in LYING
    ),
    binds={"objects": "objects"},
    labels=("replace", "swap", "turn into", *LYING),
)  # fmt: skip
def replace_by_element(
    city: City,
    *,
    objects: Annotated[tuple[str, ...], ObjectName()],
    kind: Annotated[str, Choice(*LYING)],
) -> City:
    """Build a car park, a playground, a market... in the place of buildings or of land.

    Parameters
    ----------
    city
        The city.
    objects
        Buildings, or land such as a pond, that go; together they make room for one.
    kind
        What is built.
    """
    ids, element = find_objects(city, objects), ELEMENTS[kind]
    shapes, amid = grounds_of(city, objects)
    free = shapely.union_all(shapes)
    layout = city.layout
    houses = layout.buildings["id"].to_numpy(np.uint64)
    others = layout.buildings.geometry.to_numpy()[~np.isin(houses, ids)]
    lands = layout.areas["id"].to_numpy(np.uint64)
    kept = replace(layout, areas=_rows(layout.areas, ~np.isin(lands, ids)))
    bare = without_buildings(kept, np.flatnonzero(np.isin(houses, ids)))

    def fits(lots: list[Lot]) -> list[Lot]:
        plans = plans_of(lots, lot_of(element))
        good = shapely.intersects(plans, free) if lots else np.zeros(0, bool)
        if len(others) and lots:
            good[shapely.STRtree(others).query(plans, predicate="intersects")[0]] = False
        return [lots[at] for at in np.flatnonzero(good).tolist()]

    lots = fits(lots_on_squares(replace(city, layout=bare), element, ("park", "plaza")))
    if not lots or not amid:
        lots = lots_along_streets(bare, element, fits) or lots
    if not lots:
        raise ActionFailed(
            f"There is no room for a {kind.replace('_', ' ')} where {', '.join(objects[:4])} lies, "
            "between the other houses and the streets."
        )
    lot = max(lots, key=lambda one: round(one.placed(lot_of(element)).intersection(free).area, 2))
    return placed(replace(city, layout=kept), element, lot, np.intersect1d(houses, ids),
                  was=layout)  # fmt: skip


def _rows(table: Any, kept: NDArray[np.bool_]) -> Any:
    return table.iloc[np.flatnonzero(kept)].reset_index(drop=True)
