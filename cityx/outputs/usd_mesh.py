"""Meshes as USD wants them: faces in runs of one object, material and tint, points per object."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cityx.city.mesh import MeshBatch
from cityx.outputs.gltf_mesh import finite, material_named

# A preview surface cannot multiply its texture by the tint of a face, so each tint is a material of
# its own. Tints are rounded on a fixed lattice of square roots, which is about as even to the eye:
# an error of 0.04 at most below 1, and no object's tint depends on which others there are.
TINT_STEPS = 24
_BRIGHTEST = 2.0  # no tint is brighter; trees reach 1.4


def tint_steps(tint: ArrayLike) -> NDArray[np.int64]:
    """Round (n, 3) linear tints to steps of the lattice; what is not a number becomes white."""
    shown = np.nan_to_num(np.asarray(tint, np.float64).reshape(-1, 3), nan=1.0)
    return np.round(np.sqrt(np.clip(shown, 0, _BRIGHTEST)) * TINT_STEPS).astype(np.int64)


def tint_of(steps: ArrayLike) -> NDArray[np.float64]:
    """Linear tints, (..., 3), of steps of the lattice."""
    return (np.asarray(steps, np.float64) / TINT_STEPS) ** 2


@dataclass(frozen=True)
class UsdFaces:
    """Faces of k objects, f of them with c corners, in r runs of one object, material and tint.

    Attributes
    ----------
    points
        (n, 3) float32, metres from the object's origin, in the order of the batch.
    counts
        (f,) int32, corners of each face.
    indices
        (c,) int32, counted from the first point of the object.
    st
        (c, 2) float32, in tiles, t up.
    order
        (f,) the face of the batch each came from; faces stay with their object.
    corner_start
        (k + 1,) int64, where the corners of each object begin.
    run_start
        (r + 1,) int64, where the faces of each run begin.
    run_object, run_material
        (r,) int64; the material counts `MeshBatch.materials`.
    run_steps
        (r, 3) int64 tint of each run, `TINT_STEPS` where the material takes none.
    """

    points: NDArray[np.float32]
    counts: NDArray[np.int32]
    indices: NDArray[np.int32]
    st: NDArray[np.float32]
    order: NDArray[np.int64]
    corner_start: NDArray[np.int64]
    run_start: NDArray[np.int64]
    run_object: NDArray[np.int64]
    run_material: NDArray[np.int64]
    run_steps: NDArray[np.int64]


def usd_faces(batch: MeshBatch, origin: NDArray[np.float64]) -> UsdFaces:
    """Order the faces of a batch by object, material and tint.

    Parameters
    ----------
    origin
        (k, 3) per object, scene frame.
    """
    owner = batch.face_object()
    look = np.column_stack([batch.material, tint_steps(batch.tint)]).astype(np.int64)  # (f, 4)
    look[~takes_tint(batch.materials)[batch.material], 1:] = TINT_STEPS
    order = np.lexsort((*look.T[::-1], owner))
    key = np.column_stack([owner, look])[order]  # (f, 5)
    cuts = np.flatnonzero((np.diff(key, axis=0, prepend=-1) != 0).any(axis=1))
    faces = batch.faces[order].astype(np.int64)
    used = faces >= 0
    faces -= batch.vertex_start[owner][:, None]
    counts = used.sum(axis=1)
    tiles = np.array([material_named(name).tile for name in batch.materials] or [1.0], np.float32)
    places = np.nan_to_num(batch.uv[order], nan=0, posinf=0, neginf=0)
    places /= tiles[batch.material[order]][:, None, None]
    shift = np.repeat(origin, np.diff(batch.vertex_start), axis=0)
    return UsdFaces(
        (finite(batch.vertices) - shift).astype(np.float32),
        counts.astype(np.int32),
        faces[used].astype(np.int32),
        places[used],
        order,
        np.concatenate([[0], np.cumsum(counts)])[batch.face_start],
        np.append(cuts, len(faces)),
        key[cuts, 0],
        key[cuts, 1],
        key[cuts, 2:],
    )


def takes_tint(materials: Sequence[str]) -> NDArray[np.bool_]:
    """(m,) whether each material takes a tint."""
    return np.array([material_named(name).takes_tint for name in materials], bool)
