"""Curves drawn into a city that exists, for others to go along or to build on, and taken out."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated

import numpy as np

from cityx.city.city import City
from cityx.city.layout import CURVE
from cityx.errors import ActionFailed, nearest
from cityx.protocol import Points, Port, Range, Text, action
from cityx.road.network.curve import curve
from cityx.road.network.curves import FARTHEST


@action(
    "edit/draw_curve-v1",
    limits=["A curve is nothing to be seen; who goes along one of the same name keeps the old."],
    gives=(Port("curve", "line", role="curve"),),
    labels=("draw", "path", "curve", "route"),
)
def draw_curve(
    city: City,
    *,
    name: Annotated[str, Text(60)],
    points: Annotated[tuple[tuple[float, ...], ...], Points(), Range(-FARTHEST, FARTHEST)],
) -> City:
    """Draw a curve through points at any time; one of the same name is replaced.

    Parameters
    ----------
    city
        The city.
    name
        Name by which commands find it: "let a woman walk along path 1".
    points
        Points from start to end, metres east and north of the origin, and up if there are three
        numbers; the first again at the end closes the curve.
    """
    return curve(city, name=name, points=points)


@action(
    "edit/erase_curve-v1",
    limits=["Who goes along the curve, and what is built on it, stays."],
    labels=("erase", "delete", "path", "curve"),
)
def erase_curve(city: City, *, name: Annotated[str, Text(60)]) -> City:
    """Take a curve out of the city.

    Parameters
    ----------
    city
        The city.
    name
        Name of the curve.
    """
    lines = city.layout.lines
    curves = lines["kind"].to_numpy() == CURVE
    gone = curves & (lines["source"].to_numpy() == name)
    if not gone.any():
        raise ActionFailed(
            f'The city has no curve "{name}".{nearest(name, lines["source"][curves].tolist())}'
        )
    kept = lines.iloc[np.flatnonzero(~gone)].reset_index(drop=True)
    return replace(city, layout=replace(city.layout, lines=kept))
