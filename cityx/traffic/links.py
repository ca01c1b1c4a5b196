"""Ways across junctions: from the end of each lane over curves and short lanes to the next ones."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.ops import substring

from cityx.geometry.polylines import Polylines
from cityx.traffic.streets import Link, Way

if TYPE_CHECKING:
    from cityx.city.lanes import LaneGraph

FloatArray = NDArray[np.float64]
BoolArray = NDArray[np.bool_]

LONGEST_CHAIN = 12  # short lanes that one way across a junction runs over at most


def links_of(
    graph: LaneGraph, lines: Polylines, open_lane: BoolArray,
    place_of: dict[int, tuple[int, int]], ways: tuple[Way, ...], moving: BoolArray,
) -> tuple[Link, ...]:  # fmt: skip
    """Connect each lane over the curves and short lanes of its junction to the next lanes."""
    onward: dict[int, list[tuple[int, int]]] = {}
    for row, (lane, goal) in enumerate(graph.connection.tolist()):
        onward.setdefault(lane, []).append((goal, row))
    whole = graph.lines
    curves = Polylines(graph.curve, graph.curve_start)
    links = []
    for lane in np.flatnonzero(open_lane).tolist():
        found: dict[int, tuple[float, FloatArray]] = {}
        tail = _after(whole, lines, lane)
        todo: list[tuple[int, tuple[int, ...], list[FloatArray]]] = [(lane, (), [tail])]
        while todo:
            here, passed, parts = todo.pop()
            for goal, row in onward.get(here, ()):
                edges = {int(graph.edge[each]) for each in (lane, *passed)}
                if int(graph.edge[goal]) in edges or not moving[goal]:
                    continue  # nobody turns on the spot
                way = [*parts, _line(curves, row)]
                if open_lane[goal]:
                    path = _joined([*way, _before(whole, lines, goal)])
                    size = float(np.hypot(*np.diff(path, axis=0).T).sum())
                    if goal not in found or size < found[goal][0]:
                        found[goal] = (size, path)
                elif len(passed) < LONGEST_CHAIN:
                    todo.append((goal, (*passed, goal), [*way, _line(whole, goal)]))
        for goal in sorted(found):
            source, target = place_of[lane], place_of[goal]
            ends = ways[source[0]].lanes[source[1]].shape, ways[target[0]].lanes[target[1]].shape
            links.append(Link(source, target, _risen(found[goal][1], ends)))
    return _merged(links)


def _merged(links: list[Link]) -> tuple[Link, ...]:
    """Connect one lane alone to each lane of the next edge; the others merge before.

    Nobody gives way within one stream of traffic, so two lanes that lead into one would run into
    each other. The lane with the fewest other ways on keeps its own.
    """
    choices = np.unique([link.source for link in links], axis=0, return_counts=True)
    others = dict(zip(map(tuple, choices[0].tolist()), choices[1].tolist(), strict=True))
    best: dict[tuple[int, tuple[int, int]], Link] = {}
    for link in links:
        key = (link.source[0], link.target)
        if key not in best or others[link.source] < others[best[key].source]:
            if key in best:
                others[best[key].source] -= 1
            best[key] = link
        else:
            others[link.source] -= 1
    kept = {id(link) for link in best.values()}
    return tuple(link for link in links if id(link) in kept)


def _line(lines: Polylines, row: int) -> FloatArray:
    return lines.points[lines.start[row] : lines.start[row + 1]]


def _after(whole: Polylines, lines: Polylines, lane: int) -> FloatArray:
    """Return what follows of a lane behind where one halts."""
    shape, end = shapely.LineString(_line(whole, lane)), _line(lines, lane)[-1]
    rest = substring(shape, shape.project(shapely.Point(end)), shape.length)
    return np.concatenate([end[None], shapely.get_coordinates(rest)[1:]])


def _before(whole: Polylines, lines: Polylines, lane: int) -> FloatArray:
    """Return what precedes of a lane the place where it begins."""
    shape, start = shapely.LineString(_line(whole, lane)), _line(lines, lane)[0]
    rest = substring(shape, 0.0, shape.project(shapely.Point(start)))
    return np.concatenate([shapely.get_coordinates(rest)[:-1], start[None]])


def _joined(parts: list[FloatArray]) -> FloatArray:
    """Join lines end to start; points that repeat are left out."""
    points = np.concatenate(parts)
    kept = np.r_[True, np.hypot(*np.diff(points, axis=0).T) > 1e-3]
    kept[-1] = True
    if kept.sum() < 2:  # two lanes that touch
        return points[[0, -1]]
    return np.asarray(points[kept])


def _risen(path: FloatArray, ends: tuple[FloatArray, FloatArray]) -> FloatArray:
    """Make a path across a junction rise evenly from one lane to the other."""
    along = np.r_[0.0, np.cumsum(np.hypot(*np.diff(path, axis=0).T))]
    share = along / max(along[-1], 1e-9)
    z = ends[0][-1, 2] + share * (ends[1][0, 2] - ends[0][-1, 2])
    shape = np.column_stack([path, z])
    shape[0], shape[-1] = ends[0][-1], ends[1][0]
    return np.round(shape, 3)
