"""Run in a process of its own: what Cycles itself says of the depth, place and id of each pixel.

``python inspect_alignment.py STORE CAMERA.json OUT.exr [MOMENT]`` renders one sample through the
middle of each pixel, with a material that writes the ids of faces, instances and objects. A second
file, ``OUT_matte.exr``, has Blender's own cryptomatte of many samples.
"""

import json
import sys
from pathlib import Path

import bpy  # noqa: TID251

from cityx.blender import nodes, render
from cityx.blender.lawns import LAYER
from cityx.blender.light import Lighting
from cityx.blender.materials import MaterialLibrary
from cityx.blender.scene import ID, build_scene, remove_layer
from cityx.blender.studio import Studio
from cityx.city.camera import Camera
from cityx.city.store import read_view

MATTE_SAMPLES = 256


def ids_material():
    """Make a material that writes the lower halves of ids into passes."""
    material = bpy.data.materials.new("ids")
    material.use_nodes = True
    tree = material.node_tree
    values = {
        "face": nodes.attribute(tree, "id_low").outputs["Fac"],
        "instance": nodes.attribute(tree, "id_low", instance=True).outputs["Fac"],
        "owner": nodes.attribute(tree, "owner_low", instance=True).outputs["Fac"],
        "object": tree.nodes.new("ShaderNodeObjectInfo").outputs["Object Index"],
    }
    for name, value in values.items():
        made = bpy.context.view_layer.aovs.add()
        made.name, made.type = name, "VALUE"
        sink = tree.nodes.new("ShaderNodeOutputAOV")
        sink.aov_name = name
        tree.links.new(value, sink.inputs["Value"])
    return material


def main(store, camera, out, moment=0.0):
    """Render both files."""
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    view = read_view(store)
    library = MaterialLibrary()
    scene = build_scene(view, library=library)
    names = {}
    for number, item in enumerate([o for o in bpy.data.objects if ID in o], start=1):
        item.pass_index = number
        names[number] = item[ID]
    studio = Studio(scene, view, Lighting(scene, view), library, staged=True)
    item = render.add_camera(scene, camera)
    render.set_up(scene, samples=1, gpu=False)
    studio.show(view.environment, camera, moment, truth=True)
    remove_layer(LAYER)  # blades of grass are in no truth
    render.aim(scene, item)
    scene.use_nodes = False
    scene.render.use_file_extension = False
    scene.cycles.use_denoising = scene.cycles.use_adaptive_sampling = False
    scene.render.image_settings.file_format = "OPEN_EXR_MULTILAYER"
    scene.render.image_settings.color_depth = "32"
    layer = scene.view_layers[0]
    layer.use_pass_cryptomatte_object = True
    scene.cycles.samples = MATTE_SAMPLES
    scene.cycles.max_bounces = 0
    scene.render.filepath = str(out.with_name(f"{out.stem}_matte.exr"))
    bpy.ops.render.render(write_still=True)
    scene.cycles.samples = 1
    scene.cycles.filter_width = 0.01
    layer.use_pass_cryptomatte_object = False
    layer.use_pass_z = layer.use_pass_position = layer.use_pass_normal = True
    layer.material_override = ids_material()
    scene.render.filepath = str(out)
    bpy.ops.render.render(write_still=True)
    out.with_suffix(".json").write_text(json.dumps(names))


if __name__ == "__main__":
    given = json.loads(Path(sys.argv[2]).read_text())
    eye = Camera(**{**given, "position": tuple(given["position"])})
    main(Path(sys.argv[1]), eye, Path(sys.argv[3]), *map(float, sys.argv[4:]))
