"""Ways over many tiles: known from the lanes of all between, before any world is loaded."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from pathlib import Path
from types import MappingProxyType

import numpy as np
import shapely

from cityx.city.lanes import MOVEMENTS, LaneGraph
from cityx.city.section import KIND as KINDS
from cityx.errors import InputError
from cityx.geometry.polylines import arc_lengths, to_linestrings
from cityx.tiles.region import region_about, region_streets

CORRIDOR = 400  # tiles between the ends of a journey whose lanes are looked at, at most
BESIDE = 1000.0  # metres beside the straight line between the ends that the way may take
NEAREST = 150.0  # metres from a place to the lane that stands for it
SOME = 8  # lanes near a place that are tried, for the next may lead the wrong way
EMPTY: Mapping[int, Collection[int]] = MappingProxyType({})


def metres_to(
    lanes: LaneGraph, goal: int, turns: Mapping[int, Collection[int]] = EMPTY
) -> dict[int, float]:
    """Return the metres from the start of lanes that lead to one to the start of that, by id.

    Parameters
    ----------
    lanes
        Of all tiles between.
    goal
        Id of a lane.
    turns
        Ids of lanes of which more is known, and of all lanes that each leads to.
    """
    from scipy.sparse import csr_matrix
    from scipy.sparse.csgraph import dijkstra

    length = arc_lengths(lanes.lines)[1]
    pairs = lanes.connection[lanes.movement != MOVEMENTS.index("reverse")]
    if turns:
        numbers = {key: row for row, key in enumerate(lanes.lane_id.tolist())}
        told = np.array([key in turns for key in numbers])
        known = [(numbers[key], numbers[onto]) for key, onward in turns.items() if key in numbers
                 for onto in sorted(onward) if onto in numbers]  # fmt: skip
        pairs = np.concatenate([pairs[~told[pairs[:, 0]]], np.array(known, int).reshape(-1, 2)])
    source, target = pairs.T
    across = np.hypot(*(lanes.points[lanes.point_start[target]]
                        - lanes.points[lanes.point_start[source + 1] - 1]).T)  # fmt: skip
    cost = np.maximum(length[source] + across, 1e-3)
    first = np.unique(np.column_stack([source, target]), axis=0, return_index=True)[1]
    graph = csr_matrix((cost[first], (target[first], source[first])), (lanes.count, lanes.count))
    row = int(np.flatnonzero(lanes.lane_id == np.uint64(goal))[0])
    found = dijkstra(graph, indices=row)
    known = np.isfinite(found)
    return dict(zip(lanes.lane_id[known].tolist(), found[known].tolist(), strict=True))


def corridor(folder: Path, start: tuple[float, float], goal: tuple[float, float]) -> LaneGraph:
    """Return the lanes of the tiles between two places.

    Parameters
    ----------
    folder
        Of tiles.
    start, goal
        Metres of the map or of the plane.

    Raises
    ------
    InputError, UsageError
        If there are none, or more tiles lie between than are looked at.
    """
    low, high = np.minimum(start, goal) - BESIDE, np.maximum(start, goal) + BESIDE
    (x, y), (wide, deep) = ((low + high) / 2).tolist(), (high - low).tolist()
    city = region_streets(region_about(folder, (x, y), (wide, deep), most=CORRIDOR))
    if city.lanes is None or not city.lanes.count:
        raise InputError("The tiles between the places have no streets.")
    return city.lanes


def ends_of(
    lanes: LaneGraph, start: tuple[float, float], goal: tuple[float, float]
) -> tuple[int, list[int], dict[int, float]]:
    """Return the lane nearest to a place that leads to another, lanes there, metres to the first.

    The others are for a vehicle that does not fit where the first lies.

    Parameters
    ----------
    lanes
        Of all tiles between.
    start, goal
        Metres of the frame of the lanes.

    Raises
    ------
    InputError
        If no lane is near a place, or none leads from the one to the other.
    """
    begins, goals = (_near(lanes, place) for place in (start, goal))
    for number, end in enumerate(goals):
        to_go = metres_to(lanes, end)
        for begin in begins:
            if begin in to_go and begin != end:
                return begin, goals[number:], to_go
    raise InputError("No way leads from the one place to the other over the tiles between.")


def _near(lanes: LaneGraph, place: tuple[float, float]) -> list[int]:
    """Return the ids of the lanes for cars that are nearest to a place, at most `SOME`."""
    driven = np.flatnonzero((lanes.kind == KINDS["drive"]) & (lanes.direction != 0))
    away = shapely.distance(to_linestrings(lanes.lines)[driven], shapely.Point(place))
    order = np.lexsort((lanes.lane_id[driven], away))[:SOME]
    order = order[away[order] <= NEAREST]
    if not len(order):
        raise InputError(
            f"No lane for cars lies within {NEAREST:g} m of {place[0]:.0f},{place[1]:.0f}."
        )
    found: list[int] = lanes.lane_id[driven[order]].tolist()
    return found
