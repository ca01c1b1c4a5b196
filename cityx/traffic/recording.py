"""Poses of SUMO as tracks of the city: middles of bodies, on the street, with few samples."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.city.city import City
from cityx.city.ground import KERB_HEIGHT, LABEL
from cityx.city.moments import moments_of
from cityx.city.tracks import GAIT, MOVER, Tracks, no_tracks
from cityx.geometry.arrays import BoolArray, FloatArray, IntArray
from cityx.geometry.polylines import Polylines, bends, to_linestrings, values_along
from cityx.ground.standing import stand_on, surfaces_at
from cityx.traffic.kerbside import asides, kept_aside
from cityx.traffic.making_way import Bodies, beside, interpolated, made_way, standing_by
from cityx.traffic.network import Network
from cityx.traffic.simulation import STEP, Poses
from cityx.traffic.streets import Streets

# What wheels are never on; else they are on the ground, the walks and lawns of corners included.
_NOT_RIDDEN = [LABEL[name] for name in ("building", "water", "void", "rail", "railway")]
SLACK = 0.005  # metres that samples left out may differ by; two neighbours add up to a centimetre
TURNED = 0.01  # radians that count as much
FASTER = 0.1  # metres per second that count as much
STOREY = 1.5  # metres within which a deck is the one a vehicle is on
SAME = 1e-6  # metres
STANDING, RUNS = 0.1, 2.2  # metres per second from which on somebody walks, and runs
SPREAD = 1e4  # by which time is drawn out, so that a slack across the line is one of the value


@dataclass(frozen=True)
class Mover:
    """What is seen of a mover; as of `cityx.city.tracks.Tracks`."""

    kind: int
    look: str
    size: tuple[float, float, float]
    tint: FloatArray


def recorded(
    city: City, streets: Streets, network: Network, poses: Poses,
    movers: Mapping[str, Mover], origin: str, others: Tracks | None = None,
) -> Tracks:  # fmt: skip
    """Make tracks of the movers among poses.

    Parameters
    ----------
    city
        Where they drive.
    streets, network
        The streets and the network they were simulated on.
    poses
        Where they were.
    movers
        What is seen of each, by name.
    origin
        Id of the action that puts them there.
    others
        What moves there already; it makes no way for these, None for nothing.
    """
    assert city.lanes is not None
    # The way that movers have come before the tracks begin tells how they lie in bends.
    begun = np.unique(poses.mover[poses.time >= 0.0])
    known = np.array([name in movers for name in poses.name.tolist()], bool)
    known[np.setdiff1d(np.arange(len(known)), begun)] = False
    kept = known[poses.mover]
    mover = poses.mover[kept]
    if not len(mover):
        return no_tracks()
    rows, mover = np.unique(mover, return_inverse=True)
    about = [movers[str(poses.name[row])] for row in rows.tolist()]
    size = np.array([each.size for each in about], np.float32).reshape(-1, 3)
    on_foot = np.array([each.kind == MOVER["pedestrian"] for each in about], bool)
    # Of people SUMO tells where their middle is, of vehicles where their foremost point is.
    length = np.where(on_foot, 0.0, size[:, 0].astype(float))
    xy, heading, middle = bodies(poses.xy[kept], poses.angle[kept], mover, length)
    edge, place = _lanes(city, streets, network, poses, kept)
    place, edge, time, speed = place[middle], edge[middle], poses.time[kept], poses.speed[kept]
    cycling = np.array([each.kind == MOVER["bicycle"] for each in about], bool)[mover]
    if cycling.any():
        wanted = asides(city.lanes, streets, network, poses.lane_names)[poses.lane[kept][middle]]
        xy[cycling], heading[cycling] = kept_aside(
            xy[cycling], heading[cycling], mover[cycling], wanted[cycling]
        )
    z = _heights(city, xy, mover, edge)
    position, heading = np.column_stack([xy, z]), _unwound(heading, mover)
    if not on_foot.all():
        at, aside = _made_way(mover, time, position, heading, size, on_foot, others)
        position, heading, speed = (interpolated(values, at) for values in
                                    (position, heading, speed))  # fmt: skip
        position = beside(position, heading, aside)
        place = place[at.astype(np.int64)]
    now = time >= 0.0
    mover, time, position, heading, speed, place = (
        values[now] for values in (mover, time, position, heading, speed, place)
    )
    walking = on_foot[mover]
    footing = stand_on(city.scene.meshes.get("ground"), position[walking, :2]).z
    position[walking, 2] = np.where(np.isnan(footing), position[walking, 2] + KERB_HEIGHT, footing)
    place[walking] = 0
    few = thinned(mover, time, position, heading, speed)
    few |= np.r_[True, place[1:] != place[:-1]] if len(place) else few
    start = np.searchsorted(mover[few], np.arange(len(rows) + 1)).astype(np.int64)
    ids = np.array([int(name, 16) for name in poses.name[rows].tolist()], np.uint64)
    tracks = Tracks(
        ids,
        np.array([each.kind for each in about], np.uint8),
        np.array([each.look for each in about], dtype=str),
        np.array([origin] * len(about), dtype=str),
        np.array([each.tint for each in about], np.float32).reshape(-1, 3),
        size,
        start,
        time[few],
        np.round(position[few], 4),
        np.round(heading[few], 5),
        np.round(speed[few], 3).astype(np.float32),
        _gaits(walking, speed)[few],
        place[few],
    )
    return tracks.take(np.argsort(ids))


def _made_way(
    mover: IntArray, time: FloatArray, position: FloatArray, heading: FloatArray,
    size: NDArray[np.float32], on_foot: BoolArray, others: Tracks | None,
) -> tuple[FloatArray, FloatArray]:  # fmt: skip
    """(p,) rows between which movers are, once vehicles have made way, and metres aside."""
    begun = float(time.min())
    step = np.rint((time - begun) / STEP).astype(np.int64)
    first = max(round(-begun / STEP), 0)
    held = None
    if others is not None and others.count:
        moments = moments_of(others, np.arange(int(step.max()) - first + 1) * STEP)
        held = standing_by(replace(moments, number=moments.number + first), others.size,
                           others.on_foot)  # fmt: skip
    half = size[:, :2].astype(float) / 2
    driving = np.flatnonzero(~on_foot[mover])
    bodies_ = Bodies(mover[driving], step[driving], position[driving], heading[driving],
                     half[mover[driving]])  # fmt: skip
    at, aside = np.arange(len(mover), dtype=float), np.zeros(len(mover))
    row, aside[driving] = made_way(bodies_, first, held)
    at[driving] = interpolated(driving.astype(float), row)
    return at, aside


def _gaits(walking: BoolArray, speed: FloatArray) -> NDArray[np.uint8]:
    on_foot = np.where(speed < STANDING, GAIT["still"], np.where(speed < RUNS, GAIT["walk"],
                                                                 GAIT["run"]))  # fmt: skip
    return np.where(walking, on_foot, GAIT["ride"]).astype(np.uint8)


def bodies(
    front: FloatArray, angle: FloatArray, mover: IntArray, length: FloatArray
) -> tuple[FloatArray, FloatArray, IntArray]:
    """Return where bodies are whose foremost points follow a path.

    A body is a chord of the path. In a bend its driver swings out, so that its middle leaves the
    path to the inside no more than its ends do to the outside.

    Parameters
    ----------
    front
        (p, 2) float64, foremost points, ordered by mover and time.
    angle
        (p,) float64, headings where the path behind is not known yet.
    mover
        (p,) int64, ascending.
    length
        (m,) float64, metres, of each mover.

    Returns
    -------
    xy, heading
        (p, 2) and (p,) float64, of their middles.
    passed
        (p,) int64, the pose in which the foremost point was where the middle is.
    """
    size = length[mover]
    ahead = np.column_stack([np.cos(angle), np.sin(angle)])
    straight = front - ahead * size[:, None] / 2
    step = np.r_[0.0, np.hypot(*np.diff(front, axis=0).T)]
    first = np.r_[True, np.diff(mover) != 0] if len(mover) else np.zeros(0, bool)
    # Movers follow each other on one axis, farther apart than any of them is long.
    step[first] = length.max(initial=0.0) + 1.0
    gone = np.cumsum(step)
    begin = np.repeat(gone[first], np.diff(np.r_[np.flatnonzero(first), len(gone)]))
    known = gone - begin >= size
    passed = np.searchsorted(gone, np.maximum(gone - size / 2, begin) - SAME)
    if not known.any():
        return straight, angle, passed
    middle, back = (
        np.column_stack([np.interp(gone - share * size, gone, front[:, axis]) for axis in (0, 1)])
        for share in (0.5, 1.0)
    )
    chord = front - back
    xy = np.where(known[:, None], ((front + back) / 2 + middle) / 2, straight)
    return xy, np.where(known, np.arctan2(chord[:, 1], chord[:, 0]), angle), passed


def thinned(
    mover: IntArray, time: FloatArray, position: FloatArray, heading: FloatArray, speed: FloatArray
) -> BoolArray:
    """(p,) samples between which every mover goes straight, turns and quickens evenly."""
    count = int(mover.max(initial=-1)) + 1
    start = np.searchsorted(mover, np.arange(count + 1)).astype(np.int64)
    lone = np.diff(start) < 2
    axis = Polylines(np.column_stack([time * SPREAD, np.zeros(len(time))]), start)
    if lone.any():  # a line has two points
        kept = np.ones(len(time), bool)
        many = ~lone[mover]
        again = np.unique(mover[many], return_inverse=True)[1]
        if many.any():
            kept[many] = thinned(again, time[many], position[many], heading[many], speed[many])
        return kept
    values = np.column_stack([position, heading * (SLACK / TURNED), speed * (SLACK / FASTER)])
    return bends(axis, values, SLACK)


def _unwound(heading: FloatArray, mover: IntArray) -> FloatArray:
    """Unwrap headings beyond a full turn, for each mover."""
    if not len(heading):
        return heading
    step = np.diff(heading)
    turn = np.remainder(step + np.pi, 2 * np.pi) - np.pi
    turn[np.diff(mover) != 0] = 0.0
    gone = np.r_[0.0, np.cumsum(turn)]
    first = np.r_[0, np.flatnonzero(np.diff(mover)) + 1]
    base = heading[first] - gone[first]
    return np.asarray(gone + np.repeat(base, np.diff(np.r_[first, len(heading)])))


def _lanes(
    city: City, streets: Streets, network: Network, poses: Poses, kept: BoolArray
) -> tuple[IntArray, NDArray[np.uint64]]:
    """(p, 2) edges behind and ahead, -1 for none, and (p,) ids of lanes, 0 across a junction."""
    assert city.lanes is not None
    behind = np.full(len(poses.lane_names), -1, np.int64)
    ahead = behind.copy()
    ids = np.zeros(len(behind), np.uint64)
    for number, name in enumerate(poses.lane_names.tolist()):
        if name in network.lanes:
            way, index = network.lanes[name]
            behind[number] = ahead[number] = streets.ways[way].edge
            ids[number] = city.lanes.lane_id[streets.ways[way].lanes[index].row]
        elif name in network.links:
            link = streets.links[network.links[name]]
            behind[number] = streets.ways[link.source[0]].edge
            ahead[number] = streets.ways[link.target[0]].edge
    lane = poses.lane[kept]
    return np.column_stack([behind[lane], ahead[lane]]), ids[lane]


def _heights(city: City, xy: FloatArray, mover: IntArray, edge: IntArray) -> FloatArray:
    """(p,) heights of the street under places; off the ground those of the street they are on."""
    network = city.network
    assert network is not None
    z = city.terrain.height_at(xy)
    footing = stand_on(city.scene.meshes.get("ground"), xy)
    # The mesh of the ground is coarser than the terrain; and who cuts a corner rides up the kerb.
    ridden = np.isfinite(footing.z) & ~np.isin(footing.label, _NOT_RIDDEN)
    z = np.where(ridden, footing.z, z)
    lines = network.lines
    owner = lines.line_of_point()
    lifted = np.zeros(network.edge_count, bool)
    lifted[owner[network.lift != 0.0]] = True
    if not lifted.any() or not len(xy):
        return z
    # The middle of a vehicle may still be on the street that its front has left.
    left = np.r_[-1, np.where(edge[1:, 0] != edge[:-1, 0], edge[:-1, 0], -1)]
    left[np.r_[True, np.diff(mover) != 0]] = -1
    shapes = to_linestrings(lines)
    last = _carried(left, mover)
    nearest = np.full(len(xy), np.inf)
    for candidate in (edge[:, 0], edge[:, 1], last):
        rows = np.flatnonzero(candidate >= 0)
        rows = rows[(lifted[candidate] | lifted[edge[:, 0]] | lifted[edge[:, 1]])[rows]]
        own, spots = candidate[rows], shapely.points(xy[rows])
        off = shapely.distance(shapes[own], spots)
        along = shapely.line_locate_point(shapes[own], spots)
        height = values_along(lines, network.z, own, along)
        up = values_along(lines, network.lift, own, along) != 0.0
        better = off < nearest[rows] - 1e-9
        nearest[rows[better]] = off[better]
        z[rows[better]] = np.where(up, height, z[rows])[better]
    return _on_decks(city, xy, z, np.flatnonzero(np.isfinite(nearest)))


def _on_decks(city: City, xy: FloatArray, z: FloatArray, rows: IntArray) -> FloatArray:
    """(p,) heights, of some places those of the deck that lies there at about that height."""
    decks = city.scene.meshes.get("decks")
    if decks is None or not len(rows):
        return z
    spot, height = surfaces_at(decks, xy[rows])
    off = np.abs(height - z[rows[spot]])
    order = np.lexsort((off, spot))
    order = order[off[order] < STOREY]
    first = order[np.r_[True, np.diff(spot[order]) != 0]] if len(order) else order
    found = z.copy()
    found[rows[spot[first]]] = height[first]
    return found


def _carried(values: IntArray, mover: IntArray) -> IntArray:
    """Carry the last value that is none of -1 on, within each mover."""
    place = np.where(values >= 0, np.arange(len(values)), 0)
    place = np.maximum.accumulate(place)
    same = mover[place] == mover
    return np.where(same, values[place], -1)
