"""Spots: places for things in a square or a park, or near something."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.city.city import City
from cityx.edit.land.room import Stand, faults
from cityx.errors import ActionFailed
from cityx.geometry.arrays import FloatArray
from cityx.geometry.turns import SIDES
from cityx.ids import hash_ids
from cityx.protocol.objects import find_objects
from cityx.road.surface.kerbs import yaw_facing

STEP = 1.0  # metres between the places that are looked at, or more where they are many
MANY = 4000  # places looked at in one square or park
AROUND = 12.0  # metres from something to what is put near it
CORNERS = 8000  # of the ground that a call names
MARGIN = 0.8  # metres that things keep from the border of where they are put
SPREAD = 0.55  # of the distance that things would have if all lay even, kept between them
BEYOND = 4.0  # metres at least from a side of something to what is put there
IN_A_ROW = 0.6  # metres from one thing of a row to the next
ROWS = ("behind", "before", "beside")  # where in a row the next thing stands, as one looks from it
LOOK = 60.0  # metres to the farthest way that a thing faces


def spots_within(
    city: City, names: Sequence[str], count: int, stand: Stand, *, row: str = ""
) -> FloatArray:
    """Find places for some things, spread over what they are put in, (count, 2).

    One alone stands as near to the middle as there is room, and so does the first of a row, from
    which the others stand as one of `ROWS` says.

    Raises
    ------
    ActionFailed
        If there is room for fewer.
    """
    return spots_in(city, region_around(city, names), count, stand, row=row)


def spots_in(
    city: City, region: shapely.Geometry, count: int, stand: Stand, *, row: str = ""
) -> FloatArray:
    """Find places for some things in a region, as `spots_within` does, (count, 2).

    Raises
    ------
    ActionFailed
        If there is room for fewer.
    """
    xmin, ymin, xmax, ymax = region.bounds
    step = max(STEP, float(np.sqrt((xmax - xmin) * (ymax - ymin) / MANY)))
    x, y = (np.arange(low + step / 2, high, step) for low, high in ((xmin, xmax), (ymin, ymax)))
    spots = np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)
    shapely.prepare(region)
    spots = spots[shapely.intersects_xy(region, spots)]
    middle = shapely.get_coordinates(shapely.centroid(region))[0]
    away = np.round(np.hypot(*(spots - middle).T), 6)
    spots = spots[np.lexsort((spots[:, 1], spots[:, 0], away))]
    if count == 1 or row:
        return _first_row(city, spots, count, stand, row)
    free = spots[_are_free(city, stand, spots, facing(city, spots))]
    least = float(np.hypot(*np.asarray(stand.size, float)[:2]))
    found = _spread(city, free, count, float(region.area), max(least, STEP))
    if len(found) < count:
        raise ActionFailed(f"There is room for {len(found)} of {count} there.")
    return found


def spots_beyond(
    city: City, names: Sequence[str], side: str, off: float | None, count: int, stand: Stand, *,
    row: str = "",
) -> FloatArray:  # fmt: skip
    """Find places for some things on a side of something, (count, 2).

    Parameters
    ----------
    city
        The city.
    names
        What they stand beside.
    side
        One of `SIDES`.
    off
        Metres from its outermost edge there to the middle of the things; None for as near as there
        is room.
    count, stand
        How many, and how they stand.
    row
        As of `spots_within`; without, they stand beside each other along that side.

    Raises
    ------
    ActionFailed
        If there is no room.
    """
    region = shapely.union_all(_shapes(city, find_objects(city, names), 0.0))
    way = np.array(SIDES[side]) / np.hypot(*SIDES[side])
    across = np.array([way[1], -way[0]])
    middle = shapely.get_coordinates(shapely.centroid(region))[0]
    corners = shapely.get_coordinates(region) - middle
    half = max(float(np.abs(corners @ across).max()), AROUND)
    far = float((corners @ way).max())
    t = far + (np.array([off]) if off is not None else np.arange(BEYOND, AROUND + STEP, STEP))
    u = np.arange(-np.floor(half / STEP), np.floor(half / STEP) + 1) * STEP
    ahead, aside = (grid.ravel() for grid in np.meshgrid(t, u))
    order = np.lexsort((aside, np.round(np.abs(aside) + ahead, 6)))
    spots = middle + ahead[order, None] * way + aside[order, None] * across
    if count == 1 or row:
        return _first_row(city, spots, count, stand, row)
    found: list[FloatArray] = []
    least = float(np.hypot(*np.asarray(stand.size, float)[:2])) + IN_A_ROW
    for spot in spots[_are_free(city, stand, spots, facing(city, spots))]:
        if len(found) < count and all(np.hypot(*(spot - other)) >= least for other in found):
            found.append(spot)
    if len(found) < count:
        raise ActionFailed(f"There is room for {len(found)} of {count} there.")
    return np.array(found)


def _first_row(
    city: City, spots: FloatArray, count: int, stand: Stand, row: str
) -> FloatArray:  # fmt: skip
    """Return the first of some places from which a row of things has room, (count, 2).

    Raises
    ------
    ActionFailed
        If there is none.
    """
    yaw = facing(city, spots)
    step = stand.size[0 if row == "beside" else 1] + IN_A_ROW
    back = np.column_stack([-np.sin(yaw), np.cos(yaw)])  # a thing that is not turned looks south
    way = {"before": -back, "beside": np.column_stack([np.cos(yaw), np.sin(yaw)])}.get(row, back)
    free = np.ones(len(spots), bool)
    for number in range(count):
        left = np.flatnonzero(free)
        free[left] = _are_free(city, stand, (spots + number * step * way)[left], yaw[left])
    if not free.any():
        raise ActionFailed(f"There is no room for {'one' if count == 1 else count} there.")
    first = int(np.argmax(free))
    return np.asarray(spots[first] + step * np.arange(count)[:, None] * way[first])


def _are_free(
    city: City, stand: Stand, spots: FloatArray, yaw: FloatArray
) -> NDArray[np.bool_]:  # fmt: skip
    """(n,) whether a thing can stand at places."""
    if not len(spots):
        return np.zeros(0, bool)
    why = faults(city, stand, spots, yaw, but=np.zeros(0, np.uint64))
    return np.array([not text for text in why], bool)


def region_around(city: City, names: Sequence[str]) -> Any:
    """Return the ground of areas, and that around other objects."""
    shapes = _shapes(city, find_objects(city, names), AROUND)
    return shapely.union_all(shapely.make_valid(np.array(shapes, object)))


def _shapes(city: City, ids: NDArray[np.uint64], around: float) -> list[Any]:
    """Return areas, less a margin, and what is so far around other objects.

    Raises
    ------
    ActionFailed
        If none of them has any ground.
    """
    layout = city.layout
    shapes: list[Any] = []
    areas = np.isin(layout.areas["id"].to_numpy(np.uint64), ids)
    for shape in layout.areas.geometry.to_numpy()[areas]:
        inner = shapely.buffer(shape, -MARGIN)
        shapes.append(shape if not around or shapely.is_empty(inner) else inner)
    for table in ("buildings", "roads", "points"):
        rows = getattr(layout, table)
        own = rows.geometry.to_numpy()[np.isin(rows["id"].to_numpy(np.uint64), ids)]
        shapes += shapely.buffer(own, around).tolist() if around else own.tolist()
    for rows in city.scene.instances.values():
        at = shapely.points(rows.position[np.isin(rows.object_id, ids), :2])
        shapes += shapely.buffer(at, around).tolist() if around else at.tolist()
    if not shapes:
        raise ActionFailed("What things are to be put into has no ground.")
    return shapes


def facing(city: City, xy: FloatArray) -> FloatArray:
    """Return the turn by which the front of things looks at the nearest way, (n,) radians."""
    lines = city.layout.roads.geometry.to_numpy()
    yaw = np.zeros(len(xy))
    if not len(lines) or not len(xy):
        return yaw
    points = shapely.points(xy)
    row, line = shapely.STRtree(lines).query_nearest(points, max_distance=LOOK, all_matches=False)
    ends = shapely.get_coordinates(shapely.shortest_line(points[row], lines[line]))
    way = (ends[1::2] - ends[::2]).reshape(-1, 2)
    yaw[row] = np.arctan2(way[:, 0], -way[:, 1])
    return yaw


def turned_to(city: City, xy: FloatArray, names: Sequence[str]) -> FloatArray:
    """Return the turn by which the front of things looks at objects, (n,) radians."""
    shapes = _shapes(city, find_objects(city, names), 0.0)
    whole = shapely.union_all(shapely.make_valid(np.array(shapes, object)))
    points = shapely.points(xy)
    near = np.where(shapely.intersects(points, whole), whole.centroid, whole)
    ends = shapely.get_coordinates(shapely.shortest_line(points, near))
    return yaw_facing((ends[1::2] - ends[::2]).reshape(-1, 2))


def _spread(city: City, free: FloatArray, count: int, area: float, least: float) -> FloatArray:
    """Take places in the order of a hash, each apart from those before it by `least` or more."""
    key = hash_ids(city.seed, "edit/spots", np.rint(1000 * free[:, 0]).astype(np.int64).view("u8"),
                   np.rint(1000 * free[:, 1]).astype(np.int64).view("u8"))  # fmt: skip
    order = np.argsort(key, kind="stable")
    apart = max(SPREAD * float(np.sqrt(area / max(count, 1))), least)
    found: list[FloatArray] = []
    while True:
        found = []
        for spot in free[order]:
            if all(np.hypot(*(spot - other)) >= apart for other in found):
                found.append(spot)
            if len(found) == count:
                return np.array(found)
        if apart <= least:
            return np.array(found).reshape(-1, 2)
        apart = max(0.7 * apart, least)
