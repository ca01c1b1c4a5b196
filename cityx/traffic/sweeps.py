"""What long vehicles sweep over on their ways across junctions."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.ops import substring

from cityx.traffic.conflicts import HALF_BODY, conflicts_of
from cityx.traffic.recording import bodies
from cityx.traffic.streets import Streets

FloatArray = NDArray[np.float64]

LENGTH, HALF = 12.0, 1.275  # metres, a bus and half its width
STEP = 1.0  # metres of way between the places where it is looked at
STRAIGHT = 0.15  # radians; on straighter ways it sweeps over nothing beside its lane


def tight_links(streets: Streets, walls: shapely.STRtree) -> Streets:
    """Mark the links on which a bus would sweep over walls, or ways that nobody leaves free."""
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
    tree = shapely.STRtree(np.concatenate([stands, cars[len(lanes) :]]))
    marked = []
    for number, link in enumerate(links):
        swept = _swept(streets, number)
        ends = link.source[0], link.target[0]
        tight = swept is not None and len(walls.query(swept, predicate="intersects")) > 0
        for other in (
            tree.query(swept, predicate="intersects").tolist() if swept is not None else ()
        ):
            if other < len(lanes):
                way = lanes[other][0]
                if way in ends:  # of its own lanes it leaves those beside to others
                    beside = lanes[other] not in (link.source, link.target)
                    tight |= beside and bool(shapely.intersects(cars[other], swept))
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


def _swept(streets: Streets, number: int) -> Any:
    """Return the ground that a bus sweeps over on a link; None where that is its lanes."""
    link = streets.links[number]
    source, target = (streets.ways[way].lanes[index].shape[:, :2]
                      for way, index in (link.source, link.target))  # fmt: skip
    begin, end = source[-1] - source[-2], target[1] - target[0]
    turn = np.arctan2(begin[0] * end[1] - begin[1] * end[0], begin @ end)
    if abs(turn) < STRAIGHT:
        return None
    before, after = shapely.LineString(source), shapely.LineString(target)
    parts = [substring(before, max(before.length - LENGTH, 0.0), before.length),
             shapely.LineString(link.shape[:, :2]), substring(after, 0.0, LENGTH)]  # fmt: skip
    path = shapely.LineString(np.concatenate([shapely.get_coordinates(part) for part in parts]))
    along = np.arange(0.0, path.length, STEP)
    front = shapely.get_coordinates(shapely.line_interpolate_point(path, along))
    xy, heading, _ = bodies(front, np.full(len(front), np.arctan2(begin[1], begin[0])),
                            np.zeros(len(front), np.int64), np.array([LENGTH]))  # fmt: skip
    ahead = np.column_stack([np.cos(heading), np.sin(heading)]) * LENGTH / 2
    side = np.column_stack([-np.sin(heading), np.cos(heading)]) * HALF
    ring = np.stack([xy - ahead - side, xy + ahead - side, xy + ahead + side, xy - ahead + side],
                    axis=1)  # fmt: skip
    late = along >= min(LENGTH, parts[0].length)
    return shapely.union_all(shapely.polygons(ring[late]))
