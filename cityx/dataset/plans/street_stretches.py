"""Streets as lines on which the places of a plan are spread evenly."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely

from cityx.city.roads import RoadNetwork
from cityx.geometry.arrays import FloatArray, IntArray
from cityx.geometry.polylines import Polylines, arc_lengths, locate
from cityx.geometry.scatter import nearby_order

ON_THE_GROUND = 0.3  # metres of lift up to which a street counts as lying on the ground


@dataclass(frozen=True)
class Stations:
    """Lines one after the other, neighbours together, so that one number names a place on them.

    Attributes
    ----------
    lines
        All lines.
    order
        (k,) lines that count, in the order in which they follow each other.
    reach
        (k + 1,) metres from the beginning of the first to that of each.
    """

    lines: Polylines
    order: IntArray
    reach: FloatArray

    @property
    def length(self) -> float:
        """Metres of all lines together."""
        return float(self.reach[-1])

    def at(self, share: FloatArray) -> tuple[IntArray, FloatArray]:
        """Return the line and the metres along it of (n,) shares of the whole length."""
        place = np.asarray(share) * self.length
        row = np.clip(np.searchsorted(self.reach, place, side="right") - 1, 0, len(self.order) - 1)
        return self.order[row], place - self.reach[row]


def stations(lines: Polylines, rows: IntArray) -> Stations:
    """Put some of the lines one after the other.

    Parameters
    ----------
    lines
        The lines.
    rows
        (k,) those that count.
    """
    length = arc_lengths(lines)[1][rows] if len(rows) else np.zeros(0)
    middle = locate(lines, rows, length / 2)[0] if len(rows) else np.zeros((0, 2))
    order = nearby_order(middle)
    return Stations(lines, rows[order], np.concatenate([[0.0], np.cumsum(length[order])]))


def street_lines(
    network: RoadNetwork, extent: tuple[float, float, float, float]
) -> tuple[Polylines, IntArray]:
    """Return the centrelines of a network, and which of them lie on the ground and on the site."""
    lines = network.lines
    if not network.edge_count:
        return lines, np.zeros(0, np.int64)
    lift = np.maximum.reduceat(np.abs(network.lift), network.point_start[:-1])
    length = arc_lengths(lines)[1]
    middle = locate(lines, np.arange(lines.count), length / 2)[0]
    inside = shapely.contains_xy(shapely.box(*extent), middle[:, 0], middle[:, 1])
    return lines, np.flatnonzero((lift < ON_THE_GROUND) & inside & (length > 1.0))
