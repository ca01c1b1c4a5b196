"""Elements of streets: roundabouts, signalled junctions, dead ends, streets without cars."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from dataclasses import replace
from itertools import pairwise
from typing import Annotated, Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.checks.predicates.junctions import LAYERS, Junctions, Net, net_of
from cityx.checks.predicates.whereabouts import nearness
from cityx.checks.predicates.words import LANDS, LOCAL, MAIN
from cityx.city import City, Layout
from cityx.city.asked_goals import asked, with_goal
from cityx.city.layout import joined_tables
from cityx.city.sites import pieces_of
from cityx.errors import ActionFailed, UsageError
from cityx.geometry.arrays import BoolArray, FloatArray, IntArray
from cityx.places.profiles import keeps_left, profile_of
from cityx.protocol import Choice, Port, Range, action
from cityx.road.network.network import DRIVABLE
from cityx.sources.features.kinds import point_kind
from cityx.sources.features.resolve import Features
from cityx.sources.features.shells import Shells
from cityx.sources.features.tagged import Owner, Tags, nothing, tag
from cityx.town.cutting import given_up_in, refilled, street_rows, with_points, with_streets
from cityx.town.procedural_streets import BLIND, half_width, name_of
from cityx.town.rebuilding import cleared, street_blocks, with_features

MEASURES: Mapping[str, str] = {
    "roundabout": "roundabout", "signalled_junction": "junction, signals=true",
    "dead_end": "dead_end", "pedestrian_zone": "path, class=pedestrian",
    "road_works": "road_works",
}  # fmt: skip
# What stands in rows: its tags, metres from the kerb, and metres of the narrowest walk with it.
ROWS: Mapping[str, tuple[Tags, float, float]] = {
    "streetlight": ({"highway": "street_lamp"}, 0.6, 1.2),
    "bench": ({"amenity": "bench"}, 0.75, 1.8),
}  # fmt: skip
AT_JUNCTION = 9.0  # metres beyond the carriageway across from which a row goes on
SIDES = ("any", "middle", "edge", "north", "east", "south", "west")
MOST = 10_000
RING = 15.0  # metres of radius of the middle of a ring's carriageway
RING_PER_ARM = 3.5  # metres of it for each arm beyond the fourth
RING_TAGS: Tags = {
    "junction": "roundabout", "oneway": "yes", "lanes": "1", "width:carriageway": "6.5",
    "maxspeed": "30", "surface": "asphalt", "lit": "yes", "parking:both": "no",
}  # fmt: skip
RING_POINTS = 48
WALK = 2.5  # metres outside of a ring
FEWEST_ARMS, MOST_ARMS = 3, 6
BETWEEN = 62.0  # metres between a roundabout and other junctions, and from its middle to the border
SIGNALS_APART = 34.0  # metres between junctions with signals of their own
BARRED = 10.0  # metres from a junction along an arm to the sign of who gives way
GRAND = 3  # main arms that would make a junction signalled by itself
STUB = (28.0, 60.0)  # metres of a dead end
INTO = 0.55  # of the depth of a block that it leads into
TURNING = 8.5  # metres round its end
KEPT = (
    "sidewalk:both:width",
    "surface",
    "cityx:crossings",
    "maxspeed",
)  # of the street that one leaves
LEAST_BLOCK = 1600.0  # square metres
CLOSED = (35.0, 170.0)  # metres of a street that works close
AT_ENDS, CONES, BOARDS = 9.0, 6.0, 2.3  # metres from junctions to works, between cones, and boards
WALKING = (70.0, 320.0)  # metres of a street without cars


@action(
    "layout/street_elements-v1",
    limits=[
        "Buildings in the way are taken down, and blocks that lose ground are built anew.",
        "A roundabout takes a junction that is 62 m from others.",
    ],
    requires=("layout",),
    after=("layout/street_design-v1",),
    takes=(Port("layout", "scene_layout"),),
    gives=(Port("layout", "scene_layout"),),
    labels=("roundabout", "traffic lights", "signals", "intersection", "junction", "dead end",
            "cul-de-sac", "pedestrian zone", "car-free"),
)  # fmt: skip
def street_elements(
    city: City,
    *,
    kind: Annotated[str, Choice(*MEASURES)],
    least: Annotated[int, Range(0, 500)] = 1,
    most: Annotated[int, Range(0, MOST)] = MOST,
    side: Annotated[str, Choice(*SIDES)] = "any",
) -> City:
    """Give a city so many roundabouts, signalled junctions, dead ends or streets without cars.

    Parameters
    ----------
    city
        City with streets.
    kind
        What is counted.
    least, most
        How many there shall be; of what there is too much is taken away.
    side
        Where new ones are: a side of the site, its middle or its edge.
    """
    if least > most:
        raise UsageError(f"least = {least} is more than most = {most}.")
    city = _BUILDERS[kind](city, least, most, side)
    end = None if most == MOST else most
    word = kind.replace("_", " ")
    said = f"{least} {word}" if least == most else f"at least {least} {word}"
    city = asked(city, said, f"n({MEASURES[kind]})", least=least, most=end)
    if side in ("north", "east", "south", "west") and least:
        city = with_goal(city, f"{word} in the {side}", f"side({MEASURES[kind]}) == {side}")
    return city


def in_order(spots: NDArray[Any], side: str, extent: tuple[float, float, float, float]) -> IntArray:
    """Return places in the order in which they suit a side, those of no side by the middle."""
    towards = {"any": "center", "middle": "center"}.get(side, side)
    near = nearness(spots, towards, extent)
    x, y = shapely.get_coordinates(spots).reshape(-1, 2).T
    return np.asarray(np.lexsort((np.round(x, 2), np.round(y, 2), -np.round(near, 3))), np.int64)


def _apart(spots: NDArray[Any], order: IntArray, reach: float, taken: NDArray[Any]) -> list[int]:
    """Return places in order that are so far from each other and from those taken."""
    at, held = shapely.get_coordinates(spots), shapely.get_coordinates(taken).reshape(-1, 2)
    found: list[int] = []
    for row in order.tolist():
        others = np.concatenate([held, at[found]])
        if not len(others) or np.hypot(*(others - at[row]).T).min() >= reach:
            found.append(row)
    return found


def no_room(city: City, kind: str, wanted: int, room: int) -> ActionFailed:
    """Return the refusal of what there is no room for."""
    x0, y0, x1, y1 = city.layout.extent
    return ActionFailed(
        f"{wanted} {kind.replace('_', ' ')}s cannot be had on {x1 - x0:.0f} m by {y1 - y0:.0f} m; "
        f"there is room for {room}. Ask for fewer, for a larger site or for smaller blocks."
    )


@action(
    "layout/street_rows-v1",
    limits=["None stand at junctions; where there is no walk there is no row."],
    requires=("layout",),
    after=("layout/street_elements-v1",),
    takes=(Port("layout", "scene_layout"),),
    gives=(Port("layout", "scene_layout"),),
    labels=("street lamps", "lighting", "benches", "spacing", "every"),
)
def street_rows_of(
    city: City,
    *,
    kind: Annotated[str, Choice(*ROWS)] = "streetlight",
    spacing: Annotated[float, Range(8.0, 120.0)] = 30.0,
) -> City:
    """Put lamps or benches along the walks of all streets, so many metres apart on each side.

    Parameters
    ----------
    city
        City with streets.
    kind
        What stands in a row.
    spacing
        Metres between neighbours on one side; those of both sides stand in turn.
    """
    tags, setback, narrow = ROWS[kind]
    layout = city.layout
    own = point_kind(tags)
    kept = layout.points[(layout.points["kind"] != own).to_numpy()].reset_index(drop=True)
    city = replace(city, layout=replace(layout, points=kept))
    places = _along_walks(city, spacing, setback, narrow)
    if not len(places):
        raise ActionFailed(f"No street has a walk of {narrow:g} m for a row of {kind}s.")
    city = with_things(city, [(place, tags) for place in places], f"row_of_{kind}")
    quantity = f"spacing({kind}, road)"
    return asked(city, f"{kind}s every {spacing:g} m", quantity, least=0.9 * spacing,
                 most=1.1 * spacing)  # fmt: skip


def _along_walks(city: City, spacing: float, setback: float, narrow: float) -> list[Any]:
    """Return places on both walks of streets, clear of junctions and of houses."""
    roads = city.layout.roads
    level = roads["kind"].isin(DRIVABLE) & (roads["layer"] == 0) & ~roads["tunnel"]
    net = net_of(city)
    joints = shapely.points(net.places[net.arms >= FEWEST_ARMS])
    found: list[Any] = []
    for row in np.flatnonzero((level & ~roads["roundabout"]).to_numpy()).tolist():
        own = roads.iloc[row]
        line = own.geometry
        for sign, side, phase in ((1.0, "left", 0.5), (-1.0, "right", 0.0)):
            if not own[f"sidewalk_{side}"] >= narrow:
                continue
            aside = float(own["width"]) / 2 + min(setback, float(own[f"sidewalk_{side}"]) / 4 + 0.1)
            at = np.arange(spacing * (0.25 + phase / 2), line.length, spacing)
            spots = beside(line, at, sign * aside)
            free = ~_near(spots, joints, float(own["width"]) / 2 + AT_JUNCTION)
            found += spots[free].tolist()
    houses = city.layout.buildings.geometry.to_numpy()
    fine = ~_near(np.array(found, object), houses, 0.4)
    return [spot for spot, free in zip(found, fine.tolist(), strict=True) if free]


def beside(line: Any, at: FloatArray, aside: float) -> NDArray[Any]:
    """Return points beside a line, to its left where ``aside`` is positive."""
    here = shapely.get_coordinates(shapely.line_interpolate_point(line, at)).reshape(-1, 2)
    ahead = shapely.get_coordinates(shapely.line_interpolate_point(line, at + 0.5)).reshape(-1, 2)
    back = shapely.get_coordinates(shapely.line_interpolate_point(line, at - 0.5)).reshape(-1, 2)
    way = (ahead - back) / np.maximum(np.hypot(*(ahead - back).T), 1e-9)[:, None]
    out = np.column_stack([-way[:, 1], way[:, 0]])
    return np.asarray(shapely.points(np.round(here + aside * out, 3)), object)


# Roundabouts.


def _roundabouts(city: City, least: int, most: int, side: str) -> City:
    rings = LAYERS["roundabout"](city, "roundabout").shapes
    if len(rings) > most:
        raise ActionFailed(
            f"There are {len(rings)} roundabouts, of which {most} may stay; those of a map are "
            "not taken away."
        )
    missing = least - len(rings)
    if missing <= 0:
        return city
    net = net_of(city)
    spots, arms = _round_places(city, net)
    order = in_order(spots, side, city.layout.extent)
    chosen = _apart(spots, order, 2 * RING + WALK + BETWEEN / 2, shapely.centroid(rings))[:missing]
    if len(chosen) < missing:
        raise no_room(city, "roundabout", least, len(rings) + len(chosen))
    lines, discs = [], []
    profile = profile_of(city.frame)
    begin = int(city.layout.roads["source"].str.startswith("made/roundabout/").sum())
    for k, row in enumerate(chosen, begin):
        radius = RING + RING_PER_ARM * max(int(arms[row]) - 4, 0)
        tags = _ring_tags(city, spots[row], k)
        lines.append((_circle(city, spots[row], radius), Owner(("made", "roundabout", k), tags)))
        discs.append(shapely.buffer(spots[row], radius + half_width(tags, profile), quad_segs=32))
    return with_streets(city, lines, shapely.union_all(discs))


def _round_places(city: City, net: Net) -> tuple[NDArray[Any], IntArray]:
    """Return the junctions that may become roundabouts, and how many arms each has."""
    joint = (net.arms >= FEWEST_ARMS) & (net.arms <= MOST_ARMS)
    spots, arms = shapely.points(net.places[joint]), net.arms[joint]
    every = net.places[net.arms >= FEWEST_ARMS]
    away = np.hypot(*(net.places[joint][:, None] - every[None]).transpose(2, 0, 1))
    lone = (away < RING + STUB[0]).sum(axis=1) == 1
    border = shapely.box(*city.layout.extent).exterior
    fine = lone & (shapely.distance(spots, border) >= BETWEEN / 2 + RING)
    wet = city.layout.areas["kind"].isin(LANDS["water"]).to_numpy()
    water = shapely.union_all(city.layout.areas.geometry.to_numpy()[wet])
    fine &= shapely.is_empty(water) | (shapely.distance(spots, water) > 2 * RING)
    fast = city.layout.roads["kind"].isin(["motorway", "motorway_link", "trunk"]).to_numpy()
    decks = fast | (city.layout.roads["layer"].to_numpy() != 0)
    high = shapely.union_all(city.layout.roads.geometry.to_numpy()[decks])
    fine &= shapely.is_empty(high) | (shapely.distance(spots, high) > 2 * RING)
    return spots[fine], arms[fine]


def _circle(city: City, middle: Any, radius: float) -> Any:
    """Return the ring of a roundabout in the direction of its traffic."""
    turn = 2 * np.pi * np.append(np.arange(RING_POINTS), 0) / RING_POINTS
    turn = -turn if keeps_left(city.frame) else turn
    points = shapely.get_coordinates(middle) + radius * np.column_stack(
        [np.cos(turn), np.sin(turn)]
    )
    return shapely.LineString(np.round(points, 3))


def _ring_tags(city: City, middle: Any, number: int) -> Tags:
    """Return the tags of a ring: as main as the highest street that it joins."""
    roads = city.layout.roads
    near = shapely.dwithin(roads.geometry.to_numpy(), middle, 1.0)
    ranks = ("primary", "secondary", "tertiary", "residential")
    rank = next((word for word in ranks if word in set(roads["kind"][near])),
                "residential")  # fmt: skip
    outer = "left" if keeps_left(city.frame) else "right"
    walks = roads[["sidewalk_left", "sidewalk_right"]].to_numpy(float)
    wide = max(WALK, float(np.nan_to_num(walks[near]).max(initial=0.0)))
    walk = {"sidewalk": outer, f"sidewalk:{outer}:width": f"{wide:g}"}
    said = [json.loads(text or "{}") for text in roads["tags"].to_numpy()[near].tolist()]
    walk |= {key: own[key] for own in said for key in ("surface", "cityx:crossings") if key in own}
    name = name_of(city.seed, ("Circus", "Roundabout"), 6, number=number)
    return {**RING_TAGS, "highway": rank, **walk, "name": name}


# Signals.


def _signalled(city: City, least: int, most: int, side: str) -> City:
    layer = Junctions(city, "junction")
    ruled = layer.has("signals", "true")
    if ruled.sum() > most:
        city = _without_signals(city, layer.shapes[ruled][: int(ruled.sum()) - most])
        return _signalled(city, least, most, side)
    spots, arms = layer.shapes, layer.number("arms")
    rings = LAYERS["roundabout"](city, "roundabout").shapes
    border = shapely.box(*city.layout.extent).exterior
    fine = ~ruled & (arms >= FEWEST_ARMS) & (shapely.distance(spots, border) > BARRED)
    fine &= ~_near(spots, rings, RING) & ~_near(spots, _on_layers(city.layout), BARRED)
    rows = np.flatnonzero(fine)
    main = _main_arms(city.layout, spots[rows])
    order = in_order(spots[rows], side, city.layout.extent)
    if side == "any":  # where main roads cross first, then where most streets do
        place = np.argsort(order)
        order = np.lexsort((place, -arms[rows], -main))
    chosen = _apart(spots[rows], order, SIGNALS_APART, spots[ruled])[: max(least - ruled.sum(), 0)]
    if len(chosen) + ruled.sum() < least:
        raise no_room(city, "signalled_junction", least, len(chosen) + int(ruled.sum()))
    lit = shapely.points(np.concatenate(
        [np.zeros((0, 2)), *(layer.meeting(int(row)) for row in rows[chosen])]
    ))  # fmt: skip
    grand = rows[main >= GRAND]
    others = np.setdiff1d(grand, rows[chosen])
    signs = _give_way(city.layout, spots[others])
    things = [(spot, {"highway": "traffic_signals"}) for spot in lit.tolist()]
    return with_things(city, [*things, *signs], "signals")


def _without_signals(city: City, spots: NDArray[Any]) -> City:
    points = city.layout.points
    lights = (points["kind"] == "traffic_signals").to_numpy()
    gone = lights & _near(points.geometry.to_numpy(), spots, 32.0)
    kept = points[~gone].reset_index(drop=True)
    return replace(city, layout=replace(city.layout, points=kept))


def _near(spots: NDArray[Any], things: NDArray[Any], reach: float) -> BoolArray:
    found = np.zeros(len(spots), bool)
    if len(things) and len(spots):
        tree = shapely.STRtree(things)
        found[tree.query(spots, predicate="dwithin", distance=reach)[0]] = True
    return found


def _on_layers(layout: Layout) -> NDArray[Any]:
    """Return the streets that no signals rule: those over and under others, and fast ones."""
    high = (layout.roads["layer"].to_numpy() != 0) | layout.roads["tunnel"].to_numpy(bool)
    return np.asarray(layout.roads.geometry.to_numpy()[high], object)


def _main_arms(layout: Layout, spots: NDArray[Any]) -> IntArray:
    """(k,) main streets that leave each place; one that goes on counts twice."""
    roads = layout.roads[layout.roads["kind"].isin((*MAIN, "tertiary"))].geometry.to_numpy()
    count = np.zeros(len(spots), np.int64)
    spot, road = shapely.STRtree(roads).query(spots, predicate="dwithin", distance=1.0)
    at = shapely.line_locate_point(roads[road], spots[spot])
    inner = (at > 1.0) & (at < shapely.length(roads[road]) - 1.0)
    np.add.at(count, spot, 1 + inner)
    return count


def _give_way(layout: Layout, spots: NDArray[Any]) -> list[tuple[Any, Tags]]:
    """Return a sign to give way beside each place: there no signals are needed."""
    roads = layout.roads.geometry.to_numpy()[layout.roads["kind"].isin(DRIVABLE).to_numpy()]
    found: list[tuple[Any, Tags]] = []
    for spot in spots.tolist():
        near = roads[shapely.dwithin(roads, spot, 2.0)]
        line = near[int(np.argmin(shapely.length(near)))]
        at = shapely.line_locate_point(line, spot)
        to = at + BARRED if at + BARRED <= line.length else at - BARRED
        place = shapely.line_interpolate_point(line, to)
        found.append((place, {"highway": "give_way"}))
    return found


def with_things(city: City, things: list[tuple[Any, Tags]], name: str) -> City:
    """Add things at points."""
    if not things:
        return city
    shapes = [shape for shape, _ in things]
    begin = int(city.layout.points["source"].str.startswith(f"made/{name}/").sum())
    owners = [Owner(("made", name, begin + k), tags) for k, (_, tags) in enumerate(things)]
    assert all(point_kind(tags) for _, tags in things)
    none = Shells(nothing(), nothing(), np.zeros(0, np.int64))
    features = Features(city.layout.extent, none, points=tag(shapes, owners))
    return replace(city, layout=with_features(city, city.layout, features))


# Dead ends.


def _dead_ends(city: City, least: int, most: int, side: str) -> City:
    ends = LAYERS["dead_end"](city, "dead_end").shapes
    while len(ends) > most:
        order = in_order(ends, side, city.layout.extent)
        city = _without_ends(city, ends[order[most:]])
        left = LAYERS["dead_end"](city, "dead_end").shapes
        if len(left) >= len(ends):
            raise ActionFailed(f"{len(left)} dead ends cannot be taken away; {most} may stay.")
        ends = left
    added = 0
    while len(ends) + added < least:
        longer = _with_end(city, side)
        if longer is None:
            raise no_room(city, "dead_end", least, len(ends) + added)
        city, added = longer, added + 1
    return city


def _without_ends(city: City, ends: NDArray[Any]) -> City:
    """Give up streets from their ends back to the junctions before."""
    before = city.layout
    after = given_up_in(before, shapely.union_all(shapely.buffer(ends, 1.0)))
    lost = shapely.difference(
        shapely.union_all(before.roads.geometry.to_numpy()),
        shapely.union_all(after.roads.geometry.to_numpy()),
    )
    points = after.points
    circles = (points["kind"] == "turning_circle").to_numpy()
    kept = ~(circles & _near(points.geometry.to_numpy(), ends, 3.0))
    after = replace(after, points=points[kept].reset_index(drop=True))
    gone = shapely.buffer(lost, 1.0)
    return refilled(replace(city, layout=after), before, gone, shapely.Polygon())


def _with_end(city: City, side: str) -> City | None:
    """Lead a dead end from a street into a block; None where no block has room for one."""
    layout = city.layout
    blocks = street_blocks(layout)
    border = shapely.box(*layout.extent).exterior
    ends = LAYERS["dead_end"](city, "dead_end").shapes
    fine = (shapely.area(blocks) >= LEAST_BLOCK) & (shapely.distance(blocks, border) > 1.0)
    fine &= ~_near(blocks, ends, 1.0)
    kept = layout.areas[~layout.areas["kind"].isin(
        ("residential", "commercial", "retail", "industrial", "civic", "garden", "grass")
    )].geometry.to_numpy()  # fmt: skip
    name = name_of(city.seed, ("Close", "Court", "Mews"), 8, number=len(ends))
    blocks = blocks[fine]
    for row in in_order(shapely.centroid(blocks), side, layout.extent).tolist():
        found = _stub(city, blocks[row])
        if found is None:
            continue
        road, line, ground = found
        tags = {**_blind_tags(layout, road), "name": name}
        if len(kept) and shapely.intersects(kept, ground).any():
            continue
        return _joined_stub(city, road, line, ground, tags)
    return None


def _blind_tags(layout: Layout, road: int) -> Tags:
    """Return the tags of a dead end: walks, surface and speed are those of its street."""
    own = json.loads(layout.roads["tags"].iloc[road] or "{}")
    kept = {key: own[key] for key in KEPT if key in own}
    return {**BLIND, **kept}


def _stub(city: City, block: Any) -> tuple[int, Any, Any] | None:
    """Return the street that a dead end leaves, its line and the ground it takes, or None."""
    layout = city.layout
    ring = shapely.get_coordinates(shapely.simplify(block, 3.0).exterior)
    step = np.diff(ring, axis=0)
    roads = layout.roads
    drivable = np.flatnonzero(
        roads["kind"].isin(LOCAL).to_numpy() & (roads["layer"].to_numpy() == 0)
    )
    lines = roads.geometry.to_numpy()[drivable]
    for k in np.argsort(-np.hypot(*step.T), kind="stable")[:4].tolist():
        middle = (ring[k] + ring[k + 1]) / 2
        way = np.array([-step[k][1], step[k][0]]) / np.hypot(*step[k])
        probe = shapely.LineString([middle + 0.5 * way, middle + 400.0 * way])
        inside = shapely.intersection(probe, block)
        if inside.is_empty:
            way = -way
            probe = shapely.LineString([middle + 0.5 * way, middle + 400.0 * way])
            inside = shapely.intersection(probe, block)
        depth = max((part.length for part in shapely.get_parts(inside).tolist()), default=0.0)
        length = min(INTO * depth, STUB[1])
        away = shapely.distance(lines, shapely.Point(middle))
        row = int(np.argmin(away)) if len(away) else -1
        if length < STUB[0] or row < 0 or away[row] > 20.0:
            continue
        at = shapely.line_locate_point(lines[row], shapely.Point(middle))
        if not 15.0 < at < lines[row].length - 15.0:
            continue
        start = shapely.get_coordinates(shapely.line_interpolate_point(lines[row], at))[0]
        end = middle + length * way
        line = shapely.LineString(np.round([start, end], 3))
        own = roads.iloc[drivable[row]]
        walk = max(float(own["sidewalk_left"]), float(own["sidewalk_right"]))
        host = shapely.buffer(lines[row], float(own["width"]) / 2 + walk, cap_style="flat")
        half = half_width(_blind_tags(layout, int(drivable[row])), profile_of(city.frame))
        strip = shapely.buffer(line, half, cap_style="flat")
        ground = shapely.union(strip, shapely.buffer(shapely.Point(end), TURNING))
        return int(drivable[row]), line, shapely.difference(ground, host)
    return None


def _joined_stub(city: City, road: int, line: Any, ground: Any, tags: Tags) -> City:
    before = city.layout
    layout = cleared(before, ground)
    shapes = layout.roads.geometry.to_numpy().copy()
    ends = shapely.get_coordinates(line)
    shapes[road] = with_points(shapes[road], ends[:1])
    number = int(layout.roads["source"].str.startswith("made/dead_end/").sum())
    new = street_rows(city, [line], [Owner(("made", "dead_end", number), tags)])
    roads = joined_tables(layout.roads.set_geometry(shapes), new)
    city = replace(city, layout=replace(layout, roads=roads))
    city = refilled(city, before, ground, ground)
    circle = (shapely.Point(ends[-1]), {"highway": "turning_circle"})
    return with_things(city, [circle], "turning")


# Streets without cars.


def _walking(city: City, least: int, most: int, side: str) -> City:
    rows = np.flatnonzero((city.layout.roads["kind"] == "pedestrian").to_numpy())
    names = city.layout.roads["name"].to_numpy().astype(str)
    have = len(np.unique(names[rows]))
    if have > most:
        for name in np.unique(names[rows])[most:].tolist():
            city = _to_cars(city, name)
        have = most
    for number in range(have, least):
        part = best_stretch(city, side, WALKING)
        if part is None:
            raise no_room(city, "pedestrian_zone", least, number)
        city = walked_on(city, *part, number, "pedestrian", "paving_stones", "Walk")
    return city


def _to_cars(city: City, name: str) -> City:
    """Let cars into a street again."""
    roads = city.layout.roads
    rows = np.flatnonzero((roads["name"] == name) & (roads["kind"] == "pedestrian"))
    tags = [json.loads(text or "{}") for text in roads["tags"].to_numpy()[rows].tolist()]
    return as_kind(city, rows, [{**own, "highway": "residential"} for own in tags])


def best_stretch(
    city: City, side: str, sizes: tuple[float, float],
    fits: Callable[[Any], float] | None = None,
) -> tuple[int, FloatArray] | None:  # fmt: skip
    """Return the row and the points of the stretch between junctions that suits best.

    Parameters
    ----------
    side
        Where it is to lie.
    sizes
        Least and greatest length, metres.
    fits
        How well a line suits besides, 0 for any; one that does not at all is not a number.
    """
    layout = city.layout
    net = net_of(city)
    joint = net.places[net.arms >= FEWEST_ARMS]
    held = {tuple(place) for place in np.round(joint, 3).tolist()}
    roads = layout.roads
    local = roads["kind"].isin(LOCAL) & (roads["layer"] == 0) & ~roads["roundabout"]
    walked = roads.geometry.to_numpy()[roads["kind"].isin(["pedestrian", "footway"]).to_numpy()]
    best: tuple[float, int, FloatArray] | None = None
    towards = {"any": "center", "middle": "center"}.get(side, side)
    for row in np.flatnonzero(local.to_numpy()).tolist():
        for part in _stretches(shapely.get_coordinates(roads.geometry.iloc[row]), held):
            line = shapely.LineString(part)
            if not sizes[0] <= line.length <= sizes[1] or shapely.dwithin(walked, line, 5.0).any():
                continue
            near = nearness(np.array([line.centroid], object), towards, layout.extent)[0]
            cost = -round(float(near), 3) - 0.0005 * round(line.length)
            cost -= 0.0 if fits is None else fits(line)
            if np.isnan(cost):
                continue
            if best is None or cost < best[0]:
                best = cost, row, part
    return None if best is None else best[1:]


def _stretches(points: FloatArray, joints: set[tuple[float, ...]]) -> list[FloatArray]:
    """Return the stretches of a line between junctions, two where there is one within."""
    met = [k for k, place in enumerate(np.round(points, 3).tolist()) if tuple(place) in joints]
    found = []
    for a, b in zip(met, [*met[2:], None], strict=False):
        if b is not None:
            found.append(points[a : b + 1])
    found += [points[a : b + 1] for a, b in pairwise(met)]
    return found


def walked_on(
    city: City, row: int, part: FloatArray, number: int, highway: str, surface: str, name: str
) -> City:
    """Cut a stretch out of a street, which is then for people alone."""
    roads = city.layout.roads
    shape = roads.geometry.iloc[row]
    own = roads.iloc[row]
    ends = sorted(shapely.line_locate_point(shape, shapely.points(part[[0, -1]])).tolist())
    points = shapely.get_coordinates(shape)
    at = shapely.line_locate_point(shape, shapely.points(points))
    rest = [points[at <= ends[0] + 1e-6], points[at >= ends[1] - 1e-6]]
    left = roads.geometry.to_numpy().copy()
    left[row] = shapely.MultiLineString([line for line in rest if len(line) > 1])
    kept = pieces_of(roads, left, 1)
    tags = json.loads(own["tags"] or "{}")
    gone = ("lanes", "maxspeed", "oneway", "sidewalk", "parking", "cycleway", "width")
    tags = {key: value for key, value in tags.items() if not key.startswith(gone)}
    walks = float(own["sidewalk_left"]) + float(own["sidewalk_right"])
    wide = float(own["width"]) + walks
    tags |= {"highway": highway, "surface": surface, "width": f"{wide:.2f}",
             "name": f"{own['name']} {name}"}  # fmt: skip
    owner = Owner(("made", highway, number), tags)
    new = street_rows(city, [shapely.LineString(part)], [owner])
    return replace(city, layout=replace(city.layout, roads=joined_tables(kept, new)))


# Road works.


def _works(city: City, least: int, most: int, side: str) -> City:
    have = len(LAYERS["road_works"](city, "road_works").shapes)
    if have > most:
        raise ActionFailed(f"There are {have} road works, of which {most} may stay.")
    for number in range(have, least):
        part = best_stretch(city, side, CLOSED)
        if part is None:
            raise no_room(city, "road_works", least, number)
        city = _closed(city, *part, number)
    return city


def _closed(city: City, row: int, part: FloatArray, number: int) -> City:
    """Close a stretch of a street with barriers at both ends, and dig it up between cones."""
    line = shapely.LineString(part)
    wide = float(city.layout.roads["width"].iloc[row])
    city = walked_on(city, row, part, number, "footway", "gravel", "works")
    found: list[tuple[Any, Tags]] = []
    cones = np.arange(AT_ENDS, line.length - AT_ENDS + 0.01, CONES)
    for sign in (1.0, -1.0):
        spots = beside(line, cones, sign * (wide / 2 - 0.8))
        found += [(spot, {"barrier": "traffic_cone"}) for spot in spots.tolist()]
    across = np.arange(-wide / 2 + 1.2, wide / 2 - 1.1, BOARDS)
    for at in (AT_ENDS - 1.5, line.length - AT_ENDS + 1.5):
        way = np.degrees(bearing_at(line, at))
        for aside in across.tolist():
            spot = beside(line, np.array([at]), aside)[0]
            found.append((spot, {"barrier": "work_barrier", "direction": f"{way:.0f}"}))
    return with_things(city, found, "road_works")


def bearing_at(line: Any, at: float) -> float:
    """Return the compass direction of a line at a place, radians."""
    ends = shapely.get_coordinates(shapely.line_interpolate_point(line, [at - 0.5, at + 0.5]))
    return float(np.arctan2(*(ends[1] - ends[0])) % (2 * np.pi))


def as_kind(city: City, rows: IntArray, tags: list[Tags]) -> City:
    """Make streets of another kind of streets; their rows become new ones."""
    roads = city.layout.roads
    owners = [Owner(("made", "cars", k), own) for k, own in enumerate(tags)]
    new = street_rows(city, list(roads.geometry.to_numpy()[rows]), owners)
    kept = roads.drop(index=roads.index[rows]).reset_index(drop=True)
    return replace(city, layout=replace(city.layout, roads=joined_tables(kept, new)))


_BUILDERS: Mapping[str, Callable[[City, int, int, str], City]] = {
    "roundabout": _roundabouts, "signalled_junction": _signalled, "dead_end": _dead_ends,
    "pedestrian_zone": _walking, "road_works": _works,
}  # fmt: skip
