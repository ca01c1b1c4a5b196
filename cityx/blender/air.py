"""What is between a camera and what it sees: haze and fog by Koschmieder's law, rain, snow."""

from __future__ import annotations

from math import tan
from typing import Any

import bpy
import numpy as np
from numpy.typing import NDArray

from cityx.blender import nodes
from cityx.blender.sky import (
    CONTRAST_LOG,
    VEILED,
    daylight,
    haze_color,
    lamp_balance,
    light_collection,
    night_share,
)
from cityx.city.camera import Camera
from cityx.city.environment import Environment
from cityx.geometry.falling import RAIN_REACH, SNOW_REACH, flakes, places, streaks

Tree = Any
Socket = Any
LAYERS = "Layers"  # name of the node of the compositor that gives what was rendered
ROOM = 2.0  # metres behind a pane, at most, at which what is seen through it counts
NAME = "Falling"
MOST_DROPS, MOST_FLAKES = 9000, 12_000
DROPS = 800.0  # seen in a rain of 1 mm an hour; their number grows slower than the rate
FLAKES = 3300.0  # seen in a snowfall of 1 mm of water an hour
HIGH = 60.0  # metres above the ground from which a camera looks on the city and sees no drop
DROP_ALPHA, FLAKE_ALPHA = 0.27, 0.75


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


def make_falling(
    scene: bpy.types.Scene, environment: Environment, camera: Camera, *, seed: int, height: float
) -> int:
    """Put drops and flakes before a camera; those of another camera go. Returns their number.

    Parameters
    ----------
    scene
        The scene.
    environment
        Its rain, snowfall and wind count.
    camera
        Before which they fall.
    seed
        Key of their places.
    height
        Of the camera above the ground, metres; from high above none are seen.
    """
    for item in [o for o in light_collection(scene).objects if o.name.startswith(NAME)]:
        mesh = item.data
        bpy.data.objects.remove(item)
        bpy.data.meshes.remove(mesh)
    if height > HIGH:
        return 0
    half = (tan(camera.hfov / 2), tan(camera.hfov / 2) * camera.height / camera.width)
    matrix = _frame(camera)
    made = 0
    pixel = camera.hfov / camera.width
    rain = min(int(DROPS * environment.rain**0.75), MOST_DROPS) if environment.rain > 0 else 0
    snow = min(int(FLAKES * environment.snowfall**0.75), MOST_FLAKES) if environment.snowfall else 0
    if rain:
        at, draws = places(rain, RAIN_REACH, half, seed, "rain")
        turn = environment.wind_from
        blows = -environment.wind * np.array([np.sin(turn), np.cos(turn), 0.0])
        down, drift = (matrix @ np.array(v) for v in ((0, 0, -1.0), blows))
        made += _link(
            scene, "rain", *streaks(at, draws, down, drift, pixel), matrix, camera, environment
        )
    if snow:
        at, draws = places(snow, SNOW_REACH, half, seed, "snow")
        made += _link(scene, "snow", *flakes(at, draws, pixel), matrix, camera, environment)
    return made


def _frame(camera: Camera) -> NDArray[np.float64]:
    """Rows are the camera's right, up and ahead in the scene, (3, 3)."""
    heading, pitch = camera.heading, camera.pitch
    level = np.array([np.sin(heading), np.cos(heading), 0.0])
    zenith = np.array([0.0, 0.0, 1.0])
    ahead = level * np.cos(pitch) + zenith * np.sin(pitch)
    up = zenith * np.cos(pitch) - level * np.sin(pitch)
    return np.stack([np.cross(ahead, up), up, ahead])


def _link(
    scene: bpy.types.Scene, kind: str, vertices: Any, faces: Any, matrix: Any, camera: Camera,
    environment: Environment,
) -> int:  # fmt: skip
    mesh = bpy.data.meshes.new(f"{NAME} {kind}")
    sides = faces.shape[1]
    mesh.vertices.add(len(vertices))
    mesh.attributes["position"].data.foreach_set(
        "vector", (vertices @ matrix).astype(np.float32).ravel()
    )
    mesh.loops.add(faces.size)
    mesh.attributes[".corner_vert"].data.foreach_set("value", faces.astype(np.int32).ravel())
    mesh.polygons.add(len(faces))
    mesh.polygons.foreach_set("loop_start", np.arange(0, faces.size, sides, dtype=np.int32))
    mesh.update(calc_edges=True)
    mesh.materials.append(_material(kind, environment))
    item = bpy.data.objects.new(f"{NAME} {kind}", mesh)
    item.location = camera.position
    # Only the camera sees them: their shadows and mirror images would cost and not be noticed.
    for ray in ("diffuse", "glossy", "transmission", "volume_scatter", "shadow"):
        setattr(item, f"visible_{ray}", False)
    light_collection(scene).objects.link(item)
    return len(faces)


def _material(kind: str, environment: Environment) -> bpy.types.Material:
    """Make a veil of the light around: drops bend the sky into the eye, flakes scatter it."""
    name = f"{NAME} {kind}"
    material = bpy.data.materials.get(name) or bpy.data.materials.new(name)
    material.use_nodes = True
    tree = material.node_tree
    tree.nodes.clear()
    light = tree.nodes.new("ShaderNodeEmission")
    through = tree.nodes.new("ShaderNodeBsdfTransparent")
    both = tree.nodes.new("ShaderNodeMixShader")
    sink = tree.nodes.new("ShaderNodeOutputMaterial")
    day = daylight(environment) * (0.85 if kind == "snow" else 0.7)
    night = night_share(environment.sun_elevation)
    lamps = np.array([0.030, 0.024, 0.018]) * environment.lamps * night
    lamps *= lamp_balance(environment)
    color = np.array([0.96, 0.98, 1.02]) * day + lamps + np.array(haze_color(environment)) * 0.3
    nodes.assign(tree, light.inputs["Color"], tuple(color.tolist()))
    alpha = DROP_ALPHA if kind == "rain" else FLAKE_ALPHA
    both.inputs[0].default_value = alpha
    tree.links.new(through.outputs[0], both.inputs[1])
    tree.links.new(light.outputs[0], both.inputs[2])
    tree.links.new(both.outputs[0], sink.inputs["Surface"])
    material.cycles.emission_sampling = "NONE"
    return material
