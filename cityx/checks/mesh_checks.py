"""Checks of every mesh and instance: finite numbers, known prototypes, triangle counts."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from cityx.checks.check import Check
from cityx.city import City


def check_meshes(city: City) -> list[Check]:
    """Count values that are not finite in meshes and instances."""
    arrays: list[NDArray[np.floating[Any]]] = [
        batch.vertices for batch in city.scene.meshes.values()
    ]
    arrays += [prototype.mesh.vertices for prototype in city.scene.prototypes]
    for rows in city.scene.instances.values():
        arrays += [rows.position, rows.rotation, rows.scale]
    bad = sum(int(np.count_nonzero(~np.isfinite(values))) for values in arrays)
    return [Check("not_finite", bad, 0, "coordinates that are NaN or infinite")]


def triangle_counts(city: City) -> dict[str, int]:
    """Return ``unique`` (stored) and ``instanced`` (as seen, every instance counted) triangles."""
    shells = sum(batch.triangle_count for batch in city.scene.meshes.values())
    sizes = np.array([p.mesh.triangle_count for p in city.scene.prototypes] or [0], np.int64)
    placed = sum(int(sizes[rows.prototype].sum()) for rows in city.scene.instances.values())
    return {"unique": int(shells + sizes.sum()), "instanced": int(shells + placed)}
