"""Lines that stand: walls, fences, hedges and rows of trees."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from cityx.city.layout import make_table
from cityx.geometry.identity import stable_id
from cityx.sources.osm import measures
from cityx.sources.osm.areas import tags_text
from cityx.sources.osm.elements import FloatArray, IntArray, OsmMap, Tags, way_lines
from cityx.sources.osm.outlines import number_pieces
from cityx.sources.osm.site import Box, clip_lines
from cityx.sources.osm.vocabulary import LINE_HEIGHT, LINE_TABLE, is_underground, lookup

if TYPE_CHECKING:
    from geopandas import GeoDataFrame

MAX_HEIGHT = 40.0  # metres; a wall that is higher is a mistake in its unit


def line_kind(tags: Tags) -> str:
    """Return the kind of a line that stands, or ""."""
    if is_underground(tags) or tags.get("area") == "yes":
        return ""
    return lookup(LINE_TABLE, tags)


def line_table(osm: OsmMap, xy: FloatArray, ways: IntArray, box: Box) -> GeoDataFrame:
    """Make the table of the lines within the site."""
    lines, index = way_lines(osm, xy, ways)
    pieces, row = clip_lines(lines, box)
    way = ways[index[row]] if len(row) else np.zeros(0, np.int64)
    tags = [osm.way_tags[row] for row in way.tolist()]
    kinds = [line_kind(found) for found in tags]
    heights = [
        measures.measure(found.get("height"), 0.1, MAX_HEIGHT) or LINE_HEIGHT[kind]
        for found, kind in zip(tags, kinds, strict=True)
    ]
    ids = osm.way_id[way].tolist()
    numbers = number_pieces(way).tolist() if len(way) else []
    return make_table(
        "lines",
        pieces,
        id=np.array(
            [
                stable_id("osm", "way", key, k) if k else stable_id("osm", "way", key)
                for key, k in zip(ids, numbers, strict=True)
            ],
            np.uint64,
        ),
        source=[f"osm/way/{key}" for key in ids],
        kind=kinds,
        height=heights,
        tags=[tags_text(found) for found in tags],
    )
