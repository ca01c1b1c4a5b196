"""What moves, in a scene that shows one moment after another."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import bpy
import numpy as np

from cityx.assets.vehicles.moving import PEOPLE, TRAFFIC, with_movers
from cityx.blender.materials import MaterialLibrary
from cityx.blender.scene import add_layer, remove_layer

if TYPE_CHECKING:
    from cityx.city.store import View


def show_movers(
    scene: bpy.types.Scene, view: View, moment: float, library: MaterialLibrary
) -> None:
    """Put vehicles and people where they are at a moment, in place of those of another.

    Parameters
    ----------
    scene
        A scene made of the view, or one that shows another moment of it.
    view
        The city, without movers in its scene.
    moment
        Seconds into the tracks.
    library
        Gives the materials.
    """
    held = with_movers(view, moment).scene
    for layer in (TRAFFIC, PEOPLE):
        remove_layer(layer)
        rows = held.instances.get(layer)
        if rows is None or not rows.count:
            continue
        used, local = np.unique(rows.prototype, return_inverse=True)
        shapes = [held.prototypes[index] for index in used.tolist()]
        placed = replace(rows, prototype=local.astype(np.int32))
        add_layer(scene, layer, shapes, placed, view.seed, library)
