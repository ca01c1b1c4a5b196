"""Shells of buildings: disjoint outlines and the parts that belong to them."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.geometry.arrays import FloatArray, IntArray
from cityx.ids import UInt64Array
from cityx.sources.features.clipping import Box, inside_site
from cityx.sources.features.tagged import (
    MIN_SOLID,
    Owner,
    Report,
    Tagged,
    joined,
    number_pieces,
    polygons_of,
)
from cityx.sources.features.vocabulary import ROOF_ONLY

SIMPLE = 0.01  # metres; a point nearer to the line of its neighbours is no corner
ASSIGNED = 0.5  # share of a part that must lie in the outline it belongs to
TOLERANCE = 0.5  # square metres of overlap that is drawing noise
SAME = 0.9  # intersection over union from which two outlines are one building drawn twice
INSIDE = 0.8  # share of the smaller outline within the larger from which it is kept whole
LEVEL = 0.1  # metres by which heights must differ to count
ALIKE = 0.5  # intersection over union from which outlines may be of one pile
PILE = 5  # outlines alike on one spot; no map draws one building so often but by a slip
ROUNDS = 3  # an extended volume may meet another one; three rounds settle every map tried


@dataclass(frozen=True)
class Shells:
    """Tagged of buildings and of their parts, as they stand in the map.

    Attributes
    ----------
    outlines
        Disjoint, one per polygon.
    parts
        Polygons of building:part.
    building
        (parts,) row of the outline each part belongs to.
    """

    outlines: Tagged
    parts: Tagged
    building: IntArray


def make_shells(outlines: Tagged, parts: Tagged, box: Box, report: Report) -> tuple[Shells, Box]:
    """Choose the buildings of a site, make their outlines disjoint and give them their parts.

    Parameters
    ----------
    outlines, parts
        Polygons of buildings and of parts of buildings.
    box
        The site.

    Returns
    -------
    shells
    box
        The site, grown to hold every building it keeps.
    """
    outlines, parts = _simple(outlines), _simple(parts)
    every = np.concatenate([outlines.shapes, parts.shapes])
    kept, box = inside_site(every, box)
    kept_outlines, kept_parts = np.split(kept, [len(outlines.shapes)])
    report.count("buildings outside the site", int((~kept_outlines).sum()))
    across = ~kept_outlines & shapely.intersects(outlines.shapes, shapely.box(*box))
    _named(report, "buildings at the border lie out of the site", outlines, np.flatnonzero(across))
    outlines = outlines.take(np.flatnonzero(kept_outlines))
    parts = parts.take(np.flatnonzero(kept_parts))
    outlines = _disjoint(_without_piles(outlines, report), report)
    outlines, building = _assigned(outlines, parts)
    return Shells(outlines, parts, building), box


def name_covered(shells: Shells, standing: UInt64Array, report: Report) -> None:
    """Name the buildings of which nothing stands, given the ids of those that do."""
    gone = np.flatnonzero(~np.isin(shells.outlines.ids(), standing))
    _named(report, "buildings are covered by the parts of others", shells.outlines, gone)


def _simple(outlines: Tagged) -> Tagged:
    """Drop points that are no corners; the few outlines this would break stay as they are."""
    plain = shapely.simplify(outlines.shapes, SIMPLE, preserve_topology=True)
    sound = shapely.is_valid(plain) & (shapely.get_type_id(plain) == 3) & ~shapely.is_empty(plain)
    polygons = shapely.orient_polygons(np.where(sound, plain, outlines.shapes))
    return Tagged(polygons, outlines.owner, outlines.k, outlines.owners)


def _worth(outlines: Tagged) -> IntArray:
    """Return how much is known of each: a canopy is worth less than a house, tags are worth."""
    return np.array(
        [len(own) - 100 * (own.get("building") in ROOF_ONLY) for own in outlines.tags()], np.int64
    )


def _named(report: Report, what: str, outlines: Tagged, rows: IntArray) -> None:
    for row in rows.tolist():
        report.name(what, outlines.owners[outlines.owner[row]])


def _without_piles(outlines: Tagged, report: Report) -> Tagged:
    """Keep one outline of each pile of many that are nearly alike, the one most is known of."""
    shapes = outlines.shapes
    pairs = overlapping_pairs(shapes) if len(shapes) >= PILE else np.zeros((0, 2), np.int64)
    first, second = pairs.T
    area = shapely.area(shapes)
    shared = shapely.area(_intersection(shapes[first], shapes[second]))
    alike = shared > ALIKE * (area[first] + area[second] - shared)
    first, second = first[alike], second[alike]
    number = np.bincount(np.concatenate([first, second]), minlength=len(shapes))
    if number.max(initial=0) < PILE - 1:
        return outlines
    worth, ids = _worth(outlines), outlines.ids()
    left = np.ones(len(shapes), bool)
    for row in np.lexsort((ids, -worth, -number)).tolist():
        if left[row] and number[row] >= PILE - 1:
            left[second[first == row]] = left[first[second == row]] = False
    what = "buildings are piled on one spot, of which one stands"
    _named(report, what, outlines, np.flatnonzero(~left))
    return outlines.take(np.flatnonzero(left))


def _disjoint(outlines: Tagged, report: Report) -> Tagged:
    shapes, duplicate = separate_outlines(outlines.shapes, _worth(outlines))
    _named(report, "buildings are drawn twice", outlines, np.flatnonzero(duplicate))
    polygons, row = polygons_of(shapes)
    lost = np.setdiff1d(np.flatnonzero(~duplicate), row)
    _named(report, "buildings are covered by others", outlines, lost)
    owner, k = outlines.owner[row], outlines.k[row]
    order = np.lexsort((np.arange(len(row)), k, owner))
    owner = owner[order]
    return Tagged(
        shapely.orient_polygons(polygons[order]), owner, number_pieces(owner), outlines.owners
    )


def _assigned(outlines: Tagged, parts: Tagged) -> tuple[Tagged, IntArray]:
    """Find the outline of each part; parts without one form buildings of their own."""
    building = np.full(len(parts.shapes), -1, np.int64)
    if len(parts.shapes) == 0:
        return outlines, building
    part, outline = shapely.STRtree(outlines.shapes).query(parts.shapes, predicate="intersects")
    shared = shapely.area(shapely.intersection(parts.shapes[part], outlines.shapes[outline]))
    order = np.lexsort((outlines.ids()[outline], -np.round(shared, 3), part))
    part, outline, shared = part[order], outline[order], shared[order]
    first = np.ones(len(part), bool)
    first[1:] = part[1:] != part[:-1]
    enough = first & (shared >= ASSIGNED * shapely.area(parts.shapes[part]))
    building[part[enough]] = outline[enough]
    # Parts that overhang are none of their own where the ground below is another's.
    orphan = np.flatnonzero(building < 0)
    if len(orphan) == 0:
        return outlines, building
    taken = shapely.STRtree(outlines.shapes)
    groups = _groups(parts.shapes[orphan], parts.ids()[orphan])
    found: list[Any] = []
    owners: list[Owner] = []
    for group in np.unique(groups).tolist():
        rows = orphan[groups == group]
        head = parts.owners[parts.owner[rows[np.argmin(parts.ids()[rows])]]]
        shape = shapely.union_all(parts.shapes[rows], grid_size=1e-3)
        below = taken.query(shape, predicate="intersects")
        free = shapely.difference(shape, shapely.union_all(outlines.shapes[below]))
        pieces, _ = polygons_of(np.array([free], object), least=MIN_SOLID)
        if len(pieces) == 0:  # all of it lies in other outlines: it belongs to the nearest
            building[rows] = below[np.argmax(shapely.area(shapely.intersection(shape, outlines.shapes[below])))]  # fmt: skip  # noqa: E501
            continue
        # A building has one outline; the largest stands for all of its pieces.
        building[rows] = len(outlines.shapes) + len(found)
        found.append(pieces[0])
        owners.append(replace(head, more=("building",)))
    own = np.arange(len(found))
    added = Tagged(
        shapely.orient_polygons(np.array(found, object)), own, np.zeros(len(own), np.int64), owners
    )
    return joined(outlines, added), building


def _groups(polygons: NDArray[Any], ids: UInt64Array) -> IntArray:
    """Return the number of each polygon's group, joined by borders and shared areas."""
    from scipy.sparse import coo_matrix
    from scipy.sparse.csgraph import connected_components

    first, second = shapely.STRtree(polygons).query(polygons, predicate="intersects")
    joined = shapely.intersection(polygons[first], polygons[second])
    real = (shapely.area(joined) > 0) | (shapely.length(joined) > 0.5) | (first == second)
    size = len(ids)
    graph = coo_matrix((np.ones(real.sum()), (first[real], second[real])), (size, size))
    return np.asarray(connected_components(graph, directed=False)[1], np.int64)


def overlapping_pairs(polygons: NDArray[Any]) -> IntArray:
    """Return (p, 2) rows i < j of polygons that share more than `TOLERANCE`, in row order."""
    first, second = shapely.STRtree(polygons).query(polygons, predicate="intersects")
    ordered = first < second
    first, second = first[ordered], second[ordered]
    # Neighbours that share a wall are most of the pairs; they are told without an intersection.
    real = ~shapely.touches(polygons[first], polygons[second])
    first, second = first[real], second[real]
    shared = shapely.area(_intersection(polygons[first], polygons[second]))
    pairs = np.column_stack([first, second])[shared > TOLERANCE]
    return np.asarray(pairs[np.lexsort((pairs[:, 1], pairs[:, 0]))], np.int64)


def _intersection(first: Any, second: Any) -> Any:
    return shapely.intersection(first, second)


def separate_outlines(
    polygons: NDArray[Any], worth: IntArray
) -> tuple[NDArray[Any], NDArray[np.bool_]]:
    """Make outlines disjoint: duplicates go, overlaps belong to one of the two.

    Of two that lie one in the other the smaller is kept whole, else the larger.

    Parameters
    ----------
    polygons, worth
        (n,) outlines, in an order that the file does not decide, and how much is known of each.

    Returns
    -------
    separated
        (n,) geometries, empty where the outline is used up.
    duplicate
        (n,) bool, dropped as a building drawn twice.
    """
    shapes = polygons.copy()
    duplicate = np.zeros(len(shapes), bool)
    pairs = overlapping_pairs(shapes) if len(shapes) else np.zeros((0, 2), np.int64)
    area = shapely.area(polygons)
    rank = np.lexsort((np.arange(len(shapes)), -np.round(area, 3)))
    order = np.empty(len(rank), np.int64)
    order[rank] = np.arange(len(rank))
    # From the largest pair down, so that the order of rows does not count.
    keyed = sorted(
        (tuple(sorted((order[i], order[j]))) for i, j in pairs.tolist()), key=lambda p: p
    )
    for large_rank, small_rank in keyed:
        large, small = int(rank[large_rank]), int(rank[small_rank])
        shared = shapely.area(_intersection(shapes[large], shapes[small]))
        if shared <= TOLERANCE:
            continue
        if shared > SAME * (area[large] + area[small] - shared):
            better = (worth[large], -order[large]) >= (worth[small], -order[small])
            lost = small if better else large
            duplicate[lost] = True
            shapes[lost] = shapely.Polygon()
        elif shared > INSIDE * area[small]:
            shapes[large] = shapely.difference(shapes[large], shapes[small])
        else:
            shapes[small] = shapely.difference(shapes[small], shapes[large])
    return shapes, duplicate


def separate_volumes(
    polygons: NDArray[Any],
    base: FloatArray,
    top: FloatArray,
    roof: FloatArray,
    walls: NDArray[np.bool_],
    ids: UInt64Array,
) -> tuple[NDArray[Any], FloatArray]:
    """Make volumes that overlap in plan and in height disjoint, and keep their union.

    Of two from the same base the higher keeps the ground they share. One that begins within
    another goes down to the other's base where they overlap, or starts on its flat roof.

    Returns
    -------
    polygons, base
        (n,) each; polygons may have become empty or of several pieces.
    """
    shapes, base = polygons.copy(), base.copy()
    if len(shapes) == 0:
        return shapes, base
    pairs = overlapping_pairs(shapes)
    for _ in range(ROUNDS):
        low = np.maximum(base[pairs[:, 0]], base[pairs[:, 1]])
        high = np.minimum(top[pairs[:, 0]], top[pairs[:, 1]])
        meeting = pairs[high - low > LEVEL]
        keys = np.column_stack([ids[meeting].min(axis=1), ids[meeting].max(axis=1)])
        meeting = meeting[np.lexsort((keys[:, 1], keys[:, 0]))]
        changed = False
        for i, j in meeting.tolist():
            changed |= _separate(int(i), int(j), shapes, base, top, roof, walls, ids)
        if not changed:
            break
    return shapes, base


def _separate(
    i: int,
    j: int,
    shapes: NDArray[Any],
    base: FloatArray,
    top: FloatArray,
    roof: FloatArray,
    walls: NDArray[np.bool_],
    ids: UInt64Array,
) -> bool:
    shared = shapely.area(_intersection(shapes[i], shapes[j]))
    if shared <= TOLERANCE or min(top[i], top[j]) - max(base[i], base[j]) <= LEVEL:
        return False
    if walls[i] != walls[j]:  # a canopy gives way to what has walls
        lost, kept = (j, i) if walls[i] else (i, j)
        shapes[lost] = shapely.difference(shapes[lost], shapes[kept])
        return True
    key_i = (round(base[i], 2), -round(top[i], 2), round(shapely.area(shapes[i]), 2), int(ids[i]))
    key_j = (round(base[j], 2), -round(top[j], 2), round(shapely.area(shapes[j]), 2), int(ids[j]))
    lower, upper = (i, j) if key_i < key_j else (j, i)
    if base[upper] - base[lower] <= LEVEL or top[upper] - top[lower] <= LEVEL:
        # From one base the first is the higher; swallowed ones lose what they share.
        shapes[upper] = shapely.difference(shapes[upper], shapes[lower])
    elif roof[lower] <= LEVEL:
        base[upper] = top[lower]
    elif shared > INSIDE * shapely.area(shapes[upper]):
        base[upper] = base[lower]
        shapes[lower] = shapely.difference(shapes[lower], shapes[upper])
    else:
        shapes[upper] = shapely.difference(shapes[upper], shapes[lower])
    return True
