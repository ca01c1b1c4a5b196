"""Drawings as a source: curves of a GeoJSON file, with what is to be built on them."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.city import City, Frame, Layout
from cityx.city.layout import CURVE, joined_tables, make_table
from cityx.errors import InputError
from cityx.geometry.identity import stable_id

MARGIN = 25.0  # metres of land round the curves
LARGEST = 256 * 2**20  # bytes; a drawing is made by hand or by a program, not by a survey
MOST_FAULTS = 20  # told one by one
LINES = ("LineString", "MultiLineString")


@dataclass(frozen=True)
class Drawing:
    """Curves of a file.

    Attributes
    ----------
    lines
        (n,) LineStrings in longitude and latitude, degrees.
    source
        n texts such as "drawing/3", the number of the feature counted from 0.
    properties
        n mappings of what the file says of each.
    """

    lines: NDArray[Any]
    source: tuple[str, ...]
    properties: tuple[dict[str, Any], ...]


def read_drawing(path: Path) -> Drawing:
    """Read the curves of a GeoJSON file (RFC 7946), in degrees or in metres about an origin.

    A top-level member ``"units": "metres"`` with ``"origin": {"latitude": .., "longitude": ..}``
    says that coordinates are metres east and north of a place.

    Raises
    ------
    InputError
        With every fault of the file.
    """
    document = _document(path)
    frame = _frame_of(document, path)
    faults: list[str] = []
    lines, source, properties = [], [], []
    for number, feature in enumerate(_features(document, path)):
        try:
            parts = _lines_of(feature)
            said = _properties_of(feature)
        except ValueError as error:
            faults.append(f"feature {number} {error}")
            continue
        for place, xy in enumerate(parts):
            lines.append(shapely.LineString(xy if frame is None else frame.to_geographic(xy)))
            source.append(f"drawing/{number}" + (f"/{place}" if place else ""))
            properties.append(said)
    if not faults and not lines:
        faults.append("it has no features")
    if faults:
        more = [f"and {len(faults) - MOST_FAULTS} more"] if len(faults) > MOST_FAULTS else []
        raise InputError(f"{path} is no drawing: {'; '.join([*faults[:MOST_FAULTS], *more])}.")
    return Drawing(np.array(lines, object), tuple(source), tuple(properties))


def _document(path: Path) -> dict[str, Any]:
    try:
        if path.stat().st_size > LARGEST:
            raise InputError(f"{path} is larger than {LARGEST >> 20} MB, too large for a drawing.")
        document = json.loads(path.read_bytes())
    except (OSError, ValueError, RecursionError) as error:
        raise InputError(f"{path} is no GeoJSON: {error}") from error
    if not isinstance(document, dict):
        raise InputError(f"{path} is no GeoJSON: it holds no object.")
    return document


def _frame_of(document: dict[str, Any], path: Path) -> Frame | None:
    """Return the frame of coordinates in metres, or None where they are degrees."""
    units = document.get("units", "degrees")
    if units == "degrees":
        return None
    origin = document.get("origin")
    try:
        place = [float(origin[name]) for name in ("latitude", "longitude")]  # type: ignore[index]
    except (TypeError, KeyError, ValueError):
        place = [np.nan, np.nan]
    if units != "metres" or not (abs(place[0]) < 90.0 and abs(place[1]) <= 180.0):
        raise InputError(
            f'{path}: units are "degrees", or "metres" with an origin such as '
            '{"latitude": 48.2, "longitude": 16.3}.'
        )
    return Frame(*place)


def _features(document: dict[str, Any], path: Path) -> Iterator[Any]:
    kind = document.get("type")
    if kind == "Feature":
        yield document
    elif kind == "FeatureCollection" and isinstance(document.get("features"), list):
        yield from document["features"]
    else:
        raise InputError(f"{path} is no GeoJSON: it is neither Feature nor FeatureCollection.")


def _lines_of(feature: Any) -> list[NDArray[np.float64]]:
    """Return the (k, 2) coordinates of each line of a feature; heights are left out."""
    geometry = feature.get("geometry") if isinstance(feature, dict) else None
    kind = geometry.get("type") if isinstance(geometry, dict) else None
    if kind not in LINES:
        raise ValueError(f"is a {kind}; give lines: {', '.join(LINES)}")
    given = geometry.get("coordinates")  # type: ignore[union-attr]
    parts = given if kind == "MultiLineString" else [given]
    return [_coordinates(part) for part in parts] if isinstance(parts, list) else [_coordinates(0)]


def _coordinates(given: Any) -> NDArray[np.float64]:
    try:
        xy = np.array([[float(number) for number in row[:2]] for row in given], float)
    except (TypeError, ValueError, KeyError):
        xy = np.zeros((0, 2))
    if xy.ndim != 2 or xy.shape[1] != 2 or len(xy) < 2:
        raise ValueError("has coordinates that are no list of two points [x, y] and more")
    if not np.isfinite(xy).all():
        raise ValueError("has a coordinate that is no finite number")
    return xy


def _properties_of(feature: dict[str, Any]) -> dict[str, Any]:
    said = feature.get("properties") or {}
    if not isinstance(said, dict):
        raise ValueError("has properties that are no object")
    return said


def drawn_city(drawing: Drawing, *, seed: int = 0, name: str = "") -> City:
    """Make a city of nothing but curves, about the middle of them."""
    west, south, east, north = shapely.total_bounds(drawing.lines).tolist()
    if not (abs(west) <= 180 and abs(east) <= 180 and abs(south) < 90 and abs(north) < 90):
        raise InputError(
            "The drawing's coordinates are no longitude and latitude; coordinates in metres need "
            '"units": "metres" and an origin.'
        )
    frame = Frame(round((south + north) / 2, 6) + 0.0, round((west + east) / 2, 6) + 0.0)
    city = City(name, frame, Layout((0.0, 0.0, 0.0, 0.0)), seed=seed)
    xmin, ymin, xmax, ymax = shapely.total_bounds(_local(frame, drawing)).tolist()
    extent = (xmin - MARGIN, ymin - MARGIN, xmax + MARGIN, ymax + MARGIN)
    return with_drawing(replace(city, layout=Layout(extent)), drawing)


def with_drawing(city: City, drawing: Drawing) -> City:
    """Return the city with the curves of a drawing among its lines."""
    rows = make_table(
        "lines",
        _local(city.frame, drawing),
        id=[stable_id(CURVE, source) for source in drawing.source],
        source=drawing.source,
        kind=[CURVE] * len(drawing.source),
        tags=[json.dumps(said, sort_keys=True) for said in drawing.properties],
    )
    lines = joined_tables(city.layout.lines, rows)
    layout = replace(city.layout, lines=lines)
    return replace(city, layout=layout, stages_done=city.stages_done | {"layout"})


def _local(frame: Frame, drawing: Drawing) -> NDArray[Any]:
    return np.asarray(shapely.transform(drawing.lines, frame.to_local))
