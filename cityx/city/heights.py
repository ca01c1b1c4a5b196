"""Heights of ways that leave the ground: bridges and their ramps, cuttings and tunnels."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.geometry.polylines import Polylines, to_linestrings, values_along
from cityx.geometry.ranges import ranges

BESIDE = 2.0  # metres beside what is travelled that things of a way stand in


@dataclass(frozen=True)
class WayHeights:
    """Pieces of ways off the ground, w of them, with p stations together.

    Attributes
    ----------
    road
        (w,) int32, row of ``Layout.roads``.
    edge
        (w,) int32, edge of the road network; -1 for paths and tracks.
    begin, end
        (w,) float64, metres along the edge, or along what lies of the way in the site, at which
        the piece begins and ends.
    level
        (w,) int16, which ways pass over which: 0 is the ground's own.
    point_start
        (w + 1,) int64; piece i has the stations ``point_start[i]:point_start[i + 1]``.
    points
        (p, 2) float64, centrelines, metres.
    z
        (p,) float64, height of the way's surface, metres.
    ground
        (p,) float64, height of the ground there, metres.
    half_width
        (w,) float64, half the width that is travelled, metres.
    """

    road: NDArray[np.int32]
    edge: NDArray[np.int32]
    begin: NDArray[np.float64]
    end: NDArray[np.float64]
    level: NDArray[np.int16]
    point_start: NDArray[np.int64]
    points: NDArray[np.float64]
    z: NDArray[np.float64]
    ground: NDArray[np.float64]
    half_width: NDArray[np.float64]

    @cached_property
    def lines(self) -> Polylines:
        """(w,) centrelines of the pieces."""
        return Polylines(self.points, self.point_start)

    @property
    def count(self) -> int:
        """Number of pieces."""
        return len(self.road)

    def z_at(self, xy: NDArray[np.float64]) -> NDArray[np.float64]:
        """(n,) height of the nearest piece beside which (n, 2) places lie, NaN beside none."""
        found = np.full(len(xy), np.nan)
        if not self.count or not len(xy):
            return found
        lines, spots = to_linestrings(self.lines), shapely.points(xy)
        spot, piece = shapely.STRtree(lines).query_nearest(
            spots, max_distance=float(self.half_width.max()) + BESIDE
        )
        first = np.unique(spot, return_index=True)[1]  # ties go to the first piece
        spot, piece = spot[first], piece[first]
        near = shapely.distance(lines[piece], spots[spot]) <= self.half_width[piece] + BESIDE
        spot, piece = spot[near], piece[near]
        along = shapely.line_locate_point(lines[piece], spots[spot])
        found[spot] = values_along(self.lines, self.z, piece, along)
        return found

    def take(self, rows: NDArray[np.int64]) -> WayHeights:
        """Return the given pieces."""
        points, start = ranges(self.point_start, rows)
        return WayHeights(
            self.road[rows], self.edge[rows], self.begin[rows], self.end[rows], self.level[rows],
            start, self.points[points], self.z[points], self.ground[points], self.half_width[rows],
        )  # fmt: skip

    @property
    def lift(self) -> NDArray[np.float64]:
        """(p,) height above the ground, metres; negative in cuttings and tunnels."""
        return self.z - self.ground


def no_heights() -> WayHeights:
    """Return the heights of a site where every way lies on the ground."""
    none = np.zeros(0)
    return WayHeights(
        none.astype(np.int32), none.astype(np.int32), none, none, none.astype(np.int16),
        np.zeros(1, np.int64), np.zeros((0, 2)), none, none, none,
    )  # fmt: skip
