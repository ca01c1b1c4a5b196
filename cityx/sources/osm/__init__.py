"""OpenStreetMap as a source: a map file becomes a city with a resolved layout."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import shapely

from cityx.city import City, Failure, Frame
from cityx.city.layout import empty_table, make_table
from cityx.errors import InputError
from cityx.geometry.arrays import FloatArray, IntArray
from cityx.geometry.ranges import numbered
from cityx.ids import stable_id
from cityx.sources.features.clipping import Box
from cityx.sources.features.kinds import (
    building_kind,
    is_road_way,
    land_kind,
    line_kind,
    name_unseen,
    point_kind,
)
from cityx.sources.features.resolve import Features, density_of, resolve
from cityx.sources.features.road_features import (
    name_edges,
    name_points,
    name_repairs,
    share_about,
    with_rails,
)
from cityx.sources.features.shells import make_shells, name_covered
from cityx.sources.features.tagged import Owner, Report, Tagged, Tags, clipped_lines, tag
from cityx.sources.features.vertical import unread_keys
from cityx.sources.features.vocabulary import LINE_KEYS
from cityx.sources.input_kinds import place_name
from cityx.sources.osm.areas import candidate_ways, read_areas, read_barriers, read_outlines
from cityx.sources.osm.elements import OsmMap
from cityx.sources.osm.outlines import (
    Ring,
    relation_rings,
    tagged_lines,
    tagged_owners,
    way_owner,
)
from cityx.sources.osm.reader import read_elements

if TYPE_CHECKING:
    from geopandas import GeoDataFrame


__all__ = ["ATTRIBUTION", "city_of", "coverage_of", "read_osm", "site_of"]

ATTRIBUTION = "© OpenStreetMap contributors, ODbL 1.0, openstreetmap.org/copyright"
ACTION = "source/osm"
MAX_FAILURES = 200  # named one by one; the rest are counted
MIN_DEGREES = 2e-5  # about 2 m; a smaller declared rectangle is a mistake
OUTLIERS = 0.02  # share of points at either end that may be outliers
OVERHANG = 0.25  # how far beyond the rest points still belong to the site, of the rest's span
FEW_POINTS = 200  # fewer say nothing about outliers
PILE_CELL, MOST_IN_CELL = 1e-5, 4  # degrees, a metre; how many points of one spot count
PILED = 0.1  # share of the points beyond that, from which buildings are piled up
FEW_BUILDINGS = 50  # of so few none is an outlier, however finely another one is drawn
WIDEST = 100e3  # metres; a plane does not stand for the Earth beyond, nor memory for its grids
DEGREE = 111_320.0  # metres, of latitude
CARS = ("motorcar", "motor_vehicle", "vehicle")


def read_osm(
    path: Path,
    *,
    seed: int = 0,
    name: str = "",
    place: str = "",
    frame: Frame | None = None,
    box: Box | None = None,
) -> City:
    """Read a map file into a city whose layout is complete: nothing in its tables is missing.

    Parameters
    ----------
    path
        An .osm, .osm.gz, .osm.bz2 or .osm.pbf file; the content decides, not the suffix.
    seed
        Key of every draw for what the map does not say.
    name
        Of the place; the file's own name by default.
    place
        Profile of the place that the user asked for, as of `cityx.city.frame.Frame`.
    frame
        Where the scene lies; about the middle of the site by default. Windows of one map that are
        to agree share it.
    box
        The site in the scene frame, metres; found by where the map is dense by default. It grows
        by the buildings that cross its border.

    Raises
    ------
    InputError
        If the file cannot be read or holds neither buildings nor roads.
    """
    path = Path(path)
    return city_of(
        read_elements(path), str(path), seed=seed, name=name or place_name(path.name), place=place,
        frame=frame, box=box,
    )  # fmt: skip


def city_of(
    osm: OsmMap,
    path: str,
    *,
    seed: int = 0,
    name: str = "",
    place: str = "",
    frame: Frame | None = None,
    box: Box | None = None,
    bare: bool = False,
    coverage: Mapping[str, float] | None = None,
) -> City:
    """Make the city of the elements of a map; see `read_osm`.

    Parameters
    ----------
    osm
        The elements.
    path
        What messages call the map.
    bare
        Whether land without buildings and roads counts as a city too, as in a tile of a country.
    coverage
        As of `coverage_of`, of a map that this is a part of.

    Raises
    ------
    InputError
        If the map holds neither buildings nor roads.
    """
    report = Report()
    if frame is None or box is None:
        own, site = site_of(osm, path)
        frame, box = frame or own, box or site
    frame = replace(frame, place=place)
    features = _features(osm, frame, box, report)
    shells = features.shells
    if not (len(shells.outlines.shapes) or len(features.roads.shapes) or bare):
        raise InputError(_nothing(path, osm))
    features = replace(features, coverage=coverage or {})
    layout = resolve(features, frame, seed=seed)
    name_covered(shells, layout.buildings["id"].to_numpy(np.uint64), report)
    return City(
        name,
        frame,
        layout,
        seed=seed,
        attribution=(ATTRIBUTION,),
        stages_done=frozenset({"layout"}),
        failures=tuple(
            Failure(key, ACTION, why) for key, why in sorted(report.failures)[:MAX_FAILURES]
        ),
        notes=_notes(osm, report),
    )


def _features(osm: OsmMap, frame: Frame, box: Box, report: Report) -> Features:
    """Find what a map has within a site; what is odd goes into the report."""
    ways = candidate_ways(osm)
    roads, areas, lines = _other_ways(osm)
    relations = relation_rings(osm, building_kind, report)
    xy = _project(frame, osm.lonlat)
    name_unseen(tagged_owners(osm), report)
    outlines, parts = read_outlines(osm, xy, ways, relations, box, report)
    shells, box = make_shells(outlines, parts, box, report)
    for owner in (*shells.outlines.owners, *shells.parts.owners):
        for key in unread_keys(owner.tags):
            report.name(f"values of {key} cannot be used and were filled in", owner)
    streets = _roads(osm, xy, roads, box, report)
    middles = shapely.centroid(shells.outlines.shapes)
    land, kinds = read_areas(osm, xy, areas, box, report, middles)
    standing = read_barriers(osm, xy, lines, box, report)
    name_edges(standing, streets, report)
    return Features(
        box,
        shells,
        roads=streets,
        areas=land,
        area_kinds=kinds,
        lines=standing,
        points=_points(osm, xy, box),
        restrictions=restriction_table(osm, xy, box),
    )


def coverage_of(osm: OsmMap, frame: Frame, box: Box) -> dict[str, float]:
    """Return how densely it is built about the middle of each road of a site.

    Tiles share it: a tile that a long road crosses does not see the surroundings of its middle.

    Returns
    -------
    coverage
        As of `cityx.sources.features.resolve.Features`.
    """
    features = _features(osm, frame, box, Report())
    roads = features.roads
    if not len(roads.shapes):
        return {}
    shares = share_about(roads.shapes, density_of(features)).tolist()
    sources = [roads.owners[index].source for index in roads.owner.tolist()]
    # Of pieces of one road, which the border of the site makes, the first counts.
    return dict(zip(reversed(sources), reversed(shares), strict=True))


def site_of(osm: OsmMap, path: str) -> tuple[Frame, Box]:
    """Return the frame and the site that `city_of` finds for a map.

    Raises
    ------
    InputError
        If the map holds neither buildings nor roads.
    """
    rings = relation_rings(osm, building_kind, Report())[0]
    roads, areas, _ = _other_ways(osm)
    degrees = site_degrees(osm, _solid(candidate_ways(osm), rings), roads, areas)
    if degrees is None:
        raise InputError(_nothing(path, osm))
    frame = _frame(degrees)
    return frame, _local_box(frame, degrees)


def _solid(ways: Sequence[IntArray], rings: Sequence[Ring]) -> IntArray:
    """Return the rows of all ways that may be buildings."""
    members = [way for ring in rings for way in ring.ways]
    return np.concatenate([*ways, np.array(members, np.int64)])


def _other_ways(osm: OsmMap) -> tuple[IntArray, IntArray, IntArray]:
    """Sort the ways into roads, areas and lines; a way may be two of them."""
    roads, areas, lines = [], [], []
    for row, (tags, closed) in enumerate(zip(osm.way_tags, osm.way_closed.tolist(), strict=True)):
        if not tags:
            continue
        travelled = "highway" in tags or "railway" in tags
        if travelled and is_road_way(tags, closed=closed):
            roads.append(row)
        standing = not LINE_KEYS.isdisjoint(tags) and line_kind(tags)
        # A wall that is a building besides is built as one.
        if standing and not (closed and building_kind(tags)):
            lines.append(row)
        along = travelled or standing or "waterway" in tags
        if (closed or not along) and land_kind(tags):
            areas.append(row)
    return np.array(roads, np.int64), np.array(areas, np.int64), np.array(lines, np.int64)


def _frame(degrees: Box) -> Frame:
    west, south, east, north = degrees
    longitude = (west + east) / 2
    longitude -= 360.0 * round(longitude / 360.0)
    # + 0.0 turns a negative zero into zero, so that projections are spelled alike.
    return Frame(round((south + north) / 2, 6) + 0.0, round(longitude, 6) + 0.0)


def _project(frame: Frame, lonlat: FloatArray) -> FloatArray:
    """Project nodes; those on the far side of the Earth get a place far outside any site."""
    xy = frame.to_local(lonlat)
    return np.where(np.isfinite(xy).all(axis=1, keepdims=True), xy, 1e8)


def _local_box(frame: Frame, degrees: Box) -> Box:
    west, south, east, north = degrees
    x, y = np.meshgrid(np.linspace(west, east, 3), np.linspace(south, north, 3))
    corner = frame.to_local(np.column_stack([x.ravel(), y.ravel()]))
    xmin, ymin = corner.min(axis=0).tolist()
    xmax, ymax = corner.max(axis=0).tolist()
    return xmin, ymin, xmax, ymax


def _roads(osm: OsmMap, xy: FloatArray, ways: IntArray, box: Box, report: Report) -> Tagged:
    """Return the roads of the site; points of ways that meet stay equal."""
    missing = osm.missing_nodes()[ways] > 0
    for way in ways[missing].tolist():
        report.name("roads with missing nodes", way_owner(osm, way))
    lines = tagged_lines(osm, xy, ways)
    pointlike = np.setdiff1d(np.flatnonzero(~missing), lines.owner)
    name_points((lines.owners[row] for row in pointlike.tolist()), report)
    roads = clipped_lines(with_rails(lines), box)
    name_repairs(roads, box, report)
    return roads


def _points(osm: OsmMap, xy: FloatArray, box: Box) -> Tagged:
    """Return the nodes of the site at which something stands."""
    low, high = np.array(box[:2]), np.array(box[2:])
    spots = xy[osm.tagged]
    inside = np.flatnonzero(((spots >= low) & (spots <= high)).all(axis=1)).tolist()
    found = [index for index in inside if point_kind(osm.node_tags[index])]
    rows = osm.tagged[found]
    owners = [
        Owner(("osm", "node", key), osm.node_tags[index])
        for key, index in zip(osm.node_id[rows].tolist(), found, strict=True)
    ]
    return tag(shapely.points(xy[rows]), owners)


def _nothing(path: str, osm: OsmMap) -> str:
    total = len(osm.node_id) + len(osm.way_id) + len(osm.relation_id)
    if total == 0:
        return f"{path} holds no map: it has no nodes, ways or relations."
    lost = int((osm.way_nodes < 0).sum())
    cause = (
        f"; {lost:,} of the {len(osm.way_nodes):,} nodes that ways refer to are not in the file"
        if lost
        else ""
    )
    return (
        f"{path} holds no city: none of its {len(osm.way_id):,} ways and {len(osm.relation_id):,} "
        f"relations make a building or a road{cause}."
    )


def _notes(osm: OsmMap, report: Report) -> tuple[str, ...]:
    counts = dict(sorted({**osm.skipped, **report.counts}.items()))
    notes = [f"map: {number} {what}" for what, number in counts.items() if number]
    notes += report.notes()
    if len(report.failures) > MAX_FAILURES:
        more = len(report.failures) - MAX_FAILURES
        notes.append(f"map: {more} more outlines could not be read")
    return tuple(notes)


def site_degrees(osm: OsmMap, buildings: IntArray, roads: IntArray, others: IntArray) -> Box | None:
    """Choose the rectangle to build, (west, south, east, north) in degrees.

    The rectangle the file declares is taken when it holds things to build, cut down to them; else
    a rectangle around the nodes of buildings and roads without far outliers, such as the ends of
    long roads. None when nothing has a position.

    Parameters
    ----------
    buildings, roads, others
        Rows of the ways.
    """
    places = osm.lonlat[osm.nodes_of(np.concatenate([buildings, roads]))]
    if len(places) == 0:
        return None
    reach = _reach(places)
    places = _within_reach(places, reach)
    if osm.bounds is not None:
        low, high = np.array(osm.bounds[:2]), np.array(osm.bounds[2:])
        inside = ((places >= low) & (places <= high)).all(axis=1)
        if (high - low).min() > MIN_DEGREES and inside.any():
            every = osm.lonlat[osm.nodes_of(np.concatenate([buildings, roads, others]))]
            every = _within_reach(every, reach)
            return _box(np.maximum(low, every.min(axis=0)), np.minimum(high, every.max(axis=0)))
    focus = _within_reach(osm.lonlat[osm.nodes_of(buildings)], reach)
    by_buildings = len(focus) >= max(FEW_POINTS, len(places) / 10)
    # Where roads lie denser than buildings (a map without houses) they decide.
    if not by_buildings:
        focus = places
    if len(focus) < FEW_POINTS or (by_buildings and len(buildings) < FEW_BUILDINGS):
        return _box(focus.min(axis=0), focus.max(axis=0))
    spread = _spread(focus)
    if len(spread) < FEW_POINTS:
        return _box(focus.min(axis=0), focus.max(axis=0))
    low, high = np.quantile(spread, [OUTLIERS, 1 - OUTLIERS], axis=0)
    overhang = OVERHANG * (high - low)
    return _box(
        np.maximum(low - overhang, focus.min(axis=0)),
        np.minimum(high + overhang, focus.max(axis=0)),
    )


def _reach(places: FloatArray) -> FloatArray:
    """Return the (2, 2) lowest and highest longitude and latitude that one site can span."""
    away = places - np.median(places, axis=0)
    middle = places[np.argmin((away**2).sum(axis=1))]  # between two far clusters lies nothing
    half = WIDEST / 2 / DEGREE / np.array([max(np.cos(np.radians(middle[1])), 0.01), 1.0])
    return np.array([middle - half, middle + half])


def _within_reach(places: FloatArray, reach: FloatArray) -> FloatArray:
    inside = ((places >= reach[0]) & (places <= reach[1])).all(axis=1)
    return np.asarray(places[inside], np.float64)


def _spread(places: FloatArray) -> FloatArray:
    """Return places without most of a pile, beside which all of a town would be outliers."""
    cell = np.floor(places / PILE_CELL).astype(np.int64)
    _, of, number = np.unique(cell, axis=0, return_inverse=True, return_counts=True)
    order = np.argsort(of, kind="stable")
    rank = np.empty(len(of), np.int64)
    rank[order] = numbered(number)
    kept = rank < MOST_IN_CELL
    return places if kept.mean() > 1 - PILED else places[kept]


def _box(low: FloatArray, high: FloatArray) -> Box:
    # A site on one line still needs an area: 20 m around it.
    pad = np.where(high - low < 2e-4, 2e-4, 0.0)
    west, south = (low - pad).tolist()
    east, north = (high + pad).tolist()
    return west, south, east, north


def restriction_table(osm: OsmMap, xy: FloatArray, box: Box) -> GeoDataFrame:
    """Read the restrictions at junctions of the site; those with a member missing are passed over.

    A restriction over a way instead of a node counts at the node where the way it comes from ends.
    """
    rows = []
    for key, members, tags in zip(osm.relation_id, osm.members, osm.relation_tags, strict=True):
        kind = _kind(tags)
        if not kind:
            continue
        roles: dict[str, list[tuple[str, int]]] = {}
        for member, reference, role in members:
            roles.setdefault(role, []).append((member, reference))
        begin = [ref for member, ref in roles.get("from", []) if member in ("w", "way")]
        end = [ref for member, ref in roles.get("to", []) if member in ("w", "way")]
        via = [ref for member, ref in roles.get("via", []) if member in ("n", "node")]
        place = _node_row(osm, via[0]) if via else -1
        if not begin or not end or place < 0:
            continue
        place_x, place_y = xy[place].tolist()
        if not (box[0] <= place_x <= box[2] and box[1] <= place_y <= box[3]):
            continue
        for origin in begin:
            for target in end:
                rows.append((key, origin, target, kind == "only", place_x, place_y))
    if not rows:
        return empty_table("restrictions")
    relations, origins, targets, only, x, y = zip(*rows, strict=True)
    ids = [stable_id("osm", "relation", *row[:3]) for row in rows]
    return make_table(
        "restrictions", shapely.points(np.array(x), np.array(y)), id=np.array(ids, np.uint64),
        source=[f"osm/relation/{key}" for key in relations],
        from_source=[f"osm/way/{key}" for key in origins],
        to_source=[f"osm/way/{key}" for key in targets], only=list(only),
    )  # fmt: skip


def _node_row(osm: OsmMap, node: int) -> int:
    row = int(np.searchsorted(osm.node_id, node))
    return row if row < len(osm.node_id) and osm.node_id[row] == node else -1


def _kind(tags: Tags) -> str:
    """Return "no", "only", or "" for a relation that does not bind cars all day."""
    if tags.get("type") != "restriction" or any(word in tags.get("except", "") for word in CARS):
        return ""
    value = tags.get("restriction") or tags.get("restriction:motorcar") or ""
    if "hour_on" in tags or "@" in tags.get("restriction:conditional", ""):
        return ""
    head = value.split("_")[0]
    return head if head in ("no", "only") and value != "no_entry" and value != "no_exit" else ""
