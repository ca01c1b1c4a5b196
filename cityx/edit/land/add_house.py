"""Houses in a city that exists: blocks of flats, towers, villas on land that is free."""

from __future__ import annotations

from typing import Annotated

import numpy as np

from cityx.building.catalogue import generators
from cityx.city import City
from cityx.edit.buildings.designing import Wish, redesigned
from cityx.edit.buildings.replace_building import KINDS as BUILT
from cityx.edit.buildings.replace_building import USES
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
from cityx.edit.land.add_element import MOST, WHERE
from cityx.edit.land.free_lots import BY, Place, with_one
from cityx.edit.land.latest import LAID
from cityx.edit.land.spots import CORNERS
from cityx.geometry.polygons import corners_of
from cityx.protocol import Choice, ObjectName, Points, Port, Range, Serves, action
from cityx.town.elements import ELEMENTS, Element, Volume

KINDS = tuple(kind for kind in BUILT if kind not in ELEMENTS)
YARD, FRONT = 2.0, 1.0  # metres beside a house and behind it, and before it, up to its lot's border


@action(
    "edit/add_house-v1",
    limits=[
        "It stands on a lot without houses; what grows and stands there otherwise gives way.",
        "Its plan is as large as usual for its kind, or as small as usual where there is no room.",
    ],
    requires=("layout",),
    takes=(Port("layout", "scene_layout"),),
    gives=(Port("layout", "scene_layout"),),
    serves=tuple(Serves("edit=add_building", f"building.type={kind}", kind=kind) for kind in KINDS),
    binds={
        "count": "count", "near": "within", "along": "beside", "beyond": "from", "ground": "ground",
        "side": "side", "last": "last", **BINDS,
    },
    labels=("add", "build", *KINDS),
)  # fmt: skip
def add_house(
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
    """Build a house, a block of flats, an office, a tower... on a free lot.

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
        Storeys; usual ones when left out.
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
    where, element = Place(city, near, along, beyond, ground, side), _element(kind)
    for _ in range(count):
        city = with_one(city, element, where)
    fresh = np.setdiff1d(city.layout.buildings["id"].to_numpy(np.uint64), known)
    city = redesigned(city, fresh, Wish(generator=BUILT[kind]))
    return with_traits(
        city, fresh, kind, floors=floors, height=height, material=material, color=color,
        shape=shape, covering=covering, roof_color=roof_color,
    )  # fmt: skip


def _element(kind: str) -> Element:
    """Return a house of usual size on its lot."""
    made = generators()[BUILT[kind]]
    width, depth = (made.plot[0] + made.plot[1]) / 2, (made.plot[2] + made.plot[3]) / 2
    floors = round(sum(made.floors) / 2)
    body = Volume(
        box=(-width / 2, FRONT, width / 2, FRONT + depth), height=floors * made.storey,
        floors=floors,
    )  # fmt: skip
    least = max(made.plot[0] / width, made.plot[2] / depth)
    return Element(
        kind, f"building, type={kind}", least=round(least, 2),
        lot=(width + 2 * YARD, depth + FRONT + YARD),
        building={"building": USES.get(kind, made.use)}, parts=(body,),
    )  # fmt: skip
