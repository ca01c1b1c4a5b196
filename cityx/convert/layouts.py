"""From and to layouts: faces, lines, points, geographic data."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import shapely

from cityx.city.city import City
from cityx.city.layout import Layout
from cityx.errors import ActionFailed
from cityx.geometry.polylines import traced
from cityx.protocol import action
from cityx.protocol.values import (
    GeographicData,
    Lines,
    Points,
    Surfaces,
    make_lines,
    make_points,
    make_surfaces,
)
from cityx.sources.features.tagged import KIND


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
        np.concatenate([roads.geometry.to_numpy(), traced(lines.geometry.to_numpy())]),
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
    lossy=0.1,
    cost=2.0,
    limits=["Loses features whose tags are no building, road, area or thing, and forbidden turns."],
)
def geographic_to_layout_conversion(city: City, data: GeographicData) -> Layout:
    """Convert geographic data to a layout in the frame of the city.

    Parameters
    ----------
    city
        City whose frame says where on Earth the layout lies.
    data
        Features with tags in longitude and latitude; each source names one feature.
    """
    from cityx.sources.features.gather import gather
    from cityx.sources.features.resolve import resolve
    from cityx.sources.features.tagged import Owner, Report, tag

    if not len(data.geometry):
        return Layout((-10.0, -10.0, 10.0, 10.0))
    shapes = shapely.transform(data.geometry, city.frame.to_local)
    owners = [
        Owner(tuple(source.split("/")), dict(tags))
        for source, tags in zip(data.source, data.tags, strict=True)
    ]
    xmin, ymin, xmax, ymax = shapely.total_bounds(shapes).tolist()
    features = gather(tag(shapes, owners), (xmin, ymin, xmax, ymax), Report())
    return resolve(features, city.frame, seed=city.seed)


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
    if not np.isfinite([city.frame.latitude, city.frame.longitude]).all():
        raise ActionFailed("The city does not say where on Earth it lies.")
    shapes: list[Any] = []
    tags: list[Mapping[str, str]] = []
    source: list[str] = []
    for name, said in _SAID.items():
        rows = getattr(layout, name)
        shapes += rows.geometry.to_list()
        source += rows["source"].tolist()
        for row in rows.drop(columns="geometry").to_dict("records"):
            tags.append(said(row) | (json.loads(row["tags"]) if row["tags"] else {}))
    geometry = shapely.transform(np.array(shapes, object), city.frame.to_geographic)
    return GeographicData(geometry, tuple(tags), tuple(source), "; ".join(city.attribution))


def _said_of_building(row: Mapping[str, Any]) -> dict[str, str]:
    said = {"building": row["use"], "height": f"{row['height']:g}"}
    return said | {"building:levels": str(row["levels"])}


def _said_of_road(row: Mapping[str, Any]) -> dict[str, str]:
    said = {KIND: row["kind"], "width": f"{row['width']:g}", "lanes": str(row["lanes"])}
    flags = {"oneway": row["oneway"], "bridge": row["bridge"], "tunnel": row["tunnel"]}
    said |= {"surface": row["surface"], "layer": str(row["layer"])}
    return said | {key: "yes" for key, value in flags.items() if value}


def _said_of_kind(row: Mapping[str, Any]) -> dict[str, str]:
    return {KIND: row["kind"]}


_SAID: Mapping[str, Callable[[Mapping[str, Any]], dict[str, str]]] = {
    "buildings": _said_of_building,
    "roads": _said_of_road,
    "areas": _said_of_kind,
    "lines": _said_of_kind,
    "points": _said_of_kind,
}
