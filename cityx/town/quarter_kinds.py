"""Kinds of buildings that make a quarter or are counted: how they come to be and are measured."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

from cityx.assets.styles.palette_tables import HOUSE_AREA
from cityx.checks.predicates.words import BESIDE, LEAST_BUILDING
from cityx.town.elements import ELEMENTS, PLACES, SIDES, chosen_by, side_and_place

ANY_AREA = (LEAST_BUILDING, 1e9)
DWELLING = (LEAST_BUILDING, HOUSE_AREA - 1.0)
MOST = 0.5  # of the buildings of a quarter, that are of its kind
ANY_FLOORS = (1, 200)


@dataclass(frozen=True)
class Kind:
    """How buildings of a kind come to be.

    Attributes
    ----------
    chosen
        The buildings in the language of predicates.
    zone
        Zone in which blocks are built anew, "" where those that stand get another use.
    use
        Word of building=* that they get, "" for that of the zone.
    floors
        Least and greatest number of storeys, so that no building is of two kinds.
    area
        Square metres of a footprint that can become one of the kind.
    roomy
        Square metres from which a footprint is taken first.
    outer
        Whether those at the edge of the site become so first, and not those in its middle.
    instead
        Word of building=* for those that are too many.
    """

    chosen: str
    zone: str = ""
    use: str = ""
    floors: tuple[int, int] = ANY_FLOORS
    area: tuple[float, float] = ANY_AREA
    roomy: float = 0.0
    outer: bool = False
    instead: str = "house"


KINDS: Mapping[str, Kind] = MappingProxyType({
    "house": Kind("building, type=house", "suburb", "", (1, 3), DWELLING, 0, True, "retail"),
    "villa": Kind("building, tag=villa", "suburb", "villa", (1, 3), DWELLING, 0, True),
    "cottage": Kind("building, tag=cottage", "suburb", "cottage", (1, 2), DWELLING, 0, True),
    "bungalow": Kind("building, tag=bungalow", "suburb", "bungalow", (1, 1), DWELLING, 0, True),
    "terrace": Kind("building, tag=terrace", "row", "", (1, 4), DWELLING, 0, True),
    "apartment": Kind("building, use=flats", "", "apartments", (4, 200), ANY_AREA, 120.0),
    "office": Kind("building, use=office", "", "office"),
    "shop": Kind("building, use=retail", "", "retail", (1, 3)),  # higher are offices
    "warehouse": Kind("building, type=warehouse", "industry", "warehouse"),
    "factory": Kind("building, type=factory", "industry", "factory"),
})  # fmt: skip
# Zone of a town, or of its blocks, in which most buildings are of a kind.
ZONE_OF_KIND: Mapping[str, str] = MappingProxyType({
    "apartment": "midrise", **{name: one.zone for name, one in KINDS.items() if one.zone},
})  # fmt: skip
HOUSES = ("terrace", "bungalow", "cottage", "villa")  # all of which are houses, too
DWELLINGS = ("apartment", *HOUSES, "house")
# Kinds that are counted, in this order; the others stand on lots of their own, as elements.
COUNTED_KINDS = ("office", "shop", *DWELLINGS)


def share_in_part(kind: str, part: str, share: float = 1.0) -> str:
    """Return the predicate that most of a share of the buildings of a part are of a kind."""
    return f"part_share({KINDS[kind].chosen}, {part}) >= {MOST * share:.3g}"


# Places of which a side is all the land there, and metres that this reaches.
_BOUNDS, _FAR = ("river", "canal", "railway", "motorway", "tram_line"), 1000.0


def is_a_place(word: str) -> bool:
    """Return whether buildings can be beside a place, or on a side of it: "north of river"."""
    side, place = side_and_place(word)
    return (place in ELEMENTS or place in PLACES) and side in ("", *SIDES)


def reach_of(word: str) -> float:
    """Return the metres from a place, or from the side of one, within which buildings are there."""
    side, place = side_and_place(word)
    return _FAR if side and place in _BOUNDS else BESIDE


def share_beside(kind: str, near: str, within: float = BESIDE, share: float = 1.0) -> str:
    """Return the predicate that most of a share of the buildings beside something are of a kind."""
    side, place = side_and_place(near)
    option = f", within={within:g}" if within != BESIDE else ""
    option += f", side={side}" if side else ""
    return f"near_share({KINDS[kind].chosen}, {chosen_by(place)}{option}) >= {MOST * share:.3g}"
