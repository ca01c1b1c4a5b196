"""Lots: the ground where a building stood becomes that around it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from cityx.city.city import City
from cityx.city.ground import LABEL, SURFACES, Ground
from cityx.city.mesh import concatenate, one_mesh
from cityx.ids import stable_id

Ids = NDArray[np.uint64]

GROUND = "ground"
BARE = "courtyard"  # what a lot becomes whose neighbours are all streets or buildings
# What land a lot may become; streets and walks do not grow into it.
LAND = ("block", "courtyard", "farmland", "grass", "meadow", "wood", "park", "sand", "bare",
        "plaza")  # fmt: skip


def cleared(city: City, ids: Ids) -> City:
    """Lay ground where buildings stood: the mesh of the ground is open under buildings.

    Parameters
    ----------
    city
        The city.
    ids
        Of buildings that stand there no more, or not on all of the ground that they had.
    """
    ground = city.ground
    mesh = city.scene.meshes.get(GROUND)
    if ground is None or mesh is None:
        return city
    faces = np.flatnonzero(np.isin(ground.face_object, ids) & ground.labelled("building"))
    if not len(faces):
        return city
    label = ground.face_label.copy()
    label[faces] = _around(ground, faces)
    scene = city.scene
    for face in faces.tolist():
        surface = SURFACES[label[face]]
        corners = ground.triangles[ground.triangle_face == face]
        used, local = np.unique(corners, return_inverse=True)
        xy = ground.vertices[used]
        z = city.terrain.height_at(xy) + surface.offset
        triangles = local.reshape(-1, 3)
        uv = xy[triangles]
        lot = one_mesh(
            stable_id("ground", "lot", int(ground.face_object[face])),
            np.column_stack([xy, z]), triangles, materials=(surface.material,),
            uv=np.concatenate([uv, np.zeros((len(uv), 1, 2))], axis=1),
        )  # fmt: skip
        batch = scene.meshes[GROUND]
        scene = scene.with_mesh(GROUND, concatenate([batch, lot]))
    return replace(city, scene=scene, ground=replace(ground, face_label=label))


def _around(ground: Ground, faces: NDArray[np.int64]) -> NDArray[np.uint8]:
    """Return the label of the land that each face has most of its border with, (k,)."""
    start, end = (ground.vertices[ground.edges[:, side]] for side in (0, 1))
    length = np.hypot(*(end - start).T)
    found = np.full(len(faces), LABEL[BARE], np.uint8)
    land = [LABEL[name] for name in LAND]
    for place, face in enumerate(faces.tolist()):
        left = ground.edge_faces[:, 0] == face
        right = ground.edge_faces[:, 1] == face
        beside = np.concatenate([ground.edge_faces[left, 1], ground.edge_faces[right, 0]])
        share = np.concatenate([length[left], length[right]])
        beside, share = beside[beside >= 0], share[beside >= 0]
        label = ground.face_label[beside]
        kept = np.isin(label, land)
        if kept.any():
            total = np.bincount(label[kept], share[kept])
            found[place] = int(np.argmax(total))
    return found
