"""Real lights near a camera: in street lamps, and behind the panes of lit shops."""

from __future__ import annotations

import bpy
import numpy as np
from numpy.typing import NDArray

from cityx.blender.sky import light_collection
from cityx.city.camera import Camera
from cityx.city.environment import Environment
from cityx.city.rooms import lit_rooms, room_uses
from cityx.city.scene import Scene
from cityx.city.store import View

LAMP_WATTS = 110.0  # radiant, as Blender counts; a lamp post then stands in a readable pool
LAMP_COLOR = (1.0, 0.72, 0.42)  # about 3000 K
SHOP_WATTS = 16.0
SHOP_COLOR = (1.0, 0.83, 0.62)  # about 4000 K
MAX_LAMPS, MAX_SHOPS = 60, 24  # more lights cost noise; farther off only the lamp itself is seen
LAMP_REACH, SHOP_REACH = 150.0, 70.0  # metres
GLOW_MATERIAL = "lamp_glow"
LAMP = "lamp"  # in the name of every prototype that lights a street
BEFORE_PANE, PANE_HEIGHT = 0.45, 2.1  # metres


def lamp_positions(held: Scene) -> NDArray[np.float64]:
    """Return (n, 3) middles of everything that glows like a street lamp."""
    found = [np.zeros((0, 3))]
    for rows in held.instances.values():
        for index in np.unique(rows.prototype).tolist():
            mesh = held.prototypes[index].mesh
            if GLOW_MATERIAL not in mesh.materials or LAMP not in held.prototypes[index].name:
                continue
            faces = mesh.faces[mesh.material == mesh.materials.index(GLOW_MATERIAL)]
            if not len(faces):
                continue
            corners = mesh.vertices[np.unique(faces[faces >= 0])]
            lamp = (corners.min(axis=0) + corners.max(axis=0)) / 2
            lamp[2] = corners[:, 2].min() - 0.05  # just under the glass, so it hides no light
            chosen = rows.prototype == index
            offset = lamp * rows.scale[chosen]
            found.append(rows.position[chosen] + _turned(offset, rows.rotation[chosen, 2]))
    return np.concatenate(found)


def shop_positions(view: View, environment: Environment) -> NDArray[np.float64]:
    """Return (n, 3) points before the panes of lit shops."""
    rows = view.scene.instances.get("shopfronts")
    if rows is None or not rows.count:
        return np.zeros((0, 3))
    uses = room_uses(view.scene.prototypes, rows, view.objects)
    lit = np.flatnonzero(lit_rooms(rows, uses, environment, view.seed))
    offset = np.tile([0.0, -BEFORE_PANE, PANE_HEIGHT], (len(lit), 1))
    return np.asarray(rows.position[lit] + _turned(offset, rows.rotation[lit, 2]))


def _turned(offset: NDArray[np.float64], turn: NDArray[np.float32]) -> NDArray[np.float64]:
    """Turn (n, 3) offsets about the vertical by (n,) radians."""
    cos, sin = np.cos(turn.astype(float)), np.sin(turn.astype(float))
    x, y, z = offset.T
    return np.column_stack([x * cos - y * sin, x * sin + y * cos, z])


def place_lamps(
    scene: bpy.types.Scene,
    lamps: NDArray[np.float64],
    shops: NDArray[np.float64],
    camera: Camera,
    *,
    on: bool,
    balance: float = 1.0,
) -> int:
    """Put real lights into the lamps and shops nearest to a camera; returns how many.

    Parameters
    ----------
    scene
        The scene; lights placed for another camera go.
    lamps, shops
        (n, 3) and (m, 3) metres.
    camera
        The camera.
    on
        Whether any are lit.
    balance
        Factor on their power.
    """
    collection = light_collection(scene)
    for item in [o for o in collection.objects if o.name.startswith(("Lamp", "Shop"))]:
        bpy.data.objects.remove(item)
    if not on:
        return 0
    lift = max(camera.position[2], 0.0) * 2
    kinds = (
        ("Lamp", lamps, LAMP_WATTS, LAMP_COLOR, MAX_LAMPS, LAMP_REACH + lift, 0.12),
        ("Shop", shops, SHOP_WATTS, SHOP_COLOR, MAX_SHOPS, SHOP_REACH, 0.6),
    )
    made = 0
    for name, spots, watts, color, most, reach, size in kinds:
        distance = np.linalg.norm(spots - np.array(camera.position), axis=1)
        near = np.argsort(distance, kind="stable")[:most]
        near = near[distance[near] < reach]
        light = bpy.data.lights.get(name) or bpy.data.lights.new(name, "POINT")
        light.energy = watts * balance
        light.color, light.shadow_soft_size = color, size
        for index, spot in enumerate(spots[near]):
            item = bpy.data.objects.new(f"{name}_{index:02d}", light)
            item.location = spot
            item.visible_camera = False
            collection.objects.link(item)
        made += len(near)
    return made
