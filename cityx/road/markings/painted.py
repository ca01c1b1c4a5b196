"""Painted strips: lines of games and of parking bays, laid over the ground."""

from __future__ import annotations

import numpy as np

from cityx.city import City, MeshBatch
from cityx.city.mesh import NO_VERTEX, one_mesh
from cityx.geometry.polylines import Polylines, miters
from cityx.ground.pieces import heights


def painted_strips(
    city: City, lines: Polylines, width: float, over: float, own_id: int
) -> MeshBatch:
    """Make white strips along lines, one object.

    Parameters
    ----------
    city
        City with its ground.
    lines
        Metres, with points near enough to each other to follow the ground.
    width
        Metres.
    over
        Metres above the ground.
    own_id
        Of the object.
    """
    side = miters(lines) * (width / 2)
    ends = lines.points[lines.start[:-1]] - lines.points[lines.start[1:] - 1]
    closed = np.hypot(*ends.T) < 0.01
    xy = np.stack([lines.points + side, lines.points - side], axis=1)  # (p, 2, 2)
    # A closed line's last corner is its first one, met square.
    first, last = lines.start[:-1][closed], lines.start[1:][closed] - 1
    reach = lines.points[first] - lines.points[np.maximum(last - 1, 0)]
    reach /= np.maximum(np.hypot(*reach.T), 1e-9)[:, None]
    xy[last] += (width / 2) * reach[:, None]
    z = heights(city, lines.points) + over
    vertices = np.concatenate([xy, np.repeat(z, 2).reshape(-1, 2, 1)], axis=2).reshape(-1, 3)
    owner = lines.line_of_point()
    here = np.flatnonzero(owner[1:] == owner[:-1]) * 2
    faces = np.concatenate([np.column_stack([here, here + 1, here + 3]),
                            np.column_stack([here, here + 3, here + 2])])  # fmt: skip
    table = np.column_stack([faces, np.full(len(faces), NO_VERTEX)])
    uv = np.zeros((len(faces), 4, 2))
    uv[:, :3] = vertices[faces][:, :, :2]
    return one_mesh(own_id, vertices, table, materials=("marking_white",),
                    uv=uv)  # fmt: skip
