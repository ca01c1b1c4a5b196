"""Rectangles: the smallest one around an outline, and the largest one within it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely
from numpy.typing import ArrayLike, NDArray

from cityx.geometry.polygons import FloatArray

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
    best = np.zeros(count, np.int64)
    span = np.zeros((count, 4), np.int64)  # first and last row, first and last column
    for first in range(GRID):
        free = np.ones((count, GRID), bool)
        for last in range(first, GRID):
            free &= inside[:, last]
            end, length = _longest_run(free)
            cells = length * (last - first + 1)
            better = cells > best
            best[better] = cells[better]
            found = np.column_stack([np.full(count, first), np.full(count, last),
                                     end - length + 1, end])  # fmt: skip
            span[better] = found[better]
    low = span[:, [0, 2]] / GRID - 0.5
    high = (span[:, [1, 3]] + 1) / GRID - 0.5
    middle, extent = (low + high) / 2 * size, (high - low) * size
    extent[best == 0] = 0.0
    return centre + middle[:, :1] * axis + middle[:, 1:] * across, extent


def _longest_run(free: NDArray[np.bool_]) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return the end and the length of the longest run of True in every row."""
    run = np.zeros(len(free), np.int64)
    best, end = run.copy(), run.copy()
    for column in range(free.shape[1]):
        run = np.where(free[:, column], run + 1, 0)
        longer = run > best
        best = np.where(longer, run, best)
        end = np.where(longer, column, end)
    return end, best
