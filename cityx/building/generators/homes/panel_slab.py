"""Panel-built slabs: sections of large panels with open joints, loggias, stairs, lift houses."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated

import shapely

from cityx.assets.fixtures.estates import SPANDRELS
from cityx.building.generators import action_of, generator
from cityx.building.massing.massing import Mass, Plot, Site, carve, site_of
from cityx.protocol import Choice, Range

SKINS = (*SPANDRELS, *(f"loggia_{word}" for word in SPANDRELS), "grey")
STAIR = 3.4  # metres of front of a stair
STEP = 0.45  # metres that stairs stand back from the front
HEAD = 2.5  # metres of a lift house above the roof
LEAST = 8.0  # metres of a section without its stair


def masses(
    plot: Plot,
    *,
    section: Annotated[float, Range(12.0, 60.0)] = 24.0,
    colour: Annotated[str, Choice("any", "grey", *SPANDRELS)] = "any",
    step: Annotated[float, Range(0.0, 1.0)] = 0.35,
) -> tuple[Mass, ...]:
    """Build slabs of prefabricated panels.

    Storey-high panels with open joints, coloured spandrels or columns of loggias, bands of glass
    blocks before the stairs, and lift houses on the roof; long slabs consist of sections.

    Cut a slab into sections of slightly different height, a stair with a lift house in each.

    Parameters
    ----------
    section
        Metres of front that share a stair.
    colour
        Of spandrels and loggias.
    step
        Share of the sections that are a storey lower.
    """
    words = SKINS if colour == "any" else (colour, f"loggia_{colour}")
    zone = plot.pick("skin", words if colour != "grey" else ("grey",))
    zone = "" if zone == "grey" else zone
    site = _lengthwise(plot)
    x, y = site.half
    body = replace(plot.body, zone=zone, roof="flat", rise=0.0)
    if 2 * x < STAIR + LEAST or 2 * y < 6.0 or plot.levels < 3 or plot.plan.interiors:
        return (body,)
    count = max(1, round(2 * x / plot.waver("section", section, body)))
    long = 2 * x / count
    rest, found = site.plan, list[Mass]()
    heights = [_height(plot, number, step) for number in range(count)]
    for number in range(count):
        middle = -x + (number + 0.5) * long
        at = middle + (plot.draw("stair at", number) - 0.5) * 0.3 * long * min(1, 2 * plot.noise)
        span = shapely.box(at - STAIR / 2, -2 * y, at + STAIR / 2, 2 * y)
        stair, rest = carve(rest, span)
        stair = shapely.intersection(stair, shapely.box(-2 * x, -2 * y, 2 * x, y - STEP))
        high = heights[number] + HEAD if plot.levels >= 5 else heights[number]
        found += site.masses(stair, 0.0, min(high, plot.height + HEAD), "stair")
    for number in range(count):
        x0 = -2 * x if number == 0 else number * long - x
        x1 = 2 * x if number == count - 1 else (number + 1) * long - x
        piece, rest = carve(rest, shapely.box(x0, -2 * y, x1, 2 * y))
        found += site.masses(piece, 0.0, heights[number], zone)
    found += site.masses(rest, 0.0, plot.storey, zone)
    return tuple(found)


def _lengthwise(plot: Plot) -> Site:
    """Return the site with x along the slab, wherever the street lies."""
    return site_of(plot, facing=False)


def _height(plot: Plot, number: int, step: float) -> float:
    """Height of a section: that of the slab, or a storey less."""
    low = plot.draw("drop", number) < step if plot.noise else number % 2 == 1 and step > 0
    return plot.height - plot.storey if low and plot.levels > 4 else plot.height


GENERATOR = generator(masses)
panel_slab = action_of("building/panel_slab-v1", GENERATOR, masses)
