"""Areas: land use, greens, water and squares."""

from __future__ import annotations

from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.sources.features import measures
from cityx.sources.features.clipping import Box, FloatArray, IntArray, clip_polygons
from cityx.sources.features.kinds import land_kind
from cityx.sources.features.tagged import (
    Owner,
    Report,
    Tagged,
    Tags,
    clipped_polygons,
    joined,
    number_pieces,
    polygons_of,
)
from cityx.sources.features.vocabulary import WATER_KINDS, is_underground
from cityx.sources.osm.coastline import sea_polygons
from cityx.sources.osm.elements import OsmMap, way_lines
from cityx.sources.osm.outlines import relation_rings, ring_outlines, way_outlines, way_owner

# Metres of water that a line without a width stands for.
WATERWAYS = {
    "river": 12.0, "canal": 10.0, "stream": 2.5, "drain": 1.2, "ditch": 1.2, "tidal_channel": 6.0,
    "wadi": 2.5, "brook": 2.0, "rapids": 8.0,
}  # fmt: skip
COVERED = ("culvert", "yes", "flooded", "building_passage")


def waterway_width(tags: Tags) -> float:
    """Return the width of the water along a line in metres; 0 when there is none to be seen."""
    usual = WATERWAYS.get(tags.get("waterway", ""))
    if usual is None or tags.get("tunnel", "no") in COVERED or is_underground(tags):
        return 0.0
    if tags.get("covered") == "yes" or tags.get("intermittent") == "yes":
        return 0.0
    return measures.measure(tags.get("width"), 0.3, 500.0) or usual


def read_areas(
    osm: OsmMap,
    xy: FloatArray,
    ways: IntArray,
    box: Box,
    report: Report,
    buildings: NDArray[Any],
) -> tuple[Tagged, NDArray[Any]]:
    """Read every area of the site, and the kind of each.

    Parameters
    ----------
    ways
        Rows of the closed ways with a kind.
    buildings
        Points of the buildings; they tell on which side of a cut outline the area lies.
    """
    rings, spoken = relation_rings(osm, land_kind)
    own = ways[~np.isin(ways, sorted(spoken))]
    outlines = joined(
        clipped_polygons(
            way_outlines(osm, xy, own, box, report, solid=False, avoid=buildings), box
        ),
        clipped_polygons(
            ring_outlines(osm, xy, rings, box, report, solid=False, avoid=buildings), box
        ),
    )
    kinds = np.array([land_kind(tags) for tags in outlines.tags()], object)
    water = outlines.shapes[np.isin(kinds, sorted(WATER_KINDS))]
    streams = _waterways(osm, xy, water, box)
    sea = _sea(osm, xy, box)
    more = np.repeat(np.array(["river", "sea"], object), [len(streams.k), len(sea.k)])
    return joined(outlines, streams, sea), np.concatenate([kinds, more])


def _sea(osm: OsmMap, xy: FloatArray, box: Box) -> Tagged:
    coast = [row for row, tags in enumerate(osm.way_tags) if tags.get("natural") == "coastline"]
    polygons = np.zeros(0, object)
    if coast:
        polygons = sea_polygons(way_lines(osm, xy, coast)[0], box)
        polygons = polygons[np.lexsort(np.round(shapely.bounds(polygons), 2).reshape(-1, 4).T)]
    k = np.arange(len(polygons))
    return Tagged(polygons, np.zeros(len(k), np.int64), k, [Owner(("osm", "coastline", 0), {})])


def _waterways(osm: OsmMap, xy: FloatArray, water: NDArray[Any], box: Box) -> Tagged:
    """Widen rivers and streams that are drawn as lines, where no polygon covers them."""
    widths = {
        row: waterway_width(tags) for row, tags in enumerate(osm.way_tags) if "waterway" in tags
    }
    rows = np.array([row for row, width in widths.items() if width > 0], np.int64)
    lines, index = way_lines(osm, xy, rows)
    owners = [way_owner(osm, row) for row in rows.tolist()]
    half = np.array([widths[row] / 2 for row in rows.tolist()])
    if len(lines) == 0:
        return Tagged(np.zeros(0, object), rows[:0], rows[:0], owners)
    near = np.flatnonzero(shapely.intersects(lines, shapely.box(*box)))
    lines, index = lines[near], index[near]
    bands = shapely.buffer(lines, half[index], cap_style="square", quad_segs=4)
    bands = clip_polygons(bands, box)
    band, other = shapely.STRtree(water).query(bands, predicate="intersects")
    for row in np.unique(band).tolist():
        covered = shapely.union_all(water[other[band == row]])
        bands[row] = shapely.difference(bands[row], covered)
    polygons, piece = polygons_of(bands)
    owner = index[piece]
    return Tagged(polygons, owner, number_pieces(owner), owners)
