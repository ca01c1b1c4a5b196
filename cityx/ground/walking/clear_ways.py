"""Clear ways: where nothing may stand, by one rule for placing and for checking."""

from __future__ import annotations

from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.city.city import City
from cityx.city.ground import ROADWAY
from cityx.geometry.polylines import Polylines, line_strips, to_linestrings
from cityx.geometry.ranges import ranges

FloatArray = NDArray[np.float64]
WITHIN = 0.05  # metres a thing may reach over the edge of a lane before it counts


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
        reach = np.maximum(network.half_width - over, 0.0)
        lines = to_linestrings(network.lines)
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
