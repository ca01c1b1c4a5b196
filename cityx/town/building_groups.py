"""Groups of buildings: those of a kind in one place, or those that are added to a map.

A group is written in words, so that a slot may be of one: "house within 50 m of river.count" is how
many houses stand there, "apartment in east.floors" how many storeys the flats in the east have.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from types import MappingProxyType

from cityx.checks.predicates.words import BESIDE, SITE_PARTS
from cityx.town.elements import ELEMENTS, PLACES, chosen_by
from cityx.town.quarter_kinds import ANY_AREA, KINDS, Kind

FARTHEST = 1000  # metres from a place within which buildings are near it
# Kind of a group -> how its buildings come to be; "building" is any.
GROUP_KINDS: Mapping[str, Kind] = MappingProxyType(
    {**KINDS, "building": Kind("building", area=ANY_AREA)}
)
# What is measured of the buildings of a group.
OF_GROUPS = (
    "count", "floors", "height", "material", "color", "roof", "roof_color",
)  # fmt: skip
_WRITTEN = re.compile(
    r"(?P<added>added )?(?P<kind>[a-z_]+)(?: in (?P<part>[a-z_]+))?"
    r"(?: within (?P<within>[1-9][0-9]{0,3}) m of (?P<near>[a-z_]+))?"
)


@dataclass(frozen=True)
class BuildingGroup:
    """Which buildings are meant.

    Attributes
    ----------
    kind
        A key of `GROUP_KINDS`.
    part
        Part of the site that they stand in, a word of `SITE_PARTS`; "" for any.
    near
        Place or element that they stand near, "" for any.
    within
        Metres from `near`.
    added
        Whether those alone that a map does not have.
    """

    kind: str
    part: str = ""
    near: str = ""
    within: int = int(BESIDE)
    added: bool = False

    @property
    def is_known(self) -> bool:
        """Whether its buildings can be chosen."""
        placed = not self.near or self.near in ELEMENTS or self.near in PLACES
        there = self.part in ("", *SITE_PARTS) and 0 < self.within <= FARTHEST
        return self.kind in GROUP_KINDS and placed and there and self.is_some

    @property
    def is_some(self) -> bool:
        """Whether it is not all buildings of the kind."""
        return bool(self.part or self.near or self.added)

    @property
    def text(self) -> str:
        """How it is written: "added house in north within 60 m of river"."""
        added = "added " if self.added else ""
        part = f" in {self.part}" if self.part else ""
        near = f" within {self.within} m of {self.near}" if self.near else ""
        return f"{added}{self.kind}{part}{near}"

    @property
    def beside(self) -> str:
        """What its metres are measured from: of a harbour the water, along which its quay runs."""
        return "sea" if self.near == "harbour" else self.near

    @property
    def chosen(self) -> str:
        """Its buildings in the language of predicates."""
        found = [GROUP_KINDS[self.kind].chosen]
        if self.part:
            found.append(f"part={self.part}")
        if self.near:
            found.append(f'near="{self.within} m of {chosen_by(self.beside)}"')
        if self.added:
            found.append("added=true")
        return ", ".join(found)


@lru_cache(maxsize=4096)
def group_of(key: str) -> BuildingGroup | None:
    """Return the group that a key is of, None where it is of none.

    Parameters
    ----------
    key
        Such as "house in north.floors.max".
    """
    written = _WRITTEN.fullmatch(key.partition(".")[0])
    if written is None:
        return None
    told = written.groupdict()
    group = BuildingGroup(
        told["kind"], told["part"] or "", told["near"] or "", int(told["within"] or BESIDE),
        bool(told["added"]),
    )  # fmt: skip
    return group if group.is_known else None
