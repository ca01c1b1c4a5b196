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
from cityx.city.passage import FREE, crowding
from cityx.geometry.polylines import Polylines, line_strips
from cityx.geometry.ranges import ranges

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]
LET_PASS = 2  # pieces of which a small map has few
CROWDED = 0.05  # share of the things on walks that may leave less, as in corners of yards
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
