"""A ring road round the middle of a city."""

from __future__ import annotations

from typing import Annotated

import numpy as np
import shapely

from cityx.city import City
from cityx.city.asked_goals import asked
from cityx.errors import ActionFailed
from cityx.protocol import Port, Range, action
from cityx.sources.features.tagged import Owner
from cityx.town.cutting import strip_of, with_streets
from cityx.town.procedural_streets import ring_tags

POINTS = 72  # of a ring
SMALLEST = 65.0  # metres of its radius


@action(
    "layout/ring_road-v1",
    limits=["What stands in the way is taken down; streets close beside it are given up."],
    requires=("layout",),
    after=("layout/coast-v1",),
    takes=(Port("layout", "scene_layout"),),
    gives=(Port("layout", "scene_layout"),),
    labels=("ring", "beltway", "orbital", "circle"),
)
def ring_road(
    city: City,
    *,
    share: Annotated[float, Range(0.2, 0.9)] = 0.82,
    lanes: Annotated[int, Range(2, 8)] = 4,
) -> City:
    """Lead a ring road round the middle of a city; the streets it cuts meet it.

    Parameters
    ----------
    city
        City with streets.
    share
        Of the way from the middle to the nearest border, at which it runs.
    lanes
        Of both directions together.
    """
    xmin, ymin, xmax, ymax = city.layout.extent
    radius = share * min(xmax - xmin, ymax - ymin) / 2
    if radius < SMALLEST:
        raise ActionFailed(
            f"A ring at {share:g} of the way to the border has a radius of {radius:.0f} m; "
            f"{SMALLEST:.0f} m are needed. Ask for a larger site."
        )
    turn = 2 * np.pi * np.append(np.arange(POINTS), 0) / POINTS
    middle = np.array([(xmin + xmax) / 2, (ymin + ymax) / 2])
    points = middle + radius * np.column_stack([np.cos(turn), np.sin(turn)])
    line = shapely.LineString(np.round(points, 3))
    tags = ring_tags(city.seed, lanes)
    city = with_streets(city, [(line, Owner(("made", "ring"), tags))], strip_of(line, tags, city))
    return asked(city, "a ring road", "n(road, class=ring)", least=1)
