"""Poses of cameras and of LiDARs in the axes that formats use."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cityx.city.camera import Camera, axes

Matrix = NDArray[np.float64]
# From a camera with x right, y down, z ahead to one with x right, y up, z backwards.
OPENGL = np.diag([1.0, -1.0, -1.0])


def camera_to_world(camera: Camera) -> Matrix:
    """Return the (4, 4) pose of a camera with x right, y down, z ahead in the city's frame."""
    return pose(axes(camera).T, camera.position)


def lidar_to_world(camera: Camera) -> Matrix:
    """Return the (4, 4) pose of the LiDAR of a camera, at its eye: x ahead, y left, z up."""
    from cityx.dataset.lidar import sensor_axes

    return pose(sensor_axes(camera).T, camera.position)


def pose(rotation: Matrix, position: NDArray[np.float64] | tuple[float, float, float]) -> Matrix:
    """Put a (3, 3) rotation and a position into one (4, 4) matrix."""
    found = np.eye(4)
    found[:3, :3] = rotation
    found[:3, 3] = position
    return found


def turned(heading: float) -> Matrix:
    """Return the (3, 3) rotation about the vertical, counter-clockwise from above."""
    sine, cosine = np.sin(heading), np.cos(heading)
    return np.array([[cosine, -sine, 0.0], [sine, cosine, 0.0], [0.0, 0.0, 1.0]])


def inverse(matrix: Matrix) -> Matrix:
    """Return the inverse of a (4, 4) pose."""
    rotation = matrix[:3, :3].T
    return pose(rotation, -rotation @ matrix[:3, 3])


def quaternion(rotation: Matrix) -> list[float]:
    """Return the quaternion w, x, y, z of a (3, 3) rotation, with w of at least 0."""
    from scipy.spatial.transform import Rotation

    x, y, z, w = Rotation.from_matrix(rotation).as_quat().tolist()
    sign = -1.0 if w < 0 else 1.0
    return [sign * w + 0.0, sign * x + 0.0, sign * y + 0.0, sign * z + 0.0]
