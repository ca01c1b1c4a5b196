"""What a tile shows, as glTF 2.0 binary: meshes and instances whose parts tell their objects by id.

The arrays are those of the viewer's chunks, small and packed. Here prototypes lie in the file and
are placed by ``EXT_mesh_gpu_instancing``, as programs want that know tiles but not our viewer; ids
of instances are a property table (``EXT_instance_features``), those of what hangs on a building are
the building's.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from cityx.city.content import ContentHash
from cityx.city.mesh import MeshBatch
from cityx.city.scene import Prototype
from cityx.city.store import View
from cityx.geometry.arrays import FloatArray
from cityx.outputs.gltf_mesh import flat_mesh, y_up
from cityx.tiles.ownership import faces_alone, middles_of
from cityx.viewer.chunks import CELL, Chunk, Rows, chunks_of
from cityx.viewer.content import INSTANCING, ContentFile
from cityx.viewer.library import forms_of

FEATURES = "EXT_instance_features"
NEAR, FAR = 35.0, 240.0  # metres from which trees of a cell and of a whole tile are seen
TURN = 32767.0  # of a quaternion in 16 bits
MOST = 4_000_000  # bytes of a file: what a page waits for at a time
GAIN = 0.9  # of a file, what a half of it is smaller than, or it stays whole


@dataclass(frozen=True)
class Cell:
    """What is shown of one square of a tile.

    Attributes
    ----------
    name
        Of the file, without its ending.
    place, edge
        Column and row of the square among all of its edge, in metres; those of half an edge lie in
        those of the whole. The edge of a whole tile is 0.
    box
        (2, 3) metres of the frame, lowest and highest coordinates.
    glb
        The file.
    """

    name: str
    place: tuple[int, int]
    edge: float
    box: NDArray[np.float64]
    glb: bytes

    def holds(self, other: Cell) -> bool:
        """Return whether another square lies in this one."""
        steps = self.edge / other.edge if self.edge else 0.0
        return not steps or all(
            own == there // steps for own, there in zip(self.place, other.place, strict=True)
        )


def cells_of(view: View, content: ContentHash, centre: FloatArray) -> list[Cell]:
    """Return the cells of a tile, each with all its layers.

    One whose file would be larger than `MOST` has several, each with a part of what it shows: its
    quarters would be larger together, since most of a file are prototypes.

    Parameters
    ----------
    centre
        (3,) metres of the frame, where the files have their origin.
    """
    found = []
    for place, chunks in _squares(view, content, CELL):
        cell = _cell(f"{place[0]}_{place[1]}", place, CELL, view, chunks, centre, NEAR)
        found += _halved(cell, view, chunks, centre)
    return found


def overviews_of(view: View, content: ContentHash, centre: FloatArray, size: float) -> list[Cell]:
    """Return a whole tile as one file, none if it shows nothing.

    Where that would be larger than `MOST` it is several, of squares that cells lie in.

    Parameters
    ----------
    centre
        As of `cells_of`.
    size
        Of the tile, metres.
    """
    chunks, _ = chunks_of(view, content)
    if not chunks:
        return []
    whole = _cell("whole", (0, 0), 0.0, view, chunks, centre, FAR)
    edge = CELL
    while 2 * edge < size:
        edge *= 2
    found = [whole]
    while max(len(each.glb) for each in found) > MOST and edge >= CELL:
        found = [
            _cell(f"whole_{place[0]}_{place[1]}", place, edge, view, own, centre, FAR)
            for place, own in _squares(view, content, edge)
        ]
        edge /= 2
    return found


def _squares(
    view: View, content: ContentHash, edge: float
) -> list[tuple[tuple[int, int], list[Chunk]]]:
    """Return what lies in each square of an edge."""
    groups: dict[tuple[int, int], list[Chunk]] = {}
    for chunk in chunks_of(view, content, edge=edge)[0]:
        groups.setdefault(chunk.cell, []).append(chunk)
    return sorted(groups.items())


def _cell(
    name: str, place: tuple[int, int], edge: float, view: View, chunks: Sequence[Chunk],
    centre: FloatArray, beyond: float,
) -> Cell:  # fmt: skip
    file = ContentFile(0)
    prototypes = {prototype.name: prototype for prototype in view.scene.prototypes}
    nodes = []
    for chunk in chunks:
        for layer in sorted(chunk.meshes):
            nodes += file.merged(layer, chunk.meshes[layer], chunk.corner)
        for layer in sorted(chunk.rows):
            nodes += _instanced(file, layer, chunk.rows[layer], chunk.corner, prototypes, beyond)
    places = np.array([chunk.box for chunk in chunks])
    box = np.array([places[:, 0].min(axis=0), places[:, 1].max(axis=0)])
    root = {"name": name, "children": nodes, "translation": (-y_up(centre)).tolist()}
    glb = file.bytes([file.buffer.add("nodes", root)], view.attribution)
    return Cell(name, place, edge, box, glb)


def _halved(cell: Cell, view: View, chunks: Sequence[Chunk], centre: FloatArray) -> list[Cell]:
    """Return a cell, or two halves of what it shows, halved again while a file is too large."""
    if len(cell.glb) <= MOST:
        return [cell]
    parts = list(_parts(chunks))
    if len(parts) < 2:
        parts = _pieces(parts[0])
    if len(parts) < 2:  # one triangle, or one row
        return [cell]
    halves = [
        (_cell(cell.name + letter, cell.place, cell.edge, view, some, centre, NEAR), some)
        for letter, some in zip("ab", (parts[::2], parts[1::2]), strict=True)
    ]
    if max(len(half.glb) for half, _ in halves) > GAIN * len(cell.glb):
        return [cell]  # one prototype is all of it
    return [part for half, some in halves for part in _halved(half, view, some, centre)]


def _parts(chunks: Sequence[Chunk]) -> Iterator[Chunk]:
    """Yield what can be shown by itself: meshes of a layer, rows of a prototype."""
    for chunk in chunks:
        for layer, batch in sorted(chunk.meshes.items()):
            yield replace(chunk, meshes={layer: batch}, rows={})
        for layer, rows in sorted(chunk.rows.items()):
            first = 0
            for name, count in rows.counts:
                own = {key: array[first : first + count] for key, array in rows.arrays.items()}
                yield replace(chunk, meshes={}, rows={layer: Rows(((name, count),), own)})
                first += count


def _pieces(chunk: Chunk) -> list[Chunk]:
    """Return two parts of one mesh or of the rows of one prototype, or what there is."""
    for layer, batch in chunk.meshes.items():
        first = np.arange(len(batch.faces)) < len(batch.faces) // 2
        if batch.count > 1:
            first = batch.face_object() < batch.count // 2
        halves = [faces_alone(batch, kept) for kept in (first, ~first)]
        return [replace(chunk, meshes={layer: half}) for half in halves if len(half.faces)]
    for layer, rows in chunk.rows.items():
        ((name, count),) = rows.counts
        parts = [slice(0, count // 2), slice(count // 2, count)]
        return [
            replace(chunk, rows={layer: Rows(
                ((name, part.stop - part.start),),
                {key: array[part] for key, array in rows.arrays.items()},
            )})
            for part in parts if part.stop > part.start
        ]  # fmt: skip
    return [chunk]


def _instanced(
    file: ContentFile, layer: str, rows: Rows, corner: FloatArray,
    prototypes: Mapping[str, Prototype], beyond: float,
) -> list[int]:  # fmt: skip
    """Write the rows of a layer, a node for each prototype; returns the nodes."""
    owner = _ids(rows.arrays["_CITYX_OWNER"])
    ids = np.where(owner > 0, owner, _ids(rows.arrays["_CITYX_ID"]))
    known, which = np.unique(ids, return_inverse=True)
    features: tuple[dict[str, Any], int] | None = None
    nodes, begin = [], 0
    for name, count in rows.counts:
        own = slice(begin, begin + count)
        begin += count
        shape = [form for form in forms_of(prototypes[name]) if form.beyond <= beyond][-1]
        batch = shape.prototype.mesh
        flat = flat_mesh(batch, np.zeros((batch.count, 3)))
        if not len(flat.index):
            continue
        told, first = features = features or file.features(layer, known)
        node = file.part(name, flat.one(0), batch.materials, np.zeros(3), {})
        placed = file.buffer.document["nodes"][node]
        attributes = _placed(rows, own, placed.pop("translation"), placed.pop("scale", [1.0])[0])
        attributes["_FEATURE_ID_0"] = (which.reshape(-1)[own] + first).astype(np.float32)[:, None]
        accessors = {
            key: file.packer.attribute(
                array, vertex=False, normalized=key in ("ROTATION", "_COLOR_0")
            )
            for key, array in attributes.items()
        }
        placed["translation"] = y_up(corner).tolist()
        placed["extensions"] = {
            INSTANCING: {"attributes": accessors}, FEATURES: {"featureIds": [told]},
        }  # fmt: skip
        file.extensions |= {INSTANCING, FEATURES}
        nodes.append(node)
    return nodes


def _placed(rows: Rows, own: slice, origin: Any, step: float) -> dict[str, NDArray[Any]]:
    """Return the attributes of rows of a prototype whose vertices count in steps from an origin.

    The order is node, row, vertex: what turns steps to metres goes into each row.
    """
    turn = rows.arrays["ROTATION"][own]
    scale = rows.arrays["SCALE"][own][:, [0, 2, 1]].astype(np.float64)
    place = y_up(rows.arrays["TRANSLATION"][own]) + _turned(turn / TURN, scale * np.array(origin))
    return {
        "TRANSLATION": place.astype(np.float32),
        "ROTATION": np.ascontiguousarray(turn),
        "SCALE": (scale * step).astype(np.float32),
        "_COLOR_0": np.ascontiguousarray(rows.arrays["_COLOR_0"][own]),
    }


def _turned(quaternion: FloatArray, vectors: FloatArray) -> FloatArray:
    """Turn (n, 3) vectors by (n, 4) quaternions, x, y, z, w."""
    unit = quaternion / np.linalg.norm(quaternion, axis=1, keepdims=True)
    axis, angle = unit[:, :3], unit[:, 3:]
    across = 2 * np.cross(axis, vectors)
    turned: FloatArray = vectors + angle * across + np.cross(axis, across)
    return turned


def _ids(words: NDArray[Any]) -> NDArray[np.uint64]:
    return np.ascontiguousarray(words, "<u2").view("<u8").reshape(-1).astype(np.uint64)


SAMPLE = 1.0  # metres between the places of a coarse mesh that distances are measured to
MOST_STEPS = 24  # of a side of a face


def distance_between(fine: Mapping[str, MeshBatch], coarse: Mapping[str, MeshBatch]) -> float:
    """Return the greatest distance from a vertex of fine meshes to coarse ones, metres.

    Layers that only the fine ones have count by how far they reach from all the coarse ones. It is
    measured to places on the coarse faces `SAMPLE` apart, so it is up to 0.7 m too long.
    """
    points = [batch.vertices for batch in fine.values() if len(batch.vertices)]
    places = [_spread(batch) for batch in coarse.values() if len(batch.faces)]
    if not points or not places:
        return 0.0 if not points else float(np.ptp(np.concatenate(points), axis=0).max())
    away, _ = cKDTree(np.concatenate(places)).query(np.concatenate(points))
    return float(away.max())


def _spread(batch: MeshBatch) -> FloatArray:
    """Return places on the faces of meshes, with their corners."""
    corners = np.where(batch.faces < 0, batch.faces[:, 2:3], batch.faces)
    quads = batch.vertices[corners]  # (f, 4, 3)
    size = np.ptp(quads, axis=1).max(axis=1)
    steps = np.clip(np.ceil(size / SAMPLE), 1, MOST_STEPS).astype(int)
    found = [batch.vertices, middles_of(batch)]
    for count in np.unique(steps).tolist():
        share = np.linspace(0, 1, count + 1)
        u, v = (grid.ravel()[None, :, None] for grid in np.meshgrid(share, share))
        a, b, c, d = (quads[steps == count][:, [k]] for k in range(4))
        found.append(((a * (1 - u) + b * u) * (1 - v) + (d * (1 - u) + c * u) * v).reshape(-1, 3))
    spread: FloatArray = np.concatenate(found)
    return spread
