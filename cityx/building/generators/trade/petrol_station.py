"""Petrol stations: a lit canopy on posts over rows of pumps, a shop, a price sign."""

from __future__ import annotations

from typing import Annotated, Any

import shapely

from cityx.building.generators import action_of, generator
from cityx.building.massing.massing import Mass, Plot, carve, site_of
from cityx.protocol import Range

CLEAR = 4.6  # metres under a canopy, for lorries
FASCIA = 1.1  # metres
LEAST_SHOP = 11.0  # metres of depth from which a shop stands behind the pumps
LEAST_WIDTH = 4.5  # metres of a canopy


def masses(
    plot: Plot,
    *,
    shop: Annotated[float, Range(0.0, 0.6)] = 0.34,
    rows: Annotated[int, Range(0, 4)] = 0,
    totem: bool = True,
) -> tuple[Mass, ...]:
    """Build petrol stations: pumps under a canopy, a shop behind, a price sign.

    Divide the plan into a shop at the back and pumps under a canopy at the street.

    Parameters
    ----------
    shop
        Depth of the shop as a share of the plan's; 0 leaves the canopy alone.
    rows
        Rows of pumps; 0 takes what suits the depth.
    totem
        Whether a price sign stands at the street.
    """
    site = site_of(plot)
    half, deep = site.half
    if min(2 * half, 2 * deep) < LEAST_WIDTH:
        return tuple(site.masses(site.plan, 0.0, min(plot.height, 4.2), "shop"))
    grown: list[Mass] = []
    rest: Any = site.plan
    if totem and half > 6.0:
        side = 1.0 if plot.draw("totem side") < 0.5 else -1.0
        x = side * (half - 1.1)
        square = shapely.box(x - 1.1, deep - 1.1, x + 1.1, deep - 0.1)
        if shapely.intersection(rest, square).area > 0.97 * square.area:
            post = shapely.box(x - 1.0, deep - 0.8, x + 1.0, deep - 0.45)
            rest = shapely.difference(rest, square.buffer(0.8, join_style="mitre"), grid_size=0.01)
            grown += site.masses(post, 0.0, 6.8, "totem")
    gap = 0.0
    if shop > 0 and 2 * deep > LEAST_SHOP:
        depth = min(max(shop * 2 * deep, 4.5), 12.0)
        gap = min(1.5, 0.08 * deep)
        share = plot.between("shop length", 0.55, 0.95)
        slide = (1 - share) * half * (2 * plot.draw("shop slide") - 1) * min(1.0, 2 * plot.noise)
        box = shapely.box(slide - share * half, -999, slide + share * half, -deep + depth)
        back, _ = carve(rest, box)
        grown += site.masses(back, 0.0, plot.between("shop height", 3.6, 4.6), "shop")
        rest = carve(rest, shapely.box(-999, -deep + depth + gap, 999, 999))[0]
    x0, y0, x1, y1 = rest.bounds
    inset = min(0.8, 0.06 * (y1 - y0))
    clear = rest.buffer(-inset, join_style="mitre")
    top = CLEAR + FASCIA
    usual = max(1, min(3, round((y1 - y0) / 8.5)))
    count = rows or usual
    for number in range(count):
        a = y0 + (y1 - y0) * number / count
        b = y0 + (y1 - y0) * (number + 1) / count
        lane = shapely.intersection(clear, shapely.box(x0, a + 0.2, x1, b - 0.2), grid_size=0.01)
        grown += site.masses(lane, 0.0, CLEAR, "pumps", walls=False)
    return (*grown, *site.masses(rest, CLEAR, top + 0.25, "fascia", "rimmed", 0.25))


GENERATOR = generator(masses)
petrol_station = action_of("building/petrol_station-v1", GENERATOR, masses)
