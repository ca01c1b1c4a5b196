"""Buildings of a map: ways, relations and nodes that are outlines of them."""

from __future__ import annotations

from math import pi
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.sources.features import measures
from cityx.sources.features.clipping import Box, FloatArray, IntArray
from cityx.sources.features.kinds import building_kind
from cityx.sources.features.tagged import Owner, Report, Tagged, Tags, joined
from cityx.sources.features.vocabulary import NO_BUILDING, is_underground
from cityx.sources.osm.elements import OsmMap
from cityx.sources.osm.outlines import Ring, ring_outlines, way_outlines

# Radius in metres of towers that are drawn as a point.
POINT_TOWERS = {
    "chimney": 1.5, "silo": 3.0, "storage_tank": 6.0, "water_tower": 5.0, "gasometer": 15.0,
    "cooling_tower": 25.0, "lighthouse": 3.0, "communications_tower": 4.0, "obelisk": 1.2,
    "windmill": 4.0,
}  # fmt: skip
ROUND_SIDES = 16


def candidate_ways(osm: OsmMap) -> tuple[IntArray, IntArray]:
    """Return the ways that are outlines of buildings and those that are parts."""
    kinds = [
        building_kind(tags) if tags else ""
        for tags in osm.way_tags
    ]  # fmt: skip
    found = np.array(kinds, object)
    outline = np.flatnonzero(found == "building")
    # An open line with building=* is kept when it can be closed; barriers and roads are not.
    towers = [
        row for row in outline.tolist()
        if osm.way_closed[row] or osm.way_tags[row].get("building", "") not in NO_BUILDING
    ]  # fmt: skip
    members = _outline_members(osm)
    rows = np.union1d(np.array(towers, np.int64), np.array(sorted(members), np.int64))
    return rows.astype(np.int64), np.setdiff1d(np.flatnonzero(found == "part"), rows)


def _outline_members(osm: OsmMap) -> set[int]:
    """Return closed ways without tags of a building that a type=building relation calls outline."""
    found = set()
    for row, tags in enumerate(osm.relation_tags):
        if tags.get("type") == "building":
            for kind, ref, role in osm.members[row]:
                way = osm.way_row(ref) if kind == "way" and role == "outline" else -1
                if way >= 0 and osm.way_closed[way] and not _is_part(osm.way_tags[way]):
                    found.add(way)
    return found


def _is_part(tags: Tags) -> bool:
    return tags.get("building:part", "") not in NO_BUILDING


def read_outlines(
    osm: OsmMap,
    xy: FloatArray,
    ways: tuple[IntArray, IntArray],
    relations: tuple[list[Ring], set[int]],
    box: Box,
    report: Report,
) -> tuple[Tagged, Tagged]:
    """Read the outlines of buildings and of their parts.

    Parameters
    ----------
    ways
        Rows of the ways that are outlines and of those that are parts.
    relations
        What `relation_rings` finds for `building_kind`.
    box
        The site.
    """
    rings, spoken = relations
    outer = [ring for ring in rings if building_kind(ring.owner.tags) == "building"]
    inner = [ring for ring in rings if building_kind(ring.owner.tags) == "part"]
    heard = np.array(sorted(spoken), np.int64)
    own, own_parts = (rows[~np.isin(rows, heard)] for rows in ways)
    outlines = joined(
        way_outlines(osm, xy, own, box, report, solid=True),
        ring_outlines(osm, xy, outer, box, report, solid=True),
    )
    outlines = joined(outlines, _point_towers(osm, xy, outlines.shapes))
    parts = joined(
        way_outlines(osm, xy, own_parts, box, report, solid=True),
        ring_outlines(osm, xy, inner, box, report, solid=True),
    )
    return outlines, parts


def _point_towers(osm: OsmMap, xy: FloatArray, outlines: NDArray[Any]) -> Tagged:
    """Give towers that are drawn as a point a round outline, unless they stand in a building."""
    owners, shapes = [], []
    for row, tags in zip(osm.tagged.tolist(), osm.node_tags, strict=True):
        usual = POINT_TOWERS.get(tags.get("man_made", ""))
        if usual is None or is_underground(tags):
            continue
        across = measures.measure(tags.get("diameter"), 0.3, 120.0)
        radius = across / 2 if across else usual
        turn = (np.arange(ROUND_SIDES) + 0.5) * 2 * pi / ROUND_SIDES
        ring = xy[row] + radius * np.column_stack([np.cos(turn), np.sin(turn)])
        owners.append(Owner(("osm", "node", int(osm.node_id[row])), tags))
        shapes.append(shapely.Polygon(np.round(ring, 4)))
    polygons = np.array(shapes, object)
    free = np.ones(len(polygons), bool)
    if len(polygons) and len(outlines):
        free[shapely.STRtree(outlines).query(polygons, predicate="intersects")[0]] = False
    owner = np.flatnonzero(free)
    return Tagged(polygons[free], owner, np.zeros(len(owner), np.int64), owners)
