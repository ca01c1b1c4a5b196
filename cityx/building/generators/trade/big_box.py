"""Big-box stores: blank boxes with coloured bands, a glazed portal with a sign, a canopy."""

from __future__ import annotations

from typing import Annotated, Any

import shapely

from cityx.building.generators import action_of, generator
from cityx.building.massing.massing import Mass, Plot, carve, remainder, site_of
from cityx.protocol import Range

LEAST_AREA = 280.0  # square metres; a smaller one has a shopfront along its whole front


def masses(
    plot: Plot,
    *,
    portal: Annotated[float, Range(0.0, 0.5)] = 0.2,
    units: Annotated[int, Range(0, 8)] = 0,
    delivery: bool = True,
) -> tuple[Mass, ...]:
    """Build big-box stores: blank boxes with bands, a glazed portal, a canopy, a delivery yard.

    Set a portal, or those of several units, in the front, and a delivery yard behind.

    Parameters
    ----------
    portal
        Width of a portal as a share of its unit; 0 leaves it out.
    units
        Stores side by side, a portal each; 0 takes what suits the length.
    delivery
        Whether a lower part with docks stands behind.
    """
    site = site_of(plot)
    half, deep = site.half
    high = min(max(plot.height - plot.rise, 4.2), 14.0)
    if site.plan.area < LEAST_AREA or min(half, deep) < 6.0:
        return tuple(site.masses(site.plan, 0.0, high, "portal"))
    grown: list[Mass] = []
    rest: Any = site.plan
    count = units or (1 if 2 * half < 70 else 2 if 2 * half < 120 else 3)
    span = 2 * half / count
    depth = min(max(0.16 * 2 * deep, 3.6), 7.0)
    for number in range(count):
        wide = min(max(portal * span, 6.5), 22.0)
        room = 0.5 * (span - wide) - 2.0
        slide = room * (2 * plot.draw("portal", number) - 1) * min(1.0, 2 * plot.noise)
        x = -half + (number + 0.5) * span + 0.7 * slide
        if portal > 0 and wide < 0.8 * span:
            box = shapely.box(x - wide / 2, deep - depth, x + wide / 2, 999)
            gate, rest = carve(rest, box)
            grown += site.masses(gate, 0.0, high + plot.between("portal top", 1.6, 3.6), "portal")
    if delivery and deep > 11.0:
        side = 1.0 if plot.draw("yard side") < 0.5 else -1.0
        length = min(max(0.34 * 2 * half, 9.0), 30.0)
        x0, x1 = sorted((side * half * 1.1, side * (half - length)))
        depth = min(max(0.2 * 2 * deep, 5.0), 9.0)
        yard, rest = carve(rest, shapely.box(x0, -999, x1, -deep + depth))
        grown += site.masses(yard, 0.0, min(6.9, 0.92 * high), "yard")
    grown += site.masses(rest, 0.0, high)
    return (*grown, *remainder(site, grown, 4.2, ""))


GENERATOR = generator(masses)
big_box = action_of("building/big_box-v1", GENERATOR, masses)
