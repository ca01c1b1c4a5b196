"""Check of outdoor things: each stands on the ground, a deck or an embankment."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cityx.checks.check import Check, named
from cityx.city import City
from cityx.ground.standing import earth_over, stand_on, surfaces_at

FloatArray = NDArray[np.float64]
# Layers of things whose origin is their foot; those on walls, rails and in water have another.
LAYERS = ("trees", "street_furniture", "street_pieces", "park_pieces", "vehicles")
OFF_GROUND = 0.3  # metres over or under the ground; a kerb between foot and origin is less


def check_standing(city: City) -> list[Check]:
    """Run the check; none where nothing stands or there is no ground to stand on."""
    layers = [rows for name, rows in city.scene.instances.items() if name in LAYERS and rows.count]
    if not layers or "ground" not in city.scene.meshes:
        return []
    gap = ground_gaps(city, np.concatenate([rows.position for rows in layers]))
    off = gap > OFF_GROUND
    ids = np.concatenate([rows.object_id for rows in layers])
    return [
        Check("things_off_ground", float(off.sum()), 0,
              f"trees, furniture and vehicles over {OFF_GROUND:g} m above or below any ground",
              ids=named(ids[off]))
    ]  # fmt: skip


def ground_gaps(city: City, positions: FloatArray) -> FloatArray:
    """Return (n,) metres from (n, 3) places to the ground, deck or earth at them, NaN over none."""
    meshes, (xy, z) = city.scene.meshes, (positions[:, :2], positions[:, 2])
    gap: FloatArray = np.abs(z - stand_on(meshes.get("ground"), xy).z)
    np.fmin(gap, np.abs(z - earth_over(meshes.get("structures"), xy)), out=gap)
    spot, height = surfaces_at(meshes.get("decks"), xy)
    np.fmin.at(gap, spot, np.abs(z[spot] - height))
    return gap
