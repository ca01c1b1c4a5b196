"""Areas: land use, greens, water and squares."""

from __future__ import annotations

from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.sources.features.clipping import Box, FloatArray, IntArray
from cityx.sources.features.kinds import land_kind
from cityx.sources.features.tagged import (
    Owner,
    Report,
    Tagged,
    clipped_polygons,
    joined,
)
from cityx.sources.features.vocabulary import WATER_KINDS
from cityx.sources.features.waterways import waterway_width, waterways
from cityx.sources.osm.coastline import sea_polygons
from cityx.sources.osm.elements import OsmMap, way_lines
from cityx.sources.osm.outlines import relation_rings, ring_outlines, tagged_lines, way_outlines


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
    streams = waterways(tagged_lines(osm, xy, _water_lines(osm)), water, box)
    sea = _sea(osm, xy, box)
    more = np.repeat(np.array(["river", "sea"], object), [len(streams.k), len(sea.k)])
    return joined(outlines, streams, sea), np.concatenate([kinds, more])


def _water_lines(osm: OsmMap) -> IntArray:
    """Return the ways along which water flows."""
    rows = [row for row, tags in enumerate(osm.way_tags) if waterway_width(tags) > 0]
    return np.array(rows, np.int64)


def _sea(osm: OsmMap, xy: FloatArray, box: Box) -> Tagged:
    coast = [row for row, tags in enumerate(osm.way_tags) if tags.get("natural") == "coastline"]
    polygons = np.zeros(0, object)
    if coast:
        polygons = sea_polygons(way_lines(osm, xy, coast)[0], box)
        polygons = polygons[np.lexsort(np.round(shapely.bounds(polygons), 2).reshape(-1, 4).T)]
    k = np.arange(len(polygons))
    return Tagged(polygons, np.zeros(len(k), np.int64), k, [Owner(("osm", "coastline", 0), {})])
