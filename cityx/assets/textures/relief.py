"""Reliefs: what patterns are before they become images, and the courses of blocks in many."""

from __future__ import annotations

from dataclasses import dataclass
from typing import cast

import numpy as np
from numpy.typing import NDArray

from cityx.assets.textures.noise import Field, axes, lattice, per_cell

# Slopes beyond this (about 68 degrees) only make normal maps glitter.
STEEPEST = 2.5


@dataclass(frozen=True)
class Relief:
    """A pattern as fields; row 0 is v = 0, the bottom.

    Attributes
    ----------
    tile
        Edge the pattern is drawn for, metres; heights are in the same unit.
    albedo
        (s, s) or (s, s, 3) float32, linear reflectance up to a factor.
    height
        (s, s) float32, metres.
    roughness
        (s, s) float32, up to a factor, or a number.
    brightness
        Mean the colour map is scaled to. Higher keeps bright base colours unclipped, lower leaves
        room for contrast.
    """

    tile: float
    albedo: NDArray[np.float32]
    height: Field
    roughness: Field | float = 1.0
    brightness: float = 0.8


def exact_mean(values: NDArray[np.float32]) -> float:
    """Average over the first two axes in integers, so that the order of summing is no matter."""
    return int(np.round(values.astype(np.float64) * 2.0**32).astype(np.int64).sum()) / (
        2.0**32 * values.size
    )


def scaled_to_mean(values: NDArray[np.float32], mean: float) -> NDArray[np.float32]:
    """Scale non-negative values to the given mean with none above 1."""
    result = values
    for _ in range(6):  # clipping lowers the mean a little; a few rounds settle it
        average = exact_mean(result)
        result = np.clip(result * np.float32(mean / max(average, 1e-9)), 0, 1)
    return result


def neutral_albedo(albedo: NDArray[np.float32], brightness: float) -> NDArray[np.float32]:
    """Give (s, s, 3) values in [0, 1] whose three channels all have the mean `brightness`."""
    planes = np.broadcast_to(
        albedo[..., None] if albedo.ndim == 2 else albedo, (*albedo.shape[:2], 3)
    )
    return np.stack([scaled_to_mean(planes[..., c], brightness) for c in range(3)], axis=2)


def srgb_bytes(linear: NDArray[np.float32]) -> NDArray[np.uint8]:
    """Encode linear values in [0, 1] as 8-bit sRGB."""
    edges = (np.arange(255) + 0.5) / 255
    limits = np.where(edges <= 0.04045, edges / 12.92, ((edges + 0.055) / 1.055) ** 2.4)
    steps = np.round(linear.astype(np.float64) * 65535).astype(np.int64)
    table = np.searchsorted(limits, np.arange(65536) / 65535).astype(np.uint8)
    return cast(NDArray[np.uint8], table[steps])


def linear_from_srgb_bytes(encoded: NDArray[np.uint8]) -> NDArray[np.float64]:
    """Decode 8-bit sRGB to linear values in [0, 1]."""
    codes = np.arange(256) / 255
    table = np.where(codes <= 0.04045, codes / 12.92, ((codes + 0.055) / 1.055) ** 2.4)
    return cast(NDArray[np.float64], table[encoded])


def normal_bytes(height: Field, tile: float) -> NDArray[np.uint8]:
    """Encode the surface normals of a relief, tangent space, +x right, +y up, +z out."""
    pixel = np.float32(2 * tile / len(height))
    slope_u = (np.roll(height, -1, 1) - np.roll(height, 1, 1)) / pixel
    slope_v = (np.roll(height, -1, 0) - np.roll(height, 1, 0)) / pixel
    normal = np.stack(
        [
            -np.clip(slope_u, -STEEPEST, STEEPEST),
            -np.clip(slope_v, -STEEPEST, STEEPEST),
            np.ones_like(height),
        ],
        axis=2,
    )
    normal /= np.sqrt(normal[..., 0:1] ** 2 + normal[..., 1:2] ** 2 + normal[..., 2:3] ** 2)
    return np.asarray(np.round(normal * 127.5 + 127.5), dtype=np.uint8)


@dataclass(frozen=True)
class Courses:
    """Blocks laid in rows.

    Attributes
    ----------
    index
        (s, s) number of the block of each pixel.
    across, up
        (s, s) metres from the left and the lower edge of the block.
    edge
        (s, s) metres to the nearest edge of the block.
    """

    index: NDArray[np.int64]
    across: Field
    up: Field
    edge: Field
    key: str

    def draw(self, k: int = 0) -> Field:
        """Draw one number in [0, 1) per block."""
        return per_cell(self.key, self.index, k)


def lay(
    key: str,
    size: int,
    tile: float,
    columns: int,
    rows: int,
    *,
    bond: float = 0.5,
    jitter: float = 0.0,
    warp: tuple[Field, Field] | None = None,
) -> Courses:
    """Lay `rows` courses of `columns` blocks on a tile.

    Parameters
    ----------
    bond
        Shift of every second row, in blocks; `rows` must be even unless it is 0.
    jitter
        How far joints between blocks of a row stray, in blocks, below 0.5.
    warp
        Metres by which edges stray across and up, for work that is not quite straight.
    """
    u, v = axes(size)
    du, dv = (0.0, 0.0) if warp is None else (warp[0] / tile, warp[1] / tile)
    y = np.broadcast_to((v + dv) * rows, (size, size))
    row = np.floor(y).astype(np.int64)
    x = np.broadcast_to((u + du) * columns, (size, size)) - np.float32(bond) * (row % 2)
    column = np.floor(x).astype(np.int64)
    stray = (lattice(key, columns, rows, 7) - np.float32(0.5)) * np.float32(2 * jitter)
    r = row % rows
    if jitter > 0:  # the joint at each cell's left end has moved by `stray` cells
        fraction = x - column
        before = fraction < stray[r, column % columns]
        after = fraction >= 1 + stray[r, (column + 1) % columns]
        column = column - before + after
    left = column + stray[r, column % columns]
    right = column + 1 + stray[r, (column + 1) % columns]
    across = (x - left) * np.float32(tile / columns)
    width = (right - left) * np.float32(tile / columns)
    up = (y - row) * np.float32(tile / rows)
    edge = np.minimum(
        np.minimum(across, width - across), np.minimum(up, np.float32(tile / rows) - up)
    )
    index = r * columns + column % columns
    return Courses(
        index, across.astype(np.float32), up.astype(np.float32), edge.astype(np.float32), key
    )
