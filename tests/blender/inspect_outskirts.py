"""Run in a process of its own: what stands round a site in pictures, and twigs of a bare tree."""

import json
import sys
from math import radians
from pathlib import Path

import bpy  # noqa: TID251
import numpy as np

from cityx.assets.trees.plants import tree
from cityx.blender.leaf_fall import BARE, show_twigs
from cityx.blender.materials import MaterialLibrary
from cityx.blender.scene import LAYER, add_layer, build_scene
from cityx.blender.studio import Outskirts
from cityx.city.camera import Camera
from cityx.city.scene import Instances
from cityx.city.store import read_view

bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
view = read_view(Path(sys.argv[1]))
library = MaterialLibrary(textured=False)
scene = build_scene(view, library=library)
outskirts = Outskirts(scene, view)
eyes = {
    "street": Camera("street", (17.0, -8.0, 1.7), 0.05, 0.05),
    "map": Camera("map", (0.0, 0.0, 60.0), 0.0, radians(-90)),
    "truth": None,
}
record = {"images": len(outskirts.items), "shown": {}, "plain": {}, "xy": {}}


def seen():
    """List places of the buildings that are rendered, originals and images."""
    graph = bpy.context.evaluated_depsgraph_get()
    return sorted(
        tuple(round(v, 2) for v in one.matrix_world.translation[:2])
        for one in graph.object_instances
        if one.object.original.get(LAYER) == "buildings"
    )


for name, eye in eyes.items():
    outskirts.show(eye)
    bpy.context.view_layer.update()
    record["shown"][name] = not any(item.hide_render for item in outskirts.items)
    record["plain"][name] = [round(item.location.z, 3) for item in outskirts.plain]
    record["xy"][name] = seen()

one = np.ones((1, 3), np.float32)
rows = Instances(np.zeros(1, np.int32), np.ones(1, np.uint64), np.zeros(1, np.uint64),
                 np.zeros((1, 3)), 0 * one, one, one)  # fmt: skip
add_layer(scene, "more_trees", [tree("lime", 0, "near")], rows, 0, library)
lime = next(o for o in bpy.data.objects if BARE in o.modifiers)
bpy.context.scene.collection.objects.link(lime)


def faces():
    """Count the faces of the tree by material."""
    bpy.context.view_layer.update()
    mesh = lime.evaluated_get(bpy.context.evaluated_depsgraph_get()).to_mesh()
    used = [mesh.materials[face.material_index].name for face in mesh.polygons]
    return {name.split(".")[0]: used.count(name) for name in sorted(set(used))}


record["tree"] = {"summer": faces()}
lime.modifiers[BARE].show_viewport = True
record["tree"]["twigs"] = faces()
show_twigs([lime], shown=False)
record["tree"]["limbs"] = faces()
sys.stdout.write(json.dumps(record) + "\n")
