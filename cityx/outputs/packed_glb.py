"""A GLB made small: positions, normals and texture places in whole numbers, all arrays in streams.

It works on the file that `cityx.outputs.glb` writes, or any other of glTF 2.0 with one buffer:
nodes, names, extras, ids and materials stay as they are. Positions lie on the grid of
`cityx.outputs.packing`, so what met before still meets.

References
----------
Khronos Group, ``KHR_mesh_quantization``, ``KHR_texture_transform``; A. Kapoulkine,
``EXT_meshopt_compression``.
"""

from __future__ import annotations

import json
import math
import os
import struct
from collections.abc import Mapping
from dataclasses import dataclass, field
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cityx.errors import InputError, MissingExtra
from cityx.outputs.gltf_buffer import ARRAY_BUFFER, ELEMENT_ARRAY_BUFFER, MESHOPT, GltfBuffer
from cityx.outputs.packing import (
    PER_METRE,
    PER_TILE,
    QUANTIZATION,
    Packer,
    codec,
    on_grid,
    small_normals,
    small_places,
)
from cityx.system.atomic import replaced

_INSTANCING, _TRANSFORM = "EXT_mesh_gpu_instancing", "KHR_texture_transform"
_TYPES: dict[int, np.dtype[Any]] = {
    5120: np.dtype("i1"), 5121: np.dtype("u1"), 5122: np.dtype("<i2"),
    5123: np.dtype("<u2"), 5125: np.dtype("<u4"), 5126: np.dtype("<f4"),
}  # fmt: skip
_WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT4": 16}
_FURTHEST = 32767  # steps of 16 bits to each side
_RESTART = 65535  # an index that means another thing
_TURN = 32767  # steps of a component of a rotation
_ROW_STEPS = 1024.0  # steps of a metre in the places of instances


def _progressive(data: bytes) -> bytes:
    """Return a JPEG of the same quality that is coded in scans, which takes a tenth less."""
    from PIL import Image

    held = BytesIO()
    try:
        with Image.open(BytesIO(data)) as image:
            image.save(held, "JPEG", quality="keep", progressive=True)
    except (OSError, ValueError):  # not a JPEG that is known here: it stays as it is
        return data
    return held.getvalue()


def require_codec() -> None:
    """Refuse a machine without the codec.

    Raises
    ------
    MissingExtra
        If it is not installed.
    """
    if codec() is None:
        raise MissingExtra("packed GLB needs the extra view: pip install 'cityx[view]'.")


def pack_glb(source: str | os.PathLike[str], path: str | os.PathLike[str]) -> int:
    """Write a GLB anew in its small form and return its length in bytes.

    Parameters
    ----------
    source
        The file; its positions change by 3 mm at most, its texture places by 1/512 tile.
    path
        File to make, which may be the same; replaced when the new one is complete.

    Raises
    ------
    InputError
        If the file is no GLB with one buffer.
    """
    document, binary = _read(Path(source))
    packing = _Packing(document, binary)
    head = packing.packed()
    with replaced(path) as temporary, temporary.open("wb") as file:
        return packing.buffer.write(file, head)


def _read(path: Path) -> tuple[dict[str, Any], bytes]:
    data = path.read_bytes()
    if len(data) < 20 or data[:4] != b"glTF" or data[16:20] != b"JSON":
        raise InputError(f"{path} is no GLB; it must begin with glTF and a chunk of JSON.")
    size = struct.unpack_from("<I", data, 12)[0]
    document: dict[str, Any] = json.loads(data[20 : 20 + size])
    if len(document.get("buffers", ())) > 1 or MESHOPT in document.get("extensionsUsed", ()):
        raise InputError(f"{path} is packed already or has several buffers; give a plain GLB.")
    return document, data[28 + size :]


@dataclass
class _Stream:
    """Arrays of one role that are written as one, and the accessors that read them."""

    arrays: list[NDArray[Any]] = field(default_factory=list)
    accessors: list[int] = field(default_factory=list)
    length: int = 0


class _Packing:
    """A file in its small form, in the making."""

    def __init__(self, document: dict[str, Any], binary: bytes) -> None:
        self.old, self.binary = document, binary
        self.buffer = GltfBuffer()
        self.packer = Packer(self.buffer)
        self.extensions = {QUANTIZATION}
        self._meshes: dict[int, dict[str, Any]] = dict(enumerate(document.get("meshes", ())))
        self._streams: dict[tuple[Any, ...], _Stream] = {}
        self._small: dict[int, int] = {}  # steps of a metre of meshes whose rows take them up
        self._known: dict[tuple[Any, ...], int] = {}

    def packed(self) -> dict[str, Any]:
        """Write everything; returns the head of the file."""
        new, old = self.buffer.document, self.old
        nodes: list[dict[str, Any]] = [dict(node) for node in old.get("nodes", ())]
        for mesh, users in sorted(self._users(nodes).items()):
            self._mesh(mesh, users)
        for node in nodes:
            if _INSTANCING in node.get("extensions", {}):
                self._rows(node)
        new["nodes"] = nodes
        new["meshes"] = [self._meshes[number] for number in range(len(old.get("meshes", ())))]
        new["materials"] = [self._material(item) for item in old.get("materials", ())]
        new["images"] = [self._image(item) for item in old.get("images", ())]
        new["skins"] = [self._skin(item) for item in old.get("skins", ())]
        new["animations"] = [self._animation(item) for item in old.get("animations", ())]
        self._write_streams()
        used = {*old.get("extensionsUsed", ()), *self.extensions, *self.packer.extensions}
        needed = {*old.get("extensionsRequired", ()), *(used & {QUANTIZATION, MESHOPT})}
        head = {key: value for key, value in old.items() if key not in {*new, "buffers"}}
        return head | {"extensionsUsed": sorted(used), "extensionsRequired": sorted(needed)}

    def _users(self, nodes: list[dict[str, Any]]) -> dict[int, list[tuple[dict[str, Any], str]]]:
        """Return the nodes of each mesh, and how freely its places may be written in each.

        "anywhere" if the node stands alone and unturned, "scaled" if only its scale may change,
        "fixed" if nothing may, since children, a skin or an animation would follow.
        """
        moved: dict[int, set[str]] = {}
        for animation in self.old.get("animations", ()):
            for channel in animation["channels"]:
                target = channel["target"]
                moved.setdefault(target["node"], set()).add(target["path"])
        found: dict[int, list[tuple[dict[str, Any], str]]] = {}
        for number, node in enumerate(nodes):
            if "mesh" not in node:
                continue
            paths = moved.get(number, set())
            if "scale" in paths or {"skin", "children", "matrix"} & node.keys():
                free = "fixed"
            elif paths or {"rotation", "scale", "extensions"} & node.keys():
                free = "scaled"
            else:
                free = "anywhere"
            found.setdefault(node["mesh"], []).append((node, free))
        return found

    def _mesh(self, number: int, users: list[tuple[dict[str, Any], str]]) -> None:
        mesh = self.old["meshes"][number]
        parts = mesh["primitives"]
        places = {part["attributes"]["POSITION"] for part in parts}
        furthest = max(float(np.abs(self._array(place)).max(initial=0)) for place in places)
        kinds = {free for _, free in users}
        shift = np.zeros(3)
        if kinds == {"anywhere"} and len(users) == 1 and len(places) == 1:
            node = users[0][0]
            shift = np.array(node.get("translation", [0, 0, 0]), np.float64)
            grid = on_grid(self._array(next(iter(places))) + shift)
            node |= grid.placed
            steps = {next(iter(places)): grid.steps}
        elif "fixed" in kinds or furthest * (per := self._steps_of(users)) > _FURTHEST:
            steps = {place: self._array(place) for place in places}
        else:
            steps = {place: _signed(self._array(place), per) for place in places}
            for node, _ in users:
                if _INSTANCING not in node.get("extensions", {}):
                    old = np.array(node.get("scale", [1, 1, 1]), np.float64)
                    node["scale"] = (old / per).tolist()
            self._small[number] = per
        key = shift.tobytes() + bytes(str(self._small.get(number, 0)), "ascii")
        self._meshes[number] = {
            **mesh,
            "primitives": [self._primitive(part, steps, key) for part in parts],
        }

    def _steps_of(self, users: list[tuple[dict[str, Any], str]]) -> int:
        """Return steps of a metre: of what is drawn larger than it is, as many times more."""
        largest = 1.0
        for node, _ in users:
            scales = [node.get("scale", [1, 1, 1])]
            rows = node.get("extensions", {}).get(_INSTANCING, {}).get("attributes", {})
            if "SCALE" in rows:
                scales.append(np.abs(self._array(rows["SCALE"])).max(axis=0))
            largest = max(largest, float(np.prod([np.max(np.abs(s)) for s in scales])))
        return PER_METRE << math.ceil(math.log2(largest))

    def _primitive(
        self, part: dict[str, Any], steps: Mapping[int, NDArray[Any]], shift: bytes
    ) -> dict[str, Any]:
        new = {**part, "attributes": {}}
        for name, number in part["attributes"].items():
            key = (name, number, shift) if name == "POSITION" else (
                name, number)  # fmt: skip
            if key not in self._known:
                place = steps[number] if name == "POSITION" else None
                self._known[key] = self._attribute(name, number, place)
            new["attributes"][name] = self._known[key]
        if "indices" in part:
            key = ("indices", part["indices"])
            if key not in self._known:
                index = self._array(part["indices"]).reshape(-1).astype(np.uint32)
                small = index.astype(np.uint16) if index.max(initial=0) < _RESTART else index
                self._known[key] = self._joined("TRIANGLES", small, ELEMENT_ARRAY_BUFFER)
            new["indices"] = self._known[key]
        return new

    def _attribute(self, name: str, number: int, place: NDArray[Any] | None) -> int:
        if place is not None:
            return self._joined(name, place, ARRAY_BUFFER, width=3)
        values = self._array(number)
        if name == "NORMAL":
            return self._joined(name, small_normals(values), ARRAY_BUFFER, width=3, normalized=True)
        if name == "TEXCOORD_0":
            return self._joined(name, small_places(values), ARRAY_BUFFER)
        normalized = bool(self.old["accessors"][number].get("normalized"))
        return self._joined(name, values, ARRAY_BUFFER, normalized=normalized)

    def _joined(
        self, role: str, values: NDArray[Any], target: int = 0, *, width: int | None = None,
        normalized: bool = False,
    ) -> int:  # fmt: skip
        """Put an array into the stream of its role and return its accessor.

        A view for each of thousands of arrays would weigh as much as what is in them.
        """
        key = role, target, values.dtype.str, values.shape[1:]
        held = self._streams.setdefault(key, _Stream())
        bounds = None
        if role == "POSITION":
            bounds = values[:, :3].min(axis=0).tolist(), values[:, :3].max(axis=0).tolist()
        number = self.buffer.accessor(
            -1, values, width=width, first=held.length, count=len(values), bounds=bounds,
            normalized=normalized,
        )  # fmt: skip
        held.accessors.append(number)
        held.arrays.append(values)
        held.length += len(values)
        return number

    def _write_streams(self) -> None:
        for (role, target, *_), held in self._streams.items():
            mode = "TRIANGLES" if role == "TRIANGLES" else "ATTRIBUTES"
            view = self.packer.stream(np.concatenate(held.arrays), mode, target)
            for number in held.accessors:
                self.buffer.document["accessors"][number]["bufferView"] = view

    def _rows(self, node: dict[str, Any]) -> None:
        """Write the rows of instances; what the mesh was made smaller by, they make larger."""
        told = node["extensions"][_INSTANCING]["attributes"]
        new = {}
        for name, number in told.items():
            values = self._array(number)
            if name == "SCALE" and node["mesh"] in self._small:
                values = (values / self._small[node["mesh"]]).astype(np.float32)
            elif name == "TRANSLATION":
                values = (np.rint(values * _ROW_STEPS) / _ROW_STEPS).astype(np.float32)
            turned = name == "ROTATION"
            if turned:
                values = np.rint(values * _TURN).astype(np.int16)
            new[name] = self._joined(name, values, normalized=turned)
        extension = {**node["extensions"], _INSTANCING: {"attributes": new}}
        node["extensions"] = extension

    def _material(self, item: dict[str, Any]) -> dict[str, Any]:
        """Return a material whose textures know that their places are counted in steps."""
        new = json.loads(json.dumps(item))
        surface = new.get("pbrMetallicRoughness", {})
        texts = [surface.get("baseColorTexture"), surface.get("metallicRoughnessTexture")]
        texts += [new.get(f"{kind}Texture") for kind in ("normal", "occlusion", "emissive")]
        for text in filter(None, texts):
            text.setdefault("extensions", {})[_TRANSFORM] = {"scale": [1 / PER_TILE] * 2}
            self.extensions.add(_TRANSFORM)
        return dict(new)

    def _image(self, item: dict[str, Any]) -> dict[str, Any]:
        if "bufferView" not in item:
            return item
        view = self.old["bufferViews"][item["bufferView"]]
        first = view.get("byteOffset", 0)
        data = self.binary[first : first + view["byteLength"]]
        if item.get("mimeType") == "image/jpeg":
            data = min(data, _progressive(data), key=len)
        return {**item, "bufferView": self.buffer.view(np.frombuffer(data, np.uint8))}

    def _skin(self, item: dict[str, Any]) -> dict[str, Any]:
        if "inverseBindMatrices" not in item:
            return item
        return {**item, "inverseBindMatrices": self._plain(item["inverseBindMatrices"])}

    def _animation(self, item: dict[str, Any]) -> dict[str, Any]:
        samplers = [
            {**sampler, "input": self._plain(sampler["input"]),
             "output": self._plain(sampler["output"])}
            for sampler in item["samplers"]
        ]  # fmt: skip
        return {**item, "samplers": samplers}

    def _plain(self, number: int) -> int:
        """Write an array as it is."""
        if ("plain", number) not in self._known:
            values, old = self._array(number), self.old["accessors"][number]
            values = values[:, 0] if values.shape[1] == 1 else values
            bounds = (old["min"], old["max"]) if "min" in old else None
            self._known["plain", number] = self.buffer.accessor(
                self.buffer.view(values), values, bounds=bounds,
                normalized=bool(old.get("normalized")),
            )  # fmt: skip
        return self._known["plain", number]

    def _array(self, number: int) -> NDArray[Any]:
        """Return what an accessor reads, (n, c)."""
        item = self.old["accessors"][number]
        view = self.old["bufferViews"][item["bufferView"]]
        kind, width = _TYPES[item["componentType"]], _WIDTHS[item["type"]]
        row = width * kind.itemsize
        stride = view.get("byteStride", row)
        first = view.get("byteOffset", 0) + item.get("byteOffset", 0)
        if item["count"] and first + (item["count"] - 1) * stride + row > len(self.binary):
            raise InputError(f"accessor {number} reads past the end of the file.")
        return np.ndarray((item["count"], width), kind, self.binary, first, (stride, kind.itemsize))


def _signed(points: NDArray[Any], per: int) -> NDArray[np.int16]:
    """Return positions about zero, (n, 4) steps, the fourth for the padding."""
    steps = np.zeros((len(points), 4), np.int16)
    steps[:, :3] = np.rint(points * per)
    return steps
