"""Triangles of things within bounds, taken out of the trees of a scenery."""

from __future__ import annotations

from typing import Any

import numpy as np

from cityx.geometry.bvh import DEEP, SCALE
from cityx.geometry.compiled import compiled


@compiled
def within(
    box: Any, child: Any, corner: Any, way: Any, cluster_thing: Any, cluster_node: Any,
    wanted: Any, bounds: Any, found: Any, row: Any,
) -> int:  # fmt: skip
    """Write triangles of wanted things that reach into bounds; things that are only shifted.

    Parameters
    ----------
    box, child, corner, way, cluster_thing, cluster_node
        Of `cityx.sim.scenery.Scenery`.
    wanted
        (n,) bool, by thing.
    bounds
        (4,) west, south, east, north, metres.
    found, row
        (k, 3, 3) float64 and (k, 2) int64, to be written: corners in the frame of the city, and
        thing and triangle.

    Returns
    -------
    count
        How many there are; only the first k are written.
    """
    stack = np.empty(2 * DEEP, np.int64)
    count = 0
    for cluster in range(len(cluster_thing)):
        thing = cluster_thing[cluster]
        if not wanted[thing]:
            continue
        x, y, z = way[thing, 0, 3], way[thing, 1, 3], way[thing, 2, 3]
        stack[0] = cluster_node[cluster]
        waiting = 1
        while waiting:
            waiting -= 1
            node = stack[waiting]
            if node >= 0:
                for side in range(2):
                    at = 6 * side
                    if (
                        box[node, at] + x <= bounds[2] and box[node, at + 3] + x >= bounds[0]
                        and box[node, at + 1] + y <= bounds[3]
                        and box[node, at + 4] + y >= bounds[1]
                    ):  # fmt: skip
                        stack[waiting] = child[node, side]
                        waiting += 1
                continue
            code = -1 - node
            for t in range(code // SCALE, code // SCALE + code % SCALE):
                if count < len(found):
                    for k in range(3):
                        found[count, k, 0] = corner[t, k, 0] + x
                        found[count, k, 1] = corner[t, k, 1] + y
                        found[count, k, 2] = corner[t, k, 2] + z
                    row[count, 0], row[count, 1] = thing, t
                count += 1
    return count
