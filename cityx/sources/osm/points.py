"""Points: trees, street furniture, crossings and entrances."""

from __future__ import annotations

from math import nan
from typing import TYPE_CHECKING

import numpy as np
import shapely

from cityx.city.layout import make_table
from cityx.geometry.identity import stable_id, uniform
from cityx.sources.osm import measures
from cityx.sources.osm.areas import tags_text
from cityx.sources.osm.elements import FloatArray, OsmMap, Tags
from cityx.sources.osm.site import Box
from cityx.sources.osm.vocabulary import POINT_HEIGHT, POINT_TABLE, is_underground, lookup

if TYPE_CHECKING:
    from geopandas import GeoDataFrame

MAX_HEIGHT = 90.0  # metres; no tree is higher
_INTERESTING = frozenset(key for key, values in POINT_TABLE if values)


def point_kind(tags: Tags) -> str:
    """Return the kind of thing that stands at a node, or ""."""
    if _INTERESTING.isdisjoint(tags) or is_underground(tags) or tags.get("indoor") == "yes":
        return ""
    return lookup(POINT_TABLE, tags)


def point_table(osm: OsmMap, xy: FloatArray, box: Box, *, seed: int) -> GeoDataFrame:
    """Make the table of the things at a place within the site."""
    spots = xy[osm.tagged]
    low, high = np.array(box[:2]), np.array(box[2:])
    inside = np.flatnonzero(((spots >= low) & (spots <= high)).all(axis=1)).tolist()
    found = [(index, kind) for index in inside if (kind := point_kind(osm.node_tags[index]))]
    rows = osm.tagged[[index for index, _ in found]] if found else np.zeros(0, np.int64)
    keys = osm.node_id[rows].tolist()
    ids = np.array([stable_id("osm", "node", key) for key in keys], np.uint64)
    tags = [osm.node_tags[index] for index, _ in found]
    kinds = [kind for _, kind in found]
    usual = np.array([POINT_HEIGHT[kind] for kind in kinds]).reshape(-1, 2)
    height = usual[:, 0] + uniform(seed, "osm/point-height", ids) * (usual[:, 1] - usual[:, 0])
    known = [_height(own) for own in tags]
    return make_table(
        "points",
        shapely.points(xy[rows]) if found else np.zeros(0, object),
        id=ids,
        source=[f"osm/node/{key}" for key in keys],
        kind=kinds,
        height=np.where(np.isnan(known), height, known) if found else height,
        direction=[measures.direction(own.get("direction")) for own in tags],
        tags=[tags_text(own) for own in tags],
    )


def _height(tags: Tags) -> float:
    value = measures.measure(tags.get("height") or tags.get("est_height"), 0.2, MAX_HEIGHT)
    if value is None and tags.get("natural") == "tree":
        crown = measures.measure(tags.get("diameter_crown"), 0.5, 40.0)
        value = None if crown is None else 1.5 * crown + 1.0
    return nan if value is None else value
