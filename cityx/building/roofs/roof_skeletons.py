"""Roofs over the straight skeleton: every point is as high as it is far from its own eave.

Hipped roofs of any outline; the ends of wings may be raised to half hips or gables. The skeleton
is CGAL's.

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

from cityx.building.roofs.roof_meshes import RoofMesh, empty_mesh
from cityx.geometry.arrays import FloatArray, IntArray
from cityx.geometry.polygons import Rings, rings_of, triangulate
from cityx.geometry.solids import MIN_FACE, ROOF, WALL

MIN_CLEARANCE = 0.01  # metres between any two parts of an outline
MAX_POINTS = 400  # an outline with more takes CGAL seconds
MERGE = 0.02  # metres; roofs need not be planar to less
MAX_RIDGE_FALL = 0.15  # rise over run of a ridge that still ends in a gable
END_ROOM = 0.12  # share of an end wall left on either side of its gable


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
    upright: set[int] = field(default_factory=set)  # faces that stand upright


def _admitted(polygons: NDArray[Any]) -> NDArray[np.bool_]:
    """Return which outlines are safe for CGAL, which ends the process on touching rings."""
    admitted = ~shapely.is_empty(polygons)
    admitted &= shapely.get_num_coordinates(polygons) <= MAX_POINTS
    rows = np.flatnonzero(admitted)
    admitted[rows] = shapely.is_valid(polygons[rows])
    rows = np.flatnonzero(admitted)
    admitted[rows] = shapely.minimum_clearance(polygons[rows]) >= MIN_CLEARANCE
    # Clearance passes over rings that share a point.
    for row in np.flatnonzero(admitted & (shapely.get_num_interior_rings(polygons) > 0)).tolist():
        rings = rings_of(polygons[row : row + 1])
        admitted[row] = len(np.unique(rings.points, axis=0)) == len(rings.points)
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
    place = vertices.tolist()
    for face in faces:
        corner = [place[v] for v in face]
        if all(point[2] <= 0.0 for point in corner):
            continue
        turned = list(face) if _plan_area(corner) > 0 else list(face)[::-1]
        roof.append(_with_dropped(turned, rings, position))
    vertices[:, :2] += origin
    return _Skeleton(rings, vertices, _merged(roof, vertices, position))


def _plan_area(corner: list[list[float]]) -> float:
    """Signed area of a face in plan; plain numbers are quicker than arrays for so few."""
    return 0.5 * sum(
        a[0] * b[1] - b[0] * a[1] for a, b in zip(corner, [*corner[1:], corner[0]], strict=True)
    )


def _merged(
    faces: list[list[int]], points: FloatArray, position: dict[int, tuple[int, int]]
) -> list[list[int]]:
    """Collapse edges shorter than `MERGE` between inner points; events at almost one time."""
    here = [v for face in faces for v in face]
    there = [v for face in faces for v in (*face[1:], face[0])]
    if not (np.abs(points[here] - points[there]).max(axis=1) < MERGE).any():
        return faces
    target: dict[int, int] = {}

    def root(v: int) -> int:
        while v in target:
            v = target[v]
        return v

    for face in faces:
        place = points[face]
        short = np.abs(place - np.roll(place, -1, axis=0)).max(axis=1) < MERGE
        for k in np.flatnonzero(short).tolist():
            one, two = root(face[k]), root(face[(k + 1) % len(face)])
            if one != two and one not in position and two not in position:
                target[max(one, two)] = min(one, two)
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


def _raise_ends(skeleton: _Skeleton, first: float, others: float, gablets: bool) -> int:
    """Raise the walls under hipped ends: to the ridge (share 1, a gable) or part of the way.

    The ridge runs on toward the wall by the same share; the planes beside it stay as they are.
    With `gablets` the hip stays below and ends in a small upright gable. `first` is the share of
    the first end that bears one, `others` that of the rest. Returns the number of ends.
    """
    points = skeleton.points
    kept: list[list[int]] = []
    upright: list[list[int]] = []
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
        share = others if moved else first
        if apex is None or apex[0] in moved or share <= 0.0:
            kept.append(face)
            if apex is not None:
                moved.add(apex[0])
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
            sides = points[[start, end]]
            ends = sides + ((points[top] if gablets else head) - sides) * share
            heads = [len(points), len(points) + 1]
            points[top, :2] += (place - points[top, :2]) * (1 - share if gablets else share)
            points = np.concatenate([points, ends])
            if gablets:
                kept.append([start, end, heads[1], heads[0]])
                upright.append([*heads, top])
            else:
                kept.append([*heads, top])
            between[(start, top)] = between[(top, start)] = heads[0]
            between[(end, top)] = between[(top, end)] = heads[1]
        if not gablets:
            ring[ring.index(start) + 1 : ring.index(start) + 1] = heads
            skeleton.gables.update(heads)
    skeleton.points = points
    skeleton.upright = set(range(len(kept), len(kept) + len(upright)))
    skeleton.faces = [_with_between(face, between) for face in kept] + upright
    return len(moved)


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
    eave: FloatArray,
    rise: FloatArray,
    *,
    first: float = 0.0,
    others: float = 0.0,
    gablets: bool = False,
) -> RoofMesh:
    """Lay hipped roofs of one pitch on outlines, the ends of their wings raised where asked.

    Parameters
    ----------
    polygons
        (n,) valid polygons; empty ones are passed over.
    eave, rise
        (n,) metres.
    first, others
        How far up the wall is raised under the ends of wings: 0 for hips, 1 for gables. An outline
        that bears no such end is left out when `first` asks for one other than those of a plain
        gabled roof.
    gablets
        Whether the ends stay hipped below and carry a small gable above.
    """
    polygons = shapely.orient_polygons(np.asarray(polygons, dtype=object))
    found: list[tuple[int, _Skeleton]] = []
    with _silenced():
        for row in np.flatnonzero(_admitted(polygons)).tolist():
            skeleton = _skeleton_of(polygons[row])
            if skeleton is None or not skeleton.points[:, 2].max() > 0:
                continue
            if first > 0:
                ends = _raise_ends(skeleton, first, others, gablets)
                if ends == 0 and (others < 1.0 or gablets):
                    continue
            found.append((row, skeleton))
    return _gathered(found, len(polygons), eave, rise)


def _gathered(
    found: list[tuple[int, _Skeleton]], count: int, eave: FloatArray, rise: FloatArray
) -> RoofMesh:
    """Join skeletons to roofs."""
    if not found:
        return empty_mesh(count)
    heads, places, levels, extras, extra_part = [], [], [], [], []
    size: list[int] = []
    polygon: list[int] = []
    hole: list[bool] = []
    faces: list[list[int]] = []
    face_part: list[int] = []
    face_role: list[int] = []
    ring_total = sum(len(ring) for _, skeleton in found for ring in skeleton.rings)
    ring_at, extra_at = 0, ring_total
    for row, skeleton in found:
        number: dict[int, int] = {}
        for position, ring in enumerate(skeleton.rings):
            number.update(zip(ring, range(ring_at, ring_at + len(ring)), strict=True))
            ring_at += len(ring)
            size.append(len(ring))
            polygon.append(row)
            hole.append(position > 0)
            gable = [v in skeleton.gables for v in ring]
            levels += [
                not (here or there)
                for here, there in zip(gable, [*gable[1:], gable[0]], strict=True)
            ]
        order = [v for ring in skeleton.rings for v in ring]
        z = eave[row] + skeleton.points[:, 2] * (rise[row] / float(skeleton.points[:, 2].max()))
        heads.append(z[order])
        places.append(skeleton.points[order, :2])
        inner = sorted({v for face in skeleton.faces for v in face} - number.keys())
        number.update(zip(inner, range(extra_at, extra_at + len(inner)), strict=True))
        extra_at += len(inner)
        extras.append(np.column_stack([skeleton.points[inner, :2], z[inner]]))
        extra_part += [row] * len(inner)
        faces += [[number[v] for v in face] for face in skeleton.faces]
        face_part += [row] * len(skeleton.faces)
        face_role += [WALL if k in skeleton.upright else ROOF for k in range(len(skeleton.faces))]
    start = np.concatenate([[0], np.cumsum(size)]).astype(np.int64)
    rings = Rings(np.concatenate(places), start, np.array(polygon), np.array(hole, bool))
    extra = np.concatenate(extras)
    roof, source = _as_triangles(faces, np.concatenate([rings.points, extra[:, :2]]))
    return RoofMesh(
        rings,
        np.concatenate(heads),
        np.array(levels, bool),
        extra,
        np.array(extra_part, np.int64),
        roof,
        np.array(face_part, np.int64)[source],
        np.array(face_role, np.int8)[source],
        count,
    )


def _as_triangles(faces: list[list[int]], places: FloatArray) -> tuple[IntArray, IntArray]:
    """Cut faces of many corners into triangles in plan; also return the face of each."""
    size = np.array([len(face) for face in faces])
    simple = np.flatnonzero(size == 3)
    index = [np.array([faces[f] for f in simple], np.int64).reshape(-1, 3)]
    owner: list[IntArray] = [simple]
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
        index.append(flat[mesh.triangles])
        owner.append(many[mesh.polygon])
    return np.concatenate(index), np.concatenate(owner)
