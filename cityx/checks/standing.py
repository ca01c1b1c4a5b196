"""Check of things: what stands outdoors stands on the ground or on the deck of a bridge."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cityx.checks.check import Check, named
from cityx.city import City
from cityx.city.mesh import MeshBatch
from cityx.geometry.clearance import cells_of_triangles, triangles_at
from cityx.geometry.standing import heights_on, stand_on

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
              f"trees, furniture and vehicles over {OFF_GROUND:g} m above or below the ground",
              ids=named(ids[off]))
    ]  # fmt: skip


def ground_gaps(city: City, positions: FloatArray) -> FloatArray:
    """Return (n,) metres from (n, 3) places to the ground or deck at them, NaN over neither."""
    meshes = city.scene.meshes
    gap: FloatArray = np.abs(positions[:, 2] - stand_on(meshes.get("ground"), positions[:, :2]).z)
    decks = meshes.get("decks")
    if decks is None:
        return gap
    spot, height = surfaces_at(decks, positions[:, :2])
    np.fmin.at(gap, spot, np.abs(positions[spot, 2] - height))
    return gap


def surfaces_at(batch: MeshBatch, xy: FloatArray) -> tuple[NDArray[np.int64], FloatArray]:
    """Return where vertical lines through (n, 2) places meet a mesh: place, height, (h,)."""
    corners = batch.vertices[batch.triangles()[0]]
    u, v = (corners[:, 1] - corners[:, 0])[:, :2], (corners[:, 2] - corners[:, 0])[:, :2]
    corners = corners[np.abs(u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]) > 1e-9]  # upright ones apart
    if not len(corners):
        return np.zeros(0, np.int64), np.zeros(0)
    faces = cells_of_triangles(
        corners[:, :, :2].reshape(-1, 2), np.arange(3 * len(corners), dtype=np.int32).reshape(-1, 3)
    )
    spot, face = (np.concatenate(column) for column in zip(*triangles_at(xy, faces), strict=True))
    return spot, heights_on(corners[face], xy[spot])
