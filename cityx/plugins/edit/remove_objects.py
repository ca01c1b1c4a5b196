"""Removing objects, with everything they own."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated

import numpy as np

from cityx.city import City
from cityx.city.scene import Instances
from cityx.protocol import ObjectName, Port, action
from cityx.protocol.objects import find_objects


@action(
    "edit/remove_objects-v1",
    limits=["The ground stays as it is: where a building stood there is none."],
    takes=(Port("object", "complex_geometry"),),
    gives=(Port("scene", "complex_geometry"),),
    labels=("remove", "delete", "clear away"),
)
def remove_objects(city: City, *, object_names: Annotated[tuple[str, ...], ObjectName()]) -> City:
    """Remove objects, with what they own, such as the windows of a building.

    Parameters
    ----------
    city
        City that holds the objects.
    object_names
        the objects
    """
    ids = find_objects(city, object_names)
    scene = city.scene
    for layer, batch in city.scene.meshes.items():
        gone = np.isin(batch.object_id, ids)
        if gone.any():
            scene = scene.with_mesh(layer, batch.take(np.flatnonzero(~gone)))
    for layer, rows in city.scene.instances.items():
        gone = np.isin(rows.object_id, ids) | np.isin(rows.owner, ids)
        if gone.any():
            scene = scene.with_instances(layer, scene.prototypes, chosen(rows, ~gone))
    layout = city.layout
    for name, column in (("buildings", "id"), ("parts", "building"), ("points", "id")):
        table = getattr(layout, name)
        gone = np.isin(table[column].to_numpy(np.uint64), ids)
        if gone.any():
            layout = replace(layout, **{name: table[~gone].reset_index(drop=True)})
    return replace(city, scene=scene, layout=layout)


def chosen(rows: Instances, kept: np.ndarray[tuple[int], np.dtype[np.bool_]]) -> Instances:
    """Return some rows of a table of instances."""
    return Instances(**{name: column[kept] for name, column in vars(rows).items()})
