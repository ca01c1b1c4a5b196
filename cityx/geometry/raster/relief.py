"""Relief: the ground below what stands on it, and how even the tops of things are."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]
BoolArray = NDArray[np.bool_]

WINDOW = 60.0  # metres; no roof is wider in both directions, but for the largest halls
BLOCK = 2.0  # metres; the ground is sought in cells of this size, the lowest of each
ROUNDS = 6  # of finding more ground; each reaches on from the last
LOW = 0.4  # metres above the opened surface that is still ground: grass, kerbs, noise


def ground_below(surface: FloatArray, cell: float) -> FloatArray:
    """Find the ground below the houses and trees of a surface.

    What a window of 60 m opens is lower than the ground on slopes and never higher; cells near it
    are ground, and between those the ground is drawn smoothly.

    Parameters
    ----------
    surface
        (rows, columns) metres, without voids.
    cell
        Metres between cells.

    Returns
    -------
    ground
        (rows, columns) metres, nowhere above the surface.

    References
    ----------
    Zhang et al., "A progressive morphological filter for removing nonground measurements from
    airborne LIDAR data", 2003.
    """
    from scipy import ndimage

    stride = max(1, round(BLOCK / cell))
    lowest = _lowest(surface, stride)
    size = max(3, int(WINDOW / (cell * stride)) | 1)
    trend = _plane(_lowest(lowest, min(size, *lowest.shape)), lowest.shape)
    opened = ndimage.grey_opening(lowest - trend, size=(size, size), mode="nearest") + trend
    bare = lowest - opened < LOW
    ground = _drawn(lowest, bare)
    # Slopes rise above what was opened: what lies near the ground drawn so far is ground as well.
    for _ in range(ROUNDS):
        more = ~bare & (lowest - ground < LOW)
        if not more.any():
            break
        bare |= more
        ground = _drawn(lowest, bare)
    rows, columns = surface.shape
    place = np.mgrid[0:rows, 0:columns] / stride - (stride - 1) / (2 * stride)
    full = ndimage.map_coordinates(ground, place, order=1, mode="nearest")
    return np.minimum(full, surface)


def _lowest(surface: FloatArray, stride: int) -> FloatArray:
    """Return the lowest height of each block."""
    rows, columns = (-size % stride for size in surface.shape)
    padded = np.pad(surface, ((0, rows), (0, columns)), mode="edge")
    shape = (padded.shape[0] // stride, stride, padded.shape[1] // stride, stride)
    return np.asarray(padded.reshape(shape).min(axis=(1, 3)))


def _plane(values: FloatArray, shape: tuple[int, ...]) -> FloatArray:
    """Return the plane that fits some blocks best, at cells as fine as `shape`."""
    row, column = (
        axis / size for axis, size in zip(_middles(values.shape), values.shape, strict=True)
    )
    terms = np.column_stack([row.ravel(), column.ravel(), np.ones(values.size)])
    down, right, level = np.linalg.lstsq(terms, values.ravel(), rcond=None)[0].tolist()
    row, column = (axis / size for axis, size in zip(_middles(shape), shape, strict=True))
    return np.asarray(down * row + right * column + level)


def _middles(shape: tuple[int, ...]) -> FloatArray:
    return np.mgrid[0 : shape[0], 0 : shape[1]] + 0.5


def _drawn(heights: FloatArray, known: BoolArray) -> FloatArray:
    """Draw a smooth surface through the known heights: means of ever larger blocks fill the rest.

    References
    ----------
    Gortler et al., "The lumigraph", 1996 (pull and push).
    """
    if known.all() or not known.any():
        return heights
    total, weight = np.where(known, heights, 0.0), known.astype(float)
    levels = [(total, weight)]
    while (weight == 0).any():
        total, weight = _halved(total), _halved(weight)
        levels.append((total, weight))
    drawn = total / weight
    for total, weight in reversed(levels[:-1]):
        wide = _doubled(drawn, total.shape)
        drawn = np.where(weight > 0, total / np.maximum(weight, 1.0), wide)
    return np.asarray(drawn)


def _halved(values: FloatArray) -> FloatArray:
    """Add up blocks of 2 x 2."""
    rows, columns = values.shape
    even = np.pad(values, ((0, rows % 2), (0, columns % 2)))
    return np.asarray(even[::2, ::2] + even[1::2, ::2] + even[::2, 1::2] + even[1::2, 1::2])


def _doubled(values: FloatArray, shape: tuple[int, ...]) -> FloatArray:
    """Draw a grid twice as fine, evenly between the middles of its cells."""
    from scipy import ndimage

    rows, columns = np.arange(shape[0]) / 2 - 0.25, np.arange(shape[1]) / 2 - 0.25
    place = np.meshgrid(rows, columns, indexing="ij")
    return np.asarray(ndimage.map_coordinates(values, place, order=1, mode="nearest"))


def unevenness(heights: FloatArray) -> FloatArray:
    """Return how far the heights around each cell lie from a plane, (rows, columns) metres.

    The deviation of the residuals of the plane that fits 3 x 3 cells best.
    """
    from scipy import ndimage

    near = np.ones((3, 3)) / 9
    down, right = np.mgrid[-1:2, -1:2]
    middle = heights.mean()
    z = heights - middle  # squares of heights above the sea lose digits
    mean = ndimage.correlate(z, near, mode="nearest")
    slope = [ndimage.correlate(z, axis / 6.0, mode="nearest") for axis in (right, down)]
    square = ndimage.correlate(z * z, near, mode="nearest")
    rest = square - mean**2 - (slope[0] ** 2 + slope[1] ** 2) * 6 / 9
    return np.asarray(np.sqrt(np.maximum(rest, 0.0)))


def bends(heights: FloatArray) -> FloatArray:
    """Return how far each cell lies off the mean of its four neighbours, (rows, columns) metres."""
    z = np.pad(heights, 1, mode="edge")
    around = (z[:-2, 1:-1] + z[2:, 1:-1] + z[1:-1, :-2] + z[1:-1, 2:]) / 4
    return np.asarray(np.abs(heights - around))
