"""Streets that end blindly: one into the middle of a block that is too deep for its rim."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

LENGTH = (38.0, 85.0)  # metres of such a street
GAP = 30.0  # metres from its end to other streets
SIDE = 27.0  # metres from its line to other streets
FOOT = 34.0  # metres from where it begins to the next junction
STEP = 9.0  # metres between the places where it might begin
BLIND = -1  # family of its street


@dataclass(frozen=True)
class Net:
    """Streets as a graph; n nodes, m links.

    Attributes
    ----------
    nodes
        (n, 2) metres.
    links
        (m, 2) rows of nodes.
    street
        (m, 2) family and line of each link's street.
    """

    nodes: FloatArray
    links: IntArray
    street: IntArray


def with_blind_streets(
    net: Net,
    sides: NDArray[Any],
    doors: Sequence[FloatArray],
    *,
    often: float,
    least: float,
    drawn: Callable[[int], float],
) -> tuple[Net, IntArray]:
    """Lead streets into large blocks, as many as there is room for.

    Parameters
    ----------
    net
        Streets of a district.
    sides
        (s,) lines of its rim.
    doors
        Per side, (d, 2) places where streets may meet it.
    often
        Share of the large blocks that get one.
    least
        Square metres from which a block is large.
    drawn
        Gives the number in [0, 1) that decides for the k-th block.

    Returns
    -------
    net
        With the new streets: family `BLIND`, numbered; new nodes come last.
    ends
        (e,) rows of the nodes where they end.
    """
    if not len(net.links):
        return net, np.zeros(0, np.int64)
    lines = shapely.linestrings(net.nodes[net.links])
    outline = _divided(sides, doors)
    faces = np.asarray(shapely.get_parts(shapely.polygonize([*lines, *outline])))
    box = np.round(shapely.bounds(faces), 3)
    faces = faces[np.lexsort(box.T)]
    ends: list[int] = []
    for k in np.flatnonzero(shapely.area(faces) >= least).tolist():
        if drawn(k) >= often:
            continue
        rim = faces[k].exterior
        for _ in range(int(faces[k].area / least)):
            found = _into(net, faces[k], rim)
            if found is None:
                break
            net = _added(net, *found, number=len(ends))
            ends.append(len(net.nodes) - 1)
            rim = shapely.union(rim, shapely.LineString(found[1:]))
    return net, np.array(ends, np.int64)


def _divided(sides: NDArray[Any], doors: Sequence[FloatArray]) -> list[Any]:
    """Return the pieces of the rim between the places where streets meet it."""
    pieces = []
    for side, places in zip(sides.tolist(), doors, strict=True):
        points = shapely.get_coordinates(side)
        own = shapely.line_locate_point(side, shapely.points(points))
        at = np.concatenate([own, shapely.line_locate_point(side, shapely.points(places))])
        order = np.argsort(at, kind="stable")
        every = np.concatenate([points, places])[order]
        pieces += [shapely.LineString(pair) for pair in pairwise(every)]
    return pieces


def _into(net: Net, face: Any, rim: Any) -> tuple[int, FloatArray, FloatArray] | None:
    """Find the best street into a block: the link it begins on, where, and where it ends.

    Parameters
    ----------
    rim
        The block's outline, with the blind streets it already has.
    """
    shapely.prepare([face, rim])
    middle = shapely.line_interpolate_point(
        shapely.linestrings(net.nodes[net.links]), 0.5, normalized=True
    )
    # Dead ends have the block on both sides, so they are no place to begin.
    own = np.flatnonzero((shapely.distance(middle, rim) < 1e-6) & (net.street[:, 0] >= 0))
    if not len(own):
        return None
    start, end = net.nodes[net.links[own, 0]], net.nodes[net.links[own, 1]]
    length = np.hypot(*(end - start).T)
    count = np.maximum((length / STEP).astype(np.int64), 1)
    row = np.repeat(np.arange(len(own)), count)
    k = np.arange(len(row)) - np.repeat(np.cumsum(count) - count, count)
    t = (k + 0.5) / count[row]
    way = (end - start)[row] / length[row][:, None]
    foot = start[row] + (t * length[row])[:, None] * way
    foot = np.round(foot, 3)
    normal = np.stack([-way[:, 1], way[:, 0]], axis=1)
    inward = shapely.contains_xy(face, foot + normal)
    normal = np.where(inward[:, None], normal, -normal)
    ray = shapely.linestrings(np.stack([foot + normal, foot + 400.0 * normal], axis=1))
    reach = shapely.distance(shapely.points(foot), shapely.intersection(ray, rim))
    size = np.minimum(np.nan_to_num(reach) - GAP, LENGTH[1])
    tip = np.round(foot + size[:, None] * normal, 3)
    body = shapely.linestrings(np.stack([foot + (SIDE + 1.0) * normal, tip], axis=1))
    degree = np.bincount(net.links.ravel(), minlength=len(net.nodes))
    ring = shapely.get_coordinates(face.exterior)
    junctions = _junctions(net, degree, ring)
    clear = shapely.distance(shapely.points(foot), junctions) >= FOOT
    good = (size >= LENGTH[0]) & clear & (shapely.distance(body, rim) >= SIDE)
    good &= shapely.distance(shapely.points(tip), rim) >= GAP - 2.0
    if not good.any():
        return None
    # The deepest ends lie farthest from every other street.
    depth = np.where(good, shapely.distance(shapely.points(tip), rim) + 0.3 * size, -1.0)
    best = int(np.argmax(np.round(depth, 3)))
    return int(own[row[best]]), foot[best], tip[best]


def _junctions(net: Net, degree: IntArray, ring: FloatArray) -> Any:
    """Return the places on a block's rim where streets meet or bend sharply, as one geometry."""
    before, after = ring[:-1] - np.roll(ring[:-1], 1, axis=0), np.diff(ring, axis=0)
    cross = before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0]
    turn = np.abs(np.arctan2(cross, (before * after).sum(axis=1)))
    sharp = ring[:-1][turn > np.radians(30.0)]
    return shapely.MultiPoint(
        np.concatenate([net.nodes[degree > 2], net.nodes[degree == 1], sharp])
    )


def _added(net: Net, link: int, foot: FloatArray, tip: FloatArray, *, number: int) -> Net:
    count = len(net.nodes)
    first, second = net.links[link].tolist()
    links = net.links.copy()
    links[link] = first, count
    more = np.array([(count, second), (count, count + 1)])
    street = np.concatenate([net.street, [net.street[link], (BLIND, number)]])
    return Net(np.concatenate([net.nodes, [foot, tip]]), np.concatenate([links, more]), street)
