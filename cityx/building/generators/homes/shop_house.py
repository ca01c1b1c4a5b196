"""Shop houses: narrow gabled town houses, a shop with awning and sign below, flats above."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Annotated

import shapely

from cityx.building.generators import action_of, generator
from cityx.building.massing.massing import Mass, Plot, Site, carve, site_of
from cityx.building.massing.rules import chamfered
from cityx.protocol import Choice, Range

GABLES = ("stepped", "bell", "neck", "cornice")
WIDEST = 8.5  # metres of one house; a wider front is a row of them
CORNER = 3.4  # metres of a corner shop's entrance
SHEARED = 0.022  # share of the plan that the cut of its corner may take
STEEPEST = 1.5  # rise over run of the steepest gable


def masses(
    plot: Plot,
    *,
    gable: Annotated[str, Choice("any", *GABLES)] = "any",
    house: Annotated[float, Range(4.5, 9.0)] = 6.5,
    corner: Annotated[float, Range(0.0, 1.0)] = 0.25,
) -> tuple[Mass, ...]:
    """Build narrow shop houses under stepped, bell and neck gables.

    A shop with a painted board, an awning and a hanging sign on the ground floor, flats above with
    small-paned windows, loft doors and a hoist in the gable; some have an entrance across the
    corner under a turret. Wide fronts become rows.

    Divide a front into narrow houses, a gable of its own to the street for each.

    Parameters
    ----------
    gable
        What ends the front.
    house
        Metres of front of one house in a row.
    corner
        Share of buildings with an entrance across a corner.
    """
    site = site_of(plot)
    x, y = site.half
    zone = plot.pick("gable 0", GABLES, (3, 3, 2, 2)) if gable == "any" else gable
    eave = plot.height - plot.rise
    if min(x, y) < 1.8 or plot.plan.area < 2.8 * x * y or plot.said:
        return (replace(plot.body, zone="cornice"),)
    wide = plot.waver("house", house, plot.body)
    count = max(1, round(2 * x / wide)) if 2 * x > WIDEST else 1
    edges = _edges(plot, x, count)
    rest, found = site.plan, list[Mass]()
    angled = plot.draw("corner") < corner
    hand = 0 if plot.draw("hand") < 0.5 else count - 1
    for number in range(count):
        x0 = -2 * x if number == 0 else edges[number]
        x1 = 2 * x if number == count - 1 else edges[number + 1]
        plan, rest = carve(rest, shapely.box(x0, -2 * y, x1, 2 * y))
        word = zone if number == 0 or gable != "any" else plot.pick(
            f"gable {number}", GABLES, (3, 3, 2, 2))  # fmt: skip
        drop = 0 if count == 1 or not plot.noise else round(1.4 * plot.draw("drop", number))
        top = eave - min(drop, plot.levels - 2) * plot.storey if plot.levels > 2 else eave
        if angled and number == hand:
            side = 1.0 if number == count - 1 and count > 1 else plot.draw("side") * 2 - 1
            found += _cornered(site, plot, plan, top, 1.0 if side > 0 and hand else -1.0)
        else:
            found += _house(site, plot, plan, top, word)
    found += site.masses(rest, 0.0, plot.storey, "cornice")
    return tuple(found)


def _edges(plot: Plot, half: float, count: int) -> list[float]:
    """Return where houses meet, unequal by noise."""
    swing = 0.5 * min(1.0, 2 * plot.noise)
    shares = [1.0 + swing * (plot.draw("wide", number) - 0.5) for number in range(count)]
    edges, run = [], -half
    for share in shares:
        edges.append(run)
        run += 2 * half * share / sum(shares)
    return [*edges, run]


def _house(site: Site, plot: Plot, plan: object, eave: float, zone: str) -> list[Mass]:
    """Raise one house: its ridge runs back from the street behind the gable."""
    x0, y0, x1, y1 = shapely.bounds(plan).tolist()
    if zone == "cornice" or y1 - y0 < x1 - x0:
        rise = min(max(plot.rise, 2.4), 3.6)
        return site.masses(plan, 0.0, eave + rise, "cornice", "mansard", rise)
    slope = plot.between("slope", 1.05, STEEPEST)
    rise = min(slope * (x1 - x0) / 2, 0.75 * eave)
    return site.masses(plan, 0.0, eave + rise, zone, "gabled", rise, down=(1.0, 0.0))


def _cornered(site: Site, plot: Plot, plan: object, eave: float, hand: float) -> list[Mass]:
    """Cut the corner of a house off for the entrance of its shop, under a turret."""
    x0, y0, x1, y1 = shapely.bounds(plan).tolist()
    x = x1 if hand > 0 else x0
    side = min(CORNER, 0.6 * (x1 - x0), 0.5 * (y1 - y0))
    box = shapely.box(min(x, x - hand * side), y1 - side, max(x, x - hand * side), y1)
    piece, rest = carve(plan, box)
    leg = min(0.7 * side, math.sqrt(2 * SHEARED * plot.plan.area))
    if side < 2.4 or leg < 1.35 or piece.area < 0.97 * box.area:
        return _house(site, plot, plan, eave, "bell")
    turret = chamfered(piece, (x, y1), leg)
    rise = min(max(plot.rise, 2.6), 3.6)
    cap = 1.15 * side
    return [
        *site.masses(rest, 0.0, eave + rise, "cornice", "mansard", rise),
        *site.masses(turret, 0.0, eave + cap, "corner", "pyramidal", cap),
    ]


GENERATOR = generator(masses)
shop_house = action_of("building/shop_house-v1", GENERATOR, masses)
