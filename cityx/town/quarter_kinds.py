"""Kinds of buildings that a quarter may be of: how they come to be, and how they are measured."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

from cityx.checks.predicates.words import BESIDE
from cityx.town.elements import chosen_by

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
        Least and greatest number of storeys.
    """

    chosen: str
    zone: str = ""
    use: str = ""
    floors: tuple[int, int] = ANY_FLOORS


KINDS: Mapping[str, Kind] = MappingProxyType({
    "house": Kind("building, type=house", "suburb"),
    "villa": Kind("building, tag=villa", "suburb", "villa"),
    "cottage": Kind("building, tag=cottage", "suburb", "cottage", (1, 2)),
    "bungalow": Kind("building, tag=bungalow", "suburb", "bungalow", (1, 1)),
    "terrace": Kind("building, tag=terrace", "row"),
    "apartment": Kind("building, use=flats", use="apartments"),
    "office": Kind("building, use=office", use="office"),
    "shop": Kind("building, use=retail", use="retail", floors=(1, 3)),  # higher are offices
    "warehouse": Kind("building, type=warehouse", "industry", "warehouse"),
    "factory": Kind("building, type=factory", "industry", "factory"),
})  # fmt: skip


def share_in_part(kind: str, part: str, share: float = 1.0) -> str:
    """Return the predicate that most of a share of the buildings of a part are of a kind."""
    return f"part_share({KINDS[kind].chosen}, {part}) >= {MOST * share:.3g}"


def share_beside(kind: str, near: str, within: float = BESIDE, share: float = 1.0) -> str:
    """Return the predicate that most of a share of the buildings beside something are of a kind."""
    option = f", within={within:g}" if within != BESIDE else ""
    return f"near_share({KINDS[kind].chosen}, {chosen_by(near)}{option}) >= {MOST * share:.3g}"
