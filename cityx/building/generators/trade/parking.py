"""Parking decks: open floors between parapets of concrete, a ramp, towers of stairs."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Annotated, Any

import numpy as np
import shapely

from cityx.building.generators import action_of, generator
from cityx.building.massing.massing import LEAST_WIDTH, Axes, Mass, Plot, pieces
from cityx.protocol import Choice, Range

RAMPS = ("drum", "inner")
LEAST = 12.0  # metres of width of a deck with open floors
SLOT = 1.5  # metres, the least open height between parapets
DRUM = 8.6  # metres, radius of a ramp that winds
CURB = 0.28  # metres by which upper parts stand behind the wall below


def masses(
    plot: Plot,
    *,
    ramp: Annotated[str, Choice("any", *RAMPS)] = "any",
    band: Annotated[float, Range(0.7, 1.6)] = 1.15,
    stairs: Annotated[int, Range(0, 4)] = 2,
) -> tuple[Mass, ...]:
    """Build parking decks with open floors.

    Floors between parapets of concrete with nothing but columns between them, a drum or an inner
    ramp, towers of stairs at the corners, and a way in with barriers and a bar for the height.

    Lay floors with parapets over one another, open between, around a ramp.

    Parameters
    ----------
    ramp
        Whether cars climb in a drum at a corner or inside.
    band
        Metres of the parapets.
    stairs
        Towers of stairs.
    """
    axes = plot.axes()
    storey = plot.storey
    tall = min(band, storey - SLOT)
    whole = plot.plan.area > 0.55 * axes.length * axes.width
    if plot.levels < 2 or tall < 0.6 or axes.width < LEAST or not whole:
        return (plot.body,)
    towers, cut = _stairs(plot, axes, stairs)
    chosen = ramp if ramp != "any" else plot.pick("ramp", RAMPS, (1, 1))
    drum = _drum(plot, axes) if chosen == "drum" else None
    base_top = storey + tall
    found = [Mass(plot.plan, 0.0, base_top, "base"), *[
        Mass(each, base_top, plot.height, "stair") for each in towers
    ]]  # fmt: skip
    room = plot.plan.buffer(-CURB, join_style="mitre") - cut
    if drum is not None:
        room = room - _corner_of(drum, axes) - drum.buffer(0.02)
    skin = plot.pick("skin", ("", "slatted", "striped"), (4, 3, 2))
    decks = max(1, plot.levels - 1)
    for number in range(2, decks + 1):
        low = number * storey
        found += [Mass(each, low, low + tall, skin) for each in pieces(room)]
    inner = _core(plot, axes, room)
    for number in range(1, decks):
        low, high = number * storey + tall, (number + 1) * storey
        found += [Mass(each, low, high, "core") for each in inner]
    if drum is not None:
        found += _helix(plot, drum, base_top, plot.height, tall)
    return tuple(found)


def _stairs(plot: Plot, axes: Axes, count: int) -> tuple[Sequence[Any], Any]:
    """Return plans of towers of stairs at opposite corners, and what they take of the decks."""
    x, y = axes.length / 2, axes.width / 2
    wide, deep = min(6.2, 0.25 * axes.length), min(4.6, 0.3 * axes.width)
    hand = 1.0 if plot.draw("hand") < 0.5 or not plot.noise else -1.0
    places = ((hand, 1.0), (-hand, -1.0), (hand, -1.0), (-hand, 1.0))
    found, taken = [], []
    for sx, sy in places[:count]:
        x0, x1 = sorted((sx * x, sx * (x - wide)))
        y0, y1 = sorted((sy * y, sy * (y - deep)))
        spot = axes.box(x0, y0, x1, y1)
        plans = pieces(spot & plot.plan.buffer(-0.12, join_style="mitre"))
        if plans and plans[0].area > 0.85 * spot.area:
            taken.append(spot)
            found.append(plans[0])
    return found, shapely.union_all(taken)


def _drum(plot: Plot, axes: Axes) -> Any | None:
    """Return the round plan of a ramp in a corner at the front, or None where there is no room."""
    radius = min(plot.between("drum", 0.85, 1.0) * DRUM, 0.3 * axes.width)
    if radius < 5.5 or axes.length < 5 * radius:
        return None
    hand = 1.0 if plot.draw("hand") >= 0.5 and plot.noise else -1.0
    x, y = hand * (axes.length / 2 - radius - 0.4), axes.width / 2 - radius - 0.4
    disc = axes.place(shapely.Point(x, y).buffer(radius, quad_segs=7))
    return disc if plot.plan.contains(disc) else None


def _corner_of(drum: Any, axes: Axes) -> Any:
    """Return the corner of the plan that a drum leaves open: it shows from the street."""
    offset = np.array(drum.centroid.coords[0]) - axes.middle
    x, y = float(offset @ axes.along), float(offset @ axes.across)
    inner = 0.72 * math.sqrt(drum.area / math.pi)
    hand = 1.0 if x > 0 else -1.0
    x0, x1 = sorted((x - hand * inner, hand * axes.length))
    return axes.box(x0, y - inner, x1, axes.length)


def _helix(plot: Plot, drum: Any, low: float, high: float, tall: float) -> Sequence[Mass]:
    """Wind a ramp: rings of parapet half a storey apart about a pillar."""
    middle = drum.centroid
    pillar = middle.buffer(1.5, quad_segs=4)
    found = []
    step = plot.storey / 2
    level = low + 0.55
    while level + 0.8 * tall <= high + 1e-6:
        found.append(Mass(drum - pillar, level, level + min(0.8 * tall, 0.6 * step), "drum"))
        level += step
    if pillar.buffer(-LEAST_WIDTH / 2).is_empty or not found:
        return found
    return [Mass(pillar, low, high, "core"), *found]


def _core(plot: Plot, axes: Axes, room: Any) -> Sequence[Any]:
    """Return the plan of the ramps between the decks, deep inside."""
    half = 0.3 * axes.length
    body = axes.box(-half, -3.0, half, 3.0) & room.buffer(-3.0)
    del plot
    return pieces(body)


GENERATOR = generator(masses)
parking = action_of("building/parking-v1", GENERATOR, masses)
