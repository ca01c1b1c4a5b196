"""Wall strips: upright quads of closed solids that go on side by side in one plane."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cityx.building.facade.bands import Chains
from cityx.geometry.arrays import FloatArray, IntArray
from cityx.geometry.polygons import STRAIGHT, Rings
from cityx.geometry.ranges import ranges
from cityx.geometry.solids import NO_VERTEX

PLANAR = 0.01  # metres; corners of a strip leave its plane by no more than this
ROW = 1e4  # metres between strips laid side by side on one axis; longer than any wall
MIN_SIDE = 0.02  # metres; a quad narrower or lower than this takes no niche


@dataclass(frozen=True)
class WallStrips:
    """Upright strips of quads, w of them.

    Attributes
    ----------
    face
        (q,) int64, the quads strip by strip, each from left to right as seen from outside.
    start
        (w + 1,) int64, offsets into ``face``.
    origin, unit
        (w, 2) float64, where the plane's line in plan begins, metres, and its direction.
    length
        (w,) float64, how far it runs, metres.
    """

    face: IntArray
    start: IntArray
    origin: FloatArray
    unit: FloatArray
    length: FloatArray

    @property
    def count(self) -> int:
        """Number of strips."""
        return len(self.length)

    @property
    def of_face(self) -> IntArray:
        """(q,) strip of each quad."""
        return np.repeat(np.arange(self.count), np.diff(self.start))

    def take(self, rows: IntArray) -> WallStrips:
        """Return the given strips."""
        pick, start = ranges(self.start, rows)
        return WallStrips(
            self.face[pick], start, self.origin[rows], self.unit[rows], self.length[rows]
        )


def strips_of(
    vertices: FloatArray,
    faces: IntArray,
    wall: NDArray[np.bool_],
    alike: IntArray,
    uv: NDArray[np.float32],
) -> WallStrips:
    """Find upright quads and chain those that go on in one plane.

    Parameters
    ----------
    vertices, faces
        (n, 3) and (f, 4) of closed solids, counter-clockwise from outside, triangles with -1.
    wall
        (f,) bool, the faces looked at; those that are no upright quads are passed over.
    alike
        (f,) int; only faces of equal value are joined to one strip.
    uv
        (f, 4, 2) texture coordinates, metres; a strip ends where they do not run on.
    """
    rows = np.flatnonzero(wall & (faces[:, 3] != NO_VERTEX))
    corner = vertices[faces[rows]]  # (q, 4, 3)
    upright = (corner[:, 0, :2] == corner[:, 3, :2]).all(1)
    upright &= (corner[:, 1, :2] == corner[:, 2, :2]).all(1)
    upright &= (corner[:, 3, 2] - corner[:, 0, 2] > MIN_SIDE) & (
        corner[:, 2, 2] - corner[:, 1, 2] > MIN_SIDE
    )
    vector = corner[:, 1, :2] - corner[:, 0, :2]
    upright &= np.hypot(*vector.T) > MIN_SIDE
    rows, corner, vector = rows[upright], corner[upright], vector[upright]
    if not len(rows):
        none = np.zeros((0, 2))
        return WallStrips(rows, np.zeros(1, np.int64), none, none, np.zeros(0))
    after = _next_in_plane(faces[rows], vector, alike[rows], uv[rows])
    chain, rank = _chains(after)
    order = np.lexsort((rank, chain))
    _, chain = np.unique(chain[order], return_inverse=True)
    # A chain that bends out of its plane falls apart into its quads.
    first = np.flatnonzero(np.diff(chain, prepend=-1) != 0)
    last = np.append(first[1:], len(chain)) - 1
    begin, end = corner[order[first], 0, :2], corner[order[last], 1, :2]
    span = end - begin
    size = np.maximum(np.hypot(*span.T), 1e-9)
    offset = corner[order, 1, :2] - begin[chain]
    aside = np.abs(offset[:, 0] * span[chain, 1] - offset[:, 1] * span[chain, 0]) / size[chain]
    bent = np.zeros(len(first), bool)
    bent[chain[aside > PLANAR]] = True
    starts = bent[chain]
    starts[first] = True
    first = np.flatnonzero(starts)
    last = np.append(first[1:], len(order)) - 1
    begin, end = corner[order[first], 0, :2], corner[order[last], 1, :2]
    span = end - begin
    size = np.maximum(np.hypot(*span.T), 1e-9)
    start = np.append(first, len(order)).astype(np.int64)
    return WallStrips(rows[order], start, begin, span / size[:, None], size)


def _next_in_plane(
    quads: IntArray, vector: FloatArray, alike: IntArray, uv: NDArray[np.float32]
) -> IntArray:
    """(q,) the quad that goes on at the right end of each in its plane, or -1."""
    found = np.full(len(quads), -1, np.int64)
    if not len(quads):
        return found
    scale = int(quads.max()) + 1
    left = quads[:, 0] * scale + quads[:, 3]
    right = quads[:, 1] * scale + quads[:, 2]
    order = np.argsort(left, kind="stable")
    at = np.minimum(np.searchsorted(left[order], right), len(order) - 1)
    other = order[at]
    length = np.hypot(*vector.T)
    cross = vector[:, 0] * vector[other, 1] - vector[:, 1] * vector[other, 0]
    dot = (vector * vector[other]).sum(1)
    fits = (left[other] == right) & (alike[other] == alike)
    fits &= (np.abs(cross) < np.sin(STRAIGHT) * length * length[other]) & (dot > 0)
    fits &= np.abs(uv[other, 0] - uv[:, 1]).max(1) < 1e-3  # the texture runs on
    found[fits] = other[fits]
    return found


def _chains(after: IntArray) -> tuple[IntArray, IntArray]:
    """First link of every chain and place in it, (q,) each, by pointer doubling."""
    count = len(after)
    before = np.full(count, -1, np.int64)
    linked = np.flatnonzero(after >= 0)
    before[after[linked]] = linked
    jump = np.where(before >= 0, before, np.arange(count))
    step = (before >= 0).astype(np.int64)
    for _ in range(count.bit_length()):
        if not (before[jump] >= 0).any():
            break
        step = step + step[jump]
        jump = jump[jump]
    # Rings without a beginning are no plane: every quad stands alone.
    ring = before[jump] >= 0
    return np.where(ring, np.arange(count), jump), np.where(ring, 0, step)


def outlines_of(
    vertices: FloatArray, faces: IntArray, strips: WallStrips
) -> tuple[Rings, IntArray]:
    """Return the outline of every strip in its plane.

    Parameters
    ----------
    vertices, faces
        The solids' that the strips were found in.
    strips
        The strips, w of them.

    Returns
    -------
    rings, vertex
        One ring per strip of (metres along, height), counter-clockwise from outside, and the
        vertex of each point.
    """
    size = np.diff(strips.start)
    total = 2 * (size + 1)
    start = np.concatenate([[0], np.cumsum(total)]).astype(np.int64)
    strip = np.repeat(np.arange(strips.count), size)
    rank = np.arange(len(strip)) - strips.start[:-1][strip]
    vertex = np.empty(start[-1], np.int64)
    foot = start[strip] + rank
    vertex[foot] = faces[strips.face, 0]
    vertex[foot + 1] = faces[strips.face, 1]
    head = start[strip + 1] - 1 - rank
    vertex[head] = faces[strips.face, 3]
    vertex[head - 1] = faces[strips.face, 2]
    of_point = np.repeat(np.arange(strips.count), total)
    offset = vertices[vertex, :2] - strips.origin[of_point]
    along = (offset * strips.unit[of_point]).sum(1)
    points = np.column_stack([along, vertices[vertex, 2]])
    number = np.arange(strips.count)
    return Rings(points, start, number, np.zeros(strips.count, bool)), vertex


def feet_and_heads(
    vertices: FloatArray, faces: IntArray, strips: WallStrips
) -> tuple[Chains, Chains]:
    """Return feet and heads of strips from left to right, in the planes of the strips.

    Parameters
    ----------
    vertices, faces
        The solids' that the strips were found in.
    strips
        The strips.
    """
    rings, vertex = outlines_of(vertices, faces, strips)
    half = np.diff(rings.start) // 2
    start = np.concatenate([[0], np.cumsum(half)]).astype(np.int64)
    rank = np.arange(start[-1]) - np.repeat(start[:-1], half)
    foot = np.repeat(rings.start[:-1], half) + rank
    head = np.repeat(rings.start[1:] - 1, half) - rank
    return (
        Chains(start, vertex[foot], rings.points[foot]),
        Chains(start, vertex[head], rings.points[head]),
    )


def in_space(
    vertices: FloatArray, faces: IntArray, strips: WallStrips, strip: IntArray, flat: FloatArray
) -> FloatArray:
    """Lift points of a strip's plane onto its quads, which may leave it by `PLANAR`.

    Parameters
    ----------
    vertices, faces
        The solids' that the strips were found in.
    strips
        The strips.
    strip
        (k,) strip of each point.
    flat
        (k, 2) metres along the strip, and height.

    Returns
    -------
    points
        (k, 3) scene frame, metres.
    """
    of_face = strips.of_face
    right = vertices[faces[strips.face, 1], :2] - strips.origin[of_face]
    normal = np.column_stack([strips.unit[:, 1], -strips.unit[:, 0]])
    reach = (right * strips.unit[of_face]).sum(1)
    out = (right * normal[of_face]).sum(1)
    number = np.arange(strips.count)
    axis = np.concatenate([ROW * number, ROW * of_face + reach])
    before = np.concatenate([np.zeros(strips.count), out])
    order = np.argsort(axis, kind="stable")
    stand = np.interp(ROW * strip + flat[:, 0], axis[order], before[order])
    # A straight strip of one quad must not get the rounding of the common axis.
    stand[np.diff(strips.start)[strip] == 1] = 0.0
    plan = strips.origin[strip] + strips.unit[strip] * flat[:, :1] + normal[strip] * stand[:, None]
    return np.column_stack([plan, flat[:, 1]])
