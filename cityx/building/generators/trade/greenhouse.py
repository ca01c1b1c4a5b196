"""Greenhouses: bays of glass gables in a row, in a thin white frame."""

from __future__ import annotations

from functools import partial
from types import MappingProxyType
from typing import Annotated

from cityx.assets.fixtures.houses import HIGH_RISE, RISE
from cityx.assets.styles.facade_styles import FacadeStyle, Fixture, Strip
from cityx.assets.styles.generators import Generator, Look
from cityx.building.design import redesign
from cityx.building.massing.massing import Mass, Plot
from cityx.city.city import City
from cityx.geometry.parcels.lots import lot_of
from cityx.protocol import ObjectName, Range, action

WIDE = 5.5  # metres; wider bays have the higher roof
LOWEST = 1.9  # metres under a gutter
MOST = 60  # bays


def masses(plot: Plot, *, bay: float = 4.0) -> tuple[Mass, ...]:
    """Cut the plan into bays along its longer side, each under a gable of glass."""
    lot = lot_of(plot, lengthwise=True)
    wanted = plot.between("bay", 0.75 * bay, 1.25 * bay)
    count = min(max(1, round(lot.depth / max(wanted, 1.0))), MOST)
    width = lot.depth / count
    high = width > WIDE
    rise = HIGH_RISE if high else RISE
    eave = max((plot.height - plot.rise) * plot.between("eave", 0.86, 1.0), LOWEST)
    boxes = [(-lot.x, -lot.y + k * width, lot.x, -lot.y + (k + 1) * width) for k in range(count)]
    made = lot.masses(boxes, low=0.0, high=eave + rise, zone="wide" if high else "", roof="gabled",
                      rise=rise, direction=lot.along())  # fmt: skip
    return tuple(made)


_GLASS = ((1, "glass_wall", (0xFFFFFF, 0xE8FFF4, 0xE6F2FF)),)
_FRAMES = (0xF2F1EE, 0xEFEDE8, 0xD9DDDB)


def _house(bars: str) -> FacadeStyle:
    return FacadeStyle(
        "curtain", 1.2, (("window_strip", 1),), (("door_greenhouse", 1),), ground_storey=2.4,
        corner=0.1, surrounds=(("", 1),), back="", heads=(("eaves_board", 1),),
        fins=(Strip("band_frame", 0.06, 0.07, "frame", spacing=1.2, lobby=False),),
        slabs=(Strip("band_frame", 0.08, 0.05, "frame", lobby=False),),
        fixtures=(
            Fixture(bars, "top", "frame", spacing=1.2, stretch="across"),
            Fixture("glass_vent", "top", "frame", spacing=4.8, stretch="across", share=0.7),
        ),
    )  # fmt: skip


GENERATOR = Generator(
    "greenhouse",
    "Greenhouse",
    Look(_house("glass_bars"), _GLASS, frames=_FRAMES),
    zones=MappingProxyType({"wide": Look(_house("glass_bars_high"), _GLASS, frames=_FRAMES)}),
    mass=masses,
    roofs=(("gabled", 1.0),),
    pitch=(22.0, 26.0),
    pitched=_GLASS,
    flat=_GLASS,
    area=(12.0, 60000.0),
    levels=(1, 4),
    plot=(18.0, 30.0, 9.0, 15.0),
    floors=(1, 1),
    storey=2.6,
    use="greenhouse",
)


@action(
    "building/greenhouse-v1",
    limits=[
        "Only footprints of a size that admits such a building change.",
        "The glass cannot be looked through; nothing grows inside.",
    ],
    requires=("layout",),
    labels=("greenhouse", "glasshouse", "conservatory", "horticulture", "glass"),
)
def greenhouse(
    city: City,
    *,
    share: Annotated[float, Range(0.0, 1.0)] = 1.0,
    floors: Annotated[int, Range(0, 2)] = 1,
    building: Annotated[str | None, ObjectName()] = None,
    bay: Annotated[float, Range(2.5, 12.0)] = 4.0,
    noise: Annotated[float, Range(0.0, 1.0)] = 0.5,
) -> City:
    """Build greenhouses.

    Glass walls and a row of small glass gables between gutters, held by a thin white frame.

    Parameters
    ----------
    share
        Share of the buildings that become one.
    floors
        Storeys, 0 to keep those of each building.
    building
        The one building to change, or None for all.
    bay
        Metres of width of a gable.
    noise
        How far bays vary between greenhouses; 0 makes all alike.
    """
    mass = partial(masses, bay=bay)
    return redesign(
        city, GENERATOR, share=share, floors=floors, building=building, mass=mass, noise=noise
    )
