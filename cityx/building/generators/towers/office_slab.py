"""Office slabs: ribbon windows behind sun blades, blind cores of stairs, plant on the roof."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Annotated

from cityx.building.generators import action_of, generator
from cityx.building.massing.massing import Mass, Plot, pieces
from cityx.building.massing.rules import banded
from cityx.protocol import Choice, Range

CORES = ("end", "middle", "ends", "none")
SUNS = ("", "fins", "blades", "crates")
LEAST = 11.0  # metres of width under which a building is a plain bar
DEEP = 27.0  # metres of width from which a slab is two bars with a link


def masses(
    plot: Plot,
    *,
    core: Annotated[str, Choice("any", *CORES)] = "any",
    bar: Annotated[float, Range(9.0, 30.0)] = 16.0,
    recess: Annotated[float, Range(0.4, 4.0)] = 1.2,
) -> tuple[Mass, ...]:
    """Build slabs of offices with bands of windows behind fins, blades or crates.

    A bar over a dark lobby, blind cores of stairs that stand out and above it, and a house for the
    plant; deep plots get two bars of unequal height.

    Raise bars of offices and the cores that serve them over a lobby.

    Parameters
    ----------
    core
        Where the stairs stand along the bar.
    bar
        Metres of the width of a bar where there is room for two.
    recess
        Metres that the cores stand out.
    """
    skin = plot.pick("sun", SUNS, (3, 3, 2, 2))
    axes = plot.axes()
    if plot.levels < 3 or axes.width < LEAST or plot.plan.area < 0.6 * axes.length * axes.width:
        return (replace(plot.body, zone=skin),)
    chosen = core if core != "any" else plot.pick("core", CORES, (4, 3, 2, 1))
    lobby = Mass(plot.plan, 0.0, plot.storey, "lobby")
    far = axes.length
    rise = plot.storey * (1 if plot.levels < 6 else 1.4)
    top = plot.height - (0.0 if chosen == "none" else rise)
    found: list[Mass] = [lobby]
    spans = _cores(plot, chosen, axes.length)
    solid = [axes.box(x0, -far, x1, far) for x0, x1 in spans]
    back = plot.waver("core depth", recess, lobby)
    for span in solid:
        plan = (plot.plan & span).buffer(-0.2, join_style="mitre")
        found += [Mass(each, plot.storey, plot.height, "core") for each in pieces(plan)]
    rest = plot.plan.buffer(-0.25, join_style="mitre")
    for span in solid:
        rest = rest - span.buffer(0.01)
    deep = axes.width > max(DEEP, 1.6 * bar)
    front = axes.width / 2 - (0.0 if chosen == "none" else back)
    if deep:
        gap = axes.width - 2 * bar if axes.width - 2 * bar > 6.0 else 0.28 * axes.width
        strips = [(-far, -gap / 2), (gap / 2, front)]
    else:
        strips = [(-front, front)]
    level = plot.floor(plot.between("second bar", 0.55, 0.9) * top)
    for number, (y0, y1) in enumerate(strips):
        high = top if number == len(strips) - 1 else max(level, 2 * plot.storey)
        for each in pieces(rest & axes.box(-far, y0, far, y1)):
            found += _bar(plot, Mass(each, plot.storey, high, skin))
    return tuple(found)


def _cores(plot: Plot, core: str, length: float) -> Sequence[tuple[float, float]]:
    """Return the stretches of the length that stairs and lifts take."""
    wide = min(plot.between("core", 5.0, 8.0), 0.22 * length)
    half = length / 2
    hand = 1.0 if plot.draw("hand") < 0.5 or not plot.noise else -1.0
    if core == "end":
        span = (half - wide, length)
        return [span if hand > 0 else (-span[1], -span[0])]
    if core == "ends":
        return [(half - 0.7 * wide, length), (-length, 0.7 * wide - half)]
    if core == "middle":
        middle = hand * plot.between("core at", 0.0, 0.34) * half
        return [(middle - wide / 2, middle + wide / 2)]
    return []


def _bar(plot: Plot, body: Mass) -> Sequence[Mass]:
    """Set a house for the plant on the roof of a bar."""
    axes = plot.axes(body.plan)
    if axes.length < 16 or axes.width < 9 or body.height < 3.5 * plot.storey:
        return [body]
    storey = plot.storey
    x = axes.length * plot.between("plant length", 0.18, 0.34)
    at = (0.5 * axes.length - x - 2.0) * (2 * plot.draw("plant at") - 1) * min(1, 2 * plot.noise)
    house = axes.box(at - x, -0.28 * axes.width, at + x, 0.28 * axes.width)
    rule = banded((-1,), symbols=("", ""))
    lower, upper = (mass for _, mass in rule(body, plot))
    tops = [
        replace(upper, plan=each, high=upper.low + 0.85 * storey, zone="plant")
        for each in pieces(body.plan & house)
    ]
    return [lower, *tops]


GENERATOR = generator(masses)
office_slab = action_of("building/office_slab-v1", GENERATOR, masses)
