"""Bungalows: one long low storey under a shallow roof, a deep porch on posts, a carport."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from types import MappingProxyType
from typing import Annotated

from cityx.assets.styles.facade_styles import FacadeStyle, Fixture
from cityx.assets.styles.generators import Generator, Look
from cityx.assets.styles.palette_tables import BOARDS, REDS, SHINGLES
from cityx.building.design import redesign
from cityx.building.massing.massing import Mass, Plot
from cityx.city.city import City
from cityx.geometry.parcels.lots import Box, Lot, lot_of, masses_on, slope_of
from cityx.protocol import ObjectName, Range, action

LEAST = 6.2  # metres of house; a narrower one has neither porch nor carport
CARPORT = 3.3  # metres of its width
EAVE = 2.35  # metres under the eave of porch and carport
WINGED = 0.2  # share of its box that a plan must lack to have a ridge for each wing
DEEPEST = 3.8  # metres of a porch
STEEPEST = 1.1  # rise over run of a roof with a storey in it
SHALLOW = 0.24  # rise over run of their roofs


def masses(plot: Plot, *, porch: float = 0.85, carport: float = 0.5) -> tuple[Mass, ...]:
    """Open a carport at one end and a porch along the front of a low house."""
    lot = lot_of(plot)
    if not lot.boxy or lot.narrow < LEAST or plot.rise <= 0:
        return (plot.body,)
    turn, parks, sits, wide, deep, gable = plot.draws("bungalow", 6)
    side = 1.0 if turn < 0.5 else -1.0
    if plot.levels > 1 and not plot.said:
        plot = _under_the_roof(plot, lot)
    eave, slope = plot.height - plot.rise, slope_of(plot, lot)
    made: list[Mass] = []
    near = -lot.x
    if parks < carport and lot.length > LEAST + CARPORT:
        near += CARPORT
        rise = SHALLOW * CARPORT
        made += lot.masses([_box(side, -lot.x, near, -lot.y, lot.y)], low=0.0, high=EAVE + rise,
                           zone="carport", roof="skillion", rise=rise,
                           direction=lot.compass(-side, 0.0), walls=False)  # fmt: skip
    body = lot.x - near
    if sits >= porch or lot.depth < LEAST + 1.8:
        return (*made, *_house(lot, plot, slope, _ring(side, near, lot.x, lot.x, lot.y, lot.y)))
    cut = min(1.8 + 0.8 * deep, 0.3 * lot.depth)
    knee = near + (0.5 + 0.14 * wide) * body if wide < 0.6 and body > 9.0 else lot.x
    if knee < lot.x and plot.roof == "gabled":
        # A ridge for each wing needs a deep corner; else the porch takes the whole front.
        wanted = WINGED * lot.depth * body / (knee - near)
        cut, knee = (wanted, knee) if wanted < DEEPEST else (cut, lot.x)
    made += _house(lot, plot, slope, _ring(side, near, knee, lot.x, lot.y - cut, lot.y))
    box = _box(side, near, knee, lot.y - cut, lot.y)
    if gable < 0.45 and knee - near < 9.0:
        rise = min(0.5 * SHALLOW * (knee - near), eave + 0.35 - EAVE)
        down = lot.inward()
    else:
        rise, down = SHALLOW * cut, lot.along()
    rise = max(rise, 0.2)
    made += lot.masses([box], low=0.0, high=EAVE + rise, zone="porch",
                       roof="gabled" if down == lot.inward() else "skillion", rise=rise,
                       direction=down, walls=False)  # fmt: skip
    return tuple(made)


def _under_the_roof(plot: Plot, lot: Lot) -> Plot:
    """Take the top storey into the roof, as high as that is not too steep."""
    eave = max((plot.levels - 1) * plot.storey, plot.height - 0.5 * STEEPEST * lot.narrow)
    return replace(plot, rise=plot.height - eave)


def _box(side: float, x0: float, x1: float, y0: float, y1: float) -> Box:
    return (x0, y0, x1, y1) if side > 0 else (-x1, y0, -x0, y1)


def _ring(
    side: float, near: float, knee: float, far: float, step: float, front: float
) -> list[tuple[float, float]]:
    """Outline of a house whose front lies back from `near` to `knee`."""
    back = -front
    ring = [(near, back), (far, back), (far, front if knee < far else step)]
    ring += [(knee, front), (knee, step)] if knee < far else []
    ring.append((near, step))
    return ring if side > 0 else [(-a, b) for a, b in ring[::-1]]


def _house(lot: Lot, plot: Plot, slope: float, ring: list[tuple[float, float]]) -> list[Mass]:
    wide = max(a for a, _ in ring) - min(a for a, _ in ring)
    deep = max(b for _, b in ring) - min(b for _, b in ring)
    rise = min(0.5 * slope * min(wide, deep), plot.rise)
    eave = plot.height - plot.rise
    # A plan with wings takes a hip over each.
    roof = "hipped" if len(ring) > 4 and plot.roof != "gabled" and not plot.said else plot.roof
    return masses_on(lot.outline(ring), low=0.0, high=eave + rise, roof=roof, rise=rise)


_WALLS = (
    (5, "wood", (*BOARDS, 0x9BA59A, 0xC9B58E, 0x8FA0A8)),
    (3, "brick", (*REDS, 0xB08A68)),
    (3, "plaster", (0xE4D8C0, 0xD9C7A2, 0xCBBFA8, 0xDDB892)),
)
_BODY = FacadeStyle(
    "punched", 3.9, (("window_picture", 5), ("window_slider", 2)), (("door_sidelight", 1),),
    sill=0.7, ground_storey=2.5, corner=0.8, scale=(0.92, 0.9),
    surrounds=(("surround_flat", 2), ("sill", 1)), heads=(("eaves_board", 1),),
    base=(("stone", 3), ("", 2)),
    fixtures=(
        Fixture("knee_brace", "edge", "trim", spacing=1.9, lift=-0.16, share=0.6),
        Fixture("trellis", "foot", street=False, share=0.15, scattered=True),
    ),
)  # fmt: skip
_OPEN = FacadeStyle("shed", 3.0, (("window_small", 1),), (("door_service", 1),), sill=2.5)

_LIGHT = ((1, "wood", (0xE6E3DA, 0xDCD8D2, 0xD9D5CA)),)  # of what stands on posts

GENERATOR = Generator(
    "bungalow",
    "Bungalow",
    Look(_BODY, _WALLS),
    zones=MappingProxyType(
        {
            "porch": Look(
                FacadeStyle(
                    "shed", 3.0, (("window_small", 1),), (("door_service", 1),), sill=2.5,
                    fixtures=(Fixture("porch_deck", "ground", "trim", stretch="plan"),),
                ),
                _LIGHT,
            ),
            "carport": Look(_OPEN, _LIGHT),
        }
    ),
    mass=masses,
    roofs=(("hipped", 6), ("gabled", 4), ("hipped-and-gabled", 1)),
    eaves=2.0,
    pitch=(16.0, 24.0),
    pitched=((8, "bitumen", SHINGLES), (2, "roof_tiles", (0x6C4236, 0x74503F, 0x5A5450)),
             (1, "roof_metal", (0x84888A, 0x6E7A70))),
    area=(45.0, 600.0),
    levels=(1, 3),
    width=(5.5, 40.0),
    plot=(14.0, 21.0, 9.0, 12.0),
    chimneys=0.45,
    floors=(1, 1),
    storey=2.75,
    use="bungalow",
)  # fmt: skip


@action(
    "building/bungalow-v1",
    limits=[
        "Only footprints of a size that admits such a building change.",
        "Plans that are not nearly rectangular keep one body.",
    ],
    requires=("layout",),
    labels=("bungalow", "ranch", "low", "porch", "carport", "house", "american"),
)
def bungalow(
    city: City,
    *,
    share: Annotated[float, Range(0.0, 1.0)] = 1.0,
    floors: Annotated[int, Range(0, 2)] = 1,
    building: Annotated[str | None, ObjectName()] = None,
    porch: Annotated[float, Range(0.0, 1.0)] = 0.85,
    carport: Annotated[float, Range(0.0, 1.0)] = 0.5,
    noise: Annotated[float, Range(0.0, 1.0)] = 0.5,
) -> City:
    """Build low bungalows and ranch houses.

    One storey under a shallow hipped or gabled roof, picture windows, knee braces under the eaves,
    a porch on posts along the front and a carport at one end.

    Parameters
    ----------
    share
        Share of the buildings that become one.
    floors
        Storeys, 0 to keep those of each building; a second one lies in the roof.
    building
        The one building to change, or None for all.
    porch, carport
        Share of houses with a porch, and with a carport.
    noise
        How far houses vary; 0 makes all alike.
    """
    mass = partial(masses, porch=porch, carport=carport)
    return redesign(
        city, GENERATOR, share=share, floors=floors, building=building, mass=mass, noise=noise
    )
