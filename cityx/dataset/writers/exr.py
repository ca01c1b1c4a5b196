"""OpenEXR files of many channels, none of which loses a bit."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cityx.dataset.channels import CHANNELS

# Names of the components of a channel by their number; ids of 64 bits are two layers of 32.
_COMPONENTS = {1: "Y", 2: "XY", 3: "XYZ"}
_COLOURS = "RGBA"
_HALVES = ("low", "high")
_WORD = np.uint64(32)


def write_exr(
    path: Path, channels: Mapping[str, NDArray[Any]], notes: Mapping[str, str] | None = None
) -> None:
    """Write channels into one multilayer OpenEXR file.

    Parameters
    ----------
    path
        The file.
    channels
        Channel name to (h, w) or (h, w, c). Floats are kept as float32, whole numbers as uint32;
        uint64 becomes the layers ``NAME.low`` and ``NAME.high``.
    notes
        Attributes of the header.
    """
    import OpenEXR

    planes: dict[str, NDArray[Any]] = {}
    for name, values in channels.items():
        planes |= _planes(name, values)
    header = {
        "compression": OpenEXR.ZIP_COMPRESSION,
        "type": OpenEXR.scanlineimage,
        **(notes or {}),
    }
    with OpenEXR.File(header, planes) as file:
        file.write(str(path))


def _planes(name: str, values: NDArray[Any]) -> dict[str, NDArray[Any]]:
    if values.dtype == np.uint64:
        parts = (values & np.uint64(0xFFFFFFFF), values >> _WORD)
        return {
            f"{name}.{half}": np.ascontiguousarray(part, np.uint32)
            for half, part in zip(_HALVES, parts, strict=True)
        }
    dtype = np.float32 if values.dtype.kind == "f" else np.uint32
    if values.ndim == 2:
        return {f"{name}.Y": np.ascontiguousarray(values, dtype)}
    return {
        plane: np.ascontiguousarray(values[..., index], dtype)
        for index, plane in enumerate(_names(name, values.shape[2]))
    }


def _names(name: str, count: int) -> list[str]:
    """Return the names of the components of a channel in the order of its values."""
    if name == "rgb":
        return list("RGB")  # the layer that viewers show
    if count > len(_COLOURS):  # Cryptomatte: crypto_object00.R, ...
        return [f"{name}{rank // 4:02d}.{_COLOURS[rank % 4]}" for rank in range(count)]
    coloured = count == 3 and name in CHANNELS and CHANNELS[name].unit == ""
    letters = _COLOURS if coloured and name != "normal" else _COMPONENTS.get(count, _COLOURS)
    return [f"{name}.{letters[index]}" for index in range(count)]


def read_exr(path: Path) -> dict[str, NDArray[Any]]:
    """Read the channels that `write_exr` wrote, with the types of the table of channels."""
    import OpenEXR

    with OpenEXR.File(str(path), separate_channels=True) as file:
        planes = {name: channel.pixels for name, channel in file.channels().items()}
    found = {}
    for name, channel in CHANNELS.items():
        if f"{name}.{_HALVES[0]}" in planes:
            low, high = (planes[f"{name}.{half}"].astype(np.uint64) for half in _HALVES)
            found[name] = low | (high << _WORD)
        elif channel.depth == 1 and f"{name}.Y" in planes:
            found[name] = planes[f"{name}.Y"].astype(channel.dtype)
        elif channel.depth > 1 and _names(name, channel.depth)[0] in planes:
            parts = [planes[plane] for plane in _names(name, channel.depth)]
            found[name] = np.stack(parts, axis=-1).astype(channel.dtype)
    return found
