"""Embankments: slopes of earth beside ramps, where there is room for them."""

from __future__ import annotations

from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.city.ground import Ground
from cityx.city.layout import Layout
from cityx.city.terrain import Terrain
from cityx.geometry.polylines import Polylines, segments
from cityx.ground.grading import SOIL
from cityx.ground.structures import Bodies, bank_directions, banks, chains_of

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]
Shapes = NDArray[Any]

LEAST = 0.15  # metres of height; a lower edge is a kerb
TOP = 0.10  # metres from the edge of the surface down to the soil beside it
SUNK = 0.05  # metres that its foot lies below the ground
DEPTH = 0.4  # metres that the body reaches into the ground
BESIDE = 0.8  # metres from a foot to other ways
FROM_HOUSES = 1.0  # metres
ROUNDS = 2  # of looking for a foot where the land falls away
FARTHEST = 2.0  # times as far as on level land
SHORTEST = 6.0  # metres along; a shorter slope stays a wall


class Obstacles:
    """What keeps earth away: houses, water, and ways; those on the ramp itself less than others."""

    def __init__(self, layout: Layout, wet: Shapes) -> None:
        roads = layout.roads
        lines, half = roads.geometry.to_numpy(), roads["width"].to_numpy(float) / 2
        houses = shapely.buffer(layout.buildings.geometry.to_numpy(), FROM_HOUSES)
        ways = shapely.buffer(lines, half + BESIDE, cap_style="flat")
        self.things = shapely.STRtree(np.concatenate([ways, houses, wet]))
        self.carriageways = shapely.STRtree(shapely.buffer(lines, half, cap_style="flat"))

    def leave(self, shapes: Shapes, own: IntArray) -> BoolArray:
        """(k,) whether shapes lie in nothing; of ways of the ramp, by row, their surface counts."""
        free = np.ones(len(shapes), bool)
        shape, thing = self.things.query(shapes, predicate="intersects")
        free[shape[~np.isin(thing, own)]] = False
        free[self.carriageways.query(shapes, predicate="intersects")[0]] = False
        return free


def embankments(
    deck: Ground, edges: IntArray, z: FloatArray, terrain: Terrain, obstacles: Obstacles,
    own: IntArray,
) -> Bodies:  # fmt: skip
    """Fill earth against the edges of ramps.

    Parameters
    ----------
    deck
        The arrangement of the ramps' surfaces.
    edges
        (k, 2) vertices along their edges, the ramp on the left.
    z
        (n,) heights of the surface at all vertices, metres.
    terrain
        Under them.
    obstacles
        What leaves no room.
    own
        Rows of the ways on the ramps.
    """
    lift = z - terrain.height_at(deck.vertices)
    edges = edges[lift[edges].min(axis=1) > LEAST]
    run = np.diff(deck.vertices[edges], axis=1)[:, 0]
    out = np.column_stack([run[:, 1], -run[:, 0]]) / np.maximum(np.hypot(*run.T), 1e-9)[:, None]
    a, b = edges.T
    feet = [deck.vertices[v] + out * (lift[v] / SOIL)[:, None] for v in (b, a)]
    ground = shapely.polygons(np.stack([deck.vertices[a], deck.vertices[b], *feet], axis=1))
    edges = edges[obstacles.leave(ground, own)]
    while True:
        vertex, start = _long(deck, *chains_of(edges, np.zeros(len(edges), np.int64)))
        lines = Polylines(deck.vertices[vertex], start)
        high = z[vertex] - TOP
        reach, foot = _feet(lines, high, lift[vertex], terrain)
        # Where edges bend, feet lie farther out than those of single edges.
        first = segments(lines)[0]
        after = first + 1
        far = lines.points + bank_directions(lines) * reach[:, None]
        slopes = shapely.polygons(
            np.stack([lines.points[first], lines.points[after], far[after], far[first]], axis=1)
        )
        free = obstacles.leave(slopes, own)
        if free.all():
            return banks(lines, high, reach, foot, DEPTH)
        edges = np.column_stack([vertex[first], vertex[after]])[free]


def _feet(
    lines: Polylines, high: FloatArray, lift: FloatArray, terrain: Terrain
) -> tuple[FloatArray, FloatArray]:
    """(p,) metres out to the feet of slopes from lines, and their heights."""
    ahead = bank_directions(lines)
    reach = lift / SOIL
    for _ in range(ROUNDS):
        foot = terrain.height_at(lines.points + ahead * reach[:, None]) - SUNK
        reach = np.clip((high - foot) / SOIL, LEAST, FARTHEST * lift / SOIL)
    return reach, foot


def _long(deck: Ground, vertex: IntArray, start: IntArray) -> tuple[IntArray, IntArray]:
    """Leave out chains that are too short for a slope."""
    lines = Polylines(deck.vertices[vertex], start)
    owner = lines.line_of_point()
    step = np.hypot(*np.diff(lines.points, axis=0).T) * (owner[1:] == owner[:-1])
    length = np.bincount(owner[1:], step, minlength=lines.count)
    kept = length > SHORTEST
    size = np.diff(start)[kept]
    return vertex[kept[owner]], np.concatenate([[0], np.cumsum(size)]).astype(np.int64)
