"""The materials of a city: one table, read by every view.

A material is a tileable texture in metres (`cityx.assets.textures`), a base colour and a few
numbers of the metallic-roughness model, so that Blender, glTF and USD show the same surface.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType


@dataclass(frozen=True)
class Material:
    """A physically based material.

    Attributes
    ----------
    name
        Unique name.
    color
        Linear RGB base colour; the texture's mean is neutral, so this is what one sees from afar.
    roughness, metallic
        Of the metallic-roughness model.
    texture
        Pattern of `cityx.assets.textures`, or "" for none.
    tile
        Edge of one texture tile in metres.
    takes_tint
        Whether the tint of faces and instances multiplies the colour.
    emission
        Watts per square metre and steradian-like strength at night; 0 for most.
    alpha
        Opacity, 1 for solid.
    porosity
        0 to 1, how much rain darkens it.
    family
        Material of the table that this is a state of, "" for those of the table.
    """

    name: str
    color: tuple[float, float, float]
    roughness: float = 0.8
    metallic: float = 0.0
    texture: str = ""
    tile: float = 1.0
    takes_tint: bool = True
    emission: float = 0.0
    alpha: float = 1.0
    porosity: float = 0.5
    family: str = ""

    @property
    def root(self) -> str:
        """Name in the table: its own, or that of the material it is a state of."""
        return self.family or self.name


# Water darkens a porous surface to this share at most (Lekner and Dorf 1988 measure 0.5 to 0.7).
_WETTEST = 0.55
_FILM_ROUGHNESS = 0.12  # of a closed film of water
# Of the ground that vehicles drive on, where tyres press snow to slush.
CARRIAGEWAYS = frozenset(
    {"asphalt", "asphalt_brown", "setts", "pale_setts", "small_setts", "gutter_stones",
     "gutter_slabs", "cobbles", "clinker", "pavers", "road_concrete"}
)  # fmt: skip


def wet_look(material: Material, wetness: float) -> tuple[tuple[float, float, float], float]:
    """Return the colour and the roughness of a surface on which rain has fallen, 0 to 1."""
    darker = 1 - (1 - _WETTEST) * wetness * material.porosity
    red, green, blue = (channel * darker for channel in material.color)
    smoother = (_FILM_ROUGHNESS - material.roughness) * 0.6 * wetness
    return (red, green, blue), material.roughness + smoother


def _table(*materials: Material) -> Mapping[str, Material]:
    return MappingProxyType({material.name: material for material in materials})


_M = Material
# Walls and roofs are near white where a tint is expected, so that the building decides.
MATERIALS: Mapping[str, Material] = _table(
    # walls
    _M("plaster", (0.80, 0.80, 0.80), 0.9, texture="plaster", tile=3.0, porosity=0.6),
    _M("brick", (0.80, 0.80, 0.80), 0.85, texture="brick", tile=2.0, porosity=0.7),
    _M("stone", (0.75, 0.75, 0.75), 0.8, texture="ashlar", tile=3.6, porosity=0.5),
    _M("concrete", (0.55, 0.55, 0.54), 0.85, texture="concrete", tile=4.0, porosity=0.6),
    _M("wood", (0.70, 0.70, 0.70), 0.75, texture="boards", tile=2.4, porosity=0.6),
    _M("metal_panel", (0.70, 0.70, 0.72), 0.4, 0.6, texture="panels", tile=4.0, porosity=0.0),
    _M("glass_wall", (0.10, 0.13, 0.15), 0.08, 0.3, texture="curtain", tile=14.0, porosity=0.0),
    # roofs
    _M("roof_tiles", (0.80, 0.80, 0.80), 0.8, texture="roof_tiles", tile=2.0, porosity=0.6),
    _M("slate", (0.75, 0.75, 0.75), 0.6, texture="slate", tile=2.0, porosity=0.2),
    _M("roof_metal", (0.70, 0.70, 0.70), 0.45, 0.5, texture="seams", tile=2.4, porosity=0.0),
    _M("copper", (0.25, 0.50, 0.42), 0.6, 0.2, texture="seams", tile=2.4, porosity=0.0),
    _M("bitumen", (0.75, 0.75, 0.75), 0.95, texture="felt", tile=4.0, porosity=0.3),
    _M("roof_gravel", (0.45, 0.44, 0.42), 0.95, texture="gravel", tile=2.0, porosity=0.5),
    _M("thatch", (0.35, 0.27, 0.15), 0.95, texture="thatch", tile=2.0, porosity=0.7),
    # ground
    _M("asphalt", (0.086, 0.086, 0.0885), 0.88, texture="asphalt", tile=4.0, porosity=0.4),
    _M("asphalt_light", (0.16, 0.155, 0.15), 0.9, texture="asphalt", tile=3.0, porosity=0.4),
    _M("asphalt_red", (0.20, 0.06, 0.045), 0.9, texture="asphalt", tile=3.0, porosity=0.4),
    _M("asphalt_brown", (0.235, 0.115, 0.080), 0.9, texture="asphalt", tile=3.0, porosity=0.4),
    _M("setts", (0.205, 0.196, 0.186), 0.86, texture="setts", tile=4.0, porosity=0.4),
    _M("pale_setts", (0.315, 0.305, 0.288), 0.86, texture="setts", tile=4.0, porosity=0.4),
    _M("small_setts", (0.138, 0.131, 0.124), 0.8, texture="mosaic", tile=3.84, porosity=0.4),
    _M("gutter_stones", (0.265, 0.258, 0.245), 0.75, texture="gutter_stones", tile=2.56,
       porosity=0.4),
    _M("gutter_slabs", (0.30, 0.295, 0.28), 0.85, texture="gutter_slabs", tile=2.4, porosity=0.5),
    _M("cobbles", (0.20, 0.19, 0.17), 0.75, texture="cobbles", tile=2.0, porosity=0.4),
    _M("clinker", (0.21, 0.115, 0.085), 0.85, texture="clinker", tile=2.0, porosity=0.6),
    _M("pavers", (0.28, 0.275, 0.26), 0.88, texture="clinker", tile=2.0, porosity=0.5),
    _M("road_concrete", (0.34, 0.335, 0.315), 0.88, texture="road_slabs", tile=8.0, porosity=0.5),
    _M("paving", (0.265, 0.257, 0.24), 0.85, texture="paving", tile=2.4, porosity=0.5),
    _M("plaza_slabs", (0.300, 0.274, 0.235), 0.85, texture="plaza_slabs", tile=7.2, porosity=0.5),
    _M("flagstones", (0.290, 0.268, 0.232), 0.82, texture="flagstones", tile=4.8, porosity=0.6),
    _M("mosaic", (0.165, 0.160, 0.155), 0.8, texture="mosaic", tile=2.56, porosity=0.4),
    _M("slab_walk", (0.235, 0.230, 0.222), 0.82, texture="slab_walk", tile=5.12, porosity=0.4),
    _M("walk_blocks", (0.268, 0.243, 0.204), 0.88, texture="walk_blocks", tile=3.0, porosity=0.5),
    _M("guided_blocks", (0.272, 0.245, 0.200), 0.88, texture="guided_blocks", tile=6.0,
       porosity=0.5),
    # Small blocks, a little darker than the slabs of walks: a plot ends where the walk begins.
    _M("yard", (0.158, 0.150, 0.138), 0.88, texture="clinker", tile=2.0, porosity=0.5),
    _M("kerb_stone", (0.345, 0.338, 0.322), 0.8, texture="concrete", tile=2.0, porosity=0.4),
    _M("tactile_yellow", (0.63, 0.385, 0.045), 0.8, texture="domes", tile=1.2, porosity=0.3),
    _M("tactile_pale", (0.43, 0.425, 0.41), 0.8, texture="ribbed_slabs", tile=1.2, porosity=0.4),
    _M("tactile_buff", (0.52, 0.405, 0.235), 0.85, texture="blisters", tile=1.2, porosity=0.4),
    _M("tactile_red", (0.30, 0.070, 0.050), 0.85, texture="blisters", tile=1.2, porosity=0.4),
    _M("marking_white", (0.70, 0.70, 0.68), 0.7, texture="paint", tile=2.0, porosity=0.1),
    _M("marking_yellow", (0.70, 0.42, 0.05), 0.7, texture="paint", tile=2.0, porosity=0.1),
    _M("marking_blue", (0.050, 0.125, 0.235), 0.7, texture="paint", tile=2.0, porosity=0.1),
    _M("grass", (0.075, 0.125, 0.032), 0.95, texture="grass", tile=6.0, porosity=0.3),
    _M("meadow", (0.12, 0.15, 0.045), 0.95, texture="grass", tile=8.0, porosity=0.3),
    _M("forest_floor", (0.060, 0.065, 0.028), 0.95, texture="soil", tile=5.0, porosity=0.6),
    _M("farmland", (0.20, 0.16, 0.075), 0.95, texture="furrows", tile=8.0, porosity=0.6),
    _M("soil", (0.17, 0.125, 0.08), 0.95, texture="soil", tile=4.0, porosity=0.8),
    _M("sand", (0.50, 0.42, 0.28), 0.95, texture="soil", tile=4.0, porosity=0.8),
    _M("gravel", (0.33, 0.31, 0.28), 0.95, texture="gravel", tile=2.0, porosity=0.5),
    _M("pitch", (0.10, 0.18, 0.07), 0.9, texture="grass", tile=6.0, porosity=0.3),
    _M("rail_ballast", (0.20, 0.18, 0.16), 0.95, texture="gravel", tile=2.0, porosity=0.5),
    _M("rail_steel", (0.35, 0.33, 0.31), 0.35, 0.9, porosity=0.0),
    _M("water", (0.020, 0.045, 0.050), 0.06, texture="ripples", tile=12.0, takes_tint=False,
       porosity=0.0),
    # things
    _M("glass", (0.030, 0.040, 0.045), 0.04, 0.1, takes_tint=False, porosity=0.0),
    _M("pane", (0.030, 0.040, 0.045), 0.03, takes_tint=False, alpha=0.30, porosity=0.0),
    # Steps and jambs of doors, which the colour of the door must not tint.
    _M("step_stone", (0.42, 0.41, 0.38), 0.85, texture="concrete", tile=2.0, takes_tint=False),
    _M("curtain", (0.70, 0.68, 0.62), 0.9, takes_tint=False, porosity=0.0),
    # Goods in shop windows, which the colour of the shop must not tint.
    _M("ware_cream", (0.72, 0.69, 0.60), 0.5, takes_tint=False, porosity=0.0),
    _M("ware_red", (0.55, 0.14, 0.09), 0.4, takes_tint=False, porosity=0.0),
    _M("ware_ochre", (0.66, 0.46, 0.14), 0.5, takes_tint=False, porosity=0.0),
    _M("ware_blue", (0.16, 0.28, 0.42), 0.4, takes_tint=False, porosity=0.0),
    _M("ware_green", (0.20, 0.34, 0.20), 0.4, takes_tint=False, porosity=0.0),
    # Walls and ceilings of shops, which lamps light by day as well (`cityx.blender.materials`).
    _M("room_wall", (0.80, 0.80, 0.80), 0.9, porosity=0.0),
    _M("window_lit", (0.60, 0.45, 0.25), 0.5, emission=6.0, porosity=0.0),
    _M("frame_paint", (0.80, 0.80, 0.80), 0.5, porosity=0.0),
    _M("door_paint", (0.80, 0.80, 0.80), 0.45, porosity=0.0),
    _M("trim", (0.75, 0.74, 0.70), 0.85, texture="plaster", tile=3.0, porosity=0.5),
    _M("sign", (0.80, 0.80, 0.80), 0.5, porosity=0.0),
    _M("cloth", (0.80, 0.80, 0.80), 0.9, porosity=0.6),
    _M("leather", (0.80, 0.80, 0.80), 0.45, porosity=0.1),
    _M("skin", (0.80, 0.80, 0.80), 0.55, porosity=0.0),
    _M("hair", (0.80, 0.80, 0.80), 0.65, porosity=0.3),
    _M("metal_dark", (0.045, 0.048, 0.05), 0.5, 0.6, takes_tint=False, porosity=0.0),
    _M("metal_grey", (0.40, 0.41, 0.42), 0.4, 0.8, takes_tint=False, porosity=0.0),
    _M("bench_wood", (0.26, 0.15, 0.075), 0.7, texture="boards", tile=1.2, porosity=0.5),
    _M("bark", (0.130, 0.106, 0.082), 0.95, texture="bark", tile=1.0, porosity=0.6),
    # Bark of birches, planes and cherries, as pale as a birch's where the tint is 1.
    _M("bark_smooth", (0.62, 0.60, 0.56), 0.85, texture="bark_smooth", tile=1.0, porosity=0.4),
    _M("bark_flaking", (0.27, 0.25, 0.19), 0.85, texture="bark_flaking", tile=1.0, porosity=0.5),
    _M("leaf", (0.095, 0.17, 0.035), 0.75, porosity=0.0),
    # Leaves of trees; near white, so that the tint of the season is their colour.
    _M("foliage", (0.80, 0.80, 0.80), 0.62, porosity=0.0),
    _M("hedge", (0.06, 0.115, 0.028), 0.9, texture="grass", tile=2.0, porosity=0.0),
    _M("car_paint", (0.80, 0.80, 0.80), 0.25, 0.2, porosity=0.0),
    _M("car_glass", (0.015, 0.018, 0.02), 0.05, 0.0, takes_tint=False, porosity=0.0),
    _M("car_pane", (0.012, 0.015, 0.017), 0.03, 0.0, takes_tint=False, alpha=0.6, porosity=0.0),
    # Seats and the insides of doors.
    _M("car_trim", (0.055, 0.055, 0.058), 0.85, takes_tint=False, porosity=0.0),
    # Lamps and plates of vehicles, which the paint of their bodies does not dye.
    _M("lens_white", (0.64, 0.64, 0.64), 0.3, takes_tint=False, porosity=0.0),
    _M("lens_red", (0.36, 0.010, 0.010), 0.3, takes_tint=False, porosity=0.0),
    _M("lens_amber", (0.68, 0.24, 0.024), 0.3, takes_tint=False, porosity=0.0),
    _M("plate_white", (0.64, 0.64, 0.62), 0.4, takes_tint=False, porosity=0.0),
    _M("plate_yellow", (0.76, 0.48, 0.03), 0.4, takes_tint=False, porosity=0.0),
    _M("plate_blue", (0.008, 0.048, 0.34), 0.4, takes_tint=False, porosity=0.0),
    _M("plate_green", (0.0, 0.12, 0.055), 0.4, takes_tint=False, porosity=0.0),
    _M("rubber", (0.02, 0.02, 0.02), 0.9, takes_tint=False, porosity=0.0),
    _M("lamp_glow", (0.90, 0.85, 0.75), 0.5, takes_tint=False, emission=30.0, porosity=0.0),
    _M("signal_red", (0.60, 0.02, 0.02), 0.4, takes_tint=False, emission=2.0, porosity=0.0),
    # Lights that burn only while something is shown; what walkers see has lights of its own.
    _M("signal_stop", (0.30, 0.01, 0.01), 0.4, takes_tint=False, emission=4.0, porosity=0.0),
    _M("signal_amber", (0.25, 0.17, 0.01), 0.4, takes_tint=False, porosity=0.0),
    _M("signal_green", (0.01, 0.16, 0.10), 0.4, takes_tint=False, porosity=0.0),
    _M("walk_red", (0.30, 0.01, 0.01), 0.4, takes_tint=False, emission=4.0, porosity=0.0),
    _M("walk_green", (0.01, 0.14, 0.09), 0.4, takes_tint=False, porosity=0.0),
    # Gas in tubes: neon itself, and argon with mercury over phosphors of several colours.
    _M("neon_red", (1.0, 0.06, 0.02), 0.4, takes_tint=False, emission=12.0, porosity=0.0),
    _M("neon_amber", (1.0, 0.32, 0.02), 0.4, takes_tint=False, emission=12.0, porosity=0.0),
    _M("neon_green", (0.06, 1.0, 0.20), 0.4, takes_tint=False, emission=9.0, porosity=0.0),
    _M("neon_cyan", (0.03, 0.70, 1.0), 0.4, takes_tint=False, emission=10.0, porosity=0.0),
    _M("neon_blue", (0.04, 0.12, 1.0), 0.4, takes_tint=False, emission=14.0, porosity=0.0),
    _M("neon_violet", (0.45, 0.06, 1.0), 0.4, takes_tint=False, emission=12.0, porosity=0.0),
    _M("neon_pink", (1.0, 0.05, 0.38), 0.4, takes_tint=False, emission=12.0, porosity=0.0),
    _M("plastic", (0.80, 0.80, 0.80), 0.5, porosity=0.0),
)  # fmt: skip


def srgb_to_linear(color: int) -> tuple[float, float, float]:
    """Return linear RGB of an sRGB color written 0xRRGGBB."""
    channels = ((color >> 16) & 255, (color >> 8) & 255, color & 255)
    red, green, blue = (
        value / 255 / 12.92 if value <= 10 else ((value / 255 + 0.055) / 1.055) ** 2.4
        for value in channels
    )
    return red, green, blue


def linear_to_srgb(color: Sequence[float]) -> int:
    """Return the nearest sRGB color, 0xRRGGBB, to linear RGB."""
    number = 0
    for value in color:
        held = min(max(float(value), 0.0), 1.0)
        curve = 12.92 * held if held <= 0.0031308 else 1.055 * held ** (1 / 2.4) - 0.055
        number = number << 8 | round(255 * curve)
    return number
