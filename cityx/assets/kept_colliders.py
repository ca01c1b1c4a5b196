"""Colliders of prototypes, kept from run to run: hulls of thousands of pieces take long to find."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import fields
from hashlib import blake2b
from types import MappingProxyType

import numpy as np

from cityx.assets.kept_prototypes import edition
from cityx.city.scene import Prototype
from cityx.geometry.convex import Box, Cylinder, Hull, Solid
from cityx.system.cache import Arrays, cached_arrays

KINDS: Mapping[str, Callable[..., Solid]] = MappingProxyType(
    {kind.__name__: kind for kind in (Hull, Box, Cylinder)}
)
FEW = 64  # faces up to which a collider is found sooner than read


def kept_collider(prototype: Prototype, make: Callable[[Prototype], list[Solid]]) -> list[Solid]:
    """Return what `make` finds for a prototype, from the cache where an earlier run has left it."""
    mesh = prototype.mesh
    if len(mesh.faces) <= FEW:
        return make(prototype)
    import scipy

    hasher = blake2b(
        repr((prototype.name, prototype.kind, mesh.materials)).encode(), digest_size=16
    )
    for array in (mesh.vertices, mesh.faces, mesh.material):
        hasher.update(np.ascontiguousarray(array).data)
    key = f"colliders-{edition()}-{scipy.__version__}/{hasher.hexdigest()}"
    return _unpacked(cached_arrays(key, lambda: _packed(make(prototype))))


def _packed(solids: list[Solid]) -> Arrays:
    return {
        f"{number} {type(solid).__name__} {column.name}": np.asarray(getattr(solid, column.name))
        for number, solid in enumerate(solids)
        for column in fields(solid)
    }


def _unpacked(held: Arrays) -> list[Solid]:
    solids: dict[int, tuple[str, Arrays]] = {}
    for name, array in held.items():
        number, kind, column = name.split()
        solids.setdefault(int(number), (kind, {}))[1][column] = array
    return [
        KINDS[kind](**{name: array if array.ndim else float(array) for name, array in own.items()})
        for kind, own in solids.values()
    ]
