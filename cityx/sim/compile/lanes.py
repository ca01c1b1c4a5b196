"""The pieces of a world: lanes and the ways across junctions that join them, with heights."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cityx.city.city import City
from cityx.geometry.arrays import BoolArray, FloatArray, IntArray
from cityx.traffic.streets import Link, Streets

SPACING = 1.0  # metres between the points of a piece, at most
LEAST = 0.05  # metres; points nearer to each other have no direction
DEAD_END = 3.5  # metres before the end of a street that the middle of a car does not reach
CURVE_SPEED = 2.0  # m/s2 sideways that drivers take in bends


@dataclass(frozen=True)
class Pieces:
    """n pieces, p points; lanes first, then the ways across junctions.

    Attributes
    ----------
    lane, onto
        (n,) uint64, the lane by `LaneGraph.lane_id`; of a way across the lanes it joins. `onto` is
        0 for lanes.
    link
        (n,) int64, row of ``Streets.links``, -1 for lanes.
    junction
        (n,) int32, of a way across, -1 for lanes.
    speed
        (n,) float64, m/s that may be driven; less in bends.
    half_width
        (n,) float64, metres.
    public, narrow
        (n,) bool: any car may drive there; those that come against it have the same ground.
    point_start
        (n + 1,) int64.
    point
        (p, 6) float64: x, y, z, heading (radians, unwrapped along a piece), metres from the start
        of the piece, metres above the ground.
    next_start, next
        (n + 1,) and (m,) int32: pieces that follow each.
    beside
        (n, 2) int32, of a lane those to the left and to the right of it that one may change to: of
        the same street and direction, with nothing between. -1 for none.
    """

    lane: NDArray[np.uint64]
    onto: NDArray[np.uint64]
    link: IntArray
    junction: NDArray[np.int32]
    speed: FloatArray
    half_width: FloatArray
    public: BoolArray
    narrow: BoolArray
    point_start: IntArray
    point: FloatArray
    next_start: NDArray[np.int32]
    next: NDArray[np.int32]
    beside: NDArray[np.int32]

    @property
    def count(self) -> int:
        """Number of pieces."""
        return len(self.lane)


def pieces_of(city: City, streets: Streets) -> Pieces:
    """Gather the pieces that cars drive along.

    Parameters
    ----------
    city
        With a lane graph.
    streets
        Its streets as a simulator knows them: lanes end where one halts.
    """
    graph = city.lanes
    assert graph is not None
    lanes = [(w, k) for w, way in enumerate(streets.ways) for k, lane in enumerate(way.lanes)
             if lane.kind == "drive" and not lane.closed and lane.length > LEAST]  # fmt: skip
    row_of = {key: row for row, key in enumerate(lanes)}
    links = [(row, link) for row, link in enumerate(streets.links)
             if link.source in row_of and link.target in row_of]  # fmt: skip
    of = [streets.ways[w].lanes[k] for w, k in lanes]
    ids = graph.lane_id[[lane.row for lane in of]] if of else np.zeros(0, np.uint64)
    source = np.array([row_of[link.source] for _, link in links], np.int64)
    target = np.array([row_of[link.target] for _, link in links], np.int64)
    entered, left = (np.isin(np.arange(len(lanes)), each) for each in (target, source))
    shapes = [_without_dead_ends(lane.shape, entered=into, left=out) for lane, into, out in
              zip(of, entered.tolist(), left.tolist(), strict=True)]  # fmt: skip
    shapes += [_joined(link, streets) for _, link in links]
    points = [_sampled(shape) for shape in shapes]
    point = np.concatenate([np.zeros((0, 5)), *points])
    ground = city.terrain.height_at(point[:, :2]) if len(point) else np.zeros(0)
    half = np.array([lane.width / 2 for lane in of])
    speed = np.array([max(lane.speed, 1.0) for lane in of])
    across = len(lanes) + np.arange(len(links))
    follow = np.concatenate([np.column_stack([source, across]), np.column_stack([across, target])])
    follow = follow[np.lexsort((follow[:, 1], follow[:, 0]))]
    count = len(lanes) + len(links)
    start = np.concatenate([[0], np.cumsum([len(each) for each in points])]).astype(np.int64)
    through = np.minimum(speed[source], speed[target])
    return Pieces(
        np.concatenate([ids, ids[source]]),
        np.concatenate([np.zeros(len(lanes), np.uint64), ids[target]]),
        np.concatenate([np.full(len(lanes), -1), [row for row, _ in links]]).astype(np.int64),
        np.array([-1] * len(lanes)
                 + [streets.ways[link.source[0]].target for _, link in links], np.int32),
        _bend_speed(np.concatenate([speed, through]), points),
        np.concatenate([half, np.minimum(half[source], half[target])]),
        np.array([lane.public for lane in of] + [True] * len(links), bool),
        np.array([lane.narrow for lane in of] + [False] * len(links), bool),
        start,
        np.column_stack([point, point[:, 2] - ground]),
        np.searchsorted(follow[:, 0], np.arange(count + 1)).astype(np.int32),
        follow[:, 1].astype(np.int32),
        np.concatenate([_beside(streets, row_of), np.full((len(links), 2), -1, np.int32)]),
    )  # fmt: skip


def _beside(streets: Streets, row_of: dict[tuple[int, int], int]) -> NDArray[np.int32]:
    """(n, 2) rows of the lanes to the left and to the right of each, where one may change."""
    found = np.full((len(row_of), 2), -1, np.int32)
    left, right = (1, 0) if streets.left_hand else (0, 1)
    for (w, k), row in row_of.items():
        inner = row_of.get((w, k + 1))
        if inner is None or streets.ways[w].apart[k]:
            continue
        found[row, left], found[inner, right] = inner, row
    return found


def _without_dead_ends(shape: FloatArray, *, entered: bool, left: bool) -> FloatArray:
    """Cut off the ends of a lane that nothing leads to or on from: the street ends there."""
    step = np.hypot(*np.diff(shape[:, :2], axis=0).T)
    along = np.r_[0.0, np.cumsum(step)]
    begin, end = (0.0 if entered else DEAD_END), along[-1] - (0.0 if left else DEAD_END)
    if (entered and left) or end - begin < DEAD_END:
        return shape
    inside = (along > begin + LEAST) & (along < end - LEAST)
    at = np.r_[begin, along[inside], end]
    return np.column_stack([np.interp(at, along, shape[:, axis]) for axis in range(3)])


def _joined(link: Link, streets: Streets) -> FloatArray:
    """(k, 3) shape of a way across, from the very end of one lane to the start of the next."""
    ends = [streets.ways[way].lanes[lane].shape for way, lane in (link.source, link.target)]
    return np.concatenate([ends[0][-1:], link.shape[1:-1], ends[1][:1]])


def _sampled(shape: FloatArray) -> FloatArray:
    """(k, 5) points along a line at most `SPACING` apart: x, y, z, heading and metres along."""
    step = np.hypot(*np.diff(shape[:, :2], axis=0).T)
    shape = shape[np.r_[True, step > LEAST / 2]]
    along = np.r_[0.0, np.cumsum(np.hypot(*np.diff(shape[:, :2], axis=0).T))]
    count = max(int(np.ceil(along[-1] / SPACING)), 1) + 1
    at = np.linspace(0.0, along[-1], count)
    xyz = np.column_stack([np.interp(at, along, shape[:, axis]) for axis in range(3)])
    way = np.diff(xyz[:, :2], axis=0)
    edge = np.unwrap(np.arctan2(way[:, 1], way[:, 0]))
    heading = np.r_[edge[0], (edge[:-1] + edge[1:]) / 2, edge[-1]]
    return np.column_stack([xyz, heading, at])


def _bend_speed(speed: FloatArray, points: list[FloatArray]) -> FloatArray:
    """(n,) speeds that keep to `CURVE_SPEED` where pieces bend most."""
    found = speed.copy()
    for row, each in enumerate(points):
        reach = max(each[-1, 4], LEAST)
        span = max(1, round(3.0 / SPACING))
        if len(each) > span:
            turn = np.abs(each[span:, 3] - each[:-span, 3]) / (each[span:, 4] - each[:-span, 4])
            bend = float(turn.max())
        else:
            bend = abs(float(each[-1, 3] - each[0, 3])) / reach
        found[row] = min(speed[row], max(np.sqrt(CURVE_SPEED / max(bend, 1e-6)), 2.0))
    return found
