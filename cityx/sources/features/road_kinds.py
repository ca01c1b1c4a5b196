"""Road kinds of installed packages: values of highway=* that CityX does not know by itself."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType

from cityx.errors import UsageError, nearest
from cityx.sources.features.tagged import Tags
from cityx.sources.features.vocabulary import RAIL_WORDS, ROAD_TABLE, ROAD_WORDS
from cityx.system.extensions import extensions, remembered

GROUP = "cityx.road_kinds"


@dataclass(frozen=True)
class RoadKind:
    """A kind of road, registered under the entry point group ``cityx.road_kinds``.

    Attributes
    ----------
    name
        Value of highway=*.
    like
        The class of CityX that it is used, marked and crossed like: "residential".
    tags
        OpenStreetMap's tags of its cross-section, which those of a way go over:
        ``{"lanes": "1", "width": "4", "sidewalk": "none", "surface": "sett", "maxspeed": "20"}``.
    """

    name: str
    like: str
    tags: Mapping[str, str] = field(default_factory=lambda: MappingProxyType({}))


@remembered
def outside_roads() -> Mapping[str, RoadKind]:
    """Return the road kinds that installed packages add, by name."""

    def admit(value: object) -> tuple[str, RoadKind]:
        if not isinstance(value, RoadKind):
            raise UsageError("it is no cityx.sources.features.road_kinds.RoadKind.")
        if value.like not in ROAD_TABLE or value.like in RAIL_WORDS:
            hint = nearest(value.like, ROAD_TABLE)
            raise UsageError(f'road kind "{value.name}" is like no road "{value.like}".{hint}')
        if not all(isinstance(word, str) for pair in value.tags.items() for word in pair):
            raise UsageError(f'road kind "{value.name}" has tags that are no texts.')
        return value.name, value

    return extensions(GROUP, admit, {*ROAD_TABLE, *ROAD_WORDS}.__contains__)


def road_tags(tags: Tags) -> Tags:
    """Return the tags of a way, with those that a road kind of a package stands for."""
    highway = tags.get("highway", "")
    if not highway or highway in ROAD_TABLE or highway in ROAD_WORDS:
        return tags
    kind = outside_roads().get(highway)
    return tags if kind is None else {**kind.tags, **tags, "highway": kind.like}
