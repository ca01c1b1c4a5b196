"""The materials of a city: one table, read by every view.

A material is a tileable texture in metres (`cityx.assets.textures`), a base colour and a few
numbers of the metallic-roughness model, so that Blender, glTF and USD show the same surface.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from cityx.system.tables import table


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


# Walls and roofs are near white where a tint is expected, so that the building decides.
MATERIALS = table("assets/materials", Material)


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
