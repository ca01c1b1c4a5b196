"""Small forms of what a GLB holds: whole numbers on a grid, and streams of the meshopt codec.

Positions lie on one grid of 1/256 m that all files of a city share, so that neighbours still meet;
texture places count in 1/256 of a tile. Without the codec, which an extra brings, arrays are stored
as they are: the same numbers in more bytes.

References
----------
Khronos Group, ``KHR_mesh_quantization``; A. Kapoulkine, ``EXT_meshopt_compression``.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cityx.outputs.gltf_buffer import ARRAY_BUFFER, ELEMENT_ARRAY_BUFFER, MESHOPT, GltfBuffer

QUANTIZATION = "KHR_mesh_quantization"
PER_METRE = 256  # steps of the grid: 2 mm off at most, and exact in floating point
PER_TILE = 256  # steps of texture places: 4 mm of a tile of two metres at most
_MOST = 65535  # steps of 16 bits
_FURTHEST = 32767 / PER_TILE  # tiles that 16 bits reach to each side


@lru_cache(maxsize=1)
def codec() -> Any | None:
    """Return the module that encodes streams, None where it is not installed."""
    try:
        import meshopt
    except ImportError:
        return None
    return meshopt


@dataclass(frozen=True)
class Grid:
    """Positions as they are stored, and the node that puts them in their place.

    Attributes
    ----------
    steps
        (n, 4) uint16, the fourth for the padding; or (n, 3) float32 where 16 bits do not reach.
    origin
        (3,) metres, of the node.
    scale
        Metres of a step.
    """

    steps: NDArray[Any]
    origin: NDArray[np.float64]
    scale: float

    @property
    def placed(self) -> dict[str, Any]:
        """Translation and scale of the node."""
        found: dict[str, Any] = {"translation": self.origin.tolist()}
        return found if self.scale == 1.0 else {**found, "scale": [self.scale] * 3}


def on_grid(points: NDArray[Any]) -> Grid:
    """Put positions, (n, 3) metres, on the grid that all files share."""
    steps = np.rint(np.asarray(points, np.float64) * PER_METRE)
    low = steps.min(axis=0)
    if (np.ptp(steps, axis=0) > _MOST).any():
        origin = low / PER_METRE
        return Grid((steps / PER_METRE - origin).astype(np.float32), origin, 1.0)
    padded = np.zeros((len(steps), 4), np.uint16)
    padded[:, :3] = steps - low
    return Grid(padded, low / PER_METRE, 1 / PER_METRE)


def small_normals(normal: NDArray[np.float32]) -> NDArray[np.int8]:
    """Return unit vectors as (n, 4) signed bytes, the fourth for the padding."""
    padded = np.zeros((len(normal), 4), np.int8)
    padded[:, :3] = np.rint(np.clip(normal, -1, 1) * 127)
    return padded


def small_places(uv: NDArray[np.float32]) -> NDArray[Any]:
    """Return texture places, (n, 2) tiles, in steps of 1/256 tile, whole tiles taken off.

    They are int16, or float32 where that does not reach.
    """
    near = uv - np.round(np.median(uv, axis=0))
    if np.abs(near).max(initial=0) > _FURTHEST:
        return np.asarray(near * PER_TILE, np.float32)
    return np.asarray(np.rint(near * PER_TILE), np.int16)


def used_vertices(index: NDArray[np.uint32]) -> tuple[NDArray[np.uint32], NDArray[np.int64]]:
    """Return triangles whose vertices are numbered anew, and which vertices those are.

    With the codec, triangles come in the order that graphics cards like, and vertices in the order
    of their first use, which is what its streams are small by.
    """
    used, compact = np.unique(index, return_inverse=True)
    corners: NDArray[np.uint32] = compact.reshape(-1).astype(np.uint32)
    held = codec()
    if held is None:
        return corners, used.astype(np.int64)
    ordered, place, _ = held.reorder_mesh(corners, triangles=True, optsize=False)
    return np.asarray(ordered, np.uint32), used[np.argsort(place)].astype(np.int64)


class Packer:
    """Writes arrays to a file in their small form.

    Parameters
    ----------
    buffer
        The file in the making.

    Attributes
    ----------
    extensions
        What a reader of the file must know.
    """

    def __init__(self, buffer: GltfBuffer) -> None:
        self.buffer = buffer
        self.extensions: set[str] = set()

    def attribute(
        self, values: NDArray[Any], *, width: int | None = None, normalized: bool = False,
        vertex: bool = True,
    ) -> int:  # fmt: skip
        """Write an attribute of vertices or of rows and return its accessor; (n, c)."""
        bounds = None
        if width == 3 and not normalized:  # a position
            shown = values[:, :3]
            bounds = shown.min(axis=0).tolist(), shown.max(axis=0).tolist()
        target = ARRAY_BUFFER if vertex else 0
        view = self.stream(values, "ATTRIBUTES", target)
        return self.buffer.accessor(view, values, width=width, normalized=normalized, bounds=bounds)

    def triangles(self, index: NDArray[np.uint32]) -> int:
        """Write corners of triangles, (3 t,), and return their accessor."""
        small = index.astype(np.uint16) if index.max(initial=0) < _MOST else index
        return self.buffer.accessor(self.stream(small, "TRIANGLES", ELEMENT_ARRAY_BUFFER), small)

    def primitive(
        self, steps: NDArray[Any], normal: NDArray[np.float32], uv: NDArray[np.float32],
        color: NDArray[np.uint8] | None, index: NDArray[np.uint32],
    ) -> dict[str, Any]:  # fmt: skip
        """Write the arrays of a primitive in their small form; positions come from `on_grid`."""
        self.extensions.add(QUANTIZATION)
        attributes = {
            "POSITION": self.attribute(steps, width=3),
            "NORMAL": self.attribute(small_normals(normal), width=3, normalized=True),
            "TEXCOORD_0": self.attribute(small_places(uv)),
        }
        if color is not None and (color != 255).any():
            attributes["COLOR_0"] = self.attribute(color, normalized=True)
        return {"attributes": attributes, "indices": self.triangles(index)}

    def stream(self, values: NDArray[Any], mode: str, target: int) -> int:
        """Write an array, (n,) or (n, c), and return its buffer view."""
        held = codec()
        if held is None:
            return self.buffer.view(values, target=target, shared=mode == "ATTRIBUTES")
        self.extensions.add(MESHOPT)
        packed = held.encode_gltf_buffer(np.ascontiguousarray(values), mode)
        return self.buffer.packed_view(packed, values, mode, target=target)
