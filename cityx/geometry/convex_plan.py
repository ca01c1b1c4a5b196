"""Upright solids, such as shells of buildings, as few convex ones: cut in plan, then hulled."""

from __future__ import annotations

from typing import Any

import numpy as np
import shapely

from cityx.geometry.chains import components
from cityx.geometry.convex import FloatArray, Hull, IntArray, hull_of, hulls_round
from cityx.geometry.polygons import rings_of, triangulate
from cityx.geometry.solids import NO_VERTEX, area_vectors

GRID = 1e-3  # metres, of the plan
TOUCH = 0.02  # metres over the border of a piece that a corner still belongs to it
CONVEX = 1e-3  # sine of the turn that a corner of a convex piece may make the wrong way
FLAT = 1e-6  # square metres of plan that a face covers which counts
PIECES_JOINED = 24  # of a part, up to which neighbours are tried as one
SLACK = 0.02  # share of a part's hull that joining pieces may add


def pieces_of_mesh(vertices: FloatArray, faces: IntArray) -> list[IntArray]:
    """Return the rows of the vertices of each connected piece of a mesh, most corners first.

    Parameters
    ----------
    vertices
        (n, 3) metres.
    faces
        (f, 4) rows of vertices, triangles with -1.
    """
    last = np.where(faces[:, 3] == NO_VERTEX, faces[:, 2], faces[:, 3])
    pairs = [faces[:, :2], faces[:, 1:3], np.column_stack([faces[:, 2], last])]
    lowest = components(np.concatenate(pairs), len(vertices))
    used = np.zeros(len(vertices), bool)
    used[faces[faces != NO_VERTEX]] = True
    rows = np.flatnonzero(used)
    order = rows[np.argsort(lowest[rows], kind="stable")]
    cuts = np.flatnonzero(np.diff(lowest[order])) + 1
    return [piece for piece in np.split(order, cuts) if len(piece)]


def upright_hulls(vertices: FloatArray, faces: IntArray) -> list[Hull]:
    """Cover a shell that stands on its plan by convex hulls.

    The plan of each connected piece is cut into convex parts; what of the shell lies over one part
    is hulled. Prisms and roofs whose ridges run along the cuts come out exact; what is hollow from
    above, such as a saddle between two ridges, is filled.

    Parameters
    ----------
    vertices, faces
        As of `pieces_of_mesh`.
    """
    found: list[Hull] = []
    for rows in pieces_of_mesh(vertices, faces):
        member = np.zeros(len(vertices), bool)
        member[rows] = True
        clusters = _clusters(vertices, faces[member[faces[:, 0]]])
        if not clusters:
            found.append(hull_of(vertices[rows]))
        elif 1 < len(clusters) <= PIECES_JOINED:
            found += hulls_round(clusters, most=PIECES_JOINED, slack=SLACK)
        else:
            found += [hull_of(points) for points in clusters]
    return found


def _clusters(vertices: FloatArray, faces: IntArray) -> list[FloatArray]:
    """Return the points of a shell over each convex piece of its plan."""
    pieces = convex_pieces(_plan(vertices, faces))
    if len(pieces) <= 1:
        return [vertices[np.unique(faces[faces != NO_VERTEX])]] if pieces else []
    begin, end = _edges(faces)
    a, b = vertices[begin], vertices[end]
    clusters = []
    for ring in pieces:
        inside = [points[_within(points[:, :2], ring)] for points in (a, b)]
        crossing = [
            _crossings(a, b, *side) for side in zip(ring, np.roll(ring, -1, 0), strict=True)
        ]
        met = np.concatenate([*inside, *crossing])
        met = met[_within(met[:, :2], ring)]
        if len(met) > 3:
            clusters.append(met)
    return clusters


def _plan(vertices: FloatArray, faces: IntArray) -> Any:
    """Return the shadow of a mesh on the plane, a polygon or several."""
    level = np.abs(area_vectors(vertices, faces)[:, 2]) > FLAT
    shown = faces[level]
    if not len(shown):
        return shapely.Polygon()
    last = np.where(shown[:, 3] == NO_VERTEX, shown[:, 0], shown[:, 3])
    corners = vertices[np.column_stack([shown[:, :3], last, shown[:, 0]])][:, :, :2]
    shadows = shapely.set_precision(shapely.make_valid(shapely.polygons(corners)), GRID)
    return shapely.union_all(shadows, grid_size=GRID)


def convex_pieces(shape: Any) -> list[FloatArray]:
    """Cut polygons into convex ones between their own corners (Hertel and Mehlhorn 1983).

    Parameters
    ----------
    shape
        A polygon, or several.

    Returns
    -------
    rings
        Corners of each piece, (k, 2), counter-clockwise, without the closing one. At most four
        times as many as the fewest there can be.
    """
    parts = [p for p in shapely.get_parts(shape) if p.geom_type == "Polygon" and p.area > FLAT]
    if not parts:
        return []
    polygons = shapely.simplify(np.array(parts, object), GRID)
    rings = rings_of(polygons)
    cut = triangulate(polygons, rings)
    return _joined_rings(rings.points, [list(map(int, t)) for t in cut.triangles])


def _joined_rings(points: FloatArray, rings: list[list[int]]) -> list[FloatArray]:
    """Join rings over the sides they share, the longest first, while what comes out is convex."""
    side: dict[tuple[int, int], int] = {
        (p, q): number for number, ring in enumerate(rings)
        for p, q in zip(ring, [*ring[1:], ring[0]], strict=True)
    }  # fmt: skip
    shared = [pair for pair in side if pair[0] < pair[1] and pair[::-1] in side]
    shared.sort(key=lambda pair: (-float(np.hypot(*(points[pair[0]] - points[pair[1]]))), pair))
    for p, q in shared:
        one, other = side[p, q], side[q, p]
        if one == other:
            continue
        ring = _spliced(rings[one], rings[other], p, q)
        if len(set(ring)) < len(ring) or not _is_convex(points[ring]):
            continue
        rings[one], rings[other] = ring, []
        for pair in zip(ring, [*ring[1:], ring[0]], strict=True):
            side[pair] = one
    return [points[ring] for ring in rings if ring]


def _spliced(one: list[int], other: list[int], p: int, q: int) -> list[int]:
    """Return the ring round two of which the first has the side from p to q, the second q to p."""
    at, back = one.index(q), other.index(p)
    return [*one[at:], *one[:at], *[*other[back:], *other[:back]][1:-1]]


def _is_convex(ring: FloatArray) -> bool:
    along = np.roll(ring, -1, 0) - ring
    ahead = np.roll(along, -1, 0)
    turn = along[:, 0] * ahead[:, 1] - along[:, 1] * ahead[:, 0]
    return bool((turn >= -CONVEX * np.hypot(*along.T) * np.hypot(*ahead.T)).all())


def _within(xy: FloatArray, ring: FloatArray) -> Any:
    """Whether (n, 2) points lie in a convex ring or touch it, (n,) bool."""
    along = np.roll(ring, -1, 0) - ring
    normal = np.column_stack([-along[:, 1], along[:, 0]])
    normal /= np.maximum(np.hypot(*along.T), GRID)[:, None]
    return (xy @ normal.T - (ring * normal).sum(axis=1) >= -TOUCH).all(axis=1)


def _edges(faces: IntArray) -> tuple[IntArray, IntArray]:
    quad = faces[:, 3] != NO_VERTEX
    third = np.where(quad, faces[:, 3], faces[:, 0])
    begin = np.concatenate([faces[:, 0], faces[:, 1], faces[:, 2], faces[quad, 3]])
    end = np.concatenate([faces[:, 1], faces[:, 2], third, faces[quad, 0]])
    once = np.unique(np.sort(np.column_stack([begin, end]), axis=1), axis=0)
    return once[:, 0], once[:, 1]


def _crossings(a: FloatArray, b: FloatArray, p: FloatArray, q: FloatArray) -> FloatArray:
    """Return where edges a-b, (n, 3) each, cross the upright wall over the line p-q, (m, 3)."""
    along = q - p
    normal = np.array([-along[1], along[0]])
    first, second = (a[:, :2] - p) @ normal, (b[:, :2] - p) @ normal
    across = first * second < 0
    share = first[across] / (first[across] - second[across])
    return np.asarray(a[across] + share[:, None] * (b[across] - a[across]))
