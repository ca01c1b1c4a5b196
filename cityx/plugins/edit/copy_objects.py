"""Copying objects: another of the same, with all it owns, at another place."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from cityx.city import City
from cityx.city.mesh import concatenate
from cityx.city.scene import Instances
from cityx.geometry.identity import hash_ids, id_text
from cityx.plugins.edit.place_objects import place_objects
from cityx.protocol import ObjectName, Port, Range, action
from cityx.protocol.objects import find_objects

ACTION = "edit/copy_objects-v1"
UInt64Array = NDArray[np.uint64]
Vector = tuple[float, float, float]


@action(
    ACTION,
    limits=["Copies may reach into their neighbours; nothing is pushed aside."],
    takes=(Port("object", "complex_geometry"),),
    gives=(Port("object", "complex_geometry"),),
    labels=("copy", "duplicate", "repeat"),
)
def copy_objects(
    city: City,
    *,
    objects: Annotated[tuple[str, ...], ObjectName()],
    move: Annotated[Vector, Range(-1e6, 1e6)] = (0.0, 0.0, 0.0),
    turn: Annotated[Vector, Range(-7.0, 7.0)] = (0.0, 0.0, 0.0),
    factor: Annotated[Vector, Range(0.01, 100.0)] = (1.0, 1.0, 1.0),
) -> City:
    """Add a copy of each object, with what it owns, and place it as `edit/place_objects-v1` does.

    A copy has an id of its own, which follows from that of its original and from how many copies
    of it there are.

    Parameters
    ----------
    city
        City that holds the objects.
    objects
        the objects
    move
        metres to the east, to the north and up from the original
    turn
        radians about the axes to the east, to the north and up, in that order
    factor
        factors of length, width and height
    """
    ids = np.unique(find_objects(city, objects))
    fresh = _new_ids(city, ids)
    city = _copied(city, ids, fresh)
    names = tuple(map(id_text, fresh.tolist()))
    return place_objects(city, objects=names, move=move, turn=turn, factor=factor)


def _new_ids(city: City, ids: UInt64Array) -> UInt64Array:
    """Return an id for a copy of each object that no object has yet."""
    taken = np.concatenate(
        [
            *(batch.object_id for batch in city.scene.meshes.values()),
            *(rows.object_id for rows in city.scene.instances.values()),
        ]
    )
    fresh, number = hash_ids(0, ACTION, ids), 0
    while (used := np.isin(fresh, taken)).any():
        number += 1
        fresh = np.where(used, hash_ids(0, ACTION, ids, number), fresh)
    return fresh


def _copied(city: City, ids: UInt64Array, fresh: UInt64Array) -> City:
    scene = city.scene
    for layer, batch in city.scene.meshes.items():
        mine = np.flatnonzero(np.isin(batch.object_id, ids))
        if len(mine):
            shells = batch.take(mine)
            shells = replace(shells, object_id=fresh[np.searchsorted(ids, shells.object_id)])
            scene = scene.with_mesh(layer, concatenate([batch, shells]))
    for layer, rows in city.scene.instances.items():
        own, owned = np.isin(rows.object_id, ids), np.isin(rows.owner, ids)
        if (own | owned).any():
            joined = _with_twins(rows, own, owned, ids, fresh)
            scene = scene.with_instances(layer, scene.prototypes, joined)
    layout = city.layout
    for name, column in (("buildings", "id"), ("parts", "building")):
        table = getattr(layout, name)
        known = np.isin(table[column].to_numpy(np.uint64), ids)
        if known.any():
            twin = table[known].copy()
            twin[column] = fresh[np.searchsorted(ids, twin[column].to_numpy(np.uint64))]
            if column != "id":
                twin["id"] = hash_ids(0, ACTION, twin["id"].to_numpy(np.uint64), twin[column])
            both = pd.concat([table, twin], ignore_index=True).sort_values("id")
            layout = replace(layout, **{name: both.reset_index(drop=True)})
    return replace(city, scene=scene, layout=layout)


def _with_twins(
    rows: Instances,
    own: NDArray[np.bool_],
    owned: NDArray[np.bool_],
    ids: UInt64Array,
    fresh: UInt64Array,
) -> Instances:
    """Return instances with copies of those that are copied, or that what is copied owns."""
    both = np.flatnonzero(own | owned)
    held = {name: column[both] for name, column in vars(rows).items()}
    place = np.minimum(np.searchsorted(ids, held["owner"]), len(ids) - 1)
    held["owner"] = np.where(owned[both], fresh[place], held["owner"])
    named = np.minimum(np.searchsorted(ids, held["object_id"]), len(ids) - 1)
    carried = hash_ids(0, ACTION, held["object_id"], held["owner"])
    held["object_id"] = np.where(own[both], fresh[named], carried)
    joined = {name: np.concatenate([getattr(rows, name), held[name]]) for name in held}
    return Instances(**joined)
