"""Cast rays into Blender's scene of a stored city: ``python inspect_rays.py JOB.json``."""

import json
import sys
from dataclasses import replace
from pathlib import Path

import bpy  # noqa: TID251
import numpy as np

from cityx.assets.vehicles.moving import with_movers
from cityx.blender.leaf_fall import show_twigs
from cityx.blender.light import Lighting
from cityx.blender.scene import build_scene
from cityx.city.store import read_view

job = json.loads(Path(sys.argv[1]).read_text())
view = read_view(Path(job["city"]))
view = replace(view, environment=replace(view.environment, snow=job["snow"]))
view = with_movers(view, job["moment"])
bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
scene = build_scene(view)
Lighting(scene, view).set(view.environment)
show_twigs(bpy.data.objects, shown=False)
graph = bpy.context.evaluated_depsgraph_get()
found = []
for eye, direction in job["rays"]:
    hit, place, *_ = scene.ray_cast(graph, eye, direction)
    found.append(float(np.linalg.norm(np.array(place) - eye)) if hit else None)
sys.stdout.write("@" + json.dumps(found) + "\n")
