"""Greenhouses: bays of glass gables in a row, in a thin white frame."""

from __future__ import annotations

from typing import Annotated

from cityx.assets.fixtures.houses import HIGH_RISE, RISE
from cityx.building.generators import action_of, generator
from cityx.building.massing.lots import lot_of
from cityx.building.massing.massing import Mass, Plot
from cityx.protocol import Range

WIDE = 5.5  # metres; wider bays have the higher roof
LOWEST = 1.9  # metres under a gutter
MOST = 60  # bays


def masses(plot: Plot, *, bay: Annotated[float, Range(2.5, 12.0)] = 4.0) -> tuple[Mass, ...]:
    """Build greenhouses.

    Glass walls and a row of small glass gables between gutters, held by a thin white frame.

    Cut the plan into bays along its longer side, each under a gable of glass.

    Parameters
    ----------
    bay
        Metres of width of a gable.
    """
    lot = lot_of(plot, lengthwise=True)
    wanted = plot.between("bay", 0.75 * bay, 1.25 * bay)
    count = min(max(1, round(lot.depth / max(wanted, 1.0))), MOST)
    width = lot.depth / count
    high = width > WIDE
    rise = HIGH_RISE if high else RISE
    eave = max((plot.height - plot.rise) * plot.between("eave", 0.86, 1.0), LOWEST)
    boxes = [(-lot.x, -lot.y + k * width, lot.x, -lot.y + (k + 1) * width) for k in range(count)]
    made = lot.masses(boxes, low=0.0, high=eave + rise, zone="wide" if high else "", roof="gabled",
                      rise=rise, direction=lot.along())  # fmt: skip
    return tuple(made)


GENERATOR = generator(masses)
greenhouse = action_of("building/greenhouse-v1", GENERATOR, masses)
