"""The arrangement: regions of any shape become faces that leave no gap and no overlap.

All boundary lines are noded together on one grid, so every face, and every triangle of it, shares
its vertices with its neighbours. Which region a face belongs to is asked afterwards, with one point
inside of it; the region of the highest priority wins. No polygon is ever cut by another.

References
----------
Hobby, "Practical segment intersection with finite precision output", 1999 (snap rounding).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
import shapely
from numpy.typing import ArrayLike, NDArray

from cityx.city.ground import LABEL, ON_ROADWAY, Ground
from cityx.geometry.arrays import IntArray
from cityx.geometry.chains import components
from cityx.geometry.faces import OUTSIDE, doubled_areas, trace_faces
from cityx.geometry.noding import FINE, snap_round
from cityx.system.remembered import Remembered

GRID = 0.01  # metres; finer than a joint between kerb stones, coarser than any rounding error
PER_METRE = 100  # grid steps per metre
SLIVER_AREA = 0.02  # square metres; smaller faces take the label of their longest neighbour
SLIVER_WIDTH = 0.02  # metres; so do thinner ones
BEYOND = OUTSIDE  # the face on the far side of the site's border
LENGTHWISE = 0.25  # share of its rim that a face has in common with what it was cut from
LEAST_CUT = 0.25  # metres of it; rails and lines are narrower


@dataclass(frozen=True)
class Regions:
    """n regions that compete for the ground.

    Attributes
    ----------
    polygons
        (n,) shapely Polygons or MultiPolygons, scene frame, metres.
    label
        (n,) uint8 into `cityx.city.SURFACES`.
    priority
        (n,) int32; the highest wins, among equals the lowest object id.
    object_id
        (n,) uint64.
    """

    polygons: NDArray[Any] = field(default_factory=lambda: np.zeros(0, object))
    label: NDArray[np.uint8] = field(default_factory=lambda: np.zeros(0, np.uint8))
    priority: NDArray[np.int32] = field(default_factory=lambda: np.zeros(0, np.int32))
    object_id: NDArray[np.uint64] = field(default_factory=lambda: np.zeros(0, np.uint64))


def regions(
    polygons: ArrayLike, label: ArrayLike, priority: ArrayLike, object_id: ArrayLike = 0
) -> Regions:
    """Make regions; all but the polygons broadcast, and what has no area is dropped."""
    shapes = np.atleast_1d(np.asarray(polygons, dtype=object))
    size = len(shapes)
    labels = np.broadcast_to(np.asarray(label, np.uint8), size)
    priorities = np.broadcast_to(np.asarray(priority, np.int32), size)
    ids = np.broadcast_to(np.asarray(object_id, np.uint64), size)
    shapes, row = shapely.get_parts(shapes, return_index=True)
    flat = (shapely.get_type_id(shapes) == 3) & (shapely.area(shapes) > 0)
    row = row[flat]
    return Regions(shapes[flat], labels[row], priorities[row], ids[row])


def take_regions(given: Regions, rows: ArrayLike) -> Regions:
    """Return the regions of the given rows, in that order."""
    rows = np.asarray(rows, dtype=np.int64)
    return Regions(
        given.polygons[rows], given.label[rows], given.priority[rows], given.object_id[rows]
    )


def join_regions(parts: Sequence[Regions]) -> Regions:
    """Put regions together."""
    if not parts:
        return Regions()
    return Regions(
        np.concatenate([part.polygons for part in parts]),
        np.concatenate([part.label for part in parts]),
        np.concatenate([part.priority for part in parts]),
        np.concatenate([part.object_id for part in parts]),
    )


def arrange(
    given: Regions,
    extent: tuple[float, float, float, float],
    *,
    lines: ArrayLike = (),
    background: int = LABEL["block"],
) -> Ground:
    """Divide a rectangle into labelled, triangulated faces.

    Parameters
    ----------
    given
        The regions. Invalid polygons are allowed: only their rings and a point test are used.
    extent
        (xmin, ymin, xmax, ymax), metres; rounded to the grid.
    lines
        Shapely lines at which faces are cut besides (terrain grid, cut bars).
    background
        Label of what no region covers.

    Returns
    -------
    ground
        The faces. Every interior edge is shared by exactly two triangles.
    """
    west, south, east, north = np.round(np.asarray(extent, float) * PER_METRE) / PER_METRE
    site = shapely.box(west, south, max(east, west + GRID), max(north, south + GRID))
    given = _inside(given, site)
    faces = trace_faces(*snap_round(*_segments(given.polygons, np.asarray(lines, object), site)))
    triangles, face = faces.triangles()
    count = faces.count
    ground = Ground(
        faces.points / PER_METRE,
        triangles.astype(np.int32),
        face.astype(np.int32),
        np.zeros(count, np.uint8),
        np.zeros(count, np.uint64),
        faces.edges.astype(np.int32),
        faces.edge_faces.astype(np.int32),
    )
    label, object_id = _owners(given, inner_points(ground), background)
    ground = replace(ground, face_label=label, face_object=object_id)
    return _absorb_slivers(ground, doubled_areas(faces.points, triangles))


def _inside(given: Regions, site: Any) -> Regions:
    """Cut regions at the site's rectangle and drop those outside."""
    west, south, east, north = site.bounds
    box = shapely.bounds(given.polygons)
    within = (box[:, 0] >= west) & (box[:, 1] >= south) & (box[:, 2] <= east) & (box[:, 3] <= north)
    outside = (box[:, 0] > east) | (box[:, 1] > north) | (box[:, 2] < west) | (box[:, 3] < south)
    shapes = given.polygons.copy()
    across = np.flatnonzero(~within & ~outside)
    shapes[across] = shapely.intersection(shapely.make_valid(shapes[across]), site)
    keep = np.flatnonzero(~outside)
    return regions(shapes[keep], given.label[keep], given.priority[keep], given.object_id[keep])


def _segments(polygons: NDArray[Any], lines: NDArray[Any], site: Any) -> tuple[IntArray, IntArray]:
    """Both ends, (m, 2) each, of the segments of all boundary lines, in parts of a grid step."""
    if len(lines):
        lines = shapely.intersection(lines, site)
    strokes = np.concatenate([shapely.get_rings(polygons), lines.ravel(), [site.exterior]])
    points, owner = shapely.get_coordinates(shapely.get_parts(strokes), return_index=True)
    spots = np.rint(points * (PER_METRE * FINE)).astype(np.int64)
    first = np.flatnonzero(owner[1:] == owner[:-1])
    return spots[first], spots[first + 1]


def inner_points(ground: Ground) -> NDArray[np.float64]:
    """(f, 2) a point in each face: the centroid of its largest triangle."""
    face = ground.triangle_face
    area = doubled_areas(ground.vertices, ground.triangles)
    begin = np.flatnonzero(np.r_[True, face[1:] != face[:-1]])
    largest = np.flatnonzero(area == np.maximum.reduceat(area, begin)[face])
    largest = largest[np.unique(face[largest], return_index=True)[1]]
    return np.asarray(ground.vertices[ground.triangles[largest]].mean(axis=1))


def _owners(
    given: Regions, points: NDArray[np.float64], background: int
) -> tuple[NDArray[np.uint8], NDArray[np.uint64]]:
    """Find the winning region at each point."""
    label = np.full(len(points), background, np.uint8)
    object_id = np.zeros(len(points), np.uint64)
    if not len(given.polygons):
        return label, object_id
    shapely.prepare(given.polygons)
    point, region = shapely.STRtree(given.polygons).query(shapely.points(points))
    # The tree lists regions by where all of them lie; of two alike the lower label wins.
    order = np.lexsort(
        (given.label[region], given.object_id[region], -given.priority[region], point)
    )
    point, region = point[order], region[order]
    first = np.flatnonzero(np.r_[True, point[1:] != point[:-1]][: len(point)])
    last = np.r_[first[1:], len(point)]
    while len(first):  # the next region of each point that lies in none yet
        held = shapely.contains_xy(given.polygons[region[first]], *points[point[first]].T)
        winner = first[held]
        label[point[winner]] = given.label[region[winner]]
        object_id[point[winner]] = given.object_id[region[winner]]
        first, last = first[~held] + 1, last[~held]
        first, last = first[first < last], last[first < last]
    return label, object_id


def half_edges(triangles: NDArray[Any]) -> tuple[IntArray, IntArray]:
    """Return directed edges, (3t, 2), and the opposite of each, (3t,), -1 if there is none."""
    edges = triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2).astype(np.int64)
    if not len(edges):
        return edges, np.zeros(0, np.int64)
    stride = int(edges.max()) + 1
    forward = edges[:, 0] < edges[:, 1]
    keys = np.minimum(*edges.T)
    keys *= stride
    keys += np.maximum(*edges.T)
    order = np.argsort(keys, kind="stable")
    keys = keys[order]
    pair = np.flatnonzero((keys[1:] == keys[:-1]) & (forward[order][1:] != forward[order][:-1]))
    twin = np.full(len(edges), -1, np.int64)
    twin[order[pair]], twin[order[pair + 1]] = order[pair + 1], order[pair]
    return edges, twin


_AREAS: Remembered[NDArray[np.float64]] = Remembered()
_LENGTHS: Remembered[NDArray[np.float64]] = Remembered()


def face_areas(ground: Ground) -> NDArray[np.float64]:
    """(f,) area of each face, square metres, read only; other labels change nothing."""

    def made() -> NDArray[np.float64]:
        area = doubled_areas(ground.vertices, ground.triangles) / 2
        size = len(ground.face_label)
        return _fixed(np.bincount(ground.triangle_face, area, minlength=size))

    return _AREAS.get(made, [ground.vertices, ground.triangles, ground.triangle_face])


def edge_lengths(ground: Ground) -> NDArray[np.float64]:
    """(e,) metres of each edge, read only."""

    def made() -> NDArray[np.float64]:
        begin, end = ground.vertices[ground.edges.T]
        return _fixed(np.hypot(*(end - begin).T))

    return _LENGTHS.get(made, [ground.vertices, ground.edges])


def inner_edges(ground: Ground) -> tuple[IntArray, IntArray, NDArray[np.float64]]:
    """Left and right faces of the edges between two faces, and their lengths in metres."""
    left, right = ground.edge_faces.T.astype(np.int64)
    inner = right != BEYOND
    return left[inner], right[inner], edge_lengths(ground)[inner]


def _fixed(values: NDArray[Any]) -> NDArray[np.float64]:
    found = np.asarray(values, float)
    found.flags.writeable = False
    return found


def _absorb_slivers(ground: Ground, doubled: IntArray) -> Ground:
    """Give faces too thin to see the label of the neighbour along their longest edge.

    Where that is thin as well, both go together, over the longest other edge of either. What lines
    of hidden surfaces cut off from a mark on a roadway stays with it, and no mark grows.
    """
    size = len(ground.face_label)
    area = np.bincount(ground.triangle_face, doubled, minlength=size) / (2 * PER_METRE**2)
    length = edge_lengths(ground)
    rim = np.bincount(ground.edge_faces[:, 0], length, minlength=size)
    inner = ground.edge_faces[:, 1] != BEYOND
    rim += np.bincount(ground.edge_faces[inner, 1], length[inner], minlength=size)
    thin = (area < SLIVER_AREA) | (2 * area < SLIVER_WIDTH * rim)
    left, right = ground.edge_faces[inner].T.astype(np.int64)
    paint = ground.labelled(*ON_ROADWAY)
    same = paint[left] & (ground.face_label[left] == ground.face_label[right])
    mark = components(np.column_stack([left, right])[same], size)
    of_mark = np.bincount(mark, area, minlength=size)[mark]
    thin &= ~(paint & (np.bincount(mark, minlength=size)[mark] > 1) & (of_mark > SLIVER_AREA))
    own, other = _by_longest_edge(ground, thin, ~paint)
    return _labelled_as(ground, *_taken_along(own, other, thin))


def _taken_along(
    own: IntArray, other: IntArray, thin: NDArray[np.bool_]
) -> tuple[IntArray, IntArray]:
    """Return thin faces and those that they end up with.

    Parameters
    ----------
    own, other
        (m,) thin faces and neighbours of theirs, thin or not, pairs with the longest edge first.
    thin
        (f,) bool.
    """
    from scipy.sparse import csr_array
    from scipy.sparse.csgraph import minimum_spanning_tree

    faces = np.flatnonzero(thin)
    number = np.zeros(len(thin), np.int64)  # of thin faces from 1; all others are one root
    number[faces] = np.arange(1, len(faces) + 1)
    ends = np.sort(np.column_stack([number[own], number[other]]), axis=1)
    size = len(faces) + 1
    pair = np.unique(ends[:, 0] * size + ends[:, 1], return_index=True)[1]
    # The tree of the longest edges holds one way from each face to the root.
    graph = csr_array((pair + 1.0, ends[pair].T), shape=(size, size))
    tree = minimum_spanning_tree(graph).tocoo()
    row = tree.data.astype(np.int64) - 1
    leads = ends[row, 0] == 0
    group = components(ends[row[~leads]], size)
    taker = np.full(size, -1, np.int64)
    taker[group[number[own[row[leads]]]]] = other[row[leads]]
    found = taker[group[number[faces]]]
    return faces[found >= 0], found[found >= 0]


def owners(ground: Ground, label: int, over: tuple[str, ...]) -> NDArray[np.int64]:
    """Return which surface of one label each face belongs to, also for faces on top of it.

    Parameters
    ----------
    ground
        The arrangement.
    label
        Of the surfaces, each known by its object.
    over
        Names of what may lie on them; it belongs to what it shares most of its rim with. Lines of
        what lies below may have cut it into faces, which count as one if cut lengthwise.

    Returns
    -------
    owner
        (f,) from 1 in the order of the objects; 0 for none.
    """
    mine = ground.face_label == label
    ids = np.unique(ground.face_object[mine])
    owner = np.zeros(len(mine), np.int64)
    owner[mine] = 1 + np.searchsorted(ids, ground.face_object[mine])
    left, right, length = inner_edges(ground)
    paint = ground.labelled(*over)
    group = _mended(ground.face_label, paint, left, right, length)
    apart = group[left] != group[right]
    left, right, length = left[apart], right[apart], length[apart]
    size = len(owner)
    rim = np.bincount(group[left], length, size) + np.bincount(group[right], length, size)
    while True:  # rails cross each other inside of a junction, bars of a box are cut by many lines
        held, other = np.zeros(size), np.zeros(size, np.int64)
        for a, b in ((left, right), (right, left)):
            rows = np.flatnonzero(paint[a] & (owner[a] == 0) & (owner[b] > 0))
            np.add.at(held, group[a[rows]], length[rows])
            other[group[a[rows]]] = owner[b[rows]]
        found = np.where(held > 0.5 * rim, other, 0)[group]
        known = np.where(paint & (owner == 0), found, owner)
        if np.array_equal(known, owner):
            return owner
        owner = known


def _mended(
    label: NDArray[Any], chosen: NDArray[np.bool_], left: IntArray, right: IntArray,
    length: NDArray[np.float64],
) -> IntArray:  # fmt: skip
    """(f,) a number for each face, one for those of a label that were one and have been cut.

    A cut lengthwise is what takes a good part of the rim of the smaller face, and is no cut across
    that leaves a sliver.
    """
    size = len(label)
    rim = np.bincount(left, length, size) + np.bincount(right, length, size)
    same = chosen[left] & (label[left] == label[right])
    pairs = np.sort(np.column_stack([left, right])[same], axis=1)
    if not len(pairs):
        return np.arange(size, dtype=np.int64)
    keys, index = np.unique(pairs[:, 0] * size + pairs[:, 1], return_inverse=True)
    pairs = np.column_stack([keys // size, keys % size])
    shared = np.bincount(index, length[same], len(pairs))
    cut = shared > np.maximum(LENGTHWISE * rim[pairs].min(axis=1), LEAST_CUT)
    return np.asarray(components(pairs[cut], size), np.int64)


def absorb_scraps(
    ground: Ground, label: int, area: float, over: tuple[str, ...], kin: tuple[str, ...] = ()
) -> Ground:
    """Give scraps of the surfaces of one label to their neighbours.

    Scraps are pieces that something cut off, and slivers by which a surface touches itself.

    Parameters
    ----------
    ground
        The arrangement.
    label
        Of the surfaces, each known by its object.
    area
        Square metres; smaller pieces of a surface go to any neighbour if it has a larger one.
    over
        Names of what lies on surfaces without parting them, nor takes their scraps.
    kin
        Names of the only neighbours that take larger pieces, all but the largest.
    """
    size = len(ground.face_label)
    owner = owners(ground, label, over)
    left, right = ground.edge_faces.T.astype(np.int64)
    right = np.where(right != BEYOND, right, left)
    same = (owner[left] == owner[right]) & (owner[left] > 0)
    piece = components(np.column_stack([left, right])[same], size)
    of_piece = np.bincount(piece, face_areas(ground), minlength=size)[piece]
    largest = np.zeros(int(owner.max(initial=0)) + 1)
    np.maximum.at(largest, owner, of_piece)
    apart = (ground.face_label == label) & (of_piece < largest[owner])
    takes = ~ground.labelled(*over)
    small = of_piece < area
    for scrap, taker in ((apart & small, takes), (apart & ~small, ground.labelled(*kin) | apart)):
        # A scrap among scraps waits until one of these has gone to a neighbour.
        waiting = scrap
        while waiting.any():
            given = _given_away(ground, waiting, taker)
            still = waiting & (given.face_object == ground.face_object)
            if still.sum() == waiting.sum():
                break
            ground, waiting = given, still
    thin = (ground.face_label == label) & (face_areas(ground) < SLIVER_AREA)
    thin &= _touching(ground, owners(ground, label, over))
    return _given_away(ground, thin, takes & (ground.face_label != label))


def _touching(ground: Ground, owner: NDArray[np.int64]) -> NDArray[np.bool_]:
    """(f,) faces with a corner at which the outline of their own surface meets itself."""
    left, right = ground.edge_faces.T.astype(np.int64)
    beyond = np.where(right == BEYOND, 0, owner[np.maximum(right, 0)])
    rim = owner[left] != beyond
    vertex = np.tile(ground.edges[rim].astype(np.int64).T.ravel(), 2)
    surface = np.concatenate([np.tile(owner[left[rim]], 2), np.tile(beyond[rim], 2)])
    count = int(owner.max(initial=0)) + 1
    key, times = np.unique(vertex * count + surface, return_counts=True)
    crossed = key[(times > 2) & (key % count > 0)]
    corner = ground.triangles.astype(np.int64) * count + owner[ground.triangle_face][:, None]
    found = np.zeros(len(owner), bool)
    found[ground.triangle_face[np.isin(corner, crossed).any(axis=1)]] = True
    return found


def _given_away(
    ground: Ground, given: NDArray[np.bool_], takes: NDArray[np.bool_] | None = None
) -> Ground:
    """Give faces the label of the neighbour along their longest edge that keeps its own.

    Of the neighbours only those marked in `takes`, if given.
    """
    own, other = _by_longest_edge(ground, given, ~given if takes is None else takes & ~given)
    own, first = np.unique(own, return_index=True)
    return _labelled_as(ground, own, other[first])


def _by_longest_edge(
    ground: Ground, given: NDArray[np.bool_], takes: NDArray[np.bool_]
) -> tuple[IntArray, IntArray]:
    """Return faces that are given with neighbours that take, pairs with the longest edge first."""
    length = edge_lengths(ground)
    inner = ground.edge_faces[:, 1] != BEYOND
    pairs, reach = ground.edge_faces[inner].astype(np.int64), length[inner]
    own = np.concatenate([pairs[:, 0], pairs[:, 1]])
    other = np.concatenate([pairs[:, 1], pairs[:, 0]])
    reach = np.concatenate([reach, reach])
    useful = given[own] & takes[other]
    own, other, reach = own[useful], other[useful], reach[useful]
    order = np.lexsort((other, own, -np.round(reach, 6)))
    return own[order], other[order]


def _labelled_as(ground: Ground, own: IntArray, other: IntArray) -> Ground:
    """Give faces the label of others."""
    label, object_id = ground.face_label.copy(), ground.face_object.copy()
    label[own], object_id[own] = label[other], object_id[other]
    return replace(ground, face_label=label, face_object=object_id)


def check_arrangement(ground: Ground) -> tuple[int, int, float]:
    """Check that the faces cover their rectangle once.

    Returns
    -------
    open_edges
        Triangle edges without a neighbour that do not lie on the border of the rectangle.
    overlapping_faces
        Faces with a triangle that is turned over, without area, or that shares an edge with more
        than one other on the same side.
    area_error
        Difference between the area of all triangles and that of the rectangle, as a share.
    """
    if not len(ground.triangles):
        return 0, 0, 1.0
    vertices = np.rint(ground.vertices * PER_METRE).astype(np.int64)
    edges, twin = half_edges(ground.triangles)
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    loose = vertices[edges[twin < 0]]  # (k, 2, 2)
    del twin
    on_border = ((loose == low).all(axis=1) | (loose == high).all(axis=1)).any(axis=1)
    area = doubled_areas(vertices, ground.triangles)
    bad = np.zeros(len(ground.face_label), bool)
    bad[ground.triangle_face[area <= 0]] = True
    bad[ground.triangle_face[_again(edges[:, 0] * len(vertices) + edges[:, 1]) // 3]] = True
    whole = 2.0 * float(np.prod((high - low).astype(float)))
    error = abs(float(area.sum()) - whole) / max(whole, 1.0)
    return int(np.count_nonzero(~on_border)), int(np.count_nonzero(bad)), error


def _again(keys: IntArray) -> IntArray:
    """Return the rows whose key an earlier row has."""
    rising = np.sort(keys)  # faster than the order of them, which hardly any ground needs
    rows = np.flatnonzero(np.isin(keys, rising[1:][rising[1:] == rising[:-1]]))
    order = rows[np.argsort(keys[rows], kind="stable")]
    return np.asarray(order[1:][keys[order[1:]] == keys[order[:-1]]], np.int64)
