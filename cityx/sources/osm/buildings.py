"""Buildings: outlines, made disjoint, with what is known of each."""

from __future__ import annotations

from dataclasses import dataclass
from math import pi
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.geometry.identity import UInt64Array
from cityx.sources.osm import measures
from cityx.sources.osm.elements import FloatArray, IntArray, OsmMap, Tags
from cityx.sources.osm.multipolygons import MIN_SOLID, polygons_of
from cityx.sources.osm.outlines import (
    Outlines,
    Owner,
    Report,
    Ring,
    join_outlines,
    number_pieces,
    ring_outlines,
    way_outlines,
)
from cityx.sources.osm.overlaps import separate_outlines
from cityx.sources.osm.site import Box, inside_site
from cityx.sources.osm.vocabulary import NO_BUILDING, ROOF_ONLY, TOWERS, is_underground

SIMPLE = 0.01  # metres; a point nearer to the line of its neighbours is no corner
ASSIGNED = 0.5  # share of a part that must lie in the outline it belongs to
# Radius in metres of towers that are drawn as a point.
POINT_TOWERS = {
    "chimney": 1.5, "silo": 3.0, "storage_tank": 6.0, "water_tower": 5.0, "gasometer": 15.0,
    "cooling_tower": 25.0, "lighthouse": 3.0, "communications_tower": 4.0, "obelisk": 1.2,
    "windmill": 4.0,
}  # fmt: skip
ROUND_SIDES = 16


def building_kind(tags: Tags) -> str:
    """Return "building", "part" or "" for the tags of an outline."""
    if tags.get("building", "") not in NO_BUILDING or tags.get("man_made") in TOWERS:
        return "" if is_underground(tags) else "building"
    if tags.get("building:part", "") not in NO_BUILDING:
        return "" if is_underground(tags) else "part"
    return ""


def use_of(tags: Tags) -> str:
    """Return what a building is used for: the value of building=*, or the word of a tower."""
    tower = tags.get("man_made", "")
    value = measures.word(tags.get("building") or tags.get("building:part"))
    if tower in TOWERS and value in ("", "yes", "tower", "industrial", "part"):
        return tower
    return value if value not in NO_BUILDING else "yes"


def type_word(tags: Tags) -> str:
    """Return the word that tells the type of a building; other tags help where it says "yes"."""
    use = use_of(tags)
    if use != "yes":
        return use
    amenity = tags.get("amenity", "")
    if amenity == "place_of_worship":
        return "church"
    if amenity in ("parking", "school", "university", "college", "hospital", "kindergarten",
                   "townhall", "library", "police", "fire_station", "theatre", "cinema",
                   "restaurant", "pub", "bank", "toilets", "marketplace"):  # fmt: skip
        return amenity
    tourism = tags.get("tourism", "")
    if tourism in ("hotel", "hostel", "museum", "guest_house"):
        return "hotel" if tourism != "museum" else "museum"
    if "shop" in tags:
        return "supermarket" if tags["shop"] in ("supermarket", "mall") else "yes"
    if "office" in tags:
        return "office"
    if tags.get("aeroway") in ("hangar", "terminal"):
        return tags["aeroway"]
    if tags.get("leisure") in ("stadium", "sports_centre", "sports_hall"):
        return tags["leisure"]
    return "yes"


@dataclass(frozen=True)
class Shells:
    """Outlines of buildings and of their parts, as they stand in the map.

    Attributes
    ----------
    outlines
        Disjoint, one per polygon.
    parts
        Polygons of building:part.
    building
        (parts,) row of the outline each part belongs to.
    """

    outlines: Outlines
    parts: Outlines
    building: IntArray


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


def read_shells(
    osm: OsmMap,
    xy: FloatArray,
    ways: tuple[IntArray, IntArray],
    relations: tuple[list[Ring], set[int]],
    box: Box,
    report: Report,
) -> tuple[Shells, Box]:
    """Read outlines and parts, choose those of the site, and make the outlines disjoint.

    Parameters
    ----------
    ways
        Rows of the ways that are outlines and of those that are parts.
    relations
        What `relation_rings` finds for `building_kind`.
    box
        The site.

    Returns
    -------
    shells
    box
        The site, grown to hold every building it keeps.
    """
    rings, spoken = relations
    outer = [ring for ring in rings if building_kind(ring.owner.tags) == "building"]
    inner = [ring for ring in rings if building_kind(ring.owner.tags) == "part"]
    heard = np.array(sorted(spoken), np.int64)
    own, own_parts = (rows[~np.isin(rows, heard)] for rows in ways)
    outlines = join_outlines(
        way_outlines(osm, xy, own, box, report, solid=True),
        ring_outlines(osm, xy, outer, box, report, solid=True),
    )
    outlines = join_outlines(outlines, _point_towers(osm, xy, outlines.polygons))
    parts = join_outlines(
        way_outlines(osm, xy, own_parts, box, report, solid=True),
        ring_outlines(osm, xy, inner, box, report, solid=True),
    )
    outlines, parts = _simple(outlines), _simple(parts)
    every = np.concatenate([outlines.polygons, parts.polygons])
    kept, box = inside_site(every, box)
    kept_outlines, kept_parts = np.split(kept, [len(outlines.polygons)])
    report.count("buildings outside the site", int((~kept_outlines).sum()))
    outlines = outlines.take(np.flatnonzero(kept_outlines))
    parts = parts.take(np.flatnonzero(kept_parts))
    outlines = _disjoint(outlines, report)
    outlines, building = _assigned(outlines, parts)
    return Shells(outlines, parts, building), box


def _simple(outlines: Outlines) -> Outlines:
    """Drop points that are no corners; the few outlines this would break stay as they are."""
    plain = shapely.simplify(outlines.polygons, SIMPLE, preserve_topology=True)
    sound = shapely.is_valid(plain) & (shapely.get_type_id(plain) == 3) & ~shapely.is_empty(plain)
    polygons = shapely.orient_polygons(np.where(sound, plain, outlines.polygons))
    return Outlines(polygons, outlines.owner, outlines.k, outlines.owners)


def _point_towers(osm: OsmMap, xy: FloatArray, outlines: NDArray[Any]) -> Outlines:
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
        owners.append(Owner("node", int(osm.node_id[row]), tags))
        shapes.append(shapely.Polygon(np.round(ring, 4)))
    polygons = np.array(shapes, object)
    free = np.ones(len(polygons), bool)
    if len(polygons) and len(outlines):
        free[shapely.STRtree(outlines).query(polygons, predicate="intersects")[0]] = False
    owner = np.flatnonzero(free)
    return Outlines(polygons[free], owner, np.zeros(len(owner), np.int64), owners)


def _disjoint(outlines: Outlines, report: Report) -> Outlines:
    tags = outlines.tags()
    # A canopy is worth less than a house, more tags are worth more.
    worth = np.array(
        [len(own) - 100 * (own.get("building") in ROOF_ONLY) for own in tags], np.int64
    )
    shapes, duplicate = separate_outlines(outlines.polygons, worth)
    report.count("buildings drawn twice", int(duplicate.sum()))
    polygons, row = polygons_of(shapes)
    lost = np.setdiff1d(np.flatnonzero(~duplicate), row)
    report.count("buildings covered by others", len(lost))
    owner, k = outlines.owner[row], outlines.k[row]
    order = np.lexsort((np.arange(len(row)), k, owner))
    owner = owner[order]
    return Outlines(
        shapely.orient_polygons(polygons[order]), owner, number_pieces(owner), outlines.owners
    )


def _assigned(outlines: Outlines, parts: Outlines) -> tuple[Outlines, IntArray]:
    """Find the outline of each part; parts without one form buildings of their own."""
    building = np.full(len(parts.polygons), -1, np.int64)
    if len(parts.polygons) == 0:
        return outlines, building
    part, outline = shapely.STRtree(outlines.polygons).query(parts.polygons, predicate="intersects")
    shared = shapely.area(shapely.intersection(parts.polygons[part], outlines.polygons[outline]))
    order = np.lexsort((outlines.ids()[outline], -np.round(shared, 3), part))
    part, outline, shared = part[order], outline[order], shared[order]
    first = np.ones(len(part), bool)
    first[1:] = part[1:] != part[:-1]
    enough = first & (shared >= ASSIGNED * shapely.area(parts.polygons[part]))
    building[part[enough]] = outline[enough]
    # Parts that overhang are none of their own where the ground below is another's.
    orphan = np.flatnonzero(building < 0)
    if len(orphan) == 0:
        return outlines, building
    taken = shapely.STRtree(outlines.polygons)
    groups = _groups(parts.polygons[orphan], parts.ids()[orphan])
    found: list[Any] = []
    owners: list[Owner] = []
    for group in np.unique(groups).tolist():
        rows = orphan[groups == group]
        head = parts.owners[parts.owner[rows[np.argmin(parts.ids()[rows])]]]
        shape = shapely.union_all(parts.polygons[rows], grid_size=1e-3)
        below = taken.query(shape, predicate="intersects")
        free = shapely.difference(shape, shapely.union_all(outlines.polygons[below]))
        pieces, _ = polygons_of(np.array([free], object), least=MIN_SOLID)
        if len(pieces) == 0:  # all of it lies in other outlines: it belongs to the nearest
            building[rows] = below[np.argmax(shapely.area(shapely.intersection(shape, outlines.polygons[below])))]  # fmt: skip  # noqa: E501
            continue
        # A building has one outline; the largest stands for all of its pieces.
        building[rows] = len(outlines.polygons) + len(found)
        found.append(pieces[0])
        owners.append(Owner(head.kind, head.osm_id, head.tags, ("building",)))
    own = np.arange(len(found))
    added = Outlines(
        shapely.orient_polygons(np.array(found, object)), own, np.zeros(len(own), np.int64), owners
    )
    return join_outlines(outlines, added), building


def _groups(polygons: NDArray[Any], ids: UInt64Array) -> IntArray:
    """Return the number of each polygon's group, joined by borders and shared areas."""
    from scipy.sparse import coo_matrix
    from scipy.sparse.csgraph import connected_components

    first, second = shapely.STRtree(polygons).query(polygons, predicate="intersects")
    joined = shapely.intersection(polygons[first], polygons[second])
    real = (shapely.area(joined) > 0) | (shapely.length(joined) > 0.5) | (first == second)
    size = len(ids)
    graph = coo_matrix((np.ones(real.sum()), (first[real], second[real])), (size, size))
    return np.asarray(connected_components(graph, directed=False)[1], np.int64)
