"""The wood of a tree: tubes along its limbs, swept for all limbs at once."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cityx.assets.trees.skeletons import TWIG, Skeleton
from cityx.city.mesh import MeshBatch, concatenate, one_mesh
from cityx.geometry.arrays import FloatArray, IntArray

FLARE_HEIGHT = 0.42  # metres over which the roots widen the stem
FLARE = 0.95  # share of the radius by which they do at the ground
# Thinnest radius of a limb and the corners it gets, coarse to fine.
FOOT_RINGS = (0.0, 0.07, 0.15, 0.25, 0.38, 0.55, 0.8, 1.1)  # metres above the ground
SIDES = ((0.10, 8), (0.035, 5), (0.0, 3))
FINE_SIDES = ((0.10, 20), (0.035, 8), (0.015, 5), (0.0, 3))


def wood(
    skeleton: Skeleton,
    material: str,
    tint: tuple[float, float, float],
    *,
    thinnest: float,
    limbs: tuple[float, float] = (0.0, np.inf),
    skip: int = 1,
    fine: bool = False,
    cover: float = 0.0,
) -> list[MeshBatch]:
    """Make tubes along the limbs: each continues in its thickest branch, the others start tubes.

    Parameters
    ----------
    skeleton
        Of the tree.
    material, tint
        Of the bark.
    thinnest
        Metres, radius at which tubes end.
    limbs
        Metres, least and largest radius at the foot of the limbs that are drawn.
    skip
        Every how many nodes a ring is made, except on the stem.
    fine
        Whether thick limbs get twice the corners.
    cover
        Metres, least radius of a ring, for twigs that must cover pixels by themselves.
    """
    chain, rank = _chains(skeleton.parent, skeleton.radius)
    node = np.flatnonzero(skeleton.radius >= thinnest)
    node = node[np.lexsort((rank[node], chain[node]))]
    # Every limb but the stem starts inside the one that bears it.
    head = np.flatnonzero(np.r_[True, chain[node][1:] != chain[node][:-1]])
    bearer = skeleton.parent[node[head]]
    ring = np.insert(node, head[1:], bearer[1:])
    limb = np.insert(chain[node], head[1:], chain[node[head[1:]]])
    place = np.arange(len(ring)) - np.searchsorted(limb, limb)
    ends = np.r_[limb[1:] != limb[:-1], True]
    keep = (place % skip == 0) | ends | (limb == 0)
    ring, limb, ends = ring[keep], limb[keep], ends[keep]
    starts = np.r_[True, limb[1:] != limb[:-1]]
    size = np.diff(np.append(np.flatnonzero(starts), len(ring)))
    radius = skeleton.radius[ring].copy()
    after = np.minimum(np.arange(len(ring)) + 1, len(ring) - 1)
    born = starts & (limb != 0)
    radius[born] = np.minimum(radius[born], 1.15 * radius[after[born]])
    radius[ends] *= 0.6
    radius = np.maximum(radius, cover)
    thick = np.repeat(np.maximum.reduceat(radius, np.flatnonzero(starts)), size)
    kept = np.repeat(size > 1, size) & (thick >= limbs[0]) & (thick < limbs[1])
    point = skeleton.position[ring]
    if fine:
        point, radius, limb, thick, kept = _foot_refined(point, radius, limb, thick, kept)
    made = []
    limit = np.inf
    for least, sides in FINE_SIDES if fine else SIDES:
        rows = np.flatnonzero(kept & (thick >= least) & (thick < limit))
        limit = least
        if len(rows):
            made.append(_swept(point[rows], radius[rows], limb[rows], sides,
                               material, tint))  # fmt: skip
    return [concatenate(made)] if made else []


def _foot_refined(
    point: FloatArray,
    radius: FloatArray,
    limb: IntArray,
    thick: FloatArray,
    kept: NDArray[np.bool_],
) -> tuple[FloatArray, FloatArray, IntArray, FloatArray, NDArray[np.bool_]]:
    """Put more rings where the roots widen the stem, which comes first of the limbs."""
    stem = np.flatnonzero(limb == 0)
    z = point[stem, 2]
    more = np.array([level for level in FOOT_RINGS if z[0] < level < z[-1]])
    at = np.searchsorted(z, more)
    fresh = np.column_stack([*(np.interp(more, z, point[stem, axis]) for axis in (0, 1)), more])
    size = np.interp(more, z, radius[stem])
    of_stem = stem[0]
    return (np.insert(point, at, fresh, axis=0), np.insert(radius, at, size),
            np.insert(limb, at, 0), np.insert(thick, at, thick[of_stem]),
            np.insert(kept, at, kept[of_stem]))  # fmt: skip


def _chains(parent: IntArray, radius: FloatArray) -> tuple[IntArray, IntArray]:
    """Cut a tree into limbs: (n,) first node of each node's limb, and place in it."""
    count = len(parent)
    heir = np.full(count, -1)
    order = np.lexsort((np.arange(count), -radius, parent))
    order = order[parent[order] >= 0]
    first = np.r_[True, parent[order][1:] != parent[order][:-1]]
    heir[parent[order[first]]] = order[first]
    goes_on = np.zeros(count, bool)
    goes_on[heir[heir >= 0]] = True
    # Jump to the first node of the limb by doubling.
    up = np.where(goes_on, parent, np.arange(count))
    rank = goes_on.astype(np.int64)
    while True:
        further = up[up]
        rank = rank + rank[up]
        if np.array_equal(further, up):
            return up, rank
        up = further


def _swept(
    points: FloatArray,
    radius: FloatArray,
    limb: IntArray,
    sides: int,
    material: str,
    tint: tuple[float, float, float],
) -> MeshBatch:
    """Sweep circles along polylines given one after the other; ``limb`` tells them apart."""
    count = len(points)
    starts = np.r_[True, limb[1:] != limb[:-1]]
    ends = np.r_[starts[1:], True]
    before = np.where(starts, np.arange(count), np.arange(count) - 1)
    after = np.where(ends, np.arange(count), np.arange(count) + 1)
    ahead = points[after] - points[before]
    ahead /= np.maximum(np.linalg.norm(ahead, axis=1, keepdims=True), 1e-5)
    # One reference per limb keeps its rings from twisting.
    first = np.flatnonzero(starts)
    size = np.diff(np.append(first, count))
    mean = points[first + size - 1] - points[first]
    reference = np.eye(3)[np.argmin(np.abs(mean), axis=1)]
    side = np.cross(np.repeat(reference, size, axis=0), ahead)
    side /= np.maximum(np.linalg.norm(side, axis=1, keepdims=True), 1e-5)
    up = np.cross(ahead, side)
    angle = np.arange(sides) * (2 * np.pi / sides)
    reach = np.broadcast_to(radius[:, None], (count, sides)).copy()
    if sides >= SIDES[0][1]:  # roots: five ridges run out from the stem
        low = np.exp(-np.clip(points[:, 2], 0.0, None) / FLARE_HEIGHT) * (limb == 0)
        reach *= 1 + FLARE * low[:, None] * (0.62 + 0.38 * np.cos(5 * angle + 0.7))
        # No stem is as round as a pipe: flutes that wind a little as they go up.
        turn = 0.35 * points[:, 2:]
        reach *= 1 + 0.035 * np.cos(3 * angle + turn) + 0.02 * np.cos(7 * angle - 1.7 * turn)
    spokes = np.cos(angle)[:, None] * side[:, None, :] + np.sin(angle)[:, None] * up[:, None, :]
    vertices = points[:, None, :] + reach[:, :, None] * spokes  # (n, sides, 3)
    row = np.flatnonzero(~ends)
    k = np.arange(sides)
    a = row[:, None] * sides + k
    b = row[:, None] * sides + (k + 1) % sides
    faces = np.stack([a, b, b + sides, a + sides], axis=2).reshape(-1, 4)
    # Texture: metres round the limb's foot and along the limb.
    whole = 2 * np.pi * np.maximum(radius[first], TWIG)
    # Bark that repeats each metre meets itself where a stem's girth is whole metres.
    whole = np.where(whole > 0.6, np.rint(whole), whole)
    girth = np.repeat(whole, size) / sides
    run = np.cumsum(np.linalg.norm(points - points[before], axis=1))
    run -= np.repeat(run[first], size)
    u = girth[row][:, None] * np.stack([k, k + 1, k + 1, k], axis=1)[:, None, :]  # (sides, f, 4)
    u = np.moveaxis(u, 0, 1)
    v = np.stack([run[row], run[row], run[row + 1], run[row + 1]], axis=1)
    v = np.broadcast_to(v[:, None, :], u.shape)
    uv = np.stack([u, v], axis=3).reshape(-1, 4, 2)
    return one_mesh(0, vertices.reshape(-1, 3), faces, materials=(material,), uv=uv, tint=tint)
