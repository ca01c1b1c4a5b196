"""Town halls: a symmetric front with an arcade, a clock tower under a spire or a dome, gables."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from types import MappingProxyType
from typing import Annotated, Any

import shapely

from cityx.assets.styles.facade_styles import FacadeStyle, Fixture, Strip
from cityx.assets.styles.generators import Generator, Look
from cityx.assets.styles.palette_tables import STONES
from cityx.building.design import redesign
from cityx.building.massing.massing import Mass, Plot, Site, carve, disc, grow, site_of
from cityx.building.massing.rules import courtyard
from cityx.city.city import City
from cityx.protocol import Choice, ObjectName, Range, action

TOPS = ("spire", "dome", "battlement", "helm")
LEAST = 13.0  # metres of front, and 9 of depth, under which there is no room for a tower
INSET = 0.2  # metres that each stage of the tower stands back
PORCH = 1.2  # storeys of its lowest stage, with the great door
STEEP = 8.5  # metres; the highest roof of the body


def masses(
    plot: Plot, *, tower: float = 2.1, top: str = "any", pavilions: bool = True,
    wing: float = 15.0,
) -> tuple[Mass, ...]:  # fmt: skip
    """Set a tower into the middle of the front, and pavilions at its ends."""
    site = site_of(plot)
    x, y = site.half
    rise = plot.rise if plot.said else min(plot.rise, STEEP)
    eave = plot.height - plot.rise
    body = replace(plot.body, high=eave + rise, rise=rise)
    if 2 * x < LEAST or 2 * y < 9.0 or plot.plan.area < 2.2 * x * y:
        return (body,)
    rest: Any = site.plan
    found: list[Mass] = []
    side = min(max(plot.between("tower side", 0.15, 0.2) * 2 * x, 4.8), 9.5, 0.6 * 2 * y)
    if tower > 0:
        square = shapely.box(-side / 2, y - side, side / 2, y)
        inside, left = carve(rest, square)
        if inside.area > 0.97 * square.area:
            rest = left
            word = plot.pick("tower top", TOPS, (4, 3, 2, 3)) if top == "any" else top
            found += _tower(site, plot, inside, side, eave, rise, tower, word)
    wide = min(max(0.15 * 2 * x, 5.6), 10.0)
    if pavilions and 2 * x > side + 2 * wide + 8.0:
        for x0, x1 in ((-2 * x, wide - x), (x - wide, 2 * x)):
            end, rest = carve(rest, shapely.box(x0, -2 * y, x1, 2 * y))
            roof = "flat" if body.roof == "flat" else "mansard"
            up = 1.12 * rise
            found += site.masses(end, 0.0, eave + up, "pavilion", roof, up)
    for mass in site.masses(rest, 0.0, body.high, "", body.roof, body.rise):
        if mass.plan.area > 600.0:
            found += grow(plot, {"lot": courtyard(wing)}, depth=1, axiom=mass)
        else:
            found.append(mass)
    return tuple(found)


def _tower(
    site: Site, plot: Plot, inside: Any, side: float, eave: float, rise: float, tall: float,
    top: str,
) -> Sequence[Mass]:  # fmt: skip
    """Raise a tower in stages: entrance, shaft, clock, and what crowns it."""
    middle = inside.centroid
    total = max(plot.waver("tower", tall, plot.body) * eave, eave + rise + 1.6 * side)
    clock = max(0.95 * side, 4.2)
    shaft = max(total - clock, eave + rise + 1.0)
    porch = min(PORCH * plot.storey, 0.5 * eave)
    stages = [shapely.buffer(inside, -number * INSET, join_style="mitre") for number in range(4)]
    found = site.masses(stages[0], 0.0, porch, "porch")
    found += site.masses(stages[1], porch, eave, "entrance")
    found += site.masses(stages[2], eave, shaft, "shaft")
    upper = stages[3]
    if top == "battlement":
        found += site.masses(upper, shaft, shaft + clock, "belfry")
        turret = disc(middle.x, middle.y, 0.26 * side, 8)
        at = shaft + clock
        return [*found, *site.masses(turret, at, at + 1.3 * side, "lantern", "pyramidal",
                                     0.8 * side)]  # fmt: skip
    if top == "helm":
        high = 1.25 * side
        found += site.masses(upper, shaft, shaft + clock + high, "clock", "pyramidal", high)
        return found
    found += site.masses(upper, shaft, shaft + clock, "clock")
    at = shaft + clock
    if top == "dome":
        drum = disc(middle.x, middle.y, 0.4 * side, 12)
        swell = 0.42 * side
        lantern = disc(middle.x, middle.y, 0.13 * side, 8)
        low = at + 0.28 * side + swell
        return [
            *found,
            *site.masses(drum, at, low, "lantern", "dome", swell),
            *site.masses(lantern, low, low + 0.6 * side, "tip", "onion", 0.34 * side),
        ]
    octagon = disc(middle.x, middle.y, 0.37 * side, 8)
    foot = at + 0.5 * side
    spire = 1.7 * side
    return [*found, *site.masses(octagon, at, foot + spire, "lantern", "pyramidal", spire)]


_WALLS = (
    (6, "stone", (*STONES, 0xBFA988, 0xB59A7C)),
    (4, "brick", (0x8C4A3A, 0x96543F, 0x7C4234, 0x86503E)),
    (2, "plaster", (0xDACBA4, 0xDAD3C8, 0xC2A593)),
)
_FRAMES = (0x3A3D40, 0x4A3A30, 0xE8E4DA, 0x38463F)
_FRONT = FacadeStyle(
    "punched", 3.1, (("window_mullioned", 1),), (("door_double", 1),), sill=0.8,
    ground_storey=5.0, corner=0.7, surrounds=(("", 1),), back="surround_block",
    heads=(("cornice", 1),), string=1.0, base=(("stone", 1),), quoins=1.0,
    slabs=(Strip("band_box", 0.2, 0.14, "trim"),),
    fixtures=(
        Fixture("hall_arcade", "bay", tint="trim", stretch="bay", street=True, before=True,
                share=0.75),
        Fixture("roof_balustrade", "head", tint="trim", stretch="bay", street=True, share=0.6),
        Fixture("palace_modillions", "head", tint="trim", stretch="bay", street=True, share=0.5),
        Fixture("front_flag", "pier", first=1, last=1, every=3, lift=0.9, street=True, share=0.7),
    ),
)  # fmt: skip
_PAVILION = replace(
    _FRONT, bay=2.6,
    fixtures=(
        Fixture("hall_gable", "edge", tint="trim", street=True, share=0.6),
        Fixture("hall_saddle", "edge", street=True, share=0.6),
        Fixture("palace_aedicule", "window", tint="trim", first=1, last=1, stretch="opening",
                street=True),
        Fixture("roof_crest", "top", stretch="along", share=0.6),
    ),
)  # fmt: skip
_SHAFT = FacadeStyle(
    "nave", 3.0, (("window_lancet", 1),), (("door_gothic", 1),), scale=(0.0, 1.0), back="",
    surrounds=(("", 1),), heads=(("", 1),), quoins=1.0,
    fixtures=(Fixture("tower_lights", "edge", tint="trim", lift=-0.5),),
)  # fmt: skip
_CLOCK = FacadeStyle(
    "nave", 3.0, (("window_belfry", 1),), (("door_gothic", 1),), scale=(0.0, 1.0), back="",
    surrounds=(("", 1),), heads=(("cornice", 1),), quoins=1.0,
    fixtures=(Fixture("great_clock", "edge", tint="", lift=-2.6),),
)  # fmt: skip


def _look(facade: FacadeStyle) -> Look:
    return Look(facade, _WALLS, frames=_FRAMES, own_trim=False, bricks=True)


_BELFRY = replace(
    _CLOCK,
    fixtures=(
        *_CLOCK.fixtures,
        Fixture("tower_turret", "corner", tint="trim", stretch="", lift=0.0),
        Fixture("roof_balustrade", "edge", tint="trim", spacing=1.0),
    ),
)
_TIP = replace(_CLOCK, heads=(("", 1),), fixtures=(Fixture("spire_vane", "top"),), quoins=0.0)
_LANTERN = FacadeStyle(
    "punched", 1.5, (("window_belfry", 1),), (("door_gothic", 1),), scale=(0.6, 0.7), sill=0.4,
    back="", surrounds=(("", 1),), heads=(("cornice", 1),), corner=0.1,
    fixtures=(Fixture("spire_vane", "top"),),
)  # fmt: skip

GENERATOR = Generator(
    "townhall",
    "Town hall",
    _look(_FRONT),
    zones=MappingProxyType(
        {
            "pavilion": _look(_PAVILION),
            "entrance": _look(
                replace(
                    _FRONT, bay=2.8,
                    fixtures=(
                        Fixture("palace_aedicule", "window", tint="trim", first=1, last=-1,
                                stretch="opening", street=True),
                        Fixture("front_flag", "pier", first=1, last=1, lift=0.9, street=True),
                    ),
                )
            ),
            "porch": _look(
                replace(
                    _SHAFT, heads=(("cornice", 1),),
                    fixtures=(
                        Fixture("council_frame", "foot", tint="trim", out=0.06, street=True),
                        Fixture("council_leaves", "foot", tint="accent", street=True),
                        Fixture("council_steps", "foot", street=True),
                    ),
                )
            ),
            "shaft": _look(_SHAFT),
            "clock": _look(_CLOCK),
            "belfry": _look(_BELFRY),
            "lantern": _look(_LANTERN),
            "tip": _look(_TIP),
            "yard": _look(
                FacadeStyle("punched", 3.0, (("window_small", 1),), (("door_service", 1),))
            ),
        }
    ),
    mass=masses,
    roofs=(("hipped", 3), ("mansard", 2)),
    pitch=(44.0, 52.0),
    pitched=(
        (4, "slate", (0x50545A, 0x5C6064, 0x474A50)),
        (3, "copper", (0xFFFFFF,)),
        (2, "roof_tiles", (0x8E4B36, 0x7B4434)),
    ),
    area=(150.0, 9000.0),
    levels=(2, 7),
    width=(10.0, 90.0),
    plot=(32.0, 52.0, 16.0, 24.0),
    floors=(3, 4),
    storey=4.3,
    use="townhall",
)  # fmt: skip


@action(
    "building/townhall-v1",
    limits=["Only footprints of a size that admits such a building change."],
    requires=("layout",),
    labels=("town hall", "city hall", "clock tower", "council", "civic", "arcade"),
)
def townhall(
    city: City,
    *,
    share: Annotated[float, Range(0.0, 1.0)] = 1.0,
    floors: Annotated[int, Range(0, 7)] = 0,
    building: Annotated[str | None, ObjectName()] = None,
    tower: Annotated[float, Range(0.0, 4.0)] = 2.1,
    top: Annotated[str, Choice("any", *TOPS)] = "any",
    pavilions: bool = True,
    noise: Annotated[float, Range(0.0, 1.0)] = 0.5,
) -> City:
    """Build town halls with a clock tower in the middle of a symmetric front.

    An arcade along the ground floor, tall windows with stone crosses, a balustrade, pavilions with
    ornate gables, flags, and a tower with clocks under a spire, a dome, a helm or battlements.

    Parameters
    ----------
    share
        Share of the buildings that become one.
    floors
        Storeys, 0 to keep those of each building.
    building
        The one building to change, or None for all.
    tower
        Height of the tower relative to the walls of the body; 0 leaves it out.
    top
        What crowns the tower.
    pavilions
        Whether the ends of long fronts have roofs of their own.
    noise
        How far measures vary; 0 is regular.
    """
    mass = partial(masses, tower=tower, top=top, pavilions=pavilions)
    return redesign(
        city, GENERATOR, share=share, floors=floors, building=building, mass=mass, noise=noise
    )
