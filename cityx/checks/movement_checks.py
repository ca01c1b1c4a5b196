"""Checks of vehicles and pedestrians: on lane or walk, collisions, ground contact, signals.

All are measured on the tracks as every view shows them, twice a second, and against the finished
ground and scene, whatever made the tracks.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.checks.check import Check, named
from cityx.city import City
from cityx.city.ground import ON_ROADWAY, ROADWAY
from cityx.city.lanes import LaneGraph
from cityx.city.moments import Moments, moments_of
from cityx.city.signals import STATE, Signals, states_at
from cityx.city.tracks import AT_REST, MOVER, Tracks, travelled
from cityx.geometry.arrays import BoolArray, FloatArray, IntArray
from cityx.geometry.polylines import Polylines, to_linestrings
from cityx.ground.standing import stand_on, surfaces_at
from cityx.ground.walking.crosswalks import heads_of
from cityx.ground.walking.walkable import walk_areas

EVERY = 0.5  # seconds between the moments that are looked at
YARDS = ("parking", "apron")  # driven on beside the roadways
BESIDE = 0.3  # metres past the edge of its lane that the middle of a vehicle may be
OFF_WALK = 0.1  # metres past the edge of the walkable area that the middle of a person may be
TOUCH = 0.05  # metres by which outlines may reach into each other
BREAST = 0.17  # metres from the middle of a person to what never yields: half the depth of the body
IN_WALL = 0.1  # metres that an outline may reach into a house
OFF_GROUND = 0.05  # metres between feet or wheels and what they are on
REACH = 0.25  # metres about the middle of a person where the feet are
STUCK_FOR, STUCK_WITHIN = 60.0, 2.0  # seconds that something stays within so many metres
LOOK = 5.0  # seconds between the moments at which it is looked whether something gets on
FASTEST = {True: 8.0, False: 70.0}  # metres per second, on foot and driving
PULL = 15.0  # metres per second squared by which a speed may change between two samples
SHARE = 0.01  # of the movers that may be stuck or taken up
RED = (STATE["red"], STATE["red_yellow"])
REACTION = 1.0  # seconds of red after which whoever starts has seen it


@dataclass(frozen=True)
class Scene:
    """A city with its tracks at the moments that are looked at."""

    city: City
    tracks: Tracks
    at: Moments

    @cached_property
    def walks(self) -> BoolArray:
        """(m,) whether each is on foot."""
        return np.asarray(self.foot[self.at.mover])

    @cached_property
    def foot(self) -> BoolArray:
        """(n,) whether each mover is on foot."""
        return self.tracks.on_foot

    @cached_property
    def points(self) -> NDArray[Any]:
        """(m,) middles as points."""
        return np.asarray(shapely.points(self.at.position[:, :2]), object)

    @cached_property
    def outlines(self) -> NDArray[Any]:
        """(m,) what each takes up of the ground: boxes of vehicles, and discs of people."""
        found = self.at.boxes(self.tracks.size, -TOUCH / 2)
        found[self.walks] = shapely.buffer(self.points[self.walks], BREAST, quad_segs=4)
        return found

    def ids(self, rows: BoolArray | IntArray) -> tuple[str, ...]:
        """Return ids of the movers of some moments."""
        return named(self.tracks.object_id[self.at.mover[rows]])


def check_movement(city: City) -> list[Check]:
    """Run every check on what moves; none where nothing does."""
    tracks = city.tracks
    if tracks is None or not tracks.count:
        return []
    times = np.arange(0.0, tracks.duration + EVERY / 2, EVERY)
    scene = Scene(city, tracks, moments_of(tracks, times))
    total = max(len(scene.at.mover), 1)
    off_lane, off_walk = off_lanes(scene), off_walks(scene)
    met, housed = overlapping(scene), in_buildings(scene)
    jumped, stuck = jumping(tracks), stuck_movers(tracks)
    floating, red = off_ground(scene), red_runners(city)
    return [
        Check("vehicles_off_lane", float(off_lane.sum()), 0,
              f"moments, of {total:,}, at which the middle of a vehicle is past the edge of its "
              "lane and of every way across a junction", ids=scene.ids(off_lane)),
        Check("pedestrians_off_walkable", float(off_walk.sum()), 0,
              f"moments, of {total:,}, at which a person is off every sidewalk, path, plaza, park "
              "and crosswalk", ids=scene.ids(off_walk)),
        Check("movers_overlapping", float(len(met)), 0,
              "pairs of movers and moments at which one is in the other",
              ids=scene.ids(met.ravel())),
        Check("movers_in_buildings", float(housed.sum()), 0,
              f"moments at which a mover reaches over {IN_WALL} m into a building",
              ids=scene.ids(housed)),
        Check("movers_off_ground", float(floating.sum()), 0,
              f"moments at which feet or wheels are over {OFF_GROUND} m above or below what they "
              "are on", ids=scene.ids(floating)),
        Check("ran_red", float(red.sum()), 0,
              "movers that pass a signal which has shown red for a second",
              ids=named(tracks.object_id[red])),
        Check("movers_teleported", float(jumped.mean()), SHARE,
              "share of the movers that get on faster than they can",
              ids=named(tracks.object_id[jumped])),
        Check("movers_stuck", float(stuck.mean()), SHARE,
              f"share of the movers that stay within {STUCK_WITHIN:g} m for {STUCK_FOR:g} s and do "
              "not merely stand", ids=named(tracks.object_id[stuck])),
    ]  # fmt: skip


def off_lanes(scene: Scene) -> BoolArray:
    """(m,) vehicles whose middle is past the edge of their lane.

    Who is in no lane, or on the way from one to another, must be on a way across a junction or in
    some lane; who never is in one, as on a drawn curve, on a roadway.
    """
    off = np.zeros(len(scene.at.mover), bool)
    graph, ground = scene.city.lanes, scene.city.ground
    driving = np.flatnonzero(~scene.walks)
    if graph is None or not graph.count or not len(driving):
        return off
    lanes, half = _lane_lines(graph)
    place = scene.at.place[driving]
    order = np.argsort(graph.lane_id)
    own = order[np.minimum(np.searchsorted(graph.lane_id[order], place), graph.count - 1)]
    known = (graph.lane_id[own] == place) & (place == scene.at.onto[driving])
    # By its front a vehicle is in a lane before its middle is, and out of it as well.
    along = shapely.line_locate_point(lanes[own], scene.points[driving])
    known &= (along > 0) & (along < shapely.length(lanes[own]))
    far = shapely.distance(scene.points[driving[known]], lanes[own[known]])
    off[driving[known]] = far > half[own[known]] + BESIDE
    between = driving[~known]
    lines = np.concatenate([lanes, to_linestrings(Polylines(graph.curve, graph.curve_start))])
    reach = np.concatenate([half, half[graph.connection].max(axis=1)]) + BESIDE
    near = shapely.STRtree(scene.points[between]).query(
        lines, predicate="dwithin", distance=reach
    )[1]  # fmt: skip
    left = np.setdiff1d(between, between[near])
    if ground is not None:
        in_lanes = np.zeros(scene.tracks.count, bool)
        in_lanes[scene.tracks.mover[scene.tracks.place > 0]] = True
        free = ~in_lanes[scene.at.mover[left]]
        free[free] = ground.on(scene.at.position[left[free], :2], *ROADWAY, *ON_ROADWAY, *YARDS)
        left = left[~free]
    off[left] = True
    return off


def _lane_lines(graph: LaneGraph) -> tuple[NDArray[Any], FloatArray]:
    """(l,) middles of lanes and half their widths."""
    lines = to_linestrings(graph.lines)
    return lines, np.abs(graph.left - graph.right) / 2


def off_walks(scene: Scene) -> BoolArray:
    """(m,) people who are on no surface that is walked on, and on no crosswalk."""
    off = np.zeros(len(scene.at.mover), bool)
    walking = np.flatnonzero(scene.walks)
    if not len(walking) or scene.city.ground is None or scene.city.network is None:
        return off
    area = shapely.buffer(walk_areas(scene.city).areas, OFF_WALK, quad_segs=2)
    inside = shapely.STRtree(scene.points[walking]).query(area, predicate="intersects")[1]
    left = np.setdiff1d(np.arange(len(walking)), inside)
    parks = ("park", "grass", "meadow", "courtyard", "playground", "pitch", "sand")
    left = left[~scene.city.ground.on(scene.at.position[walking[left], :2], *parks)]
    off[walking[left]] = True
    return off


def overlapping(scene: Scene) -> IntArray:
    """(k, 2) rows of moments, one and the other, at which two movers are in one another."""
    # The moments lie apart from each other in the plane, so that one search serves all of them.
    west, _, east, _ = scene.city.layout.extent
    shift = scene.at.number * (2.0 * (east - west) + 1000.0)
    outlines = scene.outlines
    apart = np.repeat(shift, shapely.get_num_coordinates(outlines))
    points = shapely.get_coordinates(outlines)
    points[:, 0] += apart
    moved = shapely.set_coordinates(outlines.copy(), points)
    one, other = shapely.STRtree(moved).query(moved, predicate="intersects")
    pair = np.column_stack([one, other])[one < other]
    level = np.abs(np.diff(scene.at.position[pair, 2], axis=1)[:, 0]) < 2.0  # not over a bridge
    return np.asarray(pair[level])


def in_buildings(scene: Scene) -> BoolArray:
    """(m,) movers that reach into a house on the ground, not those in its passages."""
    ground = scene.city.ground
    found = np.zeros(len(scene.at.mover), bool)
    if ground is None:
        return found
    built = shapely.polygons(ground.vertices[ground.triangles_of("building")])
    if not len(built):
        return found
    low = scene.city.terrain.height_at(scene.at.position[:, :2])
    level = np.flatnonzero(np.abs(scene.at.position[:, 2] - low) < 2.0)  # not above, nor below
    cores = shapely.buffer(scene.outlines[level], -IN_WALL)
    found[level[shapely.STRtree(built).query(cores, predicate="intersects")[0]]] = True
    return found


def off_ground(scene: Scene) -> BoolArray:
    """(m,) movers that are on no surface at their height, neither of the ground nor of a deck."""
    position = scene.at.position
    long = scene.tracks.size[scene.at.mover, 0].astype(float)
    reach = np.where(scene.walks, REACH, long / 2)
    ahead = np.column_stack([np.cos(scene.at.heading), np.sin(scene.at.heading)])
    side = np.column_stack([-ahead[:, 1], ahead[:, 0]])
    # A foot, or an axle, is on the ground though the middle is over a kerb or a crest.
    gap = np.full(len(position), np.inf)
    for along, across in ((0.0, 0.0), (1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0)):
        spread = np.where(scene.walks, REACH, 0.0) * across
        spots = position[:, :2] + ahead * (along * reach)[:, None] + side * spread[:, None]
        z = stand_on(scene.city.scene.meshes.get("ground"), spots).z
        gap = np.fmin(gap, np.abs(position[:, 2] - z))
    for layer in ("decks", "structures"):
        batch = scene.city.scene.meshes.get(layer)
        left = np.flatnonzero(gap > OFF_GROUND)
        if batch is not None and batch.count and len(left):
            spot, height = surfaces_at(batch, position[left, :2])
            np.fmin.at(gap, left[spot], np.abs(position[left[spot], 2] - height))
    slack = np.where(scene.walks, OFF_GROUND, np.maximum(OFF_GROUND, 0.02 * long))
    west, south, east, north = scene.city.layout.extent
    x, y = position[:, 0], position[:, 1]
    inside = (x > west) & (x < east) & (y > south) & (y < north)  # beyond there is no ground
    return np.asarray((gap > slack) & inside)


def jumping(tracks: Tracks) -> BoolArray:
    """(n,) movers that are somewhere else at once, or faster than anything of their kind."""
    jumps = np.zeros(tracks.count, bool)
    if len(tracks.time) < 2:
        return jumps
    mover = tracks.mover
    same = mover[1:] == mover[:-1]
    gap = np.diff(tracks.time)[same]
    way = np.hypot(*np.diff(tracks.position[:, :2], axis=0)[same].T)
    foot = tracks.on_foot[mover[1:][same]]
    most = np.where(foot, FASTEST[True], FASTEST[False]) * gap + TOUCH
    jumps[mover[1:][same][(way > most) | (gap <= 0)]] = True
    return jumps


def stuck_movers(tracks: Tracks) -> BoolArray:
    """(n,) movers that want to get on and do not; those who stand throughout are no such."""
    stuck = np.zeros(tracks.count, bool)
    found = moments_of(tracks, np.arange(0.0, tracks.duration + 1.0, LOOK))
    size = round(STUCK_FOR / LOOK) + 1
    if len(found.mover) < size:
        return stuck
    held = np.lib.stride_tricks.sliding_window_view(found.position[:, :2], size, axis=0)
    near = np.hypot(*np.ptp(held, axis=2).T) < STUCK_WITHIN
    same = found.mover[size - 1 :] == found.mover[: len(near)]
    stuck[found.mover[: len(near)][near & same]] = True
    stands = np.ones(tracks.count, bool)
    stands[tracks.mover[~np.isin(tracks.gait, AT_REST)]] = False
    return np.asarray(stuck & ~stands)


def red_runners(city: City) -> BoolArray:
    """Return (n,) which movers pass a signal head that has shown red for a while.

    A vehicle passes between its last sample on the lane and the next; it runs the light when the
    head is red from before the first to the second.
    """
    tracks, signals = city.tracks, city.signals
    if tracks is None:
        return np.zeros(0, bool)
    runs = np.zeros(tracks.count, bool)
    if signals is None or not signals.count:
        return runs
    for mover, head, begin, end in (*_passing(tracks, signals), *_stepping(city, tracks, signals)):
        times = np.append(np.arange(begin - REACTION, end, EVERY), end)
        if all(states_at(signals, max(t, 0.0))[head] in RED for t in times.tolist()):
            runs[mover] = True
    return runs


def _passing(tracks: Tracks, signals: Signals) -> list[tuple[int, int, float, float]]:
    """Mover, head, and between which times it passes it, of every vehicle that leaves a lane."""
    place, mover = tracks.place, tracks.mover
    here = np.flatnonzero((place[:-1] > 0) & (place[1:] != place[:-1]) & (mover[1:] == mover[:-1]))
    # The lane that it comes to may be some samples ahead.
    known = np.where(place > 0, np.arange(len(place)), len(place))
    ahead = np.minimum.accumulate(known[::-1])[::-1]
    key = {(int(a), int(b)): row for row, (a, b) in enumerate(zip(signals.lane, signals.onto,
                                                                  strict=True)) if a}  # fmt: skip
    gone = travelled(tracks)
    found = []
    for at in here.tolist():
        there = int(ahead[at + 1])
        if there < len(place) and mover[there] == mover[at]:
            head = key.get((int(place[at]), int(place[there])))
            if head is not None:
                found.append((int(mover[at]), head, *_front_over(tracks, gone, at)))
    return found


def _front_over(tracks: Tracks, gone: FloatArray, at: int) -> tuple[float, float]:
    """Return the times between which the front passes where the middle is at a sample or after.

    Who obeys does so by the front; slow, its middle is past the line some seconds later.
    """
    mover = tracks.mover[at]
    own = slice(tracks.sample_start[mover], tracks.sample_start[mover + 1])
    places = gone[[at, at + 1]] - float(tracks.size[mover, 0]) / 2
    rises = np.r_[True, np.diff(gone[own]) > 0]  # who stands is where it is until it goes on
    begin, end = np.interp(places, gone[own][rises], _last_there(tracks.time[own], rises))
    return float(begin), float(end)


def _last_there(time: FloatArray, rises: BoolArray) -> FloatArray:
    """Return of every place that was reached when it was left."""
    last = np.r_[np.flatnonzero(rises)[1:] - 1, len(time) - 1]
    return np.asarray(time[last])


def _stepping(city: City, tracks: Tracks, signals: Signals) -> list[tuple[int, int, float, float]]:
    """Return the same of every person who steps onto a crosswalk that signals rule."""
    foot = np.flatnonzero(tracks.kind == MOVER["pedestrian"])
    if city.ground is None or city.network is None or not len(foot):
        return []
    area = walk_areas(city)
    head = heads_of(area.crosswalks, signals)
    found = moments_of(tracks.take(foot), np.arange(0.0, tracks.duration + EVERY / 2, EVERY))
    over = np.zeros(len(found.mover), np.int64)
    spot, crosswalk = shapely.STRtree(area.over).query(
        shapely.points(found.position[:, :2]), predicate="intersects"
    )
    over[spot] = crosswalk + 1
    steps = np.flatnonzero(
        (over[1:] > 0) & (over[:-1] == 0) & (found.mover[1:] == found.mover[:-1])
    )
    ruled = head[over[steps + 1] - 1]
    return [
        (int(foot[found.mover[at]]), int(row), float(found.time[at]), float(found.time[at + 1]))
        for at, row in zip(steps.tolist(), ruled.tolist(), strict=True)
        if row >= 0
    ]
