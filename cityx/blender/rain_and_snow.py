"""Rain and snow in front of a camera: one object per picture, replaced for the next."""

from __future__ import annotations

from math import tan
from typing import Any

import bpy
import numpy as np
from numpy.typing import NDArray

from cityx.blender import nodes
from cityx.blender.sky import (
    daylight,
    haze_color,
    lamp_balance,
    light_collection,
    night_share,
)
from cityx.city.camera import Camera
from cityx.city.environment import Environment
from cityx.geometry.falling import (
    RAIN_REACH,
    SNOW_REACH,
    flakes,
    places,
    streaks,
)

NAME = "Falling"
MOST_DROPS, MOST_FLAKES = 9000, 12_000
DROPS = 800.0  # seen in a rain of 1 mm an hour; their number grows slower than the rate
FLAKES = 3300.0  # seen in a snowfall of 1 mm of water an hour
HIGH = 60.0  # metres above the ground from which a camera looks on the city and sees no drop
DROP_ALPHA, FLAKE_ALPHA = 0.27, 0.75


def make_falling(
    scene: bpy.types.Scene,
    environment: Environment,
    camera: Camera,
    *,
    seed: int,
    height: float,
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
        down, drift = (matrix @ np.array(v) for v in ((0, 0, -1.0), (environment.wind, 0, 0)))
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
