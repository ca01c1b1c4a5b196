"""Party walls: outlines of joined bodies are cut so that neighbours share one straight wall."""

from __future__ import annotations

from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.geometry.raster.cracks import arcs, find_cracks
from cityx.geometry.raster.regions import filled

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

OVERSHOOT = 4.0  # pixels a wall is drawn on, so that it meets an outline that was straightened
STRAIGHT = 1.5  # pixels; a wall that strays further from its chord keeps its bends
SMALLEST = 2.0  # square pixels; less is a shred of two walls that nearly meet
FINEST = 0.01  # pixels; the grid on which walls and outlines are noded


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
