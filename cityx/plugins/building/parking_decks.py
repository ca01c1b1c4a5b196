"""Bays on the uppermost decks of car parks: rows of four along the long side, and aisles."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.assets.roof_furniture import DECK_BAY, DECK_ROWS, DECK_STALL, REACH
from cityx.geometry.identity import choose
from cityx.geometry.polygons import FloatArray
from cityx.plugins.building.volumes import covered

if TYPE_CHECKING:
    from cityx.plugins.building.volumes import Volumes

AISLE = 6.2  # metres between the rows of a pair
EDGE = 0.5  # metres between bays and the parapet
REACHING = 2.9  # metres about the middle of a bay that nothing above may cover
LEAST = 180.0  # square metres of a deck that has bays
FIRST = 200  # numbers of rows begin here, after those of other pieces of a roof
PIECES = tuple(REACH)


def deck_rows(
    seed: int, volumes: Volumes, ids: NDArray[np.uint64], rows: NDArray[np.int64],
    deck: FloatArray, axes: tuple[FloatArray, FloatArray, FloatArray],
) -> tuple[Any, ...]:  # fmt: skip
    """Lay rows of bays on decks that nothing covers.

    Parameters
    ----------
    seed
        Of the city.
    volumes, ids
        Parts of buildings and their ids.
    rows
        Parts that are decks of car parks.
    deck
        (n,) metres, height of the roof of each part.
    axes
        Long and short half axes and the middle of each part, (n, 2) each.

    Returns
    -------
    part, piece, x, y, z, height, yaw, number
        (k,) each; `piece` counts `REACH`.
    """
    found: list[tuple[int, float, float, float, int]] = []
    long_axis, short_axis, middle = axes
    for row in rows[shapely.area(volumes.polygons[rows]) > LEAST].tolist():
        length, depth = (2 * float(np.hypot(*axis[row])) for axis in (long_axis, short_axis))
        u, v = 2 * long_axis[row] / max(length, 1e-6), 2 * short_axis[row] / max(depth, 1e-6)
        module = 2 * DECK_STALL + AISLE
        pairs = max(1, int((depth - 2 * EDGE) / module))
        start = -(pairs * module) / 2
        low = start + np.arange(pairs) * module
        across = [(low + DECK_STALL / 2, 0.0), (low + module - DECK_STALL / 2, np.pi)]
        lines = [(t, turn) for ts, turn in across for t in ts.tolist()]
        wide = 4 * DECK_BAY
        count = int((length - 2 * EDGE) / (wide + 0.3))
        along = (np.arange(count) - (count - 1) / 2) * (wide + 0.3)
        room = shapely.buffer(volumes.polygons[row], -EDGE, join_style="mitre")
        yaw = float(np.arctan2(u[1], u[0]))
        for line, (t, turn) in enumerate(lines):
            for place, s in enumerate(along.tolist()):
                at = middle[row] + s * u + t * v
                a, b = u * wide / 2, v * DECK_STALL / 2
                if room.contains(shapely.Polygon([at - a - b, at + a - b, at + a + b, at - a + b])):
                    found.append((row, at[0], at[1], yaw + turn, FIRST + line * 200 + place))
    table = np.array(found, float).reshape(-1, 5)
    part, number = table[:, 0].astype(np.int64), table[:, 4].astype(np.int64)
    x, y, yaws = table[:, 1], table[:, 2], table[:, 3]
    kinds = [PIECES.index(name) for name in DECK_ROWS]
    drawn = choose(seed, "roof/bays", ids[part], [1.0] * len(kinds), number)
    free = np.ones(len(part), bool)
    for shift in (-1.5 * DECK_BAY, 0.0, 1.5 * DECK_BAY):
        over, up = x + shift * np.cos(yaws), y + shift * np.sin(yaws)
        free &= ~covered(volumes, part, over, up, np.full(len(part), REACHING), deck[part])
    piece = np.array(kinds)[drawn]
    # One comes up in place of the first bays that are free.
    first = np.flatnonzero(free)[np.unique(part[free], return_index=True)[1]]
    piece[first] = PIECES.index("deck_ramp")
    return (part[free], piece[free], x[free], y[free], deck[part][free], np.ones(int(free.sum())),
            yaws[free], number[free])  # fmt: skip
