"""Roofs whose planes rise from every eave: hipped, half-hipped, side-hipped, gabled wings.

Rectangles have a closed form. Other outlines take the straight skeleton of CGAL, in which every
point is as high as it is far from its own eave.

References
----------
Aichholzer et al., "A novel type of skeleton for polygons", J. UCS 1995 (straight skeleton).
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.geometry.extrude import Plan, plan_of, roofed
from cityx.geometry.polygons import FloatArray, IntArray, Rings, rings_of, triangulate
from cityx.geometry.solids import MIN_FACE, NO_VERTEX, Solids, as_quads, no_solids

SQUARE_CORNER = np.sin(np.radians(3.0))  # a corner this close to square counts as square
MIN_CLEARANCE = 0.01  # metres between any two parts of an outline
MAX_POINTS = 400  # an outline with more takes CGAL seconds
MERGE = 0.02  # metres; roofs need not be planar to less
MIN_RIDGE = 0.05  # metres; the ridge of a square roof, so that no face collapses
MAX_RIDGE_FALL = 0.15  # rise over run of a ridge that still ends in a gable
END_ROOM = 0.12  # share of an end wall left on either side of its gable
HALF = 0.5  # share of its height at which a half hip starts


def is_rectangle(rings: Rings, count: int) -> NDArray[np.bool_]:
    """Mark the polygons of one ring, four points and square corners, (count,) bool."""
    number = np.bincount(rings.polygon, minlength=count)
    ring = np.flatnonzero((np.diff(rings.start) == 4) & (number[rings.polygon] == 1))
    corner = rings.points[rings.start[ring][:, None] + np.arange(4)]
    edge = np.roll(corner, -1, axis=1) - corner
    edge /= np.maximum(np.linalg.norm(edge, axis=2), 1e-9)[:, :, None]
    cosine = (edge * np.roll(edge, -1, axis=1)).sum(axis=2)
    found = np.zeros(count, bool)
    found[rings.polygon[ring[(np.abs(cosine) < SQUARE_CORNER).all(axis=1)]]] = True
    return found


# Faces over the numbered points of a rectangle p0..p3 whose first edge is long. A and B are the
# ends of the ridge near p3-p0 and p1-p2. "ring" lists the wall heads in order.
@dataclass(frozen=True)
class _Template:
    bottom: tuple[tuple[int, int, int], ...]
    roof: tuple[tuple[int, int, int], ...]


_HIPPED = _Template(  # 0..3 corners, 4 = A, 5 = B
    ((0, 1, 2), (0, 2, 3)),
    ((0, 1, 5), (0, 5, 4), (1, 2, 5), (2, 3, 4), (2, 4, 5), (3, 0, 4)),
)
_SIDE_HIPPED = _Template(  # ring p0 p1 p2 p3 gable, 5 = B
    ((0, 1, 4), (4, 1, 2), (4, 2, 3)),
    ((0, 1, 5), (0, 5, 4), (1, 2, 5), (2, 3, 4), (2, 4, 5)),
)
_HALF_HIPPED = _Template(  # ring p0 p1 a1 a2 p2 p3 b1 b2, 8 = A, 9 = B
    ((0, 1, 2), (0, 2, 7), (7, 2, 3), (7, 3, 6), (6, 3, 4), (6, 4, 5)),
    (
        (0, 1, 2), (0, 2, 9), (0, 9, 8), (0, 8, 7),
        (4, 5, 6), (4, 6, 8), (4, 8, 9), (4, 9, 3),
        (2, 3, 9), (6, 7, 8),
    ),
)  # fmt: skip


@dataclass(frozen=True)
class SkeletonRoofs:
    """Roofs over n outlines.

    Attributes
    ----------
    solids
        Shells; an outline without a usable skeleton has none.
    rings
        The wall heads, m points; gables add points to the outline.
    eave_z
        (m,) height of the wall head at each ring point.
    level_edge
        (m,) bool, whether the edge that starts at a point is a level eave.
    slope
        (n,) rise over run of the roof planes.
    """

    solids: Solids
    rings: Rings
    eave_z: FloatArray
    level_edge: NDArray[np.bool_]
    slope: FloatArray


def rectangle_roofs(
    polygons: NDArray[Any],
    kind: str,
    angle: FloatArray,
    low: FloatArray,
    eave: FloatArray,
    rise: FloatArray,
    zero: FloatArray,
) -> SkeletonRoofs:
    """Raise rectangles under a roof of one kind.

    Parameters
    ----------
    polygons
        (n,) rectangles, see `is_rectangle`; empty ones are passed over.
    kind
        "hipped", "side_hipped" or "half-hipped".
    angle
        (n,) radians, direction of the ridge; the nearer pair of sides carries it.
    low, eave, rise, zero
        (n,) metres, as in `cityx.geometry.roof_profiles.profile_roofs`.
    """
    count = len(polygons)
    source = rings_of(polygons)
    rows = source.polygon
    k = len(rows)
    p = source.points.reshape(k, 4, 2)
    first = p[:, 1] - p[:, 0]
    cosine = first[:, 0] * np.cos(angle[rows]) + first[:, 1] * np.sin(angle[rows])
    along = np.abs(cosine) >= np.linalg.norm(first, axis=1) * np.sqrt(0.5)
    p = np.where(along[:, None, None], p, np.roll(p, -1, axis=1))
    width = np.linalg.norm(p[:, 2] - p[:, 1], axis=1)
    length = np.linalg.norm(p[:, 1] - p[:, 0], axis=1)
    a, b = (p[:, 3] + p[:, 0]) / 2, (p[:, 1] + p[:, 2]) / 2
    axis = (b - a) / np.maximum(length, 1e-9)[:, None]
    share = HALF if kind == "half-hipped" else 1.0
    inset = np.minimum(width / 2 * share, length / 2 - MIN_RIDGE / 2)[:, None]
    ridge_a, ridge_b = a + axis * inset, b - axis * inset
    base, summit = eave[rows], (eave + rise)[rows]
    if kind == "hipped":
        template, ring, extra = _HIPPED, p, [ridge_a, ridge_b]
        head = np.repeat(base[:, None], 4, axis=1)
        level = np.ones((k, 4), bool)
    elif kind == "side_hipped":
        template, extra = _SIDE_HIPPED, [ridge_b]
        ring = np.concatenate([p, a[:, None]], axis=1)
        head = np.column_stack([np.repeat(base[:, None], 4, axis=1), summit])
        level = np.tile([True, True, True, False, False], (k, 1))
    else:
        template, extra = _HALF_HIPPED, [ridge_a, ridge_b]
        near, far = HALF / 2, 1 - HALF / 2
        ends = [p[:, 1] + (p[:, 2] - p[:, 1]) * near, p[:, 1] + (p[:, 2] - p[:, 1]) * far]
        ends += [p[:, 3] + (p[:, 0] - p[:, 3]) * near, p[:, 3] + (p[:, 0] - p[:, 3]) * far]
        ring = np.stack([p[:, 0], p[:, 1], *ends[:2], p[:, 2], p[:, 3], *ends[2:]], axis=1)
        middle = base + (summit - base) * HALF
        head = np.stack([base, base, middle, middle, base, base, middle, middle], axis=1)
        level = np.tile([True, False, False, False, True, False, False, False], (k, 1))
    size = ring.shape[1]
    rings = Rings(ring.reshape(-1, 2), np.arange(k + 1) * size, rows, np.zeros(k, bool))
    bottom = (np.array(template.bottom) + (np.arange(k) * size)[:, None, None]).reshape(-1, 3)
    plan = Plan(rings, bottom, np.repeat(rows, len(template.bottom)), count)
    tops = np.stack(extra, axis=1)  # (k, e, 2)
    number = tops.shape[1]
    faces = np.array(template.roof)  # (t, 3) over ring then extras
    on_ring = faces < size
    index = np.where(
        on_ring,
        faces + (np.arange(k) * size)[:, None, None],
        faces - size + k * size + (np.arange(k) * number)[:, None, None],
    ).reshape(-1, 3)
    solids = roofed(
        plan,
        low,
        head.ravel(),
        zero,
        as_quads(index),
        np.repeat(rows, len(template.roof)),
        extra=np.column_stack([tops.reshape(-1, 2), np.repeat(summit, number)]),
        extra_part=np.repeat(rows, number),
    )
    slope = np.zeros(count)
    slope[rows] = rise[rows] / np.maximum(width / 2, 0.1)
    return SkeletonRoofs(solids, rings, head.ravel(), level.ravel(), slope)


@contextmanager
def _silenced() -> Iterator[None]:
    """Send what C++ code writes to the two standard streams to nowhere."""
    kept = [os.dup(1), os.dup(2)]
    nowhere = os.open(os.devnull, os.O_WRONLY)
    try:
        os.dup2(nowhere, 1)
        os.dup2(nowhere, 2)
        yield
    finally:
        for number, descriptor in zip((1, 2), kept, strict=True):
            os.dup2(descriptor, number)
            os.close(descriptor)
        os.close(nowhere)


@dataclass
class _Skeleton:
    """Skeleton of one outline: plan points with their distance from the eave, faces over them."""

    rings: list[list[int]]  # point numbers of every ring, in order
    points: FloatArray  # (v, 3)
    faces: list[list[int]]
    gables: set[int] = field(default_factory=set)  # points that became gables


def _admitted(polygons: NDArray[Any]) -> NDArray[np.bool_]:
    """Tell which outlines may be handed to CGAL, which ends the process on touching rings."""
    admitted = ~shapely.is_empty(polygons)
    admitted &= shapely.get_num_coordinates(polygons) <= MAX_POINTS
    rows = np.flatnonzero(admitted)
    admitted[rows] = shapely.is_valid(polygons[rows])
    rows = np.flatnonzero(admitted)
    admitted[rows] = shapely.minimum_clearance(polygons[rows]) >= MIN_CLEARANCE
    return np.asarray(admitted)


def _skeleton_of(polygon: Any) -> _Skeleton | None:
    """Run CGAL on one polygon; None when it fails or returns something else than a roof."""
    from compas_cgal import _straight_skeleton_2

    contours = [np.asarray(ring.coords)[:-1, :2] for ring in (polygon.exterior, *polygon.interiors)]
    origin = contours[0][0]
    contours = [np.ascontiguousarray(contour - origin) for contour in contours]
    weights = [[1.0] * len(contour) for contour in contours]
    try:
        vertices, faces = _straight_skeleton_2.extrude_straight_skeleton(
            contours[0], contours[1:], weights, False, 0.0
        )
    except (RuntimeError, ValueError):
        return None
    vertices = np.asarray(vertices)
    if len(vertices) == 0 or not np.isfinite(vertices).all():
        return None
    numbered = _numbered(contours, vertices)
    if numbered is None:
        return None
    rings, vertices = numbered
    position = {v: (r, k) for r, ring in enumerate(rings) for k, v in enumerate(ring)}
    roof = []
    for face in faces:
        corner = vertices[list(face)]
        if (corner[:, 2] <= 0.0).all():
            continue
        x, y = corner[:, 0], corner[:, 1]
        area = float(np.dot(x, np.roll(y, -1)) - np.dot(y, np.roll(x, -1)))
        turned = list(face) if area > 0 else list(face)[::-1]
        roof.append(_with_dropped(turned, rings, position))
    vertices[:, :2] += origin
    return _Skeleton(rings, vertices, _merged(roof, vertices, position))


def _merged(
    faces: list[list[int]], points: FloatArray, position: dict[int, tuple[int, int]]
) -> list[list[int]]:
    """Collapse edges shorter than `MERGE` between inner points; events at almost one time."""
    target: dict[int, int] = {}

    def root(v: int) -> int:
        while v in target:
            v = target[v]
        return v

    for face in faces:
        place = points[face]
        short = np.abs(place - np.roll(place, -1, axis=0)).max(axis=1) < MERGE
        for k in np.flatnonzero(short).tolist():
            here, there = root(face[k]), root(face[(k + 1) % len(face)])
            if here != there and here not in position and there not in position:
                target[max(here, there)] = min(here, there)
    if not target:
        return faces
    merged = []
    for face in faces:
        moved = [root(v) for v in face]
        distinct = [v for k, v in enumerate(moved) if v != moved[k - 1]]
        if len(distinct) < 3:
            continue
        x, y = points[distinct, 0], points[distinct, 1]
        area = float(np.dot(x, np.roll(y, -1)) - np.dot(y, np.roll(x, -1))) / 2
        if len(set(distinct)) < len(distinct) or area < MIN_FACE:
            return faces  # the collapse would fold a face; the tiny edge stays
        merged.append(distinct)
    edges = [pair for face in merged for pair in zip(face, face[1:] + face[:1], strict=True)]
    return merged if len(set(edges)) == len(edges) else faces


def _numbered(
    contours: list[FloatArray], vertices: FloatArray
) -> tuple[list[list[int]], FloatArray] | None:
    """Assign numbers to contour points; points that CGAL merged away are added at the end."""
    floor = np.flatnonzero(vertices[:, 2] <= 0.0)
    known = {
        (round(float(x), 6), round(float(y), 6)): int(v)
        for v, (x, y) in zip(floor, vertices[floor, :2], strict=True)
    }
    added: list[list[float]] = []
    rings: list[list[int]] = []
    for contour in contours:
        ring = []
        for x, y in contour.tolist():
            number = known.pop((round(x, 6), round(y, 6)), -1)
            if number < 0:
                number = len(vertices) + len(added)
                added.append([x, y, 0.0])
            ring.append(number)
        rings.append(ring)
    if known:  # a floor point that belongs to no contour
        return None
    return rings, np.concatenate([vertices, np.array(added).reshape(-1, 3)])


def _with_dropped(
    face: list[int], rings: list[list[int]], position: dict[int, tuple[int, int]]
) -> list[int]:
    """Put the contour points between two eave points of a face back into it."""
    full: list[int] = []
    for here, there in zip(face, [*face[1:], face[0]], strict=True):
        full.append(here)
        if here not in position or there not in position:
            continue
        (ring, k), (other, last) = position[here], position[there]
        if ring == other:
            points = rings[ring]
            between = (last - k - 1) % len(points)
            full += [points[(k + 1 + step) % len(points)] for step in range(between)]
    return full


def _raise_ends(skeleton: _Skeleton, share: float) -> None:
    """Raise the walls under hipped ends: to the ridge (share 1, a gable) or part of the way.

    The ridge runs on toward the wall by the same share; the planes beside it stay as they are.
    """
    points = skeleton.points
    kept: list[list[int]] = []
    neighbours: dict[int, set[int]] = {}
    for face in skeleton.faces:
        for here, there in zip(face, [*face[1:], face[0]], strict=True):
            neighbours.setdefault(here, set()).add(there)
            neighbours.setdefault(there, set()).add(here)
    following = {
        here: (number, there)
        for number, ring in enumerate(skeleton.rings)
        for here, there in zip(ring, [*ring[1:], ring[0]], strict=True)
    }
    between: dict[tuple[int, int], int] = {}
    moved: set[int] = set()
    for face in skeleton.faces:
        apex = _gable_apex(face, points, neighbours, following)
        if apex is None or apex[0] in moved:
            kept.append(face)
            continue
        top, place, start = apex
        moved.add(top)
        number, end = following[start]
        ring = skeleton.rings[number]
        if share >= 1.0:
            points[top, :2] = place
            heads = [top]
        else:
            head = np.append(place, points[top, 2])
            ends = points[[start, end]] + (head - points[[start, end]]) * share
            heads = [len(points), len(points) + 1]
            points[top, :2] += (place - points[top, :2]) * share
            points = np.concatenate([points, ends])
            kept.append([*heads, top])
            between[(start, top)] = between[(top, start)] = heads[0]
            between[(end, top)] = between[(top, end)] = heads[1]
        ring[ring.index(start) + 1 : ring.index(start) + 1] = heads
        skeleton.gables.update(heads)
    skeleton.points = points
    skeleton.faces = [_with_between(face, between) for face in kept]


def _with_between(face: list[int], between: dict[tuple[int, int], int]) -> list[int]:
    """Put the new points on the edges of a face into it."""
    full: list[int] = []
    for here, there in zip(face, [*face[1:], face[0]], strict=True):
        full.append(here)
        if (here, there) in between:
            full.append(between[(here, there)])
    return full


def _gable_apex(
    face: list[int],
    points: FloatArray,
    neighbours: dict[int, set[int]],
    following: dict[int, tuple[int, int]],
) -> tuple[int, FloatArray, int] | None:
    """Apex of a hipped end, where it goes, and the start of its wall; None for other faces."""
    if len(face) != 3:
        return None
    for turn in range(3):
        start, end, top = face[turn], face[(turn + 1) % 3], face[(turn + 2) % 3]
        if start in following and following[start][1] == end and top not in following:
            break
    else:
        return None
    others = neighbours[top] - {start, end}
    if len(others) != 1:
        return None
    inner = points[others.pop()]
    ridge = points[top] - inner
    run = float(np.hypot(ridge[0], ridge[1]))
    if run < 0.3 or abs(float(ridge[2])) > MAX_RIDGE_FALL * run:
        return None
    wall = points[end, :2] - points[start, :2]
    cross = float(ridge[0] * wall[1] - ridge[1] * wall[0])
    if abs(cross) < 0.5 * run * float(np.hypot(*wall)):
        return None
    gap = points[start, :2] - inner[:2]
    share = float(ridge[1] * gap[0] - ridge[0] * gap[1]) / cross
    if not END_ROOM < share < 1 - END_ROOM:
        return None
    return top, points[start, :2] + wall * share, start


def skeleton_roofs(
    polygons: NDArray[Any],
    ends: FloatArray,
    low: FloatArray,
    eave: FloatArray,
    rise: FloatArray,
    zero: FloatArray,
) -> SkeletonRoofs:
    """Raise outlines under hipped roofs of one pitch, their ends raised where asked.

    Parameters
    ----------
    polygons
        (n,) valid polygons; empty ones are passed over.
    ends
        (n,) how far up the wall is raised under the ends of wings: 0 for hips, 1 for gables.
    low, eave, rise, zero
        (n,) metres, as in `cityx.geometry.roof_profiles.profile_roofs`.
    """
    polygons = shapely.orient_polygons(np.asarray(polygons, dtype=object))
    count = len(polygons)
    found: list[tuple[int, _Skeleton]] = []
    with _silenced():
        for row in np.flatnonzero(_admitted(polygons)).tolist():
            skeleton = _skeleton_of(polygons[row])
            if skeleton is not None and skeleton.points[:, 2].max() > 0:
                if ends[row] > 0:
                    _raise_ends(skeleton, float(ends[row]))
                found.append((row, skeleton))
    return _gathered(found, count, low, eave, rise, zero)


def _gathered(
    found: list[tuple[int, _Skeleton]],
    count: int,
    low: FloatArray,
    eave: FloatArray,
    rise: FloatArray,
    zero: FloatArray,
) -> SkeletonRoofs:
    """Join skeletons to solids."""
    slope = np.zeros(count)
    outlines = np.full(count, shapely.Polygon(), dtype=object)
    heads, levels, extras, extra_part = [], [], [], []
    faces: list[list[int]] = []
    face_part: list[int] = []
    ring_total = sum(len(ring) for _, skeleton in found for ring in skeleton.rings)
    ring_at, extra_at = 0, ring_total
    for row, skeleton in found:
        number: dict[int, int] = {}
        for ring in skeleton.rings:
            number.update(zip(ring, range(ring_at, ring_at + len(ring)), strict=True))
            ring_at += len(ring)
            gable = [v in skeleton.gables for v in ring]
            levels += [
                not (here or there)
                for here, there in zip(gable, [*gable[1:], gable[0]], strict=True)
            ]
        order = [v for ring in skeleton.rings for v in ring]
        summit = float(skeleton.points[:, 2].max())
        slope[row] = rise[row] / summit
        z = eave[row] + skeleton.points[:, 2] * slope[row]
        heads.append(z[order])
        inner = sorted({v for face in skeleton.faces for v in face} - number.keys())
        number.update(zip(inner, range(extra_at, extra_at + len(inner)), strict=True))
        extra_at += len(inner)
        extras.append(np.column_stack([skeleton.points[inner, :2], z[inner]]))
        extra_part += [row] * len(inner)
        shell, *holes = (skeleton.points[ring, :2] for ring in skeleton.rings)
        outlines[row] = shapely.Polygon(shell, holes)
        faces += [[number[v] for v in face] for face in skeleton.faces]
        face_part += [row] * len(skeleton.faces)
    if not found:
        none = np.zeros(0)
        return SkeletonRoofs(no_solids(), rings_of(outlines), none, none.astype(bool), slope)
    rings = rings_of(outlines)
    plan = plan_of(outlines)
    head = np.concatenate(heads)
    extra = np.concatenate(extras)
    places = np.concatenate([rings.points, extra[:, :2]])
    roof, roof_part = _as_faces(faces, np.array(face_part, np.int64), places)
    solids = roofed(
        plan,
        low,
        head,
        zero,
        roof,
        roof_part,
        extra=extra,
        extra_part=np.array(extra_part, np.int64),
    )
    return SkeletonRoofs(solids, rings, head, np.array(levels, bool), slope)


def _as_faces(
    faces: list[list[int]], part: IntArray, places: FloatArray
) -> tuple[IntArray, IntArray]:
    """Cut faces of many corners into triangles in plan; triangles stay as they are."""
    size = np.array([len(face) for face in faces])
    simple = np.flatnonzero(size == 3)
    index = [
        np.column_stack(
            [
                np.array([faces[f] for f in simple], np.int64).reshape(-1, 3),
                np.full(len(simple), NO_VERTEX),
            ]
        )
    ]
    owner = [part[simple]]
    many = np.flatnonzero(size > 3)
    if len(many):
        flat = np.concatenate([np.array(faces[f], np.int64) for f in many])
        start = np.concatenate([[0], np.cumsum(size[many])]).astype(np.int64)
        rings = Rings(places[flat], start, np.arange(len(many)), np.zeros(len(many), bool))
        closed = np.insert(flat, start[1:], flat[start[:-1]])
        lines = shapely.linearrings(
            places[closed], indices=np.repeat(np.arange(len(many)), size[many] + 1)
        )
        mesh = triangulate(shapely.polygons(lines), rings)
        index.append(as_quads(flat[mesh.triangles]))
        owner.append(part[many[mesh.polygon]])
    return np.concatenate(index), np.concatenate(owner)
