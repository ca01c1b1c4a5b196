"""Classes of maps: the words of a legend, and what each becomes in the tags of OpenStreetMap."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum
from types import MappingProxyType

from cityx.city.layout import AREA_KINDS
from cityx.errors import InputError, nearest
from cityx.sources.features.kinds import building_kind, land_kind, road_kind
from cityx.sources.features.tagged import KIND, Tags
from cityx.system.tables import table


class Role(StrEnum):
    """What is made of the pixels of a class."""

    BUILDING = "building"
    ROAD = "road"
    RAIL = "rail"
    REGION = "region"
    TREE = "tree"  # crowns: single trees where small, a wood where large
    COVER = "cover"  # lies on something else, which goes on below it
    UNKNOWN = "unknown"  # neither street nor house; the region around it goes on
    VOID = "void"  # nobody looked there, or nobody says: it stays empty


@dataclass(frozen=True)
class MapClass:
    """One class of a map.

    Attributes
    ----------
    word
        Its name.
    role
        What is made of it.
    tags
        What is said of each shape made of it; {} for a region that is plain ground.
    """

    word: str
    role: Role
    tags: Tags

    def taller(self, height: float) -> MapClass:
        """Return the class with a height in metres for every building of it."""
        return MapClass(self.word, self.role, {**self.tags, "height": f"{height:g}"})


def _region(**tags: str) -> tuple[Role, Tags]:
    return Role.REGION, tags


_TABLE: Mapping[str, tuple[Role, Tags]] = MappingProxyType({
    "building": (Role.BUILDING, {"building": "yes"}),
    "road": (Role.ROAD, {}),
    "rail": (Role.RAIL, {KIND: "rail"}),
    "tree": (Role.TREE, {"natural": "wood"}),
    "car": (Role.COVER, {}),
    "unknown": (Role.UNKNOWN, {}),
    "void": (Role.VOID, {KIND: "void"}),
    "ground": _region(),
    "paved": _region(highway="pedestrian", area="yes"),
    "plaza": _region(highway="pedestrian", area="yes"),
    "parking": _region(amenity="parking"),
    "water": _region(natural="water"),
    "vegetation": _region(landuse="grass"),
    **{kind: (Role.REGION, {KIND: kind}) for kind in AREA_KINDS if kind not in ("water", "void")},
})  # fmt: skip
# Other words for the same, lower case without what stands in brackets.
_SYNONYMS = table("sources/legends", str, "synonyms")

WORDS = tuple(sorted(_TABLE))


def class_of(text: str) -> MapClass:
    """Return the class that a legend means.

    Parameters
    ----------
    text
        One of `WORDS`, another word for it, or a tag of OpenStreetMap such as "natural=wood".

    Raises
    ------
    InputError
        If it means nothing here; the message names what would.
    """
    if "=" in text:
        return _tagged(text)
    word = re.sub(r"\(.*?\)", "", text).strip().lower().replace("_", " ")
    word = _SYNONYMS.get(word, word)
    if word not in _TABLE:
        near = nearest(word, [*WORDS, *_SYNONYMS])
        raise InputError(
            f'"{text}" is no class of a map.{near} Known are {", ".join(WORDS)}, and tags such as '
            '"landuse=forest".'
        )
    role, tags = _TABLE[word]
    return MapClass(word, role, dict(tags))


def _tagged(text: str) -> MapClass:
    key, _, value = (part.strip() for part in text.partition("="))
    tags = {key: value}
    if building_kind(tags) == "building":
        return MapClass(text, Role.BUILDING, tags)
    if road_kind(tags):
        return MapClass(text, Role.RAIL if key == "railway" else Role.ROAD, tags)
    if land_kind(tags):
        return MapClass(text, Role.REGION, tags)
    raise InputError(
        f'The tag "{text}" is no building, way or area; write one such as "building=house", '
        '"highway=primary" or "landuse=forest".'
    )
