"""A river through a city: of a width, between two quays, under a number of bridges."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated, Any

import numpy as np
import shapely

from cityx.checks.predicates.words import LANDS
from cityx.city import City, Layout
from cityx.city.asked_goals import asked
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
SWING, WAVES = 0.06, 1.1  # of the site's size a course swings by; its waves across the site
POINTS = 40  # of a course
BEYOND = 60.0  # metres that a course runs beyond the site
APART = 45.0  # metres between two bridges, or from one to the border
SNAP = 30.0  # metres along a quay within which a bridge takes a street that is there
KEPT = ("pedestrian", "park")  # land that a course avoids


@action(
    "layout/river-v1",
    limits=["What lies in the river's way is taken down; a city with water there is refused."],
    requires=("layout",),
    after=("layout/boulevard-v1",),
    takes=(Port("layout", "scene_layout"),),
    gives=(Port("layout", "scene_layout"),),
    labels=("river", "bridge", "stream", "canal", "water"),
)
def river(
    city: City,
    *,
    width: Annotated[float, Range(8.0, 200.0)] = 30.0,
    bridges: Annotated[int, Range(0, 40)] = 2,
    axis: Annotated[str, Choice(*AXES)] = "west_east",
) -> City:
    """Cut a river through a city, from border to border, under exactly so many bridges.

    Parameters
    ----------
    city
        City with streets.
    width
        Metres of water.
    bridges
        Number of them, spread along the river, on streets where there are some; all other streets
        end on the quays.
    axis
        Where it flows; it swings a little.
    """
    course = _course(city, axis, width)
    quays = [shapely.offset_curve(course, side * (width / 2 + QUAY)) for side in (1.0, -1.0)]
    site = shapely.box(*city.layout.extent)
    room = course.intersection(site).length
    if room < APART * (bridges + 1):
        raise ActionFailed(
            f"{bridges} bridges do not fit on {room:.0f} m of river: there is room for "
            f"{int(room // APART) - 1}."
        )
    lines = [_in_site(quay, site) for quay in quays]
    owners = [Owner(("made", "quay", k), shore_tags(city.seed, "quay", k)) for k in (0, 1)]
    ground = shapely.union_all([
        shapely.buffer(course, width / 2 + QUAY, cap_style="flat"),
        *(strip_of(line, own.tags, city) for line, own in zip(quays, owners, strict=True)),
    ]).intersection(site)  # fmt: skip
    city = with_streets(city, list(zip(lines, owners, strict=True)), ground)
    layout = _with_water(city.layout, course, width, site)
    city = _with_bridges(replace(city, layout=layout), course, owners, bridges, site)
    city = asked(city, f"a river {width:g} m wide", "stat(river, width, mean)",
                 least=0.9 * width, most=1.1 * width)  # fmt: skip
    return asked(city, f"{bridges} bridges", "n(bridge)", least=bridges, most=bridges)


def _in_site(line: Any, site: Any) -> Any:
    """Return the longest part of a line in the site, to the millimetre."""
    parts = shapely.get_parts(shapely.intersection(line, site))
    longest = parts[int(np.argmax(shapely.length(parts)))]
    return shapely.LineString(np.round(shapely.get_coordinates(longest), 3))


def _course(city: City, axis: str, width: float) -> Any:
    """Return the middle of the water: through the site where it takes least that is dear."""
    layout = city.layout
    xmin, ymin, xmax, ymax = layout.extent
    size = np.array([xmax - xmin, ymax - ymin])
    along, across = (size if axis == "west_east" else size[::-1]).tolist()
    half = width / 2 + QUAY
    narrow = ActionFailed(
        f"A river {width:g} m wide with its quays needs {2 * half:.0f} m; the site has "
        f"{across:.0f} m across."
    )
    if min(along, across) <= 2 * half:
        raise narrow
    t = np.linspace(-along / 2 - BEYOND, along / 2 + BEYOND, POINTS)
    phase = 2 * np.pi * draw(city.seed, "layout/river", 1)
    swing = SWING * across * np.sin(phase + 2 * np.pi * WAVES * t / along)
    found = []
    for share in COURSES:
        points = np.column_stack([t, swing + share * across])
        points = points if axis == "west_east" else points[:, ::-1]
        line = shapely.LineString(points + np.array([xmin + xmax, ymin + ymax]) / 2)
        ground = shapely.buffer(line, half)
        if abs(share) * across + SWING * across + half < across / 2:
            found.append((_cost(layout, ground), line))
    if not found:
        raise narrow
    wet = layout.areas.geometry.to_numpy()[layout.areas["kind"].isin(LANDS["water"]).to_numpy()]
    dry = [pair for pair in found if not shapely.intersects(wet, pair[1].buffer(half)).any()]
    if not dry:
        raise ActionFailed("There is water already wherever a river could flow.")
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


def _with_water(layout: Layout, course: Any, width: float, site: Any) -> Layout:
    """Add the water and the green between it and the quays."""
    water = shapely.buffer(course, width / 2, cap_style="flat").intersection(site)
    green = shapely.buffer(course, width / 2 + QUAY - GREEN, cap_style="flat").intersection(site)
    layout = with_area(layout, "river", water, Owner(("made", "river"), {}))
    for k, bank in enumerate(shapely.get_parts(green.difference(water))):
        layout = with_area(layout, "grass", bank, Owner(("made", "bank", k), {}))
    return layout


def _with_bridges(city: City, course: Any, owners: list[Owner], count: int, site: Any) -> City:
    """Build bridges between the quays."""
    roads = city.layout.roads
    ids = roads["id"].to_numpy()
    rows = [int(np.flatnonzero(ids == owner.id())[0]) for owner in owners]
    quays = [roads.geometry.to_numpy()[row] for row in rows]
    feet = [_feet(roads, row) for row in rows]
    inner = course.intersection(site)
    taken: list[FloatArray] = []
    lines, made = [], []
    for k in range(count):
        middle = shapely.get_coordinates(inner.interpolate((k + 0.5) / count, normalized=True))[0]
        ends = np.stack(
            [_foot(quay, spots, middle) for quay, spots in zip(quays, feet, strict=True)]
        )
        taken.append(ends)
        pieces = _bridge_pieces(ends)
        tags = bridge_tags(city.seed, k)
        for number, (piece, over) in enumerate(pieces):
            lines.append(shapely.LineString(piece))
            own = {**tags, **BRIDGE} if over else tags
            made.append(Owner(("made", "bridge", k, number), own))
    if not count:
        return city
    shapes = roads.geometry.to_numpy().copy()
    for side, row in enumerate(rows):
        shapes[row] = with_points(quays[side], np.stack([ends[side] for ends in taken]))
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


def _bridge_pieces(ends: FloatArray) -> list[tuple[FloatArray, bool]]:
    """Cut a crossing into a ramp, the bridge and a ramp."""
    way = ends[1] - ends[0]
    step = np.round(ABUTMENT * way / np.hypot(*way), 3)
    first, last = ends[0] + step, ends[1] - step
    return [
        (np.stack([ends[0], first]), False),
        (np.stack([first, last]), True),
        (np.stack([last, ends[1]]), False),
    ]
