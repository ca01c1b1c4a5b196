"""Twins: another of an object, with all it owns, at the same place and with ids of its own."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from cityx.city import City
from cityx.city.mesh import concatenate
from cityx.city.scene import Instances
from cityx.ids import UInt64Array, hash_ids, id_text

PURPOSE = "edit/copy_objects-v1"  # keys the ids of copies


def _new_ids(city: City, ids: UInt64Array) -> UInt64Array:
    """Return an id for a copy of each object that no object has yet."""
    taken = np.concatenate(
        [
            *(batch.object_id for batch in city.scene.meshes.values()),
            *(rows.object_id for rows in city.scene.instances.values()),
        ]
    )
    fresh, number = hash_ids(0, PURPOSE, ids), 0
    while (used := np.isin(fresh, taken)).any():
        number += 1
        fresh = np.where(used, hash_ids(0, PURPOSE, ids, number), fresh)
    return fresh


def with_twins(city: City, ids: UInt64Array) -> tuple[City, UInt64Array]:
    """Return the city with a copy of each object, and the ids of the copies.

    Parameters
    ----------
    city
        City that holds the objects.
    ids
        Of the objects, ascending.

    Returns
    -------
    city, fresh
        The id of a copy follows from that of its original and from how many copies there are.
    """
    fresh = _new_ids(city, ids)
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
            if column == "id":
                twin["name"] = ""
                twin["source"] = [f"edit/copy/{id_text(one)}" for one in twin["id"].tolist()]
            else:
                twin["id"] = hash_ids(0, PURPOSE, twin["id"].to_numpy(np.uint64), twin[column])
            both = pd.concat([table, twin], ignore_index=True).sort_values("id")
            layout = replace(layout, **{name: both.reset_index(drop=True)})
    return replace(city, scene=scene, layout=layout), fresh


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
    carried = hash_ids(0, PURPOSE, held["object_id"], held["owner"])
    held["object_id"] = np.where(own[both], fresh[named], carried)
    joined = {name: np.concatenate([getattr(rows, name), held[name]]) for name in held}
    return Instances(**joined)
