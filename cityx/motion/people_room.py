"""Bottleneck capacity: how many people narrow places let through; fuller ways are not taken."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cityx.geometry.polylines import Polylines
from cityx.ground.walking.walkable import Walkable

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

TILE = 2.0  # metres along an edge of the places in which people are counted
WIDE = 1.5  # metres of clearance from which a place takes everybody
# People a minute and metre of clearance, both directions together: per metre of width half of it,
# which is Fruin's level of service D.
FLOW = 100.0
LEAST = 8.0  # people a minute that get through any place
SPELLS = 1 << 16  # more than there are in any run
SPELL = 30.0  # seconds in which people at a place are counted together


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
        self.walkable, self.seconds = walkable, seconds
        self.taken: dict[int, int] = {}

    def admitted(
        self, walks: Polylines, rows: IntArray, place: IntArray, clock: FloatArray,
        pace: FloatArray, begun: FloatArray,
    ) -> IntArray:  # fmt: skip
        """Take room for ways one after the other, and return the rows that find some.

        Only what is walked before the end counts, and each place at the time when one comes there:
        who is out at the beginning takes nothing from those who come later.

        Parameters
        ----------
        walks
            The ways, w of them.
        rows
            (r,) those that are wished for, in order.
        place
            (w,) number of the place in the crowd of who walks them.
        clock
            Seconds at which each place in the crowd is free; it is written to.
        pace, begun
            (w,) metres per second, and the share of a way that lies behind its walker.
        """
        points = walks.points
        room = self.walkable.at(self.walkable.clearance, points).astype(float)
        west, south, _, _ = self.walkable.grid.extent
        tile = np.floor((points - (west, south)) / TILE).astype(np.int64)
        key = tile[:, 0] * (1 << 24) + tile[:, 1]
        found = []
        for row in rows.tolist():
            own = slice(walks.start[row], walks.start[row + 1])
            gone = np.r_[0.0, np.cumsum(np.hypot(*np.diff(points[own], axis=0).T))]
            start = clock[place[row]]
            time = start + (gone - begun[row] * gone[-1]) / pace[row]
            narrow = (room[own] < WIDE) & (time >= start) & (time < self.seconds)
            spell = np.floor(time[narrow] / SPELL).astype(np.int64)
            places, number = np.unique(key[own][narrow] * SPELLS + spell, return_inverse=True)
            least = np.full(len(places), WIDE)
            np.minimum.at(least, number, room[own][narrow])
            most = np.maximum(FLOW * least, LEAST) * SPELL / 60.0
            held = [self.taken.get(place, 0) for place in places.tolist()]
            if (np.array(held) < most).all():
                found.append(row)
                clock[place[row]] = time[-1]
                self.taken.update(zip(places.tolist(), [n + 1 for n in held], strict=True))
        return np.array(found, np.int64)
