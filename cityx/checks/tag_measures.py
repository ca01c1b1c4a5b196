"""Measures of what tags of a map state: each compares a value with what stands in a city.

Values are understood by the tables of this module alone, so that a fault of the importer is not
repeated by its check.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from types import MappingProxyType

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.assets.styles.materials import srgb_to_linear
from cityx.checks.map_features import Feature
from cityx.checks.mapped_things import Finished
from cityx.checks.predicates.thing_predicates import CannotTell
from cityx.city.ground import KERB_HEIGHT
from cityx.city.section import BAND_KINDS
from cityx.geometry.arrays import FloatArray
from cityx.system.tables import table

KEPT, DEPARTED, LOST, UNREADABLE = "kept", "departed", "lost", "unreadable"
VERDICTS = (KEPT, DEPARTED, LOST, UNREADABLE)
METRES, SHARE = 0.5, 0.03  # by which a height may differ, whichever is more
WIDTH = 0.10  # share by which a width may differ
TURN = 5.0  # degrees
SPEED = 1.0  # km/h
BESIDE = 12.0  # metres from a way to lanes that are of it
LOW_METRES = 0.15  # by which heights and widths of barriers may differ
ABOUT = 0.03  # metres, likewise of kerbs
AT_CROSSING, FAR_OFF = 3.0, 16.0  # metres from a crossing of the map to the one of the city
COLOUR = 0.14  # of the distance of two colours in OKLab, white to black being 1
PAINT = (0.03, 0.85)  # share of light that any coat of paint reflects, at least and at most
_LET_IN = ("yes", "designated", "official")
_NEGATIVE = ("no", "none", "false", "0")

Found = tuple[str, str]  # a verdict, and what there is
Measure = Callable[[Finished, Feature, str], Found]


def _verdict(kept: bool, found: object) -> Found:
    return (KEPT if kept else DEPARTED), str(found)


def _number(text: str, units: Mapping[str, float]) -> float | None:
    """Read a number with a unit: "12", "12.5 m", "40'", "20 mph"."""
    match = re.fullmatch(r"([-+]?\d+(?:[.,]\d+)?)\s*([^\d\s].*)?", text.strip())
    if match is None:
        return None
    unit = (match[2] or "").strip().lower()
    return float(match[1].replace(",", ".")) * units[unit] if unit in units else None


_LENGTHS = {"": 1.0, "m": 1.0, "metres": 1.0, "meters": 1.0, "ft": 0.3048, "'": 0.3048}
_SPEEDS = {"": 1.0, "km/h": 1.0, "kmh": 1.0, "mph": 1.609344, "knots": 1.852}
_BY_LAW = table("sources/implicit_speeds", dict[str, float])
_PLAIN = {"": 1.0}


def _height(city: Finished, one: Feature, value: str) -> Found:
    stated = _number(value, _LENGTHS)
    if stated is None or not 0 < stated < 1000:
        return UNREADABLE, value
    found = float(city.heights_of(one.name).max(initial=0.0))
    return _verdict(abs(found - stated) <= max(METRES, SHARE * stated), f"{found:.1f} m")


def height_of_rest(city: Finished, one: Feature, value: str) -> Found:
    """Compare the height of a divided building: parts of the map may rise above what it says."""
    stated, (verdict, found) = _number(value, _LENGTHS), _height(city, one, value)
    tops = city.heights_of(one.name)
    if verdict != DEPARTED or stated is None or not len(tops):
        return verdict, found
    nearest = float(tops[np.argmin(np.abs(tops - stated))])
    return _verdict(abs(nearest - stated) <= max(METRES, SHARE * stated), f"{nearest:.1f} m")


def _levels(city: Finished, one: Feature, value: str) -> Found:
    stated = _number(value, _PLAIN)
    if stated is None or not 0 <= stated < 250:
        return UNREADABLE, value
    found = int(city.city.layout.buildings["levels"].to_numpy()[city.buildings[one.name]])
    return _verdict(abs(found - stated) <= 0.5, found)


_SHAPES = {
    "pitched": "gabled", "half_hipped": "half-hipped", "side_hipped": "hipped",
    "lean_to": "skillion", "pyramid": "pyramidal", "shed": "skillion", "monopitch": "skillion",
    "spherical": "dome", "conical": "cone",
}  # fmt: skip


# Of the page "Key:roof:shape" of OpenStreetMap's wiki; "many" and whatever else says no shape.
_KNOWN_SHAPES = frozenset(
    ("flat", "skillion", "gabled", "half-hipped", "hipped", "pyramidal", "gambrel", "mansard",
     "dome", "onion", "round", "saltbox", "cone", "sawtooth", "butterfly", "crosspitched",
     "side_half-hipped", "quadruple_saltbox", "zakomar", "hyperbolic_paraboloid",
     "gabled_height_moved")
)  # fmt: skip


def _roof_shape(city: Finished, one: Feature, value: str) -> Found:
    if _SHAPES.get(value, value) not in _KNOWN_SHAPES:
        return UNREADABLE, value
    stated, found = _SHAPES.get(value, value), str(city.part(one.name, "roof_shape"))
    return _verdict(stated in (found, _SHAPES.get(found, found)), found)


_WINDS = ("N", "NNE", "NE", "ENE", "E", "ESE", "SE", "SSE",
          "S", "SSW", "SW", "WSW", "W", "WNW", "NW", "NNW")  # fmt: skip


def _roof_direction(city: Finished, one: Feature, value: str) -> Found:
    wind = value.strip().upper()
    stated = 22.5 * _WINDS.index(wind) if wind in _WINDS else _number(value, {"": 1.0, "°": 1.0})
    if stated is None:
        return UNREADABLE, value
    found = float(np.degrees(city.part(one.name, "roof_direction"))) % 360
    return _verdict(abs((found - stated + 180) % 360 - 180) <= TURN, f"{found:.0f}")


def _roof_orientation(city: Finished, one: Feature, value: str) -> Found:
    if value not in ("across", "along"):
        return UNREADABLE, value
    found = "across" if city.part(one.name, "roof_across") else "along"
    return _verdict(found == value, found)


def _color(walls: bool) -> Measure:
    def measure(city: Finished, one: Feature, value: str) -> Found:
        from PIL import ImageColor

        try:
            red, green, blue = ImageColor.getrgb(value.strip().lower().replace(" ", ""))[:3]
        except ValueError:
            return UNREADABLE, value
        try:
            means = city.colors(walls)
        except CannotTell:
            return KEPT, "not built yet"
        mean = means.get(one.name)
        if mean is None:
            return LOST, ""
        stated = np.array(srgb_to_linear((red << 16) | (green << 8) | blue))
        far = float(np.linalg.norm(_oklab(mean) - _oklab(np.clip(stated, *PAINT))))
        return _verdict(far <= COLOUR, f"{far:.2f} away")

    return measure


def _oklab(linear: FloatArray) -> FloatArray:
    """Return colours in OKLab, in which distances are those that one sees (Ottosson 2020)."""
    cones = np.array([[0.4122214708, 0.5363325363, 0.0514459929],
                      [0.2119034982, 0.6806995451, 0.1073969566],
                      [0.0883024619, 0.2817188376, 0.6299787005]])  # fmt: skip
    axes = np.array([[0.2104542553, 0.7936177850, -0.0040720468],
                     [1.9779984951, -2.4285922050, 0.4505937099],
                     [0.0259040371, 0.7827717662, -0.8086757660]])  # fmt: skip
    return np.asarray(np.cbrt(np.clip(linear @ cones.T, 0, None)) @ axes.T)


# Values of building:material and roof:material, by the materials that show them.
_WALLS_OF = {
    "brick": "brick bricks clinker", "plaster": "plaster stucco render rendered clay adobe mud "
    "loam tiles ceramic eternit vinyl plastic", "stone": "stone sandstone limestone granite marble "
    "masonry slate", "concrete": "concrete cement_block reinforced_concrete prefabricated",
    "wood": "wood timber timber_framing bamboo log plywood", "glass_wall": "glass mirror",
    "metal_panel": "metal steel aluminium tin copper zinc iron corrugated_iron corrugated_metal "
    "sheet_metal metal_plates stainless_steel",
}  # fmt: skip
_ROOFS_OF = {
    "roof_tiles": "roof_tiles tiles tile clay brick", "slate": "slate stone eternit asbestos",
    "roof_metal": "metal steel tin zinc aluminium metal_sheet corrugated_iron stainless_steel",
    "copper": "copper", "bitumen": "tar_paper bitumen asphalt asphalt_shingle plastic",
    "roof_gravel": "gravel", "concrete": "concrete", "thatch": "thatch reed straw palm_leaves",
    "glass_wall": "glass", "grass": "grass plants", "wood": "wood",
}  # fmt: skip


def _material(walls: bool) -> Measure:
    shown = {word: name for name, text in (_WALLS_OF if walls else _ROOFS_OF).items()
             for word in text.split()}  # fmt: skip

    def measure(city: Finished, one: Feature, value: str) -> Found:
        words = [word.strip().replace(" ", "_") for word in value.lower().split(";")]
        wanted = {shown[word] for word in words if word in shown}
        if not wanted:
            return UNREADABLE, value
        try:
            found = city.materials(walls).get(one.name, "")
        except CannotTell:
            return KEPT, "not built yet"
        return _verdict(not found or found in wanted, found or "has none")

    return measure


def _building_name(city: Finished, one: Feature, value: str) -> Found:
    found = str(city.city.layout.buildings["name"].to_numpy()[city.buildings[one.name]])
    return _verdict(found == value, found)


def _lanes(city: Finished, one: Feature, value: str) -> Found:
    stated = _number(value, _PLAIN)
    if stated is None or not 0 < stated < 30:
        return UNREADABLE, value
    counts = [_beside_each_other(city, lanes) for lanes in city.lanes_of(one.name)]
    barred = (
        _is_shut(one.tags, who, way) and "no" in (one.tags.get(who), one.tags.get(f"{who}:{way}"))
        for who in _WHO for way in ("forward", "backward")
    )  # fmt: skip
    if any(barred):
        # What cars are kept out of is of bicycles, or as a shoulder.
        counts += [_beside_each_other(city, lanes) for lanes in city.carriageway_of(one.name)]
    if not counts:
        return KEPT, "too short for a lane of its own"
    most, shut = max(set(counts), key=counts.count), _shut(one.tags)
    return _verdict(stated - shut in counts, f"{most}, {shut} closed to all" if shut else most)


def _shut(tags: Mapping[str, str]) -> int:
    """Count the lanes that values per lane close to everybody; they are as shoulders."""
    found = 0
    for way in ("", ":forward", ":backward"):
        said = [tags.get(f"{key}:lanes{way}", "").split("|") for key in ("vehicle", "access")]
        let = [tags.get(f"{key}:lanes{way}", "").split("|") for key in ("bus", "psv", "bicycle")]
        for words in said:
            open_ = [any(len(own) == len(words) and own[lane] in _LET_IN for own in let)
                     for lane in range(len(words))]  # fmt: skip
            found += sum(word == "no" and not one for word, one in zip(words, open_, strict=True))
    return found


def _beside_each_other(city: Finished, rows: NDArray[np.int64]) -> int:
    """Count lanes; one that is driven in both directions is one."""
    lanes = city.city.lanes
    assert lanes is not None
    sides = np.round(np.column_stack([lanes.left[rows], lanes.right[rows]]), 2)
    return len(np.unique(sides, axis=0))


def _oneway(city: Finished, one: Feature, value: str) -> Found:
    wanted = {"yes": 1, "true": 1, "1": 1, "-1": -1, "reverse": -1}.get(value)
    if wanted is None:
        return (KEPT, value) if value in (*_NEGATIVE, "reversible", "alternating") else (
            UNREADABLE, value)  # fmt: skip
    lanes = city.city.lanes
    rows = city.lanes_of(one.name)
    if lanes is None or not rows:
        return KEPT, "too short for a lane of its own"
    cars = np.concatenate([row[lanes.kind[row] == BAND_KINDS.index("drive")] for row in rows])
    ways = {_leads(city, one, lane) for lane in cars.tolist()}
    return _verdict(ways <= {wanted, 0}, sorted(ways))


def _leads(city: Finished, one: Feature, lane: int) -> int:
    """Return whether a lane leads along a way as it is drawn, see `_leads_along`."""
    lanes = city.city.lanes
    assert lanes is not None
    return _leads_along(one, lanes.points[lanes.point_start[lane] : lanes.point_start[lane + 1]])


def _leads_along(one: Feature, points: FloatArray) -> int:
    """Return 1 for a line that leads along a way as it is drawn, -1 against it, 0 for neither.

    Told where they lie beside each other: both may go on, or come back to where they began.
    """
    line, way = shapely.LineString(points), one.shape
    spots = shapely.line_interpolate_point(way, np.linspace(0.05, 0.95, 19), normalized=True)
    near = spots[shapely.distance(line, spots) <= BESIDE]
    if not len(near):
        return 0
    steps = []
    for path in (way, line):
        at = shapely.line_locate_point(path, near)
        ends = [shapely.line_interpolate_point(path, np.clip(at + step, 0.0, path.length))
                for step in (-0.5, 0.5)]  # fmt: skip
        steps.append(np.subtract(*map(shapely.get_coordinates, ends[::-1])))
    return int(np.sign(np.round(np.sum(steps[0] * steps[1]), 3)))


def _of_law(value: str) -> float | None:
    """Return the km/h that the law of a country sets for a word: "RU:urban", "FR:zone30"."""
    country, _, word = value.partition(":")
    number = re.fullmatch(r"zone:?(\d+)", word)
    if number:
        return float(number[1]) * (_SPEEDS["mph"] if country in ("GB", "US") else 1.0)
    return _BY_LAW.get(country.split("-")[0], {}).get(word)


def _maxspeed(city: Finished, one: Feature, value: str) -> Found:
    stated = _number(value, _SPEEDS) or _of_law(value)
    lanes = city.city.lanes
    if stated is None or stated <= 0:
        return UNREADABLE, value
    rows = [row for row in city.lanes_of(one.name) if len(row)]
    if lanes is None or not rows:
        return KEPT, "too short for a lane of its own"
    speed = float(np.median(np.concatenate([lanes.speed[row] for row in rows])))
    return _verdict(abs(speed - stated) <= SPEED, f"{speed:.0f}")


# Surfaces that another one says more exactly, and words for the same.
_SURFACES: Mapping[str, tuple[str, ...]] = MappingProxyType(
    {
        "paved": ("asphalt", "concrete", "paving_stones", "sett", "cobblestone"),
        "unpaved": ("gravel", "ground", "compacted", "dirt", "sand", "grass", "fine_gravel"),
        "dirt": ("ground",), "earth": ("ground",), "mud": ("ground",), "sand": ("ground",),
        "compacted": ("gravel",), "fine_gravel": ("gravel",), "pebblestone": ("gravel",),
        "cobblestone": ("sett",), "unhewn_cobblestone": ("cobblestone",),
        "cobblestone:flattened": ("sett",), "concrete:plates": ("concrete",),
        "concrete:lanes": ("concrete",), "bricks": ("paving_stones",), "tiles": ("paving_stones",),
    }
)  # fmt: skip


# Of the page "Key:surface" of OpenStreetMap's wiki, beside those above.
_PLAIN_SURFACES = ("asphalt", "concrete", "paving_stones", "sett", "gravel", "ground", "grass",
                   "metal", "wood", "chipseal", "rock", "grass_paver", "acrylic", "artificial_turf",
                   "rubber", "tartan", "clay", "woodchips", "ice", "snow", "salt", "shells",
                   "stepping_stones", "carpet", "fibre_reinforced_polymer_grate")  # fmt: skip


def _surface(city: Finished, one: Feature, value: str) -> Found:
    if value not in _SURFACES and value not in _PLAIN_SURFACES:
        return UNREADABLE, value
    found = str(city.city.layout.roads["surface"].to_numpy()[city.roads[one.name]])
    return _verdict(found == value or found in _SURFACES.get(value, ()), found)


def _road_name(city: Finished, one: Feature, value: str) -> Found:
    found = str(city.city.layout.roads["name"].to_numpy()[city.roads[one.name]])
    return _verdict(found == value, found)


def _flag(column: str) -> Measure:
    def measure(city: Finished, one: Feature, value: str) -> Found:
        found = bool(city.city.layout.roads[column].to_numpy()[city.roads[one.name]])
        return _verdict(found == (value not in _NEGATIVE), found)

    return measure


def _width(city: Finished, one: Feature, value: str) -> Found:
    stated = _number(value, _LENGTHS)
    network, row = city.city.network, city.roads[one.name]
    if stated is None or not 0 < stated < 100:
        return UNREADABLE, value
    if network is None or row not in city.edges:
        return KEPT, "too short for a lane of its own"
    found = 2 * float(np.median(network.half_width[city.edges[row]]))
    return _verdict(abs(found - stated) <= max(WIDTH * stated, 0.3), f"{found:.1f} m")


def bicycles_against(city: Finished, one: Feature) -> Found:
    """Compare whether bicycles may go against a one-way street."""
    lanes = city.city.lanes
    rows = [row for row in city.bands_of(one.name) if len(row)]
    if lanes is None or not rows:
        return KEPT, "too short for a lane of its own"
    turned = -1 if one.tags.get("oneway") == "-1" else 1
    cycled = [row[lanes.kind[row] == BAND_KINDS.index("cycle")] for row in rows]
    ways = {_leads(city, one, lane) for own in cycled for lane in own.tolist()}
    if ways == {0}:
        return KEPT, "too short for a lane of its own"
    return _verdict(-turned in ways, "against it" if -turned in ways else "with it alone")


def _bus_lanes(city: Finished, one: Feature, value: str) -> Found:
    lanes = city.city.lanes
    stated = value.split("|").count("designated")
    rows = [row for row in city.lanes_of(one.name) if len(row)]
    if lanes is None or not rows:
        return KEPT, "too short for a lane of its own"
    found = max(int((lanes.kind[row] == BAND_KINDS.index("bus")).sum()) for row in rows)
    return _verdict(found >= stated, found)


def _walks(city: Finished, one: Feature, value: str) -> Found:
    """Compare on which sides of a street the map has walks."""
    wanted = {"both": {1, -1}, "left": {1}, "right": {-1}, "no": set(), "none": set()}.get(value)
    if wanted is None:
        return (KEPT, value) if value == "separate" else (UNREADABLE, value)
    lanes, network = city.city.lanes, city.city.network
    edges = city.edges.get(city.roads[one.name], np.zeros(0, np.int64)).tolist()
    if lanes is None or network is None or not edges:
        return KEPT, "too short for a lane of its own"
    sides: list[set[int]] = []
    for edge, rows in zip(edges, city.bands_of(one.name), strict=True):
        along = 1 if _leads_along(one, network.edge_points(edge)) >= 0 else -1
        walks = rows[lanes.kind[rows] == BAND_KINDS.index("walk")]
        sides.append({along * int(np.sign(lanes.left[row] + lanes.right[row]))
                      for row in walks.tolist()})  # fmt: skip
    words = {1: "left", -1: "right"}
    return _verdict(wanted in sides, [[words[side] for side in sorted(own)] for own in sides])


# Keys of who may use a street, the narrower before the wider.
_WHO = ("motorcar", "motor_vehicle", "vehicle", "access")


def _permission(key: str) -> Measure:
    """Compare whether cars may drive on a street, in one direction or both, as a key says."""
    name, _, told = key.partition(":")

    def measure(city: Finished, one: Feature, value: str) -> Found:
        lanes = city.city.lanes
        rows = [row for row in city.bands_of(one.name) if len(row)]
        if value != "no" or lanes is None or not rows:
            return KEPT, value
        cars = [
            lane
            for own in rows
            for lane in own.tolist()
            if lanes.kind[lane] == BAND_KINDS.index("drive") and lanes.direction[lane]
        ]
        found = {_leads(city, one, lane) for lane in cars}
        closed = {
            way
            for way, sign in (("forward", 1), ("backward", -1))
            if told in ("", way) and _is_shut(one.tags, name, way) and sign in found
        }
        return _verdict(not closed, f"open {' and '.join(sorted(closed))}" if closed else "closed")

    return measure


def _is_shut(tags: Mapping[str, str], name: str, way: str) -> bool:
    """Return whether what a key forbids in a direction is allowed by no narrower one."""
    narrower = _WHO[: _WHO.index(name)]
    words = [tags.get(f"{key}:{way}", tags.get(key)) for key in narrower]
    return all(word in (None, "no") for word in words)


def _barrier_height(city: Finished, one: Feature, value: str) -> Found:
    stated = _number(value, _LENGTHS)
    if stated is None or not 0 < stated < 100:
        return UNREADABLE, value
    high = _above_ground(city, one)
    near = float(high[np.argmin(np.abs(high - stated))])
    return _verdict(abs(near - stated) <= max(LOW_METRES, 0.05 * stated), f"{near:.2f} m")


def _barrier_foot(city: Finished, one: Feature, value: str) -> Found:
    stated = _number(value, _LENGTHS)
    if stated is None or not 0 <= stated < 100:
        return UNREADABLE, value
    low = max(float(_above_ground(city, one).min()), 0.0)
    return _verdict(abs(low - stated) <= LOW_METRES, f"{low:.2f} m")


def _above_ground(city: Finished, one: Feature) -> FloatArray:
    corners = city.barrier(one.name)
    land = city.city.terrain.height_at(corners[:, :2]) + KERB_HEIGHT
    return np.asarray(corners[:, 2] - land)


def _barrier_width(city: Finished, one: Feature, value: str) -> Found:
    stated = _number(value, _LENGTHS)
    if stated is None or not 0 < stated < 50 or one.shape.geom_type.endswith("Polygon"):
        return UNREADABLE, value
    places = shapely.points(city.barrier(one.name)[:, :2])
    found = 2 * float(np.max(shapely.distance(one.shape, places)))
    return _verdict(abs(found - stated) <= max(LOW_METRES, 0.25 * stated), f"{found:.2f} m")


OF_BARRIERS: Mapping[str, Measure] = MappingProxyType(
    {"height": _barrier_height, "min_height": _barrier_foot, "width": _barrier_width}
)


def kerb(city: Finished, place: shapely.Geometry, value: str) -> Found:
    """Compare a kerb with a word of kerb=* or a height of kerb:height=*."""
    height = city.kerb_near(place)
    if value in _KERBS:
        low, high = _KERBS[value]
    else:
        told = _number(value, {**_LENGTHS, "cm": 0.01, "mm": 0.001})
        if told is None or not 0 <= told < 0.5:
            return UNREADABLE, value
        low, high = told - ABOUT, told + ABOUT
    if np.isnan(height):
        return LOST, "no kerb there"
    return _verdict(low <= height <= high, f"{height:.2f} m")


# Metres of the page "Key:kerb" of OpenStreetMap's wiki.
_KERBS: Mapping[str, tuple[float, float]] = MappingProxyType(
    {"flush": (0.0, 0.03), "no": (0.0, 0.03), "lowered": (0.0, 0.06), "rolled": (0.02, 0.3),
     "raised": (0.06, 0.5), "regular": (0.06, 0.5), "yes": (0.0, 0.5)}
)  # fmt: skip


def crossing(city: Finished, place: shapely.Geometry, value: str) -> Found:
    """Compare a crossing of a street with where people cross in the city."""
    lines = city.crosswalks
    off = float(shapely.distance(lines, place).min()) if len(lines) else np.inf
    if value == "no":
        return _verdict(
            off > AT_CROSSING, "nobody crosses" if off > AT_CROSSING else "people cross"
        )
    if off > FAR_OFF:
        return LOST, ""
    return _verdict(off <= AT_CROSSING, f"{off:.1f} m off")


OF_BUILDINGS: Mapping[str, Measure] = MappingProxyType(
    {
        "height": _height, "building:levels": _levels, "roof:shape": _roof_shape,
        "roof:direction": _roof_direction, "roof:orientation": _roof_orientation,
        "building:colour": _color(walls=True), "roof:colour": _color(walls=False),
        "building:material": _material(walls=True), "roof:material": _material(walls=False),
        "name": _building_name,
    }
)  # fmt: skip
# Of a building that the map divides, the parts say these.
OF_PARTS = ("height", "building:levels", "roof:shape", "roof:direction", "roof:orientation",
             "building:colour", "roof:colour", "building:material", "roof:material")  # fmt: skip
OF_ROADS: Mapping[str, Measure] = MappingProxyType(
    {
        "lanes": _lanes, "oneway": _oneway, "maxspeed": _maxspeed, "surface": _surface,
        "name": _road_name, "bridge": _flag("bridge"), "width": _width, "sidewalk": _walks,
        "bus:lanes": _bus_lanes, "bus:lanes:forward": _bus_lanes, "psv:lanes": _bus_lanes,
        "bus:lanes:backward": _bus_lanes,
        **{f"{who}{way}": _permission(f"{who}{way}")
           for who in _WHO for way in ("", ":forward", ":backward")},
    }
)  # fmt: skip
