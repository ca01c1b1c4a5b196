"""Patterns of local streets: graphs over a stretch of the plane that districts are cut from."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from cityx.geometry.arrays import FloatArray, IntArray
from cityx.geometry.noise import gradient_noise

Box = tuple[float, float, float, float]

STRETCH = 25.0  # metres between the points of a street that bends
ARC = 1.7  # times its usual length that an arc between two spokes may have before one is added


@dataclass(frozen=True)
class Pattern:
    """Streets as a graph; n nodes, m links.

    Attributes
    ----------
    nodes
        (n, 2) metres.
    links
        (m, 2) rows of the nodes at the ends.
    street
        (m, 2) what names the street that a link is of: number of the family, number of the line.
    name
        (m, 2) what names the link among all of its pattern: lattice numbers that do not depend on
        the stretch.
    """

    nodes: FloatArray
    links: IntArray
    street: IntArray
    name: IntArray

    def take(self, rows: NDArray[np.bool_]) -> Pattern:
        """Return some of the links, over the same nodes."""
        return Pattern(self.nodes, self.links[rows], self.street[rows], self.name[rows])


def grid(
    box: Box, origin: FloatArray, angle: float, sizes: tuple[float, float], *, brick: bool = False
) -> Pattern:
    """Lay a grid of streets over a box.

    Parameters
    ----------
    box
        What it must cover, metres.
    origin
        (2,) a crossing, from which lines are counted.
    angle
        Direction of the first family of lines, radians.
    sizes
        Metres between crossings along the first family, and between its lines.
    brick
        Whether every other row of cross streets is shifted by half, so that all ends are T.
    """
    nodes, column, row = grid_nodes(box, origin, angle, sizes, brick=brick)
    number = np.arange(len(column)).reshape(-1, row[-1] - row[0] + 1)
    first = np.stack([number[:-1].ravel(), number[1:].ravel()], axis=1)
    rising = np.stack([number[:, :-1].ravel(), number[:, 1:].ravel()], axis=1)
    if brick:
        c, r = column[rising[:, 0]], row[rising[:, 0]]
        rising = rising[(c + r) % 2 == 0]
    links = np.concatenate([first, rising])
    family = np.repeat([0, 1], [len(first), len(rising)])
    line = np.where(family == 0, row[links[:, 0]], column[links[:, 0]])
    other = np.where(family == 0, column[links[:, 0]], row[links[:, 0]])
    name = np.stack([2 * line + family, other], axis=1)
    return Pattern(nodes, links, np.stack([family, line], axis=1), name)


def grid_nodes(
    box: Box, origin: FloatArray, angle: float, sizes: tuple[float, float], *, brick: bool = False
) -> tuple[FloatArray, IntArray, IntArray]:
    """Return the crossings of a `grid`: (n, 2) places, (n,) columns and (n,) rows, both rising."""
    along, across = sizes
    u0, u1, v0, v1 = _turned_box(box, origin, angle)
    step = 2 if brick else 1  # nodes per crossing along a line
    i = np.arange(math.floor(u0 / along * step) - 1, math.ceil(u1 / along * step) + 2)
    j = np.arange(math.floor(v0 / across) - 1, math.ceil(v1 / across) + 2)
    column, row = (part.ravel() for part in np.meshgrid(i, j, indexing="ij"))
    return _placed(origin, angle, column * (along / step), row * across), column, row


def rings(box: Box, middle: FloatArray, angle: float, sizes: tuple[float, float]) -> Pattern:
    """Lay rings and spokes over a box.

    Parameters
    ----------
    middle
        (2,) where the spokes aim; the first ring goes round a place there.
    angle
        Direction of the first spoke, radians.
    sizes
        Metres between spokes along a ring, and between rings.
    """
    along, across = sizes
    corner = np.array([(x, y) for x in box[::2] for y in box[1::2]]) - middle
    count = math.ceil(np.hypot(*corner.T).max() / across) + 1
    radius = across * (np.arange(count) + 0.6)
    spokes = [6]
    for r in radius[1:]:
        often = 2 if 2 * math.pi * r / spokes[-1] > ARC * along else 1
        spokes.append(often * spokes[-1])
    start = np.cumsum([0, *spokes])
    turn = [angle + 2 * np.pi * np.arange(n) / n for n in spokes]
    nodes = np.concatenate(
        [
            middle + r * np.stack([np.cos(t), np.sin(t)], 1)
            for r, t in zip(radius, turn, strict=True)
        ]
    )
    links, street = [], []
    for k, n in enumerate(spokes):
        here = np.arange(n)
        links.append(np.stack([start[k] + here, start[k] + (here + 1) % n], axis=1))
        street.append(np.stack([np.zeros(n, int), np.full(n, k)], axis=1))
        if k:
            often = n // spokes[k - 1]
            inner = np.arange(spokes[k - 1])
            links.append(np.stack([start[k - 1] + inner, start[k] + often * inner], axis=1))
            street.append(
                np.stack([np.ones(len(inner), int), inner * (spokes[-1] // len(inner))], 1)
            )
    every, named = np.concatenate(links), np.concatenate(street)
    return Pattern(nodes, every, named, every.copy())


def curved(pattern: Pattern, seed: int, *, wave: float, reach: float) -> Pattern:
    """Divide the links of a pattern and bend it by noise.

    Parameters
    ----------
    wave
        Metres of the largest waves.
    reach
        Metres by which a node is moved at most.
    """
    fine = divided(pattern)
    moved = [gradient_noise(seed + k, fine.nodes / wave) for k in (0, 1)]
    return replace(fine, nodes=fine.nodes + reach * np.stack(moved, axis=1))


def divided(pattern: Pattern, *, middle: FloatArray | None = None) -> Pattern:
    """Divide the links of a pattern into equal pieces; each new node has two links.

    Parameters
    ----------
    middle
        (2,) of the rings, whose links become arcs; straight pieces by default.
    """
    a, b = pattern.nodes[pattern.links[:, 0]], pattern.nodes[pattern.links[:, 1]]
    pieces = np.maximum(np.rint(np.hypot(*(b - a).T) / STRETCH).astype(np.int64), 1)
    owner = np.repeat(np.arange(len(pieces)), pieces)
    first = np.concatenate([[0], np.cumsum(pieces)[:-1]])
    k = np.arange(len(owner)) - first[owner]
    t = (k / pieces[owner])[:, None]
    inner = a[owner] + t * (b[owner] - a[owner])
    if middle is not None:
        ring = pattern.street[owner, 0] == 0
        size = np.hypot(*(a[owner] - middle).T) / np.maximum(np.hypot(*(inner - middle).T), 1e-9)
        inner = np.where(ring[:, None], middle + size[:, None] * (inner - middle), inner)
    node = np.where(k == 0, pattern.links[owner, 0], len(pattern.nodes) + np.cumsum(k > 0) - 1)
    last = k == pieces[owner] - 1
    after = np.where(last, pattern.links[owner, 1], np.append(node[1:], 0))
    return Pattern(
        np.concatenate([pattern.nodes, inner[k > 0]]),
        np.stack([node, after], axis=1),
        pattern.street[owner],
        pattern.name[owner],
    )


def _turned_box(box: Box, origin: FloatArray, angle: float) -> tuple[float, float, float, float]:
    corner = np.array([(x, y) for x in box[::2] for y in box[1::2]]) - origin
    c, s = math.cos(angle), math.sin(angle)
    u, v = c * corner[:, 0] + s * corner[:, 1], c * corner[:, 1] - s * corner[:, 0]
    return float(u.min()), float(u.max()), float(v.min()), float(v.max())


def _placed(origin: FloatArray, angle: float, u: FloatArray, v: FloatArray) -> FloatArray:
    c, s = math.cos(angle), math.sin(angle)
    return np.asarray(origin + np.stack([c * u - s * v, s * u + c * v], axis=1))
