"""Growth: vertices and faces added to the objects of a batch, all at once."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cityx.city.mesh import NO_VERTEX, MeshBatch
from cityx.geometry.arrays import FloatArray, IntArray


@dataclass(frozen=True)
class Piece:
    """What is added to a batch: v vertices and f faces.

    Attributes
    ----------
    vertices, vertex_owner
        (v, 3) float64 and (v,) int64, row of the object each belongs to.
    faces, face_owner
        (f, 4) int64 and (f,) int64; numbers below the count of the batch's vertices mean those, the
        others count on into ``vertices``.
    material
        (f,) int16 into `materials`.
    materials
        Names.
    uv, tint
        (f, 4, 2) and (f, 3) float32.
    """

    vertices: FloatArray
    vertex_owner: IntArray
    faces: IntArray
    face_owner: IntArray
    material: NDArray[np.int16]
    materials: tuple[str, ...]
    uv: NDArray[np.float32]
    tint: NDArray[np.float32]


def piece_of(added: MeshBatch, batch: MeshBatch) -> Piece:
    """Turn a batch, whose objects are all in another, into what is added to that one."""
    row = np.searchsorted(batch.object_id, added.object_id)
    return Piece(
        added.vertices,
        np.repeat(row, np.diff(added.vertex_start)),
        np.where(added.faces == NO_VERTEX, NO_VERTEX, added.faces + len(batch.vertices)),
        np.repeat(row, np.diff(added.face_start)),
        added.material,
        added.materials,
        added.uv,
        added.tint,
    )


def grown(
    batch: MeshBatch, pieces: Sequence[Piece], kept: NDArray[np.bool_] | None = None
) -> MeshBatch:
    """Add pieces to a batch and leave out the faces that are not `kept`, (f,) bool."""
    pieces = [piece for piece in pieces if len(piece.faces)]
    if not pieces and kept is None:
        return batch
    rows = np.arange(len(batch.faces)) if kept is None else np.flatnonzero(kept)
    names = list(dict.fromkeys([*batch.materials, *(m for p in pieces for m in p.materials)]))
    count = len(batch.vertices)
    shift = np.cumsum([0] + [len(piece.vertices) for piece in pieces])
    owner = np.concatenate(
        [np.repeat(np.arange(batch.count), np.diff(batch.vertex_start))]
        + [piece.vertex_owner for piece in pieces]
    )
    vertex_order = _sorted_rows(owner, batch.count)
    vertex_start = _starts(owner, batch.count)
    number = np.empty(len(vertex_order) + 1, np.int32)
    number[vertex_order] = np.arange(len(vertex_order), dtype=np.int32)
    number[-1] = NO_VERTEX  # which is what -1 looks up
    owner = np.concatenate([batch.face_object()[rows]] + [piece.face_owner for piece in pieces])
    face_order = _sorted_rows(owner, batch.count)
    place = np.empty(len(face_order), np.int64)
    place[face_order] = np.arange(len(face_order))
    size = len(face_order)
    faces = np.empty((size, 4), np.int32)
    material = np.empty(size, np.int16)
    uv = np.empty((size, 4, 2), np.float32)
    tint = np.empty((size, 3), np.float32)
    # Each part is written straight to where it belongs.
    at = place[: len(rows)]
    faces[at], material[at] = number[batch.faces[rows]], batch.material[rows]
    uv[at], tint[at] = batch.uv[rows], batch.tint[rows]
    done = len(rows)
    for piece, first in zip(pieces, shift, strict=False):
        at = place[done : done + len(piece.faces)]
        done += len(piece.faces)
        faces[at] = number[np.where(piece.faces >= count, piece.faces + first, piece.faces)]
        table = np.array([names.index(name) for name in piece.materials], np.int16)
        material[at] = table[piece.material]
        uv[at], tint[at] = piece.uv, piece.tint
    return MeshBatch(
        batch.object_id,
        vertex_start,
        _starts(owner, batch.count),
        np.concatenate([batch.vertices, *(piece.vertices for piece in pieces)])[vertex_order],
        faces,
        material,
        tuple(names),
        uv,
        tint,
    )


def _sorted_rows(owner: IntArray, count: int) -> IntArray:
    """Order of (n,) owners below a count; numbers of 16 bits are sorted digit by digit."""
    short = owner.astype(np.uint16) if count <= 1 << 16 else owner
    return np.argsort(short, kind="stable")


def _starts(owner: IntArray, count: int) -> IntArray:
    return np.concatenate([[0], np.cumsum(np.bincount(owner, minlength=count))]).astype(np.int64)
