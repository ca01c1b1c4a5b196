"""Mosques: a hall under a dome on a drum, half domes, a portico of small domes, minarets."""

from __future__ import annotations

import math
from typing import Annotated, Any

import shapely

from cityx.building.generators import action_of, generator
from cityx.building.massing.massing import Mass, Plot, Site, carve, disc, remainder, site_of, widest
from cityx.protocol import Range

LEAST_DOME = 2.6  # metres of radius; a smaller hall has a flat roof
LEAST_MINARET = 120.0  # square metres of plan from which there is a minaret
FULL = 0.95  # share of a minaret's foot that the plan must fill
SIDES = 16  # of domes and drums


def masses(
    plot: Plot,
    *,
    minarets: Annotated[int, Range(-1, 4)] = -1,
    dome: Annotated[float, Range(0.0, 1.25)] = 1.0,
    portico: bool = True,
) -> tuple[Mass, ...]:
    """Build mosques: a domed hall with a portico and minarets.

    The dome stands on a drum and an octagon, half domes and small domes about it; minarets rise
    from the corners, with one or two balconies and a cone.

    Cut minarets and a portico off the plan, and vault what is left.

    Parameters
    ----------
    minarets
        Number of minarets; -1 takes what suits the size.
    dome
        Width of the dome relative to the usual one; 0 leaves it out.
    portico
        Whether a row of small domes stands before the hall.
    """
    site = site_of(plot)
    half, deep = site.half
    area = site.plan.area
    hall = min(max(0.42 * math.sqrt(area), 5.0), 15.0)
    if plot.height < 0.9 * hall:
        hall = max(plot.height * 0.75, 3.6)
    grown: list[Mass] = []
    rest = site.plan
    if minarets < 0:
        usual = 0 if area < LEAST_MINARET else 1 if area < 380 else 2 if area < 1400 else 4
        minarets = max(usual, 1) if area > LEAST_MINARET and plot.draw("minarets") < 0.85 else usual
    foot = min(max(0.075 * math.sqrt(area) + 1.1, 2.3), 4.6)
    tall = hall * plot.between("minaret", 2.1, 3.1) + 4.0
    for x, y in _corners(site, foot, minarets):
        square = shapely.box(x - foot / 2, y - foot / 2, x + foot / 2, y + foot / 2)
        if shapely.intersection(site.plan, square).area > FULL * square.area:
            inside, rest = carve(rest, square)
            grown += _minaret(site, inside, x, y, foot, hall, tall)
    depth = min(max(0.2 * 2 * deep, 3.6), 6.0)
    if portico and 2 * deep > 3.2 * depth and half > 6.0:
        front, rest = carve(rest, shapely.box(-999, deep - depth, 999, 999))
        grown += _portico(site, front, depth, 0.5 * hall)
    x, y, radius = widest(rest if rest.area > 1 else site.plan)
    wide = min(0.72 * radius, 14.0) * min(max(dome, 0.0), 1.25)
    grown += site.masses(rest, 0.0, hall)
    if wide > LEAST_DOME:
        grown += _domes(site, rest, x, y, wide, hall, plot)
    return (*grown, *remainder(site, grown, 0.5 * hall, "portico"))


def _corners(site: Site, foot: float, count: int) -> list[tuple[float, float]]:
    """Places of minarets: the front corners first, then those at the back."""
    half, deep = site.half
    x, y = half - foot / 2, deep - foot / 2
    if min(half, deep) < 2 * foot:
        return []
    return [(x, y), (-x, y), (x, -y), (-x, -y)][: max(count, 0)]


def _minaret(site: Site, inside: Any, x: float, y: float, foot: float, hall: float,
             tall: float) -> list[Mass]:  # fmt: skip
    """Square foot, shaft with balconies, and a cone."""
    grown = site.masses(inside, 0.0, 1.08 * hall, "foot")
    low, radius = 1.08 * hall, 0.34 * foot
    levels = [0.52, 0.8] if tall > 26 else [0.7]
    for share in levels:
        high = max(share * tall, low + 1.5)
        grown += site.masses(disc(x, y, radius, 12), low, high, "shaft")
        grown += site.masses(disc(x, y, 1.42 * radius, 12), high, high + 1.15, "balcony")
        low, radius = high + 1.15, 0.86 * radius
    high = max(tall, low + 2.0)
    cone = 4.4 * radius
    grown += site.masses(disc(x, y, radius, 12), low, high, "shaft")
    grown += site.masses(disc(x, y, 1.16 * radius, 12), high, high + cone, "cone", "pyramidal",
                         cone - 0.25)  # fmt: skip
    return grown


def _portico(site: Site, front: Any, depth: float, high: float) -> list[Mass]:
    """Row of bays under small domes, the middle one higher."""
    x0, y0, x1, y1 = front.bounds
    count = max(3, round((x1 - x0) / depth) // 2 * 2 + 1)
    size = (x1 - x0) / count
    grown: list[Mass] = []
    rest = front
    middle = shapely.box(x0 + count // 2 * size, -999, x0 + (count // 2 + 1) * size, 999)
    gate, rest = carve(rest, middle)
    grown += site.masses(rest, 0.0, high, "portico")
    grown += site.masses(gate, 0.0, 1.35 * high, "gate")
    inner = front.buffer(-0.3)
    for number in range(count):
        x, y = x0 + (number + 0.5) * size, (y0 + y1) / 2
        radius = 0.40 * min(size, depth)
        base = 1.35 * high if number == count // 2 else high
        ring = disc(x, y, radius, 12)
        if inner.covers(ring):
            grown += site.masses(ring, base, base + 0.5 + 0.9 * radius, "small", "dome",
                                 0.9 * radius)  # fmt: skip
    return grown


def _domes(site: Site, rest: Any, x: float, y: float, wide: float, hall: float,
           plot: Plot) -> list[Mass]:  # fmt: skip
    """Central dome on a drum on an octagon, half domes about it, small ones in the corners."""
    step = 0.24 * wide + 0.5
    drum = 0.36 * wide + 1.0
    top = hall + step + drum
    shape = plot.pick("dome", ("dome", "onion"), (4, 1))
    rise = wide * (1.0 if shape == "dome" else 1.25)
    grown = site.masses(disc(x, y, 1.1 * wide, 8), hall, hall + step, "step")
    grown += site.masses(disc(x, y, wide, SIDES), hall + step, top + rise, "drum", shape, rise)
    inner = rest.buffer(-0.4)
    octagon = disc(x, y, 1.1 * wide + 0.05, 8)
    reach = 0.42 * wide
    halves = plot.draw("half domes") < 0.6 and wide > 3.4
    for number in range(4):
        turn = number * math.pi / 2
        away = 1.1 * wide + 0.72 * reach
        at = x + away * math.cos(turn), y + away * math.sin(turn)
        side = disc(*at, reach, 12)
        if halves and inner.covers(side):
            grown += site.masses(side - octagon, hall, hall + 0.7, "step")
            grown += site.masses(side.buffer(-0.25) - octagon, hall + 0.7, hall + 0.7 + reach,
                                 "small", "dome", reach)  # fmt: skip
        turn += math.pi / 4
        small = 0.3 * wide
        gap = 1.1 * wide / math.cos(math.pi / 8) + small + 0.4
        ring = disc(x + gap * math.cos(turn), y + gap * math.sin(turn), small, 12)
        if inner.covers(ring) and small > 1.0:
            grown += site.masses(ring, hall, hall + 0.9 + small, "small", "dome", small)
    return grown


GENERATOR = generator(masses)
mosque = action_of("building/mosque-v1", GENERATOR, masses)
