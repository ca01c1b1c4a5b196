"""Mid-rise of Japanese towns: flats behind balconies, narrow houses of tenants, tiled offices."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from types import MappingProxyType
from typing import Annotated

from cityx.assets.fixtures.japan import UPRIGHT
from cityx.assets.styles.facade_styles import FacadeStyle, Fixture, Strip
from cityx.assets.styles.generators import Generator, Look
from cityx.assets.styles.palette_tables import GREYS, TILES, Surfaces
from cityx.building.design import redesign
from cityx.building.massing.massing import Mass, Plot
from cityx.city.city import City
from cityx.geometry.parcels.lots import lot_of
from cityx.protocol import Choice, ObjectName, Range, action

FRONTS = ("parapet", "glazed", "railed", "tenants", "ribbon", "tiled")
# Of large plots with flats, and of narrow ones in trading streets.
WIDE, NARROW = (4, 3, 3, 0.8, 1.2, 2), (1.2, 0.8, 0.8, 5, 1.5, 3)
NARROW_AREA = 170.0  # square metres
LEAST = 5.0  # metres that a set-back top keeps
INSIDE = 0.08  # metres between walls that stand above one another


def masses(plot: Plot, *, front: str = "any", setback: float = 0.4) -> tuple[Mass, ...]:
    """Raise a block behind one of `FRONTS`; at times its top storeys stand back from the street."""
    shares = NARROW if plot.plan.area < NARROW_AREA else WIDE
    usual = plot.pick("front", FRONTS, shares) if plot.noise else FRONTS[0]
    zone = usual if front == "any" else front
    zone = "" if zone == "parapet" else zone
    body = replace(plot.body, zone=zone)
    lot = lot_of(plot)
    stepped, back, floors = plot.draws("midrise", 3)
    depth = 1.4 + 1.6 * back
    if not lot.boxy or plot.levels < 4 or lot.depth - depth < LEAST or stepped >= setback:
        return (body,)
    # The slant that the daylight of the street asks for.
    level = plot.height - (2 if floors < 0.35 and plot.levels > 5 else 1) * plot.storey
    box = (-lot.x + INSIDE, -lot.y + INSIDE, lot.x - INSIDE, lot.y - depth)
    top = lot.masses([box], low=level, high=plot.height, zone=zone)
    return (Mass(plot.plan, 0.0, level, zone), *top) if top else (body,)


_TILED = (
    (5, "brick", (0xCFC7B8, 0xB9B2A5, 0x8A6A55, 0xD9D4C8, 0x7A5547, 0x9DA3A6, 0xC8B8A0, 0x6A5248)),
    (3, "plaster", TILES),
    (1, "concrete", GREYS),
)
_FACED = (
    (4, "plaster", TILES), (3, "brick", (0xCFC7B8, 0x8C7A6B, 0x5C5350, 0xB0A696)),
    (3, "concrete", GREYS), (2, "metal_panel", (0x3F464E, 0x5A6166, 0xB9BCBB, 0x8B9AA2)),
)  # fmt: skip
_FRAMES = (0x9A9C9C, 0x6E6F70, 0x4A4440, 0xB8B8B5, 0x2F3234)


def _flats(balcony: str) -> FacadeStyle:
    """Divide a front of flats: sliding doors to balconies that run on from flat to flat."""
    return FacadeStyle(
        "punched", 2.9, (("window_terrace", 1),), (("door_lobby", 1),), sill=0.2,
        ground_storey=3.1, corner=0.3, scale=(1.0, 1.0), surrounds=(("", 1),), back="sill_metal",
        heads=(("coping", 1),), base=(("stone", 2), ("", 1)), shops=0.3,
        fixtures=(
            Fixture(balcony, "bay", "trim", first=1, last=-1, stretch="bay", street=True),
            Fixture("balcony_things", "bay", first=1, last=-1, street=True, share=0.6,
                    scattered=True),
            Fixture("balcony_green", "bay", first=1, last=-1, street=True, share=0.4,
                    scattered=True),
            Fixture("laundry", "bay", first=1, last=-1, street=True, share=0.22, scattered=True),
            Fixture("quilt", "bay", first=1, last=-1, street=True, share=0.1, scattered=True),
            Fixture("stair_flight", "bay", first=0, last=-2, every=5, stretch="storey",
                    street=False, share=0.5),
            Fixture("outdoor_units", "foot", street=False, spacing=3.2, share=0.4, scattered=True),
            Fixture("drain_pipes", "corner", stretch="height", share=0.7, scattered=True),
        ),
    )  # fmt: skip


_SIGNS = tuple(
    Fixture(name, "pier", first=1 + number % 2, last=-1, every=5 + 2 * (number // 2), floors=3,
            lift=0.25, street=True, share=0.3)
    for number, name in enumerate(UPRIGHT)
)  # fmt: skip
_TENANTS = FacadeStyle(
    "strip", 2.6, (("window_office", 1),), (("door_glass", 1),), sill=0.8, ground_storey=3.6,
    corner=0.55, scale=(1.0, 0.95), surrounds=(("", 1),), back="", heads=(("coping", 1),),
    cooling=0.16, shops=0.85,
    slabs=(Strip("band_box", 0.5, 0.05, "trim", 0.95, share=0.5),),
    fixtures=(
        *_SIGNS,
        Fixture("floor_sign", "pier", "sign", first=1, last=-1, every=3, street=True, share=0.7),
        Fixture("tenant_board", "foot", street=True, lift=0.2, share=0.7),
        Fixture("stair_flight", "bay", first=0, last=-2, every=4, stretch="storey", street=False,
                share=0.7),
        Fixture("cooling_ledge", "pier", "trim", first=1, last=-1, lift=0.3, street=False,
                share=0.4, scattered=True),
        Fixture("street_vending", "foot", "sign", street=True, share=0.25),
        Fixture("drain_pipes", "corner", stretch="height", share=0.6, scattered=True),
    ),
)  # fmt: skip
_RIBBON = FacadeStyle(
    "strip", 3.0, (("window_strip", 1),), (("door_lobby", 1),), sill=0.85, ground_storey=3.7,
    corner=0.35, scale=(1.0, 1.0), surrounds=(("", 1),), back="", heads=(("coping", 1),),
    base=(("stone", 1),), shops=0.45,
    slabs=(Strip("band_box", 0.16, 0.1, "trim", 0.9, share=0.6),),
    fixtures=(
        Fixture("tenant_board", "foot", street=True, lift=0.2, share=0.5),
        Fixture("cooling_ledge", "pier", "trim", first=1, last=-1, lift=0.3, street=False,
                share=0.5, scattered=True),
    ),
)  # fmt: skip
_WINDOWED = FacadeStyle(
    "punched", 2.35, (("window_slider", 3), ("window_single", 1)), (("door_glass", 1),), sill=0.85,
    ground_storey=3.3, corner=0.4, scale=(0.95, 1.1), surrounds=(("sill_metal", 1),),
    back="sill_metal", heads=(("coping", 1),), cooling=0.3, base=(("stone", 1), ("paint", 1)),
    shops=0.6,
    fixtures=(
        *_SIGNS[:3],
        Fixture("balcony_railed", "bay", "trim", first=1, last=-1, every=3, stretch="bay",
                street=True, share=0.35),
        Fixture("tenant_board", "foot", street=True, lift=0.2, share=0.3),
        Fixture("meter_boxes", "foot", street=False, spacing=5.0, share=0.4, scattered=True),
        Fixture("drain_pipes", "corner", stretch="height", share=0.6, scattered=True),
    ),
)  # fmt: skip


def _look(facade: FacadeStyle, walls: Surfaces = _TILED) -> Look:
    # Balconies of flats are painted pale, whatever the tiles; offices are of one colour.
    return Look(facade, walls, frames=_FRAMES, own_trim=walls is _FACED)


_ROOFTOP = MappingProxyType(
    {"condenser": 5, "ac_row": 6, "water_cistern": 4, "stair_head": 4, "lift_house": 3,
     "antenna": 3, "vent": 2, "roof_patch": 6, "roof_hatch": 2, "roof_pipes": 3, "roof_planters": 1,
     "roof_lawn": 1.6,
     "roof_duct": 2, "roof_walkway": 1.5}
)  # fmt: skip

GENERATOR = Generator(
    "japanese_midrise",
    "Japanese mid-rise",
    _look(_flats("balcony_run")),
    zones=MappingProxyType(
        {
            "glazed": _look(_flats("balcony_glazed")),
            "railed": _look(_flats("balcony_railed")),
            "tenants": _look(_TENANTS, _FACED),
            "ribbon": _look(_RIBBON, _FACED),
            "tiled": _look(_WINDOWED),
        }
    ),
    mass=masses,
    roofs=(("flat", 1.0),),
    flat=((6, "bitumen", (0x8A8C8A, 0x7F9488, 0x74787A, 0x6B7F78, 0x8C7A6C, 0x7F9088)),
          (3, "concrete", GREYS),
          (1, "roof_gravel", (0x8B8780, 0x7E7B75))),
    rooftop=_ROOFTOP,
    area=(24.0, 2600.0),
    levels=(3, 15),
    plot=(9.0, 26.0, 10.0, 15.0),
    chimneys=0.0,
    floors=(4, 10),
    storey=2.9,
    use="apartments",
)  # fmt: skip


@action(
    "building/japanese_midrise-v1",
    limits=["Only footprints of a size that admits such a building change."],
    requires=("layout",),
    labels=("japanese", "mid-rise", "flats", "mansion", "zakkyo", "tenants", "signs", "tokyo"),
)
def japanese_midrise(
    city: City,
    *,
    share: Annotated[float, Range(0.0, 1.0)] = 1.0,
    floors: Annotated[int, Range(0, 15)] = 0,
    building: Annotated[str | None, ObjectName()] = None,
    front: Annotated[str, Choice("any", *FRONTS)] = "any",
    setback: Annotated[float, Range(0.0, 1.0)] = 0.4,
    noise: Annotated[float, Range(0.0, 1.0)] = 0.5,
) -> City:
    """Build the middle-sized blocks of Japanese towns.

    Tile-clad flats behind continuous balconies with partitions and cooling units; narrow houses
    with a tenant and a sign on each floor, over a shop; offices with ribbon windows; some tops
    stand back for the daylight of the street.

    Parameters
    ----------
    share
        Share of the buildings that become one.
    floors
        Storeys, 0 to keep those of each building.
    building
        The one building to change, or None for all.
    front
        What the front is like.
    setback
        Share of the blocks whose top stands back from the street.
    noise
        How far measures vary; 0 makes all alike.
    """
    mass = partial(masses, front=front, setback=setback)
    return redesign(
        city, GENERATOR, share=share, floors=floors, building=building, mass=mass, noise=noise
    )
