"""The share of a site that is under buildings."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated

import numpy as np
import shapely

from cityx.city import City
from cityx.city.asked_goals import asked
from cityx.errors import ActionFailed, UsageError
from cityx.geometry.arrays import FloatArray, IntArray
from cityx.ids import uniform
from cityx.protocol import Port, Range, action
from cityx.town.rebuilding import without_buildings
from cityx.town.wishes.counting import asked_for


@action(
    "layout/cover-v1",
    limits=["Where too much is built on, buildings are taken down; none is added."],
    requires=("layout",),
    after=("layout/highest-v1",),
    takes=(Port("layout", "scene_layout"),),
    gives=(Port("layout", "scene_layout"),),
    labels=("dense", "sparse", "density", "built up", "coverage"),
)
def cover(
    city: City,
    *,
    least: Annotated[float, Range(0.0, 0.8)] = 0.0,
    most: Annotated[float, Range(0.0, 1.0)] = 1.0,
) -> City:
    """Keep the share of the site that is under buildings within bounds.

    Parameters
    ----------
    city
        City with buildings.
    least, most
        0 to 1. Where more is built on, buildings drawn all over the site go.
    """
    if least > most:
        raise UsageError(f"least = {least:g} is more than most = {most:g}.")
    table = city.layout.buildings
    site = shapely.box(*city.layout.extent).area
    share = shapely.area(table.geometry.to_numpy()) / site
    if share.sum() < least:
        raise ActionFailed(
            f"Buildings take {share.sum():.3f} of the site, {least:g} are asked for. Lay out a "
            'town with fewer parks, narrower streets or the zone "core".'
        )
    kept = asked_for(city.layout)
    ids = table["id"].to_numpy()
    order = np.lexsort((uniform(city.seed, "layout/cover", ids), ~kept))
    gone = _beyond(share, order, most)
    if kept[gone].any():
        raise ActionFailed(
            f"The buildings asked for alone take {share[kept].sum():.3f} of the site, more than "
            f"{most:g}."
        )
    city = replace(city, layout=without_buildings(city.layout, gone))
    if least > 0:
        city = asked(city, f"{100 * least:g} % built on at least", "cover(building)", least=least)
    if most < 1:
        city = asked(city, f"{100 * most:g} % built on at most", "cover(building)", most=most)
    return city


def _beyond(share: FloatArray, order: IntArray, most: float) -> IntArray:
    """Return what has no room any more when things are taken in an order."""
    gone, total = [], 0.0
    for row in order.tolist():
        if total + share[row] > most:
            gone.append(row)
        else:
            total += share[row]
    return np.array(gone, np.int64)
