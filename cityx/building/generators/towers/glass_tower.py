"""Glass curtain-wall towers: a lobby of two storeys, a shaft of glass of many forms, a crown."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from types import MappingProxyType
from typing import Annotated

from shapely import affinity

from cityx.building.generators import action_of, generator
from cityx.building.massing.massing import Mass, Plot, Successors, grow, pieces
from cityx.building.massing.rules import banded, bundled, sliced
from cityx.protocol import Choice, Range

FORMS = ("taper", "notch", "twist", "bundle", "slabs", "wedge")
JOINT = 0.25  # metres by which parts on one another differ, so that their walls never coincide
SLENDER = 11.0  # metres of width under which a tower is a plain shaft
LOW = 9  # storeys; a lower building has neither crown nor floors for plant


def masses(
    plot: Plot,
    *,
    form: Annotated[str, Choice("any", *FORMS)] = "any",
    taper: Annotated[float, Range(0.3, 1.0)] = 0.7,
    turn: Annotated[float, Range(0.0, 120.0)] = 60.0,
    plant: Annotated[int, Range(0, 60)] = 15,
) -> tuple[Mass, ...]:
    """Build towers of glass of many forms.

    A lobby of two storeys, a shaft of glass that tapers, turns, steps or slides, floors of plant
    behind louvres, and a screen or a lantern on top.

    Stand a shaft of some form on a lobby, divide it by floors of plant and crown it.

    Parameters
    ----------
    form
        Form of the shaft.
    taper
        Size of the top relative to the foot, where the form has one.
    turn
        Degrees by which twisted shafts turn.
    plant
        Storeys between floors of plant; 0 for none.
    """
    skin = plot.pick("skin", ("", "ribbed", "banded"), (5, 3, 2))
    lobby = 2 if plot.levels >= LOW else 1
    if plot.levels < 5:
        return (replace(plot.body, zone=skin),)
    base = Mass(plot.plan, 0.0, lobby * plot.storey, "lobby")
    upper = pieces(plot.plan.buffer(-JOINT, join_style="mitre"))
    if not upper:
        return (replace(plot.body, zone=skin),)
    chosen = form if form != "any" else plot.pick("form", FORMS, (3, 3, 2, 2, 3, 3))
    found: list[Mass] = [base]
    for part in upper:
        shaft = Mass(part, base.high, plot.height, skin)
        axes = plot.axes(part)
        fits = axes.width >= SLENDER and part.area > 0.45 * axes.length * axes.width
        own = chosen if fits and plot.levels >= LOW else "plain"
        found += _SHAFTS[own](plot, shaft, taper, math.radians(turn))
    return tuple(each for mass in found for each in _with_plant(plot, mass, plant))


def _plain(plot: Plot, shaft: Mass, taper: float, turn: float) -> Sequence[Mass]:
    del taper, turn
    return _screened(plot, shaft)


def _taper(plot: Plot, shaft: Mass, taper: float, turn: float) -> Sequence[Mass]:
    """Draw the plan in a little every few floors, more and more."""
    del turn
    steps = max(3, min(9, plot.levels // 4))
    middle, found = shaft.plan.centroid, []
    share = 1 - (1 - taper) * (0.85 + 0.3 * plot.draw("taper") if plot.noise else 1.0)
    level = [shaft.low + plot.floor((shaft.high - shaft.low) * i / steps) for i in range(steps)]
    level.append(shaft.high)
    for step in range(steps):
        size = 1 - (1 - share) * (step / (steps - 1)) ** 1.4
        plan = affinity.scale(shaft.plan, size, size, origin=middle).intersection(shaft.plan)
        found += [
            replace(shaft, plan=each, low=level[step], high=level[step + 1])
            for each in pieces(plan)
        ]
    top = found.pop()
    return [*found, *_screened(plot, top)]


def _notch(plot: Plot, shaft: Mass, taper: float, turn: float) -> Sequence[Mass]:
    """Cut the corners deep, and end the corners of the shaft below its core."""
    del turn
    axes = plot.axes(shaft.plan)
    depth = min(plot.between("notch", 2.4, 4.6), 0.2 * axes.width)
    drop = 1 - plot.between("shoulder", 0.12, 0.3)
    x, y = 0.5 * axes.length - depth, 0.5 * axes.width - depth
    cross = axes.box(-x, -axes.width, x, axes.width).union(
        axes.box(-axes.length, -y, axes.length, y)
    )
    level = shaft.low + plot.floor(drop * shaft.height)
    core = axes.box(-x * (0.3 + 0.7 * taper), -y, x * (0.3 + 0.7 * taper), y)
    found = [replace(shaft, plan=each, high=level) for each in pieces(shaft.plan & cross)]
    upper = pieces(shaft.plan & core)
    if not upper or level > shaft.high - 2 * plot.storey:
        return _screened(plot, shaft)
    tops = [replace(shaft, plan=each, low=level) for each in upper]
    return [*found, *tops[1:], *_screened(plot, tops[0])]


def _twist(plot: Plot, shaft: Mass, taper: float, turn: float) -> Sequence[Mass]:
    """Turn a square shaft with cut corners over a podium, every second floor a little."""
    axes = plot.axes(shaft.plan)
    low = shaft.low + 2 * plot.storey
    steps = max(4, min(26, plot.levels // 2))
    if shaft.high - low < 5 * plot.storey:
        return _taper(plot, shaft, taper, turn)
    sign = 1.0 if plot.draw("hand") < 0.5 or not plot.noise else -1.0
    half, cut = 0.43 * axes.width, 0.07 * axes.width
    long = min(half + 0.2 * (axes.length - axes.width), 1.25 * half)
    square = axes.box(-long, -half, long, half).buffer(-cut).buffer(cut, quad_segs=1)
    level = [low + plot.floor((shaft.high - low) * i / steps) for i in range(steps)] + [shaft.high]
    found = [replace(shaft, high=low)]
    for step in range(steps):
        share = step / (steps - 1)
        size = 1 - 0.5 * (1 - taper) * share
        plan = affinity.rotate(square, sign * turn * share, use_radians=True)
        plan = affinity.scale(plan, size, size) & shaft.plan
        found += [
            replace(shaft, plan=each, low=level[step], high=level[step + 1])
            for each in pieces(plan)
        ]
    top = found.pop()
    return [*found, *_screened(plot, top, tall=False)]


def _bundle(plot: Plot, shaft: Mass, taper: float, turn: float) -> Sequence[Mass]:
    """Bundle tubes of unequal height; the tallest bears the crown."""
    del turn
    axes = plot.axes(shaft.plan)
    along = 3 if axes.length > 33 else 2
    across = 3 if axes.width > 33 else 2
    rules = {"lot": bundled(across, along, lowest=max(0.35, 0.75 * taper))}
    tubes = list(grow(plot, rules, depth=1, axiom=shaft))
    if len(tubes) < 3:
        return _notch(plot, shaft, taper, turn=0.0)
    tallest = max(range(len(tubes)), key=lambda i: (tubes[i].high, -i))
    top = tubes.pop(tallest)
    return [*tubes, *_screened(plot, top)]


def _slabs(plot: Plot, shaft: Mass, taper: float, turn: float) -> Sequence[Mass]:
    """Slide two slabs of glass past one another along a solid core that rises above them."""
    del turn
    axes = plot.axes(shaft.plan)
    slide = axes.length * plot.between("slide", 0.1, 0.26)
    core = plot.between("core", 0.18, 0.26) * axes.width
    far = axes.length
    hand = 1.0 if plot.draw("hand") < 0.5 or not plot.noise else -1.0
    top = shaft.high - plot.storey
    second = shaft.low + plot.floor((0.55 + 0.4 * taper) * (top - shaft.low))
    strips = (
        (-far, -core / 2, hand * slide, top, shaft.zone),
        (core / 2, far, -hand * slide, second, shaft.zone),
        (-core / 2, core / 2, 0.0, shaft.high, "core"),
    )
    found = []
    for y0, y1, shift, high, zone in strips:
        cut = 1.5 * slide if zone == "core" else 0.0
        x0 = -far if shift <= 0 else -axes.length / 2 + shift
        x1 = far if shift >= 0 else axes.length / 2 + shift
        strip = axes.box(max(x0, cut - axes.length / 2 if cut else -far), y0,
                         min(x1, axes.length / 2 - cut if cut else far), y1)  # fmt: skip
        found += [
            replace(shaft, plan=each, high=high, zone=zone) for each in pieces(shaft.plan & strip)
        ]
    return found if len(found) >= 3 else _screened(plot, shaft)


def _wedge(plot: Plot, shaft: Mass, taper: float, turn: float) -> Sequence[Mass]:
    """Cut the top of a shaft aslant, and lean a lower slice against it."""
    del turn
    axes = plot.axes(shaft.plan)
    rules = {"lot": sliced((3, 2), symbols=("", ""), heights=(1.0, max(0.4, taper + 0.05)))}
    slices = list(grow(plot, rules, depth=1, axiom=shaft))
    rise = min(plot.between("wedge", 0.55, 1.0) * axes.width, 0.28 * shaft.height)
    found = []
    for number, each in enumerate(slices):
        slope = rise if number == 0 else 0.45 * rise
        slope = min(slope, 0.4 * each.height)
        back = axes.compass + (0.0 if number == 0 else math.pi)
        found.append(replace(each, roof="skillion", rise=slope, direction=back % (2 * math.pi)))
    return found


_SHAFTS = MappingProxyType(
    {
        "plain": _plain, "taper": _taper, "notch": _notch, "twist": _twist, "bundle": _bundle,
        "slabs": _slabs, "wedge": _wedge,
    }
)  # fmt: skip


def _screened(plot: Plot, top: Mass, *, tall: bool = True) -> Sequence[Mass]:
    """Hide the plant on a roof behind a screen of glass or metal."""
    storeys = 2 if tall and top.height > 8 * plot.storey else 1
    zone = plot.pick("crown", ("screen", "lantern"), (3, 2)) if plot.noise else "screen"
    if plot.levels < LOW or top.height < 2.5 * plot.storey:
        return [top]
    inset = 0.35 if zone == "screen" else 1.6
    rule = banded((-storeys,), symbols=("", ""), zones=(None, zone), insets=(0.0, inset))
    found: Successors = rule(top, plot)
    return [mass for _, mass in found] or [top]


def _with_plant(plot: Plot, mass: Mass, plant: int) -> Sequence[Mass]:
    """Divide a tall shaft by floors of plant, drawn in behind louvres."""
    count = round(mass.height / plot.storey)
    if not plant or mass.zone in ("core", "lobby", "screen", "lantern") or count < 1.35 * plant:
        return [mass]
    parts = max(1, round(count / plant) - 1)
    each = max(2, round((count - parts) / (parts + 1)))
    cuts, symbols, zones, insets = [], [""], [None], [0.0]
    zones_: list[str | None] = list(zones)
    for number in range(parts):
        foot = (number + 1) * each + number
        if foot + 3 > count:
            break
        cuts += [foot, foot + 1]
        symbols += ["", ""]
        zones_ += ["plant", None]
        insets += [0.4, 0.0]
    found = banded(cuts, symbols=symbols, zones=zones_, insets=insets)(mass, plot) if cuts else ()
    return [part for _, part in found] or [mass]


GENERATOR = generator(masses)
glass_tower = action_of("building/glass_tower-v1", GENERATOR, masses)
