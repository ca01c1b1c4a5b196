"""Formats that datasets are written in, one module each, loaded when asked for."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from importlib import import_module
from types import MappingProxyType
from typing import TYPE_CHECKING

from cityx.errors import InputError, nearest

if TYPE_CHECKING:
    from cityx.dataset.writers.writer import Format

# Name to its module, the name of its value there, and the libraries it needs.
FORMATS: Mapping[str, tuple[str, tuple[str, ...]]] = MappingProxyType({
    "raw": ("RAW", ("OpenEXR",)),
    "coco": ("COCO", ("pycocotools",)),
    "kitti": ("KITTI", ()),
    "nuscenes": ("NUSCENES", ()),
    "nerf": ("NERF", ()),
    "colmap": ("COLMAP", ()),
    "webdataset": ("WEBDATASET", ()),
})  # fmt: skip


def formats_named(words: Iterable[str]) -> tuple[Format, ...]:
    """Return the formats that words name, in the order of the table.

    Raises
    ------
    InputError
        Naming every word that is no format.
    """
    wanted = set(words)
    unknown = sorted(wanted - set(FORMATS))
    if unknown:
        faults = " ".join(f'there is no format "{w}".{nearest(w, FORMATS)}' for w in unknown)
        raise InputError(f"{faults} Known are: {', '.join(FORMATS)}.")
    return tuple(_load(name) for name in FORMATS if name in wanted)


def libraries_of(words: Iterable[str]) -> tuple[str, ...]:
    """Return the libraries that formats need, as they are imported."""
    return tuple(lib for word in words if word in FORMATS for lib in FORMATS[word][1])


def _load(name: str) -> Format:
    module = import_module(f"cityx.dataset.writers.{name}")
    found: Format = getattr(module, FORMATS[name][0])
    return found
