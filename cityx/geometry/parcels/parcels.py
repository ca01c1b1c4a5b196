"""Parcels: blocks between streets cut into plots, each with its front on the street."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import shapely
from numpy.typing import ArrayLike, NDArray

from cityx.errors import UsageError
from cityx.geometry.arrays import FloatArray, IntArray
from cityx.geometry.parcels.block_splits import Pieces, joined_pieces, split_blocks
from cityx.geometry.parcels.block_strips import strip_blocks
from cityx.geometry.parcels.street_edges import fronts_of, street_edges, street_lines
from cityx.geometry.ranges import numbered
from cityx.geometry.seams import moved, on_grid, unite
from cityx.ids import UInt64Array, hash_ids, uniform

# Adoption: pieces of land without a street, or too small, join the neighbour they touch most.

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


DOOR = 1.2  # metres of street that every parcel has at least
SPREAD = 0.1  # of the frontage, how much blocks of a zone differ
STREET = 0.25  # of the wanted frontage that a halved piece has at least
SHARE = 0.45  # of the wanted area; a smaller strip parcel joins its neighbour
UNDIVIDED = 4.0  # times the wanted area from which a block is not to be one parcel
ROUND = 6  # decimals of metres to which borders of blocks are read


@dataclass(frozen=True)
class Scheme:
    """How a zone cuts its blocks: from its least to its most dense places.

    Attributes
    ----------
    frontage, depth
        Metres along the street and away from it.
    strips
        Whether blocks are cut into strips along their streets, or halved.
    """

    frontage: tuple[float, float]
    depth: tuple[float, float]
    strips: bool


SCHEMES: Mapping[str, Scheme] = {
    "core": Scheme((42.0, 34.0), (42.0, 36.0), strips=False),
    "midrise": Scheme((24.0, 16.0), (34.0, 28.0), strips=True),
    "row": Scheme((7.5, 5.4), (30.0, 26.0), strips=True),
    "semi": Scheme((22.0, 18.0), (34.0, 27.0), strips=True),
    "suburb": Scheme((22.0, 13.5), (36.0, 27.0), strips=True),
    "rural": Scheme((48.0, 28.0), (60.0, 45.0), strips=True),
    "industry": Scheme((80.0, 60.0), (80.0, 65.0), strips=False),
    "campus": Scheme((130.0, 100.0), (110.0, 90.0), strips=False),
    "slab": Scheme((120.0, 90.0), (90.0, 75.0), strips=False),
    "retail strip": Scheme((60.0, 40.0), (60.0, 48.0), strips=False),
}


@dataclass(frozen=True)
class Parcels:
    """m parcels, those of a block together.

    Attributes
    ----------
    shapes
        (m,) polygons, metres.
    block
        (m,) row of each parcel's block.
    id
        (m,) uint64, the same whatever other blocks are cut with it.
    front
        (m, 2, 2) ends of its main edge on the street, the parcel on the left hand.
    street
        (m,) lines; all of its edges on the street.
    block_id
        (m,) uint64 id of its block.
    """

    shapes: NDArray[Any]
    block: IntArray
    id: UInt64Array
    front: FloatArray
    street: NDArray[Any]
    block_id: UInt64Array

    def take(self, rows: Any) -> Parcels:
        """Return some of the parcels."""
        return Parcels(
            self.shapes[rows], self.block[rows], self.id[rows], self.front[rows],
            self.street[rows], self.block_id[rows],
        )  # fmt: skip


def parcels_of(
    blocks: ArrayLike, ids: ArrayLike, zone: ArrayLike, density: ArrayLike, *, seed: int
) -> Parcels:
    """Cut blocks into parcels that cover them and all touch the street.

    A piece that rounding parts from the street is left out.

    Parameters
    ----------
    blocks
        (n,) valid polygons, metres, in any frame; their whole border, holes included, is street.
        Corners are read to the micrometre.
    ids
        (n,) uint64, ids of the blocks.
    zone
        (n,) words of `SCHEMES`.
    density
        (n,) 0 to 1; the denser, the smaller the parcels.

    Raises
    ------
    UsageError
        For an unknown zone or a block that is no valid polygon.
    """
    blocks = np.asarray(blocks, object)
    ids = np.asarray(ids, np.uint64)
    zones = np.asarray(zone, object)
    density = np.clip(np.asarray(density, float), 0.0, 1.0)
    _checked(blocks, zones)
    if not len(blocks):
        none = np.zeros(0, np.int64)
        lines = np.zeros(0, object)
        return Parcels(blocks, none, ids, np.zeros((0, 2, 2)), lines, ids)
    origin = np.floor(shapely.bounds(blocks)[:, :2])
    local = moved(blocks, -origin, ROUND)
    streets = shapely.boundary(local)
    pieces = _cut(local, streets, ids, zones, density, seed=seed)
    wanted = _wanted_area(zones, density)
    pieces = _on_the_street(pieces, local, streets, wanted)
    pieces = _halved_instead(pieces, local, streets, ids, _sizes(zones, density), seed=seed)
    order = np.lexsort((pieces.code, pieces.block))
    block, code = pieces.block[order], pieces.code[order]
    shapes = on_grid(pieces.shapes[order])
    edges = street_edges(shapes, streets, block)
    front = fronts_of(edges, len(shapes), pieces.heading[order])
    shift = origin[block]
    found = Parcels(
        moved(shapes, shift),
        block,
        hash_ids(0, "parcel", ids[block], code),
        front + shift[:, None],
        moved(street_lines(edges, len(shapes)), shift),
        ids[block],
    )
    reached = np.isfinite(front).all(axis=(1, 2))
    return found if reached.all() else found.take(reached)


def _checked(blocks: NDArray[Any], zones: NDArray[Any]) -> None:
    """Refuse what cannot be cut, all at once."""
    wrong = (shapely.get_type_id(blocks) != 3) | ~shapely.is_valid(blocks)
    wrong |= shapely.is_empty(blocks)
    faults = [f"block {row} is not a valid polygon" for row in np.flatnonzero(wrong).tolist()]
    unknown = sorted({str(word) for word in zones if word not in SCHEMES})
    faults += [f"zone {word!r} is none of {', '.join(SCHEMES)}" for word in unknown]
    if faults:
        raise UsageError("; ".join(faults))


def _sizes(zones: NDArray[Any], density: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return wanted frontage and depth of parcels, (n,) metres each."""
    schemes = [SCHEMES[word] for word in zones]
    frontage = np.array([scheme.frontage for scheme in schemes])
    depth = np.array([scheme.depth for scheme in schemes])
    return (
        frontage[:, 0] + density * (frontage[:, 1] - frontage[:, 0]),
        depth[:, 0] + density * (depth[:, 1] - depth[:, 0]),
    )


def _wanted_area(zones: NDArray[Any], density: FloatArray) -> FloatArray:
    frontage, depth = _sizes(zones, density)
    return np.asarray(frontage * depth)


def _cut(
    blocks: NDArray[Any],
    streets: NDArray[Any],
    ids: UInt64Array,
    zones: NDArray[Any],
    density: FloatArray,
    *,
    seed: int,
) -> Pieces:
    """Cut each block the way of its zone."""
    spread = 1.0 + SPREAD * (2 * uniform(seed, "parcel/size", ids) - 1)
    frontage, depth = _sizes(zones, density)
    frontage = frontage * spread
    by_strips = np.array([SCHEMES[word].strips for word in zones], bool)
    made = []
    rows = np.flatnonzero(by_strips)
    if len(rows):
        cut = strip_blocks(blocks[rows], ids[rows], frontage[rows], depth[rows], seed=seed)
        made.append(Pieces(cut.shapes, rows[cut.block], cut.code, cut.heading))
    rows = np.flatnonzero(~by_strips)
    if len(rows):
        cut = split_blocks(
            blocks[rows], streets[rows], ids[rows], (frontage * depth)[rows],
            STREET * frontage[rows], seed=seed,
        )  # fmt: skip
        made.append(Pieces(cut.shapes, rows[cut.block], cut.code, cut.heading))
    return joined_pieces(made)


def _halved_instead(
    pieces: Pieces,
    blocks: NDArray[Any],
    streets: NDArray[Any],
    ids: UInt64Array,
    sizes: tuple[FloatArray, FloatArray],
    *,
    seed: int,
) -> Pieces:
    """Halve large blocks that strips did not divide, whose outline is too crooked for them."""
    count = np.bincount(pieces.block, minlength=len(blocks))
    wanted = sizes[0] * sizes[1]
    rows = np.flatnonzero((count == 1) & (shapely.area(blocks) > UNDIVIDED * wanted))
    if not len(rows):
        return pieces
    front = STREET * sizes[0][rows]
    cut = split_blocks(blocks[rows], streets[rows], ids[rows], wanted[rows], front, seed=seed)
    cut = _on_the_street(cut, blocks[rows], streets[rows], wanted[rows])
    cut = replace(cut, block=rows[cut.block])
    return joined_pieces([pieces.take(~np.isin(pieces.block, rows)), cut])


def _on_the_street(
    pieces: Pieces, blocks: NDArray[Any], streets: NDArray[Any], wanted: FloatArray
) -> Pieces:
    """Join pieces without a door to the street, or too small, with a neighbour."""
    edges = street_edges(pieces.shapes, streets, pieces.block)
    count = len(pieces.shapes)
    door = np.zeros(count)
    np.maximum.at(door, edges.owner, edges.length)
    area = shapely.area(pieces.shapes)
    orphan = (door < DOOR) | (area < SHARE * wanted[pieces.block])
    orphan &= ~_best_of_orphans(pieces.block, orphan, door, area)
    shapes, parent = adopt(pieces.shapes, pieces.block, orphan)
    kept = parent == np.arange(count)
    # Whatever could not be united: the block is one parcel.
    broken = kept & (orphan | (shapely.get_type_id(shapes) != 3))
    lost = np.zeros(len(blocks), bool)
    lost[pieces.block[broken]] = True
    rows = np.flatnonzero(kept & ~lost[pieces.block])
    whole = np.flatnonzero(lost)
    return joined_pieces([
        replace(pieces, shapes=shapes).take(rows),
        Pieces(blocks[whole], whole, np.zeros(len(whole), np.uint64),
               np.full((len(whole), 2), np.nan)),
    ])  # fmt: skip


def _best_of_orphans(
    block: IntArray, orphan: NDArray[np.bool_], door: FloatArray, area: FloatArray
) -> NDArray[np.bool_]:
    """Mark one piece in each block that has orphans only: with a door, then the largest."""
    order = np.lexsort((np.arange(len(block)), -np.round(area, 6), door < DOOR, block))
    first = np.ones(len(order), bool)
    first[1:] = block[order][1:] != block[order][:-1]
    best = np.zeros(len(block), bool)
    alone = np.ones(int(block.max()) + 1, bool)
    alone[block[~orphan]] = False
    best[order[first]] = True
    return np.asarray(best & alone[block] & orphan)
