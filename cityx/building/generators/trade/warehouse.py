"""Warehouses: ribbed halls with a row of docks on one side and an office at a corner."""

from __future__ import annotations

from functools import partial
from types import MappingProxyType
from typing import Annotated, Any

import shapely

from cityx.assets.styles.facade_styles import FacadeStyle, Fixture, Strip
from cityx.assets.styles.generators import Generator, Look
from cityx.assets.styles.palette_tables import HALL_ROOF
from cityx.building.design import redesign
from cityx.building.massing.massing import Mass, Plot, carve, remainder, site_of
from cityx.city.city import City
from cityx.protocol import ObjectName, Range, action

LEAST_AREA = 350.0  # square metres; a smaller one is a plain shed with gates
LEAST_WIDTH = 13.0  # metres
DOCKS = 6.2  # metres of the height of the part that the docks are in


def masses(
    plot: Plot, *, docks: bool = True, office: float = 0.16, bays: int = 0
) -> tuple[Mass, ...]:
    """Cut an office and a dock side off the plan, and roof the rest in one or more spans."""
    site = site_of(plot)
    half, deep = site.half
    eave = min(max(plot.height - plot.rise, 5.0), 18.0)
    span = 2 * deep if not bays else 2 * deep / bays
    many = bays > 1 or (not bays and span > 34.0)
    roof = plot.pick("roof", ("flat", "gabled", "round"), (5, 4, 1))
    if plot.said:
        roof = plot.roof
    if many and roof in ("gabled", "round"):
        roof = "gabled_row"
    rise = 0.0 if roof == "flat" else min(0.07 * min(span, 30.0) + 0.4, 3.0)
    rise = 0.16 * span if roof == "round" else rise
    if site.plan.area < LEAST_AREA or 2 * deep < LEAST_WIDTH:
        roof = roof if roof != "gabled_row" else "gabled"
        return tuple(site.masses(site.plan, 0.0, eave + rise, "", roof, rise))
    grown: list[Mass] = []
    rest: Any = site.plan
    side = 1.0 if plot.draw("office side") < 0.5 else -1.0
    length = min(max(office * 2 * half, 8.0), 26.0)
    if office > 0 and 2 * half > 2.6 * length:
        x0, x1 = sorted((side * half * 1.1, side * (half - length)))
        depth = min(max(0.3 * 2 * deep, 7.0), 12.0)
        corner, rest = carve(rest, shapely.box(x0, deep - depth, x1, 999))
        grown += site.masses(corner, 0.0, eave + 1.1, "office")
    depth = min(max(0.16 * 2 * deep, 4.0), 8.0)
    if docks and eave > DOCKS + 0.8:
        front, rest = carve(rest, shapely.box(-999, deep - depth, 999, 999))
        low = DOCKS + 0.8 if plot.draw("docks low") < 0.6 else eave - 0.01
        grown += site.masses(front, 0.0, low, "docks")
    grown += site.masses(rest, 0.0, eave + rise, "", roof, rise)
    return (*grown, *remainder(site, grown, 5.0, "docks"))


_CLAD = (0xA7AAAB, 0x8C9398, 0xB9B6AB, 0x6F7B82, 0x5C6B78, 0xC6C5BF, 0x7C8A86, 0x4F5A63)
_WALLS = (
    (7, "metal_panel", _CLAD),
    (2, "concrete", (0xB4B3AF, 0xC2C0BA)),
    (1, "metal_panel", (0x3F5A78, 0x6A3A34, 0x3E5F50)),
)
_FRAMES = (0x3F4447, 0x5A5D5F, 0x2F4A54)
_RIBS = Strip("band_box", 0.07, 0.05, "wall", 0.93, spacing=1.25, lobby=False)

GENERATOR = Generator(
    "warehouse",
    "Warehouse",
    Look(
        FacadeStyle(
            "hall", 6.5, (("window_hall", 3), ("window_strip", 1)), (("door_service", 1),),
            ground_storey=4.0, corner=0.8, surrounds=(("", 1),), heads=(("coping", 1),), back="",
            scale=(0.9, 0.8), fins=(_RIBS,),
            fixtures=(
                Fixture("plinth_band", "foot", stretch="wall", out=0.05),
                Fixture("fascia_band", "edge", tint="sign", stretch="wall", lift=-0.25, share=0.7),
            ),
        ),
        _WALLS,
        frames=_FRAMES,
    ),
    zones=MappingProxyType(
        {
            "docks": Look(
                FacadeStyle(
                    "punched", 6.0, (("window_strip", 1),), (("door_service", 1),),
                    scale=(0.0, 1.0), surrounds=(("", 1),), heads=(("coping", 1),), back="",
                    fins=(Strip("band_box", 0.07, 0.05, "wall", 0.93, spacing=1.25, lobby=False),),
                    fixtures=(
                        Fixture("loading_dock", "foot", spacing=5.2),
                        Fixture("fascia_band", "edge", tint="sign", stretch="wall", lift=-0.2,
                                share=0.4),
                    ),
                ),
                _WALLS,
                frames=_FRAMES,
            ),
            "office": Look(
                FacadeStyle(
                    "strip", 3.0, (("window_strip", 1),), (("door_glass", 1),), sill=0.8,
                    ground_storey=3.4, corner=0.4, surrounds=(("", 1),), heads=(("coping", 1),),
                    back="", slabs=(Strip("band_paint", 0.5, 0.05, "accent"),),
                    fixtures=(
                        Fixture("letters_logistics", "edge", tint="sign", lift=-0.95, street=True),
                        Fixture("canopy_slab", "door", tint="frame"),
                    ),
                ),
                (
                    (4, "metal_panel", (0xD2D3D0, 0x4A5056, 0x8E9498)),
                    (3, "plaster", (0xE2E0DB, 0xD3CFC7)),
                    (1, "brick", (0x8C4A3A, 0x7C4234)),
                ),
                frames=_FRAMES,
            ),
        }
    ),
    mass=masses,
    pitched=HALL_ROOF,
    flat=HALL_ROOF,
    rooftop=MappingProxyType({"skylight": 8, "vent": 6, "hvac_unit": 3}),
    area=(60.0, 100000.0),
    levels=(1, 3),
    plot=(44.0, 90.0, 30.0, 50.0),
    floors=(1, 1),
    storey=9.5,
    use="warehouse",
)  # fmt: skip


@action(
    "building/warehouse-v1",
    limits=["Only footprints of a size that admits such a building change."],
    requires=("layout",),
    labels=("warehouse", "logistics", "hall", "industry", "dock"),
)
def warehouse(
    city: City,
    *,
    share: Annotated[float, Range(0.0, 1.0)] = 1.0,
    floors: Annotated[int, Range(0, 3)] = 0,
    building: Annotated[str | None, ObjectName()] = None,
    docks: bool = True,
    office: Annotated[float, Range(0.0, 0.35)] = 0.16,
    bays: Annotated[int, Range(0, 8)] = 0,
    noise: Annotated[float, Range(0.0, 1.0)] = 0.5,
) -> City:
    """Build warehouses: clad halls with loading docks and an office at a corner.

    Parameters
    ----------
    share
        Share of the buildings that become one.
    floors
        Storeys, 0 to keep those of each building.
    building
        The one building to change, or None for all.
    docks
        Whether the front is a row of docks.
    office
        Length of the office as a share of the hall's; 0 leaves it out.
    bays
        Spans side by side; 0 takes what suits the depth.
    noise
        How far measures vary; 0 is regular.
    """
    mass = partial(masses, docks=docks, office=office, bays=bays)
    return redesign(
        city, GENERATOR, share=share, floors=floors, building=building, mass=mass, noise=noise
    )
