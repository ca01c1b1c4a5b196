"""Sun, sky, air and lamps of a Blender scene, from an `Environment`."""

from __future__ import annotations

from collections.abc import Sequence
from math import exp
from typing import Any

import bpy
import numpy as np
from numpy.typing import NDArray

from cityx.city.camera import Camera
from cityx.city.environment import Environment
from cityx.city.scene import Scene

# Radiance of a white level plane under Blender's physical clear sky of strength 1, by elevation of
# the sun in degrees: with the sun, and from the sky alone. Rendered with bpy 4.5.
_ELEVATION = (-12.0, -6.0, -3.0, -1.0, 0.0, 2.0, 5.0, 10.0, 20.0, 40.0, 60.0, 80.0)
_CLEAR = (1e-7, 0.0016, 0.052, 0.21, 0.35, 0.86, 2.3, 5.6, 13.1, 27.0, 37.5, 43.0)
OVERCAST_SHARE = 0.22  # a closed cloud layer lets through about a fifth of sun and sky
GROUND_ALBEDO = (0.13, 0.125, 0.105)  # of the land beyond the site
CONTRAST_LOG = 3.912  # -ln 0.02: visibility is where contrast falls to 2 %
# The light of a night is balanced for a camera opened by about three stops.
NIGHT_SKY = (0.0012, 0.0018, 0.0035)  # a city's night sky as pictures show it, brighter than real
MOON_IRRADIANCE = 0.015
LAMP_WATTS = 90.0  # radiant, as Blender counts; a lamp post then stands in a readable pool
LAMP_COLOR = (1.0, 0.72, 0.42)  # about 3000 K
MAX_LAMPS = 60  # more lights cost noise, and beyond 150 m only the lamp itself is seen
LAMP_REACH = 150.0  # metres
GLOW_MATERIAL = "lamp_glow"
CLOUD_BASE = 1.2  # flattens the dome so that clouds shrink towards the horizon

Tree = Any
Socket = Any


def clear_radiance(elevation: float) -> float:
    """Return the radiance of a white level plane under a clear sky of strength 1 (radians in)."""
    return exp(float(np.interp(np.degrees(elevation), _ELEVATION, np.log(_CLEAR))))


def night_share(elevation: float) -> float:
    """Return 0 by day, 1 at night, smooth from sunset to the end of civil dusk (8 degrees)."""
    t = min(max((2.0 - float(np.degrees(elevation))) / 10.0, 0.0), 1.0)
    return t * t * (3 - 2 * t)


def make_world(scene: bpy.types.Scene, environment: Environment) -> bpy.types.World:
    """Make sky and sun; the sun stands where the environment says, azimuth from north."""
    world = bpy.data.worlds.new("Sky")
    scene.world = world
    world.use_nodes = True
    tree = world.node_tree
    background = tree.nodes["Background"]
    background.inputs["Strength"].default_value = 1.0
    direction = tree.nodes.new("ShaderNodeTexCoord").outputs["Generated"]
    split = tree.nodes.new("ShaderNodeSeparateXYZ")
    tree.links.new(direction, split.inputs[0])
    up = split.outputs["Z"]

    day = _scaled(tree, _sky(tree, environment), environment.sky_strength)
    cover = environment.cloud_cover
    if cover > 0:
        share: Socket = 1.0 if cover >= 0.95 else _clouds(tree, direction, up, cover)
        day = _mixed(tree, share, day, _overcast(tree, up, environment))
    night = night_share(environment.sun_elevation)
    if night > 0:
        day = _sum(tree, day, tuple(channel * night for channel in NIGHT_SKY))
    below = _step(tree, up, 0.0, -0.02)
    tree.links.new(_mixed(tree, below, day, _land(environment)), background.inputs["Color"])
    if night > 0.5:
        _moon(scene, environment, night)
    return world


def _sky(tree: Tree, environment: Environment) -> Socket:
    sky = tree.nodes.new("ShaderNodeTexSky")
    kinds = sky.bl_rna.properties["sky_type"].enum_items.keys()
    # Blender 5 renamed the model, with the better multiple scattering beside it.
    sky.sky_type = "NISHITA" if "NISHITA" in kinds else "MULTIPLE_SCATTERING"
    sky.sun_elevation = environment.sun_elevation
    sky.sun_rotation = environment.sun_azimuth  # measured from +y, clockwise: compass
    veil = environment.cloud_cover
    sky.sun_disc = True
    sky.sun_intensity = (1.0 - veil) ** 2 if veil < 0.95 else 0.0
    sky.sun_size = np.radians(0.545 + 4.0 * veil)  # thin cloud blurs the disc
    # Haze: the share of particles for which contrast falls to 2 % at the visibility.
    haze = min(10.0, max(1.0, 20_000.0 / max(environment.visibility, 1.0)))
    name = "dust_density" if hasattr(sky, "dust_density") else "aerosol_density"
    setattr(sky, name, haze)
    return sky.outputs["Color"]


def _overcast(tree: Tree, up: Socket, environment: Environment) -> Socket:
    """Return the CIE overcast sky: three times brighter at the zenith than at the horizon."""
    level = clear_radiance(environment.sun_elevation) * OVERCAST_SHARE * 9 / 7
    level *= environment.sky_strength
    rise = tree.nodes.new("ShaderNodeMapRange")
    tree.links.new(up, rise.inputs["Value"])
    rise.inputs["To Min"].default_value = level / 3
    rise.inputs["To Max"].default_value = level
    return _mixed(tree, 1.0, rise.outputs["Result"], (0.95, 0.98, 1.05), blend="MULTIPLY")


def _clouds(tree: Tree, direction: Socket, up: Socket, cover: float) -> Socket:
    """Return the share of cloud towards each direction: noise on a plane seen from below."""
    lifted = _math(tree, "ADD", _math(tree, "MAXIMUM", up, 0.0), CLOUD_BASE / 10)
    inverse = _math(tree, "DIVIDE", 1.0, lifted)
    plane = tree.nodes.new("ShaderNodeVectorMath")
    plane.operation = "SCALE"
    tree.links.new(direction, plane.inputs[0])
    tree.links.new(inverse, plane.inputs["Scale"])
    noise = tree.nodes.new("ShaderNodeTexNoise")
    noise.inputs["Scale"].default_value = 0.8
    noise.inputs["Detail"].default_value = 6.0
    noise.inputs["Roughness"].default_value = 0.55
    tree.links.new(plane.outputs[0], noise.inputs["Vector"])
    # The noise is nearly normal about 0.5; its quantile at `cover` is the threshold.
    edge = 0.5 - 0.22 * (2 * cover - 1)
    return _step(tree, noise.outputs["Fac"], edge - 0.06, edge + 0.1)


def _land(environment: Environment) -> tuple[float, float, float]:
    """Radiance of the land beyond the site, seen below the horizon."""
    cover = environment.cloud_cover
    level = clear_radiance(environment.sun_elevation) * environment.sky_strength
    level *= (1 - cover) + cover * OVERCAST_SHARE
    night = night_share(environment.sun_elevation)
    red, green, blue = (
        a * (level + n * night * 2) for a, n in zip(GROUND_ALBEDO, NIGHT_SKY, strict=True)
    )
    return red, green, blue


def _moon(scene: bpy.types.Scene, environment: Environment, night: float) -> None:
    """Put a weak blue light high up, opposite the sun."""
    light = bpy.data.lights.new("Moon", "SUN")
    light.energy = MOON_IRRADIANCE * night * (1 - 0.9 * environment.cloud_cover)
    light.color = (0.62, 0.76, 1.0)
    light.angle = np.radians(0.53)
    item = bpy.data.objects.new("Moon", light)
    item.rotation_euler = (np.radians(42.0), 0.0, -environment.sun_azimuth)
    light_collection(scene).objects.link(item)


def light_collection(scene: bpy.types.Scene) -> bpy.types.Collection:
    """Return the collection "Light", made when it is missing."""
    found = scene.collection.children.get("Light")
    if found is None:
        found = bpy.data.collections.new("Light")
        scene.collection.children.link(found)
    return found


# --- nodes ----------------------------------------------------------------------------------------


def _math(tree: Tree, operation: str, *values: Socket) -> Socket:
    node = tree.nodes.new("ShaderNodeMath")
    node.operation = operation
    for target, value in zip(node.inputs, values, strict=False):
        _set(tree, target, value)
    return node.outputs[0]


def _set(tree: Tree, target: Socket, value: Socket) -> None:
    if isinstance(value, bpy.types.NodeSocket):
        tree.links.new(value, target)
    else:
        target.default_value = (*value, 1.0) if isinstance(value, tuple) else value


def _mixed(tree: Tree, share: Socket, a: Socket, b: Socket, *, blend: str = "MIX") -> Socket:
    node = tree.nodes.new("ShaderNodeMix")
    node.data_type = "RGBA"
    node.blend_type = blend
    first, second = (s for s in node.inputs if s.type == "RGBA")
    _set(tree, node.inputs[0], share)
    _set(tree, first, a)
    _set(tree, second, b)
    return next(s for s in node.outputs if s.type == "RGBA")


def _sum(tree: Tree, a: Socket, b: Socket) -> Socket:
    return _mixed(tree, 1.0, a, b, blend="ADD")


def _scaled(tree: Tree, color: Socket, factor: float) -> Socket:
    return _mixed(tree, 1.0, color, (factor, factor, factor), blend="MULTIPLY")


def _step(tree: Tree, value: Socket, low: float, high: float) -> Socket:
    node = tree.nodes.new("ShaderNodeMapRange")
    node.interpolation_type = "SMOOTHSTEP"
    node.inputs["From Min"].default_value = low
    node.inputs["From Max"].default_value = high
    _set(tree, node.inputs["Value"], value)
    return node.outputs["Result"]


# --- air ------------------------------------------------------------------------------------------


def haze_color(environment: Environment) -> tuple[float, float, float]:
    """Return the radiance of air far away: that of the sky just above the horizon."""
    cover = environment.cloud_cover
    level = clear_radiance(environment.sun_elevation) * environment.sky_strength
    night = night_share(environment.sun_elevation)
    clear = np.array([0.145, 0.17, 0.215]) * level
    # Fog scatters light of sun and sky evenly.
    grey = np.array([0.30, 0.31, 0.32]) * level * (1 if cover < 0.95 else OVERCAST_SHARE * 2)
    thick = min(1.0, 3000.0 / max(environment.visibility, 1.0))
    mix = max(cover, thick)
    lamps = np.array([0.02, 0.014, 0.008]) * (environment.night_lights > 0) * night
    red, green, blue = (
        (1 - mix) * clear + mix * grey + np.array(NIGHT_SKY) * night + lamps * thick
    ).tolist()
    return red, green, blue


def make_air(scene: bpy.types.Scene, environment: Environment, reach: float) -> None:
    """Dim what is far away: the mist pass, composited by Koschmieder's law.

    A volume would light the fog too, at many times the render time and with noise.

    Parameters
    ----------
    scene
        The scene.
    environment
        Its visibility counts.
    reach
        Metres to the farthest thing a camera sees.
    """
    scene.world.mist_settings.start = 0.0
    scene.world.mist_settings.depth = reach
    scene.world.mist_settings.falloff = "LINEAR"
    scene.view_layers[0].use_pass_mist = True
    scene.use_nodes = True
    tree = scene.node_tree
    tree.nodes.clear()
    layers = tree.nodes.new("CompositorNodeRLayers")
    sink = tree.nodes.new("CompositorNodeComposite")

    def math(operation: str, a: Socket, b: float) -> Socket:
        node = tree.nodes.new("CompositorNodeMath")
        node.operation = operation
        if isinstance(a, bpy.types.NodeSocket):
            tree.links.new(a, node.inputs[0])
            node.inputs[1].default_value = b
        else:
            node.inputs[0].default_value = a
            tree.links.new(b, node.inputs[1])
        return node.outputs[0]

    depth = -CONTRAST_LOG * reach / max(environment.visibility, 1.0)
    clear = math("EXPONENT", math("MULTIPLY", layers.outputs["Mist"], depth), 0.0)
    hazy = math("SUBTRACT", 1.0, clear)
    mix = tree.nodes.new("CompositorNodeMixRGB")
    tree.links.new(hazy, mix.inputs[0])
    tree.links.new(layers.outputs["Image"], mix.inputs[1])
    mix.inputs[2].default_value = (*haze_color(environment), 1.0)
    tree.links.new(mix.outputs[0], sink.inputs["Image"])
    for index, node in enumerate(tree.nodes):
        node.location = (index * 200.0, 0.0)


# --- lamps ----------------------------------------------------------------------------------------


def lamp_positions(held: Scene) -> NDArray[np.float64]:
    """Return (n, 3) middles of everything that glows like a street lamp."""
    found = [np.zeros((0, 3))]
    for rows in held.instances.values():
        for index in np.unique(rows.prototype).tolist():
            mesh = held.prototypes[index].mesh
            if GLOW_MATERIAL not in mesh.materials:
                continue
            faces = mesh.faces[mesh.material == mesh.materials.index(GLOW_MATERIAL)]
            if not len(faces):
                continue
            corners = mesh.vertices[np.unique(faces[faces >= 0])]
            lamp = (corners.min(axis=0) + corners.max(axis=0)) / 2
            lamp[2] = corners[:, 2].min() - 0.05  # just under the glass, so it hides no light
            chosen = rows.prototype == index
            offset = lamp * rows.scale[chosen]
            turn = rows.rotation[chosen, 2].astype(float)
            turned = np.column_stack(
                [
                    offset[:, 0] * np.cos(turn) - offset[:, 1] * np.sin(turn),
                    offset[:, 0] * np.sin(turn) + offset[:, 1] * np.cos(turn),
                    offset[:, 2],
                ]
            )
            found.append(rows.position[chosen] + turned)
    return np.concatenate(found)


def place_lamps(
    scene: bpy.types.Scene, lamps: NDArray[np.float64], camera: Camera, *, on: bool
) -> int:
    """Put real lights into the lamps nearest to a camera; returns how many."""
    collection = light_collection(scene)
    for item in [o for o in collection.objects if o.name.startswith("Lamp")]:
        bpy.data.objects.remove(item)
    if not on or not len(lamps):
        return 0
    distance = np.linalg.norm(lamps - np.array(camera.position), axis=1)
    near = np.argsort(distance, kind="stable")[:MAX_LAMPS]
    near = near[distance[near] < LAMP_REACH + max(camera.position[2], 0.0) * 2]
    light = bpy.data.lights.get("Lamp") or bpy.data.lights.new("Lamp", "POINT")
    light.energy, light.color, light.shadow_soft_size = LAMP_WATTS, LAMP_COLOR, 0.12
    for index, spot in enumerate(lamps[near]):
        item = bpy.data.objects.new(f"Lamp_{index:02d}", light)
        item.location = spot
        collection.objects.link(item)
    return len(near)


def make_light(
    scene: bpy.types.Scene,
    environment: Environment,
    cameras: Sequence[Camera],
    extent: tuple[float, float, float, float],
) -> None:
    """Make sky, air and the way colours are shown."""
    make_world(scene, environment)
    xmin, ymin, xmax, ymax = extent
    corners = np.array([(x, y) for x in (xmin, xmax) for y in (ymin, ymax)])
    eyes = np.array([c.position for c in cameras] or [((xmin + xmax) / 2, (ymin + ymax) / 2, 0.0)])
    far = np.linalg.norm(corners[None] - eyes[:, None, :2], axis=2).max()
    reach = float(np.hypot(far, np.abs(eyes[:, 2]).max())) * 1.1 + 100.0
    make_air(scene, environment, reach)
    scene.view_settings.view_transform = "AgX"
    scene.view_settings.look = "None"
    scene.view_settings.exposure = environment.exposure
