"""The road network: edges between junctions, with their cross-sections."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from cityx.geometry.polylines import Polylines


@dataclass(frozen=True)
class RoadNetwork:
    """Centreline graph of the carriageways, n nodes, e edges.

    Attributes
    ----------
    node_position
        (n, 2) float64.
    node_degree
        (n,) int32, number of carriageway arms.
    edge_nodes
        (e, 2) int32, start and end.
    edge_road
        (e,) int32, row of ``Layout.roads``.
    edge_id
        (e,) uint64, stable id of the edge.
    point_start
        (e + 1,) int64; edge i has the points ``points[point_start[i]:point_start[i + 1]]``.
    points
        (p, 2) float64, centrelines in the direction of the way.
    half_width
        (e,) float64, metres, after limiting by the clearance to facades.
    trim
        (e, 2) float64, metres from start and end where the junction surfaces begin.
    crossing
        (e, 2) bool, whether a zebra crossing lies at the start and end of the edge.
    left_hand
        (e,) bool, whether traffic keeps to the left.
    z
        (p,) float64, height of the carriageway at the points, metres; 0 until `road/heights`.
    lift
        (p,) float64, the same above the ground; negative in cuttings and tunnels.
    """

    node_position: NDArray[np.float64]
    node_degree: NDArray[np.int32]
    edge_nodes: NDArray[np.int32]
    edge_road: NDArray[np.int32]
    edge_id: NDArray[np.uint64]
    point_start: NDArray[np.int64]
    points: NDArray[np.float64]
    half_width: NDArray[np.float64]
    trim: NDArray[np.float64]
    crossing: NDArray[np.bool_]
    left_hand: NDArray[np.bool_]
    z: NDArray[np.float64]
    lift: NDArray[np.float64]

    @cached_property
    def lines(self) -> Polylines:
        """(e,) centrelines."""
        return Polylines(self.points, self.point_start)

    @property
    def edge_count(self) -> int:
        """Number of edges."""
        return len(self.edge_road)

    def edge_points(self, edge: int) -> NDArray[np.float64]:
        """(k, 2) centreline of one edge."""
        return self.points[self.point_start[edge] : self.point_start[edge + 1]]
