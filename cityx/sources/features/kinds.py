"""What tags mean: the kind of building, land, way, line or thing that they describe."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from types import MappingProxyType

from cityx.city.layout import AREA_KINDS
from cityx.errors import UsageError, nearest
from cityx.sources.features import measures
from cityx.sources.features.tagged import KIND, Owner, Report, Tags
from cityx.sources.features.vocabulary import (
    CARS,
    LINE_HEIGHT,
    LINE_TABLE,
    NO_BUILDING,
    POINT_HEIGHT,
    POINT_TABLE,
    RAIL_WORDS,
    ROAD_TABLE,
    ROAD_WORDS,
    TOWERS,
    area_kind,
    closed_is_area,
    is_indoor,
    is_underground,
    lookup,
)
from cityx.system.extensions import extensions, remembered

_INTERESTING = frozenset(key for key, values in POINT_TABLE if values)
# Tag by which a source says how a place is built, "low", "urban" or "core", and leaves no doubt.
PLACE = "cityx:place"
GROUP = "cityx.road_kinds"
# Barriers that are drawn as areas too, where their thickness is known.
THICK = frozenset({"wall", "city_wall", "retaining_wall", "hedge"})
# What these say is of the ground within a street that goes round; a course is the street itself.
GROUNDS = frozenset({"landuse", "leisure", "natural", "place", "amenity", "landcover", "water"})
COURSES = frozenset({"track", "coastline", "tree_row", "cliff", "slipway", "parking_space"})
# Of a way that carries a street and rails these tags are of the rails, or of both.
RAIL_KEYS = frozenset({
    "bridge", "covered", "electrified", "embankment", "cutting", "gauge", "layer", "level",
    "location", "name", "passenger_lines", "railway", "service", "tracks", "tunnel", "usage",
    "voltage", "frequency",
})  # fmt: skip


def building_kind(tags: Tags) -> str:
    """Return "building", "part" or "" for the tags of an outline."""
    return "" if is_underground(tags) or is_indoor(tags) else stated_building(tags)


def stated_building(tags: Tags) -> str:
    """Return "building", "part" or "" for the tags of an outline, wherever it lies."""
    if measures.word(tags.get("building")) not in NO_BUILDING or tags.get("man_made") in TOWERS:
        return "building"
    return "part" if measures.word(tags.get("building:part")) not in NO_BUILDING else ""


_NOT = frozenset({"", "no", "none", "false"})  # values that state no building


def name_unseen(owners: Iterable[Owner], report: Report) -> None:
    """Name the outlines of buildings and of parts of which nothing stands, and why."""
    for owner in owners:
        value = measures.word(owner.tags.get("building"))
        if value in NO_BUILDING - _NOT and not stated_building(owner.tags):
            report.name(f"outlines of building={value} are of no building that stands", owner)
        elif stated_building(owner.tags) and not building_kind(owner.tags):
            where = "below the ground" if is_underground(owner.tags) else "within houses"
            report.name(f"buildings lie {where} and are not raised", owner)


def use_of(tags: Tags) -> str:
    """Return what a building is used for: the value of building=*, or the word of a tower."""
    tower = tags.get("man_made", "")
    value = measures.word(tags.get("building") or tags.get("building:part"))
    if tower in TOWERS and value in ("", "yes", "tower", "industrial", "part"):
        return tower
    return value if value not in NO_BUILDING else "yes"


def type_word(tags: Tags) -> str:
    """Return the word for the type of a building; other tags help where it says "yes"."""
    use = use_of(tags)
    if use != "yes":
        return use
    amenity = tags.get("amenity", "")
    if amenity == "place_of_worship":
        return "church"
    if amenity in ("parking", "school", "university", "college", "hospital", "kindergarten",
                   "townhall", "library", "police", "fire_station", "theatre", "cinema",
                   "restaurant", "pub", "bank", "toilets", "marketplace"):  # fmt: skip
        return amenity
    tourism = tags.get("tourism", "")
    if tourism in ("hotel", "hostel", "museum", "guest_house"):
        return "hotel" if tourism != "museum" else "museum"
    if "shop" in tags:
        return "supermarket" if tags["shop"] in ("supermarket", "mall") else "yes"
    if "office" in tags:
        return "office"
    if tags.get("aeroway") in ("hangar", "terminal"):
        return tags["aeroway"]
    if tags.get("leisure") in ("stadium", "sports_centre", "sports_hall"):
        return tags["leisure"]
    return "yes"


def land_kind(tags: Tags) -> str:
    """Return the kind of area that a closed outline is, or "" when it is none or a building."""
    if tags.get(KIND) in AREA_KINDS:
        return tags[KIND]
    if tags.get("building", "") not in NO_BUILDING or "building:part" in tags:
        return ""
    if is_underground(tags):
        return ""
    if not closed_is_area(tags):
        return _encircled(tags)
    return area_kind(tags)


def _encircled(tags: Tags) -> str:
    """Return the kind of land that a closed way encircles which is a street besides, or ""."""
    if "highway" not in tags or tags.get("area") == "no":
        return ""
    return area_kind({key: tags[key] for key in sorted(GROUNDS.intersection(tags))
                      if tags[key] not in COURSES})  # fmt: skip


def road_kind(tags: Tags) -> str:
    """Return the class of a way that carries movement, or "" when it is none that is built."""
    if tags.get(KIND) in ROAD_TABLE:
        return tags[KIND]
    tags = road_tags(tags)
    highway = tags.get("highway")
    railway = tags.get("railway", "")
    kind = ROAD_WORDS.get(highway, highway) if highway else ""
    # Rails in a street that is planned, or in one of a kind nobody knows, lie there alone.
    if highway and (kind in ROAD_TABLE or railway not in RAIL_WORDS):
        if kind not in ROAD_TABLE or kind in RAIL_WORDS or _in_hall(tags, kind):
            return ""
        if tags.get("area") == "yes" or tags.get("conveying") or tags.get("tunnel") == "culvert":
            return ""
        return kind
    return RAIL_WORDS.get(railway, "")


def _in_hall(tags: Tags, kind: str) -> bool:
    """Return whether a way lies within a building, where nobody sees it from the street.

    What is driven on the level of the street is a passage of the building.
    """
    driven = kind in CARS and tags.get("level", "0") == "0" and not is_underground(tags)
    return tags.get("indoor") == "yes" and not driven


def is_road_way(tags: Tags, *, closed: bool) -> bool:
    """Return whether a way is a road and not the outline of a square."""
    return bool(road_kind(tags)) and not (closed and "area" in tags and closed_is_area(tags))


def rail_tags(tags: Tags) -> Tags:
    """Return what the tags of a way say of the rails that lie in its street, {} without rails."""
    if tags.get("railway") not in RAIL_WORDS or road_kind(tags) in ("", *RAIL_WORDS.values()):
        return {}
    return {key: value for key, value in tags.items() if key.partition(":")[0] in RAIL_KEYS}


def line_kind(tags: Tags) -> str:
    """Return the kind of a line that stands, or ""."""
    if tags.get(KIND) in LINE_HEIGHT:
        return tags[KIND]
    if is_underground(tags):
        return ""
    return lookup(LINE_TABLE, tags)


def is_thick(tags: Tags) -> bool:
    """Return whether an outline is of a barrier itself, not of land that it stands round."""
    return line_kind(tags) in THICK and not area_kind(tags)


def point_kind(tags: Tags) -> str:
    """Return the kind of thing that stands at a node, or ""; that of a package goes first."""
    if tags.get(KIND) in POINT_HEIGHT:
        return tags[KIND]
    if is_underground(tags) or tags.get("indoor") == "yes":
        return ""
    outside = next((outside_points()[pair] for pair in tags.items() if pair in outside_points()),
                   "")  # fmt: skip
    return outside or ("" if _INTERESTING.isdisjoint(tags) else lookup(POINT_TABLE, tags))


@remembered
def outside_points() -> Mapping[tuple[str, str], str]:
    """Return the things that packages add, by the tag of a point that is one."""

    def admit(value: object) -> tuple[str, Mapping[str, str]]:
        return str(getattr(value, "name", "")), getattr(value, "tags", {})

    found = extensions("cityx.street_objects", admit, POINT_HEIGHT.__contains__)
    return {pair: name for name, tags in found.items() for pair in tags.items()}


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
            raise UsageError("it is no cityx.sources.features.kinds.RoadKind.")
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
