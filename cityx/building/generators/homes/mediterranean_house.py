"""Mediterranean town houses: shutters, low tiled roofs, loggias, terraces and roof towers."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Annotated

import shapely

from cityx.building.generators import action_of, generator
from cityx.building.massing.massing import Mass, Plot, Site, carve, site_of
from cityx.protocol import Choice, Range

FORMS = ("plain", "loggia", "terrace", "altana")
CAP = 0.95  # metres of the low roof of a roof tower
DIVIDED = 0.55  # share of houses that are more than a box


def masses(
    plot: Plot,
    *,
    form: Annotated[str, Choice("any", *FORMS)] = "any",
    terrace: Annotated[float, Range(0.2, 0.6)] = 0.38,
) -> tuple[Mass, ...]:
    """Build Mediterranean town houses.

    Lime-washed walls in warm colours, shutters open and closed, washing and awnings at the windows,
    low roofs of clay tiles, and a loggia, a roof terrace or an open tower above the roofs.

    Leave an end of the house flat for a terrace, or raise a tower with arches above it.

    Parameters
    ----------
    form
        A plain house, one with arches in its top floor, with a terrace, or with a roof tower.
    terrace
        Share of the length that a terrace takes.
    """
    site = site_of(plot)
    x, y = site.half
    body = plot.body
    word = form
    if word == "any":
        divided = plot.draw("divided") < DIVIDED
        word = plot.pick("form", FORMS[1:], (3, 3, 3)) if divided else "plain"
    if word == "loggia":
        return (replace(body, zone="loggia" if plot.levels > 1 else ""),)
    boxy = plot.plan.area > 2.8 * x * y
    if word == "plain" or not boxy or min(x, y) < 2.6 or plot.levels < 2 or not plot.rise:
        return (body,)
    grown = _terraced(site, plot, terrace) if word == "terrace" else _towered(site, plot)
    return tuple(grown)


def _terraced(site: Site, plot: Plot, share: float) -> Sequence[Mass]:
    """Roof one end with tiles, and lay a terrace over the top floor of the other."""
    x, y = site.half
    eave = plot.height - plot.rise
    hand = 1.0 if plot.draw("hand") < 0.5 else -1.0
    long = 2 * x >= min(8.0, 2 * y)
    wide = plot.between("terrace", 0.8 * share, 1.2 * share) * 2 * (x if long else y)
    if wide < 3.0:
        return [plot.body]
    if long:
        x0, x1 = sorted((hand * (x - wide), hand * 2 * x))
        tool = shapely.box(x0, -2 * y, x1, 2 * y)
    else:
        tool = shapely.box(-2 * x, -2 * y, 2 * x, wide - y)
    flat, rest = carve(site.plan, tool)
    level = eave - plot.storey if plot.levels > 2 and plot.draw("drop") < 0.5 else eave
    tiled = site.masses(rest, 0.0, plot.height, "", plot.roof, plot.rise)
    return [*tiled, *site.masses(flat, 0.0, level, "terrace")]


def _towered(site: Site, plot: Plot) -> Sequence[Mass]:
    """Raise an open room over a corner of the front, above the roof."""
    x, y = site.half
    eave = plot.height - plot.rise
    hand = 1.0 if plot.draw("hand") < 0.5 else -1.0
    side = min(plot.between("altana", 3.4, 4.8), 0.9 * x, 0.9 * y)
    if side < 2.4:
        return [plot.body]
    x0, x1 = sorted((hand * x, hand * (x - side)))
    shaft, rest = carve(site.plan, shapely.box(x0, y - side, x1, y))
    found = site.masses(rest, 0.0, plot.height, "", plot.roof, plot.rise)
    found += site.masses(shaft, 0.0, eave, "")
    room = shapely.buffer(shaft, -0.1, join_style="mitre")
    return [*found, *site.masses(room, eave, eave + 2.9 + CAP, "altana", "hipped", CAP)]


GENERATOR = generator(masses)
mediterranean_house = action_of("building/mediterranean_house-v1", GENERATOR, masses)
