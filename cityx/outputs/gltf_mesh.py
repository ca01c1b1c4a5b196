"""Meshes as a graphics card wants them: split at corners, welded, y up, local to each object."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cityx.assets.styles.materials import material_named
from cityx.city.mesh import MeshBatch

# Corners of one vertex that may differ in normal, texture place or colour and still be welded
# with their equals; more than this stay apart, which costs bytes and nothing else.
_SLOTS = 4
_MIX = np.array(
    [0x9E3779B97F4A7C15, 0xBF58476D1CE4E5B9, 0x94D049BB133111EB, 0xD6E8FEB86659FD93], np.uint64
)
# Faces handled at a time: their arrays stay in the processor's cache, which doubles the speed.
PIECE = 16_384
UP = np.array([0, 1, 0], np.float32)


def y_up(points: ArrayLike) -> NDArray[np.float64]:
    """Turn (..., 3) points from x east, y north, z up to glTF's x east, y up, z south."""
    points = np.asarray(points, dtype=np.float64)
    turned = np.empty(points.shape)
    turned[..., 0], turned[..., 1], turned[..., 2] = points[..., 0], points[..., 2], -points[..., 1]
    return turned


@dataclass(frozen=True)
class FlatMesh:
    """Vertices and triangles of k objects, s sections (runs of one object and material).

    Attributes
    ----------
    position
        (n, 3) float32, y up, metres from the object's origin.
    normal
        (n, 3) float32, y up, unit.
    uv
        (n, 2) float32, in tiles, v down as in glTF.
    color
        (n, 4) uint8 linear tint with alpha 255, or None when all are white.
    takes_tint
        (n,) whether the material of the vertex takes a tint.
    vertex
        (n,) the vertex of the batch each came from.
    index
        (3 t,) uint32, counted from the first vertex of the object.
    vertex_start
        (k + 1,) int64.
    section_object, section_material
        (s,) int64; the material counts `MeshBatch.materials`.
    section_start
        (s + 1,) int64 into ``index``.
    """

    position: NDArray[np.float32]
    normal: NDArray[np.float32]
    uv: NDArray[np.float32]
    color: NDArray[np.uint8] | None
    takes_tint: NDArray[np.bool_]
    vertex: NDArray[np.int32]
    index: NDArray[np.uint32]
    vertex_start: NDArray[np.int64]
    section_object: NDArray[np.int64]
    section_material: NDArray[np.int64]
    section_start: NDArray[np.int64]

    def one(self, index: int) -> FlatMesh:
        """Return the mesh of one object; its arrays are views of these."""
        rows = slice(*self.vertex_start[index : index + 2].tolist())
        first, last = np.searchsorted(self.section_object, [index, index + 1]).tolist()
        begin, end = self.section_start[[first, last]].tolist()
        return FlatMesh(
            self.position[rows],
            self.normal[rows],
            self.uv[rows],
            None if self.color is None else self.color[rows],
            self.takes_tint[rows],
            self.vertex[rows],
            self.index[begin:end],
            np.array([0, rows.stop - rows.start], np.int64),
            np.zeros(last - first, np.int64),
            self.section_material[first:last],
            self.section_start[first : last + 1] - begin,
        )

    def bounds(self) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
        """(k, 3) least and greatest position per object; zeros for an object without vertices."""
        count = len(self.vertex_start) - 1
        low, high = np.zeros((2, count, 3), np.float32)
        filled = np.flatnonzero(np.diff(self.vertex_start))
        if len(filled):
            starts = self.vertex_start[filled]
            low[filled] = np.minimum.reduceat(self.position, starts, axis=0)
            high[filled] = np.maximum.reduceat(self.position, starts, axis=0)
        return low, high


def origins(batch: MeshBatch) -> NDArray[np.float64]:
    """(k, 3) origin of each object: the middle of its plan and its lowest point, to the centimetre.

    Local coordinates keep float32 exact to micrometres anywhere in a large city.
    """
    result = np.zeros((batch.count, 3))
    filled = np.flatnonzero(np.diff(batch.vertex_start))
    if len(filled):
        starts = batch.vertex_start[filled]
        points = finite(batch.vertices)
        low = np.minimum.reduceat(points, starts, axis=0)
        high = np.maximum.reduceat(points, starts, axis=0)
        middle = (low + high) / 2
        middle[:, 2] = low[:, 2]
        result[filled] = np.round(middle, 2)
    return result


def finite(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Replace what is not a number by 0: one broken vertex must not spoil a whole file."""
    return values if np.isfinite(values).all() else np.nan_to_num(values, posinf=0, neginf=0)


def takes_tint(materials: Sequence[str]) -> NDArray[np.bool_]:
    """(m,) whether each material takes a tint."""
    return np.array([material_named(name).takes_tint for name in materials], bool)


def flat_mesh(
    batch: MeshBatch, origin: NDArray[np.float64], cuts: NDArray[np.int64] | None = None
) -> FlatMesh:
    """Split corners where normal, texture place or tint differ, and weld those that are equal.

    Parameters
    ----------
    origin
        (k, 3) per object, scene frame.
    cuts
        Where the faces are cut into pieces, from 0 to their number; after each `PIECE` if left out.
        Corners of two pieces are not welded.
    """
    order, owner, material, ends = _laid_out(batch)
    faces = len(owner)
    if cuts is None:
        cuts = np.append(np.arange(0, faces, PIECE), faces)
    most = faces * 4  # corners; pages that stay untouched cost nothing
    position, normal = np.empty((most, 3), np.float32), np.empty((most, 3), np.float32)
    uv, color = np.empty((most, 2), np.float32), np.empty((most, 4), np.uint8)
    takes, vertex = np.empty(most, bool), np.empty(most, np.int32)
    index = np.empty(ends[-1], np.uint32)
    counts = np.zeros(batch.count, np.int64)
    count = 0
    for start, stop in pairwise(cuts.tolist()):
        chosen = slice(start, stop) if order is None else order[start:stop]
        piece = _piece(batch, origin, owner[start:stop], material[start:stop], chosen)
        rows = slice(count, count + len(piece.position))
        position[rows], normal[rows] = piece.position, piece.normal
        uv[rows], color[rows] = piece.uv, piece.color
        takes[rows], vertex[rows] = piece.takes_tint, piece.vertex
        # Indices count from the first vertex of the object, which lies in this piece or before it.
        low, high = owner[start], owner[stop - 1] + 1
        own = np.bincount(piece.vertex_owner - low, minlength=high - low)
        before = np.cumsum(own) - own  # of each object in this piece
        before[0] -= counts[low]  # only the first object can have begun earlier
        counts[low:high] += own
        shift = np.repeat(before[owner[start:stop] - low], np.diff(ends[start : stop + 1]))
        index[ends[start] : ends[stop]] = piece.index - shift
        count = rows.stop
    white = bool((color[:count] == 255).all())
    return FlatMesh(
        position[:count],
        normal[:count],
        uv[:count],
        None if white else color[:count],
        takes[:count],
        vertex[:count],
        index,
        np.concatenate([[0], np.cumsum(counts)]).astype(np.int64),
        *_sections(batch, owner, material, ends),
    )


def sections_of(batch: MeshBatch) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.int64]]:
    """Return the object, the material and the start of each section; see `FlatMesh`."""
    return _sections(batch, *_laid_out(batch)[1:])


def _laid_out(
    batch: MeshBatch,
) -> tuple[NDArray[np.int64] | None, NDArray[np.int64], NDArray[np.int16], NDArray[np.int64]]:
    """Return the order of faces in a file, the object and the material of each, and their ends.

    The order is None when they already are in order; ends, (f + 1,), count corners of triangles.
    """
    owner = batch.face_object()
    order = _by_object_and_material(owner, batch.material)
    material, entries = batch.material, np.where(batch.faces[:, 3] >= 0, 6, 3)
    if order is not None:
        owner, material, entries = owner[order], material[order], entries[order]
    return order, owner, material, np.concatenate([[0], np.cumsum(entries)])


def _sections(
    batch: MeshBatch, owner: NDArray[np.int64], material: NDArray[np.int16], ends: NDArray[np.int64]
) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.int64]]:
    cuts = np.flatnonzero(np.diff(owner * (len(batch.materials) + 1) + material, prepend=-1))
    start = np.concatenate([ends[cuts], ends[-1:]]).astype(np.int64)
    return owner[cuts], material[cuts].astype(np.int64), start


@dataclass(frozen=True)
class _Piece:
    """What `flat_mesh` makes of some of the faces, f of them."""

    position: NDArray[np.float32]
    normal: NDArray[np.float32]
    uv: NDArray[np.float32]
    color: NDArray[np.uint8]
    takes_tint: NDArray[np.bool_]
    vertex: NDArray[np.int64]
    vertex_owner: NDArray[np.int64]
    index: NDArray[np.int64]  # from the first vertex of the piece


def _by_object_and_material(
    owner: NDArray[np.int64], material: NDArray[np.int16]
) -> NDArray[np.int64] | None:
    """Order of faces by object and material, or None when they already are in order."""
    down = np.diff(material) < 0
    if not (down & (np.diff(owner) == 0)).any():
        return None
    order = np.argsort(material, kind="stable")  # 16 bits: a radix sort
    return order[np.argsort(owner[order], kind="stable")]


def _piece(
    batch: MeshBatch,
    origin: NDArray[np.float64],
    owner: NDArray[np.int64],
    material: NDArray[np.int16],
    chosen: slice | NDArray[np.int64],
) -> _Piece:
    faces = batch.faces[chosen].astype(np.int64)
    quad = faces[:, 3] >= 0
    fourth = np.where(quad, faces[:, 3], faces[:, 0])
    base, end = int(min(faces[:, :3].min(), fourth.min())), int(faces.max()) + 1
    faces -= base
    fourth -= base
    points = finite(batch.vertices[base:end])
    first, last = (np.searchsorted(batch.vertex_start, (base, end - 1), side="right") - 1).tolist()
    if first == last:
        points = points - origin[first]
    else:
        edges = np.clip(batch.vertex_start[first : last + 2], base, end)
        points = points - np.repeat(origin[first : last + 1], np.diff(edges), axis=0)
    points = y_up(points)
    normal = _face_normals(points, faces, fourth)
    takes = takes_tint(batch.materials)[material]
    color = _face_colors(takes, batch.tint[chosen])
    places = _uv_in_tiles(batch.materials, material, batch.uv[chosen])
    vertex, places, sides, index = _corners(faces, quad, places)
    face = np.repeat(np.arange(len(faces)), sides)
    same_as = _welded(vertex, face, _face_codes(normal, color, takes), places, end - base)
    kept = np.zeros(len(vertex), bool)
    kept[same_as] = True
    new = np.cumsum(kept) - 1
    corner = np.flatnonzero(kept)
    vertex, face = vertex[corner], face[corner]
    return _Piece(
        points.astype(np.float32).take(vertex, axis=0),
        normal.take(face, axis=0),
        places.take(corner, axis=0),
        color.take(face, axis=0),
        takes[face],
        vertex + base,
        owner[face],
        new[same_as if index is None else same_as[index]],
    )


def _face_normals(
    points: NDArray[np.float64], faces: NDArray[np.int64], last: NDArray[np.int64]
) -> NDArray[np.float32]:
    """(f, 3) unit normals; a face without area points up."""
    one = points.take(faces[:, 2], axis=0) - points.take(faces[:, 0], axis=0)
    two = points.take(last, axis=0) - points.take(faces[:, 1], axis=0)
    (ax, ay, az), (bx, by, bz) = one.T, two.T
    x, y, z = ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx
    length = np.sqrt(x * x + y * y + z * z)
    flat = length < 1e-12  # square metres
    factor = 1 / np.where(flat, 1, length)
    normal = np.empty((len(x), 3), np.float32)
    normal[:, 0], normal[:, 1], normal[:, 2] = x * factor, y * factor, z * factor
    normal[flat] = UP
    return normal


def _face_colors(takes: NDArray[np.bool_], tint: NDArray[np.float32]) -> NDArray[np.uint8]:
    """(f, 4) colour of each face, white where the material takes no tint."""
    color = np.full((len(tint), 4), 255, np.uint8)
    shown = np.clip(np.nan_to_num(tint, nan=1.0), 0, 1) * np.float32(255) + np.float32(0.5)
    color[:, :3] = shown.astype(np.uint8)
    color[~takes] = 255
    return color


def _uv_in_tiles(
    materials: tuple[str, ...], material: NDArray[np.int16], uv: NDArray[np.float32]
) -> NDArray[np.float32]:
    tiles = np.array([material_named(name).tile for name in materials] or [1.0], np.float32)
    scale = np.stack([1 / tiles, -1 / tiles], axis=1)[material]  # (f, 2)
    if not np.isfinite(uv).all():
        uv = np.nan_to_num(uv, posinf=0, neginf=0)
    return cast(NDArray[np.float32], uv * scale[:, None, :] + np.float32(0))  # no -0


def _corners(
    faces: NDArray[np.int64], quad: NDArray[np.bool_], places: NDArray[np.float32]
) -> tuple[
    NDArray[np.int64], NDArray[np.float32], NDArray[np.int64] | int, NDArray[np.int64] | None
]:
    """List corners face by face: vertex, texture place, corners per face, corners of triangles.

    The corners of triangles are None when they are all corners in order.
    """
    fan = np.array([0, 1, 2, 0, 2, 3])
    if not quad.any():
        return faces[:, :3].ravel(), places[:, :3].reshape(-1, 2), 3, None
    if quad.all():
        index = (np.arange(0, 4 * len(faces), 4)[:, None] + fan).ravel()
        return faces.ravel(), places.reshape(-1, 2), 4, index
    used = np.ones((len(faces), 6), bool)
    used[:, 3] = quad
    vertex, places = faces[used[:, :4]], places[used[:, :4]]
    used[:, 4] = used[:, 5] = quad
    sides = 3 + quad
    return vertex, places, sides, ((np.cumsum(sides) - sides)[:, None] + fan)[used]


def _face_codes(
    normal: NDArray[np.float32], color: NDArray[np.uint8], takes: NDArray[np.bool_]
) -> NDArray[np.uint64]:
    """(f,) hash of what all corners of a face share."""
    with np.errstate(over="ignore"):
        # Adding 1536 leaves steps of 1/8192: nearly equal normals get equal bits.
        bits = (normal + np.float32(1536)).view(np.uint32).astype(np.uint64)
        paint = color.view(np.uint32)[:, 0].astype(np.uint64) * np.uint64(2) + takes
        code = bits[:, 0] * _MIX[0] ^ bits[:, 1] * _MIX[1] ^ bits[:, 2] * _MIX[2]
        return cast(NDArray[np.uint64], code ^ paint * _MIX[3])


def _welded(
    vertex: NDArray[np.int64],
    face: NDArray[np.int64],
    face_code: NDArray[np.uint64],
    places: NDArray[np.float32],
    vertices: int,
) -> NDArray[np.int64]:
    """(c,) for each corner the corner that stands for it: itself or an equal one."""
    with np.errstate(over="ignore"):
        code = np.ascontiguousarray(places).view(np.uint64).ravel()
        code = (code ^ (code >> np.uint64(29)) ^ face_code[face]) * _MIX[1]
        code ^= code >> np.uint64(32)
    slot = (code & np.uint64(_SLOTS - 1)).view(np.int64)
    slot += vertex * _SLOTS
    numbers = np.arange(len(vertex))
    table = np.empty(vertices * _SLOTS, np.int64)
    table[slot] = numbers  # the last corner of a slot stands for its equals
    candidate = table[slot]
    return np.where(code[candidate] == code, candidate, numbers)
