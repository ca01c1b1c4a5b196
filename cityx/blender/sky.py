"""Sun, sky and moon of a Blender scene, from an `Environment`."""

from __future__ import annotations

from math import cos, exp, sin
from typing import Any

import bpy
import numpy as np

from cityx.blender import nodes
from cityx.blender.nodes import Socket, Tree
from cityx.city.environment import Environment

# Radiance of a white level plane under Blender's physical clear sky of strength 1, by elevation of
# the sun in degrees: with the sun, and from the sky alone. Rendered with bpy 4.5.
_ELEVATION = (-12.0, -6.0, -3.0, -1.0, 0.0, 2.0, 5.0, 10.0, 20.0, 40.0, 60.0, 80.0)
_CLEAR = (1e-7, 0.0016, 0.052, 0.21, 0.35, 0.86, 2.3, 5.6, 13.1, 27.0, 37.5, 43.0)
OVERCAST_SHARE = 0.22  # a closed cloud layer lets through about a fifth of sun and sky
GROUND_ALBEDO = (0.13, 0.125, 0.105)  # of the land beyond the site
SNOW_ALBEDO = (0.55, 0.57, 0.60)
CONTRAST_LOG = 3.912  # -ln 0.02: visibility is where contrast falls to 2 %
# The light of a night is balanced for a camera opened by about three stops.
# Degrees of the sun, and a factor on lamps, so that one exposure shows them beside the sky.
LAMP_BALANCE = ((-7.0, 1.0), (-3.0, 0.08), (0.0, 0.25), (5.0, 0.7))
NIGHT_SKY = (0.0015, 0.0025, 0.0054)  # a city's night sky as pictures show it, brighter than real
CITY_GLOW = (0.0066, 0.0052, 0.0040)  # of lamps on the air above the horizon
STAR_RADIANCE = 0.35
MOON_IRRADIANCE = 0.02
MOON_HEIGHT, MOON_TURN = 48.0, 0.6  # degrees up; radians from opposite the sun
MOON_RADIUS = 0.9  # degrees, four times as wide as real: so it looks in a wide picture
CLOSED = 0.9  # cloud cover from which no sun and no blue is seen
CLOUD_BASE = 0.12  # flattens the dome so that clouds shrink towards the horizon
VEILED = (3_000.0, 12_000.0)  # metres of visibility between which haze begins to veil the sky
# Radiance of far air beside that of a white level plane: under a high sun, under one close to the
# horizon, whose light has lost its blue on the way, and that of fog, which mixes sun and sky.
CLEAR_HAZE, LOW_SUN_HAZE, FOG_HAZE = (0.145, 0.17, 0.215), (0.55, 0.33, 0.20), (0.30, 0.31, 0.32)
LOW_SUN = (-7.0, -1.0, 3.0, 14.0)  # degrees of the sun between which it reddens the air


def clear_radiance(elevation: float) -> float:
    """Return the radiance of a white level plane under a clear sky of strength 1 (radians in)."""
    return exp(float(np.interp(np.degrees(elevation), _ELEVATION, np.log(_CLEAR))))


def night_share(elevation: float) -> float:
    """Return 0 by day, 1 at night, smooth from sunset to the end of civil dusk (8 degrees)."""
    t = min(max((2.0 - float(np.degrees(elevation))) / 10.0, 0.0), 1.0)
    return t * t * (3 - 2 * t)


def deep_night(elevation: float) -> float:
    """Return 0 while the sky still glows of the sun, 1 when only stars and lamps are left."""
    t = min(max((-2.0 - float(np.degrees(elevation))) / 5.0, 0.0), 1.0)
    return t * t * (3 - 2 * t)


def low_sun(elevation: float) -> float:
    """Return how far the sun reddens the air: 1 while it rises or sets, 0 by day and at night."""
    return float(np.interp(np.degrees(elevation), LOW_SUN, (0.0, 1.0, 1.0, 0.0)))


def lamp_balance(environment: Environment) -> float:
    """Return the factor on all lamps: at dusk they are weak beside the sky, at night 1."""
    return float(np.interp(np.degrees(environment.sun_elevation), *np.array(LAMP_BALANCE).T))


def daylight(environment: Environment) -> float:
    """Return the radiance of a white plane under the sky as clouds leave it."""
    cover = environment.cloud_cover
    level = clear_radiance(environment.sun_elevation) * environment.sky_strength
    return level * ((1 - cover) + cover * OVERCAST_SHARE)


def haze_color(environment: Environment) -> tuple[float, float, float]:
    """Return the radiance of air far away: that of the sky just above the horizon."""
    cover = environment.cloud_cover
    level = clear_radiance(environment.sun_elevation) * environment.sky_strength
    night = night_share(environment.sun_elevation)
    warm = (1 - cover) * low_sun(environment.sun_elevation)
    low = np.array(LOW_SUN_HAZE) * warm
    clear = (np.array(CLEAR_HAZE) * (1 - warm) + low) * level
    grey = (np.array(FOG_HAZE) * (1 - warm) + low) * level
    grey *= 1 if cover < 0.95 else OVERCAST_SHARE * 2
    thick = min(1.0, 3000.0 / max(environment.visibility, 1.0))
    share = max(cover, thick)
    lamps = np.array([0.02, 0.014, 0.008]) * environment.lamps * night * lamp_balance(environment)
    red, green, blue = (
        (1 - share) * clear + share * grey + np.array(NIGHT_SKY) * night + lamps * thick
    ).tolist()
    return red, green, blue


def make_world(scene: bpy.types.Scene, environment: Environment) -> bpy.types.World:
    """Make sky and sun; the sun stands where the environment says, azimuth from north.

    An older sky of the scene is replaced.
    """
    if scene.world is not None:
        bpy.data.worlds.remove(scene.world)
    for item in [o for o in light_collection(scene).objects if o.name.startswith("Moon")]:
        bpy.data.objects.remove(item)
    world = bpy.data.worlds.new("Sky")
    scene.world = world
    world.use_nodes = True
    tree = world.node_tree
    background = tree.nodes["Background"]
    direction = tree.nodes.new("ShaderNodeTexCoord").outputs["Generated"]
    _, _, up = nodes.parts(tree, direction)
    closed = environment.cloud_cover >= CLOSED
    plain = _radiance(tree, direction, up, environment, detailed=False)
    tree.links.new(plain, background.inputs["Color"])
    if environment.cloud_cover > 0 or night_share(environment.sun_elevation) > 0:
        # Only the camera and mirrors see clouds and stars; other rays take the plain sky, a third
        # of the time of a picture under clouds.
        seen = tree.nodes.new("ShaderNodeBackground")
        color = _radiance(tree, direction, up, environment, detailed=True)
        tree.links.new(color, seen.inputs["Color"])
        ray = tree.nodes.new("ShaderNodeLightPath").outputs
        both = tree.nodes.new("ShaderNodeMixShader")
        share = nodes.math(tree, "MAXIMUM", ray["Is Camera Ray"], ray["Is Glossy Ray"])
        tree.links.new(share, both.inputs[0])
        tree.links.new(background.outputs[0], both.inputs[1])
        tree.links.new(seen.outputs[0], both.inputs[2])
        tree.links.new(both.outputs[0], tree.nodes["World Output"].inputs["Surface"])
    # Rays that bounce find an even sky by themselves; rays towards it would only cost.
    world.cycles.sampling_method = "NONE" if closed else "AUTOMATIC"
    night = night_share(environment.sun_elevation)
    if night > 0.5:
        _moonlight(scene, environment, night)
    nodes.spread(tree)
    return world


def _radiance(
    tree: Tree, direction: Socket, up: Socket, environment: Environment, *, detailed: bool
) -> Socket:
    """Return the radiance of the sky and of the land beyond the site towards a direction."""
    if environment.cloud_cover >= CLOSED:
        color = _overcast(tree, direction, up, environment, detailed=detailed)
    else:
        factor = (environment.sky_strength,) * 3
        color = nodes.product(tree, _sky(tree, environment), factor)
        night = night_share(environment.sun_elevation)
        if night > 0:
            color = _with_night(tree, color, direction, up, environment, detailed=detailed)
        if environment.cloud_cover > 0:
            color = _with_clouds(tree, color, direction, up, environment, detailed=detailed)
    color = _veiled(tree, color, up, environment)
    return nodes.mix(tree, nodes.smoothstep(tree, up, 0.0, -0.02), color, _land(environment))


def _sky(tree: Tree, environment: Environment) -> Socket:
    sky = tree.nodes.new("ShaderNodeTexSky")
    kinds = sky.bl_rna.properties["sky_type"].enum_items.keys()
    # Blender 5 renamed the model, with the better multiple scattering beside it.
    sky.sky_type = "NISHITA" if "NISHITA" in kinds else "MULTIPLE_SCATTERING"
    sky.sun_elevation = environment.sun_elevation
    sky.sun_rotation = environment.sun_azimuth  # measured from +y, clockwise: compass
    veil = environment.cloud_cover
    sky.sun_disc = True
    sky.sun_intensity = (1.0 - veil) ** 2
    sky.sun_size = np.radians(0.545 + 4.0 * veil)  # thin cloud blurs the disc
    # Haze: the share of particles for which contrast falls to 2 % at the visibility.
    haze = min(10.0, max(1.0, 20_000.0 / max(environment.visibility, 1.0)))
    name = "dust_density" if hasattr(sky, "dust_density") else "aerosol_density"
    setattr(sky, name, haze)
    return sky.outputs["Color"]


# --- clouds ---------------------------------------------------------------------------------------


def _ceiling(tree: Tree, direction: Socket, up: Socket) -> Socket:
    """Return where a direction meets the layer of clouds: a dome, flat above, low at the rim."""
    lifted = nodes.math(tree, "ADD", nodes.math(tree, "MAXIMUM", up, 0.0), CLOUD_BASE)
    inverse = nodes.math(tree, "DIVIDE", 1.0, lifted)
    return nodes.vector(tree, "SCALE", direction, scale=inverse)


def _billows(tree: Tree, place: Socket, size: float, detail: float) -> Socket:
    """Return the thickness of cloud, 0 to 1: noise whose place is itself pushed about by noise."""
    push = tree.nodes.new("ShaderNodeTexNoise")
    push.inputs["Scale"].default_value = 0.9 / size
    push.inputs["Detail"].default_value = 2.0
    tree.links.new(place, push.inputs["Vector"])
    moved = nodes.vector(
        tree, "MULTIPLY_ADD", push.outputs["Color"], (0.9 * size, 0.9 * size, 0.0), place
    )
    return nodes.noise(tree, size, detail, at=moved, roughness=0.58)


def _overcast(
    tree: Tree, direction: Socket, up: Socket, environment: Environment, *, detailed: bool
) -> Socket:
    """Return the CIE overcast sky, three times brighter at the zenith, with folds of cloud in it.

    Folds are darker and stand out more the higher the contrast; under a storm the cloud is a dark
    ceiling, and a pale band is left above the horizon, where one looks out beneath it.
    """
    level = clear_radiance(environment.sun_elevation) * OVERCAST_SHARE * 9 / 7
    level *= environment.sky_strength
    contrast = environment.cloud_contrast
    rise = tree.nodes.new("ShaderNodeMapRange")
    tree.links.new(up, rise.inputs["Value"])
    storm = contrast**2  # of thin layers little of it shows
    rise.inputs["To Min"].default_value = level / 3 * (1 + 0.8 * contrast)
    rise.inputs["To Max"].default_value = level * (1 - 0.2 * contrast - 0.5 * storm)
    deep: Socket = 0.5  # 0 thin and bright, 1 thick and dark
    if detailed:
        place = _ceiling(tree, direction, up)
        folds = _billows(tree, place, 1.5, 6.0)
        small = nodes.noise(tree, 0.4, 4.0, at=place)
        mixed = nodes.math(
            tree, "MULTIPLY_ADD", small, 0.3, nodes.math(tree, "MULTIPLY", folds, 0.7)
        )
        # A storm's folds are closed towers with ragged edges, and few gaps between them.
        deep = nodes.smoothstep(tree, mixed, 0.38 - 0.07 * storm, 0.6 - 0.09 * storm)
    deep = nodes.math(tree, "MULTIPLY", deep, nodes.smoothstep(tree, up, 0.0, 0.12))
    shade = nodes.math(tree, "MULTIPLY_ADD", deep, -1.0 * contrast, 1.0 + 0.4 * contrast)
    bright = nodes.math(tree, "MULTIPLY", rise.outputs["Result"], shade)
    cool = (0.93 - 0.10 * contrast, 0.98 - 0.03 * contrast, 1.06)
    grey = nodes.mix(tree, 1.0, bright, cool, blend="MULTIPLY")
    night = night_share(environment.sun_elevation)
    # At night low cloud throws the light of the lamps back.
    glow = tuple(
        night * (n + 0.6 * g * environment.lamps) for n, g in zip(NIGHT_SKY, CITY_GLOW, strict=True)
    )
    glow_color = nodes.product(tree, (*glow, 1.0), shade)
    return nodes.mix(tree, 1.0, grey, glow_color, blend="ADD")


def _with_clouds(
    tree: Tree, sky: Socket, direction: Socket, up: Socket, environment: Environment, *,
    detailed: bool,
) -> Socket:  # fmt: skip
    """Put cumulus over the sky: bright where the sun meets it, grey where it is thick below."""
    level = clear_radiance(environment.sun_elevation) * environment.sky_strength
    low = 1.0 - min(max(np.degrees(environment.sun_elevation) / 18.0, 0.0), 1.0)
    night = night_share(environment.sun_elevation)
    sunlit = np.array([0.40, 0.385, 0.37]) * (1 - low) + np.array([0.62, 0.36, 0.24]) * low
    shaded = np.array([0.15, 0.165, 0.19]) * (1 - low) + np.array([0.13, 0.12, 0.16]) * low
    dim = night * np.array(CITY_GLOW) * environment.lamps * 0.35
    pale, dark = ((*(part * level + dim).tolist(), 1.0) for part in (sunlit, shaded))
    if not detailed:
        middle = tuple((a + b) / 2 for a, b in zip(pale, dark, strict=True))
        return nodes.mix(tree, environment.cloud_cover * 0.93, sky, middle)
    place = _ceiling(tree, direction, up)
    thick = _billows(tree, place, 1.1, 7.0)
    # The noise is nearly normal about 0.5; its quantile at the cover is the threshold.
    edge = 0.51 - 0.17 * (2 * environment.cloud_cover - 1)
    share = nodes.smoothstep(tree, thick, edge, edge + 0.07)
    azimuth, elevation = environment.sun_azimuth, max(environment.sun_elevation, 0.0)
    toward = np.array([sin(azimuth), cos(azimuth), 0.0]) * 0.16 * cos(elevation)
    behind = _billows(tree, nodes.vector(tree, "ADD", place, tuple(toward.tolist())), 1.1, 5.0)
    # Less cloud towards the sun: this side is lit.
    lit = nodes.math(tree, "MULTIPLY_ADD", nodes.math(tree, "SUBTRACT", thick, behind), 6.0, 0.55)
    core = nodes.smoothstep(tree, thick, edge + 0.04, edge + 0.22)
    lit = nodes.math(tree, "MULTIPLY_ADD", core, -0.45, lit, clamp=True)
    cloud = nodes.mix(tree, lit, dark, pale)
    # Far clouds are seen through much air.
    share = nodes.math(tree, "MULTIPLY", share, nodes.smoothstep(tree, up, 0.0, 0.1))
    return nodes.mix(tree, nodes.math(tree, "MULTIPLY", share, 0.93), sky, cloud)


# --- night ----------------------------------------------------------------------------------------


def _with_night(
    tree: Tree, sky: Socket, direction: Socket, up: Socket, environment: Environment, *,
    detailed: bool,
) -> Socket:  # fmt: skip
    """Add the deep blue of the night, the glow of the city, stars and the moon."""
    night = deep_night(environment.sun_elevation)
    high = nodes.smoothstep(tree, up, -0.05, 0.75)
    top = tuple(night * channel for channel in NIGHT_SKY)
    glow = tuple(
        night * (n + g * (0.3 + 0.7 * environment.lamps))
        for n, g in zip(NIGHT_SKY, CITY_GLOW, strict=True)
    )
    sky = nodes.mix(tree, 1.0, sky, nodes.mix(tree, high, (*glow, 1.0), (*top, 1.0)), blend="ADD")
    clear = night * (1 - environment.cloud_cover) * min(1.0, environment.visibility / 12_000.0)
    deep = max(0.0, min(1.0, (-np.degrees(environment.sun_elevation) - 3.0) / 5.0))
    if deep > 0 and detailed:
        cells = tree.nodes.new("ShaderNodeTexVoronoi")
        cells.inputs["Scale"].default_value = 90.0
        tree.links.new(direction, cells.inputs["Vector"])
        drawn, _, _ = nodes.parts(tree, cells.outputs["Color"])
        bright = nodes.math(tree, "POWER", drawn, 6.0)
        point = nodes.smoothstep(tree, cells.outputs["Distance"], 0.11, 0.02)
        rim = nodes.smoothstep(tree, up, 0.02, 0.35)
        star = nodes.math(tree, "MULTIPLY", nodes.math(tree, "MULTIPLY", point, bright), rim)
        star = nodes.math(tree, "MULTIPLY", star, STAR_RADIANCE * clear * deep)
        sky = nodes.mix(tree, 1.0, sky, star, blend="ADD")
        toward = nodes.vector(tree, "DOT_PRODUCT", direction, moon_direction(environment))
        disc = nodes.smoothstep(
            tree, toward, cos(np.radians(MOON_RADIUS)), cos(np.radians(MOON_RADIUS * 0.9))
        )
        seas = nodes.noise(tree, 0.012, 3.0, at=direction)
        face = nodes.math(tree, "MULTIPLY_ADD", nodes.smoothstep(tree, seas, 0.4, 0.62), -0.35, 1.0)
        lit = nodes.math(tree, "MULTIPLY", disc, face)
        halo = nodes.math(tree, "POWER", nodes.math(tree, "MAXIMUM", toward, 0.0), 700.0)
        lit = nodes.math(tree, "MULTIPLY_ADD", halo, 0.03, lit)
        lit = nodes.math(tree, "MULTIPLY", lit, 0.4 * clear * deep * environment.moon)
        moon = nodes.mix(tree, 1.0, lit, (0.95, 0.98, 1.0, 1.0), blend="MULTIPLY")
        sky = nodes.mix(tree, 1.0, sky, moon, blend="ADD")
    return sky


def moon_direction(environment: Environment) -> tuple[float, float, float]:
    """Return the unit vector towards the moon: high, somewhat aside of opposite the sun."""
    azimuth = environment.sun_azimuth + np.pi + MOON_TURN
    up = np.radians(MOON_HEIGHT)
    return (float(sin(azimuth) * cos(up)), float(cos(azimuth) * cos(up)), float(sin(up)))


def _moonlight(scene: bpy.types.Scene, environment: Environment, night: float) -> None:
    """Put a weak blue light where the moon stands."""
    light = bpy.data.lights.new("Moon", "SUN")
    light.energy = MOON_IRRADIANCE * night * (1 - 0.9 * environment.cloud_cover) * environment.moon
    light.color = (0.62, 0.76, 1.0)
    light.angle = np.radians(0.53)
    item = bpy.data.objects.new("Moon", light)
    azimuth = environment.sun_azimuth + np.pi + MOON_TURN
    item.rotation_euler = (np.radians(90.0 - MOON_HEIGHT), 0.0, np.pi - azimuth)
    light_collection(scene).objects.link(item)


# --- near the horizon -----------------------------------------------------------------------------


def _veiled(tree: Tree, sky: Socket, up: Socket, environment: Environment) -> Socket:
    """Veil the sky by fog: all of it at the horizon, above as deep as the fog is."""
    thin, thick = VEILED[1], VEILED[0]
    weight = min(max((thin - environment.visibility) / (thin - thick), 0.0), 1.0)
    if not weight:
        return sky
    depth = CONTRAST_LOG / environment.visibility * environment.fog_height
    along = nodes.math(tree, "DIVIDE", -depth, nodes.math(tree, "MAXIMUM", up, 0.01))
    share = nodes.math(tree, "SUBTRACT", 1.0, nodes.math(tree, "EXPONENT", along))
    share = nodes.math(tree, "MULTIPLY", share, weight)
    return nodes.mix(tree, share, sky, (*haze_color(environment), 1.0))


def _land(environment: Environment) -> tuple[float, float, float, float]:
    """Radiance of the land beyond the site, seen below the horizon."""
    level = daylight(environment)
    night = night_share(environment.sun_elevation)
    white = min(1.0, environment.snow * 1.1)
    red, green, blue = (
        (a * (1 - white) + s * white) * (level + n * night * 2)
        for a, s, n in zip(GROUND_ALBEDO, SNOW_ALBEDO, NIGHT_SKY, strict=True)
    )
    return red, green, blue, 1.0


def light_collection(scene: bpy.types.Scene) -> bpy.types.Collection:
    """Return the collection "Light", made when it is missing."""
    found: Any = scene.collection.children.get("Light")
    if found is None:
        found = bpy.data.collections.new("Light")
        scene.collection.children.link(found)
    return found
