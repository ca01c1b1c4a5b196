"""Low-rise of Japanese towns: tiled boxes, set-back top floors, outdoor stairs, units, meters."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Annotated

from cityx.building.generators import action_of, generator
from cityx.building.massing.lots import lot_of
from cityx.building.massing.massing import Mass, Plot
from cityx.protocol import Range

LEAST = 4.6  # metres that a top floor keeps
INSIDE = 0.08  # metres between walls that stand above one another
BOARDED, KEEPERS = 0.12, 0.5  # shares of low houses of boards and, up to the second, of shops
SHED_RISE = 0.32  # rise over run of its sloping roof


def masses(
    plot: Plot,
    *,
    setback: Annotated[float, Range(0.0, 4.0)] = 1.5,
    sloping: Annotated[float, Range(0.0, 1.0)] = 0.5,
) -> tuple[Mass, ...]:
    """Build the small mixed houses of Japanese towns.

    Tiled or metal-clad boxes of two to four storeys with the top floor set back, balconies with
    washing, an outdoor stair, cooling units, meters, vertical signs and vending machines.

    Draw the top floor back from the street and, at times, from one side, under a shed roof.

    Houses of boards under pitched roofs, and low shops, keep their plain volume.

    Parameters
    ----------
    setback
        Metres by which the top floor stands back; 0 leaves it on the wall below.
    sloping
        Share of the level roofs that slope instead, for the daylight of the street.
    """
    lot = lot_of(plot)
    kind = plot.draw("kind") if plot.levels <= 3 and plot.noise else 1.0
    if kind < (BOARDED if plot.roof == "flat" else 0.75):
        return (replace(plot.body, zone="boarded"),)
    if kind < KEEPERS:
        return (replace(plot.body, zone="keeper"),)
    zone = plot.pick("balcony", ("", "glazed", "railed"), (3, 3, 3)) if plot.noise else ""
    body = replace(plot.body, zone=zone)
    if not lot.boxy or plot.levels < 2 or setback <= 0:
        return (body,)
    turn, back, beside, slopes, tops = plot.draws("japanese", 5)
    storey = plot.storey
    depth = setback * (0.7 + 0.6 * back)
    if lot.depth - depth < LEAST or lot.length < 3.0:
        return (body,)
    floors = 2 if plot.levels >= 5 and tops < 0.5 else 1
    level = (plot.levels - floors) * storey
    x0, x1 = -lot.x, lot.x
    if beside < 0.4 and lot.length - depth > LEAST:
        x0, x1 = (x0 + depth, x1) if turn < 0.5 else (x0, x1 - depth)
    roof, rise, down = plot.roof, plot.rise, math.nan
    if roof == "flat" and not plot.said and slopes < sloping:
        # The slant that the daylight of the street asks for.
        roof, down = "skillion", lot.compass(0.0, 1.0 if slopes < 0.7 * sloping else -1.0)
        rise = min(SHED_RISE * (lot.depth - depth), 0.42 * storey)
    foot = Mass(plot.plan, 0.0, level, zone)
    # Its walls run down inside those below, clear of them.
    x0, x1 = max(x0, -lot.x + INSIDE), min(x1, lot.x - INSIDE)
    box = (x0, -lot.y + INSIDE, x1, lot.y - depth)
    top = lot.masses([box], low=level, high=plot.height, zone="top",
                     roof=roof, rise=rise, direction=down)  # fmt: skip
    return (foot, *top) if top else (body,)


GENERATOR = generator(masses)
japanese_lowrise = action_of("building/japanese_lowrise-v1", GENERATOR, masses)
