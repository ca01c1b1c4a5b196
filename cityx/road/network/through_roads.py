"""Roads that go straight on at junctions, and the streets that end at them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from cityx.geometry.arrays import BoolArray, FloatArray, IntArray
from cityx.geometry.ranges import numbered
from cityx.road.markings.marks import Street
from cityx.road.network.network import arm_bearings, arms_of

STRAIGHT = np.radians(40.0)  # a road that turns by more does not go straight on


@dataclass(frozen=True)
class Through:
    """Pairs of arms, k of them, that are one road at a junction.

    Attributes
    ----------
    node
        (k,) int64.
    edge, side
        (k, 2) int64; `side` is 0 where the arm leaves the node at its start, 1 at its end.
    major
        (k,) bool, whether no other road of its class meets it there.
    tee
        (k,) bool, whether one other road of its class ends at it.
    """

    node: IntArray
    edge: IntArray
    side: IntArray
    major: BoolArray
    tee: BoolArray


def through_roads(street: Street) -> Through:
    """Pair the arms of the highest class at each junction that continue one another best."""
    network = street.network
    node, edge, side = arms_of(street.lines, network.edge_nodes)
    bearing = arm_bearings(street.lines, edge, side)
    chosen = (street.rank[edge] == street.best[node]) & (network.node_degree[node] >= 3)
    node, edge, side, bearing = (column[chosen] for column in (node, edge, side, bearing))
    degree = np.bincount(node, minlength=len(network.node_position))
    first, second = _pairs(node, degree[node])
    bend = _bend(bearing[first], bearing[second])
    # Each arm takes its straightest partner; where both agree they are one road.
    least = np.full(len(node), np.inf)
    np.minimum.at(least, first, bend)
    np.minimum.at(least, second, bend)
    kept = (bend < STRAIGHT) & (bend <= least[first]) & (bend <= least[second])
    first, second = first[kept], second[kept]
    return Through(
        node[first],
        np.column_stack([edge[first], edge[second]]),
        np.column_stack([side[first], side[second]]),
        degree[node[first]] == 2,
        degree[node[first]] == 3,
    )


def across_junctions(street: Street, through: Through) -> Through:
    """Pair the outer arms of junctions of several nodes, past the short edges between these.

    A road that ends within its junction is left out.
    """
    ends = street.cluster[street.network.edge_nodes]
    inner = ends[:, 0] == ends[:, 1]
    arms = [[(edge, side) for edge, side in zip(*pair, strict=True)]
            for pair in zip(through.edge.tolist(), through.side.tolist(), strict=True)]  # fmt: skip
    onward = {arm: pair[1 - at] for pair in arms for at, arm in enumerate(pair)}
    found: dict[frozenset[tuple[int, int]], int] = {}
    for row, (first, last) in enumerate(arms):
        if inner[first[0]]:
            first, last = last, first
        seen = {first}
        while inner[last[0]] and last not in seen:
            seen.add(last)
            last = onward.get((last[0], 1 - last[1]), last)
        if not inner[first[0]] and not inner[last[0]]:
            arms[row] = [first, last]
            found.setdefault(frozenset(arms[row]), row)
    rows = np.array(list(found.values()), np.int64)
    pairs = np.array([arms[row] for row in rows.tolist()], np.int64).reshape(-1, 2, 2)
    return Through(
        through.node[rows], pairs[:, :, 0], pairs[:, :, 1], through.major[rows], through.tee[rows]
    )


def _pairs(node: IntArray, size: IntArray) -> tuple[IntArray, IntArray]:
    """All pairs of rows of one node, each once; rows are sorted by node."""
    row = np.repeat(np.arange(len(node)), size)
    begin = np.searchsorted(node, node)
    other = begin[row] + numbered(size)
    return row[row < other], other[row < other]


def _bend(first: FloatArray, second: FloatArray) -> FloatArray:
    """(k,) radians by which the way from one bearing to another leaves the straight line."""
    turn = np.mod(second - first, 2 * np.pi)
    return np.asarray(np.round(np.abs(turn - np.pi), 6))


def stems(street: Street, through: Through) -> BoolArray:
    """(e, 2) ends at which a street ends at a road of its own class that goes straight on."""
    network = street.network
    equal = np.zeros((network.edge_count, 2), bool)
    node = network.edge_nodes
    arms = np.bincount(node.ravel(), minlength=len(street.best))
    of_rank = (street.rank[:, None] == street.best[node]) & street.joint[node]
    alike = np.bincount(node[of_rank], minlength=len(arms))
    equal[of_rank & (alike == 3)[node]] = True
    going_on = np.zeros_like(equal)
    going_on[through.edge.ravel(), through.side.ravel()] = True
    crossed = np.zeros(len(arms), bool)
    crossed[through.node] = True
    return np.asarray(equal & ~going_on & crossed[node])
