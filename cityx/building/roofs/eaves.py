"""Eaves: the strip of roof that runs out over the walls, as closed bodies of their own."""

from __future__ import annotations

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.geometry.extrude import roof_uv
from cityx.geometry.polygons import FloatArray, IntArray, Rings, offset_points, polygons_of
from cityx.geometry.solids import NO_VERTEX, ROOF, TRIM, WALL, Solids, no_solids

THICKNESS = 0.16  # metres from the roof's surface to the soffit


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
