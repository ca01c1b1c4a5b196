"""Solids of bridges, ramps, cuttings and tunnels over the faces of an arrangement."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from cityx.city.ground import Ground
from cityx.geometry.arrays import FloatArray, IntArray
from cityx.geometry.chains import components, join_segments
from cityx.geometry.polylines import Polylines, arc_lengths, miters
from cityx.geometry.solids import NO_VERTEX
from cityx.ground.arrangement import BEYOND, half_edges


@dataclass(frozen=True)
class Bodies:
    """Closed bodies in one array, b of them.

    Attributes
    ----------
    vertices
        (n, 3) float64, metres.
    faces
        (f, 4) int64, triangles with -1.
    uv
        (f, 4, 2) float64, metres.
    vertex_body, face_body
        (n,) and (f,) int64, body of each, not in order.
    key
        (b,) int64, what each body was made of: a face or a chain, as the maker says.
    """

    vertices: FloatArray
    faces: IntArray
    uv: FloatArray
    vertex_body: IntArray
    face_body: IntArray
    key: IntArray


def slabs(ground: Ground, group: IntArray, low: FloatArray, high: FloatArray) -> Bodies:
    """Fill the space between two heights over groups of faces.

    Parameters
    ----------
    ground
        The arrangement.
    group
        (f,) whole number of each face; -1 for none. Faces of one group that share an edge make one
        body.
    low, high
        (g, n) heights of each group at each vertex, metres, or (n,) for all groups.

    Returns
    -------
    bodies
        ``key`` is the lowest face of each.
    """
    left, right = ground.edge_faces.T.astype(np.int64)
    inner = right != BEYOND
    same = inner & (group[left] >= 0) & (group[left] == group[np.where(inner, right, left)])
    body_of_face = components(np.column_stack([left, right])[same], len(group))
    face = ground.triangle_face.astype(np.int64)
    chosen = np.flatnonzero(group[face] >= 0)
    corner = ground.triangles[chosen].astype(np.int64)
    body = body_of_face[face[chosen]]
    edges, twin = half_edges(corner + body[:, None] * len(ground.vertices))
    # A body that touches itself in one point has a vertex there for each of its sides.
    begin = np.arange(len(edges))
    end = begin - begin % 3 + (begin + 1) % 3
    whole = np.flatnonzero(twin >= 0)
    links = [np.column_stack([begin[whole], end[twin[whole]]]),
             np.column_stack([end[whole], begin[twin[whole]]])]  # fmt: skip
    keys, index = np.unique(components(np.concatenate(links), len(edges)), return_inverse=True)
    vertex, owner = corner.ravel()[keys], np.repeat(body, 3)[keys]
    low, high = np.atleast_2d(low), np.atleast_2d(high)
    row = group[owner]
    bottom = low[row if len(low) > 1 else 0, vertex]
    top = high[row if len(high) > 1 else 0, vertex]
    xy = ground.vertices[vertex]
    size = len(keys)
    vertices = np.concatenate([np.column_stack([xy, bottom]), np.column_stack([xy, top])])
    rim = np.flatnonzero(twin < 0)
    a, b = index[begin[rim]], index[end[rim]]
    index = index.reshape(-1, 3)
    none = np.full(len(index), NO_VERTEX)
    lids = np.column_stack([index + size, none])
    floors = np.column_stack([index[:, ::-1], none])
    walls = np.column_stack([a, b, b + size, a + size])
    faces = np.concatenate([lids, floors, walls])
    uv = np.zeros((len(faces), 4, 2))
    flat = len(lids) + len(floors)
    uv[:flat, :3] = vertices[faces[:flat, :3], :2]
    uv[flat:, 1:3, 0] = np.hypot(*(xy[b] - xy[a]).T)[:, None]
    uv[flat:, :, 1] = vertices[walls, 2]
    bodies = np.unique(body)
    return Bodies(
        vertices, faces, uv,
        np.searchsorted(bodies, np.concatenate([owner, owner])),
        np.searchsorted(bodies, np.concatenate([body, body, body[rim // 3]])), bodies,
    )  # fmt: skip


def rim_edges(ground: Ground, group: IntArray) -> tuple[IntArray, IntArray, IntArray]:
    """Edges where a group of faces ends: (k, 2) vertices, the face within, and that beyond.

    The group lies on the left; the face beyond is -1 past the border.
    """
    left, right = ground.edge_faces.T.astype(np.int64)
    inner = right != BEYOND
    own = group[left] >= 0
    other = inner & (group[np.where(inner, right, left)] >= 0)
    head, tail = np.flatnonzero(own & ~other), np.flatnonzero(other & ~own)
    edges = ground.edges.astype(np.int64)
    return (
        np.concatenate([edges[head], edges[tail][:, ::-1]]),
        np.concatenate([left[head], right[tail]]),
        np.concatenate([right[head], left[tail]]),
    )


def chains_of(edges: IntArray, kind: IntArray) -> tuple[IntArray, IntArray]:
    """Join directed edges of one kind to chains: vertices in order, and (c + 1,) their starts."""
    if not len(edges):
        return np.zeros(0, np.int64), np.zeros(1, np.int64)
    head, rank = join_segments(edges, kind)
    order = np.lexsort((rank, head))
    edges, head = edges[order], head[order]
    first = np.flatnonzero(np.r_[True, head[1:] != head[:-1]])
    size = np.diff(np.r_[first, len(head)])
    start = np.concatenate([[0], np.cumsum(size + 1)]).astype(np.int64)
    vertex = np.empty(start[-1], np.int64)
    chain = np.repeat(np.arange(len(first)), size)
    vertex[np.arange(len(edges)) + chain] = edges[:, 0]
    vertex[start[1:] - 1] = edges[np.r_[first[1:], len(head)] - 1, 1]
    return vertex, start


def beams(lines: Polylines, low: FloatArray, high: FloatArray, inner: ArrayLike,
          outer: ArrayLike) -> Bodies:  # fmt: skip
    """Sweep an upright rectangle along lines: walls, parapets, rails.

    Parameters
    ----------
    lines
        The lines, with what they bound on the left.
    low, high
        (p,) heights at their points, metres.
    inner, outer
        (n,) or one for all, metres to the right of the lines at which the near and the far face
        stand.

    Returns
    -------
    bodies
        One per line; ``key`` is its number.
    """
    owner = lines.line_of_point()
    right = -_ring_miters(lines)
    inner, outer = (np.broadcast_to(np.asarray(a, float), lines.count) for a in (inner, outer))
    near = lines.points + right * inner[owner][:, None]
    far = lines.points + right * outer[owner][:, None]
    return _swept(lines, [(near, low), (far, low), (far, high), (near, high)], outer - inner)


def banks(lines: Polylines, high: FloatArray, reach: FloatArray, foot: FloatArray,
          depth: float) -> Bodies:  # fmt: skip
    """Make embankment slopes: from each line down to its foot.

    Parameters
    ----------
    lines
        The lines, with what they bound on the left.
    high
        (p,) heights of the soil at their points, metres.
    reach, foot
        (p,) metres to the right of the points at which the slope ends, and its height there.
    depth
        Metres that a bank reaches into the ground.

    Returns
    -------
    bodies
        One per line; ``key`` is its number.
    """
    far = lines.points + bank_directions(lines) * reach[:, None]
    low = np.minimum(high, foot) - depth
    sides = [(lines.points, low), (far, low), (far, foot), (lines.points, high)]
    return _swept(
        lines, sides, np.maximum.reduceat(reach, lines.start[:-1]) if len(reach) else reach
    )


def bank_directions(lines: Polylines) -> FloatArray:
    """(p, 2) vectors at the points in which the foot of a bank lies off them."""
    return -_ring_miters(lines)


def _swept(
    lines: Polylines, sides: list[tuple[FloatArray, FloatArray]], girth: FloatArray
) -> Bodies:
    """Join four lines along each of some lines to a closed body.

    Parameters
    ----------
    lines
        The lines.
    sides
        (p, 2) places and (p,) heights of each of the four, round the body: near and far below, far
        and near above.
    girth
        (n,) metres across each body, for its texture.
    """
    if not lines.count:
        none = np.zeros(0, np.int64)
        return Bodies(np.zeros((0, 3)), np.zeros((0, 4), np.int64), np.zeros((0, 4, 2)), none,
                      none, none)  # fmt: skip
    owner = lines.line_of_point()
    vertices = np.stack([np.column_stack([xy, z]) for xy, z in sides], axis=1).reshape(-1, 3)
    first = np.flatnonzero(owner[1:] == owner[:-1])
    k, after = np.arange(4), np.roll(np.arange(4), -1)
    a = first[:, None] * 4
    walls = np.stack([a + k, a + 4 + k, a + 4 + after, a + after], axis=2).reshape(-1, 4)
    head, tail = lines.start[:-1] * 4, (lines.start[1:] - 1) * 4
    caps = np.concatenate([head[:, None] + k, tail[:, None] + k[::-1]])
    along = arc_lengths(lines)[0]
    u = np.stack([along[first], along[first + 1], along[first + 1], along[first]], axis=1)
    u = np.repeat(u[:, None], 4, axis=1).reshape(-1, 4)
    v = vertices[walls, 2]
    flat = np.tile(np.array([True, False, True, False]), len(first))
    v[flat] = np.repeat(girth[owner[first]], 2)[:, None] * np.array([0.0, 0.0, 1.0, 1.0])
    uv = np.stack([u, v], axis=2)
    cap_uv = np.zeros((len(caps), 4, 2))
    cap_uv[:, :, 1] = vertices[caps, 2]
    return Bodies(
        vertices, np.concatenate([walls, caps]), np.concatenate([uv, cap_uv]),
        np.repeat(owner, 4),
        np.concatenate([np.repeat(owner[first], 4), np.tile(np.arange(lines.count), 2)]),
        np.arange(lines.count),
    )  # fmt: skip


def _ring_miters(lines: Polylines) -> FloatArray:
    """Return left-hand vectors at the points; closed lines are mitred where they close too."""
    found = miters(lines)
    first, last = lines.start[:-1], lines.start[1:] - 1
    ring = np.flatnonzero((lines.points[first] == lines.points[last]).all(axis=1)
                          & (last - first >= 3))  # fmt: skip
    if len(ring):
        a, b = first[ring], last[ring]
        around = np.stack([lines.points[b - 1], lines.points[a], lines.points[a + 1]], axis=1)
        closing = Polylines(around.reshape(-1, 2), 3 * np.arange(len(ring) + 1))
        found[a] = found[b] = miters(closing)[1::3]
    return found
