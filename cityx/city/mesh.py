"""Meshes of many objects in one set of arrays.

Geometry of a city is kept as structure of arrays: the vertices of all objects of a layer in one
array, cut into objects by start offsets. Faces are triangles or convex planar quads.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cityx.geometry.ranges import equal_rows, ranges

NO_VERTEX = -1  # fourth index of a triangle


@dataclass(frozen=True)
class MeshBatch:
    """Meshes of k objects, n vertices, f faces.

    Attributes
    ----------
    object_id
        (k,) uint64, one per object.
    vertex_start, face_start
        (k + 1,) int64; object i owns vertices ``vertex_start[i]:vertex_start[i + 1]`` and faces
        likewise. No face uses a vertex of another object.
    vertices
        (n, 3) float64, scene frame, metres.
    faces
        (f, 4) int32 into ``vertices`` of the whole batch, counter-clockwise seen from outside; a
        triangle has -1 in the last column.
    material
        (f,) int16 into ``materials``.
    materials
        Names of materials, see `cityx.assets.styles.materials`.
    uv
        (f, 4, 2) float32, texture coordinates per face corner **in metres** (walls: running length
        along the wall and height; ground: world x and y).
    tint
        (f, 3) float32, linear RGB that multiplies the base color of the material.
    """

    object_id: NDArray[np.uint64]
    vertex_start: NDArray[np.int64]
    face_start: NDArray[np.int64]
    vertices: NDArray[np.float64]
    faces: NDArray[np.int32]
    material: NDArray[np.int16]
    materials: tuple[str, ...]
    uv: NDArray[np.float32]
    tint: NDArray[np.float32]

    @property
    def count(self) -> int:
        """Number of objects."""
        return len(self.object_id)

    @property
    def triangle_count(self) -> int:
        """Number of triangles after splitting quads."""
        return len(self.faces) + int(np.count_nonzero(self.faces[:, 3] != NO_VERTEX))

    def triangles(self) -> tuple[NDArray[np.int32], NDArray[np.int64]]:
        """Split quads: (t, 3) vertex indices and (t,) the face of each triangle."""
        quads = np.flatnonzero(self.faces[:, 3] != NO_VERTEX)
        triangles = np.concatenate([self.faces[:, :3], self.faces[quads][:, [0, 2, 3]]])
        return triangles, np.concatenate([np.arange(len(self.faces)), quads])

    def face_object(self) -> NDArray[np.int64]:
        """(f,) index of the object each face belongs to."""
        return np.repeat(np.arange(self.count), np.diff(self.face_start))

    def one(self, index: int) -> MeshBatch:
        """Return the batch of one object; apart from ``faces`` its arrays are views of these."""
        vertices = slice(*self.vertex_start[index : index + 2].tolist())
        rows = slice(*self.face_start[index : index + 2].tolist())
        faces = self.faces[rows]
        if vertices.start:
            faces = np.where(faces == NO_VERTEX, NO_VERTEX, faces - np.int32(vertices.start))
        return MeshBatch(
            self.object_id[index : index + 1],
            np.array([0, vertices.stop - vertices.start], np.int64),
            np.array([0, rows.stop - rows.start], np.int64),
            self.vertices[vertices],
            faces,
            self.material[rows],
            self.materials,
            self.uv[rows],
            self.tint[rows],
        )

    def with_faces(self, kept: NDArray[np.bool_]) -> MeshBatch:
        """Return the batch with some of its (f,) faces; all objects and vertices stay."""
        start = np.concatenate([[0], np.cumsum(kept)])[self.face_start].astype(np.int64)
        return replace(
            self, face_start=start, faces=self.faces[kept], material=self.material[kept],
            uv=self.uv[kept], tint=self.tint[kept],
        )  # fmt: skip

    def take(self, objects: ArrayLike) -> MeshBatch:
        """Return the batch of the given objects (indices into ``object_id``), in that order."""
        objects = np.asarray(objects, dtype=np.int64)
        vertex_rows, vertex_start = ranges(self.vertex_start, objects)
        face_rows, face_start = ranges(self.face_start, objects)
        shift = np.repeat(vertex_start[:-1] - self.vertex_start[:-1][objects], np.diff(face_start))[
            :, None
        ]
        faces = self.faces[face_rows]
        return MeshBatch(
            self.object_id[objects],
            vertex_start,
            face_start,
            self.vertices[vertex_rows],
            np.where(faces == NO_VERTEX, NO_VERTEX, faces + shift).astype(np.int32),
            self.material[face_rows],
            self.materials,
            self.uv[face_rows],
            self.tint[face_rows],
        )


def feet(batch: MeshBatch) -> NDArray[np.float64]:
    """Return the middle of the foot of each object, (k, 3) metres, in whole millimetres.

    It is the middle of the plan's bounds at the height of the lowest vertex; 0 without vertices.
    Editors turn and scale the object about it.
    """
    found = np.zeros((batch.count, 3))
    filled = np.flatnonzero(np.diff(batch.vertex_start) > 0)
    if len(filled):
        begin = batch.vertex_start[:-1][filled]
        low = np.minimum.reduceat(batch.vertices, begin)
        high = np.maximum.reduceat(batch.vertices, begin)
        found[filled] = np.round(np.column_stack([(low + high)[:, :2] / 2, low[:, 2]]), 3)
    return found


def one_mesh(
    object_id: int,
    vertices: ArrayLike,
    faces: ArrayLike,
    *,
    material: ArrayLike = 0,
    materials: Sequence[str] = ("plaster",),
    uv: ArrayLike | None = None,
    tint: ArrayLike = (1.0, 1.0, 1.0),
) -> MeshBatch:
    """Make a batch of one object; `material` and `tint` broadcast over faces, (f, 3) faces pass."""
    points = np.asarray(vertices, dtype=np.float64).reshape(-1, 3)
    corners = np.asarray(faces, dtype=np.int32)
    if corners.ndim == 2 and corners.shape[1] == 3:
        corners = np.column_stack([corners, np.full(len(corners), NO_VERTEX, np.int32)])
    corners = corners.reshape(-1, 4)
    count = len(corners)
    flat = np.zeros((count, 4, 2), np.float32) if uv is None else np.asarray(uv, np.float32)
    number, color = np.empty(count, np.int16), np.empty((count, 3), np.float32)
    number[:], color[:] = material, tint
    return MeshBatch(
        np.array([object_id], np.uint64),
        np.array([0, len(points)], np.int64),
        np.array([0, count], np.int64),
        points,
        corners,
        number,
        tuple(materials),
        flat.reshape(count, 4, 2),
        color,
    )


def empty_batch() -> MeshBatch:
    """Return a batch without objects."""
    return MeshBatch(
        np.zeros(0, np.uint64),
        np.zeros(1, np.int64),
        np.zeros(1, np.int64),
        np.zeros((0, 3)),
        np.zeros((0, 4), np.int32),
        np.zeros(0, np.int16),
        (),
        np.zeros((0, 4, 2), np.float32),
        np.zeros((0, 3), np.float32),
    )


def concatenate(batches: Iterable[MeshBatch]) -> MeshBatch:
    """Join batches; objects keep their order, material names are merged."""
    columns, names = joined_columns(batches)
    if not columns:
        return empty_batch()
    joined = {name: np.concatenate(parts) for name, parts in columns.items()}
    return MeshBatch(**joined, materials=names)


def joined_apart(batches: Iterable[MeshBatch]) -> MeshBatch:
    """Join batches; each keeps its materials, in their order, behind those of the others."""
    parts = list(batches)
    shift = np.cumsum([0, *(len(batch.materials) for batch in parts)]).tolist()
    numbers = [batch.material + np.int16(s) for batch, s in zip(parts, shift, strict=False)]
    return replace(
        concatenate(parts),
        material=np.concatenate([np.zeros(0, np.int16), *numbers]),
        materials=tuple(name for batch in parts for name in batch.materials),
    )


def joined_columns(
    batches: Iterable[MeshBatch],
) -> tuple[dict[str, list[NDArray[Any]]], tuple[str, ...]]:
    """Return the arrays of a batch that joins others, by name, in pieces that are not yet joined.

    Returns
    -------
    columns
        The pieces of each array of a `MeshBatch`; none without objects.
    materials
        The merged names.
    """
    parts = [batch for batch in batches if batch.count]
    if not parts:
        return {}, ()
    names = list(dict.fromkeys(name for batch in parts for name in batch.materials))
    columns: dict[str, list[NDArray[Any]]] = {
        "object_id": [batch.object_id for batch in parts],
        "vertex_start": [np.zeros(1, np.int64)], "face_start": [np.zeros(1, np.int64)],
        "vertices": [batch.vertices for batch in parts], "faces": [], "material": [],
        "uv": [batch.uv for batch in parts], "tint": [batch.tint for batch in parts],
    }  # fmt: skip
    vertex_shift = face_shift = 0
    for batch in parts:
        columns["vertex_start"].append(batch.vertex_start[1:] + vertex_shift)
        columns["face_start"].append(batch.face_start[1:] + face_shift)
        moved = batch.faces + np.int32(vertex_shift)
        moved[batch.faces == NO_VERTEX] = NO_VERTEX
        columns["faces"].append(moved)
        table = np.array([names.index(name) for name in batch.materials], np.int16)
        columns["material"].append(table[batch.material] if len(batch.material) else batch.material)
        vertex_shift += len(batch.vertices)
        face_shift += len(batch.faces)
    return columns, tuple(names)


def same_objects(batch: MeshBatch, other: MeshBatch) -> NDArray[np.bool_]:
    """(k,) whether each object of a batch is in another batch just so, of the same id.

    Both are sorted by id. Runs of objects that follow each other in both are compared at once.
    """
    found = np.zeros(batch.count, bool)
    if not batch.count or not other.count:
        return found
    at = np.minimum(np.searchsorted(other.object_id, batch.object_id), other.count - 1)
    alike = other.object_id[at] == batch.object_id
    for name in ("vertex_start", "face_start"):
        sizes, others = np.diff(getattr(batch, name)), np.diff(getattr(other, name))
        alike &= sizes == others[at]
    rows = np.flatnonzero(alike)
    breaks = np.flatnonzero((np.diff(rows) != 1) | (np.diff(at[rows]) != 1)) + 1
    for run in np.split(rows, breaks):
        if len(run):
            found[run] = _equal_run(batch, other, run, int(at[run[0]]))
    return found


def _equal_run(
    batch: MeshBatch, other: MeshBatch, run: NDArray[np.int64], first: int
) -> NDArray[np.bool_]:
    """(r,) whether objects of a run equal those of a run of another batch, of the same sizes."""
    mine, theirs = slice(int(run[0]), int(run[-1]) + 1), slice(first, first + len(run))
    points, corners = ((b.vertex_start, b.face_start) for b in (batch, other))
    v, w = _span(points[0], mine), _span(corners[0], theirs)
    f, g = _span(points[1], mine), _span(corners[1], theirs)
    same = _all_of(equal_rows(batch.vertices[v], other.vertices[w]), points[0], mine)
    shift = np.int32(v.start - w.start)
    faces = other.faces[g]
    moved = np.where(faces == NO_VERTEX, NO_VERTEX, faces + shift)
    known = {name: number for number, name in enumerate(other.materials)}
    number = np.array([*(known.get(name, -1) for name in batch.materials), -1], np.int16)
    equal = equal_rows(batch.faces[f], moved)
    equal &= number[batch.material[f]] == other.material[g]
    equal &= equal_rows(batch.uv[f], other.uv[g])
    equal &= equal_rows(batch.tint[f], other.tint[g])
    return same & _all_of(equal, points[1], mine)


def _span(start: NDArray[np.int64], objects: slice) -> slice:
    return slice(int(start[objects.start]), int(start[objects.stop]))


def _all_of(
    equal: NDArray[np.bool_], start: NDArray[np.int64], objects: slice
) -> NDArray[np.bool_]:
    """(r,) whether all rows of each object of a range are true."""
    own = start[objects.start : objects.stop + 1] - start[objects.start]
    wrong = np.concatenate([[0], np.cumsum(~equal)])
    return np.asarray(wrong[own[1:]] == wrong[own[:-1]])
