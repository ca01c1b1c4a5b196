"""The line of what stands at kerbs: things of wide walks are moved into it, or turned square."""

from __future__ import annotations

import numpy as np
import shapely

from cityx.city.roads import RoadNetwork
from cityx.geometry.polylines import locate, to_linestrings
from cityx.ground.pieces import FloatArray
from cityx.ground.street_rules import FRONT_LINE
from cityx.road.surface.kerbs import yaw_facing

SQUARE = 30.0  # metres from the middle of a street within which things turn to it
TO_LINE = 3.5  # metres from the line within which things are moved there


def in_kerb_line(
    network: RoadNetwork | None, xy: FloatArray, depth: FloatArray, turn: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Move things of wide walks into the line of what stands at their kerb, square to the street.

    Those too far from the line stay where they are and turn; those far from any street stay as
    they are.

    Parameters
    ----------
    network
        The streets; without any, things stay as they are.
    xy
        (n, 2) float, places, metres.
    depth
        (n,) float, half their sizes across the walk, metres.
    turn
        (n,) float, their turns about z, radians.

    Returns
    -------
    moved, turned
        The same for where they belong.
    """
    if network is None or not network.edge_count or not len(xy):
        return xy, turn
    shapes = to_linestrings(network.lines)
    spots = shapely.points(xy)
    spot, edge = shapely.STRtree(shapes).query_nearest(spots, max_distance=SQUARE)
    spot, first = np.unique(spot, return_index=True)  # ties go to the first line
    edge = edge[first]
    foot, _ = locate(network.lines, edge, shapely.line_locate_point(shapes[edge], spots[spot]))
    out = xy[spot] - foot
    far = np.hypot(*out.T)
    beside = far > network.half_width[edge]
    spot, edge, foot, far = spot[beside], edge[beside], foot[beside], far[beside]
    out = out[beside] / far[:, None]
    line = network.half_width[edge] + FRONT_LINE + depth[spot]
    near = np.abs(far - line) < TO_LINE
    moved, turned = xy.copy(), turn.copy()
    turned[spot] = yaw_facing(-out)
    moved[spot[near]] = (foot + line[:, None] * out)[near]
    return moved, turned
