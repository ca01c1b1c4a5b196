"""Checks of the lane graph: connected as far as the map is, no lane without a way on."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cityx.checks.check import Check
from cityx.city import City
from cityx.city.routes import cars, pieces_of, stranded
from cityx.geometry.chains import components

IntArray = NDArray[np.int64]
BORDER = 2.0  # metres from the site's rectangle within which a street leaves it


def check_lanes(city: City) -> list[Check]:
    """Run every check on the lane graph; none where there is no graph."""
    graph, network = city.lanes, city.network
    if graph is None or network is None or not network.edge_count:
        return []
    open_to_cars = cars(graph)
    piece = pieces_of(graph)
    found = _joined(piece[piece >= 0], graph.edge[piece >= 0])
    ends = np.where(graph.direction > 0, 1, 0)
    last = network.edge_nodes[graph.edge, ends]
    first = network.edge_nodes[graph.edge, 1 - ends]
    of_map = _pieces_of_map(
        graph.edge[open_to_cars].astype(np.int64), first[open_to_cars], last[open_to_cars]
    )
    at = network.node_position[last]
    inside = ~_leaves(at, city.layout.extent)
    joined = (network.node_degree[last] >= 2) & inside & open_to_cars
    leads_on = np.zeros(graph.count, bool)
    leads_on[graph.connection[:, 0]] = True
    dead = int((joined & ~leads_on).sum())
    # A street that ends in the open, or a junction that nothing leads to, was cut by the map.
    opened = network.node_degree == 1
    opened |= _leaves(network.node_position, city.layout.extent)
    source = ~np.isin(np.arange(len(opened)), last[open_to_cars])
    sink = ~np.isin(np.arange(len(opened)), first[open_to_cars])
    entries = np.flatnonzero(open_to_cars & (opened | source)[first])
    exits = np.flatnonzero(open_to_cars & (opened | sink)[last])
    lost = len(stranded(graph, entries, exits))
    total = max(int(open_to_cars.sum()), 1)
    return [
        Check("lane_graph_pieces", float(found - of_map), 0,
              "pieces of the lane graph beyond those of the map's streets"),
        Check("lanes_without_exit", dead / total, 0.05,
              "share of lanes that end at a junction from which none leads on"),
        Check("lanes_stranded", lost / total, 0.25,
              "share of lanes from which, or to which, no way leads within the site"),
    ]  # fmt: skip


def _joined(piece: IntArray, edge: NDArray[np.int32]) -> int:
    """Count pieces; the two directions of one street count together, also on a ring road."""
    if not len(piece):
        return 0
    shift = int(piece.max()) + 1
    pairs = np.column_stack([piece, shift + edge.astype(np.int64)])
    label = components(pairs, shift + int(edge.max()) + 1)
    return len(np.unique(label[piece]))


def _pieces_of_map(edge: IntArray, first: IntArray, last: IntArray) -> int:
    """Count the pieces in which streets hang together by junctions one can come to and leave.

    ``edge``, ``first`` and ``last`` are (k,) of lanes: edge, node they begin and node they end at.
    Two one-way streets that meet head on are not joined.
    """
    if not len(edge):
        return 0
    open_nodes = np.intersect1d(first, last)
    pairs = []
    shift = int(edge.max()) + 1
    for node in (first, last):
        rows = np.flatnonzero(np.isin(node, open_nodes))
        pairs.append(np.column_stack([edge[rows], shift + node[rows]]))
    label = components(np.concatenate(pairs), shift + int(max(first.max(), last.max())) + 1)
    return len(np.unique(label[np.unique(edge)]))


def _leaves(
    at: NDArray[np.float64], extent: tuple[float, float, float, float]
) -> NDArray[np.bool_]:
    """(k,) whether places lie at the edge of the site."""
    xmin, ymin, xmax, ymax = extent
    near = (at[:, 0] <= xmin + BORDER) | (at[:, 0] >= xmax - BORDER)
    return np.asarray(near | (at[:, 1] <= ymin + BORDER) | (at[:, 1] >= ymax - BORDER))
