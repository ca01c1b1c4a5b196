"""The materials of a city as Blender node trees, made from `cityx.assets.styles.materials`.

All of them run through two node groups (`cityx.blender.weather`) whose values are weather and hour:
changing them in one place wets, whitens or lights the whole city.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from types import MappingProxyType

import bpy

from cityx.assets.styles.materials import (
    DRIVEN,
    FOLIAGE,
    LEAVES,
    MATERIALS,
    PAINTED,
    PUDDLED,
    SNOWLESS,
    Material,
    material_named,
)
from cityx.assets.textures.grounds import SETT_COURSE, SETT_TILE
from cityx.blender import kept_materials, nodes
from cityx.blender.nodes import Socket, Tree
from cityx.blender.weather import INDOORS as WHEN_OPEN
from cityx.blender.weather import LIGHTS, WEATHER, lights_group, weather_group
from cityx.city.rooms import WORK

# Streets of setts: courses shifted along themselves, uneven work, relaid patches.

STRAY, STRAY_SIZE = 0.11, 1.7  # metres by which courses stray, and between their bends
PLOT = (18 * SETT_COURSE, 2.6)  # metres along and across the street in which one patch may lie
PATCHED = 0.86  # of the draws of plots, above which one was dug up
SMALLER = 1.28  # times as many stones lie in a patch, from another delivery
PATCH_TONE = 0.5  # range of the brightness of patches
BLOTCH, BLOTCH_TONE = 1.3, (0.82, 1.18)  # metres between paler and darker spots, and their tones
LOAD = 5.5  # metres between loads of warm and of cold stone
COLD, WARM = (0.94, 0.99, 1.07, 1.0), (1.07, 1.0, 0.90, 1.0)


def laid_setts(tree: Tree, uv: Socket) -> tuple[Socket, Socket]:
    """Return where setts are read from their texture, and the colour that they are tinted with.

    Parameters
    ----------
    tree
        Node tree of the material.
    uv
        Metres along and across the street.
    """
    push = tree.nodes.new("ShaderNodeTexNoise")
    push.inputs["Scale"].default_value = 1 / STRAY_SIZE
    push.inputs["Detail"].default_value = 3.0
    tree.links.new(uv, push.inputs["Vector"])
    centred = nodes.vector(tree, "SUBTRACT", push.outputs["Color"], (0.5, 0.5, 0.5))
    bent = nodes.vector(tree, "MULTIPLY_ADD", centred, (STRAY, STRAY, 0.0), uv)
    along, across, _ = nodes.parts(tree, bent)
    patch, drawn = _patches(tree, along, across)
    size = nodes.math(tree, "MULTIPLY_ADD", patch, SMALLER - 1.0, 1.0)
    along = nodes.math(tree, "MULTIPLY", along, size)
    across = nodes.math(tree, "MULTIPLY", across, size)
    course = _whole(tree, along, SETT_COURSE)
    shift, _ = nodes.white(tree, nodes.math(tree, "MULTIPLY_ADD", patch, 3071.0, course))
    across = nodes.math(tree, "MULTIPLY_ADD", shift, SETT_TILE, across)
    # The other tones of a patch are its own, those of the street change from spot to spot.
    spot = nodes.smoothstep(tree, nodes.noise(tree, BLOTCH, 3.0), 0.3, 0.7)
    low, high = BLOTCH_TONE
    tone = nodes.math(tree, "MULTIPLY_ADD", spot, high - low, low)
    other = nodes.math(tree, "MULTIPLY_ADD", drawn, PATCH_TONE, -PATCH_TONE / 2)
    tone = nodes.math(tree, "MULTIPLY_ADD", patch, other, tone)
    load = nodes.smoothstep(tree, nodes.noise(tree, LOAD, 1.0), 0.35, 0.65)
    return nodes.joined(tree, along, across), nodes.product(
        tree, nodes.mix(tree, load, COLD, WARM), tone
    )


def _whole(tree: Tree, value: Socket, step: float) -> Socket:
    """Return the number of whole steps in a value."""
    return nodes.math(tree, "FLOOR", nodes.math(tree, "DIVIDE", value, step))


def _patches(tree: Tree, along: Socket, across: Socket) -> tuple[Socket, Socket]:
    """Return 1 where setts were taken up and relaid, and a number that each patch draws.

    A patch begins and ends with whole courses; its sides are toothed, as courses are in bond.
    """
    long, wide = PLOT
    course = _whole(tree, along, SETT_COURSE)
    tooth, _ = nodes.white(tree, course)
    across = nodes.math(tree, "MULTIPLY_ADD", tooth, 0.16, across)
    middle = nodes.math(tree, "MULTIPLY", nodes.math(tree, "ADD", course, 0.5), SETT_COURSE)
    row = _whole(tree, middle, long)
    slip, _ = nodes.white(tree, row)
    across = nodes.math(tree, "MULTIPLY_ADD", slip, wide, across)
    plot = nodes.math(tree, "MULTIPLY_ADD", row, 131.7, _whole(tree, across, wide))
    chance, bounds = nodes.white(tree, plot)
    first, second, drawn = nodes.parts(tree, bounds)
    inside = nodes.math(tree, "GREATER_THAN", chance, PATCHED)
    for value, step, draw in ((middle, long, first), (across, wide, second)):
        share = nodes.math(tree, "FRACT", nodes.math(tree, "DIVIDE", value, step))
        after = nodes.math(tree, "GREATER_THAN", share, nodes.math(tree, "MULTIPLY", draw, 0.4))
        end = nodes.math(tree, "MULTIPLY_ADD", draw, 0.4, 0.6)
        before = nodes.math(tree, "LESS_THAN", share, end)
        inside = nodes.math(tree, "MULTIPLY", inside, nodes.math(tree, "MULTIPLY", after, before))
    return inside, drawn


# Materials of outer walls, which weather: splashes above the ground, streaks of rain, blotches.
AGED = frozenset({"plaster", "brick", "stone", "concrete", "wood", "trim"})
# Materials of what is round: their faces are shaded as one curved surface.
ROUND = frozenset({"bark", "bark_smooth", "bark_flaking"})
CLUMP, STAND = 1.6, 11.0  # metres over which the colour of leaves changes, in a crown and beyond
THROUGH = 0.50  # share of the light on a leaf that its other side gives off
CRACKED = frozenset({"asphalt", "asphalt_light"})
# What is dug up and filled again, and the share of the tone of repairs that it shows: setts are the
# same afterwards.
REPAIRED: Mapping[str, float] = MappingProxyType({
    "asphalt": 1.0, "asphalt_light": 1.0, "setts": 0.35, "pale_setts": 0.35, "cobbles": 0.35,
    "paving": 1.0, "flagstones": 1.0, "plaza_slabs": 1.0, "slab_walk": 1.0, "walk_blocks": 1.0,
})  # fmt: skip
SETTS = frozenset({"setts", "pale_setts"})  # whose courses are pushed along themselves
FIELDS = frozenset({"yard"})  # what was laid house by house
GLAZED = frozenset({"glass", "glass_wall", "car_glass", "car_pane"})
GLASS_IOR = 1.9  # a coated double pane mirrors twice as much as plain glass
# From a material's emission to radiance under a camera opened by three stops, as at night.
EMISSION_SCALE = 0.15
# Share of the emission of a lit window that leaves through its curtains.
ROOM_GLOW = 0.3
SIGN_GLOW = 1.6
INDOORS = "room_wall"  # what lamps light by day as well, while shops are open
INDOOR_GLOW = 0.42  # radiance of a white wall there, against that of the sky at noon
# Numbers of instances that tell what signals show: to vehicles one more than the number of their
# state of `cityx.city.signals`, to people 1 for waiting and 2 for walking; 0 where it is not known.
SHOWS, WALKS = "shows", "walks"
# Lights of signals: which number lights them, from and to, and their colour.
BURNING: Mapping[str, tuple[str, float, float, tuple[float, float, float]]] = {
    "signal_stop": (SHOWS, 1.5, 3.5, (1.0, 0.03, 0.02)),
    "signal_amber": (SHOWS, 2.5, 4.5, (1.0, 0.42, 0.02)),
    "signal_green": (SHOWS, 4.5, 6.5, (0.02, 0.85, 0.42)),
    "walk_red": (WALKS, 0.5, 1.5, (1.0, 0.03, 0.02)),
    "walk_green": (WALKS, 1.5, 2.5, (0.02, 0.85, 0.42)),
}
BURNING_DAY, BURNING_NIGHT = 1.6, 2.0  # radiance by day, and emission as of a material by night


class MaterialLibrary:
    """The materials of one scene, each made when it is first asked for.

    A class because materials share images and the weather group of the open file. Those that are
    known to be wanted are read from the cache, where earlier runs have left them.
    """

    def __init__(self, wanted: Iterable[tuple[str, str]] = (), *, textured: bool = True) -> None:
        self.textured = textured
        titles = {_title(material_named(name).name, variant): (name, variant)
                  for name, variant in wanted}  # fmt: skip
        kept = kept_materials.Kept(titles, textured=textured)
        self.weather = bpy.data.node_groups.get(WEATHER) or weather_group()
        self.lights = bpy.data.node_groups.get(LIGHTS) or lights_group()
        self._made: dict[tuple[str, str], bpy.types.Material] = {
            titles[title]: material for title, material in kept.found.items()
        }
        for name, variant in titles.values():
            self.get(name, variant)
        kept.keep()

    def get(self, name: str, variant: str = "") -> bpy.types.Material:
        """Return a material.

        Parameters
        ----------
        name
            Name for `cityx.assets.styles.materials.material_named`.
        variant
            "" for shells; "instance" for prototypes, whose colour is also multiplied by the
            instance's tint; "room" for prototypes that have a room behind their glass; "sign" for
            signs, which shine at night.
        """
        key = (name, variant)
        if key not in self._made:
            self._made[key] = self._make(material_named(name), variant)
        return self._made[key]

    def _make(self, record: Material, variant: str) -> bpy.types.Material:
        material = bpy.data.materials.new(_title(record.name, variant))
        material.use_nodes = True
        material.diffuse_color = (*record.color, record.alpha)
        tree = material.node_tree
        shader = tree.nodes["Principled BSDF"]
        shader.inputs["Alpha"].default_value = record.alpha
        color, roughness, normal = self._surface(tree, record)
        if record.takes_tint:
            color = nodes.product(tree, color, nodes.attribute(tree, "tint").outputs["Color"])
            if variant:
                tint = nodes.attribute(tree, "tint", instance=True)
                color = nodes.product(tree, color, tint.outputs["Color"])
        if record.name in LEAVES:
            color = _uneven_leaves(tree, color)
        if record.root in GLAZED:
            shader.inputs["IOR"].default_value = GLASS_IOR
            color, normal = _panes(tree, color, normal, variant)
        weather = tree.nodes.new("ShaderNodeGroup")
        weather.node_tree = self.weather
        weather.location = (-250, 200)
        nodes.assign(tree, weather.inputs["Color"], color)
        nodes.assign(tree, weather.inputs["Roughness"], roughness)
        given = {
            "Metallic": record.metallic, "Porosity": record.porosity,
            "Puddles": record.root in PUDDLED,
            "Traffic": record.root in DRIVEN and not variant,
            "Cracks": record.root in CRACKED and not variant,
            "Repairs": 0.0 if variant else REPAIRED.get(record.root, 0.0),
            "Paint": record.root in PAINTED and not variant,
            "Fields": record.root in FIELDS and not variant,
            "Snow cover": record.name not in SNOWLESS, "Foliage": record.name in FOLIAGE,
            "Variation": bool(record.texture),
        }  # fmt: skip
        if record.name in AGED and self.textured:
            given["Age"] = 1.0 if not variant else 0.3
        for name, value in given.items():
            nodes.assign(tree, weather.inputs[name], float(value))
        for name in ("Metallic", "Roughness"):
            tree.links.new(weather.outputs[name], shader.inputs[name])
        tree.links.new(weather.outputs["Color"], shader.inputs["Base Color"])
        if record.root in PUDDLED:  # water levels the surface
            plain = tree.nodes.new("ShaderNodeNewGeometry").outputs["Normal"]
            tree.links.new(plain if normal is None else normal, weather.inputs["Normal"])
            normal = weather.outputs["Normal"]
        if normal is not None:
            tree.links.new(normal, shader.inputs["Normal"])
        if record.name == "car_paint":
            shader.inputs["Coat Weight"].default_value = 0.7
        self._emit(material, record, variant, color)
        if record.name in LEAVES:
            _let_light_through(tree, weather.outputs["Color"])
        return material

    def _surface(self, tree: Tree, record: Material) -> tuple[Socket, Socket, Socket]:
        """Colour, roughness and normal of a dry surface; values or sockets."""
        if not (record.texture and self.textured):
            return (*record.color, 1.0), record.roughness, None
        from cityx.assets.textures import texture_files

        maps = texture_files(record.texture)
        loaded = self._load(record.texture, maps.files)
        place = tree.nodes.new("ShaderNodeUVMap")
        place.uv_map = "UVMap"
        scale = tree.nodes.new("ShaderNodeMapping")
        scale.inputs["Scale"].default_value = (1 / record.tile, 1 / record.tile, 1.0)
        read, hue = place.outputs["UV"], None
        if record.root in SETTS:
            read, hue = laid_setts(tree, read)
        tree.links.new(read, scale.inputs["Vector"])
        images = {}
        for row, (name, image) in enumerate(loaded.items()):
            node = images[name] = tree.nodes.new("ShaderNodeTexImage")
            node.image = image
            node.location = (-1100, 400 - 300 * row)
            tree.links.new(scale.outputs["Vector"], node.inputs["Vector"])
        place.location, scale.location = (-1600, 200), (-1400, 200)
        base = tuple(min(1.0, channel / maps.mean) for channel in record.color)
        color = nodes.product(tree, images["color"].outputs["Color"], (*base, 1.0))
        if hue is not None:
            color = nodes.product(tree, color, hue)
        factor = tree.nodes.new("ShaderNodeMath")
        factor.operation = "MULTIPLY"
        factor.inputs[1].default_value = min(1.0, record.roughness / maps.roughness_mean)
        factor.use_clamp = True
        tree.links.new(images["roughness"].outputs["Color"], factor.inputs[0])
        bend = tree.nodes.new("ShaderNodeNormalMap")
        bend.uv_map = "UVMap"
        bend.location = (-700, -300)
        tree.links.new(images["normal"].outputs["Color"], bend.inputs["Color"])
        return color, factor.outputs[0], bend.outputs["Normal"]

    def _load(self, name: str, files: Mapping[str, bytes]) -> dict[str, bpy.types.Image]:
        """Pack a texture's files, which is 20 times faster than to pack pixels."""
        return {
            part: bpy.data.images.get(f"{name}_{part}")
            or _packed(f"{name}_{part}", data, "sRGB" if part == "color" else "Non-Color")
            for part, data in files.items()
        }

    def _emit(
        self, material: bpy.types.Material, record: Material, variant: str, color: Socket
    ) -> None:
        """Let lamps, lit windows, rooms and signs glow as the group "CityX Lights" says."""
        if record.name == INDOORS:
            tree = material.node_tree
            shader = tree.nodes["Principled BSDF"]
            nodes.assign(tree, shader.inputs["Emission Color"], color)
            lights = tree.nodes.new("ShaderNodeGroup")
            lights.node_tree = self.lights
            lights.inputs["Strength"].default_value = INDOOR_GLOW
            tree.links.new(lights.outputs[WHEN_OPEN], shader.inputs["Emission Strength"])
            material.cycles.emission_sampling = "NONE"
            return
        if record.name in BURNING and variant:
            self._burn(material, record)
            return
        room = record.name == "glass" and variant == "room"
        wall = record.root == "glass_wall"
        sign = record.name == "sign" and variant == "sign"
        if not record.emission and not room and not wall and not sign:
            return
        tree = material.node_tree
        shader = tree.nodes["Principled BSDF"]
        lights = tree.nodes.new("ShaderNodeGroup")
        lights.node_tree = self.lights
        lights.location = (-250, -300)
        glow = record.emission or (SIGN_GLOW if sign else MATERIALS["window_lit"].emission)
        strength: Socket = glow * EMISSION_SCALE * (ROOM_GLOW if room or wall else 1.0)
        if room:
            for name in ("seed", "use"):
                given = nodes.attribute(tree, name, instance=True)
                tree.links.new(given.outputs["Fac"], lights.inputs[name.capitalize()])
            seed = lights.inputs["Seed"].links[0].from_socket
            strength = nodes.math(tree, "MULTIPLY", _room_depth(tree, seed), strength)
        elif wall:
            tree.links.new(_cell_noise(tree), lights.inputs["Seed"])
            lights.inputs["Use"].default_value = float(WORK)
        nodes.assign(tree, lights.inputs["Strength"], strength)
        shader.inputs["Emission Color"].default_value = (*record.color, 1.0)
        if room or wall:
            tree.links.new(lights.outputs["Room color"], shader.inputs["Emission Color"])
        elif sign:
            nodes.assign(tree, shader.inputs["Emission Color"], color)
        output = "Room" if room or wall else "Lamp"
        tree.links.new(lights.outputs[output], shader.inputs["Emission Strength"])
        # Thousands of panes as light sources would swamp the light tree; lamps near the camera
        # get real lights instead (`cityx.blender.sky`).
        material.cycles.emission_sampling = "NONE"

    def _burn(self, material: bpy.types.Material, record: Material) -> None:
        """Let a light of a signal burn while its instance shows it, by day as well."""
        name, low, high, color = BURNING[record.name]
        tree = material.node_tree
        shader = tree.nodes["Principled BSDF"]
        lights = tree.nodes.new("ShaderNodeGroup")
        lights.node_tree = self.lights
        lights.inputs["Strength"].default_value = BURNING_NIGHT * EMISSION_SCALE
        night = lights.outputs["Lamp"]
        by_day = nodes.math(tree, "LESS_THAN", night, 1e-6)
        glow = nodes.math(tree, "MULTIPLY_ADD", by_day, BURNING_DAY, night)
        given = nodes.attribute(tree, name, instance=True).outputs["Fac"]
        on = nodes.math(tree, "GREATER_THAN", given, low)
        on = nodes.math(tree, "MULTIPLY", on, nodes.math(tree, "LESS_THAN", given, high))
        strength = nodes.math(tree, "MULTIPLY", on, glow)
        if record.emission:  # what burns where nothing is known
            unknown = nodes.math(tree, "LESS_THAN", given, 0.5)
            strength = nodes.math(tree, "MULTIPLY_ADD", unknown, glow, strength)
        shader.inputs["Emission Color"].default_value = (*color, 1.0)
        tree.links.new(strength, shader.inputs["Emission Strength"])
        material.cycles.emission_sampling = "NONE"


def _title(name: str, variant: str) -> str:
    return f"{name}.{variant}" if variant else name


def _packed(name: str, data: bytes, space: str) -> bpy.types.Image:
    image = bpy.data.images.new(name, 8, 8)
    image.source = "FILE"
    image.filepath_raw = kept_materials.image_path(name)
    image.pack(data=data, data_len=len(data))
    image.colorspace_settings.name = space
    return image


# --- surfaces ------------------------------------------------------------------------------------


def _room_depth(tree: Tree, seed: Socket) -> Socket:
    """Return how bright each spot of a lit pane is, about 1: a lamp above, curtains at some."""
    place = tree.nodes.new("ShaderNodeTexCoord").outputs["Generated"]
    across, _, high = nodes.parts(tree, place)
    ceiling = nodes.math(tree, "MULTIPLY_ADD", nodes.smoothstep(tree, high, 0.0, 0.85), 0.8, 0.45)
    aside = nodes.math(tree, "ABSOLUTE", nodes.math(tree, "SUBTRACT", across, 0.5))
    _, drawn = nodes.white(tree, nodes.math(tree, "ADD", seed, 7.0))
    has_curtains, wide, _ = nodes.parts(tree, drawn)
    edge = nodes.math(tree, "MULTIPLY_ADD", wide, 0.25, 0.1)
    curtain = nodes.smoothstep(tree, nodes.math(tree, "SUBTRACT", aside, edge), -0.02, 0.02)
    drawn_shut = nodes.math(tree, "GREATER_THAN", has_curtains, 0.45)
    hidden = nodes.math(tree, "MULTIPLY", curtain, drawn_shut)
    return nodes.math(
        tree, "MULTIPLY", ceiling, nodes.math(tree, "MULTIPLY_ADD", hidden, -0.6, 1.0)
    )


def _cell_noise(tree: Tree) -> Socket:
    """One number per pane of a curtain wall."""
    tile = (MATERIALS["glass_wall"].tile,) * 3
    drawn = tree.nodes.new("ShaderNodeTexWhiteNoise")
    drawn.noise_dimensions = "2D"
    tree.links.new(nodes.vector(tree, "SNAP", nodes.uv(tree), tile), drawn.inputs["Vector"])
    return drawn.outputs["Value"]


def _panes(tree: Tree, color: Socket, normal: Socket, variant: str) -> tuple[Socket, Socket]:
    """Give each pane of an instance its own darkness and a hair of tilt: no two mirror alike."""
    if variant != "room":
        return color, normal
    seed = nodes.attribute(tree, "seed", instance=True)
    value, drawn = nodes.white(tree, seed.outputs["Fac"])
    # Most rooms are dark behind the glass, some have pale curtains.
    pale = nodes.math(tree, "MULTIPLY", nodes.smoothstep(tree, value, 0.55, 1.0), 0.55)
    color = nodes.mix(tree, pale, color, (0.36, 0.34, 0.30, 1.0))
    upright = tree.nodes.new("ShaderNodeNewGeometry").outputs["Normal"]
    shifted = nodes.vector(tree, "ADD", upright, (-0.01, -0.01, -0.01))
    tilted = nodes.vector(tree, "MULTIPLY_ADD", drawn, (0.02, 0.02, 0.02), shifted)
    return color, nodes.vector(tree, "NORMALIZE", tilted)


def _uneven_leaves(tree: Tree, color: Socket) -> Socket:
    """Let branches and whole trees differ: some are paler and more yellow, some deep and bluish."""
    pale = nodes.smoothstep(tree, nodes.noise(tree, CLUMP, 1.0), 0.30, 0.70)
    tone = nodes.math(tree, "MULTIPLY_ADD", pale, 0.50, 0.76)
    warm = nodes.smoothstep(tree, nodes.noise(tree, STAND, 1.0), 0.30, 0.70)
    hue = nodes.mix(tree, warm, (0.84, 0.95, 1.10, 1.0), (1.12, 1.03, 0.86, 1.0))
    return nodes.product(tree, nodes.product(tree, color, hue), tone)


def _let_light_through(tree: Tree, color: Socket) -> None:
    """Leaves are thin: a good part of the light comes out at the other side."""
    shader = tree.nodes["Principled BSDF"]
    through = tree.nodes.new("ShaderNodeBsdfTranslucent")
    through.location = (0, -650)
    tree.links.new(nodes.product(tree, color, (1.5, 1.6, 0.66, 1.0)), through.inputs["Color"])
    both = tree.nodes.new("ShaderNodeMixShader")
    both.location = (300, 300)
    both.inputs[0].default_value = THROUGH
    tree.links.new(shader.outputs[0], both.inputs[1])
    tree.links.new(through.outputs[0], both.inputs[2])
    sink = tree.nodes["Material Output"]
    sink.location = (500, 300)
    tree.links.new(both.outputs[0], sink.inputs["Surface"])
