"""The planes of roofs: where something can lie or stand on a building as it is built."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely

from cityx.city import City
from cityx.city.mesh import NO_VERTEX, MeshBatch
from cityx.geometry.arrays import FloatArray
from cityx.geometry.solids import area_vectors
from cityx.ids import UInt64Array

UPRIGHT = 0.35  # least vertical part of the normal of what is roof
LEAST = 4.0  # square metres of a plane
TOP = 0.08  # metres below the highest point that count as the ridge
LOW = 2.0  # metres above the ground that a roof is at least


@dataclass(frozen=True)
class Plane:
    """A plane of a roof.

    Attributes
    ----------
    origin, normal, along, up
        (3,) a point, the normal, and unit vectors along the eave and up the slope.
    outline
        Its ground in metres along and up.
    area
        Square metres.
    corners
        (k, 3) of its faces.
    """

    origin: FloatArray
    normal: FloatArray
    along: FloatArray
    up: FloatArray
    outline: Any
    area: float
    corners: FloatArray

    def place(self, u: float, v: float) -> FloatArray:
        """Return the point at so many metres along and up."""
        return np.asarray(self.origin + u * self.along + v * self.up)


def planes_of(city: City, chosen: UInt64Array) -> Iterator[tuple[int, list[Plane]]]:
    """Yield buildings with the planes of their roofs, largest first; those without are left out."""
    batch = city.scene.meshes.get("buildings")
    if batch is None:
        return
    for at in np.flatnonzero(np.isin(batch.object_id, chosen)).tolist():
        one = batch.take(np.array([at]))
        planes = _planes(one)
        if planes:
            yield int(batch.object_id[at]), planes


def _planes(shell: MeshBatch) -> list[Plane]:
    """Return the planes of the roof of a shell, largest first."""
    vectors = area_vectors(shell.vertices, shell.faces)
    area = np.linalg.norm(vectors, axis=1)
    normal = vectors / np.maximum(area, 1e-12)[:, None]
    ground = float(shell.vertices[:, 2].min())
    middle = shell.vertices[shell.faces[:, 0]]
    roof = (normal[:, 2] > UPRIGHT) & (area > 1e-6) & (middle[:, 2] > ground + LOW)
    offset = np.einsum("ij,ij->i", normal, middle)
    key = np.column_stack([np.round(normal, 2), np.round(offset, 1)])
    found: list[Plane] = []
    rows = np.flatnonzero(roof)
    if not len(rows):
        return found
    _, group = np.unique(key[rows], axis=0, return_inverse=True)
    for number in range(int(group.max()) + 1):
        own = rows[group.ravel() == number]
        if area[own].sum() >= LEAST:
            found.append(_plane(shell, own, normal[own[0]], float(area[own].sum())))
    return sorted(found, key=lambda plane: -plane.area)


def _plane(shell: MeshBatch, faces: Any, normal: FloatArray, area: float) -> Plane:
    flat = np.hypot(*normal[:2])
    along = np.array([1.0, 0.0, 0.0])
    if flat > 1e-3:
        along = np.array([-normal[1], normal[0], 0.0]) / flat
    up = np.cross(normal, along)
    shapes, corners = [], []
    origin = shell.vertices[shell.faces[faces[0], 0]]
    for face in shell.faces[faces]:
        points = shell.vertices[face[face != NO_VERTEX]]
        corners.append(points)
        flat_points = np.column_stack([(points - origin) @ along, (points - origin) @ up])
        shapes.append(shapely.polygons(flat_points))
    outline = shapely.union_all(shapely.make_valid(np.array(shapes, object)))
    return Plane(origin, normal, along, up, outline, area, np.concatenate(corners))


def ridge_of(planes: list[Plane]) -> tuple[FloatArray | None, float]:
    """Return a place on the highest part of a roof, and the turn along its ridge."""
    if not planes:
        return None, 0.0
    if planes[0].normal[2] > 0.985:
        plane = planes[0]
        spot = shapely.get_coordinates(shapely.point_on_surface(plane.outline))[0]
        return plane.place(*spot.tolist()), 0.0
    corners = np.concatenate([plane.corners for plane in planes])
    top = corners[corners[:, 2] > corners[:, 2].max() - TOP]
    ends = top[[int(np.argmin(top[:, 0] + top[:, 1])), int(np.argmax(top[:, 0] + top[:, 1]))]]
    way = ends[1] - ends[0]
    turn = float(np.arctan2(way[1], way[0])) if np.hypot(*way[:2]) > 0.1 else 0.0
    return np.asarray(ends[0] + 0.3 * way), turn
