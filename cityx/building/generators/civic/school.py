"""Schools: long wings of class rooms about an entrance with a clock, and a gymnasium."""

from __future__ import annotations

from typing import Annotated, Any

import shapely

from cityx.building.generators import action_of, generator
from cityx.building.massing.massing import Mass, Plot, Site, carve, remainder, site_of
from cityx.protocol import Range

LEAST_AREA = 330.0  # square metres from which there is more than one block
DEEP = 24.0  # metres of depth from which wings run back from the front
WING = 11.5  # metres, of class rooms on one side of a corridor


def masses(
    plot: Plot,
    *,
    wings: Annotated[int, Range(0, 5)] = 2,
    gym: Annotated[float, Range(0.0, 1.6)] = 1.0,
    tower: Annotated[float, Range(0.0, 3.0)] = 1.0,
) -> tuple[Mass, ...]:
    """Build schools: ribbon windows in long wings, a coloured entrance, a gymnasium.

    The entrance stands higher, with canopy, clock and flag; deep plots have wings that run back
    about low halls; the gymnasium is a hall of its own at one end.

    Cut the gymnasium, the entrance and the wings; what lies between them is low.

    Parameters
    ----------
    wings
        Wings that run back from the front, where the plot is deep enough.
    gym
        Height of the gymnasium relative to the usual one; 0 leaves it out.
    tower
        Storeys, about, by which the entrance stands above the wings.
    """
    site = site_of(plot)
    half, deep = site.half
    storey = min(max(plot.storey, 3.0), 4.4)
    levels = max(plot.levels, 1)
    high = max(plot.height - plot.rise, storey)
    shape, pitch = (
        plot.pick("roof", ("flat", "hipped", "skillion", "gabled"), (5, 2, 1.5, 1.5)),
        0.0,
    )
    if plot.said:
        shape = plot.roof
    if shape != "flat":
        pitch = {"hipped": 0.62, "gabled": 0.62}.get(shape, 0.16)
    if site.plan.area < LEAST_AREA or min(half, deep) < 5.0:
        rise = min(pitch * deep, 0.6 * high)
        return tuple(site.masses(site.plan, 0.0, high + rise, "", shape, rise))
    grown: list[Mass] = []
    rest: Any = site.plan
    side = 1.0 if plot.draw("gym side") < 0.5 else -1.0
    length = min(max(0.26 * 2 * half, 13.0), 27.0)
    if gym > 0 and 2 * half > 2.4 * length:
        depth = min(2 * deep, 1.5 * length)
        x0, x1 = sorted((side * half * 1.1, side * (half - length)))
        box = shapely.box(x0, -999, x1, -deep + depth)
        hall, rest = carve(rest, box)
        top = min(max(7.2, 0.42 * length), 10.0) * gym
        roof = plot.pick("gym roof", ("flat", "round", "gabled"), (3, 3, 2))
        up = {"flat": 0.0, "round": 0.14, "gabled": 0.12}[roof] * min(length, depth)
        grown += site.masses(hall, 0.0, top + up, "gym", roof, up)
    x0, _, x1, _ = rest.bounds
    front = min(2 * deep, 13.5)
    spot = plot.between("entrance", 0.34, 0.66)
    wide = min(max(0.13 * (x1 - x0), 7.0), 13.0)
    middle = x0 + spot * (x1 - x0)
    box = shapely.box(middle - wide / 2, deep - front, middle + wide / 2, 999)
    entrance, rest = carve(rest, box)
    if 2 * deep > DEEP and wings > 0:
        spine, back = carve(rest, shapely.box(-999, deep - front, 999, 999))
        grown += _wings(site, back, wings, high, storey, levels, shape, pitch)
        rest = spine
    rise = pitch * front / 2
    grown += site.masses(rest, 0.0, high + rise, "", shape, rise, down=_down(shape))
    top = high + storey * 0.9 * tower if tower > 0 else high
    grown += site.masses(entrance, 0.0, top, "entrance")
    return (*grown, *remainder(site, grown, storey + 0.6, "commons"))


def _down(shape: str) -> tuple[float, float] | None:
    return (0.0, -1.0) if shape == "skillion" else None


def _wings(site: Site, back: Any, wings: int, high: float, storey: float, levels: int, shape: str,
           pitch: float) -> list[Mass]:  # fmt: skip
    """Wings that run back from the front, and low halls between them."""
    x0, _, x1, _ = back.bounds
    count = min(wings, int((x1 - x0 + 7.0) / (WING + 7.0)))
    top = high if levels < 3 else high - storey
    grown: list[Mass] = []
    rest = back
    for number in range(count):
        share = number / max(count - 1, 1) if count > 1 else 0.0
        left = x0 + share * (x1 - x0 - WING)
        wing, rest = carve(rest, shapely.box(left, -999, left + WING, 999))
        rise = pitch * WING / 2 if shape != "skillion" else 0.1 * WING
        grown += site.masses(wing, 0.0, top + rise, "", shape, rise)
    return [*grown, *site.masses(rest, 0.0, storey + 0.6, "commons")]


GENERATOR = generator(masses)
school = action_of("building/school-v1", GENERATOR, masses)
