"""Removing what belongs to something larger: windows of buildings, pieces of walls."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated

import numpy as np

from cityx.city import City
from cityx.city.rows import leave_rows
from cityx.errors import ActionFailed
from cityx.ids import id_text
from cityx.protocol import ObjectName, Port, action
from cityx.protocol.objects import find_objects

WHOLE = ("buildings", "ground")  # layers of meshes that `edit/remove-v1` and streets decide on


@action(
    "edit/remove_parts-v1",
    limits=["What is left open stays open: a wall without its window shows plain wall."],
    takes=(Port("object", "complex_geometry"),),
    gives=(Port("object", "complex_geometry"),),
    labels=("remove window", "remove part", "take down barrier"),
    serves=("edit=remove_parts",),
    binds={"objects": "objects"},
)
def remove_parts(city: City, *, objects: Annotated[tuple[str, ...], ObjectName()]) -> City:
    """Remove parts of buildings, such as windows and chimneys, and barriers with their own mesh.

    Parameters
    ----------
    city
        The city.
    objects
        Parts of what is built, by their ids; of a building all its parts.
    """
    ids = np.unique(find_objects(city, objects))
    scene = city.scene
    found = np.isin(ids, city.layout.buildings["id"].to_numpy(np.uint64))  # parts or none
    for layer, batch in city.scene.meshes.items():
        gone = np.isin(batch.object_id, ids) & (layer not in WHOLE)
        if gone.any():
            found |= np.isin(ids, batch.object_id[gone])
            scene = scene.with_mesh(layer, batch.take(np.flatnonzero(~gone)))
    for layer, rows in city.scene.instances.items():
        gone = (np.isin(rows.object_id, ids) | np.isin(rows.owner, ids)) & (rows.owner > 0)
        if gone.any():
            found |= np.isin(ids, rows.object_id[gone]) | np.isin(ids, rows.owner[gone])
            scene = scene.with_instances(layer, scene.prototypes, leave_rows(rows, gone))
    if not found.all():
        other = ", ".join(map(id_text, ids[~found][:4].tolist()))
        raise ActionFailed(f"{other} has no parts and is part of nothing; use edit/remove-v1.")
    return replace(city, scene=scene)
