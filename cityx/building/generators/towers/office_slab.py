"""Office slabs: ribbon windows behind sun blades, blind cores of stairs, plant on the roof."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from types import MappingProxyType
from typing import Annotated

from cityx.assets.styles.facade_styles import FacadeStyle, Fixture, Strip
from cityx.assets.styles.generators import Generator, Look
from cityx.assets.styles.palette_tables import GREYS
from cityx.building.design import redesign
from cityx.building.massing.massing import Mass, Plot, pieces
from cityx.building.massing.rules import banded
from cityx.city.city import City
from cityx.protocol import Choice, ObjectName, Range, action

CORES = ("end", "middle", "ends", "none")
SUNS = ("", "fins", "blades", "crates")
LEAST = 11.0  # metres of width under which a building is a plain bar
DEEP = 27.0  # metres of width from which a slab is two bars with a link


def masses(
    plot: Plot, *, core: str = "any", bar: float = 16.0, recess: float = 1.2
) -> tuple[Mass, ...]:
    """Raise bars of offices and the cores that serve them over a lobby."""
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


_WALLS = (
    (4, "concrete", GREYS),
    (4, "stone", (0xBDB4A4, 0xA79E90, 0xC9C3B8, 0x8F8A82)),
    (2, "metal_panel", (0x9DA1A3, 0x7C8083, 0xB5B3AC, 0x6C7F86)),
    (1, "brick", (0x8B7B6C, 0x9C6B52)),
)
_FRAMES = (0x4A4D50, 0x6E7173, 0x383A3D, 0xB4B5B4)
_RIBBON = FacadeStyle(
    "strip", 3.1, (("window_strip", 3), ("window_office", 2)), (("door_lobby", 1),),
    sill=0.85, ground_storey=3.6, corner=0.3, scale=(1.0, 1.15), surrounds=(("", 1),),
    heads=(("coping", 1),), back="",
    slabs=(Strip("band_box", 0.12, 0.06, "wall", 0.8, share=0.6),),
)  # fmt: skip
_BLIND = ((3, "concrete", (0x93928F, 0xA3A29E)), (3, "brick", (0x7C4F3E, 0x6D5A50, 0x8B7B6C)),
          (2, "stone", (0x5E5A56, 0x8F8A82)))  # fmt: skip
_ZONES = {
    "fins": Look(
        replace(
            _RIBBON,
            fins=(Strip("band_box", 0.14, 0.62, "trim", 0.95, spacing=1.55),),
            slabs=(Strip("band_box", 0.3, 0.66, "trim", 0.9),),
        ),
        _WALLS,
        frames=_FRAMES,
    ),
    "blades": Look(
        replace(_RIBBON, fixtures=(Fixture("sun_blade", "bay", last=-1, stretch="bay"),)),
        _WALLS,
        frames=_FRAMES,
    ),
    "crates": Look(
        replace(
            _RIBBON,
            windows=(("window_deep", 1),),
            fins=(Strip("band_box", 0.32, 0.8, "wall", 1.08),),
            slabs=(Strip("band_box", 0.42, 0.8, "wall", 1.02),),
        ),
        (_WALLS[0], (2, "plaster", (0xE2E0DB, 0xDAD2C4))),
        frames=_FRAMES,
    ),
    "lobby": Look(
        FacadeStyle(
            "strip", 3.1, (("window_deep", 1),), (("door_lobby", 1),), sill=0.35,
            ground_storey=4.0, corner=0.3, scale=(1.0, 1.5), surrounds=(("", 1),),
            heads=(("coping", 1),), back="",
            fins=(Strip("band_box", 0.5, 0.12, "wall", 0.8, every=2, lobby=False),),
        ),
        ((3, "stone", (0x5E5A56, 0x77726B, 0x8F8A82)), (2, "concrete", GREYS)),
        frames=_FRAMES,
    ),
    "core": Look(
        FacadeStyle(
            "punched", 3.4, (("window_slit", 1),), (("door_service", 1),), sill=0.7, corner=1.2,
            surrounds=(("", 1),), heads=(("coping", 1),), back="",
            slabs=(Strip("band_box", 0.05, 0.015, "wall", 0.7),),
        ),
        _BLIND,
        frames=_FRAMES,
    ),
    "plant": Look(
        FacadeStyle(
            "strip", 2.6, (("window_small", 1),), (("door_service", 1),), sill=9.0,
            surrounds=(("", 1),), heads=(("", 1),), back="",
            fixtures=(Fixture("louvre_bank", "bay", stretch="bay", before=True),),
        ),
        ((1, "metal_panel", (0x84888A, 0x6E7276, 0xA0A3A2)),),
        frames=_FRAMES,
    ),
}  # fmt: skip

GENERATOR = Generator(
    "office_slab",
    "Office slab",
    Look(_RIBBON, _WALLS, frames=_FRAMES),
    zones=MappingProxyType(_ZONES),
    mass=masses,
    roofs=(("flat", 1.0),),
    area=(80.0, 20000.0),
    levels=(2, 30),
    plot=(30.0, 64.0, 15.0, 24.0),
    floors=(5, 13),
    storey=3.5,
    use="office",
)


@action(
    "building/office_slab-v1",
    limits=["Only footprints of a size that admits such a building change."],
    requires=("layout",),
    labels=("office", "slab", "ribbon", "windows", "brise-soleil", "bar"),
)
def office_slab(
    city: City,
    *,
    share: Annotated[float, Range(0.0, 1.0)] = 1.0,
    floors: Annotated[int, Range(0, 30)] = 0,
    building: Annotated[str | None, ObjectName()] = None,
    core: Annotated[str, Choice("any", *CORES)] = "any",
    bar: Annotated[float, Range(9.0, 30.0)] = 16.0,
    recess: Annotated[float, Range(0.4, 4.0)] = 1.2,
    noise: Annotated[float, Range(0.0, 1.0)] = 0.5,
) -> City:
    """Build slabs of offices with bands of windows behind fins, blades or crates.

    A bar over a dark lobby, blind cores of stairs that stand out and above it, and a house for the
    plant; deep plots get two bars of unequal height.

    Parameters
    ----------
    share
        Share of the buildings that become one.
    floors
        Storeys, 0 to keep those of each building.
    building
        The one building to change, or None for all.
    core
        Where the stairs stand along the bar.
    bar
        Metres of the width of a bar where there is room for two.
    recess
        Metres that the cores stand out.
    noise
        How far measures vary; 0 is regular.
    """
    mass = partial(masses, core=core, bar=bar, recess=recess)
    return redesign(
        city, GENERATOR, share=share, floors=floors, building=building, mass=mass, noise=noise
    )
