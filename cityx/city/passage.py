"""Passage: the room that things standing on a walk leave to who passes."""

from __future__ import annotations

from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.city.city import City
from cityx.geometry.arrangement import BEYOND

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]
WALKS = ("sidewalk", "kerb", "plaza", "path", "courtyard", "trail", "furnishing", "gravel",
         "edging", "frontage")  # fmt: skip
FREE = 1.2  # metres of walk that a wheelchair and a passer-by need
BORDER = 3.0  # metres from the site's rectangle, which cuts walks lengthwise
LOOK = 12.0  # metres to each side of a thing that the walk is followed


def crowding(
    city: City, outlines: NDArray[Any], xy: FloatArray, asked: NDArray[np.bool_] | None = None
) -> tuple[IntArray, NDArray[np.bool_]]:
    """Return the rows of things on walks, and whether less than `FREE` metres are left beside each.

    Parameters
    ----------
    city
        City with its ground.
    outlines, xy
        (n,) polygons of things as they stand, and (n, 2) their places, metres.
    asked
        (n,) those to be looked at, all if None; the others stand in the way as well.

    Notes
    -----
    Through the middle of each thing a line is laid square to the nearest edge of the walk. What of
    it lies on the walk and in no thing is free; the longest free piece counts.
    """
    ground = city.ground
    assert ground is not None
    walk = ground.labelled(*WALKS)
    xmin, ymin, xmax, ymax = city.layout.extent
    edge = np.minimum(xy - [xmin, ymin], np.array([xmax, ymax]) - xy).min(axis=1)
    rows = np.flatnonzero((edge > BORDER) if asked is None else (edge > BORDER) & asked)
    rows = rows[ground.on(xy[rows], *WALKS)]
    left, right = ground.edge_faces.T.astype(np.int64)
    beyond = np.where(right == BEYOND, False, walk[np.maximum(right, 0)])
    ends = ground.vertices[ground.edges[walk[left] != beyond]]  # (r, 2, 2)
    rims = shapely.linestrings(ends)
    if not len(rows) or not len(rims):
        return rows, np.zeros(len(rows), bool)
    spots = shapely.points(xy[rows])
    tree = shapely.STRtree(rims)
    near = tree.query_nearest(spots, all_matches=False)[1]
    foot = shapely.get_coordinates(
        shapely.line_interpolate_point(rims[near], shapely.line_locate_point(rims[near], spots))
    )
    away = xy[rows] - foot
    size = np.hypot(*away.T)
    away = np.where(size[:, None] > 0.02, away / np.maximum(size, 1e-9)[:, None], [1.0, 0.0])
    across = shapely.linestrings(np.stack([xy[rows] - LOOK * away, xy[rows] + LOOK * away], axis=1))
    line, rim = tree.query(across, predicate="intersects")
    at = _met(ends[rim] - xy[rows][line][:, None], away[line])
    low, high = np.full(len(rows), -LOOK), np.full(len(rows), LOOK)
    np.maximum.at(low, line[at <= 0], at[at <= 0])
    np.minimum.at(high, line[at > 0], at[at > 0])
    # Every thing on the line takes its own stretch of it.
    line, thing = shapely.STRtree(outlines).query(across, predicate="intersects")
    cut = shapely.bounds(_along(outlines[thing], xy[rows][line], away[line]))[:, [0, 2]]
    inside = (cut[:, 1] > low[line]) & (cut[:, 0] < high[line])
    line, cut = line[inside], cut[inside]
    order = np.lexsort((cut[:, 0], line))
    line, cut = line[order], cut[order]
    free = np.zeros(len(rows))
    reached = low.copy()
    # The things on one line are few: the k-th of every line at once.
    number = np.arange(len(line)) - np.searchsorted(line, line)
    for k in range(int(number.max(initial=-1)) + 1):
        of = np.flatnonzero(number == k)
        row = line[of]
        free[row] = np.maximum(free[row], cut[of, 0] - reached[row])
        reached[row] = np.maximum(reached[row], cut[of, 1])
    free = np.maximum(free, high - reached)
    return rows, free < FREE


def _met(ends: FloatArray, way: FloatArray) -> FloatArray:
    """(n,) metres along unit vectors from the origin at which segments, (n, 2, 2), are met.

    Of a segment that lies along the way it is the middle of what is within `LOOK`.
    """
    ahead = (ends * way[:, None]).sum(axis=2)  # (n, 2)
    aside = ends[..., 1] * way[:, None, 0] - ends[..., 0] * way[:, None, 1]
    across = aside[:, 0] - aside[:, 1]
    along = np.abs(across) < 1e-9
    share = aside[:, 0] / np.where(along, 1.0, across)
    middle = np.clip(ahead, -LOOK, LOOK).mean(axis=1)
    return np.where(along, middle, ahead[:, 0] + share * (ahead[:, 1] - ahead[:, 0]))


def _along(shapes: NDArray[Any], origin: FloatArray, axis: FloatArray) -> NDArray[Any]:
    """Turn (n,) shapes about their own origins so that their own axes point along x."""
    points, row = shapely.get_coordinates(shapes, return_index=True)
    p = points - origin[row]
    u = axis[row]
    turned = np.column_stack([(p * u).sum(axis=1), p[:, 1] * u[:, 0] - p[:, 0] * u[:, 1]])
    return np.asarray(shapely.polygons(shapely.linearrings(turned, indices=row)))
