"""Big-box stores: blank boxes with coloured bands, a glazed portal with a sign, a canopy."""

from __future__ import annotations

from functools import partial
from types import MappingProxyType
from typing import Annotated, Any

import shapely

from cityx.assets.styles.facade_styles import FacadeStyle, Fixture, Strip
from cityx.assets.styles.generators import Generator, Look
from cityx.assets.styles.palette_tables import LIGHTS
from cityx.building.design import redesign
from cityx.building.massing.massing import Mass, Plot, carve, remainder, site_of
from cityx.city.city import City
from cityx.protocol import ObjectName, Range, action

LEAST_AREA = 280.0  # square metres; a smaller one has a shopfront along its whole front


def masses(
    plot: Plot, *, portal: float = 0.2, delivery: bool = True, units: int = 0
) -> tuple[Mass, ...]:
    """Set a portal, or those of several units, in the front, and a delivery yard behind."""
    site = site_of(plot)
    half, deep = site.half
    high = min(max(plot.height - plot.rise, 4.2), 14.0)
    if site.plan.area < LEAST_AREA or min(half, deep) < 6.0:
        return tuple(site.masses(site.plan, 0.0, high, "portal"))
    grown: list[Mass] = []
    rest: Any = site.plan
    count = units or (1 if 2 * half < 70 else 2 if 2 * half < 120 else 3)
    span = 2 * half / count
    depth = min(max(0.16 * 2 * deep, 3.6), 7.0)
    for number in range(count):
        wide = min(max(portal * span, 6.5), 22.0)
        room = 0.5 * (span - wide) - 2.0
        slide = room * (2 * plot.draw("portal", number) - 1) * min(1.0, 2 * plot.noise)
        x = -half + (number + 0.5) * span + 0.7 * slide
        if portal > 0 and wide < 0.8 * span:
            box = shapely.box(x - wide / 2, deep - depth, x + wide / 2, 999)
            gate, rest = carve(rest, box)
            grown += site.masses(gate, 0.0, high + plot.between("portal top", 1.6, 3.6), "portal")
    if delivery and deep > 11.0:
        side = 1.0 if plot.draw("yard side") < 0.5 else -1.0
        length = min(max(0.34 * 2 * half, 9.0), 30.0)
        x0, x1 = sorted((side * half * 1.1, side * (half - length)))
        depth = min(max(0.2 * 2 * deep, 5.0), 9.0)
        yard, rest = carve(rest, shapely.box(x0, -999, x1, -deep + depth))
        grown += site.masses(yard, 0.0, min(6.9, 0.92 * high), "yard")
    grown += site.masses(rest, 0.0, high)
    return (*grown, *remainder(site, grown, 4.2, ""))


_WALLS = (
    (5, "metal_panel", (0xC2C2BE, 0xA2A5A6, 0xD6D6D2, 0xB8B2A6, 0x7C8083)),
    (3, "plaster", LIGHTS),
    (2, "brick", (0x96543F, 0xA25F48, 0xA98A70)),
)
_FRAMES = (0x3A3D40, 0x8E9294, 0x5A5D5F)
GENERATOR = Generator(
    "big_box",
    "Big-box store",
    Look(
        FacadeStyle(
            "nave", 5.0, (("window_strip", 1),), (("door_auto", 1),), scale=(0.0, 1.0),
            ground_storey=4.0, corner=0.7, surrounds=(("", 1),), heads=(("coping", 1),), back="",
            fins=(Strip("band_box", 0.05, 0.03, "wall", 0.9, spacing=2.4, lobby=False),),
            fixtures=(
                Fixture("fascia_band", "edge", tint="sign", stretch="wall", lift=-0.3),
                Fixture("plinth_band", "foot", stretch="wall", out=0.02),
                Fixture("front_canopy", "foot", tint="sign", stretch="wall", street=True,
                        share=0.75),
                Fixture("canopy_post", "foot", spacing=6.5, street=True, share=0.75),
                Fixture("poster_case", "foot", tint="sign", spacing=5.0, street=True,
                        lift=0.9, scattered=True, share=0.6),
                Fixture("trolleys", "foot", spacing=22.0, street=True),
            ),
        ),
        _WALLS,
        frames=_FRAMES,
    ),
    zones=MappingProxyType(
        {
            "portal": Look(
                FacadeStyle(
                    "nave", 2.4, (("window_strip", 1),), (("door_auto", 1),), corner=0.5,
                    surrounds=(("", 1),), heads=(("coping", 1),), back="", scale=(0.0, 1.0),
                    entrance=True,
                    fixtures=(
                        Fixture("sign_board", "edge", tint="sign", lift=-2.3, street=True),
                        Fixture("glass_front", "foot", tint="frame", lift=3.9, street=True),
                        Fixture("bollards", "foot", street=True, out=1.2),
                    ),
                ),
                (
                    (3, "metal_panel", (0x4A5056, 0x2F3234, 0xDADBD8)),
                    (2, "metal_panel", (0x7A2A24, 0x24476B, 0x2C5A3E, 0xB8862C)),
                    (1, "wood", (0x8A7256, 0x9A7B58)),
                ),
                frames=_FRAMES,
            ),
            "yard": Look(
                FacadeStyle(
                    "nave", 5.0, (("window_strip", 1),), (("door_service", 1),),
                    scale=(0.0, 1.0), surrounds=(("", 1),), heads=(("coping", 1),), back="",
                    fixtures=(Fixture("loading_dock", "foot", spacing=5.6, street=False),),
                ),
                _WALLS,
                frames=_FRAMES,
            ),
        }
    ),
    mass=masses,
    flat=((5, "bitumen", (0xA2A19C, 0xB0AEA6)), (2, "roof_metal", (0xAEB0AF,)),
          (1, "roof_gravel", (0x8B8780,))),
    rooftop=MappingProxyType({"hvac_unit": 7, "skylight": 5, "condenser": 3, "vent": 3}),
    area=(150.0, 100000.0),
    levels=(1, 3),
    plot=(42.0, 84.0, 30.0, 50.0),
    floors=(1, 1),
    storey=6.8,
    use="supermarket",
)  # fmt: skip


@action(
    "building/big_box-v1",
    limits=["Only footprints of a size that admits such a building change."],
    requires=("layout",),
    labels=("supermarket", "big", "box", "mall", "shop"),
)
def big_box(
    city: City,
    *,
    share: Annotated[float, Range(0.0, 1.0)] = 1.0,
    floors: Annotated[int, Range(0, 3)] = 0,
    building: Annotated[str | None, ObjectName()] = None,
    portal: Annotated[float, Range(0.0, 0.5)] = 0.2,
    units: Annotated[int, Range(0, 8)] = 0,
    delivery: bool = True,
    noise: Annotated[float, Range(0.0, 1.0)] = 0.5,
) -> City:
    """Build big-box stores: blank boxes with bands, a glazed portal, a canopy, a delivery yard.

    Parameters
    ----------
    share
        Share of the buildings that become one.
    floors
        Storeys, 0 to keep those of each building.
    building
        The one building to change, or None for all.
    portal
        Width of a portal as a share of its unit; 0 leaves it out.
    units
        Stores side by side, a portal each; 0 takes what suits the length.
    delivery
        Whether a lower part with docks stands behind.
    noise
        How far measures vary; 0 is regular.
    """
    mass = partial(masses, portal=portal, units=units, delivery=delivery)
    return redesign(
        city, GENERATOR, share=share, floors=floors, building=building, mass=mass, noise=noise
    )
