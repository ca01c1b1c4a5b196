"""Brutalist blocks: raw concrete, coffers about windows, stacked trays, towers of stairs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from types import MappingProxyType
from typing import Annotated, Any

import shapely

from cityx.assets.styles.facade_styles import FacadeStyle, Fixture, Strip
from cityx.assets.styles.generators import Generator, Look
from cityx.building.design import redesign
from cityx.building.massing.massing import Axes, Mass, Plot, grow, pieces
from cityx.building.massing.rules import overhung, stepped
from cityx.city.city import City
from cityx.protocol import Choice, ObjectName, Range, action

FORMS = ("inverted", "trays", "terraces", "slab")
LEAST = 13.0  # metres of width under which a building is a plain block with its coffers
TOWER = 4.6  # metres, side of a tower of stairs


def masses(
    plot: Plot, *, form: str = "any", reach: float = 1.8, towers: int = 2
) -> tuple[Mass, ...]:
    """Stack blocks of concrete over a plinth and stand towers of stairs beside them."""
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


_CONCRETE = (
    (5, "concrete", (0xA39E94, 0xB0AAA0, 0x948F86, 0x8A857C)),
    (2, "concrete", (0xB5A994, 0xA89B86)),  # warm, with yellow sand
)
_FRAMES = (0x2B2724, 0x3A3632, 0x4A3A2C, 0x24282A)
_BOARDS = (Strip("band_box", 0.05, 0.016, "wall", 0.80, spacing=1.2, lobby=False),)
_COFFERED = FacadeStyle(
    "strip", 3.3, (("window_deep", 1),), (("door_glass", 1),), sill=0.85, ground_storey=3.2,
    corner=0.7, scale=(1.0, 0.95), surrounds=(("", 1),), heads=(("", 1),), back="",
    fins=_BOARDS,
    fixtures=(
        Fixture("concrete_coffer", "bay", tint="wall", first=0, last=-1, stretch="bay",
                before=True),
        Fixture("waterspout", "edge", tint="wall", spacing=9.0, share=0.5),
    ),
)  # fmt: skip
_ZONES = {
    "hooded": Look(
        replace(
            _COFFERED, mode="punched", bay=3.6, corner=1.0,
            fixtures=(
                Fixture("concrete_hood", "bay", tint="wall", last=-1, stretch="bay"),
                Fixture("waterspout", "edge", tint="wall", spacing=7.2, share=0.7),
            ),
        ),
        _CONCRETE,
        frames=_FRAMES,
    ),
    "banded": Look(
        replace(
            _COFFERED, sill=1.05, windows=(("window_strip", 1),), scale=(1.0, 0.9),
            slabs=(Strip("band_box", 1.15, 0.45, "wall", 0.97, lobby=False),),
            fins=(*_BOARDS, Strip("band_box", 0.55, 0.62, "wall", 1.0, every=3, lobby=False)),
            fixtures=(Fixture("waterspout", "edge", tint="wall", spacing=9.0, share=0.6),),
        ),
        _CONCRETE,
        frames=_FRAMES,
    ),
    "plinth": Look(
        FacadeStyle(
            "punched", 4.8, (("window_deep", 1),), (("door_glass", 1),), sill=0.6, corner=0.8,
            ground_storey=3.4, scale=(1.3, 1.0), surrounds=(("", 1),), heads=(("", 1),), back="",
            fins=(*_BOARDS, Strip("band_box", 0.9, 0.5, "wall", 0.95, lobby=False)),
        ),
        _CONCRETE,
        frames=_FRAMES,
    ),
    "stair": Look(
        FacadeStyle(
            "punched", 3.4, (("window_slit", 1),), (("door_service", 1),), sill=0.6, corner=1.0,
            surrounds=(("", 1),), heads=(("", 1),), back="",
            fins=(Strip("band_box", 0.07, 0.02, "wall", 0.78, spacing=0.8, lobby=False),),
        ),
        _CONCRETE,
        frames=_FRAMES,
    ),
    "plant": Look(
        FacadeStyle(
            "strip", 3.0, (("window_small", 1),), (("door_service", 1),), sill=9.0,
            surrounds=(("", 1),), heads=(("", 1),), back="", fins=_BOARDS,
            fixtures=(
                Fixture("louvre_bank", "bay", every=2, stretch="bay"),
                Fixture("concrete_plant", "top", tint="wall", share=0.7),
            ),
        ),
        _CONCRETE,
        frames=_FRAMES,
    ),
}  # fmt: skip

GENERATOR = Generator(
    "brutalist",
    "Brutalist block",
    Look(_COFFERED, _CONCRETE, frames=_FRAMES),
    zones=MappingProxyType(_ZONES),
    mass=masses,
    roofs=(("flat", 1.0),),
    flat=((3, "concrete", (0xA3A29E, 0x93928F)), (2, "roof_gravel", (0x7E7B75, 0x8B8780))),
    area=(140.0, 12000.0),
    levels=(2, 32),
    width=(9.0, 200.0),
    plot=(28.0, 52.0, 20.0, 30.0),
    floors=(5, 13),
    storey=3.5,
    use="public",
)


@action(
    "building/brutalist-v1",
    limits=["Only footprints of a size that admits such a building change."],
    requires=("layout",),
    labels=("brutalist", "concrete", "coffer", "terrace", "stair", "tower"),
)
def brutalist(
    city: City,
    *,
    share: Annotated[float, Range(0.0, 1.0)] = 1.0,
    floors: Annotated[int, Range(0, 32)] = 0,
    building: Annotated[str | None, ObjectName()] = None,
    form: Annotated[str, Choice("any", *FORMS)] = "any",
    reach: Annotated[float, Range(0.5, 6.0)] = 1.8,
    towers: Annotated[int, Range(0, 4)] = 2,
    noise: Annotated[float, Range(0.0, 1.0)] = 0.5,
) -> City:
    """Build brutalist blocks of raw concrete.

    Blocks that grow outwards, shift or step back over a plinth, windows deep in coffers, towers of
    stairs with slits, and heavy plant on the roof.

    Parameters
    ----------
    share
        Share of the buildings that become one.
    floors
        Storeys, 0 to keep those of each building.
    building
        The one building to change, or None for all.
    form
        How the blocks are stacked.
    reach
        Metres by which a block stands out beyond or behind the one below.
    towers
        Towers of stairs.
    noise
        How far measures vary; 0 is regular.
    """
    mass = partial(masses, form=form, reach=reach, towers=towers)
    return redesign(
        city, GENERATOR, share=share, floors=floors, building=building, mass=mass, noise=noise
    )
