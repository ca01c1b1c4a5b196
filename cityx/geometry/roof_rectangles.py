"""Roofs over rectangles in closed form: hipped, side-hipped, half-hipped."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cityx.geometry.extrude import Plan, roofed
from cityx.geometry.polygons import FloatArray, Rings, rings_of
from cityx.geometry.solids import Solids, as_quads

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
class PitchedRoofs:
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
) -> PitchedRoofs:
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
    return PitchedRoofs(solids, rings, head.ravel(), level.ravel(), slope)
