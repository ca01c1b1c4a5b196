"""Faces of a plane graph: which edges go round each, and the triangles that fill it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.geometry.arrays import IntArray
from cityx.geometry.ranges import counted, numbered
from cityx.system.cores import in_threads

OUTSIDE = -1  # the face beyond the outermost edges
BATCH = 2500  # faces that a thread triangulates at once; a triangle as a polygon has 500 bytes


@dataclass(frozen=True)
class Faces:
    """f faces between the edges of a plane graph.

    Attributes
    ----------
    points
        (n, 2) int64, grid steps, all of them corners of faces, rising by x, then y.
    corner
        (c,) int64 into the points, ring after ring. Shells turn left, holes right, and no ring
        passes a point twice.
    start
        (r + 1,) int64, where each ring begins in `corner`.
    ring_face
        (r,) int64, the face of each ring, rising; its shell comes first.
    edges
        (k, 2) int64 into the points; each edge once, inner ones from the lower point.
    edge_faces
        (k, 2) int64, the faces left and right of them, `OUTSIDE` beyond the outermost.
    """

    points: IntArray
    corner: IntArray
    start: IntArray
    ring_face: IntArray
    edges: IntArray
    edge_faces: IntArray

    @property
    def count(self) -> int:
        """Number of faces."""
        return int(self.ring_face[-1]) + 1 if len(self.ring_face) else 0

    def polygons(self, faces: IntArray) -> NDArray[Any]:
        """Return some of the faces as shapely Polygons, grid steps."""
        at, row, owner = self._corners(faces)
        loops = shapely.linearrings(self.points[self.corner[at]].astype(float), indices=row)
        return np.asarray(shapely.polygons(loops, indices=owner))

    def _corners(self, faces: IntArray) -> tuple[IntArray, IntArray, IntArray]:
        """Return places in `corner` of some faces, rising, the ring of each, and the face of rings.

        Rings and faces are numbered among the chosen ones.
        """
        low, high = (np.searchsorted(self.ring_face, faces, side) for side in ("left", "right"))
        owner, number = counted(high - low)
        ring = low[owner] + number
        row, into = counted(np.diff(self.start)[ring])
        return self.start[ring][row] + into, row, owner

    def triangles(self) -> tuple[IntArray, IntArray]:
        """Fill the faces: corners of triangles that turn left, (t, 3), and their faces, (t,)."""
        first = np.flatnonzero(np.r_[True, self.ring_face[1:] != self.ring_face[:-1]])
        rings = np.bincount(self.ring_face, minlength=self.count)
        size = np.where(rings == 1, np.diff(self.start)[first], 0)
        begin = self.start[first]
        three, four = np.flatnonzero(size == 3), np.flatnonzero(size == 4)
        corners = [self.corner[begin[three][:, None] + np.arange(3)]]
        corners.append(_halves(self.points, self.corner[begin[four][:, None] + np.arange(4)]))
        owners = [three, np.repeat(four, 2)]
        rest = np.flatnonzero((size != 3) & (size != 4))
        key = (self.points[:, 0] << np.int64(32)) + self.points[:, 1]

        def some(low: int) -> tuple[IntArray, IntArray]:
            rows = rest[low : low + BATCH]
            cut, owner = shapely.get_coordinates(
                shapely.constrained_delaunay_triangles(self.polygons(rows)), return_index=True
            )
            # A triangle is a closed ring of four points.
            spots = np.rint(cut.reshape(-1, 4, 2)[:, :3].reshape(-1, 2)).astype(np.int64)
            # Looked for among the corners of these faces alone, which lie together in memory.
            own = np.unique(self.corner[self._corners(rows)[0]])
            at = own[np.searchsorted(key[own], (spots[:, 0] << 32) + spots[:, 1])]
            return at.reshape(-1, 3), rows[owner[::4]]

        for made, owner in in_threads(some, range(0, len(rest), BATCH)):
            corners.append(made)
            owners.append(owner)
        face = np.concatenate(owners)
        order = np.argsort(face, kind="stable")
        found = np.concatenate(corners)[order]
        clockwise = doubled_areas(self.points, found) < 0
        found[clockwise] = found[clockwise][:, ::-1]
        return found, face[order]


def trace_faces(points: IntArray, edges: IntArray) -> Faces:
    """Find the faces of a plane graph.

    Parameters
    ----------
    points
        (n, 2) int64, distinct, rising by x, then y.
    edges
        (k, 2) int64 into the points, the lower one first; they meet at points alone. Those with
        one face on both sides, which bound nothing, are left out.

    Returns
    -------
    faces
        In the order of their lowest points.
    """
    turning = _turning(points, edges)
    while True:
        after = _followers(edges, turning)
        label = _cycles(after)
        idle = label[0::2] == label[1::2]
        if not idle.any():
            break
        kept = np.repeat(~idle, 2)
        turning = (np.cumsum(kept) - 1)[turning[kept[turning]]]
        edges = edges[~idle]
    used = np.zeros(len(points), bool)
    used[edges] = True
    points, edges = points[used], (np.cumsum(used) - 1)[edges]
    source = edges.ravel()
    order, start = _in_turn(after, label, source)
    corner = source[order]
    loop, loop_start, parent = _simple_loops(corner, start)
    area = _doubled(points, loop, loop_start)
    face_of_loop = _assigned(points, loop, loop_start, parent, area)
    # Faces by their lowest points; two that share it, by the next corners of their shells.
    shell = np.flatnonzero(area > 0)
    low = loop_start[shell]
    rank = np.lexsort((loop[low + 1], loop[low]))
    number = np.full(len(area) + 1, OUTSIDE)
    number[shell[rank]] = np.arange(len(shell))
    face = number[face_of_loop]
    of_label = np.full(len(start) - 1, OUTSIDE)
    of_label[parent] = face
    kept = np.flatnonzero(face != OUTSIDE)
    kept = kept[np.lexsort((loop[loop_start[kept]], area[kept] < 0, face[kept]))]
    size = np.diff(loop_start)[kept]
    row = np.repeat(np.arange(len(kept)), size)
    begin = np.concatenate([[0], np.cumsum(size)])
    at = np.arange(len(row)) - begin[row] + loop_start[kept][row]
    sides = of_label[label].reshape(-1, 2)
    beyond = sides[:, 0] == OUTSIDE
    edges = np.where(beyond[:, None], edges[:, ::-1], edges)
    sides = np.where(beyond[:, None], sides[:, ::-1], sides)
    return Faces(points, loop[at], begin, face[kept], edges, sides)


def doubled_areas(points: NDArray[Any], triangles: NDArray[Any]) -> NDArray[Any]:
    """(t,) twice the signed area of each triangle; exact on whole numbers."""
    # Axis by axis and in place, which takes a third of the time of rows.
    x, y = (np.ascontiguousarray(axis) for axis in points.T[:2])
    one, two, three = (np.ascontiguousarray(corner) for corner in triangles.T)
    ax, ay = x[one], y[one]
    area, other = x[two], y[two]
    area -= ax
    other -= ay
    up, along = y[three], x[three]
    up -= ay
    along -= ax
    area *= up
    other *= along
    area -= other
    return np.asarray(area)


def _turning(points: IntArray, edges: IntArray) -> IntArray:
    """(2k,) the half edges point by point, about each to the left.

    Half edge 2i runs along edge i, half edge 2i + 1 back.
    """
    source = edges.ravel()
    turning = np.argsort(source, kind="stable")
    # About a point with two half edges, as most are, any order is the same.
    several = np.flatnonzero(np.bincount(source)[source[turning]] > 2)
    half = turning[several]
    ahead = (points[edges[half >> 1, 1]] - points[edges[half >> 1, 0]]).astype(float)
    ahead *= np.where(half & 1, -1.0, 1.0)[:, None]
    # Two directions between grid points differ by far more than angles are rounded by.
    order = np.lexsort((np.arctan2(ahead[:, 1], ahead[:, 0]), source[half]))
    turning[several] = half[order]
    return np.asarray(turning, np.int64)


def _followers(edges: IntArray, turning: IntArray) -> IntArray:
    """(2k,) the half edge that follows each round the face on its left."""
    source = edges.ravel()[turning]
    head = np.r_[True, source[1:] != source[:-1]][: len(turning)]
    first = np.flatnonzero(head)
    last = np.r_[first[1:], len(turning)] - 1
    before = np.arange(len(turning)) - 1
    before[first] = last
    clockwise = np.empty(len(turning), np.int64)
    clockwise[turning] = turning[before]
    return np.asarray(clockwise[np.arange(len(turning)) ^ 1])


def _cycles(after: IntArray) -> IntArray:
    """(h,) number of the cycle that each half edge belongs to."""
    from scipy.sparse import csr_array
    from scipy.sparse.csgraph import connected_components

    size = len(after)
    graph = csr_array((np.ones(size, np.int8), after, np.arange(size + 1)), shape=(size, size))
    return np.asarray(connected_components(graph, directed=True, connection="weak")[1], np.int64)


def _in_turn(after: IntArray, label: IntArray, source: IntArray) -> tuple[IntArray, IntArray]:
    """Half edges cycle by cycle, each from its lowest point on, and where the cycles begin."""
    size = len(after)
    order = np.lexsort((source, label))
    count = np.bincount(label)
    start = np.concatenate([[0], np.cumsum(count)])
    # Steps to the end of the cycle, by pointer doubling; the last half edge leads to the first.
    last = np.zeros(size, bool)
    begins = np.zeros(size, bool)
    begins[order[start[:-1]]] = True
    last[begins[after]] = True
    jump = np.where(last, -1, after)
    steps = (~last).astype(np.int64)
    alive = np.flatnonzero(jump >= 0)
    while len(alive):
        to = jump[alive]
        gained, onward = steps[to], jump[to]
        steps[alive] += gained
        jump[alive] = onward
        alive = alive[onward >= 0]
    rank = count[label] - 1 - steps
    placed = np.empty(size, np.int64)
    placed[start[label] + rank] = np.arange(size)
    return placed, start


def _simple_loops(corner: IntArray, start: IntArray) -> tuple[IntArray, IntArray, IntArray]:
    """Part cycles that pass a point twice there: corners, where loops begin, and their cycles."""
    count = np.diff(start)
    cycle = np.repeat(np.arange(len(count)), count)
    order = np.lexsort((corner, cycle))
    twice = (np.diff(corner[order]) == 0) & (np.diff(cycle[order]) == 0)
    pinched = np.unique(cycle[order[1:][twice]])
    whole = np.ones(len(count), bool)
    whole[pinched] = False
    loops: list[list[int]] = []
    owner: list[int] = []
    for row in pinched.tolist():
        stack: list[int] = []
        seen: dict[int, int] = {}
        for point in corner[start[row] : start[row + 1]].tolist():
            if point in seen:
                at = seen[point]
                loops.append(stack[at:])
                owner.append(row)
                for gone in stack[at:]:
                    del seen[gone]
                del stack[at:]
            seen[point] = len(stack)
            stack.append(point)
        loops.append(stack)
        owner.append(row)
    turned = [loop[loop.index(min(loop)) :] + loop[: loop.index(min(loop))] for loop in loops]
    size = np.concatenate([count[whole], np.array([len(loop) for loop in turned], np.int64)])
    parts = [corner[whole[cycle]], *(np.array(loop, np.int64) for loop in turned)]
    parent = np.concatenate([np.flatnonzero(whole), np.array(owner, np.int64)])
    return np.concatenate(parts), np.concatenate([[0], np.cumsum(size)]), parent


def _doubled(points: IntArray, loop: IntArray, start: IntArray) -> IntArray:
    """(l,) twice the signed area of loops."""
    size = np.diff(start)
    row = np.repeat(np.arange(len(size)), size)
    onward = np.arange(1, len(loop) + 1)
    onward[start[1:] - 1] = start[:-1]
    own = points[loop] - points[loop[start[:-1]]][row]
    other = own[onward]
    return np.add.reduceat(own[:, 0] * other[:, 1] - own[:, 1] * other[:, 0], start[:-1])


def _assigned(
    points: IntArray, loop: IntArray, start: IntArray, parent: IntArray, area: IntArray
) -> IntArray:
    """(l,) the shell each loop belongs to: itself, or the smallest round a hole; -1 for none."""
    shell, hole = np.flatnonzero(area > 0), np.flatnonzero(area < 0)
    found = np.full(len(area), OUTSIDE)
    found[shell] = shell
    # A hole that touches its shell was one cycle with it.
    of_cycle = np.full(int(parent.max(initial=0)) + 1, OUTSIDE)
    of_cycle[parent[shell]] = shell
    found[hole] = of_cycle[parent[hole]]
    hole = hole[found[hole] == OUTSIDE]
    # The holes of one cycle hang together: where one lies, all lie.
    cycles, row = np.unique(parent[hole], return_index=True)
    spots = points[loop[start[hole[row]]]].astype(float)
    low = np.minimum.reduceat(points[loop], start[:-1], axis=0)[shell]
    high = np.maximum.reduceat(points[loop], start[:-1], axis=0)[shell]
    boxes = shapely.box(low[:, 0], low[:, 1], high[:, 0], high[:, 1])
    spot, at = shapely.STRtree(boxes).query(shapely.points(spots))
    near, which = np.unique(at, return_inverse=True)
    size = np.diff(start)[shell[near]]
    ring = np.repeat(np.arange(len(near)), size)
    into = numbered(size)
    rings = shapely.polygons(
        shapely.linearrings(
            points[loop[start[shell[near]][ring] + into]].astype(float), indices=ring
        )
    )
    shapely.prepare(rings)
    inside = shapely.contains_xy(rings[which], *spots[spot].T)
    spot, at = spot[inside], shell[at[inside]]
    order = np.lexsort((area[at], spot))
    spot, first = np.unique(spot[order], return_index=True)
    around = np.full(len(of_cycle), OUTSIDE)
    around[cycles[spot]] = at[order][first]
    found[hole] = around[parent[hole]]
    return found


def _halves(points: IntArray, corners: IntArray) -> IntArray:
    """Cut quadrilaterals, (q, 4) corners turning left, in two each, as Delaunay would: (2q, 3)."""
    one = np.stack([corners[:, [0, 1, 2]], corners[:, [0, 2, 3]]], axis=1)
    other = np.stack([corners[:, [0, 1, 3]], corners[:, [1, 2, 3]]], axis=1)
    fits = [
        (doubled_areas(points, pair.reshape(-1, 3)) > 0).reshape(-1, 2).all(axis=1)
        for pair in (one, other)
    ]
    a, b, c, d = np.moveaxis((points[corners] - points[corners[:, :1]]).astype(float), 1, 0)
    # Opposite angles at b and d sum to less than half a turn where the cut from a to c is right.
    u, v, w, x = a - b, c - b, c - d, a - d
    cross_b, dot_b = v[:, 0] * u[:, 1] - v[:, 1] * u[:, 0], (u * v).sum(axis=1)
    cross_d, dot_d = x[:, 0] * w[:, 1] - x[:, 1] * w[:, 0], (w * x).sum(axis=1)
    first = fits[0] & (~fits[1] | (cross_b * dot_d + dot_b * cross_d >= 0))
    return np.where(first[:, None, None], one, other).reshape(-1, 3)
