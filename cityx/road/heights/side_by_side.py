"""Carriageways side by side at different heights: what each leaves to the other."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.city.ground import LABEL, SURFACES
from cityx.city.layout import Layout
from cityx.city.roads import RoadNetwork
from cityx.geometry.arrays import BoolArray, FloatArray, IntArray
from cityx.geometry.polylines import Polylines, pack, segments, to_linestrings, values_along
from cityx.ground.arrangement import Regions, join_regions, regions
from cityx.road.heights.structure_tiers import SAME_PLACE, STORY, Tier, free_over
from cityx.road.network.stations import DECK, STATION

Shapes = NDArray[Any]

APART = 0.3  # metres of height from which two ways side by side are no one surface
WALL = 0.45  # metres beside a carriageway for what bounds the higher one
CROSSED = 25.0  # metres round where two ways cross in which one may lie over the other
STEP = 0.3  # metres that pieces of strips lap over each other, so that bends leave no gap
LEAST = 0.05  # metres of a carriageway for which another one gives way
FAR = 1.0  # metres past the edge of a way


@dataclass(frozen=True)
class _Runs:
    """Short straight pieces of carriageways, r of them."""

    ends: FloatArray  # (r, 2, 2) metres
    z: FloatArray  # (r, 2) metres
    edge: IntArray  # (r,) row of the edge in the network they come from

    @property
    def shapes(self) -> Shapes:
        """(r,) the pieces as lines."""
        return np.asarray(shapely.linestrings(self.ends))

    def height_at(self, rows: IntArray, points: FloatArray) -> FloatArray:
        """(k,) heights of pieces at places on them."""
        begin, step = self.ends[rows, 0], np.diff(self.ends[rows], axis=1)[:, 0]
        share = ((points - begin) * step).sum(axis=1) / np.maximum((step**2).sum(axis=1), 1e-9)
        low, high = self.z[rows].T
        return np.asarray(low + np.clip(share, 0.0, 1.0) * (high - low))


def yielded(layout: Layout, part: Tier, network: RoadNetwork) -> Regions:
    """Return what the surfaces of a tier leave to carriageways beside them at other heights.

    A walk ends where another carriageway begins. Where two carriageways would share ground, each
    keeps the part of the width between the two lines that its own width has in the sum of both.
    Ways that cross are left as they are about the place.

    Parameters
    ----------
    layout
        The city's, which tells kinds.
    part
        The tier.
    network
        The whole city's, with heights.
    """
    own = part.network
    reach = part.reach[: own.edge_count]
    mine = _runs(own.lines, own.z, np.arange(own.edge_count))
    near = shapely.STRtree(to_linestrings(own.lines)).query(
        to_linestrings(network.lines), "dwithin",
        distance=network.half_width + reach.max(initial=0.0) + WALL,
    )[0]  # fmt: skip
    theirs = _runs(network.lines, network.z, np.unique(near))
    theirs = _without(theirs, network, own)
    if not len(mine.edge) or not len(theirs.edge):
        return Regions()
    here, there, between, drop = _facing(mine, theirs, reach, network.half_width)
    free = free_over(layout, network.edge_road)[theirs.edge[there]]
    beside = np.where(drop > 0, drop < free + DECK, -drop < STORY) & (np.abs(drop) > APART)
    beside &= ~_crossing(own, network, mine.edge[here], theirs.edge[there], between.mean(axis=1))
    here, there, between = here[beside], there[beside], between[beside]
    gap = np.hypot(*np.diff(between, axis=1)[:, 0].T)
    half, other = own.half_width[mine.edge[here]], network.half_width[theirs.edge[there]]
    room = SURFACES[LABEL["carriageway"]].priority - 1
    found = [_strips(mine, here, theirs, there, between, other + WALL, reach[mine.edge[here]],
                     room)]  # fmt: skip
    shared = gap < half + other
    here, there, between = here[shared], there[shared], between[shared]
    kept = (gap * other / (half + other))[shared]
    found.append(_strips(mine, here, theirs, there, between, kept, half[shared] + STEP,
                         SURFACES[LABEL["void"]].priority))  # fmt: skip
    return join_regions(found)


def _runs(lines: Polylines, z: FloatArray, rows: IntArray) -> _Runs:
    """Cut some lines into pieces of a few metres."""
    cut = pack(shapely.segmentize(to_linestrings(lines)[rows], STATION))
    first, owner = segments(cut)
    along = shapely.line_locate_point(
        to_linestrings(lines)[rows][cut.line_of_point()], shapely.points(cut.points)
    )
    height = values_along(lines, z, rows[cut.line_of_point()], along)
    return _Runs(
        np.stack([cut.points[first], cut.points[first + 1]], axis=1),
        np.stack([height[first], height[first + 1]], axis=1), rows[owner],
    )  # fmt: skip


def _without(theirs: _Runs, network: RoadNetwork, own: RoadNetwork) -> _Runs:
    """Leave out the pieces of edges that belong to the tier itself."""
    lines = to_linestrings(own.lines)
    middle = shapely.points(theirs.ends.mean(axis=1))
    run, line = shapely.STRtree(lines).query(middle, "dwithin", distance=SAME_PLACE)
    same = network.edge_id[theirs.edge[run]] == own.edge_id[line]
    kept = np.setdiff1d(np.arange(len(middle)), run[same])
    return _Runs(theirs.ends[kept], theirs.z[kept], theirs.edge[kept])


def _facing(
    mine: _Runs, theirs: _Runs, reach: FloatArray, half: FloatArray
) -> tuple[IntArray, IntArray, FloatArray, FloatArray]:
    """Pair pieces of which one lies within the width of the other.

    Returns
    -------
    here, there
        (k,) rows of both.
    between
        (k, 2, 2) the nearest places, on the one and on the other.
    drop
        (k,) metres from the other up to the one there.
    """
    own, other = mine.shapes, theirs.shapes
    far = reach[mine.edge] + half[theirs.edge].max(initial=0.0) + WALL
    here, there = shapely.STRtree(other).query(own, "dwithin", distance=far)
    close = shapely.distance(own[here], other[there])
    near = close < reach[mine.edge[here]] + half[theirs.edge[there]] + WALL
    here, there = here[near], there[near]
    link = shapely.shortest_line(own[here], other[there])
    between = shapely.get_coordinates(link).reshape(-1, 2, 2)
    drop = mine.height_at(here, between[:, 0]) - theirs.height_at(there, between[:, 1])
    return here, there, between, drop


def _crossing(
    own: RoadNetwork, network: RoadNetwork, one: IntArray, other: IntArray, at: FloatArray
) -> BoolArray:
    """(k,) whether places lie about a crossing of the two lines."""
    pairs, row = np.unique(np.column_stack([one, other]), axis=0, return_inverse=True)
    shapes = to_linestrings(own.lines)[pairs[:, 0]], to_linestrings(network.lines)[pairs[:, 1]]
    spots = shapely.intersection(*shapes)
    far = shapely.distance(spots[row.ravel()], shapely.points(at))
    return np.asarray(shapely.crosses(*shapes)[row.ravel()] & (far < CROSSED))


def _strips(
    mine: _Runs, here: IntArray, theirs: _Runs, there: IntArray, between: FloatArray,
    half: FloatArray, reach: FloatArray, priority: int,
) -> Regions:  # fmt: skip
    """Return the ground from the near edge of other carriageways on, as far as a way reaches.

    Parameters
    ----------
    mine, here, theirs, there, between
        As of `_facing`.
    half
        (k,) metres from the other line to its edge.
    reach
        (k,) metres that the way reaches.
    priority
        Of the region.
    """
    wide = half > LEAST
    here, there = here[wide], there[wide]
    between, half, reach = between[wide], half[wide], reach[wide]
    ends = theirs.ends[there]
    ahead = np.diff(ends, axis=1)[:, 0]
    ahead /= np.maximum(np.hypot(*ahead.T), 1e-9)[:, None]
    left = np.column_stack([-ahead[:, 1], ahead[:, 0]])
    side = np.where(((between[:, 0] - ends[:, 0]) * left).sum(axis=1) < 0, -1.0, 1.0)[:, None]
    near, far = left * side * half[:, None], -left * side * (half + reach + FAR)[:, None]
    begin, end = ends[:, 0] - STEP * ahead, ends[:, 1] + STEP * ahead
    beyond = shapely.polygons(np.stack([begin + near, end + near, end + far, begin + far], axis=1))
    strip = shapely.buffer(mine.shapes[here], reach + WALL, cap_style="flat")
    cut = shapely.intersection(shapely.make_valid(beyond), strip)
    joined = shapely.unary_union(cut[shapely.area(cut) > 0])
    return regions(joined, LABEL["void"], priority)
