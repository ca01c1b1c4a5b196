"""Elements that are lines: city walls, power lines, tram lines and railways."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np
import shapely
import shapely.ops
from numpy.typing import NDArray

from cityx.checks.predicates.line_predicates import LINES
from cityx.checks.predicates.street_predicates import strokes
from cityx.city import City, Layout
from cityx.city.layout import joined_tables
from cityx.errors import ActionFailed
from cityx.geometry.arrays import BoolArray, FloatArray, IntArray
from cityx.geometry.chains import components
from cityx.road.network.network import DRIVABLE
from cityx.sources.features.resolve import Features, resolve
from cityx.sources.features.shells import Shells
from cityx.sources.features.tagged import Owner, Tags, nothing, tag
from cityx.town.cutting import given_up_in, street_rows, with_fronts, with_points
from cityx.town.elements import Element
from cityx.town.rebuilding import WET, cleared, is_made, with_area, without_buildings

Key = tuple[object, ...]
MAIN = ("primary", "secondary", "tertiary")
# Rings of city walls, the outermost first: shares of half the site, tried in turn.
RINGS = (0.86, 0.8, 0.64, 0.58, 0.44, 0.38, 0.28, 0.22)
APART_RINGS = 0.13  # of half the site, between two walls
OUTERMOST = 0.75  # a ring from which on there is open land beyond the wall
ROUNDED = 0.4  # of half a ring, the radius of its corners
BESIDE_WALL = 5.0  # metres kept free on both sides of a wall
GATES, CROSSINGS, STOPS = 4, 3, 3  # usual numbers
GATE_REACH = 14.0  # metres round a gate, or a level crossing, in which its street stays
TOWERS_APART = 45.0  # metres between the towers of a wall
TOWER_ASIDE = 3.2  # metres from the edge of a street's walk to the middle of a tower
SPAN = 58.0  # metres between pylons
PYLON_ROOM = 4.5  # metres from a pylon to buildings and the edges of streets
UNDER_WIRES = 7.0  # metres beside a power line without buildings
FROM_BORDER = 12.0  # metres from the border of the site to a line along it
STEP = 8.0  # metres between the courses that are tried
TRACK = 2.1  # metres from the middle of a railway to each of its tracks
BED, CORRIDOR = 5.5, 10.5  # metres from its middle to the edge of its bed, and of what it takes
PLATFORM = (3.9, 7.4)  # metres from its middle to the edges of a platform
PLATFORM_LENGTH = 80.0  # metres
TRAM_TRACK = 1.55  # metres from the middle of a street to each track
LEAST_TRAM = 6.4  # metres of carriageway that two tracks need
LEAST_LINE = 0.5  # of the site's shorter side that a tram line is long
ASKEW = 4.0  # half widths of a strip that a line over it is within it at most
HOUSE, ALONG = 12.0, 3.0  # metres from the side that a building weighs, and a metre along a street


def with_line(
    city: City, element: Element, key: Key, *, side: str, parts: int, height: float
) -> City:
    """Build one more wall or line.

    Parameters
    ----------
    key
        What names it and its things: first words of their provenance.
    side
        Of the site along which it runs, or "any".
    parts
        Gates of a wall, level crossings of a railway, stops of a tram line; -1 for a usual number.
    height
        Metres, 0 for a usual one.

    Raises
    ------
    ActionFailed
        If there is no room for it.
    """
    made = BUILDERS[element.builder](city, key, side, parts, height)
    return with_fronts(made, city.layout)


def without_line(city: City, element: Element, ids: NDArray[np.uint64]) -> City:
    """Take a wall or line away, by the ids of its rows, with the things that were made for it."""
    layout = city.layout
    name = "roads" if element.measure.startswith("railway") else "lines"
    table = getattr(layout, name)
    gone = table["id"].isin(ids).to_numpy()
    made = {
        "/".join(source.split("/")[:3]) + "/"
        for source in table["source"][gone]
        if source.startswith("made/")
    }

    def own(rows: Any) -> NDArray[np.bool_]:
        sources = rows["source"].to_numpy().astype(str)
        found = np.zeros(len(rows), bool)
        for first in sorted(made):
            found |= np.char.startswith(sources, first)
        return found

    layout = without_buildings(layout, np.flatnonzero(own(layout.buildings)))
    kept = {
        part: getattr(layout, part)[~own(getattr(layout, part))].reset_index(drop=True)
        for part in ("areas", "lines", "points", "roads")
    }
    rest = kept[name][~kept[name]["id"].isin(ids)].reset_index(drop=True)
    return replace(city, layout=replace(layout, **{**kept, name: rest}))


def _added(
    city: City, layout: Layout, lines: list[tuple[Any, Owner]], points: list[tuple[Any, Owner]]
) -> Layout:
    """Add lines that stand, and things, as those of any source are."""
    none = Shells(nothing(), nothing(), np.zeros(0, np.int64))
    rows = [tag([shape for shape, _ in items], [own for _, own in items])
            for items in (lines, points)]  # fmt: skip
    found = Features(layout.extent, none, lines=rows[0], points=rows[1])
    made = resolve(found, city.frame, seed=city.seed)
    return replace(
        layout,
        lines=joined_tables(layout.lines, made.lines),
        points=joined_tables(layout.points, made.points),
    )


# -- city walls ----------------------------------------------------------------------------------


def _wall(city: City, key: Key, side: str, parts: int, height: float) -> City:
    """Lay a wall round the town, its gates where streets pass, towers beside them and between."""
    del side
    layout = city.layout
    ring, share = _ring(layout)
    before = layout
    band = shapely.buffer(ring, BESIDE_WALL)
    gates = _gates(layout, ring, parts, GATES, BESIDE_WALL)
    inside = shapely.Polygon(ring)
    site = shapely.box(*layout.extent)
    beyond = shapely.difference(site, inside) if share >= OUTERMOST else shapely.Polygon()
    ways = _ways_through(layout, gates, inside)
    taken = shapely.difference(shapely.union(band, beyond), shapely.union_all(_rail_land(layout)))
    layout = given_up_in(layout, shapely.difference(taken, ways))
    layout = cleared(layout, taken)
    for k, part in enumerate(shapely.get_parts(taken)):
        kind = "meadow" if share >= OUTERMOST else "grass"
        layout = with_area(
            layout, kind, shapely.orient_polygons(part), Owner((*key, "land", k), {})
        )
    tags = {"barrier": "city_wall", **({"height": f"{height:g}"} if height else {})}
    tops = {"tower:type": "defensive", **({"height": f"{height + 2:g}"} if height else {})}
    points = [
        (shapely.Point(at), Owner((*key, "tower", k), {**tops, "direction": f"{bearing:g}"}))
        for k, (at, bearing) in enumerate(_towers(before, ring, gates))
    ]
    wall = (shapely.LineString(_from_quiet(ring, gates)), Owner((*key, "wall"), tags))
    return replace(city, layout=_added(city, layout, [wall], points))


def _ring(layout: Layout) -> tuple[Any, float]:
    """Return the course of a new wall, and its share of the site."""
    xmin, ymin, xmax, ymax = layout.extent
    middle = np.array([(xmin + xmax) / 2, (ymin + ymax) / 2])
    half = np.array([xmax - xmin, ymax - ymin]) / 2
    standing = layout.lines.geometry.to_numpy()[(layout.lines["kind"] == "city_wall").to_numpy()]
    areas, buildings = layout.areas, layout.buildings
    rails = _rail_land(layout)
    shut = (areas["kind"].isin(WET).to_numpy() | is_made(areas)) & ~_of_railways(areas)
    kept = np.concatenate([
        areas.geometry.to_numpy()[shut],
        buildings.geometry.to_numpy()[is_made(buildings)],
    ])  # fmt: skip
    for share in RINGS:
        corner = share * half
        radius = float(ROUNDED * corner.min())
        box = shapely.box(*(middle - corner + radius), *(middle + corner - radius))
        ring = shapely.buffer(box, radius, quad_segs=6).exterior
        ring = shapely.LinearRing(np.round(shapely.get_coordinates(ring), 2))
        away = float(APART_RINGS * half.min())
        free = not shapely.intersects(kept, shapely.buffer(ring, BESIDE_WALL)).any()
        free &= not shapely.dwithin(standing, ring, away).any()
        if free and _across([ring], shapely.union_all(rails), CORRIDOR):
            return ring, share
    raise ActionFailed("There is no room for one more city wall round the town.")


def _of_railways(table: Any) -> BoolArray:
    """(n,) whether land was made for a railway."""
    return np.asarray(table["source"].str.startswith("made/railway/").to_numpy(bool))


def _rail_land(layout: Layout) -> NDArray[Any]:
    """Return the beds, verges and platforms of railways."""
    return np.asarray(layout.areas.geometry.to_numpy()[_of_railways(layout.areas)])


def _across(lines: Iterable[Any], ground: Any, half: float) -> bool:
    """Return whether lines lead over a strip, or meet it nowhere, rather than along it."""
    parts = shapely.get_parts(shapely.intersection(np.asarray(lines, object), ground))
    return bool((shapely.length(shapely.line_merge(parts)) <= ASKEW * half).all())


def _crossings(layout: Layout, line: Any) -> tuple[FloatArray, IntArray]:
    """Return where streets cross a line, (n, 2), the main streets first, and their rows."""
    roads = layout.roads
    rows = np.flatnonzero(roads["kind"].isin(DRIVABLE).to_numpy() & ~roads["tunnel"].to_numpy(bool))
    shapes = roads.geometry.to_numpy()[rows]
    hit = np.flatnonzero(shapely.intersects(shapes, line))
    spots, of = shapely.get_parts(shapely.intersection(shapes[hit], line), return_index=True)
    rows = rows[hit[of]]
    xy = shapely.get_coordinates(shapely.centroid(spots))
    kinds = roads["kind"].to_numpy()[rows].astype(str).tolist()
    rank = np.array([MAIN.index(word) if word in MAIN else len(MAIN) for word in kinds], int)
    order = np.lexsort((np.round(xy[:, 1], 2), np.round(xy[:, 0], 2), rank))
    return xy[order], rows[order]


def _gates(
    layout: Layout, line: Any, wanted: int, usual: int, half: float
) -> list[tuple[int, FloatArray]]:
    """Return rows of streets and the places at which they pass a line, spread along it.

    A street that does not leave the ground that a line takes, ``half`` metres to both sides, near
    where it passes has no gate: it ends there.

    Raises
    ------
    ActionFailed
        If fewer streets cross it than are wanted.
    """
    xy, rows = _passable(layout, line, half)
    at = shapely.line_locate_point(line, shapely.points(xy))
    count = min(usual, len(xy)) if wanted < 0 else wanted
    if count > len(xy):
        raise ActionFailed(f"{len(xy)} streets could pass there, and {count} are to.")
    chosen: list[int] = []
    for _ in range(count):  # the next is as far from the others as can be, on a main street first
        free = [k for k in range(len(xy)) if k not in chosen]
        gap = [min([abs(at[k] - at[c]) % line.length for c in chosen]
                   + [line.length - abs(at[k] - at[c]) for c in chosen] + [line.length])
               for k in free]  # fmt: skip
        chosen.append(free[int(np.argmax(np.round(gap, 1)))])
    return [(int(rows[k]), xy[k]) for k in chosen]


def _passable(layout: Layout, line: Any, half: float) -> tuple[FloatArray, IntArray]:
    """Return where streets can pass a line alone, (n, 2), and their rows."""
    xy, rows = _crossings(layout, line)
    if not len(xy):
        return xy, rows
    pairs = np.column_stack(shapely.STRtree(shapely.points(xy)).query(
        shapely.points(xy), predicate="dwithin", distance=2 * GATE_REACH))  # fmt: skip
    label = np.asarray(components(pairs, len(xy)), np.int64)
    alone = np.bincount(label, minlength=len(xy))[label] == 1
    alone &= _steep(layout, line, xy, rows, half)
    return xy[alone], rows[alone]


def _steep(layout: Layout, line: Any, xy: FloatArray, rows: IntArray, half: float) -> BoolArray:
    """(n,) whether streets leave the ground of a line within what stays open round a gate."""
    ground = shapely.buffer(line, half, cap_style="flat")
    within, of = shapely.get_parts(
        shapely.intersection(layout.roads.geometry.to_numpy()[rows], ground), return_index=True
    )
    spots = shapely.points(xy)
    far = shapely.hausdorff_distance(within, spots[of]) > half + GATE_REACH - BESIDE_WALL
    steep = np.ones(len(xy), bool)
    steep[of[far & (shapely.distance(within, spots[of]) < 1.0)]] = False
    return steep


def _ways_through(layout: Layout, gates: list[tuple[int, FloatArray]], inside: Any) -> Any:
    """Return the ground of streets at their gates, and from there to the border."""
    found = [shapely.buffer(shapely.Point(xy), GATE_REACH) for _, xy in gates]
    for row, xy in gates:
        outer = shapely.get_parts(shapely.difference(layout.roads.geometry.to_numpy()[row], inside))
        near = outer[shapely.distance(outer, shapely.Point(xy)) < 1.0]
        found += shapely.buffer(near, 1.0).tolist()
    return shapely.union_all(found)


def _towers(
    layout: Layout, ring: Any, gates: list[tuple[int, FloatArray]]
) -> list[tuple[FloatArray, float]]:
    """Return places of towers, and compass degrees of the way out: beside gates and between."""
    middle = shapely.get_coordinates(shapely.centroid(shapely.Polygon(ring)))[0]
    length = ring.length
    roads = layout.roads
    aside = []
    for row, xy in gates:
        at = float(ring.project(shapely.Point(xy)))
        walks = float(roads[["sidewalk_left", "sidewalk_right"]].to_numpy()[row].max())
        half = float(roads["width"].to_numpy()[row]) / 2 + walks + TOWER_ASIDE
        aside += [at - half, at + half]
    spots = [value % length for value in aside]
    for at in np.arange(0.0, length, TOWERS_APART).tolist():
        gap = [min(abs(at - s), length - abs(at - s)) for s in spots]
        if min(gap, default=length) > 0.6 * TOWERS_APART:
            spots.append(at)
    found = []
    for at in sorted(spots):
        xy = shapely.get_coordinates(ring.interpolate(at))[0]
        out = xy - middle
        found.append((np.round(xy, 2), round(float(np.degrees(np.arctan2(*out))) % 360, 1)))
    return found


def _from_quiet(ring: Any, gates: list[tuple[int, FloatArray]]) -> FloatArray:
    """Return the points of a ring from where it is farthest from any gate, round to there."""
    points = shapely.get_coordinates(ring)[:-1]
    spots = [shapely.Point(xy) for _, xy in gates]
    away = [min((shapely.Point(p).distance(s) for s in spots), default=0.0) for p in points]
    first = int(np.argmax(np.round(away, 2)))
    turned = np.roll(points, -first, axis=0)
    return np.concatenate([turned, turned[:1]])


# -- power lines ---------------------------------------------------------------------------------


def _power_line(city: City, key: Key, side: str, parts: int, height: float) -> City:
    """Carry a power line across the site, along one of its sides."""
    del parts
    layout = city.layout
    line = _course(layout, side, UNDER_WIRES, kind="power_line")
    layout = _without_houses(layout, shapely.buffer(line, UNDER_WIRES, cap_style="flat"))
    spots = _pylons(layout, line)
    ends = shapely.get_coordinates(line)
    points = np.round(np.concatenate([ends[:1], spots, ends[1:]]), 2)
    tags = {"power": "line", **({"height": f"{height:g}"} if height else {})}
    way = ends[1] - ends[0]
    bearing = float(np.degrees(np.arctan2(way[0], way[1]))) % 360
    tops: Tags = {**tags, "power": "tower", "direction": f"{bearing:g}"}
    things = [(shapely.Point(xy), Owner((*key, "pylon", k), tops))
              for k, xy in enumerate(np.round(spots, 2))]  # fmt: skip
    return replace(city, layout=_added(
        city, layout, [(shapely.LineString(points), Owner((*key, "line"), tags))], things
    ))  # fmt: skip


def _without_houses(layout: Layout, ground: Any) -> Layout:
    hit = shapely.intersects(layout.buildings.geometry.to_numpy(), ground)
    return without_buildings(layout, np.flatnonzero(hit))


def _pylons(layout: Layout, line: Any) -> FloatArray:
    """Return the places of pylons on a line: a span apart, off streets, water and houses."""
    roads = layout.roads
    half = np.nan_to_num(roads["width"].to_numpy()) / 2 + roads[
        ["sidewalk_left", "sidewalk_right"]].max(axis=1).to_numpy()  # fmt: skip
    areas = layout.areas
    shut = np.concatenate([
        shapely.buffer(roads.geometry.to_numpy(), half + PYLON_ROOM),
        shapely.buffer(layout.buildings.geometry.to_numpy(), PYLON_ROOM),
        areas.geometry.to_numpy()[areas["kind"].isin(WET).to_numpy()],
    ])  # fmt: skip
    free = shapely.difference(line, shapely.union_all(shut))
    count = max(int(np.ceil(line.length / SPAN)), 1)
    found: list[float] = []
    for k in range(count):
        wish = line.interpolate((k + 0.5) / count, normalized=True)
        if free.is_empty:
            break
        at = float(line.project(shapely.ops.nearest_points(free, wish)[0]))
        if not found or at - found[-1] > 0.3 * SPAN:
            found.append(at)
    if not found:
        raise ActionFailed("There is no room for the pylons of a power line.")
    return np.array([shapely.get_coordinates(line.interpolate(at))[0] for at in found])


def _course(
    layout: Layout, side: str, half: float, *, kind: str, dry: bool = False, streets: int = 0
) -> Any:
    """Return a straight line across the site where it takes least.

    Parameters
    ----------
    side
        Along which it runs; "any" for the best, "middle" for one through the middle.
    half
        Metres beside it that it takes.
    kind
        Of lines or roads to which it keeps a distance.
    dry
        Whether it must not cross water.
    streets
        How many can pass it on the level, where any course has as many.
    """
    xmin, ymin, xmax, ymax = layout.extent
    low, high = np.array([xmin, ymin]), np.array([xmax, ymax])
    found: list[tuple[float, int, Any]] = []
    sides = (side,) if side in ("north", "east", "south", "west") else (
        "north", "east", "south", "west")  # fmt: skip
    for one in sides:
        across = int(one in ("north", "south"))  # the axis that it lies at a place of
        size = float(high[across] - low[across])
        inner = size / 2 if side != "middle" else 0.75 * size
        begin = 0.3 * size if side == "middle" else FROM_BORDER + half
        for off in np.arange(begin, max(inner, begin + 1.0), STEP).tolist():
            at = high[across] - off if one in ("north", "east") else low[across] + off
            ends = np.array([low, high], float)
            ends[:, across] = round(float(at), 2)
            line = shapely.LineString(ends)
            cost = _cost(layout, line, half, kind, dry)
            if np.isfinite(cost):
                found.append((round(cost + off, 1), len(found), line))
    if not found:
        raise ActionFailed(f"There is no room for a {kind.replace('_', ' ')} across the site.")
    for _, _, line in sorted(found) if streets > 0 else ():
        if len(_passable(layout, line, half)[0]) >= streets:
            return line
    return min(found)[2]


def _stands(table: Any) -> BoolArray:
    """(n,) whether lines are city walls or power lines, which pass over railways and beside."""
    return np.asarray(table["kind"].isin(LINES).to_numpy(bool))


def _cost(layout: Layout, line: Any, half: float, kind: str, dry: bool) -> float:
    """Return what a course takes: houses, streets along it; infinite where it may not run."""
    ground = shapely.buffer(line, half, cap_style="flat")
    areas, buildings, roads = layout.areas, layout.buildings, layout.roads
    made = is_made(areas) & ~areas["kind"].isin(("grass", "meadow", "residential")).to_numpy()
    kept = [areas.geometry.to_numpy()[made], buildings.geometry.to_numpy()[is_made(buildings)]]
    if dry:
        kept.append(areas.geometry.to_numpy()[areas["kind"].isin(WET).to_numpy()])
    lines, ways = layout.lines, roads.geometry.to_numpy()
    near = [lines.geometry.to_numpy()[(lines["kind"] == kind).to_numpy()],
            ways[(roads["kind"] == kind).to_numpy()]]  # fmt: skip
    if any(shapely.intersects(each, ground).any() for each in kept):
        return np.inf
    if any(shapely.dwithin(each, line, 4 * half).any() for each in near):
        return np.inf
    if not _across(lines.geometry.to_numpy()[_stands(lines)], ground, half):
        return np.inf
    houses = int(shapely.intersects(buildings.geometry.to_numpy(), ground).sum())
    along = float(shapely.length(shapely.intersection(ways, ground)).sum())
    crossed = int(shapely.intersects(ways, line).sum())
    return HOUSE * houses + ALONG * max(along - 3 * half * crossed, 0.0)


# -- tram lines ----------------------------------------------------------------------------------


def _tram(city: City, key: Key, side: str, parts: int, height: float) -> City:
    """Lay two tracks along the longest wide street without any, with stops beside it."""
    del side, height
    layout = city.layout
    row, line = _street_for_tram(layout)
    name = f"Line {key[-1]}" if key else ""
    lines, owners = [], []
    for k, aside in enumerate((TRAM_TRACK, -TRAM_TRACK)):
        track = shapely.offset_curve(line, -aside)
        points = np.round(shapely.get_coordinates(track), 3)
        lines.append(shapely.LineString(points[::-1] if k else points))
        tags = {"railway": "tram", "oneway": "yes", "name": name}
        owners.append(Owner((*key, "track", k), tags))
    layout = _with_rails(city, layout, lines, owners)
    count = STOPS if parts < 0 else parts
    half = float(np.nan_to_num(city.layout.roads["width"].to_numpy()[row])) / 2 + 1.2
    stops = []
    for k in range(count):  # on both sides in turn
        beside = shapely.offset_curve(line, half if k % 2 else -half)
        share = _off_junctions(city.layout, line, (k + 0.5) / count)
        at = np.round(shapely.get_coordinates(beside.interpolate(share, normalized=True))[0], 2)
        stops.append((shapely.Point(at), Owner((*key, "stop", k), {"railway": "tram_stop"})))
    return replace(city, layout=_added(city, layout, [], stops))


def _street_for_tram(layout: Layout) -> tuple[int, Any]:
    """Return the row and the whole line of the longest street that is wide enough."""
    roads = layout.roads
    shapes = roads.geometry.to_numpy()
    fits = roads["kind"].isin(DRIVABLE) & (roads["width"] >= LEAST_TRAM)
    fits &= (roads["layer"] == 0) & ~roads["tunnel"] & ~roads["bridge"] & ~roads["roundabout"]
    rows = np.flatnonzero(fits.to_numpy())
    tracks = shapes[(roads["kind"] == "tram").to_numpy()]
    xmin, ymin, xmax, ymax = layout.extent
    least = LEAST_LINE * min(xmax - xmin, ymax - ymin)
    street = strokes(shapes[rows], roads["kind"].to_numpy().astype(str)[rows])
    found = []
    for number in np.unique(street).tolist():
        own = rows[street == number]
        line = shapely.line_merge(shapely.union_all(shapes[own]))
        if line.geom_type != "LineString" or line.length < least or line.is_ring:
            continue
        along = shapely.intersection(tracks, shapely.buffer(line, 3.0))
        if float(shapely.length(along).sum()) < 30.0:
            found.append((-round(line.length, 1), int(own[0]), line))
    if not found:
        raise ActionFailed(
            f"No street of {least:.0f} m that is {LEAST_TRAM:g} m wide is free for a tram line."
        )
    _, row, line = min(found, key=lambda item: item[:2])
    return row, line


def _off_junctions(layout: Layout, line: Any, share: float) -> float:
    """Return the share of a line near a wished one that is farthest from any street across."""
    roads = layout.roads[layout.roads["kind"].isin(DRIVABLE)].geometry.to_numpy()
    across = roads[shapely.intersects(roads, line) & ~shapely.within(
        roads, shapely.buffer(line, 1.0))]  # fmt: skip
    tried = [min(max(share + step / line.length, 0.02), 0.98) for step in range(-35, 36, 5)]
    spots = [line.interpolate(one, normalized=True) for one in tried]
    if not len(across):
        return share
    gap = [round(min(float(shapely.distance(across, spot).min()), 25.0), 1) for spot in spots]
    return float(tried[int(np.argmax(gap))])


# -- railways ------------------------------------------------------------------------------------


def _railway(city: City, key: Key, side: str, parts: int, height: float) -> City:
    """Lay a railway of two tracks across the site, with a platform on either side.

    Streets that do not cross it on the level end before it.
    """
    del height
    layout = city.layout
    line = _course(layout, side, CORRIDOR, kind="rail", dry=True, streets=parts)
    crossings = _gates(layout, line, parts, CROSSINGS, CORRIDOR)
    ground = shapely.buffer(line, CORRIDOR, cap_style="flat")
    ways = shapely.union_all([shapely.buffer(shapely.Point(xy), 2 * GATE_REACH, cap_style="square")
                              for _, xy in crossings])  # fmt: skip
    layout = given_up_in(layout, shapely.difference(ground, ways))
    standing = layout.lines[_stands(layout.lines)]
    layout = cleared(layout, ground)
    rest = layout.lines[~_stands(layout.lines)]
    layout = replace(layout, lines=joined_tables(rest, standing))  # walls have a gap for rails
    bed = shapely.buffer(line, BED, cap_style="flat")
    layout = with_area(layout, "railway", bed, Owner((*key, "bed"), {"landuse": "railway"}))
    for k, part in enumerate(shapely.get_parts(shapely.difference(ground, bed))):
        owner = Owner((*key, "verge", k), {})
        layout = with_area(layout, "grass", shapely.orient_polygons(part), owner)
    for k, platform in enumerate(_platforms(line, [xy for _, xy in crossings])):
        tags = {"public_transport": "platform", "shelter_type": "public_transport"}
        row = Features(
            layout.extent, Shells(nothing(), nothing(), np.zeros(0, np.int64)),
            areas=tag([platform], [Owner((*key, "platform", k), tags)]),
            area_kinds=np.array(["pedestrian"], object),
        )  # fmt: skip
        made = resolve(row, city.frame, seed=city.seed)
        layout = cleared(layout, platform)
        layout = replace(layout, areas=joined_tables(layout.areas, made.areas))
    lines, owners = [], []
    for k, aside in enumerate((TRACK, -TRACK)):
        points = np.round(shapely.get_coordinates(shapely.offset_curve(line, -aside)), 3)
        lines.append(shapely.LineString(points[::-1] if k else points))
        tags = {"railway": "rail", "oneway": "yes", "name": f"Railway {key[-1]}"}
        owners.append(Owner((*key, "track", k), tags))
    return replace(city, layout=_with_rails(city, layout, lines, owners))


def _with_rails(city: City, layout: Layout, lines: list[Any], owners: list[Owner]) -> Layout:
    """Add tracks that have a point in common with each street they cross, as those of maps do."""
    roads = layout.roads
    shapes = roads.geometry.to_numpy().copy()
    level = ~(roads["bridge"] | roads["tunnel"]).to_numpy(bool) & (roads["layer"] == 0).to_numpy()
    noded = []
    for line in lines:
        rows = np.flatnonzero(level & shapely.crosses(shapes, line))
        met = []
        for row in rows.tolist():
            spots = shapely.get_parts(shapely.intersection(shapes[row], line))
            xy = np.round(shapely.get_coordinates(shapely.centroid(spots)), 3)
            shapes[row] = with_points(shapes[row], xy)
            met.append(xy)
        noded.append(with_points(line, np.concatenate(met)) if met else line)
    table = joined_tables(roads.set_geometry(shapes), street_rows(city, noded, owners))
    return replace(layout, roads=table)


def _platforms(line: Any, crossings: list[FloatArray]) -> list[Any]:
    """Return the two platforms of a halt, as far from level crossings as can be."""
    at = sorted([0.0, line.length, *(float(line.project(shapely.Point(xy))) for xy in crossings)])
    gaps = [(high - low, -low) for low, high in pairwise(at)]
    size, low = max(gaps)
    length = min(PLATFORM_LENGTH, size - 2 * GATE_REACH)
    if length < PLATFORM_LENGTH / 4:
        return []
    middle = -low + size / 2
    stretch = shapely.ops.substring(line, middle - length / 2, middle + length / 2)
    near, far = PLATFORM
    rings = [shapely.buffer(shapely.offset_curve(stretch, side * (near + far) / 2),
                            (far - near) / 2, cap_style="flat") for side in (1, -1)]  # fmt: skip
    return [shapely.orient_polygons(shapely.Polygon(np.round(shapely.get_coordinates(ring), 2)))
            for ring in rings]  # fmt: skip


BUILDERS: Mapping[str, Callable[[City, Key, str, int, float], City]] = {
    "wall": _wall, "power_line": _power_line, "tram": _tram, "railway": _railway,
}  # fmt: skip
