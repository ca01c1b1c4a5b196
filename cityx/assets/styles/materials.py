"""Materials of a city and their states: one table, read by every view and by physics engines.

A material is a tileable texture in metres (`cityx.assets.textures`), a base colour and a few
numbers of the metallic-roughness model, so that Blender, glTF and USD show the same surface.

A state is a material like those of the table, and its name says all of it, so every view makes the
same surface from the name alone: ``asphalt_a2w3r0`` is asphalt half bleached, worn, and dry.

Densities and friction are those of handbooks, rounded: dry surfaces against concrete or asphalt.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from types import MappingProxyType

import numpy as np

from cityx.geometry.arrays import FloatArray
from cityx.system.tables import table

STEPS = 4  # of age, wear and wetness from 0 to 1: few states, so that streets share materials
_NAME = re.compile(rf"([a-z_]+)_a([0-{STEPS}])w([0-{STEPS}])r([0-{STEPS}])")


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
PAINTED = frozenset({"marking_white", "marking_yellow", "marking_blue"})
DRIVEN = CARRIAGEWAYS | PAINTED  # where tyres press snow to slush
# Materials of level ground, where rain stands in puddles.
PUDDLED = frozenset(
    {"asphalt", "asphalt_light", "setts", "pale_setts", "small_setts", "gutter_stones",
     "gutter_slabs", "paving", "concrete", "bitumen", "pitch", "soil",
     "cobbles", "clinker", "pavers", "yard", "road_concrete", "flagstones", "mosaic", "slab_walk",
     "plaza_slabs", "walk_blocks", "guided_blocks", "tactile_yellow", "tactile_pale",
     "tactile_buff", "tactile_red"}
)  # fmt: skip
LEAVES = frozenset({"leaf", "foliage"})
FOLIAGE = LEAVES | {"hedge"}  # what catches snow at any slope
# What no snow lies on: water, and panes that are warm from inside.
SNOWLESS = frozenset({"water", "glass", "pane", "window_lit", "lamp_glow"})


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


def oklab(linear: FloatArray) -> FloatArray:
    """Return (n, 3) linear RGB in OKLab, where distances are those that one sees.

    References
    ----------
    Ottosson, "A perceptual color space for image processing", 2020.
    """
    return np.asarray(np.cbrt(np.clip(linear @ _TO_CONES.T, 0.0, None)) @ _TO_AXES.T)


_TO_CONES = np.array([[0.4122214708, 0.5363325363, 0.0514459929],
                      [0.2119034982, 0.6806995451, 0.1073969566],
                      [0.0883024619, 0.2817188376, 0.6299787005]])  # fmt: skip
_TO_AXES = np.array([[0.2104542553, 0.7936177850, -0.0040720468],
                     [1.9779984951, -2.4285922050, 0.4505937099],
                     [0.0259040371, 0.7827717662, -0.8086757660]])  # fmt: skip


@dataclass(frozen=True)
class Ageing:
    """How a surface changes.

    Attributes
    ----------
    fresh, old
        Factors on the colour when new and after decades: asphalt bleaches, concrete and stone
        darken.
    polish
        Share of the roughness that tyres take off.
    worn
        Pattern from half worn on, "" where it stays.
    """

    fresh: float
    old: float
    polish: float
    worn: str = ""


AGEING = table("assets/ageing", Ageing)


def state_of(family: str, *, age: float, wear: float, wetness: float = 0.0) -> str:
    """Return the name of a state.

    Parameters
    ----------
    family
        Key of `AGEING`.
    age, wear, wetness
        0 to 1, rounded to quarters.
    """
    a, w, r = (round(STEPS * min(max(value, 0.0), 1.0)) for value in (age, wear, wetness))
    return f"{family}_a{a}w{w}r{r}"


@lru_cache(maxsize=1024)
def material_named(name: str) -> Material:
    """Return a material of the table, a state of one, or a grey one under an unknown name."""
    match = _NAME.fullmatch(name)
    if name in MATERIALS or match is None or match[1] not in AGEING:
        return MATERIALS.get(name) or Material(name, (0.5, 0.5, 0.5))
    family, ageing = MATERIALS[match[1]], AGEING[match[1]]
    age, wear, wetness = (int(step) / STEPS for step in match.groups()[1:])
    factor = ageing.fresh + (ageing.old - ageing.fresh) * age
    red, green, blue = (min(1.0, factor * channel) for channel in family.color)
    aged = replace(
        family,
        name=name,
        family=family.name,
        color=(red, green, blue),
        roughness=family.roughness * (1.0 - ageing.polish * wear),
        texture=ageing.worn if ageing.worn and wear >= 0.5 else family.texture,
    )
    color, roughness = wet_look(aged, wetness)
    return replace(aged, color=color, roughness=roughness)


@dataclass(frozen=True)
class Substance:
    """A material by weight and touch.

    Attributes
    ----------
    density
        Kilograms per cubic metre.
    wall
        Metres: how thick what is made of it is at most. Posts, bins and bodies of cars are hollow.
    friction
        Coefficient of Coulomb.
    restitution
        Share of the speed that is left after a bounce.
    """

    density: float
    wall: float
    friction: float
    restitution: float


@dataclass(frozen=True)
class _Row(Substance):
    """A substance and the materials that are made of it."""

    of: tuple[str, ...]


_ROWS = table("assets/substances", _Row, "substances")
SUBSTANCES: Mapping[str, Substance] = MappingProxyType(
    {
        name: Substance(row.density, row.wall, row.friction, row.restitution)
        for row in _ROWS.values()
        for name in row.of
    }
)


def substance(material: str) -> Substance:
    """Return the substance of a material, or of the one it is a state of; concrete if unknown."""
    return SUBSTANCES.get(material_named(material).root, SUBSTANCES["concrete"])


# Kerb weights, kilograms, of what holds more than its skin shows.
WEIGHTS = table("assets/substances", float, "weights")
VEHICLE_DENSITY = 180.0  # kilograms per cubic metre of collider, of vehicles that are not named
BUILDING_DENSITY = 350.0  # kilograms per cubic metre of a building, storeys and all
# Kilograms of what moves by itself, with who rides it.
MOVER_WEIGHTS = table("assets/substances", float, "mover_weights")

# Semantic class of pieces by how their names begin; others are a class of their own name.
CLASSES = table("assets/substances", str, "classes")
# Pieces that stand by their weight alone. Bicycles are locked, boats moored, posts set in concrete.
LOOSE = frozenset(
    {"bench", "bin", "litter_bin", "planter", "cafe_set", "shop_board", "picnic_table", "boulder",
     "traffic_cone", "work_barrier", "vending_machine", "fruit_stand", "flower_stand",
     "clothes_rail", "cartons"}
)  # fmt: skip
# A box each: what hangs on a post in the ground would fall over without it.
UPRIGHT = frozenset({"litter_bin"})
