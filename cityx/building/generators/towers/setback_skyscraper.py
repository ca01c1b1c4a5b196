"""Setback skyscrapers: masonry towers stepped back by the zoning of 1916."""

from __future__ import annotations

from typing import Annotated

from cityx.building.generators import action_of, generator
from cityx.building.massing.massing import Mass, Plot, grow
from cityx.building.massing.rules import crowned, light_court, notched, otherwise, setback
from cityx.protocol import Choice, Range

CROWNS = ("pyramidal", "flat", "mansard", "steps")


def masses(
    plot: Plot,
    *,
    inset: Annotated[float, Range(1.5, 12.0)] = 4.5,
    depth: Annotated[int, Range(0, 8)] = 7,
    crown: Annotated[str, Choice("any", *CROWNS)] = "any",
) -> tuple[Mass, ...]:
    """Build masonry skyscrapers that step back as they rise.

    A base to the street line, tiers drawn in above it, piers that run up the shaft, and a crown.

    Step a tower back, three times at most, and set a crown on it.

    Parameters
    ----------
    inset
        Metres of the first step; the next are smaller.
    depth
        How often a volume is divided; 0 is a plain block.
    crown
        What ends the tower: a roof, or steps.
    """
    crown = plot.pick("crown roof", CROWNS, (3, 1, 2, 4)) if crown == "any" else crown
    roof = "flat" if crown == "steps" else crown
    steps = 0.8 * inset, 0.7 * inset
    tall = plot.between("crown", 6.0, 14.0)
    rules = {
        "lot": setback(inset, 0.34, then="tier", zone="tower"),
        "tier": otherwise(setback(steps[0], 0.42, then="shaft", zone="tower"), "shaft"),
        "shaft": otherwise(
            setback(steps[1], 0.55, then="corners", zone="tower", least=12.0), "corners"
        ),
        "corners": otherwise(notched(2.4, then="top"), "top"),
        "top": crowned(2.2, tall, roof=roof),
    }
    if crown == "steps":
        rules["top"] = crowned(1.8, 1.6 * tall, then="ziggurat")
        rules["ziggurat"] = crowned(1.6, tall, then="lantern")
        rules["lantern"] = crowned(1.4, 0.5 * tall)
    if plot.levels < 16:
        rules["lot"] = light_court(14.0, above=3 * plot.storey, then="tier", foot="")
    return grow(plot, rules, depth=depth)


GENERATOR = generator(masses)
setback_skyscraper = action_of("building/setback_skyscraper-v1", GENERATOR, masses)
