"""Warehouses: ribbed halls with a row of docks on one side and an office at a corner."""

from __future__ import annotations

from typing import Annotated, Any

import shapely

from cityx.building.generators import action_of, generator
from cityx.building.massing.massing import Mass, Plot, carve, remainder, site_of
from cityx.protocol import Range

LEAST_AREA = 350.0  # square metres; a smaller one is a plain shed with gates
LEAST_WIDTH = 13.0  # metres
DOCKS = 6.2  # metres of the height of the part that the docks are in


def masses(
    plot: Plot,
    *,
    docks: bool = True,
    office: Annotated[float, Range(0.0, 0.35)] = 0.16,
    bays: Annotated[int, Range(0, 8)] = 0,
) -> tuple[Mass, ...]:
    """Build warehouses: clad halls with loading docks and an office at a corner.

    Cut an office and a dock side off the plan, and roof the rest in one or more spans.

    Parameters
    ----------
    docks
        Whether the front is a row of docks.
    office
        Length of the office as a share of the hall's; 0 leaves it out.
    bays
        Spans side by side; 0 takes what suits the depth.
    """
    site = site_of(plot)
    half, deep = site.half
    eave = min(max(plot.height - plot.rise, 5.0), 18.0)
    span = 2 * deep if not bays else 2 * deep / bays
    many = bays > 1 or (not bays and span > 34.0)
    roof = plot.pick("roof", ("flat", "gabled", "round"), (5, 4, 1))
    if plot.said:
        roof = plot.roof
    if many and roof in ("gabled", "round"):
        roof = "gabled_row"
    rise = 0.0 if roof == "flat" else min(0.07 * min(span, 30.0) + 0.4, 3.0)
    rise = 0.16 * span if roof == "round" else rise
    if site.plan.area < LEAST_AREA or 2 * deep < LEAST_WIDTH:
        roof = roof if roof != "gabled_row" else "gabled"
        return tuple(site.masses(site.plan, 0.0, eave + rise, "", roof, rise))
    grown: list[Mass] = []
    rest: Any = site.plan
    side = 1.0 if plot.draw("office side") < 0.5 else -1.0
    length = min(max(office * 2 * half, 8.0), 26.0)
    if office > 0 and 2 * half > 2.6 * length:
        x0, x1 = sorted((side * half * 1.1, side * (half - length)))
        depth = min(max(0.3 * 2 * deep, 7.0), 12.0)
        corner, rest = carve(rest, shapely.box(x0, deep - depth, x1, 999))
        grown += site.masses(corner, 0.0, eave + 1.1, "office")
    depth = min(max(0.16 * 2 * deep, 4.0), 8.0)
    if docks and eave > DOCKS + 0.8:
        front, rest = carve(rest, shapely.box(-999, deep - depth, 999, 999))
        low = DOCKS + 0.8 if plot.draw("docks low") < 0.6 else eave - 0.01
        grown += site.masses(front, 0.0, low, "docks")
    grown += site.masses(rest, 0.0, eave + rise, "", roof, rise)
    return (*grown, *remainder(site, grown, 5.0, "docks"))


GENERATOR = generator(masses)
warehouse = action_of("building/warehouse-v1", GENERATOR, masses)
