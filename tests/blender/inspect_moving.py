"""Describe what moves in a .blend at some frames: one line of JSON after @."""

import json
import sys

import bpy  # noqa: TID251
import numpy as np

bpy.ops.wm.open_mainfile(filepath=sys.argv[1])
scene = bpy.context.scene
record = {
    "range": [scene.frame_start, scene.frame_end],
    "rate": scene.render.fps,
    "current": scene.frame_current,
    "frames": {},
}
for frame in map(int, sys.argv[2:]):
    scene.frame_set(frame)
    graph = bpy.context.evaluated_depsgraph_get()
    held = {}
    for item in bpy.data.objects:
        if item.type != "MESH":
            continue
        made = item.evaluated_get(graph)
        mesh = made.to_mesh()
        points = np.empty(3 * len(mesh.vertices), np.float32)
        mesh.vertices.foreach_get("co", points)
        made.to_mesh_clear()
        matrix = np.array(made.matrix_world)
        points = points.reshape(-1, 3) @ matrix[:3, :3].T + matrix[:3, 3]
        held[item.name] = {
            "low": points.min(axis=0).tolist(),
            "high": points.max(axis=0).tolist(),
            "hidden": item.hide_render,
            "axis": matrix[:3, 2].tolist(),
            "id": item.get("cityx_id", ""),
        }
    record["frames"][frame] = held
print("@" + json.dumps(record))  # noqa: T201
