"""Petrol stations: a lit canopy on posts over rows of pumps, a shop, a price sign."""

from __future__ import annotations

from functools import partial
from types import MappingProxyType
from typing import Annotated, Any

import shapely

from cityx.assets.styles.facade_styles import FacadeStyle, Fixture
from cityx.assets.styles.generators import Generator, Look
from cityx.building.design import redesign
from cityx.building.massing.massing import Mass, Plot, carve, site_of
from cityx.city.city import City
from cityx.protocol import ObjectName, Range, action

CLEAR = 4.6  # metres under a canopy, for lorries
FASCIA = 1.1  # metres
LEAST_SHOP = 11.0  # metres of depth from which a shop stands behind the pumps
LEAST_WIDTH = 4.5  # metres of a canopy


def masses(
    plot: Plot, *, shop: float = 0.34, rows: int = 0, totem: bool = True
) -> tuple[Mass, ...]:
    """Divide the plan into a shop at the back and pumps under a canopy at the street."""
    site = site_of(plot)
    half, deep = site.half
    if min(2 * half, 2 * deep) < LEAST_WIDTH:
        return tuple(site.masses(site.plan, 0.0, min(plot.height, 4.2), "shop"))
    grown: list[Mass] = []
    rest: Any = site.plan
    if totem and half > 6.0:
        side = 1.0 if plot.draw("totem side") < 0.5 else -1.0
        x = side * (half - 1.1)
        square = shapely.box(x - 1.1, deep - 1.1, x + 1.1, deep - 0.1)
        if shapely.intersection(rest, square).area > 0.97 * square.area:
            post = shapely.box(x - 1.0, deep - 0.8, x + 1.0, deep - 0.45)
            rest = shapely.difference(rest, square.buffer(0.8, join_style="mitre"), grid_size=0.01)
            grown += site.masses(post, 0.0, 6.8, "totem")
    gap = 0.0
    if shop > 0 and 2 * deep > LEAST_SHOP:
        depth = min(max(shop * 2 * deep, 4.5), 12.0)
        gap = min(1.5, 0.08 * deep)
        share = plot.between("shop length", 0.55, 0.95)
        slide = (1 - share) * half * (2 * plot.draw("shop slide") - 1) * min(1.0, 2 * plot.noise)
        box = shapely.box(slide - share * half, -999, slide + share * half, -deep + depth)
        back, _ = carve(rest, box)
        grown += site.masses(back, 0.0, plot.between("shop height", 3.6, 4.6), "shop")
        rest = carve(rest, shapely.box(-999, -deep + depth + gap, 999, 999))[0]
    x0, y0, x1, y1 = rest.bounds
    inset = min(0.8, 0.06 * (y1 - y0))
    clear = rest.buffer(-inset, join_style="mitre")
    top = CLEAR + FASCIA
    usual = max(1, min(3, round((y1 - y0) / 8.5)))
    count = rows or usual
    for number in range(count):
        a = y0 + (y1 - y0) * number / count
        b = y0 + (y1 - y0) * (number + 1) / count
        lane = shapely.intersection(clear, shapely.box(x0, a + 0.2, x1, b - 0.2), grid_size=0.01)
        grown += site.masses(lane, 0.0, CLEAR, "pumps", walls=False)
    return (*grown, *site.masses(rest, CLEAR, top + 0.25, "fascia", "rimmed", 0.25))


_WHITES = (0xE8E8E4, 0xDADBD8, 0xF0F0EE)


def _look(walls: Any, *fixtures: Fixture, **more: Any) -> Look:
    given: dict[str, Any] = {
        "scale": (0.0, 1.0), "heads": (("", 1),), "corner": 0.2,
        "windows": (("window_office", 1),), "doors": (("door_auto", 1),), "mode": "punched",
        "bay": 3.0,
    } | more  # fmt: skip
    style = FacadeStyle(surrounds=(("", 1),), back="", fixtures=fixtures, **given)
    return Look(style, walls, frames=(0x3A3D40, 0x8E9294))


_SHOP = (
    (3, "metal_panel", _WHITES),
    (2, "plaster", (0xE2E0DB, 0xD3CFC7, 0xDAD2C4)),
    (1, "brick", (0x8C4A3A, 0x96543F)),
)
_SHOP_LOOK = _look(
    _SHOP,
    Fixture("fascia_band", "edge", tint="sign", stretch="wall", lift=-0.1),
    Fixture("letters_garage", "front", tint="sign", lift=3.05),
    Fixture("bollards", "front", lift=0.0),
    Fixture("air_point", "corner", share=0.7),
    scale=(1.05, 1.15), sill=0.35, bay=2.7, heads=(("coping", 1),),
)  # fmt: skip
GENERATOR = Generator(
    "petrol_station",
    "Petrol station",
    _SHOP_LOOK,
    zones=MappingProxyType(
        {
            "shop": _SHOP_LOOK,
            "pumps": _look(
                ((1, "metal_panel", _WHITES),),
                Fixture("pump_island", "ground", spacing=8.0),
                Fixture("pump_heads", "ground", tint="sign", spacing=8.0),
                Fixture("canopy_lights", "ground", spacing=8.0, lift=CLEAR - 0.3),
            ),
            "fascia": _look(
                ((1, "metal_panel", _WHITES),),
                Fixture("canopy_fascia", "edge", tint="sign", stretch="wall"),
            ),
            "totem": _look(
                ((1, "metal_panel", (0x3F4447, 0xDADBD8)),),
                Fixture("price_totem", "foot"),
                Fixture("totem_head", "foot", tint="sign"),
            ),
        }
    ),
    mass=masses,
    pitched=((1, "roof_metal", (0xC9CBCB, 0xAEB0AF)),),
    flat=((3, "roof_metal", (0xAEB0AF, 0x9A9D9E)), (1, "bitumen", (0xA2A19C,))),
    area=(20.0, 3000.0),
    levels=(1, 4),
    plot=(22.0, 34.0, 18.0, 28.0),
    floors=(1, 1),
    storey=5.6,
    use="fuel",
    covers=False,
)


@action(
    "building/petrol_station-v1",
    limits=["Only footprints of a size that admits such a building change."],
    requires=("layout",),
    labels=("petrol", "fuel", "gas", "station", "canopy", "pumps"),
)
def petrol_station(
    city: City,
    *,
    share: Annotated[float, Range(0.0, 1.0)] = 1.0,
    floors: Annotated[int, Range(0, 2)] = 0,
    building: Annotated[str | None, ObjectName()] = None,
    shop: Annotated[float, Range(0.0, 0.6)] = 0.34,
    rows: Annotated[int, Range(0, 4)] = 0,
    totem: bool = True,
    noise: Annotated[float, Range(0.0, 1.0)] = 0.5,
) -> City:
    """Build petrol stations: pumps under a canopy, a shop behind, a price sign.

    Parameters
    ----------
    share
        Share of the buildings that become one.
    floors
        Storeys, 0 to keep those of each building.
    building
        The one building to change, or None for all.
    shop
        Depth of the shop as a share of the plan's; 0 leaves the canopy alone.
    rows
        Rows of pumps; 0 takes what suits the depth.
    totem
        Whether a price sign stands at the street.
    noise
        How far measures vary; 0 is regular.
    """
    mass = partial(masses, shop=shop, rows=rows, totem=totem)
    return redesign(
        city, GENERATOR, share=share, floors=floors, building=building, mass=mass, noise=noise
    )
