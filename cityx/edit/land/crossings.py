"""Crossings for those on foot, painted on streets that exist."""

from __future__ import annotations

import json
from dataclasses import replace
from typing import Annotated, Any

import numpy as np
import shapely

from cityx.city import City
from cityx.city.layout import joined_tables, make_table
from cityx.edit.land.spots import CORNERS, region_around
from cityx.edit.renewal import renewed
from cityx.errors import ActionFailed
from cityx.geometry.polygons import region_of_corners
from cityx.ids import hash_ids, id_text, stable_id
from cityx.protocol import ObjectName, Points, Port, Range, Serves, action
from cityx.protocol.objects import find_objects
from cityx.road.network.network import DRIVABLE

ACTION = "edit/crossing-v1"
NEAR = 60.0  # metres from something to the street that is crossed near it
CLEAR = 20.0  # metres from a junction, which has crossings of its own, and from another crossing
STEP = 2.0  # metres between the places that are tried along a street
TAGS = {"crossing": "uncontrolled", "crossing:markings": "zebra"}


@action(
    ACTION,
    limits=["A crossing keeps 20 m from junctions and from other crossings of the layout."],
    requires=("layout",),
    takes=(Port("layout", "scene_layout"),),
    gives=(Port("layout", "scene_layout"),),
    serves=tuple(
        Serves("edit=add", "element=crosswalk", place) for place in ("within", "beside", "ground")
    ),
    binds={"near": "within", "along": "beside", "ground": "ground", "count": "count"},
    labels=("zebra crossing", "crosswalk", "pedestrian crossing"),
)
def crossing(
    city: City,
    *,
    near: Annotated[tuple[str, ...] | None, ObjectName()] = None,
    along: Annotated[tuple[str, ...] | None, ObjectName()] = None,
    ground: Annotated[tuple[tuple[float, ...], ...] | None, Points(3, CORNERS)] = None,
    count: Annotated[int, Range(1, 50)] = 1,
) -> City:
    """Paint zebra crossings across streets, with lowered kerbs.

    Parameters
    ----------
    city
        City with streets.
    near
        Objects near which streets are crossed.
    along
        Streets that are crossed.
    ground
        Corners of polygons in which they are crossed, instead: x, y and which polygon.
    count
        How many.
    """
    places = _places(city, near, along, ground, count)
    found = hash_ids(0, ACTION, np.array([stable_id(ACTION, *map(round, xy)) for xy in
                     1000 * shapely.get_coordinates(places)], np.uint64))  # fmt: skip
    number = len(places)
    table = make_table(
        "points", places, id=found, kind=["crossing"] * number, tags=[json.dumps(TAGS)] * number,
        source=[f"edit/crossing/{id_text(one)}" for one in found.tolist()],
    )  # fmt: skip
    points = joined_tables(city.layout.points, table)
    return renewed(city, replace(city.layout, points=points))


def _places(
    city: City, near: tuple[str, ...] | None, along: tuple[str, ...] | None, ground: Any, count: int
) -> Any:
    """Return where streets are crossed, the nearest first, each apart from all others."""
    roads = city.layout.roads
    rows = roads["kind"].isin(DRIVABLE).to_numpy()
    if along is not None:
        rows &= np.isin(roads["id"].to_numpy(np.uint64), find_objects(city, along))
    lines = roads.geometry.to_numpy()[rows]
    middle: Any = None
    if ground is not None:
        region = region_of_corners(ground)
        middle = region.centroid
        lines = shapely.intersection(lines, region)
    elif near is not None:
        middle = region_around(city, near)
    spots = _spots(lines[~shapely.is_empty(lines)])
    taken = shapely.union_all(_taken(city))
    free = spots[shapely.distance(spots, taken) >= CLEAR] if len(spots) else spots
    away = (
        np.round(shapely.distance(free, middle), 2) if middle is not None else np.zeros(len(free))
    )
    free, away = free[away <= NEAR], away[away <= NEAR]
    at = shapely.get_coordinates(free)
    chosen: list[Any] = []
    for row in np.lexsort((at[:, 1], at[:, 0], away)).tolist():
        if all(free[row].distance(other) >= CLEAR for other in chosen):
            chosen.append(free[row])
        if len(chosen) == count:
            return np.array(chosen, object)
    raise ActionFailed(
        f"There is room for {len(chosen)} of {count} crossings there, {CLEAR:g} m from junctions "
        "and from other crossings."
    )


def _spots(lines: Any) -> Any:
    found: list[Any] = []
    for line in shapely.get_parts(lines).tolist():
        along = np.arange(STEP / 2, line.length, STEP)
        found += shapely.line_interpolate_point(line, along).tolist()
    return np.array(found, object)


def _taken(city: City) -> list[Any]:
    """Return the junctions of streets, and the crossings that there are."""
    points = city.layout.points
    own = points.geometry.to_numpy()[(points["kind"] == "crossing").to_numpy()]
    lines = city.layout.roads.geometry.to_numpy()
    kept = city.layout.roads["kind"].isin(DRIVABLE).to_numpy()
    first, second = shapely.STRtree(lines[kept]).query(lines[kept], predicate="intersects")
    pairs = first < second
    met = shapely.intersection(lines[kept][first[pairs]], lines[kept][second[pairs]])
    return [*own, *met]
