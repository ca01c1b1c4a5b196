"""Brutalist blocks: raw concrete, coffers about windows, stacked trays, towers of stairs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from types import MappingProxyType
from typing import Annotated, Any

import shapely

from cityx.building.generators import action_of, generator
from cityx.building.massing.massing import Axes, Mass, Plot, grow, pieces
from cityx.building.massing.rules import overhung, stepped
from cityx.protocol import Choice, Range

FORMS = ("inverted", "trays", "terraces", "slab")
LEAST = 13.0  # metres of width under which a building is a plain block with its coffers
TOWER = 4.6  # metres, side of a tower of stairs


def masses(
    plot: Plot,
    *,
    form: Annotated[str, Choice("any", *FORMS)] = "any",
    reach: Annotated[float, Range(0.5, 6.0)] = 1.8,
    towers: Annotated[int, Range(0, 4)] = 2,
) -> tuple[Mass, ...]:
    """Build brutalist blocks of raw concrete.

    Blocks that grow outwards, shift or step back over a plinth, windows deep in coffers, towers of
    stairs with slits, and heavy plant on the roof.

    Stack blocks of concrete over a plinth and stand towers of stairs beside them.

    Parameters
    ----------
    form
        How the blocks are stacked.
    reach
        Metres by which a block stands out beyond or behind the one below.
    towers
        Towers of stairs.
    """
    skin = plot.pick("skin", ("", "hooded", "banded"), (5, 3, 3))
    axes = plot.axes()
    if plot.levels < 4 or axes.width < LEAST or plot.plan.area < 0.55 * axes.length * axes.width:
        return (replace(plot.body, zone=skin),)
    plinth = Mass(plot.plan, 0.0, plot.storey, "plinth")
    top = plot.height - plot.storey * (1.0 if plot.levels < 8 else 1.6)
    stairs, taken = _stairs(plot, axes, towers)
    room = (plot.plan - taken).buffer(-0.25, join_style="mitre")
    chosen = form if form != "any" else plot.pick("form", FORMS, (4, 3, 3, 2))
    found: list[Mass] = [plinth, *stairs]
    for each in pieces(room):
        body = Mass(each, plinth.high, top, skin)
        own = plot.axes(each)
        blocks = _BODIES[chosen](plot, body, own, reach) if own.width > 0.6 * LEAST else [body]
        found += [*blocks, *_plant(plot, blocks)]
    return tuple(found)


def _stairs(plot: Plot, axes: Axes, count: int) -> tuple[Sequence[Mass], Any]:
    """Stand blind towers at the ends and the back of the plan, higher than all else."""
    x, y = axes.length / 2, axes.width / 2
    side = min(plot.between("stair", 0.85, 1.25) * TOWER, 0.3 * axes.width, 0.18 * axes.length)
    hand = 1.0 if plot.draw("hand") < 0.5 or not plot.noise else -1.0
    at = plot.between("stair at", -0.3, 0.3) * x
    places = (
        (hand * (x - side / 2), y - side / 2),
        (-hand * (x - side / 2), side / 2 - y),
        (at, side / 2 - y),
        (-hand * (x - side / 2), y - side / 2),
    )
    found, taken = [], []
    for px, py in places[:count] if side > 2.6 else ():
        spot = axes.box(px - side / 2, py - side / 2, px + side / 2, py + side / 2)
        if spot.intersection(plot.plan).area > 0.98 * spot.area:
            taken.append(spot)
            found += [
                Mass(each, plot.storey, plot.height, "stair")
                for each in pieces(spot.intersection(plot.plan.buffer(-0.1)))
            ]
    return found, shapely.union_all(taken)


def _inverted(plot: Plot, body: Mass, axes: Axes, reach: float) -> Sequence[Mass]:
    """Let the block grow outwards as it rises."""
    steps = max(1, min(3, plot.levels // 3))
    room = 0.16 * axes.width / steps
    rules = {"lot": overhung(steps, min(reach, room), least=5.0)}
    return grow(plot, rules, depth=1, axiom=body)


def _trays(plot: Plot, body: Mass, axes: Axes, reach: float) -> Sequence[Mass]:
    """Stack trays of two or three storeys that are shifted along the block in turn."""
    count = max(2, min(5, round(body.height / plot.storey / 2.4)))
    level = [body.low + plot.floor(body.height * i / count) for i in range(count)] + [body.high]
    x, y, far = axes.length / 2, axes.width / 2, axes.length
    found = []
    for number in range(count):
        cut = 1.6 * reach * (1 + plot.draw("tray", number) if plot.noise else 1.0)
        cut = min(cut, 0.2 * axes.length)
        back = 0.45 * reach if number % 2 else 0.0
        hand = 1 if number % 2 else -1
        ends = (-far, x - cut) if hand > 0 else (cut - x, far)
        tray = (
            axes.box(ends[0], -far, ends[1], y - back)
            if back
            else axes.box(ends[0], -far, ends[1], far)
        )
        found += [
            replace(body, plan=each, low=level[number], high=level[number + 1])
            for each in pieces(body.plan & tray)
        ]
    return found


def _terraces(plot: Plot, body: Mass, axes: Axes, reach: float) -> Sequence[Mass]:
    """Step the block back from the street in terraces."""
    steps = max(2, min(6, plot.levels - 3))
    rules = {"lot": stepped(steps, min(1.4 * reach, 0.5 * axes.width / steps))}
    return grow(plot, rules, depth=1, axiom=body)


def _slab(plot: Plot, body: Mass, axes: Axes, reach: float) -> Sequence[Mass]:
    """Lift a thin slab over a broad foot."""
    level = body.low + plot.floor(0.3 * body.height)
    y = 0.3 * axes.width
    upper = pieces(body.plan & axes.box(-axes.length, -y, axes.length, y))
    if not upper or level <= body.low:
        return [body]
    inset = 0.5 * reach
    foot = pieces(body.plan.buffer(-inset, join_style="mitre")) or [body.plan]
    return [
        *[replace(body, plan=each, high=level) for each in foot],
        *[replace(body, plan=each & foot[0], low=level) for each in upper],
    ]


_BODIES = MappingProxyType(
    {"inverted": _inverted, "trays": _trays, "terraces": _terraces, "slab": _slab}
)


def _plant(plot: Plot, blocks: Sequence[Mass]) -> Sequence[Mass]:
    """Load the highest roof with a heavy house of plant."""
    highest = max(blocks, key=lambda mass: (round(mass.high, 2), round(mass.plan.area, 1)))
    axes = plot.axes(highest.plan)
    x, y = plot.between("plant", 0.16, 0.3) * axes.length, 0.26 * axes.width
    if y < 2.2 or highest.high > plot.height - 1.0:
        return []
    at = (0.5 * axes.length - x) * (2 * plot.draw("plant at") - 1) * 0.7 * min(1, 2 * plot.noise)
    house = axes.box(at - x, -1.1 * y, at + x, 0.7 * y)
    high = highest.high + min(plot.height - highest.high, 1.3 * plot.storey) * 0.85
    return [
        Mass(each, highest.high, high, "plant")
        for each in pieces(house.intersection(highest.plan.buffer(-1.2)))
    ]


GENERATOR = generator(masses)
brutalist = action_of("building/brutalist-v1", GENERATOR, masses)
