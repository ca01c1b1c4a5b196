"""Roof heights: how high and how steep the drawn roofs are at places in plan."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.geometry.arrays import FloatArray, IntArray
from cityx.geometry.extrude import roof_uv
from cityx.geometry.polygons import Rings, offset_points, polygons_of
from cityx.geometry.solids import NO_VERTEX, ROOF, TRIM, WALL, Solids, no_solids

if TYPE_CHECKING:
    from cityx.city.mesh import MeshBatch


UPWARD = 0.05  # least share of a face's area that is seen from above
EDGE = 1e-3  # metres outside a triangle that still count as on it
THICKNESS = 0.16  # metres from the roof's surface to the soffit


@dataclass(frozen=True)
class RoofField:
    """Triangles seen from above, t of them, as planes over the plan.

    Attributes
    ----------
    tree
        Index of the triangles' boxes.
    corner
        (t, 3, 2) plan.
    plane
        (t, 3) a, b, c of z = a x + b y + c, x and y counted from the first corner.
    owner
        (t,) uint64, id of the object.
    """

    tree: Any
    corner: FloatArray
    plane: FloatArray
    owner: NDArray[np.uint64]

    def at(self, points: FloatArray, owner: NDArray[np.uint64]) -> tuple[FloatArray, FloatArray]:
        """Return the highest surface of an object at places.

        Parameters
        ----------
        points
            (k, 2) metres.
        owner
            (k,) id of the object.

        Returns
        -------
        z, slope
            (k,) heights, NaN where the object has no roof, and (k, 2) rise over run along x and y.
        """
        z = np.full(len(points), -np.inf)
        slope = np.zeros((len(points), 2))
        if len(points) and len(self.owner):
            point, face = self.tree.query(shapely.points(points))
            same = owner[point] == self.owner[face]
            point, face = point[same], face[same]
            inside = self._inside(points[point], face)
            point, face = point[inside], face[inside]
            offset = points[point] - self.corner[face, 0]
            plane = self.plane[face]
            height = (offset * plane[:, :2]).sum(axis=1) + plane[:, 2]
            order = np.lexsort((height, point))  # the highest comes last and stays
            z[point[order]] = height[order]
            slope[point[order]] = plane[order, :2]
        return np.where(np.isfinite(z), z, np.nan), slope

    def _inside(self, points: FloatArray, face: IntArray) -> NDArray[np.bool_]:
        corner = self.corner[face]
        inside = np.ones(len(face), bool)
        for k in range(3):
            a, b = corner[:, k], corner[:, (k + 1) % 3]
            edge, gap = b - a, points - a
            length = np.maximum(np.hypot(*edge.T), 1e-9)
            left = (edge[:, 0] * gap[:, 1] - edge[:, 1] * gap[:, 0]) / length
            inside &= left > -EDGE
        return inside


def roof_field(batch: MeshBatch, objects: NDArray[np.bool_], without: tuple[str, ...]) -> RoofField:
    """Gather the upward triangles of objects.

    Parameters
    ----------
    batch
        k objects.
    objects
        (k,) bool, those that are asked about.
    without
        Names of materials that are no roof, such as of cornices.
    """
    owner = batch.face_object()
    skipped = [row for row, name in enumerate(batch.materials) if name in without]
    rows = np.flatnonzero(objects[owner] & ~np.isin(batch.material, skipped))
    faces = batch.faces[rows].astype(np.int64)
    quad = np.flatnonzero(faces[:, 3] >= 0)
    triangles = np.concatenate([faces[:, :3], faces[quad][:, [0, 2, 3]]])
    of_face = owner[np.concatenate([rows, rows[quad]])]
    corner = batch.vertices[triangles]  # (t, 3, 3)
    p, q = corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]
    normal = np.cross(p, q)
    up = normal[:, 2] > UPWARD * np.maximum(np.linalg.norm(normal, axis=1), 1e-12)
    corner, normal, of_face = corner[up], normal[up], of_face[up]
    gradient = -normal[:, :2] / normal[:, 2:]
    flat = corner[:, :, :2]
    low, high = flat.min(axis=1) - EDGE, flat.max(axis=1) + EDGE
    boxes = shapely.box(low[:, 0], low[:, 1], high[:, 0], high[:, 1])
    return RoofField(
        shapely.STRtree(boxes),
        flat,
        np.column_stack([gradient, corner[:, 0, 2]]),
        batch.object_id[of_face],
    )


def overhang_points(
    rings: Rings, distance: FloatArray, count: int
) -> tuple[FloatArray, NDArray[np.bool_]]:
    """Move the edges of outlines outward and say which edges can keep their overhang.

    Parameters
    ----------
    rings
        m points of n outlines.
    distance
        (m,) metres per edge, 0 where none is wanted.
    count
        Number of outlines.

    Returns
    -------
    points, active
        (m, 2) outer corners and (m,) bool: edges with an overhang that crosses nothing of its own
        outline.
    """
    points, sound_ring = offset_points(rings, distance)
    sound = np.ones(count, bool)
    sound[rings.polygon[~sound_ring]] = False
    shapes = polygons_of(Rings(points, rings.start, rings.polygon, rings.hole), count)
    sound &= shapely.is_valid(shapes)
    return points, (distance > 0) & sound[rings.polygon[rings.ring_of_point]]


def eave_bodies(
    rings: Rings,
    outer: FloatArray,
    active: NDArray[np.bool_],
    inner_z: FloatArray,
    outer_z: FloatArray,
    count: int,
) -> Solids:
    """Build one closed body per run of edges with an overhang.

    Parameters
    ----------
    rings
        m points of n outlines.
    outer, active
        From `overhang_points`.
    inner_z, outer_z
        (m,) height of the roof's surface over the ring point and over the outer corner.
    count
        Number of outlines.
    """
    size = len(rings.points)
    here = np.flatnonzero(active)
    if len(here) == 0:
        return no_solids()
    after, before = rings.following(), rings.preceding()
    there = after[here]
    # Vertex blocks: inner top, inner bottom, outer top, outer bottom.
    vertices = np.concatenate(
        [
            np.column_stack([rings.points, inner_z]),
            np.column_stack([rings.points, inner_z - THICKNESS]),
            np.column_stack([outer, outer_z]),
            np.column_stack([outer, outer_z - THICKNESS]),
        ]
    )
    p, p_low, q, q_low = (np.arange(size) + block * size for block in range(4))
    top = np.column_stack([p[here], q[here], q[there], p[there]])
    soffit = np.column_stack([p_low[here], p_low[there], q_low[there], q_low[here]])
    fascia = np.column_stack([q_low[here], q_low[there], q[there], q[here]])
    back = np.column_stack([p_low[there], p_low[here], p[here], p[there]])
    first = here[~active[before[here]]]
    last = there[~active[there]]
    starts = np.column_stack([p_low[first], q_low[first], q[first], p[first]])
    ends = np.column_stack([p_low[last], p[last], q[last], q_low[last]])
    faces = np.concatenate([top, soffit, fascia, back, starts, ends])
    part_of = rings.polygon[rings.ring_of_point]
    corner = np.concatenate([here, here, here, here, first, last])
    role = np.full(len(faces), TRIM, np.int8)
    role[: len(here)] = ROOF
    role[3 * len(here) : 4 * len(here)] = WALL  # hidden; the fascias alone are upright trim
    part: IntArray = part_of[corner]
    used = np.zeros(len(vertices), bool)
    used[faces] = True
    number = np.cumsum(used) - 1
    uv = roof_uv(vertices, faces, part, np.zeros(count))
    faces = np.where(faces == NO_VERTEX, NO_VERTEX, number[faces])
    return Solids(vertices[used], np.tile(part_of, 4)[used], faces, part, role, uv)
