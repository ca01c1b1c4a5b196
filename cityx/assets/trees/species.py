"""The species of trees: size, habit, leaves, bark and the colours of the year.

Sizes are of grown street and park trees; silhouettes, phyllotaxis and autumn colours follow the
field guides.

References
----------
Mitchell, "A field guide to the trees of Britain and northern Europe", 1974.
Gilman and Watson, fact sheets ST-1 to ST-680, University of Florida, 1993 (warm climates).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache

from cityx.system.tables import table

Color = tuple[float, float, float]
SEASONS = ("spring", "summer", "autumn", "winter")
STREET_CLEAR = 5.0  # metres of clear stem of a tree grown beside a carriageway
PARK_FORMS = STREET_FORMS = 3  # individuals of each
# The first individuals of the streets again, as they grow beside a wall; numbers from here on.
WALLED, WALLED_FORMS = PARK_FORMS + STREET_FORMS, 2

# Linear reflectance of leaves in full light, where the table says nothing else.
GREEN: Color = (0.082, 0.162, 0.042)
YELLOW: Color = (0.40, 0.34, 0.020)
RUSSET: Color = (0.23, 0.115, 0.025)
CREAM: Color = (0.70, 0.66, 0.52)


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


TREES = table("assets/trees", Species, "species")


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
