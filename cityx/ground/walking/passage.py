"""Clearance on walks: where nothing may stand, and what things leave for pedestrians."""

from __future__ import annotations

from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.city.city import City
from cityx.city.ground import ROADWAY
from cityx.geometry.arrays import FloatArray, IntArray
from cityx.geometry.polylines import Polylines, line_strips, to_linestrings
from cityx.geometry.probes import nearest_on, segments_of, way_to
from cityx.geometry.ranges import ranges
from cityx.ground.arrangement import BEYOND

WALKS = ("sidewalk", "kerb", "plaza", "path", "courtyard", "trail", "furnishing", "gravel",
         "edging", "frontage")  # fmt: skip
FREE = 1.2  # metres of walk that a wheelchair and a passer-by need
BORDER = 3.0  # metres from the site's rectangle, which cuts walks lengthwise
LOOK = 12.0  # metres to each side of a thing that the walk is followed
ON = 1e-4  # metres from an edge within which a thing stands on it
WITHIN = 0.05  # metres a thing may reach over the edge of a lane before it counts


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
    if not len(rows) or not len(ends):
        return rows, np.zeros(len(rows), bool)
    rim = segments_of(shapely.linestrings(ends))
    away = xy[rows] - nearest_on(rim, xy[rows])
    size = np.hypot(*away.T)
    away = np.where(size[:, None] > 0.02, away / np.maximum(size, 1e-9)[:, None], [1.0, 0.0])
    low = -way_to(rim, xy[rows], -away, LOOK)
    high = ON + way_to(rim, xy[rows] + ON * away, away, LOOK)  # what it stands on is behind it
    across = shapely.linestrings(
        np.stack([xy[rows] + low[:, None] * away, xy[rows] + high[:, None] * away], axis=1)
    )
    # Every thing on the line takes its own stretch of it.
    line, thing = shapely.STRtree(outlines).query(across, predicate="intersects")
    cut = _stretches(outlines[thing], xy[rows][line], away[line])
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


def _stretches(shapes: NDArray[Any], origin: FloatArray, axis: FloatArray) -> FloatArray:
    """(n, 2) metres along unit vectors from origins between which shapes lie."""
    if not len(shapes):
        return np.zeros((0, 2))
    points, row = shapely.get_coordinates(shapes, return_index=True)
    along = ((points - origin[row]) * axis[row]).sum(axis=1)
    first = np.flatnonzero(np.diff(row, prepend=-1))
    return np.column_stack([np.minimum.reduceat(along, first), np.maximum.reduceat(along, first)])


def in_lanes(
    city: City, outlines: NDArray[Any], xy: FloatArray, *, over: float = 0.0
) -> NDArray[np.bool_]:
    """(n,) whether things reach into a lane or a carriageway, or stand on one.

    Parameters
    ----------
    city
        Its ground, lanes and network count, as far as they are there.
    outlines, xy
        (n,) polygons of things as they stand, of `city.thing_outlines`, and (n, 2) their places,
        metres.
    over
        Metres that they may reach over the edge.
    """
    found = np.zeros(len(xy), bool)
    if not len(xy):
        return found
    if city.ground is not None:
        found |= city.ground.on(xy, *ROADWAY)
    tree = shapely.STRtree(outlines)
    found[tree.query(_lane_strips(city, over), predicate="intersects")[1]] = True
    network = city.network
    if network is not None and network.edge_count:
        above = ~city.layout.roads["tunnel"].to_numpy(bool)[network.edge_road]
        reach = np.maximum(network.half_width - over, 0.0)[above]
        lines = to_linestrings(network.lines)[above]
        found[tree.query(lines, predicate="dwithin", distance=reach)[1]] = True
    return found


def _lane_strips(city: City, over: float) -> NDArray[Any]:
    """Lanes in the open on the ground, as polygons with mitred corners, `over` metres narrower."""
    lanes, network = city.lanes, city.network
    if lanes is None or not lanes.count:
        return np.zeros(0, object)
    rows = np.flatnonzero(lanes.travelled & (np.diff(lanes.point_start) >= 2))
    if network is not None:
        roads = city.layout.roads
        open_air = (roads["layer"].to_numpy() == 0) & ~roads["tunnel"].to_numpy(bool)
        open_air &= ~roads["bridge"].to_numpy(bool)
        rows = rows[open_air[network.edge_road[lanes.edge[rows]]]]
    width = np.round(np.maximum((lanes.left - lanes.right)[rows] - 2 * over, 0.1), 2)
    found = [np.zeros(0, object)]
    for wide in np.unique(width).tolist():
        index, start = ranges(lanes.point_start, rows[width == wide])
        lines = Polylines(lanes.points[index], start)
        found.append(line_strips(lines, np.zeros(lines.count), wide))
    strips = np.concatenate(found)
    return np.asarray(strips[shapely.is_valid(strips)])
