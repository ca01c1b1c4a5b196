"""Rectangles: the smallest one around an outline, and the largest one within it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely
from numpy.typing import ArrayLike, NDArray

from cityx.geometry.arrays import FloatArray

SQUARE = 1e-6  # of a side; sides closer to each other than that are equal
GRID = 18  # cells along each side of the raster in which inner rectangles are found


@dataclass(frozen=True)
class Rectangles:
    """n rectangles.

    Attributes
    ----------
    centre
        (n, 2).
    length, width
        (n,) long and short side, metres.
    angle
        (n,) direction of the long side, [0, pi), counter-clockwise from x. Of a square it is that
        of the side nearer to the x axis.
    """

    centre: FloatArray
    length: FloatArray
    width: FloatArray
    angle: FloatArray


def rectangles_of(polygons: ArrayLike) -> Rectangles:
    """Find the rectangle of smallest area around every polygon; NaN around an empty one."""
    shapes = np.asarray(polygons, object)
    boxes = shapely.oriented_envelope(shapes)
    good = (shapely.get_type_id(boxes) == 3) & ~shapely.is_empty(boxes)
    corner = np.full((len(shapes), 5, 2), np.nan)
    corner[good] = shapely.get_coordinates(boxes[good]).reshape(-1, 5, 2)
    a, b = corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 1]
    size_a, size_b = np.hypot(*a.T), np.hypot(*b.T)
    square = np.abs(size_a - size_b) <= SQUARE * np.maximum(size_a, size_b)
    a_first = np.where(square, np.abs(a[:, 0]) >= np.abs(b[:, 0]), size_a >= size_b)
    axis = np.where(a_first[:, None], a, b)
    angle = np.arctan2(axis[:, 1], axis[:, 0]) % np.pi
    # A ring that begins elsewhere must not turn 0 into a hair less than pi.
    angle = np.where(np.pi - angle < 1e-9, 0.0, angle)
    return Rectangles(
        (corner[:, 0] + corner[:, 2]) / 2,
        np.maximum(size_a, size_b),
        np.minimum(size_a, size_b),
        angle,
    )


def inner_rectangles(
    polygons: NDArray[Any], centre: FloatArray, axis: FloatArray, size: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Find a large rectangle within every outline, along given axes.

    It is found among the rectangles of a raster, so it is smaller than the largest by up to a cell
    (an 18th of the side) at each side.

    Parameters
    ----------
    polygons
        (n,) outlines.
    centre, axis, size
        (n, 2) middle, unit vector and (along, across) sides of the rectangles to search in.

    Returns
    -------
    centre, size
        (n, 2) each, of the rectangles found; sides are 0 where there is none.
    """
    count = len(polygons)
    step = (np.arange(GRID) + 0.5) / GRID - 0.5
    across = np.column_stack([-axis[:, 1], axis[:, 0]])
    u, v = np.meshgrid(step, step, indexing="ij")  # (g, g)
    u, v = u.ravel(), v.ravel()
    at = centre[:, None, :] + (
        (u * size[:, :1])[..., None] * axis[:, None, :]
        + (v * size[:, 1:])[..., None] * across[:, None, :]
    )  # (n, g * g, 2)
    shapely.prepare(polygons)
    inside = shapely.contains_xy(polygons[:, None], at[..., 0], at[..., 1])
    inside = inside.reshape(count, GRID, GRID)
    masks = inside @ (1 << np.arange(GRID))  # (n, g), bits for columns
    best = np.zeros(count, np.int64)
    span = np.zeros((count, 4), np.int64)  # first and last row, first and last column
    for first in range(GRID):
        free = np.bitwise_and.accumulate(masks[:, first:], axis=1)
        end, length = _longest_run(free)
        cells = length * np.arange(1, GRID - first + 1)
        most = cells.argmax(axis=1)
        rows = np.flatnonzero(cells.max(axis=1) > best)
        most = most[rows]
        best[rows] = cells[rows, most]
        last, right = first + most, end[rows, most]
        span[rows] = np.column_stack(
            [np.full(len(rows), first), last, right - length[rows, most] + 1, right]
        )
    low = span[:, [0, 2]] / GRID - 0.5
    high = (span[:, [1, 3]] + 1) / GRID - 0.5
    middle, extent = (low + high) / 2 * size, (high - low) * size
    extent[best == 0] = 0.0
    return centre + middle[:, :1] * axis + middle[:, 1:] * across, extent


def _longest_run(masks: NDArray[np.int64]) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return the highest bit and the length of the lowest of the longest runs of set bits."""
    length = np.zeros(masks.shape, np.int64)
    ends = masks.copy()  # bits that a run of so many bits ends at
    left = masks
    while left.any():
        length += left != 0
        ends = np.where(left != 0, left, ends)
        left = left & (left << 1)
    lowest = ends & -ends
    return np.frexp(np.maximum(lowest, 1).astype(float))[1].astype(np.int64) - 1, length
