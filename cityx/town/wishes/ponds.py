"""Ponds that a town is asked to hold, in its parks and lawns."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated

import numpy as np
import shapely

from cityx.city import City, Layout
from cityx.city.asked_goals import asked
from cityx.errors import ActionFailed
from cityx.geometry.arrays import IntArray
from cityx.geometry.turns import SIDES
from cityx.protocol import Choice, Port, Range, action
from cityx.sources.features.tagged import Owner
from cityx.town.ponds import GREENS, SIZES, dug
from cityx.town.rebuilding import with_area

MOST = 20


@action(
    "layout/ponds-v1",
    limits=["A pond lies in a park, a lawn or a garden that has room for it."],
    requires=("layout",),
    after=("layout/elements-v1",),
    takes=(Port("layout", "scene_layout"),),
    gives=(Port("layout", "scene_layout"),),
    labels=("pond", "water", "number"),
)
def ponds(
    city: City,
    *,
    least: Annotated[int, Range(1, MOST)] = 1,
    side: Annotated[str, Choice("any", "north", "east", "south", "west")] = "any",
) -> City:
    """Dig ponds into the parks of a town, one into each while there are some.

    Parameters
    ----------
    city
        City with parks or other greens.
    least
        How many.
    side
        Of the site, on which greens come first.
    """
    layout = city.layout
    for number in range(least):
        layout = _with_one_more(layout, number, side, city.seed)
    return asked(replace(city, layout=layout), "ponds", "n(pond)", least=least)


def _with_one_more(layout: Layout, number: int, side: str, seed: int) -> Layout:
    areas = layout.areas
    rows = np.flatnonzero(areas["kind"].isin(GREENS).to_numpy())
    shapes, ids = areas.geometry.to_numpy()[rows], areas["id"].to_numpy(np.uint64)[rows]
    waters = areas.geometry.to_numpy()[(areas["kind"] == "water").to_numpy()]
    held = [any(shape.intersects(water) for water in waters) for shape in shapes]
    parks = (areas["kind"].to_numpy()[rows] == "park").astype(int)
    x, y = SIDES.get(side, (0.0, 0.0))
    middle = shapely.get_coordinates(shapely.centroid(shapes)) - np.mean(
        np.reshape(layout.extent, (2, 2)), axis=0
    )
    along, across = middle @ np.array([x, y]), np.abs(middle @ np.array([-y, x]))
    away = np.round(along - across, 2)
    size = [round(one.area) for one in shapes]
    keys = (ids, np.negative(size), -parks, np.negative(away), np.array(held, int))
    order: IntArray = np.lexsort(keys)
    for wanted in (SIZES["medium"], SIZES["small"]):
        for row in order.tolist():
            found, _ = dug(layout, shapes[row], wanted, int(ids[row]), seed=seed)
            if found is not None:
                owner = Owner(("made", "pond", str(number)), {"name": "pond"})
                return with_area(layout, "water", found, owner)
    raise ActionFailed(
        f"No park or lawn has room for pond {number + 1}; ask for a larger site or another park."
    )
