"""Run in a process of its own: change the weather of a city's scene and see what else changes."""

import hashlib
import json
import sys
import time
from pathlib import Path

import bpy  # noqa: TID251
import numpy as np

from cityx.blender.leaf_fall import BARE
from cityx.blender.light import Lighting
from cityx.blender.metering import light_on
from cityx.blender.scene import build_scene
from cityx.city.camera import Camera
from cityx.city.environment import Environment
from cityx.city.store import read_view
from cityx.geometry.raycast import ray_scene
from cityx.light.weather import lit_anew

CHANGES = ("snow dusk", "night", "storm", "clear")


def arrays(mesh):
    """Hash the points, corners and attributes of a mesh."""
    hasher = hashlib.sha256()
    points = np.zeros(3 * len(mesh.vertices), np.float32)
    mesh.vertices.foreach_get("co", points)
    corners = np.zeros(len(mesh.loops), np.int32)
    mesh.loops.foreach_get("vertex_index", corners)
    hasher.update(points.tobytes() + corners.tobytes())
    hasher.update(json.dumps([m.name for m in mesh.materials]).encode())
    for attribute in mesh.attributes:
        hasher.update(f"{attribute.name} {attribute.data_type} {len(attribute.data)}".encode())
    return hasher.hexdigest()


def meshes():
    """Hash every mesh of the city."""
    held = [o for o in bpy.data.objects if o.type == "MESH" and not o.name.startswith("Falling")]
    return {o.name: arrays(o.data) for o in held}


bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
view = read_view(Path(sys.argv[1]))
scene = build_scene(view)
lighting = Lighting(scene, view)
lighting.set(Environment())
camera = Camera("street", (17.0, -8.0, 1.7), 0.05, 0.05)
record = {"before": meshes(), "after": {}, "seconds": {}, "falling": {}, "knobs": {}, "bare": {}}
for change in CHANGES:
    begin = time.process_time()
    light = lit_anew(Environment(), view.frame.latitude, view.frame.longitude, weather=change)
    lighting.set(light)
    lighting.set_for(light, camera)
    record["seconds"][change] = time.process_time() - begin
    record["after"][change] = meshes()
    record["falling"][change] = sum(
        len(o.data.polygons) for o in bpy.data.objects if o.name.startswith("Falling")
    )
    nodes = bpy.data.node_groups["CityX Weather"].nodes
    record["knobs"][change] = [nodes[name].outputs[0].default_value for name in ("Wetness", "Snow")]
    record["bare"][change] = [
        o.modifiers[BARE].show_render for o in bpy.data.objects if BARE in o.modifiers
    ]
# A wall without end beside two places, between them and the sun in the south.
wall = ray_scene(
    [[(-900, -1, 0), (900, -1, 0), (900, -1, 900), (-900, -1, 900)]], [[(0, 1, 2), (0, 2, 3)]],
    [0], np.eye(3, 4)[None],
)  # fmt: skip
noon = Environment(sun_elevation=np.pi / 6, sun_azimuth=np.pi)
record["light"] = {
    "shade": light_on(np.array([[0.0, -0.999, 0.0]]), wall, noon).tolist(),
    "sun": light_on(np.array([[0.0, -1.001, 0.0]]), wall, noon).tolist(),
}
record["worlds"] = len(bpy.data.worlds)
record["moons"] = len([o for o in bpy.data.objects if o.name.startswith("Moon")])
print("@" + json.dumps(record))  # noqa: T201
