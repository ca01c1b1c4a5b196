"""Regions: a raster of labels becomes smooth polygons that share their borders exactly.

Borders are cut into arcs where three labels meet; each arc is smoothed once, for both of its sides;
all arcs together are noded and polygonised, so regions neither overlap nor leave gaps, whatever the
smoothing does. All points are (column, row).
"""

from __future__ import annotations

from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.geometry.raster.cracks import OUTSIDE, arcs, find_cracks

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

FINEST = 0.01  # pixels; the grid on which borders are noded


def filled(labels: NDArray[Any], unknown: NDArray[np.bool_]) -> NDArray[Any]:
    """Give unknown pixels the label of the nearest known one; all stay as they are if none is."""
    from scipy import ndimage

    if unknown.all() or not unknown.any():
        return labels
    row, column = ndimage.distance_transform_edt(
        unknown, return_distances=False, return_indices=True
    )
    return np.asarray(labels[row, column])


def without_small_patches(labels: NDArray[Any], least: float) -> NDArray[Any]:
    """Give patches of fewer than `least` pixels to the labels around them."""
    from skimage.measure import label

    patches = label(labels, background=OUTSIDE, connectivity=1)
    small = (np.bincount(patches.ravel()) < least)[patches]
    return filled(labels, small)


def regions(
    labels: NDArray[Any], *, smooth: float, tolerance: float
) -> tuple[NDArray[Any], IntArray]:
    """Draw the regions of a raster.

    Parameters
    ----------
    labels
        (rows, columns) int, 0 or more; every patch is large enough to matter.
    smooth
        Pixels, deviation of the filter along borders; the border of the raster stays straight.
    tolerance
        Pixels that a border may stray when points are dropped.

    Returns
    -------
    shapes
        (n,) polygons that together cover the raster once.
    label
        (n,) of each.
    """
    borders = _borders(labels, smooth, tolerance)
    noded = shapely.union_all(borders, grid_size=FINEST)
    faces = shapely.get_parts(shapely.polygonize([noded]))
    column, row = np.floor(shapely.get_coordinates(shapely.point_on_surface(faces))).T.astype(int)
    rows, columns = labels.shape
    found = labels[np.clip(row, 0, rows - 1), np.clip(column, 0, columns - 1)]
    return _dissolved(faces, found)


def _borders(labels: NDArray[Any], smooth: float, tolerance: float) -> NDArray[Any]:
    """Return one line for each arc between two labels."""
    cracks = find_cracks(labels)
    chains = arcs(cracks)
    start, middle = cracks.points(cracks.start), cracks.middles()
    last = cracks.points(cracks.end)
    lines = []
    for index, closed in enumerate(chains.closed.tolist()):
        run = chains.crack[chains.begin[index] : chains.begin[index + 1]]
        if cracks.right[run[0]] == OUTSIDE:
            points = np.vstack([start[run], last[run[-1:]]])
            lines.append(shapely.simplify(shapely.LineString(points), 0))
            continue
        points = _smoothed(middle[run], smooth, closed=closed)
        ends = (points[-1:], points[:0]) if closed else (start[run[:1]], last[run[-1:]])
        line = shapely.LineString(np.vstack([ends[0], points, ends[1]]))
        lines.append(shapely.simplify(line, tolerance))
    return np.array(lines, object)


def _smoothed(points: FloatArray, deviation: float, *, closed: bool) -> FloatArray:
    from scipy.ndimage import gaussian_filter1d

    mode = "wrap" if closed else "nearest"
    return np.asarray(gaussian_filter1d(points, deviation, axis=0, mode=mode))


def _dissolved(faces: NDArray[Any], label: IntArray) -> tuple[NDArray[Any], IntArray]:
    """Join neighbouring faces of one label; the result is sorted by label and place."""
    shapes, found = [], []
    for word in np.unique(label).tolist():
        parts = shapely.get_parts(shapely.coverage_union_all(faces[label == word]))
        box = shapely.bounds(parts)
        shapes.append(parts[np.lexsort((box[:, 0], box[:, 1]))])
        found.append(np.full(len(parts), word))
    return np.concatenate(shapes), np.concatenate(found)
