"""Whole layouts: joined, cut to a window, taken to another frame."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.city.frame import Frame
from cityx.city.layout import SCHEMA, Layout, joined_tables
from cityx.ids import hash_ids

if TYPE_CHECKING:
    from geopandas import GeoDataFrame

Box = tuple[float, float, float, float]

MARGIN = 15.0  # metres; no building touches the border of its site
WINDOW = 1000.0  # metres of a window whose centre alone is said


def merged(old: Layout, new: Layout) -> Layout:
    """Join two layouts of one frame; rows of the new one replace rows of the same id."""
    tables = {name: joined_tables(getattr(old, name), getattr(new, name)) for name in SCHEMA}
    corners = np.array([old.extent, new.extent])
    low, high = corners[:, :2].min(axis=0), corners[:, 2:].max(axis=0)
    return Layout((*low.tolist(), *high.tolist()), **tables)


def moved(layout: Layout, old: Frame, new: Frame) -> Layout:
    """Take a layout from one frame to another."""
    if old == new:
        return layout

    def place(points: NDArray[Any]) -> NDArray[Any]:
        return new.to_local(old.to_geographic(points))

    tables = {name: getattr(layout, name) for name in SCHEMA}
    for name, table in tables.items():
        if len(table):
            tables[name] = table.set_geometry(shapely.transform(table.geometry.to_numpy(), place))
    xmin, ymin, xmax, ymax = layout.extent
    corners = place(np.array([[xmin, ymin], [xmin, ymax], [xmax, ymin], [xmax, ymax]]))
    return Layout((*corners.min(axis=0).tolist(), *corners.max(axis=0).tolist()), **tables)


def window_about(extent: Box, centre: tuple[float, float], width: float, depth: float) -> Box:
    """Return a rectangle of a size about a point, as far as it lies in an extent, metres."""
    xmin, ymin, xmax, ymax = extent
    x, y = centre
    return (
        max(xmin, x - width / 2), max(ymin, y - depth / 2),
        min(xmax, x + width / 2), min(ymax, y + depth / 2),
    )  # fmt: skip


def cut(layout: Layout, window: Box) -> Layout:
    """Keep what lies in a window.

    Buildings are kept whole when their centroid lies in it, and the site grows to hold them, with
    the others that it then has room for; lines and areas are cut, each piece a row.
    """
    kept = _centroid_in(layout.buildings, shapely.box(*window))
    buildings = layout.buildings[kept]
    extent = window
    if len(buildings):
        low_x, low_y, high_x, high_y = buildings.total_bounds.tolist()
        extent = (
            min(window[0], low_x - MARGIN),
            min(window[1], low_y - MARGIN),
            max(window[2], high_x + MARGIN),
            max(window[3], high_y + MARGIN),
        )
    room = shapely.box(*extent).buffer(-MARGIN, join_style="mitre")
    kept |= shapely.covered_by(layout.buildings.geometry.to_numpy(), room)
    return _cut_at(layout, layout.buildings[kept], extent)


def left_at_border(whole: Layout, window: Layout) -> list[str]:
    """Return what the sources call the buildings that the border of a window cuts off."""
    gone = whole.buildings[~whole.buildings["id"].isin(window.buildings["id"])]
    across = shapely.intersects(gone.geometry.to_numpy(), shapely.box(*window.extent))
    return sorted(set(gone["source"][across]))


def cut_to(layout: Layout, window: Box) -> Layout:
    """Keep what lies in a window, which the site then is exactly; buildings that cross it go."""
    inside = shapely.within(layout.buildings.geometry.to_numpy(), shapely.box(*window))
    return _cut_at(layout, layout.buildings[inside], window)


def _cut_at(layout: Layout, buildings: GeoDataFrame, extent: Box) -> Layout:
    """Keep some buildings, and of the rest what lies in a rectangle."""
    frame = shapely.box(*extent)
    parts = layout.parts[layout.parts["building"].isin(buildings["id"])]
    return Layout(
        extent,
        buildings=buildings.reset_index(drop=True),
        parts=parts.reset_index(drop=True),
        roads=_clipped(layout.roads, frame, 1),
        areas=_clipped(layout.areas, frame, 2),
        lines=_clipped(layout.lines, frame, shapely.get_dimensions(layout.lines.geometry)),
        points=_within(layout.points, frame),
        restrictions=_within(layout.restrictions, frame),
    )


def _within(table: GeoDataFrame, box: shapely.Polygon) -> GeoDataFrame:
    return table[shapely.intersects(table.geometry.to_numpy(), box)].reset_index(drop=True)


def _centroid_in(table: GeoDataFrame, box: shapely.Polygon) -> NDArray[np.bool_]:
    return np.asarray(shapely.intersects(shapely.centroid(table.geometry.to_numpy()), box))


def _clipped(
    table: GeoDataFrame, box: shapely.Polygon, dimension: int | NDArray[Any]
) -> GeoDataFrame:
    hit = shapely.intersects(table.geometry.to_numpy(), box)
    touched = table[hit]
    if not isinstance(dimension, int):
        dimension = dimension[hit]
    shapes = touched.geometry.to_numpy()
    crossing = ~shapely.covered_by(shapes, box)
    shapes = shapes.copy()
    shapes[crossing] = shapely.intersection(shapes[crossing], box)
    return pieces_of(touched, shapes, dimension)


def pieces_of(
    table: GeoDataFrame, shapes: NDArray[Any], dimension: int | NDArray[Any]
) -> GeoDataFrame:
    """Give the rows of a table new shapes, one row per piece; rows of empty shapes go.

    Parameters
    ----------
    shapes
        (n,) geometries, also collections.
    dimension
        Pieces of another one are left out: 1 for lines, 2 for areas; of all rows or (n,) of each.
    """
    pieces, rows = shapely.get_parts(shapes, return_index=True)
    deeper, inner = shapely.get_parts(pieces, return_index=True)
    rows = rows[inner]
    wanted = np.broadcast_to(dimension, len(shapes))[rows]
    keep = (shapely.get_dimensions(deeper) == wanted) & ~shapely.is_empty(deeper)
    shapes, rows = deeper[keep], rows[keep]
    result = table.iloc[rows].copy().set_geometry(shapes)
    # A row cut into pieces keeps its id for the first; the others get ids of their own.
    first = np.searchsorted(rows, rows)
    piece = np.arange(len(rows)) - first
    ids = result["id"].to_numpy(np.uint64)
    result["id"] = np.where(piece == 0, ids, hash_ids(0, "piece", ids, piece))
    return result.sort_values("id", kind="stable").reset_index(drop=True)
