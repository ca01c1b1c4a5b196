"""Air between the camera and what it sees: haze and fog by Koschmieder's law."""

from __future__ import annotations

from typing import Any

import bpy

from cityx.blender.sky import CONTRAST_LOG, VEILED, haze_color
from cityx.city.environment import Environment

Tree = Any
Socket = Any
LAYERS = "Layers"  # name of the node of the compositor that gives what was rendered
ROOM = 2.0  # metres behind a pane, at most, at which what is seen through it counts


def make_air(
    scene: bpy.types.Scene, environment: Environment, *, reach: float, ground: float, eye: float
) -> None:
    """Dim what is far away: the mist pass, composited.

    A volume would light the fog too, at many times the render time and with noise. Thick air thins
    out with height, and the sky is left to the world, which veils itself. Behind panes the mist
    pass is noise, which shows on dark ones; what is seen through them counts as a room's depth
    behind them.

    Parameters
    ----------
    scene
        The scene.
    environment
        Its visibility and the height of its fog count.
    reach
        Metres to the farthest thing the camera sees.
    ground, eye
        Height of the ground under the camera and of the camera, metres.
    """
    thick = environment.visibility < VEILED[1]
    scene.world.mist_settings.start = 0.0
    scene.world.mist_settings.depth = reach
    scene.world.mist_settings.falloff = "LINEAR"
    layer = scene.view_layers[0]
    layer.use_pass_mist = True
    layer.cycles.denoising_store_passes = True
    layer.use_pass_position = thick
    scene.use_nodes = True
    tree = scene.node_tree
    tree.nodes.clear()
    layers = tree.nodes.new("CompositorNodeRLayers")
    layers.name = LAYERS
    sink = tree.nodes.new("CompositorNodeComposite")
    mist = layers.outputs["Mist"]
    surface = layers.outputs["Denoising Depth"]
    behind = _math(tree, "ADD", surface, ROOM)
    metres = _math(tree, "MAXIMUM", _math(tree, "MULTIPLY", mist, reach), surface)
    metres = _math(tree, "MINIMUM", metres, behind)
    depth: Socket = _math(
        tree, "MULTIPLY", metres, -CONTRAST_LOG / max(environment.visibility, 1.0)
    )
    if thick:
        density = _density(tree, layers.outputs["Position"], environment, ground, eye)
        depth = _math(tree, "MULTIPLY", depth, density)
    hazy = _math(tree, "SUBTRACT", 1.0, _math(tree, "EXPONENT", depth, 0.0))
    sky = _math(tree, "MULTIPLY", _math(tree, "SUBTRACT", mist, 0.97), 1 / 0.03, clamp=True)
    hazy = _math(tree, "MULTIPLY", hazy, _math(tree, "SUBTRACT", 1.0, sky))
    mixed = tree.nodes.new("CompositorNodeMixRGB")
    tree.links.new(hazy, mixed.inputs[0])
    tree.links.new(layers.outputs["Image"], mixed.inputs[1])
    mixed.inputs[2].default_value = (*haze_color(environment), 1.0)
    tree.links.new(mixed.outputs[0], sink.inputs["Image"])
    for index, node in enumerate(tree.nodes):
        node.location = (index * 200.0, 0.0)


def _density(
    tree: Tree, position: Socket, environment: Environment, ground: float, eye: float
) -> Socket:
    """Return the mean density of fog along the ray to each pixel, 1 at the ground.

    Density falls off as exp(-height / fog_height); its mean is taken by Simpson's rule.
    """
    split = tree.nodes.new("CompositorNodeSeparateXYZ")
    tree.links.new(position, split.inputs[0])
    here = max(eye - ground, 0.0)
    there = _math(tree, "MAXIMUM", _math(tree, "SUBTRACT", split.outputs["Z"], ground), 0.0)
    middle = _math(tree, "MULTIPLY", _math(tree, "ADD", there, here), 0.5)

    def thinned(height: Socket) -> Socket:
        scaled = _math(tree, "MULTIPLY", height, -1.0 / environment.fog_height)
        return _math(tree, "EXPONENT", scaled, 0.0)

    ends = _math(tree, "ADD", thinned(there), thinned(_math(tree, "ADD", here, 0.0)))
    total = _math(tree, "ADD", ends, _math(tree, "MULTIPLY", thinned(middle), 4.0))
    return _math(tree, "MULTIPLY", total, 1 / 6)


def _math(tree: Tree, operation: str, a: Socket, b: Socket, *, clamp: bool = False) -> Socket:
    node = tree.nodes.new("CompositorNodeMath")
    node.operation = operation
    node.use_clamp = clamp
    for target, value in zip(node.inputs, (a, b), strict=False):
        if isinstance(value, bpy.types.NodeSocket):
            tree.links.new(value, target)
        else:
            target.default_value = value
    return node.outputs[0]
