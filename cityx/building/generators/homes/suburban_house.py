"""Suburban houses: family houses with a wing or a gable to the street, a porch, a garage."""

from __future__ import annotations

import math
from typing import Annotated

from cityx.building.generators import action_of, generator
from cityx.building.massing.lots import Lot, lot_of, masses_on, slope_of
from cityx.building.massing.massing import Mass, Plot
from cityx.protocol import Range

LEAST = 6.4  # metres of house; a narrower one has neither porch nor garage
TWO_CARS = 5.6  # metres of a garage for two
EAVE = 2.6  # metres under the eaves of porch and garage
WINGED = 0.2  # share of its box that a plan must lack to have a ridge for each wing
DEEPEST = 3.7  # metres of a porch
REACH = 0.37  # share of a front that its wing takes


def masses(
    plot: Plot,
    *,
    garage: Annotated[float, Range(0.0, 1.0)] = 0.6,
    porch: Annotated[float, Range(0.0, 1.0)] = 0.7,
    wing: Annotated[float, Range(0.0, 1.0)] = 0.6,
) -> tuple[Mass, ...]:
    """Build detached family houses of the suburbs.

    Two storeys under a pitched roof, a wing or a gable to the street, a porch on posts, bay
    windows, and a garage with a lower roof of its own.

    Cut a garage off a side and a porch off the front; what is left is the house.

    Parameters
    ----------
    garage, porch, wing
        Share of houses with a garage, with a porch, and, of these, with a wing beside it.
    """
    if plot.rise <= 0:
        return (plot.body,)
    lot = lot_of(plot)
    if not lot.boxy or lot.narrow < LEAST:
        return (plot.body,)
    turn, parks, fronts, winged, deep, roofing = plot.draws("suburban house", 6)
    eave, slope = plot.height - plot.rise, slope_of(plot, lot)
    side = 1.0 if turn < 0.5 else -1.0
    width = 0.0
    if parks < garage and eave > EAVE + 0.4:
        width = TWO_CARS if lot.length > 15.5 else 3.4 if lot.length > LEAST + 3.4 else 0.0
    made = _garage(lot, side, width, slope, eave, roofing) if width else []
    # The house itself, from `near` (at the garage) to `far`; x runs away from the garage.
    near, far = -lot.x + width, lot.x
    body = far - near
    if fronts >= porch or lot.depth < LEAST + 1.4:
        return (*made, *_plain(lot, plot, side, near, far, slope))
    if winged < wing:
        return (*made, *_winged(lot, plot, side, (near, far - REACH * body, far), deep, slope))
    cut = 1.6 + 0.9 * deep
    return (*made, *_gabled(lot, plot, side, near, far, cut, slope))


def _boxed(side: float, x0: float, x1: float) -> tuple[float, float]:
    """Turn a span that is counted away from the garage into one from left to right."""
    return (x0, x1) if side > 0 else (-x1, -x0)


def _garage(
    lot: Lot, side: float, width: float, slope: float, eave: float, draw: float
) -> list[Mass]:
    x0, x1 = _boxed(side, -lot.x, -lot.x + width)
    box = [(x0, -lot.y, x1, lot.y)]
    zone = "garage" if width < TWO_CARS else "garage_pair"
    room = eave - EAVE - 0.15
    if draw < 0.45:
        rise = min(slope * width / 2, room + 0.6)
        return lot.masses(box, low=0.0, high=EAVE + rise, zone=zone, roof="gabled",
                          rise=rise, direction=lot.inward())  # fmt: skip
    if draw < 0.8:
        rise = min(0.8 * slope * width, room)
        return lot.masses(box, low=0.0, high=EAVE + rise, zone=zone, roof="skillion",
                          rise=rise, direction=lot.compass(-side, 0.0))  # fmt: skip
    return lot.masses(box, low=0.0, high=EAVE + 0.35, zone=zone)


def _plain(lot: Lot, plot: Plot, side: float, near: float, far: float, slope: float) -> list[Mass]:
    x0, x1 = _boxed(side, near, far)
    rise = min(slope * min(far - near, lot.depth) / 2, plot.rise)
    high = plot.height - plot.rise + rise
    return lot.masses([(x0, -lot.y, x1, lot.y)], low=0.0, high=high, roof=plot.roof, rise=rise)


def _winged(
    lot: Lot, plot: Plot, side: float, x: tuple[float, float, float], draw: float, slope: float
) -> list[Mass]:
    """Build an L with a ridge for each wing, its inner corner under a porch."""
    near, knee, far = x
    roof = plot.roof if plot.said else "gabled"
    cut = WINGED * (far - near) * lot.depth / (knee - near)
    if cut > DEEPEST or plot.roof == "hipped":  # a hip needs no deep corner
        cut, roof = 1.7 + draw, plot.roof if plot.said else "hipped"
    back, step, front = -lot.y, lot.y - cut, lot.y
    ring = [(near, back), (far, back), (far, front), (knee, front), (knee, step), (near, step)]
    if side < 0:
        ring = [(-a, b) for a, b in ring[::-1]]
    rise = min(slope * min(far - near, lot.depth) / 2, plot.rise)
    high = plot.height - plot.rise + rise
    made = masses_on(lot.outline(ring), low=0.0, high=high, roof=roof, rise=rise)
    x0, x1 = _boxed(side, near, knee)
    return made + _porch(lot, plot, (x0, step, x1, front), slope)


def _gabled(
    lot: Lot, plot: Plot, side: float, near: float, far: float, cut: float, slope: float
) -> list[Mass]:
    """Turn the gable to the street and stand a porch before it."""
    x0, x1 = _boxed(side, near, far)
    span = far - near if plot.roof == "gabled" else min(far - near, lot.depth - cut)
    rise = min(slope * span / 2, 1.2 * plot.rise, plot.rise + 0.4)
    high = min(plot.height, plot.height - plot.rise + rise)
    rise = high - (plot.height - plot.rise)
    direction = lot.inward() if plot.roof in ("gabled", "half-hipped") else math.nan
    made = lot.masses([(x0, -lot.y, x1, lot.y - cut)], low=0.0, high=high, roof=plot.roof,
                      rise=rise, direction=direction)  # fmt: skip
    return made + _porch(lot, plot, (x0, lot.y - cut, x1, lot.y), slope)


def _porch(
    lot: Lot, plot: Plot, box: tuple[float, float, float, float], slope: float
) -> list[Mass]:
    rise = min(0.7 * slope * (box[3] - box[1]), 0.9, plot.storey + 0.7 - EAVE)
    rise = max(rise, 0.2)
    return lot.masses([box], low=0.0, high=EAVE - 0.1 + rise, zone="porch", roof="skillion",
                      rise=rise, direction=lot.along(), walls=False)  # fmt: skip


GENERATOR = generator(masses)
suburban_house = action_of("building/suburban_house-v1", GENERATOR, masses)
