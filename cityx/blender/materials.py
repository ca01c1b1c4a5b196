"""The materials of a city as Blender node trees, made from `cityx.assets.materials`.

All of them run through one node group, "CityX Weather", whose values are the weather: changing
them in one place wets, whitens or lights the whole city.
"""

from __future__ import annotations

from functools import lru_cache
from io import BytesIO
from typing import Any

import bpy
import numpy as np

from cityx.assets.materials import MATERIALS, Material
from cityx.city.environment import Environment

# Materials of level ground, where rain stands in puddles.
PUDDLED = frozenset(
    {"asphalt", "asphalt_light", "setts", "paving", "concrete", "bitumen", "pitch", "soil"}
)
# Materials of outer walls, which weather: splashes above the ground, streaks of rain, blotches.
AGED = frozenset({"plaster", "brick", "stone", "concrete", "wood", "trim"})
SPLASH_HEIGHT = 1.3  # metres above the ground that rain throws soil up a wall
SPLASH, STREAK, BLOTCH = 0.26, 0.16, 0.14  # shares of light they take at most
LEAVES = frozenset({"leaf", "foliage"})
GLAZED = frozenset({"glass", "glass_wall", "car_glass"})
SNOW_COLOR = (0.82, 0.84, 0.88, 1.0)
WET_LOSS = 0.55  # share of light a soaked porous surface loses; wet concrete keeps about half
GLASS_IOR = 1.9  # a coated double pane mirrors twice as much as plain glass
JPEG_QUALITY = 92
# From a material's emission to radiance under a camera opened by three stops, as at night.
EMISSION_SCALE = 0.15
# Share of the emission of a lit window that leaves through its curtains.
ROOM_GLOW = 0.3

Socket = Any
Tree = Any


class MaterialLibrary:
    """The materials of one scene, each made when it is first asked for.

    A class because materials share images and the weather group of the open file.
    """

    def __init__(self, environment: Environment, *, textured: bool = True) -> None:
        self.textured = textured
        self.weather = _weather_group(environment)
        self.lights = _lights_group(environment)
        self._made: dict[tuple[str, str], bpy.types.Material] = {}
        self._images: dict[str, dict[str, bpy.types.Image]] = {}

    def get(self, name: str, variant: str = "") -> bpy.types.Material:
        """Return a material.

        Parameters
        ----------
        name
            Name in `cityx.assets.materials.MATERIALS`; unknown names give a grey surface.
        variant
            "" for shells; "instance" for prototypes, whose colour is also multiplied by the
            instance's tint; "room" for prototypes that have a room behind their glass.
        """
        key = (name, variant)
        if key not in self._made:
            record = MATERIALS.get(name) or Material(name, (0.5, 0.5, 0.5))
            self._made[key] = self._make(record, variant)
        return self._made[key]

    def _make(self, record: Material, variant: str) -> bpy.types.Material:
        material = bpy.data.materials.new(f"{record.name}.{variant}" if variant else record.name)
        material.use_nodes = True
        material.diffuse_color = (*record.color, record.alpha)
        tree = material.node_tree
        shader = tree.nodes["Principled BSDF"]
        shader.inputs["Alpha"].default_value = record.alpha
        color, roughness, normal = self._surface(tree, record)
        if record.takes_tint:
            color = _product(tree, color, _attribute(tree, "tint"))
            if variant:
                color = _product(tree, color, _attribute(tree, "tint", instance=True))
        if record.name in GLAZED:
            shader.inputs["IOR"].default_value = GLASS_IOR
            color, normal = _panes(tree, color, normal, variant)
        weather = tree.nodes.new("ShaderNodeGroup")
        weather.node_tree = self.weather
        weather.location = (-250, 200)
        _set(tree, weather.inputs["Color"], color)
        _set(tree, weather.inputs["Roughness"], roughness)
        weather.inputs["Metallic"].default_value = record.metallic
        weather.inputs["Porosity"].default_value = record.porosity
        weather.inputs["Puddles"].default_value = float(record.name in PUDDLED)
        weather.inputs["Snow cover"].default_value = float(record.name != "water")
        weather.inputs["Variation"].default_value = 1.0 if record.texture else 0.0
        if record.name in AGED and self.textured:
            weather.inputs["Age"].default_value = 1.0 if not variant else 0.3
        for name in ("Metallic", "Roughness"):
            tree.links.new(weather.outputs[name], shader.inputs[name])
        tree.links.new(weather.outputs["Color"], shader.inputs["Base Color"])
        if normal is not None:
            tree.links.new(normal, shader.inputs["Normal"])
        if record.name == "car_paint":
            shader.inputs["Coat Weight"].default_value = 0.7
        self._emit(material, record, variant)
        if record.name in LEAVES:
            _let_light_through(tree, weather.outputs["Color"])
        return material

    def _surface(self, tree: Tree, record: Material) -> tuple[Socket, Socket, Socket]:
        """Colour, roughness and normal of a dry surface; values or sockets."""
        if not (record.texture and self.textured):
            return (*record.color, 1.0), record.roughness, None
        from cityx.assets.textures import texture

        images = self._load(record.texture)
        maps = texture(record.texture)
        place = tree.nodes.new("ShaderNodeUVMap")
        place.uv_map = "UVMap"
        scale = tree.nodes.new("ShaderNodeMapping")
        scale.inputs["Scale"].default_value = (1 / record.tile, 1 / record.tile, 1.0)
        tree.links.new(place.outputs["UV"], scale.inputs["Vector"])
        nodes = {}
        for row, (name, image) in enumerate(images.items()):
            node = nodes[name] = tree.nodes.new("ShaderNodeTexImage")
            node.image = image
            node.location = (-1100, 400 - 300 * row)
            tree.links.new(scale.outputs["Vector"], node.inputs["Vector"])
        place.location, scale.location = (-1600, 200), (-1400, 200)
        base = tuple(min(1.0, channel / maps.mean) for channel in record.color)
        color = _product(tree, nodes["color"].outputs["Color"], (*base, 1.0))
        factor = tree.nodes.new("ShaderNodeMath")
        factor.operation = "MULTIPLY"
        factor.inputs[1].default_value = min(1.0, record.roughness / maps.roughness_mean)
        factor.use_clamp = True
        tree.links.new(nodes["roughness"].outputs["Color"], factor.inputs[0])
        bend = tree.nodes.new("ShaderNodeNormalMap")
        bend.uv_map = "UVMap"
        bend.location = (-700, -300)
        tree.links.new(nodes["normal"].outputs["Color"], bend.inputs["Color"])
        return color, factor.outputs[0], bend.outputs["Normal"]

    def _load(self, name: str) -> dict[str, bpy.types.Image]:
        if name not in self._images:
            self._images[name] = {
                part: _packed(f"{name}_{part}", data, "sRGB" if part == "color" else "Non-Color")
                for part, data in _encoded(name).items()
            }
        return self._images[name]

    def _emit(self, material: bpy.types.Material, record: Material, variant: str) -> None:
        """Let lamps, lit windows and rooms glow as the group "CityX Lights" says."""
        room = record.name == "glass" and variant == "room"
        wall = record.name == "glass_wall"
        if not record.emission and not room and not wall:
            return
        tree = material.node_tree
        shader = tree.nodes["Principled BSDF"]
        lights = tree.nodes.new("ShaderNodeGroup")
        lights.node_tree = self.lights
        lights.location = (-250, -300)
        if room:
            tree.links.new(_attribute(tree, "seed", instance=True), lights.inputs["Seed"])
        elif wall:
            tree.links.new(_cell_noise(tree), lights.inputs["Seed"])
        glow = record.emission or MATERIALS["window_lit"].emission * ROOM_GLOW
        lights.inputs["Strength"].default_value = glow * EMISSION_SCALE
        shader.inputs["Emission Color"].default_value = (*record.color, 1.0)
        if room or wall:
            tree.links.new(lights.outputs["Room color"], shader.inputs["Emission Color"])
        output = "Room" if room or wall else "Lamp"
        tree.links.new(lights.outputs[output], shader.inputs["Emission Strength"])
        # Thousands of panes as light sources would swamp the light tree; lamps near the camera
        # get real lights instead (`cityx.blender.sky`).
        material.cycles.emission_sampling = "NONE"


@lru_cache(maxsize=64)
def _encoded(name: str) -> dict[str, bytes]:
    """Encode a texture's maps as image files: packing files is 20 times faster than pixels."""
    from PIL import Image

    from cityx.assets.textures import texture

    maps = texture(name)
    files = {}
    for part in ("color", "normal", "roughness"):
        target = BytesIO()
        image = Image.fromarray(getattr(maps, part))
        image.save(target, "JPEG", quality=JPEG_QUALITY, subsampling=0)
        files[part] = target.getvalue()
    return files


def _packed(name: str, data: bytes, space: str) -> bpy.types.Image:
    image = bpy.data.images.new(name, 8, 8)
    image.source = "FILE"
    image.filepath_raw = f"//textures/{name}.jpg"
    image.pack(data=data, data_len=len(data))
    image.colorspace_settings.name = space
    return image


# --- pieces of node trees -------------------------------------------------------------------------


def _set(tree: Tree, target: Socket, value: Socket) -> None:
    """Give an input a value or a link."""
    if isinstance(value, bpy.types.NodeSocket):
        tree.links.new(value, target)
    else:
        target.default_value = value


def _mix(tree: Tree, kind: str, blend: str = "MIX") -> tuple[Any, Socket, Socket, Socket, Socket]:
    """Make a mix node; returns it, its factor, both inputs and the output."""
    node = tree.nodes.new("ShaderNodeMix")
    node.data_type = kind
    if kind == "RGBA":
        node.blend_type = blend
    kind_of = {"FLOAT": "VALUE", "RGBA": "RGBA"}[kind]
    a, b = (s for s in node.inputs if s.type == kind_of and s.name in "AB")
    out = next(s for s in node.outputs if s.type == kind_of)
    return node, node.inputs[0], a, b, out


def _product(tree: Tree, a: Socket, b: Socket) -> Socket:
    """Multiply two colours."""
    _, factor, first, second, out = _mix(tree, "RGBA", "MULTIPLY")
    factor.default_value = 1.0
    _set(tree, first, a)
    _set(tree, second, b)
    return out


def _attribute(tree: Tree, name: str, *, instance: bool = False) -> Socket:
    """Read an attribute of the geometry or of the instance; numbers as `Fac`, else `Color`."""
    node = tree.nodes.new("ShaderNodeAttribute")
    node.attribute_name = name
    node.attribute_type = "INSTANCER" if instance else "GEOMETRY"
    node.location = (-1100, -600)
    return node.outputs["Fac" if name == "seed" else "Color"]


def _math(tree: Tree, operation: str, *values: Socket, clamp: bool = False) -> Socket:
    node = tree.nodes.new("ShaderNodeMath")
    node.operation = operation
    node.use_clamp = clamp
    for target, value in zip(node.inputs, values, strict=False):
        _set(tree, target, value)
    return node.outputs[0]


def _smoothstep(tree: Tree, value: Socket, low: float, high: float) -> Socket:
    node = tree.nodes.new("ShaderNodeMapRange")
    node.interpolation_type = "SMOOTHSTEP"
    node.inputs["From Min"].default_value = low
    node.inputs["From Max"].default_value = high
    _set(tree, node.inputs["Value"], value)
    return node.outputs["Result"]


def _noise(tree: Tree, size: float, detail: float = 2.0) -> Socket:
    """Noise over the scene with features of `size` metres, 0 to 1."""
    node = tree.nodes.new("ShaderNodeTexNoise")
    node.inputs["Scale"].default_value = 1 / size
    node.inputs["Detail"].default_value = detail
    place = tree.nodes.new("ShaderNodeNewGeometry")
    tree.links.new(place.outputs["Position"], node.inputs["Vector"])
    return node.outputs["Fac"]


def _cell_noise(tree: Tree) -> Socket:
    """One number per pane of a curtain wall."""
    place = tree.nodes.new("ShaderNodeUVMap")
    place.uv_map = "UVMap"
    cells = tree.nodes.new("ShaderNodeVectorMath")
    cells.operation = "SNAP"
    cells.inputs[1].default_value = (MATERIALS["glass_wall"].tile,) * 3
    white = tree.nodes.new("ShaderNodeTexWhiteNoise")
    white.noise_dimensions = "2D"
    tree.links.new(place.outputs["UV"], cells.inputs[0])
    tree.links.new(cells.outputs[0], white.inputs["Vector"])
    return white.outputs["Value"]


def _panes(tree: Tree, color: Socket, normal: Socket, variant: str) -> tuple[Socket, Socket]:
    """Give each pane of an instance its own darkness and a hair of tilt: no two mirror alike."""
    if variant != "room":
        return color, normal
    seed = _attribute(tree, "seed", instance=True)
    white = tree.nodes.new("ShaderNodeTexWhiteNoise")
    white.noise_dimensions = "1D"
    tree.links.new(seed, white.inputs["W"])
    # Most rooms are dark behind the glass, some have pale curtains.
    pale = _math(tree, "MULTIPLY", _smoothstep(tree, white.outputs["Value"], 0.55, 1.0), 0.55)
    _, factor, a, b, out = _mix(tree, "RGBA")
    tree.links.new(pale, factor)
    _set(tree, a, color)
    b.default_value = (0.36, 0.34, 0.30, 1.0)
    tilt = tree.nodes.new("ShaderNodeVectorMath")
    tilt.operation = "MULTIPLY_ADD"
    tilt.inputs[1].default_value = (0.02, 0.02, 0.02)
    tree.links.new(white.outputs["Color"], tilt.inputs[0])
    upright = tree.nodes.new("ShaderNodeNewGeometry")
    shifted = tree.nodes.new("ShaderNodeVectorMath")
    shifted.inputs[1].default_value = (-0.01, -0.01, -0.01)
    tree.links.new(upright.outputs["Normal"], shifted.inputs[0])
    tree.links.new(shifted.outputs[0], tilt.inputs[2])
    unit = tree.nodes.new("ShaderNodeVectorMath")
    unit.operation = "NORMALIZE"
    tree.links.new(tilt.outputs[0], unit.inputs[0])
    return out, unit.outputs[0]


def _let_light_through(tree: Tree, color: Socket) -> None:
    """Leaves are thin: a good part of the light comes out at the other side."""
    shader = tree.nodes["Principled BSDF"]
    through = tree.nodes.new("ShaderNodeBsdfTranslucent")
    through.location = (0, -650)
    tree.links.new(_product(tree, color, (1.5, 1.6, 0.7, 1.0)), through.inputs["Color"])
    both = tree.nodes.new("ShaderNodeMixShader")
    both.location = (300, 300)
    both.inputs[0].default_value = 0.4
    tree.links.new(shader.outputs[0], both.inputs[1])
    tree.links.new(through.outputs[0], both.inputs[2])
    sink = tree.nodes["Material Output"]
    sink.location = (500, 300)
    tree.links.new(both.outputs[0], sink.inputs["Surface"])


# --- the two groups every material shares ---------------------------------------------------------


def _group(name: str, inputs: dict[str, Any], outputs: dict[str, str]) -> tuple[Tree, Any, Any]:
    """Make a shader group with float or colour inputs by default value, and typed outputs."""
    tree = bpy.data.node_groups.new(name, "ShaderNodeTree")
    for key, value in inputs.items():
        kind = "NodeSocketFloat" if isinstance(value, float) else "NodeSocketColor"
        socket = tree.interface.new_socket(key, in_out="INPUT", socket_type=kind)
        socket.default_value = value
    for key, kind in outputs.items():
        tree.interface.new_socket(key, in_out="OUTPUT", socket_type=f"NodeSocket{kind}")
    return tree, tree.nodes.new("NodeGroupInput"), tree.nodes.new("NodeGroupOutput")


def _value(tree: Tree, name: str, value: float) -> Socket:
    """Make a named value node: the knob a person or a later weather change turns."""
    node = tree.nodes.new("ShaderNodeValue")
    node.name = node.label = name
    node.outputs[0].default_value = value
    return node.outputs[0]


def _weather_group(environment: Environment) -> Tree:
    """Make the group between a dry surface and its shader.

    Cycles folds products with a constant zero, so in dry weather the noise costs nothing.
    """
    inputs = {
        "Color": (0.8, 0.8, 0.8, 1.0), "Roughness": 0.8, "Metallic": 0.0, "Porosity": 0.5,
        "Puddles": 0.0, "Snow cover": 1.0, "Variation": 0.0, "Age": 0.0,
    }  # fmt: skip
    outputs = {"Color": "Color", "Roughness": "Float", "Metallic": "Float"}
    tree, source, sink = _group("CityX Weather", inputs, outputs)
    given = source.outputs
    wetness = _value(tree, "Wetness", environment.wetness)
    snow = _value(tree, "Snow", environment.snow)
    upright = tree.nodes.new("ShaderNodeNewGeometry")
    split = tree.nodes.new("ShaderNodeSeparateXYZ")
    tree.links.new(upright.outputs["Normal"], split.inputs[0])
    up = split.outputs["Z"]

    # Broad patches of slightly other brightness hide the repeat of the tiles.
    patches = _math(tree, "SUBTRACT", _noise(tree, 9.0), 0.5)
    varied = _math(tree, "MULTIPLY", patches, given["Variation"])
    bright = _math(tree, "MULTIPLY_ADD", varied, 0.5, 1.0)
    color = _product(tree, given["Color"], bright)
    dirt = _math(tree, "MULTIPLY", _dirt(tree), given["Age"])
    level_share = _smoothstep(tree, up, 0.3, 0.6)
    dirt = _math(tree, "MULTIPLY", dirt, _math(tree, "SUBTRACT", 1.0, level_share))
    color = _product(tree, color, _math(tree, "SUBTRACT", 1.0, dirt))

    # Rain reaches level surfaces first, walls little.
    reach = _math(tree, "MULTIPLY_ADD", _smoothstep(tree, up, 0.1, 0.8), 0.65, 0.35)
    wet = _math(tree, "MULTIPLY", reach, wetness)
    loss = _math(tree, "MULTIPLY", _math(tree, "MULTIPLY", wet, given["Porosity"]), WET_LOSS)
    color = _product(tree, color, _math(tree, "SUBTRACT", 1.0, loss))
    _, factor, a, b, roughness = _mix(tree, "FLOAT")
    tree.links.new(_math(tree, "MULTIPLY", wet, 0.6), factor)
    tree.links.new(given["Roughness"], a)
    b.default_value = 0.12
    level = _math(tree, "MULTIPLY", _smoothstep(tree, up, 0.97, 0.995), given["Puddles"])
    pools = _math(tree, "MULTIPLY", _smoothstep(tree, _noise(tree, 3.5, 3.0), 0.52, 0.6), level)
    pooled = _math(tree, "MULTIPLY", pools, _smoothstep(tree, wetness, 0.3, 0.9))
    _, factor, a, b, smooth = _mix(tree, "FLOAT")
    tree.links.new(pooled, factor)
    tree.links.new(roughness, a)
    b.default_value = 0.02

    edge = _math(tree, "MULTIPLY_ADD", _noise(tree, 1.2), 0.3, up)
    lying = _math(tree, "MULTIPLY", _smoothstep(tree, edge, 0.62, 0.92), given["Snow cover"])
    white = _math(tree, "MULTIPLY", lying, snow, clamp=True)
    _, factor, a, b, covered = _mix(tree, "RGBA")
    tree.links.new(white, factor)
    tree.links.new(color, a)
    b.default_value = SNOW_COLOR
    _, factor, a, b, rough = _mix(tree, "FLOAT")
    tree.links.new(white, factor)
    tree.links.new(smooth, a)
    b.default_value = 0.65
    bare = _math(tree, "SUBTRACT", 1.0, white)
    metallic = _math(tree, "MULTIPLY", given["Metallic"], bare)
    tree.links.new(covered, sink.inputs["Color"])
    tree.links.new(rough, sink.inputs["Roughness"])
    tree.links.new(metallic, sink.inputs["Metallic"])
    _spread(tree)
    return tree


def _dirt(tree: Tree) -> Socket:
    """Return the share of light that the age of a wall takes, by its metres along and up."""
    place = tree.nodes.new("ShaderNodeUVMap")
    place.uv_map = "UVMap"
    split = tree.nodes.new("ShaderNodeSeparateXYZ")
    tree.links.new(place.outputs["UV"], split.inputs[0])
    blotch = _smoothstep(tree, _noise(tree, 1.6, 4.0), 0.42, 0.7)
    # Streaks run down: noise that is long in height and short along the wall.
    stretch = tree.nodes.new("ShaderNodeCombineXYZ")
    tree.links.new(_math(tree, "MULTIPLY", split.outputs["X"], 1.7), stretch.inputs["X"])
    tree.links.new(_math(tree, "MULTIPLY", split.outputs["Y"], 0.11), stretch.inputs["Y"])
    run = tree.nodes.new("ShaderNodeTexNoise")
    run.inputs["Scale"].default_value = 1.0
    run.inputs["Detail"].default_value = 3.0
    tree.links.new(stretch.outputs[0], run.inputs["Vector"])
    streak = _smoothstep(tree, run.outputs["Fac"], 0.52, 0.74)
    # The edge of the splashes wavers.
    height = _math(tree, "MULTIPLY_ADD", _noise(tree, 0.7, 3.0), -0.9, split.outputs["Y"])
    low = _math(tree, "SUBTRACT", 1.0, _smoothstep(tree, height, -0.4, SPLASH_HEIGHT - 0.4))
    total = _math(tree, "MULTIPLY_ADD", low, SPLASH, _math(tree, "MULTIPLY", blotch, BLOTCH))
    return _math(tree, "MULTIPLY_ADD", streak, STREAK, total)


def _lights_group(environment: Environment) -> Tree:
    """Make the group that decides which rooms are lit, and how bright lamps and rooms are."""
    inputs = {"Seed": 0.0, "Strength": 1.0}
    outputs = {"Lamp": "Float", "Room": "Float", "Room color": "Color"}
    tree, source, sink = _group("CityX Lights", inputs, outputs)
    share = _value(tree, "Share of rooms lit", environment.night_lights)
    lit = _math(tree, "LESS_THAN", source.outputs["Seed"], share)
    on = _math(tree, "GREATER_THAN", share, 0.0)
    # A second number from the same seed: how bright a lit room is, and how warm its lamp.
    white = tree.nodes.new("ShaderNodeTexWhiteNoise")
    white.noise_dimensions = "1D"
    tree.links.new(source.outputs["Seed"], white.inputs["W"])
    bright = _math(tree, "MULTIPLY_ADD", white.outputs["Value"], 0.9, 0.25)
    _, factor, a, b, color = _mix(tree, "RGBA")
    tree.links.new(white.outputs["Value"], factor)
    a.default_value = (1.0, 0.55, 0.24, 1.0)  # about 2700 K
    b.default_value = (1.0, 0.78, 0.52, 1.0)  # about 4000 K
    strength = _math(tree, "MULTIPLY", lit, source.outputs["Strength"])
    tree.links.new(_math(tree, "MULTIPLY", bright, strength), sink.inputs["Room"])
    tree.links.new(_math(tree, "MULTIPLY", on, source.outputs["Strength"]), sink.inputs["Lamp"])
    tree.links.new(color, sink.inputs["Room color"])
    _spread(tree)
    return tree


def _spread(tree: Tree) -> None:
    """Lay the nodes out in order of making, so that a person can read the group."""
    for index, node in enumerate(tree.nodes):
        column, row = divmod(index, 6)
        node.location = np.array([column * 220.0, -row * 190.0])
