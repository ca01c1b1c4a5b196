"""Solids: closed shells of many parts in one set of arrays, and what must hold of them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cityx.geometry.arrays import FloatArray, IntArray
from cityx.ids import mix

NO_VERTEX = -1  # fourth index of a triangle
WALL, ROOF, TRIM, GLAZED = 0, 1, 2, 3  # roles of faces
LEVEL = 0.999  # cosine; an underside is level within 2.5 degrees
MIN_FACE = 1e-6  # square metres
AT_ONCE = 8192  # faces whose vectors stay in the processor's cache


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
    key = (np.minimum(begin, end) * vertices + np.maximum(begin, end)) * 2 + (begin > end)
    ordered = np.sort(key)
    # In a closed shell the keys come in pairs 2k, 2k + 1.
    paired = np.zeros(len(key), bool)
    if len(key) > 1:
        partner = (ordered[1:] == ordered[:-1] + 1) & (ordered[:-1] % 2 == 0)
        paired[:-1] |= partner
        paired[1:] |= partner
        same = ordered[1:] == ordered[:-1]
        paired[:-1] &= ~same
        paired[1:] &= ~same
    lone = np.unique(ordered[~paired])
    wrong = begin == end
    if len(lone):
        wrong |= lone[np.minimum(np.searchsorted(lone, key), len(lone) - 1)] == key
    owner = np.concatenate([group, group, group, group[quad]])
    found = np.zeros(groups, bool)
    found[owner[wrong]] = True
    return found


def surely_open(
    faces: NDArray[np.int64] | NDArray[np.int32], start: IntArray, vertices: int
) -> NDArray[np.bool_]:
    """Mark the runs of faces in which some edge lacks its reverse, most of them at first sight.

    Each edge counts a number drawn for its ends, and its reverse the same less: where they do not
    cancel out, something is open. Where they do, `open_groups` tells.

    Parameters
    ----------
    faces
        (f, 4) vertex numbers, triangles with -1.
    start
        (r + 1,) where each run begins; no two share a vertex.
    vertices
        Number of vertices.
    """
    number = np.arange(vertices, dtype=np.uint64)
    one, other = mix(number), mix(~number)
    corners = [faces[:, 0], faces[:, 1], faces[:, 2],
               np.where(faces[:, 3] == NO_VERTEX, faces[:, 0], faces[:, 3])]  # fmt: skip
    p, q = [one[corner] for corner in corners], [other[corner] for corner in corners]
    total = np.zeros(len(faces), np.uint64)  # modulo 2 ** 64
    for side in range(4):
        total += p[side - 1] * q[side] - q[side - 1] * p[side]
    sums = np.append(np.uint64(0), np.cumsum(total))[start]
    return np.asarray(sums[1:] != sums[:-1])


def open_parts(solids: Solids, parts: int) -> NDArray[np.bool_]:
    """Mark the parts that are not closed, (parts,) bool."""
    return open_groups(solids.faces, solids.face_part, len(solids.vertices), parts)


def area_vectors(vertices: FloatArray, faces: NDArray[np.int32] | IntArray) -> FloatArray:
    """Return the area vector of each face, (f, 3) square metres, pointing outward."""
    a, b, c = (vertices[faces[:, i]] for i in range(3))
    d = vertices[np.where(faces[:, 3] == NO_VERTEX, faces[:, 0], faces[:, 3])]
    p, q = c - a, d - b
    return np.asarray(_cross(p, q) / 2)


def face_areas(vertices: FloatArray, faces: NDArray[np.int32] | IntArray) -> FloatArray:
    """Return the area of each face, (f,) square metres; found in the processor's cache."""
    found = np.empty(len(faces))
    for first in range(0, len(faces), AT_ONCE):
        some = slice(first, first + AT_ONCE)
        found[some] = np.linalg.norm(area_vectors(vertices, faces[some]), axis=1)
    return found


def _cross(p: FloatArray, q: FloatArray) -> FloatArray:
    """Return the cross products of rows, in a third of the time that NumPy's own takes."""
    (px, py, pz), (qx, qy, qz) = p.T, q.T
    found = np.empty(p.shape)
    found[:, 0], found[:, 1], found[:, 2] = py * qz - pz * qy, pz * qx - px * qz, px * qy - py * qx
    return found


def volumes_by_group(
    vertices: FloatArray, faces: NDArray[np.int32] | IntArray, group: IntArray, groups: int
) -> FloatArray:
    """Signed volume of each closed group of faces, (groups,) cubic metres."""
    origin = np.zeros((groups, 3))
    origin[group] = vertices[faces[:, 0]]  # any vertex near the group keeps the sums small
    near = origin[group]
    a, b, c = (vertices[faces[:, i]] - near for i in range(3))
    total = np.einsum("ij,ij->i", a, _cross(b, c))
    quad = np.flatnonzero(faces[:, 3] != NO_VERTEX)
    d = vertices[faces[quad, 3]] - near[quad]
    total[quad] += np.einsum("ij,ij->i", a[quad], _cross(c[quad], d))
    return np.asarray(np.bincount(group, total / 6.0, minlength=groups), float)
