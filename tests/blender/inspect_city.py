"""Run in a process of its own: reopen a .blend file of a city, print what can be found in it."""

import json
import sys

import bpy  # noqa: TID251
import numpy as np

bpy.ops.wm.open_mainfile(filepath=sys.argv[1])


def ids_of(mesh, name="id"):
    """Sorted distinct ids of a mesh's faces or points, None without them."""
    halves = [mesh.attributes.get(f"{name}_{half}") for half in ("low", "high")]
    if None in halves:
        return None
    words = np.zeros((2, len(halves[0].data)), np.int32)
    for half, row in zip(halves, words, strict=True):
        half.data.foreach_get("value", row)
    low, high = words.view(np.uint32).astype(np.uint64)
    found, count = np.unique(high << np.uint64(32) | low, return_counts=True)
    return {f"{key:016x}": number for key, number in zip(found.tolist(), count.tolist())}  # noqa: B905


meshes = [item for item in bpy.data.objects if item.type == "MESH"]
shown = bpy.data.collections["Buildings"].objects
placed = [item for item in meshes if "Instances" in item.modifiers]
record = {
    "collections": sorted(c.name for c in bpy.context.scene.collection.children),
    "buildings": {o["cityx_id"]: [o.name, len(o.data.polygons)] for o in shown if "cityx_id" in o},
    "listed": sorted(text for o in shown for text in o.get("cityx_ids", "").split()),
    "faces": [ids_of(o.data) for o in shown],
    "rows": {o.name: ids_of(o.data) for o in placed},
    "owners": sorted(o.name for o in placed if ids_of(o.data, "owner")),
    "bare": sorted(
        o.name for o in meshes
        if len(o.data.polygons) and (not o.data.materials or None in list(o.data.materials))
    ),
    "missing": sorted(
        i.name for i in bpy.data.images if i.source == "FILE" and not (i.packed_file and i.size[0])
    ),
    "images": len(bpy.data.images),
    "attribution": bpy.context.scene["cityx_attribution"],
}  # fmt: skip
print("@" + json.dumps(record))  # noqa: T201
