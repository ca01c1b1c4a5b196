"""Roof meshes: roofs as triangles over their outlines, to be cut, bent and raised to shells.

A roof is a height over its plan, so it is changed by cutting its triangles along lines on which a
value is zero, and by giving every point a new height. Neighbouring triangles share the points of a
cut, and points on the outline enter its rings: what was closed stays closed.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.geometry.arrays import FloatArray, IntArray
from cityx.geometry.extrude import Plan, aligned, plan_of, roofed
from cityx.geometry.polygons import Rings, polygons_of
from cityx.geometry.solids import ROOF, Solids, as_quads, no_solids

SNAP = 5e-3  # metres; a point this near to a cut lies on it, or slivers would remain
LEAST_SHARE = 1e-4  # of the rise between two bends of a profile; nearer ones are one


@dataclass(frozen=True)
class RoofMesh:
    """Roofs over n outlines with m ring points and e points inside.

    Attributes
    ----------
    rings
        The outlines with all points their wall heads have; ``rings.polygon`` is the row.
    head
        (m,) height of the wall head at each ring point.
    level
        (m,) bool, whether the edge that starts at a point is a level eave.
    extra, extra_part
        (e, 3) and (e,) points of the roof that do not stand on a wall.
    faces
        (f, 3) int64 triangles over ring points (below m) and extra points (m and above),
        counter-clockwise from above.
    face_part, role
        (f,) row and role of each triangle.
    count
        Number of outlines, n.
    bottom
        Triangles over the ring points that close the foot, and their rows; None where the outline
        must be cut into triangles anew.
    """

    rings: Rings
    head: FloatArray
    level: NDArray[np.bool_]
    extra: FloatArray
    extra_part: IntArray
    faces: IntArray
    face_part: IntArray
    role: NDArray[np.int8]
    count: int
    bottom: tuple[IntArray, IntArray] | None = None

    @property
    def points(self) -> FloatArray:
        """(m + e, 3) all points."""
        return np.concatenate([np.column_stack([self.rings.points, self.head]), self.extra])

    @property
    def part(self) -> IntArray:
        """(m + e,) row of each point."""
        return np.concatenate([self.rings.polygon[self.rings.ring_of_point], self.extra_part])

    def with_heights(self, z: FloatArray) -> RoofMesh:
        """Return the mesh with other heights, (m + e,)."""
        size = len(self.head)
        return replace(self, head=z[:size], extra=np.column_stack([self.extra[:, :2], z[size:]]))


def flat_mesh(polygons: NDArray[Any], z: FloatArray) -> RoofMesh:
    """Lay level roofs on (n,) outlines at heights (n,), ready to be cut."""
    plan = plan_of(polygons)
    size = len(plan.rings.points)
    return RoofMesh(
        plan.rings,
        z[plan.part_of_point],
        np.ones(size, bool),
        np.zeros((0, 3)),
        np.zeros(0, np.int64),
        plan.triangles,
        plan.owner,
        np.full(len(plan.triangles), ROOF, np.int8),
        plan.count,
        (plan.triangles, plan.owner),
    )


def join_meshes(first: RoofMesh, second: RoofMesh) -> RoofMesh:
    """Put two sets of roofs over the same n rows into one."""
    m, extra, other = len(first.head), len(first.extra), len(second.head)
    low = np.where(first.faces < m, first.faces, first.faces + other)
    high = np.where(second.faces < other, second.faces + m, second.faces + m + extra)
    bottom = None
    if first.bottom is not None and second.bottom is not None:
        bottom = (
            np.concatenate([first.bottom[0], second.bottom[0] + m]),
            np.concatenate([first.bottom[1], second.bottom[1]]),
        )
    return RoofMesh(
        Rings(
            np.concatenate([first.rings.points, second.rings.points]),
            np.concatenate([first.rings.start, second.rings.start[1:] + m]),
            np.concatenate([first.rings.polygon, second.rings.polygon]),
            np.concatenate([first.rings.hole, second.rings.hole]),
        ),
        np.concatenate([first.head, second.head]),
        np.concatenate([first.level, second.level]),
        np.concatenate([first.extra, second.extra]),
        np.concatenate([first.extra_part, second.extra_part]),
        np.concatenate([low, high]),
        np.concatenate([first.face_part, second.face_part]),
        np.concatenate([first.role, second.role]),
        first.count,
        bottom,
    )


def raised(mesh: RoofMesh, low: FloatArray, zero: FloatArray) -> Solids:
    """Raise walls from the feet (n,) up to a roof; see `cityx.geometry.extrude.roofed`."""
    if len(mesh.faces) == 0:
        return no_solids()
    if mesh.bottom is None:
        rings = mesh.rings
        whole = plan_of(polygons_of(rings, mesh.count))
        plan = Plan(rings, _on_rings(whole, rings), whole.owner, mesh.count)
    else:
        plan = Plan(mesh.rings, mesh.bottom[0], mesh.bottom[1], mesh.count)
    return roofed(
        plan,
        low,
        mesh.head,
        zero,
        as_quads(mesh.faces),
        mesh.face_part,
        extra=mesh.extra,
        extra_part=mesh.extra_part,
        role=mesh.role,
    )


def _on_rings(plan: Plan, rings: Rings) -> IntArray:
    """Triangles of a plan over rings whose polygons come in another order."""
    order = np.lexsort((np.arange(len(rings.polygon)), rings.polygon))
    size = np.diff(rings.start)[order]
    first = np.concatenate([[0], np.cumsum(size)[:-1]])
    point = np.arange(size.sum()) - np.repeat(first - rings.start[:-1][order], size)
    return np.asarray(point[plan.triangles])


def cut_mesh(mesh: RoofMesh, value: FloatArray, *, snap: float = SNAP) -> RoofMesh:
    """Cut triangles along the line on which a value is zero.

    Parameters
    ----------
    mesh
        Roofs with m ring points and e points inside.
    value
        (m + e,) one number per point, taken as linear over each triangle.
    snap
        Points whose value is this near to zero lie on the line.
    """
    sign = np.where(np.abs(value) <= snap, 0, np.sign(value)).astype(np.int64)
    corner = sign[mesh.faces]
    crossed = np.flatnonzero((corner.min(axis=1) < 0) & (corner.max(axis=1) > 0))
    if len(crossed) == 0:
        return mesh
    m = len(mesh.head)
    total = m + len(mesh.extra)
    points, part = mesh.points, mesh.part
    faces = mesh.faces[crossed]
    begin = faces.ravel()
    end = np.roll(faces, -1, axis=1).ravel()
    cutting = sign[begin] * sign[end] < 0
    key = np.minimum(begin, end) * total + np.maximum(begin, end)
    edges, of_edge = np.unique(key[cutting], return_inverse=True)
    low, high = edges // total, edges % total
    share = value[low] / (value[low] - value[high])
    place = points[low] + share[:, None] * (points[high] - points[low])
    # On the outline the new point stands on the wall, inside it is a point of the roof.
    after = mesh.rings.following()
    on_ring = (low < m) & (high < m)
    ring_low, ring_high = np.where(on_ring, low, 0), np.where(on_ring, high, 0)
    forward = on_ring & (after[ring_low] == high)
    backward = on_ring & (after[ring_high] == low) & ~forward
    outer = forward | backward
    old_ring, new_ring, rings, head, level = _grown_rings(
        mesh, np.where(forward, low, high)[outer], np.where(forward, share, 1 - share)[outer],
        place[outer],
    )  # fmt: skip
    grown = len(head)
    number = np.concatenate([old_ring, np.arange(total - m) + grown])  # of the old points
    fresh = np.empty(len(edges), np.int64)
    fresh[outer] = new_ring
    fresh[~outer] = grown + total - m + np.arange(int((~outer).sum()))
    middle = np.full(len(begin), -1)
    middle[cutting] = fresh[of_edge.ravel()]
    pieces, of_piece = _cut_triangles(number[faces], corner[crossed], middle.reshape(-1, 3))
    whole = np.ones(len(mesh.faces), bool)
    whole[crossed] = False
    source = np.concatenate([np.flatnonzero(whole), crossed[of_piece]])
    bottom = None
    if mesh.bottom is not None and not outer.any():
        bottom = (number[mesh.bottom[0]], mesh.bottom[1])
    return RoofMesh(
        rings,
        head,
        level,
        np.concatenate([mesh.extra, place[~outer]]),
        np.concatenate([mesh.extra_part, part[low[~outer]]]),
        np.concatenate([number[mesh.faces[whole]], pieces]),
        mesh.face_part[source],
        mesh.role[source],
        mesh.count,
        bottom,
    )


def _grown_rings(
    mesh: RoofMesh, edge: IntArray, share: FloatArray, place: FloatArray
) -> tuple[IntArray, IntArray, Rings, FloatArray, NDArray[np.bool_]]:
    """Insert points into ring edges: new numbers of old and of new points, rings, heads, levels."""
    rings, m = mesh.rings, len(mesh.head)
    at = np.concatenate([np.arange(m), edge])
    order = np.lexsort((np.concatenate([np.zeros(m), share]), at))
    position = np.empty(len(order), np.int64)
    position[order] = np.arange(len(order))
    ring = rings.ring_of_point[at]
    size = np.bincount(ring, minlength=len(rings.polygon))
    start = np.concatenate([[0], np.cumsum(size)]).astype(np.int64)
    points = np.concatenate([rings.points, place[:, :2]])[order]
    head = np.concatenate([mesh.head, place[:, 2]])[order]
    grown = Rings(points, start, rings.polygon, rings.hole)
    return position[:m], position[m:], grown, head, mesh.level[at][order]


def _cut_triangles(faces: IntArray, sign: IntArray, middle: IntArray) -> tuple[IntArray, IntArray]:
    """Cut triangles with a corner on either side; `middle` (t, 3) are the points on their edges.

    Returns
    -------
    pieces, source
        (p, 3) triangles and (p,) the triangle each was cut from.
    """
    row = np.arange(len(faces))
    # Turn each triangle so that it starts at a corner alone on its side (or at the one on the cut).
    zero = sign == 0
    through = zero.any(axis=1)
    alone = np.where(sign.sum(axis=1) > 0, -1, 1)
    lead = np.where(through, np.argmax(zero, axis=1), np.argmax(sign == alone[:, None], axis=1))
    turn = (lead[:, None] + np.arange(3)) % 3
    a, b, c = faces[row[:, None], turn].T
    ab, bc, ca = middle[row[:, None], turn].T
    one, two = np.flatnonzero(through), np.flatnonzero(~through)
    pieces = [
        np.column_stack([a, b, bc])[one],
        np.column_stack([a, bc, c])[one],
        np.column_stack([a, ab, ca])[two],
        np.column_stack([ab, b, c])[two],
        np.column_stack([ab, c, ca])[two],
    ]
    return np.concatenate(pieces), np.concatenate([one, one, two, two, two])


def bend_mesh(
    mesh: RoofMesh, eave: FloatArray, rise: FloatArray, knots: FloatArray, heights: FloatArray
) -> RoofMesh:
    """Bend the planes of roofs along their contour lines: a hip becomes a mansard or a dome.

    Parameters
    ----------
    mesh
        Roofs that rise evenly from their eaves.
    eave, rise
        (n,) metres.
    knots, heights
        (n, k) shares of the rise at which a roof bends, rising from 0 to 1, and the shares they
        are moved to.
    """
    for column in range(1, knots.shape[1] - 1):
        part = mesh.part
        share = (mesh.points[:, 2] - eave[part]) / np.maximum(rise[part], 1e-9)
        mesh = cut_mesh(mesh, share - knots[part, column], snap=LEAST_SHARE)
    part = mesh.part
    share = np.clip((mesh.points[:, 2] - eave[part]) / np.maximum(rise[part], 1e-9), 0.0, 1.0)
    here, there = knots[part], heights[part]
    step = np.clip((share[:, None] >= here).sum(axis=1) - 1, 0, here.shape[1] - 2)
    at = np.arange(len(part))
    run = np.maximum(here[at, step + 1] - here[at, step], 1e-12)
    along = (share - here[at, step]) / run
    bent = there[at, step] + along * (there[at, step + 1] - there[at, step])
    return mesh.with_heights(eave[part] + rise[part] * bent)


def crossed_mesh(
    polygons: NDArray[Any], angle: FloatArray, eave: FloatArray, rise: FloatArray
) -> RoofMesh:
    """Lay two gabled roofs at right angles over outlines and keep the higher of the two.

    Parameters
    ----------
    polygons
        (n,) valid polygons; empty ones are passed over.
    angle
        (n,) radians, direction of one of the two ridges.
    eave, rise
        (n,) metres.
    """
    mesh = flat_mesh(polygons, eave)
    if len(mesh.faces) == 0:
        return mesh
    local = aligned(mesh.rings.points, mesh.part, angle)
    low, high = np.full((mesh.count, 2), np.inf), np.full((mesh.count, 2), -np.inf)
    np.minimum.at(low, mesh.part, local)
    np.maximum.at(high, mesh.part, local)
    absent = low >= high
    low[absent], high[absent] = -1.0, 1.0
    half, middle = (high - low) / 2, (high + low) / 2
    for line in ((0.0, 1.0), (1.0, 0.0), (1.0, 1.0), (1.0, -1.0)):
        part = mesh.part
        place = (aligned(mesh.points[:, :2], part, angle) - middle[part]) / half[part]
        reach = half[part].min(axis=1)
        mesh = cut_mesh(mesh, (place @ np.array(line)) * reach)
    part = mesh.part
    place = (aligned(mesh.points[:, :2], part, angle) - middle[part]) / half[part]
    share = 1.0 - np.abs(place).min(axis=1)
    return mesh.with_heights(eave[part] + rise[part] * np.clip(share, 0.0, 1.0))


def edge_slopes(mesh: RoofMesh) -> FloatArray:
    """Return how steeply the roof beside each ring edge rises along x and y, (m, 2).

    NaN where the face beside the edge is upright or missing.
    """
    m, points = len(mesh.head), mesh.points
    total = len(points)
    begin, end = mesh.faces.ravel(), np.roll(mesh.faces, -1, axis=1).ravel()
    outer = np.flatnonzero((begin < m) & (end < m))
    key = begin[outer] * total + end[outer]
    order = np.argsort(key, kind="stable")
    asked = np.arange(m) * total + mesh.rings.following()
    at = np.minimum(np.searchsorted(key[order], asked), max(len(order) - 1, 0))
    found = np.full((m, 2), np.nan)
    if len(order) == 0:
        return found
    known = np.flatnonzero(key[order][at] == asked)
    face = mesh.faces[outer[order[at[known]]] // 3]
    a, b, c = points[face[:, 0]], points[face[:, 1]], points[face[:, 2]]
    normal = np.cross(b - a, c - a)
    upright = normal[:, 2] < 1e-3 * np.maximum(np.linalg.norm(normal, axis=1), 1e-12)
    slope = -normal[:, :2] / np.where(upright, 1.0, normal[:, 2])[:, None]
    slope[upright] = np.nan
    found[known] = slope
    return found


def empty_mesh(count: int) -> RoofMesh:
    """Return roofs over no outline of `count`."""
    return flat_mesh(np.full(count, shapely.Polygon(), dtype=object), np.zeros(count))
