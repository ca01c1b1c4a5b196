"""Chunks: what a page loads of a city, one for each group of layers and cell of 200 m or more.

A chunk is named by a hash of what is in it, so it never changes and is kept for ever; a change of
the city makes other chunks of the few cells that it touches. Prototypes are not in them: packs hold
those (`cityx.viewer.library`), once for the whole city.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from hashlib import sha256
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cityx.city.content import ContentHash, hash_mesh
from cityx.city.mesh import MeshBatch
from cityx.city.rooms import room_draws, room_uses
from cityx.city.rows import take_rows
from cityx.city.scene import Instances
from cityx.city.store import View
from cityx.outputs.gltf_instances import id_words, y_up_quaternions
from cityx.outputs.gltf_mesh import finite
from cityx.outputs.packing import codec
from cityx.version import __version__

CELL = 200.0  # metres, edge of the smallest cells
# Large cities have larger cells, as far as what an edit sends of one of them stays small: metres by
# level of detail. A view of all of it is a draw call for each layer of each cell.
LARGEST = {0: 800.0, 1: 400.0}
MOST_CELLS = 100  # of the extent of a city, where cells may be larger
WIDEST = 56.0  # metres, extent of an object above which its faces are shared out among cells
FORMAT = 4  # of what a chunk holds; another one gives other names
# Layers that an edit of one object changes together, by the group that their chunks belong to.
GROUPS: Mapping[str, str] = {
    **dict.fromkeys(
        ("buildings", "windows", "doors", "shopfronts", "trims", "roof_furniture"), "buildings"
    ),
    **dict.fromkeys(("trees", "shore_pieces", "plants", "shrubs"), "nature"),
    **dict.fromkeys(
        ("ground", "bay_lines", "lawn_edging", "garden_paths", "shores", "decks", "structures"),
        "ground",
    ),
    "surroundings": "surroundings",
}  # fmt: skip
OTHERS = "street"  # group of all other layers
RIM = "surroundings"  # layer that reaches for miles: it stays in one piece
ROW_STEPS = 512.0  # steps of a metre in the places of rows
_ROWS_OF_CELLS = 1 << 20  # more than any plane of a city has
Cell = tuple[int, int]


@dataclass(frozen=True)
class Rows:
    """Instances of a layer in a chunk, ordered by prototype.

    Attributes
    ----------
    counts
        Name of each prototype and how many rows it has.
    arrays
        Attributes of the rows by name.
    """

    counts: tuple[tuple[str, int], ...]
    arrays: Mapping[str, NDArray[Any]]


@dataclass(frozen=True)
class Chunk:
    """What one group of layers holds in one cell.

    Attributes
    ----------
    name
        32 hexadecimal digits, a hash of the content.
    group, cell, edge
        Where it belongs; cells count from the origin, in steps of the edge, metres.
    box
        (2, 3) metres, lowest and highest coordinates.
    meshes, rows
        By layer; objects of more than `WIDEST` are there with the faces of this cell alone.
    triangles
        Of the meshes.
    """

    name: str
    group: str
    cell: Cell
    edge: float
    box: NDArray[np.float64]
    meshes: Mapping[str, MeshBatch]
    rows: Mapping[str, Rows]
    triangles: int

    @property
    def corner(self) -> NDArray[np.float64]:
        """(3,) the corner of the cell that places in the chunk count from."""
        return np.array([*self.cell, 0.0]) * self.edge

    def to_json(self) -> dict[str, Any]:
        """Return the chunk as the page lists it."""
        return {
            "name": self.name, "group": self.group, "cell": list(self.cell),
            "box": np.round(self.box, 2).ravel().tolist(), "triangles": self.triangles,
            "layers": sorted({*self.meshes, *self.rows}),
        }  # fmt: skip


def group_of(layer: str) -> str:
    """Return the group of a layer."""
    return GROUPS.get(layer, OTHERS)


def edge_of(extent: tuple[float, float, float, float], lod: int) -> float:
    """Return the edge of the cells of a city, metres; no edit changes it."""
    west, south, east, north = extent
    edge = CELL
    while (east - west) * (north - south) > MOST_CELLS * edge**2 and edge < LARGEST.get(lod, CELL):
        edge *= 2
    return edge


@dataclass(frozen=True)
class Cuts:
    """Layers that were cut into cells, for a later state of the city that has them still.

    Attributes
    ----------
    meshes
        By the hash of a layer: the cells of its small objects, and the part of each cell.
    rows
        By the hash of a layer and of what its rows stand on: the part of each cell, with a hash.
    """

    meshes: dict[bytes, tuple[dict[int, Cell], list[tuple[Cell, MeshBatch, bytes]]]] = field(
        default_factory=dict
    )
    rows: dict[bytes, list[tuple[Cell, Rows, bytes]]] = field(default_factory=dict)


def chunks_of(
    view: View, content: ContentHash, like: Cuts | None = None, *, edge: float = CELL
) -> tuple[tuple[Chunk, ...], Cuts]:
    """Cut a city into chunks, in the order of their groups and cells.

    Parameters
    ----------
    view
        The city.
    content
        Its hashes, by which chunks are named.
    like
        How an earlier state was cut; layers that it shares are not cut again.
    edge
        Of the cells, metres.
    """
    like, cuts = like or Cuts(), Cuts()
    meshes: dict[tuple[str, Cell], dict[str, MeshBatch]] = {}
    rows: dict[tuple[str, Cell], dict[str, Rows]] = {}
    hashes: dict[tuple[str, Cell], dict[str, bytes]] = {}
    homes: dict[int, Cell] = {}
    for layer, batch in sorted(view.scene.meshes.items()):
        known = content.layers.get(f"meshes/{layer}")
        name = _layer_key(layer, known, b"%d" % edge)
        held = like.meshes.get(name)
        if held is None or known is None:
            own_homes: dict[int, Cell] = {}
            parts = list(_mesh_parts(batch, known, own_homes, edge, shared_out=layer != RIM))
            held = own_homes, parts
        cuts.meshes[name] = held
        homes.update(held[0])
        for cell, part, told in held[1]:
            key = group_of(layer), cell
            meshes.setdefault(key, {})[layer] = part
            hashes.setdefault(key, {})[layer] = told
    for layer, table in sorted(view.scene.instances.items()):
        for cell, own, told in _cut_rows(view, content, layer, table, homes, edge, like, cuts):
            key = group_of(layer), cell
            rows.setdefault(key, {})[layer] = own
            hashes.setdefault(key, {})[layer + "*"] = told
    return tuple(
        _chunk(key, edge, meshes.get(key, {}), rows.get(key, {}), hashes[key])
        for key in sorted(hashes)
    ), cuts


def _layer_key(layer: str, known: tuple[NDArray[Any], NDArray[Any]] | None, *more: bytes) -> bytes:
    """Return a hash of a layer as it is stored, and of what else its parts hang on."""
    hasher = sha256(layer.encode())
    for part in (*(known or ()), *more):
        hasher.update(np.ascontiguousarray(part).data if isinstance(part, np.ndarray) else part)
    return hasher.digest()


def _cut_rows(
    view: View, content: ContentHash, layer: str, table: Instances, homes: Mapping[int, Cell],
    edge: float, like: Cuts, cuts: Cuts,
) -> list[tuple[Cell, Rows, bytes]]:  # fmt: skip
    """Return the rows of each cell with a hash, from an earlier state where that has the same."""
    known = content.layers.get(f"instances/{layer}")
    uses = room_uses(view.scene.prototypes, table, view.objects)
    stands = repr(sorted(homes.items())).encode() if group_of(layer) == "buildings" else b""
    name = _layer_key(layer, known, uses.tobytes(), stands, b"%d" % edge)
    held = like.rows.get(name)
    if held is None or known is None:
        parts = _row_parts(view, layer, table, homes, uses, edge)
        held = [(cell, own, _digest_of(own)) for cell, own in parts]
    cuts.rows[name] = held
    return held


def _chunk(
    key: tuple[str, Cell], edge: float, meshes: Mapping[str, MeshBatch], rows: Mapping[str, Rows],
    hashes: Mapping[str, bytes],
) -> Chunk:  # fmt: skip
    hasher = sha256(f"{__version__} {FORMAT} {codec() is not None} {edge} {key}".encode())
    for layer in sorted(hashes):
        hasher.update(layer.encode() + b"\0" + hashes[layer])
    corner = np.array([*key[1], 0.0]) * edge
    places = [batch.vertices for batch in meshes.values()]
    places += [table.arrays["TRANSLATION"] + corner for table in rows.values()]
    box = np.array([np.min([p.min(axis=0) for p in places], axis=0),
                    np.max([p.max(axis=0) for p in places], axis=0)])  # fmt: skip
    triangles = sum(batch.triangle_count for batch in meshes.values())
    return Chunk(hasher.hexdigest()[:32], *key, edge, box, meshes, rows, triangles)


def _mesh_parts(
    batch: MeshBatch,
    known: tuple[NDArray[Any], NDArray[Any]] | None,
    homes: dict[int, Cell],
    edge: float,
    *,
    shared_out: bool,
) -> Iterator[tuple[Cell, MeshBatch, bytes]]:
    """Yield the objects of each cell, with a hash; `homes` learns where small objects are."""
    filled = np.flatnonzero(np.diff(batch.face_start) > 0)
    if not len(filled):
        return
    batch = batch.take(filled[np.argsort(batch.object_id[filled], kind="stable")])
    filled = np.arange(batch.count)
    starts = batch.vertex_start[filled]
    points = finite(batch.vertices)
    low, high = np.minimum.reduceat(points, starts), np.maximum.reduceat(points, starts)
    wide = ((high - low)[:, :2].max(axis=1) > WIDEST) & shared_out
    small = batch.take(filled[~wide])
    cells = np.floor((low + high)[~wide, :2] / 2 / edge).astype(np.int64)
    homes.update(zip(small.object_id.tolist(), map(tuple, cells.tolist()), strict=True))
    pieces = [batch.one(number) for number in filled[wide].tolist()]
    shared: dict[Cell, list[MeshBatch]] = {}
    for piece in pieces:
        for cell, part in _shared_out(piece, edge):
            shared.setdefault(cell, []).append(part)
    own = dict(_by_cell(cells))
    for cell in sorted({*own, *shared}):
        parts = [small.take(own[cell])] if cell in own else []
        told = b"".join(_told(part, known) for part in parts)
        others = shared.get(cell, [])
        told += b"".join(np.column_stack(hash_mesh(part)).tobytes() for part in others)
        yield cell, _joined([*parts, *others]), told


def _by_cell(cells: NDArray[np.int64]) -> list[tuple[Cell, NDArray[np.int64]]]:
    """Return the rows of each of the cells, (n, 2), in the order of their numbers."""
    if not len(cells):
        return []
    key = cells[:, 0] * _ROWS_OF_CELLS + cells[:, 1]
    order = np.argsort(key, kind="stable")
    first = np.flatnonzero(np.diff(key[order], prepend=key[order[0]] - 1))
    found = cells[order[first]].tolist()
    parts = np.split(order, first[1:])
    return [((x, y), rows) for (x, y), rows in zip(found, parts, strict=True)]


def _told(part: MeshBatch, known: tuple[NDArray[Any], NDArray[Any]] | None) -> bytes:
    """Return ids and hashes of objects, from those of the city where they are known."""
    ids = np.sort(part.object_id)
    if known is not None and len(known[0]):
        rows = np.minimum(np.searchsorted(known[0], ids), len(known[0]) - 1)
        twice = np.searchsorted(known[0], ids, side="right") - np.searchsorted(known[0], ids)
        if (known[0][rows] == ids).all() and (twice == 1).all():
            return np.column_stack([ids, known[1][rows]]).tobytes()
    return np.column_stack(hash_mesh(part)).tobytes()


def _shared_out(piece: MeshBatch, edge: float) -> Iterator[tuple[Cell, MeshBatch]]:
    """Share the faces of one object out among cells by their middles."""
    corners = np.where(piece.faces < 0, piece.faces[:, :1], piece.faces)
    middle = finite(piece.vertices)[corners, :2].mean(axis=1)
    for cell, rows in _by_cell(np.floor(middle / edge).astype(np.int64)):
        faces = piece.faces[rows]
        used = np.unique(faces[faces >= 0])
        place = np.full(len(piece.vertices) + 1, -1, np.int32)  # the last stands for no vertex
        place[used] = np.arange(len(used), dtype=np.int32)
        yield (
            cell,
            replace(
                piece,
                vertices=piece.vertices[used],
                faces=place[faces],
                vertex_start=np.array([0, len(used)], np.int64),
                face_start=np.array([0, len(rows)], np.int64),
                material=piece.material[rows],
                uv=piece.uv[rows],
                tint=piece.tint[rows],
            ),
        )


def _joined(parts: list[MeshBatch]) -> MeshBatch:
    """Join batches whose faces count the same materials."""
    if len(parts) == 1:
        return parts[0]
    shift = np.cumsum([0, *(len(part.vertices) for part in parts)])
    faces = [np.where(part.faces < 0, -1, part.faces + np.int32(first))
             for part, first in zip(parts, shift.tolist(), strict=False)]  # fmt: skip
    sizes = [np.diff(part.vertex_start) for part in parts]
    counts = [np.diff(part.face_start) for part in parts]
    return MeshBatch(
        np.concatenate([part.object_id for part in parts]),
        np.concatenate([[0], np.cumsum(np.concatenate(sizes))]).astype(np.int64),
        np.concatenate([[0], np.cumsum(np.concatenate(counts))]).astype(np.int64),
        np.concatenate([part.vertices for part in parts]),
        np.concatenate(faces).astype(np.int32),
        np.concatenate([part.material for part in parts]),
        parts[0].materials,
        np.concatenate([part.uv for part in parts]),
        np.concatenate([part.tint for part in parts]),
    )


def _row_parts(
    view: View,
    layer: str,
    table: Instances,
    homes: Mapping[int, Cell],
    uses: NDArray[np.int8],
    edge: float,
) -> Iterator[tuple[Cell, Rows]]:
    """Yield the rows of each cell: with what they belong to, or else where they stand."""
    if not table.count:
        return
    cells = np.floor(finite(table.position)[:, :2] / edge).astype(np.int64)
    if group_of(layer) == "buildings":
        owners, which = np.unique(table.owner, return_inverse=True)
        of_owner = [homes.get(owner) for owner in owners.tolist()]
        held = np.array([home is not None for home in of_owner])
        there = np.array([home or (0, 0) for home in of_owner], np.int64)
        which = which.reshape(-1)
        cells = np.where(held[which][:, None], there[which], cells)
    names = [prototype.name for prototype in view.scene.prototypes]
    rank = np.argsort(np.argsort(names))[table.prototype]  # of the name: an order for ever
    order = np.lexsort((table.object_id, rank))
    draws = np.floor(room_draws(view.seed, table) * 256).astype(np.uint8)
    for cell, rows in _by_cell(cells[order]):
        chosen = order[rows]
        part = take_rows(table, chosen)
        first = np.flatnonzero(np.diff(rank[chosen], prepend=-1))
        counts = np.diff([*first.tolist(), part.count]).tolist()
        own = [names[number] for number in part.prototype[first].tolist()]
        corner = np.array([*cell, 0.0]) * edge
        yield (
            cell,
            Rows(
                tuple(zip(own, counts, strict=True)),
                _row_arrays(part, corner, uses[chosen], draws[chosen]),
            ),
        )


def _row_arrays(
    part: Instances, corner: NDArray[np.float64], uses: NDArray[np.int8], draws: NDArray[np.uint8]
) -> dict[str, NDArray[Any]]:
    place = np.rint((finite(part.position) - corner) * ROW_STEPS) / ROW_STEPS
    color = np.full((part.count, 4), 255, np.uint8)
    color[:, :3] = np.rint(np.clip(np.nan_to_num(part.tint, nan=1.0), 0, 1) * 255)
    turn = np.rint(y_up_quaternions(part.rotation) * 32767).astype(np.int16)
    room = np.zeros((part.count, 4), np.uint8)
    room[:, 0], room[:, 1] = uses, draws
    return {
        "TRANSLATION": place.astype(np.float32),
        "ROTATION": turn,
        "SCALE": part.scale.astype(np.float32),
        "_COLOR_0": color,
        "_CITYX_ID": id_words(part.object_id),
        "_CITYX_OWNER": id_words(part.owner),
        "_CITYX_ROOM": room,
    }


def _digest_of(rows: Rows) -> bytes:
    hasher = sha256(repr(rows.counts).encode())
    for name in sorted(rows.arrays):
        hasher.update(np.ascontiguousarray(rows.arrays[name]).data)
    return hasher.digest()
