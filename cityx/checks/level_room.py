"""Room between levels: where the map lets one way pass over another, and whether it can.

Heights of ways are bounded by their grades: along a way they change by its length times its grade
at most. So the most by which one way can lie above another where they cross is the least climb over
all paths that join the two places (infinite where none does), and crossings that share such paths
can all be kept unless some cycle of paths and crossings climbs less than the crossings need. This
asks the map's lines and tags alone, and nothing of what was built.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray
from scipy.sparse import coo_array, csr_array
from scipy.sparse.csgraph import connected_components, dijkstra

from cityx.city.layout import Layout
from cityx.geometry.arrays import BoolArray, FloatArray, IntArray
from cityx.geometry.chains import components
from cityx.geometry.polylines import arc_lengths, pack
from cityx.system.remembered import Remembered

# Steepest climb by kind of way, as standards for streets of towns in hills have it; rails last.
LIMITS = {"motorway": 0.06, "trunk": 0.07, "primary": 0.08, "secondary": 0.09, "tertiary": 0.10,
          "service": 0.15, "track": 0.18, "steps": 0.6, "tram": 0.08, "rail": 0.035,
          "light_rail": 0.035, "subway": 0.035, "narrow_gauge": 0.035,
          "monorail": 0.035}  # fmt: skip
USUAL_LIMIT = 0.12
LINK_MORE = 0.02  # on ramps between roads, where one drives slowly
STEEPEST = 2.5  # times the grade that ramps without room may climb
STAIRS = 0.6  # grade of what is walked, where stairs are its only way
WALKED = ("footway", "path", "cycleway", "pedestrian", "bridleway", "corridor", "steps")
RAILS = ("rail", "light_rail", "subway", "tram", "narrow_gauge", "monorail")
CLEAR = 4.5  # metres of free height over a carriageway
OVER = {"walked": 2.2, "rails": 5.0}  # over what else moves
DECK = {True: 0.5, False: 0.8}  # metres of structure under what is walked, and under all else
NARROWEST = 1.5  # metres of width that every way has
NODE = 0.001  # metres within which a crossing lies at a corner of a line
PER_METRE = 1000  # steps in which places are told apart
FLAT = 1e-6  # metres of climb of a step without length
REACH = 2.5  # times the height of a crossing within which another one bears on it
HOPS = 5  # crossings in one cycle that are looked at together
BATCH = 64  # crossings from which paths are looked for at once


@dataclass(frozen=True)
class LevelCrossings:
    """Where ways of the map pass over each other, c places.

    Attributes
    ----------
    at
        (c, 2) metres.
    upper, lower
        (c,) rows of the layout's roads.
    need
        (c,) metres from the lower surface to the upper.
    tight, roomless
        (c,) bool: no room within the usual grades; none within the steepest.
    """

    at: FloatArray
    upper: IntArray
    lower: IntArray
    need: FloatArray
    tight: BoolArray
    roomless: BoolArray


_LAST: Remembered[LevelCrossings] = Remembered()


def level_crossings(layout: Layout) -> LevelCrossings:
    """Find where ways pass over each other, and whether there is room; the last are remembered."""
    return _LAST.get(lambda: _found(layout), [layout])


def grade_limits(kind: NDArray[np.str_]) -> FloatArray:
    """(n,) steepest climb of ways by their kinds, rise over run."""
    limit = np.array([LIMITS.get(word.removesuffix("_link"), USUAL_LIMIT) for word in kind])
    return np.asarray(limit + LINK_MORE * np.char.endswith(kind, "_link"))


def _found(layout: Layout) -> LevelCrossings:
    roads = layout.roads
    shapes = shapely.force_2d(roads.geometry.to_numpy())
    kind, level = roads["kind"].to_numpy().astype(str), _levels(layout)
    walked, rails = np.isin(kind, WALKED), np.isin(kind, RAILS)
    off = np.flatnonzero(level)
    one, other = shapely.STRtree(shapes).query(shapes[off], predicate="crosses")
    pair = np.unique(np.sort(np.column_stack([off[one], other]), axis=1), axis=0).reshape(-1, 2)
    # Of one level, what is walked, or runs on rails below, passes farther from the ground.
    rank = 2 * level + np.sign(level) * (walked | (rails & (level < 0)))
    pair = pair[rank[pair[:, 0]] != rank[pair[:, 1]]]
    first = rank[pair[:, 0]] > rank[pair[:, 1]]
    upper, lower = np.where(first, pair.T, pair.T[::-1])
    at, row = shapely.get_coordinates(
        shapely.intersection(shapes[upper], shapes[lower]), return_index=True
    )
    upper, lower = upper[row], lower[row]
    free = np.select([walked, rails], [OVER["walked"], OVER["rails"]], CLEAR)
    need = free[lower] + np.where(walked[upper], DECK[True], DECK[False])
    places = np.tile(at, (2, 1)), np.concatenate([upper, lower])
    graph_of, node = _graph(shapes, level, *places)
    usual = grade_limits(kind)
    steep = np.where(walked, STAIRS, STEEPEST * usual)
    over, under = node[: len(upper)], node[len(upper) :]
    half = np.maximum(roads["width"].to_numpy(float), NARROWEST) / 2

    def lacking(grade: FloatArray) -> BoolArray:
        # The height is needed over the whole width of what is crossed, and under that of the deck.
        more = grade[upper] * half[lower] + grade[lower] * half[upper]
        return _lacking(graph_of(grade), over, under, need + more)

    tight, roomless = lacking(usual), lacking(steep)
    found = LevelCrossings(at, upper, lower, need, tight | roomless, roomless)
    return _with_contradictions(found, shapes, level, walked | rails)


def _with_contradictions(
    found: LevelCrossings, shapes: NDArray[Any], level: IntArray, light: BoolArray
) -> LevelCrossings:
    """Add the places where streets of one level off the ground cross without a node: no room."""
    off = np.flatnonzero((level != 0) & ~light)
    one, other = (off[row] for row in shapely.STRtree(shapes[off]).query(shapes[off], "crosses"))
    same = (one < other) & (level[one] == level[other])
    one, other = one[same], other[same]
    at, row = shapely.get_coordinates(
        shapely.intersection(shapes[one], shapes[other]), return_index=True
    )
    # Those that meet at a corner of both are a junction.
    corner = [
        shapely.dwithin(shapely.extract_unique_points(shapes[way[row]]), shapely.points(at), NODE)
        for way in (one, other)
    ]
    alone = ~(corner[0] & corner[1])
    none = np.ones(int(alone.sum()), bool)
    return LevelCrossings(
        np.concatenate([found.at, at[alone]]),
        np.concatenate([found.upper, one[row][alone]]),
        np.concatenate([found.lower, other[row][alone]]),
        np.concatenate([found.need, np.zeros(len(none))]),
        np.concatenate([found.tight, none]), np.concatenate([found.roomless, none]),
    )  # fmt: skip


def _levels(layout: Layout) -> IntArray:
    """(n,) level of each way as its tags have it: bridges above the ground, tunnels below."""
    roads = layout.roads
    level = roads["layer"].to_numpy().astype(np.int64)
    level = np.where(roads["bridge"].to_numpy(bool), np.maximum(level, 1), level)
    level = np.where(roads["tunnel"].to_numpy(bool), np.minimum(level, -1), level)
    return np.asarray(np.where(roads["passage"].to_numpy(bool), 0, level))


@dataclass(frozen=True)
class _Steps:
    """Steps along ways between places that are told apart, s of them."""

    ends: IntArray  # (s, 2) places
    run: FloatArray  # (s,) metres
    way: IntArray  # (s,)
    count: int  # of places

    def __call__(self, grade: FloatArray) -> csr_array:
        """Return what each step climbs at most, metres, for the grade of each way."""
        climb = np.maximum(self.run * grade[self.way], FLAT)
        low, high = np.sort(self.ends, axis=1).T
        order = np.lexsort((climb, high, low))
        low, high, climb = low[order], high[order], climb[order]
        least = np.r_[True, (low[1:] != low[:-1]) | (high[1:] != high[:-1])] & (low != high)
        size = (self.count, self.count)
        return csr_array(coo_array((climb[least], (low[least], high[least])), shape=size))


def _graph(
    shapes: NDArray[Any], level: IntArray, at: FloatArray, way: IntArray
) -> tuple[_Steps, IntArray]:
    """Divide ways at their corners and at some places, and join them where they meet.

    Ways of different levels meet at a common corner where both end, or one ends that nothing goes
    on from; elsewhere they cross.

    Parameters
    ----------
    shapes, level
        (w,) lines, and the level of each.
    at, way
        (k, 2) places on lines, and (k,) which one.

    Returns
    -------
    steps
        Between the corners and the places.
    node
        (k,) of the places.
    """
    lines = pack(shapes)
    owner = lines.line_of_point()
    ends = np.zeros(len(owner), bool)
    ends[lines.start[:-1]] = ends[lines.start[1:] - 1] = True
    place = np.unique(np.rint(lines.points * PER_METRE), axis=0, return_inverse=True)[1].ravel()
    group = np.unique(np.column_stack([place, level[owner]]), axis=0, return_inverse=True)[1]
    group = group.ravel()
    count = int(group.max(initial=-1)) + 1
    ending, visits = np.zeros(count, bool), np.bincount(group, minlength=count)
    np.logical_or.at(ending, group, ends)
    meets = ending[group]
    loose = np.zeros(int(place.max(initial=-1)) + 1, bool)
    loose[place[meets & (visits[group] == 1)]] = True
    joins = meets | loose[place]
    pairs = np.column_stack([group, count + place])[joins]
    corner = components(pairs, count + len(loose))[group]
    own = np.concatenate([owner, way])
    along = np.concatenate([
        arc_lengths(lines)[0], shapely.line_locate_point(shapes[way], shapely.points(at))
    ])  # fmt: skip
    node = np.concatenate([corner, count + len(loose) + np.arange(len(way))])
    order = np.lexsort((along, own))
    same = np.flatnonzero(own[order][1:] == own[order][:-1])
    before, after = order[same], order[same + 1]
    steps = _Steps(np.column_stack([node[before], node[after]]), along[after] - along[before],
                   own[before], count + len(loose) + len(way))  # fmt: skip
    return steps, node[len(owner) :]


def _lacking(graph: csr_array, over: IntArray, under: IntArray, need: FloatArray) -> BoolArray:
    """(c,) crossings that lie on a cycle which climbs less than its crossings need."""
    lacking = np.zeros(len(over), bool)
    if not len(over):
        return lacking
    excess = np.full((len(over), len(over)), np.inf)
    limit = REACH * float(need.max())
    for begin in range(0, len(over), BATCH):
        rows = slice(begin, begin + BATCH)
        climb = dijkstra(graph, directed=False, indices=under[rows], limit=limit)
        excess[rows] = climb[:, over] - need
    lacking |= np.diag(excess) < 0
    for hops in range(2, HOPS + 1):
        kept = np.flatnonzero(~lacking)
        part = csr_array(np.isfinite(excess[np.ix_(kept, kept)]))
        count, label = connected_components(part, directed=True, connection="strong")
        size = np.bincount(label, minlength=count)
        for which in np.flatnonzero(size > 1).tolist():
            rows = kept[label == which]
            lacking[rows] = _closed(excess[np.ix_(rows, rows)], hops) < 0
    return lacking


def _closed(excess: FloatArray, hops: int) -> FloatArray:
    """(m,) least sum over closed walks of so many steps from each of m places."""
    walk = excess
    for _ in range(hops - 1):
        walk = np.stack([(row[:, None] + excess).min(axis=0) for row in walk])
    return np.asarray(np.diag(walk))
