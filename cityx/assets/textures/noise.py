"""Tileable noise on a square grid, the same to the bit on every machine.

Only +, -, *, / and square roots are used (exactly rounded by IEEE 754), on lattices of hashed
integers, so no library version or processor changes a pixel. Row 0 is v = 0, the bottom.
"""

from __future__ import annotations

from typing import cast

import numpy as np
from numpy.typing import NDArray

from cityx.ids import uniform

Field = NDArray[np.float32]  # (size, size)


def lattice(key: str, nx: int, ny: int, k: int = 0) -> Field:
    """Draw (ny, nx) numbers in [0, 1), one per cell of a lattice."""
    ids = np.arange(nx * ny, dtype=np.uint64)
    return uniform(0, f"texture/{key}", ids, k).reshape(ny, nx).astype(np.float32)


def axes(size: int) -> tuple[Field, Field]:
    """Return u as (1, size) and v as (size, 1), pixel centres in [0, 1)."""
    centres = ((np.arange(size) + 0.5) / size).astype(np.float32)
    return centres[None, :], centres[:, None]


def smooth(low: float, high: float, values: Field) -> Field:
    """Rise from 0 at `low` to 1 at `high` without a kink."""
    t = np.clip((values - np.float32(low)) / np.float32(high - low), 0, 1)
    return cast(Field, t * t * (3 - 2 * t))


def _cells(size: int, n: int) -> tuple[NDArray[np.int64], NDArray[np.int64], Field]:
    """Lattice neighbours left and right of each pixel, and the fraction between."""
    position = (np.arange(size) + 0.5) * n / size
    left = np.floor(position).astype(np.int64)
    return left % n, (left + 1) % n, (position - left).astype(np.float32)


def value_noise(key: str, size: int, nx: int, ny: int | None = None, k: int = 0) -> Field:
    """Interpolate random values smoothly between nx x ny lattice points; in [0, 1), mean 0.5."""
    values = lattice(key, nx, ny or nx, k)
    x0, x1, fx = _cells(size, nx)
    y0, y1, fy = _cells(size, ny or nx)
    tx, ty = fx * fx * (3 - 2 * fx), (fy * fy * (3 - 2 * fy))[:, None]
    across = values[:, x0] * (1 - tx) + values[:, x1] * tx  # (ny, size)
    return cast(Field, across[y0] * (1 - ty) + across[y1] * ty)


def gradient_noise(key: str, size: int, nx: int, ny: int | None = None, k: int = 0) -> Field:
    """Interpolate random slopes between nx x ny lattice points (Perlin); mean 0, about +-0.5."""
    ny = ny or nx
    gx = lattice(key, nx, ny, 2 * k + 101) * 2 - 1
    gy = lattice(key, nx, ny, 2 * k + 102) * 2 - 1
    x0, x1, fx = _cells(size, nx)
    y0, y1, fy = _cells(size, ny)
    tx, ty = fx * fx * fx * (fx * (fx * 6 - 15) + 10), fy * fy * fy * (fy * (fy * 6 - 15) + 10)
    # Blend along x first: slope and offset of each lattice row, then along y.
    offset = gx[:, x0] * fx * (1 - tx) + gx[:, x1] * (fx - 1) * tx  # (ny, size)
    slope = gy[:, x0] * (1 - tx) + gy[:, x1] * tx
    fy_, ty_ = fy[:, None], ty[:, None]
    low = offset[y0] + slope[y0] * fy_
    high = offset[y1] + slope[y1] * (fy_ - 1)
    return cast(Field, low * (1 - ty_) + high * ty_)


def fractal(
    key: str, size: int, nx: int, ny: int | None = None, *, octaves: int = 4, gain: float = 0.5
) -> Field:
    """Sum octaves of gradient noise, each of double frequency; mean 0, about +-1."""
    ny = ny or nx
    total = np.zeros((size, size), np.float32)
    weight = np.float32(1.0)
    for octave in range(octaves):
        # Above half the pixel count noise is only aliasing.
        fx, fy = min(nx << octave, size), min(ny << octave, size)
        total += weight * gradient_noise(key, size, fx, fy, octave)
        weight *= np.float32(gain)
    return cast(Field, total * np.float32(1.6))


def speckle(key: str, size: int, k: int = 0) -> Field:
    """Draw one number in [0, 1) per pixel."""
    return lattice(f"{key}/speckle", size, size, k)


def cells(
    key: str, size: int, nx: int, ny: int | None = None, *, jitter: float = 0.9
) -> tuple[Field, Field, NDArray[np.int64]]:
    """Find the nearest of one random point per lattice cell (Worley).

    Returns
    -------
    nearest, second
        (size, size) distance to the nearest and second nearest point, in cells.
    index
        (size, size) number of the nearest point, row by row of the lattice.
    """
    ny = ny or nx
    px = (lattice(key, nx, ny, 201) - 0.5) * np.float32(jitter) + np.float32(0.5)
    py = (lattice(key, nx, ny, 202) - 0.5) * np.float32(jitter) + np.float32(0.5)
    x0, _, fx = _cells(size, nx)
    y0, _, fy = _cells(size, ny)
    nearest = np.full((size, size), np.float32(9.0))
    second = nearest.copy()
    index = np.zeros((size, size), np.int32)
    for dy in (-1, 0, 1):
        rows = (y0 + dy) % ny
        for dx in (-1, 0, 1):
            columns = (x0 + dx) % nx
            at = np.ix_(rows, columns)
            ex, ey = px[at] + (dx - fx), py[at] + (dy - fy)[:, None]
            distance = ex * ex + ey * ey
            closer = distance < nearest
            second = np.where(closer, nearest, np.minimum(second, distance))
            number = (rows[:, None] * nx + columns[None, :]).astype(np.int32)
            index = np.where(closer, number, index)
            nearest = np.minimum(nearest, distance)
    return np.sqrt(nearest), np.sqrt(second), index.astype(np.int64)


def per_cell(key: str, index: NDArray[np.int64], k: int = 0) -> Field:
    """Draw one number in [0, 1) per cell number."""
    table = uniform(0, f"texture/{key}", np.arange(int(index.max()) + 1, dtype=np.uint64), k)
    return table.astype(np.float32)[index]


def blurred(values: Field, radius: int) -> Field:
    """Average over a square of 2 `radius` + 1 pixels, wrapping around."""
    result = values
    for axis in (0, 1):
        total = result.copy()
        for step in range(1, radius + 1):
            total += np.roll(result, step, axis) + np.roll(result, -step, axis)
        result = np.asarray(total / np.float32(2 * radius + 1), dtype=np.float32)
    return result


def sampled(values: Field, du: Field, dv: Field) -> Field:
    """Read a field at pixels displaced by (`du`, `dv`) tiles, bilinear, wrapping around."""
    size = len(values)
    grid = np.arange(size, dtype=np.float32)
    x = grid[None, :] + du * size
    y = grid[:, None] + dv * size
    left, low = np.floor(x), np.floor(y)
    fx, fy = x - left, y - low
    i0, j0 = low.astype(np.int64) % size, left.astype(np.int64) % size
    i1, j1 = (i0 + 1) % size, (j0 + 1) % size
    bottom = values[i0, j0] * (1 - fx) + values[i0, j1] * fx
    top = values[i1, j0] * (1 - fx) + values[i1, j1] * fx
    return np.asarray(bottom * (1 - fy) + top * fy, dtype=np.float32)
