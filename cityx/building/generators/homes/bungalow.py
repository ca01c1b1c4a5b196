"""Bungalows: one long low storey under a shallow roof, a deep porch on posts, a carport."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated

from cityx.building.generators import action_of, generator
from cityx.building.massing.lots import Box, Lot, lot_of, masses_on, slope_of
from cityx.building.massing.massing import Mass, Plot
from cityx.protocol import Range

LEAST = 6.2  # metres of house; a narrower one has neither porch nor carport
CARPORT = 3.3  # metres of its width
EAVE = 2.35  # metres under the eave of porch and carport
WINGED = 0.2  # share of its box that a plan must lack to have a ridge for each wing
DEEPEST = 3.8  # metres of a porch
STEEPEST = 1.1  # rise over run of a roof with a storey in it
SHALLOW = 0.24  # rise over run of their roofs


def masses(
    plot: Plot,
    *,
    porch: Annotated[float, Range(0.0, 1.0)] = 0.85,
    carport: Annotated[float, Range(0.0, 1.0)] = 0.5,
) -> tuple[Mass, ...]:
    """Build low bungalows and ranch houses.

    One storey under a shallow hipped or gabled roof, picture windows, knee braces under the eaves,
    a porch on posts along the front and a carport at one end.

    Open a carport at one end and a porch along the front of a low house.

    Parameters
    ----------
    porch, carport
        Share of houses with a porch, and with a carport.
    """
    lot = lot_of(plot)
    if not lot.boxy or lot.narrow < LEAST or plot.rise <= 0:
        return (plot.body,)
    turn, parks, sits, wide, deep, gable = plot.draws("bungalow", 6)
    side = 1.0 if turn < 0.5 else -1.0
    if plot.levels > 1 and not plot.said:
        plot = _under_the_roof(plot, lot)
    eave, slope = plot.height - plot.rise, slope_of(plot, lot)
    made: list[Mass] = []
    near = -lot.x
    if parks < carport and lot.length > LEAST + CARPORT:
        near += CARPORT
        rise = SHALLOW * CARPORT
        made += lot.masses([_box(side, -lot.x, near, -lot.y, lot.y)], low=0.0, high=EAVE + rise,
                           zone="carport", roof="skillion", rise=rise,
                           direction=lot.compass(-side, 0.0), walls=False)  # fmt: skip
    body = lot.x - near
    if sits >= porch or lot.depth < LEAST + 1.8:
        return (*made, *_house(lot, plot, slope, _ring(side, near, lot.x, lot.x, lot.y, lot.y)))
    cut = min(1.8 + 0.8 * deep, 0.3 * lot.depth)
    knee = near + (0.5 + 0.14 * wide) * body if wide < 0.6 and body > 9.0 else lot.x
    if knee < lot.x and plot.roof == "gabled":
        # A ridge for each wing needs a deep corner; else the porch takes the whole front.
        wanted = WINGED * lot.depth * body / (knee - near)
        cut, knee = (wanted, knee) if wanted < DEEPEST else (cut, lot.x)
    made += _house(lot, plot, slope, _ring(side, near, knee, lot.x, lot.y - cut, lot.y))
    box = _box(side, near, knee, lot.y - cut, lot.y)
    if gable < 0.45 and knee - near < 9.0:
        rise = min(0.5 * SHALLOW * (knee - near), eave + 0.35 - EAVE)
        down = lot.inward()
    else:
        rise, down = SHALLOW * cut, lot.along()
    rise = max(rise, 0.2)
    made += lot.masses([box], low=0.0, high=EAVE + rise, zone="porch",
                       roof="gabled" if down == lot.inward() else "skillion", rise=rise,
                       direction=down, walls=False)  # fmt: skip
    return tuple(made)


def _under_the_roof(plot: Plot, lot: Lot) -> Plot:
    """Take the top storey into the roof, as high as that is not too steep."""
    eave = max((plot.levels - 1) * plot.storey, plot.height - 0.5 * STEEPEST * lot.narrow)
    return replace(plot, rise=plot.height - eave)


def _box(side: float, x0: float, x1: float, y0: float, y1: float) -> Box:
    return (x0, y0, x1, y1) if side > 0 else (-x1, y0, -x0, y1)


def _ring(
    side: float, near: float, knee: float, far: float, step: float, front: float
) -> list[tuple[float, float]]:
    """Outline of a house whose front lies back from `near` to `knee`."""
    back = -front
    ring = [(near, back), (far, back), (far, front if knee < far else step)]
    ring += [(knee, front), (knee, step)] if knee < far else []
    ring.append((near, step))
    return ring if side > 0 else [(-a, b) for a, b in ring[::-1]]


def _house(lot: Lot, plot: Plot, slope: float, ring: list[tuple[float, float]]) -> list[Mass]:
    wide = max(a for a, _ in ring) - min(a for a, _ in ring)
    deep = max(b for _, b in ring) - min(b for _, b in ring)
    rise = min(0.5 * slope * min(wide, deep), plot.rise)
    eave = plot.height - plot.rise
    # A plan with wings takes a hip over each.
    roof = "hipped" if len(ring) > 4 and plot.roof != "gabled" and not plot.said else plot.roof
    return masses_on(lot.outline(ring), low=0.0, high=eave + rise, roof=roof, rise=rise)


GENERATOR = generator(masses)
bungalow = action_of("building/bungalow-v1", GENERATOR, masses)
