"""Streets of a procedural town: their classes, cross-sections and names, as tags."""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache

from cityx.geometry.parcels.lattice import Key
from cityx.geometry.parcels.winding_patterns import AVENUE, RING, SQUARE
from cityx.ids import hash_bits
from cityx.places.profile import Profile
from cityx.sources.features.road_features import cross_section
from cityx.sources.features.tagged import Tags
from cityx.town.plane import DENSITY, Plane, StreetBounds
from cityx.town.rims import Side

OPEN = DENSITY[-1]  # density below which is open country
TOWN = DENSITY[2]  # density from which main roads have houses on both sides

_PAVED = {"surface": "asphalt", "lit": "yes"}
_NO_WALK = {"sidewalk": "no", "lit": "no", "parking:both": "no", "surface": "asphalt"}


def _section(
    highway: str, lanes: int, walk: float, parking: str, speed: int, more: Tags | None = None
) -> Tags:
    """Return the tags of a street; nothing is left for the surroundings to decide."""
    sides = {"parking:left": "lane" if parking in ("left", "both") else "no",
             "parking:right": "lane" if parking in ("right", "both") else "no"}  # fmt: skip
    return {
        "highway": highway, "lanes": str(lanes), "maxspeed": str(speed), "sidewalk": "both",
        "sidewalk:both:width": f"{walk:g}", **sides, **_PAVED, **(more or {}),
    }  # fmt: skip


_CYCLES = {"cycleway:both": "lane"}
# Main roads by rank, and by whether they run in the open.
MAIN: Mapping[tuple[str, bool], Tags] = {
    ("primary", False): _section("primary", 4, 4.0, "", 50, _CYCLES),
    ("secondary", False): _section("secondary", 2, 3.5, "both", 50, _CYCLES),
    ("tertiary", False): _section("tertiary", 2, 3.0, "both", 30),
    ("primary", True): {"highway": "primary", "lanes": "2", "maxspeed": "80", **_NO_WALK},
    ("secondary", True): {"highway": "secondary", "lanes": "2", "maxspeed": "70", **_NO_WALK},
    ("tertiary", True): {"highway": "tertiary", "lanes": "2", "maxspeed": "70", **_NO_WALK},
}
# Local streets by the zone of their district.
LOCAL: Mapping[str, Tags] = {
    "core": _section("residential", 2, 3.2, "both", 30),
    "midrise": _section("residential", 2, 2.6, "both", 30),
    "row": _section("residential", 2, 2.2, "right", 30),
    "suburb": _section("residential", 2, 1.8, "", 30),
    "semi": _section("residential", 2, 1.8, "", 30),
    "rural": {"highway": "unclassified", "lanes": "2", "maxspeed": "50", **_NO_WALK},
    "industry": _section("unclassified", 2, 1.8, "right", 50),
}
# Narrow streets of old quarters, in one direction only.
NARROW = _section("residential", 1, 2.0, "right", 20, {"oneway": "yes"})
BLIND = _section("residential", 2, 1.6, "", 20)
# Tag by which a street says its part in the plan of a site: "avenue", "ring", "square".
ROLE = "cityx:role"
MAIN_LINE = 8  # family of the main streets of a grid
# Rank and part of the families of streets that a site has besides local ones.
PARTS: Mapping[int, tuple[str, str]] = {
    AVENUE: ("primary", "avenue"), RING: ("secondary", "ring"), SQUARE: ("tertiary", "square"),
    MAIN_LINE: ("secondary", "main"),
}  # fmt: skip
# What a town of narrow or wide streets changes: of local streets and of main roads.
MAIN_CLASSES = ("primary", "secondary")  # of highway=*
CLEAR = 0.05  # metres by which carriageways stay clear of a bound
LEAST_LANE = 2.5  # metres
_UNPARKED = {"parking:left": "no", "parking:right": "no"}
_PARKED = {"parking:left": "lane", "parking:right": "lane"}
_FITTED: Mapping[str, tuple[Tags, Tags]] = {
    "narrow": (
        {**_UNPARKED, "width:carriageway": "5", "sidewalk:both:width": "1.6"},
        {**_UNPARKED, "lanes": "2", "width:carriageway": "6.5", "sidewalk:both:width": "2"},
    ),
    "wide": ({**_PARKED, "lanes": "2", "width:carriageway": "13"}, {**_PARKED, "lanes": "4"}),
}

_FIRST = (
    "Mill", "Church", "Market", "Linden", "Orchard", "Station", "Castle", "Bridge", "Garden",
    "Harbour", "Abbey", "School", "Forge", "Meadow", "Willow", "Tanner", "Cooper", "Weaver",
    "Potter", "Miller", "Bishop", "King", "Queen", "Fountain", "Chapel", "Elm", "Oak", "Ash",
    "Beech", "Rose", "Well", "Hill", "Spring", "Quarry", "Park", "Tower", "Copper", "Silver",
    "Lantern", "Rope", "Sail", "Anchor", "Hay", "Corn", "Wool", "Salt", "Glass", "Bell",
)  # fmt: skip
_LAST_OF = {"avenue": ("Avenue",), "ring": ("Ring",), "square": ("Square",), "main": ("Road",)}
_MAIN_LAST, _LOCAL_LAST, _BLIND_LAST = ("Avenue", "Road", "Boulevard"), ("Street", "Lane", "Row", "Way"), ("Close", "Court", "Mews")  # fmt: skip  # noqa: E501


def main_rank(plane: Plane, a: Key, b: Key) -> str:
    """Return the rank of the main road between two districts.

    Where quarters meet it is "primary": the quarters are cells of a coarser lattice, so these
    roads make a closed net of their own.
    """
    if plane.is_wet(a) or plane.is_wet(b):
        return "tertiary"
    if plane.quarter_of(a) != plane.quarter_of(b):
        return "primary"
    densest = max(plane.site_density(a), plane.site_density(b))
    return "secondary" if densest >= TOWN else "tertiary"


def main_tags(plane: Plane, a: Key, b: Key) -> Tags:
    """Return the tags of the main road between two districts."""
    a, b = min(a, b), max(a, b)
    densest = max(plane.site_density(a), plane.site_density(b))
    in_open = densest < OPEN and not plane.plan.zone
    tags = MAIN[main_rank(plane, a, b), in_open]
    tags = tags if in_open else _fitted(tags, plane, main=True)
    return {**tags, "name": name_of(plane.seed, _MAIN_LAST, a[0], a[1], b[0] - a[0], b[1] - a[1])}


def side_tags(plane: Plane, key: Key, side: Side) -> Tags:
    """Return the tags of the road along one side of a district."""
    if side.kind == "road":
        return main_tags(plane, key, side.beyond)
    in_open = plane.site_density(key) < OPEN and not plane.plan.zone
    tags = MAIN["tertiary", in_open]
    tags = tags if in_open else _fitted(tags, plane, main=True)
    return {**tags, "name": name_of(plane.seed, ("Quay", "Embankment"), *key, 3)}


def local_tags(plane: Plane, key: Key, zone: str, kind: str, family: int, line: int) -> Tags:
    """Return the tags of a local street: its line in a family of streets, -1 for a dead end."""
    if family < 0:
        tags = _fitted(BLIND, plane, main=False)
        return {**tags, "name": name_of(plane.seed, _BLIND_LAST, *key, 7, line)}
    if family in PARTS:
        rank, part = PARTS[family]
        tags = _fitted(MAIN[rank, False], plane, main=True)
        name = name_of(plane.seed, _LAST_OF[part], *key, family, number=line)
        return {**tags, ROLE: part, "name": name}
    old = kind == "organic" and zone in ("core", "midrise") and family == 1
    tags = _fitted(NARROW if old else LOCAL[zone], plane, main=False)
    return {**tags, "name": name_of(plane.seed, _LOCAL_LAST, *key, family, line)}


def _fitted(tags: Tags, plane: Plane, *, main: bool) -> Tags:
    """Return the tags of a street where streets are narrow, wide or as usual, within bounds."""
    tags = _as_wide(tags, plane.plan.streets, main=main)
    bounds = plane.plan.main if tags["highway"] in MAIN_CLASSES else plane.plan.local
    return tags if bounds == StreetBounds() else _bounded(tags, bounds, plane.profile)


def _bounded(tags: Tags, bounds: StreetBounds, profile: Profile) -> Tags:
    """Return the tags of a street whose lanes and width are within bounds.

    Parked cars give way before lanes do where a street must be narrower.
    """
    lanes = int(tags["lanes"])
    wanted = min(max(lanes, bounds.least_lanes), bounds.most_lanes)
    if wanted != lanes:
        gone = ("width:carriageway", *(("oneway",) if wanted > 1 else ()))
        tags = {key: value for key, value in tags.items() if key not in gone}
        tags["lanes"] = str(wanted)
    for change in ({}, _UNPARKED):
        tags = {**tags, **change}
        width = _section_of(_said(tags), profile)[0]
        if width <= bounds.most:
            break
    fitting = min(max(width, bounds.least + CLEAR), bounds.most - CLEAR)
    if bounds.least <= width <= bounds.most or fitting < bounds.least:
        fitting = min(max(width, bounds.least), bounds.most)
    if fitting == width:
        return tags
    tags = {key: value for key, value in tags.items() if not key.startswith("cycleway")}
    room = max(int(fitting / LEAST_LANE), bounds.least_lanes, 1)
    return {**tags, "width:carriageway": f"{fitting:g}", "lanes": str(min(wanted, room))}


def _as_wide(tags: Tags, width: str, *, main: bool) -> Tags:
    """Return the tags of a street where streets are narrow, wide or as usual."""
    if width == "usual":
        return tags
    change = dict(_FITTED[width][main])
    if width == "narrow":
        tags = {key: value for key, value in tags.items() if not key.startswith("cycleway")}
        if tags.get("oneway") == "yes":
            change["width:carriageway"] = "3.8"
    return {**tags, **change}


def boulevard_tags(seed: int, lanes: int) -> Tags:
    """Return the tags of a boulevard."""
    tags = _section("primary", lanes, 5.0, "", 50)
    return {**tags, ROLE: "boulevard", "name": name_of(seed, ("Boulevard",), 1)}


def ring_tags(seed: int, lanes: int) -> Tags:
    """Return the tags of a ring road."""
    tags = _section("secondary", lanes, 3.5, "", 50)
    return {**tags, ROLE: "ring", "name": name_of(seed, ("Ring",), 4)}


def shore_tags(seed: int, part: str, number: int) -> Tags:
    """Return the tags of a street along water: a "quay" or a "promenade"."""
    last = {"quay": ("Quay", "Embankment"), "promenade": ("Promenade", "Esplanade")}[part]
    name = name_of(seed, last, 2, number=number)
    return {**MAIN["tertiary", False], ROLE: part, "name": name}


def bridge_tags(seed: int, number: int) -> Tags:
    """Return the tags of a street over a river, its ramps included."""
    tags = _section("tertiary", 2, 3.0, "", 30)
    return {**tags, ROLE: "bridge", "name": name_of(seed, ("Bridge",), 3, number=number)}


BRIDGE = {"bridge": "yes", "layer": "1"}


def name_of(seed: int, last: tuple[str, ...], *identity: int, number: int = 0) -> str:
    """Return a name for a street; those of one identity differ by their numbers."""
    bits = 0
    for part in identity:
        bits = hash_bits(seed, "town/name", part, bits)
    return f"{_FIRST[(bits + number) % len(_FIRST)]} {last[(bits >> 32) % len(last)]}"


def carriageway(tags: Tags, profile: Profile) -> float:
    """Return the metres from kerb to kerb of a street."""
    return float(cross_section(tags, profile.streets, town=True, dense=True)[5])


def half_width(tags: Tags, profile: Profile) -> float:
    """Return the metres from the middle of a street to the houses' side of its walk."""
    width, left, right = _section_of(_said(tags), profile)
    return float(width / 2 + max(left, right))


def _said(tags: Tags) -> tuple[tuple[str, str], ...]:
    return tuple(sorted((key, value) for key, value in tags.items() if key != "name"))


@lru_cache(maxsize=256)
def _section_of(tags: tuple[tuple[str, str], ...], profile: Profile) -> tuple[float, float, float]:
    """Return the metres of a carriageway and of its left and right walk."""
    width, left, right = cross_section(dict(tags), profile.streets, town=True, dense=True)[5:8]
    return float(width), float(left), float(right)
