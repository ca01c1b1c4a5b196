"""Curve objects of a .blend: ``python -m cityx.blender.curves JOB.json``.

Opens a file without running anything in it and writes the lines that its curve objects draw.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

import bpy
import numpy as np
from numpy.typing import NDArray

from cityx.system.parents import end_with_parent


def curves_of(scene: bpy.types.Scene) -> dict[str, Any]:
    """Return what a scene's objects are, and the lines, metres, and properties of its curves."""
    kinds, lines, properties = {}, {}, {}
    for item in scene.objects:
        kinds[item.name] = item.type.lower()
        if item.type == "CURVE":
            lines[item.name] = lines_of(item, scene.unit_settings.scale_length)
            properties[item.name] = {
                key: value for key, value in item.items()
                if isinstance(value, str | int | float) and not key.startswith("_")
            }  # fmt: skip
    return {"kinds": kinds, "lines": lines, "properties": properties}


def lines_of(item: bpy.types.Object, metres: float) -> list[list[list[float]]]:
    """Return the points of each spline of a curve; a closed one ends where it begins."""
    curve = item.data.copy()
    curve.dimensions = "3D"  # one of two dimensions would be filled
    curve.bevel_depth = curve.extrude = curve.offset = 0.0
    curve.bevel_object = curve.taper_object = None
    plain = bpy.data.objects.new("line", curve)
    mesh = plain.to_mesh()
    place = np.array([vertex.co[:] for vertex in mesh.vertices]).reshape(-1, 3)
    edges = np.array([edge.vertices[:] for edge in mesh.edges], int).reshape(-1, 2)
    plain.to_mesh_clear()
    bpy.data.objects.remove(plain)
    bpy.data.curves.remove(curve)
    world = world_of(item)
    place = (place @ world[:3, :3].T + world[:3, 3]) * metres
    joined = {int(edge.min()) for edge in edges if edge.max() - edge.min() == 1}
    breaks = [number for number in range(1, len(place)) if number - 1 not in joined]
    closed = {(int(edge.min()), int(edge.max())) for edge in edges}
    found = []
    for part in np.split(np.arange(len(place)), breaks):
        if len(part) > 1:
            ring = len(part) > 2 and (int(part[0]), int(part[-1])) in closed
            found.append(place[np.append(part, part[0]) if ring else part].round(4).tolist())
    return found


def world_of(item: bpy.types.Object) -> NDArray[np.float64]:
    """Return where an object is, (4, 4), without evaluating the scene."""
    own = np.array(item.matrix_basis, float)
    if item.parent is None:
        return own
    above = world_of(item.parent) @ np.array(item.matrix_parent_inverse, float)
    return np.asarray(above @ own)


def opened(path: Path) -> str:
    """Open a .blend and run nothing in it; returns why it cannot be read, "" if it can."""
    try:
        bpy.ops.wm.open_mainfile(filepath=str(path), load_ui=False, use_scripts=False)
    except RuntimeError as error:
        return f"Blender cannot read it ({' '.join(str(error).split())})"
    written, own = bpy.data.version, bpy.app.version
    if written[:2] > own[:2]:
        texts = (".".join(map(str, version[:2])) for version in (written, own))
        return "it was saved by Blender {}, of which {} would lose parts".format(*texts)
    return ""


def main(arguments: list[str]) -> int:
    """Run one job."""
    job = json.loads(Path(arguments[0]).read_text())
    end_with_parent(job["parent"])
    fault = opened(Path(job["blend"]))
    result = {"unreadable": fault} if fault else curves_of(bpy.context.scene)
    Path(job["result"]).write_text(json.dumps(result))
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
