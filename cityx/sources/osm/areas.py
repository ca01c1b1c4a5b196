"""Areas: buildings, land use, greens, water and squares."""

from __future__ import annotations

from math import pi
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.geometry.arrays import FloatArray, IntArray
from cityx.sources.features import measures
from cityx.sources.features.clipping import Box, clip_lines
from cityx.sources.features.kinds import building_kind, is_thick, land_kind, line_kind
from cityx.sources.features.tagged import (
    MIN_AREA,
    MIN_SOLID,
    Owner,
    Report,
    Tagged,
    Tags,
    clipped_lines,
    clipped_polygons,
    joined,
    number_pieces,
)
from cityx.sources.features.vocabulary import (
    CARS,
    NO_BUILDING,
    WATER_KINDS,
    is_area,
    is_underground,
)
from cityx.sources.features.waterways import waterway_kind, waterway_width, waterways
from cityx.sources.osm.elements import OsmMap, way_lines
from cityx.sources.osm.outlines import (
    MAX_AVOIDED,
    Ring,
    relation_rings,
    ring_outlines,
    tagged_lines,
    way_outlines,
    way_owner,
)

# The sea: what lies to the right of the coastline.

PROBE = 0.05  # metres beside a coast segment at which its two sides are looked up
# An extract cuts ways at the last node inside it; the next one lies about a segment further.
REACH = 120.0
REACH_SHARE = 0.1  # of the site's shorter side, where that is less
# Of the coast along a face, the share by which one side must win: a coastline that ends within a
# face has both sides in it and decides nothing.
MARGIN = 0.2
# Of the buildings of a site, or of its streets, the share that cannot stand in one sea, and the
# least metres of streets that tell.
DROWNED, LEAST_STREETS = 0.2, 200.0
DRY = "puts much of the town into the sea, as no coast does; no sea was built there"
# Radius in metres of towers that are drawn as a point.
POINT_TOWERS = {
    "chimney": 1.5, "silo": 3.0, "storage_tank": 6.0, "water_tower": 5.0, "gasometer": 15.0,
    "cooling_tower": 25.0, "lighthouse": 3.0, "communications_tower": 4.0, "obelisk": 1.2,
    "windmill": 4.0,
}  # fmt: skip
ROUND_SIDES = 16


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
    osm: OsmMap, xy: FloatArray, ways: IntArray, box: Box, report: Report, buildings: NDArray[Any]
) -> tuple[Tagged, NDArray[Any]]:
    """Read every area of the site, and the kind of each.

    Parameters
    ----------
    ways
        Rows of the closed ways with a kind.
    buildings
        Points of the buildings; they tell on which side of a cut outline the area lies.
    """
    rings, spoken = relation_rings(osm, land_kind, report)
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
    sea = _sea(osm, xy, box, report, buildings)
    flow = np.array([waterway_kind(tags) for tags in streams.tags()], object)
    more = np.full(len(sea.k), "sea", object)
    return joined(outlines, streams, sea), np.concatenate([kinds, flow, more])


def read_barriers(osm: OsmMap, xy: FloatArray, ways: IntArray, box: Box, report: Report) -> Tagged:
    """Read barriers: lines, and polygons of those that are drawn with their thickness.

    Parameters
    ----------
    ways
        Rows of the ways that are barriers.
    """
    rings, _ = relation_rings(osm, _related_barrier, report)
    held = {
        way
        for ring in rings
        for way in ring.ways
        if line_kind(osm.way_tags[way]) == line_kind(ring.owner.tags)
    }
    own = ways[~np.isin(ways, sorted(held))]
    solid = np.array(
        [osm.way_closed[way] and is_area(tags) and is_thick(tags)
         for way, tags in ((way, osm.way_tags[way]) for way in own.tolist())], bool,
    )  # fmt: skip
    thick = [ring for ring in rings if is_thick(ring.owner.tags)]
    around = [ring for ring in rings if not is_thick(ring.owner.tags)]
    outlines = joined(
        way_outlines(osm, xy, own[solid], box, report, solid=True),
        ring_outlines(osm, xy, thick, box, report, solid=True),
    )
    lines = joined(tagged_lines(osm, xy, own[~solid]), _ring_lines(osm, xy, around))
    return joined(clipped_lines(lines, box), clipped_polygons(outlines, box, least=MIN_SOLID))


def _related_barrier(tags: Tags) -> str:
    """Return the kind of barrier that a relation is by its own tags, or ""."""
    if tags.get("type") != "multipolygon" or building_kind(tags):
        return ""
    return line_kind(tags)


def _ring_lines(osm: OsmMap, xy: FloatArray, rings: list[Ring]) -> Tagged:
    """Return the outlines of relations as lines: the fence round a pitch with an island in it."""
    of = np.repeat(np.arange(len(rings)), [len(ring.ways) for ring in rings]).astype(np.int64)
    lines, index = way_lines(osm, xy, [way for ring in rings for way in ring.ways])
    owner = of[index]
    return Tagged(lines, owner, number_pieces(owner), [ring.owner for ring in rings])


def _water_lines(osm: OsmMap) -> IntArray:
    """Return the ways along which water flows."""
    rows = [row for row, tags in enumerate(osm.way_tags) if waterway_width(tags) > 0]
    return np.array(rows, np.int64)


def _sea(osm: OsmMap, xy: FloatArray, box: Box, report: Report, buildings: NDArray[Any]) -> Tagged:
    coast = [row for row, tags in enumerate(osm.way_tags) if tags.get("natural") == "coastline"]
    polygons = np.zeros(0, object)
    if coast:
        lines, index = way_lines(osm, xy, coast)
        polygons = sea_polygons(lines, box)
        polygons = polygons[np.lexsort(np.round(shapely.bounds(polygons), 2).reshape(-1, 4).T)]
        dry = _built_upon(polygons, buildings, _ground_streets(osm, xy, box))
        for row in np.unique(index[_bounding(lines, polygons[dry])]).tolist():
            owner = way_owner(osm, coast[row])
            report.fail(owner.id(), f"{owner.source} {DRY}")
        polygons = polygons[~dry]
    k = np.arange(len(polygons))
    return Tagged(polygons, np.zeros(len(k), np.int64), k, [Owner(("osm", "coastline", 0), {})])


def _ground_streets(osm: OsmMap, xy: FloatArray, box: Box) -> NDArray[Any]:
    """Return the lines of streets on the ground, cut at the site."""
    rows = [
        row
        for row, tags in enumerate(osm.way_tags)
        if tags.get("highway") in CARS and not {"bridge", "tunnel", "ford"}.intersection(tags)
    ]
    return clip_lines(way_lines(osm, xy, rows)[0], box)[0]


def _built_upon(
    seas: NDArray[Any], buildings: NDArray[Any], streets: NDArray[Any]
) -> NDArray[np.bool_]:
    """(n,) whether too much of a town stands in a sea for its coastline to be believed.

    Parameters
    ----------
    seas
        (n,) polygons.
    buildings, streets
        Points and lines of the whole site.
    """
    face, _ = shapely.STRtree(buildings).query(seas, predicate="intersects")
    drowned = np.bincount(face, minlength=len(seas))
    dry = (drowned > MAX_AVOIDED) & (drowned > DROWNED * len(buildings))
    face, line = shapely.STRtree(streets).query(seas, predicate="intersects")
    inside = shapely.length(shapely.intersection(seas[face], streets[line]))
    length = np.bincount(face, inside, minlength=len(seas))
    return np.asarray(dry | (length > max(LEAST_STREETS, DROWNED * shapely.length(streets).sum())))


def _bounding(lines: NDArray[Any], faces: NDArray[Any]) -> NDArray[np.int64]:
    """Return the rows of the lines that bound some faces."""
    found = shapely.STRtree(lines).query(shapely.boundary(faces), "dwithin", distance=PROBE)[1]
    return np.asarray(np.unique(found), np.int64)


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
