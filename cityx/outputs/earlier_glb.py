"""Meshes of an earlier file of a city, so that only what changed is made anew.

The arrays of a mesh layer and the bodies of its objects lie in the file as `write_glb` would make
them again. They are looked up by the layout that it writes; a file of another layout is no use.
"""

from __future__ import annotations

import json
import os
import re
import struct
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import islice, pairwise
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cityx.assets.colliders import standing_fast
from cityx.city.mesh import NO_VERTEX, MeshBatch, same_objects
from cityx.outputs import gltf_mesh
from cityx.outputs.gltf_buffer import ELEMENT_ARRAY_BUFFER
from cityx.outputs.gltf_mesh import FlatMesh, flat_mesh, sections_of
from cityx.version import __version__

HEAD = 20  # bytes before the text of a GLB
AFTER = 8  # bytes between the text and the arrays
_COUNT = re.compile(r'"count":(\d+),"type":"VEC3",(?:"byteOffset":(\d+),)?"min":')
_BODY = re.compile(r'"body":(\{[^{}]*\})')
Body = dict[str, str | float]


@dataclass(frozen=True)
class EarlierLayer:
    """A layer of meshes as a file has it.

    Attributes
    ----------
    batch
        What was written, k objects.
    count
        (k,) int64, vertices of each in the file.
    arrays
        Positions, normals, texture places and, unless all are white, colours, as of `FlatMesh`.
    index
        (3 t,) uint16 or uint32.
    bodies
        Of each object; empty for one without faces.
    """

    batch: MeshBatch
    count: NDArray[np.int64]
    arrays: tuple[NDArray[Any], ...]
    index: NDArray[Any]
    bodies: Sequence[Body]

    def bodies_of(self, name: str, batch: MeshBatch) -> list[Body]:
        """Return the bodies of a layer like this one, as of `standing_fast`."""
        if batch is self.batch:
            return list(self.bodies)
        at, same = self._same(batch)
        same &= np.diff(batch.face_start) > 0
        anew = iter(standing_fast(name, batch.take(np.flatnonzero(~same))))
        return [self.bodies[row] if kept else next(anew)
                for row, kept in zip(at.tolist(), same.tolist(), strict=True)]  # fmt: skip

    def flat(self, batch: MeshBatch, origin: NDArray[np.float64]) -> FlatMesh:
        """Flatten a layer like this one, as of `flat_mesh`; what is the same is copied.

        ``takes_tint`` and ``vertex`` stay empty.
        """
        if batch is self.batch:
            start = _starts(self.count)
            return _flat(batch, start, [*self.arrays, None][:4], self.index)
        at, same = self._same(batch)
        same &= self._cut_alike(batch, at)
        changed = np.flatnonzero(~same)
        part = batch.take(changed)
        fresh = flat_mesh(part, origin[changed], _cuts(batch, part, changed))
        count = self.count[at]
        count[changed] = np.diff(fresh.vertex_start)
        start, ends = _starts(count), _index_starts(batch)
        old, old_ends = _starts(self.count), _index_starts(self.batch)
        new_ends = _index_starts(part)
        shapes = ((3, np.float32), (3, np.float32), (2, np.float32), (4, np.uint8))
        arrays = [np.empty((int(start[-1]), width), kind) for width, kind in shapes]
        arrays[3][:] = 255
        index = np.empty(int(ends[-1]), np.uint32)
        row = np.where(same, at, np.cumsum(~same) - 1)
        breaks = np.flatnonzero((np.diff(row) != 1) | (np.diff(same) != 0)) + 1
        for first, end in pairwise([0, *breaks.tolist(), batch.count]):
            kept, begin, last = same[first], row[first], row[end - 1] + 1
            given = self.arrays if kept else (fresh.position, fresh.normal, fresh.uv, fresh.color)
            rows = (old if kept else fresh.vertex_start)[[begin, last]]
            for array, values in zip(arrays, given, strict=False):
                if values is not None:
                    array[start[first] : start[end]] = values[rows[0] : rows[1]]
            source, rows = (self.index, old_ends) if kept else (fresh.index, new_ends)
            index[ends[first] : ends[end]] = source[rows[begin] : rows[last]]
        shown = None if (arrays[3] == 255).all() else arrays[3]
        return _flat(batch, start, [*arrays[:3], shown], index)

    def _same(self, batch: MeshBatch) -> tuple[NDArray[np.int64], NDArray[np.bool_]]:
        """(k,) the row of this layer by the id of each object, and whether it is the same."""
        own = self.batch.object_id
        at = np.minimum(np.searchsorted(own, batch.object_id), len(own) - 1)
        known = self.batch.materials == batch.materials[: len(self.batch.materials)]
        rising = all((ids[1:] > ids[:-1]).all() for ids in (own, batch.object_id))
        if not (known and rising):
            return at, np.zeros(batch.count, bool)
        return at, same_objects(batch, self.batch)

    def _cut_alike(self, batch: MeshBatch, at: NDArray[np.int64]) -> NDArray[np.bool_]:
        """(k,) whether `flat_mesh` cuts each object at the same faces; most lie in one piece."""
        begin, other = batch.face_start[:-1], self.batch.face_start[:-1][at]
        whole = _in_one_piece(batch) & _in_one_piece(self.batch)[at]
        return np.asarray(whole | (begin % gltf_mesh.PIECE == other % gltf_mesh.PIECE))


def _starts(count: NDArray[np.int64]) -> NDArray[np.int64]:
    return np.concatenate([[0], np.cumsum(count)]).astype(np.int64)


def _index_starts(batch: MeshBatch) -> NDArray[np.int64]:
    """(k + 1,) where the corners of triangles of each object begin."""
    entries = np.where(batch.faces[:, 3] != NO_VERTEX, 6, 3)
    return np.asarray(_starts(entries)[batch.face_start], np.int64)


def _in_one_piece(batch: MeshBatch) -> NDArray[np.bool_]:
    first, last = batch.face_start[:-1], batch.face_start[1:] - 1
    return np.asarray((last < first) | (first // gltf_mesh.PIECE == last // gltf_mesh.PIECE))


def _cuts(batch: MeshBatch, part: MeshBatch, chosen: NDArray[np.int64]) -> NDArray[np.int64]:
    """Return where to cut some objects of a batch so that each is cut as within the batch."""
    piece = gltf_mesh.PIECE
    borders = np.arange(piece, len(batch.faces), piece)
    owner = np.searchsorted(batch.face_start, borders, side="right") - 1
    inner = (batch.face_start[owner] < borders) & np.isin(owner, chosen)
    borders, owner = borders[inner], owner[inner]
    within = part.face_start[np.searchsorted(chosen, owner)] + borders - batch.face_start[owner]
    whole = part.face_start[np.flatnonzero(np.diff(part.face_start // piece, prepend=0))]
    cuts = np.concatenate([[0], within, whole, [len(part.faces)]])
    return np.asarray(np.unique(cuts), np.int64)


def _flat(
    batch: MeshBatch, start: NDArray[np.int64], arrays: Sequence[Any], index: NDArray[Any]
) -> FlatMesh:
    position, normal, uv, color = arrays
    nothing = np.zeros(0, bool), np.zeros(0, np.int32)
    return FlatMesh(position, normal, uv, color, *nothing, index, start, *sections_of(batch))


def read_earlier(path: Path, meshes: Mapping[str, MeshBatch], most: int) -> dict[str, EarlierLayer]:
    """Read the layers of meshes of a file; none if it is not as `write_glb` writes them.

    Parameters
    ----------
    path
        File of `write_glb`. It stays mapped, so it may be replaced but not written to.
    meshes
        The layers of the city that it shows.
    most
        Objects of a layer, above which they are merged.
    """
    if os.name != "posix":  # elsewhere a mapped file cannot be replaced
        return {}
    try:
        return _read(path, meshes, most)
    except (OSError, ValueError, KeyError, struct.error):
        return {}


def _read(path: Path, meshes: Mapping[str, MeshBatch], most: int) -> dict[str, EarlierLayer]:
    names = [name for name, batch in sorted(meshes.items()) if len(batch.faces)]
    if any(meshes[name].count > most for name in names):
        return {}
    with path.open("rb") as file:
        _, _, size, length, _ = struct.unpack("<4sIII4s", file.read(HEAD))
        text = file.read(length).decode()
    if size != path.stat().st_size or f'"generator":"CityX {__version__}"' not in text[:10_000]:
        return {}
    views, place = json.JSONDecoder().raw_decode(text, _after(text, '"bufferViews":', 0))
    filled = {name: np.flatnonzero(np.diff(meshes[name].face_start) > 0) for name in names}
    total = sum(map(len, filled.values()))
    counts = islice(_COUNT.finditer(text, _after(text, '"accessors":', place)), total)
    counted = np.array([(found[1], found[2] or 0) for found in counts], np.int64).reshape(-1, 2)
    nodes = islice(_BODY.finditer(text, _after(text, '"nodes":', place)), total)
    bodies = json.loads(f"[{','.join(found[1] for found in nodes)}]")
    if not len(counted) == len(bodies) == total:
        return {}
    data = np.memmap(path, np.uint8, "r", HEAD + length + AFTER)
    groups = _groups(views, data)
    layers: dict[str, EarlierLayer] = {}
    done = 0
    for name, arrays in zip(names, islice(groups, len(names)), strict=True):
        own = filled[name]
        some = slice(done, done + len(own))
        made = _layer(meshes[name], own, counted[some], arrays, bodies[some])
        if made is None:
            return {}
        layers[name], done = made, some.stop
    return layers


def _after(text: str, word: str, begin: int) -> int:
    return text.index(word, begin) + len(word)


def _groups(views: Sequence[Mapping[str, Any]], data: NDArray[np.uint8]) -> Any:
    """Yield the arrays of bytes of each mesh, the corners of its triangles last, with strides."""
    held: list[tuple[int, NDArray[np.uint8]]] = []
    for view in views:
        if "target" in view:
            begin = view["byteOffset"]
            own = data[begin : begin + view["byteLength"]]
            held.append((view.get("byteStride", 0), own))
            if view["target"] == ELEMENT_ARRAY_BUFFER:
                yield held
                held = []


def _layer(
    batch: MeshBatch, filled: NDArray[np.int64], counted: NDArray[np.int64],
    held: Sequence[tuple[int, NDArray[np.uint8]]], bodies: Sequence[Body],
) -> EarlierLayer | None:  # fmt: skip
    """Return a layer of its bytes, None if they are not what its objects need."""
    count = np.zeros(batch.count, np.int64)
    count[filled] = counted[:, 0]
    *given, (_, corners) = held
    strides = [stride for stride, _ in given]
    index = corners.view(np.uint16 if count.max() <= 65535 else np.uint32)
    total = int(count.sum())
    fits = (
        strides in ([12, 12, 8], [12, 12, 8, 4])
        and all(len(values) == stride * total for stride, values in given)
        and len(index) == int(_index_starts(batch)[-1])
        and np.array_equal(counted[:, 1], 12 * _starts(counted[:, 0])[:-1])
    )
    if not fits:
        return None
    kinds = (np.float32, np.float32, np.float32, np.uint8)
    arrays = tuple(
        values.view(kind).reshape(total, -1)
        for (_, values), kind in zip(given, kinds, strict=False)
    )
    every: list[Body] = [{} for _ in range(batch.count)]
    for row, body in zip(filled.tolist(), bodies, strict=True):
        every[row] = body
    return EarlierLayer(batch, count, arrays, index, every)
