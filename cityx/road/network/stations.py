"""Stations along all ways: the graph on which their heights are found."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.geometry.arrays import BoolArray, FloatArray, IntArray
from cityx.geometry.chains import components
from cityx.geometry.polylines import Polylines, arc_lengths, pack, to_linestrings
from cityx.ground.grades import fall_to, slopes_of
from cityx.road.network.network import DRIVABLE, clip_lines, shared_nodes

if TYPE_CHECKING:
    from cityx.city.layout import Layout
    from cityx.city.roads import RoadNetwork


RAILS = ("rail", "light_rail", "subway", "tram", "narrow_gauge", "monorail")
ON_FOOT = ("footway", "path", "cycleway", "pedestrian", "bridleway", "corridor")
STATION = 5.0  # metres between the heights of a way
# Steepest climb by kind of way, rise over run. Streets of hill towns exceed what one would build.
GRADE = {"motorway": 0.06, "trunk": 0.07, "primary": 0.08, "secondary": 0.09, "tertiary": 0.10,
         "service": 0.15, "track": 0.18, "steps": 0.6}  # fmt: skip
USUAL_GRADE = 0.12
LINK_GRADE = 0.01  # more on ramps between roads
ROUND_GRADE = 0.04  # of roundabouts: steeper ones tilt cars outwards (FHWA, NCHRP 672, 6.8.7)
FOOT_GRADE = 0.12
RAIL_GRADE, TRAM_GRADE = 0.035, 0.08
# Free height over a way by what moves on it, metres, with a little more than the least required.
OVER_CARS, OVER_RAILS, OVER_FEET = 4.8, 5.2, 2.7
DECK = 0.8  # metres of structure under a deck that carries traffic
FOOT_DECK = 0.5
EDGE = 0.5  # metres of kerb and parapet at the side of a deck
NEAR_LEVEL = 30.0  # metres in which no street climbs from under a bridge onto one
REACH = 400.0  # metres; a flat site needs no heights farther from every bridge and tunnel


@dataclass(frozen=True)
class Ways:
    """Centrelines in stations, with what constrains their heights; w ways, p stations."""

    lines: Polylines
    node: IntArray  # (p,)
    road: IntArray  # (w,) row of the layout
    edge: IntArray  # (w,) edge of the network or -1
    level: IntArray  # (w,)
    grade: FloatArray  # (w,)
    clear: FloatArray  # (w,) free height that a way over this one leaves
    deck: FloatArray  # (w,) structure under this one
    half: FloatArray  # (w,)
    reach: FloatArray  # (w,) half the width with walks
    tunnel: BoolArray  # (w,)
    light: BoolArray  # (w,) on foot, or rails below: no street makes way for it
    along: FloatArray  # (p,)
    count: int  # of nodes

    @cached_property
    def owner(self) -> IntArray:
        """(p,) the way of each station."""
        return self.lines.line_of_point()

    @cached_property
    def shapes(self) -> NDArray[Any]:
        """(w,) the lines."""
        return to_linestrings(self.lines)

    @property
    def length(self) -> FloatArray:
        """(w,) metres."""
        return np.asarray(self.along[self.lines.start[1:] - 1])

    @property
    def place(self) -> FloatArray:
        """(count, 2) of each node."""
        place = np.zeros((self.count, 2))
        place[self.node] = self.lines.points
        return place

    @property
    def rank(self) -> IntArray:
        """(w,) order of what passes over what: of one level, paths are farther from the ground."""
        return np.asarray(2 * self.level + np.sign(self.level) * self.light)


def way_levels(layout: Layout) -> IntArray:
    """(n,) level of each way: 0 on the ground, a bridge at least 1, a tunnel at most -1."""
    roads = layout.roads
    level = roads["layer"].to_numpy().astype(np.int64)
    passage = roads["passage"].to_numpy()
    level = np.where(roads["bridge"].to_numpy(), np.maximum(level, 1), level)
    below = roads["tunnel"].to_numpy() & ~passage
    level = np.where(below, np.minimum(level, -1), level)
    return np.asarray(np.where(passage, 0, level))


def free_heights(kind: NDArray[np.str_]) -> FloatArray:
    """(n,) metres that stay free over ways, by what moves on them."""
    rails, feet = np.isin(kind, RAILS), np.isin(kind, (*ON_FOOT, "steps"))
    return np.select([rails, feet], [OVER_RAILS, OVER_FEET], OVER_CARS)


def collect_ways(layout: Layout, network: RoadNetwork, *, everywhere: bool) -> Ways | None:
    """Collect the centrelines that need heights, with a station every few metres."""
    roads = layout.roads
    kind = roads["kind"].to_numpy().astype(str)
    others = np.flatnonzero(
        ~np.isin(kind, DRIVABLE) & (shapely.length(roads.geometry.to_numpy()) > 0)
    )
    shapes, rows = clip_lines(shapely.force_2d(roads.geometry.to_numpy()[others]), others,
                              layout.extent)  # fmt: skip
    cars = to_linestrings(network.lines)
    shapes = np.concatenate([cars, shapes])
    road = np.concatenate([network.edge_road.astype(np.int64), rows])
    edge = np.concatenate([np.arange(len(cars)), np.full(len(rows), -1)])
    level = way_levels(layout)[road]
    if not len(shapes) or not (everywhere or level.any()):
        return None
    if not everywhere:
        near = shapely.STRtree(shapes[level != 0]).query(shapes, "dwithin", distance=REACH)[0]
        chosen = np.unique(near)
        shapes, road, edge, level = shapes[chosen], road[chosen], edge[chosen], level[chosen]
    lines = pack(shapely.segmentize(shapes, STATION))
    node = shared_nodes(lines, level - level.min(), edge >= 0)[0]
    node = _joined(node, lines, edge, network)
    kind = kind[road]
    feet, rails = np.isin(kind, (*ON_FOOT, "steps")), np.isin(kind, RAILS)
    # Platforms join streets and the railway below them in one graph; no train climbs the stairs.
    deep = np.zeros(int(node.max()) + 1, bool)
    deep[node[(rails & (level < 0))[lines.line_of_point()]]] = True
    node = np.where(deep[node] & rails[lines.line_of_point()], node + len(deep), node)
    node = np.unique(node, return_inverse=True)[1]
    link = np.char.endswith(kind, "_link")
    grade = np.array([GRADE.get(word.removesuffix("_link"), USUAL_GRADE) for word in kind])
    grade = np.where(link, grade + LINK_GRADE, grade)
    grade = np.select([kind == "tram", rails, feet & (kind != "steps")],
                      [TRAM_GRADE, RAIL_GRADE, FOOT_GRADE], grade)  # fmt: skip
    ring = roads["roundabout"].to_numpy(bool)[road]
    grade = np.where(ring, np.minimum(grade, ROUND_GRADE), grade)
    half = np.maximum(roads["width"].to_numpy(float)[road], 1.5) / 2
    half[edge >= 0] = network.half_width[edge[edge >= 0]]
    half = np.where(rails, 2.25, half)
    walk = roads[["sidewalk_left", "sidewalk_right"]].to_numpy(float).max(axis=1)[road]
    return Ways(
        lines, node, road, edge, level, grade,
        free_heights(kind), np.where(feet, FOOT_DECK, DECK), half, half + walk + EDGE,
        roads["tunnel"].to_numpy()[road] & (level < 0), feet | (rails & (level < 0)),
        arc_lengths(lines)[0], int(node.max()) + 1,
    )  # fmt: skip


def _joined(
    node: IntArray, lines: Polylines, edge: IntArray, network: RoadNetwork
) -> IntArray:  # fmt: skip
    """Give ends of edges that meet in the network one station, whatever paths do there."""
    cars = np.flatnonzero(edge >= 0)
    foot = np.concatenate([lines.start[:-1][cars], lines.start[1:][cars] - 1])
    count = int(node.max()) + 1
    meeting = count + network.edge_nodes[edge[cars]].T.ravel().astype(np.int64)
    lowest = components(np.column_stack([node[foot], meeting]),
                        count + len(network.node_position))  # fmt: skip
    return np.asarray(np.unique(lowest[node], return_inverse=True)[1])


def nearest_station(ways: Ways, way: IntArray, points: FloatArray) -> IntArray:
    """(k,) station of each way nearest to each place, as an index of stations."""
    at = shapely.line_locate_point(ways.shapes[way], shapely.points(points))
    start, end = ways.lines.start[way], ways.lines.start[way + 1]
    shift = np.concatenate([[0.0], np.cumsum(ways.length + 1.0)])[:-1]
    keys = ways.along + shift[ways.owner]
    after = np.clip(np.searchsorted(keys, at + shift[way]), start + 1, end - 1)
    nearer = at - ways.along[after - 1] < ways.along[after] - at
    return np.asarray(np.where(nearer, after - 1, after))


def stations_around(ways: Ways, station: IntArray, reach: FloatArray) -> tuple[IntArray, IntArray]:
    """List the stations of a way within `reach` metres along it, and the row each belongs to."""
    way = ways.owner[station]
    shift = np.concatenate([[0.0], np.cumsum(ways.length + 1000.0)])[:-1]
    keys = ways.along + shift[ways.owner]
    low = np.searchsorted(keys, keys[station] - reach, side="left")
    high = np.searchsorted(keys, keys[station] + reach, side="right")
    low, high = np.maximum(low, ways.lines.start[way]), np.minimum(high, ways.lines.start[way + 1])
    size = np.maximum(high - low, 0)
    which = np.repeat(np.arange(len(station)), size)
    first = np.concatenate([[0], np.cumsum(size)])[:-1]
    return np.arange(len(which)) - first[which] + low[which], which


def walk_to(ways: Ways, level: int) -> FloatArray:
    """(n,) metres along ways to the nearest station of a level, or one farther from the ground.

    Looked for within `NEAR_LEVEL` metres only; infinity beyond.
    """
    owner = ways.owner
    first = np.flatnonzero(owner[1:] == owner[:-1])
    slopes = slopes_of(ways.node[np.column_stack([first, first + 1])],
                       ways.along[first + 1] - ways.along[first])  # fmt: skip
    there = np.full(ways.count, np.inf)
    there[ways.node[(np.sign(level) * (ways.level - level) >= 0)[owner]]] = 0.0
    return fall_to(slopes, there, NEAR_LEVEL)
