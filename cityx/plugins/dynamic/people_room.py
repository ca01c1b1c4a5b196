"""How many people narrow places let through: ways that would need more are not taken."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cityx.city.walkable import Walkable
from cityx.geometry.polylines import Polylines

IntArray = NDArray[np.int64]

TILE = 2.0  # metres along an edge of the places in which people are counted
WIDE = 1.5  # metres of clearance from which a place takes everybody
# People a minute and metre of clearance, both directions together: per metre of width half of it,
# which is Fruin's level of service D.
FLOW = 100.0
LEAST = 8.0  # people a minute that get through any place


class Room:
    """What is left of the room of narrow places; a class because each way takes some of it.

    Parameters
    ----------
    walkable
        The area.
    seconds
        How long people walk.
    """

    def __init__(self, walkable: Walkable, seconds: float) -> None:
        self.walkable, self.minutes = walkable, max(seconds, 60.0) / 60.0
        self.taken: dict[int, int] = {}

    def admitted(self, walks: Polylines, rows: IntArray) -> IntArray:
        """Take room for ways one after the other, and return the rows that find some.

        Parameters
        ----------
        walks
            The ways.
        rows
            (r,) those that are wished for, in order.
        """
        points = walks.points
        room = self.walkable.at(self.walkable.clearance, points).astype(float)
        west, south, _, _ = self.walkable.grid.extent
        tile = np.floor((points - (west, south)) / TILE).astype(np.int64)
        key = tile[:, 0] * (1 << 32) + tile[:, 1]
        found = []
        for row in rows.tolist():
            own = slice(walks.start[row], walks.start[row + 1])
            narrow = room[own] < WIDE
            places, number = np.unique(key[own][narrow], return_inverse=True)
            least = np.full(len(places), WIDE)
            np.minimum.at(least, number, room[own][narrow])
            most = np.maximum(FLOW * least, LEAST) * self.minutes
            held = [self.taken.get(place, 0) for place in places.tolist()]
            if (np.array(held) < most).all():
                found.append(row)
                self.taken.update(zip(places.tolist(), [n + 1 for n in held], strict=True))
        return np.array(found, np.int64)
