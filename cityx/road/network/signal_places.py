"""Where signals rule: points of the map, and crossings that have signals of their own."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import shapely

from cityx.ground.walking.mapped_crossings import SIGNALLED

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from cityx.city.layout import Layout

COMPANY = 35.0  # metres; a crossing with no other signal so near stands between junctions


def signal_rows(layout: Layout) -> tuple[NDArray[np.int64], NDArray[np.bool_]]:
    """Find the points that are signals, or crossings under signals.

    Returns
    -------
    rows, joint
        (k,) rows of the points, and whether each may rule a junction: a crossing with no other
        near rules itself alone.
    """
    points = layout.points
    kind = points["kind"].to_numpy().astype(str)
    found = kind == "traffic_signals"
    crossing = np.flatnonzero(kind == "crossing")
    told = points["tags"].iloc[crossing].str.contains(SIGNALLED, regex=True)
    found[crossing[told.to_numpy().astype(bool)]] = True
    rows = np.flatnonzero(found)
    places = points.geometry.to_numpy()[rows]
    near = shapely.STRtree(places).query(places, predicate="dwithin", distance=COMPANY)[0]
    several = np.bincount(near, minlength=len(rows)) > 1
    return rows, (kind[rows] == "traffic_signals") | several


def signal_places(layout: Layout) -> NDArray[Any]:
    """(k,) points that rule junctions."""
    rows, joint = signal_rows(layout)
    return np.asarray(layout.points.geometry.to_numpy()[rows[joint]])
