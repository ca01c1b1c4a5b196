"""Dataset writers: formats of datasets, one module each, loaded when asked for.

An installed package adds one as a `cityx.dataset.writers.format.Format` under the entry point group
``cityx.dataset_writers``.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from importlib import import_module
from types import MappingProxyType
from typing import TYPE_CHECKING

from cityx.errors import InputError, UsageError, nearest
from cityx.system.extensions import extensions, refusals, remembered

if TYPE_CHECKING:
    from cityx.dataset.writers.format import Format

GROUP = "cityx.dataset_writers"
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
    outside = {} if wanted <= set(FORMATS) else outside_formats()
    known = (*FORMATS, *outside)
    unknown = sorted(wanted - set(known))
    if unknown:
        faults = [f'there is no format "{w}".{nearest(w, known)}' for w in unknown]
        raise InputError(" ".join([*faults, f"Known are: {', '.join(known)}.", *refusals()]))
    return tuple(outside.get(name) or _load(name) for name in known if name in wanted)


@remembered
def outside_formats() -> Mapping[str, Format]:
    """Return the formats that installed packages add, by name."""
    from cityx.dataset.writers.format import Format

    def admit(value: object) -> tuple[str, Format]:
        if not isinstance(value, Format) or not value.name.isidentifier():
            raise UsageError("it is no cityx.dataset.writers.format.Format with a plain name.")
        return value.name, value

    return extensions(GROUP, admit, FORMATS.__contains__)


def libraries_of(words: Iterable[str]) -> tuple[str, ...]:
    """Return the libraries that formats need, as they are imported."""
    return tuple(lib for word in words if word in FORMATS for lib in FORMATS[word][1])


def _load(name: str) -> Format:
    module = import_module(f"cityx.dataset.writers.{name}")
    found: Format = getattr(module, FORMATS[name][0])
    return found
