"""Mid-rise of Japanese towns: flats behind balconies, narrow houses of tenants, tiled offices."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated

from cityx.building.generators import action_of, generator
from cityx.building.massing.lots import lot_of
from cityx.building.massing.massing import Mass, Plot
from cityx.protocol import Choice, Range

FRONTS = ("parapet", "glazed", "railed", "tenants", "ribbon", "tiled")
# Of large plots with flats, and of narrow ones in trading streets.
WIDE, NARROW = (4, 3, 3, 0.8, 1.2, 2), (1.2, 0.8, 0.8, 5, 1.5, 3)
NARROW_AREA = 170.0  # square metres
LEAST = 5.0  # metres that a set-back top keeps
INSIDE = 0.08  # metres between walls that stand above one another


def masses(
    plot: Plot,
    *,
    front: Annotated[str, Choice("any", *FRONTS)] = "any",
    setback: Annotated[float, Range(0.0, 1.0)] = 0.4,
) -> tuple[Mass, ...]:
    """Build the middle-sized blocks of Japanese towns.

    Tile-clad flats behind continuous balconies with partitions and cooling units; narrow houses
    with a tenant and a sign on each floor, over a shop; offices with ribbon windows; some tops
    stand back for the daylight of the street.

    Raise a block behind one of `FRONTS`; at times its top storeys stand back from the street.

    Parameters
    ----------
    front
        What the front is like.
    setback
        Share of the blocks whose top stands back from the street.
    """
    shares = NARROW if plot.plan.area < NARROW_AREA else WIDE
    usual = plot.pick("front", FRONTS, shares) if plot.noise else FRONTS[0]
    zone = usual if front == "any" else front
    zone = "" if zone == "parapet" else zone
    body = replace(plot.body, zone=zone)
    lot = lot_of(plot)
    stepped, back, floors = plot.draws("midrise", 3)
    depth = 1.4 + 1.6 * back
    if not lot.boxy or plot.levels < 4 or lot.depth - depth < LEAST or stepped >= setback:
        return (body,)
    # The slant that the daylight of the street asks for.
    level = plot.height - (2 if floors < 0.35 and plot.levels > 5 else 1) * plot.storey
    box = (-lot.x + INSIDE, -lot.y + INSIDE, lot.x - INSIDE, lot.y - depth)
    top = lot.masses([box], low=level, high=plot.height, zone=zone)
    return (Mass(plot.plan, 0.0, level, zone), *top) if top else (body,)


GENERATOR = generator(masses)
japanese_midrise = action_of("building/japanese_midrise-v1", GENERATOR, masses)
