"""Drawn lines, areas and points: GeoJSON and GPX files of roads, rivers, borders and routes."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.errors import ShapelyError
from shapely.geometry import shape as geojson_shape

from cityx.city import City, Failure, Frame
from cityx.city.frame import NOWHERE
from cityx.city.layout import CURVE
from cityx.errors import InputError, nearest
from cityx.sources.blend_curves import SUFFIX, read_blend_curves
from cityx.sources.features.gather import gather
from cityx.sources.features.resolve import resolve
from cityx.sources.features.tagged import KIND, Owner, Report, Tags, tag
from cityx.sources.features.vocabulary import RAIL_WORDS, ROAD_TABLE
from cityx.sources.input_kinds import place_name
from cityx.system.tables import table

ACTION = "source/drawn"
MAX_BYTES = 256 << 20  # nobody draws more by hand
MARGIN = 30.0  # metres of ground around what is drawn, where it makes the site
FRAME = (
    "cityx:frame"  # member of a GeoJSON file whose value "metres" says that it is not in degrees
)
# What a drawing may call things, as attributes of a map. Everything else is taken as it is.
WORDS: Mapping[str, Tags] = {
    **table("sources/drawn", dict[str, str]),
    # Streets, paths and rails stay curves: `road/drawn_streets` builds what the drawing asks for.
    **{kind: {KIND: CURVE, "kind": kind} for kind in (*ROAD_TABLE, *RAIL_WORDS)},
}
BOUNDARY = "boundary"
# Keys by which a drawing may use the words of a map instead.
MAP_KEYS = (
    KIND, "building", "building:part", "highway", "railway", "waterway", "natural", "landuse",
    "leisure", "amenity", "barrier", "man_made", "place", "tourism", "power", "emergency",
)  # fmt: skip
# What shapely raises for coordinates that are no coordinates.
UNREADABLE = (TypeError, ValueError, KeyError, AttributeError, IndexError, ShapelyError)
MOST_FAULTS = 10  # told one by one; the rest are counted
FARTHEST = 100_000.0  # metres from the origin


@dataclass(frozen=True)
class Drawing:
    """What a file draws, n shapes.

    Attributes
    ----------
    shapes
        (n,) shapely geometries; longitude and latitude in degrees, or metres.
    owners
        Names and attributes of the shapes.
    boundary
        Polygons that are the site; none when the drawing has no border.
    degrees
        Whether the shapes are in degrees.
    frame
        Frame of shapes in metres, or None where the file does not say.
    """

    shapes: NDArray[Any]
    owners: list[Owner]
    boundary: NDArray[Any]
    degrees: bool
    frame: Frame | None

    @property
    def located(self) -> bool:
        """Whether the file says where on Earth it lies."""
        return self.degrees or self.frame is not None

    @property
    def every(self) -> NDArray[Any]:
        """Shapes and boundary."""
        return np.concatenate([self.shapes, self.boundary])


DEGREES, METRES = "degrees", "metres"
_Place = Frame | str


class _Item(NamedTuple):
    """One thing that is drawn."""

    name: str
    tags: Tags
    shape: Any


def read_drawn(path: Path, *, frame: Frame | None = None, seed: int = 0) -> City:
    """Read a drawing into a city of its own; see `read_drawing` and `city_of_drawing`."""
    return city_of_drawing(read_drawing(path), path.name, frame=frame, seed=seed)


def city_of_drawing(
    drawing: Drawing, name: str, *, frame: Frame | None = None, seed: int = 0, place: str = ""
) -> City:
    """Make a city of a drawing, within its boundary where it draws one.

    Parameters
    ----------
    drawing
        The drawing.
    name
        Of its file.
    frame
        Frame to draw in; that of the drawing, or one about its middle, when left out.
    seed
        Key of every draw for what the drawing does not say.
    place
        Profile of the place that the user asked for, as of `cityx.city.frame.Frame`.
    """
    if not drawing.degrees:
        frame = drawing.frame or frame or NOWHERE
    elif frame is None:
        west, south, east, north = shapely.total_bounds(drawing.every).tolist()
        frame = Frame(round((south + north) / 2, 6) + 0.0, round((west + east) / 2, 6) + 0.0)
    frame = replace(frame, place=place or frame.place)
    shapes, border = drawing.shapes, drawing.boundary
    if drawing.degrees:
        shapes, border = (shapely.transform(item, frame.to_local) for item in (shapes, border))
    if len(border):
        site = shapely.total_bounds(border)
        shapes = shapely.intersection(shapes, shapely.union_all(border))
    else:
        site = shapely.total_bounds(shapes) + MARGIN * np.array([-1, -1, 1, 1])
    report = Report()
    features = gather(tag(shapes, drawing.owners), tuple(site.tolist()), report)
    return City(
        place_name(name),
        frame,
        resolve(features, frame, seed=seed),
        seed=seed,
        stages_done=frozenset({"layout"}),
        failures=tuple(Failure(key, ACTION, why) for key, why in sorted(report.failures)),
        notes=tuple(f"{name}: {number} {what}" for what, number in sorted(report.counts.items())),
    )


def read_drawing(path: Path) -> Drawing:
    """Read the shapes of a file.

    Parameters
    ----------
    path
        .geojson, .json, .gpx or .blend, of which the curve objects are taken.

    Raises
    ------
    InputError
        If the file cannot be read, with every fault found, or draws nothing of use.
    """
    path = Path(path)
    try:
        if path.stat().st_size > MAX_BYTES:
            raise InputError(f"{path} is larger than {MAX_BYTES >> 20} MB; draw less.")
        content = path.read_bytes()
    except OSError as error:
        raise InputError(f"cannot read {path}: {error.strerror}.") from error
    faults: list[str] = []
    items, place = _reader(path)(path, content, faults)
    for item in items:
        faults += _shape_faults(item, degrees=place is DEGREES)
    if faults:
        more = f"; and {len(faults) - MOST_FAULTS} more" if len(faults) > MOST_FAULTS else ""
        raise InputError(f"{path}: {'; '.join(faults[:MOST_FAULTS])}{more}.")
    border = [item.shape for item in items if item.tags.get("kind") == BOUNDARY]
    drawn = [item for item in items if item.tags.get("kind") != BOUNDARY]
    if not drawn:
        raise InputError(f"{path} draws nothing{' but a boundary' if border else ''}.")
    names = ("drawn", path.name)
    owners = [Owner((*names, item.name), _meaning(item.tags)) for item in drawn]
    shapes = np.array([item.shape for item in drawn], object)
    frame = place if isinstance(place, Frame) else None
    return Drawing(shapes, owners, np.array(border, object), place is DEGREES, frame)


def _reader(path: Path) -> Callable[[Path, bytes, list[str]], tuple[list[_Item], _Place]]:
    name = path.name.lower()
    return _gpx if name.endswith(".gpx") else _blend if name.endswith(SUFFIX) else _geojson


def _blend(path: Path, content: bytes, faults: list[str]) -> tuple[list[_Item], _Place]:
    """Take curve objects; a property "kind" says what each is, else somebody goes along it."""
    del content, faults
    held = read_blend_curves(path)
    items = [
        _Item(name, {"kind": "route"} | _tags(held.properties[name]),
              shapely.MultiLineString(lines) if len(lines) > 1 else shapely.LineString(lines[0]))
        for name, lines in held.lines.items() if lines
    ]  # fmt: skip
    return items, METRES


def _meaning(tags: Tags) -> Tags:
    """Put the plain word of a drawing into the words of a map."""
    said = WORDS.get(tags.get("kind", ""), {})
    return {**{key: value for key, value in tags.items() if key != "kind"}, **said}


def _shape_faults(item: _Item, *, degrees: bool) -> list[str]:
    shape, word = item.shape, item.tags.get("kind", "")
    faults = []
    if shapely.is_empty(shape):
        faults.append("has no coordinates")
    elif not np.isfinite(shapely.get_coordinates(shape)).all():
        faults.append("has coordinates that are no numbers")
    elif degrees and not (np.abs(shape.bounds) <= [180, 90, 180, 90]).all():
        faults.append(
            "has coordinates outside longitude and latitude; a drawing in metres says "
            '"units": "metres" beside its "type"'
        )
    elif not degrees and np.abs(shape.bounds).max() > FARTHEST:
        faults.append(f"reaches farther than {FARTHEST:g} m from the origin")
    elif (shape.length if shapely.get_dimensions(shape) == 1 else 1.0) == 0.0:
        faults.append("is a line without length")
    if word and word not in WORDS and word != BOUNDARY:
        faults.append(
            f'has the kind "{word}", which has no meaning.{nearest(word, WORDS)}'.rstrip(".")
        )
    elif word == BOUNDARY and not (shapely.get_dimensions(shape) == 2 and shape.is_valid):
        faults.append("is a boundary, but no polygon that does not cross itself")
    elif not word and not any(key in item.tags for key in MAP_KEYS):
        faults.append('has no "kind" and no tag of a map that says what it is')
    return [f"{item.name} {fault}" for fault in faults]


def _geojson(path: Path, content: bytes, faults: list[str]) -> tuple[list[_Item], _Place]:
    try:
        document = json.loads(content)
    except ValueError as error:
        raise InputError(f"{path} is not JSON ({error}).") from error
    if not isinstance(document, dict) or "type" not in document:
        raise InputError(f'{path} is no GeoJSON: it is no object with a "type".')
    crs = document.get("crs")
    if crs is not None and not any(word in json.dumps(crs) for word in ("CRS84", "4326")):
        faults.append(f"the coordinate system {json.dumps(crs)} is not WGS84; convert it first")
    items = []
    for number, feature in _features(document, faults):
        name = f"feature {feature.get('id', number)}"
        try:
            shape = shapely.force_2d(geojson_shape(feature["geometry"]))
        except UNREADABLE as error:
            faults.append(f"{name} has a geometry that cannot be read ({error})")
            continue
        items.append(_Item(name, _tags(feature.get("properties")), shape))
    return items, _origin(document, faults)


def _origin(document: Mapping[str, Any], faults: list[str]) -> _Place:
    """Return what coordinates are: degrees, metres of a frame, or metres of none."""
    units, origin = document.get("units", "degrees"), document.get("origin")
    if units == "degrees":
        return DEGREES
    if units != "metres":
        faults.append(f'"units" is "{units}"; it may be "degrees" or "metres"')
    if origin is None:
        return METRES
    try:
        frame = Frame(float(origin["latitude"]), float(origin["longitude"]))
        if abs(frame.latitude) < 90.0 and abs(frame.longitude) <= 180.0:
            return frame
    except (TypeError, KeyError, ValueError):
        pass
    faults.append('"origin" is not like {"latitude": 48.2, "longitude": 16.3}')
    return METRES


def _features(
    document: Mapping[str, Any], faults: list[str]
) -> Iterator[tuple[int, Mapping[str, Any]]]:
    """Yield the features of a GeoJSON object that have a geometry, and their numbers."""
    kind = document["type"]
    if kind == "FeatureCollection":
        found = document.get("features")
    else:
        found = [document if kind == "Feature" else {"geometry": document, "properties": {}}]
    if not isinstance(found, list):
        faults.append('"features" is no list')
        return
    for number, feature in enumerate(found):
        if not isinstance(feature, dict) or not isinstance(feature.get("geometry"), dict):
            faults.append(f"feature {number} has no geometry")
        else:
            yield number, feature


def _tags(properties: object) -> Tags:
    """Return properties as tags: numbers and yes or no written out, what is nested left out."""
    said: Tags = {}
    for key, value in (properties if isinstance(properties, dict) else {}).items():
        if isinstance(value, bool):
            said[key] = "yes" if value else "no"
        elif isinstance(value, str | int | float):
            said[key] = str(value)
    return said


def _gpx(path: Path, content: bytes, faults: list[str]) -> tuple[list[_Item], _Place]:
    from lxml import etree

    parser = etree.XMLParser(resolve_entities=False, no_network=True, load_dtd=False)
    try:
        root = etree.fromstring(content, parser)
    except etree.XMLSyntaxError as error:
        raise InputError(f"{path} is not XML ({error.msg}).") from error
    if etree.QName(root).localname != "gpx":
        raise InputError(f"{path} is XML with root <{etree.QName(root).localname}>, not <gpx>.")
    items = []
    for name, element, parts in _gpx_parts(root):
        lines = [_gpx_points(part, name, faults) for part in parts]
        shape = shapely.MultiLineString([line for line in lines if len(line) > 1])
        items.append(_Item(name, _gpx_tags(element), shape))
    for number, element in enumerate(root.iterfind("{*}wpt")):
        if element.findtext("{*}type"):  # a waypoint without a type marks a place, not a thing
            name = f"waypoint {number}"
            place = _gpx_points([element], name, faults)[0]
            items.append(_Item(name, _gpx_tags(element), shapely.Point(place)))
    return items, DEGREES


def _gpx_parts(root: Any) -> Iterator[tuple[str, Any, list[Any]]]:
    """Yield the name, the element and the lists of points of every track and route."""
    for number, element in enumerate(root.iterfind("{*}trk")):
        parts = [segment.findall("{*}trkpt") for segment in element.iterfind("{*}trkseg")]
        yield f"track {number}", element, parts
    for number, element in enumerate(root.iterfind("{*}rte")):
        yield f"route {number}", element, [element.findall("{*}rtept")]


def _gpx_tags(element: Any) -> Tags:
    kind = (element.findtext("{*}type") or "").strip().lower()
    return {"kind": kind or "route", "name": element.findtext("{*}name") or ""}


def _gpx_points(elements: list[Any], name: str, faults: list[str]) -> list[tuple[float, float]]:
    """Return longitude and latitude of points, degrees."""
    try:
        return [(float(point.get("lon", "")), float(point.get("lat", ""))) for point in elements]
    except ValueError:
        faults.append(f"{name} has a point whose lat and lon are no numbers")
        return [(0.0, 0.0), (1.0, 1.0)]
