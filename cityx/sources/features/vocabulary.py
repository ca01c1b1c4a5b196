"""What tags mean: tables from OpenStreetMap's words to those of the layout."""

from __future__ import annotations

from collections.abc import Mapping

from cityx.city.layout import ASKED_HEIGHTS
from cityx.system.tables import load, table

Tags = Mapping[str, str]

# (key, value) -> kind of area, first match wins; "*" stands for any other value but "no".
AREA_TABLE = tuple(table("sources/osm_tags", dict[str, str], "areas").items())
# What land is zoned for says less than what lies on it: a garden of a block is a garden.
ZONES = frozenset({"residential", "commercial", "retail", "industrial"})
WATER_KINDS = frozenset({"water", "sea", "river", "pool"})

# A closed way of these keys is a line unless area=yes says otherwise.
LINEAR_KEYS = load("sources/osm_tags", tuple[str, ...], "linear_keys")
LINEAR_VALUES = frozenset({
    ("natural", "coastline"), ("natural", "cliff"), ("natural", "ridge"), ("natural", "arete"),
    ("natural", "tree_row"), ("leisure", "slipway"),
    ("man_made", "breakwater"), ("man_made", "groyne"), ("man_made", "embankment"),
    ("man_made", "pier"), ("man_made", "quay"), ("aeroway", "taxiway"), ("aeroway", "runway"),
})  # fmt: skip
AREA_ALWAYS = frozenset({"platform"})  # highway and railway values that are areas when closed

NO_BUILDING = load("sources/osm_tags", frozenset[str], "no_building")
ROOF_ONLY = frozenset({"roof", "carport", "canopy", "shelter", "pergola"})
ROOMS = frozenset({"room", "corridor", "area", "wall", "door", "column", "level", "shop"})
TOWERS = load("sources/osm_tags", frozenset[str], "towers")
CLOSED = load("sources/osm_tags", frozenset[str], "closed")

# Lanes and surface of the streets without tags, by class; the place decides how wide they are.
ROAD_TABLE: Mapping[str, tuple[int, str]] = {
    "motorway": (4, "asphalt"),
    "motorway_link": (1, "asphalt"),
    "trunk": (2, "asphalt"),
    "trunk_link": (1, "asphalt"),
    "primary": (2, "asphalt"),
    "primary_link": (1, "asphalt"),
    "secondary": (2, "asphalt"),
    "secondary_link": (1, "asphalt"),
    "tertiary": (2, "asphalt"),
    "tertiary_link": (1, "asphalt"),
    "residential": (2, "asphalt"),
    "unclassified": (2, "asphalt"),
    "living_street": (2, "paving_stones"),
    "service": (1, "asphalt"),
    "busway": (2, "asphalt"),
    "track": (1, "gravel"),
    "pedestrian": (1, "paving_stones"),
    "footway": (1, "paving_stones"),
    "cycleway": (1, "asphalt"),
    "path": (1, "ground"),
    "bridleway": (1, "ground"),
    "steps": (1, "paving_stones"),
    "rail": (1, "ballast"),
    "light_rail": (1, "ballast"),
    "subway": (1, "ballast"),
    "tram": (1, "asphalt"),
}
# Words of highway=* and railway=* that mean one of the classes above.
ROAD_WORDS = table("sources/osm_tags", str, "road_words")
RAIL_WORDS = table("sources/osm_tags", str, "rail_words")
CARS = load("sources/osm_tags", frozenset[str], "cars")
SURFACE_WORDS = table("sources/osm_tags", str, "surface_words")

LINE_TABLE = tuple(table("sources/osm_tags", dict[str, str], "lines").items())
LINE_KEYS = frozenset(key for key, _ in LINE_TABLE)
LINE_HEIGHT = table("sources/osm_tags", float, "line_heights")
BARRIER_HEIGHT = table("sources/osm_tags", float, "barrier_heights")

# Values of amenity=* that have a front and a sign like a shop.
LET_TO_TRADE = load("sources/osm_tags", tuple[str, ...], "let_to_trade")
POINT_TABLE = (
    *table("sources/osm_tags", dict[str, str], "points").items(),
    ("amenity", dict.fromkeys(LET_TO_TRADE, "shop")),
)
# Metres, low and high; a hash of the id chooses between.
POINT_HEIGHT: Mapping[str, tuple[float, float]] = {
    **table("sources/osm_tags", tuple[float, float], "point_heights"),
    **{kind: (height, height) for kind, height in ASKED_HEIGHTS.items()},
}

ROOF_WORDS = table("sources/osm_tags", str, "roof_words")


def lookup(table: tuple[tuple[str, Mapping[str, str]], ...], tags: Tags) -> str:
    """Return the first kind of a table that the tags match, or ""."""
    for key, values in table:
        value = tags.get(key)
        if value is not None:
            kind = values.get(value)
            if kind is None and value != "no":
                kind = values.get("*")
            if kind:
                return kind
    return ""


def area_kind(tags: Tags) -> str:
    """Return the kind of area of a closed outline with these tags, or ""."""
    highway = tags.get("highway")
    if highway and (is_area(tags) or highway in AREA_ALWAYS):
        cars = ROAD_WORDS.get(highway, highway) in CARS
        return "road_area" if cars else "pedestrian"
    kind = lookup(AREA_TABLE, tags)
    if kind in ZONES and "landuse" in tags:
        kind = lookup(AREA_TABLE, {key: tags[key] for key in tags if key != "landuse"}) or kind
    if kind == "water":
        water = tags.get("water", "")
        return {"river": "river", "canal": "river", "pool": "pool"}.get(water, "water")
    if kind == "wood" and tags.get("produce") == "fruit":
        return "orchard"
    return kind


def is_water(tags: Tags) -> bool:
    """Return whether an outline with these tags encloses water."""
    return area_kind(tags) in WATER_KINDS


def is_area(tags: Tags) -> bool:
    """Return whether area=yes or type=multipolygon is given."""
    return tags.get("area") == "yes" or tags.get("type") in ("multipolygon", "boundary")


def closed_is_area(tags: Tags) -> bool:
    """Return whether a closed way with these tags encloses an area."""
    if tags.get("area") == "no":
        return False
    if is_area(tags) or "area:highway" in tags:
        return True
    for key in LINEAR_KEYS:
        value = tags.get(key)
        if value and value not in AREA_ALWAYS and not (key == "barrier" and area_kind(tags)):
            return False
    return LINEAR_VALUES.isdisjoint(tags.items())


def is_underground(tags: Tags) -> bool:
    """Return whether a thing lies below the ground.

    A negative layer says what lies below what: with a height, such a thing stands under a bridge.
    """
    if tags.get("location") in ("underground", "underwater", "subsurface"):
        return True
    if _below(tags.get("level", "")):
        return True
    storeys = tags.get("building:levels", "0") != "0"
    sunk = tags.get("building:levels") == "0" and "building:levels:underground" in tags
    sunk |= _below(tags.get("layer", "")) or tags.get("parking") == "underground"
    return sunk and not storeys and "height" not in tags


def is_indoor(tags: Tags) -> bool:
    """Return whether a thing lies within a house, as its rooms and the shops of a storey do."""
    indoor = tags.get("indoor", "no")
    return indoor in ROOMS or (indoor not in ("no", "") and "level" in tags)


def _below(levels: str) -> bool:
    return levels.startswith("-") and not _reaches_up(levels)


def _reaches_up(levels: str) -> bool:
    """Return whether a list of levels such as "-1;0" holds one at or above the ground."""
    return any(part.strip() and not part.strip().startswith("-") for part in levels.split(";"))
