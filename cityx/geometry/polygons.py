"""Polygons as arrays: rings in one table, cleaned, oriented and triangulated in bulk."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import shapely
from numpy.typing import ArrayLike, NDArray

from cityx.geometry.arrays import FloatArray, IntArray
from cityx.geometry.ranges import ranges

GRID = 1e-3  # metres; finer than any survey, coarse enough to hide differences between machines
STRAY = 2e-3  # metres; a point this near to the line between its neighbours makes only slivers
SLIT = 5e-3  # metres; outlines that come closer to themselves are snapped until they do not
MIN_AREA = 0.05  # square metres; smaller outlines are slips of the pen
STRAIGHT = np.radians(3.0)  # a bend below this is drawing noise, not a corner
MAX_MITRE = 3.0  # times the distance; a sharper corner would grow a spike
MIN_SHARE = 0.02  # of its length that an edge keeps when its ring is moved
MAX_SAGITTA = 0.15  # metres; a chain of small bends that leaves its chord further is a curve


@dataclass(frozen=True)
class Rings:
    """Rings of n polygons, r of them with m points altogether.

    Shells run counter-clockwise and holes clockwise, so the solid lies on the left hand. The
    closing point is not repeated.

    Attributes
    ----------
    points
        (m, 2) float64.
    start
        (r + 1,) offsets of rings into ``points``.
    polygon
        (r,) polygon of each ring; a polygon's shell comes before its holes.
    hole
        (r,) bool.
    """

    points: FloatArray
    start: IntArray
    polygon: IntArray
    hole: NDArray[np.bool_]

    @property
    def ring_of_point(self) -> IntArray:
        """(m,) ring of each point."""
        return np.repeat(np.arange(len(self.polygon)), np.diff(self.start))

    def following(self) -> IntArray:
        """(m,) index of the next point of the same ring."""
        step = np.arange(1, len(self.points) + 1)
        step[self.start[1:] - 1] = self.start[:-1]
        return step

    def preceding(self) -> IntArray:
        """(m,) index of the previous point of the same ring."""
        back = np.empty(len(self.points), np.int64)
        back[self.following()] = np.arange(len(self.points))
        return back


def rings_of(polygons: ArrayLike) -> Rings:
    """Read the rings of (n,) shapely polygons; empty ones have no ring."""
    polygons = np.asarray(polygons, dtype=object)
    if len(polygons) == 0:
        none = np.zeros(0, np.int64)
        return Rings(np.zeros((0, 2)), np.zeros(1, np.int64), none, none.astype(bool))
    ring, polygon = shapely.get_rings(polygons, return_index=True)
    points, of_ring = shapely.get_coordinates(ring, return_index=True)
    closing = np.zeros(len(points), bool)
    closing[np.cumsum(np.bincount(of_ring, minlength=len(ring))) - 1] = True
    count = np.bincount(of_ring[~closing], minlength=len(ring))
    first = np.ones(len(ring), bool)
    first[1:] = polygon[1:] != polygon[:-1]
    start = np.concatenate([[0], np.cumsum(count)]).astype(np.int64)
    return _oriented(Rings(points[~closing], start, polygon.astype(np.int64), ~first))


def _oriented(rings: Rings) -> Rings:
    """Turn outer rings counterclockwise and holes clockwise; each keeps its first point."""
    ring = rings.ring_of_point
    first = rings.points[rings.start[:-1]][ring]
    here, there = rings.points - first, rings.points[rings.following()] - first
    crossed = here[:, 0] * there[:, 1] - here[:, 1] * there[:, 0]
    area = np.bincount(ring, crossed, minlength=len(rings.polygon))
    wrong = np.where(rings.hole, area > 0, area < 0)
    if not wrong.any():
        return rings
    count = np.diff(rings.start)[ring]
    place = np.arange(len(ring)) - rings.start[ring]
    place = np.where(wrong[ring], (count - place) % np.maximum(count, 1), place)
    return replace(rings, points=rings.points[rings.start[ring] + place])


def clean_polygons(polygons: ArrayLike) -> NDArray[Any]:
    """Round to millimetres, drop points on straight lines and repair what is not valid.

    Parameters
    ----------
    polygons
        (n,) shapely polygons or multipolygons.

    Returns
    -------
    cleaned
        (n,) valid polygons without z; the largest piece where a repair leaves several, an empty
        polygon where less than `MIN_AREA` remains.
    """
    given = np.asarray(polygons, dtype=object)
    if len(given) == 0:
        return given.copy()
    points, of_row = shapely.get_coordinates(given, return_index=True)
    unknown = np.zeros(len(given), bool)
    unknown[of_row[~np.isfinite(points).all(axis=1)]] = True
    unknown |= shapely.is_missing(given)
    finite = np.where(unknown, shapely.Polygon(), given)
    rounded = shapely.transform(shapely.force_2d(finite), lambda p: np.round(p, 3) + 0.0)
    cleaned: NDArray[Any] = np.asarray(shapely.simplify(rounded, STRAY), dtype=object)
    wrong = (
        ~shapely.is_valid(cleaned)
        | (shapely.get_type_id(cleaned) != 3)
        | ~(shapely.area(cleaned) >= MIN_AREA)
    )
    for row in np.flatnonzero(wrong):
        cleaned[row] = _largest(rounded[row])
    tight = shapely.minimum_clearance(cleaned) < SLIT
    for row in np.flatnonzero(tight):
        cleaned[row] = _largest(shapely.set_precision(cleaned[row], 4 * SLIT))
    return cleaned


def cut_at_waists(polygons: NDArray[Any]) -> NDArray[Any]:
    """Take polygons apart where two of their edges come nearer than `SLIT`.

    Such a polygon falls apart when it is rounded, and `clean_polygons` keeps the largest piece.

    Returns
    -------
    cut
        (n,) the polygons, a multipolygon where there are several pieces of `MIN_AREA` or more.
    """
    cut = np.asarray(polygons, dtype=object).copy()
    for row in np.flatnonzero(shapely.minimum_clearance(cut) < SLIT):
        pieces = shapely.get_parts(shapely.set_precision(cut[row], 4 * SLIT))
        pieces = pieces[shapely.area(pieces) >= MIN_AREA]
        if len(pieces) > len(shapely.get_parts(cut[row])):
            cut[row] = shapely.multipolygons(pieces)
    return cut


def _largest(shape: Any) -> Any:
    """Return the largest polygon of whatever a broken outline holds, or an empty polygon."""
    empty = shapely.Polygon()
    pieces = shapely.get_parts(shapely.make_valid(shape, method="structure"))
    pieces = shapely.get_parts(pieces)
    pieces = pieces[shapely.get_type_id(pieces) == 3]
    pieces = pieces[shapely.area(pieces) >= MIN_AREA]
    if len(pieces) == 0:
        return empty
    best = pieces[np.argmax(shapely.area(pieces))]
    snapped = shapely.set_precision(best, GRID)
    return snapped if shapely.get_type_id(snapped) == 3 and snapped.is_valid else best


def corners(rings: Rings) -> NDArray[np.bool_]:
    """Mark the points where a ring turns; the others lie on straight runs (within 3 degrees).

    Every ring keeps at least three points, and a chain of small bends that leaves its chord (a
    round wall drawn finely) keeps all of its points.

    Returns
    -------
    kept
        (m,) bool.
    """
    if len(rings.points) == 0:
        return np.zeros(0, bool)
    after, before = rings.following(), rings.preceding()
    outgoing = rings.points[after] - rings.points
    incoming = outgoing[before]
    turn = np.arctan2(
        incoming[:, 0] * outgoing[:, 1] - incoming[:, 1] * outgoing[:, 0],
        (incoming * outgoing).sum(axis=1),
    )
    kept = np.abs(turn) >= STRAIGHT
    ring = rings.ring_of_point
    few = np.bincount(ring[kept], minlength=len(rings.polygon)) < 3
    kept |= few[ring]
    # Each dropped point is measured against the chord of its run.
    last, nxt = _kept_around(rings, kept)
    chord = rings.points[nxt] - rings.points[last]
    offset = rings.points - rings.points[last]
    length = np.maximum(np.hypot(*chord.T), 1e-9)
    sagitta = np.abs(chord[:, 0] * offset[:, 1] - chord[:, 1] * offset[:, 0]) / length
    curved = np.zeros(len(kept), bool)
    np.logical_or.at(curved, last[~kept], sagitta[~kept] > MAX_SAGITTA)
    kept[~kept & curved[last]] = True
    return np.asarray(kept)


def _kept_around(rings: Rings, kept: NDArray[np.bool_]) -> tuple[IntArray, IntArray]:
    """For each point the kept point at or before it and the kept point after it, on its ring."""
    ring = rings.ring_of_point
    index = np.flatnonzero(kept)
    place = np.searchsorted(index, np.arange(len(kept)), side="right")
    first = np.searchsorted(index, rings.start[:-1])  # first kept of each ring
    last = np.searchsorted(index, rings.start[1:]) - 1
    before = np.where(place - 1 < first[ring], last[ring], place - 1)
    after = np.where(place > last[ring], first[ring], place)
    return index[before], index[after]


@dataclass(frozen=True)
class Triangulation:
    """Triangles of many polygons on the points of their rings.

    Attributes
    ----------
    triangles
        (t, 3) int64 into ``Rings.points``, counter-clockwise.
    polygon
        (t,) polygon of each triangle.
    failed
        (n,) bool, polygons whose triangles do not use exactly their own points.
    """

    triangles: IntArray
    polygon: IntArray
    failed: NDArray[np.bool_]


def triangulate(polygons: NDArray[Any], rings: Rings) -> Triangulation:
    """Triangulate (n,) oriented polygons without new points (constrained Delaunay).

    A polygon in which two rings touch in a point has that position twice in `rings`; its triangles
    use the first of the two, which `failed` reports.
    """
    count = len(polygons)
    convex_quads = _quads(rings, count)
    triangles = [convex_quads[0]]
    owner = [convex_quads[1]]
    failed = np.zeros(count, bool)
    rest = np.ones(count, bool)
    rest[convex_quads[1]] = False
    rows = np.flatnonzero(rest)
    if len(rows):
        pieces, of_row = shapely.get_parts(_delaunay(polygons[rows]), return_index=True)
        corner = shapely.get_coordinates(pieces).reshape(-1, 4, 2)[:, :3]
        of_polygon = rows[of_row]
        index, found = locate(corner.reshape(-1, 2), np.repeat(of_polygon, 3), rings)
        index = index.reshape(-1, 3)
        np.logical_or.at(failed, of_polygon, ~found.reshape(-1, 3).all(axis=1))
        a, b, c = corner[:, 0], corner[:, 1], corner[:, 2]
        clockwise = np.cross(b - a, c - a) < 0
        index[clockwise] = index[clockwise][:, [0, 2, 1]]
        triangles.append(index)
        owner.append(of_polygon)
        expected = np.bincount(
            rings.polygon, np.diff(rings.start) + 2 * rings.hole, minlength=count
        ) - 2 * (np.bincount(rings.polygon, minlength=count) > 0)
        failed |= rest & (np.bincount(of_polygon, minlength=count) != expected)
    found_owner = np.concatenate(owner)
    order = np.argsort(found_owner, kind="stable")
    return Triangulation(np.concatenate(triangles)[order], found_owner[order], failed)


def _delaunay(polygons: NDArray[Any]) -> NDArray[Any]:
    """Triangulate each polygon; those that GEOS refuses give an empty collection."""
    try:
        return np.asarray(shapely.constrained_delaunay_triangles(polygons))
    except shapely.errors.GEOSException:
        pass  # one bad outline stops the whole array, so it is looked for
    found = np.full(len(polygons), shapely.GeometryCollection(), dtype=object)
    for row, polygon in enumerate(polygons):
        try:
            found[row] = shapely.constrained_delaunay_triangles(polygon)
        except shapely.errors.GEOSException:
            continue
    return found


def _quads(rings: Rings, count: int) -> tuple[IntArray, IntArray]:
    """Split convex quadrilaterals without holes along the shorter diagonal."""
    alone = np.bincount(rings.polygon, minlength=count) == 1
    ring = np.flatnonzero((np.diff(rings.start) == 4) & alone[rings.polygon])
    index = rings.start[ring][:, None] + np.arange(4)  # (q, 4)
    corner = rings.points[index]
    edge = np.roll(corner, -1, axis=1) - corner
    bend = np.cross(edge, np.roll(edge, -1, axis=1))
    convex = (bend > 1e-9).all(axis=1)
    index, corner = index[convex], corner[convex]
    first = ((corner[:, 0] - corner[:, 2]) ** 2).sum(1) <= ((corner[:, 1] - corner[:, 3]) ** 2).sum(
        1
    )
    shifted = np.where(first[:, None], index, np.roll(index, -1, axis=1))
    triangles = np.concatenate([shifted[:, [0, 1, 2]], shifted[:, [0, 2, 3]]])
    return triangles, np.tile(rings.polygon[ring[convex]], 2)


def locate(
    points: FloatArray, polygon: IntArray, rings: Rings
) -> tuple[IntArray, NDArray[np.bool_]]:
    """Find points among the ring points of their own polygon, by exact coordinates."""
    own = rings.polygon[rings.ring_of_point]
    table = np.column_stack([rings.points, own]) + 0.0
    asked = np.column_stack([points, polygon]) + 0.0
    both = np.ascontiguousarray(np.concatenate([table, asked]))
    key = both.view(np.uint64)
    mixed = key[:, 0] * np.uint64(0x9E3779B97F4A7C15)
    mixed ^= (mixed >> np.uint64(29)) ^ key[:, 1] * np.uint64(0xBF58476D1CE4E5B9)
    mixed = (mixed ^ (mixed >> np.uint64(31))) * np.uint64(0x94D049BB133111EB)
    mixed ^= key[:, 2] * np.uint64(0xD6E8FEB86659FD93)
    order = np.argsort(mixed[: len(table)], kind="stable")
    place = np.searchsorted(mixed[: len(table)][order], mixed[len(table) :])
    index = order[np.minimum(place, len(order) - 1)]
    return index, (table[index] == asked).all(axis=1)


def run_along(rings: Rings) -> FloatArray:
    """Return the metres run along its ring up to each point, (m,) float.

    Lengths are added in whole micrometres, so that the sum for one ring is exact and does not
    depend on the rings before it.
    """
    vector = rings.points[rings.following()] - rings.points
    steps = np.rint(np.hypot(*vector.T) * 1e6).astype(np.int64)
    run = np.concatenate([[0], np.cumsum(steps)])
    return np.asarray((run[:-1] - np.repeat(run[rings.start[:-1]], np.diff(rings.start))) / 1e6)


def offset_points(rings: Rings, distance: FloatArray) -> tuple[FloatArray, NDArray[np.bool_]]:
    """Move every edge outward by its own distance and return the new corners.

    Parameters
    ----------
    rings
        r rings with m points.
    distance
        (m,) metres outward (negative: inward) for the edge that starts at each point.

    Returns
    -------
    points
        (m, 2) corners where the moved edges meet.
    sound
        (r,) bool: no corner runs away and no edge turns round. Whether the ring crosses itself or
        another one is not looked at.
    """
    before, after = rings.preceding(), rings.following()
    vector = rings.points[after] - rings.points
    length = np.maximum(np.hypot(*vector.T), 1e-9)
    normal = np.column_stack([vector[:, 1], -vector[:, 0]]) / length[:, None]
    n1, n2, d1, d2 = normal[before], normal, distance[before], distance
    cross = n1[:, 0] * n2[:, 1] - n1[:, 1] * n2[:, 0]
    parallel = np.abs(cross) < np.sin(STRAIGHT)
    safe = np.where(parallel, 1.0, cross)
    move = (
        np.column_stack([d1 * n2[:, 1] - d2 * n1[:, 1], d2 * n1[:, 0] - d1 * n2[:, 0]])
        / safe[:, None]
    )
    straight = np.where((np.abs(d2) >= np.abs(d1))[:, None], n2 * d2[:, None], n1 * d1[:, None])
    both = n1 * d1[:, None] / 2 + n2 * d2[:, None] / 2
    straight = np.where((d1 == d2)[:, None], both, straight)
    move = np.where(parallel[:, None], straight, move)
    points = rings.points + move
    backwards = parallel & ((n1 * n2).sum(axis=1) < 0)
    far = np.hypot(*move.T) > MAX_MITRE * np.maximum(np.abs(d1), np.abs(d2)) + 1e-9
    turned = ((points[after] - points) * vector).sum(axis=1) < MIN_SHARE * length**2
    unsound = np.bincount(
        rings.ring_of_point, backwards | far | turned, minlength=len(rings.polygon)
    )
    return points, unsound == 0


def polygons_of(rings: Rings, count: int) -> NDArray[Any]:
    """Build (count,) shapely polygons from rings; those without a ring are empty."""
    found = np.full(count, shapely.Polygon(), dtype=object)
    if len(rings.polygon) == 0:
        return found
    size = np.diff(rings.start)
    closed = np.insert(rings.points, rings.start[1:], rings.points[rings.start[:-1]], axis=0)
    lines = shapely.linearrings(closed, indices=np.repeat(np.arange(len(size)), size + 1))
    shells = np.flatnonzero(~rings.hole)
    found[rings.polygon[shells]] = shapely.polygons(lines[shells])
    for row in np.unique(rings.polygon[rings.hole]):
        mine = rings.polygon == row
        found[row] = shapely.polygons(lines[mine & ~rings.hole][0], lines[mine & rings.hole])
    return found


def select_rings(rings: Rings, polygons: NDArray[np.bool_]) -> tuple[Rings, IntArray]:
    """Return the rings of the polygons marked in a mask, and the old number of each point."""
    ring = np.flatnonzero(polygons[rings.polygon])
    points, start = ranges(rings.start, ring)
    chosen = Rings(rings.points[points], start, rings.polygon[ring], rings.hole[ring])
    return chosen, points


def longest_edge(rings: Rings, count: int) -> FloatArray:
    """Return the direction, (n,) radians from east, of each polygon's longest straight edge."""
    vector = rings.points[rings.following()] - rings.points
    length = np.hypot(*vector.T)
    polygon = rings.polygon[rings.ring_of_point]
    order = np.lexsort((np.arange(len(length)), -np.round(length, 3), polygon))
    first = np.ones(len(order), bool)
    first[1:] = polygon[order][1:] != polygon[order][:-1]
    chosen = order[first]
    angle = np.zeros(count)
    angle[polygon[chosen]] = np.arctan2(vector[chosen, 1], vector[chosen, 0])
    return angle


def envelopes_of(polygons: NDArray[Any]) -> FloatArray:
    """Return the least rectangles: direction of the long side, both sides, filled share, (n, 4)."""
    found = np.tile([0.0, 1.0, 1.0, 1.0], (len(polygons), 1))
    boxes = shapely.oriented_envelope(polygons)
    rows = np.flatnonzero((shapely.get_type_id(boxes) == 3) & ~shapely.is_empty(boxes))
    if len(rows) == 0:
        return found
    corner = shapely.get_coordinates(boxes[rows]).reshape(len(rows), 5, 2)
    side = np.diff(corner[:, :3], axis=1)  # (n, 2, 2)
    length = np.linalg.norm(side, axis=2)
    # Of a square the side nearer to east counts, so that a last bit decides nothing.
    angles = np.mod(np.arctan2(side[:, :, 1], side[:, :, 0]), np.pi)
    square = np.abs(length[:, 0] - length[:, 1]) < 1e-3 * length.max(axis=1)
    longer = np.argmax(length, axis=1)
    nearer = np.argmin(np.round(np.abs(np.sin(angles)), 6), axis=1)
    chosen = np.where(square, nearer, longer)
    at = np.arange(len(rows))
    found[rows, 0] = angles[at, chosen]
    found[rows, 1] = length.max(axis=1)
    found[rows, 2] = length.min(axis=1)
    found[rows, 3] = shapely.area(polygons[rows]) / np.maximum(length.prod(axis=1), 1e-9)
    return found


def corners_of(shape: shapely.Geometry) -> tuple[tuple[float, float, float], ...]:
    """Return the corners of polygons, holes filled, as numbers: x, y, and which polygon."""
    parts = [part for part in shapely.get_parts(shape) if part.geom_type == "Polygon"]
    return tuple(
        (round(float(x), 3), round(float(y), 3), float(number))
        for number, part in enumerate(parts)
        for x, y in shapely.get_coordinates(part.exterior)
    )


def polygons_of_corners(corners: Sequence[Sequence[float]]) -> list[shapely.Geometry]:
    """Return the polygons of some corners one by one, as of `corners_of`."""
    points = np.asarray(corners, float)
    number = points[:, 2] if points.shape[1] > 2 else np.zeros(len(points))
    rings = [points[number == one, :2] for one in np.unique(number)]
    return [shapely.make_valid(shapely.Polygon(ring)) for ring in rings]


def region_of_corners(corners: Sequence[Sequence[float]]) -> shapely.Geometry:
    """Return the ground that polygons of some corners cover, as of `corners_of`."""
    return shapely.union_all(polygons_of_corners(corners))
