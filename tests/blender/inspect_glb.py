"""Run in a process of its own: import a GLB as a stranger would, print what came, as JSON."""

import json
import sys

import bpy  # noqa: TID251
import numpy as np

bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True, load_ui=False)
bpy.ops.import_scene.gltf(filepath=sys.argv[1])
graph = bpy.context.evaluated_depsgraph_get()


def layer_of(item):
    """Name of the node under the root that an object hangs from."""
    while item.parent is not None and item.parent.name != "city":
        item = item.parent
    return item.name


low, high = np.full(3, np.inf), np.full(3, -np.inf)
counts, corners, layers = {}, {}, {}
for instance in graph.object_instances:  # each one is valid only until the next
    item = instance.object
    if item.type != "MESH" or not len(item.data.vertices):
        continue
    if item.data not in corners:
        points = np.empty(3 * len(item.data.vertices), np.float32)
        item.data.vertices.foreach_get("co", points)
        corners[item.data] = np.c_[points.reshape(-1, 3), np.ones(len(points) // 3)].astype(float)
    placed = corners[item.data] @ np.array(instance.matrix_world).T[:, :3]
    layer = layer_of(instance.parent or item)
    counts[layer] = counts.get(layer, 0) + 1
    first, last = layers.get(layer, (low, high))
    layers[layer] = np.minimum(first, placed.min(axis=0)), np.maximum(last, placed.max(axis=0))
materials = [m for m in bpy.data.materials if m.users]
record = {
    "counts": counts,
    "boxes": {name: [v.tolist() for v in pair] for name, pair in layers.items()},
    "buildings": sorted(
        (o["cityx_id"], len(o.data.materials)) for o in bpy.data.objects
        if o.get("kind") == "building"
    ),
    "materials": sorted(m.name for m in materials),
    "images": sorted(i.name for i in bpy.data.images if i.size[0]),
}  # fmt: skip
print("@" + json.dumps(record))  # noqa: T201
