"""Cut a window out of a layout."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Annotated

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.city import City, Layout
from cityx.geometry.identity import hash_ids
from cityx.protocol import Port, Range, action

if TYPE_CHECKING:
    from geopandas import GeoDataFrame

FAR = 1e7  # metres; farther than any site reaches


@action(
    "layout/crop-v1",
    limits=["Buildings are kept whole when their centroid lies in the window, else dropped."],
    takes=(Port("layout", "scene_layout"),),
    gives=(Port("layout", "scene_layout"),),
)
def crop(
    city: City,
    *,
    x: Annotated[float, Range(-FAR, FAR)] = 0.0,
    y: Annotated[float, Range(-FAR, FAR)] = 0.0,
    width: Annotated[float, Range(10.0, FAR)] = 1000.0,
    depth: Annotated[float, Range(10.0, FAR)] = 1000.0,
) -> City:
    """Keep only what lies in a rectangle of the site.

    Parameters
    ----------
    city
        City with a layout.
    x, y
        Centre of the window, metres, scene frame.
    width, depth
        Size of the window in east and north direction, metres.
    """
    layout = city.layout
    xmin, ymin, xmax, ymax = layout.extent
    window = (
        max(xmin, x - width / 2),
        max(ymin, y - depth / 2),
        min(xmax, x + width / 2),
        min(ymax, y + depth / 2),
    )
    box = shapely.box(*window)
    buildings = layout.buildings[_centroid_in(layout.buildings, box)]
    parts = layout.parts[layout.parts["building"].isin(buildings["id"])]
    kept = shapely.union_all(shapely.envelope(buildings.geometry.to_numpy())).bounds
    margin = 15.0  # metres, as in every source: no building touches the border of its site
    extent = window
    if len(buildings):
        extent = (
            min(window[0], kept[0] - margin),
            min(window[1], kept[1] - margin),
            max(window[2], kept[2] + margin),
            max(window[3], kept[3] + margin),
        )
    frame = shapely.box(*extent)
    points = layout.points[shapely.intersects(layout.points.geometry.to_numpy(), frame)]
    cropped = Layout(
        extent,
        buildings=buildings.reset_index(drop=True),
        parts=parts.reset_index(drop=True),
        roads=_clipped(layout.roads, frame, 1),
        areas=_clipped(layout.areas, frame, 2),
        lines=_clipped(layout.lines, frame, 1),
        points=points.reset_index(drop=True),
    )
    return replace(city, layout=cropped)


def _centroid_in(table: GeoDataFrame, box: shapely.Polygon) -> NDArray[np.bool_]:
    return np.asarray(shapely.intersects(shapely.centroid(table.geometry.to_numpy()), box))


def _clipped(table: GeoDataFrame, box: shapely.Polygon, dimension: int) -> GeoDataFrame:
    """Clip rows to the box; pieces of the right dimension stay, one row per piece."""
    touched = table[shapely.intersects(table.geometry.to_numpy(), box)]
    shapes = touched.geometry.to_numpy()
    inside = shapely.covered_by(shapes, box)
    cut = np.where(inside, shapes, shapely.intersection(shapes, box))
    pieces, rows = shapely.get_parts(cut, return_index=True)
    deeper, inner = shapely.get_parts(pieces, return_index=True)
    rows = rows[inner]
    keep = (shapely.get_dimensions(deeper) == dimension) & ~shapely.is_empty(deeper)
    shapes, rows = deeper[keep], rows[keep]
    result = touched.iloc[rows].copy().set_geometry(shapes)
    # A row cut into pieces keeps its id for the first; the others get ids of their own.
    first = np.searchsorted(rows, rows)
    piece = np.arange(len(rows)) - first
    ids = result["id"].to_numpy(np.uint64)
    result["id"] = np.where(piece == 0, ids, hash_ids(0, "piece", ids, piece))
    return result.sort_values("id", kind="stable").reset_index(drop=True)
