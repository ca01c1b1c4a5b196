"""Areas: land use, greens, water and squares."""

from __future__ import annotations

from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.sources.features.clipping import Box, FloatArray, IntArray, clip_lines
from cityx.sources.features.kinds import land_kind
from cityx.sources.features.tagged import (
    MIN_AREA,
    Owner,
    Report,
    Tagged,
    clipped_polygons,
    joined,
)
from cityx.sources.features.vocabulary import WATER_KINDS
from cityx.sources.features.waterways import waterway_width, waterways
from cityx.sources.osm.elements import OsmMap, way_lines
from cityx.sources.osm.outlines import relation_rings, ring_outlines, tagged_lines, way_outlines

# The sea: what lies to the right of the coastline.

PROBE = 0.05  # metres beside a coast segment at which its two sides are looked up
# An extract cuts ways at the last node inside it; the next one lies about a segment further.
REACH = 120.0
REACH_SHARE = 0.1  # of the site's shorter side, where that is less
# Of the coast along a face, the share by which one side must win: a coastline that ends within a
# face has both sides in it and decides nothing.
MARGIN = 0.2


def sea_polygons(coast: NDArray[Any], box: Box) -> NDArray[Any]:
    """Return the polygons of the site that are sea.

    Land lies to the left of a coastline. The lines and the border of the site divide it into
    faces; each face asks the coast segments along it on which side it lies, and the longer side
    wins. A coastline cut off near the border is taken to reach it; one that ends farther within
    the site divides nothing.

    Parameters
    ----------
    coast
        (n,) lines in the direction of their ways.
    """
    lines, _ = clip_lines(coast, box)
    if len(lines) == 0:
        return np.zeros(0, object)
    frame = shapely.box(*box)
    lines = np.array([*lines, *_to_border(lines, frame)], object)
    noded = shapely.node(shapely.geometrycollections([*lines, frame.exterior]))
    faces = shapely.get_parts(shapely.polygonize(shapely.get_parts(noded)))
    points, row = shapely.get_coordinates(lines, return_index=True)
    step = np.diff(points, axis=0)
    length = np.hypot(*step.T)
    usable = (row[1:] == row[:-1]) & (length > 2 * PROBE)
    step, length = step[usable], length[usable]
    middle = ((points[1:] + points[:-1]) / 2)[usable]
    left = np.column_stack([-step[:, 1], step[:, 0]]) / length[:, None] * PROBE
    tree = shapely.STRtree(faces)
    votes, heard = np.zeros(len(faces)), np.zeros(len(faces))
    for side, sign in ((left, -1.0), (-left, 1.0)):
        probe, face = tree.query(shapely.points(middle + side), predicate="within")
        np.add.at(votes, face, sign * length[probe])
        np.add.at(heard, face, length[probe])
    sea = (votes > MARGIN * heard) & (shapely.area(faces) > MIN_AREA)
    return np.asarray(faces[sea], object)


def _to_border(lines: NDArray[Any], frame: shapely.Polygon) -> list[shapely.LineString]:
    """Return straight pieces from the loose ends of the coastline to a border close by."""
    merged = shapely.get_parts(shapely.line_merge(shapely.multilinestrings(lines)))
    loose = merged[~shapely.is_closed(merged)]
    ends = np.concatenate([shapely.get_point(loose, 0), shapely.get_point(loose, -1)])
    gap = shapely.distance(ends, frame.exterior)
    xmin, ymin, xmax, ymax = frame.bounds
    reach = min(REACH, REACH_SHARE * min(xmax - xmin, ymax - ymin))
    near = ends[(gap > 0) & (gap <= reach)]
    return list(shapely.shortest_line(near, frame.exterior))


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
