"""When a thing is what a predicate calls it, in numbers.

Each is a definition by what can be measured, so that nothing becomes a tower by being called one.
What a wish such as "a dense city" asks for is in `cityx.language.goals`.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

from cityx.assets.styles.palette_tables import HOUSE_AREA, SHED_AREA
from cityx.system.tables import table

ROUGHLY = 0.1  # of a number, by which "~" may miss it
ANY = (0.0, float("inf"))


@dataclass(frozen=True)
class Form:
    """What a building must measure to be of a type.

    Attributes
    ----------
    height
        Least and greatest, metres.
    floors
        Storeys above ground.
    area
        Footprint, square metres.
    slender
        Least height over the root of the footprint's area.
    uses
        Use groups of `cityx.assets.styles.palettes`, () for any.
    """

    height: tuple[float, float] = ANY
    floors: tuple[float, float] = ANY
    area: tuple[float, float] = ANY
    slender: float = 0.0
    uses: tuple[str, ...] = ()


@dataclass(frozen=True)
class BodyForm:
    """What a volume of a building must measure to be a tower, a dome, ... of it.

    Attributes
    ----------
    width
        Least and greatest side of its plan, metres.
    oblong
        Longer side over the shorter one, at most.
    slender
        Height over the longer side, least and greatest.
    over
        Height over that of what it stands out of, at least.
    pointed
        Height of its roof over the longer side at least, where it has a pointed one; 0 for any.
    blunt
        Whether it ends flat.
    domed
        Whether its roof is a dome, whatever the height.
    tops
        Whether a colour that is said of it is that of its roof, and not of its walls.
    """

    width: tuple[float, float]
    oblong: float = 1.8
    slender: tuple[float, float] = (0.0, float("inf"))
    over: float = 0.0
    pointed: float = 0.0
    blunt: bool = False
    domed: bool = False
    tops: bool = False


# A tall building has 50 m or 14 storeys (Council on Tall Buildings and Urban Habitat); a skyscraper
# 100 m, a high-rise 35 m (Emporis).
BUILDING_TYPES: Mapping[str, Form] = MappingProxyType(
    {
        "tower": Form(height=(50.0, ANY[1]), slender=1.5),
        "skyscraper": Form(height=(100.0, ANY[1]), slender=1.5),
        "high_rise": Form(height=(35.0, ANY[1])),
        "house": Form(height=(0.0, 14.0), floors=(0, 3), area=(SHED_AREA, HOUSE_AREA),
                      uses=("house", "flats")),
        "warehouse": Form(floors=(0, 3), area=(250.0, ANY[1]), uses=("industry",)),
        "factory": Form(floors=(0, 4), area=(600.0, ANY[1]), uses=("industry",)),
        "shed": Form(floors=(0, 1), area=(0.0, HOUSE_AREA), uses=("shed",)),
        "church": Form(uses=("worship",)),
        "block": Form(floors=(3, 12), uses=("flats",)),
    }
)  # fmt: skip

# Use of a building -> use groups of `cityx.assets.styles.palettes`.
USES = table("checks/words", tuple[str, ...], "uses")

# Value of building=* -> values that count as it; any other counts as itself alone.
TAGS = table("checks/words", tuple[str, ...], "tags")

# Material of walls or roofs -> materials of `cityx.assets.styles.materials`.
MATERIALS = table("checks/words", tuple[str, ...], "materials")
# Surface of a street -> materials of `cityx.assets.styles.materials`.
PAVINGS = table("checks/words", tuple[str, ...], "pavings")
# Material of things that stand about, and of the ground -> materials of the table.
THING_MATERIALS = table("checks/words", tuple[str, ...], "thing_materials")
COVERS = table("checks/words", tuple[str, ...], "covers")
AGES, GEAR = ("child", "adult", "elder"), ("wheelchair", "pram")  # of people
WEARS = ("hi_vis", "uniform")  # what people have on
SEASONS = ("spring", "summer", "autumn", "winter")
ON_SIDES = ("none", "left", "right", "both")  # of a street as it is drawn
ROOF_FORMS = ("flat", "pitched")
ROOF_SHAPES = ("flat", "gabled", "hipped", "mansard", "pyramidal", "dome", "round", "sawtooth")
FLAT_ROOF = 0.985  # vertical part of the normal of what is flat: 10 degrees
MAIN_SHARE = 0.5  # of the walls that the material has which a building is said to be of

# Colours as sRGB; a colour is called by the nearest of these in CIELAB. Walls are muted, so each
# word has a full and a weathered shade.
COLORS = table("checks/words", tuple[int, ...], "colors")

BACK = ("service", "track", "busway", "bus_guideway", "raceway")
# Class of a road -> values of highway=*; "avenue" and "ring" are told by their shape alone.
ROAD_CLASSES = table("checks/words", tuple[str, ...], "roads")
MAIN, LOCAL = ROAD_CLASSES["main"], ROAD_CLASSES["local"]
ROADS = (*MAIN, *LOCAL, *BACK)
PATHS = ("footway", "path", "pedestrian", "cycleway", "steps", "bridleway")
RAILWAYS = ("rail", "tram", "subway", "light_rail", "narrow_gauge")
AVENUE, RING = "avenue", "ring"
PATTERNS = ("grid", "radial", "organic", "ring")
DRIVEN = ("left", "right")  # sides of the road that one drives on
AXES = ("north_south", "east_west", "northeast_southwest", "northwest_southeast")
SIDES = ("north", "east", "south", "west")
COMPASS = (
    "north", "northeast", "east", "southeast", "south", "southwest", "west", "northwest",
)  # fmt: skip
LANDFORMS = (
    "flat", "hilly", "mountainous", "hill", "ridge", "valley", "slope", "plateau", "terraces",
)  # fmt: skip
TURNED = 0.6  # of the length of streets, that runs along two axes where a grid is turned
APART = 15.0  # metres between the middles of blocks that do not lie in one row
TOWARDS = ("center", "edge", *SIDES)
HALVES = tuple(f"{side}_half" for side in SIDES)
SITE_PARTS = (*TOWARDS, *HALVES)  # parts of a site; a side is less than its half

# Kind of land -> kinds of areas of the layout.
LANDS = table("checks/words", tuple[str, ...], "lands")
# Kinds whose pieces that touch are one place.
WHOLE = ("plaza", "park", "lake", "river", "canal", "sea", "water", "beach", "wood",
         "breakwater")  # fmt: skip
SMALLEST = 300.0  # square metres of such a place that counts
SMALLEST_OTHER = 20.0  # square metres of a garden, a pool, a pitch
NEARBY, BESIDE = 150.0, 60.0  # metres within which things are near others, or along them
LEAST_BUILDING = 45.0  # square metres; smaller ones are sheds and garages
# Part of a site -> how near to its middle or its edge what lies there is at least, 0 to 1.
PART: Mapping[str, float] = MappingProxyType(
    {"center": 0.65, "edge": 0.5, **dict.fromkeys(HALVES, 0.5)}
)
SIDE_PART = 0.62  # the same of a side
NEAR = 250.0  # metres from what things stand around to each of them
SHORE = 30.0  # metres from a beach to its water

# Length in metres -> what a vehicle is, by its body.
VEHICLE_TYPES = table("checks/words", tuple[float, float], "vehicles")
# Part of a building -> first words of the prototypes that are such parts.
PARTS = table("checks/words", tuple[str, ...], "parts")
# Part of a building that is a volume of it -> what it must measure.
BODY_PARTS = table("checks/words", BodyForm, "body_parts")
COUNTED_PARTS = tuple(f"{part}s" for part in BODY_PARTS)  # how many of them a building has
PAINTED = ("door", "window", "awning", "balcony")  # parts of which a colour is measured
# What a vehicle is by its look: first words of prototypes.
VEHICLE_LOOKS = table("checks/words", tuple[str, ...], "vehicle_looks")
SMALLEST_TREE = 2.5  # metres; a lower plant is a shrub
GLOW = 0.5  # saturation of a light from which it is neon and not a lamp


@dataclass(frozen=True)
class Moment:
    """When the sun and the clock make a time of day.

    Attributes
    ----------
    sun
        Least and greatest elevation, degrees.
    half
        "rising", "setting" or "" for either.
    hours
        Least and greatest solar hour.
    """

    sun: tuple[float, float]
    half: str = ""
    hours: tuple[float, float] = (0.0, 24.0)


UP, DOWN = "rising", "setting"
# Moments overlap, as words do: a sunset is also an evening. Below -6 degrees civil twilight ends.
TIMES = table("checks/words", Moment, "times")


@dataclass(frozen=True)
class Air:
    """What the numbers of the air must be for a kind of weather, least and greatest.

    Attributes
    ----------
    cloud, snow
        Shares, 0 to 1.
    visibility
        Metres; meteorologists speak of fog under 1 km and of haze up to some 15 km.
    rain, snowfall
        Millimetres of water per hour; 7.6 begin heavy rain.
    wind
        Metres per second.
    """

    cloud: tuple[float, float] = ANY
    snow: tuple[float, float] = ANY
    visibility: tuple[float, float] = ANY
    rain: tuple[float, float] = (0.0, 0.2)
    snowfall: tuple[float, float] = ANY
    wind: tuple[float, float] = ANY


WEATHERS = table("checks/words", Air, "weathers")

CLEAREST, THICKEST = 10_000.0, 100.0  # metres of visibility at which "fog" is 0 and 1
