"""Postmodern towers: an arcade of stone, a shaft of paired windows, a gable against the sky."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Annotated

import shapely

from cityx.building.generators import action_of, generator
from cityx.building.massing.massing import Axes, Mass, Plot, pieces
from cityx.building.massing.rules import notched
from cityx.protocol import Choice, Range

CROWNS = ("gable", "broken", "vault", "pyramid", "drum")
LEAST = 12.0  # metres of width under which there is neither slot nor crown
JOINT = 0.6  # metres by which the shaft stands behind the base


def masses(
    plot: Plot,
    *,
    crown: Annotated[str, Choice("any", *CROWNS)] = "any",
    base: Annotated[int, Range(1, 8)] = 3,
    slot: Annotated[float, Range(0.0, 0.6)] = 0.3,
    shoulder: Annotated[float, Range(0.6, 8.0)] = 2.4,
) -> tuple[Mass, ...]:
    """Build postmodern towers of stone in two colours.

    A base with an arcade, a shaft of paired windows with a slot of glass up its middle, shoulders
    drawn in, and a gable, a broken gable, a vault, a pyramid or a domed drum on top.

    Stand a shaft with a glazed slot on a stone base and end it as a piece of furniture ends.

    Parameters
    ----------
    crown
        What ends the tower.
    base
        Storeys of the base.
    slot
        Share of the length that the slot of glass takes.
    shoulder
        Metres that the top is drawn in.
    """
    foot = min(base, max(1, plot.levels // 4)) * plot.storey
    lower = Mass(plot.plan, 0.0, foot, "base")
    if plot.levels < 5:
        return (replace(plot.body, zone="base"),)
    chosen = crown if crown != "any" else plot.pick("crown", CROWNS, (4, 4, 3, 2, 2))
    found: list[Mass] = [lower]
    for part in pieces(plot.plan.buffer(-JOINT, join_style="mitre")):
        shaft = Mass(part, foot, plot.height)
        own = plot.axes(part)
        if own.width < LEAST or part.area < 0.6 * own.length * own.width:
            found.append(shaft)
        else:
            found += _tower(plot, shaft, own, chosen, slot, shoulder)
    return tuple(found)


def _tower(
    plot: Plot, shaft: Mass, axes: Axes, crown: str, slot: float, shoulder: float
) -> Sequence[Mass]:
    """Divide a shaft into body, drawn-in shoulder and crown."""
    tall = min(plot.between("crown", 0.5, 0.85) * axes.width, 0.25 * shaft.height)
    neck = shaft.low + plot.floor(plot.between("neck", 0.66, 0.82) * shaft.height)
    eave = shaft.high - tall
    if eave - neck < 2 * plot.storey:
        neck = shaft.low + plot.floor(0.6 * shaft.height)
    body = replace(shaft, high=neck)
    found = list(_slotted(plot, body, axes, slot))
    inset = plot.waver("shoulder", shoulder, shaft)
    upper = pieces(shaft.plan.buffer(-inset, join_style="mitre"))
    if not upper or eave - neck < plot.storey:
        return [*found, replace(shaft, low=neck)]
    top = replace(shaft, plan=upper[0], low=neck, high=eave, zone="shoulder")
    rest = [replace(top, plan=each) for each in upper[1:]]
    corner = notched(1.6)(top, plot) if not plot.noise or plot.draw("ears") < 0.6 else ()
    tops = [mass for _, mass in corner] or [top]
    return [*found, *rest, *tops, *_crown(plot, tops[0], shaft.high, crown)]


def _slotted(plot: Plot, body: Mass, axes: Axes, slot: float) -> Sequence[Mass]:
    """Open the middle of the shaft in a bay of glass, a little behind its stone flanks."""
    wide = 0.5 * plot.waver("slot", slot, body) * axes.length
    if wide < 2.2:
        return [body]
    far = axes.length
    deep = min(1.1, 0.06 * axes.width)
    strips = (
        (axes.box(-far, -far, -wide, far), ""),
        (axes.box(wide, -far, far, far), ""),
        (axes.box(-wide, deep - axes.width / 2, wide, axes.width / 2 - deep), "slot"),
    )
    return [
        replace(body, plan=each, zone=zone)
        for strip, zone in strips
        for each in pieces(body.plan & strip)
    ]


def _crown(plot: Plot, below: Mass, high: float, crown: str) -> Sequence[Mass]:
    """End a tower: a gable, a gable with a gap, a vault, a pyramid or a drum with a dome."""
    axes = plot.axes(below.plan)
    low, tall = below.high, high - below.high
    plan = below.plan.buffer(-0.2, join_style="mitre")
    band = min(plot.storey, 0.35 * tall)
    whole = Mass(plan, low, high, "crown", rise=tall - band)
    if crown == "gable":
        return [replace(whole, roof="gabled", across=True)]
    if crown == "vault":
        return [replace(whole, roof="round", across=True)]
    if crown == "pyramid":
        return [replace(whole, roof="pyramidal")]
    if crown == "drum":
        radius = 0.46 * min(axes.length, axes.width)
        disc = shapely.Point(axes.middle).buffer(radius, quad_segs=6)
        drums = pieces(plan & disc)
        half = 0.5 * tall
        return [replace(whole, plan=each, roof="dome", rise=half) for each in drums[:1]]
    gap = 0.12 * axes.length
    far = axes.length
    along = math.atan2(axes.along[0], axes.along[1])
    sides = (
        (axes.box(-far, -far, -gap, far), along + math.pi),
        (axes.box(gap, -far, far, far), along),
    )
    leaves = [
        replace(whole, plan=each, roof="skillion", direction=turn % (2 * math.pi))
        for side, turn in sides
        for each in pieces(plan & side)
    ]
    link = pieces(plan & axes.box(-gap, -far, gap, far))
    return leaves + [replace(whole, plan=each, high=low + band, rise=0.0) for each in link]


GENERATOR = generator(masses)
postmodern_tower = action_of("building/postmodern_tower-v1", GENERATOR, masses)
