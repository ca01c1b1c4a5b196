"""Yellow lines along kerbs where nobody may park."""

from __future__ import annotations

import numpy as np

from cityx.city.section import KIND
from cityx.geometry.polylines import line_strips, pieces
from cityx.plugins.road.marks import BoolArray, IntArray, Marks, Street, together

WIDTH = 0.1  # metres (TSRGD 2016, diagrams 1017 and 1018.1)
FROM_KERB = (0.25, 0.45)  # metres from the kerb to the middles of the two lines
SINGLE = ("residential", "unclassified", "living_street")  # may be waited in at night
NARROW = 6.5  # metres; on a narrower street a parked car is in the way at any time
STEP = 12.0  # metres of one mark, so that what crosses one leaves the others
LEAST = 1.0  # metres
OFF = 1.0  # metres from junctions and zebras
_FORBIDDEN = '"parking:(?:left|right|both)(?::restriction)?": *"no'


def kerb_lines(street: Street, chosen: BoolArray) -> Marks:
    """Paint one or two lines along both kerbs of the chosen edges, but beside parked cars.

    Two stand for no waiting at any time: on classified roads, on narrow streets, and where the map
    forbids parking.
    """
    network, bands = street.network, street.bands
    table = street.layout.roads.iloc[network.edge_road]
    forbidden = table["tags"].str.contains(_FORBIDDEN, regex=True).to_numpy().astype(bool)
    double = ~np.isin(street.kind, SINGLE) | (2 * network.half_width < NARROW) | forbidden
    parked = bands.kind == KIND["parking"]
    found = []
    for sign in (1.0, -1.0):
        free = chosen.copy()
        free[bands.edge[parked & (sign * bands.middle > 0)]] = False
        for number, gap in enumerate(FROM_KERB):
            edge = np.flatnonzero(free & (double if number else True))
            found.append(_along(street, edge, sign, gap))
    return together(found)


def _along(street: Street, edge: IntArray, sign: float, gap: float) -> Marks:
    """Lines beside one kerb, from junction to junction but for zebras, in short pieces."""
    network = street.network
    open_ = np.where(
        street.marked, np.maximum(street.setback + street.depth[:, None], 0) + OFF, OFF
    )
    open_ += network.trim
    begin, end = open_[edge, 0], street.length[edge] - open_[edge, 1]
    count = np.where(end - begin > LEAST, np.ceil((end - begin) / STEP), 0).astype(np.int64)
    row = np.repeat(np.arange(len(edge)), count)
    number = np.arange(len(row)) - np.repeat(np.cumsum(count) - count, count)
    step = (end - begin)[row] / np.maximum(count[row], 1)
    low = begin[row] + number * step
    cut = pieces(street.lines, edge[row], low, low + step)
    lateral = sign * (network.half_width[edge[row]] - gap)
    return line_strips(cut, lateral, WIDTH), edge[row]
