"""Prototypes that are slow to make, kept from run to run."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache, wraps
from pathlib import Path
from typing import Any

import numpy as np

from cityx import geometry, ids
from cityx.city import bodies, mesh, scene
from cityx.city.mesh import MeshBatch
from cityx.city.scene import Prototype
from cityx.ids import id_text, stable_id
from cityx.system.cache import Arrays, cached_arrays
from cityx.system.digests import edition_of
from cityx.system.tables import files_of

COLUMNS = ("vertices", "faces", "material", "uv", "tint")
Maker = Callable[..., Prototype]


def kept(group: str, *, least: int) -> Callable[[Maker], Maker]:
    """Take the prototypes of a maker from the cache when an earlier run has stored them.

    Parameters
    ----------
    group
        Of the maker; no other has it.
    least
        Level of detail from which prototypes are slow enough to be kept; it is the argument
        ``detail`` of the maker, 2 where it is not given.
    """

    def decorate(make: Maker) -> Maker:
        @wraps(make)
        def made(*args: Any, **options: Any) -> Prototype:
            if options.get("detail", 2) < least:
                return make(*args, **options)
            asked = id_text(stable_id(group, repr((args, sorted(options.items())))))
            key = f"prototypes-{edition()}/{group}-{asked}"
            return _unpacked(cached_arrays(key, lambda: _packed(make(*args, **options))))

        return made

    return decorate


def _packed(made: Prototype) -> Arrays:
    words = np.array([made.name, made.kind, *made.mesh.materials])
    return {"words": words} | {name: getattr(made.mesh, name) for name in COLUMNS}


def _unpacked(held: Arrays) -> Prototype:
    name, kind, *materials = held["words"].tolist()
    columns = {column: held[column] for column in COLUMNS}
    batch = MeshBatch(
        np.zeros(1, np.uint64),
        np.array([0, len(columns["vertices"])], np.int64),
        np.array([0, len(columns["faces"])], np.int64),
        materials=tuple(materials),
        **columns,
    )
    return Prototype(name, kind, batch)


@cache
def edition() -> str:
    """Return a hash of the code and data that make prototypes: a kept one is of these alone."""
    assets, kernels = Path(__file__).parent, Path(geometry.__file__).parent
    sources = [*sorted(assets.rglob("*.py")), *sorted(kernels.rglob("*.py"))]
    sources += [Path(str(module.__file__)) for module in (ids, bodies, mesh, scene)]
    return edition_of([*sources, *files_of("assets")])
