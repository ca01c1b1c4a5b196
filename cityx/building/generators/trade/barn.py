"""Barns: boarded halls under gambrel roofs, sliding doors with crossed braces, lean-to sheds."""

from __future__ import annotations

from functools import partial
from types import MappingProxyType
from typing import Annotated

from cityx.assets.styles.facade_styles import FacadeStyle, Fixture
from cityx.assets.styles.generators import Generator, Look
from cityx.assets.styles.palette_tables import SHINGLES
from cityx.building.design import redesign
from cityx.building.massing.massing import Mass, Plot
from cityx.city.city import City
from cityx.geometry.parcels.lots import lot_of
from cityx.protocol import ObjectName, Range, action

LEAST = 5.5  # metres of barn beside a lean-to
LOWEST = 2.3  # metres under the eave of a lean-to


def masses(plot: Plot, *, lean: float = 0.75, both: float = 0.25) -> tuple[Mass, ...]:
    """Lean a shed against one long side, or against both."""
    lot = lot_of(plot, lengthwise=True)
    eave = plot.height - plot.rise
    leans, second, deep, turn = plot.draws("barn", 4)
    width = (0.2 + 0.06 * deep) * lot.depth
    width = min(max(width, 2.2), 5.0)
    sides = 2 if second < both else 1
    if sides == 2 and lot.depth - 2 * width < LEAST:
        sides = 1
    fits = lot.boxy and lot.depth - sides * width >= LEAST and eave > LOWEST + 0.8
    if leans >= lean or not fits or plot.rise <= 0:
        return (plot.body,)
    rise = min(0.45 * width, eave - LOWEST - 0.25)
    share = (lot.depth - sides * width) / lot.depth
    up = plot.rise * share
    y0, y1 = -lot.y + width, lot.y - (width if sides == 2 else 0.0)
    strips = [((-lot.x, -lot.y, lot.x, y0), -1.0)]
    if sides == 2:
        strips.append(((-lot.x, y1, lot.x, lot.y), 1.0))
    elif turn < 0.3:  # towards the street
        y0, y1 = -y1, -y0
        strips = [((-lot.x, y1, lot.x, lot.y), 1.0)]
    made = lot.masses([(-lot.x, y0, lot.x, y1)], low=0.0, high=eave + up, roof=plot.roof, rise=up,
                      direction=lot.along())  # fmt: skip
    for box, way in strips:
        made += lot.masses([box], low=0.0, high=LOWEST + rise, zone="lean", roof="skillion",
                           rise=rise, direction=lot.compass(0.0, way))  # fmt: skip
    return tuple(made)


_WALLS = (
    (6, "wood", (0x7E2F26, 0x8A3A2E, 0x6E2A24, 0x923F30)),
    (3, "wood", (0x6B5B4C, 0x574A3E, 0x7F7668, 0x3F3B38)),
    (2, "wood", (0xD8D5CC, 0xC9C6BC)),
)
_BODY = FacadeStyle(
    "punched", 3.4, (("window_barn", 1),), (("door_barn", 1),), sill=1.5, ground_storey=3.6,
    corner=0.8, surrounds=(("", 1),), back="", heads=(("eaves_board", 1),),
    fixtures=(
        Fixture("barn_loft", "gable", "trim", lift=0.25, share=0.85),
        Fixture("barn_cupola", "top", "trim", share=0.7),
    ),
)  # fmt: skip
_LEAN = FacadeStyle(
    "punched", 3.6, (("window_barn", 1),), (("door_boards", 1),), sill=1.05, ground_storey=2.3,
    corner=0.8, surrounds=(("", 1),), back="",
    fixtures=(Fixture("rain_butt", "foot", share=0.3, scattered=True),),
)  # fmt: skip

GENERATOR = Generator(
    "barn",
    "Barn",
    Look(_BODY, _WALLS, frames=(0xEFEDE8, 0xE6E2D8)),
    zones=MappingProxyType({"lean": Look(_LEAN, _WALLS, frames=(0xEFEDE8, 0xE6E2D8))}),
    mass=masses,
    roofs=(("gabled", 2.5), ("gambrel", 7.5)),
    pitch=(40.0, 47.0),
    pitched=(
        (5, "roof_metal", (0x7A7E80, 0x9A9D9E, 0x6A4A40, 0x8A5248)),
        (3, "slate", (0x50545A, 0x66676A, *SHINGLES[:2])),
        (2, "roof_tiles", (0x86523F, 0x6C4236)),
    ),
    area=(50.0, 2500.0),
    levels=(1, 3),
    width=(6.0, 40.0),
    plot=(16.0, 26.0, 11.0, 15.0),
    floors=(1, 1),
    storey=4.2,
    use="barn",
)  # fmt: skip


@action(
    "building/barn-v1",
    limits=["Only footprints of a size that admits such a building change."],
    requires=("layout",),
    labels=("barn", "farm", "gambrel", "rural", "boards", "stable"),
)
def barn(
    city: City,
    *,
    share: Annotated[float, Range(0.0, 1.0)] = 1.0,
    floors: Annotated[int, Range(0, 3)] = 0,
    building: Annotated[str | None, ObjectName()] = None,
    lean: Annotated[float, Range(0.0, 1.0)] = 0.75,
    both: Annotated[float, Range(0.0, 1.0)] = 0.25,
    noise: Annotated[float, Range(0.0, 1.0)] = 0.5,
) -> City:
    """Build boarded barns.

    Gambrel or gabled roofs over board walls, sliding doors with crossed braces, a hay loft with its
    hoist in the gable, a louvred cupola on the ridge, and lean-to sheds along the sides.

    Parameters
    ----------
    share
        Share of the buildings that become one.
    floors
        Storeys, 0 to keep those of each building.
    building
        The one building to change, or None for all.
    lean, both
        Share of barns with a lean-to, and, of these, with one on either side.
    noise
        How far barns vary; 0 makes all alike.
    """
    mass = partial(masses, lean=lean, both=both)
    return redesign(
        city, GENERATOR, share=share, floors=floors, building=building, mass=mass, noise=noise
    )
