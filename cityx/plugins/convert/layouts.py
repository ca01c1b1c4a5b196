"""From and to layouts: faces, lines, points, geographic data."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

import numpy as np
import shapely

from cityx.city.city import City
from cityx.city.layout import Layout
from cityx.errors import ActionFailed
from cityx.plugins.convert.lines import line_to_layout_conversion
from cityx.plugins.convert.points import point_to_layout_conversion
from cityx.plugins.convert.surfaces import LEVEL_HEIGHT, face_to_layout_conversion
from cityx.protocol import action
from cityx.protocol.deposit import merged
from cityx.protocol.values import (
    GeographicData,
    Lines,
    Points,
    Surfaces,
    make_lines,
    make_points,
    make_surfaces,
)


@action(
    "convert/layout_to_face_conversion-v1",
    classname="Layout_to_face_conversion",
    extension=True,
    lossy=0.3,
    limits=["Loses lines, points, building parts and roofs."],
)
def layout_to_face_conversion(layout: Layout) -> Surfaces:
    """Convert a layout to faces: building outlines with their heights, then areas.

    Parameters
    ----------
    layout
        The layout.
    """
    buildings, areas = layout.buildings, layout.areas
    height = np.concatenate([buildings["height"].to_numpy(float), np.full(len(areas), np.nan)])
    return make_surfaces(
        np.concatenate([buildings.geometry.to_numpy(), areas.geometry.to_numpy()]),
        ["building"] * len(buildings) + areas["kind"].tolist(),
        height,
        np.concatenate([buildings["id"].to_numpy(), areas["id"].to_numpy()]).astype(np.uint64),
    )


@action(
    "convert/layout_to_line_conversion-v1",
    classname="Layout_to_line_conversion",
    extension=True,
    lossy=0.4,
    limits=["Loses areas, points and what roads carry besides class and width."],
)
def layout_to_line_conversion(layout: Layout) -> Lines:
    """Convert a layout to lines: centrelines of roads with their widths, then barriers.

    Parameters
    ----------
    layout
        The layout.
    """
    roads, lines = layout.roads, layout.lines
    width = np.concatenate([roads["width"].to_numpy(float), np.full(len(lines), np.nan)])
    return make_lines(
        np.concatenate([roads.geometry.to_numpy(), lines.geometry.to_numpy()]),
        roads["kind"].tolist() + lines["kind"].tolist(),
        width,
        np.concatenate([roads["id"].to_numpy(), lines["id"].to_numpy()]).astype(np.uint64),
    )


@action(
    "convert/layout_to_point_conversion-v1",
    classname="Layout_to_point_conversion",
    extension=True,
    lossy=0.6,
    limits=["Loses everything but the things at a place."],
)
def layout_to_point_conversion(layout: Layout) -> Points:
    """Convert a layout to the points of its things.

    Parameters
    ----------
    layout
        The layout.
    """
    rows = layout.points
    return make_points(shapely.get_coordinates(rows.geometry.to_numpy()), rows["kind"].tolist())


@action(
    "convert/geographic_to_layout_conversion-v1",
    classname="Geographic_to_layout_conversion",
    extension=True,
    lossy=0.2,
    cost=2.0,
    limits=[
        "Loses features whose tags are no building, road, area or thing, and the uses, widths and "
        "roofs that tags say; reading the map file itself keeps them."
    ],
)
def geographic_to_layout_conversion(city: City, data: GeographicData) -> Layout:
    """Convert geographic data to a layout in the frame of the city.

    Parameters
    ----------
    city
        City whose frame says where on Earth the layout lies.
    data
        Features with tags in longitude and latitude.
    """
    if not len(data.geometry):
        return Layout((-10.0, -10.0, 10.0, 10.0))
    shapes = shapely.transform(data.geometry, city.frame.to_local)
    faces: dict[str, list[Any]] = {"shape": [], "kind": [], "height": []}
    lines: dict[str, list[Any]] = {"shape": [], "kind": [], "height": []}
    points: dict[str, list[Any]] = {"shape": [], "kind": [], "height": []}
    for shape, tags in zip(shapes, data.tags, strict=True):
        for part in shapely.get_parts(shape):
            table = {"Polygon": faces, "LineString": lines, "Point": points}.get(part.geom_type)
            kind = _kind(tags, part.geom_type)
            if table is not None and kind:
                table["shape"].append(part)
                table["kind"].append(kind)
                table["height"].append(_height(tags))
    xy = shapely.get_coordinates(np.array(points["shape"], object))
    made = face_to_layout_conversion(
        make_surfaces(np.array(faces["shape"], object), faces["kind"], faces["height"])
    )
    made = merged(made, line_to_layout_conversion(make_lines(lines["shape"], lines["kind"])))
    made = merged(made, point_to_layout_conversion(make_points(xy, points["kind"])))
    return Layout(
        tuple(shapely.total_bounds(shapes).tolist()),
        made.buildings, made.parts, made.roads, made.areas, made.lines, made.points,
    )  # fmt: skip


KIND = "cityx:kind"  # tag that carries the layout's own word where OpenStreetMap has none


def _kind(tags: Mapping[str, str], shape: str) -> str:
    """Return the layout's word for a feature, or ""."""
    from cityx.sources.features.kinds import (
        building_kind,
        land_kind,
        line_kind,
        point_kind,
        road_kind,
    )

    said = dict(tags)
    if KIND in said:
        return said[KIND]
    if shape == "Polygon":
        return "building" if building_kind(said) == "building" else land_kind(said)
    if shape == "LineString":
        return road_kind(said) or line_kind(said)
    return point_kind(said)


def _height(tags: Mapping[str, str]) -> float:
    for key, metres in (("height", 1.0), ("building:levels", LEVEL_HEIGHT)):
        try:
            value = float(tags.get(key, "").removesuffix("m")) * metres
        except ValueError:
            continue
        if 0 < value < 1000:
            return value
    return float("nan")


@action(
    "convert/layout_to_geographic_conversion-v1",
    classname="Layout_to_geographic_conversion",
    extension=True,
    lossy=0.1,
    limits=["Loses building parts; the layout must be that of the city's own frame."],
)
def layout_to_geographic_conversion(city: City, layout: Layout) -> GeographicData:
    """Convert a layout to features in longitude and latitude, by the frame of the city.

    Parameters
    ----------
    city
        City whose frame says where on Earth the layout lies.
    layout
        The layout.
    """
    shapes: list[Any] = []
    tags: list[Mapping[str, str]] = []
    source: list[str] = []
    for name, word, column in _FEATURES:
        rows = getattr(layout, name)
        shapes += rows.geometry.to_list()
        source += rows["source"].tolist()
        heights = rows["height"].tolist() if name == "buildings" else [None] * len(rows)
        for kind, height, text in zip(rows[column], heights, rows["tags"], strict=True):
            said = {} if height is None else {"height": f"{height:g}"}
            tags.append({word: kind, **said, **(json.loads(text) if text else {})})
    if not np.isfinite([city.frame.latitude, city.frame.longitude]).all():
        raise ActionFailed("The city does not say where on Earth it lies.")
    geometry = shapely.transform(np.array(shapes, object), city.frame.to_geographic)
    return GeographicData(geometry, tuple(tags), tuple(source), "; ".join(city.attribution))


_FEATURES = (
    ("buildings", "building", "use"),
    ("roads", KIND, "kind"),
    ("areas", KIND, "kind"),
    ("lines", KIND, "kind"),
    ("points", KIND, "kind"),
)
