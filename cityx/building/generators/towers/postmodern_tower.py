"""Postmodern towers: an arcade of stone, a shaft of paired windows, a gable against the sky."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from types import MappingProxyType
from typing import Annotated

import shapely

from cityx.assets.styles.facade_styles import FacadeStyle, Fixture, Strip
from cityx.assets.styles.generators import Generator, Look
from cityx.building.design import redesign
from cityx.building.massing.massing import Axes, Mass, Plot, pieces
from cityx.building.massing.rules import notched
from cityx.city.city import City
from cityx.protocol import Choice, ObjectName, Range, action

CROWNS = ("gable", "broken", "vault", "pyramid", "drum")
LEAST = 12.0  # metres of width under which there is neither slot nor crown
JOINT = 0.6  # metres by which the shaft stands behind the base


def masses(
    plot: Plot, *, crown: str = "any", base: int = 3, slot: float = 0.3, shoulder: float = 2.4
) -> tuple[Mass, ...]:
    """Stand a shaft with a glazed slot on a stone base and end it as a piece of furniture ends."""
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


_STONES = (
    (4, "stone", (0xC49A86, 0xB8836E, 0xCBA78F, 0xA9786A)),  # rose granite
    (3, "stone", (0xD2C3A2, 0xC8B896, 0xDBCFB4)),  # buff
    (2, "stone", (0x9DA3A0, 0xAEB2AC)),  # grey-green
    (1, "brick", (0x9C5F4A, 0x8C5644)),
)
_FRAMES = (0x2F4A44, 0x3A2F2A, 0x2C3A4A, 0x5B2F2A)
_SHAFT = FacadeStyle(
    "punched", 3.3, (("window_pair", 5), ("window_lattice", 2)), (("door_double", 1),),
    sill=0.75, corner=1.5, scale=(1.0, 1.0), surrounds=(("sill", 1), ("surround_flat", 1)),
    heads=(("cornice", 1),), back="sill",
    slabs=(
        Strip("band_box", 0.5, 0.035, "accent", 0.8),
        Strip("band_box", 0.34, 0.3, "trim", 0.95, every=6),
    ),
    fins=(Strip("band_box", 0.9, 0.12, "wall", 1.06, every=2, share=0.6),),
)  # fmt: skip
_ZONES = {
    "base": Look(
        FacadeStyle(
            "punched", 4.2, (("window_lattice", 2), ("window_pair", 1)), (("door_double", 1),),
            sill=0.8, ground_storey=5.6, corner=0.4, surrounds=(("surround_flat", 1),),
            heads=(("cornice", 1),), back="sill", string=0.0, quoins=0.4,
            slabs=(Strip("band_box", 0.12, 0.05, "wall", 0.6),),
            fixtures=(
                Fixture("stone_arcade", "bay", tint="trim", stretch="bay", street=True,
                        before=True),
                Fixture("stone_urn", "edge", tint="trim", spacing=9.0, out=-1.0, street=True,
                        share=0.6),
            ),
        ),
        _STONES,
        frames=_FRAMES,
    ),
    "slot": Look(
        FacadeStyle(
            "curtain", 1.6, (("window_office", 1),), (("door_glass", 1),), surrounds=(("", 1),),
            heads=(("coping", 1),), back="",
            fins=(Strip("band_frame", 0.12, 0.16, "frame", spacing=1.6),),
            slabs=(Strip("band_frame", 0.5, 0.06, "frame", 0.7),),
        ),
        ((1, "glass_wall", (0xD4E6F6, 0xE6E2D2, 0xCDE2D8)),),
        frames=_FRAMES,
    ),
    "shoulder": Look(
        replace(_SHAFT, windows=(("window_lattice", 1),)),
        _STONES,
        frames=_FRAMES,
    ),
    "crown": Look(
        FacadeStyle(
            "punched", 3.0, (("window_lattice", 1),), (("door_service", 1),), sill=0.9,
            surrounds=(("sill", 1),), heads=(("cornice", 1),), corner=1.2,
            fixtures=(Fixture("roof_flag", "top", tint="accent", share=0.4),),
        ),
        _STONES,
        frames=_FRAMES,
    ),
}  # fmt: skip

GENERATOR = Generator(
    "postmodern_tower",
    "Postmodern tower",
    Look(_SHAFT, _STONES, frames=_FRAMES),
    zones=MappingProxyType(_ZONES),
    mass=masses,
    roofs=(("flat", 1.0),),
    pitched=((4, "copper", (0xFFFFFF,)), (2, "roof_metal", (0x7A4A3A, 0x50606C, 0x6E7274))),
    area=(250.0, 9000.0),
    levels=(5, 90),
    width=(12.0, 200.0),
    plot=(26.0, 42.0, 24.0, 34.0),
    floors=(14, 34),
    storey=3.8,
    use="office",
)


@action(
    "building/postmodern_tower-v1",
    limits=["Only footprints of a size that admits such a building change."],
    requires=("layout",),
    labels=("postmodern", "tower", "arcade", "gable", "granite", "pediment"),
)
def postmodern_tower(
    city: City,
    *,
    share: Annotated[float, Range(0.0, 1.0)] = 1.0,
    floors: Annotated[int, Range(0, 90)] = 0,
    building: Annotated[str | None, ObjectName()] = None,
    crown: Annotated[str, Choice("any", *CROWNS)] = "any",
    base: Annotated[int, Range(1, 8)] = 3,
    slot: Annotated[float, Range(0.0, 0.6)] = 0.3,
    shoulder: Annotated[float, Range(0.6, 8.0)] = 2.4,
    noise: Annotated[float, Range(0.0, 1.0)] = 0.5,
) -> City:
    """Build postmodern towers of stone in two colours.

    A base with an arcade, a shaft of paired windows with a slot of glass up its middle, shoulders
    drawn in, and a gable, a broken gable, a vault, a pyramid or a domed drum on top.

    Parameters
    ----------
    share
        Share of the buildings that become one.
    floors
        Storeys, 0 to keep those of each building.
    building
        The one building to change, or None for all.
    crown
        What ends the tower.
    base
        Storeys of the base.
    slot
        Share of the length that the slot of glass takes.
    shoulder
        Metres that the top is drawn in.
    noise
        How far measures vary; 0 is regular.
    """
    mass = partial(masses, crown=crown, base=base, slot=slot, shoulder=shoulder)
    return redesign(
        city, GENERATOR, share=share, floors=floors, building=building, mass=mass, noise=noise
    )
