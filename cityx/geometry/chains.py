"""Graphs as arrays of node pairs: chains, components, interpolation."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cityx.geometry.arrays import IntArray

EVEN = 1e-12  # squared slope left per node at which interpolation is done


def join_segments(segments: ArrayLike, section: ArrayLike) -> tuple[IntArray, IntArray]:
    """Join directed segments head to tail where exactly one of the same section follows another.

    Parameters
    ----------
    segments
        (m, 2) int, start and end node of each segment.
    section
        (m,) int; segments of different sections are never joined.

    Returns
    -------
    head
        (m,) the first segment of the chain each segment belongs to. A closed chain starts at its
        lowest node.
    rank
        (m,) position in the chain, from 0.
    """
    segments = np.asarray(segments, dtype=np.int64).reshape(-1, 2)
    section = np.asarray(section, dtype=np.int64)
    count = len(segments)
    if not count:
        return np.zeros(0, np.int64), np.zeros(0, np.int64)
    nodes = int(segments.max()) + 1
    source, target = segments.T
    leaving = np.bincount(source, minlength=nodes)
    arriving = np.bincount(target, minlength=nodes)
    outgoing, incoming = np.zeros(nodes, np.int64), np.zeros(nodes, np.int64)
    outgoing[source] = incoming[target] = np.arange(count)
    through = (leaving == 1) & (arriving == 1) & (section[outgoing] == section[incoming])
    previous = np.where(through[source], incoming[source], -1)
    head, rank = _walk(previous)
    closed = previous[head] >= 0
    if closed.any():
        low, jump = source.copy(), np.where(closed, previous, np.arange(count))
        for _ in range(count.bit_length()):
            low, jump = np.minimum(low, low[jump]), jump[jump]
        previous[closed & (source == low)] = -1
        head, rank = _walk(previous)
    return head, rank


def _walk(previous: IntArray) -> tuple[IntArray, IntArray]:
    """Follow `previous` to its end by pointer doubling: the end reached and the steps taken."""
    head = np.where(previous >= 0, previous, np.arange(len(previous)))
    rank = (previous >= 0).astype(np.int64)
    for _ in range(len(previous).bit_length()):
        if not rank[head].any():
            break
        rank, head = rank + rank[head], head[head]
    return head, rank


def components(pairs: ArrayLike, count: int) -> IntArray:
    """Label the connected components of a graph.

    Parameters
    ----------
    pairs
        (m, 2) int, edges between nodes.
    count
        Number of nodes.

    Returns
    -------
    lowest
        (count,) the lowest node of the component of each node.
    """
    one, other = np.asarray(pairs, dtype=np.int64).reshape(-1, 2).T
    lowest = np.arange(count)
    while True:
        one, other = lowest[one], lowest[other]
        apart = one != other
        if not apart.any():
            return lowest
        one, other = one[apart], other[apart]
        # Hook the root of the higher end to the lower one, then flatten the trees.
        np.minimum.at(lowest, np.maximum(one, other), np.minimum(one, other))
        while (lowest[lowest] != lowest).any():
            lowest = lowest[lowest]


def interpolate(
    pairs: ArrayLike, length: ArrayLike, known: ArrayLike, values: ArrayLike
) -> NDArray[np.float64]:
    """Spread values along a graph so that they change evenly from one known node to the next.

    Parameters
    ----------
    pairs, length
        (m, 2) int and (m,) float, edges and their lengths, above zero.
    known
        (n,) bool, nodes whose value is given; every component needs one.
    values
        (n,) float, read at the known nodes, a first guess elsewhere.

    Returns
    -------
    values
        (n,) float; linear along a chain, and balanced by inverse length where chains meet.

    References
    ----------
    Hestenes and Stiefel, "Methods of conjugate gradients for solving linear systems", 1952.
    """
    pairs = np.asarray(pairs, dtype=np.int64).reshape(-1, 2)
    pull = 1.0 / np.asarray(length, dtype=float)
    known = np.asarray(known, dtype=bool)
    size = len(known)
    a, b = pairs.T

    def tension(x: NDArray[np.float64]) -> NDArray[np.float64]:
        flow = pull * (x[a] - x[b])
        total = np.bincount(a, flow, minlength=size) - np.bincount(b, flow, minlength=size)
        return np.asarray(np.where(known, 0.0, total))

    x = np.asarray(values, dtype=float).copy()
    rest = -tension(x)
    step = rest.copy()
    energy = float(rest @ rest)
    for _ in range(4 * size):
        if energy < EVEN * size:
            break
        pulled = tension(step)
        stride = energy / float(step @ pulled)
        x += stride * step
        rest -= stride * pulled
        energy, before = float(rest @ rest), energy
        step = rest + (energy / before) * step
    return x
