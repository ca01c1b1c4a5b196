"""Spots: places for things in a square or a park, or near something."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.city.city import City
from cityx.errors import ActionFailed
from cityx.geometry.identity import hash_ids
from cityx.plugins.edit.room import Stand, faults
from cityx.protocol.objects import find_objects

FloatArray = NDArray[np.float64]

STEP = 1.0  # metres between the places that are looked at, or more where they are many
MANY = 4000  # places looked at in one square or park
AROUND = 12.0  # metres from something to what is put near it
MARGIN = 0.8  # metres that things keep from the border of where they are put
SPREAD = 0.55  # of the distance that things would have if all lay even, kept between them
LOOK = 60.0  # metres to the farthest way that a thing faces


def spots_within(city: City, names: Sequence[str], count: int, stand: Stand) -> FloatArray:
    """Find places for some things, spread over what they are put in, (count, 2).

    One alone stands as near to the middle as there is room.

    Raises
    ------
    ActionFailed
        If there is room for fewer.
    """
    region = region_around(city, names)
    xmin, ymin, xmax, ymax = region.bounds
    step = max(STEP, float(np.sqrt((xmax - xmin) * (ymax - ymin) / MANY)))
    x, y = (np.arange(low + step / 2, high, step) for low, high in ((xmin, xmax), (ymin, ymax)))
    spots = np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)
    shapely.prepare(region)
    spots = spots[shapely.intersects_xy(region, spots)]
    yaw = facing(city, spots)
    why = faults(city, stand, spots, yaw, but=np.zeros(0, np.uint64)) if len(spots) else []
    free = spots[np.array([not text for text in why], bool)] if len(spots) else spots
    if count == 1 and len(free):
        middle = shapely.get_coordinates(shapely.centroid(region))[0]
        away = np.round(np.hypot(*(free - middle).T), 6)
        return np.asarray(free[np.lexsort((free[:, 1], free[:, 0], away))[:1]])
    least = float(np.hypot(*np.asarray(stand.size, float)[:2]))
    found = _spread(city, free, count, float(region.area), max(least, STEP))
    if len(found) < count:
        raise ActionFailed(f"There is room for {len(found)} of {count} there.")
    return found


def region_around(city: City, names: Sequence[str]) -> Any:
    """Return the ground of areas, and that around other objects."""
    ids = find_objects(city, names)
    layout = city.layout
    shapes: list[Any] = []
    areas = np.isin(layout.areas["id"].to_numpy(np.uint64), ids)
    for shape in layout.areas.geometry.to_numpy()[areas]:
        inner = shapely.buffer(shape, -MARGIN)
        shapes.append(shape if shapely.is_empty(inner) else inner)
    for table in ("buildings", "roads", "points"):
        rows = getattr(layout, table)
        own = rows.geometry.to_numpy()[np.isin(rows["id"].to_numpy(np.uint64), ids)]
        shapes += shapely.buffer(own, AROUND).tolist()
    for rows in city.scene.instances.values():
        at = rows.position[np.isin(rows.object_id, ids), :2]
        shapes += shapely.buffer(shapely.points(at), AROUND).tolist()
    if not shapes:
        raise ActionFailed("What things are to be put into has no ground.")
    return shapely.union_all(shapely.make_valid(np.array(shapes, object)))


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
