"""Open ground: what streets take with their walks, and the land that is left between things."""

from __future__ import annotations

from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.city import City

PATH = 2.0  # metres of a way whose width nobody knows


def ways_of(city: City, rows: NDArray[np.bool_], beyond: float) -> NDArray[Any]:
    """Return the ground of ways with their walks, widened by some metres, (k,) polygons.

    Parameters
    ----------
    city
        The city.
    rows
        (n,) which of its roads; those below the ground take none of it.
    beyond
        Metres beyond the walks.
    """
    roads = city.layout.roads
    kept = np.flatnonzero(rows & ~roads["tunnel"].to_numpy(bool))
    half = np.nan_to_num(roads["width"].to_numpy(float)[kept], nan=PATH) / 2
    walk = roads[["sidewalk_left", "sidewalk_right"]].max(axis=1).to_numpy(float)[kept]
    lines = roads.geometry.to_numpy()[kept]
    return np.asarray(
        shapely.buffer(lines, half + np.nan_to_num(walk) + beyond, cap_style="flat"), object
    )
