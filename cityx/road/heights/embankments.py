"""Sides of ramps and decks: slopes of earth, parapets, walls of cuttings, tunnel headwalls."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.city.ground import Ground
from cityx.city.layout import Layout
from cityx.city.roads import RoadNetwork
from cityx.city.terrain import Terrain
from cityx.geometry.arrays import BoolArray, FloatArray, IntArray
from cityx.geometry.polylines import Polylines, miters, segments, to_linestrings, values_along
from cityx.ground.grading import SOIL
from cityx.ground.structures import Bodies, bank_directions, banks, beams, chains_of, rim_edges
from cityx.road.heights.structure_tiers import (
    CEILING,
    FOOTING,
    PARAPET_FROM,
    PARAPET_WIDTH,
    SAME_PLACE,
    STORY,
    WALL_FROM,
    Tier,
)
from cityx.road.network.stations import DECK

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
SOFFIT = 0.06  # metres that a parapet's outside covers below the slab
PARAPET = 0.95  # metres above the surface
GAP = 0.1  # metres that a slab keeps besides, over slopes between its corners
HEADROOM = 4.5  # metres over a carriageway in which no wall of a cutting beside it stands
CUTTING_PARAPET, CUTTING_WALL = 1.0, 0.35  # metres above the ground; metres


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


def at_seams(part: Tier, deck: Ground, edges: IntArray) -> BoolArray:
    """Return which edges lie across the ends of ways, where no parapet stands.

    Parameters
    ----------
    part, deck
        The tier and its arrangement.
    edges
        (k, 2) int64, vertices of the deck.

    Returns
    -------
    found
        (k,) bool.
    """
    lines = part.lines
    owner = lines.line_of_point()
    ends = np.concatenate([lines.start[:-1], lines.start[1:] - 1])
    across = miters(lines)[ends] * (part.reach[owner[ends]] + 0.6)[:, None]
    bars = np.stack([lines.points[ends] - across, lines.points[ends] + across], axis=1)
    seam = shapely.STRtree(shapely.linestrings(bars))
    found = np.ones(len(edges), bool)
    for side in (0, 1):
        spots = shapely.points(deck.vertices[edges[:, side]])
        near = np.zeros(len(edges), bool)
        near[seam.query(spots, "dwithin", distance=SAME_PLACE)[0]] = True
        found &= near
    return found


def rim_walls(
    part: Tier, deck: Ground, network: RoadNetwork, group: IntArray, z: FloatArray,
    soil: FloatArray, ceiling: FloatArray, covered: BoolArray, thick: FloatArray,
) -> list[Bodies]:  # fmt: skip
    """Raise parapets along decks and walls along cuttings.

    Parameters
    ----------
    part, deck
        The tier and its arrangement, of n vertices and f faces.
    network
        The whole city's: no wall stands in its carriageways.
    group
        (f,) int64, 0 for faces of structures, -1 for others.
    z, soil, ceiling
        (n,) heights of the surface, the ground, and the ceiling of a tunnel, metres.
    covered
        (f,) bool, the faces under the slab of a tunnel.
    thick
        (f,) metres of the slab below the surface.
    """
    edges, inside, _ = rim_edges(deck, group)
    if not len(edges):
        return []
    at_seam = at_seams(part, deck, edges)
    lift = (z - soil)[edges].mean(axis=1)
    kind = np.select(
        [at_seam, covered[inside], lift > PARAPET_FROM, lift < -WALL_FROM], [-1, 2, 0, 1], -1
    )
    made: list[Bodies] = []
    crown = np.maximum(z, soil) + PARAPET
    for low, rows in ((z - 2 * DECK, kind == 0), (z - FOOTING - HEADROOM, kind > 0)):
        stands = np.flatnonzero(rows)
        blocks = _in_the_way(deck, network, edges[stands], CUTTING_WALL, low, crown)
        kind[stands[blocks]] = -1
    shapes = (
        (z - SOFFIT, z + PARAPET, PARAPET_WIDTH),
        (z - FOOTING, soil + CUTTING_PARAPET, CUTTING_WALL),
        (z - FOOTING, ceiling + CEILING, CUTTING_WALL),
    )
    for number, (low, high, width) in enumerate(shapes):
        for depth in np.unique(thick[inside[kind == number]]) if number == 0 else (0.0,):
            chosen = edges[(kind == number) & ((thick[inside] == depth) | (number > 0))]
            vertex, start = chains_of(chosen, np.zeros(len(chosen), np.int64))
            lines = Polylines(deck.vertices[vertex], start)
            made.append(beams(lines, low[vertex] - depth, high[vertex], 0.0, width))
    return made


def carriageway_passes(
    network: RoadNetwork, points: FloatArray, margin: float,
    counts: Callable[[IntArray, FloatArray], BoolArray],
) -> BoolArray:  # fmt: skip
    """Return where a carriageway passes at a height that counts.

    Parameters
    ----------
    network
        The whole city's, with heights.
    points
        (n, 2) places, scene frame, metres.
    margin
        Metres beside a carriageway that still belong to it.
    counts
        Asked with (k,) rows of places and heights of carriageways there; returns (k,) bool.

    Returns
    -------
    found
        (n,) bool.
    """
    spot, height = _passing(network, points, margin)
    found = np.zeros(len(points), bool)
    found[spot[counts(spot, height)]] = True
    return found


def free_below(
    network: RoadNetwork, points: FloatArray, margin: float, z: FloatArray
) -> FloatArray:
    """Return heights above which bodies leave the carriageways below them free.

    Parameters
    ----------
    network
        The whole city's, with heights.
    points, z
        (n, 2) places and (n,) heights of a surface over them, metres.
    margin
        Metres beside a carriageway that still belong to it.

    Returns
    -------
    height
        (n,) metres; minus infinity where no carriageway passes below.
    """
    spot, at = _passing(network, points, margin)
    below = at < z[spot] - STORY
    found = np.full(len(points), -np.inf)
    np.maximum.at(found, spot[below], at[below] + HEADROOM + GAP)
    return found


def _passing(
    network: RoadNetwork, points: FloatArray, margin: float
) -> tuple[IntArray, FloatArray]:
    """(k,) rows of places at which carriageways pass, and the heights of these."""
    lines = network.lines
    shapes, spots = to_linestrings(lines), shapely.points(points)
    line, spot = shapely.STRtree(spots).query(
        shapes, predicate="dwithin", distance=network.half_width + margin
    )
    along = shapely.line_locate_point(shapes[line], spots[spot])
    return spot, values_along(lines, network.z, line, along)


def headwalls(
    deck: Ground, network: RoadNetwork, covered: BoolArray, solid: BoolArray, low: FloatArray,
    soil: FloatArray,
) -> Bodies:  # fmt: skip
    """Close the space over the mouth of a tunnel up to a parapet above the ground.

    Parameters
    ----------
    deck
        The arrangement of a tier, of n vertices and f faces.
    network
        The whole city's: no wall stands in its carriageways.
    covered, solid
        (f,) bool, the faces under the slab of a tunnel, and all faces of structures.
    low, soil
        (n,) heights of the ceiling of a tunnel and of the ground, metres.
    """
    edges, _, beyond = rim_edges(deck, np.where(covered, 0, -1))
    edges = edges[(beyond >= 0) & solid[np.maximum(beyond, 0)]]
    high = soil + CUTTING_PARAPET
    edges = edges[(high - low)[edges].min(axis=1) > LEAST]  # a gallery stands above the ground
    edges = edges[~_in_the_way(deck, network, edges, CUTTING_WALL, low, high)]
    vertex, start = chains_of(edges, np.zeros(len(edges), np.int64))
    return beams(Polylines(deck.vertices[vertex], start), low[vertex], high[vertex], 0.0,
                 CUTTING_WALL)  # fmt: skip


def _in_the_way(
    deck: Ground, network: RoadNetwork, edges: IntArray, width: float, low: FloatArray,
    high: FloatArray,
) -> BoolArray:  # fmt: skip
    """(k,) whether a wall to the right of edges would stand in a carriageway at its height.

    ``low`` and ``high`` are (n,) heights of its foot and its crown at all vertices.
    """
    ends = deck.vertices[edges]
    run = np.diff(ends, axis=1)[:, 0]
    right = np.column_stack([run[:, 1], -run[:, 0]]) / np.maximum(np.hypot(*run.T), 1e-9)[:, None]
    middle = ends.mean(axis=1) + right * width / 2
    foot, crown = low[edges].mean(axis=1), high[edges].mean(axis=1)
    return carriageway_passes(
        network, middle, 0.0, lambda row, at: (at > foot[row]) & (at < crown[row])
    )
