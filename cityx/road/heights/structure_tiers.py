"""Ways off the ground in tiers, of which none has one way pass over another."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.city.ground import KERB_WIDTH
from cityx.city.heights import WayHeights
from cityx.city.layout import Layout
from cityx.city.roads import RoadNetwork
from cityx.geometry.arrays import BoolArray, FloatArray, IntArray
from cityx.geometry.polylines import Polylines, to_linestrings, values_along
from cityx.road.ground.landcover import TRACK_BED
from cityx.road.network.stations import RAILS, free_heights, way_levels

FOOTING = 0.5  # metres that fill and piers reach into the ground
CEILING = 0.4  # metres of the slab over a tunnel; with its free height less than it lies deep
PARAPET_WIDTH = 0.25  # metres
PARAPET_FROM = 0.6  # metres of drop that want a parapet
WALL_FROM = 0.12  # metres of depth that want a retaining wall
STORY = 3.5  # metres; a way lower by more passes under
SAME_PLACE = 0.06  # metres
PASSES_OVER = 1.0  # metres of difference in height from which ways side by side have no one surface
ROOFED = 1.5  # metres up to which two ways beside each other in a tunnel have one ceiling
BLEND = 3.0  # metres beyond the edge of a way in which its height still counts
AXIS = (
    0.1  # of a metre beyond a way's edge, what a metre from its axis takes from its height's pull
)


@dataclass(frozen=True)
class Tier:
    """Ways off the ground that do not pass over each other: a network, paths and tracks, all lines.

    Attributes
    ----------
    network, others
        Carriageways; paths and tracks. They come one after the other in what is given for each of
        the w lines.
    lines, z
        Their lines of p points in plan, scene frame, and (p,) heights, metres.
    road, level
        (w,) row of the layout, and level as mapped.
    half, reach
        (w,) half the width of what is travelled, and the same with kerbs and walks, metres.
    room
        (w,) metres free over it in a tunnel.
    """

    network: RoadNetwork
    others: WayHeights
    lines: Polylines
    z: FloatArray
    road: IntArray
    level: IntArray
    half: FloatArray
    reach: FloatArray
    room: FloatArray


def tier_of(layout: Layout, sub: RoadNetwork, other: WayHeights) -> Tier:
    """Join carriageways with paths and tracks, of which some may still pass over others.

    Parameters
    ----------
    layout
        The city's, which tells kinds and walks.
    sub, other
        Carriageways off the ground, and paths and tracks off the ground.
    """
    start = np.concatenate([sub.point_start, sub.point_start[-1] + other.point_start[1:]])
    table = layout.roads.iloc[sub.edge_road]
    walk = np.maximum(table["sidewalk_left"].to_numpy(), table["sidewalk_right"].to_numpy())
    kind = layout.roads["kind"].to_numpy().astype(str)[other.road]
    half = np.where(np.isin(kind, RAILS), TRACK_BED / 2, np.maximum(other.half_width, 0.75))
    return Tier(
        sub, replace(other, half_width=half),
        Polylines(np.concatenate([sub.points, other.points]), start),
        np.concatenate([sub.z, other.z]),
        np.concatenate([sub.edge_road, other.road]).astype(np.int64),
        np.concatenate([way_levels(layout)[sub.edge_road], other.level.astype(np.int64)]),
        np.concatenate([sub.half_width, half]),
        np.concatenate([sub.half_width + KERB_WIDTH + walk, half]),
        np.concatenate([free_over(layout, sub.edge_road), free_over(layout, other.road)]),
    )  # fmt: skip


def free_over(layout: Layout, road: NDArray[np.int32]) -> FloatArray:
    """Return the room over ways in tunnels.

    Parameters
    ----------
    layout
        The city's, which tells kinds.
    road
        (w,) rows of the layout.

    Returns
    -------
    room
        (w,) metres.
    """
    return free_heights(layout.roads["kind"].to_numpy().astype(str)[road])


def groups_of(whole: Tier) -> list[IntArray]:
    """Divide ways into as few groups as can be of which none has one way pass over another.

    Ways that meet stay together, so that they have one surface, unless that puts two into a group
    of which one passes over the other.

    Parameters
    ----------
    whole
        All w ways off the ground.

    Returns
    -------
    groups
        Rows of the ways of each group, rising; none for no ways.
    """
    count = whole.lines.count
    if not count:
        return []
    joined, apart, near = _relations(whole)
    above: list[set[int]] = [set() for _ in range(count)]
    for a, b in apart.tolist():
        above[a].add(b)
        above[b].add(a)
    owner = np.arange(count)
    members = [{way} for way in range(count)]
    for a, b in joined.tolist():
        one, other = sorted((int(owner[a]), int(owner[b])))
        if one == other or above[one] & members[other]:
            continue
        owner[list(members[other])] = one
        members[one] |= members[other]
        above[one] |= above[other]
    beside: dict[int, set[int]] = {}
    for a, b in np.unique(owner[near], axis=0).tolist():
        if a != b:
            beside.setdefault(a, set()).add(b)
            beside.setdefault(b, set()).add(a)
    color: dict[int, int] = {}
    for group in np.unique(owner).tolist():
        taken = {color[other] for other in beside.get(group, ()) if other in color}
        color[group] = next(k for k in range(count) if k not in taken)
    shade = np.array([color[group] for group in owner.tolist()])
    return [np.flatnonzero(shade == k) for k in range(int(shade.max()) + 1)]


def _relations(whole: Tier) -> tuple[IntArray, IntArray, IntArray]:
    """Pairs of ways that meet, that pass over each other, and that lie side by side."""
    lines, count = whole.lines, whole.lines.count
    cars = whole.network.edge_count
    ends = np.rint(
        np.concatenate([lines.points[lines.start[:-1]], lines.points[lines.start[1:] - 1]]) * 1000
    )
    place = np.unique(ends, axis=0, return_inverse=True)[1].ravel()
    # Nodes of the network tell ways apart that cross at one place on two levels.
    nodes = whole.network.edge_nodes.T.astype(np.int64)
    shift = int(place.max()) + 1
    for side in (0, 1):
        place[side * count : side * count + cars] = shift + nodes[side]
    order = np.argsort(place, kind="stable")
    same = np.flatnonzero(place[order][1:] == place[order][:-1])
    joined = np.unique(np.sort(np.column_stack([order[same], order[same + 1]]) % count), axis=0)
    joined = joined[joined[:, 0] != joined[:, 1]]
    shapes = to_linestrings(lines)
    strips = shapely.buffer(shapes, whole.reach + 2 * PARAPET_WIDTH, cap_style="flat")
    near = np.unique(np.sort(shapely.STRtree(strips).query(strips, "intersects").T), axis=0)
    near = near[near[:, 0] != near[:, 1]]
    a, b = near.T
    link = shapely.get_coordinates(shapely.shortest_line(shapes[a], shapes[b])).reshape(-1, 2, 2)
    heights = [
        values_along(lines, whole.z, way,
                     shapely.line_locate_point(shapes[way], shapely.points(link[:, k])))
        for k, way in enumerate((a, b))
    ]  # fmt: skip
    keys = joined[:, 0] * count + joined[:, 1]
    meets = np.isin(a * count + b, keys)
    passing, storeys = _passing(whole, shapes)
    passing = passing[storeys | ~np.isin(passing @ [count, 1], keys)]
    crosses, apart = (
        shapely.crosses(shapes[a], shapes[b]),
        (np.abs(heights[0] - heights[1]) > PASSES_OVER)
        | np.isin(a * count + b, passing @ [count, 1]),
    )
    over = np.where(meets & ~np.isin(a * count + b, passing @ [count, 1]), crosses, apart)
    # What crosses at one height is one surface, as on the ground.
    level = crosses & ~meets & ~apart
    over = np.concatenate([near[over], passing])
    return (
        np.concatenate([joined, near[level]]), over,
        np.concatenate([near[~meets & ~level], passing]),
    )  # fmt: skip


def _passing(whole: Tier, shapes: NDArray[Any]) -> tuple[IntArray, BoolArray]:
    """(k, 2) pairs of ways that lie side by side somewhere at two heights; (k,) a storey apart."""
    lines = whole.lines
    spots, owner = shapely.points(lines.points), lines.line_of_point()
    way, spot = shapely.STRtree(spots).query(
        shapes, "dwithin", distance=whole.reach + whole.reach.max() + BLEND
    )
    pairs = np.sort(np.column_stack([way, owner[spot]]), axis=1)
    beside = shapely.distance(shapes[way], spots[spot]) < whole.reach[pairs].sum(axis=1) + BLEND
    beside &= pairs[:, 0] != pairs[:, 1]
    way, spot, pairs = way[beside], spot[beside], pairs[beside]
    along = shapely.line_locate_point(shapes[way], spots[spot])
    drop = values_along(lines, whole.z, way, along) - whole.z[spot]
    found, row = np.unique(pairs[np.abs(drop) > PASSES_OVER], axis=0, return_inverse=True)
    most = np.zeros(len(found))
    np.maximum.at(most, row.ravel(), np.abs(drop)[np.abs(drop) > PASSES_OVER])
    return found, most > STORY


def heights_on(part: Tier, points: FloatArray) -> FloatArray:
    """Return heights at places: of the way they lie on, blended where several are near.

    Parameters
    ----------
    part
        The tier, of at least one way.
    points
        (n, 2) places, scene frame, metres; those beside all ways get the height of the nearest.

    Returns
    -------
    height
        (n,) metres.
    """
    line, spot, far, height = _near(part, points)
    beyond = np.maximum(far - part.half[line], 0.0)
    pull = 1.0 / (0.1 + beyond + AXIS * far) ** 4
    total = np.bincount(spot, pull, minlength=len(points))
    return np.asarray(np.bincount(spot, pull * height, minlength=len(points)) / total)


def highest_on(part: Tier, points: FloatArray) -> FloatArray:
    """Return heights at places as `heights_on`: of the highest way that is one surface there."""
    _, spot, _, height = _near(part, points)
    top = heights_on(part, points)
    within = height < top[spot] + ROOFED
    np.maximum.at(top, spot[within], height[within])
    return top


def _near(part: Tier, points: FloatArray) -> tuple[IntArray, IntArray, FloatArray, FloatArray]:
    """List ways near places, the nearest at least: way, place, metres apart, height there."""
    shapes = to_linestrings(part.lines)
    spots = shapely.points(points)
    tree = shapely.STRtree(spots)
    line, spot = tree.query(shapes, predicate="dwithin", distance=part.reach + BLEND)
    alone = np.setdiff1d(np.arange(len(points)), spot)
    if len(alone):
        extra, nearest = shapely.STRtree(shapes).query_nearest(spots[alone], all_matches=False)
        line, spot = np.concatenate([line, nearest]), np.concatenate([spot, alone[extra]])
    along = shapely.line_locate_point(shapes[line], spots[spot])
    far = shapely.distance(shapes[line], spots[spot])
    return line, spot, far, values_along(part.lines, part.z, line, along)
