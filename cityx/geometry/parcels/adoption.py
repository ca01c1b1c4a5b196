"""Adoption: pieces of land without a street, or too small, join the neighbour they touch most."""

from __future__ import annotations

from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.geometry.polygons import FloatArray, IntArray
from cityx.geometry.ranges import numbered
from cityx.geometry.seams import unite

WIDTH = 0.01  # metres; of the margin along which contact is measured
LEAST_CONTACT = 0.5  # metres; pieces that touch less do not make one plot
ROUNDS = 60  # of adoption; far more than pieces lie behind one another


def adopt(
    shapes: NDArray[Any], block: IntArray, orphan: NDArray[np.bool_]
) -> tuple[NDArray[Any], IntArray]:
    """Merge orphans with a neighbour in their block that has a street.

    Parameters
    ----------
    shapes
        (m,) polygons, those of a block apart and edge to edge.
    block
        (m,) row of the block of each.
    orphan
        (m,) whether it shall be adopted.

    Returns
    -------
    united, parent
        (m,) shapes, of which only the rows that are their own parent count, and (m,) the row that
        each became part of. Orphans that touch no other piece stay their own.
    """
    shapes, left = shapes.copy(), orphan.copy()
    parent = np.arange(len(shapes))
    for _ in range(ROUNDS):
        child, adopter = _matches(shapes, block, left, parent)
        if not len(child):
            break
        shapes[adopter] = unite(shapes[adopter], shapes[child])
        parent[child] = adopter
        left[child] = False
    while (parent[parent] != parent).any():
        parent = parent[parent]
    return shapes, parent


def _matches(
    shapes: NDArray[Any], block: IntArray, left: NDArray[np.bool_], parent: IntArray
) -> tuple[IntArray, IntArray]:
    """Pair orphans with the adopter of longest contact, at most one for each adopter."""
    orphans = np.flatnonzero(left)
    homes = np.flatnonzero(~left & (parent == np.arange(len(shapes))))
    homes = homes[np.argsort(block[homes], kind="stable")]
    low = np.searchsorted(block[homes], block[orphans])
    high = np.searchsorted(block[homes], block[orphans], side="right")
    child = np.repeat(orphans, high - low)
    home = homes[np.repeat(low, high - low) + numbered(high - low)]
    margin = np.full(len(shapes), None, object)
    margin[orphans] = shapely.buffer(shapes[orphans], WIDTH, join_style="mitre")
    near = _boxes_meet(shapely.bounds(margin[child]), shapely.bounds(shapes[home]))
    child, home = child[near], home[near]
    contact = shapely.area(shapely.intersection(margin[child], shapes[home])) / WIDTH
    touching = contact > LEAST_CONTACT
    child, home, contact = child[touching], home[touching], contact[touching]
    order = np.lexsort((home, -np.round(contact, 6), child))
    order = order[_first_of(child[order])]  # the best home of each orphan
    order = order[np.lexsort((child[order], -np.round(contact[order], 6), home[order]))]
    order = order[_first_of(home[order])]  # the best orphan of each home
    return child[order], home[order]


def _first_of(sorted_values: IntArray) -> NDArray[np.bool_]:
    first = np.ones(len(sorted_values), bool)
    first[1:] = sorted_values[1:] != sorted_values[:-1]
    return first


def _boxes_meet(a: FloatArray, b: FloatArray) -> NDArray[np.bool_]:
    return np.asarray((a[:, :2] <= b[:, 2:]).all(axis=1) & (b[:, :2] <= a[:, 2:]).all(axis=1))
