"""Tree pits as prototypes: a square opening in the paving about a trunk, or an island."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import lru_cache
from types import MappingProxyType

import numpy as np

from cityx.assets import shapes
from cityx.assets.shapes import box
from cityx.city.mesh import MeshBatch
from cityx.city.scene import Prototype
from cityx.ids import rng_for

HALF = 0.60  # metres, half an edge of the pit
FRAME = 0.08  # metres, breadth of the stone edging
PLANTS, ROOT = 150, 0.24  # plants of a pit, and metres about the trunk without any
SLOT = 0.022  # metres, breadth of the slots of a grate
OPENING = 0.34  # metres, half an edge of the hole in a grate, for the trunk to grow
DEEP = -0.20  # metres below the paving, so that no gap shows on a slope
TOP = 0.012  # metres above it, enough to hide the paving beneath

STRIP, STRIP_HALF = 1.6, 0.28  # metres, length of a strip between trees and half its breadth
HEDGE = 0.46  # metres, height of the clipped bushes of a strip
ISLAND, ISLAND_KERB = (2.3, 4.6), 0.14  # metres, of an island and the breadth of its kerb
COVER = 420  # plants on it
SPRAYS = 640  # leaf cards on them

Shapes = list[MeshBatch]


def _edging(high: float) -> Shapes:
    """Four stones round the pit."""
    out, inn = HALF + FRAME, HALF
    return [
        box((-out, -out, DEEP), (out, -inn, high), "kerb_stone", bottom=False),
        box((-out, inn, DEEP), (out, out, high), "kerb_stone", bottom=False),
        box((-out, -inn, DEEP), (-inn, inn, high), "kerb_stone", bottom=False),
        box((inn, -inn, DEEP), (out, inn, high), "kerb_stone", bottom=False),
    ]


def _soil(high: float) -> MeshBatch:
    return box((-HALF, -HALF, DEEP), (HALF, HALF, high), "soil", bottom=False)


def _strip() -> Shapes:
    """Soil between two rows of edging stones, with a low clipped hedge."""
    rng = rng_for(0, "assets/tree_strip", 1)
    half = np.array([STRIP / 2 - 0.02, STRIP_HALF - 0.05])
    stones = [
        box((-STRIP / 2, y - 0.05, DEEP), (STRIP / 2, y + 0.05, 0.09), "kerb_stone", bottom=False)
        for y in (-STRIP_HALF + 0.05, STRIP_HALF - 0.05)
    ]
    soil = box((-STRIP / 2, 0.1 - STRIP_HALF, DEEP), (STRIP / 2, STRIP_HALF - 0.1, 0.04), "soil",
               bottom=False)  # fmt: skip
    core = box((-half[0] + 0.06, -half[1] + 0.05, 0.1), (half[0] - 0.06, half[1] - 0.05,
               HEDGE - 0.09), "hedge", (0.35, 0.35, 0.35))  # fmt: skip
    # Half a barrel along x, its ends rounded.
    x = rng.uniform(-1, 1, SPRAYS)
    angle = np.pi * rng.uniform(0, 1, SPRAYS)
    across, up = (np.sign(v) * np.abs(v) ** 0.5 for v in (np.cos(angle), np.sin(angle)))
    swell = 1 + 0.08 * np.sin(7 * x + 1.3) + rng.normal(0, 0.04, SPRAYS)
    centre = np.column_stack([half[0] * x, half[1] * across * swell,
                              0.12 + (HEDGE - 0.12) * up * swell])  # fmt: skip
    normal = np.column_stack([0.3 * x, across, up]) + 0.45 * rng.normal(size=(SPRAYS, 3))
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    along = np.cross(normal, rng.normal(size=(SPRAYS, 3)))
    along *= 0.085 * rng.uniform(0.7, 1.3, (SPRAYS, 1)) / np.linalg.norm(along, axis=1)[:, None]
    shade = rng.uniform(0.7, 1.2, (SPRAYS, 1)) * (0.55 + 0.45 * up[:, None])
    leaves = shapes.cards(centre, along, np.cross(normal, along) * 0.9, "leaf",
                          shade * [0.80, 0.88, 0.70])  # fmt: skip
    return [*stones, soil, core, leaves]


def _open() -> Shapes:
    """Soil within an edging that stands up a little."""
    return [*_edging(0.06), _soil(0.025)]


def _flush() -> Shapes:
    """Soil level with the paving."""
    return [*_edging(TOP + 0.006), _soil(TOP)]


def _grate() -> Shapes:
    """Cast iron bars over the soil, round an opening for the trunk."""
    parts = [*_edging(TOP + 0.006), _soil(TOP - 0.008)]
    pitch = 2.6 * SLOT
    for x in np.arange(-HALF + pitch / 2, HALF, pitch):
        low, high = x - 0.8 * SLOT, x + 0.8 * SLOT
        spans = [(-HALF, -OPENING), (OPENING, HALF)] if abs(x) < OPENING else [(-HALF, HALF)]
        parts += [box((low, a, TOP - 0.008), (high, b, TOP + 0.004), "metal_dark", bottom=False)
                  for a, b in spans]  # fmt: skip
    for y in (-OPENING, OPENING):
        parts.append(box((-HALF, y - SLOT, TOP - 0.008), (HALF, y + SLOT, TOP + 0.005),
                         "metal_dark", bottom=False))  # fmt: skip
    return parts


def _planted() -> Shapes:
    """Soil in an edging, with low plants about the trunk."""
    rng = rng_for(0, "assets/tree_pit_planted", 1)
    place = rng.uniform(-HALF + 0.06, HALF - 0.06, (2 * PLANTS, 2))
    place = place[np.abs(place).max(axis=1) > ROOT][:PLANTS]
    count = len(place)
    up = np.column_stack([rng.normal(0, 0.5, (count, 2)), np.ones(count)])
    along = up / np.linalg.norm(up, axis=1, keepdims=True) * rng.uniform(0.06, 0.13, (count, 1))
    side = np.cross(along, rng.normal(size=(count, 3)))
    side *= 0.045 / np.maximum(np.linalg.norm(side, axis=1, keepdims=True), 1e-6)
    centre = np.column_stack([place, 0.04 + along[:, 2]])
    tint = rng.uniform(0.7, 1.3, (count, 1)) * [1.0, 1.0, 0.9]
    return [*_open(), shapes.cards(centre, along, side, "leaf", tint)]


def _staked() -> Shapes:
    """Soil in an edging, with two stakes that hold a young tree by a band each."""
    parts = _open()
    for x in (-0.38, 0.38):
        parts.append(shapes.cylinder((x, 0.0, DEEP), (x, 0.0, 1.75), 0.035, "bench_wood", sides=6,
                                     caps=(False, True)))  # fmt: skip
        low, high = sorted((x, 0.10 * np.sign(x)))
        parts.append(box((low, -0.012, 1.55), (high, 0.012, 1.61), "rubber"))
    return parts


def _island() -> Shapes:
    """Island of a car park, a bay in size: kerb stones about soil with low ground cover."""
    half = np.array(ISLAND) / 2
    inn = half - ISLAND_KERB
    parts: Shapes = []
    for sign in (-1.0, 1.0):
        for low, high in (
            ((-half[0], min(sign * half[1], sign * inn[1])), (half[0], max(sign * half[1],
                                                                           sign * inn[1]))),
            ((min(sign * half[0], sign * inn[0]), -inn[1]), (max(sign * half[0], sign * inn[0]),
                                                             inn[1])),
        ):  # fmt: skip
            parts.append(box((*low, DEEP), (*high, 0.13), "kerb_stone", bottom=False))
    parts.append(box((*-inn, DEEP), (*inn, 0.10), "soil", bottom=False))
    rng = rng_for(0, "assets/lot_island", 1)
    place = rng.uniform(-1, 1, (COVER, 2)) * (inn - 0.08)
    place = place[np.hypot(*place.T) > ROOT]
    count = len(place)
    up = np.column_stack([rng.normal(0, 0.7, (count, 2)), np.ones(count)])
    along = up / np.linalg.norm(up, axis=1, keepdims=True) * rng.uniform(0.07, 0.15, (count, 1))
    side = np.cross(along, rng.normal(size=(count, 3)))
    side *= 0.06 / np.maximum(np.linalg.norm(side, axis=1, keepdims=True), 1e-6)
    tint = rng.uniform(0.6, 1.2, (count, 1)) * [1.0, 1.0, 0.85]
    centre = np.column_stack([place, 0.10 + 0.8 * along[:, 2]])
    return [*parts, shapes.cards(centre, along, side, "leaf", tint)]


PITS: Mapping[str, Callable[[], Shapes]] = MappingProxyType(
    {"tree_pit_open": _open, "tree_pit_flush": _flush, "tree_pit_grate": _grate}
)
# What some trees of a place have instead.
OTHERS: Mapping[str, Callable[[], Shapes]] = MappingProxyType(
    {"tree_pit_planted": _planted, "tree_pit_staked": _staked}
)

TREE_STRIP, LOT_ISLAND = "tree_strip", "lot_island"


@lru_cache(maxsize=9)
def pit(name: str) -> Prototype:
    """Make one of `PITS` or `OTHERS` about the trunk's place, a `TREE_STRIP` or a `LOT_ISLAND`."""
    makers = {**PITS, **OTHERS, TREE_STRIP: _strip, LOT_ISLAND: _island}
    return shapes.prototype(name, "furniture", makers[name]())
