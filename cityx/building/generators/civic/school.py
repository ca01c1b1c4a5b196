"""Schools: long wings of class rooms about an entrance with a clock, and a gymnasium."""

from __future__ import annotations

from functools import partial
from types import MappingProxyType
from typing import Annotated, Any

import shapely

from cityx.assets.styles.facade_styles import FacadeStyle, Fixture, Strip
from cityx.assets.styles.generators import Generator, Look
from cityx.assets.styles.palette_tables import REDS
from cityx.building.design import redesign
from cityx.building.massing.massing import Mass, Plot, Site, carve, remainder, site_of
from cityx.city.city import City
from cityx.protocol import ObjectName, Range, action

LEAST_AREA = 330.0  # square metres from which there is more than one block
DEEP = 24.0  # metres of depth from which wings run back from the front
WING = 11.5  # metres, of class rooms on one side of a corridor


def masses(plot: Plot, *, wings: int = 2, gym: float = 1.0, tower: float = 1.0) -> tuple[Mass, ...]:
    """Cut the gymnasium, the entrance and the wings; what lies between them is low."""
    site = site_of(plot)
    half, deep = site.half
    storey = min(max(plot.storey, 3.0), 4.4)
    levels = max(plot.levels, 1)
    high = max(plot.height - plot.rise, storey)
    shape, pitch = (
        plot.pick("roof", ("flat", "hipped", "skillion", "gabled"), (5, 2, 1.5, 1.5)),
        0.0,
    )
    if plot.said:
        shape = plot.roof
    if shape != "flat":
        pitch = {"hipped": 0.62, "gabled": 0.62}.get(shape, 0.16)
    if site.plan.area < LEAST_AREA or min(half, deep) < 5.0:
        rise = min(pitch * deep, 0.6 * high)
        return tuple(site.masses(site.plan, 0.0, high + rise, "", shape, rise))
    grown: list[Mass] = []
    rest: Any = site.plan
    side = 1.0 if plot.draw("gym side") < 0.5 else -1.0
    length = min(max(0.26 * 2 * half, 13.0), 27.0)
    if gym > 0 and 2 * half > 2.4 * length:
        depth = min(2 * deep, 1.5 * length)
        x0, x1 = sorted((side * half * 1.1, side * (half - length)))
        box = shapely.box(x0, -999, x1, -deep + depth)
        hall, rest = carve(rest, box)
        top = min(max(7.2, 0.42 * length), 10.0) * gym
        roof = plot.pick("gym roof", ("flat", "round", "gabled"), (3, 3, 2))
        up = {"flat": 0.0, "round": 0.14, "gabled": 0.12}[roof] * min(length, depth)
        grown += site.masses(hall, 0.0, top + up, "gym", roof, up)
    x0, _, x1, _ = rest.bounds
    front = min(2 * deep, 13.5)
    spot = plot.between("entrance", 0.34, 0.66)
    wide = min(max(0.13 * (x1 - x0), 7.0), 13.0)
    middle = x0 + spot * (x1 - x0)
    box = shapely.box(middle - wide / 2, deep - front, middle + wide / 2, 999)
    entrance, rest = carve(rest, box)
    if 2 * deep > DEEP and wings > 0:
        spine, back = carve(rest, shapely.box(-999, deep - front, 999, 999))
        grown += _wings(site, back, wings, high, storey, levels, shape, pitch)
        rest = spine
    rise = pitch * front / 2
    grown += site.masses(rest, 0.0, high + rise, "", shape, rise, down=_down(shape))
    top = high + storey * 0.9 * tower if tower > 0 else high
    grown += site.masses(entrance, 0.0, top, "entrance")
    return (*grown, *remainder(site, grown, storey + 0.6, "commons"))


def _down(shape: str) -> tuple[float, float] | None:
    return (0.0, -1.0) if shape == "skillion" else None


def _wings(site: Site, back: Any, wings: int, high: float, storey: float, levels: int, shape: str,
           pitch: float) -> list[Mass]:  # fmt: skip
    """Wings that run back from the front, and low halls between them."""
    x0, _, x1, _ = back.bounds
    count = min(wings, int((x1 - x0 + 7.0) / (WING + 7.0)))
    top = high if levels < 3 else high - storey
    grown: list[Mass] = []
    rest = back
    for number in range(count):
        share = number / max(count - 1, 1) if count > 1 else 0.0
        left = x0 + share * (x1 - x0 - WING)
        wing, rest = carve(rest, shapely.box(left, -999, left + WING, 999))
        rise = pitch * WING / 2 if shape != "skillion" else 0.1 * WING
        grown += site.masses(wing, 0.0, top + rise, "", shape, rise)
    return [*grown, *site.masses(rest, 0.0, storey + 0.6, "commons")]


_WALLS = (
    (4, "brick", (*REDS[:4], 0xA98A70, 0xB49A78)),
    (4, "plaster", (0xE2DCCB, 0xE6D9B4, 0xD3CFC7, 0xDCC7A4)),
    (2, "concrete", (0xC2C0BA, 0xB4B3AF)),
)
_FRAMES = (0xD9D6CE, 0x3F5A78, 0x8A2E2A, 0x3E5F50, 0xC28A2C, 0x3F4447)


def _look(*fixtures: Fixture, walls: Any = _WALLS, **more: Any) -> Look:
    given: dict[str, Any] = {
        "mode": "strip", "bay": 3.4, "windows": (("window_class", 1),),
        "doors": (("door_auto", 2), ("door_double", 1)), "sill": 0.85, "ground_storey": 3.7,
        "corner": 0.6, "heads": (("coping", 1),), "surrounds": (("", 1),), "back": "",
    } | more  # fmt: skip
    return Look(FacadeStyle(fixtures=fixtures, **given), walls, frames=_FRAMES)


_MAIN = _look(
    Fixture("bike_racks", "foot", spacing=18.0, street=True, share=0.8),
    scale=(1.0, 0.95),
    fins=(Strip("band_box", 0.4, 0.1, "wall", 0.96),),
    slabs=(Strip("band_paint", 0.62, 0.05, "frame", share=0.5),),
)
GENERATOR = Generator(
    "school",
    "School",
    _MAIN,
    zones=MappingProxyType(
        {
            "entrance": _look(
                Fixture("canopy_slab", "door", tint="frame"),
                Fixture("flag_pole", "front", lift=0.0, out=2.2),
                Fixture("letters_school", "foot", tint="accent", lift=3.6, street=True),
                Fixture("clock_panel", "edge", lift=-2.0, street=True),
                walls=(
                    (3, "plaster", (0xC98D4A, 0xB4554A, 0x4F7FA0, 0x7FA06A, 0xE6C45A)),
                    (2, "metal_panel", (0xB8862C, 0x8A2E2A, 0x2F5F80)),
                    (2, "brick", (0x7C4234, 0x6F4337)),
                ),
                scale=(1.0, 1.25), bay=3.0, sill=0.3, entrance=True,
            ),
            "gym": _look(
                Fixture("plinth_band", "foot", stretch="wall", out=0.02),
                Fixture("high_light", "edge", tint="frame", spacing=4.6, lift=-0.9),
                mode="punched", doors=(("door_service", 1),), scale=(0.0, 1.0),
                fins=(Strip("band_box", 0.45, 0.2, "wall", 0.94, spacing=4.6, lobby=False),),
            ),
            "commons": _look(
                windows=(("window_wide", 1), ("window_class", 1)), scale=(1.0, 1.0), sill=0.3,
            ),
        }
    ),
    mass=masses,
    pitched=(
        (4, "roof_tiles", (0x8E4B36, 0x7B4434)),
        (3, "slate", (0x50545A, 0x5C6064)),
        (3, "roof_metal", (0x7E8486, 0x6E7A78)),
    ),
    rooftop=MappingProxyType({"hvac_unit": 2, "vent": 4, "skylight": 5, "solar_panels": 5}),
    area=(150.0, 40000.0),
    levels=(1, 5),
    plot=(56.0, 92.0, 22.0, 46.0),
    floors=(2, 3),
    storey=3.7,
    use="school",
)  # fmt: skip


@action(
    "building/school-v1",
    limits=["Only footprints of a size that admits such a building change."],
    requires=("layout",),
    labels=("school", "college", "classroom", "gym", "education", "wings"),
)
def school(
    city: City,
    *,
    share: Annotated[float, Range(0.0, 1.0)] = 1.0,
    floors: Annotated[int, Range(0, 5)] = 0,
    building: Annotated[str | None, ObjectName()] = None,
    wings: Annotated[int, Range(0, 5)] = 2,
    gym: Annotated[float, Range(0.0, 1.6)] = 1.0,
    tower: Annotated[float, Range(0.0, 3.0)] = 1.0,
    noise: Annotated[float, Range(0.0, 1.0)] = 0.5,
) -> City:
    """Build schools: ribbon windows in long wings, a coloured entrance, a gymnasium.

    The entrance stands higher, with canopy, clock and flag; deep plots have wings that run back
    about low halls; the gymnasium is a hall of its own at one end.

    Parameters
    ----------
    share
        Share of the buildings that become one.
    floors
        Storeys, 0 to keep those of each building.
    building
        The one building to change, or None for all.
    wings
        Wings that run back from the front, where the plot is deep enough.
    gym
        Height of the gymnasium relative to the usual one; 0 leaves it out.
    tower
        Storeys, about, by which the entrance stands above the wings.
    noise
        How far measures vary; 0 is regular.
    """
    mass = partial(masses, wings=wings, gym=gym, tower=tower)
    return redesign(
        city, GENERATOR, share=share, floors=floors, building=building, mass=mass, noise=noise
    )
