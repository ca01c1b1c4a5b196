"""Regions: a raster of labels becomes smooth polygons that share their borders exactly.

Borders are cut into arcs where three labels meet; each arc is smoothed once, for both of its sides;
all arcs together are noded and polygonised, so regions neither overlap nor leave gaps, whatever the
smoothing does. All points are (column, row). Outlines of joined bodies are cut into party walls, so
that neighbours share one straight wall.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.geometry.arrays import FloatArray, IntArray
from cityx.geometry.raster.cracks import OUTSIDE, arcs, find_cracks

FINEST = 0.01  # pixels; the grid on which borders are noded
OVERSHOOT = 4.0  # pixels a wall is drawn on, so that it meets an outline that was straightened
STRAIGHT = 1.5  # pixels; a wall that strays further from its chord keeps its bends
SMALLEST = 2.0  # square pixels; less is a shred of two walls that nearly meet


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


def parted(
    shapes: NDArray[Any], bodies: NDArray[Any], parts: NDArray[Any]
) -> tuple[NDArray[Any], IntArray]:
    """Cut the outline of each body along the borders of its parts.

    Parameters
    ----------
    shapes
        (n,) polygons, (column, row), of the bodies 1 to n.
    bodies
        (rows, columns) int, number of the body, 0 for none.
    parts
        (rows, columns) int, number of the part, 0 for none; parts lie within bodies.

    Returns
    -------
    shapes
        (m,) polygons; those of one body share their walls point by point.
    part
        (m,) number of the part of each, ascending.
    """
    walls, owner = _walls(bodies, parts)
    several = np.unique(owner)
    single = np.setdiff1d(np.arange(1, len(shapes) + 1), several)
    of_body = np.zeros(len(shapes) + 1, np.int64)
    of_body[bodies.ravel()] = parts.ravel()
    found, part = [shapes[single - 1]], [of_body[single]]
    nearest = filled(parts, parts == 0) if len(several) else parts
    for body in several.tolist():
        pieces, number = _cut(shapes[body - 1], walls[owner == body], nearest)
        found.append(pieces)
        part.append(number)
    every, numbers = np.concatenate(found), np.concatenate(part)
    order = np.argsort(numbers, kind="stable")
    return every[order], numbers[order]


def _walls(bodies: NDArray[Any], parts: NDArray[Any]) -> tuple[NDArray[Any], IntArray]:
    """Return the lines between parts and the body of each."""
    cracks = find_cracks(parts)
    cracks = cracks.take(cracks.right > 0)
    chains = arcs(cracks)
    middle, start, end = cracks.middles(), cracks.points(cracks.start), cracks.points(cracks.end)
    walls, owner = [], []
    body = np.zeros(int(parts.max(initial=0)) + 1, np.int64)
    body[parts.ravel()] = bodies.ravel()
    for first, last in zip(chains.begin[:-1].tolist(), chains.begin[1:].tolist(), strict=True):
        run = chains.crack[first:last]
        walls.append(_wall(middle[run], start[run[0]], end[run[-1]]))
        owner.append(body[cracks.left[run[0]]])
    return np.array(walls, object), np.array(owner, np.int64)


def _wall(middle: FloatArray, begin: FloatArray, end: FloatArray) -> shapely.LineString:
    """Draw a wall through the middles of its cracks, straight where they allow it."""
    points = np.vstack([begin, middle, end])
    centre = middle.mean(axis=0)
    chord = end - begin
    along = chord
    if len(middle) > 2:
        along = np.linalg.svd(middle - centre, full_matrices=False)[2][0]
    length = float(np.hypot(*along))
    if length == 0.0:  # a closed wall: one part inside another
        return shapely.simplify(shapely.LineString(points), STRAIGHT)
    along = along / length * (1.0 if float(along @ chord) >= 0 else -1.0)
    away = points - centre
    across = np.abs(away[:, 0] * along[1] - away[:, 1] * along[0])
    if across[1:-1].max() > STRAIGHT:
        return shapely.simplify(shapely.LineString(points), STRAIGHT)
    reach = away @ along
    ends = np.array([reach.min() - OVERSHOOT, reach.max() + OVERSHOOT])
    return shapely.LineString(centre + ends[:, None] * along)


def _cut(
    shape: shapely.Polygon, walls: NDArray[Any], nearest: NDArray[Any]
) -> tuple[NDArray[Any], IntArray]:
    """Cut one outline; every face belongs to the part under its inner point."""
    lines = shapely.union_all([shape.boundary, *walls], grid_size=FINEST)
    faces = shapely.get_parts(shapely.polygonize([lines]))
    inner = shapely.point_on_surface(faces)
    kept = shapely.contains(shape, inner) & (shapely.area(faces) > SMALLEST)
    if not kept.any():
        return np.array([shape], object), np.array([_part_at(nearest, shape)], np.int64)
    number = np.array([_part_at(nearest, face) for face in faces[kept]], np.int64)
    pieces = [shapely.coverage_union_all(faces[kept][number == each]) for each in np.unique(number)]
    return np.array(pieces, object), np.unique(number)


def _part_at(nearest: NDArray[Any], shape: shapely.Polygon) -> int:
    column, row = np.floor(shapely.get_coordinates(shapely.point_on_surface(shape))[0]).astype(int)
    rows, columns = nearest.shape
    return int(nearest[np.clip(row, 0, rows - 1), np.clip(column, 0, columns - 1)])
