"""Turns: Euler angles as engines write them, their matrices, and the sides of the compass."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

import numpy as np
from numpy.typing import ArrayLike

from cityx.geometry.arrays import FloatArray

LOCKED = 1e-6  # cosine of the second angle below which the first and the third are one turn
# Word of a side -> the way there, east and north.
SIDES: Mapping[str, tuple[float, float]] = MappingProxyType(
    {
        "north": (0.0, 1.0), "east": (1.0, 0.0), "south": (0.0, -1.0), "west": (-1.0, 0.0),
        "northeast": (1.0, 1.0), "southeast": (1.0, -1.0),
        "southwest": (-1.0, -1.0), "northwest": (-1.0, 1.0),
    }
)  # fmt: skip


def matrices(euler: ArrayLike) -> FloatArray:
    """Return the (n, 3, 3) matrices of (n, 3) XYZ Euler angles, radians: about x first."""
    angles = np.asarray(euler, float).reshape(-1, 3)
    (cx, cy, cz), (sx, sy, sz) = np.cos(angles).T, np.sin(angles).T
    rows = [
        [cy * cz, sx * sy * cz - cx * sz, cx * sy * cz + sx * sz],
        [cy * sz, sx * sy * sz + cx * cz, cx * sy * sz - sx * cz],
        [-sy, sx * cy, cx * cy],
    ]
    return np.asarray(np.moveaxis(np.array(rows), 2, 0))


def euler_of(turns: ArrayLike) -> FloatArray:
    """Return XYZ Euler angles, (n, 3) radians, of (n, 3, 3) rotation matrices.

    Where the second angle is a quarter turn the first is 0.
    """
    m = np.asarray(turns, float).reshape(-1, 3, 3)
    flat = np.hypot(m[:, 0, 0], m[:, 1, 0])
    free = flat > LOCKED
    x = np.where(free, np.arctan2(m[:, 2, 1], m[:, 2, 2]), 0.0)
    y = np.arctan2(-m[:, 2, 0], flat)
    z = np.where(free, np.arctan2(m[:, 1, 0], m[:, 0, 0]), np.arctan2(-m[:, 0, 1], m[:, 1, 1]))
    return np.column_stack([x, y, z])
