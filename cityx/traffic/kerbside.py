"""Cyclists keep to the kerb, where SUMO drives along the middle of a lane."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from cityx.city.lanes import LaneGraph
from cityx.city.section import KIND
from cityx.geometry.arrays import FloatArray, IntArray
from cityx.traffic.making_way import beside
from cityx.traffic.network import Network
from cityx.traffic.streets import Lane, Link, Streets, Way

SHARED = ("drive", "bus")  # lanes on which cyclists keep aside; a lane of their own they ride amid
KERB, DOORS = 0.75, 1.25  # metres from the edge of a lane at a kerb, and at parked cars
EASE = 8.0  # metres before and behind a place over which they get aside
BEND = math.radians(30.0)  # by which who turns round a kerb rides amid the way
SAME = 0.05  # metres within which two bands adjoin


def asides(graph: LaneGraph, streets: Streets, network: Network, names: NDArray[np.str_]
           ) -> FloatArray:  # fmt: skip
    """Return how far to the left of the middle of each lane of the simulator cyclists ride.

    Parameters
    ----------
    graph
        The lanes, the parked cars beside them included.
    streets, network
        What was simulated.
    names
        (k,) lanes of the simulator, on streets and across junctions.

    Returns
    -------
    (k,) float64, metres, less than 0 where traffic keeps to the right; NaN across a junction where
    they hold what they had.
    """
    left = 1.0 if streets.left_hand else -1.0
    parked = _beside_parked(graph)
    found = np.zeros(len(names))
    for number, name in enumerate(names.tolist()):
        if name in network.lanes:
            way, index = network.lanes[name]
            found[number] = left * _room(streets.ways[way], index, parked)
        elif name in network.links:
            link = streets.links[network.links[name]]
            found[number] = 0.0 if left * _turned(link) > BEND else np.nan
    return found


def kept_aside(
    position: FloatArray, heading: FloatArray, mover: IntArray, wanted: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return places and headings of movers that keep aside of their way, gently.

    Parameters
    ----------
    position
        (p, 2) float64, metres, ordered by mover and time.
    heading
        (p,) float64, radians.
    mover
        (p,) int64, ascending.
    wanted
        (p,) float64, metres to the left, NaN where it is held.

    Returns
    -------
    position, heading
        (p, 2) and (p,) float64.
    """
    aside, slope = np.zeros(len(mover)), np.zeros(len(mover))
    step = np.hypot(*np.diff(position, axis=0).T)
    ends = np.r_[0, np.flatnonzero(np.diff(mover)) + 1, len(mover)]
    for first, last in pairwise(ends.tolist()):
        own = wanted[first:last]
        known = np.flatnonzero(~np.isnan(own))
        if not len(known) or not own[known].any():
            continue
        gone = np.r_[0.0, np.cumsum(step[first : last - 1])]
        # Across a junction they ride from where they left the one lane to where the other begins.
        own = np.interp(gone, gone[known], own[known])
        # The mean of what is wanted within reach, as the difference of its integral.
        reach = np.r_[gone[0] - EASE, gone, gone[-1] + EASE]
        held = np.r_[own[0], own, own[-1]]
        mass = np.r_[0.0, np.cumsum((held[1:] + held[:-1]) / 2 * np.diff(reach))]
        low, high = np.maximum(gone - EASE, reach[0]), np.minimum(gone + EASE, reach[-1])
        aside[first:last] = (np.interp(high, reach, mass) - np.interp(low, reach, mass)) / (
            2 * EASE
        )
        slope[first:last] = (np.interp(high, reach, held) - np.interp(low, reach, held)) / (
            2 * EASE
        )
    return beside(position, heading, aside), heading + np.arctan(slope)


def _room(way: Way, index: int, parked: NDArray[np.bool_]) -> float:
    """Metres from the middle of a lane to where cyclists ride in it; 0 but at the kerb."""
    lane = way.lanes[index]
    if lane.kind not in SHARED or any(_driven(other) for other in way.lanes[:index]):
        return 0.0
    return max(lane.width / 2 - (DOORS if parked[lane.row] else KERB), 0.0)


def _driven(lane: Lane) -> bool:
    return lane.kind in (*SHARED, "cycle")


def _turned(link: Link) -> float:
    """Radians to the left by which a way across a junction turns."""
    first, last = link.shape[1] - link.shape[0], link.shape[-1] - link.shape[-2]
    turn = math.atan2(last[1], last[0]) - math.atan2(first[1], first[0])
    return math.remainder(turn, 2 * math.pi)


def _beside_parked(graph: LaneGraph) -> NDArray[np.bool_]:
    """(l,) lanes with parked cars at one of their sides."""
    found = np.zeros(graph.count, bool)
    parking = np.flatnonzero(graph.kind == KIND["parking"])
    bays: dict[int, list[float]] = {}
    for row in parking.tolist():
        bays.setdefault(int(graph.edge[row]), []).extend((graph.left[row], graph.right[row]))
    for row in np.flatnonzero(np.isin(graph.edge, list(bays))).tolist():
        sides = np.array(bays[int(graph.edge[row])])
        found[row] = (np.abs(sides - graph.left[row]) < SAME).any() or (
            np.abs(sides - graph.right[row]) < SAME).any()  # fmt: skip
    return found
