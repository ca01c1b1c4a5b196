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
        Where it stands unless something else is asked: "middle", "edge", "square", "shore" (on
        land at the water) or "water" (in it, from the shore).
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

    @property
    def is_thing(self) -> bool:
        """Whether it is a thing in the open, and neither a building nor land."""
        return bool(self.points) and not self.building and not self.areas

    @property
    def area(self) -> float:
        """Square metres of the lot."""
        return self.lot[0] * self.lot[1]


ELEMENTS: Mapping[str, Element] = table("town/elements", Element)
# Places that elements are near to, besides other elements, in the language of predicates.
PLACES: Mapping[str, str] = table("town/places", str)
# Builder of a line -> what its parts are, in the language of predicates.
PARTS: Mapping[str, str] = {"wall": "gate", "tram": "tram_stop", "railway": "level_crossing"}
NEAR = 150.0  # metres within which things are near each other
FEWEST_TREES, ROW_REACH = 6, 20.0  # trees of a row, and metres from what they stand along
OFF, OFF_METRES = 0.1, 5.0  # by which a distance may be missed: share of it, and metres
RELATIONS = ("near", "in", "on", "before", "behind", "opposite", "between", "around")


def chosen_by(word: str) -> str:
    """Return a place or an element in the language of predicates."""
    return ELEMENTS[word].measure if word in ELEMENTS else PLACES[word]


def row_of_trees(near: str, species: str = "") -> str:
    """Return the predicate that trees stand along a place or an element."""
    trees = f"tree, species={species}" if species else "tree"
    return f"near({trees}, {chosen_by(near)}, within={ROW_REACH:g}) >= {FEWEST_TREES}"


def taller_than_others(kind: str) -> str:
    """Return the predicate that the buildings of an element are taller than all others."""
    own = ELEMENTS[kind].measure
    others = own.replace("=", "!=")
    return f"stat({own}, height, min) > stat({others}, height, max)"


def distances(metres: float) -> tuple[float, float]:
    """Return the least and the greatest distance that count as one; 0 for near."""
    slack = max(OFF * metres, OFF_METRES)
    return (metres - slack, metres + slack) if metres else (0.0, NEAR)


def relation_of(
    own: str, near: str, relation: str = "near", second: str = "", metres: float = 0.0,
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
    metres
        How far away it is, 0 for near.
    count
        How many are near, where several are.
    """
    other = chosen_by(near)
    low, high = distances(metres)
    if metres:
        return f"dist({own}, {other}) in [{low:g}, {high:g}]"
    if relation == "near" and count > 1:
        return f"near({own}, {other}) >= {count}"
    if relation == "near":
        return f"dist({own}, {other}) <= {high:g}"
    if relation == "between":
        return f"between({own}, {other}, {chosen_by(second)})"
    return f"{'inside' if relation in ('in', 'on') else relation}({own}, {other})"
