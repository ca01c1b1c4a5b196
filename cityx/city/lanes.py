"""The lane graph: the bands of every edge of the road network, and what leads into what."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from cityx.city.section import KIND, TRAVELLED
from cityx.geometry.polylines import Polylines

MOVEMENTS = ("left", "through", "right", "reverse")


@dataclass(frozen=True)
class LaneGraph:
    """Lanes of a road network, l of them, and c connections between them.

    A lane that is driven in both directions is two lanes in the same place.

    Attributes
    ----------
    edge
        (l,) int32, edge of the network.
    kind
        (l,) uint8 into `cityx.city.section.BAND_KINDS`.
    direction
        (l,) int8, 1 along the edge, -1 against it, 0 where nothing moves along.
    left, right
        (l,) float64, metres from the centreline to the lane's sides, positive to the left of the
        edge; ``left > right``.
    turns
        (l,) uint8, bits of `cityx.city.section.TURN` of the map, 0 when it says nothing.
    speed
        (l,) float32, km/h.
    lane_id
        (l,) uint64, stable.
    point_start, points
        (l + 1,) int64 and (p, 2) float64: middle of each lane from one junction to the next, in the
        direction of travel.
    connection
        (c, 2) int32, from lane and to lane.
    movement
        (c,) uint8 into `MOVEMENTS`.
    curve_start, curve
        (c + 1,) int64 and (q, 2) float64: the way across the junction.
    """

    edge: NDArray[np.int32]
    kind: NDArray[np.uint8]
    direction: NDArray[np.int8]
    left: NDArray[np.float64]
    right: NDArray[np.float64]
    turns: NDArray[np.uint8]
    speed: NDArray[np.float32]
    lane_id: NDArray[np.uint64]
    point_start: NDArray[np.int64]
    points: NDArray[np.float64]
    connection: NDArray[np.int32]
    movement: NDArray[np.uint8]
    curve_start: NDArray[np.int64]
    curve: NDArray[np.float64]

    @cached_property
    def lines(self) -> Polylines:
        """(l,) middles of the lanes."""
        return Polylines(self.points, self.point_start)

    @property
    def count(self) -> int:
        """Number of lanes."""
        return len(self.edge)

    @property
    def travelled(self) -> NDArray[np.bool_]:
        """(l,) whether something moves along the lane."""
        return np.isin(self.kind, [KIND[name] for name in TRAVELLED])

    def lane_points(self, lane: int) -> NDArray[np.float64]:
        """(k, 2) middle of one lane, in the direction of travel."""
        return self.points[self.point_start[lane] : self.point_start[lane + 1]]
