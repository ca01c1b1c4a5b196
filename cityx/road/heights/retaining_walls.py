"""Retaining walls beside roads, where the ground has a step that a slope of soil cannot hold."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.city.ground import KERB_WIDTH
from cityx.city.layout import Layout
from cityx.city.roads import RoadNetwork
from cityx.city.terrain import Terrain
from cityx.geometry.arrays import BoolArray, FloatArray, IntArray
from cityx.geometry.polylines import (
    Polylines,
    arc_lengths,
    every,
    locate,
    to_linestrings,
    values_along,
)
from cityx.ground.grading import SOIL, VERGE
from cityx.ground.structures import Bodies, beams
from cityx.road.network.network import DRIVABLE

Shapes = NDArray[Any]

SPACING = 2.0  # metres along a road between the places that are looked at
CELLS = 1.25  # of the terrain's cells that a step in it is wide, to each side
PLACES, STRIDE = 6, 2  # heights taken across it, half a cell apart, and of them to a cell
LEAST_STEP = 0.4  # metres in one cell beyond what soil keeps
SHORTEST = 3  # places in a row that want a wall
THICK = 0.45  # metres
FOOTING = 0.5  # metres into the ground
COPING = 0.15  # metres above the land behind
PARAPET, PARAPET_FROM = 0.95, 1.0  # metres above a road; metres of drop beside it that want one
CLEAR_OF_HOUSES, CLEAR_OF_WAYS = 0.6, 1.5  # metres


@dataclass(frozen=True)
class RetainingWalls:
    """Walls between the level strip of a road and land higher or lower, k of them.

    Attributes
    ----------
    front
        Lines along the road, which lies on their left.
    road, land
        (p,) heights of the ground on both sides at their points, metres.
    reach
        Metres to both sides in which the ground is level with its edge at the wall.
    """

    front: Polylines
    road: FloatArray
    land: FloatArray
    reach: float

    @property
    def lines(self) -> Shapes:
        """(2k,) both faces of the walls: lines at which the ground is cut."""
        front = to_linestrings(self.front)
        return np.concatenate([front, shapely.offset_curve(front, -THICK, join_style="mitre")])

    def bodies(self) -> Bodies:
        """Return the walls as solids, with a parapet where a road lies above a drop."""
        drop = self.road - self.land
        crown = np.where(drop > PARAPET_FROM, PARAPET, COPING)
        low = np.minimum(self.road, self.land) - FOOTING
        return beams(self.front, low, np.maximum(self.road, self.land) + crown, 0.0, THICK)

    def heights(self, points: FloatArray, ground: FloatArray) -> FloatArray:
        """(n,) heights of the ground at (n, 2) points, with its steps sharp at the walls."""
        found = ground.copy()
        shapes = to_linestrings(self.front)
        spots = shapely.points(points)
        spot, wall = shapely.STRtree(shapes).query(spots, predicate="dwithin", distance=self.reach)
        along = shapely.line_locate_point(shapes[wall], spots[spot])
        length = shapely.length(shapes[wall])
        beside = (along > 0) & (along < length)
        spot, wall, along = spot[beside], wall[beside], along[beside]
        foot, ahead = locate(self.front, wall, along)
        away = points[spot] - foot
        behind = ahead[:, 1] * away[:, 0] - ahead[:, 0] * away[:, 1] > THICK / 2
        nearest = np.lexsort((-np.hypot(*away.T), spot))
        spot, wall, along, behind = (a[nearest] for a in (spot, wall, along, behind))
        road, land = (values_along(self.front, z, wall, along) for z in (self.road, self.land))
        found[spot] = np.where(behind, land, road)
        return found


def find_walls(layout: Layout, network: RoadNetwork, terrain: Terrain) -> RetainingWalls:
    """Find where the terrain steps up or down at the edge of the level strip of a road.

    Parameters
    ----------
    layout
        Houses and ways that leave no room for a wall.
    network
        The pieces of its roads that lie on the ground.
    terrain
        With its roads graded.
    """
    reach = CELLS * terrain.cell
    lines = network.lines
    length = arc_lengths(lines)[1]
    if terrain.is_flat or not lines.count:
        return RetainingWalls(
            Polylines(np.zeros((0, 2)), np.zeros(1, np.int64)), np.zeros(0), np.zeros(0), reach
        )
    edge, along = every(length, SPACING)
    runs = []
    for side in (1, -1):
        at, ahead = locate(lines, edge, along)
        out = side * np.column_stack([-ahead[:, 1], ahead[:, 0]])
        strip = _strips(layout, network, side)[edge]
        spot = at + out * strip[:, None]
        profile = np.stack(
            [terrain.height_at(spot + out * far) for far in np.linspace(-reach, reach, PLACES)]
        )
        # What soil keeps within a cell is no part of a step.
        excess = np.abs(profile[STRIDE:] - profile[:-STRIDE]).max(axis=0) - SOIL * terrain.cell
        steep = excess > 0
        steep[steep] &= _free(layout, network, edge[steep], spot[steep], out[steep])
        excess[~steep] = 0.0
        runs.append((edge * 2 + (side > 0), spot, profile[0], profile[-1], excess))
    key, spot, road, land, excess = (np.concatenate(column) for column in zip(*runs, strict=True))
    return _joined(key, spot, road, land, excess, reach)


def _strips(layout: Layout, network: RoadNetwork, side: int) -> FloatArray:
    """(e,) metres from the centreline to where the level strip of a road ends."""
    name = "sidewalk_left" if side > 0 else "sidewalk_right"
    walk = layout.roads[name].to_numpy(float)[network.edge_road]
    return np.asarray(network.half_width + np.maximum(VERGE, KERB_WIDTH + walk))


def _free(
    layout: Layout, network: RoadNetwork, edge: IntArray, spot: FloatArray, out: FloatArray
) -> BoolArray:
    """(n,) whether a wall has room: off other carriageways, houses and paths."""
    places = shapely.points(spot + out * THICK / 2)
    free = np.ones(len(places), bool)
    tree = shapely.STRtree(places)
    houses = layout.buildings.geometry.to_numpy()
    free[tree.query(houses, predicate="dwithin", distance=CLEAR_OF_HOUSES)[1]] = False
    others = ~layout.roads["kind"].isin(DRIVABLE).to_numpy()
    half = layout.roads["width"].to_numpy(float)[others] / 2 + CLEAR_OF_WAYS
    paths = layout.roads.geometry.to_numpy()[others]
    free[tree.query(paths, predicate="dwithin", distance=half)[1]] = False
    streets = to_linestrings(network.lines)
    line, place = tree.query(streets, predicate="dwithin", distance=network.half_width + THICK)
    free[place] = False
    strips = network.half_width + VERGE - THICK
    line, place = tree.query(streets, predicate="dwithin", distance=strips)
    free[place[line != edge[place]]] = False
    return free


def _joined(
    key: IntArray, spot: FloatArray, road: FloatArray, land: FloatArray, excess: FloatArray,
    reach: float,
) -> RetainingWalls:  # fmt: skip
    """Join places in a row that are too steep to walls, where one of them is so by a whole step."""
    wanted = excess > 0
    begins = wanted & ~np.r_[False, wanted[:-1] & (key[1:] == key[:-1])]
    run = np.cumsum(begins)[wanted] - 1
    rows = np.flatnonzero(wanted)
    size, most = np.bincount(run, minlength=1), np.zeros(int(run.max(initial=-1)) + 1)
    np.maximum.at(most, run, excess[rows])
    long = (size[run] >= SHORTEST) & (most[run] > LEAST_STEP)
    rows, run = rows[long], np.unique(run[long], return_inverse=True)[1]
    left = key[rows] % 2 == 1
    # A wall on the left of an edge runs against it, so that the road is on its own left.
    order = np.lexsort((np.where(left, -rows, rows), run))
    rows, run = rows[order], run[order]
    start = np.searchsorted(run, np.arange(int(run.max(initial=-1)) + 2)).astype(np.int64)
    front = Polylines(spot[rows], start)
    return RetainingWalls(front, _evened(road[rows], run), _evened(land[rows], run), reach)


def _evened(values: FloatArray, run: IntArray) -> FloatArray:
    """Take the mean of each value and its neighbours in the same run."""
    total, count = values.copy(), np.ones(len(values))
    same = run[1:] == run[:-1]
    for shift in (1, -1):
        near = np.roll(values, shift)
        own = np.r_[False, same] if shift == 1 else np.r_[same, False]
        own = own[: len(values)]
        total += np.where(own, near, 0.0)
        count += own
    return np.asarray(total / count)
