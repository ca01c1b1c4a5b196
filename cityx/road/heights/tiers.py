"""Tiers: divide the road network into pieces on the ground and pieces on structures."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from cityx.city.heights import WayHeights
from cityx.city.roads import RoadNetwork
from cityx.geometry.arrays import FloatArray, IntArray
from cityx.geometry.polylines import arc_lengths, pieces, values_along
from cityx.system.remembered import Remembered

MARGIN = 2.0  # metres beyond a junction's surface that lie on the same structure
SHORTEST = 0.05  # metres


@dataclass(frozen=True)
class Spans:
    """Pieces of edges, k of them, in the order of edges and along each.

    Attributes
    ----------
    edge
        (k,) int64.
    begin, end
        (k,) float64, metres along the edge.
    off
        (k,) bool, whether the piece lies off the ground, on a structure.
    """

    edge: IntArray
    begin: FloatArray
    end: FloatArray
    off: NDArray[np.bool_]


def spans_of(network: RoadNetwork, heights: WayHeights) -> Spans:
    """Divide every edge into pieces on the ground and pieces on structures.

    A junction lies wholly on one structure as soon as one of its arms leaves the ground near it.
    """
    lines = network.lines
    length = arc_lengths(lines)[1]
    own = np.flatnonzero(heights.edge >= 0)
    edge = heights.edge[own].astype(np.int64)
    off = np.column_stack([heights.begin[own], heights.end[own]])
    nodes = network.edge_nodes.astype(np.int64)
    room = np.minimum(network.trim + MARGIN, length[:, None])
    raised = np.zeros(len(network.node_position), bool)
    low, high = np.full(len(length), np.inf), np.full(len(length), -np.inf)
    np.minimum.at(low, edge, off[:, 0])
    np.maximum.at(high, edge, off[:, 1])
    while True:
        before = int(raised.sum())
        raised[nodes[low < room[:, 0], 0]] = True
        raised[nodes[high > length - room[:, 1], 1]] = True
        if int(raised.sum()) == before:
            break
        head, tail = raised[nodes].T
        high = np.where(head, np.maximum(high, room[:, 0]), high)
        low = np.where(head, 0.0, low)
        low = np.where(tail, np.minimum(low, length - room[:, 1]), low)
        high = np.where(tail, length, high)
    touched = np.unique(np.concatenate([edge, np.flatnonzero(raised[nodes].any(axis=1))]))
    order = np.argsort(edge, kind="stable")
    begin_of, end_of = (np.searchsorted(edge[order], touched, side) for side in ("left", "right"))
    rows: list[tuple[int, float, float, bool]] = []
    for which, first, last in zip(touched.tolist(), begin_of, end_of, strict=True):
        size = float(length[which])
        parts = [(float(b), float(e)) for b, e in off[order[first:last]]]
        if raised[nodes[which, 0]]:
            parts.append((0.0, float(room[which, 0])))
        if raised[nodes[which, 1]]:
            parts.append((size - float(room[which, 1]), size))
        at = 0.0
        for begin, end in _union(parts, size):
            if begin - at > SHORTEST:
                rows.append((which, at, begin, False))
            rows.append((which, begin, end, True))
            at = end
        if size - at > SHORTEST:
            rows.append((which, at, size, False))
    rest = np.setdiff1d(np.arange(network.edge_count), touched)
    table = np.array(rows, dtype=float).reshape(-1, 4)
    edges = np.concatenate([table[:, 0].astype(np.int64), rest])
    begins = np.concatenate([table[:, 1], np.zeros(len(rest))])
    order = np.lexsort((begins, edges))
    return Spans(
        edges[order],
        begins[order],
        np.concatenate([table[:, 2], length[rest]])[order],
        np.concatenate([table[:, 3] > 0, np.zeros(len(rest), bool)])[order],
    )


_LAST: Remembered[tuple[RoadNetwork, RoadNetwork]] = Remembered()


def parted_network(
    network: RoadNetwork, heights: WayHeights
) -> tuple[RoadNetwork, RoadNetwork]:  # fmt: skip
    """Return the pieces of roads on the ground, and those off it; the last ones are remembered."""

    def made() -> tuple[RoadNetwork, RoadNetwork]:
        spans = spans_of(network, heights)
        level, off = (np.flatnonzero(spans.off == where) for where in (False, True))
        return cut_network(network, spans, level), cut_network(network, spans, off)

    return _LAST.get(made, [network, heights])


def level_network(network: RoadNetwork, heights: WayHeights | None) -> RoadNetwork:
    """Return the pieces of roads on the ground; all where no heights are known."""
    return network if heights is None else parted_network(network, heights)[0]


def _union(parts: list[tuple[float, float]], size: float) -> list[tuple[float, float]]:
    """Join intervals that touch, and those that leave only a shred of the edge between them."""
    joined: list[tuple[float, float]] = []
    for begin, end in sorted(parts):
        if joined and begin <= joined[-1][1] + SHORTEST:
            joined[-1] = (joined[-1][0], max(joined[-1][1], end))
        else:
            joined.append((begin if begin > SHORTEST else 0.0, end))
    if joined and size - joined[-1][1] < SHORTEST:
        joined[-1] = (joined[-1][0], size)
    return joined


def cut_network(network: RoadNetwork, spans: Spans, rows: IntArray) -> RoadNetwork:
    """Return the given pieces as a network of their own.

    Where an edge is cut it gets a node with nothing beyond; junctions keep their arms' trims.
    """
    lines = network.lines
    length = arc_lengths(lines)[1]
    edge, begin, end = spans.edge[rows], spans.begin[rows], spans.end[rows]
    at_head, at_tail = begin <= 0.0, end >= length[edge]
    cut = pieces(lines, edge, begin, end)
    count, size = len(network.node_position), len(rows)
    head = np.where(at_head, network.edge_nodes[edge, 0], count + np.arange(size))
    tail = np.where(at_tail, network.edge_nodes[edge, 1], count + size + np.arange(size))
    used, nodes = np.unique(np.column_stack([head, tail]), return_inverse=True)
    position = np.concatenate(
        [network.node_position, cut.points[cut.start[:-1]], cut.points[cut.start[1:] - 1]]
    )
    degree = np.concatenate([network.node_degree, np.ones(2 * size, np.int32)])
    # Whole ends stay where they were to the last bit, so that what is closed stays closed.
    cut.points[cut.start[:-1][at_head]] = lines.points[lines.start[edge[at_head]]]
    cut.points[cut.start[1:][at_tail] - 1] = lines.points[lines.start[edge[at_tail] + 1] - 1]
    owner = cut.line_of_point()
    along = begin[owner] + arc_lengths(cut)[0]
    free = np.column_stack([at_head, at_tail])
    trim = np.where(free, network.trim[edge], 0.0)
    # A piece that ends within a junction's surface lies in it as a whole.
    trim = np.minimum(trim, (end - begin)[:, None])
    return replace(
        network,
        node_position=position[used],
        node_degree=degree[used].astype(np.int32),
        edge_nodes=nodes.reshape(-1, 2).astype(np.int32),
        edge_road=network.edge_road[edge],
        edge_id=network.edge_id[edge],
        point_start=cut.start,
        points=cut.points,
        half_width=network.half_width[edge],
        trim=trim,
        crossing=network.crossing[edge] & free,
        left_hand=network.left_hand[edge],
        z=values_along(lines, network.z, edge[owner], along),
        lift=values_along(lines, network.lift, edge[owner], along),
    )
