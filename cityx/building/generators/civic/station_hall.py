"""Railway stations: a head building with a clock and arches before vaulted train sheds."""

from __future__ import annotations

import math
from typing import Annotated, Any

import shapely

from cityx.building.generators import action_of, generator
from cityx.building.massing.massing import Mass, Plot, Site, carve, remainder, site_of
from cityx.protocol import Range

LEAST_AREA = 500.0  # square metres from which there is a train shed
SPAN = 32.0  # metres, the widest usual vault


def masses(
    plot: Plot,
    *,
    spans: Annotated[int, Range(0, 6)] = 0,
    clock: Annotated[float, Range(0.0, 2.0)] = 1.0,
    pavilions: bool = True,
) -> tuple[Mass, ...]:
    """Build railway stations of the nineteenth century.

    A booking hall with tall arched windows, lower wings behind an awning of iron and glass,
    pavilions at the ends, and train sheds under round roofs with glazed ends.

    Cut the head off at the street and vault the rest.

    Parameters
    ----------
    spans
        Vaults side by side; 0 takes what suits the width.
    clock
        Height of the clock tower relative to the usual one; 0 leaves it out.
    pavilions
        Whether the wings end in pavilions.
    """
    site = site_of(plot)
    deep = site.half[1]
    high = min(max(plot.height - plot.rise, 7.0), 22.0)
    if deep < 3.5:
        return (plot.body,)
    if site.plan.area < LEAST_AREA or deep < 8.0:
        rise = min(0.5 * deep, 4.0)
        return tuple(_head(site, site.plan, plot, high, clock, pavilions=pavilions, rise=rise))
    depth = min(max(0.3 * 2 * deep, 8.0), 17.0)
    head, shed = carve(site.plan, shapely.box(-999, deep - depth, 999, 999))
    grown = _head(site, head, plot, high, clock, pavilions=pavilions, rise=0.22 * depth)
    grown += _sheds(site, shed, high, spans)
    return (*grown, *remainder(site, grown, 0.6 * high, "wing"))


def _head(site: Site, head: Any, plot: Plot, high: float, clock: float, *, pavilions: bool,
          rise: float) -> list[Mass]:  # fmt: skip
    """Wings, a higher booking hall in the middle, pavilions at the ends, a clock tower."""
    x0, _, x1, y1 = head.bounds
    length, middle = x1 - x0, (x0 + x1) / 2
    wing = plot.between("wing", 0.5, 0.74) * high
    grown: list[Mass] = []
    rest = head
    wide = min(max(0.26 * length, 9.0), 26.0)
    if length > 2.2 * wide:
        hall, rest = carve(rest, shapely.box(middle - wide / 2, -999, middle + wide / 2, 999))
        shape = plot.pick("hall roof", ("mansard", "hipped", "flat"), (3, 2, 2))
        up = 0.0 if shape == "flat" else min(0.34 * wide, 6.0)
        grown += site.masses(hall, 0.0, high + up, "hall", shape, up)
        side = min(max(0.5 * wide, 6.0), 11.0)
        ends = plot.draw("pavilions") < 0.75
        if pavilions and ends and length > wide + 5 * side:
            for x in (x0, x1 - side):
                end, rest = carve(rest, shapely.box(x, -999, x + side, 999))
                up = 0.45 * side
                grown += site.masses(end, 0.0, 0.8 * high + up, "pavilion", "mansard", up)
        tower = 0.0 if clock <= 0 or plot.draw("clock tower") > 0.55 else 6.2
        edge = middle + wide / 2
        square = shapely.box(edge, y1 - tower, edge + tower, y1)
        if tower and shapely.intersection(rest, square).area > 0.97 * square.area:
            inside, rest = carve(rest, square)
            top = 1.75 * high * clock
            grown += site.masses(inside, 0.0, top, "shaft")
            upper = square.buffer(-0.35, join_style="mitre")
            grown += site.masses(upper, top, top + 4.6 + 5.5, "clock", "pyramidal", 5.5)
    return [*grown, *site.masses(rest, 0.0, wing + rise, "wing", "hipped", rise)]


def _sheds(site: Site, shed: Any, high: float, spans: int) -> list[Mass]:
    """Side by side vaults, whose ridge runs away from the street where the shed is deep."""
    grown: list[Mass] = []
    for part in shapely.get_parts(shed):
        x0, y0, x1, y1 = part.bounds
        away = (y1 - y0) > 0.42 * (x1 - x0)
        width = (x1 - x0) if away else (y1 - y0)
        count = spans or max(1, math.ceil(width / SPAN))
        # A vault is longer than it is wide.
        length = (y1 - y0) if away else (x1 - x0)
        count = max(count, math.ceil(width / max(0.95 * length, 1.0)))
        for number in range(count):
            span = width / count
            a, b = number * span, (number + 1) * span
            lane = shapely.box(x0 + a, -999, x0 + b, 999)
            if not away:
                lane = shapely.box(-999, y0 + a, 999, y0 + b)
            rise = min(0.42 * span, 12.0)
            eave = max(0.5 * high, 5.5)
            down = (1.0, 0.0) if away else (0.0, 1.0)
            piece = shapely.intersection(part, lane, grid_size=0.01)
            grown += site.masses(piece, 0.0, eave + rise, "shed", "round", rise, down=down)
    return grown


GENERATOR = generator(masses)
station_hall = action_of("building/station_hall-v1", GENERATOR, masses)
