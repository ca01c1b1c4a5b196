"""Temples and pagodas: a stone platform, posts, lattice fronts, tiers of roofs with deep eaves."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated

import numpy as np

from cityx.building.generators import action_of, generator
from cityx.building.massing.lots import Lot, lot_of, masses_on
from cityx.building.massing.massing import Mass, Plot
from cityx.protocol import Range

EAVES = 1.6  # metres that roofs stand out, as far as the columns before the walls ask
BOARD = 0.22  # metres from the surface of a roof to its soffit, at the edge
EDGE = 0.15  # metres between the eaves and the edge of the platform
LEAST = 4.2  # metres of hall; a narrower plan bears none
STAIR = (2.8, 1.5)  # metres of its width and depth
STAIR_SHARE = 0.028  # of the platform that may stay open for it
FIRST, SECOND, THIRD = 0.36, 0.62, 0.86  # rise over run of a roof, from eaves to ridge
SKIRT = 0.42  # the same of the roofs between tiers
STOREY, LEAST_STOREY = 3.6, 2.3  # metres of a tier, usual and least
MOST = 7  # tiers
SQUARISH = 1.4  # length over width up to which a high temple is a pagoda

Half = tuple[float, float]


def masses(
    plot: Plot,
    *,
    tiers: Annotated[int, Range(0, 7)] = 0,
    platform: Annotated[float, Range(0.6, 2.0)] = 1.0,
) -> tuple[Mass, ...]:
    """Build East Asian temples and pagodas.

    A stone platform with a stair and a balustrade, a hall of posts and lattice doors, and tiers of
    tiled roofs with deep eaves that grow steeper towards the ridge.

    Stack halls on a platform, each with a roof of its own, the uppermost with a ridge.

    Parameters
    ----------
    tiers
        Roofs above one another; 0 follows the storeys.
    platform
        Metres of the platform's height.
    """
    lot = lot_of(plot)
    margin = EAVES + EDGE
    if not lot.boxy or lot.narrow < 2 * margin + LEAST:
        return (plot.body,)
    half = lot.x - margin, lot.y - margin
    pagoda = plot.levels >= 3 and max(half) <= SQUARISH * min(half) and tiers != 1
    step = 0.16 * min(half) if pagoda else min(1.6, 0.28 * min(half))
    count = tiers or (min(plot.levels, MOST) if pagoda else min(plot.levels, 2))
    foot = platform * plot.between("platform", 0.85, 1.15)
    while True:
        halls = [(half[0] - step * k, half[1] - step * k) for k in range(count)]
        top = _height(halls[-1], pagoda=pagoda)
        skirts = SKIRT * (EAVES + step) * (count - 1)
        room = plot.height - foot - top - skirts
        share = np.array([1.25] + [0.8] * (count - 1))
        tall = room * share / share.sum()
        slim = min(halls[-1]) < 1.4
        if count == 1 or (tall.min() > LEAST_STOREY * 0.75 and not slim):
            break
        count -= 1
    squeeze = 1.0
    if tall[0] < LEAST_STOREY:
        squeeze = (plot.height - foot - LEAST_STOREY) / top
        tall = np.array([LEAST_STOREY])
        if squeeze < 0.35:
            return (plot.body,)
    made = _platform(lot, halls[0], foot)
    level = foot
    for number, hall in enumerate(halls):
        eave = level + float(tall[number])
        zone = "tier" if number else ""
        made += lot.masses([_box(hall)], low=level, high=eave - BOARD, zone=zone)
        if number + 1 < count:
            rise = SKIRT * (EAVES + step)
            made += _ring(lot, _grown(hall), halls[number + 1], eave, rise)
            level = eave + rise
        else:
            made += _roof(lot, hall, eave, squeeze, pagoda=pagoda)
    return tuple(made)


def _box(half: Half) -> tuple[float, float, float, float]:
    return -half[0], -half[1], half[0], half[1]


def _grown(half: Half, by: float = EAVES) -> Half:
    return half[0] + by, half[1] + by


def _curve(hall: Half) -> float:
    """Metres behind the wall at which a roof becomes steep."""
    return 0.38 * min(hall)


def _height(hall: Half, *, pagoda: bool) -> float:
    """Metres from the eaves to the ridge of the uppermost roof."""
    if pagoda:
        return FIRST * EAVES + THIRD * min(hall)
    inner = min(hall) - _curve(hall)
    return FIRST * EAVES + SECOND * _curve(hall) + THIRD * inner


def _platform(lot: Lot, hall: Half, foot: float) -> list[Mass]:
    """Lay the platform about the hall, with a bay for the stair at its front."""
    core = lot.masses([_box(hall)], low=0.0, high=foot, zone="platform")
    x, y, inner = lot.x, lot.y, hall[1]
    half, deep = STAIR[0] / 2, STAIR[1]
    shell = [(-x, -y), (x, -y), (x, y), (-x, y)]
    hole = [(-hall[0], -inner), (hall[0], -inner), (hall[0], inner), (-hall[0], inner)]
    if STAIR[0] * deep > STAIR_SHARE * 4 * x * y:
        ring = _with_hole(lot, shell, hole)
        return core + masses_on(ring, low=0.0, high=foot, zone="platform")
    landing = lot.masses([(-half, inner, half, y - deep)], low=0.0, high=foot, zone="stair")
    # Open towards the landing, so that the platform is one piece around the hall.
    line = [(-x, -y), (x, -y), (x, y), (half, y), (half, inner), (hall[0], inner),
            (hall[0], -inner), (-hall[0], -inner), (-hall[0], inner), (-half, inner), (-half, y),
            (-x, y)]  # fmt: skip
    return core + landing + masses_on(lot.outline(line), low=0.0, high=foot, zone="platform")


def _with_hole(lot: Lot, shell: Sequence[Half], hole: Sequence[Half]) -> object:
    import shapely

    shape = shapely.Polygon(lot.place(shell), [lot.place(hole)])
    return lot.clipped(np.array([shape], object))[0]


def _ring(lot: Lot, outer: Half, inner: Half, eave: float, rise: float) -> list[Mass]:
    """Slope four planes from an outer rectangle up to an inner one; they meet in hips."""
    corner = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]
    down = [(0.0, -1.0), (1.0, 0.0), (0.0, 1.0), (-1.0, 0.0)]
    made = []
    for side in range(4):
        a, b = corner[side], corner[(side + 1) % 4]
        line = [(a[0] * outer[0], a[1] * outer[1]), (b[0] * outer[0], b[1] * outer[1]),
                (b[0] * inner[0], b[1] * inner[1]), (a[0] * inner[0], a[1] * inner[1])]  # fmt: skip
        made += masses_on(
            lot.outline(line), low=eave - BOARD, high=eave + rise, zone="roof", roof="skillion",
            rise=rise, direction=lot.compass(*down[side]), walls=False,
        )  # fmt: skip
    return made


def _roof(lot: Lot, hall: Half, eave: float, squeeze: float, *, pagoda: bool) -> list[Mass]:
    """Raise the uppermost roof, steeper in each step from the eaves to the ridge."""
    rise = squeeze * FIRST * EAVES
    made = _ring(lot, _grown(hall), hall, eave, rise)
    level = eave + rise
    if pagoda:
        up = squeeze * THIRD * min(hall)
        return made + lot.masses([_box(hall)], low=level - BOARD, high=level + up, zone="spire",
                                 roof="pyramidal", rise=up, walls=False)  # fmt: skip
    run = _curve(hall)
    inner = hall[0] - run, hall[1] - run
    rise = squeeze * SECOND * run
    made += _ring(lot, hall, inner, level, rise)
    level += rise
    up = squeeze * THIRD * min(inner)
    along = lot.compass(0.0, 1.0) if inner[0] >= inner[1] else lot.compass(1.0, 0.0)
    return made + lot.masses([_box(inner)], low=level - BOARD, high=level + up, zone="ridge",
                             roof="gabled", rise=up, direction=along, walls=False)  # fmt: skip


GENERATOR = generator(masses)
temple = action_of("building/temple-v1", GENERATOR, masses)
