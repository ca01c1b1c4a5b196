"""Render passes: what Cycles writes besides the colour of a picture, to be read as numbers.

A picture with passes is two files: the PNG as people see it, and a multilayer EXR of float32 with
all else, written first and under a temporary name.
"""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Any

import bpy

from cityx.blender.air import LAYERS
from cityx.blender.operators import call
from cityx.blender.render import aim
from cityx.blender.sheets import NOISY, PASSES

AO_REACH = 1000.0  # metres: whatever stands above a face takes its share of the sky


_SWITCHES = frozenset(name for each in PASSES.values() for name in each.switches)


def use_passes(scene: bpy.types.Scene, names: Iterable[str], *, denoise: bool) -> None:
    """Switch on the passes that are wanted, and choose the colour that the air is laid over.

    Parameters
    ----------
    scene
        The scene, with its light and air.
    names
        Keys of `PASSES`.
    denoise
        Whether the colour is the denoiser's; if not, the denoiser only tells the noise.
    """
    layer = scene.view_layers[0]
    layer.name = "ViewLayer"
    wanted = {switch for name in names for switch in PASSES[name].switches}
    for switch in _SWITCHES:
        setattr(layer, switch, switch in wanted)
    cycles: Any = layer.cycles
    cycles.denoising_store_passes = cycles.pass_debug_sample_count = True
    scene.world.light_settings.distance = AO_REACH
    if not denoise:
        tree = scene.node_tree
        source = tree.nodes[LAYERS]
        for link in [link for link in tree.links if link.from_socket.name == "Image"]:
            if link.from_node == source:
                tree.links.new(source.outputs[NOISY], link.to_socket)


def render_passes(scene: bpy.types.Scene, camera: bpy.types.Object, path: Path) -> dict[str, Any]:
    """Render a picture into a PNG and, beside it, an EXR with its passes.

    Parameters
    ----------
    scene
        After `use_passes`.
    camera
        What sees it.
    path
        Of the PNG, which appears last.

    Returns
    -------
    facts
        "exposure", the stops between the linear colour and the PNG, and the "view_transform".
    """
    aim(scene, camera)
    settings = scene.render.image_settings
    kept = settings.file_format, settings.color_mode, settings.color_depth
    sheets = path.with_suffix(".exr")
    halves = [each.with_name(f".{each.stem}.partial{each.suffix}") for each in (sheets, path)]
    path.parent.mkdir(parents=True, exist_ok=True)
    scene.render.use_file_extension = False
    scene.render.filepath = str(halves[0])
    settings.file_format, settings.color_depth = "OPEN_EXR_MULTILAYER", "32"
    settings.exr_codec = "ZIP"
    try:
        call("render.render", write_still=True)
    finally:
        settings.file_format, settings.color_mode, settings.color_depth = kept
    bpy.data.images["Render Result"].save_render(str(halves[1]), scene=scene)
    for half, whole in zip(halves, (sheets, path), strict=True):
        half.replace(whole)
    return {
        "exposure": round(float(scene.view_settings.exposure), 6),
        "view_transform": scene.view_settings.view_transform,
    }
