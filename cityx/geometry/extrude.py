"""Extrusion: outlines raised to solids, all parts at once."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.geometry.arrays import FloatArray, IntArray
from cityx.geometry.polygons import (
    Rings,
    clean_polygons,
    longest_edge,
    rings_of,
    run_along,
    triangulate,
)
from cityx.geometry.solids import (
    NO_VERTEX,
    ROOF,
    WALL,
    Solids,
    as_quads,
    face_uv,
    join_solids,
    open_parts,
)

LEVEL_TILT = 1e-3  # sine; a flatter face has no direction of slope
NICK = 0.02  # metres around a point where two rings touch that are cut out of an outline
LOOSEN = 0.004  # metres an outline is drawn in if that does not help


@dataclass(frozen=True)
class Plan:
    """Outlines of n parts, cut into triangles on the points of their rings.

    Attributes
    ----------
    rings
        The rings; ``rings.polygon`` is the row of the part.
    triangles
        (t, 3) int64 into ``rings.points``, counter-clockwise.
    owner
        (t,) int64, row of the part.
    count
        Number of parts.
    """

    rings: Rings
    triangles: IntArray
    owner: IntArray
    count: int

    @property
    def part_of_point(self) -> IntArray:
        """(m,) row of the part of each ring point."""
        return self.rings.polygon[self.rings.ring_of_point]


def plan_of(polygons: NDArray[Any]) -> Plan:
    """Triangulate (n,) valid polygons; empty ones have no triangle."""
    polygons = np.asarray(polygons, dtype=object)
    rings = rings_of(polygons)
    mesh = triangulate(polygons, rings)
    return Plan(rings, mesh.triangles, mesh.polygon, len(polygons))


def wall_faces(
    rings: Rings, lower: IntArray, upper: IntArray, z_low: FloatArray, z_high: FloatArray
) -> tuple[IntArray, NDArray[np.float32]]:
    """Raise one quad per ring edge between two vertices per ring point.

    Parameters
    ----------
    rings
        m points.
    lower, upper
        (m,) vertex numbers of the foot and the head of the wall at each point.
    z_low, z_high
        (m,) height of foot and head above the zero of the texture.

    Returns
    -------
    faces, uv
        (m, 4) int64 and (m, 4, 2) float32.
    """
    after = rings.following()
    faces = np.column_stack([lower, lower[after], upper[after], upper])
    u = run_along(rings)
    u_end = u + np.hypot(*(rings.points[after] - rings.points).T)
    uv = np.stack(
        [
            np.column_stack([u, z_low]),
            np.column_stack([u_end, z_low[after]]),
            np.column_stack([u_end, z_high[after]]),
            np.column_stack([u, z_high]),
        ],
        axis=1,
    )
    return faces, uv.astype(np.float32)


def aligned(points: FloatArray, part: IntArray, angle: FloatArray) -> FloatArray:
    """Turn world coordinates so that u runs along the angle of the part, (m, 2) metres."""
    cosine, sine = np.cos(angle)[part], np.sin(angle)[part]
    return np.column_stack(
        [points[:, 0] * cosine + points[:, 1] * sine, points[:, 1] * cosine - points[:, 0] * sine]
    )


def extrude(
    plan: Plan,
    low: FloatArray,
    high: FloatArray,
    zero: FloatArray,
    *,
    per_point: bool = False,
    roof_uv: FloatArray | None = None,
) -> Solids:
    """Raise every outline to a solid with upright walls.

    Parameters
    ----------
    plan
        n outlines with m ring points.
    low
        (n,) height of the level foot.
    high
        (n,) height of the level top; with `per_point`, (m,) one per ring point, and the top follows
        the triangles of the plan.
    zero
        (n,) height at which the texture of the walls starts.
    roof_uv
        (m, 2) texture coordinates of the top; world metres along the longest edge by default.
    """
    rings = plan.rings
    part = plan.part_of_point
    size = len(rings.points)
    z_low = low[part]
    z_high = high if per_point else high[part]
    vertices = np.concatenate(
        [np.column_stack([rings.points, z_low]), np.column_stack([rings.points, z_high])]
    )
    index = np.arange(size)
    walls, walls_uv = wall_faces(
        rings, index, index + size, z_low - zero[part], z_high - zero[part]
    )
    world = aligned(rings.points, part, longest_edge(rings, plan.count))
    top = as_quads(plan.triangles + size)
    bottom = as_quads(plan.triangles[:, [0, 2, 1]])
    over = np.tile(world if roof_uv is None else roof_uv, (2, 1))
    return Solids(
        vertices,
        np.tile(part, 2),
        np.concatenate([walls, top, bottom]),
        np.concatenate([part, plan.owner, plan.owner]),
        np.repeat(np.array([WALL, ROOF, WALL], np.int8), [len(walls), len(top), len(bottom)]),
        np.concatenate([walls_uv, face_uv(over, top), face_uv(np.tile(world, (2, 1)), bottom)]),
    )


def roof_uv(vertices: FloatArray, faces: IntArray, part: IntArray, angle: FloatArray) -> Any:
    """Lay texture on sloping faces: u along the eave, v up the slope, both in metres.

    Parameters
    ----------
    vertices, faces
        (n, 3) and (f, 4).
    part
        (f,) row of the part of each face.
    angle
        (parts,) radians; level faces take their u along it.

    Returns
    -------
    uv
        (f, 4, 2) float32.
    """
    corner = vertices[np.where(faces == NO_VERTEX, faces[:, :1], faces)]  # (f, 4, 3)
    origin = np.full((len(angle), 3), np.inf)
    np.minimum.at(origin, part, corner.min(axis=1))
    normal = np.cross(corner[:, 2] - corner[:, 0], corner[:, 3] - corner[:, 1])
    short = faces[:, 3] == NO_VERTEX
    normal[short] = np.cross(
        corner[short, 1] - corner[short, 0], corner[short, 2] - corner[short, 0]
    )
    normal /= np.maximum(np.linalg.norm(normal, axis=1), 1e-12)[:, None]
    tilt = np.hypot(normal[:, 0], normal[:, 1])
    level = tilt < LEVEL_TILT
    eave = np.column_stack([-normal[:, 1], normal[:, 0]]) / np.maximum(tilt, 1e-12)[:, None]
    eave[level] = np.column_stack([np.cos(angle), np.sin(angle)])[part[level]]
    along = np.column_stack([eave, np.zeros(len(eave))])
    up = np.cross(normal, along)
    local = corner - origin[part][:, None]
    uv = np.stack([(local * along[:, None]).sum(2), (local * up[:, None]).sum(2)], axis=2)
    uv[short, 3] = 0.0
    return uv.astype(np.float32)


def roofed(
    plan: Plan,
    low: FloatArray,
    ring_top: FloatArray,
    zero: FloatArray,
    roof: IntArray,
    roof_part: IntArray,
    *,
    extra: FloatArray | None = None,
    extra_part: IntArray | None = None,
    role: NDArray[np.int8] | None = None,
) -> Solids:
    """Raise outlines to walls whose heads follow a roof, and close them with that roof.

    Parameters
    ----------
    plan
        n outlines, m ring points; its triangles close the foot.
    low, zero
        (n,) height of the foot and of the zero of the wall texture.
    ring_top
        (m,) height of the wall head at each ring point.
    roof
        (f, 4) faces over ring points (numbers below m) and extra vertices (m and above).
    roof_part
        (f,) row of the part of each face.
    extra, extra_part
        (e, 3) and (e,) vertices of the roof that do not stand on a wall.
    role
        (f,) role of each face of the roof, `ROOF` by default.
    """
    rings, part = plan.rings, plan.part_of_point
    size = len(rings.points)
    extra = np.zeros((0, 3)) if extra is None else extra
    extra_part = np.zeros(0, np.int64) if extra_part is None else extra_part
    z_low = low[part]
    vertices = np.concatenate(
        [np.column_stack([rings.points, z_low]), np.column_stack([rings.points, ring_top]), extra]
    )
    index = np.arange(size)
    walls, walls_uv = wall_faces(
        rings, index, index + size, z_low - zero[part], ring_top - zero[part]
    )
    angle = longest_edge(rings, plan.count)
    top = np.where(roof == NO_VERTEX, NO_VERTEX, roof + size)
    bottom = as_quads(plan.triangles[:, [0, 2, 1]])
    world = aligned(rings.points, part, angle)
    roles = np.concatenate(
        [
            np.full(len(walls), WALL, np.int8),
            np.full(len(top), ROOF, np.int8) if role is None else role,
            np.full(len(bottom), WALL, np.int8),
        ]
    )
    return Solids(
        vertices,
        np.concatenate([part, part, extra_part]),
        np.concatenate([walls, top, bottom]),
        np.concatenate([part, roof_part, plan.owner]),
        roles,
        np.concatenate(
            [walls_uv, roof_uv(vertices, top, roof_part, angle), face_uv(world, bottom)]
        ),
    )


def weld_touching(solids: Solids) -> Solids:
    """Join vertices of the same part and position, where rings of an outline touch in a point."""
    key = np.ascontiguousarray(
        np.column_stack([solids.vertices + 0.0, solids.vertex_part.astype(float)])
    )
    _, first, same = np.unique(key.view("V32").ravel(), return_index=True, return_inverse=True)
    same = first[same.ravel()]
    used = np.zeros(len(solids.vertices), bool)
    faces = np.where(solids.faces == NO_VERTEX, NO_VERTEX, same[solids.faces])
    used[faces[faces != NO_VERTEX]] = True
    number = np.cumsum(used) - 1
    return Solids(
        solids.vertices[used],
        solids.vertex_part[used],
        np.where(faces == NO_VERTEX, NO_VERTEX, number[faces]),
        solids.face_part,
        solids.role,
        solids.uv,
    )


def _nicked(polygons: NDArray[Any]) -> NDArray[Any]:
    """Cut a small square out of each polygon at every point where two of its rings touch."""
    nicked = polygons.copy()
    for row, polygon in enumerate(polygons):
        rings = [shapely.get_coordinates(ring)[:-1] for ring in shapely.get_rings(polygon)]
        places, number = np.unique(np.concatenate(rings), axis=0, return_counts=True)
        touching = shapely.points(places[number > 1])
        squares = shapely.union_all(shapely.buffer(touching, NICK, quad_segs=1))
        nicked[row] = shapely.difference(polygon, squares)
    return nicked


def _drawn_in(polygons: NDArray[Any]) -> NDArray[Any]:
    return np.asarray(shapely.buffer(polygons, -LOOSEN, join_style="mitre"), dtype=object)


def prisms(
    polygons: NDArray[Any], low: FloatArray, high: FloatArray, zero: FloatArray
) -> tuple[Solids, NDArray[np.bool_]]:
    """Raise outlines to level prisms and repair those that do not close.

    Parameters
    ----------
    polygons
        (n,) valid polygons; empty ones are passed over.
    low, high, zero
        (n,) height of foot, top and zero of the wall texture.

    Returns
    -------
    solids, failed
        Closed prisms, and (n,) bool: outlines that are empty or would not close.
    """
    count = len(polygons)
    solids = extrude(plan_of(polygons), low, high, zero)
    wrong = open_parts(solids, count)
    if wrong.any():
        closed = solids.of_parts(~wrong)
        welded = weld_touching(solids.of_parts(wrong))
        wrong = open_parts(welded, count)
        closed = join_solids([closed, welded.of_parts(~wrong)])
        for loosen in (_nicked, _drawn_in):
            rows = np.flatnonzero(wrong)
            loose = np.full(count, shapely.Polygon(), dtype=object)
            loose[rows] = clean_polygons(loosen(polygons[rows]))
            apart = extrude(plan_of(loose), low, high, zero)
            wrong = open_parts(apart, count)
            closed = join_solids([closed, apart.of_parts(~wrong)])
        solids = closed
    failed = np.ones(count, bool)
    failed[solids.face_part] = False
    return solids, failed
