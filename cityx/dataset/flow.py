"""Flow and motion: where the points seen in a shot are in the next frame of its sequence.

What stands still moves in the picture because the camera does; movers move with each of their
parts. People and riders are followed corner by corner, since each of their poses has the same
triangles. A point that is hidden in the next frame has its flow all the same.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cityx.city.camera import Camera
from cityx.city.projection import axes, project
from cityx.dataset.sight import Sight
from cityx.dataset.stage import Stage
from cityx.geometry.raycast import corners_at, ways_at

FloatArray = NDArray[np.float64]


def motion_of(seen: Sight, later: Stage) -> FloatArray:
    """Return how far each point seen moves, (p, 3) metres.

    Movers that have left the city by then count as standing still.

    Parameters
    ----------
    seen
        What the pixels meet.
    later
        The city at the moment of the next frame.
    """
    moved = np.zeros((len(seen.rows), 3))
    stage = seen.stage
    pixel = np.flatnonzero(seen.hits.instance >= stage.first_mover)
    pieces = later.piece[later.instance_object[later.first_mover :]]
    if not len(pixel) or not len(pieces):
        return moved
    order = np.argsort(pieces, kind="stable")
    wanted = stage.piece[seen.rows[pixel]]
    at = np.minimum(np.searchsorted(pieces[order], wanted), len(order) - 1)
    known = pieces[order][at] == wanted
    pixel, then = pixel[known], later.first_mover + order[at[known]]
    now, triangle = seen.hits.instance[pixel], seen.hits.triangle[pixel]
    _, back, count = ways_at(stage.rays, now)
    ways, _, count_then = ways_at(later.rays, then)
    eye = np.array(seen.shot.camera.position)
    local = _along(back, seen.position[pixel] + eye)
    moved[pixel] = _along(ways, local) - seen.position[pixel] - eye
    same = count == count_then
    bent, shape = pixel[same], triangle[same]
    step = corners_at(later.rays, then[same], shape) - corners_at(stage.rays, now[same], shape)
    u, v = seen.hits.u[bent, None].astype(float), seen.hits.v[bent, None].astype(float)
    moved[bent] = (1 - u - v) * step[:, 0] + u * step[:, 1] + v * step[:, 2]
    return moved


def _along(ways: FloatArray, points: FloatArray) -> FloatArray:
    return np.asarray(np.einsum("nij,nj->ni", ways[:, :, :3], points) + ways[:, :, 3])


def flow_of(seen: Sight, motion: FloatArray, camera: Camera) -> FloatArray:
    """Return the flow, (p, 2) pixels right and down; NaN of what is behind the next camera.

    The sky is infinitely far: it moves by the turn of the camera alone.

    Parameters
    ----------
    seen
        What the pixels meet.
    motion
        (p, 3) metres that the points seen move.
    camera
        Of the next frame.
    """
    own = seen.shot.camera
    points = seen.position + motion + np.array(own.position)
    place, depth = project(camera, points)
    sky = ~seen.met
    far = seen.directions[sky] @ axes(camera).T
    focal = camera.width / 2 / np.tan(camera.hfov / 2)
    with np.errstate(divide="ignore", invalid="ignore"):
        spot = far[:, :2] / far[:, 2:] * focal
    place[sky] = spot + np.array([camera.width / 2, camera.height / 2])
    depth[sky] = far[:, 2]
    x, y = np.meshgrid(np.arange(own.width) + 0.5, np.arange(own.height) + 0.5)
    flow = place - np.column_stack([x.ravel(), y.ravel()])
    return np.where(depth[:, None] > 0, flow, np.nan)
