"""Removing objects."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated

import numpy as np

from cityx.building.lots import cleared
from cityx.city.city import City
from cityx.edit.buildings.rebuilding import Ids, rebuilt
from cityx.edit.targets import targets_of, with_changed_rows
from cityx.protocol import ObjectName, Port, action
from cityx.protocol.serving import Serves

FAMILIES = ("building", "piece", "lamp", "light", "vehicle", "pedestrian")  # kinds of objects


@action(
    "edit/remove-v1",
    limits=[
        "The lot of a building becomes the land around it.",
        "Streets, water and land are not removed; walls of neighbours stay as they are.",
    ],
    takes=(Port("object", "complex_geometry"),),
    gives=(Port("object", "complex_geometry"),),
    labels=("remove", "delete", "demolish", "clear"),
    serves=tuple(Serves("edit=remove", f"family={family}") for family in FAMILIES),
    binds={"objects": "objects"},
)
def remove(city: City, *, objects: Annotated[tuple[str, ...], ObjectName()]) -> City:
    """Remove objects, everything they own with them.

    Parameters
    ----------
    city
        The city.
    objects
        Buildings, and things that stand or move about.
    """
    found = targets_of(city, objects)
    if len(found.buildings):
        city = demolished(city, found.buildings)
    if len(found.pieces):
        city = with_changed_rows(city, found.pieces, lambda _: None)
        points = city.layout.points
        kept = ~np.isin(points["id"].to_numpy(np.uint64), found.pieces)
        if not kept.all():
            points = points.iloc[np.flatnonzero(kept)].reset_index(drop=True)
            city = replace(city, layout=replace(city.layout, points=points))
    if len(found.movers) and city.tracks is not None:
        staying = ~np.isin(city.tracks.object_id, found.movers)
        city = replace(city, tracks=city.tracks.take(staying))
    return city


def demolished(city: City, ids: Ids) -> City:
    """Return a city without some buildings, by their ids, and what they own."""
    layout = city.layout
    tables = {}
    for name, column in (("buildings", "id"), ("parts", "building")):
        table = getattr(layout, name)
        kept = ~np.isin(table[column].to_numpy(np.uint64), ids)
        tables[name] = table.iloc[np.flatnonzero(kept)].reset_index(drop=True)
    return rebuilt(cleared(replace(city, layout=replace(layout, **tables)), ids), ids)
