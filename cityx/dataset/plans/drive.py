"""The plan "drive": what a camera on the roof of a car sees that drives along the lanes."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.city.lanes import MOVEMENTS, LaneGraph
from cityx.city.moments import moments_of
from cityx.city.roads import RoadNetwork
from cityx.city.routes import cars, lane_lengths
from cityx.dataset.plans.motion import along_line, headings, length_of, smoothed, speeds
from cityx.dataset.plans.plan_site import Site
from cityx.dataset.plans.street_stretches import stations
from cityx.dataset.plans.takes import Refusal, Source, Take
from cityx.errors import InputError
from cityx.geometry.arrays import FloatArray, IntArray
from cityx.geometry.polylines import to_linestrings, values_along
from cityx.ids import draw

FOV = 70.0  # degrees
EYE = 1.6  # metres above the lane: on the roof of a car
CLEAR = 1.0  # metres round the eye: half the width of the car that carries it
UNEVEN = 1.2  # metres by which the road may lie off the profile of its centreline
SPRINGS = 1.0  # metres of road over which a car's springs even it out
STEP = 0.5  # metres between the points of a way
ROUND = 1.5  # metres over which its corners are rounded
WHEELBASE = 2.7  # metres between the points whose direction is that of the car
LOOK = 25.0  # metres of way that are looked over beyond the last place
SIDEWAYS, FASTER, SLOWER = 2.0, 1.5, 2.0  # metres per second squared, as calm drivers drive
GAP, HEADWAY = 2.0, 1.4  # metres and seconds kept behind what drives ahead
FRONT = 2.2  # metres from the eye to the car's front
BESIDE = 0.9  # metres beside the way within which something is in it
SLOWEST = 3.0  # metres per second that a lane is driven at least
TICK = 0.05  # seconds, at most, of a step of the car


def drive(site: Site) -> Source:
    """Return the source of drives, which begin evenly along all lanes for cars.

    Raises
    ------
    InputError
        If no car can drive in the city.
    """
    city = site.city
    graph, network = city.lanes, city.network
    if graph is None or network is None or not cars(graph).any():
        raise InputError(f"nobody can drive in {city.name}: it has no lanes for cars.")
    lines = graph.lines
    length = lane_lengths(graph)
    places = stations(lines, np.flatnonzero(cars(graph) & (length > STEP)))
    edges = network.lines
    roads = _Roads(graph, network, to_linestrings(edges), *_next_lanes(graph))

    def candidates(numbers: IntArray) -> list[Take | Refusal]:
        lane, along = places.at(site.draws("drive", numbers, 1)[:, 0])
        moments = site.moments(numbers)
        rows = zip(numbers.tolist(), lane.tolist(), along.tolist(), moments.tolist(), strict=True)
        return [_take(site, roads, *row) for row in rows]

    return candidates


@dataclass(frozen=True)
class _Roads:
    """The lane graph, the lines of its edges, and the connections for cars by their first lane."""

    graph: LaneGraph
    network: RoadNetwork
    edges: NDArray[Any]
    connection: IntArray
    start: IntArray


@dataclass(frozen=True)
class _Way:
    """A way along lanes: (k, 2) points `STEP` apart, what is allowed there and how high it is."""

    points: FloatArray
    limit: FloatArray
    z: FloatArray


def _next_lanes(graph: LaneGraph) -> tuple[IntArray, IntArray]:
    open_to_cars = cars(graph)
    rows = np.flatnonzero(open_to_cars[graph.connection].all(axis=1))
    turned = graph.movement[rows] == MOVEMENTS.index("reverse")
    rows = rows[np.lexsort((turned, graph.connection[rows, 0]))]
    return rows, np.searchsorted(graph.connection[rows, 0], np.arange(graph.count + 1))


def _take(
    site: Site, roads: _Roads, number: int, lane: int, along: float, moment: float
) -> Take | Refusal:
    wishes = site.wishes
    fastest = float(roads.graph.speed.max()) / 3.6
    way = _way(site, roads, number, lane, along, fastest * wishes.seconds + LOOK)
    limit = speeds(way.points, way.limit, STEP, sideways=SIDEWAYS, faster=FASTER, slower=SLOWER)
    time = moment + np.arange(wishes.length) / wishes.rate
    place = _driven(site, way, limit, time)
    whole = STEP * (len(way.points) - 1)
    if place[-1] + WHEELBASE > whole:
        return Refusal("the way ends", f"after {whole:.0f} m at {way.points[-1].round(1).tolist()}")
    spot = along_line(way.points, place)
    ahead = along_line(way.points, place + WHEELBASE / 2)
    behind = along_line(way.points, np.maximum(place - WHEELBASE / 2, 0.0))
    steps = np.arange(len(way.z)) * STEP
    z = np.interp(place, steps, way.z)
    climb = np.interp(place, steps, np.gradient(way.z, STEP))
    return Take(
        np.column_stack([spot, z + EYE]), headings(ahead - behind), np.arctan(climb), time,
        wishes.fov(FOV), clearance=CLEAR, foot=EYE,
    )  # fmt: skip


def _way(
    site: Site, roads: _Roads, number: int, lane: int, along: float, needed: float
) -> _Way:  # fmt: skip
    """Follow lanes from a place on one, as if drawn at every junction."""
    graph = roads.graph
    parts, speed, own = [graph.lane_points(lane)], [_limit(graph, lane)], [int(graph.edge[lane])]
    length = length_of(parts[0]) - along
    turn = 0
    while length < needed:
        ways = roads.connection[roads.start[lane] : roads.start[lane + 1]]
        if not len(ways):
            break
        forth = ways[graph.movement[ways] != MOVEMENTS.index("reverse")]
        ways = forth if len(forth) else ways
        share = draw(site.wishes.seed, "dataset/drive", number, turn)
        row = int(ways[int(share * len(ways))])
        then = int(graph.connection[row, 1])
        curve = graph.curve[graph.curve_start[row] : graph.curve_start[row + 1]]
        for points, limit, edge in (
            (curve, min(speed[-1], _limit(graph, then)), -1),
            (graph.lane_points(then), _limit(graph, then), int(graph.edge[then])),
        ):
            parts.append(points)
            speed.append(limit)
            own.append(edge)
            length += length_of(points)
        lane, turn = then, turn + 1
    return _even(site, roads, parts, speed, own, along, needed)


def _limit(graph: LaneGraph, lane: int) -> float:
    return max(float(graph.speed[lane]) / 3.6, SLOWEST)


def _even(
    site: Site, roads: _Roads, parts: list[FloatArray], speed: list[float], own: list[int],
    along: float, needed: float,
) -> _Way:  # fmt: skip
    """Put the parts of a way together, smooth, with even steps."""
    points = np.concatenate(parts)
    part = np.repeat(np.arange(len(parts)), [len(p) for p in parts])
    gone = np.r_[0.0, np.cumsum(np.hypot(*np.diff(points, axis=0).T))]
    place = np.arange(along, min(gone[-1], along + needed), STEP)
    if len(place) < 2:
        place = np.array([max(gone[-1] - STEP, 0.0), gone[-1]])
    spot = along_line(points, place)
    of = part[np.clip(np.searchsorted(gone, place, side="right") - 1, 0, len(part) - 1)]
    z = np.full(len(place), np.nan)
    lines = roads.network.lines
    edge = np.array(own)[of]
    known = np.flatnonzero(edge >= 0)
    on = shapely.line_locate_point(roads.edges[edge[known]], shapely.points(spot[known]))
    z[known] = values_along(lines, roads.network.z, edge[known], on)
    z = np.interp(place, place[known], z[known]) if len(known) else np.zeros(len(place))
    spot = smoothed(spot, ROUND / STEP)
    return _Way(spot, np.array(speed)[of], smoothed(_settled(site, spot, z), SPRINGS / STEP))


def _settled(site: Site, spot: FloatArray, z: FloatArray) -> FloatArray:
    """(k,) heights of what lies under places at about some heights: the road as it is built."""
    eyes = np.column_stack([spot, z + EYE])
    down = np.broadcast_to([0.0, 0.0, -1.0], eyes.shape)
    off = EYE - site.stage.cast(eyes, down).distance
    return np.where(np.abs(off) < UNEVEN, z + off, z)


def _driven(site: Site, way: _Way, limit: FloatArray, time: FloatArray) -> FloatArray:
    """Return (f,) metres along a way at times; what drives ahead on it is followed.

    References
    ----------
    Treiber, Hennecke and Helbing, Phys. Rev. E 62, 2000 (the intelligent driver model).
    """
    steps = max(int(np.ceil((time[1] - time[0]) / TICK)), 1) if len(time) > 1 else 1
    fine = np.interp(np.arange((len(time) - 1) * steps + 1) / steps, np.arange(len(time)), time)
    ahead = _ahead(site, way, fine)
    metres = np.arange(len(limit)) * STEP
    place, speed = 0.0, -1.0
    found = np.zeros(len(fine))
    for tick in range(len(fine)):
        found[tick] = place
        wanted = float(np.interp(place, metres, limit))
        other = ahead[tick]
        front = place + FRONT
        rows = np.flatnonzero(other[:, 0] > place)
        gap, theirs = np.inf, 0.0
        if len(rows):
            first = rows[np.argmin(other[rows, 0])]
            gap, theirs = max(float(other[first, 0] - front), 0.1), float(other[first, 1])
        if speed < 0:
            speed = min(wanted, max(gap - GAP, 0.0) / HEADWAY)
        dt = float(fine[tick + 1] - fine[tick]) if tick + 1 < len(fine) else 0.0
        kept = GAP + max(
            speed * HEADWAY + speed * (speed - theirs) / (2 * (FASTER * SLOWER) ** 0.5), 0
        )
        push = FASTER * (1 - (speed / max(wanted, 0.1)) ** 4 - (kept / gap) ** 2)
        after = max(min(speed + push * dt, wanted if speed <= wanted else speed), 0.0)
        place += (speed + after) / 2 * dt
        speed = after
    return found[::steps]


def _ahead(site: Site, way: _Way, time: FloatArray) -> list[FloatArray]:
    """Return for each time (m, 2) metres along a way to the rears on it, and their speeds."""
    tracks = site.city.tracks
    none = np.zeros((0, 2))
    if tracks is None or not tracks.count:
        return [none] * len(time)
    there = moments_of(tracks, time)
    line = shapely.linestrings(way.points)
    half = tracks.size[there.mover].astype(float) / 2
    spots = shapely.points(there.position[:, :2])
    near = np.flatnonzero(shapely.distance(line, spots) < BESIDE + half[:, 1])
    along = shapely.line_locate_point(line, spots[near])
    # A step of one mover later tells its speed along the way.
    later = np.searchsorted(near, np.minimum(near + 1, len(there.mover) - 1))
    follows = (later < len(near)) & (near[np.minimum(later, len(near) - 1)] == near + 1)
    later = np.where(follows, later, np.arange(len(near)))
    follows &= there.mover[near[later]] == there.mover[near]
    gone = np.where(follows, there.time[near[later]] - there.time[near], 1.0)
    speed = np.where(follows, (along[later] - along) / np.maximum(gone, 1e-9), 0.0)
    rows = np.column_stack([along - half[near, 0], np.maximum(speed, 0.0)])
    order = np.argsort(there.number[near], kind="stable")
    start = np.searchsorted(there.number[near][order], np.arange(len(time) + 1))
    return [rows[order[a:b]] for a, b in pairwise(start.tolist())]
