"""What bars the way: bridges closed to traffic, scaffolds before houses."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from typing import Annotated, Any

import numpy as np
import shapely

from cityx.checks.predicates.junctions import LAYERS
from cityx.checks.predicates.street_predicates import Bridges
from cityx.city import City
from cityx.city.asked_goals import asked
from cityx.errors import ActionFailed, UsageError
from cityx.geometry.arrays import FloatArray, IntArray
from cityx.protocol import Choice, Port, Range, action
from cityx.road.network.network import DRIVABLE
from cityx.sources.features.tagged import Tags
from cityx.town.wishes.street_elements import (
    BOARDS,
    MOST,
    SIDES,
    as_kind,
    bearing_at,
    beside,
    in_order,
    no_room,
    with_things,
)

MEASURES: Mapping[str, str] = {
    "closed_bridge": "bridge, closed=true", "scaffold": "scaffolding",
}  # fmt: skip
BEFORE_DECK = 8.0  # metres before the deck of a bridge at which boards stand
RAMP = 40.0  # metres of a street at the end of a bridge that is its ramp
BAY, FEWEST, MOST_BAYS = 2.6, 2, 6  # metres of a bay of a scaffold, and how many stand together
OFF_WALL = 0.75  # metres from a wall to the middle of a scaffold
ROOM = 2.6  # metres before a wall that it needs, clear of carriageways and other houses
LEAST_WALL = 5.0  # metres of the height of a house that gets one
FRONT = 30.0  # metres within which the street before a house lies


@action(
    "layout/obstacles-v1",
    limits=["A scaffold is four storeys high; who walks there goes round it."],
    requires=("layout",),
    after=("layout/street_elements-v1", "layout/river-v1", "layout/elements-v1",
           "layout/buildings_count-v1"),
    takes=(Port("layout", "scene_layout"),),
    gives=(Port("layout", "scene_layout"),),
    labels=("closed bridge", "barrier", "scaffold", "scaffolding", "obstacle"),
)  # fmt: skip
def obstacles(
    city: City,
    *,
    kind: Annotated[str, Choice(*MEASURES)],
    least: Annotated[int, Range(0, 100)] = 1,
    most: Annotated[int, Range(0, MOST)] = MOST,
    side: Annotated[str, Choice(*SIDES)] = "any",
) -> City:
    """Close bridges to traffic with barriers, or put scaffolds before houses, so many of them.

    Parameters
    ----------
    city
        City with streets.
    kind
        What is counted.
    least, most
        How many there shall be; those of a map are not taken away.
    side
        Where new ones are: a side of the site, its middle or its edge.
    """
    if least > most:
        raise UsageError(f"least = {least} is more than most = {most}.")
    have = len(_there(city, kind))
    word = kind.replace("_", " ")
    if have > most:
        raise ActionFailed(f"There are {have} of the kind {word}, of which {most} may stay.")
    if have < least:
        city = _BUILDERS[kind](city, have, least, side)
    end = None if most == MOST else most
    words = f"{least} {word}" if least == 1 else f"{least} {word}s"
    return asked(city, words, f"n({MEASURES[kind]})", least=least, most=end)


def _there(city: City, kind: str) -> Any:
    """Return the shapes of those that are there."""
    if kind == "closed_bridge":
        layer = Bridges(city, "bridge")
        return layer.shapes[layer.has("closed", "true")] if len(layer.shapes) else layer.shapes
    return LAYERS["scaffolding"](city, "scaffolding").shapes


# Closed bridges.


def _close_bridges(city: City, have: int, least: int, side: str) -> City:
    """Let no cars over some bridges, and put boards across the street at both ends."""
    layer = Bridges(city, "bridge")
    free = np.flatnonzero(~layer.has("closed", "true")) if len(layer.shapes) else np.zeros(0, int)
    roads = city.layout.roads
    decks = [np.flatnonzero(roads["id"].isin(layer.members(np.array([k]))).to_numpy())
             for k in free.tolist()]  # fmt: skip
    streets = [_with_ramps(roads, rows) for rows in decks]
    fine = [k for k, rows in enumerate(streets) if _is_street(roads, rows)]
    spots = shapely.centroid(layer.shapes[free[fine]])
    order = in_order(spots, side, city.layout.extent)[: least - have]
    if len(order) < least - have:
        raise no_room(city, "closed_bridge", least, have + len(order))
    chosen = [fine[k] for k in order.tolist()]
    things: list[tuple[Any, Tags]] = []
    for k in chosen:
        things += _boards(city, streets[k], decks[k])
    every = np.concatenate([streets[k] for k in chosen])
    tags = [_for_walkers(roads.iloc[row]) for row in every.tolist()]
    return with_things(as_kind(city, every, tags), things, "closed_bridge")


def _is_street(roads: Any, rows: IntArray) -> bool:
    """Return whether ways are a street of the town that may be closed."""
    kind = roads["kind"].iloc[rows]
    return bool(kind.isin(DRIVABLE).all() and not kind.str.startswith("motorway").any())


def _with_ramps(roads: Any, rows: IntArray) -> IntArray:
    """Return ways over a bridge together with the pieces of their street that lead up to it."""
    lines = roads.geometry.to_numpy()
    whole = shapely.union_all(lines[rows])
    near = shapely.dwithin(lines, whole, 0.05) & (shapely.length(lines) <= RAMP)
    near &= roads["name"].isin(set(roads["name"].iloc[rows]) - {""}).to_numpy()
    near[rows] = True
    return np.asarray(np.flatnonzero(near), np.int64)


def _boards(city: City, street: IntArray, deck: IntArray) -> list[tuple[Any, Tags]]:
    """Return boards across a street before both ends of a bridge, on the ground."""
    roads = city.layout.roads
    lines = roads.geometry.to_numpy()
    found: list[tuple[Any, Tags]] = []
    for row in np.setdiff1d(street, deck).tolist():
        line = lines[row]
        along = line.project(shapely.union_all(lines[deck]).centroid)
        at = min(BEFORE_DECK, line.length / 2)
        found += _across(line, line.length - at if along > line.length / 2 else at, roads.iloc[row])
    if not found:  # no ramps of its own: on the deck
        line = max(lines[deck].tolist(), key=lambda one: one.length)
        row = roads.iloc[deck[0]]
        found = [*_across(line, 1.5, row), *_across(line, line.length - 1.5, row)]
    return found


def _across(line: Any, at: float, row: Any) -> list[tuple[Any, Tags]]:
    """Return boards from kerb to kerb at a place along a street."""
    half = float(row["width"]) / 2
    way = np.degrees(bearing_at(line, at))
    aside = np.arange(-half + 1.0, half - 0.5, BOARDS)
    spots = [beside(line, np.array([at]), one)[0] for one in aside.tolist()]
    return [(spot, {"barrier": "work_barrier", "direction": f"{way:.0f}"}) for spot in spots]


def _for_walkers(row: Any) -> Tags:
    """Return the tags of a street that cars no longer use, as wide as it was with its walks."""
    gone = ("lanes", "maxspeed", "oneway", "sidewalk", "parking", "cycleway", "width")
    tags = {key: value for key, value in json.loads(row["tags"] or "{}").items()
            if not key.startswith(gone)}  # fmt: skip
    wide = float(row["width"]) + float(row["sidewalk_left"]) + float(row["sidewalk_right"])
    return {**tags, "highway": "pedestrian", "motor_vehicle": "no", "width": f"{wide:.2f}",
            "name": str(row["name"])}  # fmt: skip


# Scaffolds.


def _scaffolds(city: City, have: int, least: int, side: str) -> City:
    """Put scaffolds along the fronts of houses."""
    houses = city.layout.buildings
    taken = _there(city, "scaffold")
    fronts = _fronts(city)
    rows = np.array(sorted(fronts), np.int64)
    if len(taken) and len(rows):
        near = shapely.STRtree(taken).query(houses.geometry.to_numpy()[rows], "dwithin", 4.0)
        rows = np.delete(rows, np.unique(near[0]))
    spots = shapely.centroid(houses.geometry.to_numpy()[rows])
    order = in_order(spots, side, city.layout.extent)
    chosen: list[int] = []
    for row in rows[order].tolist():
        middle = fronts[row].mean(axis=0)
        apart = [np.hypot(*(fronts[one].mean(axis=0) - middle)) for one in chosen]
        if len(chosen) < least - have and min(apart, default=np.inf) > (MOST_BAYS + 2) * BAY:
            chosen.append(row)
    if len(chosen) < least - have:
        raise no_room(city, "scaffold", least, have + len(chosen))
    things: list[tuple[Any, Tags]] = []
    for row in chosen:
        things += _bays(*fronts[row])
    return with_things(city, things, "scaffold")


def _bays(start: FloatArray, end: FloatArray) -> list[tuple[Any, Tags]]:
    """Return bays of a scaffold before a wall that has the house on its left."""
    way = (end - start) / np.hypot(*(end - start))
    out = np.array([way[1], -way[0]])
    count = min(int(np.hypot(*(end - start)) // BAY), MOST_BAYS)
    first = (start + end) / 2 - way * BAY * (count - 1) / 2 + OFF_WALL * out
    faces = np.degrees(np.arctan2(*out)) % 360.0
    tags = {"man_made": "scaffolding", "direction": f"{faces:.0f}"}
    spots = [np.round(first + k * BAY * way, 3) for k in range(count)]
    return [(shapely.Point(spot), tags) for spot in spots]


def _fronts(city: City) -> dict[int, FloatArray]:
    """Return houses that have room for a scaffold, and the ends of the wall before which it is."""
    layout = city.layout
    houses = layout.buildings
    shapes = houses.geometry.to_numpy()
    roads = layout.roads[layout.roads["kind"].isin(DRIVABLE).to_numpy()]
    lines, half = roads.geometry.to_numpy(), np.nan_to_num(roads["width"].to_numpy(float)) / 2
    street, tree = shapely.STRtree(lines), shapely.STRtree(shapes)
    site = shapely.box(*layout.extent)
    found: dict[int, FloatArray] = {}
    for row in np.flatnonzero(houses["height"].to_numpy(float) >= LEAST_WALL).tolist():
        ring = shapely.get_coordinates(shapely.orient_polygons(
            shapely.simplify(shapes[row], 0.1)).exterior)  # fmt: skip
        steps = np.hypot(*np.diff(ring, axis=0).T)
        best = None
        for k in np.flatnonzero(steps >= FEWEST * BAY).tolist():
            wall = ring[k : k + 2]
            way = (wall[1] - wall[0]) / steps[k]
            out = np.array([way[1], -way[0]])
            before = shapely.Polygon([*(wall + 0.05 * out), *(wall + ROOM * out)[::-1]])
            near = street.query(shapely.Point(wall.mean(axis=0)), "dwithin", FRONT)
            if not len(near) or not site.contains(before):
                continue
            if len(tree.query(before, "intersects")):
                continue
            clear = shapely.distance(lines[near], before) - half[near]
            away = shapely.distance(lines[near], shapely.Point(wall.mean(axis=0) + out))
            back = shapely.distance(lines[near], shapely.Point(wall.mean(axis=0)))
            if clear.min() < 0.2 or away.min() >= back.min():
                continue
            if best is None or round(float(back.min()), 2) < best[0]:
                best = round(float(back.min()), 2), wall
        if best is not None:
            found[row] = best[1]
    return found


_BUILDERS: Mapping[str, Callable[[City, int, int, str], City]] = {
    "closed_bridge": _close_bridges, "scaffold": _scaffolds,
}  # fmt: skip
