"""Churches: nave, aisles, transept, choir and apse under steep roofs, and a tower in the west."""

from __future__ import annotations

import math
from typing import Annotated, Any

import numpy as np
import shapely

from cityx.building.generators import action_of, generator
from cityx.building.massing.massing import Mass, Plot, Site, carve, disc, remainder, site_of
from cityx.protocol import Choice, Range

CHAPEL = 8.5  # metres of width below which a church has neither aisles nor transept
AISLED = 13.0  # metres of width from which it has aisles
CATHEDRAL = 21.0  # metres of width from which it has two towers and a crossing
FULL = 0.93  # share of a tower's square that the plan must fill
NAVE_FILL = 0.6  # share of the nave's strip that the plan must fill; less is no hall
STATIONS = 25  # places along the plan where its width is measured
TOPS = ("spire", "pyramid", "onion", "flat")


def masses(
    plot: Plot,
    *,
    tower: Annotated[float, Range(0.0, 3.0)] = 1.0,
    top: Annotated[str, Choice("any", *TOPS)] = "any",
    aisles: bool = True,
) -> tuple[Mass, ...]:
    """Build churches: a nave with aisles, apse and tower.

    Chapels have a nave and a bell turret; from 13 metres of width there are aisles under lean-to
    roofs, from 21 a transept, a crossing and two towers in the west.

    Build nave, aisles, transept, choir, apse and towers, as the size admits.

    Parameters
    ----------
    tower
        Height of the tower relative to the usual one; 0 leaves it out.
    top
        What crowns the tower.
    aisles
        Whether wide churches have aisles.
    """
    site = site_of(plot, facing=False)
    found = _widths(site.plan)
    if found is None:
        return (plot.body,)
    site, width, middle = _faced(site, *found)
    half = site.half[0]
    if width < 3.2 or half < 3.0:
        return (plot.body,)
    aisled = aisles and width >= AISLED
    nave = min(0.54 * width if aisled else width, 16.0 if aisled else 19.0)
    strip = shapely.box(-2 * half, middle - nave / 2, 2 * half, middle + nave / 2)
    if shapely.intersection(site.plan, strip).area < NAVE_FILL * 2 * half * nave:
        return (plot.body,)
    pitch = math.radians(plot.between("pitch", 44.0, 58.0))
    eave = min(max(1.25 * nave, 7.0), 24.0) if aisled else min(max(0.62 * nave + 2.4, 4.2), 12.0)
    rise = 0.5 * nave * math.tan(pitch)
    ridge = eave + rise
    known = plot.height if plot.height < 1.5 * ridge else ridge
    scale = min(max(known / ridge, 0.7), 1.3)
    eave, rise, ridge = eave * scale, rise * scale, ridge * scale
    side = min(max(0.46 * width, 3.4), 10.0)
    grown: list[Mass] = []
    rest, west = site.plan, -half
    twin = tower > 0 and width >= CATHEDRAL
    names = ["any"] if top not in TOPS else [top]
    word = names[0] if names != ["any"] else plot.pick("tower top", TOPS, (5, 4, 2, 1.2))
    total = ridge * plot.between("tower", 1.12, 1.5) * tower
    if plot.height > 1.5 * ridge:
        total = max(0.62 * plot.height, 1.05 * ridge) * min(tower, 1.0)
    squares = _towers(site, width, middle, side, twin=twin) if tower > 0 else []
    for square in squares:
        inside, rest = carve(rest, square)
        grown += _tower(site, inside, square, total, word, ridge)
    screen = twin or not squares
    if squares and not twin:
        west += side
    crossing = west + 0.64 * (half - west) if width >= CATHEDRAL and half > 18.0 else math.nan
    if not math.isnan(crossing):
        arm = shapely.box(crossing - nave / 2, -999, crossing + nave / 2, 999)
        bar, rest = carve(rest, arm)
        core, arms = carve(bar, strip)
        grown += site.masses(core, 0.0, ridge, "bare", "crosspitched", rise, down=(0.0, 1.0))
        for number in (-1.0, 1.0):
            beyond = shapely.box(-999, min(0, 999 * number), 999, max(0, 999 * number))
            wing = shapely.intersection(arms, beyond)
            edge = wing.bounds[3] if number > 0 else wing.bounds[1]
            end, wing = carve(wing, shapely.box(-999, edge - 1.0, 999, edge + 1.0))
            grown += site.masses(wing, 0.0, ridge, "arm", "gabled", rise, down=(1.0, 0.0))
            grown += site.masses(end, 0.0, ridge + 0.5, "front", "gabled", rise, down=(1.0, 0.0))
        if tower > 0:
            at = core.centroid
            base = disc(at.x, at.y, 1.5, 8)
            grown += site.masses(base, ridge, ridge + 4.0, "turret")
            grown += site.masses(disc(at.x, at.y, 1.3, 8), ridge + 4.0, ridge + 14.0, "spire",
                                 "pyramidal", 9.7)  # fmt: skip
    if screen and half > 7.0:
        front, rest = carve(rest, strip & shapely.box(-2 * half, -999, -half + 1.0, 999))
        grown += site.masses(front, 0.0, ridge + 0.7, "front", "gabled", rise, down=(0.0, 1.0))
    body, rest = carve(rest, strip)
    grown += _body(site, body, half, nave, middle, eave, rise, "bare" if aisled else "")
    low = (0.46 if aisled else 0.5) * eave
    if aisled:
        lean = min(0.55 * (width - nave) / 2, eave - low - 2.6)
        for number in (-1.0, 1.0):
            beyond = shapely.box(-999, min(middle, 999 * number), 999, max(middle, 999 * number))
            aisle, rest = carve(rest, strip_of(beyond, middle, nave, width, number))
            grown += site.masses(aisle, 0.0, low + max(lean, 0.3), "", "skillion", max(lean, 0.3),
                                 down=(0.0, number))  # fmt: skip
    grown += remainder(site, grown, max(low, 3.2), "annex")
    if not squares and tower > 0 and half > 4.5:
        x = -half + 2.2
        grown += site.masses(shapely.box(x - 0.9, middle - 0.9, x + 0.9, middle + 0.9),
                             ridge + 0.05, ridge + 2.6, "turret")  # fmt: skip
        grown += site.masses(shapely.box(x - 0.8, middle - 0.8, x + 0.8, middle + 0.8),
                             ridge + 2.6, ridge + 5.8, "spire", "pyramidal", 3.0)  # fmt: skip
    return tuple(grown)


def strip_of(beyond: Any, middle: float, nave: float, width: float, number: float) -> Any:
    """Return what lies beside the nave on one side, to the outer wall of the aisle."""
    edge = sorted((middle + number * (nave / 2 - 0.3), middle + number * (width / 2 + 0.6)))
    return beyond & shapely.box(-999, edge[0], 999, edge[1])


def _widths(plan: Any) -> tuple[float, float] | None:
    """Return the usual width of a plan across its length and the middle of that width."""
    x0, y0, x1, y1 = plan.bounds
    at = x0 + (x1 - x0) * (np.arange(STATIONS) + 0.5) / STATIONS
    lines = shapely.linestrings([[(x, y0 - 1), (x, y1 + 1)] for x in at.tolist()])
    cut = shapely.intersection(plan, lines)
    length = shapely.length(cut)
    good = length > 0.5
    if not good.any():
        return None
    width = float(np.median(length[good]))
    usual = np.flatnonzero(np.abs(length - width) < 0.12 * width + 0.3)
    middle = float(np.median(shapely.get_y(shapely.centroid(cut[usual])))) if len(usual) else 0.0
    return width, middle


def _faced(site: Site, width: float, middle: float) -> tuple[Site, float, float]:
    """Turn a site so that the tower's end, the western one where both will do, has the least x."""
    half, side = site.half[0], 0.4 * width
    fill = []
    for x in (-half, half - side):
        square = shapely.box(x, middle - side / 2, x + side, middle + side / 2)
        end = shapely.box(x, -999, x + side, 999)
        own = shapely.intersection(site.plan, square).area / square.area
        taper = shapely.intersection(site.plan, end).area / (side * width)
        fill.append(round(own, 1) * 2 + min(round(taper, 1), 1.0) * (own > FULL))
    western = bool(site.axes.along[0] < -1e-6)
    wanted = western if fill[0] == fill[1] else fill[1] > fill[0]
    return (site.turned(), width, middle) if wanted else (site, width, middle)


def _towers(site: Site, width: float, middle: float, side: float, *, twin: bool) -> list[Any]:
    """Squares for towers at the western end, those that the plan fills."""
    half = site.half[0]
    if half < 1.1 * side:
        return []
    if twin:
        side = min(0.36 * width, 11.0)
        ys = [middle - width / 2, middle + width / 2 - side]
    else:
        ys = [middle - side / 2]
    found = [shapely.box(-half, y, -half + side, y + side) for y in ys]
    full = [s for s in found if shapely.intersection(site.plan, s).area > FULL * s.area]
    return full if len(full) == len(found) else []


def _tower(
    site: Site, inside: Any, square: Any, total: float, top: str, ridge: float
) -> list[Mass]:
    """Raise a shaft, a bell chamber drawn in a little, and what crowns it."""
    side = square.bounds[2] - square.bounds[0]
    middle = square.centroid
    bells = min(max(0.9 * side, 3.6), 0.3 * total)
    shaft = max(total - bells, 1.02 * ridge if total > 1.2 * ridge else total - bells)
    grown = site.masses(inside, 0.0, shaft, "tower")
    chamber = square.buffer(-0.28, join_style="mitre")
    if top == "flat":
        grown += site.masses(chamber, shaft, shaft + bells, "belfry")
        x0, y0, x1, y1 = chamber.bounds
        for x in (x0, x1 - 0.9):
            for y in (y0, y1 - 0.9):
                foot = shapely.box(x, y, x + 0.9, y + 0.9)
                grown += site.masses(foot, shaft + bells, shaft + bells + 3.4, "pinnacle",
                                     "pyramidal", 2.4)  # fmt: skip
        return grown
    if top == "onion":
        drum = disc(middle.x, middle.y, 0.36 * side, 8)
        tall = 1.25 * side
        return [
            *grown,
            *site.masses(chamber, shaft, shaft + bells, "belfry"),
            *site.masses(drum, shaft + bells, shaft + bells + 0.9 + tall, "spire", "onion", tall),
        ]
    if top == "pyramid":
        tall = 0.75 * side
        return [
            *grown,
            *site.masses(chamber, shaft, shaft + bells + tall, "belfry", "pyramidal", tall),
        ]
    tall = 2.5 * side
    foot = disc(middle.x, middle.y, 0.46 * side, 8)
    return [
        *grown,
        *site.masses(chamber, shaft, shaft + bells, "belfry"),
        *site.masses(foot, shaft + bells, shaft + bells + tall, "spire", "pyramidal", tall - 0.35),
    ]


def _body(site: Site, body: Any, half: float, nave: float, middle: float, eave: float, rise: float,
          zone: str) -> list[Mass]:  # fmt: skip
    """Nave with a gabled roof, and in the east an apse of half an octagon, a little lower."""
    reach = 0.5 * nave
    east = shapely.intersection(body, shapely.box(half - 0.35, -999, 2 * half, 999))
    tapered = east.area < 0.35 * 0.7 * nave
    if nave < CHAPEL * 0.6 or half < 6.0:
        return site.masses(body, 0.0, eave + rise, zone, "gabled", rise, down=(0.0, 1.0))
    centre = half - reach
    end = disc(centre, middle, reach - 0.05, 8) & shapely.box(centre, -999, 999, 999)
    if tapered:
        end = shapely.box(centre, -999, 999, 999)
    apse, rest = carve(body, end)
    corners: list[Mass] = []
    if not tapered:
        outer, rest = carve(rest, shapely.box(centre, -999, 999, 999))
        corners = site.masses(outer, 0.0, 0.45 * eave, "annex")
    choir = 0.86 * eave
    up = 0.55 * rise
    return [
        *site.masses(rest, 0.0, eave + rise, zone, "gabled", rise, down=(0.0, 1.0)),
        *site.masses(apse, 0.0, choir + up, "apse", "pyramidal", up),
        *corners,
    ]


GENERATOR = generator(masses)
church = action_of("building/church-v1", GENERATOR, masses)
