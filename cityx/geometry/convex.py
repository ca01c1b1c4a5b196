"""Convex solids: hulls of points, and few of them round a shape of many pieces or upright walls."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import combinations, pairwise
from typing import Any

import numpy as np
import shapely
from numpy.typing import ArrayLike, NDArray

from cityx.geometry.arrays import FloatArray, IntArray
from cityx.geometry.chains import components
from cityx.geometry.polygons import rings_of, triangulate
from cityx.geometry.solids import NO_VERTEX, area_vectors

THIN = 0.02  # metres; what is thinner is given this thickness, so that nothing passes through
MOST_POINTS = 48  # corners of a hull; engines slow down beyond, and MuJoCo's advice is fewer
DIRECTIONS = 40  # of the planes round a hull with more corners
NEAR = 0.3  # metres between the boxes of two pieces that may be neighbours
BOX_SHARE = 0.9  # of a box that a hull fills which is taken for one
# A cylinder of eight sides fills 0.90 of its round one, a square bar 0.64.
ROUND_SHARE = 0.85
GRID = 1e-3  # metres, of the plan
TOUCH = 0.02  # metres over the border of a piece that a corner still belongs to it
CONVEX = 1e-3  # sine of the turn that a corner of a convex piece may make the wrong way
FLAT = 1e-6  # square metres of plan that a face covers which counts
NEARLY = 1e-9  # metres between corners that are one
POLYGON = 3  # type of geometry
PIECES_JOINED = 24  # of a part, up to which neighbours are tried as one
SLACK = 0.02  # share of a part's hull that joining pieces may add


@dataclass(frozen=True)
class Hull:
    """A convex solid.

    Attributes
    ----------
    points
        (n, 3) float64, its corners, metres.
    planes
        (f, 4) float64, one of each triangle of its skin: unit normal outwards and offset; inside,
        normal . x + offset <= 0.
    volume
        Cubic metres.
    """

    points: FloatArray
    planes: FloatArray
    volume: float

    def outside(self, points: FloatArray) -> FloatArray:
        """Return how far (n, 3) points are outside of its planes, (n,) metres, below 0 inside."""
        return np.asarray((points @ self.planes[:, :3].T + self.planes[:, 3]).max(axis=1))


@dataclass(frozen=True)
class Box:
    """An upright box that is turned about z.

    Attributes
    ----------
    center, half
        (3,) middle and half of length, width and height, metres.
    yaw
        Radians counter-clockwise from x of its length.
    """

    center: FloatArray
    half: FloatArray
    yaw: float

    @property
    def volume(self) -> float:
        """Cubic metres."""
        return float(8 * np.prod(self.half))

    def corners(self) -> FloatArray:
        """Return its corners, (8, 3)."""
        c, s = np.cos(self.yaw), np.sin(self.yaw)
        signs = np.array([[i, j, k] for i in (-1, 1) for j in (-1, 1) for k in (-1, 1)], float)
        return np.asarray(signs * self.half @ [[c, s, 0], [-s, c, 0], [0, 0, 1]] + self.center)


@dataclass(frozen=True)
class Cylinder:
    """An upright cylinder.

    Attributes
    ----------
    center
        (3,) its middle, metres.
    radius, half_height
        Metres.
    """

    center: FloatArray
    radius: float
    half_height: float

    @property
    def volume(self) -> float:
        """Cubic metres."""
        return float(2 * np.pi * self.radius**2 * self.half_height)


Solid = Hull | Box | Cylinder


def hull_of(points: ArrayLike) -> Hull:
    """Return the convex hull of (n, 3) points; what is flat is given a thickness of `THIN`."""
    from scipy.spatial import ConvexHull, QhullError

    held = np.asarray(points, float).reshape(-1, 3)
    try:
        found = ConvexHull(held)
        if found.volume < THIN**3:
            raise QhullError("flat")
    except (QhullError, ValueError):
        held = _thickened(held)
        found = ConvexHull(held)
    return Hull(held[np.sort(found.vertices)], found.equations, float(found.volume))


def _thickened(points: FloatArray) -> FloatArray:
    """Grow points to small cubes."""
    cube = np.array([[i, j, k] for i in (-1, 1) for j in (-1, 1) for k in (-1, 1)]) * THIN / 2
    return np.asarray((points[:, None] + cube).reshape(-1, 3))


def fewer_corners(hull: Hull, most: int = MOST_POINTS) -> Hull:
    """Return a hull that holds another and has few corners, cut by planes in fixed directions."""
    if len(hull.points) <= most:
        return hull
    from scipy.spatial import HalfspaceIntersection

    # As wide in every direction, so that planes lie as close to a pole as to a ball.
    size = np.maximum(np.ptp(hull.points, axis=0), THIN)
    even = hull.points / size
    normals = _directions()
    planes = np.column_stack([normals, -(even @ normals.T).max(axis=0)])
    corners = HalfspaceIntersection(planes, even.mean(axis=0)).intersections
    return hull_of(np.round(corners * size, 6))


@lru_cache(maxsize=1)
def _directions() -> FloatArray:
    """Return unit vectors: the axes, and a spiral from pole to pole (Vogel 1979), (d, 3)."""
    number = np.arange(DIRECTIONS) + 0.5
    z = 1 - 2 * number / DIRECTIONS
    turn = np.pi * (1 + np.sqrt(5)) * number
    flat = np.sqrt(1 - z * z)
    spiral = np.column_stack([flat * np.cos(turn), flat * np.sin(turn), z])
    return np.concatenate([spiral, np.eye(3), -np.eye(3)])


def simplest(hull: Hull) -> Solid:
    """Return the cylinder or box round a hull if it is hardly larger, else the hull in few corners.

    What is returned holds the hull whole.
    """
    low, high = hull.points.min(axis=0), hull.points.max(axis=0)
    box = box_round(hull.points)
    if hull.volume >= BOX_SHARE * box.volume:
        return box
    middle = (low + high) / 2
    radius = float(np.hypot(*(hull.points - middle)[:, :2].T).max())
    cylinder = Cylinder(middle, radius, float(high[2] - low[2]) / 2)
    if hull.volume >= ROUND_SHARE * cylinder.volume:
        return cylinder
    return fewer_corners(hull)


def box_round(points: FloatArray) -> Box:
    """Return the smallest upright box round (n, 3) points."""
    import shapely

    low, high = points[:, 2].min(), points[:, 2].max()
    plan = shapely.minimum_rotated_rectangle(shapely.multipoints(points[:, :2]))
    if plan.geom_type != "Polygon":  # all on one line
        plan = shapely.minimum_rotated_rectangle(plan.buffer(THIN / 2, quad_segs=1))
    a, b, c = shapely.get_coordinates(plan)[:3]
    yaw = float(np.arctan2(*(b - a)[::-1]))
    # Of the equal ways to turn a box the one nearest to no turn is taken.
    quarter = int(np.round(yaw / (np.pi / 2)))
    size = np.array([np.hypot(*(b - a)), np.hypot(*(c - b))]) / 2
    yaw -= quarter * np.pi / 2
    size = size[::-1] if quarter % 2 else size
    half = np.maximum([*size, (high - low) / 2], THIN / 2)
    return Box(np.array([*((a + c) / 2), (low + high) / 2]), half, yaw)


def hulls_round(clusters: Sequence[FloatArray], *, most: int, slack: float) -> list[Hull]:
    """Cover pieces of a shape by few hulls: neighbours are joined while little air comes in.

    Parameters
    ----------
    clusters
        Points of each piece, (n, 3); a piece counts as convex.
    most
        Hulls at most, from 1.
    slack
        Share of the hull of all that a hull may hold beyond its pieces, unless there are too many.
    """
    hulls = {number: hull_of(points) for number, points in enumerate(clusters)}
    solid = {number: hull.volume for number, hull in hulls.items()}
    allowed = slack * hull_of(np.concatenate([hull.points for hull in hulls.values()])).volume
    costs = {
        pair: _joined(hulls, solid, *pair) for pair in combinations(hulls, 2)
        if _near(hulls[pair[0]], hulls[pair[1]])
    }  # fmt: skip
    while len(hulls) > 1:
        if not costs and len(hulls) > most:
            costs = {pair: _joined(hulls, solid, *pair) for pair in combinations(hulls, 2)}
        if not costs:
            break
        best = min(costs, key=lambda pair: (costs[pair][0], pair))
        if costs[best][0] > allowed and len(hulls) <= most:
            break
        one, other = best
        hulls[one] = costs[best][1]
        solid[one] += solid[other]
        del hulls[other], solid[other]
        costs = {pair: cost for pair, cost in costs.items() if not {one, other} & set(pair)}
        for number in hulls:
            if number != one and _near(hulls[number], hulls[one]):
                pair = (min(number, one), max(number, one))
                costs[pair] = _joined(hulls, solid, *pair)
    return list(hulls.values())


def _joined(
    hulls: dict[int, Hull], solid: dict[int, float], one: int, other: int
) -> tuple[float, Hull]:
    """Return the air that the hull of two would hold, cubic metres, and the hull."""
    hull = hull_of(np.concatenate([hulls[one].points, hulls[other].points]))
    return hull.volume - solid[one] - solid[other], hull


def _near(one: Hull, other: Hull) -> bool:
    gap = np.maximum(one.points.min(axis=0), other.points.min(axis=0))
    gap -= np.minimum(one.points.max(axis=0), other.points.max(axis=0))
    return bool((gap <= NEAR).all())


def piece_of_vertices(faces: IntArray | NDArray[np.int32], count: int) -> IntArray:
    """Return the lowest vertex of the connected piece of a mesh that each vertex is of, (n,).

    Parameters
    ----------
    faces
        (f, 4) rows of vertices, triangles with -1.
    count
        Number of vertices.
    """
    a, b, c, d = faces.T
    quad = d != NO_VERTEX
    begin, end = np.concatenate([a, b, c[quad]]), np.concatenate([b, c, d[quad]])
    return components(np.column_stack([begin, end]), count)


def pieces_of_mesh(vertices: FloatArray, faces: IntArray) -> list[IntArray]:
    """Return the rows of the vertices of each connected piece of a mesh.

    Parameters
    ----------
    vertices
        (n, 3) metres.
    faces
        As of `piece_of_vertices`.
    """
    lowest = piece_of_vertices(faces, len(vertices))
    used = np.zeros(len(vertices), bool)
    used[faces[faces != NO_VERTEX]] = True
    rows = np.flatnonzero(used)
    order = rows[np.argsort(lowest[rows], kind="stable")]
    cuts = [0, *(np.flatnonzero(np.diff(lowest[order])) + 1).tolist(), len(order)]
    return [order[first:end] for first, end in pairwise(cuts) if first < end]


def upright_hulls(
    vertices: FloatArray, faces: IntArray | NDArray[np.int32], shell: IntArray, shells: int
) -> list[list[Hull]]:
    """Cover shells that stand on their plans by convex hulls, those of each in a list.

    The plan of each connected piece is cut into convex parts; what of the shell lies over one part
    is hulled. Prisms and roofs whose ridges run along the cuts come out exact; what is hollow from
    above, such as a saddle between two ridges, is filled.

    Parameters
    ----------
    vertices
        (n, 3) metres.
    faces
        As of `piece_of_vertices`.
    shell
        (f,) shell of each face, below `shells`; no two share a vertex.
    """
    piece = piece_of_vertices(faces, len(vertices))[faces[:, 0]]
    order = np.lexsort((piece, shell))
    faces, piece, shell = faces[order], piece[order], shell[order]
    start = np.append(np.flatnonzero(np.diff(piece, prepend=-1)), len(faces))
    found: list[list[Hull]] = [[] for _ in range(shells)]
    rings = convex_pieces(_plans(vertices, faces, start))
    for own, (first, end) in zip(rings, pairwise(start.tolist()), strict=True):
        hulls = found[int(shell[first])]
        clusters = _clusters(vertices, faces[first:end], own) if len(own) > 1 else []
        if 1 < len(clusters) <= PIECES_JOINED:
            hulls += hulls_round(clusters, most=PIECES_JOINED, slack=SLACK)
        else:
            corners = faces[first:end]
            whole = vertices[np.unique(corners[corners != NO_VERTEX])]
            hulls += [hull_of(points) for points in clusters or [whole]]
    return found


def _clusters(
    vertices: FloatArray, faces: IntArray | NDArray[np.int32], rings: list[FloatArray]
) -> list[FloatArray]:
    """Return the points of a shell over each of the convex rings of its plan."""
    begin, end = _edges(faces, len(vertices))
    a, b = vertices[begin], vertices[end]
    clusters = []
    for ring in rings:
        inside = [points[_within(points[:, :2], ring)] for points in (a, b)]
        crossing = [_crossings(a, b, *side) for side in zip(ring, _next(ring), strict=True)]
        met = np.concatenate([*inside, *crossing])
        met = met[_within(met[:, :2], ring)]
        if len(met) > 3:
            clusters.append(met)
    return clusters


def _plans(
    vertices: FloatArray, faces: IntArray | NDArray[np.int32], start: IntArray
) -> NDArray[Any]:
    """Return the shadow on the plane of each run of faces, a polygon or several.

    That of a run in the shadow of one of its faces is left empty: it is convex.
    """
    size = np.abs(area_vectors(vertices, faces)[:, 2])
    run = np.repeat(np.arange(len(start) - 1), np.diff(start))
    level = (size > FLAT) & ~_shaded(vertices, faces, start, size)[run]
    shown = faces[level]
    last = np.where(shown[:, 3] == NO_VERTEX, shown[:, 0], shown[:, 3])
    corners = vertices[np.column_stack([shown[:, :3], last, shown[:, 0]])][:, :, :2]
    shadows = shapely.set_precision(shapely.make_valid(shapely.polygons(corners)), GRID)
    cuts = np.concatenate([[0], np.cumsum(level)])[start].tolist()
    plans = np.full(len(start) - 1, shapely.Polygon(), object)
    for row, (first, end) in enumerate(pairwise(cuts)):
        if first < end:
            plans[row] = shapely.union_all(shadows[first:end], grid_size=GRID)
    return plans


def _shaded(
    vertices: FloatArray, faces: IntArray | NDArray[np.int32], start: IntArray, size: FloatArray
) -> NDArray[np.bool_]:
    """(r,) whether each run of faces has all corners at those of its largest face, or inside of it.

    The face is a convex quad, and inside is deeper than rounding moves a corner.
    """
    run = np.repeat(np.arange(len(start) - 1), np.diff(start))
    largest = faces[np.lexsort((size, run))[start[1:] - 1]]
    ring = vertices[largest][:, :, :2]  # (r, 4, 2)
    side = np.roll(ring, -1, axis=1) - ring
    length, bend = np.hypot(*side.T).T, np.cross(side, np.roll(side, -1, axis=1))
    sign = np.sign(bend.sum(axis=1, keepdims=True))
    clear = bend * sign > 2 * GRID * (length + np.roll(length, -1, axis=1))
    convex = (largest[:, 3] != NO_VERTEX) & clear.all(axis=1)
    inward = side[..., ::-1] * [-1, 1] * (sign / np.maximum(length, GRID))[..., None]
    asked = np.flatnonzero(convex[run])
    own = run[asked]
    corners = np.where(faces[asked] == NO_VERTEX, faces[asked, :1], faces[asked])
    away = vertices[corners][:, :, None, :2] - ring[own][:, None]  # (a, 4, 4, 2)
    same = (np.abs(away) < NEARLY).all(axis=3).any(axis=2)
    inside = ((away * inward[own][:, None]).sum(axis=3) > 2 * GRID).all(axis=2)
    convex[own[~(same | inside).all(axis=1)]] = False
    return np.asarray(convex)


def convex_pieces(shapes: ArrayLike) -> list[list[FloatArray]]:
    """Cut polygons into convex ones between their own corners (Hertel and Mehlhorn 1983).

    Parameters
    ----------
    shapes
        (n,) a polygon each, or several.

    Returns
    -------
    rings
        For each shape the corners of its pieces, (k, 2), counter-clockwise, without the closing
        one. At most four times as many as the fewest there can be.
    """
    parts, of_shape = shapely.get_parts(np.asarray(shapes, object), return_index=True)
    solid = (shapely.get_type_id(parts) == POLYGON) & (shapely.area(parts) > FLAT)
    polygons = shapely.simplify(parts[solid], GRID)
    rings = rings_of(polygons)
    cut = triangulate(polygons, rings)
    joined = _joined_rings(rings.points, cut.triangles.tolist())
    found: list[list[FloatArray]] = [[] for _ in range(len(np.asarray(shapes, object)))]
    for row, ring in zip(of_shape[solid][cut.polygon].tolist(), joined, strict=True):
        if ring:
            found[row].append(rings.points[ring])
    return found


def _joined_rings(points: FloatArray, rings: list[list[int]]) -> list[list[int]]:
    """Join rings over the sides they share, the longest first, while what comes out is convex.

    Returns
    -------
    joined
        The rings, empty those that went into another.
    """
    side: dict[tuple[int, int], int] = {
        (p, q): number for number, ring in enumerate(rings)
        for p, q in zip(ring, [*ring[1:], ring[0]], strict=True)
    }  # fmt: skip
    shared = [pair for pair in side if pair[0] < pair[1] and pair[::-1] in side]
    ends = np.array(shared, np.int64).reshape(-1, 2)
    lengths = np.hypot(*(points[ends[:, 0]] - points[ends[:, 1]]).T)
    places = [complex(x, y) for x, y in points.tolist()]
    for row in np.lexsort((ends[:, 1], ends[:, 0], -lengths)).tolist():
        p, q = shared[row]
        one, other = side[p, q], side[q, p]
        if one == other:
            continue
        ring = _spliced(rings[one], rings[other], p, q)
        if len(set(ring)) < len(ring) or not _is_convex([places[corner] for corner in ring]):
            continue
        rings[one], rings[other] = ring, []
        for pair in zip(ring, [*ring[1:], ring[0]], strict=True):
            side[pair] = one
    return rings


def _spliced(one: list[int], other: list[int], p: int, q: int) -> list[int]:
    """Return the ring round two of which the first has the side from p to q, the second q to p."""
    at, back = one.index(q), other.index(p)
    return [*one[at:], *one[:at], *[*other[back:], *other[:back]][1:-1]]


def _is_convex(ring: list[complex]) -> bool:
    along = [end - begin for begin, end in zip(ring, [*ring[1:], ring[0]], strict=True)]
    return all(
        one.real * two.imag - one.imag * two.real >= -CONVEX * abs(one) * abs(two)
        for one, two in zip(along, [*along[1:], along[0]], strict=True)
    )


def _next(ring: FloatArray) -> FloatArray:
    """Return the point that follows each of a ring."""
    return np.concatenate([ring[1:], ring[:1]])


def _within(xy: FloatArray, ring: FloatArray) -> Any:
    """Whether (n, 2) points lie in a convex ring or touch it, (n,) bool."""
    along = _next(ring) - ring
    normal = np.column_stack([-along[:, 1], along[:, 0]])
    normal /= np.maximum(np.hypot(*along.T), GRID)[:, None]
    return (xy @ normal.T - (ring * normal).sum(axis=1) >= -TOUCH).all(axis=1)


def _edges(faces: IntArray | NDArray[np.int32], count: int) -> tuple[IntArray, IntArray]:
    """Return the edges of faces, each once, by their lower and their higher vertex."""
    a, b, c, d = faces.T.astype(np.int64)
    quad = d != NO_VERTEX
    begin = np.concatenate([a, b, c, d[quad]])
    end = np.concatenate([b, c, np.where(quad, d, a), a[quad]])
    once = np.unique(np.minimum(begin, end) * count + np.maximum(begin, end))
    return once // count, once % count


def _crossings(a: FloatArray, b: FloatArray, p: FloatArray, q: FloatArray) -> FloatArray:
    """Return where edges a-b, (n, 3) each, cross the upright wall over the line p-q, (m, 3)."""
    along = q - p
    normal = np.array([-along[1], along[0]])
    first, second = (a[:, :2] - p) @ normal, (b[:, :2] - p) @ normal
    across = first * second < 0
    share = first[across] / (first[across] - second[across])
    return np.asarray(a[across] + share[:, None] * (b[across] - a[across]))
