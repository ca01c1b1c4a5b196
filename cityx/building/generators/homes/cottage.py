"""Cottages: steep roofs on low walls, small leaded windows, timber gables, an outshut."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated

from cityx.building.generators import action_of, generator
from cityx.building.massing.lots import Lot, lot_of, masses_on, slope_of
from cityx.building.massing.massing import Mass, Plot
from cityx.protocol import Range

LEAST = 5.4  # metres of cottage; a narrower one has neither outshut nor wing
LOWEST = 1.95  # metres under the eave of an outshut
WINGED = 0.2  # share of its box that a plan must lack to have a ridge for each wing


def masses(
    plot: Plot,
    *,
    outshut: Annotated[float, Range(0.0, 1.0)] = 0.6,
    wing: Annotated[float, Range(0.0, 1.0)] = 0.4,
    timber: Annotated[float, Range(0.0, 1.0)] = 0.4,
) -> tuple[Mass, ...]:
    """Build cottages with steep roofs.

    Low walls of brick, stone or limewash, half timbering above, leaded windows, steep tiles or
    thatch, and an outshut that carries the roof down to a man's height.

    Lean an outshut against the back or a gable, or turn a wing to the street.

    Parameters
    ----------
    outshut, wing, timber
        Share of cottages with a low part under a lean-to roof, with a wing to the street, and with
        half timbering above the ground floor.
    """
    turn, winged, leaning, where, deep, framed = plot.draws("cottage", 6)
    zone, low = ("timber", "timber_low") if framed < timber else ("", "low")
    body = replace(plot.body, zone=zone)
    lot = lot_of(plot, lengthwise=True)
    if plot.rise <= 0 or not lot.boxy or lot.depth < LEAST:
        return (body,)
    side = 1.0 if turn < 0.5 else -1.0
    slope = slope_of(plot, lot)
    if winged < wing and lot.length > 8.5 and lot.depth > 6.5:
        return tuple(_winged(lot, plot, side, slope, zone, low)) or (body,)
    if leaning >= outshut:
        return (body,)
    eave = plot.height - plot.rise
    if where < 0.45 and lot.length > LEAST + 2.4:
        cut = 1.9 + 0.7 * deep
        rise = min(0.55 * cut, eave + 0.5 * plot.rise - LOWEST)
        rest = (-lot.x + cut, -lot.y, lot.x, lot.y)
        strip = (-lot.x, -lot.y, -lot.x + cut, lot.y)
        down = lot.compass(-side, 0.0)
        boxes = [rest, strip] if side > 0 else [(-b[2], b[1], -b[0], b[3]) for b in (rest, strip)]
    else:
        cut = min(1.6 + 0.6 * deep, 0.3 * lot.depth)
        rise = min(1.1 * cut, eave - 0.1 - LOWEST)
        boxes = [(-lot.x, -lot.y + cut, lot.x, lot.y), (-lot.x, -lot.y, lot.x, -lot.y + cut)]
        down = lot.compass(0.0, -1.0)
    if rise < 0.3:
        return (body,)
    high = LOWEST + rise
    width = min(boxes[0][2] - boxes[0][0], boxes[0][3] - boxes[0][1])
    up = min(slope * width / 2, plot.rise)
    main = lot.masses(boxes[:1], low=0.0, high=eave + up, zone=zone, roof=plot.roof, rise=up)
    lean = lot.masses(boxes[1:], low=0.0, high=high, zone=low, roof="skillion", rise=rise,
                      direction=down)  # fmt: skip
    return (*main, *lean)


def _winged(lot: Lot, plot: Plot, side: float, slope: float, zone: str, low: str) -> list[Mass]:
    """Build an L with a ridge for each wing; a low porch stands in its inner corner."""
    reach = 0.46 * lot.length
    cut = WINGED * lot.length * lot.depth / (lot.length - reach)
    eave = plot.height - plot.rise
    rise = min(0.5 * cut, eave - 0.1 - LOWEST)
    if rise < 0.2:
        return []
    back, step, front = -lot.y, lot.y - cut, lot.y
    knee = lot.x - reach
    ring = [(-lot.x, back), (lot.x, back), (lot.x, front), (knee, front), (knee, step),
            (-lot.x, step)]  # fmt: skip
    box = (-lot.x, step, knee, front)
    if side < 0:
        ring = [(-a, b) for a, b in ring[::-1]]
        box = (-knee, step, lot.x, front)
    roof = plot.roof if plot.said else "gabled"
    up = min(slope * min(reach, lot.depth - cut) / 2, plot.rise)
    made = masses_on(lot.outline(ring), low=0.0, high=eave + up, zone=zone, roof=roof, rise=up)
    return made + lot.masses([box], low=0.0, high=LOWEST + rise, zone=low, roof="skillion",
                             rise=rise, direction=lot.along())  # fmt: skip


GENERATOR = generator(masses)
cottage = action_of("building/cottage-v1", GENERATOR, masses)
