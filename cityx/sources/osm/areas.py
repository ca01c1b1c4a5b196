"""Areas: land use, greens, water and squares."""

from __future__ import annotations

from json.encoder import encode_basestring as _quote
from typing import TYPE_CHECKING, Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.city.layout import make_table
from cityx.sources.osm import measures
from cityx.sources.osm.coastline import sea_polygons
from cityx.sources.osm.elements import FloatArray, IntArray, OsmMap, Tags, way_lines
from cityx.sources.osm.multipolygons import polygons_of
from cityx.sources.osm.outlines import (
    Outlines,
    Owner,
    Report,
    clipped,
    join_outlines,
    number_pieces,
    relation_rings,
    ring_outlines,
    way_outlines,
)
from cityx.sources.osm.site import Box, clip_polygons
from cityx.sources.osm.vocabulary import (
    NO_BUILDING,
    WATER_KINDS,
    area_kind,
    closed_is_area,
    is_underground,
)

if TYPE_CHECKING:
    from geopandas import GeoDataFrame

# Metres of water that a line without a width stands for.
WATERWAYS = {
    "river": 12.0, "canal": 10.0, "stream": 2.5, "drain": 1.2, "ditch": 1.2, "tidal_channel": 6.0,
    "wadi": 2.5, "brook": 2.0, "rapids": 8.0,
}  # fmt: skip
COVERED = ("culvert", "yes", "flooded", "building_passage")


def land_kind(tags: Tags) -> str:
    """Return the kind of area that a closed outline is, or "" when it is none or a building."""
    if tags.get("building", "") not in NO_BUILDING or "building:part" in tags:
        return ""
    if not closed_is_area(tags) or is_underground(tags):
        return ""
    return area_kind(tags)


def waterway_width(tags: Tags) -> float:
    """Return the width of the water along a line in metres; 0 when there is none to be seen."""
    usual = WATERWAYS.get(tags.get("waterway", ""))
    if usual is None or tags.get("tunnel", "no") in COVERED or is_underground(tags):
        return 0.0
    if tags.get("covered") == "yes" or tags.get("intermittent") == "yes":
        return 0.0
    return measures.measure(tags.get("width"), 0.3, 500.0) or usual


def area_table(
    osm: OsmMap,
    xy: FloatArray,
    ways: IntArray,
    box: Box,
    report: Report,
    buildings: NDArray[Any],
) -> GeoDataFrame:
    """Read every area of the site.

    Parameters
    ----------
    ways
        Rows of the closed ways with a kind.
    buildings
        Points of the buildings; they tell on which side of a cut outline the area lies.
    """
    rings, spoken = relation_rings(osm, land_kind)
    own = ways[~np.isin(ways, sorted(spoken))]
    outlines = join_outlines(
        clipped(way_outlines(osm, xy, own, box, report, solid=False, avoid=buildings), box),
        clipped(ring_outlines(osm, xy, rings, box, report, solid=False, avoid=buildings), box),
    )
    kinds = np.array([land_kind(tags) for tags in outlines.tags()], object)
    water = outlines.polygons[np.isin(kinds, sorted(WATER_KINDS))]
    streams = _waterways(osm, xy, water, box)
    sea = _sea(osm, xy, box)
    kinds = np.concatenate(
        [kinds, np.repeat(np.array(["river", "sea"], object), [len(streams.k), len(sea.k)])]
    )
    outlines = join_outlines(outlines, streams, sea)
    tags = outlines.tags()
    return make_table(
        "areas",
        outlines.polygons,
        id=outlines.ids(),
        source=outlines.sources(),
        kind=kinds,
        name=[own.get("name", "") for own in tags],
        tags=[tags_text(own) for own in tags],
    )


def tags_text(tags: Tags) -> str:
    """Return tags as the JSON object that the tables keep, keys in order."""
    quoted = [f"{_quote(key)}: {_quote(tags[key])}" for key in sorted(tags)]
    return f"{{{', '.join(quoted)}}}"


def _sea(osm: OsmMap, xy: FloatArray, box: Box) -> Outlines:
    coast = [row for row, tags in enumerate(osm.way_tags) if tags.get("natural") == "coastline"]
    polygons = np.zeros(0, object)
    if coast:
        polygons = sea_polygons(way_lines(osm, xy, coast)[0], box)
        polygons = polygons[np.lexsort(np.round(shapely.bounds(polygons), 2).reshape(-1, 4).T)]
    k = np.arange(len(polygons))
    return Outlines(polygons, np.zeros(len(k), np.int64), k, [Owner("coastline", 0, {})])


def _waterways(osm: OsmMap, xy: FloatArray, water: NDArray[Any], box: Box) -> Outlines:
    """Widen rivers and streams that are drawn as lines, where no polygon covers them."""
    widths = {
        row: waterway_width(tags) for row, tags in enumerate(osm.way_tags) if "waterway" in tags
    }
    rows = np.array([row for row, width in widths.items() if width > 0], np.int64)
    lines, index = way_lines(osm, xy, rows)
    owners = [Owner("way", int(osm.way_id[row]), osm.way_tags[row]) for row in rows.tolist()]
    half = np.array([widths[row] / 2 for row in rows.tolist()])
    if len(lines) == 0:
        return Outlines(np.zeros(0, object), rows[:0], rows[:0], owners)
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
    return Outlines(polygons, owner, number_pieces(owner), owners)
