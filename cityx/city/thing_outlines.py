"""Outlines of things on the ground, as obstacles of people and vehicles."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.city.scene import Scene
from cityx.geometry.arrays import FloatArray

FURNITURE = ("street_furniture", "street_pieces", "park_pieces", "shore_pieces")
LOW, HIGH = 0.10, 2.0  # metres above the ground between which a thing is in somebody's way


def placed_rings(
    ring: FloatArray, at: FloatArray, yaw: NDArray[Any], scale: NDArray[Any]
) -> FloatArray:
    """(n, k, 2) corners of (k, 2) as they are scaled, turned and put at (n, 2) places.

    Parameters
    ----------
    ring, at
        Metres.
    yaw
        (n,) radians, counter-clockwise.
    scale
        (n, 2 or more) factors along x and y.
    """
    angle, size = yaw.astype(float), scale.astype(float)
    c, s = np.cos(angle)[:, None], np.sin(angle)[:, None]
    x, y = (ring[:, k] * size[:, k : k + 1] for k in (0, 1))
    return np.asarray(np.stack([c * x - s * y, s * x + c * y], axis=2) + at[:, None])


def solid_ring(vertices: FloatArray) -> FloatArray:
    """Return the outline of a thing as an obstacle, (k, 2) metres, in its own frame.

    Parameters
    ----------
    vertices
        (n, 3) of the thing. Of one that is low or high throughout the ring has less than four
        points.
    """
    body = vertices[(vertices[:, 2] > LOW) & (vertices[:, 2] < HIGH)]
    # A post has vertices at its ends alone.
    foot = vertices[vertices[:, 2] <= LOW]
    solid = foot if len(body) < 3 and vertices[:, 2].max() > LOW else body
    return np.asarray(
        shapely.get_coordinates(shapely.convex_hull(shapely.multipoints(solid[:, :2])))
    )


def placed_outlines(
    scene: Scene, layers: Sequence[str] = FURNITURE
) -> tuple[NDArray[Any], FloatArray, NDArray[np.uint64]]:
    """Return the outlines of things as obstacles.

    Parameters
    ----------
    scene
        Where they stand.
    layers
        Layers of instances that are looked at.

    Returns
    -------
    outlines, places, ids
        (n,) convex polygons round what of them lies between ankle and head, (n, 2) metres where
        they stand, and (n,) uint64. What is lower or higher throughout is left out.
    """
    hulls: dict[int, FloatArray] = {}
    shapes, spots = [np.zeros(0, object)], [np.zeros((0, 2))]
    ids = [np.zeros(0, np.uint64)]
    for layer in layers:
        rows = scene.instances.get(layer)
        if rows is None:
            continue
        for index in np.unique(rows.prototype).tolist():
            if index not in hulls:
                hulls[index] = solid_ring(scene.prototypes[index].mesh.vertices)
            hull = hulls[index]
            if len(hull) < 4:
                continue
            of = rows.prototype == index
            at = rows.position[of][:, :2]
            ring = placed_rings(hull, at, rows.rotation[of, 2], rows.scale[of])
            shapes.append(shapely.polygons(ring))
            spots.append(at)
            ids.append(rows.object_id[of])
    return np.concatenate(shapes), np.concatenate(spots), np.concatenate(ids)
