"""Streets around a square: avenues that leave it, rings that join them, and streets between."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from cityx.geometry.parcels.street_patterns import Pattern

AVENUE, RING, SQUARE, ARC, SPOKE = 5, 6, 7, 0, 1  # families of streets
STEP = 25.0  # metres between the points of an arc
LAST = 0.8  # of the way to the nearest border, where the outermost ring runs
STAGGER = 0.3  # of the metres between two arcs, by which those of neighbouring sectors differ
ASIDE = 0.24  # of the way between two spokes, by which those on both sides of an arc differ
SIDE = 38.0  # metres along the street round the square between two avenues
LEAST = 40.0  # metres from the middle of the square to the street round it


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
