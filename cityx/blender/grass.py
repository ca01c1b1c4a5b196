"""Grass near the camera: clumps of blades at render time, nothing of it in the store."""

from __future__ import annotations

from typing import TYPE_CHECKING

import bpy

from cityx.assets.furniture.grass import CLUMPS, grass_clump
from cityx.blender.lawns import grass_rows
from cityx.blender.materials import MaterialLibrary
from cityx.blender.scene import add_layer, remove_layer
from cityx.city.camera import Camera

if TYPE_CHECKING:
    from cityx.city.store import View

LAYER = "grass"
SNOWED = 0.35  # snow from which lawns are covered


def sow(scene: bpy.types.Scene, view: View, camera: Camera, library: MaterialLibrary) -> int:
    """Put grass before a camera in place of what stood before another; returns how many clumps."""
    remove_layer(LAYER)
    if view.lod < 2 or view.environment.snow > SNOWED:
        return 0
    rows = grass_rows(view, camera)
    if rows.count:
        add_layer(scene, LAYER, [grass_clump(name) for name in CLUMPS], rows, view.seed, library)
    return rows.count
