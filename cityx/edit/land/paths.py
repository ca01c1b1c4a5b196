"""Paths laid through parks, along waters and between things, and footbridges over rivers."""

from __future__ import annotations

import json
from dataclasses import replace
from typing import Annotated, Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.city import City
from cityx.city.layout import joined_tables, make_table
from cityx.edit.land.open_ground import ways_of
from cityx.edit.land.spots import CORNERS, region_around
from cityx.edit.renewal import renewed
from cityx.errors import ActionFailed, UsageError
from cityx.geometry.polygons import region_of_corners
from cityx.ids import hash_ids, id_text, stable_id
from cityx.protocol import Choice, ObjectName, Points, Port, Range, Serves, action
from cityx.protocol.objects import find_objects
from cityx.road.network.street_designs import SURFACES

PATH = "edit/footpath-v1"
BRIDGE = "edit/footbridge-v1"
WATER = ("water", "sea", "river", "pool")
KIND = "footway"
FIRM = 1.0  # metres of ground between a path and walls or water
BANK = 2.5  # metres from water to the middle of a path along it
INSIDE = 2.0  # metres from the border of a park to the middle of a path along it
SHORTEST = 12.0  # metres of a piece of path that is worth laying
DOORSTEP = 40.0  # metres from a border to a street that leads by it
STEP = 4.0  # metres between the places where a bridge is tried
LANDING = 2.0  # metres of a bridge beyond each bank
APPROACH = 70.0  # metres from a landing to the street that it is reached from
APART = 25.0  # metres between bridges
NEAR = 80.0  # metres from something to a bridge that is near it
LONGEST = 120.0  # metres of a footbridge


@action(
    PATH,
    limits=[
        "Houses, waters and streets interrupt a path; nothing leads over water.",
        "Through a park it leads straight from street to street.",
    ],
    requires=("layout",),
    takes=(Port("layout", "scene_layout"),),
    gives=(Port("layout", "scene_layout"),),
    serves=tuple(Serves("edit=add_path", place) for place in ("within", "beside", "start")),
    binds={
        "through": "within", "along": "beside", "start": "start", "end": "end",
        "surface": "surface", "width": "width",
    },
    labels=("path", "footpath", "gravel path", "trail", "walk through the park"),
)  # fmt: skip
def footpath(
    city: City,
    *,
    through: Annotated[tuple[str, ...] | None, ObjectName()] = None,
    along: Annotated[tuple[str, ...] | None, ObjectName()] = None,
    start: Annotated[tuple[str, ...] | None, ObjectName()] = None,
    end: Annotated[tuple[str, ...] | None, ObjectName()] = None,
    surface: Annotated[str, Choice(*SURFACES)] = "gravel",
    width: Annotated[float, Range(1.0, 8.0)] = 2.5,
) -> City:
    """Lay a path for walkers and rebuild what depends on it.

    Parameters
    ----------
    city
        City with its ground.
    through
        Parks and squares, each of which it crosses.
    along
        Waters, on all banks of which it runs, and land, inside the border of which it runs.
    start, end
        Objects between which it leads.
    surface
        What it is paved with, in OpenStreetMap's words.
    width
        Metres.
    """
    lines: list[Any] = []
    if through is not None:
        lines += [_across(city, shape) for shape in _lands(city, through)]
    if along is not None:
        lines += [_beside(city, shape, kind) for shape, kind in _lands_and_kinds(city, along)]
    if start is not None and end is not None:
        ends = [shapely.union_all(region_around(city, one)) for one in (start, end)]
        lines.append(shapely.shortest_line(*ends))
    if not lines:
        raise UsageError("Nothing is said of the way: through, along or between what.")
    found = _firm(city, shapely.union_all(lines), width)
    if not len(found):
        where = ", ".join((*(through or ()), *(along or ()), *(start or ())))
        raise ActionFailed(f"No path finds room at {where}, between houses, waters and streets.")
    return renewed(city, replace(city.layout, roads=_with(city, PATH, found, surface, width)))


def _with(
    city: City, of: str, lines: NDArray[Any], surface: str, width: float,
    bridge: NDArray[np.bool_] | None = None,
) -> Any:  # fmt: skip
    """Return the table of streets with some paths more."""
    count = len(lines)
    over = np.zeros(count, bool) if bridge is None else bridge
    ends = [np.rint(100 * shapely.get_coordinates(line)).astype(int).ravel() for line in lines]
    keys = [stable_id(of, *map(int, end)) for end in ends]
    ids = hash_ids(0, of, np.array(keys, np.uint64))
    word = of.split("/")[1].partition("-")[0]
    tags = [{"highway": KIND, "surface": surface} | ({"bridge": "yes"} if one else {})
            for one in over.tolist()]  # fmt: skip
    table = make_table(
        "roads", lines, id=ids, kind=[KIND] * count, width=np.full(count, width),
        surface=[surface] * count, bridge=over, layer=over.astype(np.int16),
        source=[f"edit/{word}/{id_text(int(one))}" for one in ids],
        tags=[json.dumps(one) for one in tags],
    )  # fmt: skip
    return joined_tables(city.layout.roads, table)


def _lands_and_kinds(city: City, names: tuple[str, ...]) -> list[tuple[Any, str]]:
    areas = city.layout.areas
    mine = np.isin(areas["id"].to_numpy(np.uint64), find_objects(city, names))
    if not mine.any():
        raise UsageError(f"A path leads through or along land or water; {names[0]} is neither.")
    shapes = shapely.make_valid(areas.geometry.to_numpy()[mine])
    return list(zip(shapes.tolist(), areas["kind"].to_numpy().astype(str)[mine], strict=True))


def _lands(city: City, names: tuple[str, ...]) -> list[Any]:
    return [shape for shape, _ in _lands_and_kinds(city, names)]


def _across(city: City, land: Any) -> Any:
    """Return the longest way through land between two places of its border that streets lead by."""
    ring = shapely.boundary(land)
    at = shapely.line_interpolate_point(ring, np.linspace(0.0, 1.0, 48)[:-1], normalized=True)
    streets = shapely.union_all(city.layout.roads.geometry.to_numpy())
    at = at[shapely.distance(at, streets) <= DOORSTEP]
    first, second = np.triu_indices(len(at), 1)
    ways = shapely.linestrings(
        np.stack([shapely.get_coordinates(at[first]), shapely.get_coordinates(at[second])], axis=1)
    )
    held = shapely.buffer(land, 0.5)
    good = shapely.covers(held, ways) if len(ways) else np.zeros(0, bool)
    if not good.any():
        raise ActionFailed("No straight path leads through it from one street to another.")
    middle = np.round(shapely.distance(ways, shapely.centroid(land)), 2)
    score = shapely.length(ways) - 2 * middle
    return ways[int(np.argmax(np.where(good, np.round(score, 3), -np.inf)))]


def _beside(city: City, shape: Any, kind: str) -> Any:
    """Return the line along the banks of water, or inside the border of land."""
    off = BANK if kind in WATER else -INSIDE
    line = shapely.boundary(shapely.buffer(shape, off, join_style="mitre"))
    return shapely.intersection(line, shapely.box(*city.layout.extent).buffer(-INSIDE))


def _firm(city: City, lines: Any, width: float) -> NDArray[Any]:
    """Return the pieces of lines that lie on open ground, (n,) in a set order."""
    layout = city.layout
    areas = layout.areas
    wet = areas.geometry.to_numpy()[areas["kind"].isin(WATER).to_numpy()]
    taken = [*shapely.buffer(layout.buildings.geometry.to_numpy(), width / 2 + FIRM)]
    taken += [*shapely.buffer(wet, width / 2 + FIRM / 2)]
    roads = layout.roads
    taken += [*ways_of(city, np.ones(len(roads), bool), 0.0)]
    found = shapely.difference(lines, shapely.union_all(np.array(taken, object)))
    parts = shapely.get_parts(shapely.line_merge(found))
    parts = parts[(shapely.get_type_id(parts) == 1) & (shapely.length(parts) >= SHORTEST)]
    order = np.lexsort(np.round(shapely.get_coordinates(shapely.centroid(parts)), 3).T)
    return np.asarray(parts[order], object)


@action(
    BRIDGE,
    limits=[
        "It carries those on foot; a bridge for cars is part of a street and cannot be added.",
        "It crosses squarely, 25 m from other bridges, where a straight path leads to a street.",
    ],
    requires=("layout",),
    takes=(Port("layout", "scene_layout"),),
    gives=(Port("layout", "scene_layout"),),
    serves=("edit=add_bridge",),
    binds={"over": "over", "near": "within", "ground": "ground", "width": "width"},
    labels=("footbridge", "pedestrian bridge", "bridge for walkers"),
)
def footbridge(
    city: City,
    *,
    over: Annotated[tuple[str, ...], ObjectName()],
    near: Annotated[tuple[str, ...] | None, ObjectName()] = None,
    ground: Annotated[tuple[tuple[float, ...], ...] | None, Points(3, CORNERS)] = None,
    width: Annotated[float, Range(1.5, 8.0)] = 3.0,
) -> City:
    """Build a bridge for walkers over a river, with paths from both ends to the nearest streets.

    Parameters
    ----------
    city
        City with its ground.
    over
        The water.
    near
        Objects near which it lies; where the other bridges are farthest when left out.
    ground
        Corners of polygons near which it lies, instead: x, y and which polygon.
    width
        Metres.
    """
    shapes = [shape for shape, kind in _lands_and_kinds(city, over) if kind in WATER]
    if not shapes:
        raise UsageError(f"A footbridge leads over water; {over[0]} is none.")
    about = None
    if ground is not None:
        about = region_of_corners(ground)
    elif near is not None:
        about = region_around(city, near)
    lines = _crossings(city, shapely.union_all(shapes), width)
    roads = city.layout.roads
    others = shapely.union_all(roads.geometry.to_numpy()[roads["bridge"].to_numpy(bool)])
    apart = shapely.distance(lines, others) if not others.is_empty else np.full(len(lines), APART)
    score = apart if about is None else -shapely.distance(lines, about)
    good = apart >= APART
    if about is not None:
        good &= -score <= NEAR
    for at in np.argsort(-np.round(score, 3), kind="stable"):
        if not good[at]:
            continue
        ways = [
            _approach(city, end, lines[at], width) for end in shapely.get_coordinates(lines[at])
        ]
        if all(way is not None for way in ways):
            own = np.array([lines[at], *[way for way in ways if way is not None]], object)
            deck = np.array([True, False, False])[: len(own)]
            table = _with(city, BRIDGE, own, "wood", width, deck)
            return renewed(city, replace(city.layout, roads=table))
    there = " there" if about is not None else ""
    raise ActionFailed(
        f"No footbridge of {width:g} m finds room{there}: {APART:g} m from other bridges, with a "
        "straight way from both banks to a street."
    )


def _crossings(city: City, water: Any, width: float) -> NDArray[Any]:
    """Return the lines that lead squarely from bank to bank, with landings, clear of houses."""
    inner = shapely.box(*city.layout.extent).buffer(-(APART / 2))
    banks = shapely.get_parts(shapely.line_merge(shapely.intersection(water.boundary, inner)))
    banks = sorted(banks.tolist(), key=lambda one: -one.length)[:2]
    if len(banks) < 2:
        raise ActionFailed("The water has no two banks here, between which a bridge would lead.")
    at = shapely.line_interpolate_point(banks[0], np.arange(STEP / 2, banks[0].length, STEP))
    ends = shapely.get_coordinates(shapely.shortest_line(at, banks[1])).reshape(-1, 2, 2)
    way = ends[:, 1] - ends[:, 0]
    far = np.hypot(*way.T)
    unit = way / np.maximum(far, 1e-9)[:, None]
    reach = np.stack([ends[:, 0] - LANDING * unit, ends[:, 1] + LANDING * unit], axis=1)
    lines = shapely.linestrings(np.round(reach, 3))
    houses = shapely.STRtree(city.layout.buildings.geometry.to_numpy())
    hit = houses.query(lines, predicate="dwithin", distance=width / 2 + FIRM)[0]
    good = (far > 2.0) & (far <= LONGEST)
    good[hit] = False
    return np.asarray(lines[good], object)


def _approach(city: City, end: NDArray[np.float64], deck: Any, width: float) -> Any:
    """Return the way from a landing to the nearest street on its side, None where none is free."""
    roads = city.layout.roads
    land = ~roads["bridge"].to_numpy(bool)
    lines = roads.geometry.to_numpy()[land]
    spot = shapely.Point(end)
    way = shapely.shortest_line(spot, shapely.union_all(lines))
    houses = city.layout.buildings.geometry.to_numpy()
    areas = city.layout.areas
    wet = areas.geometry.to_numpy()[areas["kind"].isin(WATER).to_numpy()]
    blocked = shapely.dwithin(houses, way, width / 2 + FIRM / 2).any()
    blocked |= shapely.length(shapely.intersection(wet, way)).sum() > LANDING
    return None if blocked or not 0 < way.length <= APPROACH or way.crosses(deck) else way
