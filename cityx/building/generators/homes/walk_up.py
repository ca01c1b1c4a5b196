"""Brick walk-ups: American tenements and row houses, with stoops, fire escapes, metal cornices."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Annotated

import shapely

from cityx.building.generators import action_of, generator
from cityx.building.massing.massing import Mass, Plot, carve, site_of
from cityx.protocol import Choice, Range

FRONTS = ("tenement", "brownstone", "flats")
DEEP = 12.0  # metres from which rooms in the middle need a shaft


def masses(
    plot: Plot,
    *,
    front: Annotated[str, Choice("any", *FRONTS)] = "any",
    shaft: Annotated[float, Range(0.0, 4.0)] = 1.6,
) -> tuple[Mass, ...]:
    """Build American walk-ups of brick and brownstone.

    A stoop to a raised ground floor, fire escapes that zigzag over the front, a cornice of pressed
    metal on brackets, water tanks, and light shafts that make a dumbbell of a deep plan.

    Cut light shafts into both sides of a deep plan, above the ground floor: a dumbbell.

    Parameters
    ----------
    front
        Tenements have fire escapes, brownstones dressed stone and a stoop.
    shaft
        Metres of depth of the light shafts, 0 for none.
    """
    low = plot.levels <= 5  # brownstones are houses
    zone = plot.pick("front", FRONTS, (4, 3 * low, 3)) if front == "any" else front
    zone = "" if zone == "flats" else zone
    body = replace(plot.body, zone=zone)
    site = site_of(plot)
    x, y = site.half
    if 2 * y < DEEP or 2 * x < 7.0 or plot.levels < 3 or shaft <= 0 or plot.plan.interiors:
        return (body,)
    return _dumbbell(plot, body, shaft)


def _dumbbell(plot: Plot, body: Mass, shaft: float) -> tuple[Mass, ...]:
    site = site_of(plot)
    x, y = site.half
    wide = min(plot.waver("shaft", shaft, body), 0.22 * 2 * x)
    long = plot.between("shaft length", 0.26, 0.36) * 2 * y
    middle = plot.between("shaft at", -0.1, 0.06) * 2 * y
    rest, found = site.plan, list[Mass]()
    for x0, x1 in _spans(x, wide):
        inside, rest = carve(rest, shapely.box(x0, middle - long / 2, x1, middle + long / 2))
        found += site.masses(inside, 0.0, plot.storey, "shaft")
    grown = site.masses(rest, 0.0, body.high, body.zone, body.roof, body.rise)
    return (*grown, *found)


def _spans(half: float, wide: float) -> Sequence[tuple[float, float]]:
    return [(-2 * half, wide - half), (half - wide, 2 * half)]


GENERATOR = generator(masses)
walk_up = action_of("building/walk_up-v1", GENERATOR, masses)
