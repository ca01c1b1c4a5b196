"""Box junction markings: hatching where the paths of traffic cross at signals, to be kept free.

References
----------
Department for Transport, "Traffic Signs Manual", chapter 5, 2019, section 8: a box covers what
standing traffic would block, and no more.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import shapely

from cityx.city.ground import LABEL, SURFACES
from cityx.city.roads import RoadNetwork
from cityx.geometry.arrays import FloatArray
from cityx.ground.arrangement import Regions, regions
from cityx.road.markings.marks import CLASSIFIED, Street, rimmed
from cityx.road.network.junction_ways import JunctionWays, conflicts
from cityx.road.surface.carriageway import Carriageway

LEAST_ARMS = 3  # of classified roads that meet at signals
INSET = 0.4  # metres from the rim of the junction
HALF_LANE = 1.7  # metres to either side of a way that the box covers where two cross
LINE, SPACING = 0.2, 2.5  # metres (TSRGD 2016, diagram 1043)
AREA = (15.0, 600.0)  # square metres
BLUNT = 0.5  # metres by which the outline may be simplified


def box_junctions(street: Street, ways: JunctionWays, road: Carriageway) -> Regions:
    """Hatch where ways cross in junctions under signals in which classified roads meet."""
    network = street.network
    cluster, ruled = street.cluster, street.ruled_hubs
    classified = np.bincount(cluster[network.edge_nodes[street.rank <= CLASSIFIED]].ravel(),
                             minlength=len(network.node_position))  # fmt: skip
    shapes = []
    for hub in ruled[classified[ruled] >= LEAST_ARMS].tolist():
        star = np.flatnonzero(road.node == hub)
        rows = np.flatnonzero(ways.hub == hub)
        if len(star) and len(rows):
            area = _crossed(ways.take(rows), road.stars[star[0]])
            if AREA[0] < area.area < AREA[1]:
                shapes.append(_box(area, _direction(network, cluster == hub)))
    label = LABEL["marking_yellow"]
    return regions(np.array(shapes, object), label, SURFACES[label].priority)


def _crossed(ways: JunctionWays, star: Any) -> Any:
    """Hull of the places where ways from different arms into different ones cross."""
    about = shapely.buffer(conflicts(ways), HALF_LANE, cap_style="square")
    hull = shapely.simplify(shapely.convex_hull(shapely.union_all(about)), BLUNT)
    free = shapely.buffer(star, -INSET, join_style="mitre")
    # Without the necks that a hull leaves in the mouths of arms.
    shape = shapely.buffer(shapely.intersection(hull, free), -INSET, join_style="mitre")
    shape = shapely.intersection(shapely.buffer(shape, INSET, join_style="mitre"), free)
    parts = shapely.get_parts(shape)
    return parts[np.argmax(shapely.area(parts))] if len(parts) else shape


def _direction(network: RoadNetwork, nodes: Any) -> FloatArray:
    """Return the unit vector along the widest road that meets at some nodes."""
    edge = np.flatnonzero(nodes[network.edge_nodes].any(axis=1))
    widest = int(edge[np.argmax(network.half_width[edge])])
    ends = network.node_position[network.edge_nodes[widest]]
    step = ends[1] - ends[0]
    return np.asarray(step / max(float(np.hypot(*step)), 1e-9))


def _box(shape: Any, along: FloatArray) -> Any:
    """Rim and crossed bars of one box, at 45 degrees to the road."""
    turn = np.sqrt(0.5) * np.array([[1.0, -1.0], [1.0, 1.0]])
    return rimmed(shape, [turn @ along, turn.T @ along], SPACING, LINE, rim=LINE)
