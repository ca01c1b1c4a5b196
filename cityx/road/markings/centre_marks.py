"""Marks in the middle of Japanese junctions: a lozenge under signals, else a cross or a T."""

from __future__ import annotations

from typing import Any

import numpy as np
import shapely

from cityx.geometry.arrays import FloatArray, IntArray
from cityx.geometry.polylines import locate
from cityx.road.markings.marks import RANK, Shapes, Street
from cityx.road.network.junction_ways import JunctionWays, conflicts
from cityx.road.surface.carriageway import Carriageway, joined_by

LOZENGE, SLIT = (2.0, 1.0), 0.15  # metres, long and wide, and of the cross that parts it
CROSS, STROKE = 0.9, 0.15  # metres from the middle to the tips of a cross, and its strokes
LOZENGE_ARMS = 4  # more of them have no middle that all pass alike
MINOR = RANK.index("unclassified")  # roads that meet at a cross, and lower ones
LEAST_WIDTH = 3.5  # metres of the streets that meet at a cross
CROSS_ARMS = 4
ARMS = (3, CROSS_ARMS)  # of streets with a cross


def centre_marks(street: Street, ways: JunctionWays, road: Carriageway) -> Shapes:
    """Paint lozenges where ways cross under signals, and crosses where minor streets meet.

    Parameters
    ----------
    street, ways, road
        The network, the ways across its junctions, and its surfaces.
    """
    found = [*_lozenges(street, ways), *_crosses(street)]
    marks = np.array(found, object)
    inside = shapely.STRtree(road.stars).query(marks, predicate="covered_by")[0]
    return np.asarray(marks[np.unique(inside)])


def _lozenges(street: Street, ways: JunctionWays) -> list[Any]:
    found = []
    for hub in street.ruled_hubs[street.arms[street.ruled_hubs] == LOZENGE_ARMS].tolist():
        rows = np.flatnonzero(ways.hub == hub)
        own = ways.take(rows[np.argsort(street.rank[ways.edge[rows]], kind="stable")])
        middle = shapely.centroid(shapely.convex_hull(shapely.union_all(conflicts(own))))
        if shapely.is_empty(middle):
            continue
        begin = own.line.points[0]
        ahead = own.line.points[1] - begin
        found.append(_lozenge(shapely.get_coordinates(middle)[0], ahead / np.hypot(*ahead)))
    return found


def _lozenge(at: FloatArray, ahead: FloatArray) -> Any:
    aside = np.array([-ahead[1], ahead[0]])
    u, v = ahead * LOZENGE[0] / 2, aside * LOZENGE[1] / 2
    shape = shapely.Polygon(np.round([at + u, at + v, at - u, at - v], 3))
    slits = shapely.linestrings(np.stack([[at - 2 * u, at + 2 * u], [at - 2 * v, at + 2 * v]]))
    return shapely.difference(shape, shapely.union_all(shapely.buffer(slits, SLIT / 2)))


def minor_junctions(street: Street) -> IntArray:
    """Nodes at which three or four minor streets meet without signals."""
    network = street.network
    alone = np.bincount(street.cluster, minlength=len(street.cluster)) == 1
    plain = alone & street.joint & (street.best >= MINOR) & ~street.signalled
    narrow = np.zeros(len(plain), bool)
    narrow[network.edge_nodes[2 * network.half_width < LEAST_WIDTH]] = True
    degree = network.node_degree
    return np.flatnonzero(plain & ~narrow & np.isin(degree, ARMS))


def _crosses(street: Street) -> list[Any]:
    """Strokes from the middle of each junction of minor streets towards its arms."""
    network = street.network
    edge, end = np.nonzero(np.isin(network.edge_nodes, minor_junctions(street)))
    at = network.edge_nodes[edge, end].astype(np.int64)
    return list(_strokes(street, edge, end, at))


def _strokes(street: Street, edge: IntArray, end: IntArray, node: IntArray) -> Shapes:
    if not len(edge):
        return np.zeros(0, object)
    reach = np.minimum(street.network.trim[edge, end], street.length[edge] / 2)
    along = np.where(end == 0, reach, street.length[edge] - reach)
    far, _ = locate(street.lines, edge, along)
    middle = street.network.node_position[node]
    ahead = far - middle
    ahead = ahead / np.maximum(np.hypot(*ahead.T), 1e-9)[:, None]
    tips = np.round(np.stack([middle, middle + CROSS * ahead], axis=1), 3)
    strokes = shapely.buffer(shapely.linestrings(tips), STROKE / 2, cap_style="flat")
    return joined_by(strokes, node)[0]
