"""Run in a process of its own: print what a .blend file holds, as JSON."""

import json
import math
import sys

import bpy  # noqa: TID251

bpy.ops.wm.open_mainfile(filepath=sys.argv[1])
graph = bpy.context.evaluated_depsgraph_get()
layers = {}
for instance in graph.object_instances:  # each one is valid only until the next
    if instance.is_instance:
        layers[instance.parent.name] = layers.get(instance.parent.name, 0) + 1
buildings = {o["cityx_id"]: o for o in bpy.data.collections["Buildings"].objects}
first = next(o for o in buildings.values() if o.get("name"))
mesh = first.data
heights = [(first.matrix_world @ v.co).z for v in mesh.vertices]
post = next(m for m in bpy.data.meshes if any(s.name.startswith("bark") for s in m.materials))
normals = {}
for face in post.polygons:
    for key in face.edge_keys:
        normals.setdefault(key, []).append(face.normal)
creases = {
    (pair[0].angle(pair[1]) > math.radians(32), edge.use_edge_sharp)
    for edge in post.edges
    if len(pair := normals.get(edge.key, ())) == 2
}
record = {
    "round": all(face.use_smooth for face in post.polygons),
    "creases": sorted(creases),
    "instances": layers,
    "ids": sorted(buildings),
    "names": sorted(o.name for o in buildings.values()),
    "properties": {k: first[k] for k in ("cityx_id", "kind", "name", "source", "use")},
    "attributes": sorted(mesh.attributes.keys()),
    "flat": all(f.use_smooth is False for f in mesh.polygons),
    "materials": [m.name for m in mesh.materials],
    "valid": not any(m.validate() for m in bpy.data.meshes),
    "collections": sorted(c.name for c in bpy.context.scene.collection.children),
    "height": max(heights) - min(heights),
    "packed": all(i.packed_file for i in bpy.data.images if i.source == "FILE"),
    "cameras": [o.name for o in bpy.data.collections["Cameras"].objects],
}
print("@" + json.dumps(record))  # noqa: T201
