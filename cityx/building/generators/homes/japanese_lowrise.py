"""Low-rise of Japanese towns: tiled boxes, set-back top floors, outdoor stairs, units, meters."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import partial
from types import MappingProxyType
from typing import Annotated

from cityx.assets.styles.facade_styles import FacadeStyle, Fixture
from cityx.assets.styles.generators import Generator, Look
from cityx.assets.styles.palette_tables import GREYS, TILES
from cityx.building.design import redesign
from cityx.building.massing.massing import Mass, Plot
from cityx.city.city import City
from cityx.geometry.parcels.lots import lot_of
from cityx.protocol import ObjectName, Range, action

LEAST = 4.6  # metres that a top floor keeps
INSIDE = 0.08  # metres between walls that stand above one another
BOARDED, KEEPERS = 0.12, 0.5  # shares of low houses of boards and, up to the second, of shops
SHED_RISE = 0.32  # rise over run of its sloping roof


def masses(plot: Plot, *, setback: float = 1.5, sloping: float = 0.5) -> tuple[Mass, ...]:
    """Draw the top floor back from the street and, at times, from one side, under a shed roof.

    Houses of boards under pitched roofs, and low shops, keep their plain volume.
    """
    lot = lot_of(plot)
    kind = plot.draw("kind") if plot.levels <= 3 and plot.noise else 1.0
    if kind < (BOARDED if plot.roof == "flat" else 0.75):
        return (replace(plot.body, zone="boarded"),)
    if kind < KEEPERS:
        return (replace(plot.body, zone="keeper"),)
    zone = plot.pick("balcony", ("", "glazed", "railed"), (3, 3, 3)) if plot.noise else ""
    body = replace(plot.body, zone=zone)
    if not lot.boxy or plot.levels < 2 or setback <= 0:
        return (body,)
    turn, back, beside, slopes, tops = plot.draws("japanese", 5)
    storey = plot.storey
    depth = setback * (0.7 + 0.6 * back)
    if lot.depth - depth < LEAST or lot.length < 3.0:
        return (body,)
    floors = 2 if plot.levels >= 5 and tops < 0.5 else 1
    level = (plot.levels - floors) * storey
    x0, x1 = -lot.x, lot.x
    if beside < 0.4 and lot.length - depth > LEAST:
        x0, x1 = (x0 + depth, x1) if turn < 0.5 else (x0, x1 - depth)
    roof, rise, down = plot.roof, plot.rise, math.nan
    if roof == "flat" and not plot.said and slopes < sloping:
        # The slant that the daylight of the street asks for.
        roof, down = "skillion", lot.compass(0.0, 1.0 if slopes < 0.7 * sloping else -1.0)
        rise = min(SHED_RISE * (lot.depth - depth), 0.42 * storey)
    foot = Mass(plot.plan, 0.0, level, zone)
    # Its walls run down inside those below, clear of them.
    x0, x1 = max(x0, -lot.x + INSIDE), min(x1, lot.x - INSIDE)
    box = (x0, -lot.y + INSIDE, x1, lot.y - depth)
    top = lot.masses([box], low=level, high=plot.height, zone="top",
                     roof=roof, rise=rise, direction=down)  # fmt: skip
    return (foot, *top) if top else (body,)


_WALLS = (
    (5, "brick", (0xCFC7B8, 0xB9B2A5, 0xA28D78, 0xD9D4C8, 0x8C7A6B, 0x9DA3A6)),
    (4, "plaster", TILES),
    (3, "metal_panel", (0x3F464E, 0x5A6166, 0xB9BCBB, 0x6A5A4E, 0x8B9AA2)),
    (1, "concrete", GREYS),
)
_FRAMES = (0x4A4440, 0x9A9C9C, 0x6E6F70, 0x2F3234, 0xD3D3D0)
_THINGS = (
    Fixture("balcony_run", "bay", "trim", first=1, last=-1, stretch="bay", street=True, share=0.7),
    Fixture("laundry", "bay", first=1, last=-1, street=True, share=0.3, scattered=True),
    Fixture("quilt", "bay", first=1, last=-1, street=True, share=0.12, scattered=True),
)
_BODY = FacadeStyle(
    "punched", 2.7, (("window_terrace", 3), ("window_slider", 4)), (("door_flat", 1),),
    sill=0.5, ground_storey=2.8, corner=0.4, scale=(0.95, 0.95),
    surrounds=(("sill_metal", 3), ("", 1)), back="sill_metal", heads=(("coping", 1),),
    cooling=0.5, pipe=True, shops=0.42,
    fixtures=(
        *_THINGS,
        Fixture("street_vending", "foot", "sign", street=True, share=0.55),
        Fixture("meter_boxes", "foot", street=True, spacing=6.0, share=0.3, scattered=True),
        Fixture("street_sign_tower", "pier", "sign", first=1, last=1, lift=0.1, street=True,
                share=0.25, scattered=True),
        Fixture("outdoor_stair", "foot", street=False, share=0.5),
        Fixture("meter_boxes", "foot", street=False, spacing=3.6, share=0.5, scattered=True),
        Fixture("outdoor_units", "foot", street=False, spacing=2.7, share=0.5, scattered=True),
        Fixture("drain_pipes", "corner", stretch="height", share=0.5, scattered=True, out=0.0),
    ),
)  # fmt: skip


def _with(balcony: str) -> FacadeStyle:
    """Return the style of the body with other balconies."""
    runs = replace(_THINGS[0], name=balcony)
    things = Fixture("balcony_things", "bay", first=1, last=-1, street=True, share=0.4,
                     scattered=True)  # fmt: skip
    green = replace(things, name="balcony_green", share=0.4)
    return replace(_BODY, fixtures=(runs, things, green, *_BODY.fixtures[1:]))


_TOP = FacadeStyle(
    "punched", 2.9, (("window_terrace", 1), ("window_slider", 1)), (("door_service", 1),),
    sill=0.3, corner=0.4, surrounds=(("", 1),), back="", heads=(("coping", 1),),
    fixtures=(Fixture("laundry", "bay", first=0, last=0, street=True, share=0.4, scattered=True),),
)  # fmt: skip

# Houses of two storeys in siding or boards: pent roofs, shutter cases, bars before windows.
_BOARDED = FacadeStyle(
    "punched", 2.4, (("window_slider", 3), ("window_terrace", 1)), (("door_flat", 1),),
    sill=0.75, ground_storey=2.8, corner=0.45, scale=(0.92, 0.95), surrounds=(("sill_metal", 1),),
    back="sill_metal", heads=(("", 1),), cooling=0.25, pipe=True, base=(("", 2), ("stone", 1)),
    fixtures=(
        Fixture("pent_roof", "bay", first=1, last=1, stretch="bay", street=True, lift=-0.2,
                share=0.6),
        Fixture("shutter_case", "window", first=1, last=-1, every=2, stretch="opening", share=0.6),
        Fixture("window_bars", "window", first=0, last=0, stretch="opening", share=0.7),
        *_BODY.fixtures[3:5],
        *_BODY.fixtures[7:],
    ),
)  # fmt: skip
_BOARDS = (
    (4, "metal_panel", (0x8E8A80, 0xA8A294, 0x5F6468, 0x7A6A5A, 0xC4BEB0, 0x4A4D50, 0x8B8F86)),
    (3, "wood", (0x6A4E38, 0x4E3C30, 0x8A6E50)),
    (3, "plaster", (0xD8D0C0, 0xC6BAA2, 0xB4A58C, 0xE0DCD2)),
)
# Shop houses: the ground floor is a shop behind a shutter, the board reaches across the front.
_KEEPER = FacadeStyle(
    "punched", 2.6, (("window_slider", 1),), (("door_flat", 1),), sill=0.8, ground_storey=3.1,
    corner=0.4, scale=(1.0, 1.0), surrounds=(("sill_metal", 1),), back="sill_metal",
    heads=(("coping", 1),), cooling=0.4, pipe=True, shops=1.0,
    fixtures=(
        Fixture("balcony_railed", "bay", "trim", first=1, last=-1, stretch="bay", street=True,
                share=0.35),
        Fixture("upright_bar", "pier", first=1, last=1, every=9, lift=0.2, street=True, share=0.3),
        Fixture("floor_sign", "pier", "sign", first=1, last=1, every=3, street=True, share=0.5),
        *_BODY.fixtures[3:4],
        *_BODY.fixtures[7:],
    ),
)  # fmt: skip

GENERATOR = Generator(
    "japanese_lowrise",
    "Japanese low-rise",
    Look(_BODY, _WALLS, frames=_FRAMES),
    zones=MappingProxyType(
        {
            "glazed": Look(_with("balcony_glazed"), _WALLS, frames=_FRAMES),
            "railed": Look(_with("balcony_railed"), _WALLS, frames=_FRAMES),
            "top": Look(_TOP, _WALLS, frames=_FRAMES, own_trim=True),
            "boarded": Look(_BOARDED, _BOARDS, frames=_FRAMES),
            "keeper": Look(_KEEPER, _WALLS, frames=_FRAMES, own_trim=True),
        }
    ),
    mass=masses,
    roofs=(("flat", 5), ("gabled", 3), ("hipped", 2)),
    pitch=(14.0, 24.0),
    pitched=((5, "roof_metal", (0x4C5256, 0x6A5A50, 0x5C6A70)),
             (4, "slate", (0x4A4E55, 0x5A5E66, 0x6A5A52))),
    flat=((6, "bitumen", (0x8A8C8A, 0x7F9488, 0x74787A, 0x6B7F78, 0x8C7A6C)),
          (2, "concrete", GREYS)),
    area=(20.0, 700.0),
    levels=(1, 6),
    plot=(7.0, 11.5, 9.0, 13.0),
    chimneys=0.0,
    floors=(2, 4),
    storey=2.9,
    use="house",
)  # fmt: skip


@action(
    "building/japanese_lowrise-v1",
    limits=[
        "Only footprints of a size that admits such a building change.",
        "Signs carry no text.",
    ],
    requires=("layout",),
    labels=("japanese", "low-rise", "house", "tile", "balcony", "tokyo", "asian"),
)
def japanese_lowrise(
    city: City,
    *,
    share: Annotated[float, Range(0.0, 1.0)] = 1.0,
    floors: Annotated[int, Range(0, 6)] = 0,
    building: Annotated[str | None, ObjectName()] = None,
    setback: Annotated[float, Range(0.0, 4.0)] = 1.5,
    sloping: Annotated[float, Range(0.0, 1.0)] = 0.5,
    noise: Annotated[float, Range(0.0, 1.0)] = 0.5,
) -> City:
    """Build the small mixed houses of Japanese towns.

    Tiled or metal-clad boxes of two to four storeys with the top floor set back, balconies with
    washing, an outdoor stair, cooling units, meters, vertical signs and vending machines.

    Parameters
    ----------
    share
        Share of the buildings that become one.
    floors
        Storeys, 0 to keep those of each building.
    building
        The one building to change, or None for all.
    setback
        Metres by which the top floor stands back; 0 leaves it on the wall below.
    sloping
        Share of the level roofs that slope instead, for the daylight of the street.
    noise
        How far measures vary; 0 makes all alike.
    """
    mass = partial(masses, setback=setback, sloping=sloping)
    return redesign(
        city, GENERATOR, share=share, floors=floors, building=building, mass=mass, noise=noise
    )
