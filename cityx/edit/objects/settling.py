"""Settling: the nearest place with room for what is to stand somewhere about."""

from __future__ import annotations

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.city.city import City
from cityx.city.rows import take_rows
from cityx.edit.buildings.resettling import room_for
from cityx.edit.land.room import faults, stand_of
from cityx.edit.targets import Targets

FloatArray = NDArray[np.float64]

STEP = 1.0  # metres between the places that are tried for things
WIDE = 3.0  # and for buildings


def settled(city: City, targets: Targets, way: FloatArray, reach: float) -> FloatArray:
    """Return how far objects are moved so that all find room, near to a way that is wanted.

    Parameters
    ----------
    city
        The city.
    targets
        What is moved.
    way
        (2,) metres.
    reach
        Metres from there that they may end.

    Returns
    -------
    way
        The one wanted, where there is no room at all: who moves it says why.
    """
    step = WIDE if len(targets.buildings) else STEP
    steps = np.arange(-reach, reach + step, step)
    off = np.stack(np.meshgrid(steps, steps), axis=-1).reshape(-1, 2)
    far = np.hypot(*off.T)
    order = np.lexsort((off[:, 0], off[:, 1], np.round(far, 6)))
    ways = way + off[order[far[order] <= reach]]
    free = np.ones(len(ways), bool)
    if len(targets.buildings):
        table = city.layout.buildings
        own = np.isin(table["id"].to_numpy(np.uint64), targets.buildings)
        for shape in table.geometry.to_numpy()[own]:
            shapes = np.array(
                [shapely.transform(shape, lambda xy, w=each: xy + w) for each in ways], object
            )
            free &= room_for(city, shapes, targets.buildings)
    for rows in city.scene.instances.values():
        for at in np.flatnonzero(np.isin(rows.object_id, targets.pieces)).tolist():
            one = take_rows(rows, slice(at, at + 1))
            stand = stand_of(city.scene.prototypes[int(one.prototype[0])])
            spots = one.position[:, :2] + ways
            yaw = np.full(len(ways), float(one.rotation[0, 2]))
            why = faults(city, stand, spots, yaw, but=targets.pieces)
            free &= np.array([not text for text in why], bool)
    found = np.flatnonzero(free)
    return np.asarray(ways[found[0]] if len(found) else way)
