"""East Asian residential blocks: crosses, stars and notched slabs on podiums, ranks of units."""

from __future__ import annotations

import math
from typing import Annotated, Any

import numpy as np
import shapely

from cityx.building.generators import action_of, generator
from cityx.building.massing.lots import Lot, lot_of, masses_on
from cityx.building.massing.massing import GRID, Mass, Plot
from cityx.protocol import Range

SPINE = 6.5  # metres between the light wells of two sides
PLANT = 3.2  # metres, of lift houses and tank rooms
WELL_EVERY = 12.0  # metres of front per light well
CROSS_LEAST, STAR_LEAST = 15.0, 21.0  # metres of the shorter side that a cross, a star needs
SQUARISH = 1.7  # length over width up to which a plan is that of a point block


def masses(
    plot: Plot,
    *,
    podium: Annotated[int, Range(0, 5)] = 2,
    well: Annotated[float, Range(0.0, 6.0)] = 2.4,
) -> tuple[Mass, ...]:
    """Build East Asian residential blocks.

    Point blocks on a cross or a star and slabs with light wells stand on podiums; walls of coloured
    tiles bear bay windows, enclosed balconies and ranks of cooling units, roofs the water tanks.

    Stand a cross, a star or a slab with light wells on a podium, and a lift house on top.

    Parameters
    ----------
    podium
        Storeys of the podium under high blocks.
    well
        Metres of width of the light wells of slabs; 0 leaves them out.
    """
    lot = lot_of(plot, lengthwise=True)
    if not lot.boxy or lot.depth < 9.0 or plot.levels < 4:
        return _topped(plot, lot, [plot.body])
    form, inset, deep = plot.draws("asian block", 3)
    base = podium if plot.levels >= 9 and lot.depth >= 18.0 else min(podium, 1)
    level = max(base, 1) * plot.storey
    draw_in = (0.05 + 0.05 * inset) * lot.depth if base > 1 else 0.0
    x, y = lot.x - draw_in, lot.y - draw_in
    point = x <= SQUARISH * y
    if point and 2 * y >= STAR_LEAST and form < 0.3:
        plan = _star(x, y, 0.36 + 0.08 * deep)
    elif point and 2 * y >= CROSS_LEAST:
        plan = _cross(x, y, 0.24 + 0.08 * deep)
    else:
        plan = _slab(x, y, well, 0.22 + 0.1 * deep)
    shape = lot.clipped(np.array([_placed(lot, plan)], object))[0]
    zone = "podium" if base > 1 else ""
    foot = Mass(plot.plan, 0.0, level, zone)
    tower = masses_on(shape, low=level, high=plot.height)
    if not tower:
        return _topped(plot, lot, [plot.body])
    return _topped(plot, lot, [foot, *tower])


def _placed(lot: Lot, plan: Any) -> Any:
    return shapely.set_precision(shapely.transform(plan, lot.place), GRID)


def _cross(x: float, y: float, corner: float) -> Any:
    """Cut squares from the corners of a box."""
    cut = corner * 2 * min(x, y)
    bars = [shapely.box(-x, -y + cut, x, y - cut), shapely.box(-x + cut, -y, x - cut, y)]
    return shapely.union_all(np.array(bars, object))


def _star(x: float, y: float, wing: float) -> Any:
    """Lay three wings about the middle, one to the back."""
    half = wing * min(x, y)
    reach = 1.4 * max(x, y)
    wings = []
    for turn in (-90.0, 30.0, 150.0):
        c, s = math.cos(math.radians(turn)), math.sin(math.radians(turn))
        ring = [(0.0, -half), (reach, -half), (reach, half), (0.0, half)]
        wings.append(shapely.Polygon([(a * c - b * s, a * s + b * c) for a, b in ring]))
    hub = shapely.Point(0.0, 0.0).buffer(1.15 * half, quad_segs=3)
    star = shapely.union_all(np.array([*wings, hub], object))
    return shapely.intersection(star, shapely.box(-x, -y, x, y))


def _slab(x: float, y: float, well: float, share: float) -> Any:
    """Cut light wells into both long sides of a slab."""
    deep = min(share * 2 * y, y - SPINE / 2)
    plan = shapely.box(-x, -y, x, y)
    if deep < 1.2 or well <= 0:
        return plan
    count = max(1, round(2 * x / WELL_EVERY))
    cuts = []
    for number in range(count):
        middle = -x + (number + 0.5) * 2 * x / count
        for low, high in ((-y - 1, -y + deep), (y - deep, y + 1)):
            cuts.append(shapely.box(middle - well / 2, low, middle + well / 2, high))
    return shapely.difference(plan, shapely.union_all(np.array(cuts, object)))


def _topped(plot: Plot, lot: Lot, made: list[Mass]) -> tuple[Mass, ...]:
    """Take the top storey off the last volume and stand a lift house there instead."""
    tower = max(made, key=lambda mass: (mass.high, mass.plan.area))
    tall = tower.height > 4 * PLANT and tower.roof == "flat"
    middle = shapely.Polygon(lot.place([(-2.8, -2.4), (2.8, -2.4), (2.8, 2.4), (-2.8, 2.4)]))
    if not tall or not tower.plan.buffer(-0.6).covers(middle):
        return tuple(made)
    level = plot.height - PLANT
    lower = [
        Mass(mass.plan, mass.low, min(mass.high, level), mass.zone, mass.roof, mass.rise)
        for mass in made
    ]
    return (*lower, Mass(middle, level, plot.height, "plant"))


GENERATOR = generator(masses)
asian_block = action_of("building/asian_block-v1", GENERATOR, masses)
