"""Sheds: boarded garden sheds, brick garages, and the open stores beside them."""

from __future__ import annotations

from typing import Annotated

from cityx.building.generators import action_of, generator
from cityx.building.massing.lots import lot_of
from cityx.building.massing.massing import Mass, Plot
from cityx.protocol import Range

LEAST = 2.8  # metres of shed beside a store
STORE = 1.9  # metres of the store's width
LOWEST = 1.85  # metres under its eave


def masses(
    plot: Plot,
    *,
    store: Annotated[float, Range(0.0, 1.0)] = 0.3,
    slope: Annotated[float, Range(0.0, 0.6)] = 0.0,
) -> tuple[Mass, ...]:
    """Build sheds and garages.

    Garden sheds of boards and garages of brick or render, with one door that fits, under gabled,
    lean-to or level roofs, some with an open store at one end.

    Open a store for wood or a mower at one end; most sheds are one plain volume.

    Parameters
    ----------
    slope
        Rise over run of a lean-to roof that falls to the back, 0 for the shed's own roof.

    Parameters
    ----------
    store
        Share of sheds with an open store.
    slope
        Rise over run of lean-to roofs instead of the usual ones; 0 keeps those.
    """
    body = plot.body
    if slope > 0 and not plot.said:
        lot = lot_of(plot)
        eave = plot.height - plot.rise
        rise = min(slope * lot.depth, 0.45 * eave)
        if rise > 0.15:
            return (Mass(plot.plan, 0.0, eave + rise, "", "skillion", rise,
                         lot.compass(0.0, -1.0)),)  # fmt: skip
    if store <= 0 or plot.plan.area < 14.0:
        return (body,)
    stores, turn = plot.draws("shed", 2)
    if stores >= store:
        return (body,)
    lot = lot_of(plot, lengthwise=True)
    eave = plot.height - plot.rise
    rise = min(0.3 * STORE, eave - 0.1 - LOWEST)
    if not lot.boxy or lot.length < LEAST + STORE or rise < 0.15:
        return (body,)
    cut = -lot.x + STORE if turn < 0.5 else lot.x - STORE
    left, right = (-lot.x, -lot.y, cut, lot.y), (cut, -lot.y, lot.x, lot.y)
    main, open_ = (right, left) if turn < 0.5 else (left, right)
    up = plot.rise * min(1.0, (main[2] - main[0]) / lot.depth)
    made = lot.masses([main], low=0.0, high=eave + up, roof=plot.roof, rise=up)
    made += lot.masses([open_], low=0.0, high=LOWEST + rise, zone="store", roof="skillion",
                       rise=rise, direction=lot.compass(-1.0 if turn < 0.5 else 1.0, 0.0),
                       walls=False)  # fmt: skip
    return tuple(made)


GENERATOR = generator(masses)
shed = action_of("building/shed-v1", GENERATOR, masses)
