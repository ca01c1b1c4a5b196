"""Traits: what is asked of a building that is new: storeys, height, walls and roof."""

from __future__ import annotations

from typing import Annotated

import numpy as np

from cityx.building.roofs.shapes import SHAPES
from cityx.city.city import City
from cityx.edit.buildings.designing import Wish, redesigned
from cityx.edit.buildings.rebuilding import Ids
from cityx.edit.buildings.set_material import WORDS
from cityx.edit.buildings.set_roof import COVERINGS
from cityx.errors import ActionFailed
from cityx.protocol import Choice, Color, Range

Floors = Annotated[int | None, Range(1, 200)]
Height = Annotated[float | None, Range(2.2, 1000.0)]
Material = Annotated[str | None, Choice(*WORDS)]
Hue = Annotated[int | None, Color(), Range(0, 0xFFFFFF)]
Shape = Annotated[str | None, Choice(*SHAPES)]
Covering = Annotated[str | None, Choice(*COVERINGS)]
BINDS = {
    "floors": "building.floors", "height": "building.height", "material": "material",
    "color": "rgb", "shape": "roof", "covering": "roof", "roof_color": "roof.rgb",
}  # fmt: skip


def with_traits(
    city: City,
    ids: Ids,
    what: str,
    *,
    floors: int | None = None,
    height: float | None = None,
    material: str | None = None,
    color: int | None = None,
    shape: str | None = None,
    covering: str | None = None,
    roof_color: int | None = None,
) -> City:
    """Give new buildings what was asked of them; what is None is as usual.

    Parameters
    ----------
    city
        With the buildings.
    ids
        (k,) uint64 of them.
    what
        What was asked for, for the message where nothing of it is a building.
    floors
        Storeys above ground.
    height
        Metres from the ground to the top.
    material, color
        Of the walls; the colour is 0xRRGGBB, sRGB.
    shape, covering, roof_color
        Of the roofs.

    Raises
    ------
    ActionFailed
        If there is no building that could have them.
    """
    look = Wish(
        material=material, color=color, roof=shape, roof_material=covering, roof_color=roof_color
    )
    if floors is None and height is None and look == Wish():
        return city
    if not len(ids):
        raise ActionFailed(f"A {what.replace('_', ' ')} has no walls, storeys or roof to choose.")
    ids = np.sort(ids)
    if height is not None or floors is not None:
        form = Wish(
            height=None if height is None else np.full(len(ids), height),
            floors=None if floors is None else np.full(len(ids), floors, np.int64),
        )
        city = redesigned(city, ids, form)
    return city if look == Wish() else redesigned(city, ids, look)
