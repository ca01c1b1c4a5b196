"""Sheds: boarded garden sheds, brick garages, and the open stores beside them."""

from __future__ import annotations

from functools import partial
from types import MappingProxyType
from typing import Annotated

from cityx.assets.styles.facade_styles import FacadeStyle, Fixture
from cityx.assets.styles.generators import Generator, Look
from cityx.assets.styles.palette_tables import FELT, GREYS, LIGHTS, RED_TILES, REDS
from cityx.building.design import redesign
from cityx.building.massing.massing import Mass, Plot
from cityx.city.city import City
from cityx.geometry.parcels.lots import lot_of
from cityx.protocol import ObjectName, Range, action

LEAST = 2.8  # metres of shed beside a store
STORE = 1.9  # metres of the store's width
LOWEST = 1.85  # metres under its eave


def masses(plot: Plot, *, store: float = 0.3, slope: float = 0.0) -> tuple[Mass, ...]:
    """Open a store for wood or a mower at one end; most sheds are one plain volume.

    Parameters
    ----------
    slope
        Rise over run of a lean-to roof that falls to the back, 0 for the shed's own roof.
    """
    body = plot.body
    if slope > 0 and not plot.said:
        lot = lot_of(plot)
        eave = plot.height - plot.rise
        rise = min(slope * lot.depth, 0.45 * eave)
        if rise > 0.15:
            return (Mass(plot.plan, 0.0, eave + rise, "", "skillion", rise,
                         lot.compass(0.0, -1.0)),)  # fmt: skip
    if store <= 0 or plot.plan.area < 14.0:
        return (body,)
    stores, turn = plot.draws("shed", 2)
    if stores >= store:
        return (body,)
    lot = lot_of(plot, lengthwise=True)
    eave = plot.height - plot.rise
    rise = min(0.3 * STORE, eave - 0.1 - LOWEST)
    if not lot.boxy or lot.length < LEAST + STORE or rise < 0.15:
        return (body,)
    cut = -lot.x + STORE if turn < 0.5 else lot.x - STORE
    left, right = (-lot.x, -lot.y, cut, lot.y), (cut, -lot.y, lot.x, lot.y)
    main, open_ = (right, left) if turn < 0.5 else (left, right)
    up = plot.rise * min(1.0, (main[2] - main[0]) / lot.depth)
    made = lot.masses([main], low=0.0, high=eave + up, roof=plot.roof, rise=up)
    made += lot.masses([open_], low=0.0, high=LOWEST + rise, zone="store", roof="skillion",
                       rise=rise, direction=lot.compass(-1.0 if turn < 0.5 else 1.0, 0.0),
                       walls=False)  # fmt: skip
    return tuple(made)


_WALLS = (
    (5, "wood", (0x8A7256, 0x6F5B46, 0x9A8B78, 0x7F7F78, 0x5F6B5A, 0x7A3A30)),
    (4, "plaster", LIGHTS),
    (2, "brick", REDS),
    (1, "concrete", GREYS),
    (0.5, "metal_panel", (*GREYS, 0x5F7068)),
)
_BODY = FacadeStyle(
    "shed", 2.4, (("window_barn", 2), ("window_small", 1)),
    (("door_boards", 3), ("door_carriage", 3), ("door_garage", 4)),
    sill=1.05, ground_storey=2.2, corner=0.3, scale=(0.85, 0.8), surrounds=(("", 1),), back="",
    heads=(("eaves_board", 1),),
    fixtures=(
        Fixture("rain_butt", "foot", street=False, share=0.22, scattered=True),
        Fixture("log_pile", "foot", street=False, share=0.2, scattered=True),
    ),
)  # fmt: skip

GENERATOR = Generator(
    "shed",
    "Shed",
    Look(_BODY, _WALLS),
    zones=MappingProxyType(
        {
            "store": Look(
                FacadeStyle(
                    "shed", 3.0, (("window_small", 1),), (("door_service", 1),), sill=2.5,
                    fixtures=(Fixture("log_pile", "ground"),),
                ),
                _WALLS,
            )
        }
    ),
    mass=masses,
    roofs=(("gabled", 5), ("skillion", 3), ("flat", 4), ("hipped", 1)),
    pitch=(16.0, 36.0),
    pitched=((4, "bitumen", FELT), (3, "roof_tiles", RED_TILES),
             (3, "roof_metal", (0x7E8486, 0x5F7068, 0x8A5A48))),
    plot=(4.0, 8.0, 3.0, 5.5),
    floors=(1, 1),
    storey=2.5,
    use="shed",
)  # fmt: skip


@action(
    "building/shed-v1",
    limits=["Only footprints of a size that admits such a building change."],
    requires=("layout",),
    labels=("shed", "garage", "outbuilding", "hut", "store"),
)
def shed(
    city: City,
    *,
    share: Annotated[float, Range(0.0, 1.0)] = 1.0,
    building: Annotated[str | None, ObjectName()] = None,
    store: Annotated[float, Range(0.0, 1.0)] = 0.3,
    slope: Annotated[float, Range(0.0, 0.6)] = 0.0,
    noise: Annotated[float, Range(0.0, 1.0)] = 0.5,
) -> City:
    """Build sheds and garages.

    Garden sheds of boards and garages of brick or render, with one door that fits, under gabled,
    lean-to or level roofs, some with an open store at one end.

    Parameters
    ----------
    share
        Share of the buildings that become one.
    building
        The one building to change, or None for all.
    store
        Share of sheds with an open store.
    slope
        Rise over run of lean-to roofs instead of the usual ones; 0 keeps those.
    noise
        How far sheds vary; 0 makes all alike.
    """
    mass = partial(masses, store=store, slope=slope)
    return redesign(city, GENERATOR, share=share, building=building, mass=mass, noise=noise)
