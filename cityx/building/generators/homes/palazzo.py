"""Classical palazzos: rendered or ashlar town palaces of the nineteenth century."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Annotated

import shapely

from cityx.building.generators import action_of, generator
from cityx.building.massing.massing import COURT, Mass, Plot, Site, carve, grow, site_of
from cityx.building.massing.rules import chamfered, courtyard
from cityx.protocol import Choice, Range

PAVILIONS = ("none", "ends", "centre", "corner")
LEAST = 7.0  # metres of depth and front under which a palace is one plain body
BODY = 0.8  # height of the main roof as a share of that of the pavilions
ROTUNDA = (5.0, 6.6)  # metres of front of a corner with a dome
SHEARED = 0.02  # share of the plan that the cut of a corner may take


def masses(
    plot: Plot,
    *,
    pavilions: Annotated[str, Choice("any", *PAVILIONS)] = "any",
    attic: Annotated[float, Range(1.0, 9.0)] = 6.0,
    wing: Annotated[float, Range(8.0, 30.0)] = 13.0,
) -> tuple[Mass, ...]:
    """Build classical town palaces.

    Ashlar or rendered fronts of the nineteenth century: a rusticated ground floor or shops, tall
    windows, balconies of iron along the second and the last floor, a mansard, and pavilions or a
    domed corner.

    Lay wings around a court and set pavilions with roofs of their own into the front.

    Parameters
    ----------
    pavilions
        Where parts of the front have roofs of their own.
    attic
        Metres of the highest roofs, at most.
    wing
        Metres of depth beyond which a court opens behind the front.
    """
    site = site_of(plot)
    x, y = site.half
    rise = min(plot.rise, attic) if not plot.said else plot.rise
    body = replace(plot.body, high=plot.height - plot.rise + BODY * rise, rise=BODY * rise)
    if min(2 * x, 2 * y) < LEAST or plot.levels < 3 or plot.plan.area < 2.4 * x * y:
        return (body,)
    form = pavilions
    if form == "any":
        wide = 2 * x > 19.0
        form = plot.pick("pavilions", PAVILIONS, (2, 3, 3, 3) if wide else (4, 0, 0.01, 3))
    full = plot.height - plot.rise + rise
    if form == "corner":
        found = _cornered(site, plot, body, full, rise)
    elif form in ("ends", "centre"):
        found = _sliced(site, plot, body, full, rise, form, wing)
    else:
        found = [body]
    rules = {"body": courtyard(wing, then="")}
    grown: list[Mass] = []
    for mass in found:
        inner = mass.zone == "" and mass.plan.area > 300.0
        grown += grow(plot, rules, start="body", depth=1, axiom=mass) if inner else [mass]
    return tuple(grown)


def _sliced(
    site: Site, plot: Plot, body: Mass, full: float, rise: float, form: str, wing: float
) -> Sequence[Mass]:
    """Cut slices off the front, as deep as a wing: two at its ends, or one in its middle."""
    x, y = site.half
    wide = plot.between("pavilion", 0.17, 0.24) * 2 * x
    wide = min(max(wide, 4.6), 9.0)
    spans = [(-x, wide - x), (x - wide, x)] if form == "ends" else [(-wide / 2, wide / 2)]
    if 2 * x - len(spans) * wide < 5.0:
        return [body]
    rest, found = site.plan, list[Mass]()
    foot = y - 0.9 * wing if 2 * y > 2 * wing + COURT else -2 * y
    roof = "flat" if body.roof == "flat" else "mansard"
    for x0, x1 in spans:
        inside, rest = carve(rest, shapely.box(x0, foot, x1, 2 * y))
        high = full if roof != "flat" else body.high
        found += site.masses(inside, 0.0, high, "pavilion", roof, rise if roof != "flat" else 0.0)
    return [*site.masses(rest, 0.0, body.high, "", body.roof, body.rise), *found]


def _cornered(site: Site, plot: Plot, body: Mass, full: float, rise: float) -> Sequence[Mass]:
    """Cut a corner off and set a dome on it."""
    x, y = site.half
    side = min(plot.between("rotunda", *ROTUNDA), 0.45 * 2 * x, 0.6 * 2 * y)
    hand = 1.0 if plot.draw("hand") < 0.5 else -1.0
    x0, x1 = sorted((hand * x, hand * (x - side)))
    square = shapely.box(x0, y - side, x1, y)
    inside, rest = carve(site.plan, square)
    if side < 3.6 or inside.area < 0.97 * square.area:
        return [body]
    leg = min(0.42 * side, (2 * SHEARED * plot.plan.area) ** 0.5)
    cut = chamfered(inside, (hand * x, y), leg) if leg > 1.0 else inside
    roof = plot.pick("rotunda roof", ("dome", "pyramidal"), (4, 1)) if rise else "flat"
    dome = site.masses(cut, 0.0, full, "corner", roof, rise)
    return [*site.masses(rest, 0.0, body.high, "", body.roof, body.rise), *dome]


GENERATOR = generator(masses)
palazzo = action_of("building/palazzo-v1", GENERATOR, masses)
