"""Elements: churches, schools, playgrounds, fountains... that a town can be asked to hold.

Each is drawn in tags of OpenStreetMap (`cityx/data/town/elements.toml`), so that it is built as the
same thing of a map is.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field

from cityx.system.tables import table

Rectangle = tuple[float, float, float, float]


@dataclass(frozen=True)
class Outline:
    """A plan on a lot: x along the street, y away from it, metres from the middle of its front.

    Attributes
    ----------
    box
        Least x and y, greatest x and y.
    round
        Centre and radius.
    oval
        Centre and both radii.
    hole
        Oval that is left open in the middle.
    """

    box: Rectangle | None = None
    round: tuple[float, float, float] | None = None
    oval: Rectangle | None = None
    hole: Rectangle | None = None


@dataclass(frozen=True)
class Volume(Outline):
    """A part of a building.

    Attributes
    ----------
    kind
        Word of building:part=*; that of the building when "".
    height, base
        Metres above the ground, roof included, and of its underside.
    roof, roof_height
        Word of roof:shape=*, and metres.
    floors
        Storeys, 0 where they are not said.
    material
        Of the walls, "" where the generator chooses.
    """

    kind: str = ""
    height: float = 8.0
    base: float = 0.0
    roof: str = "flat"
    roof_height: float = 0.0
    floors: int = 0
    material: str = ""

    def tags(self) -> dict[str, str]:
        """Return what is said of the volume, but for its kind."""
        said = {
            "height": f"{self.height:g}",
            "roof:shape": self.roof,
            "min_height": f"{self.base:g}" if self.base else "",
            "roof:height": f"{self.roof_height:g}" if self.roof_height else "",
            "building:levels": str(self.floors) if self.floors else "",
            "building:material": self.material,
        }
        return {key: value for key, value in said.items() if value}


@dataclass(frozen=True)
class Ground(Outline):
    """A piece of land.

    Attributes
    ----------
    tags
        What it is.
    without
        Rectangles that are left out of it.
    """

    tags: dict[str, str] = field(default_factory=dict)
    without: tuple[Rectangle, ...] = ()


@dataclass(frozen=True)
class Spot:
    """A thing at a point.

    Attributes
    ----------
    at
        Place on the lot.
    tags
        What it is.
    faces
        Degrees from its front to the lot's: 0 looks to the street, 90 to the right of it. Without
        a number it turns to the nearest street.
    """

    at: tuple[float, float]
    tags: dict[str, str]
    faces: float = math.nan


@dataclass(frozen=True)
class Element:
    """How something is drawn, and how it is found again in the finished city.

    Attributes
    ----------
    measure
        What chooses it in the language of predicates: "building, tag=church".
    lot
        Metres along the street, and away from it.
    least
        Scale down to which the lot may shrink where blocks are small.
    common
        Whether its noun names what most buildings of a town may be, as "factory" does.
    where
        Where it stands unless something else is asked: "middle", "edge", a key of `GROUNDS`,
        "shore" (on land at the water) or "water" (in it, from the shore).
    land
        Tags of the lot's ground, {} where its areas or what was there stay.
    building
        Tags of the building, {} where there is none.
    parts
        Volumes of the building; together they are its outline.
    beside
        Buildings of their own on the same lot; `Volume.kind` is what each is.
    areas, points
        Land and things on the lot.
    builder
        What builds it where it stands on no lot; see `cityx.town.wishes.line_elements`.
    by
        What it stands near to, where that is there.
    size
        A word of `SIZES`, "" for a usual one.
    takes
        What can be said of it, of `ATTRIBUTES`; () for what follows from what it is.
    looks
        What its looks and its height are measured of, "" for itself or the buildings on it.
    told
        Whether the schema of a scene names it; others are put by commands.
    """

    name: str
    measure: str
    lot: tuple[float, float] = (0.0, 0.0)
    least: float = 1.0
    common: bool = False
    where: str = "middle"
    land: dict[str, str] = field(default_factory=dict)
    building: dict[str, str] = field(default_factory=dict)
    parts: tuple[Volume, ...] = ()
    beside: tuple[Volume, ...] = ()
    areas: tuple[Ground, ...] = ()
    points: tuple[Spot, ...] = ()
    builder: str = ""
    by: str = ""
    size: str = ""
    takes: tuple[str, ...] = ()
    looks: str = ""
    told: bool = True

    @property
    def attributes(self) -> frozenset[str]:
        """What can be said of it, of `ATTRIBUTES`."""
        if self.takes:
            return frozenset(self.takes)
        if self.building or self.builder:
            return frozenset(ATTRIBUTES if self.building else ())
        return frozenset(_OF_THINGS if self.is_thing else ("length", "width", "size"))

    @property
    def may_be_enclosed(self) -> bool:
        """Whether it has land or walls of its own, round which something may go."""
        return not self.builder and self.where not in ("water", "afloat")

    @property
    def looked_at(self) -> str:
        """What its looks and its height are measured of: it, or the buildings on its land."""
        on_land = self.building and not self.measure.startswith("building")
        return self.looks or (f"building, in={self.measure}" if on_land else self.measure)

    @property
    def scales(self) -> tuple[float, ...]:
        """Scales that its drawing may have, the best first."""
        if self.size:
            return SIZES[self.size]
        return tuple(scale for scale in SCALES if scale >= self.least)

    @property
    def has_size(self) -> bool:
        """Whether it may be small or large."""
        return "size" in self.attributes

    @property
    def is_thing(self) -> bool:
        """Whether it is a thing in the open, and neither a building nor land."""
        return bool(self.points) and not self.building and not self.areas

    @property
    def area(self) -> float:
        """Square metres of the lot."""
        return self.lot[0] * self.lot[1]


# What can be said of a thing; `roof` is its shape or covering.
ATTRIBUTES = ("material", "color", "height", "length", "width", "size", "roof", "roof_color")
_OF_THINGS = ("material", "color", "height", "length", "width", "size")
BARRIERS = {"fence": "fence", "hedge": "hedge", "boundary_wall": "wall"}  # noun -> kind of line
_ENCLOSED_PLACES = ("plaza", "park", "pond")
RINGED = 0.6  # of all directions round an element, in which what encloses it stands at least
SCALES = (1.0, 0.85, 0.7, 0.55, 0.4)  # to which a lot may shrink, as far as its element admits
# Size -> the scales of its drawing; the ground it takes goes with their squares.
SIZES: Mapping[str, tuple[float, ...]] = {"large": (1.6, 1.45, 1.3), "small": (0.75, 0.65, 0.55)}
# Size -> scale of a thing in the open, and what it is measured to be at least or at most.
SCALE_OF: Mapping[str, float] = {"large": 1.5, "small": 0.65}
LARGE_SCALE, SMALL_SCALE = 1.3, 0.8
LARGE, SMALL = 1.4, 0.65  # of the usual ground: at least that of a large one, at most of a small
ELEMENTS: Mapping[str, Element] = table("town/elements", Element)


@dataclass(frozen=True)
class Other:
    """What is no element, but of which something can be said.

    Attributes
    ----------
    measure
        What chooses it in the language of predicates.
    takes
        What can be said of it, of `ATTRIBUTES`.
    """

    measure: str
    takes: tuple[str, ...]


OTHER_THINGS: Mapping[str, Other] = table("town/other_things", Other)
# Places that elements are near to, besides other elements, in the language of predicates.
PLACES: Mapping[str, str] = table("town/places", str)
# What elements stand so far from, besides.
HOMES: Mapping[str, str] = {"house": "building, type=house"}
# Builder of a line -> what its parts are, in the language of predicates.
PARTS: Mapping[str, str] = {"wall": "gate", "tram": "tram_stop", "railway": "level_crossing"}
NEAR = 150.0  # metres within which things are near each other
FEWEST_TREES, ROW_REACH = 6, 20.0  # trees of a row, and metres from what they stand along
OFF, OFF_METRES = 0.1, 5.0  # by which a distance may be missed: share of it, and metres
# Metres within which a thing stands at a street or another thing, at water, where a quay may lie
# between, and at the middle of a junction.
AT, AT_WATER, AT_CORNER = 50.0, 90.0, 25.0
_WATERSIDES = ("pier", "harbour", "sea", "beach", "lake", "river", "canal", "water")
# Where things stand -> the places in which they do, the first that there are.
GROUNDS: Mapping[str, tuple[str, ...]] = {
    "square": ("plaza", "park"), "meadow": ("meadow", "farmland", "park"), "beach": ("beach",),
    "afloat": ("lake", "river", "canal", "sea"),
}  # fmt: skip
HERDS = ("meadow", "beach", "afloat")  # where many stand side by side
SIDES = ("north", "east", "south", "west")  # of a place, on which something stands
RELATIONS = (
    "near", "at", "in", "on", "before", "behind", "opposite", "between", "around", "end", "across",
    *SIDES,
)  # fmt: skip
WITH_SECOND = ("between", "across")  # relations to two places


def side_and_place(word: str) -> tuple[str, str]:
    """Return the side and the place of "north of river"; of a place alone the side is ""."""
    side, of, place = word.partition(" of ")
    return (side, place) if of else ("", word)


def attributes_of(word: str) -> frozenset[str]:
    """Return what can be said of an element or another thing, of `ATTRIBUTES`."""
    if word in ELEMENTS:
        return ELEMENTS[word].attributes
    return frozenset(OTHER_THINGS[word].takes) if word in OTHER_THINGS else frozenset()


_SAID: Mapping[str, str] = {
    "material": "material that can be chosen", "color": "colour that can be chosen",
    "height": "height of its own", "length": "length of its own", "width": "width of its own",
    "size": "size that can be chosen", "roof": "roof", "roof_color": "roof",
}  # fmt: skip


def has_none(word: str, attribute: str) -> str:
    """Return the sentence that a thing has no such attribute."""
    named, said = word.replace("_", " "), _SAID[attribute]
    if named.endswith("s") and not named.endswith("ss"):
        return f"{named.capitalize()} have no {said.replace('its own', 'their own')}."
    return f"{'An' if named[0] in 'aeiou' else 'A'} {named} has no {said}."


def looked_at(word: str) -> str:
    """Return what the looks of an element or another thing are measured of, "" without any."""
    if word in ELEMENTS:
        return ELEMENTS[word].looked_at
    return OTHER_THINGS[word].measure if word in OTHER_THINGS else ""


def chosen_by(word: str) -> str:
    """Return a place or an element in the language of predicates."""
    return ELEMENTS[word].measure if word in ELEMENTS else {**PLACES, **HOMES}[word]


def row_of_trees(near: str, species: str = "") -> str:
    """Return the predicate that trees stand along a place or an element."""
    trees = f"tree, species={species}" if species else "tree"
    return f"near({trees}, {chosen_by(near)}, within={ROW_REACH:g}) >= {FEWEST_TREES}"


def enclosed_by(kind: str, barrier: str) -> str:
    """Return the predicate that a barrier, a key of `BARRIERS`, goes round an element."""
    return f"enclosed({BARRIERS[barrier]}, {chosen_by(kind)}) >= {RINGED:g}"


def may_be_enclosed(word: str) -> bool:
    """Return whether something may go round an element or a place."""
    return ELEMENTS[word].may_be_enclosed if word in ELEMENTS else word in _ENCLOSED_PLACES


def taller_than_others(kind: str) -> str:
    """Return the predicate that the buildings of an element are taller than all others."""
    own = ELEMENTS[kind].measure
    others = own.replace("=", "!=")
    return f"stat({own}, height, min) > stat({others}, height, max)"


def measures(chosen: str, name: str, low: float, high: float, count: int = 1) -> str:
    """Return the predicate that so many things measure between two numbers, within `OFF`."""
    low, high = (1 - OFF) * low, (1 + OFF) * high
    told = f"{name} >= {low:.6g}" if math.isinf(high) else f"{name} in [{low:.6g}, {high:.6g}]"
    return f"n({chosen}, {told}) >= {count}"


@dataclass(frozen=True)
class Distance:
    """How far away one thing is from another, from outline to outline.

    Attributes
    ----------
    metres
        So far, 0 where that is not said.
    least, most
        At least and at most, 0 where that is not said.
    """

    metres: float = 0.0
    least: float = 0.0
    most: float = 0.0

    @property
    def is_told(self) -> bool:
        """Whether anything is said of it."""
        return bool(self.metres or self.least or self.most)

    def __str__(self) -> str:
        """Return it in words."""
        if self.metres:
            return f"{self.metres:g} m"
        told = ((self.least, "at least"), (self.most, "at most"))
        return " and ".join(f"{words} {value:g} m" for value, words in told if value)

    def bounds(self, relation: str = "near", near: str = "") -> tuple[float, float]:
        """Return the least and the greatest distance that count, of a relation to a place."""
        if self.metres:
            slack = max(OFF * self.metres, OFF_METRES)
            return self.metres - slack, self.metres + slack
        if self.least or self.most:
            return self.least, self.most or math.inf
        at = AT_WATER if near in _WATERSIDES else AT_CORNER if near == "corner" else AT
        return 0.0, at if relation == "at" else NEAR


UNTOLD = Distance()


def relation_of(
    own: str, near: str, relation: str = "near", second: str = "", distance: Distance = UNTOLD,
    *, count: int = 1,
) -> str:  # fmt: skip
    """Return the predicate of where an element stands to a place or another element.

    Parameters
    ----------
    own
        The element in the language of predicates.
    near, second
        Places or elements, by their words.
    relation
        One of `RELATIONS`.
    distance
        How far away it is.
    count
        How many are near, where several are.
    """
    other = chosen_by(near)
    low, high = distance.bounds(relation, near)
    if distance.metres or (distance.least and distance.most):
        return f"dist({own}, {other}) in [{low:g}, {high:g}]"
    if distance.least:
        return f"dist({own}, {other}) >= {low:g}"
    if relation in ("near", "at") and count > 1:
        return f"near({own}, {other}{f', within={high:g}' * (high != NEAR)}) >= {count}"
    if relation in ("near", "at"):
        return f"dist({own}, {other}) <= {high:g}"
    if relation in WITH_SECOND:
        return f"{relation}({own}, {other}, {chosen_by(second)})"
    if relation in SIDES:
        return f"near({own}, {other}, within={high:g}, side={relation}) >= {count}"
    form = {"in": "inside", "on": "inside", "end": "at_end"}.get(relation, relation)
    return f"{form}({own}, {other})"
