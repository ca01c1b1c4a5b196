"""Checks of street furniture: nothing in a lane, and a way past everything on a walk.

Both are measured from what stands in the scene: the outlines of the prototypes as they are placed,
the lanes of the lane graph, and the faces of the ground.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cityx.checks.check import Check, named
from cityx.city import City
from cityx.city.thing_outlines import placed_outlines
from cityx.ground.walking.clear_ways import WITHIN, in_lanes
from cityx.ground.walking.passage import FREE, crowding

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]
LET_PASS = 2  # pieces of which a small map has few
CROWDED = 0.05  # share of the things on walks that may leave less, as in corners of yards


def check_furniture(city: City) -> list[Check]:
    """Run both checks; none where nothing stands."""
    outlines, xy, ids = placed_outlines(city.scene)
    if not len(outlines) or city.ground is None:
        return []
    rows, tight = crowding(city, outlines, xy)
    # What the map shows stands where the map has it.
    tight = tight[~np.isin(ids[rows], city.layout.points["id"].to_numpy())]
    crowded = max(int(tight.sum()) - LET_PASS, 0)
    hindering = in_lanes(city, outlines, xy, over=WITHIN)
    return [
        Check("furniture_in_lanes", float(hindering.sum()), 0,
              "pieces of furniture whose outline reaches into a lane or a carriageway",
              ids=named(ids[hindering])),
        Check("furniture_on_walkway", crowded / max(len(tight), 1), CROWDED,
              f"share of the pieces on walks that leave less than {FREE} m to pass, "
              f"{LET_PASS} let pass"),
    ]  # fmt: skip
