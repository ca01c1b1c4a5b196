"""Symbols on lanes: arrows before junctions, speed limits, what bus and cycle lanes are for."""

from __future__ import annotations

from typing import Any

import numpy as np

from cityx.city.section import KIND, TRAVELLED, TURN
from cityx.geometry.arrays import BoolArray, FloatArray, IntArray
from cityx.geometry.polylines import every, locate
from cityx.road.markings.crossing_places import STOP
from cityx.road.markings.marks import CLASSIFIED, STRIPED, Marks, Street, lane_count
from cityx.road.markings.symbols import LENGTH, arrow, bicycle, diamond, figures, placed, word
from cityx.road.network.lane_graph import turns_of_lanes

EVERY = 60.0  # metres between symbols on a bus or cycle lane
ONE_WAY, FROM_MOUTH = 45.0, 7.0  # metres between arrows of one-way streets, and to the first
LEAST_SYMBOL = 1.2  # metres of a lane with a symbol
FROM_LINE = (1.5, 21.5)  # metres from the stop line to the tips of arrows
AHEAD = (30.0, 50.0)  # metres from a crossing to the lozenges that tell of it
LIMITS = (20, 30, 40, 50, 60, 80)  # km/h that are painted
LIMIT_EVERY, LIMIT_FROM = 45.0, 17.0  # metres between figures on a lane, and to the first
QUIET_LIMIT = 30  # km/h on one-way streets of one lane where the map tells none
_MOVING = [KIND[name] for name in TRAVELLED]


def lane_symbols(
    street: Street, chosen: BoolArray, *, one_way: bool = False, diamonds: bool = False
) -> Marks:
    """Paint arrows before junctions, and what bus and cycle lanes are for behind them.

    Where `one_way`, arrows in the single lane of one-way streets tell which way that is; `diamonds`
    tell of zebras without signals at the end of a lane.
    """
    network, lines, bands = street.network, street.lines, street.bands
    begin, end = street.free
    lanes = np.flatnonzero(np.isin(bands.kind, _MOVING) & (bands.direction != 0))
    lanes = lanes[chosen[bands.edge[lanes]] & (bands.width[lanes] > LEAST_SYMBOL)]
    edge = bands.edge[lanes]
    ahead = bands.direction[lanes] > 0
    room = (end - begin)[edge]
    shapes, edges = [], []

    def paint(outline: Any, rows: IntArray, along: FloatArray) -> None:
        """Put an outline `along` metres into the free part of lanes, in their direction."""
        own = edge[rows]
        place = np.where(ahead[rows], begin[own] + along, end[own] - along)
        position, direction = locate(lines, own, place)
        sign = np.where(ahead[rows], 1.0, -1.0)
        lateral = bands.middle[lanes[rows]] * sign
        made = placed(outline, position, direction * sign[:, None], lateral)
        shapes.append(made)
        edges.append(np.repeat(own, len(made) // max(len(own), 1)))

    at_node = np.where(ahead, network.edge_nodes[edge, 1], network.edge_nodes[edge, 0])
    junction = network.node_degree[at_node] >= 3
    turns = np.where(bands.turns[lanes] > 0, bands.turns[lanes], _meant(street, chosen)[lanes])
    for bits in np.unique(turns[turns > 0]).tolist():
        for gap in FROM_LINE:
            back = STOP + gap + LENGTH
            rows = np.flatnonzero((turns == bits) & junction & (room > back + 2.0))
            paint(arrow(int(bits)), rows, room[rows] - back)
    kind = bands.kind[lanes]
    driven = (lane_count(bands, network.edge_count, 1)
              + lane_count(bands, network.edge_count, -1)) > 0  # fmt: skip
    if diamonds:
        side = ahead.astype(np.int64)
        told = (street.crossing[edge, side] == STRIPED) & ~street.signalled[at_node]
        for far in AHEAD:
            rows = np.flatnonzero((kind == KIND["drive"]) & told & (room > far + 2.0))
            paint(diamond(), rows, room[rows] - far)
    if one_way:
        single = street.layout.roads["oneway"].to_numpy(bool)[network.edge_road]
        single &= lane_count(bands, network.edge_count, 1) == 1
        rows = np.flatnonzero((kind == KIND["drive"]) & single[edge] & (turns == 0))
        which, along = every(room[rows] - LENGTH, ONE_WAY, FROM_MOUTH)
        paint(arrow(TURN["through"]), rows[which], along)
    for name, outline in (("bus", word("BUS")), ("cycle", bicycle())):
        # A street without cars is all of bicycles; nothing on it tells lanes apart.
        rows = np.flatnonzero((kind == KIND[name]) & driven[edge])
        which, along = every(room[rows], EVERY, 6.0)
        paint(outline, rows[which], along)
    if not shapes:
        return np.zeros(0, object), np.zeros(0, np.int64)
    return np.concatenate(shapes), np.concatenate(edges).astype(np.int64)


def speed_figures(street: Street, chosen: BoolArray) -> Marks:
    """Paint speed limits on lanes of cars, behind junctions and again and again."""
    network, lines, bands = street.network, street.lines, street.bands
    begin, end = street.free
    table = street.layout.roads
    told = table["maxspeed_kmh"].to_numpy(float)[network.edge_road]
    single = table["oneway"].to_numpy(bool)[network.edge_road]
    single &= lane_count(bands, network.edge_count, 1) == 1
    single &= np.isin(street.kind, ("residential", "unclassified"))
    limit = np.where(np.isfinite(told), told, np.where(single, QUIET_LIMIT, 0))
    lanes = np.flatnonzero((bands.kind == KIND["drive"]) & (bands.direction != 0))
    lanes = lanes[chosen[bands.edge[lanes]] & (bands.width[lanes] > LEAST_SYMBOL)]
    lanes = lanes[np.isin(limit[bands.edge[lanes]], LIMITS)]
    edge = bands.edge[lanes]
    which, along = every((end - begin)[edge] - LIMIT_FROM, LIMIT_EVERY, LIMIT_FROM)
    lane, own = lanes[which], edge[which]
    sign = np.where(bands.direction[lane] > 0, 1.0, -1.0)
    position, direction = locate(lines, own, np.where(sign > 0, begin[own] + along,
                                                      end[own] - along))  # fmt: skip
    ahead, lateral = direction * sign[:, None], bands.middle[lane] * sign
    shapes, edges = [np.zeros(0, object)], [np.zeros(0, np.int64)]
    for value in np.unique(limit[own]).tolist():
        rows = np.flatnonzero(limit[own] == value)
        made = placed(figures(int(value)), position[rows], ahead[rows], lateral[rows])
        shapes.append(made)
        edges.append(np.repeat(own[rows], len(made) // len(rows)))
    return np.concatenate(shapes), np.concatenate(edges).astype(np.int64)


def _junction_of_main_roads(street: Street) -> BoolArray:
    """(n,) whether classified roads meet at a node, so that their lanes part there."""
    main = street.rank <= CLASSIFIED
    arms = np.bincount(street.network.edge_nodes[main].ravel(), minlength=len(street.joint))
    return street.joint & (arms >= 3)


def _meant(street: Street, chosen: BoolArray) -> IntArray:
    """(b,) turns that lanes of cars allow at main junctions where no tag of their arm tells any.

    Only where cars arrive in several lanes, since one lane alone serves all.
    """
    network, bands = street.network, street.bands
    meant = np.zeros(len(bands.edge), np.int64)
    drive = bands.kind == KIND["drive"]
    for end, direction in ((0, -1), (1, 1)):
        asked = (street.signalled | _junction_of_main_roads(street))[network.edge_nodes[:, end]]
        asked &= chosen
        asked &= lane_count(bands, network.edge_count, direction) >= 2
        along = bands.direction == direction
        asked[bands.edge[(bands.turns > 0) & along]] = False
        rows = drive & along & asked[bands.edge]
        if rows.any():
            meant[rows] = turns_of_lanes(street.layout, network, bands)[rows]
    # Back along one's own street is nobody's lane.
    return meant & ~TURN["reverse"]
