"""Modern mixed-use blocks: shops below, flats in volumes of their own materials, terraces above."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Annotated

from cityx.building.generators import action_of, generator
from cityx.building.massing.massing import Axes, Mass, Plot, pieces
from cityx.protocol import Range

LEAST = 9.0  # metres of width under which a house is one volume
SKINS = ("", "second", "third")
JOINT = 0.2  # metres by which upper walls stand behind those below
MANY = 0.75  # share of plots on which the block is divided at all: most of a town is plain


def masses(
    plot: Plot,
    *,
    volumes: Annotated[int, Range(1, 6)] = 3,
    terrace: Annotated[float, Range(1.0, 6.0)] = 2.6,
    retail: Annotated[int, Range(1, 3)] = 1,
    divided: float = 1.0,
) -> tuple[Mass, ...]:
    """Build modern blocks of flats over shops.

    A base for shops, volumes of two or three materials side by side above it, loggias, screens and
    balconies, and top storeys set back behind terraces.

    Divide a block above its shops into volumes, and step their tops back in terraces.

    Parameters
    ----------
    volumes
        Volumes side by side, where there is room.
    terrace
        Metres that the top storeys are set back.
    retail
        Storeys of the base.
    """
    axes = plot.axes()
    plain = plot.levels < 4 or axes.width < LEAST or plot.draw("divided") >= divided
    if plain or plot.plan.area < 0.5 * axes.length * axes.width:
        return (plot.body,)
    level = min(retail, plot.levels - 2) * plot.storey
    found = [Mass(plot.plan, 0.0, level, "retail")]
    above = plot.plan.buffer(-JOINT, join_style="mitre")
    count = max(1, min(volumes, int(axes.length / 9.0)))
    edge = _edges(plot, axes, count)
    start = int(3 * plot.draw("first skin")) if plot.noise else 0
    far = axes.length
    for number in range(count):
        x0 = -far if number == 0 else edge[number]
        x1 = far if number == count - 1 else edge[number + 1]
        skin = SKINS[(start + number) % (3 if count > 2 else 2)]
        back = 0.0 if number % 2 == 0 else plot.between("recess", 0.6, 1.8)
        strip = axes.box(x0, -far, x1, axes.width / 2 - back if back else far)
        drop = round(1.49 * plot.draw("drop", number)) if plot.noise and count > 1 else number % 2
        high = plot.height - min(drop, max(plot.levels - 4, 0)) * plot.storey
        for plan in pieces(above & strip):
            found += _terraced(plot, Mass(plan, level, high, skin), terrace)
    return tuple(found)


def _edges(plot: Plot, axes: Axes, count: int) -> Sequence[float]:
    """Return where the volumes meet along the block, unequal shares."""
    shares = [
        1.0 + (0.5 * (2 * plot.draw("volume", i) - 1) * min(1, 2 * plot.noise))
        for i in range(count)
    ]
    run, edges = -axes.length / 2, []
    for share in shares:
        edges.append(run)
        run += axes.length * share / sum(shares)
    return [*edges, run]


def _terraced(plot: Plot, body: Mass, depth: float) -> Sequence[Mass]:
    """Set the top storey, or the two top ones in steps, back from the street."""
    axes = plot.axes(body.plan)
    storeys = round(body.height / plot.storey)
    steps = (
        0
        if storeys < 3
        else 1
        if storeys < 5
        else 1 + int(1.4 * plot.draw("steps") * min(1, 2 * plot.noise))
    )
    found: list[Mass] = []
    left = body
    for step in range(steps):
        back = plot.between(f"terrace {step}", 0.75 * depth, 1.25 * depth)
        far = axes.length + axes.width
        room = axes.box(-far, -far, far, axes.width / 2 - (step + 1) * back)
        upper = pieces(left.plan.buffer(-JOINT, join_style="mitre") & room)
        level = body.high - (steps - step) * plot.storey
        if not upper or plot.axes(upper[0]).width < 0.55 * axes.width:
            break
        found.append(replace(left, high=level))
        found += [replace(left, plan=each, low=level, zone="attic") for each in upper[1:]]
        left = replace(left, plan=upper[0], low=level, zone="attic")
    return [*found, left]


# A call of the action divides all blocks, a town does some.
GENERATOR = generator(masses, divided=MANY)
mixed_use = action_of("building/mixed_use-v1", GENERATOR, masses)
