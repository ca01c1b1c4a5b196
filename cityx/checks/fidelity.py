"""Fidelity: what a map states, read a second time, held against the finished city.

The file is read here by osmium and the tags are understood by the tables of this module alone, so
that a fault of the importer is not repeated by its check. Each stated fact is kept, departed from,
lost with its object, or unreadable.
"""

from __future__ import annotations

import re
import tempfile
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.assets.styles.materials import srgb_to_linear
from cityx.checks.predicates.building_predicates import Buildings
from cityx.checks.predicates.thing_predicates import CannotTell
from cityx.city import City
from cityx.city.section import BAND_KINDS
from cityx.geometry.arrays import FloatArray

KEPT, DEPARTED, LOST, UNREADABLE = "kept", "departed", "lost", "unreadable"
VERDICTS = (KEPT, DEPARTED, LOST, UNREADABLE)
SUFFIXES = (".osm", ".osm.gz", ".osm.bz2", ".osm.pbf", ".pbf")
MOST_IDS = 20  # of each tag, in a report
METRES, SHARE = 0.5, 0.03  # by which a height may differ, whichever is more
WIDTH = 0.10  # share by which a width may differ
TURN = 5.0  # degrees
SPEED = 1.0  # km/h
COLOUR = 0.14  # of the distance of two colours in OKLab, white to black being 1

# -- the second reading ----------------------------------------------------------------------------

# Nodes that something stands for in the scene: tag -> how the names of its prototypes begin, and
# how far off it may stand, metres; signals and stops stand beside the way that the node is of.
_STANDING: Mapping[tuple[str, str], tuple[tuple[str, ...], float]] = MappingProxyType(
    {
        ("natural", "tree"): ((), 5.0), ("amenity", "bench"): (("bench",), 5.0),
        ("amenity", "waste_basket"): (("waste_basket",), 5.0),
        ("amenity", "post_box"): (("post_box",), 5.0),
        ("amenity", "bicycle_parking"): (("bicycle_parking",), 5.0),
        ("highway", "street_lamp"): (("street_lamp", "lamp"), 5.0),
        ("highway", "traffic_signals"): (("traffic_signal",), 30.0),
        ("highway", "bus_stop"): (("bus_stop", "bus_pole"), 12.0),
        ("emergency", "fire_hydrant"): (("fire_hydrant",), 5.0),
        ("barrier", "bollard"): (("bollard",), 5.0),
    }
)  # fmt: skip
FURNISHED = 2  # least level of detail that has what stands in streets
# Lines and areas that must be in the city: key -> values, () for all.
_GROUND: Mapping[str, tuple[str, ...]] = MappingProxyType(
    {
        "natural": ("water", "wood", "beach", "scrub", "grassland"),
        "waterway": ("river", "stream", "canal", "ditch", "drain"),
        "railway": ("rail", "tram", "light_rail", "narrow_gauge"),
        "barrier": ("wall", "fence", "hedge", "city_wall", "retaining_wall"),
        "power": ("line", "minor_line"),
        "leisure": ("park", "garden", "pitch", "playground"),
        "landuse": ("grass", "forest", "meadow", "cemetery", "reservoir"),
    }
)  # fmt: skip
_NEGATIVE = ("no", "none", "false", "0")


@dataclass(frozen=True)
class Feature:
    """An object of a map: "way/12", its tags, and its shape in degrees or the metres of a city."""

    name: str
    tags: Mapping[str, str]
    shape: shapely.Geometry


def is_map(path: Path) -> bool:
    """Return whether a file is a map of OpenStreetMap, by its name."""
    return path.name.lower().endswith(SUFFIXES)


def features(path: Path) -> list[Feature]:
    """Read the tagged objects of an OSM file, relations of areas too; broken ones are left out."""
    import osmium

    try:
        return _read(path)
    except RuntimeError as fault:
        if "out of order" not in str(fault):
            raise
    with tempfile.TemporaryDirectory() as folder:
        ordered = Path(folder) / "ordered.osm.pbf"
        reader = osmium.MergeInputReader()
        reader.add_file(str(path))
        with osmium.SimpleWriter(str(ordered)) as writer:
            reader.apply(writer)
        return _read(ordered)


def _read(path: Path) -> list[Feature]:
    import osmium

    factory = osmium.geom.WKBFactory()
    found: dict[str, Feature] = {}
    for one in osmium.FileProcessor(str(path)).with_areas():
        tags = {tag.k: tag.v for tag in one.tags}
        if not tags:
            continue
        try:
            name, shape = _shaped(one, factory)
        except (RuntimeError, osmium.InvalidLocationError):
            continue
        if name and (name not in found or shape.geom_type.endswith("Polygon")):
            found[name] = Feature(name, tags, shape)
    return [found[name] for name in sorted(found)]


def _shaped(one: Any, factory: Any) -> tuple[str, shapely.Geometry]:
    """Return the name and the shape of an object; an area is of the way or relation it is of."""
    if one.is_node():
        return f"node/{one.id}", shapely.from_wkb(factory.create_point(one))
    if one.is_way():
        return f"way/{one.id}", shapely.from_wkb(factory.create_linestring(one))
    if one.is_area():
        kind = "way" if one.from_way() else "relation"
        return f"{kind}/{one.orig_id()}", shapely.from_wkb(factory.create_multipolygon(one))
    return "", shapely.Point()


# -- the finished city -----------------------------------------------------------------------------


class Finished:
    """What stands in a city, by the names of the map's objects; and the parts of buildings in it.

    Parameters
    ----------
    city
        The city.
    mapped_parts
        Shapes of the parts of buildings that the map draws, in the metres of the city.
    """

    def __init__(self, city: City, mapped_parts: NDArray[Any]) -> None:
        self.city = city
        self.mapped_parts = mapped_parts
        self._colors: dict[bool, Mapping[str, FloatArray]] = {}
        self._trees_of: dict[tuple[str, ...], shapely.STRtree] = {}

    @cached_property
    def buildings(self) -> Mapping[str, int]:
        """Rows of the buildings."""
        return _rows(self.city.layout.buildings)

    @cached_property
    def roads(self) -> Mapping[str, int]:
        """Rows of the streets."""
        return _rows(self.city.layout.roads)

    @cached_property
    def kinds(self) -> Mapping[str, frozenset[str]]:
        """Kinds of what is built of each object; one way may be a street and a tram line."""
        layout = self.city.layout
        found: dict[str, set[str]] = {name: {"building"} for name in self.buildings}
        for table in (layout.areas, layout.lines, layout.points, layout.roads):
            pairs = zip(table["source"].to_numpy(str), table["kind"].to_numpy(str), strict=True)
            for source, kind in pairs:
                found.setdefault(source.removeprefix("osm/"), set()).add(kind)
        return {name: frozenset(kinds) for name, kinds in found.items()}

    @cached_property
    def parts(self) -> Mapping[int, NDArray[np.int64]]:
        """Rows of the parts of each building, the largest first."""
        table = self.city.layout.parts
        owner = table["building"].to_numpy(np.uint64)
        return _grouped(owner, np.argsort(-shapely.area(table.geometry.to_numpy()), kind="stable"))

    @cached_property
    def edges(self) -> Mapping[int, NDArray[np.int64]]:
        """Edges of each row of the streets."""
        network = self.city.network
        if network is None:
            return {}
        return _grouped(network.edge_road, np.arange(len(network.edge_road)))

    @cached_property
    def _standing(self) -> Mapping[str, FloatArray]:
        """Places of all that stands in the scene, by the names of its prototypes; trees by ""."""
        names = np.array([one.name for one in self.city.scene.prototypes], str)
        found: dict[str, list[FloatArray]] = {}
        for group, table in self.city.scene.instances.items():
            places = np.asarray(table.position[:, :2], float)
            if group == "trees":
                found.setdefault("", []).append(places)
                continue
            for kind in np.unique(table.prototype).tolist():
                found.setdefault(str(names[kind]), []).append(places[table.prototype == kind])
        return {name: np.vstack(places) for name, places in found.items()}

    def is_near(self, begins: tuple[str, ...], place: shapely.Geometry, far: float) -> bool:
        """Return whether something of a kind stands near a place; trees where no name is given."""
        if begins not in self._trees_of:
            chosen = [
                places for name, places in self._standing.items()
                if (name.startswith(begins) if begins else not name)
            ]  # fmt: skip
            points = shapely.points(np.vstack(chosen)) if chosen else []
            self._trees_of[begins] = shapely.STRtree(points)
        return len(self._trees_of[begins].query(place, "dwithin", far)) > 0

    def colors(self, walls: bool) -> Mapping[str, FloatArray]:
        """Return the mean colours of the meshes of walls or roofs, linear RGB, by building."""
        if walls not in self._colors:
            means = dict(zip(self._looks.ids.tolist(), self._looks.mean_colors(walls=walls),
                             strict=True))  # fmt: skip
            ids = self.city.layout.buildings["id"].to_numpy(np.uint64).tolist()
            names = self.buildings.items()
            self._colors[walls] = {name: means[ids[row]] for name, row in names
                                   if ids[row] in means}  # fmt: skip
        return self._colors[walls]

    @cached_property
    def _looks(self) -> Buildings:
        """The buildings as predicates see them."""
        return Buildings(self.city, "building")

    @cached_property
    def _mapped_parts(self) -> shapely.STRtree:
        return shapely.STRtree(self.mapped_parts)

    def left_of(self, outline: shapely.Geometry) -> float:
        """Return the area of an outline on which the map draws no part, square metres."""
        near = self._mapped_parts.query(outline, "intersects")
        return float(shapely.difference(outline, shapely.union_all(self.mapped_parts[near])).area)

    def parts_of(self, name: str) -> NDArray[np.int64]:
        """Return the rows of the parts of a building."""
        row = self.buildings[name]
        building = int(self.city.layout.buildings["id"].to_numpy(np.uint64)[row])
        return self.parts.get(building, np.zeros(0, np.int64))

    def part(self, name: str, column: str) -> Any:
        """Return a value of the largest part of a building."""
        return self.city.layout.parts[column].to_numpy()[self.parts_of(name)[0]]

    def lanes_of(self, name: str) -> list[NDArray[np.int64]]:
        """Return the lanes for vehicles of each edge of a street, those of one edge together."""
        row = self.roads.get(name, -1)
        none = np.zeros(0, np.int64)
        return [self._lanes.get(int(edge), none) for edge in self.edges.get(row, ())]

    @cached_property
    def _lanes(self) -> Mapping[int, NDArray[np.int64]]:
        """Lanes for vehicles of each edge of the network."""
        lanes = self.city.lanes
        if lanes is None:
            return {}
        driven = np.isin(lanes.kind, [BAND_KINDS.index("drive"), BAND_KINDS.index("bus")])
        return _grouped(lanes.edge, np.flatnonzero(driven))


def _grouped(key: NDArray[Any], rows: NDArray[np.int64]) -> dict[int, NDArray[np.int64]]:
    """Return rows by their keys, in the order that they come in."""
    if not len(rows):
        return {}
    ordered = rows[np.argsort(key[rows], kind="stable")]
    keys, first = np.unique(key[ordered], return_index=True)
    return dict(zip(keys.tolist(), np.split(ordered, first[1:]), strict=True))


def _rows(table: Any) -> dict[str, int]:
    sources = table["source"].to_numpy(str)
    return {one.removeprefix("osm/"): row for row, one in enumerate(sources.tolist()) if one}


# -- measures --------------------------------------------------------------------------------------

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
_PLAIN = {"": 1.0}


def _height(city: Finished, one: Feature, value: str) -> Found:
    stated = _number(value, _LENGTHS)
    if stated is None or not 0 < stated < 1000:
        return UNREADABLE, value
    rows = city.parts_of(one.name)
    top = city.city.layout.parts["top"].to_numpy(float)[rows]
    found = float(top.max()) if len(top) else 0.0
    return _verdict(abs(found - stated) <= max(METRES, SHARE * stated), f"{found:.1f} m")


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


def _roof_shape(city: Finished, one: Feature, value: str) -> Found:
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
        far = float(np.linalg.norm(_oklab(mean) - _oklab(stated)))
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


def _building_name(city: Finished, one: Feature, value: str) -> Found:
    found = str(city.city.layout.buildings["name"].to_numpy()[city.buildings[one.name]])
    return _verdict(found == value, found)


def _lanes(city: Finished, one: Feature, value: str) -> Found:
    stated = _number(value, _PLAIN)
    if stated is None or not 0 < stated < 30:
        return UNREADABLE, value
    counts = [_beside_each_other(city, lanes) for lanes in city.lanes_of(one.name)]
    if not counts:
        return KEPT, "too short for a lane of its own"
    most = max(set(counts), key=counts.count)
    return _verdict(stated in counts, most)


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
    ends = [lanes.points[lanes.point_start[[lane, lane + 1]] - [0, 1]] for lane in cars.tolist()]
    ways = {_along(one.shape, places) for places in ends}
    return _verdict(ways <= {wanted, 0}, sorted(ways))


def _along(way: shapely.Geometry, ends: FloatArray) -> int:
    """Return 1 for a lane that leads along a way as it is drawn, -1 against it, 0 for no way."""
    start, end = shapely.line_locate_point(way, shapely.points(ends))
    return int(np.sign(np.round(end - start, 2)))


def _maxspeed(city: Finished, one: Feature, value: str) -> Found:
    stated = _number(value, _SPEEDS)
    lanes = city.city.lanes
    if stated is None:
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


def _surface(city: Finished, one: Feature, value: str) -> Found:
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


_OF_BUILDINGS: Mapping[str, Measure] = MappingProxyType(
    {
        "height": _height, "building:levels": _levels, "roof:shape": _roof_shape,
        "roof:direction": _roof_direction, "roof:orientation": _roof_orientation,
        "building:colour": _color(walls=True), "roof:colour": _color(walls=False),
        "name": _building_name,
    }
)  # fmt: skip
# Of a building that the map divides, the parts say these.
_OF_PARTS = ("height", "building:levels", "roof:shape", "roof:direction", "roof:orientation",
             "building:colour", "roof:colour")  # fmt: skip
_OF_ROADS: Mapping[str, Measure] = MappingProxyType(
    {
        "lanes": _lanes, "oneway": _oneway, "maxspeed": _maxspeed, "surface": _surface,
        "name": _road_name, "bridge": _flag("bridge"), "width": _width,
    }
)  # fmt: skip
_DRIVEN = ("motorway", "trunk", "primary", "secondary", "tertiary", "unclassified", "residential",
           "living_street", "service", "motorway_link", "trunk_link", "primary_link",
           "secondary_link", "tertiary_link", "road")  # fmt: skip


_STREETS = frozenset((*_DRIVEN, "footway", "path", "cycleway", "pedestrian", "track", "steps"))

# -- facts -----------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Fact:
    """Something that a map states of an object.

    Attributes
    ----------
    tag
        "height", "highway=residential"...
    name
        "way/12".
    stated, found
        Of the map and of the city, as text.
    verdict
        One of `VERDICTS`.
    """

    tag: str
    name: str
    stated: str
    found: str
    verdict: str


def facts(city: City, path: Path) -> Iterator[Fact]:
    """Yield what a map states of all that lies inside a city, each with what became of it."""
    known = features(path)
    shapes = _in_frame(city, [one.shape for one in known])
    parts = [one.tags.get("building:part", "no") != "no" for one in known]
    finished = Finished(city, shapes[np.array(parts, bool)])
    site = shapely.box(*city.layout.extent)
    inside = shapely.intersects(shapes, site) & ~shapely.is_empty(shapes)
    divided = _divided(known, shapes)
    for one, shape, near in zip(known, shapes, inside, strict=True):
        if near:
            placed = replace(one, shape=shape)
            yield from _facts_of(finished, placed, site, divided=one.name in divided)


def _in_frame(city: City, shapes: list[shapely.Geometry]) -> NDArray[Any]:
    """Return shapes in degrees in the metres of a city, by its projection."""
    import pyproj

    to_metres = pyproj.Transformer.from_crs("EPSG:4326", city.frame.projection, always_xy=True)

    def moved(places: FloatArray) -> FloatArray:
        return np.column_stack(to_metres.transform(places[:, 0], places[:, 1]))

    return np.asarray(shapely.transform(np.array(shapes, object), moved))


def _covered(city: Finished, one: Feature) -> bool:
    """Return whether parts of the map leave nothing of an outline to which it says a height."""
    return bool(city.left_of(one.shape) < 0.05 * one.shape.area)


def _divided(known: list[Feature], shapes: NDArray[Any]) -> frozenset[str]:
    """Return the names of the buildings in which the map has parts."""
    parts = [k for k, one in enumerate(known) if one.tags.get("building:part", "no") != "no"]
    wholes = [k for k, one in enumerate(known) if one.tags.get("building", "no") != "no"]
    if not parts or not wholes:
        return frozenset()
    tree = shapely.STRtree(shapely.point_on_surface(shapes[parts]))
    whole, _ = tree.query(shapes[wholes], predicate="intersects")
    return frozenset(known[wholes[k]].name for k in np.unique(whole).tolist())


def _facts_of(
    city: Finished, one: Feature, site: shapely.Geometry, *, divided: bool
) -> Iterator[Fact]:
    tags, shape = one.tags, one.shape
    area = shape.geom_type.endswith("Polygon")
    whole = shapely.within(shapely.point_on_surface(shape), site)
    if area and tags.get("building", "no") != "no" and whole:
        stands = one.name in city.buildings
        yield Fact("building", one.name, tags["building"], "", KEPT if stands else LOST)
        if divided and "height" in tags and stands and not _covered(city, one):
            yield _fact("height", one, _height(city, one, tags["height"]))
        for tag, measure in _OF_BUILDINGS.items():
            if tag in tags and not (divided and tag in _OF_PARTS):
                lost = not stands or not len(city.parts_of(one.name))
                yield _fact(tag, one, (LOST, "") if lost else measure(city, one, tags[tag]))
    elif not area and tags.get("highway") in _DRIVEN and shape.length > 0:
        built = one.name in city.roads
        yield Fact("highway", one.name, tags["highway"], "", KEPT if built else LOST)
        for tag, measure in _OF_ROADS.items():
            if tag in tags:
                yield _fact(tag, one, measure(city, one, tags[tag]) if built else (LOST, ""))
    yield from _things_of(city, one)


def _things_of(city: Finished, one: Feature) -> Iterator[Fact]:
    """Yield whether what a feature is stands in the scene, or lies on the ground."""
    shape = one.shape
    if shape.geom_type == "Point":
        for (key, value), (begins, far) in _STANDING.items():
            if one.tags.get(key) == value and city.city.lod >= FURNISHED:
                verdict = KEPT if city.is_near(begins, shape, far) else LOST
                yield Fact(f"{key}={value}", one.name, value, "", verdict)
        return
    for key, values in _GROUND.items():
        if one.tags.get(key) in values:
            there = city.kinds.get(one.name, frozenset()) - _STREETS
            yield Fact(f"{key}={one.tags[key]}", one.name, one.tags[key], "",
                       KEPT if there else LOST)  # fmt: skip


def _fact(tag: str, one: Feature, found: Found) -> Fact:
    return Fact(tag, one.name, one.tags[tag], found[1], found[0])


def fidelity(city: City, path: Path) -> dict[str, Any]:
    """Return per tag how much of what a map states is kept, with names of what is not.

    Parameters
    ----------
    city
        The finished city.
    path
        The OSM file that it was built from.

    Returns
    -------
    table
        ``share`` of the readable facts that are kept, and ``tags``: of each how many are stated,
        kept, departed, lost and unreadable, and up to 20 of those with what was stated and found.
    """
    rows: dict[str, dict[str, Any]] = {}
    import osmium

    try:
        told = list(facts(city, path))
    except (RuntimeError, ValueError, osmium.InvalidLocationError) as fault:
        # osmium is stricter than the importer, of positions and of lengths of tags.
        return {"share": None, "stated": 0, "tags": {}, "error": str(fault)}
    for fact in told:
        row = rows.setdefault(fact.tag, {"stated": 0, **dict.fromkeys(VERDICTS, 0), "which": []})
        row["stated"] += 1
        row[fact.verdict] += 1
        if fact.verdict != KEPT and len(row["which"]) < MOST_IDS:
            row["which"].append([fact.name, fact.verdict, fact.stated, fact.found])
    readable = sum(row["stated"] - row[UNREADABLE] for row in rows.values())
    kept = sum(row[KEPT] for row in rows.values())
    share = round(kept / readable, 6) if readable else 1.0
    return {"share": share, "stated": readable, "tags": dict(sorted(rows.items()))}
