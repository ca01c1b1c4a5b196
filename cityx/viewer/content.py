"""What chunks, packs and materials hold, as glTF 2.0 binary.

A chunk has a node for each layer. Meshes are merged by material; a vertex tells its object by
``_FEATURE_ID_0``, a row of the property table with ids and layers (``EXT_mesh_features``,
``EXT_structural_metadata``). Rows that place prototypes are accessors named in the extras of their
node. Materials have no textures in chunks and packs: those are in one file of their own.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from io import BytesIO
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cityx.assets.styles.materials import (
    DRIVEN,
    FOLIAGE,
    PUDDLED,
    SNOWLESS,
    Material,
    material_named,
)
from cityx.city.environment import Environment
from cityx.city.mesh import MeshBatch, joined_apart
from cityx.city.scene import in_chunks
from cityx.ids import UInt64Array, id_text
from cityx.outputs.gltf_buffer import MESHOPT, GltfBuffer
from cityx.outputs.gltf_material import SLUSH_SHARE, GltfMaterials, snow_share
from cityx.outputs.gltf_mesh import FlatMesh, flat_mesh, y_up
from cityx.outputs.packing import PER_TILE, QUANTIZATION, Packer, on_grid, used_vertices
from cityx.version import __version__
from cityx.viewer.chunks import Chunk, Rows
from cityx.viewer.library import Pack, Paints

FEATURES, TABLES = "EXT_mesh_features", "EXT_structural_metadata"
PLACES = "KHR_texture_transform"
INSTANCING = "EXT_mesh_gpu_instancing"  # tiles place rows by it
TEXTURE_SIZE = 512  # pixels
ANY_SLOPE = 2.0  # in the place of a share of snow: it is caught by leaves however they are turned
# What stands behind panes; a page does not look upward for a roof.
INDOORS = frozenset({"curtain", "room_wall", "ware_cream", "ware_red", "ware_ochre", "ware_blue",
                     "ware_green", "car_trim"})  # fmt: skip


def chunk_bytes(chunk: Chunk, attribution: Sequence[str] = ()) -> bytes:
    """Return a chunk as GLB."""
    file = ContentFile(0)
    layers = []
    for layer in sorted({*chunk.meshes, *chunk.rows}):
        node: dict[str, Any] = {"name": layer}
        if layer in chunk.meshes:
            node["children"] = file.merged(layer, chunk.meshes[layer], chunk.corner)
        if layer in chunk.rows:
            node["extras"] = file.rows(chunk.rows[layer], chunk.corner)
        layers.append(file.buffer.add("nodes", node))
    return file.bytes(layers, attribution)


def pack_bytes(pack: Pack) -> bytes:
    """Return a pack as GLB: one node for each form of a prototype."""
    file = ContentFile(0)
    nodes = []
    shapes = pack.shapes
    kinds = {id(shape.prototype): shape for shape in shapes}
    for some in in_chunks([shape.prototype for shape in shapes]):
        batch = joined_apart(kind.mesh for kind in some)
        flat = flat_mesh(batch, np.zeros((batch.count, 3)))
        for row, kind in enumerate(some):
            shape = kinds[id(kind)]
            extras = {"prototype": shape.of, "beyond": shape.beyond}
            own = flat.one(row)
            if len(own.index):
                nodes.append(file.part(kind.name, own, batch.materials, np.zeros(3), extras))
    return file.bytes(nodes)


def paints_bytes(paints: Paints) -> bytes:
    """Return the materials as GLB, dry and with lamps on, with their textures.

    The extras of its scene tell what a weather does to each: see `weathering`.
    """
    file = ContentFile(TEXTURE_SIZE, Environment(lamps=1.0))  # the page turns them on
    for name in paints.names:
        file.materials.number(name)
    for material in file.buffer.document.get("materials", []):
        surface = material["pbrMetallicRoughness"]
        texts = [surface.get("baseColorTexture"), surface.get("metallicRoughnessTexture"),
                 material.get("normalTexture")]  # fmt: skip
        for text in filter(None, texts):
            text["extensions"] = {PLACES: {"scale": [1 / PER_TILE] * 2}}
            file.extensions.add(PLACES)
    materials = [material_named(name) for name in paints.names]
    return file.bytes([], extras={
        "materials": list(paints.names),
        "untinted": [material.name for material in materials if not material.takes_tint],
        "weather": [weathering(material) for material in materials],
    })  # fmt: skip


def weathering(material: Material) -> list[float]:
    """Return what rain and snow do to a material.

    Returns
    -------
    of_weather
        How much water darkens it, 0 to 1; whether water stands on it; how much snow lies where it
        faces up, 0 to 1, or `ANY_SLOPE`; and the share of snow in a file whose materials do not
        know what faces up.
    """
    if material.root in SNOWLESS | INDOORS:
        lying = 0.0
    elif material.root in FOLIAGE:
        lying = ANY_SLOPE
    else:
        lying = SLUSH_SHARE if material.root in DRIVEN else 1.0
    return [material.porosity, float(material.root in PUDDLED), lying, snow_share(material)]


class ContentFile:
    """A file in the making."""

    def __init__(self, texture_size: int, environment: Environment | None = None) -> None:
        self.buffer = GltfBuffer()
        self.packer = Packer(self.buffer)
        self.materials = GltfMaterials(self.buffer, environment or Environment(), texture_size)
        self.extensions: set[str] = set()
        self.objects: list[tuple[str, UInt64Array]] = []  # of the property table: layer, ids

    def merged(self, layer: str, batch: MeshBatch, corner: NDArray[np.float64]) -> list[int]:
        """Write objects as one mesh that tells them apart by a feature id; returns its node."""
        ids, which = np.unique(batch.object_id, return_inverse=True)
        feature = np.repeat(which.reshape(-1), np.diff(batch.vertex_start)).astype(np.float32)
        merged = replace(
            batch,
            object_id=np.zeros(1, np.uint64),
            vertex_start=np.array([0, len(batch.vertices)], np.int64),
            face_start=np.array([0, len(batch.faces)], np.int64),
        )
        flat = flat_mesh(merged, corner[None])
        if not len(flat.index):
            return []
        features, first = self.features(layer, ids)
        extra = {"extensions": {FEATURES: {"featureIds": [features]}}}
        self.extensions.add(FEATURES)
        return [self.part(layer, flat, batch.materials, corner, {}, feature + first, extra)]

    def part(
        self, name: str, flat: FlatMesh, materials: Sequence[str], corner: NDArray[np.float64],
        extras: dict[str, Any], feature: NDArray[np.float32] | None = None,
        extra: dict[str, Any] | None = None,
    ) -> int:  # fmt: skip
        """Write a mesh of one object with a primitive for each material; returns its node."""
        grid = on_grid(flat.position)
        primitives = []
        named = [materials[number] for number in flat.section_material.tolist()]
        for section in sorted(range(len(named)), key=named.__getitem__):
            first, last = flat.section_start[section : section + 2].tolist()
            index, vertex = used_vertices(flat.index[first:last])
            color = None if flat.color is None else flat.color[vertex]
            part = self.packer.primitive(
                grid.steps[vertex], flat.normal[vertex], flat.uv[vertex], color, index
            )
            part["material"] = self.materials.number(named[section])
            if feature is not None:
                own = feature[flat.vertex[vertex]][:, None]
                part["attributes"]["_FEATURE_ID_0"] = self.packer.attribute(own)
            primitives.append(part | (extra or {}))
        mesh = self.buffer.add("meshes", {"name": name, "primitives": primitives})
        placed = grid.placed
        placed["translation"] = (y_up(corner) + placed["translation"]).tolist()
        node = {"name": name, "mesh": mesh, **placed, **({"extras": extras} if extras else {})}
        return self.buffer.add("nodes", node)

    def rows(self, rows: Rows, corner: NDArray[np.float64]) -> dict[str, Any]:
        """Write the rows of a layer; returns what the extras of its node say of them."""
        arrays = dict(rows.arrays)
        arrays["TRANSLATION"] = y_up(arrays["TRANSLATION"]).astype(np.float32)
        arrays["SCALE"] = np.ascontiguousarray(arrays["SCALE"][:, [0, 2, 1]])
        accessors = {
            name: self.packer.attribute(
                array, vertex=False, normalized=name in ("ROTATION", "_COLOR_0")
            )
            for name, array in arrays.items()
        }
        return {"rows": accessors, "counts": [list(pair) for pair in rows.counts],
                "origin": y_up(corner).tolist()}  # fmt: skip

    def features(self, layer: str, ids: UInt64Array) -> tuple[dict[str, Any], int]:
        """Put objects into the property table of the file.

        A file has one table, since CesiumJS looks up all that is picked of a file in one.

        Returns
        -------
        features
            What a part whose vertices or rows name the objects says of them.
        first
            Row of the first object.
        """
        first = sum(len(held) for _, held in self.objects)
        self.objects.append((layer, ids))
        return {"featureCount": len(ids), "attribute": 0, "propertyTable": 0}, first

    def bytes(
        self,
        nodes: list[int],
        attribution: Sequence[str] = (),
        extras: dict[str, Any] | None = None,
    ) -> bytes:
        """Return the file."""
        asset: dict[str, Any] = {"version": "2.0", "generator": f"CityX {__version__}"}
        if attribution:
            asset["copyright"] = "; ".join(attribution)
        scene: dict[str, Any] = {"nodes": nodes} if nodes else {}
        self.buffer.add("scenes", scene | ({"extras": dict(extras)} if extras else {}))
        if self.objects:
            self.extensions.add(TABLES)
        used = self.extensions | self.packer.extensions | self.materials.extensions
        head: dict[str, Any] = {"asset": asset, "scene": 0}
        if used:
            head["extensionsUsed"] = sorted(used)
        needed = sorted(used & {QUANTIZATION, MESHOPT, INSTANCING})
        if needed:
            head["extensionsRequired"] = needed
        if self.objects:
            head["extensions"] = {TABLES: self._table()}
        file = BytesIO()
        self.buffer.write(file, head)
        return file.getvalue()

    def _table(self) -> dict[str, Any]:
        """Write the property table: ids of 16 hexadecimal digits, and layers."""
        ids = np.concatenate([held for _, held in self.objects])
        layers = sorted({layer for layer, _ in self.objects})
        which = np.concatenate([np.full(len(held), layers.index(layer), np.uint8)
                                for layer, held in self.objects])  # fmt: skip
        texts = np.frombuffer("".join(map(id_text, ids.tolist())).encode(), np.uint8)
        offsets = np.arange(0, len(texts) + 1, 16, dtype=np.uint32)
        named = [{"name": layer, "value": number} for number, layer in enumerate(layers)]
        schema = {
            "id": "cityx",
            "enums": {"layer": {"valueType": "UINT8", "values": named}},
            "classes": {"object": {"properties": {
                "id": {"type": "STRING", "required": True},
                "layer": {"type": "ENUM", "enumType": "layer", "required": True}}}},
        }  # fmt: skip
        properties = {
            "id": {"values": self.buffer.view(texts), "stringOffsets": self.buffer.view(offsets),
                   "stringOffsetType": "UINT32"},
            "layer": {"values": self.buffer.view(which)},
        }  # fmt: skip
        table = {"class": "object", "count": len(ids), "properties": properties}
        return {"schema": schema, "propertyTables": [table]}
