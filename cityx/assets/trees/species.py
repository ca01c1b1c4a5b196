"""The species of trees: size, habit, leaves, bark and the colours of the year.

Sizes are of grown street and park trees; silhouettes, phyllotaxis and autumn colours follow the
field guides.

References
----------
Mitchell, "A field guide to the trees of Britain and northern Europe", 1974.
Gilman and Watson, fact sheets ST-1 to ST-680, University of Florida, 1993 (warm climates).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import lru_cache
from types import MappingProxyType

from cityx.errors import UsageError
from cityx.system.extensions import extensions

Color = tuple[float, float, float]
SEASONS = ("spring", "summer", "autumn", "winter")
STREET_CLEAR = 5.0  # metres of clear stem of a tree grown beside a carriageway
PARK_FORMS = STREET_FORMS = 3  # individuals of each
# The first individuals of the streets again, as they grow beside a wall; numbers from here on.
WALLED, WALLED_FORMS = PARK_FORMS + STREET_FORMS, 2

# Linear reflectance of leaves in full light.
GREEN: Color = (0.082, 0.162, 0.042)
YELLOW: Color = (0.40, 0.34, 0.020)
GOLD: Color = (0.60, 0.48, 0.006)
ORANGE: Color = (0.42, 0.15, 0.012)
RED: Color = (0.32, 0.028, 0.012)
RUSSET: Color = (0.23, 0.115, 0.025)
OLD_GREEN: Color = (0.19, 0.23, 0.025)
PINK: Color = (0.72, 0.50, 0.55)
VIOLET: Color = (0.25, 0.12, 0.58)
CREAM: Color = (0.70, 0.66, 0.52)


def _green(red: float, green: float, blue: float) -> Color:
    """Return the common leaf green, each channel times a factor."""
    return (GREEN[0] * red, GREEN[1] * green, GREEN[2] * blue)


@dataclass(frozen=True)
class Whorls:
    """Branches of a straight stem, after Weber and Penn.

    Attributes
    ----------
    gap
        Metres between the places where branches leave the stem.
    count
        Branches per place; 1 puts them on a spiral of the golden angle.
    low, high
        Radians, rise of the lowest and of the highest branch at the stem.
    bend
        Radians by which a branch rises along its length; negative droops.
    side
        Length of the side shoots as a share of the branch.
    bare
        Share of a branch, from the stem, without side shoots.
    """

    gap: float
    count: int
    low: float
    high: float
    bend: float
    side: float = 0.35
    bare: float = 0.2


@dataclass(frozen=True)
class Species:
    """How a species grows and what it looks like through the year.

    Attributes
    ----------
    height, clear, radius
        Metres: height, stem without branches, largest radius of the crown.
    profile
        Crown radius as a share of `radius` at equal steps from crown base to top.
    trunk
        Metres, stem radius at breast height.
    leaf
        Metres, length of a leaf card near the viewer: a twig's end with its leaves.
    slim
        Breadth of a card as a share of its length.
    pattern
        How the leaves of a twig's end stand, see `cityx.assets.trees.foliage.PATTERNS`.
    cards
        Leaf cards near the viewer.
    summer, autumn
        Linear RGB; autumn as two colours between which leaves vary.
    flower, flowering
        Colour of the blossom and share of the cards in blossom in spring.
    bark, smooth
        Factor on the colour of the bark material; whether the bark is smooth, without ridges.
    flaking
        Whether smooth bark comes off in plates of several colours, as that of planes.
    lobed
        Whether leaves have lobes.
    evergreen
        Keeps its leaves in winter.
    whorls
        Growth in whorls about a straight stem; None grows by space colonisation.
    lead
        Share of the crown's height through which the stem can be followed.
    rise
        How much branches bend to the light.
    sag
        Metres by which the outermost branches hang lower than they grew.
    strands
        Metres of the shoots that hang from the twigs, 0 for none.
    spread
        Metres, spread of a leaf clump about its twig.
    attractors
        Points the branches grow towards; more make a finer crown.
    core
        Large dark cards that close the view through the crown.
    street
        Crown radius when grown in a street, as a share of `radius`; 0 for no street tree.
    """

    height: float
    clear: float
    radius: float
    profile: tuple[float, ...]
    trunk: float
    leaf: float = 0.30
    slim: float = 0.74
    pattern: str = "alternate"
    cards: int = 6500
    summer: Color = GREEN
    autumn: tuple[Color, Color] = (YELLOW, RUSSET)
    flower: Color = CREAM
    flowering: float = 0.0
    bark: Color = (1.0, 1.0, 1.0)
    smooth: bool = False
    flaking: bool = False
    lobed: bool = False
    evergreen: bool = False
    whorls: Whorls | None = None
    lead: float = 0.45
    rise: float = 0.12
    sag: float = 0.0
    strands: float = 0.0
    spread: float = 0.50
    attractors: int = 800
    core: int = 300
    street: float = 0.0


_DOME = (0.50, 0.86, 1.0, 0.98, 0.86, 0.62, 0.22)
_OVAL = (0.42, 0.78, 0.97, 1.0, 0.92, 0.70, 0.28)
_VASE = (0.22, 0.48, 0.74, 0.94, 1.0, 0.86, 0.36)
_CONE = (1.0, 0.93, 0.80, 0.64, 0.46, 0.27, 0.05)
_FLAME = (0.55, 0.90, 1.0, 0.95, 0.80, 0.55, 0.12)
_TABLE = (0.16, 0.34, 0.66, 0.95, 1.0, 0.80, 0.30)


@dataclass(frozen=True)
class TreeSpecies:
    """A species of an installed package, under the entry point group ``cityx.species``.

    Attributes
    ----------
    name
        Its word in commands, and the name of its entry: "baobab".
    habit
        How it grows.
    words
        What sentences call such trees, singular: "baobab", "baobab tree".
    genus
        Words of the tags genus, species and taxon that mean it: "adansonia".
    streets, parks
        Region or climate ("north", "temperate", "japan", "warm", "tropic") -> weight among the
        trees that are planted there, whose weights add up to about 8. Without any it grows where
        it is asked for or mapped.
    """

    name: str
    habit: Species
    words: tuple[str, ...] = ()
    genus: tuple[str, ...] = ()
    streets: Mapping[str, float] = field(default_factory=lambda: MappingProxyType({}))
    parks: Mapping[str, float] = field(default_factory=lambda: MappingProxyType({}))


_OWN: Mapping[str, Species] = MappingProxyType(
    {
        "lime": Species(
            14.0, 2.4, 3.9, _DOME, 0.21, summer=_green(1.0, 1.0, 0.9),
            autumn=(YELLOW, OLD_GREEN), street=0.80),
        "plane": Species(
            17.0, 3.2, 5.4, _OVAL, 0.31, leaf=0.36, slim=0.9, cards=8000, spread=0.62,
            summer=_green(1.12, 1.02, 1.0), autumn=(RUSSET, YELLOW), bark=(1.0, 1.0, 1.0),
            smooth=True, flaking=True, lobed=True, street=0.72),
        "maple": Species(
            12.0, 2.3, 4.5, (0.58, 0.92, 1.0, 0.95, 0.80, 0.56, 0.20), 0.19, leaf=0.28, slim=0.92,
            cards=8000,
            summer=_green(1.05, 1.0, 0.8), autumn=(ORANGE, RED), lobed=True, spread=0.55,
            street=0.74),
        "oak": Species(
            15.0, 2.6, 6.0, (0.55, 0.90, 1.0, 0.97, 0.86, 0.64, 0.26), 0.38, leaf=0.36, slim=0.66,
            cards=8000, summer=_green(0.85, 0.85, 0.8), autumn=(RUSSET, YELLOW),
            bark=(0.8, 0.8, 0.8), lead=0.34, rise=0.04, spread=0.66, street=0.62),
        "chestnut": Species(
            14.0, 2.3, 4.9, (0.62, 0.92, 1.0, 0.97, 0.85, 0.62, 0.24), 0.30, leaf=0.33, slim=0.95,
            cards=8000,
            pattern="palmate", summer=_green(0.80, 0.86, 0.8), autumn=(RUSSET, ORANGE),
            flower=CREAM, flowering=0.10, bark=(0.9, 0.85, 0.8), spread=0.58, sag=0.7,
            street=0.72),
        "birch": Species(
            13.0, 2.4, 2.8, (0.45, 0.85, 1.0, 0.90, 0.72, 0.48, 0.14), 0.12, leaf=0.22,
            cards=6000, summer=_green(1.35, 1.15, 0.95), autumn=(GOLD, YELLOW),
            bark=(0.95, 0.95, 0.93), smooth=True, lead=0.9, rise=0.10, strands=0.9, spread=0.38,
            core=70, street=0.95),
        "cherry": Species(
            7.5, 1.8, 4.0, (0.55, 0.82, 0.98, 1.0, 0.86, 0.60, 0.24), 0.16, leaf=0.24, slim=0.62,
            cards=6000, summer=_green(1.05, 0.95, 0.9), autumn=(ORANGE, RED), flower=PINK,
            flowering=0.97, bark=(0.26, 0.18, 0.16), smooth=True, lead=0.10, rise=0.05,
            spread=0.40, core=130),
        "ginkgo": Species(
            14.0, 2.6, 3.1, (0.75, 1.0, 0.96, 0.82, 0.64, 0.42, 0.12), 0.19, leaf=0.24, slim=1.0,
            pattern="fan", cards=6500, summer=_green(1.15, 1.12, 0.9), autumn=(GOLD, GOLD),
            bark=(0.85, 0.82, 0.80), whorls=Whorls(0.36, 2, 0.45, 0.95, 0.12, 0.32, 0.15),
            spread=0.26, core=150, street=0.80),
        "zelkova": Species(
            15.0, 2.6, 5.2, _VASE, 0.24, leaf=0.36, slim=0.62, cards=8000,
            summer=_green(1.0, 0.98, 0.85), autumn=(ORANGE, RUSSET), bark=(0.24, 0.22, 0.20),
            smooth=True, lead=0.08, rise=0.30, spread=0.48, attractors=950, street=0.76),
        "camphor": Species(
            14.0, 2.6, 5.4, (0.56, 0.90, 1.0, 1.0, 0.92, 0.72, 0.34), 0.30, leaf=0.36, slim=0.62,
            cards=8000, summer=_green(0.95, 0.98, 0.75), evergreen=True, bark=(0.85, 0.78, 0.7),
            lead=0.25, spread=0.55, street=0.66),
        "poplar": Species(
            20.0, 1.6, 1.9, (0.50, 0.82, 0.98, 1.0, 0.90, 0.66, 0.14), 0.26, leaf=0.28,
            cards=6500, summer=_green(0.95, 0.95, 0.85), autumn=(YELLOW, GOLD),
            whorls=Whorls(0.30, 2, 0.95, 1.25, 0.22, 0.30, 0.2), spread=0.28, core=160),
        "willow": Species(
            11.0, 1.9, 4.8, (0.50, 0.84, 1.0, 1.0, 0.90, 0.70, 0.32), 0.32, leaf=0.44, slim=0.24,
            pattern="pinnate", cards=8000, summer=_green(1.25, 1.15, 1.0),
            autumn=(YELLOW, OLD_GREEN), bark=(0.9, 0.85, 0.75), lead=0.15, rise=0.10, sag=0.9,
            strands=3.6, spread=0.30, attractors=520, core=110),
        "jacaranda": Species(
            11.0, 3.0, 5.2, _TABLE, 0.22, leaf=0.38, slim=0.55, pattern="pinnate", cards=6000,
            summer=_green(1.05, 1.08, 0.9), autumn=(YELLOW, OLD_GREEN), flower=VIOLET,
            flowering=0.85, bark=(1.0, 0.95, 0.88), lead=0.12, rise=0.16, spread=0.42, core=90,
            street=0.68),
        "acacia": Species(
            9.0, 3.0, 5.4, (0.08, 0.16, 0.34, 0.70, 1.0, 0.98, 0.55), 0.20, leaf=0.34, slim=0.5,
            pattern="pinnate", cards=6000, summer=_green(1.0, 0.92, 0.85), evergreen=True,
            bark=(0.9, 0.8, 0.72), lead=0.08, rise=0.02, spread=0.34, core=70),
        "olive": Species(
            6.0, 1.5, 2.6, (0.60, 0.95, 1.0, 0.96, 0.82, 0.58, 0.24), 0.19, leaf=0.26, slim=0.42,
            pattern="pinnate", cards=5500, summer=(0.155, 0.185, 0.105), evergreen=True,
            bark=(1.0, 0.98, 0.95), lead=0.12, rise=0.05, spread=0.34, core=110),
        "pine": Species(
            15.0, 5.5, 3.4, (0.55, 0.90, 1.0, 0.96, 0.84, 0.62, 0.26), 0.21, leaf=0.42, slim=0.55,
            pattern="tuft", cards=5500, summer=(0.060, 0.115, 0.036), evergreen=True,
            bark=(1.0, 0.72, 0.55), whorls=Whorls(0.75, 4, 0.10, 0.85, 0.40, 0.42, 0.45),
            spread=0.24, core=80),
        "spruce": Species(
            16.0, 0.9, 3.0, _CONE, 0.20, leaf=0.40, slim=0.46, pattern="spray", cards=7500,
            summer=(0.043, 0.094, 0.028), evergreen=True,
            whorls=Whorls(0.42, 6, -0.22, 0.62, 0.28, 0.36, 0.15), spread=0.13, core=120),
        "cypress": Species(
            12.0, 0.5, 1.15, (0.62, 0.92, 1.0, 0.95, 0.80, 0.52, 0.08), 0.15, leaf=0.31,
            slim=0.40, pattern="spray", cards=5500, summer=(0.048, 0.100, 0.030), evergreen=True,
            whorls=Whorls(0.20, 3, 1.05, 1.25, 0.12, 0.30, 0.2), spread=0.15, core=130),
    }
)  # fmt: skip


def _admitted(value: object) -> tuple[str, TreeSpecies]:
    if not isinstance(value, TreeSpecies) or not isinstance(value.habit, Species):
        raise UsageError("it is no cityx.assets.trees.species.TreeSpecies with a Species.")
    if not value.name.isidentifier() or "_" in value.name:
        raise UsageError(f'the name of a species is one word, not "{value.name}".')
    return value.name, value


OUTSIDE_TREES = extensions("cityx.species", _admitted, {*_OWN, "palm", "shrub"}.__contains__)
TREES: Mapping[str, Species] = MappingProxyType(
    {**_OWN, **{name: tree.habit for name, tree in OUTSIDE_TREES.items()}}
)


@lru_cache(maxsize=64)
def habit(species: str, variant: int) -> Species:
    """Return how an individual grows: numbers from `PARK_FORMS` on are street trees.

    Street trees have been pruned to a clear stem and kept narrow all their lives.
    """
    grown = TREES[species]
    if variant < PARK_FORMS or not grown.street:
        return grown
    height = max(grown.height, STREET_CLEAR + 5.0)
    return replace(grown, clear=STREET_CLEAR, height=height, radius=grown.radius * grown.street,
                   lead=max(grown.lead, 0.3))  # fmt: skip


def individuals(species: str, *, street: bool = False) -> tuple[int, int]:
    """Return the number of the first individual of a kind of place, and how many there are."""
    if street and species in TREES and TREES[species].street:
        return PARK_FORMS, STREET_FORMS
    return 0, PARK_FORMS
