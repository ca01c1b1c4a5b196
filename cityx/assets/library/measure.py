"""Measures of meshes: true outline, size, front, and whether they can be an asset at all."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.geometry.polygons import FloatArray, IntArray

SIMPLE = 0.005  # of the longer side: detail of outlines below it is left out
LEAST_SIMPLE = 0.002  # metres
MOST_JOINED = 60_000  # triangles; beyond it the outline is the convex hull
FLAT = 1e-9  # square metres; a triangle seen edge-on covers no ground
SNAP = 1e-4  # metres


def outline_of(vertices: FloatArray, triangles: IntArray | None) -> Any:
    """Return the outline of what a mesh covers seen from above, a polygon without holes.

    Parameters
    ----------
    vertices
        (n, 3) metres.
    triangles
        (t, 3) rows of vertices. The outline is the union of the triangles; the convex hull where
        there are none, too many, or they do not join into one piece of most of the hull's area.

    Returns
    -------
    outline
        Empty if the mesh covers no ground.
    """
    points = np.asarray(vertices, float)[:, :2]
    hull = shapely.convex_hull(shapely.multipoints(points))
    if shapely.get_type_id(hull) != 3:
        return shapely.Polygon()
    extent = np.ptp(points, axis=0).max()
    step = max(SIMPLE * extent, LEAST_SIMPLE)
    if triangles is None or len(triangles) > MOST_JOINED:
        return _counter_clockwise(shapely.simplify(hull, step / 4))
    corner = points[triangles]  # (t, 3, 2)
    a, b = corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]
    area = np.abs(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]) / 2
    solid = shapely.polygons(corner[area > FLAT])
    if not len(solid):
        return _counter_clockwise(hull)
    joined = shapely.union_all(shapely.buffer(shapely.union_all(solid, grid_size=SNAP), step,
                                              join_style="mitre"))  # fmt: skip
    joined = shapely.buffer(joined, -step, join_style="mitre")
    pieces = shapely.get_parts(joined)
    if not len(pieces):
        return _counter_clockwise(hull)
    largest = pieces[np.argmax(shapely.area(pieces))]
    # Two pieces, such as a house and its garage: only the hull covers both.
    if shapely.area(pieces).sum() > 1.02 * shapely.area(largest):
        return _counter_clockwise(hull)
    outline = shapely.simplify(shapely.Polygon(largest.exterior), step)
    return _counter_clockwise(outline if shapely.is_valid(outline) else hull)


def stable_outline(outline: Any) -> Any:
    """Round an outline to millimetres, so that machines agree on it."""
    rounded = shapely.set_precision(outline, 1e-3)
    return outline if shapely.is_empty(rounded) else _counter_clockwise(rounded)


def _counter_clockwise(polygon: Any) -> Any:
    return shapely.normalize(shapely.orient_polygons(polygon))


def front_of(
    vertices: FloatArray,
    triangles: IntArray,
    names: Sequence[str],
    number: NDArray[np.int64],
    outline: Any,
) -> float:
    """Guess which way an asset faces, compass radians.

    Where parts are named after doors or entrances, it is the side of the smallest rectangle that
    they are nearest to. Else it is -y: the front of glTF, USD and Blender files.

    Parameters
    ----------
    vertices, triangles
        (n, 3) and (t, 3).
    names, number
        Names of materials and parts, and (t,) which one each triangle has.
    outline
        Outline of the asset.
    """
    from cityx.geometry.rectangles import rectangles_of

    words = ("door", "entrance", "entry", "portal", "porch", "shopfront", "storefront")
    doors = [i for i, name in enumerate(names) if any(word in name.lower() for word in words)]
    hit = np.isin(number, doors)
    if not hit.any():
        return float(np.pi)
    box = rectangles_of(np.array([outline], object))
    middle = vertices[triangles[hit]].mean(axis=(0, 1))[:2] - box.centre[0]
    axis = np.array([np.cos(box.angle[0]), np.sin(box.angle[0])])
    across = np.array([-axis[1], axis[0]])
    share = np.array(
        [
            middle @ axis / max(box.length[0] / 2, 1e-9),
            middle @ across / max(box.width[0] / 2, 1e-9),
        ]
    )
    way = axis * np.sign(share[0]) if abs(share[0]) > abs(share[1]) else across * np.sign(share[1])
    return float(np.arctan2(way[0], way[1]) % (2 * np.pi))
