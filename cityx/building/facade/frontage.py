"""Frontage: what a wall looks out on, and which wall of a building has the main door."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.building.facade.walls import WallTable
from cityx.geometry.arrays import FloatArray, IntArray

CLOSE = 1.3  # metres; nobody puts a window so near to the next building
REACH = 22.0  # metres; a street further off than that is not the one the wall stands on
EYE = 0.35  # metres before the wall where a look begins, past neighbours that touch
MIN_LOOK = 1.2  # metres; shorter walls have no openings, so what they face does not matter
MANY_LOOKS = 9.0  # metres; longer walls look out in three places
DOOR_NEAR = 2.0  # metres between a mapped entrance and its wall
NONE = -1


@dataclass(frozen=True)
class Frontage:
    """What w walls face.

    Attributes
    ----------
    street
        (w,) int64, row of the road in front, -1 where there is none.
    distance
        (w,) float64, metres to its centreline, inf where there is none.
    free
        (w,) float64, metres to the next building, at most `REACH`.
    screened
        (w,) float64, height up to which a building stands closer than `CLOSE`, -inf for none.
    """

    street: IntArray
    distance: FloatArray
    free: FloatArray
    screened: FloatArray


def frontage_of(
    walls: WallTable,
    roads: NDArray[Any],
    polygons: NDArray[Any],
    z_low: FloatArray,
    z_high: FloatArray,
) -> Frontage:
    """Return what every wall looks out on, at right angles to it.

    Parameters
    ----------
    walls
        The walls.
    roads
        (r,) LineStrings of the ways that count as streets, None or empty for those that do not.
    polygons, z_low, z_high
        (n,) outlines, foot and eave of the parts that can stand in the way.
    """
    street = np.full(walls.count, NONE, np.int64)
    distance = np.full(walls.count, np.inf)
    free = np.full(walls.count, REACH)
    screened = np.full(walls.count, -np.inf)
    wall, eye = _eyes(walls)
    if not len(wall):
        return Frontage(street, distance, free, screened)
    # A foot of 1 mm keeps rounding from asking whether the eye touches its own wall.
    rays = shapely.linestrings(np.stack([eye, eye + walls.normal[wall] * REACH], axis=1))
    shapely.prepare(rays)
    starts = shapely.points(eye)
    look, hit = shapely.STRtree(polygons).query(rays, predicate="intersects")
    row = wall[look]
    # Parts that begin above the storey or end below it do not stand in the way.
    middle = walls.z_low[row] + 1.5
    useful = (z_low[hit] < middle) & (z_high[hit] > middle)
    useful &= walls.part[row] != hit
    look, hit = look[useful], hit[useful]
    seen = shapely.distance(starts[look], polygons[hit])
    clear = np.full(len(wall), REACH)
    np.minimum.at(clear, look, seen + EYE)
    np.minimum.at(free, wall, clear)
    close = seen + EYE < CLOSE
    np.maximum.at(screened, wall[look[close]], z_high[hit[close]])

    tree = shapely.STRtree(roads)
    look, road = tree.query(rays, predicate="intersects")
    crossing = shapely.intersection(rays[look], roads[road])
    away = shapely.distance(starts[look], crossing) + EYE
    before = away < clear[look]
    look, road, away = look[before], road[before], away[before]
    order = np.lexsort((road, away, wall[look]))
    row = wall[look][order]
    first = np.ones(len(row), bool)
    first[1:] = row[1:] != row[:-1]
    street[row[first]] = road[order][first]
    distance[row[first]] = away[order][first]
    return Frontage(street, distance, free, screened)


def _eyes(walls: WallTable) -> tuple[IntArray, FloatArray]:
    """Places to look from: (k,) wall and (k, 2) position."""
    rows = np.flatnonzero(walls.length >= MIN_LOOK)
    long_rows = rows[walls.length[rows] > MANY_LOOKS]
    wall = np.concatenate([rows, long_rows, long_rows])
    share = np.concatenate(
        [np.full(len(rows), 0.5), np.full(len(long_rows), 0.2), np.full(len(long_rows), 0.8)]
    )[:, None]
    at = walls.start[wall] * (1 - share) + walls.end[wall] * share
    return wall, at + walls.normal[wall] * EYE


def walls_at(
    walls: WallTable, usable: NDArray[np.bool_], places: FloatArray
) -> tuple[IntArray, FloatArray]:
    """Return the usable wall at each of some places, and where along it.

    Parameters
    ----------
    walls, usable
        The walls, and (w,) which count.
    places
        (e, 2) metres.

    Returns
    -------
    wall, along
        (e,) -1 where none is within `DOOR_NEAR`; metres from the start of the wall.
    """
    wall = np.full(len(places), NONE, np.int64)
    along = np.zeros(len(places))
    rows = np.flatnonzero(usable)
    if not len(rows) or not len(places):
        return wall, along
    lines = shapely.linestrings(np.stack([walls.start[rows], walls.end[rows]], axis=1))
    point, line = shapely.STRtree(lines).query_nearest(
        shapely.points(places), max_distance=DOOR_NEAR, all_matches=True
    )
    # At a corner the longer wall has it.
    order = np.lexsort((rows[line], walls.length[rows[line]]))
    wall[point[order]] = rows[line[order]]
    found = np.flatnonzero(wall >= 0)
    at = wall[found]
    unit = (walls.end - walls.start)[at] / walls.length[at, None]
    along[found] = ((places[found] - walls.start[at]) * unit).sum(axis=1)
    return wall, along


def door_walls(
    walls: WallTable,
    building: NDArray[np.uint64],
    usable: NDArray[np.bool_],
    score: FloatArray,
    entrances: FloatArray,
    rank: IntArray,
) -> tuple[IntArray, FloatArray]:
    """Choose the wall and place of each building's main door.

    Parameters
    ----------
    walls
        The walls.
    building
        (w,) building of each wall.
    usable
        (w,) whether a door fits into the wall.
    score
        (w,) the better the wall, the higher.
    entrances
        (e, 2) mapped entrances.
    rank
        (e,) the lower the more it is the main one.

    Returns
    -------
    wall, along
        (d,) one per building that has a usable wall, sorted by wall; metres from the wall's start,
        NaN where nothing was mapped.
    """
    rows = np.flatnonzero(usable)
    if not len(rows):
        return np.zeros(0, np.int64), np.zeros(0)
    lines = shapely.linestrings(np.stack([walls.start[rows], walls.end[rows]], axis=1))
    marked = np.full(walls.count, np.inf)
    along = np.full(walls.count, np.nan)
    if len(entrances):
        point, line = shapely.STRtree(lines).query_nearest(
            shapely.points(entrances), max_distance=DOOR_NEAR, all_matches=True
        )
        order = np.lexsort((entrances[point, 1], entrances[point, 0], rank[point]))[::-1]
        point, wall = point[order], rows[line[order]]  # the best is written last
        marked[wall] = rank[point]
        unit = (walls.end - walls.start)[wall] / walls.length[wall, None]
        along[wall] = ((entrances[point] - walls.start[wall]) * unit).sum(axis=1)
    order = np.lexsort((-walls.length[rows], -score[rows], marked[rows], building[rows]))
    chosen = rows[order]
    first = np.ones(len(chosen), bool)
    first[1:] = building[chosen][1:] != building[chosen][:-1]
    chosen = np.sort(chosen[first])
    return chosen, along[chosen]
