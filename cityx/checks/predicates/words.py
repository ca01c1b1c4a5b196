"""When a thing is what a predicate calls it, in numbers.

Each is a definition by what can be measured, so that nothing becomes a tower by being called one.
What a wish such as "a dense city" asks for is in `cityx.language.goals`.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

from cityx.assets.styles.palette_tables import HOUSE_AREA, SHED_AREA

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


# A tall building has 50 m or 14 storeys (Council on Tall Buildings and Urban Habitat); a skyscraper
# 100 m, a high-rise 35 m (Emporis).
BUILDING_TYPES: Mapping[str, Form] = MappingProxyType(
    {
        "tower": Form(height=(50.0, ANY[1]), slender=1.5),
        "skyscraper": Form(height=(100.0, ANY[1]), slender=1.5),
        "high_rise": Form(height=(35.0, ANY[1])),
        "house": Form(height=(0.0, 14.0), floors=(0, 3), area=(SHED_AREA, HOUSE_AREA),
                      uses=("house", "flats", "retail", "office", "civic")),
        "warehouse": Form(floors=(0, 3), area=(250.0, ANY[1]), uses=("industry",)),
        "factory": Form(floors=(0, 4), area=(600.0, ANY[1]), uses=("industry",)),
        "shed": Form(floors=(0, 1), area=(0.0, HOUSE_AREA), uses=("shed",)),
        "church": Form(uses=("worship",)),
        "block": Form(floors=(3, 12), uses=("flats",)),
    }
)  # fmt: skip

# Use of a building -> use groups of `cityx.assets.styles.palettes`.
USES: Mapping[str, tuple[str, ...]] = MappingProxyType(
    {
        "residential": ("house", "flats"), "commercial": ("office", "retail"),
        "industrial": ("industry",), "civic": ("civic",), "religious": ("worship",),
        "office": ("office",), "retail": ("retail",), "house": ("house",), "flats": ("flats",),
        "ancillary": ("shed",),
    }
)  # fmt: skip

# Material of walls or roofs -> materials of `cityx.assets.styles.materials`.
MATERIALS: Mapping[str, tuple[str, ...]] = MappingProxyType(
    {
        "glass": ("glass_wall", "glass", "pane"), "brick": ("brick", "clinker"),
        "concrete": ("concrete", "road_concrete"), "stone": ("stone", "step_stone"),
        "plaster": ("plaster",), "wood": ("wood",), "metal": ("metal_panel", "roof_metal"),
        "tiles": ("roof_tiles",), "slate": ("slate",), "thatch": ("thatch",), "copper": ("copper",),
        "grass": ("grass",), "gravel": ("roof_gravel",), "bitumen": ("bitumen",),
    }
)  # fmt: skip
# Surface of a street -> materials of `cityx.assets.styles.materials`.
PAVINGS: Mapping[str, tuple[str, ...]] = MappingProxyType(
    {
        "asphalt": ("asphalt", "asphalt_light", "asphalt_red", "asphalt_brown"),
        "concrete": ("road_concrete",),
        "cobbles": ("cobbles", "setts", "pale_setts"), "pavers": ("pavers", "paving"),
        "brick": ("clinker",),
        "gravel": ("gravel",), "soil": ("soil",),
    }
)  # fmt: skip
SEASONS = ("spring", "summer", "autumn", "winter")
ON_SIDES = ("none", "left", "right", "both")  # of a street as it is drawn
ROOF_FORMS = ("flat", "pitched")
FLAT_ROOF = 0.985  # vertical part of the normal of what is flat: 10 degrees
MAIN_SHARE = 0.5  # of the walls that the material has which a building is said to be of

# Colours as sRGB; a colour is called by the nearest of these in CIELAB. Walls are muted, so each
# word has a full and a weathered shade.
COLORS: Mapping[str, tuple[int, ...]] = MappingProxyType(
    {
        "red": (0xD02018, 0xB03A30, 0x8C2A22), "orange": (0xE8821E, 0xC97A3A),
        "yellow": (0xF0D020, 0xD8C050), "green": (0x2E8B2E, 0x5E8C50, 0x28602C),
        "blue": (0x2040C0, 0x4870B0, 0x1F2E60), "purple": (0x7020A0, 0x7C5A94),
        "pink": (0xF080A0, 0xD8A0A8), "brown": (0x6B4423, 0x8A6244, 0x50362A),
        "beige": (0xE0D3B4, 0xC7B69A), "white": (0xFFFFFF, 0xE6E4DF),
        "grey": (0x808080, 0xADADAA, 0x585858), "black": (0x000000, 0x282828),
        "turquoise": (0x30C0B8, 0x60A8A4),
    }
)  # fmt: skip

LOCAL = ("residential", "living_street", "unclassified", "tertiary", "tertiary_link", "road")
MAIN = ("motorway", "trunk", "primary", "secondary",
        "motorway_link", "trunk_link", "primary_link", "secondary_link")  # fmt: skip
BACK = ("service", "track", "busway", "bus_guideway", "raceway")
# Class of a road -> values of highway=*; "avenue" and "ring" are told by their shape alone.
ROAD_CLASSES: Mapping[str, tuple[str, ...]] = MappingProxyType(
    {
        "main": MAIN, "local": LOCAL,
        "motorway": ("motorway", "motorway_link"), "trunk": ("trunk", "trunk_link"),
        "primary": ("primary", "primary_link"), "secondary": ("secondary", "secondary_link"),
        "tertiary": ("tertiary", "tertiary_link"), "residential": ("residential", "living_street"),
        "service": ("service",), "track": ("track",),
    }
)  # fmt: skip
ROADS = (*MAIN, *LOCAL, *BACK)
PATHS = ("footway", "path", "pedestrian", "cycleway", "steps", "bridleway")
RAILWAYS = ("rail", "tram", "subway", "light_rail", "narrow_gauge")
AVENUE, RING = "avenue", "ring"
PATTERNS = ("grid", "radial", "organic", "ring")
AXES = ("north_south", "east_west", "northeast_southwest", "northwest_southeast")
SIDES = ("north", "east", "south", "west")

# Kind of land -> kinds of areas of the layout.
LANDS: Mapping[str, tuple[str, ...]] = MappingProxyType(
    {
        "plaza": ("pedestrian",), "park": ("park",), "lake": ("water",), "river": ("river",),
        "sea": ("sea",), "water": ("water", "sea", "river"), "beach": ("sand",),
        "garden": ("garden",), "wood": ("wood",), "meadow": ("meadow",), "grass": ("grass",),
        "farmland": ("farmland",), "pitch": ("pitch",), "playground": ("playground",),
        "cemetery": ("cemetery",), "pool": ("pool",), "pier": ("pier",), "parking": ("parking",),
        "orchard": ("orchard",), "quarter": ("residential", "commercial", "retail", "industrial"),
        "green": ("park", "garden", "grass", "meadow", "wood", "scrub", "orchard", "cemetery",
                  "golf", "wetland"),
    }
)  # fmt: skip
# Kinds whose pieces that touch are one place.
WHOLE = ("plaza", "park", "lake", "river", "sea", "water", "beach", "wood")
SMALLEST = 300.0  # square metres of such a place that counts
SMALLEST_OTHER = 20.0  # square metres of a garden, a pool, a pitch
NEAR = 250.0  # metres from what things stand around to each of them
SHORE = 30.0  # metres from a beach to its water

# Length in metres -> what a vehicle is, by its body.
VEHICLE_TYPES: Mapping[str, tuple[float, float]] = MappingProxyType(
    {"bicycle": (0.0, 2.4), "car": (2.4, 5.8), "truck": (5.8, 9.0), "bus": (9.0, 30.0)}
)
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
TIMES: Mapping[str, Moment] = MappingProxyType(
    {
        "night": Moment((-90.0, -6.0)),
        "midnight": Moment((-90.0, -6.0)),
        "dawn": Moment((-6.5, 6.0), UP),
        "sunrise": Moment((-1.0, 8.0), UP),
        "morning": Moment((-1.0, 90.0), UP, (4.0, 11.5)),
        "noon": Moment((0.0, 90.0), "", (11.0, 13.0)),
        "day": Moment((0.0, 90.0)),
        "afternoon": Moment((2.0, 90.0), DOWN, (12.5, 19.0)),
        "evening": Moment((-12.0, 15.0), DOWN, (13.5, 24.0)),
        "golden_hour": Moment((2.0, 12.0)),
        "sunset": Moment((-1.0, 8.0), DOWN),
        "dusk": Moment((-6.5, 6.0), DOWN),
        "blue_hour": Moment((-8.0, -3.0)),
    }
)


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


_DRY = (0.0, 0.05)
WEATHERS: Mapping[str, Air] = MappingProxyType(
    {
        "clear": Air(cloud=(0.0, 0.3), visibility=(10_000.0, ANY[1]), snowfall=_DRY),
        "cloudy": Air(cloud=(0.3, 0.8), visibility=(10_000.0, ANY[1]), snowfall=_DRY),
        "overcast": Air(cloud=(0.8, 1.0), visibility=(1_500.0, ANY[1]), snowfall=_DRY),
        "haze": Air(visibility=(1_000.0, 18_000.0), cloud=(0.0, 0.7), snowfall=_DRY),
        "fog": Air(visibility=(0.0, 1_500.0), snowfall=_DRY),
        "rain": Air(rain=(0.2, 14.0), cloud=(0.5, 1.0)),
        "storm": Air(rain=(7.6, ANY[1]), wind=(6.0, ANY[1]), cloud=(0.5, 1.0)),
        "snow": Air(snow=(0.02, 1.0), snowfall=(0.05, ANY[1])),
    }
)

CLEAREST, THICKEST = 10_000.0, 100.0  # metres of visibility at which "fog" is 0 and 1
