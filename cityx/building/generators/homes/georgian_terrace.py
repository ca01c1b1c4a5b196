"""Georgian terraces: narrow brick houses of London, wall to wall, their roofs behind parapets."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated

import shapely

from cityx.building.generators import action_of, generator
from cityx.building.massing.massing import Mass, Plot, carve, site_of
from cityx.protocol import Choice, Range

ROOFS = ("butterfly", "mansard", "flat")
SCREEN = 0.9  # metres of depth of the front wall that stands up as a parapet
VALLEY = 1.25  # metres from the valley of a London roof to its edges
GRAND = 0.35  # share of terraces of stucco all over


def masses(
    plot: Plot,
    *,
    roof: Annotated[str, Choice("any", *ROOFS)] = "any",
    parapet: Annotated[float, Range(0.4, 1.6)] = 0.9,
    closet: Annotated[float, Range(0.0, 1.0)] = 0.6,
) -> tuple[Mass, ...]:
    """Build Georgian terraces of London.

    Narrow houses of stock brick or stucco: small-paned sashes, a door under a fanlight, railings
    before the area, iron balconies, a parapet before a roof with a valley, chimney stacks on the
    party walls.

    Hide a roof with a valley behind the front's parapet, and add a closet wing at the back.

    Parameters
    ----------
    roof
        Roof behind the parapet.
    parapet
        Metres of the parapet above the last ceiling.
    closet
        Share of houses with a narrow wing at the back.
    """
    zone = "stucco" if plot.draw("grand") < GRAND else ""
    body = replace(plot.body, zone=zone)
    if plot.said or plot.levels < 2:
        return (body,)
    eave = plot.height - plot.rise
    word = plot.pick("london roof", ROOFS, (4, 3, 2)) if roof == "any" else roof
    site = site_of(plot)
    x, y = site.half
    if min(x, y) < 2.2 or plot.plan.area < 2.8 * x * y:
        return (replace(body, high=eave, roof="flat", rise=0.0),)
    rest = site.plan
    found: list[Mass] = []
    if 2 * y > 8.5 and 2 * x < 12.0 and plot.draw("closet") < closet:
        deep = plot.between("closet depth", 2.2, 3.2)
        back, rest = carve(rest, shapely.box(-2 * x, -2 * y, 2 * x, deep - y))
        side = shapely.box(0.06 * x, -2 * y, 2 * x, 2 * y)
        tall, low = carve(back, side)
        found += site.masses(tall, 0.0, eave - plot.storey, "closet", "skillion", 0.5,
                             down=(0.0, -1.0))  # fmt: skip
        found += site.masses(low, 0.0, plot.storey, "closet")
    if word == "butterfly":
        front, rest = carve(rest, shapely.box(-2 * x, y - SCREEN, 2 * x, 2 * y))
        found += site.masses(front, 0.0, eave + parapet, zone)
        found += site.masses(rest, 0.0, eave + 0.75 * parapet, "behind", "butterfly",
                             min(VALLEY, 0.3 * x), down=(1.0, 0.0))  # fmt: skip
    elif word == "mansard":
        rise = min(max(plot.rise, 2.6), 3.4)
        found += site.masses(rest, 0.0, eave + rise, zone, "mansard", rise)
    else:
        found += site.masses(rest, 0.0, eave + parapet, zone)
    return tuple(found)


GENERATOR = generator(masses)
georgian_terrace = action_of("building/georgian_terrace-v1", GENERATOR, masses)
