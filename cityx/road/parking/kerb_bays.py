"""Lanes of parked cars along kerbs: where they begin and end, and the places in them.

References
----------
Straßenverkehrs-Ordnung, § 12: nobody parks within 5 m of where the kerbs of two streets would meet.
Traffic Signs Regulations and General Directions 2016, diagram 1028.4: bays have a broken outline.
Richtlinien für die Markierung von Straßen, part 1: thin lines along lanes of parked cars.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from cityx.city.section import KIND
from cityx.geometry.arrays import FloatArray, IntArray
from cityx.geometry.polylines import arc_lengths, line_strips, pieces
from cityx.geometry.ranges import numbered
from cityx.road.markings.marks import Marks, boxes, together

if TYPE_CHECKING:
    from cityx.city.roads import RoadNetwork
    from cityx.geometry.polylines import Polylines
    from cityx.road.network.sections import Bands


BAY = 5.5  # metres of kerb per car
FROM_JUNCTION = 2.0  # metres behind the curve of a kerb, which is 3 m long and more
FROM_CROSSING = (
    5.2  # metres where a crossing lies there, which ends 4.5 m behind the junction at most
)
FROM_JOINT = 0.3  # metres where a street merely goes on
# Metres of breadth: of lines between stalls, along rows of bays, and broken ones round them.
STALL, LINE, OUTLINE = 0.12, 0.10, 0.06
DASHES = (0.6, 0.3)  # metres of dash and gap of an outline
INSET = 0.05  # metres from the kerb to the end of a line


@dataclass(frozen=True)
class Runs:
    """r stretches of parking lanes in which cars stand.

    Attributes
    ----------
    edge
        (r,) int64.
    low, high
        (r,) float, metres along the edge.
    kerb, road
        (r,) float, metres left of the centreline to the outer and the inner edge of the lane.
    """

    edge: IntArray
    low: FloatArray
    high: FloatArray
    kerb: FloatArray
    road: FloatArray

    @property
    def side(self) -> IntArray:
        """(r,) +1 left of the edge's direction, -1 right."""
        return np.where(self.kerb > self.road, 1, -1)

    def bays(self) -> tuple[IntArray, IntArray, FloatArray]:
        """Return the run of each bay, its number in the run, and metres along to its middle."""
        count = np.floor((self.high - self.low) / BAY + 1e-9).astype(np.int64)
        run = np.repeat(np.arange(len(count)), count)
        number = numbered(count)
        spare = (self.high - self.low - count * BAY)[run] / 2
        return run, number, self.low[run] + spare + (number + 0.5) * BAY


def runs_of(network: RoadNetwork, bands: Bands) -> Runs:
    """Return where cars stand in the lanes that cross-sections have for them."""
    rows = np.flatnonzero(bands.kind == KIND["parking"])
    edge, left = bands.edge[rows], bands.middle[rows] > 0
    kerb = np.where(left, bands.left[rows], bands.right[rows])
    road = np.where(left, bands.right[rows], bands.left[rows])
    low, high = free_of(network)
    room = (high - low)[edge] >= BAY
    edge = edge[room]
    return Runs(edge, low[edge], high[edge], kerb[room], road[room])


def free_of(network: RoadNetwork) -> tuple[FloatArray, FloatArray]:
    """(e,) metres along each edge between which cars may stand."""
    joint = network.node_degree[network.edge_nodes] == 2
    gap = np.where(joint, FROM_JOINT, FROM_JUNCTION)
    gap = network.trim + np.where(network.crossing, FROM_CROSSING, gap)
    return gap[:, 0], arc_lengths(network.lines)[1] - gap[:, 1]


def bay_marks(lines: Polylines, runs: Runs, style: str) -> Marks:
    """Paint the lanes of parked cars.

    Parameters
    ----------
    lines
        Centrelines of the edges.
    runs
        What is painted.
    style
        "stalls" (lines between the cars), "outline" (a broken line round each row of bays) or
        "line" (one along the row).
    """
    run, number, middle = runs.bays()
    first = np.flatnonzero(number == 0)
    last = np.append(first[1:], len(run)) - 1 if len(first) else first
    begin, end = middle[first] - BAY / 2, middle[last] + BAY / 2
    row = run[first]
    if style == "stalls":
        at = np.concatenate([middle - BAY / 2, end])
        return _across(lines, runs, np.concatenate([run, row]), at, STALL)
    if style == "line":
        return _along(lines, runs, row, begin, end, LINE)
    step = sum(DASHES)
    count = np.maximum(np.round((end - begin) / step), 1).astype(np.int64)
    which = np.repeat(np.arange(len(count)), count)
    place = numbered(count)
    pitch = ((end - begin + DASHES[1]) / count)[which]
    low = begin[which] + place * pitch
    dashes = _along(lines, runs, row[which], low, low + pitch - DASHES[1], OUTLINE)
    return together([dashes, *(_ends(lines, runs, row, at) for at in (begin, end))])


def _along(
    lines: Polylines, runs: Runs, row: IntArray, low: FloatArray, high: FloatArray, breadth: float
) -> Marks:
    """Lines along the inner edges of lanes."""
    edge = runs.edge[row]
    return line_strips(pieces(lines, edge, low, high), runs.road[row], breadth), edge


def _across(lines: Polylines, runs: Runs, row: IntArray, at: FloatArray, breadth: float) -> Marks:
    """Lines from the kerbs to the inner edges of lanes."""
    width = np.abs(runs.kerb - runs.road)[row] - INSET
    middle = (runs.kerb + runs.road)[row] / 2
    return boxes(lines, runs.edge[row], at, middle, breadth, width)


def _ends(lines: Polylines, runs: Runs, row: IntArray, at: FloatArray) -> Marks:
    """Two dashes from the kerb to the inner edge at each end of a row of bays."""
    width = np.abs(runs.kerb - runs.road)[row] - OUTLINE
    dash = (width - DASHES[1]) / 2
    inward = -np.sign(runs.kerb - runs.road)[row]
    found = []
    for place in (dash / 2 + INSET, width - dash / 2):
        lateral = runs.kerb[row] + inward * place
        found.append(boxes(lines, runs.edge[row], at, lateral, OUTLINE, dash))
    return together(found)
