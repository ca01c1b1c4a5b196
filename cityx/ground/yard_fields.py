"""Fields of yards: the ground about each house that was paved together with it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cityx.city.mesh import MeshBatch
from cityx.ids import choose, uniform

FloatArray = NDArray[np.float64]

PURPOSE = "yard field"
BRICK = 0.85  # tone from which a field is laid with brick
REACH = (3.0, 22.0)  # metres of ground on each side of a house that belongs to it
# Tones of asphalt, worn and usual blocks, pale slabs and brick, each a range, and how often.
TONES = (((-1.0, -0.75), 3.0), ((-0.6, -0.15), 3.0), ((-0.1, 0.1), 1.5), ((0.3, 0.65), 3.0),
         ((BRICK, 1.0), 1.6))  # fmt: skip
LEVEL = 0.05  # metres between the ends of an edge of a wall that runs level
SIDES = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)], float)


def yard_fields(houses: MeshBatch) -> tuple[FloatArray, FloatArray]:
    """Draw a rectangle of ground about each house, square to its longest wall.

    Parameters
    ----------
    houses
        k shells.

    Returns
    -------
    outline
        (k, 4, 2) float, metres. Fields of neighbours overlap; the later one hides the earlier.
    tone
        (k,) float, how much paler (to 1) or darker (to -1) than the usual paving it is; from
        `BRICK` on it is brick.
    """
    count = houses.count
    if not count:
        return np.zeros((0, 4, 2)), np.zeros(0)
    along = _long_walls(houses)
    frame = np.stack([along, np.column_stack([-along[:, 1], along[:, 0]])], axis=2)  # (k, 2, 2)
    house = np.repeat(np.arange(count), np.diff(houses.vertex_start))
    own = np.einsum("ni,nij->nj", houses.vertices[:, :2], frame[house])
    start = houses.vertex_start[:-1]
    low, high = np.minimum.reduceat(own, start), np.maximum.reduceat(own, start)
    drawn = [
        uniform(0, PURPOSE, houses.object_id, side) for side in range(4)
    ]  # the ground before, behind and beside
    reach = REACH[0] + (REACH[1] - REACH[0]) * np.stack(drawn, axis=1)
    low, high = low - reach[:, :2], high + reach[:, 2:]
    corner = np.where(SIDES[None] < 0, low[:, None], high[:, None])  # (k, 4, 2)
    outline = np.einsum("kcj,kij->kci", corner, frame)
    kind = choose(0, f"{PURPOSE}/kind", houses.object_id, [share for _, share in TONES])
    least, most = np.array([span for span, _ in TONES])[kind].T
    tone = uniform(0, f"{PURPOSE}/tone", houses.object_id)
    return outline, least + (most - least) * tone


def _long_walls(houses: MeshBatch) -> FloatArray:
    """(k, 2) unit vectors along the longest level edge of each shell."""
    first, second = (houses.vertices[houses.faces[:, corner]] for corner in (0, 1))  # (f, 3) each
    edge = second - first
    length = np.hypot(edge[:, 0], edge[:, 1]) * (np.abs(edge[:, 2]) < LEVEL)
    most = np.maximum.reduceat(length, houses.face_start[:-1])
    house = np.repeat(np.arange(houses.count), np.diff(houses.face_start))
    longest = np.zeros(houses.count, np.int64)
    reaching = np.flatnonzero(length == most[house])
    longest[house[reaching]] = reaching  # the last of equal ones
    way = edge[longest, :2]
    size = np.maximum(length[longest], 1e-9)[:, None]
    return np.asarray(np.where(length[longest, None] > 0, way / size, (1.0, 0.0)))
