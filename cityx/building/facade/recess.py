"""Recesses: niches cut into upright walls, so that a closed shell stays closed.

A wall is a strip of upright quads in one plane. Strips that get niches are cut into triangles on
their old corners and the rims of the niches; every niche adds the faces of its sides and a back.
Since a strip keeps its outer corners and gets no new ones, its neighbours still fit.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.building.facade.bands import Holes, cut_bands
from cityx.building.facade.wall_strips import (
    ROW,
    WallStrips,
    feet_and_heads,
    in_space,
    outlines_of,
    strips_of,
)
from cityx.geometry.arrays import FloatArray, IntArray
from cityx.geometry.polygons import Rings, polygons_of, triangulate
from cityx.geometry.ranges import numbered, ranges
from cityx.geometry.solids import NO_VERTEX, as_quads

FRONT, SIDE, SILL, HEAD, BACK = range(5)  # kinds of new faces
EDGE = 0.02  # metres of wall left between a niche and the edge of its strip or another niche
NEAR = 0.05  # metres; a niche is looked for on the strips this near to its place
FACING = 0.998  # cosine; a niche and its strip face the same way within 3.6 degrees
LEVEL = 0.995  # cosine; an edge of a rim within six degrees of level is a sill or a head


@dataclass(frozen=True)
class Niches:
    """Niches to be cut, k of them.

    Attributes
    ----------
    group
        (k,) int64, group of the faces each belongs into.
    place
        (k, 2) float64, point of the wall below which or on which the niche stands, metres.
    normal
        (k, 2) float64, outward unit normal of the wall.
    low
        (k,) float64, height that z = 0 of the rim means.
    depth
        (k,) float64, metres; 0 for none.
    start
        (k + 1,) int64, offsets into ``rim``.
    rim
        (p, 2) float64: metres to the right of the place and above ``low``, a convex outline,
        counter-clockwise as seen from outside.
    """

    group: IntArray
    place: FloatArray
    normal: FloatArray
    low: FloatArray
    depth: FloatArray
    start: IntArray
    rim: FloatArray

    @property
    def count(self) -> int:
        """Number of niches."""
        return len(self.group)

    @property
    def owner(self) -> IntArray:
        """(p,) niche of each point of a rim."""
        return np.repeat(np.arange(self.count), np.diff(self.start))

    def take(self, rows: IntArray) -> Niches:
        """Return the given niches."""
        points, start = ranges(self.start, rows)
        return Niches(
            self.group[rows], self.place[rows], self.normal[rows], self.low[rows],
            self.depth[rows], start, self.rim[points],
        )  # fmt: skip


@dataclass(frozen=True)
class Recesses:
    """What cutting niches changes in a set of faces.

    Attributes
    ----------
    done
        (k,) bool, the niches that were cut.
    kept
        (f,) bool, the old faces that stay.
    vertices
        (m, 3) float64, new vertices, numbered after the old ones.
    vertex_source
        (m,) int64, a face of the strip each new vertex was cut into.
    faces
        (g, 4) int64, new faces, counter-clockwise from outside, triangles with -1.
    source
        (g,) int64, the old face that each new one takes the place of or opens into.
    niche
        (g,) int64, the niche of each new face, -1 for what is left of a wall.
    kind
        (g,) int8: `FRONT`, `SIDE`, `SILL`, `HEAD` or `BACK`.
    uv
        (g, 4, 2) float32, metres.
    """

    done: NDArray[np.bool_]
    kept: NDArray[np.bool_]
    vertices: FloatArray
    vertex_source: IntArray
    faces: IntArray
    source: IntArray
    niche: IntArray
    kind: NDArray[np.int8]
    uv: NDArray[np.float32]


def cut_niches(
    vertices: FloatArray,
    faces: IntArray | NDArray[np.int32],
    group: IntArray,
    wall: NDArray[np.bool_],
    alike: IntArray,
    uv: NDArray[np.float32],
    niches: Niches,
) -> Recesses:
    """Cut niches into upright walls.

    Parameters
    ----------
    vertices, faces
        (n, 3) and (f, 4) of closed solids, counter-clockwise from outside, triangles with -1.
    group
        (f,) group of each face; no face shares a vertex with one of another group.
    wall
        (f,) bool, the faces that may be cut; those that are no upright quads are passed over.
    alike
        (f,) int; only faces of equal value are joined to one strip.
    uv
        (f, 4, 2) texture coordinates, metres, u along the wall and v upward.
    niches
        What to cut. A niche whose rim does not lie well within one strip is not cut, nor the later
        of two that touch.
    """
    faces = np.asarray(faces, np.int64)
    strips = strips_of(vertices, faces, wall, alike, uv)
    if not niches.count or not strips.count:
        return _nothing(np.zeros(niches.count, bool), len(faces))
    strip, along = _strip_of(vertices, faces, niches, strips, group)
    strip = _apart(niches, strip, along)
    chosen = np.flatnonzero(strip >= 0)
    if not len(chosen):
        return _nothing(np.zeros(niches.count, bool), len(faces))
    pieces, of_strip, extra, extra_strip, bad = _fronts(
        vertices, faces, strips, niches.take(chosen), strip[chosen], along[chosen]
    )
    # A strip that will not be cut without new points keeps its face, and so do its openings.
    if bad.any():
        keep = ~bad[strip[chosen]]
        chosen = chosen[keep]
        pieces, of_strip, extra, extra_strip, _ = _fronts(
            vertices, faces, strips, niches.take(chosen), strip[chosen], along[chosen]
        )
    done = np.zeros(niches.count, bool)
    done[chosen] = True
    if not len(chosen):
        return _nothing(done, len(faces))
    return _assembled(
        vertices, faces, uv, strips, niches.take(chosen), strip[chosen], along[chosen],
        pieces, of_strip, extra, extra_strip, done, chosen,
    )  # fmt: skip


def _nothing(done: NDArray[np.bool_], count: int) -> Recesses:
    none = np.zeros(0, np.int64)
    return Recesses(
        done, np.ones(count, bool), np.zeros((0, 3)), none, np.zeros((0, 4), np.int64), none, none,
        np.zeros(0, np.int8), np.zeros((0, 4, 2), np.float32),
    )  # fmt: skip


def _polygons(vertices: FloatArray, faces: IntArray, strips: WallStrips) -> NDArray[Any]:
    rings, _ = outlines_of(vertices, faces, strips)
    return polygons_of(rings, strips.count)


def _fronts(
    vertices: FloatArray,
    faces: IntArray,
    strips: WallStrips,
    niches: Niches,
    strip: IntArray,
    along: FloatArray,
) -> tuple[IntArray, IntArray, FloatArray, IntArray, NDArray[np.bool_]]:
    """Cut what is left of the strips with niches: upright bands where they fit, else triangles.

    Returns
    -------
    pieces, strip
        (t, 4) vertex numbers and (t,). The points of rims come after the old vertices, then as
        many for the backs of niches, then new points within the strips.
    extra, extra_strip
        (s, 2) and (s,) those new points in the plane of their strip.
    bad
        (w,) bool, strips that could not be cut.
    """
    count, points = len(vertices), len(niches.rim)
    square = _rectangles(niches)
    other = np.zeros(strips.count, bool)
    other[strip[~square]] = True
    plain = np.flatnonzero(~other[strip])
    rim = _flat_rims(niches, along)
    first = niches.start[:-1][plain]
    used, local = np.unique(strip[plain], return_inverse=True)
    few = strips.take(used)
    feet, heads = feet_and_heads(vertices, faces, few)
    corner = first[:, None] + np.arange(4)
    holes = Holes(local, rim[first], rim[first + 2], corner + count)
    banded = cut_bands(feet, heads, holes, count + 2 * points)
    done = np.zeros(strips.count, bool)
    done[used[banded.cut]] = True
    rest = np.flatnonzero(~done[strip])
    bad = np.zeros(strips.count, bool)
    if not len(rest):
        extra_strip = used[banded.point_wall]
        return banded.faces, used[banded.wall], banded.point, extra_strip, bad
    others, local = np.unique(strip[rest], return_inverse=True)
    triangles, of, torn = _triangles(
        vertices, faces, strips.take(others), niches.take(rest), local, along[rest]
    )
    bad[others[torn]] = True
    point = ranges(niches.start, rest)[0]
    old = triangles < count
    global_ = np.where(old, triangles, count + point[np.where(old, 0, triangles - count)])
    return (
        np.concatenate([banded.faces, as_quads(global_)]),
        np.concatenate([used[banded.wall], others[of]]),
        banded.point,
        used[banded.point_wall],
        bad,
    )


def _rectangles(niches: Niches) -> NDArray[np.bool_]:
    """(k,) whether a rim is an upright rectangle that begins at its lower left corner."""
    found = np.diff(niches.start) == 4
    first = niches.start[:-1][found]
    a, b, c, d = (niches.rim[first + k] for k in range(4))
    found[found] = (
        (a[:, 1] == b[:, 1]) & (b[:, 0] == c[:, 0]) & (c[:, 1] == d[:, 1]) & (d[:, 0] == a[:, 0])
        & (a[:, 0] < b[:, 0]) & (b[:, 1] < c[:, 1])
    )  # fmt: skip
    return np.asarray(found, bool)


def _strip_of(
    vertices: FloatArray, faces: IntArray, niches: Niches, strips: WallStrips, group: IntArray
) -> tuple[IntArray, FloatArray]:
    """Strip that wholly contains each niche, or -1, and the place along it, (k,) each."""
    found = np.full(niches.count, -1, np.int64)
    along = np.zeros(niches.count)
    if not strips.count or not niches.count:
        return found, along
    ends = np.stack([strips.origin, strips.origin + strips.unit * strips.length[:, None]], axis=1)
    tree = shapely.STRtree(shapely.linestrings(ends))
    niche, strip = tree.query(shapely.points(niches.place), predicate="dwithin", distance=NEAR)
    normal = np.column_stack([strips.unit[:, 1], -strips.unit[:, 0]])
    fits = group[strips.face[strips.start[:-1]]][strip] == niches.group[niche]
    fits &= (normal[strip] * niches.normal[niche]).sum(1) > FACING
    fits &= niches.depth[niche] > 0
    niche, strip = niche[fits], strip[fits]
    offset = niches.place[niche] - strips.origin[strip]
    at = (offset * strips.unit[strip]).sum(1)
    low, high = _extents(niches)
    left, right = at + low[niche, 0] - EDGE, at + high[niche, 0] + EDGE
    foot, head = niches.low[niche] + low[niche, 1] - EDGE, niches.low[niche] + high[niche, 1] + EDGE
    inside = (left >= 0) & (right <= strips.length[strip])
    # Most lie between the highest foot and the lowest head of their strip, the others are cut out.
    corner = vertices[faces[strips.face], 2]
    bottom = np.maximum.reduceat(corner[:, :2].max(axis=1), strips.start[:-1])
    top = np.minimum.reduceat(corner[:, 2:].min(axis=1), strips.start[:-1])
    rest = np.flatnonzero(inside & ((foot < bottom[strip]) | (head > top[strip])))
    if len(rest):
        used, local = np.unique(strip[rest], return_inverse=True)
        shapes = _polygons(vertices, faces, strips.take(used))
        boxes = shapely.box(left[rest], foot[rest], right[rest], head[rest])
        inside[rest] = shapely.covers(shapes[local], boxes)
    niche, strip, at = niche[inside], strip[inside], at[inside]
    # The first strip of each niche, by its first face, whatever order the tree gave.
    order = np.lexsort((strips.face[strips.start[:-1]][strip], niche))
    niche, strip, at = niche[order], strip[order], at[order]
    first = np.flatnonzero(np.diff(niche, prepend=-1) != 0)
    found[niche[first]] = strip[first]
    along[niche[first]] = at[first]
    return found, along


def _extents(niches: Niches) -> tuple[FloatArray, FloatArray]:
    """Lower left and upper right of every rim, (k, 2) each."""
    if not niches.count:
        return np.zeros((0, 2)), np.zeros((0, 2))
    first = niches.start[:-1]
    return np.minimum.reduceat(niches.rim, first), np.maximum.reduceat(niches.rim, first)


def _apart(niches: Niches, strip: IntArray, along: FloatArray) -> IntArray:
    """Leave out the later of two niches that touch on their strip."""
    rows = np.flatnonzero(strip >= 0)
    low, high = _extents(niches)
    at = along[rows] + strip[rows] * ROW
    # Half the gap on each side; both boxes grow, so that they meet when the gap is too small.
    boxes = shapely.box(
        at + low[rows, 0] - EDGE / 2, niches.low[rows] + low[rows, 1] - EDGE / 2,
        at + high[rows, 0] + EDGE / 2, niches.low[rows] + high[rows, 1] + EDGE / 2,
    )  # fmt: skip
    first, second = shapely.STRtree(boxes).query(boxes, predicate="intersects")
    later = first > second
    free = strip.copy()
    free[rows[first[later]]] = -1
    return free


def _triangles(
    vertices: FloatArray,
    faces: IntArray,
    strips: WallStrips,
    niches: Niches,
    strip: IntArray,
    along: FloatArray,
) -> tuple[IntArray, IntArray, NDArray[np.bool_]]:
    """Cut strips with holes into triangles.

    Returns
    -------
    triangles
        (t, 3) int64 vertex numbers; points of rims come after the old vertices.
    strip
        (t,) strip of each.
    bad
        (w,) bool, strips that could not be cut.
    """
    outer, vertex = outlines_of(vertices, faces, strips)
    rim = _flat_rims(niches, along)
    # Holes run clockwise: each rim backwards.
    size = np.diff(niches.start)
    back = np.repeat(niches.start[:-1] + niches.start[1:] - 1, size) - np.arange(len(rim))
    order = np.argsort(strip, kind="stable")
    taken, start = ranges(niches.start, order)
    pick = back[taken]
    rings = Rings(
        np.concatenate([outer.points, rim[pick]]),
        np.concatenate([outer.start, start[1:] + outer.start[-1]]),
        np.concatenate([outer.polygon, strip[order]]),
        np.concatenate([outer.hole, np.ones(niches.count, bool)]),
    )
    number = np.concatenate([vertex, pick + len(vertices)])
    made = triangulate(_with_holes(rings, strips.count), rings)
    bad = made.failed
    # Unpaired edges would tear the shell: the triangles have to use every edge of every ring.
    area = np.bincount(made.polygon, _areas(rings.points[made.triangles]), strips.count)
    whole = np.bincount(rings.polygon, _ring_areas(rings), strips.count)
    bad = bad | (np.abs(area - whole) > 1e-6 * np.maximum(whole, 1.0))
    return number[made.triangles], made.polygon, bad


def _flat_rims(niches: Niches, along: FloatArray) -> FloatArray:
    """(p, 2) points of rims in the plane of their strip: metres along it, height."""
    owner = niches.owner
    return niches.rim + np.column_stack([along, niches.low])[owner]


def _areas(corner: FloatArray) -> FloatArray:
    a, b = corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]
    return np.asarray((a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]) / 2)


def _ring_areas(rings: Rings) -> FloatArray:
    """(r,) signed area of rings."""
    base = np.repeat(rings.points[rings.start[:-1]], np.diff(rings.start), axis=0)
    a = rings.points - base
    b = a[rings.following()]
    return np.add.reduceat(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0], rings.start[:-1]) / 2


def _with_holes(rings: Rings, count: int) -> NDArray[Any]:
    """Build (count,) polygons of which many have many holes."""
    size = np.diff(rings.start)
    closed = np.insert(rings.points, rings.start[1:], rings.points[rings.start[:-1]], axis=0)
    lines = shapely.linearrings(closed, indices=np.repeat(np.arange(len(size)), size + 1))
    order = np.argsort(rings.polygon, kind="stable")  # a polygon's shell comes before its holes
    found = np.full(count, shapely.Polygon(), dtype=object)
    shapely.polygons(lines[order], indices=rings.polygon[order], out=found)
    return found


def _assembled(
    vertices: FloatArray,
    faces: IntArray,
    uv: NDArray[np.float32],
    strips: WallStrips,
    niches: Niches,
    strip: IntArray,
    along: FloatArray,
    pieces: IntArray,
    of_piece: IntArray,
    extra: FloatArray,
    extra_strip: IntArray,
    done: NDArray[np.bool_],
    chosen: IntArray,
) -> Recesses:
    """Put the fronts, sides and backs together."""
    first_face = strips.face[strips.start[:-1]]
    owner = niches.owner
    flat = _flat_rims(niches, along)
    count, points = len(vertices), len(flat)
    front = in_space(vertices, faces, strips, strip[owner], flat)
    inner = in_space(vertices, faces, strips, extra_strip, extra)
    inward = np.column_stack([-strips.unit[:, 1], strips.unit[:, 0], np.zeros(strips.count)])
    rear = front + inward[strip[owner]] * niches.depth[owner][:, None]
    # Sides: one quad per edge of a rim, from the wall to the back.
    here = np.arange(points)
    after = here + 1
    after[niches.start[1:] - 1] = niches.start[:-1]
    sides = np.column_stack([here, after, after + points, here + points]) + count
    edge = flat[after] - flat
    edge /= np.maximum(np.hypot(*edge.T), 1e-9)[:, None]
    kind = np.where(edge[:, 0] > LEVEL, SILL, np.where(edge[:, 0] < -LEVEL, HEAD, SIDE))
    backs, back_owner = _fans(niches.start, count + points)

    # Texture: metres from the start of the strip, so that it runs on round every edge.
    zero = np.column_stack([uv[first_face, 0, 0], uv[first_face, 0, 1]]).astype(float)
    zero[:, 1] -= vertices[faces[first_face, 0], 2]
    on_wall = flat + zero[strip[owner]]
    into = np.column_stack([-edge[:, 1], edge[:, 0]]) * niches.depth[owner][:, None]
    side_uv = np.stack(
        [on_wall, on_wall[after], on_wall[after] + into, on_wall + into], axis=1, dtype=np.float32,
        casting="same_kind",
    )  # fmt: skip
    back_uv = on_wall.astype(np.float32)[np.where(backs == NO_VERTEX, 0, backs - count - points)]
    placed = np.concatenate([flat, np.zeros_like(flat), extra]).astype(np.float32)
    front_uv = placed[(pieces - count).clip(min=0)]  # (t, 4, 2)
    # Old corners have another place in each of the strips they belong to.
    row, slot = np.nonzero((pieces < count) & (pieces != NO_VERTEX))
    old, of = pieces[row, slot], of_piece[row]
    onto = ((vertices[old, :2] - strips.origin[of]) * strips.unit[of]).sum(1)
    front_uv[row, slot, 0] = onto
    front_uv[row, slot, 1] = vertices[old, 2]
    front_uv += zero[of_piece].astype(np.float32)[:, None]

    kept = np.ones(len(faces), bool)
    cut = np.zeros(strips.count, bool)
    cut[strip] = True
    kept[strips.face[cut[strips.of_face]]] = False
    number = np.concatenate([np.full(len(pieces), -1), chosen[owner], chosen[back_owner]])
    source = first_face[np.concatenate([of_piece, strip[owner], strip[back_owner]])]
    kinds = np.repeat(np.array([FRONT, BACK], np.int8), [len(pieces), len(backs)])
    kinds = np.insert(kinds, len(pieces), kind.astype(np.int8))
    all_uv = np.concatenate([front_uv, side_uv, back_uv], dtype=np.float32, casting="same_kind")
    new = np.concatenate([pieces, sides, backs])
    short = np.flatnonzero(new[:, 3] == NO_VERTEX)
    all_uv[short, 3] = 0.0
    return Recesses(
        done, kept, np.concatenate([front, rear, inner]),
        first_face[np.concatenate([strip[owner], strip[owner], extra_strip])], new,
        source, number, kinds, all_uv,
    )  # fmt: skip


def _fans(start: IntArray, first: int) -> tuple[IntArray, IntArray]:
    """Close convex outlines: fans of quads and at most one triangle each, and their owner."""
    size = np.diff(start)
    number = (size - 1) // 2  # faces over corners 0, 1 2 3, 3 4 5, ...
    owner = np.repeat(np.arange(len(size)), number)
    step = numbered(number)
    a = start[:-1][owner]
    b = a + 2 * step + 1
    last = b + 2 >= start[1:][owner]
    faces = np.column_stack([a, b, b + 1, np.where(last, NO_VERTEX - first, b + 2)]) + first
    return faces, owner
