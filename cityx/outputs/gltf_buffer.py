"""The growing content of a glTF 2.0 binary file.

References
----------
Khronos Group, "glTF 2.0 Specification", ISO/IEC 12113:2022.
"""

from __future__ import annotations

import json
import os
import struct
from dataclasses import dataclass, field
from io import BytesIO
from typing import Any, BinaryIO

import numpy as np
from numpy.typing import NDArray

from cityx.errors import UsageError

ARRAY_BUFFER, ELEMENT_ARRAY_BUFFER = 34962, 34963
BYTE, UBYTE, SHORT, USHORT, UINT, FLOAT = 5120, 5121, 5122, 5123, 5125, 5126
MESHOPT = "EXT_meshopt_compression"
_COMPONENT = {
    np.dtype(np.int8): BYTE,
    np.dtype(np.uint8): UBYTE,
    np.dtype(np.int16): SHORT,
    np.dtype(np.uint16): USHORT,
    np.dtype(np.uint32): UINT,
    np.dtype(np.float32): FLOAT,
}
_KIND = {1: "SCALAR", 2: "VEC2", 3: "VEC3", 4: "VEC4", 16: "MAT4"}
_LARGEST = 2**32 - 1  # lengths in a GLB are 32-bit


@dataclass
class GltfBuffer:
    """Lists of a glTF document and the binary data they point into.

    Attributes
    ----------
    document
        Top-level arrays by name ("nodes", "meshes", ...), filled in place.
    """

    document: dict[str, list[Any]] = field(default_factory=dict)
    _chunks: list[NDArray[np.uint8]] = field(default_factory=list)
    _length: int = 0
    _unpacked: int = 0  # bytes that the compressed views have once they are decoded

    def add(self, kind: str, item: dict[str, Any]) -> int:
        """Append to a top-level array and return the position."""
        items = self.document.setdefault(kind, [])
        items.append(item)
        return len(items) - 1

    def view(self, values: NDArray[Any], *, target: int = 0, shared: bool = False) -> int:
        """Append an array as a buffer view, 4-byte aligned.

        Parameters
        ----------
        values
            (n,) or (n, c); rows of vertex attributes must be multiples of 4 bytes.
        shared
            Whether several accessors of vertex attributes will read it (then glTF asks for the
            stride).
        """
        flat = np.ascontiguousarray(values).reshape(-1).view(np.uint8)
        item = self._append(flat)
        if shared:
            item["byteStride"] = values.dtype.itemsize * (values.shape[1] if values.ndim > 1 else 1)
        if target:
            item["target"] = target
        return self.add("bufferViews", item)

    def packed_view(
        self, packed: bytes, values: NDArray[Any], mode: str, *, target: int = 0
    ) -> int:
        """Append an array that is compressed already as a view of ``EXT_meshopt_compression``.

        Parameters
        ----------
        packed
            What the codec made of it.
        values
            (n,) or (n, c), as it is decoded.
        mode
            "ATTRIBUTES", "TRIANGLES" or "INDICES".
        """
        stride = values.nbytes // len(values)
        held = self._append(np.frombuffer(packed, np.uint8))
        held |= {"byteStride": stride, "count": len(values), "mode": mode}
        item: dict[str, Any] = {
            "buffer": 1, "byteOffset": self._unpacked, "byteLength": values.nbytes,
            "extensions": {MESHOPT: held},
        }  # fmt: skip
        if mode == "ATTRIBUTES" and target:
            item["byteStride"] = stride
        if target:
            item["target"] = target
        self._unpacked += values.nbytes + -values.nbytes % 4
        return self.add("bufferViews", item)

    def _append(self, flat: NDArray[np.uint8]) -> dict[str, Any]:
        """Append bytes, 4-byte aligned, and return where they lie."""
        item: dict[str, Any] = {"buffer": 0, "byteOffset": self._length, "byteLength": len(flat)}
        padding = -len(flat) % 4
        self._chunks.append(flat)
        if padding:
            self._chunks.append(np.zeros(padding, np.uint8))
        self._length += len(flat) + padding
        return item

    def accessor(
        self,
        view: int,
        values: NDArray[Any],
        *,
        width: int | None = None,
        first: int = 0,
        count: int | None = None,
        bounds: tuple[list[float], list[float]] | None = None,
        normalized: bool = False,
    ) -> int:
        """Append an accessor to rows ``first:first + count`` of the array behind a view.

        With `width` only so many columns are read, as of rows that are padded to 4 bytes.
        """
        columns = values.shape[1] if values.ndim > 1 else 1
        item: dict[str, Any] = {
            "bufferView": view,
            "componentType": _COMPONENT[values.dtype],
            "count": len(values) if count is None else count,
            "type": _KIND[width or columns],
        }
        if first:
            item["byteOffset"] = first * columns * values.dtype.itemsize
        if normalized:
            item["normalized"] = True
        if bounds is not None:
            item["min"], item["max"] = bounds
        return self.add("accessors", item)

    def write(self, file: BinaryIO, head: dict[str, Any]) -> int:
        """Write the GLB and return its length in bytes.

        Parameters
        ----------
        head
            Top-level objects beside the arrays: "asset", "scene", "extensionsUsed", ...
        """
        document = {**head, **{name: items for name, items in self.document.items() if items}}
        if self._length:
            document["buffers"] = [{"byteLength": self._length}]
        if self._unpacked:
            decoded = {"byteLength": self._unpacked, "extensions": {MESHOPT: {"fallback": True}}}
            document["buffers"].append(decoded)
        text = json.dumps(document, ensure_ascii=False, separators=(",", ":"), allow_nan=False)
        encoded = text.encode()
        encoded += b" " * (-len(encoded) % 4)
        total = 12 + 8 + len(encoded) + (8 + self._length if self._length else 0)
        if total > _LARGEST:
            raise UsageError(
                f"the city is {total / 1e9:.1f} GB as glTF, and a GLB holds at most 4.3 GB; "
                "build it with a lower level of detail or in tiles"
            )
        file.write(struct.pack("<4sII", b"glTF", 2, total))
        file.write(struct.pack("<I4s", len(encoded), b"JSON") + encoded)
        if self._length:
            file.write(struct.pack("<I4s", self._length, b"BIN\0"))
            for chunk in self._chunks:
                file.write(chunk.data)
        file.flush()
        if not isinstance(file, BytesIO):
            os.fsync(file.fileno())
        return total
