"""Footing: things set on the ground of another place, if they can stand there."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from cityx.city.city import City
from cityx.city.rows import take_rows
from cityx.city.scene import Instances
from cityx.edit.buildings.rebuilding import Ids
from cityx.edit.land.room import faults, refuse, stand_of
from cityx.edit.targets import with_changed_rows
from cityx.ground.pieces import heights


def moved_pieces(
    city: City, ids: Ids, change: Callable[[Instances], Instances], *, anywhere: bool = False
) -> City:
    """Change where things stand, keeping each as high above the ground as it was.

    Parameters
    ----------
    city
        The city.
    ids
        Of the things.
    change
        Takes rows of instances to where they shall be, in the plane.
    anywhere
        Whether nothing is refused.

    Raises
    ------
    ActionFailed
        If one cannot stand there; the message says why, and where there is room.
    """

    def stood(rows: Instances) -> Instances:
        made = change(rows)
        rise = heights(city, made.position[:, :2]) - heights(city, rows.position[:, :2])
        position = made.position.copy()
        position[:, 2] = rows.position[:, 2] + rise
        return replace(made, position=position)

    changed = with_changed_rows(city, ids, stood)
    if not anywhere:
        check_room(changed, ids)
    return changed


def check_room(city: City, ids: Ids) -> None:
    """Refuse a city in which one of some things stands where it cannot.

    Raises
    ------
    ActionFailed
        As of `moved_pieces`.
    """
    for rows in city.scene.instances.values():
        for at in np.flatnonzero(np.isin(rows.object_id, ids)).tolist():
            one = take_rows(rows, slice(at, at + 1))
            stand = stand_of(city.scene.prototypes[int(one.prototype[0])])
            yaw, xy = one.rotation[:, 2].astype(float), one.position[:, :2]
            scale = float(one.scale[0, :2].max())
            (why,) = faults(city, stand, xy, yaw, scale=scale, but=ids)
            if why:
                refuse(city, stand, xy[0], float(yaw[0]), why, but=ids)


def moved_points(city: City, ids: Ids, way: NDArray[np.float64]) -> City:
    """Move the points of a map that some things stand at, so that a build puts them there."""
    import shapely

    points = city.layout.points
    mine = np.isin(points["id"].to_numpy(np.uint64), ids)
    if not mine.any():
        return city
    shapes = points.geometry.to_numpy().copy()
    shapes[mine] = shapely.transform(shapes[mine], lambda xy: xy + way)
    table = points.copy()
    table.geometry = shapes
    return replace(city, layout=replace(city.layout, points=table))
