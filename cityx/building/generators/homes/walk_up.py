"""Brick walk-ups: American tenements and row houses, with stoops, fire escapes, metal cornices."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from types import MappingProxyType
from typing import Annotated

import shapely

from cityx.assets.styles.facade_styles import FacadeStyle, Fixture, Strip
from cityx.assets.styles.generators import Generator, Look
from cityx.assets.styles.palette_tables import REDS, STOCK
from cityx.building.design import redesign
from cityx.building.massing.massing import Mass, Plot, carve, site_of
from cityx.city.city import City
from cityx.protocol import Choice, ObjectName, Range, action

FRONTS = ("tenement", "brownstone", "flats")
DEEP = 12.0  # metres from which rooms in the middle need a shaft


def masses(plot: Plot, *, front: str = "any", shaft: float = 1.6) -> tuple[Mass, ...]:
    """Cut light shafts into both sides of a deep plan, above the ground floor: a dumbbell."""
    low = plot.levels <= 5  # brownstones are houses
    zone = plot.pick("front", FRONTS, (4, 3 * low, 3)) if front == "any" else front
    zone = "" if zone == "flats" else zone
    body = replace(plot.body, zone=zone)
    site = site_of(plot)
    x, y = site.half
    if 2 * y < DEEP or 2 * x < 7.0 or plot.levels < 3 or shaft <= 0 or plot.plan.interiors:
        return (body,)
    return _dumbbell(plot, body, shaft)


def _dumbbell(plot: Plot, body: Mass, shaft: float) -> tuple[Mass, ...]:
    site = site_of(plot)
    x, y = site.half
    wide = min(plot.waver("shaft", shaft, body), 0.22 * 2 * x)
    long = plot.between("shaft length", 0.26, 0.36) * 2 * y
    middle = plot.between("shaft at", -0.1, 0.06) * 2 * y
    rest, found = site.plan, list[Mass]()
    for x0, x1 in _spans(x, wide):
        inside, rest = carve(rest, shapely.box(x0, middle - long / 2, x1, middle + long / 2))
        found += site.masses(inside, 0.0, plot.storey, "shaft")
    grown = site.masses(rest, 0.0, body.high, body.zone, body.roof, body.rise)
    return (*grown, *found)


def _spans(half: float, wide: float) -> Sequence[tuple[float, float]]:
    return [(-2 * half, wide - half), (half - wide, 2 * half)]


_WALLS = ((9, "brick", (*REDS, *STOCK[3:6], 0x8A5A48)), (1, "brick", (0xB8A27C, 0xC2AE88)))
_BROWN = ((3, "stone", (0x7A5646, 0x8A6654, 0x6E4E40, 0x94745E)), (2, "brick", REDS[:4]),
          (1, "stone", (0xB8AC97, 0xA89F8F)))  # fmt: skip
_FRAMES = (0x2F3234, 0xE8E6E1, 0x4A3A30, 0x38463F, 0x5A2E28)
_COMMON = (
    Fixture("stoop_frame", "door", tint="trim"),
    Fixture("stoop_steps", "door"),
    Fixture("metal_cornice", "edge", tint="accent", stretch="round", lift=-0.3, street=True),
    Fixture("metal_bracket", "edge", tint="accent", spacing=0.85, lift=-0.3, street=True),
)
_FRONT = FacadeStyle(
    "punched", 2.5, (("window_tenement", 1),), (("door_stoop", 1),), sill=0.8,
    ground_storey=3.9, corner=0.5, surrounds=(("surround_block", 4), ("surround_lintel", 3)),
    heads=(("coping", 1),), string=0.8, base=(("stone", 2), ("paint", 2), ("", 3)), cooling=0.06,
    fixtures=(*_COMMON, Fixture("wood_tank", "top", share=0.25)),
)  # fmt: skip
_TENEMENT = replace(
    _FRONT,
    slabs=(Strip("band_box", 0.14, 0.05, "trim", share=0.5),),
    fixtures=(
        *_COMMON,
        Fixture("escape_left", "bay", first=1, last=-2, floors=2, every=4, stretch="storey",
                street=True),
        Fixture("escape_right", "bay", first=2, last=-2, floors=2, every=4, stretch="storey",
                street=True),
        Fixture("escape_top", "bay", first=-1, last=-1, every=4, stretch="storey", street=True),
        Fixture("escape_drop", "bay", first=1, last=1, every=4, street=True),
        Fixture("wood_tank", "top", share=0.3),
    ),
)  # fmt: skip
_BROWNSTONE = replace(
    _FRONT, bay=2.2, base=(("stone", 1),),
    surrounds=(("surround_cap", 3), ("surround_pediment", 2)), cooling=0.0,
    fixtures=(*_COMMON, Fixture("stucco_garland", "window", tint="trim", first=1, last=-1,
                                 stretch="opening", street=True, share=0.4)),
)  # fmt: skip

GENERATOR = Generator(
    "walk_up",
    "Brick walk-up",
    Look(_FRONT, _WALLS, frames=_FRAMES, bricks=True, old=True),
    zones=MappingProxyType(
        {
            "tenement": Look(_TENEMENT, _WALLS, frames=_FRAMES, bricks=True, old=True),
            "brownstone": Look(_BROWNSTONE, _BROWN, frames=_FRAMES, own_trim=True, bricks=True,
                               old=True),
            "shaft": Look(FacadeStyle("punched", 3.0, (("window_small", 1),),
                                      (("door_service", 1),)), _WALLS, frames=_FRAMES),
        }
    ),
    mass=masses,
    roofs=(("flat", 1.0),),
    area=(50.0, 4000.0),
    levels=(2, 9),
    plot=(7.6, 18.0, 14.0, 20.0),
    floors=(4, 6),
    storey=3.3,
    use="apartments",
)  # fmt: skip


@action(
    "building/walk_up-v1",
    limits=["Only footprints of a size that admits such a building change."],
    requires=("layout",),
    labels=("walk-up", "tenement", "brick", "brownstone", "fire escape", "new york", "american"),
)
def walk_up(
    city: City,
    *,
    share: Annotated[float, Range(0.0, 1.0)] = 1.0,
    floors: Annotated[int, Range(0, 9)] = 0,
    building: Annotated[str | None, ObjectName()] = None,
    front: Annotated[str, Choice("any", *FRONTS)] = "any",
    shaft: Annotated[float, Range(0.0, 4.0)] = 1.6,
    noise: Annotated[float, Range(0.0, 1.0)] = 0.5,
) -> City:
    """Build American walk-ups of brick and brownstone.

    A stoop to a raised ground floor, fire escapes that zigzag over the front, a cornice of pressed
    metal on brackets, water tanks, and light shafts that make a dumbbell of a deep plan.

    Parameters
    ----------
    share
        Share of the buildings that become one.
    floors
        Storeys, 0 to keep those of each building.
    building
        The one building to change, or None for all.
    front
        Tenements have fire escapes, brownstones dressed stone and a stoop.
    shaft
        Metres of depth of the light shafts, 0 for none.
    noise
        How far measures vary; 0 is regular.
    """
    mass = partial(masses, front=front, shaft=shaft)
    return redesign(
        city, GENERATOR, share=share, floors=floors, building=building, mass=mass, noise=noise
    )
