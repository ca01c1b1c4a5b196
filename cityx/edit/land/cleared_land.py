"""Grass, meadows and squares in the place of buildings and of other land."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated

import numpy as np

from cityx.city import City
from cityx.edit.land.turf import GREEN, WET, land_around, with_land
from cityx.edit.objects.remove import demolished
from cityx.edit.renewal import renewed
from cityx.errors import UsageError
from cityx.protocol import Choice, ObjectName, Port, Range, Serves, action
from cityx.protocol.objects import find_objects

ACTION = "edit/replace_by_green-v1"
YARD = 6.0  # metres of yard around a house that go with it
# Word of a sentence -> the kind of land that is laid.
GROWS = {"meadow": "meadow", "lawn": "grass", "park": "park", "garden": "garden", "wood": "wood",
         "plaza": "pedestrian"}  # fmt: skip


@action(
    ACTION,
    limits=["The land of houses is their ground and their yard, up to streets and other houses."],
    requires=("layout",),
    takes=(Port("object", "complex_geometry"),),
    gives=(Port("layout", "scene_layout"),),
    serves=tuple(
        Serves("edit=replace", f"family={family}", f"element={word}", kind=kind)
        for family in ("building", "land") for word, kind in GROWS.items()
    ),
    binds={"objects": "objects"},
    labels=("replace", "swap", "turn into", "meadow", "lawn", "park", "garden", "square", "plaza"),
)  # fmt: skip
def replace_by_green(
    city: City,
    *,
    objects: Annotated[tuple[str, ...], ObjectName()],
    kind: Annotated[str, Choice(*sorted(set(GROWS.values())))] = "meadow",
    yard: Annotated[float, Range(0.5, 30.0)] = YARD,
) -> City:
    """Take buildings down and lay green or a square on their land, or make it of other land.

    Parameters
    ----------
    city
        The city.
    objects
        Buildings that go, or land such as a square.
    kind
        What the land becomes.
    yard
        Metres around buildings that go with them.
    """
    ids = find_objects(city, objects)
    layout = city.layout
    own = np.isin(layout.areas["id"].to_numpy(np.uint64), ids)
    houses = np.isin(layout.buildings["id"].to_numpy(np.uint64), ids)
    if (own & layout.areas["kind"].isin(WET).to_numpy()).any():
        raise UsageError(f"Water does not become {kind}; fill it by something that is built.")
    areas = layout.areas.copy()
    areas.loc[own & (areas["kind"] != kind).to_numpy(), "kind"] = kind
    shapes = layout.buildings.geometry.to_numpy()[houses]
    if houses.any():
        city = demolished(city, layout.buildings["id"].to_numpy(np.uint64)[houses])
    land = land_around(city, shapes, yard)
    if len(land):
        areas = with_land(areas, land, kind, ACTION, int(ids[0]), "edit/green")
    elif not own.any():
        laid = ", ".join((*GREEN, "square", "car park"))
        raise UsageError(f"No land is free around {', '.join(objects[:4])}: it is {laid} already.")
    return renewed(city, replace(city.layout, areas=areas), surface=True)
