"""Factories: brick halls under a sawtooth roof, a boiler house, a chimney and a water tower."""

from __future__ import annotations

from typing import Annotated, Any

import shapely

from cityx.building.generators import action_of, generator
from cityx.building.massing.massing import Mass, Plot, Site, carve, disc, remainder, site_of
from cityx.protocol import Range

TOOTH = 8.0  # metres, the usual bay of the roof
LEAST_AREA = 420.0  # square metres from which there is more than a hall
SIDES = 12  # of chimneys


def masses(
    plot: Plot,
    *,
    chimney: Annotated[float, Range(0.0, 2.0)] = 1.0,
    offices: bool = True,
    tank: bool = True,
) -> tuple[Mass, ...]:
    """Build brick factories under sawtooth roofs.

    Pilasters and steel windows all round, offices at the street, and behind them a boiler house
    with a round chimney and a tower with a water tank.

    Set offices before a hall of teeth, with a boiler house, chimney and water tower behind.

    Parameters
    ----------
    chimney
        Height of the chimney relative to the usual one; 0 leaves it out.
    offices
        Whether an office wing stands at the street.
    tank
        Whether there is a water tower.
    """
    site = site_of(plot)
    half, deep = site.half
    eave = min(max(plot.height - plot.rise, 5.0), 11.0)
    rest: Any = site.plan
    grown: list[Mass] = []
    if rest.area > LEAST_AREA and min(half, deep) > 8.0:
        side = 1.0 if plot.draw("side") < 0.5 else -1.0
        if offices:
            depth = min(max(0.26 * 2 * deep, 7.0), 11.0)
            share = plot.between("offices", 0.35, 0.8) * 2 * half
            x0, x1 = sorted((-side * half * 1.1, -side * (half - share)))
            front, rest = carve(rest, shapely.box(x0, deep - depth, x1, 999))
            roof, rise = ("gabled", 0.24 * depth) if plot.draw("office roof") < 0.5 else ("flat", 0)
            grown += site.masses(front, 0.0, 1.45 * eave + rise, "office", roof, float(rise))
        width = min(max(0.24 * 2 * half, 8.0), 15.0)
        depth = min(max(0.4 * 2 * deep, 8.0), 16.0)
        x0, x1 = sorted((side * half * 1.1, side * (half - width)))
        boiler, rest = carve(rest, shapely.box(x0, -999, x1, -deep + depth))
        wide = min(width, depth)
        stack, square = _chimney(site, boiler, side, plot, chimney, eave)
        grown += stack
        boiler = shapely.difference(boiler, square, grid_size=0.01)
        grown += site.masses(boiler, 0.0, 1.5 * eave + 0.3 * wide, "boiler", "gabled", 0.3 * wide)
        if tank:
            x = -side * (half - 3.2)
            square = shapely.box(x - 2.9, -deep + 0.3, x + 2.9, -deep + 6.1)
            tower, after = carve(rest, square)
            if tower.area > 0.95 * square.area:
                rest = after
                grown += site.masses(tower, 0.0, 1.75 * eave, "tank")
    teeth = min(0.42 * TOOTH, 0.55 * eave)
    wide = max(half, deep) * 2 > TOOTH * 1.5
    roof = "sawtooth" if wide else "gabled"
    across = half >= deep
    grown += site.masses(rest, 0.0, eave + teeth, "", roof, teeth, across=across and wide)
    return (*grown, *remainder(site, grown, eave, ""))


def _chimney(
    site: Site, boiler: Any, side: float, plot: Plot, size: float, eave: float
) -> tuple[list[Mass], Any]:
    """Square foot and a round shaft that tapers, in a corner of the boiler house; its square."""
    none = shapely.Polygon()
    if size <= 0 or boiler.area < 50:
        return [], none
    tall = plot.between("chimney", 2.8, 4.6) * eave * size
    foot = min(max(0.085 * tall, 2.4), 4.2)
    x0, y0, x1, _ = boiler.bounds
    x = x1 - foot / 2 if side > 0 else x0 + foot / 2
    y = y0 + foot / 2
    square = shapely.box(x - foot / 2, y - foot / 2, x + foot / 2, y + foot / 2)
    inside = shapely.intersection(boiler, square, grid_size=0.01)
    if inside.area < 0.97 * square.area:
        return [], none
    low = min(0.8 * eave, 0.3 * tall)
    found = site.masses(inside, 0.0, low, "stack")
    steps = 4
    for step in range(steps):
        radius = 0.43 * foot * (1 - 0.11 * step)
        base = low + (tall - low) * step / steps
        high = low + (tall - low) * (step + 1) / steps
        found += site.masses(disc(x, y, radius, SIDES), base, high, "shaft")
    crown = disc(x, y, 0.36 * foot, SIDES)
    return [*found, *site.masses(crown, tall, tall + 1.3, "crown")], square


GENERATOR = generator(masses)
sawtooth_factory = action_of("building/sawtooth_factory-v1", GENERATOR, masses)
