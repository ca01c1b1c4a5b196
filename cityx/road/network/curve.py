"""A named curve of the city, to build streets or paths on."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated

import shapely

from cityx.city.city import City
from cityx.city.layout import CURVE, Layout, make_table
from cityx.city.sites import merged
from cityx.convert.points import extent_of
from cityx.errors import UsageError
from cityx.ids import stable_id
from cityx.protocol import Points, Port, Range, Text, action
from cityx.road.network.curves import FARTHEST, curve_faults


@action(
    "road/curve-v1",
    limits=["A curve is nothing to be seen: other actions build streets and the like on it."],
    gives=(Port("curve", "line", role="curve"),),
    labels=("draw", "sketch", "polyline", "points", "centreline"),
)
def curve(
    city: City,
    *,
    name: Annotated[str, Text(60)],
    points: Annotated[tuple[tuple[float, ...], ...], Points(), Range(-FARTHEST, FARTHEST)],
) -> City:
    """Draw a curve through points; one of the same name is replaced.

    Parameters
    ----------
    city
        City to draw it in.
    name
        Name by which other actions find it.
    points
        Points from start to end, metres east and north of the origin, and up if there are three
        numbers; the first again at the end closes the curve.
    """
    line = shapely.LineString([point[:2] for point in points])
    if faults := curve_faults(shapely.get_parts(line)):
        raise UsageError(" ".join(faults))
    row = make_table(
        "lines", [line], id=[stable_id(CURVE, name)], source=[name], kind=[CURVE], tags=["{}"]
    )
    return replace(
        city,
        layout=merged(city.layout, Layout(extent_of(shapely.get_coordinates(line)), lines=row)),
    )
