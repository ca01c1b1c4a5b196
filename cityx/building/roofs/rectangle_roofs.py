"""Roofs over rectangles in closed form: hips, half hips and gables at either end."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cityx.building.roofs.roof_meshes import RoofMesh
from cityx.geometry.arrays import FloatArray
from cityx.geometry.polygons import Rings, rings_of
from cityx.geometry.solids import ROOF, WALL

SQUARE_CORNER = np.sin(np.radians(3.0))  # a corner this close to square counts as square
MIN_RIDGE = 0.05  # metres; the ridge of a square roof, so that no face collapses
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
    ((0, 1, 2), (0, 2, 3)), ((0, 1, 5), (0, 5, 4), (1, 2, 5), (2, 3, 4), (2, 4, 5), (3, 0, 4))
)
_SIDE_HIPPED = _Template(  # ring p0 p1 p2 p3 gable, 5 = B
    ((0, 1, 4), (4, 1, 2), (4, 2, 3)), ((0, 1, 5), (0, 5, 4), (1, 2, 5), (2, 3, 4), (2, 4, 5))
)
_HALF_HIPPED = _Template(  # ring p0 p1 a1 a2 p2 p3 b1 b2, 8 = A, 9 = B
    ((0, 1, 2), (0, 2, 7), (7, 2, 3), (7, 3, 6), (6, 3, 4), (6, 4, 5)),
    (
        (0, 1, 2), (0, 2, 9), (0, 9, 8), (0, 8, 7),
        (4, 5, 6), (4, 6, 8), (4, 8, 9), (4, 9, 3),
        (2, 3, 9), (6, 7, 8),
    ),
)  # fmt: skip
_SIDE_HALF_HIPPED = _Template(  # ring p0 p1 a1 a2 p2 p3 gable, 7 = B
    ((0, 1, 2), (0, 2, 6), (6, 2, 3), (6, 3, 5), (5, 3, 4)),
    (
        (0, 1, 2), (0, 2, 7), (0, 7, 6),
        (4, 5, 6), (4, 6, 7), (4, 7, 3),
        (2, 3, 7),
    ),
)  # fmt: skip
_GABLET = _Template(  # 4 = A, 5 = B, 6 and 7 the hips' heads under A, 8 and 9 those under B
    ((0, 1, 2), (0, 2, 3)),
    (
        (0, 1, 8), (0, 8, 6), (6, 8, 5), (6, 5, 4),
        (2, 3, 7), (2, 7, 9), (9, 7, 4), (9, 4, 5),
        (3, 0, 6), (3, 6, 7), (1, 2, 9), (1, 9, 8),
        (7, 6, 4), (8, 9, 5),
    ),
)  # fmt: skip
GABLETS = 2  # the last faces of `_GABLET` stand upright
RECTANGULAR = ("hipped", "side_hipped", "half-hipped", "side_half-hipped", "hipped-and-gabled")


def rectangle_roofs(
    polygons: NDArray[Any], kind: str, angle: FloatArray, eave: FloatArray, rise: FloatArray
) -> RoofMesh:
    """Lay roofs of one kind on rectangles.

    Parameters
    ----------
    polygons
        (n,) rectangles, see `is_rectangle`; empty ones are passed over.
    kind
        A word of `RECTANGULAR`.
    angle
        (n,) radians, direction of the ridge; the nearer pair of sides carries it.
    eave, rise
        (n,) metres.
    """
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
    share = HALF if kind in ("half-hipped", "side_half-hipped", "hipped-and-gabled") else 1.0
    inset = np.minimum(width / 2 * share, length / 2 - MIN_RIDGE / 2)[:, None]
    base, summit = eave[rows], (eave + rise)[rows]
    middle = base + (summit - base) * HALF

    def at(point: FloatArray, z: FloatArray) -> FloatArray:
        return np.column_stack([point, z])

    ridge_a, ridge_b = at(a + axis * inset, summit), at(b - axis * inset, summit)
    corner = [at(p[:, i], base) for i in range(4)]
    near, far = HALF / 2, 1 - HALF / 2
    end_b = [at(p[:, 1] + (p[:, 2] - p[:, 1]) * part, middle) for part in (near, far)]
    end_a = [at(p[:, 3] + (p[:, 0] - p[:, 3]) * part, middle) for part in (near, far)]
    gable = at(a, summit)
    if kind == "hipped":
        template, ring, extra = _HIPPED, corner, [ridge_a, ridge_b]
        level = [True] * 4
    elif kind == "side_hipped":
        template, ring, extra = _SIDE_HIPPED, [*corner, gable], [ridge_b]
        level = [True, True, True, False, False]
    elif kind == "half-hipped":
        template, extra = _HALF_HIPPED, [ridge_a, ridge_b]
        ring = [*corner[:2], *end_b, *corner[2:], *end_a]
        level = [True, False, True, False, True, False, True, False]
    elif kind == "side_half-hipped":
        template, extra = _SIDE_HALF_HIPPED, [ridge_b]
        ring = [*corner[:2], *end_b, *corner[2:], gable]
        level = [True, False, True, False, True, False, False]
    else:
        template, ring = _GABLET, corner
        level = [True] * 4
        deep = (inset * axis)[:, :2]
        heads = [
            at(p[:, 0] + (p[:, 3] - p[:, 0]) * near + deep, middle),
            at(p[:, 3] + (p[:, 0] - p[:, 3]) * near + deep, middle),
            at(p[:, 1] + (p[:, 2] - p[:, 1]) * near - deep, middle),
            at(p[:, 2] + (p[:, 1] - p[:, 2]) * near - deep, middle),
        ]
        extra = [ridge_a, ridge_b, *heads]
    return _filled(template, kind, np.stack(ring, axis=1), np.stack(extra, axis=1), level, rows,
                   len(polygons))  # fmt: skip


def _filled(
    template: _Template, kind: str, ring: FloatArray, tops: FloatArray, level: list[bool],
    rows: NDArray[np.int64], count: int,
) -> RoofMesh:  # fmt: skip
    """Lay the faces of a template over the ring points (k, s, 3) and inner points (k, e, 3)."""
    k, size, number = len(rows), ring.shape[1], tops.shape[1]
    rings = Rings(ring[:, :, :2].reshape(-1, 2), np.arange(k + 1) * size, rows, np.zeros(k, bool))
    block = (np.arange(k) * size)[:, None, None]
    bottom = (np.array(template.bottom) + block).reshape(-1, 3)
    faces = np.array(template.roof)  # (t, 3) over ring then extras
    inner = faces - size + k * size + (np.arange(k) * number)[:, None, None]
    index = np.where(faces < size, faces + block, inner).reshape(-1, 3)
    role = np.full(len(faces), ROOF, np.int8)
    if kind == "hipped-and-gabled":
        role[-GABLETS:] = WALL
    return RoofMesh(
        rings,
        ring[:, :, 2].ravel(),
        np.tile(np.array(level, bool), k),
        tops.reshape(-1, 3),
        np.repeat(rows, number),
        index,
        np.repeat(rows, len(faces)),
        np.tile(role, k),
        count,
        (bottom, np.repeat(rows, len(template.bottom))),
    )
