"""Streets that nobody drew with a ruler: winding between blocks, or in rings around a square."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from cityx.geometry.arrays import FloatArray, IntArray
from cityx.geometry.chains import components
from cityx.geometry.parcels.street_patterns import Box, Pattern
from cityx.geometry.scatter import cell_ids
from cityx.ids import uniform

JITTER = 0.4  # of the pitch by which the middle of a block is shaken at most
STRETCH = 1.2  # times that blocks are longer than wide
JOINED = 0.3  # of the pitch; junctions nearer than that are one
ONWARD = np.radians(50.0)  # most that a street turns at a junction to run on
LOCAL = 0  # family of streets
AVENUE, RING, SQUARE, ARC, SPOKE = 5, 6, 7, 0, 1  # families of streets
STEP = 25.0  # metres between the points of an arc
LAST = 0.8  # of the way to the nearest border, where the outermost ring runs
STAGGER = 0.3  # of the metres between two arcs, by which those of neighbouring sectors differ
ASIDE = 0.24  # of the way between two spokes, by which those on both sides of an arc differ
SIDE = 38.0  # metres along the street round the square between two avenues
LEAST = 40.0  # metres from the middle of the square to the street round it


def winding(box: Box, seed: int, *, pitch: float, angle: float) -> Pattern:
    """Lay streets along the borders of the cells of a shaken lattice.

    Parameters
    ----------
    box
        What they must cover, metres.
    pitch
        Metres from block to block.
    angle
        Direction in which blocks are longer, radians.

    References
    ----------
    The Voronoi diagram of the shaken points, short sides joined to one junction.
    """
    from scipy.spatial import Voronoi

    found = Voronoi(_sites(box, seed, pitch, angle))
    links = np.array([pair for pair in found.ridge_vertices if min(pair) >= 0], np.int64)
    low, high = np.array(box[:2]) - pitch, np.array(box[2:]) + pitch
    inside = ((found.vertices >= low) & (found.vertices <= high)).all(axis=1)
    links = links[inside[links].all(axis=1)]
    nodes, links = _joined(found.vertices, links, JOINED * pitch)
    street = np.column_stack([np.full(len(links), LOCAL), streets_of(nodes, links)])
    return Pattern(nodes, links, street, links.copy())


def _sites(box: Box, seed: int, pitch: float, angle: float) -> FloatArray:
    """Return the points whose cells are blocks, (n, 2) metres."""
    reach = math.hypot(box[2] - box[0], box[3] - box[1]) / 2 + 3 * pitch
    middle = np.array([(box[0] + box[2]) / 2, (box[1] + box[3]) / 2])
    count = math.ceil(reach / pitch * STRETCH) + 1
    i = np.arange(-count, count + 1)
    keys = np.stack(np.meshgrid(i, i, indexing="ij"), axis=-1).reshape(-1, 2)
    ids = cell_ids(keys)
    shaken = np.stack([uniform(seed, "winding", ids, k) for k in (0, 1)], axis=1)
    # Every other row is shifted by half, so that three blocks meet in most junctions.
    at = keys + JITTER * (2 * shaken - 1) + np.column_stack([0.5 * (keys[:, 1] % 2), 0 * ids])
    u, v = at[:, 0] * pitch * math.sqrt(STRETCH), at[:, 1] * pitch / math.sqrt(STRETCH)
    c, s = math.cos(angle), math.sin(angle)
    return np.asarray(middle + np.stack([c * u - s * v, s * u + c * v], axis=1))


def _joined(nodes: FloatArray, links: IntArray, least: float) -> tuple[FloatArray, IntArray]:
    """Join nodes at the ends of short links; return the nodes left and the links between them."""
    length = np.hypot(*(nodes[links[:, 0]] - nodes[links[:, 1]]).T)
    # The shortest first, and no node twice, so that no chain of them falls into one place.
    taken = np.zeros(len(nodes), bool)
    pairs = []
    for row in np.argsort(length, kind="stable")[: int((length < least).sum())].tolist():
        if not taken[links[row]].any():
            taken[links[row]] = True
            pairs.append(links[row])
    into = components(np.array(pairs, np.int64).reshape(-1, 2), len(nodes))
    label, into = np.unique(into, return_inverse=True)
    count = np.bincount(into, minlength=len(label))
    place = np.column_stack([np.bincount(into, nodes[:, k]) / count for k in (0, 1)])
    ends = np.unique(np.sort(into[links], axis=1), axis=0)
    ends = ends[ends[:, 0] != ends[:, 1]]
    used, renamed = np.unique(ends, return_inverse=True)
    return place[used], renamed.reshape(-1, 2).astype(np.int64)


def streets_of(nodes: FloatArray, links: IntArray) -> IntArray:
    """Find the streets that links are of: at a junction the straightest two run on as one.

    Parameters
    ----------
    nodes, links
        (n, 2) metres and (m, 2) rows of nodes.

    Returns
    -------
    street
        (m,) number of the lowest link of each street.
    """
    end = np.concatenate([links[:, 0], links[:, 1]])
    link = np.tile(np.arange(len(links)), 2)
    away = np.concatenate([nodes[links[:, 1]] - nodes[links[:, 0]],
                           nodes[links[:, 0]] - nodes[links[:, 1]]])  # fmt: skip
    bearing = np.arctan2(away[:, 1], away[:, 0])
    order = np.argsort(end, kind="stable")
    start = np.searchsorted(end[order], np.arange(len(nodes) + 1))
    pairs: list[tuple[int, int]] = []
    for node in range(len(nodes)):
        pairs += _running_on(order[start[node] : start[node + 1]], link, bearing)
    return np.asarray(components(np.array(pairs, np.int64).reshape(-1, 2), len(links)))


def _running_on(arms: IntArray, link: IntArray, bearing: FloatArray) -> Sequence[tuple[int, int]]:
    """Return the pairs of links at one node that run on, the straightest first."""
    found: list[tuple[int, int]] = []
    free = arms.tolist()
    while len(free) > 1:
        turns = [
            (abs((bearing[a] - bearing[b]) % (2 * np.pi) - np.pi), a, b)
            for k, a in enumerate(free) for b in free[k + 1 :]
        ]  # fmt: skip
        least, a, b = min(turns)
        if least > ONWARD:
            break
        found.append((int(link[a]), int(link[b])))
        free = [arm for arm in free if arm not in (a, b)]
    return found


def with_main_streets(pattern: Pattern, family: int, *, count: int, reach: float) -> Pattern:
    """Make main streets of the shortest ways from the middle outwards, in even directions.

    Parameters
    ----------
    family
        Of the main streets, numbered from 0.
    count
        How many lead outwards.
    reach
        Metres from the middle, (0, 0), to where they are known to lead.
    """
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import dijkstra

    nodes, links = pattern.nodes, pattern.links
    length = np.hypot(*(nodes[links[:, 0]] - nodes[links[:, 1]]).T)
    graph = coo_array((length, (links[:, 0], links[:, 1])), shape=(len(nodes), len(nodes))).tocsr()
    first = int(np.argmin(np.hypot(*nodes.T)))
    far, before = dijkstra(graph, directed=False, indices=first, return_predecessors=True)
    number = {tuple(sorted(pair)): row for row, pair in enumerate(links.tolist())}
    street = pattern.street.copy()
    for k in range(count):
        turn = 2 * np.pi * (k + 0.25) / count
        goal = reach * np.array([math.cos(turn), math.sin(turn)])
        node = int(np.argmin(np.where(np.isfinite(far), np.hypot(*(nodes - goal).T), np.inf)))
        while node != first:
            row = number[tuple(sorted((node, int(before[node]))))]
            if street[row, 0] != family:
                street[row] = family, k
            node = int(before[node])
    return Pattern(nodes, links, street, pattern.name)


@dataclass
class _Net:
    """Nodes by radius and angle, and the links between them."""

    nodes: dict[tuple[float, float], int]
    links: list[tuple[int, int]]
    street: list[tuple[int, int]]

    def node(self, radius: float, angle: float) -> int:
        # To the millimetre and the microradian, a full turn being none.
        key = (round(radius, 3), round(angle % (2 * math.pi), 6) % round(2 * math.pi, 6))
        return self.nodes.setdefault(key, len(self.nodes))

    def link(self, a: int, b: int, street: tuple[int, int]) -> None:
        self.links.append((a, b))
        self.street.append(street)


def radial(
    half: tuple[float, float], sizes: tuple[float, float], *, avenues: int, rings: int
) -> Pattern:
    """Lay avenues, rings and streets between them around a square at (0, 0).

    Parameters
    ----------
    half
        Half the width and depth that the streets must cover, metres.
    sizes
        Metres between streets that lead outwards, and between those around.
    avenues
        Streets that lead straight from the square to the border, at least 3; one leads east.
    rings
        Closed circles round the square, besides the street along it.

    Returns
    -------
    pattern
        Streets of the families `AVENUE`, `RING`, `SQUARE`, and between them `ARC` and `SPOKE`,
        of which none goes all the way round or all the way out.
    """
    first = square_radius(avenues)
    last = LAST * min(half)
    circles = [first, *(first + (last - first) * (k + 1) / rings for k in range(rings))]
    out = math.hypot(*half) + sizes[1]
    bounds = [*circles, out]
    net = _Net({}, [], [])
    turn = 2 * math.pi / avenues
    levels = [_levels(bounds, sizes[1], sector) for sector in range(avenues)]
    on_arc: dict[tuple[int, int], set[float]] = {}
    for sector in range(avenues):
        low = sector * turn
        for gap, (a, b) in enumerate(pairwise(levels[sector])):
            count = max(round(turn * (a + b) / 2 / sizes[0]), 1)
            aside = ASIDE * (0.5 if gap % 2 else -0.5)  # no spoke runs on across an arc
            for k in range(1, count):
                angle = low + turn * (k + aside) / count
                street = (SPOKE, (sector * len(levels[sector]) + gap) * 64 + k)
                net.link(net.node(a, angle), net.node(b, angle), street)
                on_arc.setdefault((sector, gap), set()).add(angle)
                on_arc.setdefault((sector, gap + 1), set()).add(angle)
        for level, radius in enumerate(levels[sector]):
            if radius == out:
                continue
            steps = max(math.ceil(turn * radius / STEP), 1)
            ends = [low, low + turn]
            stops = sorted({*ends, *on_arc.get((sector, level), set())})
            angles = _filled(stops, turn / steps)
            for p, q in pairwise(angles):
                street = _arc_street(circles, radius, sector, level)
                net.link(net.node(radius, p), net.node(radius, q), street)
    for sector in range(avenues):
        stops = sorted({*levels[sector], *levels[sector - 1]})
        for p, q in pairwise(stops):
            angle = sector * turn
            net.link(net.node(p, angle), net.node(q, angle), (AVENUE, sector))
    return _pattern(net)


def square_radius(avenues: int) -> float:
    """Return the metres from the middle of a square to the street round it."""
    return max(LEAST, avenues * SIDE / (2 * math.pi))


def _levels(bounds: list[float], across: float, sector: int) -> list[float]:
    """Return the radii of the arcs of a sector: circles, and staggered arcs between them."""
    found = [bounds[0]]
    for low, high in pairwise(bounds):
        count = max(round((high - low) / across), 1)
        step = (high - low) / count
        shift = STAGGER * step * (0.5 if sector % 2 else -0.5)
        found += [low + step * k + shift for k in range(1, count)] + [high]
    return found


def _arc_street(circles: list[float], radius: float, sector: int, level: int) -> tuple[int, int]:
    if radius == circles[0]:
        return SQUARE, 0
    if radius in circles:
        return RING, circles.index(radius)
    return ARC, sector * 64 + level


def _filled(stops: list[float], step: float) -> list[float]:
    """Divide the stretches between stops evenly, into pieces no longer than a step."""
    found = [stops[0]]
    for a, b in pairwise(stops):
        count = max(math.ceil((b - a) / step - 1e-9), 1)
        found += [a + (b - a) * k / count for k in range(1, count)] + [b]
    return found


def _pattern(net: _Net) -> Pattern:
    polar = np.array(list(net.nodes), float)
    nodes = polar[:, :1] * np.column_stack([np.cos(polar[:, 1]), np.sin(polar[:, 1])])
    links = np.array(net.links, np.int64)
    return Pattern(nodes, links, np.array(net.street, np.int64), links.copy())
