"""Meshes and prims as USD wants them: faces in runs of one object, points, attributes.

They are written to the layer itself (Sdf): a stage would compose the scene anew after each.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from pxr import Gf, Sdf, Tf, Vt

from cityx.assets.styles.materials import material_named
from cityx.city.mesh import MeshBatch
from cityx.outputs.gltf_mesh import finite, takes_tint

# A preview surface cannot multiply its texture by the tint of a face, so each tint is a material of
# its own. Tints are rounded on a fixed lattice of square roots, which is about as even to the eye:
# an error of 0.04 at most below 1, and no object's tint depends on which others there are.
TINT_STEPS = 24
_NO_AREA = 1e-12  # square metres
_BRIGHTEST = 4.0  # trees reach 1.4; a step fits in 6 bits
Types = Sdf.ValueTypeNames


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


def add_prim(parent: Any, name: str, kind: str = "", *, specifier: Any = Sdf.SpecifierDef) -> Any:
    """Add a prim of a schema ("Mesh", "Xform", ... or "" for the one it refers to).

    What USD allows in no name becomes ``_``, and a name that is taken gets a number.
    """
    valid = unique = Tf.MakeValidIdentifier(name)
    number = 1
    while unique in parent.nameChildren:
        number += 1
        unique = f"{valid}_{number}"
    return Sdf.PrimSpec(parent, unique, specifier, kind)


def add_attribute(
    prim: Any, name: str, kind: Any, value: Any = None, *, uniform: bool = False, over: str = ""
) -> Any:
    """Add an attribute.

    Parameters
    ----------
    kind
        Member of `Types`.
    value
        What it holds, or None for nothing.
    uniform
        Whether its schema calls it uniform: one value for all times.
    over
        Interpolation of a primvar: "uniform" is one value per face, "faceVarying" per corner.
    """
    variability = Sdf.VariabilityUniform if uniform else Sdf.VariabilityVarying
    attribute = Sdf.AttributeSpec(prim, name, kind, variability, name.startswith("cityx:"))
    if value is not None:
        attribute.default = value
    if over:
        attribute.SetInfo("interpolation", over)
    return attribute


def point_at(prim: Any, relationship: str, paths: Sequence[Any]) -> None:
    """Add a relationship to the given paths."""
    Sdf.RelationshipSpec(prim, relationship, False).targetPathList.explicitItems = list(paths)


def connect(prim: Any, name: str, kind: Any, source: Any, output: str) -> None:
    """Add an input or output that takes its value from an output of another shader."""
    path = source.path.AppendProperty(f"outputs:{output}")
    add_attribute(prim, name, kind).connectionPathList.explicitItems = [path]


def refer(prim: Any, path: Any) -> None:
    """Make a prim a reference to a path of the same layer."""
    prim.referenceList.prependedItems = [Sdf.Reference("", path)]


def apply_schemas(prim: Any, *schemas: str) -> None:
    """Apply schemas such as "MaterialBindingAPI" to a prim."""
    prim.SetInfo("apiSchemas", Sdf.TokenListOp.Create(prependedItems=list(schemas)))


def move_to(prim: Any, place: NDArray[np.float64]) -> None:
    """Translate a prim in the frame of its parent, metres."""
    add_attribute(prim, "xformOp:translate", Types.Double3, Gf.Vec3d(*place.tolist()))
    order = Vt.TokenArray(["xformOp:translate"])
    add_attribute(prim, "xformOpOrder", Types.TokenArray, order, uniform=True)


def label(prim: Any, words: str) -> None:
    """Give a prim its semantic class; the schema "SemanticsLabelsAPI:class" must be applied."""
    add_attribute(prim, "semantics:labels:class", Types.TokenArray, Vt.TokenArray([words]))


def vectors(values: NDArray[Any]) -> Any:
    """(n, 3) as an array of float vectors."""
    return Vt.Vec3fArray.FromNumpy(np.ascontiguousarray(values, np.float32))


def integers(values: NDArray[Any]) -> Any:
    """(n,) as an array of 32-bit integers."""
    return Vt.IntArray.FromNumpy(np.ascontiguousarray(values, np.int32))


def long_integers(ids: NDArray[np.uint64]) -> Any:
    """(n,) ids as an array of 64-bit integers: the same bits, the first of which is a sign here."""
    return Vt.Int64Array.FromNumpy(np.ascontiguousarray(ids).view(np.int64))
