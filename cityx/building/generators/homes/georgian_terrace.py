"""Georgian terraces: narrow brick houses of London, wall to wall, their roofs behind parapets."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from types import MappingProxyType
from typing import Annotated

import shapely

from cityx.assets.styles.facade_styles import FacadeStyle, Fixture, Strip
from cityx.assets.styles.generators import Generator, Look
from cityx.assets.styles.palette_tables import STOCK
from cityx.building.design import redesign
from cityx.building.massing.massing import Mass, Plot, carve, site_of
from cityx.city.city import City
from cityx.protocol import Choice, ObjectName, Range, action

ROOFS = ("butterfly", "mansard", "flat")
SCREEN = 0.9  # metres of depth of the front wall that stands up as a parapet
VALLEY = 1.25  # metres from the valley of a London roof to its edges
GRAND = 0.35  # share of terraces of stucco all over


def masses(
    plot: Plot, *, roof: str = "any", closet: float = 0.6, parapet: float = 0.9
) -> tuple[Mass, ...]:
    """Hide a roof with a valley behind the front's parapet, and add a closet wing at the back."""
    zone = "stucco" if plot.draw("grand") < GRAND else ""
    body = replace(plot.body, zone=zone)
    if plot.said or plot.levels < 2:
        return (body,)
    eave = plot.height - plot.rise
    word = plot.pick("london roof", ROOFS, (4, 3, 2)) if roof == "any" else roof
    site = site_of(plot)
    x, y = site.half
    if min(x, y) < 2.2 or plot.plan.area < 2.8 * x * y:
        return (replace(body, high=eave, roof="flat", rise=0.0),)
    rest = site.plan
    found: list[Mass] = []
    if 2 * y > 8.5 and 2 * x < 12.0 and plot.draw("closet") < closet:
        deep = plot.between("closet depth", 2.2, 3.2)
        back, rest = carve(rest, shapely.box(-2 * x, -2 * y, 2 * x, deep - y))
        side = shapely.box(0.06 * x, -2 * y, 2 * x, 2 * y)
        tall, low = carve(back, side)
        found += site.masses(tall, 0.0, eave - plot.storey, "closet", "skillion", 0.5,
                             down=(0.0, -1.0))  # fmt: skip
        found += site.masses(low, 0.0, plot.storey, "closet")
    if word == "butterfly":
        front, rest = carve(rest, shapely.box(-2 * x, y - SCREEN, 2 * x, 2 * y))
        found += site.masses(front, 0.0, eave + parapet, zone)
        found += site.masses(rest, 0.0, eave + 0.75 * parapet, "behind", "butterfly",
                             min(VALLEY, 0.3 * x), down=(1.0, 0.0))  # fmt: skip
    elif word == "mansard":
        rise = min(max(plot.rise, 2.6), 3.4)
        found += site.masses(rest, 0.0, eave + rise, zone, "mansard", rise)
    else:
        found += site.masses(rest, 0.0, eave + parapet, zone)
    return tuple(found)


_BRICK = ((8, "brick", (*STOCK, 0x6E5646, 0x84705A)), (1, "plaster", (0xE6E1D5, 0xDAD3C2)))
_STUCCO = ((1, "plaster", (0xEDE9DF, 0xE6E1D5, 0xE9E6DF, 0xE2D6BF, 0xDDE0E2)),)
_FRAMES = (0xF0EFEC, 0xEDEBE6, 0xF2F1EE, 0xF2F1EE)
_FRONT = FacadeStyle(
    "punched", 2.25, (("window_georgian", 1),), (("door_fanlight", 1),), sill=0.75,
    ground_storey=3.7, corner=0.4, surrounds=(("surround_lintel", 5), ("surround_block", 2)),
    heads=(("coping", 3), ("cornice", 3)), string=1.0, base=(("stone", 5), ("", 2)), pipe=True,
    slabs=(Strip("band_box", 0.18, 0.05, "trim", every=2, share=0.5),),
    fixtures=(
        Fixture("area_rails", "foot", spacing=1.5, street=True, share=0.8),
        Fixture("fanlight_frame", "door", tint="trim"),
        Fixture("stucco_porch", "door", tint="trim", share=0.35),
        Fixture("regency_balcony", "window", first=1, last=1, stretch="opening", street=True,
                share=0.55),
        Fixture("party_stack", "side", spacing=7.0),
    ),
)  # fmt: skip
_GRAND = replace(
    _FRONT, surrounds=(("surround_cap", 2), ("surround_pediment", 3)), heads=(("cornice", 1),),
    quoins=0.5,
    fixtures=(
        Fixture("area_rails", "foot", spacing=1.5, street=True),
        Fixture("fanlight_frame", "door", tint="trim"),
        Fixture("stucco_porch", "door", tint="trim"),
        Fixture("regency_balcony", "window", first=1, last=1, stretch="opening", street=True),
        Fixture("regency_canopy", "window", first=1, last=1, stretch="opening", street=True,
                share=0.35),
        Fixture("roof_balustrade", "head", tint="trim", stretch="bay", street=True, lift=-0.1,
                share=0.6),
        Fixture("party_stack", "side", spacing=7.0),
    ),
)  # fmt: skip
_BEHIND = replace(_FRONT, heads=(("", 1),), fixtures=(Fixture("party_stack", "side", spacing=7.0),))

GENERATOR = Generator(
    "georgian_terrace",
    "Georgian terrace",
    Look(_FRONT, _BRICK, frames=_FRAMES, bricks=True, old=True),
    zones=MappingProxyType(
        {
            "stucco": Look(_GRAND, _STUCCO, frames=_FRAMES, own_trim=True, old=True),
            "behind": Look(_BEHIND, _BRICK, frames=_FRAMES, bricks=True),
            "closet": Look(replace(_BEHIND, fixtures=()), _BRICK, frames=_FRAMES, bricks=True),
        }
    ),
    mass=masses,
    roofs=(("mansard", 1),),
    pitch=(38.0, 46.0),
    pitched=((1, "slate", (0x50545A, 0x5C6064, 0x474A50, 0x66676A)),),
    area=(30.0, 2500.0),
    levels=(2, 7),
    plot=(5.5, 8.0, 9.0, 13.0),
    floors=(3, 4),
    storey=3.2,
    use="terrace",
)  # fmt: skip


@action(
    "building/georgian_terrace-v1",
    limits=["Only footprints of a size that admits such a building change."],
    requires=("layout",),
    labels=("terrace", "georgian", "victorian", "brick", "row", "london"),
)
def georgian_terrace(
    city: City,
    *,
    share: Annotated[float, Range(0.0, 1.0)] = 1.0,
    floors: Annotated[int, Range(0, 7)] = 0,
    building: Annotated[str | None, ObjectName()] = None,
    roof: Annotated[str, Choice("any", *ROOFS)] = "any",
    parapet: Annotated[float, Range(0.4, 1.6)] = 0.9,
    closet: Annotated[float, Range(0.0, 1.0)] = 0.6,
    noise: Annotated[float, Range(0.0, 1.0)] = 0.5,
) -> City:
    """Build Georgian terraces of London.

    Narrow houses of stock brick or stucco: small-paned sashes, a door under a fanlight, railings
    before the area, iron balconies, a parapet before a roof with a valley, chimney stacks on the
    party walls.

    Parameters
    ----------
    share
        Share of the buildings that become one.
    floors
        Storeys, 0 to keep those of each building.
    building
        The one building to change, or None for all.
    roof
        Roof behind the parapet.
    parapet
        Metres of the parapet above the last ceiling.
    closet
        Share of houses with a narrow wing at the back.
    noise
        How far measures vary; 0 is regular.
    """
    mass = partial(masses, roof=roof, parapet=parapet, closet=closet)
    return redesign(
        city, GENERATOR, share=share, floors=floors, building=building, mass=mass, noise=noise
    )
