"""Fitting a pattern of streets into a district: what stays clear of its rim, and ways out to it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.geometry.arrays import BoolArray, FloatArray, IntArray
from cityx.geometry.chains import components
from cityx.geometry.parcels.street_patterns import Pattern

CORNER = 38.0  # metres from a corner of the district to the nearest way out
GAP = 45.0  # metres between ways out on one side of the rim
SQUARE = np.radians(52.0)  # least angle at which a street meets the rim
BEND = np.radians(65.0)  # most that a street turns to meet the rim squarely
LONG = 3.0  # times the clearance that a way out may be long
BESIDE = 0.62  # of the clearance that a way out keeps from other streets


@dataclass(frozen=True)
class Ways:
    """Ways out of a district, k of them.

    Attributes
    ----------
    node
        (k,) row of the node each begins at.
    side
        (k,) side of the rim it leads to.
    at
        (k,) metres along that side.
    street, name
        (k, 2) as in `Pattern`.
    """

    node: IntArray
    side: IntArray
    at: FloatArray
    street: IntArray
    name: IntArray

    def take(self, rows: Any) -> Ways:
        """Return some of them."""
        return Ways(
            self.node[rows], self.side[rows], self.at[rows], self.street[rows], self.name[rows]
        )


def fitted(
    pattern: Pattern, district: Any, sides: NDArray[Any], clearance: float
) -> tuple[Pattern, Ways]:
    """Keep the part of a pattern in a district and clear of its rim, and connect it to the rim.

    Parameters
    ----------
    district
        Polygon.
    sides
        (s,) lines that make its rim.
    clearance
        Metres that streets keep from the rim where they do not lead to it.

    Returns
    -------
    inner
        The links inside.
    ways
        Where streets may meet the rim; those too near to a corner or to another are left out.
    """
    points = shapely.points(pattern.nodes)
    rim = shapely.multilinestrings(sides)
    shapely.prepare([district, rim])
    inside = shapely.contains(district, points)
    inside[inside] = shapely.distance(points[inside], rim) >= clearance
    both = inside[pattern.links].all(axis=1)
    lines = shapely.linestrings(pattern.nodes[pattern.links[both]])
    both[both] = shapely.distance(lines, rim) >= BESIDE * clearance
    inner = pattern.take(both)
    one = np.flatnonzero(inside[pattern.links].sum(axis=1) == 1)
    ways = _ways(pattern, one, inside, sides, rim, clearance)
    return inner, ways


def _ways(
    pattern: Pattern, links: IntArray, inside: BoolArray, sides: NDArray[Any], rim: Any,
    clearance: float,
) -> Ways:  # fmt: skip
    """Lead the links that cross the clearance straight on to the rim, or squarely where slanted."""
    ends = pattern.links[links]
    turned = ~inside[ends[:, 0]]
    ends = np.where(turned[:, None], ends[:, ::-1], ends)
    start, aim = pattern.nodes[ends[:, 0]], pattern.nodes[ends[:, 1]]
    way = aim - start
    way = way / np.maximum(np.hypot(*way.T), 1e-9)[:, None]
    ray = shapely.linestrings(np.stack([start, start + LONG * clearance * way], axis=1))
    hit = _first_hit(ray, start, rim)
    found = _met(start, hit, way, sides)
    square = shapely.get_coordinates(
        shapely.get_point(shapely.shortest_line(shapely.points(start), rim), 1)
    )
    other = _met(start, square, way, sides)
    straight = np.isfinite(hit[:, 0]) & (found[2] >= SQUARE)
    side = np.where(straight, found[0], other[0])
    at = np.where(straight, found[1], other[1])
    good = straight | ((other[2] >= SQUARE) & (other[3] <= BEND))
    length = shapely.length(sides)[side]
    good &= (at >= CORNER) & (at <= length - CORNER)
    rows = np.flatnonzero(good)
    ways = Ways(ends[rows, 0], side[rows], at[rows], pattern.street[links[rows]], pattern.name[links[rows]])  # fmt: skip  # noqa: E501
    return ways.take(_apart(ways))


def _first_hit(ray: NDArray[Any], start: FloatArray, rim: Any) -> FloatArray:
    """Return where rays first meet the rim, (n, 2), NaN where they do not."""
    crossed = shapely.intersection(ray, rim)
    points, row = shapely.get_coordinates(crossed, return_index=True)
    away = np.hypot(*(points - start[row]).T)
    order = np.lexsort((away, row))
    row, first = np.unique(row[order], return_index=True)
    hit = np.full(start.shape, np.nan)
    hit[row] = points[order][first]
    return hit


def _met(
    start: FloatArray, end: FloatArray, way: FloatArray, sides: NDArray[Any]
) -> tuple[IntArray, FloatArray, FloatArray, FloatArray]:
    """Return how lines meet the rim: side, metres along it, angle with it, and turn from `way`."""
    place = shapely.points(np.nan_to_num(end))
    distance = np.stack([shapely.distance(side, place) for side in sides], axis=1)
    side = distance.argmin(axis=1)
    at = shapely.line_locate_point(sides[side], place)
    before = shapely.get_coordinates(shapely.line_interpolate_point(sides[side], np.maximum(at - 1.0, 0.0)))  # fmt: skip  # noqa: E501
    after = shapely.get_coordinates(shapely.line_interpolate_point(sides[side], at + 1.0))
    along, own = after - before, np.nan_to_num(end) - start
    angle = np.abs(_angle(own, along))
    return side, at, np.minimum(angle, np.pi - angle), np.abs(_angle(own, way))


def _angle(a: FloatArray, b: FloatArray) -> FloatArray:
    cross = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
    return np.asarray(np.arctan2(cross, (a * b).sum(axis=1)))


def _apart(ways: Ways) -> IntArray:
    """Choose ways out that keep their distance on each side, by name."""
    order = np.lexsort((*ways.name.T[::-1], ways.side))
    kept: list[int] = []
    for row in order.tolist():
        near = [k for k in kept if ways.side[k] == ways.side[row]]
        if all(abs(ways.at[k] - ways.at[row]) >= GAP for k in near):
            kept.append(row)
    return np.array(sorted(kept), np.int64)


def no_ways() -> Ways:
    """Return no way out."""
    none = np.zeros(0, np.int64)
    return Ways(none, none, np.zeros(0), none.reshape(0, 2), none.reshape(0, 2))


def settled(links: IntArray, nodes: FloatArray, fixed: BoolArray, loose: BoolArray) -> BoolArray:
    """Choose the links that make a net: none crosses another, none ends blindly or hangs alone.

    Parameters
    ----------
    links, nodes
        (m, 2) and (n, 2).
    fixed
        (n,) whether a node is a place on the rim, where a street may end.
    loose
        (n,) whether a street may end at a node blindly.
    """
    kept = _uncrossed(links, nodes)
    while True:
        degree = np.bincount(links[kept].ravel(), minlength=len(nodes))
        blind = (degree == 1) & ~fixed & ~loose
        ending = kept & blind[links].any(axis=1)
        if not ending.any():
            break
        kept &= ~ending
    if not kept.any():
        return kept
    group = components(links[kept], len(nodes))
    out = np.zeros(group.max() + 1, bool)
    out[group[fixed & (degree > 0)]] = True
    return np.asarray(kept & out[group[links[:, 0]]])


def _uncrossed(links: IntArray, nodes: FloatArray) -> BoolArray:
    """Drop the later of two links that cross or touch without sharing a node."""
    lines = shapely.linestrings(nodes[links])
    first, second = shapely.STRtree(lines).query(lines, predicate="intersects")
    apart = (links[first][:, :, None] != links[second][:, None, :]).all(axis=(1, 2))
    kept = np.ones(len(links), bool)
    pairs = sorted(zip(first[apart].tolist(), second[apart].tolist(), strict=True))
    for a, b in pairs:
        if a < b and kept[a]:
            kept[b] = False
    return kept
