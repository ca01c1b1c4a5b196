"""Bays on the uppermost decks of car parks: rows of four along the long side, and aisles."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.assets.trims.roof_furniture import DECK_BAY, DECK_ROWS, DECK_STALL, REACH
from cityx.building.volumes import covered
from cityx.geometry.arrays import FloatArray
from cityx.geometry.rectangles import rectangles_of
from cityx.ids import choose

if TYPE_CHECKING:
    from cityx.building.volumes import Volumes

AISLE = 6.2  # metres between the rows of a pair
EDGE = 0.5  # metres between bays and the parapet
REACHING = 2.9  # metres about the middle of a bay that nothing above may cover
LEAST = 180.0  # square metres of a deck that has bays
MOST_WINGS = 4  # of a deck
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
    for row in rows[shapely.area(volumes.polygons[rows]) > LEAST].tolist():
        room = shapely.buffer(volumes.polygons[row], -EDGE, join_style="mitre")
        frame = tuple(axis[row] for axis in axes)
        lines = 0
        # Wings that the rows of the whole do not reach have rows of their own.
        for _ in range(MOST_WINGS):
            bays, count = _rows(room, frame, lines)
            found += [(row, *bay) for bay in bays]
            lines += count
            if not bays:
                break
            taken = shapely.union_all([_bay(bay, AISLE) for bay in bays])
            parts = shapely.get_parts(shapely.difference(room, taken))
            room = parts[np.argmax(shapely.area(parts))] if len(parts) else shapely.Polygon()
            if room.area < LEAST:
                break
            wing = rectangles_of([room])
            ahead = np.array([np.cos(wing.angle[0]), np.sin(wing.angle[0])])
            left = np.array([-ahead[1], ahead[0]])
            frame = (ahead * wing.length[0] / 2, left * wing.width[0] / 2, wing.centre[0])
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


def _rows(
    room: Any, frame: tuple[Any, ...], first: int
) -> tuple[list[tuple[float, float, float, int]], int]:
    """Lay pairs of rows along the longer axis of a frame.

    Returns
    -------
    bays
        (x, y, yaw, number) of each row of four, wholly in the room.
    count
        Lines that they lie in.
    """
    long_axis, short_axis, middle = frame
    length, depth = (2 * float(np.hypot(*axis)) for axis in (long_axis, short_axis))
    u = 2 * long_axis / max(length, 1e-6)
    v = np.array([-u[1], u[0]])
    module = 2 * DECK_STALL + AISLE
    pairs = max(1, int((depth - 2 * EDGE) / module))
    low = -(pairs * module) / 2 + np.arange(pairs) * module
    # Bays open towards their -y, across the aisle to each other.
    across = [(low + DECK_STALL / 2, np.pi), (low + module - DECK_STALL / 2, 0.0)]
    lines = [(t, turn) for ts, turn in across for t in ts.tolist()]
    wide = 4 * DECK_BAY + 0.3
    count = int((length - 2 * EDGE) / wide)
    along = (np.arange(count) - (count - 1) / 2) * wide
    yaw = float(np.arctan2(u[1], u[0]))
    found = []
    for line, (t, turn) in enumerate(lines, first):
        for place, s in enumerate(along.tolist()):
            at = middle + s * u + t * v
            bay = (float(at[0]), float(at[1]), yaw + turn, FIRST + line * 200 + place)
            if room.contains(_bay(bay)):
                found.append(bay)
    return found, len(lines)


def _bay(bay: tuple[float, float, float, int], before: float = 0.0) -> Any:
    """Return what a row takes up, with some metres of the aisle that it opens to."""
    x, y, yaw, _ = bay
    u = np.array([np.cos(yaw), np.sin(yaw)])
    v = np.array([-u[1], u[0]])
    a, b = u * 2 * DECK_BAY, v * DECK_STALL / 2
    at = np.array([x, y])
    near = b + v * before
    return shapely.Polygon([at - a - near, at + a - near, at + a + b, at - a + b])
