"""Crowns beside walls: clipped on that side, wide along the wall and to the light."""

from __future__ import annotations

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.city import City
from cityx.nature.trees.tree_room import FREE_LEAVES, TALLEST, Room, fitted

FloatArray = NDArray[np.float64]
BoolArray = NDArray[np.bool_]

ALONG = 1.8  # times as wide along a wall as towards it a crown is at most
CORNERS = 16  # of the outline by which a crown is held against walls


def crowded_by_walls(wide: FloatArray, size: FloatArray, room: Room) -> BoolArray:
    """(n,) whether crowns of a wished scale of width would reach a facade."""
    return np.asarray(wide * size[:, 1] > room.facade - FREE_LEAVES)


def fitted_crowns(
    city: City,
    xy: FloatArray,
    wished: FloatArray,
    size: FloatArray,
    room: Room,
    *,
    fixed: BoolArray,
    crowded: BoolArray,
) -> tuple[FloatArray, FloatArray]:
    """Fit crowns into their room, each side of them by itself where a wall is near.

    Parameters
    ----------
    city
        City with its buildings.
    xy
        (n, 2) float, trunks, metres.
    wished
        (n, 4) float: scale of height, of width, length of the crown over its breadth, and the turn
        about the stem in radians.
    size
        (n, 4) float, metres, as of `cityx.nature.trees.tree_room.fitted`.
    room
        Of the trees.
    fixed
        (n,) bool, trees whose height is mapped.
    crowded
        (n,) bool, trees that face a wall: their +x side turns to it.

    Returns
    -------
    scale, yaw
        (n, 3) and (n,) float.
    """
    tall, broad, aspect, yaw = wished.T
    up, wide = fitted(
        tall, broad * np.sqrt(np.maximum(aspect, 1 / aspect)), size, room, fixed=fixed
    )
    scale = np.column_stack([wide * np.minimum(1, aspect), wide / np.maximum(1, aspect), up])
    rows = np.flatnonzero(crowded)
    if not len(rows):
        return scale, yaw
    houses = city.layout.buildings.geometry.to_numpy()
    tree = shapely.STRtree(houses)
    spots = shapely.points(xy[rows])
    nearest = tree.query_nearest(spots, all_matches=False)[1]
    foot = shapely.get_coordinates(shapely.shortest_line(spots, houses[nearest])).reshape(-1, 2, 2)
    out = foot[:, 1] - foot[:, 0]
    yaw = yaw.copy()
    yaw[rows] = np.arctan2(out[:, 1], out[:, 0])
    _, reach, _, to_wall = size[rows].T
    deep = wide[rows]
    along = np.minimum(broad[rows], ALONG * deep)
    # What still meets another wall, as in a corner, is as narrow on all sides.
    outline = _outlines(xy[rows], yaw[rows], deep, along, reach, to_wall)
    met = np.unique(tree.query(outline, predicate="intersects")[0])
    least = np.minimum(deep, np.maximum(room.facade[rows] - FREE_LEAVES, 0.1) / reach)
    deep[met], along[met] = least[met], least[met]
    scale[rows] = np.column_stack([deep, along, np.minimum(up[rows], TALLEST * along)])
    return scale, yaw


def _outlines(
    xy: FloatArray,
    yaw: FloatArray,
    deep: FloatArray,
    along: FloatArray,
    reach: FloatArray,
    to_wall: FloatArray,
) -> NDArray[np.object_]:
    """(n,) polygons of crowns seen from above: half ellipses towards the wall and away from it."""
    angle = np.arange(CORNERS) * (2 * np.pi / CORNERS)
    ahead = np.where(np.cos(angle) > 0, to_wall[:, None], reach[:, None]) * np.cos(angle)
    x, y = deep[:, None] * ahead, (along * reach)[:, None] * np.sin(angle)  # (n, k)
    cos, sin = np.cos(yaw)[:, None], np.sin(yaw)[:, None]
    turned = np.stack([cos * x - sin * y, sin * x + cos * y], axis=2)
    return np.asarray(shapely.polygons(xy[:, None, :] + turned))
