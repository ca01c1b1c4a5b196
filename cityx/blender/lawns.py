"""Lawns at eye level: which clumps of grass a camera sees.

Clumps stand on a fixed grid moved by a hash of the cell, so a place has the same blades in every
picture; how many of them are shown falls with the distance.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import bpy
import numpy as np
from numpy.typing import NDArray

from cityx.assets.furniture.grass import CLUMPS, grass_clump
from cityx.blender.materials import MaterialLibrary
from cityx.blender.scene import add_layer, remove_layer
from cityx.city.camera import Camera
from cityx.city.ground import LABEL
from cityx.city.scene import Instances
from cityx.geometry.arrays import FloatArray
from cityx.geometry.scatter import cell_ids
from cityx.ground.standing import stand_on
from cityx.ids import choose, hash_ids, uniform

if TYPE_CHECKING:
    from cityx.city.store import View


CELL = 0.17  # metres; one clump each where grass is densest
REACH = 55.0  # metres from the camera
DENSE = 6.0  # metres within which every cell has its clump
FALL = 1.7  # power by which density falls with distance
FADE = 15.0  # metres over which the last clumps thin out
HIGHEST = 30.0  # metres of the camera above the ground; from higher, blades are not seen
MARGIN = 0.12  # radians beyond the picture's sides, against blades that reach in
# Share of cells, and the weights of `CLUMPS`, by label of the ground.
KINDS = {
    "grass": (1.0, (5, 5, 1.0, 0, 0)), "park": (1.0, (5, 5, 0.8, 0, 0)),
    "block": (0.9, (5, 5, 0.5, 0.15, 0.15)), "meadow": (0.8, (1, 1, 1, 4, 4)),
    "pitch": (0.9, (5, 5, 0, 0, 0)), "wood": (0.10, (1, 1, 0, 2, 2)),
}  # fmt: skip
LAYER = "grass"
SNOWED = 0.35  # snow from which lawns are covered


def grass_rows(view: View, camera: Camera) -> Instances:
    """Draw the clumps that a camera sees, (n,) rows over `CLUMPS`."""
    ground = view.scene.meshes.get("ground")
    xy, ids, away = _candidates(view, camera)
    under = stand_on(ground, xy)
    shown = np.zeros(len(ids), bool)
    kind = np.zeros(len(ids), np.int64)
    chance = uniform(view.seed, "grass/share", ids)
    for name, (share, weights) in KINDS.items():
        here = under.label == LABEL[name]
        shown |= here & (chance < share)
        kind = np.where(here, choose(view.seed, f"grass/{name}", ids, weights), kind)
    z = np.nan_to_num(under.z, nan=-1e9)
    shown &= (camera.position[2] - z < HIGHEST) & (camera.position[2] > z)
    xy, ids, away, kind, z = xy[shown], ids[shown], away[shown], kind[shown], z[shown]
    count = len(ids)
    rotation = np.zeros((count, 3), np.float32)
    rotation[:, 2] = 2 * np.pi * uniform(view.seed, "grass/turn", ids)
    # Fewer clumps far away are larger, so that the lawn does not seem to end.
    size = 0.75 + 0.5 * uniform(view.seed, "grass/size", ids) + 0.5 * away / REACH
    mown = under.label[shown] == LABEL["pitch"]
    scale = np.repeat(size[:, None], 3, axis=1)
    scale[:, 2] *= np.where(mown, 0.55, 1.0)
    shade = 0.85 + 0.15 * uniform(view.seed, "grass/shade", ids)
    return Instances(
        kind.astype(np.int32), ids, np.zeros(count, np.uint64), np.column_stack([xy, z]), rotation,
        scale.astype(np.float32), np.repeat(shade[:, None], 3, axis=1).astype(np.float32),
    )  # fmt: skip


def _candidates(view: View, camera: Camera) -> tuple[FloatArray, NDArray[np.uint64], FloatArray]:
    """Cells before the camera, thinned by distance: places, ids and metres away."""
    eye = np.array(camera.position[:2])
    low, high = (np.floor((eye + s * REACH) / CELL).astype(np.int64) for s in (-1, 1))
    i, j = np.meshgrid(np.arange(low[0], high[0] + 1), np.arange(low[1], high[1] + 1),
                       indexing="ij")  # fmt: skip
    cells = np.column_stack([i.ravel(), j.ravel()])
    step = (cells + 0.5) * CELL - eye
    flat = np.hypot(*step.T)
    ahead = np.array([np.sin(camera.heading), np.cos(camera.heading)])
    side = np.abs(np.arctan2(step[:, 0] * ahead[1] - step[:, 1] * ahead[0], step @ ahead))
    # A camera that looks down sees beside and behind itself.
    half = camera.hfov / 2 + MARGIN
    seen = (side < half) | (flat < 1.5) if camera.pitch > -0.6 else np.ones(len(step), bool)
    seen &= flat < REACH
    cells, flat = cells[seen], flat[seen]
    ids = cell_ids(cells)
    rise = max(camera.position[2] - float(view.terrain.height_at(eye[None])[0]), 0.0)
    away = np.hypot(flat, max(rise - 1.8, 0.0))
    share = np.minimum(1.0, (DENSE / np.maximum(away, 0.1)) ** FALL)
    share = share * np.clip((REACH - away) / FADE, 0.0, 1.0)
    keep = uniform(view.seed, "grass/keep", ids) < share
    cells, ids, away = cells[keep], ids[keep], away[keep]
    own = hash_ids(view.seed, "grass/place", ids)
    offset = np.column_stack(
        [uniform(view.seed, "grass/x", own), uniform(view.seed, "grass/y", own)]
    )
    return (cells + offset) * CELL, own, away


def sow(scene: bpy.types.Scene, view: View, camera: Camera, library: MaterialLibrary) -> int:
    """Put grass before a camera in place of what stood before another; returns how many clumps."""
    remove_layer(LAYER)
    if view.lod < 2 or view.environment.snow > SNOWED:
        return 0
    rows = grass_rows(view, camera)
    if rows.count:
        add_layer(scene, LAYER, [grass_clump(name) for name in CLUMPS], rows, view.seed, library)
    return rows.count
