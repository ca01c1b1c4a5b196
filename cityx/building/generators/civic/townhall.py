"""Town halls: a symmetric front with an arcade, a clock tower under a spire or a dome, gables."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Annotated, Any

import shapely

from cityx.building.generators import action_of, generator
from cityx.building.massing.massing import Mass, Plot, Site, carve, disc, grow, site_of
from cityx.building.massing.rules import courtyard
from cityx.protocol import Choice, Range

TOPS = ("spire", "dome", "battlement", "helm")
LEAST = 13.0  # metres of front, and 9 of depth, under which there is no room for a tower
INSET = 0.2  # metres that each stage of the tower stands back
PORCH = 1.2  # storeys of its lowest stage, with the great door
STEEP = 8.5  # metres; the highest roof of the body
WING = 15.0  # metres of depth beyond which a court opens behind the front


def masses(
    plot: Plot,
    *,
    tower: Annotated[float, Range(0.0, 4.0)] = 2.1,
    top: Annotated[str, Choice("any", *TOPS)] = "any",
    pavilions: bool = True,
) -> tuple[Mass, ...]:
    """Build town halls with a clock tower in the middle of a symmetric front.

    An arcade along the ground floor, tall windows with stone crosses, a balustrade, pavilions with
    ornate gables, flags, and a tower with clocks under a spire, a dome, a helm or battlements.

    Set a tower into the middle of the front, and pavilions at its ends.

    Parameters
    ----------
    tower
        Height of the tower relative to the walls of the body; 0 leaves it out.
    top
        What crowns the tower.
    pavilions
        Whether the ends of long fronts have roofs of their own.
    """
    site = site_of(plot)
    x, y = site.half
    rise = plot.rise if plot.said else min(plot.rise, STEEP)
    eave = plot.height - plot.rise
    body = replace(plot.body, high=eave + rise, rise=rise)
    if 2 * x < LEAST or 2 * y < 9.0 or plot.plan.area < 2.2 * x * y:
        return (body,)
    rest: Any = site.plan
    found: list[Mass] = []
    side = min(max(plot.between("tower side", 0.15, 0.2) * 2 * x, 4.8), 9.5, 0.6 * 2 * y)
    if tower > 0:
        square = shapely.box(-side / 2, y - side, side / 2, y)
        inside, left = carve(rest, square)
        if inside.area > 0.97 * square.area:
            rest = left
            word = plot.pick("tower top", TOPS, (4, 3, 2, 3)) if top == "any" else top
            found += _tower(site, plot, inside, side, eave, rise, tower, word)
    wide = min(max(0.15 * 2 * x, 5.6), 10.0)
    if pavilions and 2 * x > side + 2 * wide + 8.0:
        for x0, x1 in ((-2 * x, wide - x), (x - wide, 2 * x)):
            end, rest = carve(rest, shapely.box(x0, -2 * y, x1, 2 * y))
            roof = "flat" if body.roof == "flat" else "mansard"
            up = 1.12 * rise
            found += site.masses(end, 0.0, eave + up, "pavilion", roof, up)
    for mass in site.masses(rest, 0.0, body.high, "", body.roof, body.rise):
        if mass.plan.area > 600.0:
            found += grow(plot, {"lot": courtyard(WING)}, depth=1, axiom=mass)
        else:
            found.append(mass)
    return tuple(found)


def _tower(
    site: Site, plot: Plot, inside: Any, side: float, eave: float, rise: float, tall: float,
    top: str,
) -> Sequence[Mass]:  # fmt: skip
    """Raise a tower in stages: entrance, shaft, clock, and what crowns it."""
    middle = inside.centroid
    total = max(plot.waver("tower", tall, plot.body) * eave, eave + rise + 1.6 * side)
    clock = max(0.95 * side, 4.2)
    shaft = max(total - clock, eave + rise + 1.0)
    porch = min(PORCH * plot.storey, 0.5 * eave)
    stages = [shapely.buffer(inside, -number * INSET, join_style="mitre") for number in range(4)]
    found = site.masses(stages[0], 0.0, porch, "porch")
    found += site.masses(stages[1], porch, eave, "entrance")
    found += site.masses(stages[2], eave, shaft, "shaft")
    upper = stages[3]
    if top == "battlement":
        found += site.masses(upper, shaft, shaft + clock, "belfry")
        turret = disc(middle.x, middle.y, 0.26 * side, 8)
        at = shaft + clock
        return [*found, *site.masses(turret, at, at + 1.3 * side, "lantern", "pyramidal",
                                     0.8 * side)]  # fmt: skip
    if top == "helm":
        high = 1.25 * side
        found += site.masses(upper, shaft, shaft + clock + high, "clock", "pyramidal", high)
        return found
    found += site.masses(upper, shaft, shaft + clock, "clock")
    at = shaft + clock
    if top == "dome":
        drum = disc(middle.x, middle.y, 0.4 * side, 12)
        swell = 0.42 * side
        lantern = disc(middle.x, middle.y, 0.13 * side, 8)
        low = at + 0.28 * side + swell
        return [
            *found,
            *site.masses(drum, at, low, "lantern", "dome", swell),
            *site.masses(lantern, low, low + 0.6 * side, "tip", "onion", 0.34 * side),
        ]
    octagon = disc(middle.x, middle.y, 0.37 * side, 8)
    foot = at + 0.5 * side
    spire = 1.7 * side
    return [*found, *site.masses(octagon, at, foot + spire, "lantern", "pyramidal", spire)]


GENERATOR = generator(masses)
townhall = action_of("building/townhall-v1", GENERATOR, masses)
