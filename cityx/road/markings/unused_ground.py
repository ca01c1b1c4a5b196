"""Hatching of ground in signalled junctions that no vehicle path comes near.

References
----------
RMS-1, 1993, mark 298, and the Japanese standard for marks on roads, 1960 as amended, 208-2: oblique
bars within a line tell where traffic does not go.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import shapely

from cityx.city.ground import LABEL, SURFACES
from cityx.geometry.polylines import to_linestrings
from cityx.ground.arrangement import Regions, regions
from cityx.road.markings.marks import Shapes, Street, rimmed
from cityx.road.network.junction_ways import JunctionWays
from cityx.road.surface.carriageway import Carriageway, joined_by

HALF_WAY = 1.75  # metres to either side of a way that vehicles take
FREE = 0.6  # metres from crossings and other marks
NECK = 1.75  # metres; what is narrower is no ground of its own
AREA = (10.0, 80.0)  # square metres; smaller ones look stray
LINE, BAR, SPACING = 0.12, 0.3, 1.1  # metres: of the line about it, of a bar, from bar to bar


def unused_ground(
    street: Street, ways: Sequence[JunctionWays], road: Carriageway, taken: Shapes
) -> Regions:
    """Hatch the pieces of junctions under signals that no way comes near.

    Parameters
    ----------
    street, ways, road
        The network, the ways across its junctions, and its surfaces.
    taken
        (n,) crossings and other marks, which keep their room.
    """
    lines = np.concatenate([to_linestrings(some.line) for some in ways])
    hub = np.concatenate([some.hub for some in ways])
    crossed = np.intersect1d(street.ruled_hubs, hub)
    surfaces, node = np.concatenate([road.stars, road.curves]), np.r_[road.node, road.curve_node]
    own = np.isin(node, crossed) & np.isin(node, road.node)
    whole, nodes = joined_by(surfaces[own], node[own])
    led = np.flatnonzero(np.isin(hub, nodes))
    near, mark = shapely.STRtree(taken).query(whole, predicate="dwithin", distance=FREE)
    driven = shapely.buffer(lines[led], HALF_WAY, cap_style="flat")
    kept = shapely.buffer(taken[mark], FREE, join_style="mitre")
    used, _ = joined_by(
        np.concatenate([driven, kept]), np.concatenate([np.searchsorted(nodes, hub[led]), near])
    )
    rest = shapely.difference(shapely.buffer(whole, -FREE), used)
    core = shapely.buffer(rest, -NECK / 2, join_style="mitre")
    core = shapely.buffer(core, NECK / 2 - LINE, join_style="mitre")
    # Corners of what is left may reach past what there was.
    parts = shapely.get_parts(shapely.intersection(core, shapely.buffer(rest, -LINE)))
    area = shapely.area(parts)
    found = parts[(area > AREA[0]) & (area < AREA[1])]
    label = LABEL["marking"]
    painted = [_hatching(shape) for shape in found]
    return regions(np.array(painted, object), label, SURFACES[label].priority)


def _hatching(shape: Any) -> Any:
    """Rim of a piece and bars at 45 degrees to its longer side."""
    corners = shapely.get_coordinates(shapely.minimum_rotated_rectangle(shape))
    sides = np.diff(corners[:3], axis=0)
    longer = sides[np.argmax(np.hypot(*sides.T))]
    longer = longer / np.hypot(*longer)
    slant = np.sqrt(0.5) * np.array([longer[0] - longer[1], longer[0] + longer[1]])
    return rimmed(shape, [slant], SPACING, BAR, rim=LINE)
