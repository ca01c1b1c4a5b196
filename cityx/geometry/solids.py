"""Solids: closed shells of many parts in one set of arrays, and what must hold of them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from cityx.geometry.polygons import FloatArray, IntArray

if TYPE_CHECKING:
    from cityx.city.mesh import MeshBatch

NO_VERTEX = -1  # fourth index of a triangle
WALL, ROOF, TRIM, GLAZED = 0, 1, 2, 3  # roles of faces
LEVEL = 0.999  # cosine; an underside is level within 2.5 degrees
MIN_FACE = 1e-6  # square metres


@dataclass(frozen=True)
class Solids:
    """Shells of parts, n vertices and f faces; each part is closed by itself.

    Attributes
    ----------
    vertices
        (n, 3) float64.
    vertex_part, face_part
        (n,) and (f,) int64, row of the part.
    faces
        (f, 4) int64 into ``vertices``, counter-clockwise from outside, triangles with -1.
    role
        (f,) int8: `WALL`, `ROOF`, `TRIM` or `GLAZED`.
    uv
        (f, 4, 2) float32, metres.
    """

    vertices: FloatArray
    vertex_part: IntArray
    faces: IntArray
    face_part: IntArray
    role: NDArray[np.int8]
    uv: NDArray[np.float32]

    def of_parts(self, chosen: NDArray[np.bool_]) -> Solids:
        """Return the solids of the parts marked in a mask over part rows."""
        vertex, face = chosen[self.vertex_part], chosen[self.face_part]
        number = np.cumsum(vertex) - 1
        faces = self.faces[face]
        return Solids(
            self.vertices[vertex],
            self.vertex_part[vertex],
            np.where(faces == NO_VERTEX, NO_VERTEX, number[faces]),
            self.face_part[face],
            self.role[face],
            self.uv[face],
        )


def no_solids() -> Solids:
    """Return solids of no part."""
    return Solids(
        np.zeros((0, 3)),
        np.zeros(0, np.int64),
        np.zeros((0, 4), np.int64),
        np.zeros(0, np.int64),
        np.zeros(0, np.int8),
        np.zeros((0, 4, 2), np.float32),
    )


def join_solids(pieces: Sequence[Solids]) -> Solids:
    """Put solids behind each other."""
    if not pieces:
        return no_solids()
    shift = np.cumsum([0] + [len(piece.vertices) for piece in pieces])
    return Solids(
        np.concatenate([piece.vertices for piece in pieces]),
        np.concatenate([piece.vertex_part for piece in pieces]),
        np.concatenate(
            [
                np.where(piece.faces == NO_VERTEX, NO_VERTEX, piece.faces + first)
                for piece, first in zip(pieces, shift, strict=False)
            ]
        ),
        np.concatenate([piece.face_part for piece in pieces]),
        np.concatenate([piece.role for piece in pieces]),
        np.concatenate([piece.uv for piece in pieces]),
    )


def as_quads(triangles: IntArray) -> IntArray:
    """Give (t, 3) triangles the fourth column of a face table."""
    return np.column_stack([triangles, np.full(len(triangles), NO_VERTEX, np.int64)])


def face_uv(uv: FloatArray, faces: IntArray) -> NDArray[np.float32]:
    """Look up (f, 4, 2) texture coordinates from one pair per vertex."""
    found = uv[faces].astype(np.float32)
    found[faces == NO_VERTEX] = 0.0
    return found


def open_groups(
    faces: NDArray[np.int64] | NDArray[np.int32], group: IntArray, vertices: int, groups: int
) -> NDArray[np.bool_]:
    """Mark the groups of faces in which some edge lacks its one reverse.

    Parameters
    ----------
    faces
        (f, 4) vertex numbers, triangles with -1.
    group
        (f,) group of each face, below `groups`.
    vertices
        Number of vertices.
    groups
        Number of groups.
    """
    quad = faces[:, 3] != NO_VERTEX
    third = np.where(quad, faces[:, 3], faces[:, 0])
    begin = np.concatenate([faces[:, 0], faces[:, 1], faces[:, 2], faces[quad, 3]]).astype(np.int64)
    end = np.concatenate([faces[:, 1], faces[:, 2], third, faces[quad, 0]]).astype(np.int64)
    low, high = np.minimum(begin, end), np.maximum(begin, end)
    key = (low * vertices + high) * 2 + (begin > end)
    owner = np.concatenate([group, group, group, group[quad]])
    order = np.argsort(key, kind="stable")
    key = key[order]
    # In a closed shell the keys come in pairs 2k, 2k + 1.
    paired = np.zeros(len(key), bool)
    if len(key) > 1:
        partner = (key[1:] == key[:-1] + 1) & (key[:-1] % 2 == 0)
        paired[:-1] |= partner
        paired[1:] |= partner
        same = key[1:] == key[:-1]
        paired[:-1] &= ~same
        paired[1:] &= ~same
    wrong = ~paired | (low[order] == high[order])
    found = np.zeros(groups, bool)
    found[owner[order[wrong]]] = True
    return found


def open_parts(solids: Solids, parts: int) -> NDArray[np.bool_]:
    """Mark the parts that are not closed, (parts,) bool."""
    return open_groups(solids.faces, solids.face_part, len(solids.vertices), parts)


def area_vectors(vertices: FloatArray, faces: NDArray[np.int32] | IntArray) -> FloatArray:
    """Return the area vector of each face, (f, 3) square metres, pointing outward."""
    a, b, c = (vertices[faces[:, i]] for i in range(3))
    d = vertices[np.where(faces[:, 3] == NO_VERTEX, faces[:, 0], faces[:, 3])]
    p, q = c - a, d - b
    double = np.stack(
        [
            p[:, 1] * q[:, 2] - p[:, 2] * q[:, 1],
            p[:, 2] * q[:, 0] - p[:, 0] * q[:, 2],
            p[:, 0] * q[:, 1] - p[:, 1] * q[:, 0],
        ],
        axis=1,
    )
    return np.asarray(double / 2)


def volumes_by_group(
    vertices: FloatArray, faces: NDArray[np.int32] | IntArray, group: IntArray, groups: int
) -> FloatArray:
    """Signed volume of each closed group of faces, (groups,) cubic metres."""
    origin = np.zeros((groups, 3))
    origin[group] = vertices[faces[:, 0]]  # any vertex near the group keeps the sums small
    a, b, c = (vertices[faces[:, i]] - origin[group] for i in range(3))
    total = np.einsum("ij,ij->i", a, np.cross(b, c))
    quad = np.flatnonzero(faces[:, 3] != NO_VERTEX)
    d = vertices[faces[quad, 3]] - origin[group[quad]]
    total[quad] += np.einsum("ij,ij->i", a[quad], np.cross(c[quad], d))
    return np.asarray(np.bincount(group, total / 6.0, minlength=groups), float)


def check_closed(batch: MeshBatch) -> NDArray[np.bool_]:
    """Tell for each object whether every directed edge has its reverse exactly once.

    Vertices count as they are indexed; positions are not welded. An object without faces is open.

    Returns
    -------
    closed
        (k,) bool.
    """
    owner = batch.face_object()
    found = open_groups(batch.faces, owner, max(len(batch.vertices), 1), batch.count)
    return ~found & (np.diff(batch.face_start) > 0)


def volume(batch: MeshBatch) -> FloatArray:
    """Return the signed volume of each object, (k,) cubic metres; positive means outward faces."""
    return volumes_by_group(batch.vertices, batch.faces, batch.face_object(), batch.count)


def _undersides(
    batch: MeshBatch, without: Sequence[str], below: FloatArray | None
) -> tuple[FloatArray, NDArray[np.bool_]]:
    """Return the area vector of each face, (f, 3), and which are level undersides, (f,)."""
    normal = area_vectors(batch.vertices, batch.faces)
    size = np.linalg.norm(normal, axis=1)
    under = -normal[:, 2] > LEVEL * size
    skipped = [i for i, name in enumerate(batch.materials) if name in without]
    if below is not None:
        under &= batch.vertices[batch.faces[:, 0], 2] < below[batch.face_object()]
    return normal, np.asarray(under & ~np.isin(batch.material, skipped))


def plan_area(
    batch: MeshBatch, *, without: Sequence[str] = ("trim",), below: FloatArray | None = None
) -> FloatArray:
    """Return the ground that each object covers, (k,) square metres.

    The level undersides are summed, so eaves (whose material is named in `without`), domes that
    bulge and roofs cut into many faces do not count twice.

    Parameters
    ----------
    without
        Materials whose faces do not count.
    below
        (k,) metres, height of each object below which undersides count; all do when left out.
    """
    normal, counted = _undersides(batch, without, below)
    area = np.bincount(batch.face_object()[counted], -normal[counted, 2], minlength=batch.count)
    return np.asarray(area, float)


def plan_middle(
    batch: MeshBatch, *, without: Sequence[str] = ("trim",), below: FloatArray | None = None
) -> FloatArray:
    """Return the middle of the ground that each object covers, (k, 2) metres; NaN for none.

    It is the centroid of the level undersides, see `plan_area`.
    """
    counted = _undersides(batch, without, below)[1]
    triangles, face = batch.triangles()
    kept = counted[face]
    a, b, c = batch.vertices[triangles[kept], :2].transpose(1, 0, 2)
    u, v = b - a, c - a
    weight = np.abs(u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0])
    owner = batch.face_object()[face[kept]]
    sums = [
        np.bincount(owner, values, minlength=batch.count)
        for values in (weight, *(weight[:, None] * (a + b + c) / 3).T)
    ]
    total = np.where(sums[0] > 0, sums[0], np.nan)
    return np.column_stack([sums[1] / total, sums[2] / total])


def degenerate_faces(batch: MeshBatch, *, smallest: float = MIN_FACE) -> NDArray[np.bool_]:
    """Mark the faces smaller than `smallest` square metres, (f,) bool."""
    return np.asarray(np.linalg.norm(area_vectors(batch.vertices, batch.faces), axis=1) < smallest)


def has_nan(batch: MeshBatch) -> NDArray[np.bool_]:
    """Tell for each object whether a coordinate of a vertex or of its texture is not finite."""
    bad = np.zeros(batch.count, bool)
    owner = np.repeat(np.arange(batch.count), np.diff(batch.vertex_start))
    bad[owner[~np.isfinite(batch.vertices).all(axis=1)]] = True
    bad[batch.face_object()[~np.isfinite(batch.uv).all(axis=(1, 2))]] = True
    return bad
