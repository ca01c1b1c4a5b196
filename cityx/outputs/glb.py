"""A city as one glTF 2.0 binary file.

Nodes: ``city``, under it one node per layer, under it one node per object, named by its id, or one
node per prototype and colour with ``EXT_mesh_gpu_instancing``. Every object's id is in its name and
extras, that of an instance in the attribute ``_CITYX_ID`` (four 16-bit words, lowest first). Beside
``city`` stands ``sun``, a directional light, when the sun is up; sky and weather are numbers in the
extras of ``city``.
"""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cityx.assets.colliders import shapeless, standing_fast
from cityx.city.environment import Environment
from cityx.city.mesh import MeshBatch, joined_apart
from cityx.city.rooms import lit_scene
from cityx.city.scene import Instances, Prototype, in_chunks
from cityx.ids import id_text
from cityx.outputs.earlier_glb import EarlierLayer, read_earlier
from cityx.outputs.gltf_buffer import ARRAY_BUFFER, ELEMENT_ARRAY_BUFFER, GltfBuffer
from cityx.outputs.gltf_instances import EXTENSION as LIGHTS
from cityx.outputs.gltf_instances import (
    id_words,
    illuminance_of,
    sun_light,
    sun_rotation,
    tint_groups,
    y_up_quaternions,
)
from cityx.outputs.gltf_material import GltfMaterials
from cityx.outputs.gltf_mesh import FlatMesh, finite, flat_mesh, origins, takes_tint, y_up
from cityx.system.atomic import replaced
from cityx.version import __version__

# Above this many objects in a layer viewers choke on nodes: objects are merged by tile and keep
# their ids in a vertex attribute.
MOST_OBJECTS = 20_000
TILE = 250.0  # metres, edge of a merged tile
_INSTANCING = "EXT_mesh_gpu_instancing"


@dataclass(frozen=True)
class GlbStats:
    """What a file holds.

    Attributes
    ----------
    size
        Bytes.
    nodes, meshes, materials, textures
        Counts in the file.
    instances
        Rows placed.
    triangles_unique, triangles_instanced
        Stored, and as seen with every instance counted.
    """

    size: int
    nodes: int
    meshes: int
    materials: int
    textures: int
    instances: int
    triangles_unique: int
    triangles_instanced: int


def write_glb(
    view: Any, path: str | os.PathLike[str], *, instancing: bool = True, texture_size: int = 512,
    tints: int = 8, like: tuple[Mapping[str, MeshBatch], Path] | None = None,
) -> GlbStats:  # fmt: skip
    """Write a city as GLB: y up, metres, textures inside.

    Parameters
    ----------
    view
        A `cityx.city.store.View`, or a City.
    path
        File to make; replaced when the new one is complete.
    instancing
        Place instances with ``EXT_mesh_gpu_instancing``. False writes a node for each, for
        viewers that do not know the extension.
    texture_size
        Edge of the textures in pixels, 0 for none.
    tints
        Most colours of one prototype in a layer: each has the colours of its vertices again.
    like
        Meshes of another city by layer, and the file in which they were written; what is the same
        is taken from there.

    Raises
    ------
    UsageError
        If the city is larger than a GLB can hold (4 GB).
    """
    if not hasattr(view, "objects"):
        from cityx.city.store import view_of

        view = view_of(view)
    earlier = {} if like is None else read_earlier(like[1], like[0], MOST_OBJECTS)
    writer = _Writer(view, instancing, texture_size, tints, earlier)
    layers = [
        *(writer.mesh_layer(name, batch) for name, batch in sorted(writer.scene.meshes.items())),
        *(
            writer.instance_layer(name, rows)
            for name, rows in sorted(writer.scene.instances.items())
        ),
    ]
    moving, bodies = writer.movers()
    layers += moving
    root: dict[str, Any] = {"name": "city", "extras": _city_extras(view)}
    children = [layer for layer in layers if layer is not None]
    if children:
        root["children"] = children
    top = writer.buffer.add("nodes", root)
    sun = writer.sun(view.environment)
    writer.buffer.add("scenes", {"name": view.name or "city", "nodes": [top, *sun, *bodies]})
    with replaced(path) as temporary, temporary.open("wb") as file:
        size = writer.buffer.write(file, _head(view, writer.extensions))
    counts = {name: len(items) for name, items in writer.buffer.document.items()}
    return GlbStats(
        size=size,
        nodes=counts["nodes"],
        meshes=counts.get("meshes", 0),
        materials=counts.get("materials", 0),
        textures=counts.get("textures", 0),
        instances=writer.instances,
        triangles_unique=writer.triangles_unique,
        triangles_instanced=writer.triangles_instanced,
    )


def _city_extras(view: Any) -> dict[str, Any]:
    frame = view.frame
    return {
        "cityx": __version__,
        "name": view.name,
        "seed": getattr(view, "seed", 0),
        "latitude": frame.latitude,
        "longitude": frame.longitude,
        "projection": frame.projection,
        "attribution": list(view.attribution),
        "environment": asdict(view.environment),
    }


def _head(view: Any, extensions: set[str]) -> dict[str, Any]:
    asset = {"version": "2.0", "generator": f"CityX {__version__}"}
    if view.attribution:
        asset["copyright"] = "; ".join(view.attribution)
    head: dict[str, Any] = {"asset": asset, "scene": 0}
    if extensions:
        head["extensionsUsed"] = sorted(extensions)
    if LIGHTS in extensions:
        head["extensions"] = {LIGHTS: {"lights": [sun_light(view.environment)]}}
    if _INSTANCING in extensions:  # without it a viewer would show one window, at no place
        head["extensionsRequired"] = [_INSTANCING]
    return head


def _rounded(values: Any) -> list[float]:
    return [round(float(value), 4) + 0.0 for value in values]


@dataclass(frozen=True)
class _Shape:
    """A prototype in the file: everything but its colour.

    Attributes
    ----------
    colors
        (c, 3) uint8, those of its vertices.
    takes_tint
        (c,) whether a tint changes each.
    color
        (n,) the colour of each vertex.
    """

    primitives: list[dict[str, Any]]
    colors: NDArray[np.uint8]
    takes_tint: NDArray[np.bool_]
    color: NDArray[np.int64]
    triangles: int


@dataclass(frozen=True)
class _Group:
    """Instances of a prototype in one colour: rows of their layer."""

    kind: Prototype
    body: Mapping[str, Any]
    number: int
    tint: NDArray[np.float32]
    rows: NDArray[np.int64]


@dataclass(frozen=True)
class _Placed:
    """Instances of a layer as the file has them, those of group after group.

    Attributes
    ----------
    start
        (g + 1,) int64, where the rows of each group begin.
    origin
        (g, 3) float64, node of each group, y up.
    arrays
        Attributes by name.
    """

    start: list[int]
    origin: NDArray[np.float64]
    arrays: dict[str, NDArray[Any]]

    @classmethod
    def of(cls, rows: Instances, groups: Sequence[_Group]) -> _Placed:
        order = np.concatenate([group.rows for group in groups])
        counts = [len(group.rows) for group in groups]
        start = np.cumsum([0, *counts]).tolist()
        position = finite(rows.position)[order]
        middle = [position[first:end].mean(axis=0) for first, end in pairwise(start)]
        origin = np.round(middle, 2)
        arrays = {
            "TRANSLATION": y_up(position - np.repeat(origin, counts, axis=0)).astype(np.float32),
            "ROTATION": y_up_quaternions(rows.rotation[order]),
            "SCALE": rows.scale[order][:, [0, 2, 1]],
            "_CITYX_ID": id_words(rows.object_id[order]),
            "_CITYX_OWNER": id_words(rows.owner[order]),
        }
        return cls(start, y_up(origin), arrays)


class _Writer:
    """A file in the making."""

    def __init__(
        self, view: Any, instancing: bool, texture_size: int, tints: int,
        earlier: Mapping[str, EarlierLayer],
    ) -> None:  # fmt: skip
        self.view, self.earlier = view, earlier
        self.scene = lit_scene(view)
        self.instancing, self.tints = instancing, tints
        self.buffer = GltfBuffer()
        self.materials = GltfMaterials(self.buffer, view.environment, texture_size)
        self.instances = self.triangles_unique = self.triangles_instanced = 0
        self._flats: dict[str, tuple[FlatMesh, tuple[str, ...]]] = {}
        self._shapes: dict[str, _Shape | None] = {}
        self._painted: dict[tuple[str, bytes], int] = {}
        self._used: set[str] = set()

    @property
    def extensions(self) -> set[str]:
        return self._used | self.materials.extensions

    def sun(self, environment: Environment) -> list[int]:
        """Write the node of the sun, if it is up; returns the nodes, at most one."""
        if illuminance_of(environment) <= 0:
            return []
        self._used.add(LIGHTS)
        node = {"name": "sun", "rotation": sun_rotation(environment)}
        return [self.buffer.add("nodes", {**node, "extensions": {LIGHTS: {"light": 0}}})]

    def mesh_layer(self, name: str, batch: MeshBatch) -> int | None:
        """Write one node per object and return the layer's node."""
        if not len(batch.faces):
            return None
        ids, known = None, self.earlier.get(name)
        if batch.count > MOST_OBJECTS:
            batch, ids, tiles = merged_by_tile(batch)
            labels, known = [_tile_label(name, tile) for tile in tiles.tolist()], None
        else:
            bodies = standing_fast(name, batch) if known is None else known.bodies_of(name, batch)
            ids_and_bodies = zip(batch.object_id.tolist(), bodies, strict=True)
            labels = [self._label(name, object_id, body) for object_id, body in ids_and_bodies]
        origin = origins(batch)
        flat = flat_mesh(batch, origin) if known is None else known.flat(batch, origin)
        places = y_up(origin)
        primitives = self._primitives(flat, batch.materials, ids)
        self.triangles_unique += batch.triangle_count
        self.triangles_instanced += batch.triangle_count
        children = []
        for item, parts in primitives.items():
            label, extras = labels[item]
            mesh = self.buffer.add("meshes", {"name": label, "primitives": parts})
            node = {"name": label, "mesh": mesh, "translation": _rounded(places[item])}
            children.append(self.buffer.add("nodes", {**node, "extras": extras}))
        return self.buffer.add("nodes", {"name": name, "children": children})

    def _label(
        self, layer: str, object_id: int, body: Mapping[str, str | float]
    ) -> tuple[str, dict[str, Any]]:
        text = id_text(object_id)
        known: Mapping[str, str] = self.view.objects.get(object_id, {})
        extras: dict[str, Any] = {
            "cityx_id": text,
            **{key: value for key, value in known.items() if value},
        }
        return f"{layer.removesuffix('s')}_{text}", extras | {"body": body}

    def _primitives(
        self, flat: FlatMesh, materials: tuple[str, ...], ids: NDArray[np.uint64] | None = None
    ) -> dict[int, list[dict[str, Any]]]:
        """Write the arrays of a layer and return the primitives of each object that has any."""
        buffer = self.buffer
        shared: list[tuple[str, NDArray[Any], bool]] = [
            ("NORMAL", flat.normal, False),
            ("TEXCOORD_0", flat.uv, False),
        ]
        if flat.color is not None:
            shared.append(("COLOR_0", flat.color, True))
        if ids is not None:
            shared.append(("_CITYX_ID", id_words(ids[flat.vertex]), False))
        position = buffer.view(flat.position, target=ARRAY_BUFFER, shared=True)
        views = [buffer.view(array, target=ARRAY_BUFFER, shared=True) for _, array, _ in shared]
        counts = np.diff(flat.vertex_start)
        # 65535 itself is kept free: it means "restart" to a graphics card.
        index = flat.index.astype(np.uint16) if counts.max() <= 65535 else flat.index
        index_view = buffer.view(index, target=ELEMENT_ARRAY_BUFFER)
        low, high = (bound.tolist() for bound in flat.bounds())
        starts, sizes = flat.vertex_start.tolist(), counts.tolist()
        sections = flat.section_start.tolist()
        numbers = [self.materials.number(materials[m]) for m in flat.section_material.tolist()]
        result: dict[int, list[dict[str, Any]]] = {}
        attributes: dict[str, int] = {}
        for section, item in enumerate(flat.section_object.tolist()):
            if item not in result:
                result[item] = []
                rows = {"first": starts[item], "count": sizes[item]}
                bounds = (low[item], high[item])
                attributes = {
                    "POSITION": buffer.accessor(position, flat.position, bounds=bounds, **rows)
                }
                for (kind, array, normalized), view in zip(shared, views, strict=True):
                    attributes[kind] = buffer.accessor(view, array, normalized=normalized, **rows)
            first, last = sections[section : section + 2]
            indices = buffer.accessor(index_view, index, first=first, count=last - first)
            result[item].append(
                {"attributes": attributes, "indices": indices, "material": numbers[section]}
            )
        return result

    def instance_layer(self, name: str, rows: Instances) -> int | None:
        """Write one node per prototype and colour and return the layer's node."""
        groups = self._groups(rows)
        if not groups:
            return None
        self.instances += sum(len(group.rows) for group in groups)
        placed = _Placed.of(rows, groups) if self.instancing else None
        children: list[int] = []
        for place, group in enumerate(groups):
            shape = self._shape(group.kind)
            assert shape is not None
            self.triangles_instanced += shape.triangles * len(group.rows)
            mesh = self._mesh(group.kind.name, shape, group.tint)
            if placed is not None:
                children.append(self._instanced(group, mesh, placed, place))
            else:
                children += self._single(group, mesh, rows)
        return self.buffer.add("nodes", {"name": name, "children": children})

    def _groups(self, rows: Instances) -> list[_Group]:
        """Sort the rows of a layer by prototype and colour; prototypes without faces are none."""
        if not rows.count:
            return []
        few = len(self.scene.prototypes) < 65536
        number = rows.prototype.astype(np.uint16) if few else rows.prototype  # 16: a radix sort
        order = np.argsort(number, kind="stable")
        numbers, first = np.unique(number[order], return_index=True)
        kinds = [self.scene.prototypes[number] for number in numbers.tolist()]
        self._flatten(kinds)
        found = []
        for kind, thing, members in zip(
            kinds, shapeless(kinds), np.split(order, first[1:]), strict=True
        ):
            if not len(kind.mesh.faces):
                continue
            group, tints = np.zeros(len(members), np.int64), np.ones((1, 3), np.float32)
            if takes_tint(kind.mesh.materials)[kind.mesh.material].any():
                group, tints = tint_groups(rows.tint[members], self.tints)
            body = {"body": thing.to_json()}
            own = np.split(
                members[np.argsort(group.astype(np.uint8), kind="stable")],
                np.cumsum(np.bincount(group, minlength=len(tints)))[:-1],
            )
            found += [
                _Group(kind, body, number, tint, mine)
                for number, (tint, mine) in enumerate(zip(tints, own, strict=True))
            ]
        return found

    def _flatten(self, prototypes: Sequence[Prototype]) -> None:
        """Flatten prototypes, those of a chunk at once, for `_shape` to write."""
        new = [kind for kind in prototypes if kind.name not in self._shapes]
        for chunk in in_chunks(new):
            batch = joined_apart(kind.mesh for kind in chunk)
            flat = flat_mesh(batch, np.zeros((batch.count, 3)))
            for row, kind in enumerate(chunk):
                self._flats[kind.name] = flat.one(row), batch.materials

    def _shape(self, prototype: Prototype) -> _Shape | None:
        name = prototype.name
        if name not in self._shapes:
            batch = prototype.mesh
            shape = None
            if len(batch.faces):
                if name not in self._flats:
                    self._flatten([prototype])
                flat, materials = self._flats.pop(name)
                plain = replace(flat, color=None)
                parts = [
                    part for own in self._primitives(plain, materials).values() for part in own
                ]
                color = np.full((len(flat.takes_tint), 4), 255, np.uint8)
                if flat.color is not None:
                    color[:] = flat.color
                color[:, 3] = flat.takes_tint
                codes, which = np.unique(color.view(np.uint32), return_inverse=True)
                seen = codes.view(np.uint8).reshape(-1, 4)
                takes, which = seen[:, 3] > 0, which.reshape(-1)
                shape = _Shape(parts, seen[:, :3], takes, which, batch.triangle_count)
                self.triangles_unique += shape.triangles
            self._shapes[name] = shape
        return self._shapes[name]

    def painted(self, prototype: Prototype, tint: NDArray[np.float32]) -> int:
        """Write a prototype that has faces in one colour and return its mesh."""
        shape = self._shape(prototype)
        assert shape is not None
        self.triangles_instanced += shape.triangles
        return self._mesh(prototype.name, shape, np.clip(tint, 0, 1))

    def primitives(self, batch: MeshBatch) -> list[dict[str, Any]]:
        """Write a mesh of one object and return its primitives."""
        flat = flat_mesh(batch, np.zeros((1, 3)))
        self.triangles_unique += batch.triangle_count
        self.triangles_instanced += batch.triangle_count
        return self._primitives(flat, batch.materials)[0]

    def movers(self) -> tuple[list[int], list[int]]:
        """Write what moves and return the nodes of its layers, and those beside ``city``."""
        tracks = self.view.tracks
        if tracks is None or not tracks.count:
            return [], []
        from cityx.outputs.gltf_animation import Animated, MoverWriter

        out = Animated(self.buffer, self.painted, self.primitives, max(self.view.lod, 2))
        movers = MoverWriter(out, tracks, self.view.moment)
        return movers.layers(), movers.bodies

    def _mesh(self, title: str, shape: _Shape, tint: NDArray[np.float32]) -> int:
        """Return the mesh of a prototype in one colour; only the colours are written again."""
        shown = np.full((len(shape.colors), 4), 255, np.uint8)
        factor = np.where(shape.takes_tint[:, None], tint, np.float32(1))
        shown[:, :3] = np.round(shape.colors * factor)
        key = (title, shown.tobytes())
        if key not in self._painted:
            parts = shape.primitives
            if (shown < 255).any():
                color = shown.view(np.uint32).take(shape.color).view(np.uint8).reshape(-1, 4)
                view = self.buffer.view(color, target=ARRAY_BUFFER, shared=True)
                paint = self.buffer.accessor(view, color, normalized=True)
                parts = [
                    {**part, "attributes": {**part["attributes"], "COLOR_0": paint}}
                    for part in parts
                ]
            self._painted[key] = self.buffer.add("meshes", {"name": title, "primitives": parts})
        return self._painted[key]

    def _instanced(self, group: _Group, mesh: int, placed: _Placed, place: int) -> int:
        rows = slice(*placed.start[place : place + 2])
        accessors = {}
        for kind, array in placed.arrays.items():
            own = array[rows]
            accessors[kind] = self.buffer.accessor(self.buffer.view(own), own)
        self._used.add(_INSTANCING)
        node = {
            "name": f"{group.kind.name}_{group.number}",
            "mesh": mesh,
            "translation": _rounded(placed.origin[place]),
            "extensions": {_INSTANCING: {"attributes": accessors}},
            "extras": group.body,
        }
        return self.buffer.add("nodes", node)

    def _single(self, group: _Group, mesh: int, rows: Instances) -> list[int]:
        chosen, title = group.rows, group.kind.name
        places = np.round(y_up(finite(rows.position[chosen])), 4).tolist()
        turns = np.round(y_up_quaternions(rows.rotation[chosen]).astype(float), 7).tolist()
        scales = np.round(rows.scale[chosen][:, [0, 2, 1]].astype(float), 6).tolist()
        owners = [id_text(owner) if owner else "" for owner in rows.owner[chosen].tolist()]
        numbers = []
        for row, object_id in enumerate(rows.object_id[chosen].tolist()):
            text = id_text(object_id)
            extras = {"cityx_id": text, **group.body}
            if owners[row]:
                extras["owner"] = owners[row]
            node = {"name": f"{title}_{text}", "mesh": mesh, "translation": places[row]}
            node |= {"rotation": turns[row], "scale": scales[row], "extras": extras}
            numbers.append(self.buffer.add("nodes", node))
        return numbers


def merged_by_tile(batch: MeshBatch) -> tuple[MeshBatch, NDArray[np.uint64], NDArray[np.int64]]:
    """Merge the objects of each `TILE` into one.

    Returns
    -------
    merged
        One object per tile.
    ids
        (n,) uint64, the object each vertex of `merged` belonged to.
    tiles
        (k, 2) column and row of each tile.
    """
    tile = np.floor(origins(batch)[:, :2] / TILE).astype(np.int64)
    order = np.lexsort((np.arange(batch.count), tile[:, 0], tile[:, 1]))
    tile, batch = tile[order], batch.take(order)
    first = np.flatnonzero(np.r_[True, (np.diff(tile, axis=0) != 0).any(axis=1)])
    ids = np.repeat(batch.object_id, np.diff(batch.vertex_start))
    merged = replace(
        batch,
        object_id=np.zeros(len(first), np.uint64),
        vertex_start=np.r_[batch.vertex_start[first], batch.vertex_start[-1]],
        face_start=np.r_[batch.face_start[first], batch.face_start[-1]],
    )
    return merged, ids, tile[first]


def _tile_label(layer: str, tile: list[int]) -> tuple[str, dict[str, Any]]:
    return f"{layer}_tile_{tile[0]}_{tile[1]}", {"tile": tile, "edge": TILE}
