"""Changing a finished layout: clearing blocks, new buildings, new land, other heights."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.city import City, Layout
from cityx.city.layout import make_table
from cityx.geometry.arrays import FloatArray
from cityx.ids import hash_ids
from cityx.road.network.network import DRIVABLE
from cityx.sources.features.gather import gather
from cityx.sources.features.resolve import Features, resolve
from cityx.sources.features.shells import make_shells
from cityx.sources.features.tagged import Owner, Report, Tagged, nothing, tag

if TYPE_CHECKING:
    from geopandas import GeoDataFrame


WET = ("water", "sea", "river", "pool", "wetland")
# Land of blocks and of the parcels on them.
BUILT_ON = (
    "residential", "commercial", "retail", "industrial", "civic", "garden", "grass", "pedestrian",
    "parking", "road_area", "meadow",
)  # fmt: skip
LEAST_BLOCK = 400.0  # square metres
THIN = 6.0  # metres; narrower land between streets is no block
LOWER = 0.9  # of a height that buildings are lowered to which must stay below it
BORDER = 1.0  # metres; land nearer to the border of the site goes on beyond it


def street_blocks(layout: Layout) -> NDArray[Any]:
    """Return the land between the streets of a layout, nearest to the middle first, (b,) polygons.

    What goes on beyond the border of the site comes last.
    """
    roads = layout.roads[layout.roads["kind"].isin(DRIVABLE)]
    walks = roads[["sidewalk_left", "sidewalk_right"]].max(axis=1).to_numpy()
    half = roads["width"].to_numpy() / 2 + walks
    strips = shapely.buffer(roads.geometry.to_numpy(), half, quad_segs=4)
    areas = layout.areas.geometry.to_numpy()
    wet = areas[layout.areas["kind"].isin(WET).to_numpy()]
    site = shapely.box(*layout.extent)
    land = shapely.difference(site, shapely.union_all(np.concatenate([strips, wet])))
    land = shapely.buffer(shapely.buffer(land, -THIN / 2, quad_segs=4), THIN / 2, quad_segs=4)
    found = shapely.get_parts(land)
    inner = shapely.distance(found, site.exterior) > BORDER
    large = shapely.area(found) >= LEAST_BLOCK
    found, inner = found[large], inner[large]
    away = np.round(shapely.distance(shapely.centroid(found), site.centroid), 3)
    return np.asarray(found[np.lexsort((away, ~inner))])


def cleared(layout: Layout, place: Any) -> Layout:
    """Take buildings, land, lines and things off a place; roads stay."""
    shapely.prepare(place)
    touched = shapely.intersects(layout.buildings.geometry.to_numpy(), place)
    buildings = layout.buildings[~touched]
    parts = layout.parts[layout.parts["building"].isin(buildings["id"])]
    lines = layout.lines[~shapely.intersects(layout.lines.geometry.to_numpy(), place)]
    points = layout.points[~shapely.intersects(layout.points.geometry.to_numpy(), place)]
    return replace(
        layout,
        buildings=buildings.reset_index(drop=True),
        parts=parts.reset_index(drop=True),
        areas=_cut_out(layout.areas, place),
        lines=lines.reset_index(drop=True),
        points=points.reset_index(drop=True),
    )


def _cut_out(table: GeoDataFrame, place: Any) -> GeoDataFrame:
    """Cut a place out of areas; one row per piece."""
    shapes = table.geometry.to_numpy()
    touched = shapely.intersects(shapes, place)
    shapes = np.where(touched, shapely.difference(shapes, place), shapes)
    pieces, row = shapely.get_parts(shapes, return_index=True)
    kept = (shapely.get_type_id(pieces) == 3) & (shapely.area(pieces) > 1.0)
    pieces, row = pieces[kept], row[kept]
    result = table.iloc[row].copy().set_geometry(pieces)
    # A row cut into pieces keeps its id for the first; the others get ids of their own.
    k = np.arange(len(row)) - np.searchsorted(row, row)
    ids = result["id"].to_numpy(np.uint64)
    result["id"] = np.where(k == 0, ids, hash_ids(0, "rebuilt", ids, k))
    return result.sort_values("id", kind="stable").reset_index(drop=True)


def with_area(layout: Layout, kind: str, shape: Any, owner: Owner, *, tags: str = "{}") -> Layout:
    """Add one area."""
    row = make_table("areas", [shape], id=[owner.id()], source=[owner.source], kind=[kind],
                     name=[owner.tags.get("name", "")], tags=[tags])  # fmt: skip
    return replace(layout, areas=_together(layout.areas, row))


def with_buildings(
    city: City, layout: Layout, shapes: Sequence[Any], owners: list[Owner]
) -> Layout:
    """Add buildings within the site, resolved as those of any source are."""
    shells, box = make_shells(tag(shapes, owners), nothing(), layout.extent, Report())
    return with_features(city, layout, Features(box, shells))


def with_features(city: City, layout: Layout, features: Features) -> Layout:
    """Add buildings, land and things at a place, resolved as those of any source are."""
    added = resolve(features, city.frame, seed=city.seed)
    tables = ("buildings", "parts", "areas", "points")
    return replace(
        layout,
        **{name: _together(getattr(layout, name), getattr(added, name)) for name in tables},
    )


def with_tagged(city: City, layout: Layout, tagged: Tagged) -> Layout:
    """Add buildings, land, lines and things of the scene, resolved as those of any source are."""
    features = gather(tagged, layout.extent, Report())
    added = resolve(features, city.frame, seed=city.seed)
    tables = ("buildings", "parts", "areas", "points", "lines")
    return replace(
        layout,
        **{name: _together(getattr(layout, name), getattr(added, name)) for name in tables},
    )


def is_square(areas: GeoDataFrame) -> NDArray[np.bool_]:
    """(n,) whether paved land is a square, which has a name, and not the ground round a tower."""
    return np.asarray((areas["kind"] == "pedestrian") & (areas["name"] != ""), bool)


def is_made(table: GeoDataFrame) -> NDArray[np.bool_]:
    """(n,) whether a row was made because it was asked for.

    Blocks that were built anew, as they were, come from the plan.
    """
    source = table["source"].str
    return np.asarray(source.startswith("made/") & ~source.startswith("made/block/"), bool)


def without_buildings(layout: Layout, rows: NDArray[np.int64]) -> Layout:
    """Take buildings down, by their rows."""
    kept = np.ones(len(layout.buildings), bool)
    kept[rows] = False
    buildings = layout.buildings[kept]
    parts = layout.parts[layout.parts["building"].isin(buildings["id"])]
    return replace(
        layout, buildings=buildings.reset_index(drop=True), parts=parts.reset_index(drop=True)
    )


def _together(first: GeoDataFrame, second: GeoDataFrame) -> GeoDataFrame:
    import pandas as pd

    table = pd.concat([first, second], ignore_index=True)
    return table.sort_values("id", kind="stable").reset_index(drop=True)


def with_heights(
    layout: Layout, rows: NDArray[np.int64], heights: FloatArray, *, exact: bool = True
) -> Layout:
    """Scale buildings in height, and tag them with it, so that drawn roofs keep it.

    Parameters
    ----------
    rows, heights
        (k,) rows of the table of buildings, and metres they shall have.
    exact
        Whether all are tagged; else those alone whose height was said before.
    """
    buildings, parts = layout.buildings.copy(), layout.parts.copy()
    old = buildings["height"].to_numpy()
    factor = np.ones(len(buildings))
    factor[rows] = heights / old[rows]
    of = np.searchsorted(buildings["id"].to_numpy(), parts["building"].to_numpy())
    for column in ("base", "top", "roof_height"):
        parts[column] = parts[column].to_numpy() * factor[of]
    for table, share in ((buildings, factor), (parts, factor[of])):
        levels = np.maximum(np.rint(table["levels"].to_numpy() * share), 1)
        table["levels"] = np.where(share == 1.0, table["levels"], levels).astype(np.int16)
    height = old.copy()
    height[rows] = heights
    buildings["height"] = height
    tags = buildings["tags"].to_numpy(object).copy()
    for row, metres in zip(rows.tolist(), np.asarray(heights, float).tolist(), strict=True):
        own = json.loads(tags[row] or "{}")
        if exact or "height" in own:
            tags[row] = json.dumps({**own, "height": f"{metres:.2f}"})
    buildings["tags"] = tags.astype(str)
    return replace(layout, buildings=buildings, parts=parts)


def lowered(layout: Layout, below: float, *, but: NDArray[np.uint64]) -> Layout:
    """Lower the buildings that are as high as something, all but some."""
    table = layout.buildings
    high = (table["height"].to_numpy() >= below) & ~np.isin(table["id"].to_numpy(), but)
    rows = np.flatnonzero(high)
    return with_heights(layout, rows, np.full(len(rows), LOWER * below)) if len(rows) else layout
