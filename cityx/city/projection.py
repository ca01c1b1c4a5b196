"""Projection: pinhole cameras as matrices, rays through pixels, points seen in pixels."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cityx.city.camera import Camera


def intrinsics(camera: Camera) -> NDArray[np.float64]:
    """Return the (3, 3) matrix K of a camera: square pixels, principal point in the middle.

    Pixel (0.5, 0.5) is the middle of the pixel at the upper left; x to the right, y down.
    """
    focal = camera.width / 2 / np.tan(camera.hfov / 2)
    return np.array(
        [[focal, 0.0, camera.width / 2], [0.0, focal, camera.height / 2], [0.0, 0.0, 1.0]]
    )


def axes(camera: Camera) -> NDArray[np.float64]:
    """Return the (3, 3) rows right, down and ahead of a camera, in the frame of the city."""
    sh, ch = np.sin(camera.heading), np.cos(camera.heading)
    sp, cp = np.sin(camera.pitch), np.cos(camera.pitch)
    right = (ch, -sh, 0.0)
    down = (sh * sp, ch * sp, -cp)
    ahead = (sh * cp, ch * cp, sp)
    return np.array([right, down, ahead])


def rays(camera: Camera) -> NDArray[np.float64]:
    """Return (h, w, 3) directions through the middles of the pixels, of depth 1 along the view."""
    focal = camera.width / 2 / np.tan(camera.hfov / 2)
    x = (np.arange(camera.width) + 0.5 - camera.width / 2) / focal
    y = (np.arange(camera.height) + 0.5 - camera.height / 2) / focal
    right, down, ahead = axes(camera)
    found: NDArray[np.float64] = ahead + x[None, :, None] * right + y[:, None, None] * down
    return found


def project(
    camera: Camera, points: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return where (n, 3) points are seen, (n, 2) pixels, and their depth, (n,) metres.

    Points behind the eye have a depth of at most 0 and no meaningful pixel.
    """
    local = (points - np.array(camera.position)) @ axes(camera).T
    focal = camera.width / 2 / np.tan(camera.hfov / 2)
    depth = local[:, 2]
    with np.errstate(divide="ignore", invalid="ignore"):
        seen = local[:, :2] / depth[:, None] * focal
    middle = np.array([camera.width / 2, camera.height / 2])
    return seen + middle, depth
