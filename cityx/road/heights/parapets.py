"""Parapets of decks, walls of cuttings and headwalls of tunnels."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.city.ground import Ground
from cityx.city.roads import RoadNetwork
from cityx.geometry.polylines import Polylines, miters, to_linestrings, values_along
from cityx.ground.structures import Bodies, beams, chains_of, rim_edges
from cityx.road.heights.structure_tiers import (
    CEILING,
    FOOTING,
    PARAPET_FROM,
    PARAPET_WIDTH,
    SAME_PLACE,
    WALL_FROM,
    Tier,
)
from cityx.road.network.stations import DECK

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]

SOFFIT = 0.06  # metres that a parapet's outside covers below the slab
PARAPET = 0.95  # metres above the surface
CUTTING_PARAPET, CUTTING_WALL = 1.0, 0.35  # metres above the ground; metres


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
    kind[_in_the_way(deck, network, edges, CUTTING_WALL, z - 2 * DECK, crown)] = -1
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
    lines = network.lines
    shapes, spots = to_linestrings(lines), shapely.points(points)
    found = np.zeros(len(points), bool)
    if not len(shapes) or not len(points):
        return found
    line, spot = shapely.STRtree(spots).query(
        shapes, predicate="dwithin", distance=network.half_width + margin
    )
    along = shapely.line_locate_point(shapes[line], spots[spot])
    height = values_along(lines, network.z, line, along)
    found[spot[counts(spot, height)]] = True
    return found


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
