"""Cutting new streets, rivers and coasts through a finished layout."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import fields, replace
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.checks.predicates.words import LANDS, RAILWAYS
from cityx.city import City, Layout
from cityx.city.layout import joined_tables
from cityx.city.sites import Box, cut_to, pieces_of
from cityx.errors import ActionFailed
from cityx.geometry.arrays import BoolArray, FloatArray, IntArray
from cityx.geometry.polylines import pack
from cityx.ids import stable_id
from cityx.places.profiles import profile_of
from cityx.road.network.network import DRIVABLE
from cityx.sources.features.gather import gather
from cityx.sources.features.resolve import Features, resolve
from cityx.sources.features.shells import Shells
from cityx.sources.features.tagged import Owner, Report, Tags, joined, nothing, tag
from cityx.town.blocks import LAND, LEAST, THIN, Blocks
from cityx.town.procedural_streets import half_width
from cityx.town.rebuilding import (
    BUILT_ON,
    cleared,
    is_made,
    is_square,
    street_blocks,
    with_area,
    without_buildings,
)
from cityx.town.window import buildings_on

BESIDE = 24.0  # metres from a new street within which an old one along it is given up
ALONG = 2.2  # times that; a longer piece so near runs along it, a shorter one leads to it
MERGED = 20.0  # metres between places on a new street that become one junction
STUB = 6.0  # metres; what is left of a street that is shorter is given up
REACH = 90.0  # metres from what is left of a street to the new one it is led to
AHEAD = 0.5  # cosine of the most that a street turns to be led to a new one
ON = 0.02  # metres within which a point lies on a line
ROUND = 3  # decimals of metres of new places; nodes of streets are shared to the millimetre
# Zone of a block by the use of most of its buildings.
ZONE_OF_USE: Mapping[str, str] = {
    "apartments": "midrise", "office": "core", "terrace": "row", "house": "suburb",
    "detached": "suburb", "bungalow": "suburb", "semidetached_house": "semi",
    "industrial": "industry", "warehouse": "industry", "retail": "retail strip",
}  # fmt: skip
WIDER = 0.05  # metres from which a street that is wider needs ground
NEXT = 2.0  # metres from what was taken to a block that lost ground
BEYOND = 40.0  # metres beyond the border of the site to which a block that it cuts goes on
OWN = ("town/", "made/block/")  # sources of the land of blocks
PARCEL, FRONT = "parcel/", 0.9  # sources of parcels; metres from one to the walk it lies on
TABLES = ("buildings", "parts", "areas", "lines", "points")


def strip_of(line: Any, tags: dict[str, str], city: City) -> Any:
    """Return the ground that a street takes with its walks."""
    half = half_width(tags, profile_of(city.frame))
    return shapely.buffer(line, half, cap_style="flat", join_style="mitre")


def with_streets(city: City, streets: Sequence[tuple[Any, Owner]], ground: Any) -> City:
    """Lay new streets through a layout and lead to them what they interrupt.

    Buildings, land and things on the ground they take are cleared, and blocks of a procedural town
    that lose ground are built anew. A street that they cut ends
    on the nearest of them; one that would run close beside them is given up.

    Parameters
    ----------
    streets
        Lines in the scene frame, metres, and what is said of each.
    ground
        Polygon that is cleared; it holds the new streets.

    Raises
    ------
    ActionFailed
        If there is water on it.

    Returns
    -------
    city
        Whose new streets have a point wherever another meets them.
    """
    areas = city.layout.areas
    wet = areas.geometry.to_numpy()[areas["kind"].isin(LANDS["water"]).to_numpy()]
    if shapely.intersects(wet, ground).any():
        raise ActionFailed(
            "It would cross water, over which only a river's own bridges lead; lay out streets "
            "before the river, and none towards the sea."
        )
    layout = cleared(city.layout, ground)
    lines = [line for line, _ in streets]
    rest, open_ends, gone = _interrupted(layout, ground)
    street, at, fine = _landings(rest, open_ends, lines)
    moved, met = _joined_places(lines, street, at)
    rest = _pruned(_led_on(rest, open_ends[fine], moved), open_ends[~fine])
    placed = [with_points(line, met[k]) for k, line in enumerate(lines)]
    roads = pieces_of(layout.roads, _shapes(rest, len(layout.roads)), 1)
    new = street_rows(city, placed, [owner for _, owner in streets])
    cut = replace(city, layout=replace(layout, roads=joined_tables(roads, new)))
    return refilled(cut, city.layout, gone, ground)


def given_up_in(layout: Layout, ground: Any) -> Layout:
    """Take the streets off a piece of ground; what led there ends at the junction before it."""
    shapes = layout.roads.geometry.to_numpy()
    hit = shapely.intersects(shapes, ground)
    left = np.where(hit, shapely.difference(shapes, ground), shapes)
    parts, row = shapely.get_parts(left, return_index=True)
    parts, row = parts[shapely.length(parts) > ON], row[shapely.length(parts) > ON]
    rest = [(k, shapely.get_coordinates(part)) for k, part in zip(row.tolist(), parts, strict=True)]
    tips = np.array([points[[0, -1]] for _, points in rest])
    lost = shapely.union_all(shapely.intersection(shapes[hit], ground))
    ends = np.argwhere(shapely.distance(shapely.points(tips), lost) <= ON)
    rails = set(np.flatnonzero(layout.roads["kind"].isin(RAILWAYS).to_numpy()).tolist())
    kept = _shapes(_pruned(rest, ends, rails), len(shapes))
    return replace(layout, roads=pieces_of(layout.roads, kept, 1))


def street_rows(city: City, lines: Sequence[Any], owners: list[Owner]) -> Any:
    """Make rows of the table of roads."""
    none = Shells(nothing(), nothing(), np.zeros(0, np.int64))
    found = Features(city.layout.extent, none, roads=tag(lines, owners))
    return resolve(found, city.frame, seed=city.seed).roads


def with_tags(city: City, rows: IntArray, tags: Sequence[Tags], *, make_room: bool = True) -> City:
    """Give streets other tags, and the cross-sections that follow from them.

    Blocks of a procedural town along streets that become wider are built anew; elsewhere streets
    have the room that buildings leave.

    Parameters
    ----------
    rows, tags
        (k,) rows of the table of roads, and all tags of each.
    make_room
        Whether blocks give way to streets that become wider.
    """
    layout = city.layout
    roads = layout.roads.copy()
    lines = list(roads.geometry.to_numpy()[rows])
    owners = [Owner(("made", "tags", k), own) for k, own in enumerate(tags)]
    new = street_rows(city, lines, owners)
    ids = np.array([owner.id() for owner in owners], np.uint64)
    order = np.searchsorted(new["id"].to_numpy(), ids)
    kept = ("id", "source", "name", "geometry")
    for column in roads.columns:
        if column not in kept:
            values = roads[column].to_numpy().copy()
            values[rows] = new[column].to_numpy()[order]
            roads[column] = values
            roads[column] = roads[column].astype(layout.roads[column].dtype)
    changed = replace(city, layout=replace(layout, roads=roads))
    if not make_room or not layout.areas["source"].str.startswith(OWN).any():
        return changed
    before, after = _reach(layout.roads)[rows], _reach(roads)[rows]
    wider = np.flatnonzero(after > before + WIDER)
    if not len(wider):
        return changed
    own = np.array(lines, object)[wider]
    strips = shapely.buffer(own, after[wider], cap_style="flat", join_style="mitre")
    ground = shapely.difference(
        shapely.union_all(strips),
        shapely.union_all(shapely.buffer(layout.roads.geometry.to_numpy(), _reach(layout.roads))),
    )
    changed = replace(changed, layout=cleared(changed.layout, ground))
    return refilled(changed, layout, ground, ground)


def _reach(roads: Any) -> FloatArray:
    """(n,) metres from the middle of each street to where its walks end."""
    walks = roads[["sidewalk_left", "sidewalk_right"]].max(axis=1).to_numpy(float)
    return np.asarray(np.nan_to_num(roads["width"].to_numpy(float)) / 2 + np.nan_to_num(walks))


def with_points(line: Any, places: FloatArray) -> Any:
    """Return a line with places along it among its points."""
    own = shapely.get_coordinates(line)
    every = np.concatenate([own, np.asarray(places).reshape(-1, 2)])
    at = shapely.line_locate_point(line, shapely.points(every))
    at[0], at[len(own) - 1] = -1.0, line.length + 1.0
    ordered = every[np.argsort(at, kind="stable")]
    new = np.append(True, (np.abs(np.diff(ordered, axis=0)) > ON).any(axis=1))
    return shapely.LineString(ordered[new])


# A stretch of an old street: row of the table of roads and its points.
Rest = list[tuple[int, FloatArray]]


def _interrupted(layout: Layout, ground: Any) -> tuple[Rest, IntArray, Any]:
    """Return what is left of the streets, and its ends that lead nowhere now.

    Returns
    -------
    rest
        k stretches.
    open_ends
        (e, 2) stretch, and 0 or 1 for its first or last point.
    gone
        The ground, and that of the streets given up beside it.
    """
    shapes = layout.roads.geometry.to_numpy()
    along = _given_up(shapes, ground)
    gone = shapely.union_all([ground, *shapely.buffer(along, ON / 2)])
    hit = shapely.intersects(shapes, gone)
    left = np.where(hit, shapely.difference(shapes, gone), shapes)
    parts, row = shapely.get_parts(left, return_index=True)
    keep = (shapely.length(parts) > 0) & (~hit[row] | (shapely.length(parts) >= STUB))
    parts, row = parts[keep], row[keep]
    drivable = layout.roads["kind"].isin(DRIVABLE).to_numpy()[row]
    packed = pack(parts)
    tips = np.stack([packed.points[packed.start[:-1]], packed.points[packed.start[1:] - 1]], axis=1)
    lost = shapely.union_all(shapely.intersection(shapes[hit], gone))
    away = shapely.distance(shapely.points(tips), lost)  # (k, 2)
    rest = [
        (int(row[k]), packed.points[packed.start[k] : packed.start[k + 1]].copy())
        for k in range(len(row))
    ]
    taken = shapely.union_all([ground, *shapely.buffer(along, BESIDE)])
    return rest, np.argwhere((away <= ON) & drivable[:, None]), taken


def _given_up(shapes: NDArray[Any], ground: Any) -> NDArray[Any]:
    """Return the stretches of old streets that run close along what is taken."""
    wide = shapely.buffer(ground, BESIDE, join_style="mitre")
    near = shapes[shapely.intersects(shapes, wide)]
    within = shapely.difference(shapely.intersection(near, wide), ground)
    beside = shapely.get_parts(shapely.line_merge(within))
    return np.asarray(beside[shapely.length(beside) > ALONG * BESIDE])


def _landings(
    rest: Rest, open_ends: IntArray, lines: list[Any]
) -> tuple[IntArray, FloatArray, BoolArray]:
    """Return which open ends are led on to a new street: its number, metres along it, and which."""
    none = np.zeros(0, np.int64)
    if not len(open_ends):
        return none, np.zeros(0), np.zeros(0, bool)
    ends = [rest[k][1][::-1] if last else rest[k][1] for k, last in open_ends.tolist()]
    tips, ways = np.array([end[0] for end in ends]), np.array([end[0] - end[1] for end in ends])
    points = shapely.points(tips)
    away = np.stack([shapely.distance(points, line) for line in lines], axis=1)
    street = away.argmin(axis=1)
    chosen = np.array(lines, object)[street]
    at = shapely.line_locate_point(chosen, points)
    onward = shapely.get_coordinates(shapely.line_interpolate_point(chosen, at)) - tips
    ahead = (onward * ways).sum(axis=1) / np.maximum(np.hypot(*onward.T) * np.hypot(*ways.T), 1e-9)
    fine = (away.min(axis=1) <= REACH) & (ahead >= AHEAD)
    return street[fine], at[fine], fine


def _joined_places(
    lines: list[Any], street: IntArray, at: FloatArray
) -> tuple[FloatArray, list[FloatArray]]:
    """Decide where streets meet new ones: near places become one.

    Returns
    -------
    places
        (e, 2) of each end, metres.
    met
        (m, 2) per new street.
    """
    places = np.zeros((len(at), 2))
    met: list[FloatArray] = []
    for k, line in enumerate(lines):
        rows = np.flatnonzero(street == k)
        rows = rows[np.argsort(at[rows], kind="stable")]
        if not len(rows):
            met.append(np.zeros((0, 2)))
            continue
        group = np.cumsum(np.append(0, np.diff(at[rows]) > MERGED))
        middle = np.bincount(group, at[rows]) / np.bincount(group)
        points = shapely.get_coordinates(shapely.line_interpolate_point(line, middle))
        points = np.round(points, ROUND)
        places[rows] = points[group]
        met.append(points)
    return places, met


def _led_on(rest: Rest, ends: IntArray, places: FloatArray) -> Rest:
    """Extend the ends of stretches to places."""
    found = list(rest)
    for (k, last), place in zip(ends.tolist(), places, strict=True):
        row, points = found[k]
        found[k] = row, np.concatenate([points, place[None]] if last else [place[None], points])
    return found


def _pruned(rest: Rest, ends: IntArray, rails: Collection[int] = ()) -> Rest:
    """Take ends that lead nowhere back to the next junction; a stretch without one goes.

    Where a street crosses ``rails``, rows of the table of roads, nobody turns: it is no junction.
    """
    whole = [np.rint(points * 10**ROUND).astype(np.int64) for _, points in rest]
    streets = [np.unique(points, axis=0) for points, (row, _) in zip(whole, rest, strict=True)
               if row not in rails]  # fmt: skip
    every, count = np.unique(
        np.concatenate([np.zeros((0, 2), np.int64), *streets]), axis=0, return_counts=True
    )
    junctions = {tuple(place) for place in every[count > 1].tolist()}
    found = list(rest)
    for k, last in ends.tolist():
        row, points = found[k]
        if row in rails:
            continue
        met = np.array([tuple(place) in junctions for place in whole[k].tolist()])
        kept = np.flatnonzero(met)
        if not len(kept):
            points = points[:0]
        else:
            points = points[: kept[-1] + 1] if last else points[kept[0] :]
        whole[k] = np.rint(points * 10**ROUND).astype(np.int64)
        found[k] = row, points
    return [(row, points) for row, points in found if len(points) > 1]


def _shapes(rest: Rest, count: int) -> NDArray[Any]:
    """(count,) what is left of each road, empty where nothing is."""
    found: list[list[FloatArray]] = [[] for _ in range(count)]
    for row, points in rest:
        found[row].append(points)
    held = np.empty(count, object)
    held[:] = [shapely.MultiLineString(parts) for parts in found]
    return held


def refilled(city: City, before: Layout, gone: Any, ground: Any) -> City:
    """Build on the blocks of a procedural town that lost ground or streets, as they were built.

    Parameters
    ----------
    before
        The layout before it was cut.
    gone
        What was taken: ground, and streets given up.
    ground
        What stays free.
    """
    if not before.areas["source"].str.startswith(OWN).any():
        return city
    shapes = _open_blocks(city.layout, gone, ground)
    looks = [_built_as(before, shape) for shape in shapes.tolist()]
    rows = np.array([k for k, (zone, _) in enumerate(looks) if zone], np.int64)
    if not len(rows):
        return city
    shapes, looks = shapes[rows], [looks[row] for row in rows.tolist()]
    found = blocks_in(
        shapes, city.layout, [word for word, _ in looks], np.array([height for _, height in looks])
    )
    layout = cleared(city.layout, shapely.union_all(shapes))
    kinds = found.kind.tolist()
    for number, shape, word in zip(found.ids.tolist(), shapes.tolist(), kinds, strict=True):
        layout = with_area(layout, word, shape, Owner(("made", "block", number), {}))
    return replace(city, layout=houses_on(city, layout, found, shapes))


def blocks_in(
    shapes: NDArray[Any], layout: Layout, zones: Sequence[str], heights: FloatArray
) -> Blocks:
    """Return blocks of a site, each of a zone and, where it is not NaN, of offices so high."""
    ids = np.array([_block_id(shape) for shape in shapes.tolist()], np.uint64)
    zone = np.array(list(zones), object)
    kind = np.array([LAND[word] for word in zone], object)
    return Blocks(_beyond(shapes, layout), ids, zone, kind, np.full(len(ids), 0.5), heights)


def with_fronts(city: City, before: Layout) -> City:
    """Build anew the blocks of a procedural town whose parcels have lost their streets.

    Parameters
    ----------
    before
        The layout with these streets.
    """
    lost = off_streets(city.layout)
    if lost.any():
        known = before.buildings["id"][off_streets(before)]
        lost &= ~np.isin(city.layout.buildings["id"].to_numpy(), known)
    if not lost.any():
        return city
    gone = shapely.union_all(city.layout.buildings.geometry.to_numpy()[lost])
    city = refilled(city, before, gone, shapely.Polygon())
    return replace(
        city, layout=without_buildings(city.layout, np.flatnonzero(off_streets(city.layout)))
    )


def off_streets(layout: Layout) -> BoolArray:
    """(n,) whether buildings stand on a parcel along which no street or walk runs.

    Those at the border of the site may have theirs beyond it.
    """
    buildings, areas = layout.buildings, layout.areas
    own = buildings["source"].str.startswith(PARCEL).to_numpy(bool)
    roads = layout.roads
    if not own.any() or not len(roads):
        return np.asarray(own)
    names = np.concatenate([buildings["source"].to_numpy(str), areas["source"].to_numpy(str)])
    shapes = np.concatenate([buildings.geometry.to_numpy(), areas.geometry.to_numpy()])
    known, of = np.unique(names, return_inverse=True)
    order = np.argsort(of, kind="stable")
    whole = np.zeros(len(known), object)
    whole[:] = shapely.geometrycollections(shapes[order], indices=of[order])
    reach = _reach(roads) + FRONT
    served = ~np.isin(known, names[: len(buildings)][own])
    edge = float(reach.max())
    low, high = np.split(np.array(layout.extent), 2)
    box = shapely.bounds(whole)
    served |= ((box[:, :2] < low + edge) | (box[:, 2:] > high - edge)).any(axis=1)
    rows = np.flatnonzero(~served)
    lines = roads.geometry.to_numpy()
    parcel, street = shapely.STRtree(lines).query(whole[rows], predicate="dwithin", distance=edge)
    near = shapely.distance(whole[rows[parcel]], lines[street]) <= reach[street]
    served[rows[parcel[near]]] = True
    return np.asarray(own & ~served[of[: len(buildings)]])


def _open_blocks(layout: Layout, gone: Any, ground: Any) -> NDArray[Any]:
    """Return the blocks beside what was taken, less parks, squares and what else is no block."""
    built_on = layout.areas["kind"].isin(BUILT_ON) & ~is_square(layout.areas)
    kept = layout.areas[~built_on].geometry.to_numpy()
    made = is_made(layout.areas)
    shut = shapely.union_all([ground, *kept, *layout.areas.geometry.to_numpy()[made]])
    near = shapely.buffer(gone, NEXT)
    blocks = street_blocks(layout)
    blocks = blocks[shapely.intersects(blocks, near)]
    parts = block_parts(blocks, shut)
    return np.asarray(parts[shapely.intersects(parts, near)])


def block_parts(blocks: NDArray[Any], shut: Any) -> NDArray[Any]:
    """Return what of blocks is left beside what is shut, where it is wide enough to build on."""
    rest = shapely.difference(blocks, shut)
    rest = shapely.buffer(shapely.buffer(rest, -THIN), THIN, join_style="mitre")
    parts = shapely.get_parts(shapely.simplify(shapely.intersection(rest, blocks), 0.02))
    parts = parts[(shapely.get_type_id(parts) == 3) & (shapely.area(parts) >= LEAST)]
    return np.asarray(shapely.orient_polygons(parts))


def _block_id(shape: Any) -> int:
    """Return the id of a block by its place."""
    place = np.round(shapely.get_coordinates(shapely.point_on_surface(shape))[0], 2)
    return stable_id("block", *place.tolist())


def _built_as(layout: Layout, block: Any) -> tuple[str, float]:
    """Return the zone that a block looks built as, "" for none, and the height of its offices."""
    table = layout.buildings
    middles = shapely.point_on_surface(table.geometry.to_numpy())
    rows = np.flatnonzero(shapely.contains(block, middles))
    if not len(rows):
        return "", np.nan
    area = shapely.area(table.geometry.to_numpy()[rows])
    words, at = np.unique(table["use"].to_numpy()[rows].astype(str), return_inverse=True)
    most = words[int(np.argmax(np.bincount(at.ravel(), area)))]
    height = float(np.median(table["height"].to_numpy()[rows]))
    return ZONE_OF_USE.get(str(most), ""), height if most == "office" else np.nan


def _beyond(shapes: NDArray[Any], layout: Layout) -> NDArray[Any]:
    """Extend blocks that the border of the site cuts beyond it, where no house will stand."""
    site = shapely.box(*layout.extent)
    more = shapely.difference(shapely.buffer(shapes, BEYOND, join_style="mitre"), site)
    grown = shapely.union(shapes, more)
    whole = (shapely.get_type_id(grown) == 3) & ~shapely.is_empty(more)
    return np.where(whole, shapely.orient_polygons(grown), shapes)


def houses_on(city: City, layout: Layout, blocks: Blocks, own: NDArray[Any]) -> Layout:
    """Put buildings and grounds on blocks; one that gets none as it goes on, as it ends.

    Parameters
    ----------
    own
        (b,) the blocks as they end at the border of the site.
    """
    made = _made_on(city, layout.extent, blocks)
    points = shapely.point_on_surface(made.buildings.geometry.to_numpy())
    bare = np.ones(len(own), bool)
    bare[shapely.STRtree(points).query(own, predicate="intersects")[0]] = False
    both = [made]
    if bare.any():
        columns = {item.name: getattr(blocks, item.name)[bare] for item in fields(Blocks)}
        both.append(_made_on(city, layout.extent, Blocks(**{**columns, "shapes": own[bare]})))
    for found in both:
        pairs = {name: (getattr(layout, name), getattr(found, name)) for name in TABLES}
        tables = {name: joined_tables(*pair) for name, pair in pairs.items()}
        layout = replace(layout, **tables)
    return layout


def _made_on(city: City, extent: Box, blocks: Blocks) -> Layout:
    xmin, ymin, xmax, ymax = extent
    wide = (xmin - BEYOND, ymin - BEYOND, xmax + BEYOND, ymax + BEYOND)
    stand = joined(*buildings_on([(blocks, blocks.shapes)], wide, (0, 0), city.seed))
    return cut_to(resolve(gather(stand, wide, Report()), city.frame, seed=city.seed), extent)
