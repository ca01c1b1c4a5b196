"""Meshes as USD wants them: faces in runs of one object, material and tint, points per object."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cityx.assets.styles.surface_states import material_named
from cityx.city.mesh import MeshBatch
from cityx.outputs.gltf_mesh import finite

# A preview surface cannot multiply its texture by the tint of a face, so each tint is a material of
# its own. Tints are rounded on a fixed lattice of square roots, which is about as even to the eye:
# an error of 0.04 at most below 1, and no object's tint depends on which others there are.
TINT_STEPS = 24
_NO_AREA = 1e-12  # square metres
_BRIGHTEST = 4.0  # trees reach 1.4; a step fits in 6 bits


def tint_steps(tint: ArrayLike) -> NDArray[np.int64]:
    """Round (n, 3) linear tints to steps of the lattice; what is not a number becomes white."""
    shown = np.nan_to_num(np.asarray(tint, np.float64).reshape(-1, 3), nan=1.0)
    steps: NDArray[np.float64] = np.round(np.sqrt(shown.clip(0, _BRIGHTEST)) * TINT_STEPS)
    return steps.astype(np.int64)


def tint_of(steps: ArrayLike) -> NDArray[np.float64]:
    """Linear tints, (..., 3), of steps of the lattice."""
    share = np.asarray(steps, np.float64) / TINT_STEPS
    return share * share


@dataclass(frozen=True)
class UsdFaces:
    """Faces of k objects, f of them with c corners, in r runs of one object, material and tint.

    Attributes
    ----------
    points
        (n, 3) float32, metres from the object's origin, in the order of the batch.
    normals
        (f, 3) float32, unit.
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
    normals: NDArray[np.float32]
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
    steps = tint_steps(batch.tint)
    steps[~takes_tint(batch.materials)[batch.material]] = TINT_STEPS
    key = packed(owner * len(batch.materials) + batch.material, steps)
    order = np.argsort(key, kind="stable")
    cuts = np.flatnonzero(np.diff(key[order], prepend=-1))
    first = order[cuts]  # a face of each run
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
        face_normals(finite(batch.vertices), batch.faces[order]),
        counts.astype(np.int32),
        faces[used].astype(np.int32),
        places[used],
        order,
        np.concatenate([[0], np.cumsum(counts)])[batch.face_start],
        np.append(cuts, len(faces)),
        owner[first],
        batch.material[first].astype(np.int64),
        steps[first],
    )


def packed(number: ArrayLike, steps: NDArray[np.int64]) -> NDArray[np.int64]:
    """(n,) one integer for each number and (n, 3) tint, in the order of the numbers."""
    return np.asarray(number, np.int64) << 18 | steps @ (1 << np.array([12, 6, 0]))


def face_normals(points: NDArray[np.float64], faces: NDArray[np.int32]) -> NDArray[np.float32]:
    """(f, 3) unit normals of triangles and quads; a face without area looks up."""
    last = np.where(faces[:, 3] >= 0, faces[:, 3], faces[:, 0])
    normal = np.cross(points[faces[:, 2]] - points[faces[:, 0]], points[last] - points[faces[:, 1]])
    length = np.linalg.norm(normal, axis=1, keepdims=True)
    flat = length < _NO_AREA
    return np.where(flat, [0.0, 0.0, 1.0], normal / np.where(flat, 1, length)).astype(np.float32)


def takes_tint(materials: Sequence[str]) -> NDArray[np.bool_]:
    """(m,) whether each material takes a tint."""
    return np.array([material_named(name).takes_tint for name in materials], bool)
