"""Rain and snow in the air: where drops and flakes are while the shutter of a camera is open."""

from __future__ import annotations

from math import pi

import numpy as np
from numpy.typing import NDArray

from cityx.geometry.arrays import FloatArray
from cityx.ids import stable_id, uniform

NEAR = 1.0  # metres; what falls nearer would blot the picture out
# A drop is seen as the streak it draws in a sixtieth of a second at 6 to 9 m/s (Gunn and Kinzer
# 1949), two millimetres wide; far ones are drawn wider, so that a pixel can show them.
SHUTTER = 1 / 60
DROP_SPEED = (6.0, 9.0)
DROP_WIDTH = 0.0016
RAIN_REACH = 16.0
FLAKE_SPEED = 1.1
FLAKE_RADIUS = (0.002, 0.005)  # flakes that cling together
SNOW_REACH = 14.0
LEAST = 0.45  # pixels, the least width of a streak
SIDES = 6  # corners of a flake
# Gusts drive the rain in sheets some metres wide: between them the wind falls to a third.
GUST_SIZE = 5.0
GUST = (0.35, 1.65)


def places(
    count: int, reach: float, half: tuple[float, float], seed: int, purpose: str
) -> tuple[FloatArray, FloatArray]:
    """Spread points evenly over the volume that a camera sees.

    Parameters
    ----------
    count
        Number of points.
    reach
        Metres ahead.
    half
        Tangents of half the field of view, across and up.
    seed, purpose
        Key of the draws.

    Returns
    -------
    places
        (count, 3) metres to the right, up and ahead of the camera.
    draws
        (count, 4) numbers in [0, 1) for whatever the points become.
    """
    ids = stable_id(purpose) ^ np.arange(count, dtype=np.uint64)
    u = np.column_stack([uniform(seed, f"{purpose}/{k}", ids) for k in range(7)])  # (n, 7)
    # The volume of a pyramid grows with the cube of its height.
    ahead = (NEAR**3 + u[:, 0] * (reach**3 - NEAR**3)) ** (1 / 3)
    # A little beyond the rim of the picture, so that streaks cut it.
    right = (2 * u[:, 1] - 1) * half[0] * 1.08 * ahead
    up = (2 * u[:, 2] - 1) * half[1] * 1.08 * ahead
    return np.column_stack([right, up, ahead]), u[:, 3:]


def streaks(
    at: FloatArray, draws: FloatArray, down: FloatArray, drift: FloatArray, pixel: float
) -> tuple[FloatArray, NDArray[np.int64]]:
    """Draw a streak along the fall of each drop, broadside to the camera.

    Parameters
    ----------
    at, draws
        As of `places`.
    down, drift
        (3,) unit vector of the fall and (3,) wind in metres per second, in the camera's frame.
    pixel
        Radians that a pixel of the picture covers.

    Returns
    -------
    vertices, faces
        (4n, 3) in the camera's frame (right, up, ahead), and (n, 4).
    """
    low, high = DROP_SPEED
    speed = low + draws[:, :1] * (high - low)
    # Wind carries big drops as fast as small ones, but gusts differ.
    gust = _gusts(at)
    path = (down * speed + drift * gust * (0.85 + 0.3 * draws[:, 1:2])) * SHUTTER  # (n, 3)
    path *= 0.8 + 0.7 * draws[:, 2:3]
    side = np.cross(path, at)
    side /= np.maximum(np.linalg.norm(side, axis=1, keepdims=True), 1e-12)
    distance = np.linalg.norm(at, axis=1, keepdims=True)
    half = np.maximum(DROP_WIDTH * (0.6 + 0.8 * draws[:, 3:]), LEAST * pixel * distance) / 2
    corners = np.stack(
        [at - path / 2 - side * half * 0.4, at - path / 2 + side * half * 0.4,
         at + path / 2 + side * half, at + path / 2 - side * half], axis=1,
    )  # fmt: skip  # (n, 4, 3)
    return corners.reshape(-1, 3), np.arange(4 * len(at)).reshape(-1, 4)


def _gusts(at: FloatArray) -> FloatArray:
    """(n, 1) factor on the wind at places: two waves that cross, so that no sheet is straight."""
    turn = 2 * pi / GUST_SIZE
    right, up, ahead = at.T
    wave = np.sin(turn * (right + 0.4 * up)) + np.sin(turn * (0.6 * ahead - 0.5 * right) + 1.0)
    low, high = GUST
    return np.asarray(low + (high - low) * (wave[:, None] + 2) / 4)


def flakes(at: FloatArray, draws: FloatArray, pixel: float) -> tuple[FloatArray, NDArray[np.int64]]:
    """Draw a ragged hexagon for each flake, facing the camera.

    Returns
    -------
    vertices, faces
        (6n, 3) in the camera's frame, and (n, 6).
    """
    distance = np.linalg.norm(at, axis=1, keepdims=True)
    low, high = FLAKE_RADIUS
    radius = np.maximum(low + draws[:, :1] ** 2 * (high - low), 0.6 * pixel * distance)
    angle = 2 * pi * (np.arange(SIDES) / SIDES + draws[:, 1:2])  # (n, 6)
    ragged = radius * (0.75 + 0.25 * np.cos(2 * angle + 6.0 * draws[:, 2:3]))
    fall = 0.5 * FLAKE_SPEED * SHUTTER * np.sin(angle)  # moved while the shutter was open
    ring = np.stack(
        [ragged * np.cos(angle), ragged * np.sin(angle) + fall, np.zeros_like(angle)], axis=2
    )
    corners = at[:, None] + ring
    return corners.reshape(-1, 3), np.arange(SIDES * len(at)).reshape(-1, SIDES)
