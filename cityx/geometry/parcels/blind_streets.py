"""Streets into blocks that are too large: through streets, or dead ends into their middle."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.geometry.arrays import FloatArray, IntArray
from cityx.geometry.ranges import numbered

LENGTH = (38.0, 85.0)  # metres of such a street
GAP = 30.0  # metres from its end to other streets
SIDE = 27.0  # metres from its line to other streets
FOOT = 34.0  # metres from where it begins to the next junction
VAST = 2.2  # times the size of a large block from which every one gets its street
STEP = 9.0  # metres between the places where it might begin
THROUGH = (70.0, 220.0)  # metres of a street that halves a block
SLANT = 0.45  # cosine of the least angle at which it meets the street across
FAR = 400.0  # metres across the widest block
ON = 1e-6  # metres
BLIND, CROSS = -1, 2  # families of streets


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

    @cached_property
    def lines(self) -> NDArray[Any]:
        """(m,) links as lines."""
        return np.asarray(shapely.linestrings(self.nodes[self.links]), object)

    @cached_property
    def middles(self) -> FloatArray:
        """(m, 2) middles of the links."""
        points = shapely.line_interpolate_point(self.lines, 0.5, normalized=True)
        return np.asarray(shapely.get_coordinates(points))


def with_blind_streets(
    net: Net,
    sides: NDArray[Any],
    doors: Sequence[FloatArray],
    *,
    often: float,
    least: float,
    blind: bool,
    drawn: Callable[[int], float],
) -> tuple[Net, IntArray]:
    """Add streets to large blocks: one that halves it, else dead ends.

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
    blind
        Whether streets may end blindly.
    drawn
        Gives the number in [0, 1) that decides for the k-th block.

    Returns
    -------
    net
        With the new streets, of the families `CROSS` and `BLIND`; new nodes come last.
    ends
        (e,) rows of the nodes where they end.
    """
    if not len(net.links):
        return net, np.zeros(0, np.int64)
    outline = _divided(sides, doors)
    faces = np.asarray(shapely.get_parts(shapely.polygonize([*net.lines, *outline])))
    box = np.round(shapely.bounds(faces), 3)
    faces = faces[np.lexsort(box.T)]
    ends: list[int] = []
    for k in np.flatnonzero(shapely.area(faces) >= least).tolist():
        if drawn(k) >= often and faces[k].area < VAST * least:
            continue
        through = _into(net, faces[k], faces[k].exterior, blind=False)
        if through is not None:
            net = _added(net, *through, (CROSS, k))
            continue
        rim = faces[k].exterior
        for _ in range(int(faces[k].area / least) if blind else 0):
            found = _into(net, faces[k], rim, blind=True)
            if found is None:
                break
            net = _added(net, *found, (BLIND, len(ends)))
            ends.append(len(net.nodes) - 1)
            rim = shapely.union(rim, shapely.LineString(found[1:3]))
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
        pieces += shapely.linestrings(np.stack([every[:-1], every[1:]], axis=1)).tolist()
    return pieces


@dataclass(frozen=True)
class _Offers:
    """Streets that might lead into a block, k of them.

    Attributes
    ----------
    link
        (k,) row of the link each begins on.
    foot, tip
        (k, 2) its ends.
    worth
        (k,) the more the better, -1 where it is not possible.
    across
        (k,) row of the link it ends on, -1 where it ends blindly.
    """

    link: IntArray
    foot: FloatArray
    tip: FloatArray
    worth: FloatArray
    across: IntArray

    def best(self) -> tuple[int, FloatArray, FloatArray, int] | None:
        """Return link, foot, tip and the link across of the best one."""
        if not len(self.worth) or self.worth.max() < 0:
            return None
        k = int(np.argmax(np.round(self.worth, 3)))
        return int(self.link[k]), self.foot[k], self.tip[k], int(self.across[k])


def _into(
    net: Net, face: Any, rim: Any, *, blind: bool
) -> tuple[int, FloatArray, FloatArray, int] | None:
    """Find the best street into a block.

    Parameters
    ----------
    rim
        The block's outline, with the blind streets it already has.
    blind
        Whether it may end blindly; else it must lead to a street of the district across.
    """
    shapely.prepare([face, rim])
    lines = net.lines
    own = _bounding(net, face, rim)
    if not len(own):
        return None
    junctions = _junctions(net, face)
    row, foot, normal = _feet(net, face, own)
    clear = shapely.distance(shapely.points(foot), junctions) >= FOOT
    row, foot, normal = row[clear], foot[clear], normal[clear]
    ray = shapely.linestrings(np.stack([foot + normal, foot + FAR * normal], axis=1))
    reach = shapely.distance(shapely.points(foot), shapely.intersection(ray, rim))
    reach = np.nan_to_num(reach)
    if blind:
        size = np.minimum(reach - GAP, LENGTH[1])
        across = np.full(len(foot), -1)
        fits = size >= LENGTH[0]
    else:
        size = reach
        across, fits = _crossed(net, lines, own, foot + size[:, None] * normal, normal)
        fits &= (size >= THROUGH[0]) & (size <= THROUGH[1])
        there = shapely.points(foot + size[:, None] * normal)
        fits &= shapely.distance(there, junctions) >= FOOT
    tip = np.round(foot + size[:, None] * normal, 3)
    end = foot + np.maximum(size - (0.0 if blind else SIDE + 1.0), SIDE + 2.0)[:, None] * normal
    body = shapely.linestrings(np.stack([foot + (SIDE + 1.0) * normal, end], axis=1))
    good = fits & (shapely.distance(body, rim) >= SIDE)
    if blind:
        depth = shapely.distance(shapely.points(tip), rim)
        good &= depth >= GAP - 2.0
        worth = depth + 0.3 * size
    else:  # halves a block where both halves are alike
        worth = shapely.distance(body, junctions)
    return _Offers(own[row], foot, tip, np.where(good, worth, -1.0), across).best()


def _bounding(net: Net, face: Any, rim: Any) -> IntArray:
    """Return the links on a block's outline that a street into it may begin on."""
    low, high = np.array(face.bounds).reshape(2, 2) + np.array([[-ON], [ON]])
    near = ((net.middles >= low) & (net.middles <= high)).all(axis=1)
    # Dead ends have the block on both sides, so they are no place to begin.
    rows = np.flatnonzero(near & (net.street[:, 0] >= 0))
    return np.asarray(rows[shapely.distance(shapely.points(net.middles[rows]), rim) < ON])


def _feet(net: Net, face: Any, own: IntArray) -> tuple[IntArray, FloatArray, FloatArray]:
    """Return places along links: row of the link, place, and the normal into the block."""
    start, end = net.nodes[net.links[own, 0]], net.nodes[net.links[own, 1]]
    length = np.hypot(*(end - start).T)
    count = np.maximum((length / STEP).astype(np.int64), 1)
    row = np.repeat(np.arange(len(own)), count)
    k = numbered(count)
    t = (k + 0.5) / count[row]
    way = (end - start)[row] / length[row][:, None]
    foot = np.round(start[row] + (t * length[row])[:, None] * way, 3)
    normal = np.stack([-way[:, 1], way[:, 0]], axis=1)
    inward = shapely.contains_xy(face, foot + normal)
    return row, foot, np.where(inward[:, None], normal, -normal)


def _crossed(
    net: Net, lines: NDArray[Any], own: IntArray, tip: FloatArray, way: FloatArray
) -> tuple[IntArray, NDArray[np.bool_]]:
    """Return the link that each line ends on, and whether it meets it squarely."""
    tree = shapely.STRtree(lines[own])
    at = own[tree.nearest(shapely.points(tip))]
    on = shapely.distance(lines[at], shapely.points(tip)) < ON
    along = net.nodes[net.links[at, 1]] - net.nodes[net.links[at, 0]]
    along = along / np.hypot(*along.T)[:, None]
    square = np.abs((along * way).sum(axis=1)) <= SLANT
    return at, on & square


def _junctions(net: Net, face: Any) -> Any:
    """Return the places on a block's rim where streets meet or bend sharply, as one geometry."""
    ring = shapely.get_coordinates(face.exterior)
    degree = np.bincount(net.links.ravel(), minlength=len(net.nodes))
    before, after = ring[:-1] - np.roll(ring[:-1], 1, axis=0), np.diff(ring, axis=0)
    cross = before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0]
    turn = np.abs(np.arctan2(cross, (before * after).sum(axis=1)))
    sharp = ring[:-1][turn > np.radians(30.0)]
    return shapely.MultiPoint(
        np.concatenate([net.nodes[degree > 2], net.nodes[degree == 1], sharp])
    )


def _added(
    net: Net, link: int, foot: FloatArray, tip: FloatArray, across: int, street: tuple[int, int]
) -> Net:
    """Add a street from a link; one that ends on another link divides that too."""
    count = len(net.nodes)
    links, names = net.links.copy(), [net.street]
    more = [(count, int(links[link, 1])), (count, count + 1)]
    names.append(np.array([net.street[link], street]))
    links[link, 1] = count
    if across >= 0:
        more.append((count + 1, int(links[across, 1])))
        names.append(net.street[across][None])
        links[across, 1] = count + 1
    return Net(
        np.concatenate([net.nodes, [foot, tip]]),
        np.concatenate([links, np.array(more)]),
        np.concatenate(names),
    )
