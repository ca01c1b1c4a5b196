"""Gradient noise: smooth random functions of the plane, the same on every machine."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike

from cityx.geometry.arrays import FloatArray
from cityx.ids import draw, hash_bits, hash_ids, uniform

_CORNERS = np.array([(0, 0), (0, 1), (1, 0), (1, 1)])[:, None]  # (4, 1, 2) of a cell


def gradient_noise(seed: int, points: ArrayLike, *, octaves: int = 1) -> FloatArray:
    """Evaluate Perlin noise whose largest waves are one unit long.

    Parameters
    ----------
    seed
        Chooses the function.
    points
        (n, 2) places, in waves.
    octaves
        Layers, each of half the waves and half the height of the one before.

    Returns
    -------
    noise
        (n,) between -1 and 1; 0 on average.

    References
    ----------
    Perlin, "Improving noise", SIGGRAPH 2002.
    """
    points = np.asarray(points, dtype=float).reshape(-1, 2)
    total = np.zeros(len(points))
    for octave in range(octaves):
        total += 0.5**octave * _layer(seed, points * 2.0**octave, octave)
    return np.asarray(total / (2.0 - 0.5 ** (octaves - 1)))


def _layer(seed: int, points: FloatArray, octave: int) -> FloatArray:
    corner = np.floor(points).astype(np.int64)  # (n, 2)
    offset = points - corner
    fade = offset**3 * (offset * (offset * 6 - 15) + 10)
    cell = (corner + _CORNERS).astype(np.uint64)  # (4, n, 2)
    ids = hash_ids(seed, "noise/cell", cell[..., 0], cell[..., 1])
    angle = 2 * np.pi * uniform(seed, "noise/gradient", ids, octave)
    away = offset - _CORNERS
    slope = np.cos(angle) * away[..., 0] + np.sin(angle) * away[..., 1]
    part = np.abs(1 - _CORNERS - fade)
    weighted = part[..., 0] * part[..., 1] * slope
    total = weighted[0] + weighted[1] + weighted[2] + weighted[3]
    # Gradient noise of unit slopes stays within +-sqrt(1/2); scale to +-1.
    return np.asarray(np.sqrt(2.0) * total)


def gradient_noise_at(seed: int, x: float, y: float, *, octaves: int = 1) -> float:
    """Evaluate `gradient_noise` at one place, many times as fast."""
    total = 0.0
    for octave in range(octaves):
        total += 0.5**octave * _layer_at(seed, x * 2.0**octave, y * 2.0**octave, octave)
    return total / (2.0 - 0.5 ** (octaves - 1))


def _layer_at(seed: int, x: float, y: float, octave: int) -> float:
    left, low = math.floor(x), math.floor(y)
    u, v = x - left, y - low
    fade_u, fade_v = u**3 * (u * (u * 6 - 15) + 10), v**3 * (v * (v * 6 - 15) + 10)
    total = 0.0
    for dx in (0, 1):
        for dy in (0, 1):
            cell = hash_bits(seed, "noise/cell", left + dx, low + dy)
            angle = 2 * math.pi * draw(seed, "noise/gradient", cell, octave)
            slope = math.cos(angle) * (u - dx) + math.sin(angle) * (v - dy)
            total += abs(1 - dx - fade_u) * abs(1 - dy - fade_v) * slope
    return math.sqrt(2.0) * total
