"""Checks of street furniture: nothing in a lane, and a way past everything on a walk.

Both are measured from what stands in the scene: the outlines of the prototypes as they are placed,
the lanes of the lane graph, and the faces of the ground.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.checks.check import Check, named
from cityx.city import City
from cityx.city.ground import ROADWAY
from cityx.city.outlines import placed_outlines
from cityx.geometry.arrangement import BEYOND
from cityx.geometry.polylines import Polylines, line_strips
from cityx.geometry.ranges import ranges

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]
WALKS = ("sidewalk", "kerb", "plaza", "path", "courtyard", "trail", "furnishing")
FREE = 1.2  # metres of walk that a wheelchair and a passer-by need
LET_PASS = 2  # pieces of which a small map has few
CROWDED = 0.05  # share of the things on walks that may leave less, as in corners of yards
BORDER = 3.0  # metres from the site's rectangle, which cuts walks lengthwise
LOOK = 12.0  # metres to each side of a thing that the walk is followed
WITHIN = 0.05  # metres a thing may reach over the edge of a lane before it counts


def check_furniture(city: City) -> list[Check]:
    """Run both checks; none where nothing stands."""
    outlines, xy, ids = placed_outlines(city.scene)
    if not len(outlines) or city.ground is None:
        return []
    rows, tight = crowding(city, outlines, xy)
    # What the map shows stands where the map has it.
    tight = tight[~np.isin(ids[rows], city.layout.points["id"].to_numpy())]
    crowded = max(int(tight.sum()) - LET_PASS, 0)
    hindering = in_lanes(city, outlines, xy)
    return [
        Check("furniture_in_lanes", float(hindering.sum()), 0,
              "pieces of furniture whose outline reaches into a lane or a carriageway",
              ids=named(ids[hindering])),
        Check("furniture_on_walkway", crowded / max(len(tight), 1), CROWDED,
              f"share of the pieces on walks that leave less than {FREE} m to pass, "
              f"{LET_PASS} let pass"),
    ]  # fmt: skip


def in_lanes(city: City, outlines: NDArray[Any], xy: FloatArray) -> NDArray[np.bool_]:
    """(n,) whether things reach into a lane, or stand on a carriageway."""
    ground, lanes = city.ground, city.lanes
    assert ground is not None
    found = ground.on(xy, *ROADWAY)
    if lanes is not None and lanes.count:
        rows = np.flatnonzero(lanes.travelled & (np.diff(lanes.point_start) >= 2))
        level = city.layout.roads["layer"].to_numpy() == 0
        open_air = level & ~city.layout.roads["tunnel"].to_numpy()
        open_air &= ~city.layout.roads["bridge"].to_numpy()
        if city.network is not None:
            rows = rows[open_air[city.network.edge_road[lanes.edge[rows]]]]
        index, start = ranges(lanes.point_start, rows)
        width = (lanes.left - lanes.right)[rows]
        lines = Polylines(lanes.points[index], start)
        for wide in np.unique(np.round(width, 2)):
            of = np.flatnonzero(np.round(width, 2) == wide)
            strips = line_strips(lines, np.zeros(lines.count), max(wide - 2 * WITHIN, 0.1))[of]
            strips = strips[shapely.is_valid(strips)]
            found[shapely.STRtree(strips).query(outlines, predicate="intersects")[0]] = True
    return np.asarray(found)


def crowding(
    city: City, outlines: NDArray[Any], xy: FloatArray
) -> tuple[IntArray, NDArray[np.bool_]]:
    """Return the rows of things on walks, and whether less than `FREE` metres are left beside each.

    Through the middle of each thing a line is laid square to the nearest edge of the walk. What of
    it lies on the walk and in no thing is free; the longest free piece counts.
    """
    ground = city.ground
    assert ground is not None
    walk = ground.labelled(*WALKS)
    on_walk = ground.on(xy, *WALKS)
    xmin, ymin, xmax, ymax = city.layout.extent
    edge = np.minimum(xy - [xmin, ymin], np.array([xmax, ymax]) - xy).min(axis=1)
    rows = np.flatnonzero(on_walk & (edge > BORDER))
    left, right = ground.edge_faces.T.astype(np.int64)
    beyond = np.where(right == BEYOND, False, walk[np.maximum(right, 0)])
    rims = shapely.linestrings(ground.vertices[ground.edges[walk[left] != beyond]])
    if not len(rows) or not len(rims):
        return rows, np.zeros(len(rows), bool)
    spots = shapely.points(xy[rows])
    near = shapely.STRtree(rims).query_nearest(spots, all_matches=False)[1]
    foot = shapely.get_coordinates(
        shapely.line_interpolate_point(rims[near], shapely.line_locate_point(rims[near], spots))
    )
    away = xy[rows] - foot
    size = np.hypot(*away.T)
    away = np.where(size[:, None] > 0.02, away / np.maximum(size, 1e-9)[:, None], [1.0, 0.0])
    across = shapely.linestrings(np.stack([xy[rows] - LOOK * away, xy[rows] + LOOK * away], axis=1))
    line, rim = shapely.STRtree(rims).query(across, predicate="intersects")
    met = shapely.get_coordinates(shapely.centroid(shapely.intersection(across[line], rims[rim])))
    at = ((met - xy[rows][line]) * away[line]).sum(axis=1)
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


def _along(shapes: NDArray[Any], origin: FloatArray, axis: FloatArray) -> NDArray[Any]:
    """Turn (n,) shapes about their own origins so that their own axes point along x."""
    points, row = shapely.get_coordinates(shapes, return_index=True)
    p = points - origin[row]
    u = axis[row]
    turned = np.column_stack([(p * u).sum(axis=1), p[:, 1] * u[:, 0] - p[:, 0] * u[:, 1]])
    return np.asarray(shapely.polygons(shapely.linearrings(turned, indices=row)))
