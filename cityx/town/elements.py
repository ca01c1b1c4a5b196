"""Elements: churches, schools, playgrounds, fountains... that a town can be asked to hold.

Each is drawn in tags of OpenStreetMap (`cityx/data/town/elements.toml`), so that it is built as the
same thing of a map is.
"""

from __future__ import annotations

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
    """A piece of land, with its tags."""

    tags: dict[str, str] = field(default_factory=dict)


@dataclass(frozen=True)
class Spot:
    """A thing at a point, with its tags."""

    at: tuple[float, float]
    tags: dict[str, str]


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
    canopies
        Buildings of their own beside it: roofs on posts.
    areas, points
        Land and things on the lot.
    """

    name: str
    measure: str
    lot: tuple[float, float]
    least: float = 1.0
    common: bool = False
    where: str = "middle"
    land: dict[str, str] = field(default_factory=dict)
    building: dict[str, str] = field(default_factory=dict)
    parts: tuple[Volume, ...] = ()
    canopies: tuple[Volume, ...] = ()
    areas: tuple[Ground, ...] = ()
    points: tuple[Spot, ...] = ()

    @property
    def area(self) -> float:
        """Square metres of the lot."""
        return self.lot[0] * self.lot[1]


ELEMENTS: Mapping[str, Element] = table("town/elements", Element)
