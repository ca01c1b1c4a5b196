"""The two node groups that every material shares: weather, and the lights of rooms and lamps.

Their knobs are the only places where weather and hour enter the materials, so a change of weather
turns a dozen numbers (`turn_knobs`) and touches no mesh and no material.
"""

from __future__ import annotations

from collections.abc import Mapping
from io import BytesIO
from types import MappingProxyType
from typing import Any

import bpy
import numpy as np
from numpy.typing import NDArray

from cityx.blender import nodes
from cityx.blender.sky import lamp_balance
from cityx.city.environment import Environment
from cityx.ground.ground_wear import BRICK

Tree = Any
Socket = Any

WEATHER, LIGHTS = "CityX Weather", "CityX Lights"
BALANCE = "Balance of lamps and sky"
# Splashes above the ground, streaks of rain and blotches on old walls.
SPLASH_HEIGHT = 1.3  # metres above the ground that rain throws soil up a wall
SPLASH, STREAK, BLOTCH = 0.26, 0.16, 0.14  # shares of light they take at most
# Hair cracks in asphalt: metres between them, half their width, the share of light they take, and
# the size of the few worn stretches that have them.
CRACK_CELL, CRACK_HALF, CRACK, CRACK_STRETCH = 3.1, 0.010, 0.5, 13.0
CRACKED_FROM = (0.45, 0.56)  # of the noise by which stretches are chosen; about half have any
# Old asphalt is no even grey: metres between its spots and its grains, and ranges of their tones.
SPOT, SPOT_TONE, GRAIN, GRAIN_TONE = 1.3, 0.85, 0.13, 0.6
# Drips of oil: metres between them, share of the places that have one, and of the light it takes.
OIL_CELL, OILED, OIL = 1.9, 0.34, 0.34
# Water in the pores of a surface bends light inward again: wet concrete keeps about half of it, and
# more of its colour (Lekner and Dorf 1988).
WET_LOSS = 0.42
WET_GAMMA = 0.55
FILM_ROUGHNESS = 0.10
PUDDLE_SIZE = 5.0  # metres between hollows
RIPPLE_SIZE = 0.16  # metres between drops that fall on a puddle in the rain
SNOW_COLOR = (0.80, 0.82, 0.86, 1.0)
SLUSH_COLOR = (0.42, 0.425, 0.435, 1.0)
SNOW_REACH = 8.0  # metres within which a roof, an awning or a bridge keeps snow off
# Clipped leaves hold snow at any slope, the more of the sky they see: the top of a hedge sees all
# of it, its sides half, where a dusting lies in clumps.
CAUGHT = (0.42, 0.9)  # shares of open sky between which a leaf is covered
CLUMP = 0.3  # metres
SNOW_SAMPLES = 12  # the share of open sky is compared with a threshold: few would blur it
# The picture of `cityx.ground.ground_wear`, and how much of the light it takes or gives.
WEAR, WEAR_CORNER, WEAR_SCALE = "Ground wear", "Corner of the wear", "Scale of the wear"
WORN = "Worn"  # 1 once the picture is there
RUBBER, REPAIRED, FIELD = 0.42, 0.68, 0.55
# Paint wears off where tyres run, and in spots all over, on some streets more than on others:
# metres over which streets differ, of spots and of flakes; shares worn at least and at most.
PAINT_AGE, PAINT_SPOT, PAINT_FLAKE = 38.0, 0.55, 0.045
PAINT_WORN, PAINT_RUBBED = (0.10, 0.50), 0.42
BARE_ROAD = (0.10, 0.10, 0.104, 1.0)
BRICK_HUE = (1.02, 0.58, 0.44, 1.0)  # of fields of brick, on the colour of the other blocks
# Kelvin: bulbs and lamps of homes; tubes at work and in shops.
HOME_KELVIN, WORK_KELVIN = (2700.0, 3700.0), (3300.0, 5000.0)

INDOORS = "Indoors"  # knob of the glow of shops' rooms

# Knob to the field of the environment that it shows, by group.
KNOBS: Mapping[str, Mapping[str, str]] = MappingProxyType(
    {
        WEATHER: {"Wetness": "wetness", "Snow": "snow", "Rain": "rain"},
        LIGHTS: {
            "Homes lit": "night_lights",
            "Workplaces lit": "work_lights",
            "Shops lit": "shop_lights",
            "Lamps": "lamps",
        },
    }
)


def turn_knobs(environment: Environment) -> None:
    """Show an environment in all materials of the open file."""
    for group, knobs in KNOBS.items():
        tree = bpy.data.node_groups.get(group)
        if tree is None:
            continue
        for knob, field in knobs.items():
            tree.nodes[knob].outputs[0].default_value = getattr(environment, field)
    lights = bpy.data.node_groups.get(LIGHTS)
    if lights is not None:
        # Zero by day lets Cycles fold all rooms away.
        burning = environment.lamps > 0 or any(environment.rooms_lit)
        balance = lamp_balance(environment) if burning else 0.0
        lights.nodes[BALANCE].outputs[0].default_value = balance
        lights.nodes[INDOORS].outputs[0].default_value = environment.shop_glow


def weather_group() -> Tree:
    """Make the group between a dry surface and its shader.

    Cycles folds products with a constant zero, so in dry weather nothing here costs anything.
    """
    inputs = {
        "Color": (0.8, 0.8, 0.8, 1.0), "Roughness": 0.8, "Metallic": 0.0, "Porosity": 0.5,
        "Puddles": 0.0, "Snow cover": 1.0, "Traffic": 0.0, "Variation": 0.0, "Age": 0.0,
        "Foliage": 0.0, "Cracks": 0.0, "Repairs": 0.0, "Fields": 0.0, "Paint": 0.0,
        "Normal": (0.0, 0.0, 0.0),
    }  # fmt: skip
    outputs = {"Color": "Color", "Roughness": "Float", "Metallic": "Float", "Normal": "Vector"}
    tree, source, sink = nodes.group(WEATHER, inputs, outputs)
    given = source.outputs
    wetness = nodes.knob(tree, "Wetness")
    snow = nodes.knob(tree, "Snow")
    rain = nodes.knob(tree, "Rain")
    _, _, up = nodes.parts(tree, tree.nodes.new("ShaderNodeNewGeometry").outputs["Normal"])
    level = nodes.smoothstep(tree, up, 0.3, 0.6)
    splash = _splash(tree)

    # Broad patches of slightly other brightness hide the repeat of the tiles.
    patches = nodes.math(tree, "SUBTRACT", nodes.noise(tree, 9.0), 0.5)
    varied = nodes.math(tree, "MULTIPLY", patches, given["Variation"])
    color = nodes.product(tree, given["Color"], nodes.math(tree, "MULTIPLY_ADD", varied, 0.5, 1.0))
    dirt = nodes.math(tree, "MULTIPLY", _dirt(tree, splash), given["Age"])
    dirt = nodes.math(tree, "MULTIPLY", dirt, nodes.math(tree, "SUBTRACT", 1.0, level))
    color = nodes.product(tree, color, nodes.math(tree, "SUBTRACT", 1.0, dirt))

    cracks = nodes.math(tree, "MAXIMUM", _cracks(tree), _oil(tree))
    cracks = nodes.math(tree, "SUBTRACT", cracks, _spots(tree))
    cracks = nodes.math(tree, "MULTIPLY", cracks, given["Cracks"])
    color = nodes.product(tree, color, nodes.math(tree, "SUBTRACT", 1.0, cracks))

    wheels, repaired, field = _wear(tree)
    color = nodes.mix(tree, _bare_of_paint(tree, wheels, given["Paint"]), color, BARE_ROAD)
    brick = nodes.smoothstep(tree, field, BRICK - 0.06, BRICK - 0.02)
    brick = nodes.math(tree, "MULTIPLY", brick, given["Fields"])
    color = nodes.mix(tree, brick, color, nodes.product(tree, color, BRICK_HUE))
    color = nodes.product(tree, color, _worn(tree, given, wheels, repaired, field))

    white = _snow(tree, up, snow, given, wheels)
    # Cars melt snow: what they leave is wet.
    thaw = nodes.math(tree, "MULTIPLY", given["Traffic"], snow)
    wetness = nodes.math(tree, "MAXIMUM", wetness, nodes.math(tree, "MULTIPLY", thaw, 0.8))
    # Rain reaches level surfaces first, walls little but for the splashes at their feet.
    low = nodes.math(tree, "MULTIPLY", splash, given["Age"])
    reach = nodes.math(tree, "MULTIPLY_ADD", nodes.smoothstep(tree, up, 0.1, 0.8), 0.65, 0.35)
    reach = nodes.math(tree, "MAXIMUM", reach, low)
    wet = nodes.math(tree, "MULTIPLY", reach, wetness)
    soaked = nodes.math(tree, "MULTIPLY", wet, given["Porosity"])
    pooled = _pools(tree, up, wetness, given["Puddles"])
    gamma = tree.nodes.new("ShaderNodeGamma")
    tree.links.new(color, gamma.inputs["Color"])
    tree.links.new(nodes.math(tree, "MULTIPLY_ADD", soaked, WET_GAMMA, 1.0), gamma.inputs["Gamma"])
    kept = nodes.math(tree, "MULTIPLY_ADD", soaked, -WET_LOSS, 1.0)
    kept = nodes.math(tree, "MULTIPLY_ADD", nodes.math(tree, "MULTIPLY", pooled, kept), -0.4, kept)
    color = nodes.product(tree, gamma.outputs[0], kept)
    film = nodes.math(tree, "MULTIPLY", wet, 0.62)
    rough = nodes.mix(tree, film, given["Roughness"], FILM_ROUGHNESS, kind="FLOAT")
    rough = nodes.mix(tree, pooled, rough, 0.015, kind="FLOAT")
    bent = nodes.vector(tree, "SUBTRACT", _ripples(tree, rain), given["Normal"])
    bent = nodes.vector(tree, "MULTIPLY", bent, pooled)
    normal = nodes.vector(tree, "ADD", given["Normal"], bent)

    slushy = nodes.math(tree, "MULTIPLY", white, given["Traffic"])
    heap = nodes.mix(tree, slushy, SNOW_COLOR, SLUSH_COLOR)
    color = nodes.mix(tree, white, color, heap)
    rough = nodes.mix(tree, white, rough, 0.7, kind="FLOAT")
    metallic = nodes.math(
        tree, "MULTIPLY", given["Metallic"], nodes.math(tree, "SUBTRACT", 1.0, white)
    )
    made = {"Color": color, "Roughness": rough, "Metallic": metallic, "Normal": normal}
    for name, socket in made.items():
        tree.links.new(socket, sink.inputs[name])
    nodes.spread(tree)
    return tree


def _splash(tree: Tree) -> Socket:
    """Return 1 at the foot of a wall, 0 above the splashes; the edge wavers."""
    _, height, _ = nodes.parts(tree, nodes.uv(tree))
    wavering = nodes.math(tree, "MULTIPLY_ADD", nodes.noise(tree, 0.7, 3.0), -0.9, height)
    above = nodes.smoothstep(tree, wavering, -0.4, SPLASH_HEIGHT - 0.4)
    return nodes.math(tree, "SUBTRACT", 1.0, above)


def _dirt(tree: Tree, splash: Socket) -> Socket:
    """Return the share of light that the age of a wall takes, by its metres along and up."""
    along, height, _ = nodes.parts(tree, nodes.uv(tree))
    blotch = nodes.smoothstep(tree, nodes.noise(tree, 1.6, 4.0), 0.42, 0.7)
    # Streaks run down: noise that is long in height and short along the wall.
    stretched = nodes.joined(
        tree, nodes.math(tree, "MULTIPLY", along, 1.7), nodes.math(tree, "MULTIPLY", height, 0.11)
    )
    streak = nodes.smoothstep(tree, nodes.noise(tree, 1.0, 3.0, at=stretched), 0.52, 0.74)
    total = nodes.math(
        tree, "MULTIPLY_ADD", splash, SPLASH, nodes.math(tree, "MULTIPLY", blotch, BLOTCH)
    )
    return nodes.math(tree, "MULTIPLY_ADD", streak, STREAK, total)


def _cracks(tree: Tree) -> Socket:
    """Return the share of light that cracks take, in the few stretches that are worn."""
    place = tree.nodes.new("ShaderNodeNewGeometry").outputs["Position"]
    push = tree.nodes.new("ShaderNodeTexNoise")
    push.inputs["Scale"].default_value = 2.0
    tree.links.new(place, push.inputs["Vector"])
    bent = nodes.vector(tree, "MULTIPLY_ADD", push.outputs["Color"], (0.7, 0.7, 0.0), place)
    cells = tree.nodes.new("ShaderNodeTexVoronoi")
    cells.voronoi_dimensions = "2D"
    cells.feature = "DISTANCE_TO_EDGE"
    cells.inputs["Scale"].default_value = 1 / CRACK_CELL
    tree.links.new(bent, cells.inputs["Vector"])
    near = CRACK_HALF / CRACK_CELL
    line = nodes.smoothstep(tree, cells.outputs["Distance"], 1.3 * near, 0.7 * near)
    worn = nodes.smoothstep(tree, nodes.noise(tree, CRACK_STRETCH), *CRACKED_FROM)
    return nodes.math(tree, "MULTIPLY", nodes.math(tree, "MULTIPLY", line, worn), CRACK)


def _spots(tree: Tree) -> Socket:
    """Return by how much spots and grains of asphalt are paler, or darker below 0."""
    broad = nodes.math(tree, "SUBTRACT", nodes.noise(tree, SPOT, 4.0, roughness=0.6), 0.5)
    fine = nodes.math(tree, "SUBTRACT", nodes.noise(tree, GRAIN, 2.0), 0.5)
    fine = nodes.math(tree, "MULTIPLY", fine, GRAIN_TONE)
    return nodes.math(tree, "MULTIPLY_ADD", broad, SPOT_TONE, fine)


def _oil(tree: Tree) -> Socket:
    """Return the share of light that drips of oil take: round spots, some of them run together."""
    cells = tree.nodes.new("ShaderNodeTexVoronoi")
    cells.voronoi_dimensions = "2D"
    cells.inputs["Scale"].default_value = 1 / OIL_CELL
    place = tree.nodes.new("ShaderNodeNewGeometry").outputs["Position"]
    push = tree.nodes.new("ShaderNodeTexNoise")
    push.inputs["Scale"].default_value = 5.0
    tree.links.new(place, push.inputs["Vector"])
    bent = nodes.vector(tree, "MULTIPLY_ADD", push.outputs["Color"], (0.12, 0.12, 0.0), place)
    tree.links.new(bent, cells.inputs["Vector"])
    chance, size, dark = nodes.parts(tree, cells.outputs["Color"])
    radius = nodes.math(tree, "MULTIPLY_ADD", nodes.math(tree, "POWER", size, 3.0), 0.10, 0.022)
    ring = nodes.math(tree, "DIVIDE", cells.outputs["Distance"], radius)
    spot = nodes.smoothstep(tree, ring, 1.0, 0.55)
    there = nodes.math(tree, "LESS_THAN", chance, OILED)
    taken = nodes.math(tree, "MULTIPLY_ADD", dark, 0.5, 0.5)
    spot = nodes.math(tree, "MULTIPLY", spot, there)
    return nodes.math(tree, "MULTIPLY", nodes.math(tree, "MULTIPLY", spot, taken), OIL)


def _bare_of_paint(tree: Tree, wheels: Socket, flag: Socket) -> Socket:
    """Return where paint has gone: in flakes, of which there are more where wheels run."""
    aged = nodes.smoothstep(tree, nodes.noise(tree, PAINT_AGE), 0.32, 0.68)
    least, most = PAINT_WORN
    share = nodes.math(tree, "MULTIPLY_ADD", aged, most - least, least)
    spots = nodes.math(tree, "SUBTRACT", nodes.noise(tree, PAINT_SPOT, 3.0), 0.5)
    share = nodes.math(tree, "MULTIPLY_ADD", spots, 0.7, share)
    rubbed = nodes.math(tree, "MULTIPLY", wheels, nodes.math(tree, "ADD", aged, 0.35))
    share = nodes.math(tree, "MULTIPLY_ADD", rubbed, PAINT_RUBBED, share)
    flakes = nodes.noise(tree, PAINT_FLAKE, 4.0)
    # Noise stays near its middle: a share of it lies below these heights.
    height = nodes.math(tree, "MULTIPLY_ADD", share, 0.42, 0.24)
    gone = nodes.smoothstep(tree, nodes.math(tree, "SUBTRACT", height, flakes), -0.03, 0.05)
    return nodes.math(tree, "MULTIPLY", gone, flag)


def _pools(tree: Tree, up: Socket, wetness: Socket, flag: Socket) -> Socket:
    """Return where water stands: in broad hollows of level ground, more of them the wetter."""
    hollow = nodes.noise(tree, PUDDLE_SIZE, 3.0)
    edge = nodes.math(tree, "MULTIPLY_ADD", wetness, -0.13, 0.66)
    depth = nodes.smoothstep(tree, nodes.math(tree, "SUBTRACT", hollow, edge), 0.0, 0.035)
    flat = nodes.math(tree, "MULTIPLY", nodes.smoothstep(tree, up, 0.97, 0.995), flag)
    # A sum, not a smooth step: Cycles folds it, and then everything here, when it is dry.
    enough = nodes.math(tree, "MULTIPLY_ADD", wetness, 2.0, -0.6, clamp=True)
    return nodes.math(tree, "MULTIPLY", nodes.math(tree, "MULTIPLY", depth, flat), enough)


def _ripples(tree: Tree, rain: Socket) -> Socket:
    """Return the normal of water under drops: rings that run out from where each fell."""
    place = tree.nodes.new("ShaderNodeNewGeometry").outputs["Position"]
    heights: list[Socket] = []
    for shift in (0.0, 0.37):  # two sets of cells, so that no grid shows
        cells = tree.nodes.new("ShaderNodeTexVoronoi")
        cells.voronoi_dimensions = "2D"
        cells.inputs["Scale"].default_value = 1 / (RIPPLE_SIZE * (1 + shift))
        moved = nodes.vector(tree, "ADD", place, (shift, 1.7 * shift, 0.0))
        tree.links.new(moved, cells.inputs["Vector"])
        distance = cells.outputs["Distance"]
        age, _, _ = nodes.parts(tree, cells.outputs["Color"])
        # A ring of one crest, as far out as the drop is old, and lower.
        ring = nodes.math(tree, "SUBTRACT", distance, nodes.math(tree, "MULTIPLY", age, 0.5))
        inside = nodes.math(
            tree,
            "SUBTRACT",
            1.0,
            nodes.smoothstep(tree, nodes.math(tree, "ABSOLUTE", ring), 0.0, 0.16),
        )
        wave = nodes.math(tree, "COSINE", nodes.math(tree, "MULTIPLY", ring, 40.0))
        fading = nodes.math(tree, "SUBTRACT", 1.0, age)
        heights.append(
            nodes.math(tree, "MULTIPLY", nodes.math(tree, "MULTIPLY", wave, inside), fading)
        )
    bump = tree.nodes.new("ShaderNodeBump")
    bump.inputs["Distance"].default_value = 0.0035
    tree.links.new(nodes.math(tree, "ADD", *heights), bump.inputs["Height"])
    tree.links.new(nodes.smoothstep(tree, rain, 0.2, 12.0), bump.inputs["Strength"])
    return bump.outputs["Normal"]


def _snow(tree: Tree, up: Socket, snow: Socket, given: Any, wheels: Socket) -> Socket:
    """Return the share of snow that hides a surface: level, and open to the sky."""
    # What lies over a surface is found by rays upward; under awnings and bridges it stays bare.
    sky = tree.nodes.new("ShaderNodeAmbientOcclusion")
    sky.samples = SNOW_SAMPLES
    sky.inputs["Distance"].default_value = SNOW_REACH
    tree.links.new(nodes.joined(tree, z=1.0), sky.inputs["Normal"])
    open_sky = nodes.smoothstep(tree, sky.outputs["AO"], 0.3, 0.48)
    edge = nodes.math(tree, "MULTIPLY_ADD", nodes.noise(tree, 1.2), 0.3, up)
    lying = nodes.smoothstep(tree, edge, 0.72, 0.95)
    # Nothing holds on what is steeper than 60 degrees, whatever the noise says.
    lying = nodes.math(tree, "MULTIPLY", lying, nodes.smoothstep(tree, up, 0.5, 0.6))
    lying = nodes.math(tree, "MULTIPLY", lying, open_sky)
    clumps = nodes.math(tree, "MULTIPLY_ADD", nodes.noise(tree, CLUMP, 3.0), 0.8, -0.4)
    caught = nodes.math(tree, "ADD", sky.outputs["AO"], clumps)
    caught = nodes.smoothstep(tree, caught, *CAUGHT)
    lying = nodes.mix(tree, given["Foliage"], lying, caught, kind="FLOAT")
    # Tyres press a path for each wheel through it, and slush it a little all over the street.
    patches = nodes.smoothstep(tree, nodes.noise(tree, 1.7, 5.0), 0.3, 0.62)
    left = nodes.math(tree, "MULTIPLY_ADD", patches, 0.4, 0.45)
    pressed = nodes.math(tree, "MULTIPLY_ADD", wheels, -0.9, 1.0)
    left = nodes.math(tree, "MULTIPLY", left, pressed)
    trodden = nodes.mix(tree, given["Traffic"], 1.0, left, kind="FLOAT")
    cover = nodes.math(
        tree, "MULTIPLY", nodes.math(tree, "MULTIPLY", lying, trodden), given["Snow cover"]
    )
    full = nodes.math(tree, "MULTIPLY", snow, 1.18, clamp=True)
    return nodes.math(tree, "MULTIPLY", cover, full, clamp=True)


def _wear(tree: Tree) -> tuple[Socket, Socket, Socket]:
    """Return where wheels run, 0 to 1, and the tones of repairs and of yards, about 0.

    They come from the picture that `show_wear` puts here.
    """
    place = tree.nodes.new("ShaderNodeNewGeometry").outputs["Position"]
    corner = tree.nodes.new("ShaderNodeCombineXYZ")
    corner.name = WEAR_CORNER
    scale = tree.nodes.new("ShaderNodeCombineXYZ")
    scale.name = WEAR_SCALE
    moved = nodes.vector(tree, "SUBTRACT", place, corner.outputs[0])
    picture = tree.nodes.new("ShaderNodeTexImage")
    picture.name = WEAR
    picture.extension = "EXTEND"
    placed = nodes.vector(tree, "MULTIPLY", moved, scale.outputs[0])
    tree.links.new(placed, picture.inputs["Vector"])
    wheels, repaired, field = nodes.parts(tree, picture.outputs["Color"])
    wavering = nodes.math(tree, "MULTIPLY_ADD", nodes.noise(tree, 0.25, 3.0), 0.9, 0.45)
    wheels = nodes.math(tree, "MULTIPLY", wheels, wavering, clamp=True)
    tones = (nodes.math(tree, "MULTIPLY_ADD", tone, 2.0, -256 / 255) for tone in (repaired, field))
    return wheels, *tones


def _worn(tree: Tree, given: Any, wheels: Socket, repaired: Socket, field: Socket) -> Socket:
    """Return the share of light that use and repairs leave."""
    worn = nodes.knob(tree, WORN)
    rubbed = nodes.math(tree, "MULTIPLY", wheels, given["Traffic"])
    left = nodes.math(tree, "MULTIPLY", rubbed, -RUBBER)
    for tone, where, most in ((repaired, "Repairs", REPAIRED), (field, "Fields", FIELD)):
        left = nodes.math(
            tree, "MULTIPLY_ADD", nodes.math(tree, "MULTIPLY", tone, given[where]), most, left
        )
    return nodes.math(tree, "MULTIPLY_ADD", left, worn, 1.0)


def show_wear(
    picture: NDArray[np.uint8], corner: tuple[float, float], cell: float
) -> bpy.types.Image:
    """Put a picture of the worn ground into the materials.

    Parameters
    ----------
    picture
        (h, w, 3) uint8 as of `cityx.ground.ground_wear`, first row in the south.
    corner
        South-western corner, metres.
    cell
        Metres per pixel.
    """
    from PIL import Image, TgaImagePlugin  # noqa: F401  else Pillow imports all of its formats

    height, width = picture.shape[:2]
    file = BytesIO()
    # Runs of equal pixels are packed four times as fast as a PNG, and most of the ground is one.
    pixels = Image.fromarray(np.ascontiguousarray(picture[::-1]))
    pixels.save(file, "TGA", compression="tga_rle")
    data = file.getvalue()
    # Packing a file is many times faster than handing over pixels.
    image = bpy.data.images.new(WEAR, 8, 8)
    image.source = "FILE"
    image.filepath_raw = "//textures/ground_wear.tga"
    image.pack(data=data, data_len=len(data))
    image.colorspace_settings.name = "Non-Color"
    tree = bpy.data.node_groups[WEATHER]
    tree.nodes[WEAR].image = image
    tree.nodes[WORN].outputs[0].default_value = 1.0
    for name, values in (
        (WEAR_CORNER, corner), (WEAR_SCALE, (1 / (width * cell), 1 / (height * cell))),
    ):  # fmt: skip
        for socket, value in zip(tree.nodes[name].inputs, values, strict=False):
            socket.default_value = value
    return image


def lights_group() -> Tree:
    """Make the group that decides which rooms are lit, and how bright lamps and rooms are.

    Input "Use" is 0 for homes, 1 for workplaces, 2 for shops (`cityx.city.rooms`).
    """
    inputs = {"Seed": 0.0, "Use": 0.0, "Strength": 1.0}
    outputs = {"Lamp": "Float", "Room": "Float", "Room color": "Color", INDOORS: "Float"}
    tree, source, sink = nodes.group(LIGHTS, inputs, outputs)
    seed, use = source.outputs["Seed"], source.outputs["Use"]
    home, work, shop = (
        nodes.knob(tree, name) for name in ("Homes lit", "Workplaces lit", "Shops lit")
    )
    lamps = nodes.knob(tree, "Lamps")
    balance = nodes.knob(tree, BALANCE, 1.0)
    given = nodes.math(tree, "MULTIPLY", source.outputs["Strength"], balance)
    at_work = nodes.math(tree, "GREATER_THAN", use, 0.5)
    share = nodes.mix(tree, at_work, home, work, kind="FLOAT")
    share = nodes.mix(tree, nodes.math(tree, "GREATER_THAN", use, 1.5), share, shop, kind="FLOAT")
    lit = nodes.math(tree, "LESS_THAN", seed, share)
    # More numbers from the same seed: how bright a lit room is, and how warm its lamp.
    drawn, others = nodes.white(tree, seed)
    second, _, _ = nodes.parts(tree, others)
    bright = nodes.math(tree, "MULTIPLY_ADD", nodes.math(tree, "POWER", drawn, 1.6), 1.0, 0.12)
    bright = nodes.math(tree, "MULTIPLY_ADD", at_work, 0.25, bright)
    low = nodes.mix(tree, at_work, HOME_KELVIN[0], WORK_KELVIN[0], kind="FLOAT")
    high = nodes.mix(tree, at_work, HOME_KELVIN[1], WORK_KELVIN[1], kind="FLOAT")
    kelvin = tree.nodes.new("ShaderNodeBlackbody")
    tree.links.new(nodes.mix(tree, second, low, high, kind="FLOAT"), kelvin.inputs[0])
    strength = nodes.math(tree, "MULTIPLY", lit, given)
    tree.links.new(nodes.math(tree, "MULTIPLY", bright, strength), sink.inputs["Room"])
    tree.links.new(nodes.math(tree, "MULTIPLY", lamps, given), sink.inputs["Lamp"])
    tree.links.new(kelvin.outputs[0], sink.inputs["Room color"])
    shops = nodes.knob(tree, INDOORS, 1.0)
    tree.links.new(nodes.math(tree, "MULTIPLY", shops, source.outputs["Strength"]),
                   sink.inputs[INDOORS])  # fmt: skip
    nodes.spread(tree)
    return tree
