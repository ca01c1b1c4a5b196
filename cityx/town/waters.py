"""Lakes and the sea: whole districts under water, with shores that are rounded."""

from __future__ import annotations

from typing import Any

import numpy as np
import shapely

from cityx.geometry.parcels.lattice import PER_METRE, Key
from cityx.town.rims import Rims
from cityx.town.rivers import around

SHORE = 20.0  # metres from the middle of the road along a shore to the water
WALK = 9.0  # metres from there to the land before the water
ROUND = 55.0  # metres of the least radius of a shore
RINGS = 2  # of districts around one whose shore depends on them


def waters_of(rims: Rims, key: Key) -> tuple[Any, Any]:
    """Return the water of a wet district and the land along its shore, in its own frame."""
    plane = rims.plane
    near = {key}
    for _ in range(RINGS):
        near = {other for cell in near for name in plane.cell(cell).corners for other in around(plane, name)}  # fmt: skip  # noqa: E501
    wet = sorted(cell for cell in near if plane.is_wet(cell))
    whole = shapely.union_all([_outline(rims, cell, key) for cell in wet])
    own = _outline(rims, key, key)
    inner = shapely.buffer(whole, -SHORE - ROUND, quad_segs=6)
    water = shapely.intersection(shapely.buffer(inner, ROUND, quad_segs=6), own)
    dry = shapely.difference(shapely.buffer(whole, -WALK, quad_segs=2), water)
    return water, shapely.intersection(dry, own)


def _outline(rims: Rims, key: Key, frame: Key) -> Any:
    """Return the outline of a district in the frame of another, metres."""
    plane = rims.plane
    cell, anchor = plane.cell(key), plane.cell(frame).site
    lines = []
    for beyond in cell.beyond:
        line = plane.edge(key, beyond)
        lines.append((line if key < beyond else line[::-1])[:-1])
    return shapely.Polygon((np.concatenate(lines) - anchor) / PER_METRE)
