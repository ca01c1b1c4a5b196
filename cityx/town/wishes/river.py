"""Rivers and canals through a city: how many, where, how wide, between quays, under bridges."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Annotated, Any

import numpy as np
import shapely

from cityx.checks.predicates.words import LANDS
from cityx.city import City, Layout
from cityx.city.asked_goals import asked, with_goal
from cityx.city.layout import joined_tables
from cityx.errors import ActionFailed
from cityx.geometry.arrays import FloatArray
from cityx.ids import draw
from cityx.protocol import Choice, Port, Range, action
from cityx.sources.features.tagged import Owner
from cityx.town.cutting import ON, street_rows, strip_of, with_points, with_streets
from cityx.town.procedural_streets import BRIDGE, bridge_tags, shore_tags
from cityx.town.rebuilding import is_made, with_area
from cityx.town.rivers import ABUTMENT, GREEN, QUAY

AXES = ("west_east", "north_south")
COURSES = (0.0, 0.12, -0.12, 0.24, -0.24)  # of the site's size from its middle, tried in turn
ASIDE = (0.33, 0.28, 0.38, 0.23)  # the same of what flows along one side of the site
MIDDLE = (0.0, 0.06, -0.06)  # the same of what flows through its middle
# Side of the site -> the axis of what flows along it, and the sign of its place across.
ALONG: Mapping[str, tuple[str, float]] = {
    "north": ("west_east", 1.0), "south": ("west_east", -1.0),
    "east": ("north_south", 1.0), "west": ("north_south", -1.0),
}  # fmt: skip
SWING, WAVES = 0.06, 1.1  # of the site's size a course swings by; its waves across the site
POINTS = 40  # of a course
BEYOND = 60.0  # metres that a course runs beyond the site
APART = 45.0  # metres between two bridges, or from one to the border
SNAP = 30.0  # metres along a quay within which a bridge takes a street that is there
BETWEEN = 60.0  # metres of land between two rivers
CORNER, BEND = 24.0, 14.0  # metres of the radius of a bank, and of water, where rivers meet
CLEAR = 25.0  # metres from where rivers meet to a bridge
CANAL_QUAY = 11.0  # metres from the water of a canal to the middle of the street beside it
CANAL_SWING = 0.0  # a canal is straight
KEPT = ("pedestrian", "park")  # land that a course avoids
# Of the width of a river, by which either bank recedes round an island, metres at most; of the
# width there and of an island's width, how wide and how long it is.
RECEDES, MOST_RECEDED, ISLAND, LONG = 0.35, 13.0, 0.45, 2.4
LEAST_RIVER = 14.0  # metres of one that holds an island
OFF_ISLAND = 12.0  # metres from an island to a bridge, another one or the border


@dataclass(frozen=True)
class _Kind:
    """How a river or a canal is built.

    Attributes
    ----------
    name
        "river" or "canal".
    quay
        Metres from the water to the middle of the street along it.
    land
        What lies between them.
    swing
        Of the site's size, by which a course swings.
    tags
        Of the water.
    """

    name: str
    quay: float
    land: str
    swing: float
    tags: str


KINDS: Mapping[str, _Kind] = {
    "river": _Kind("river", QUAY, "grass", SWING, "{}"),
    "canal": _Kind("canal", CANAL_QUAY, "pedestrian", CANAL_SWING, '{"water": "canal"}'),
}


@action(
    "layout/river-v1",
    limits=["What lies in the way of a river is taken down; no river crosses water that is there."],
    requires=("layout",),
    after=("layout/boulevard-v1",),
    takes=(Port("layout", "scene_layout"),),
    gives=(Port("layout", "scene_layout"),),
    labels=("river", "bridge", "stream", "canal", "water", "confluence", "island"),
)
def river(
    city: City,
    *,
    width: Annotated[float, Range(6.0, 200.0)] = 30.0,
    bridges: Annotated[int, Range(0, 40)] = 2,
    axis: Annotated[str, Choice(*AXES)] = "west_east",
    kind: Annotated[str, Choice(*KINDS)] = "river",
    count: Annotated[int, Range(0, 3)] = 1,
    meet: bool = False,
    side: Annotated[str, Choice("any", "middle", *ALONG)] = "any",
    islands: Annotated[int, Range(0, 8)] = 0,
) -> City:
    """Cut rivers through a city, from border to border, under exactly so many bridges.

    Parameters
    ----------
    city
        City with streets.
    width
        Metres of water.
    bridges
        Number of them, spread along the rivers, on streets where there are some; all other streets
        end on the quays.
    axis
        Where they flow; a river swings a little, a canal is straight.
    kind
        A canal has walls, and paving beside the water.
    count
        Number of rivers.
    meet
        Whether the others flow into the first one.
    side
        Of the site, along which they flow; it goes before the axis.
    islands
        Of all rivers together, round which they part; their banks recede there.
    """
    own = KINDS[kind]
    axis = ALONG[side][0] if side in ALONG else axis
    before = _bridge_count(city)
    if islands and (own.name != "river" or width < LEAST_RIVER or not count or meet):
        raise ActionFailed(
            f"Islands lie in rivers of {LEAST_RIVER:g} m and more that flow apart from each other."
        )
    if meet and count > 1:
        city = _meeting(city, own, axis, side, width, count, bridges)
    else:
        most = -(-bridges // max(count, 1))  # of each, the first ones more
        for number in range(count):
            given = min(most, bridges - number * most)
            course = _course(city, own, axis, side, width, number, count)
            here = islands // count + (number < islands % count)
            city = _single(city, own, course, width, max(given, 0), number, here)
    city = asked(city, f"{islands} islands", "n(island)", least=islands) if islands else city
    return _with_goals(city, own, width, count, meet and count > 1, bridges + before, side)


def _with_goals(
    city: City, kind: _Kind, width: float, count: int, meet: bool, bridges: int, side: str
) -> City:
    if not count:
        return with_goal(city, f"no {kind.name}", f"n({kind.name}) == 0")
    kept = tuple(goal for goal in city.goals if not goal.predicate.startswith("n(bridge) "))
    city = asked(
        replace(city, goals=kept), f"a {kind.name} {width:g} m wide",
        f"stat({kind.name}, width, mean)", least=0.9 * width, most=1.1 * width,
    )  # fmt: skip
    if meet:
        city = asked(city, f"{count} rivers that meet", "river.meeting", least=count, most=count)
    elif count > 1:
        city = asked(city, f"{count} {kind.name}s", f"n({kind.name})", least=count, most=count)
    if side in ALONG:
        city = with_goal(city, f"the {kind.name} in the {side}", f"side({kind.name}) == {side}")
    return asked(city, f"{bridges} bridges", "n(bridge)", least=bridges, most=bridges)


def _bridge_count(city: City) -> int:
    """Return how many bridges such actions have built."""
    sources = city.layout.roads["source"].to_numpy().astype(str)
    return len({text.split("/")[2] for text in sources if text.startswith("made/bridge/")})


def _single(
    city: City, kind: _Kind, course: Any, width: float, bridges: int, number: int, islands: int
) -> City:
    """Build one river along its course."""
    half = width / 2 + kind.quay
    quays = [shapely.offset_curve(course, side * half) for side in (1.0, -1.0)]
    site = shapely.box(*city.layout.extent)
    room = course.intersection(site).length
    if room < APART * (bridges + 1):
        raise ActionFailed(
            f"{bridges} bridges do not fit on {room:.0f} m of {kind.name}: there is room for "
            f"{int(room // APART) - 1}."
        )
    lines = [_in_site(quay, site) for quay in quays]
    ground = shapely.buffer(course, half, cap_style="flat")
    city, owners = _with_quays(city, lines, quays, ground)
    inner = course.intersection(site)
    water = shapely.buffer(course, width / 2, cap_style="flat").intersection(site)
    if islands:
        water = _round_islands(water, inner, width, bridges, islands)
    layout = _with_water(
        city.layout, kind, number, water,
        shapely.buffer(course, half - _strip(kind), cap_style="flat").intersection(site),
    )  # fmt: skip
    middles = [
        shapely.get_coordinates(inner.interpolate((k + 0.5) / bridges, normalized=True))[0]
        for k in range(bridges)
    ]
    spots = [(middle, (0, 1)) for middle in middles]
    return _with_bridges(replace(city, layout=layout), owners, spots, kind)


def _round_islands(water: Any, course: Any, width: float, bridges: int, count: int) -> Any:
    """Return water whose banks recede round islands, clear of bridges.

    Raises
    ------
    ActionFailed
        If there is no room for them.
    """
    recedes = min(RECEDES * width, MOST_RECEDED)
    broad = ISLAND * (width / 2 + recedes)  # half the width of an island
    reach = LONG * broad + OFF_ISLAND
    taken = [(k + 0.5) / bridges * course.length for k in range(bridges)]
    spots = np.arange(reach, course.length - reach, 2.0)
    found: list[float] = []
    while len(found) < count:
        away = np.min([np.abs(spots - at) - reach * (at in found) for at in (*taken, *found)]
                      or [-np.abs(spots - course.length / 2) + course.length], axis=0)  # fmt: skip
        if not len(spots) or away.max() < reach:
            raise ActionFailed(
                f"{count} islands do not fit between the bridges of {course.length:.0f} m of "
                f"river: there is room for {len(found)}."
            )
        found.append(float(spots[int(np.argmax(np.round(away, 3)))]))
    for at in found:
        t = np.linspace(-1.0, 1.0, 2 * POINTS + 1)
        bank = width / 2 + recedes * np.cos(np.pi / 2 * t) ** 2
        water = shapely.union(water, _lens(course, at + 1.6 * LONG * broad * t, bank))
        isle = broad * np.sqrt(np.maximum(1 - t**2, 0.0))
        water = shapely.difference(water, _lens(course, at + LONG * broad * t, isle))
    return water


def _lens(course: Any, at: FloatArray, half: FloatArray) -> Any:
    """Return the ground beside a course, so many metres on either side of places along it."""
    at = np.clip(at, 0.0, course.length)
    here, ahead, back = (
        shapely.get_coordinates(shapely.line_interpolate_point(course, at + step))
        for step in (0.0, 1.0, -1.0)
    )
    way = (ahead - back) / np.hypot(*(ahead - back).T)[:, None]
    out = half[:, None] * np.column_stack([-way[:, 1], way[:, 0]])
    return shapely.make_valid(shapely.Polygon(np.concatenate([here + out, (here - out)[::-1]])))


def _strip(kind: _Kind) -> float:
    """Return the metres from the middle of the street along water to the land before the water."""
    return GREEN if kind.name == "river" else min(GREEN, kind.quay - 1.0)


def _with_quays(
    city: City, lines: list[Any], strips: Sequence[Any], ground: Any
) -> tuple[City, list[Owner]]:
    """Lay streets along water and clear the ground between them."""
    site = shapely.box(*city.layout.extent)
    first = _number_of_quays(city)
    owners = [
        Owner(("made", "quay", first + k), shore_tags(city.seed, "quay", first + k))
        for k in range(len(lines))
    ]
    taken = shapely.union_all([
        ground,
        *(strip_of(line, own.tags, city) for line, own in zip(strips, owners, strict=True)),
    ]).intersection(site)  # fmt: skip
    return with_streets(city, list(zip(lines, owners, strict=True)), taken), owners


def _number_of_quays(city: City) -> int:
    sources = city.layout.roads["source"].to_numpy().astype(str)
    return len({text for text in sources if text.startswith("made/quay/")})


def _in_site(line: Any, site: Any) -> Any:
    """Return the longest part of a line in the site, to the millimetre."""
    parts = shapely.get_parts(shapely.intersection(line, site))
    longest = parts[int(np.argmax(shapely.length(parts)))]
    return shapely.LineString(np.round(shapely.get_coordinates(longest), 3))


def _shares(side: str, number: int, count: int) -> tuple[float, ...]:
    """Return where across the site a river may flow, of its size from the middle, best first."""
    if side in ALONG:
        return tuple(ALONG[side][1] * share for share in ASIDE)
    if count > 1:
        place = (number + 0.5) / count - 0.5
        return (place, place + 0.03, place - 0.03)
    return MIDDLE if side == "middle" else COURSES


def _course(
    city: City, kind: _Kind, axis: str, side: str, width: float, number: int = 0, count: int = 1
) -> Any:
    """Return the middle of the water: through the site where it takes least that is dear."""
    layout = city.layout
    xmin, ymin, xmax, ymax = layout.extent
    size = np.array([xmax - xmin, ymax - ymin])
    along, across = (size if axis == "west_east" else size[::-1]).tolist()
    half = width / 2 + kind.quay
    needed = 2 * half * count + BETWEEN * (count - 1)
    many = f"A {kind.name}" if count == 1 else f"{count} {kind.name}s"
    narrow = ActionFailed(
        f"{many} {width:g} m wide with {'its' if count == 1 else 'their'} quays "
        f"need{'s' if count == 1 else ''} {needed:.0f} m; the site has {across:.0f} m across."
    )
    if min(along, across) <= needed:
        raise narrow
    t = np.linspace(-along / 2 - BEYOND, along / 2 + BEYOND, POINTS)
    phase = 2 * np.pi * draw(city.seed, "layout/river", 1)
    share_of_swing = kind.swing * (0.4 if count > 1 or side in ALONG else 1.0)
    swing = share_of_swing * across * np.sin(phase + 2 * np.pi * WAVES * t / along)
    found = []
    for share in _shares(side, number, count):
        points = np.column_stack([t, swing + share * across])
        points = points if axis == "west_east" else points[:, ::-1]
        line = shapely.LineString(points + np.array([xmin + xmax, ymin + ymax]) / 2)
        ground = shapely.buffer(line, half)
        if abs(share) * across + share_of_swing * across + half < across / 2:
            found.append((_cost(layout, ground), line))
    if not found:
        raise narrow
    wet = layout.areas.geometry.to_numpy()[layout.areas["kind"].isin(LANDS["water"]).to_numpy()]
    dry = [pair for pair in found if not shapely.intersects(wet, pair[1].buffer(half)).any()]
    if not dry:
        raise ActionFailed(f"There is water already wherever a {kind.name} could flow.")
    best = int(np.argmin([cost for cost, _ in dry]))
    return dry[best][1]


def _cost(layout: Layout, ground: Any) -> float:
    """Return how many square metres a course takes of what was asked for, or is a park or plaza."""
    made = is_made(layout.buildings)
    dear = np.concatenate([
        layout.buildings.geometry.to_numpy()[made],
        layout.areas.geometry.to_numpy()[layout.areas["kind"].isin(KEPT).to_numpy()],
    ])  # fmt: skip
    weight = np.concatenate([np.full(made.sum(), 100.0), np.ones(len(dear) - made.sum())])
    return round(float((weight * shapely.area(shapely.intersection(dear, ground))).sum()), 1)


def _with_water(layout: Layout, kind: _Kind, number: int, water: Any, strip: Any) -> Layout:
    """Add water, and what lies between it and the quays."""
    key = () if number == 0 and kind.name == "river" else (kind.name, number)
    for k, part in enumerate(shapely.get_parts(water).tolist()):
        owner = Owner(("made", "river", *key, *((k,) if k else ())), {})
        layout = with_area(layout, "river", part, owner, tags=kind.tags)
    for k, bank in enumerate(shapely.get_parts(strip.difference(water))):
        layout = with_area(layout, kind.land, bank, Owner(("made", "bank", *key, k), {}))
    return layout


def _meeting(
    city: City, kind: _Kind, axis: str, side: str, width: float, count: int, bridges: int
) -> City:
    """Build a river into which others flow from its two sides."""
    site = shapely.box(*city.layout.extent)
    half = width / 2 + kind.quay
    main = _course(city, kind, axis, side, width)
    inner = main.intersection(site)
    arms = [_tributary(city, inner, axis, (k + 1) / count, k, half) for k in range(count - 1)]
    water = shapely.union_all(
        [shapely.buffer(line, width / 2, cap_style="flat") for line in (main, *arms)]
    )
    ground = shapely.union_all(
        [shapely.buffer(line, half, cap_style="flat") for line in (main, *arms)]
    )
    water, ground = (
        shapely.buffer(shapely.buffer(shape, radius), -radius)
        for shape, radius in ((water, BEND), (ground, CORNER))
    )
    rims = shapely.line_merge(ground.boundary.intersection(shapely.buffer(site, -ON)))
    lines = [
        shapely.LineString(np.round(shapely.get_coordinates(shapely.simplify(line, 0.05)), 3))
        for line in shapely.get_parts(rims).tolist()
    ]
    lines = [_to_border(line, site) for line in lines]
    city, owners = _with_quays(city, lines, lines, ground)
    strip = shapely.buffer(ground, -_strip(kind)).intersection(site)
    layout = _with_water(city.layout, kind, 0, water.intersection(site), strip)
    spots = _spots_on_arms(inner, arms, lines, half, bridges, site)
    return _with_bridges(replace(city, layout=layout), owners, spots, kind)


def _to_border(line: Any, site: Any) -> Any:
    """Let a line that ends just before the border end on it."""
    points = shapely.get_coordinates(line)
    for end in (0, -1):
        spot = shapely.Point(points[end])
        if shapely.distance(spot, site.exterior) <= 2 * ON:
            points[end] = np.round(shapely.get_coordinates(
                site.exterior.interpolate(site.exterior.project(spot)))[0], 3)  # fmt: skip
    return shapely.LineString(points)


def _tributary(city: City, main: Any, axis: str, share: float, number: int, half: float) -> Any:
    """Return the course of a river that flows into another one, from beyond the border."""
    xmin, ymin, xmax, ymax = city.layout.extent
    end = shapely.get_coordinates(main.interpolate(share, normalized=True))[0]
    sign = 1.0 if (draw(city.seed, "layout/river", 2) < 0.5) == (number == 0) else -1.0
    way = np.array([0.0, sign]) if axis == "west_east" else np.array([sign, 0.0])
    border = np.array([xmax if sign > 0 else xmin, ymax if sign > 0 else ymin])
    far = abs(float((border - end) @ way)) + BEYOND
    if far - BEYOND < half + APART:
        raise ActionFailed("The site has no room for a river that flows into another one.")
    aside = np.array([way[1], way[0]]) * (0.5 - draw(city.seed, "layout/river", 3 + number))
    t = np.linspace(0.0, 1.0, POINTS)[:, None]
    bend = (t - 0.35).clip(0.0) ** 2 * 0.6 * far
    return shapely.LineString(end + t * far * way + bend * aside)


Spot = tuple[FloatArray, tuple[int, int]]  # place of a bridge on the water, and its two quays


def _spots_on_arms(
    main: Any, arms: list[Any], quays: list[Any], half: float, count: int, site: Any
) -> list[Spot]:
    """Spread bridges over rivers that meet, away from where they do."""
    mouths = [shapely.Point(shapely.get_coordinates(arm)[0]) for arm in arms]
    shut = shapely.union_all([shapely.buffer(mouth, half + CLEAR) for mouth in mouths])
    free = [shapely.difference(line.intersection(site), shut) for line in (main, *arms)]
    parts = np.concatenate([shapely.get_parts(line) for line in free])
    length = np.floor(shapely.length(parts) / APART).astype(int)
    if count > length.sum():
        raise ActionFailed(
            f"{count} bridges do not fit on these rivers: there is room for {length.sum()}."
        )
    given = np.zeros(len(parts), int)
    for _ in range(count):  # each time where they are farthest apart
        room = np.where(given < length, shapely.length(parts) / (given + 1), -1.0)
        given[int(np.argmax(np.round(room, 3)))] += 1
    found: list[Spot] = []
    for part, number in zip(parts.tolist(), given.tolist(), strict=True):
        for k in range(number):
            at = (k + 0.5) / number * part.length
            middle, ahead = (shapely.get_coordinates(part.interpolate(d))[0] for d in (at, at + 1))
            way = ahead - middle
            across = np.array([-way[1], way[0]]) / max(float(np.hypot(*way)), 1e-9)
            sides = [_quay_across(quays, middle, sign * across, half) for sign in (1.0, -1.0)]
            found.append((middle, (sides[0], sides[1])))
    return found


def _quay_across(quays: list[Any], middle: FloatArray, way: FloatArray, half: float) -> int:
    """Return which street along the water lies across from its middle."""
    ray = shapely.LineString([middle, middle + 3 * half * way])
    away = [shapely.distance(shapely.Point(middle), quay.intersection(ray)) for quay in quays]
    return int(np.nanargmin(np.where(np.isnan(away), np.inf, away)))


def _with_bridges(city: City, owners: list[Owner], spots: Sequence[Spot], kind: _Kind) -> City:
    """Build bridges between the quays."""
    roads = city.layout.roads
    ids = roads["id"].to_numpy()
    rows = [int(np.flatnonzero(ids == owner.id())[0]) for owner in owners]
    quays = [roads.geometry.to_numpy()[row] for row in rows]
    feet = [_feet(roads, row) for row in rows]
    taken: list[list[FloatArray]] = [[] for _ in rows]
    first = _bridge_count(city)
    lines, made = [], []
    for k, (middle, sides) in enumerate(spots, first):
        ends = np.stack([_foot(quays[side], feet[side], middle) for side in sides])
        for side, end in zip(sides, ends, strict=True):
            taken[side].append(end)
        tags = bridge_tags(city.seed, k)
        for number, (piece, over) in enumerate(_bridge_pieces(ends, kind)):
            lines.append(shapely.LineString(piece))
            own = {**tags, **BRIDGE} if over else tags
            made.append(Owner(("made", "bridge", k, number), own))
    if not spots:
        return city
    shapes = roads.geometry.to_numpy().copy()
    for side, row in enumerate(rows):
        if taken[side]:
            shapes[row] = with_points(quays[side], np.stack(taken[side]))
    table = joined_tables(roads.set_geometry(shapes), street_rows(city, lines, made))
    return replace(city, layout=replace(city.layout, roads=table))


def _feet(roads: Any, row: int) -> FloatArray:
    """Return where streets end on a quay, (n, 2)."""
    shapes = roads.geometry.to_numpy()
    others = np.delete(shapes, row)
    tips = np.concatenate([
        shapely.get_coordinates(shapely.get_point(others, 0)),
        shapely.get_coordinates(shapely.get_point(others, -1)),
    ])  # fmt: skip
    return np.asarray(tips[shapely.distance(shapely.points(tips), shapes[row]) <= ON])


def _foot(quay: Any, feet: FloatArray, middle: FloatArray) -> FloatArray:
    """Return where a bridge begins: on a street near the place across from its middle."""
    place = shapely.get_coordinates(quay.interpolate(quay.project(shapely.Point(middle))))[0]
    if len(feet):
        away = np.hypot(*(feet - place).T)
        if away.min() <= SNAP:
            return np.asarray(feet[int(np.argmin(np.round(away, 3)))])
    return np.asarray(np.round(place, 3))


def _bridge_pieces(ends: FloatArray, kind: _Kind) -> list[tuple[FloatArray, bool]]:
    """Cut a crossing into a ramp, the bridge and a ramp."""
    way = ends[1] - ends[0]
    ramp = min(ABUTMENT, kind.quay - 1.0)
    step = np.round(ramp * way / np.hypot(*way), 3)
    first, last = ends[0] + step, ends[1] - step
    return [
        (np.stack([ends[0], first]), False),
        (np.stack([first, last]), True),
        (np.stack([last, ends[1]]), False),
    ]
