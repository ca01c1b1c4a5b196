"""Where shapes lie: near others, towards a side, the edge or the middle of a site."""

from __future__ import annotations

from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.checks.predicates import words
from cityx.geometry.arrays import BoolArray, FloatArray
from cityx.geometry.turns import SIDES


def is_near(shapes: NDArray[Any], places: NDArray[Any], within: float) -> BoolArray:
    """(n,) whether shapes lie within so many metres of one of some places."""
    found = np.zeros(len(shapes), bool)
    if len(shapes) and len(places):
        tree = shapely.STRtree(places)
        found[tree.query(shapes, predicate="dwithin", distance=within)[0]] = True
    return found


def is_on_side(shapes: NDArray[Any], places: NDArray[Any], side: str) -> BoolArray:
    """(n,) whether the middles of shapes lie on a side of the nearest of some places.

    That is where the way to them from the nearest point of it leads more to that side than to
    either one beside it: north of a river, on the west side of a street.
    """
    if not len(shapes) or not len(places):
        return np.zeros(len(shapes), bool)
    ways = shapely.shortest_line(shapely.union_all(places), shapely.centroid(shapes))
    ends = shapely.get_coordinates(ways).reshape(-1, 2, 2)
    x, y = (ends[:, 1] - ends[:, 0]).T
    ahead = x * SIDES[side][0] + y * SIDES[side][1]
    return np.asarray((ahead > 0) & (ahead >= np.hypot(x, y) * np.sqrt(0.5)))


def is_in_part(
    shapes: NDArray[Any], part: str, extent: tuple[float, float, float, float]
) -> BoolArray:
    """(n,) whether the middles of shapes lie in a part of a site, a word of `words.SITE_PARTS`."""
    least = words.PART.get(part, words.SIDE_PART)
    return np.asarray(nearness(shapely.centroid(shapes), part, extent) >= least)


def nearness(
    points: NDArray[Any], towards: str, extent: tuple[float, float, float, float]
) -> FloatArray:
    """Return how near points are to a side, the edge or the middle of a site, (n,), 0 to 1.

    Of a half it is that to its side.
    """
    xmin, ymin, xmax, ymax = extent
    x, y = shapely.get_coordinates(points).reshape(-1, 2).T
    east, north = (x - xmin) / (xmax - xmin), (y - ymin) / (ymax - ymin)
    away = np.hypot(2 * east - 1, 2 * north - 1) / np.sqrt(2)
    return np.asarray({
        "center": 1 - away, "edge": away, "east": east, "west": 1 - east, "north": north,
        "south": 1 - north,
    }[towards.removesuffix("_half")])  # fmt: skip
