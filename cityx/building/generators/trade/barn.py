"""Barns: boarded halls under gambrel roofs, sliding doors with crossed braces, lean-to sheds."""

from __future__ import annotations

from typing import Annotated

from cityx.building.generators import action_of, generator
from cityx.building.massing.lots import lot_of
from cityx.building.massing.massing import Mass, Plot
from cityx.protocol import Range

LEAST = 5.5  # metres of barn beside a lean-to
LOWEST = 2.3  # metres under the eave of a lean-to


def masses(
    plot: Plot,
    *,
    lean: Annotated[float, Range(0.0, 1.0)] = 0.75,
    both: Annotated[float, Range(0.0, 1.0)] = 0.25,
) -> tuple[Mass, ...]:
    """Build boarded barns.

    Gambrel or gabled roofs over board walls, sliding doors with crossed braces, a hay loft with its
    hoist in the gable, a louvred cupola on the ridge, and lean-to sheds along the sides.

    Lean a shed against one long side, or against both.

    Parameters
    ----------
    lean, both
        Share of barns with a lean-to, and, of these, with one on either side.
    """
    lot = lot_of(plot, lengthwise=True)
    eave = plot.height - plot.rise
    leans, second, deep, turn = plot.draws("barn", 4)
    width = (0.2 + 0.06 * deep) * lot.depth
    width = min(max(width, 2.2), 5.0)
    sides = 2 if second < both else 1
    if sides == 2 and lot.depth - 2 * width < LEAST:
        sides = 1
    fits = lot.boxy and lot.depth - sides * width >= LEAST and eave > LOWEST + 0.8
    if leans >= lean or not fits or plot.rise <= 0:
        return (plot.body,)
    rise = min(0.45 * width, eave - LOWEST - 0.25)
    share = (lot.depth - sides * width) / lot.depth
    up = plot.rise * share
    y0, y1 = -lot.y + width, lot.y - (width if sides == 2 else 0.0)
    strips = [((-lot.x, -lot.y, lot.x, y0), -1.0)]
    if sides == 2:
        strips.append(((-lot.x, y1, lot.x, lot.y), 1.0))
    elif turn < 0.3:  # towards the street
        y0, y1 = -y1, -y0
        strips = [((-lot.x, y1, lot.x, lot.y), 1.0)]
    made = lot.masses([(-lot.x, y0, lot.x, y1)], low=0.0, high=eave + up, roof=plot.roof, rise=up,
                      direction=lot.along())  # fmt: skip
    for box, way in strips:
        made += lot.masses([box], low=0.0, high=LOWEST + rise, zone="lean", roof="skillion",
                           rise=rise, direction=lot.compass(0.0, way))  # fmt: skip
    return tuple(made)


GENERATOR = generator(masses)
barn = action_of("building/barn-v1", GENERATOR, masses)
