"""Splicing: objects taken out of a scene and put into it; all others stay as they are."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from cityx.city.mesh import MeshBatch, concatenate
from cityx.city.rows import leave_rows, merge_rows, take_rows
from cityx.city.scene import Instances, Prototype, Scene

SHELLS = "buildings"


def without(scene: Scene, ids: NDArray[np.uint64]) -> Scene:
    """Take buildings and everything they own out of a scene."""
    return without_owned(with_shells(scene, ids, None), ids)


def with_shells(scene: Scene, ids: NDArray[np.uint64], fresh: MeshBatch | None) -> Scene:
    """Put shells in the place of those of some buildings; None leaves them out."""
    batch = scene.meshes.get(SHELLS)
    if batch is None:
        return scene if fresh is None else scene.with_mesh(SHELLS, fresh)
    if fresh is None and not np.isin(batch.object_id, ids).any():
        return scene
    return scene.with_mesh(SHELLS, spliced(batch, ids, fresh))


def without_owned(scene: Scene, ids: NDArray[np.uint64]) -> Scene:
    """Take what buildings own out of a scene; their shells stay."""
    for layer, rows in scene.instances.items():
        gone = np.isin(rows.owner, ids)
        if gone.any():
            scene = scene.with_instances(layer, scene.prototypes, leave_rows(rows, gone))
    return scene


def spliced(batch: MeshBatch, gone: NDArray[np.uint64], fresh: MeshBatch | None) -> MeshBatch:
    """Put objects in the place of others, sorted by id.

    Parameters
    ----------
    batch
        Objects, sorted by id.
    gone
        Ids of those that are left out.
    fresh
        Objects that come in, None for none.
    """
    kept = ~np.isin(batch.object_id, gone)
    new = fresh if fresh is not None and fresh.count else None
    at = np.zeros(0, np.int64)
    if new is not None:
        new = new.take(np.argsort(new.object_id, kind="stable"))
        at = np.searchsorted(batch.object_id, new.object_id)
    pieces: list[MeshBatch] = []
    bounds = np.flatnonzero(np.diff(np.concatenate([[False], kept, [False]]).astype(np.int8)))
    runs = bounds.reshape(-1, 2)
    cuts = np.unique(np.concatenate([runs.ravel(), at]))
    for place, begin in enumerate(cuts.tolist()):
        if new is not None:
            pieces += [new.take([row]) for row in np.flatnonzero(at == begin).tolist()]
        end = int(cuts[place + 1]) if place + 1 < len(cuts) else batch.count
        if begin < batch.count and kept[begin]:
            pieces.append(run_of(batch, begin, end))
    return concatenate(pieces)


def run_of(batch: MeshBatch, begin: int, end: int) -> MeshBatch:
    """Return the batch of the objects of a range; apart from ``faces`` its arrays are views."""
    vertices = slice(int(batch.vertex_start[begin]), int(batch.vertex_start[end]))
    rows = slice(int(batch.face_start[begin]), int(batch.face_start[end]))
    faces = batch.faces[rows]
    if vertices.start:
        faces = np.where(faces < 0, faces, faces - np.int32(vertices.start))
    return MeshBatch(
        batch.object_id[begin:end],
        batch.vertex_start[begin : end + 1] - vertices.start,
        batch.face_start[begin : end + 1] - rows.start,
        batch.vertices[vertices],
        faces,
        batch.material[rows],
        batch.materials,
        batch.uv[rows],
        batch.tint[rows],
    )


def with_rows(scene: Scene, layer: str, prototypes: Sequence[Prototype], rows: Instances) -> Scene:
    """Add rows to a layer, sorted by id, with the prototypes they use."""
    used, number = np.unique(rows.prototype, return_inverse=True)
    offered: list[Prototype] = [prototypes[index] for index in used.tolist()]
    fresh = replace(rows, prototype=number.astype(np.int32))
    old = scene.instances.get(layer)
    if old is not None and old.count:
        known = list(scene.prototypes)
        names = {p.name: i for i, p in enumerate(known)}
        place_of = []
        for prototype in offered:
            if prototype.name not in names:
                names[prototype.name] = len(known)
                known.append(prototype)
            place_of.append(names[prototype.name])
        fresh = replace(fresh, prototype=np.array(place_of, np.int32)[fresh.prototype])
        return scene.with_instances(layer, known, merge_rows(old, fresh))
    order = np.argsort(fresh.object_id, kind="stable")
    return scene.with_instances(layer, offered, take_rows(fresh, order))
