"""Rebuild the blocks of a procedural town that something was cut through."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields, replace
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.city import City, Layout
from cityx.city.layout import joined_tables
from cityx.city.sites import Box, cut_to
from cityx.ids import stable_id
from cityx.sources.features.gather import gather
from cityx.sources.features.resolve import resolve
from cityx.sources.features.tagged import Owner, Report, joined
from cityx.town.blocks import LAND, LEAST, THIN, Blocks
from cityx.town.rebuilding import BUILT_ON, cleared, is_square, street_blocks, with_area
from cityx.town.window import buildings_on

# Zone of a block by the use of most of its buildings.
ZONE_OF_USE: Mapping[str, str] = {
    "apartments": "midrise", "office": "core", "terrace": "row", "house": "suburb",
    "detached": "suburb", "bungalow": "suburb", "semidetached_house": "suburb",
    "industrial": "industry", "warehouse": "industry", "retail": "retail strip",
}  # fmt: skip
NEXT = 2.0  # metres from what was taken to a block that lost ground
BEYOND = 40.0  # metres beyond the border of the site to which a block that it cuts goes on
OWN = ("town/", "made/block/")  # sources of the land of blocks
TABLES = ("buildings", "parts", "areas", "lines", "points")


def refilled(city: City, before: Layout, gone: Any, ground: Any) -> City:
    """Build on the blocks of a procedural town that lost ground or streets, as they were built.

    Parameters
    ----------
    before
        The layout before it was cut.
    gone
        What was taken: ground, and streets given up.
    ground
        What stays free.
    """
    if not before.areas["source"].str.startswith(OWN).any():
        return city
    shapes = _open_blocks(city.layout, gone, ground)
    looks = [_built_as(before, shape) for shape in shapes.tolist()]
    rows = np.array([k for k, (zone, _) in enumerate(looks) if zone], np.int64)
    if not len(rows):
        return city
    shapes, looks = shapes[rows], [looks[row] for row in rows.tolist()]
    ids = np.array([_block_id(shape) for shape in shapes.tolist()], np.uint64)
    zone = np.array([word for word, _ in looks], object)
    kind = np.array([LAND[word] for word in zone], object)
    found = Blocks(
        _beyond(shapes, city.layout), ids, zone, kind, np.full(len(ids), 0.5),
        np.array([height for _, height in looks]),
    )  # fmt: skip
    layout = cleared(city.layout, shapely.union_all(shapes))
    for number, shape, word in zip(ids.tolist(), shapes.tolist(), kind.tolist(), strict=True):
        layout = with_area(layout, word, shape, Owner(("made", "block", number), {}))
    return replace(city, layout=_with_houses(city, layout, found, shapes))


def _open_blocks(layout: Layout, gone: Any, ground: Any) -> NDArray[Any]:
    """Return the blocks beside what was taken, less parks, squares and what else is no block."""
    built_on = layout.areas["kind"].isin(BUILT_ON) & ~is_square(layout.areas)
    kept = layout.areas[~built_on].geometry.to_numpy()
    made = layout.areas["source"].str.startswith("made/").to_numpy(bool)
    own = layout.areas["source"].str.startswith("made/block/").to_numpy(bool)
    shut = shapely.union_all([ground, *kept, *layout.areas.geometry.to_numpy()[made & ~own]])
    near = shapely.buffer(gone, NEXT)
    blocks = street_blocks(layout)
    blocks = blocks[shapely.intersects(blocks, near)]
    rest = shapely.difference(blocks, shut)
    rest = shapely.buffer(shapely.buffer(rest, -THIN), THIN, join_style="mitre")
    parts = shapely.get_parts(shapely.simplify(shapely.intersection(rest, blocks), 0.02))
    parts = parts[(shapely.get_type_id(parts) == 3) & (shapely.area(parts) >= LEAST)]
    parts = parts[shapely.intersects(parts, near)]
    return np.asarray(shapely.orient_polygons(parts))


def _block_id(shape: Any) -> int:
    """Return the id of a block by its place."""
    place = np.round(shapely.get_coordinates(shapely.point_on_surface(shape))[0], 2)
    return stable_id("block", *place.tolist())


def _built_as(layout: Layout, block: Any) -> tuple[str, float]:
    """Return the zone that a block looks built as, "" for none, and the height of its offices."""
    table = layout.buildings
    middles = shapely.point_on_surface(table.geometry.to_numpy())
    rows = np.flatnonzero(shapely.contains(block, middles))
    if not len(rows):
        return "", np.nan
    area = shapely.area(table.geometry.to_numpy()[rows])
    words, at = np.unique(table["use"].to_numpy()[rows].astype(str), return_inverse=True)
    most = words[int(np.argmax(np.bincount(at.ravel(), area)))]
    height = float(np.median(table["height"].to_numpy()[rows]))
    return ZONE_OF_USE.get(str(most), ""), height if most == "office" else np.nan


def _beyond(shapes: NDArray[Any], layout: Layout) -> NDArray[Any]:
    """Extend blocks that the border of the site cuts beyond it, where no house will stand."""
    site = shapely.box(*layout.extent)
    more = shapely.difference(shapely.buffer(shapes, BEYOND, join_style="mitre"), site)
    grown = shapely.union(shapes, more)
    whole = (shapely.get_type_id(grown) == 3) & ~shapely.is_empty(more)
    return np.where(whole, shapely.orient_polygons(grown), shapes)


def _with_houses(city: City, layout: Layout, blocks: Blocks, own: NDArray[Any]) -> Layout:
    """Put buildings and grounds on blocks; one that gets none as it goes on, as it ends.

    Parameters
    ----------
    own
        (b,) the blocks as they end at the border of the site.
    """
    made = _houses_on(city, layout.extent, blocks)
    points = shapely.point_on_surface(made.buildings.geometry.to_numpy())
    bare = np.ones(len(own), bool)
    bare[shapely.STRtree(points).query(own, predicate="intersects")[0]] = False
    both = [made]
    if bare.any():
        columns = {item.name: getattr(blocks, item.name)[bare] for item in fields(Blocks)}
        both.append(_houses_on(city, layout.extent, Blocks(**{**columns, "shapes": own[bare]})))
    for found in both:
        pairs = {name: (getattr(layout, name), getattr(found, name)) for name in TABLES}
        tables = {name: joined_tables(*pair) for name, pair in pairs.items()}
        layout = replace(layout, **tables)
    return layout


def _houses_on(city: City, extent: Box, blocks: Blocks) -> Layout:
    xmin, ymin, xmax, ymax = extent
    wide = (xmin - BEYOND, ymin - BEYOND, xmax + BEYOND, ymax + BEYOND)
    stand = joined(*buildings_on([(blocks, blocks.shapes)], wide, (0, 0), city.seed))
    return cut_to(resolve(gather(stand, wide, Report()), city.frame, seed=city.seed), extent)
