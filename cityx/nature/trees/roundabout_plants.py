"""What grows on the islands of roundabouts: rings of bushes behind mown grass, trees amid."""

from __future__ import annotations

from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.city import City
from cityx.city.ground import KERB_WIDTH
from cityx.geometry.ranges import counted
from cityx.geometry.scatter import Points
from cityx.ids import choose, hash_ids, uniform
from cityx.nature.trees.stands import INDEX, Stand, draw_species, stand_of
from cityx.road.surface.roundabouts import Islands, islands_of, ring_edges

FloatArray = NDArray[np.float64]

PURPOSE = "nature/roundabout_plants"
# Lawn behind the kerb on which nothing grows: what rides along sees who comes from its side, and
# trailers of lorries sweep over it.
VERGE = 2.0  # metres
# Rows of bushes one behind the other: of which kind, metres between them, metres behind the first,
# and how high. They hide the far side, so that drivers heed the ring (FGSV, Merkblatt für die
# Anlage von Kreisverkehren, 2006).
ROWS = (("boxwood", 0.7, 0.0, (0.5, 0.7)), ("shrub", 1.2, 1.3, (0.9, 1.4)))
DESIGNS = (6, 1)  # weights of bushes about trees and of mown grass alone
PLANTED = 0
LEAST_ROW = 1.2  # metres of radius of a row of bushes
FOR_ONE, FOR_THREE = 4.0, 8.5  # metres of radius of an island with one tree, and with three
APART = 2.6  # metres from the middle to each of three trees
TREES = (5.5, 8.5)  # metres


def roundabout_stands(city: City, have: FloatArray) -> list[Stand]:
    """Plant the islands of roundabouts on which the map has nothing.

    Parameters
    ----------
    city
        City with a ground.
    have
        (n, 2) trees of the map, metres.
    """
    network = city.network
    if city.ground is None or network is None or not network.edge_count:
        return []
    islands = islands_of(network, ring_edges(city.layout, network))
    if not len(islands.id):
        return []
    free = ~islands.crossed & (islands.radius - islands.apron > FOR_ONE)
    told = np.concatenate([shapely.points(have), city.layout.points.geometry.to_numpy()])
    free[shapely.STRtree(islands.within(0.0)).query(told, predicate="within")[1]] = False
    planted = np.flatnonzero(free & (choose(city.seed, PURPOSE, islands.id, DESIGNS) == PLANTED))
    stands = [_trees(city, islands, planted)]
    lawn = islands.apron + KERB_WIDTH + VERGE
    for name, spacing, behind, (low, high) in ROWS:
        rows = islands.within(lawn + behind)[planted]
        points = _along(rows, islands.id[planted], spacing, name)
        on = city.ground.on(points.xy, "grass")
        points = Points(points.xy[on], points.id[on])
        height = low + (high - low) * uniform(city.seed, f"{PURPOSE}/height", points.id)
        # Low bushes of a bed, which may stand as near to a carriageway as mapped ones do.
        stands.append(stand_of(points, INDEX[name], height, mapped=True, light=True))
    return stands


def _along(rows: NDArray[Any], ids: NDArray[np.uint64], spacing: float, name: str) -> Points:
    """Put points along the outlines of round beds, the same distance apart."""
    outline = shapely.get_exterior_ring(rows)  # None of a bed in several parts, which has no points
    length = shapely.length(outline)
    count = np.where(length >= 2 * np.pi * LEAST_ROW, length // spacing, 0).astype(np.int64)
    row, place = counted(count)
    along = shapely.line_interpolate_point(outline[row], place * (length[row] / count[row]))
    ids = hash_ids(0, f"{PURPOSE}/{name}", ids[row], place)
    return Points(shapely.get_coordinates(along), ids)


def _trees(city: City, islands: Islands, rows: NDArray[np.int64]) -> Stand:
    """Put one tree amid a small island, three of one species amid a large one."""
    three = islands.radius[rows] - islands.apron[rows] > FOR_THREE
    which, place = counted(np.where(three, 3, 1))
    row = rows[which]
    turn = 2 * np.pi * (uniform(city.seed, f"{PURPOSE}/turn", islands.id[row]) + place / 3)
    reach = np.where(three[which], APART, 0.0)
    middle = shapely.get_coordinates(shapely.centroid(islands.polygon[row]))
    xy = middle + reach[:, None] * np.column_stack([np.cos(turn), np.sin(turn)])
    ids = hash_ids(0, f"{PURPOSE}/tree", islands.id[row], place)
    low, high = TREES
    height = low + (high - low) * uniform(city.seed, f"{PURPOSE}/tree", ids)
    species = draw_species("street", city, islands.id[row])
    return stand_of(Points(xy, ids), species, height)
