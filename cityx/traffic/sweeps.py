"""Swept path of vehicles in bends and across junctions."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from math import inf
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.ops import substring

from cityx.geometry.arrays import FloatArray, IntArray
from cityx.traffic.conflicts import HALF_BODY, conflicts_of
from cityx.traffic.recording import bodies
from cityx.traffic.streets import Streets

LENGTH, HALF = 12.0, 1.275  # metres, a bus and half its width
CAR_LENGTH, CAR_HALF = 5.05, 0.9  # metres, a van; a wall that it would but brush is no hindrance
STEP = 1.0  # metres of way between the places where it is looked at
BACK = 2.6  # radians between its two ends of a way on which one turns back
CIRCLE = 18.0  # metres between the two, at least, for a bus to get round
STRAIGHT = 0.15  # radians; on straighter ways it sweeps over nothing beside its lane


def tight_links(streets: Streets, walls: shapely.STRtree) -> Streets:
    """Mark the links on which a bus would sweep over walls, or over paths that are never free.

    So are those on which it would turn back within less than its turning circle.
    """
    links, ways = streets.links, streets.ways
    if not links:
        return streets
    lanes = [(number, index) for number, way in enumerate(ways)
             for index, lane in enumerate(way.lanes) if lane.kind != "walk"]  # fmt: skip
    lane_lines = [shapely.LineString(ways[way].lanes[index].shape[:, :2]) for way, index in lanes]
    link_lines = [shapely.LineString(link.shape[:, :2]) for link in links]
    cars = shapely.buffer(np.array(lane_lines + link_lines, object), HALF_BODY, cap_style="flat")
    # Who comes towards it on its own streets may be as wide, and stands there.
    stands = shapely.buffer(np.array(lane_lines, object), HALF, cap_style="flat")
    found = conflicts_of(streets)
    pairs = zip(found.first.tolist(), found.second.tolist(), strict=True)
    parted = {frozenset(pair) for pair in pairs}
    rings, of = _swept(streets, LENGTH, HALF)
    walled = set(of[walls.query(rings, predicate="intersects")[0]].tolist())
    over = np.concatenate([stands, cars[len(lanes) :]])
    met = _met(rings, of, over)
    bodies_met = {tuple(pair) for pair in _met(rings, of, cars[: len(lanes)]).tolist()}
    others = np.split(met[:, 1], np.searchsorted(met[:, 0], np.arange(1, len(links))))
    marked = []
    for number, link in enumerate(links):
        ends = link.source[0], link.target[0]
        tight = number in walled or turns_back(link.shape[:, :2])
        for other in others[number].tolist():
            if other < len(lanes):
                way = lanes[other][0]
                if way in ends:  # of its own lanes it leaves those beside to others
                    beside = lanes[other] not in (link.source, link.target)
                    tight |= beside and (number, other) in bodies_met
                else:
                    tight |= ways[way].edge in (ways[ends[0]].edge, ways[ends[1]].edge)
                continue
            place = other - len(lanes)
            same = links[place].source == link.source or links[place].target == link.target
            tight |= (
                not same
                and frozenset((number, place)) not in parted
                and (ways[links[place].source[0]].target == ways[link.source[0]].target)
            )
        marked.append(replace(link, tight=tight))
    return replace(streets, links=tuple(marked))


def _met(rings: NDArray[Any], of: IntArray, shapes: NDArray[Any]) -> IntArray:
    """(k, 2) what sweeps over which of some shapes, ascending; `of` says whose the rings are."""
    ring, shape = shapely.STRtree(shapes).query(rings, predicate="intersects")
    return np.asarray(np.unique(np.column_stack([of[ring], shape]), axis=0))


def turns_back(shape: FloatArray) -> bool:
    """Return whether a path turns back closer than a bus can turn."""
    steps = shape[[1, -1]] - shape[[0, -2]]
    first, last = steps / np.maximum(np.hypot(*steps.T), 1e-9)[:, None]
    reach = shape[-1] - shape[0]
    aside = abs(float(first[0] * reach[1] - first[1] * reach[0]))
    return bool(first @ last < np.cos(BACK)) and aside < CIRCLE


def clear_links(streets: Streets, walls: shapely.STRtree) -> Streets:
    """Leave out the links on which a car would sweep over walls."""
    rings, of = _swept(streets, CAR_LENGTH, CAR_HALF)
    touching = set(of[walls.query(rings, predicate="intersects")[0]].tolist())
    kept = (link for number, link in enumerate(streets.links) if number not in touching)
    return replace(streets, links=tuple(kept))


def swept_into(
    lines: NDArray[Any], walls: shapely.STRtree, length: float = CAR_LENGTH, half: float = CAR_HALF
) -> NDArray[np.bool_]:  # fmt: skip
    """(n,) whether a body, a car's by default, that follows a line sweeps over a wall in a bend."""
    near = np.unique(walls.query(lines, predicate="dwithin", distance=length / 2)[0])
    bent = near[shapely.get_num_points(lines[near]) > 2]
    swept = [_swept_along(line, length, half) for line in shapely.force_2d(lines[bent])]
    rings, of = _joined(swept, bent)
    hit = np.zeros(len(lines), bool)
    hit[of[walls.query(rings, predicate="intersects")[0]]] = True
    return hit


def _swept(streets: Streets, length: float, half: float) -> tuple[NDArray[Any], IntArray]:
    """Return the ground that a body sweeps over on links, and (r,) whose: none where it is lanes.

    The ground of each is where it stands one after the other, (r,) polygons of all together.
    """
    swept, of = [], []
    for number, link in enumerate(streets.links):
        source, target = (streets.ways[way].lanes[index].shape[:, :2]
                          for way, index in (link.source, link.target))  # fmt: skip
        begin, end = source[-1] - source[-2], target[1] - target[0]
        turn = np.arctan2(begin[0] * end[1] - begin[1] * end[0], begin @ end)
        if abs(turn) < STRAIGHT:
            continue
        before, after = shapely.LineString(source), shapely.LineString(target)
        parts = [substring(before, max(before.length - length, 0.0), before.length),
                 shapely.LineString(link.shape[:, :2]), substring(after, 0.0, length)]  # fmt: skip
        path = shapely.LineString(np.concatenate([shapely.get_coordinates(part) for part in parts]))
        swept.append(_swept_along(path, length, half, behind=parts[0].length))
        of.append(number)
    return _joined(swept, np.array(of, np.int64))


def _joined(rings: Sequence[FloatArray], of: IntArray) -> tuple[NDArray[Any], IntArray]:
    """Return (r,) polygons of the rings of all, and (r,) whose each is."""
    whose = np.repeat(of, [len(each) for each in rings])
    return shapely.polygons(np.concatenate([np.zeros((0, 4, 2)), *rings])), whose


def _swept_along(path: Any, length: float, half: float, behind: float = inf) -> FloatArray:
    """(r, 4, 2) where a body stands, time after time, whose foremost point follows a path.

    Where it is longer than what lies `behind` the place of interest, it is looked at from there on.
    """
    along = np.arange(0.0, path.length, STEP)
    front = shapely.get_coordinates(shapely.line_interpolate_point(path, along))
    begin = np.subtract(*shapely.get_coordinates(path)[[1, 0]])
    xy, heading, _ = bodies(front, np.full(len(front), np.arctan2(begin[1], begin[0])),
                            np.zeros(len(front), np.int64), np.array([length]))  # fmt: skip
    ahead = np.column_stack([np.cos(heading), np.sin(heading)]) * length / 2
    side = np.column_stack([-np.sin(heading), np.cos(heading)]) * half
    ring = np.stack([xy - ahead - side, xy + ahead - side, xy + ahead + side, xy - ahead + side],
                    axis=1)  # fmt: skip
    late = along >= min(length, behind)
    return np.asarray(ring[late])
