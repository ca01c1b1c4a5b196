"""The height of the highest building."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated

import numpy as np
import shapely

from cityx.city import City, Goal
from cityx.errors import ActionFailed
from cityx.protocol import Port, Range, action
from cityx.town.rebuilding import with_heights

SLENDER = 9.0  # times the root of its plan's area that a building is made high at most
NEARLY = 0.05  # metres by which the height may be missed
BELOW = 0.97  # of the highest building's height that others keep under


@action(
    "layout/highest-v1",
    requires=("layout",),
    after=("layout/building_limits-v1",),
    takes=(Port("layout", "scene_layout"),),
    gives=(Port("layout", "scene_layout"),),
)
def highest(city: City, *, height: Annotated[float, Range(5.0, 800.0)] = 60.0) -> City:
    """Make the highest building exactly so high.

    Parameters
    ----------
    city
        City with buildings.
    height
        Metres. Where all are lower, the one nearest to the middle that is not too slender grows;
        higher ones are lowered.
    """
    table = city.layout.buildings
    if not len(table):
        raise ActionFailed("There is no building that could be the highest.")
    old = table["height"].to_numpy()
    shapes = table.geometry.to_numpy()
    away = np.round(shapely.distance(shapes, shapely.box(*city.layout.extent).centroid), 2)
    stout = SLENDER * np.sqrt(shapely.area(shapes)) >= height
    if not stout.any():
        raise ActionFailed(
            f"No building is broad enough to be {height:g} m high; the broadest bears "
            f"{SLENDER * np.sqrt(shapely.area(shapes).max()):.0f} m."
        )
    high = old >= height
    best = int(np.argmax(np.where(high & stout, old, -1.0))) if (high & stout).any() else int(
        np.argmin(np.where(stout, away, np.inf))
    )  # fmt: skip
    new = np.where(old > BELOW * height, BELOW * height, old)
    new[best] = height
    rows = np.flatnonzero(new != old)
    layout = with_heights(city.layout, rows, new[rows])
    goal = Goal(
        f"the highest building is {height:g} m",
        f"stat(building, height, max) in [{height - NEARLY:g}, {height + NEARLY:g}]",
    )
    return replace(city, layout=layout, goals=(*city.goals, goal))
