"""Recorded movers of a city as obstacles of a new run."""

from __future__ import annotations

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.city.tracks import MOVER, MOVER_KINDS, Tracks, poses_at
from cityx.ids import id_text
from cityx.traffic.kinds import DRIVING
from cityx.traffic.network import Network
from cityx.traffic.simulation import Ghosts, Look, Run, type_text
from cityx.traffic.streets import Streets

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

HELD = 5.0  # seconds before the tracks begin in which everything is already where it begins
NEAR_CROSSING = 1.0  # metres from a crossing at which vehicles wait for who is about to walk


def ghosts_of(tracks: Tracks | None, streets: Streets, network: Network, run: Run) -> Ghosts | None:
    """Return movers as obstacles of a run; None for nothing.

    Of people those are kept who walk over crossings: nobody drives where the others walk.
    """
    if tracks is None:
        return None
    driven = np.isin(tracks.kind, [MOVER[kind] for kind in DRIVING])
    walks = tracks.kind == MOVER["pedestrian"]
    tracks = tracks.take(driven | walks)
    if not tracks.count:
        return None
    walks = tracks.kind == MOVER["pedestrian"]
    looks = [_look(tracks, row) for row in range(tracks.count)]
    types = sorted({type_text(look) for look in looks if look is not None})
    # Of crossings that the network has left out SUMO knows nothing.
    held = sorted((number, edge) for edge, number in network.crossings.items())
    crossings = [streets.crossings[number] for number, _ in held]
    areas = [shapely.LineString(crossing.shape[:, :2]).buffer(crossing.width / 2 + NEAR_CROSSING)
             for crossing in crossings]  # fmt: skip
    tree = shapely.STRtree(areas)
    steps = round((run.warm + run.duration) / run.step) + 1
    first = round((run.warm - HELD) / run.step)
    parts: list[FloatArray] = []
    start = np.zeros(steps + 1, np.int64)
    for step in range(steps):
        if step >= first:
            found = _at(tracks, walks, tree, max(0.0, step * run.step - run.warm))
            parts.append(found)
            start[step + 1] = start[step] + len(found)
    rows = np.concatenate([np.zeros((0, 5)), *parts])
    edges = np.array([edge for _, edge in held] or [""])
    return Ghosts(
        np.array([f"g{id_text(own)}" for own in tracks.object_id.tolist()]),
        np.array([look.type_name if look is not None else "" for look in looks]),
        tuple(types), start, rows[:, 0].astype(np.int64), rows[:, 1], rows[:, 2], rows[:, 3],
        rows[:, 4].astype(np.int64), edges,
    )  # fmt: skip


def _look(tracks: Tracks, row: int) -> Look | None:
    kind = MOVER_KINDS[tracks.kind[row]]
    if kind not in DRIVING:
        return None
    length, width, height = map(float, tracks.size[row])
    return Look(f"ghost_{tracks.look[row]}", kind, (length, width, height))


def _at(
    tracks: Tracks, walks: NDArray[np.bool_], tree: shapely.STRtree, moment: float
) -> FloatArray:
    """(p, 5) rows, foremost points, compass angles and crossings of those there at a moment."""
    poses = poses_at(tracks, moment)
    ahead = np.column_stack([np.cos(poses.heading), np.sin(poses.heading)])
    on_foot = walks[poses.row]
    reach = np.where(on_foot, 0.0, tracks.size[poses.row, 0] / 2)
    xy = poses.position[:, :2] + ahead * reach[:, None]
    crossing = np.full(len(xy), -1, np.int64)
    if len(tree.geometries):
        person, area = tree.query(shapely.points(xy), predicate="intersects")
        crossing[person] = area
    kept = ~on_foot | (crossing >= 0)
    angle = np.mod(90.0 - np.degrees(poses.heading), 360.0)
    columns = (poses.row, xy[:, 0], xy[:, 1], angle, np.maximum(crossing, 0))
    return np.column_stack(columns)[kept]
