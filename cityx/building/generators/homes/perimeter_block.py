"""European perimeter blocks: rendered housing from 1870 to 1965, stuccoed, plain or stripped."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated

from cityx.building.generators import action_of, generator
from cityx.building.massing.massing import Mass, Plot, grow
from cityx.building.massing.rules import courtyard
from cityx.protocol import Choice, Range

FRONTS = ("stucco", "oriel", "gable", "balcony", "plain", "postwar")
SHARES = (5, 3, 2, 3, 3, 3)
STEEP = 7.5  # metres; the highest roof


def masses(
    plot: Plot,
    *,
    front: Annotated[str, Choice("any", *FRONTS)] = "any",
    wing: Annotated[float, Range(8.0, 30.0)] = 12.0,
    closed: bool = False,
) -> tuple[Mass, ...]:
    """Build European perimeter blocks: tenements with stucco, oriels, gables or balconies.

    The rendered housing of central Europe: stuccoed tenements of the 1880s and those whose stucco
    was struck off, bay windows and gables of about 1910, and plain blocks of the 1950s, under
    steep roofs, with wings around a court on deep plots.

    Lay wings around a court, open to the back, behind a front of one of `FRONTS`.

    Parameters
    ----------
    front
        What the front is like.
    wing
        Metres of depth beyond which a court opens behind the front.
    closed
        Whether the court has wings on all sides; else it opens to the back.
    """
    zone = plot.pick("front", FRONTS, SHARES) if front == "any" else front
    zone = "" if zone == "plain" or plot.levels < 3 else zone
    rise = plot.rise if plot.said else min(plot.rise, STEEP)
    body = replace(plot.body, zone=zone, high=plot.height - plot.rise + rise, rise=rise)
    if plot.plan.area < 330.0:
        return (body,)
    rules = {"lot": courtyard(wing, closed=closed)}
    return grow(plot, rules, depth=1, axiom=body)


GENERATOR = generator(masses)
perimeter_block = action_of("building/perimeter_block-v1", GENERATOR, masses)
