"""Hospitals: slabs of wards in a cross, an H or a comb on a broad base, plant and a helipad."""

from __future__ import annotations

from functools import partial
from types import MappingProxyType
from typing import Annotated, Any

import numpy as np
import shapely

from cityx.assets.styles.facade_styles import FacadeStyle, Fixture, Strip
from cityx.assets.styles.generators import Generator, Look
from cityx.building.design import redesign
from cityx.building.massing.massing import Mass, Plot, Site, carve, disc, site_of
from cityx.city.city import City
from cityx.protocol import Choice, ObjectName, Range, action

LEAST_AREA = 450.0  # square metres from which wards stand on a base
PAD = 9.2  # metres, radius of a helipad
PLANS = ("any", "slab", "cross", "h", "comb", "tee")


def masses(
    plot: Plot, *, plan: str = "any", base: int = 2, helipad: bool = True
) -> tuple[Mass, ...]:
    """Set the wards on the base, a core through them, and plant and a pad on top."""
    site = site_of(plot)
    half, deep = site.half
    storey = plot.storey
    high = plot.height - plot.rise
    levels = max(plot.levels, 1)
    if site.plan.area < LEAST_AREA or min(half, deep) < 7.0 or levels < 3 or base >= levels:
        zone = "base" if levels < 3 else "ward"
        return tuple(site.masses(site.plan, 0.0, high, zone))
    low = max(base, 1) * storey
    word = plan if plan != "any" else plot.pick("plan", PLANS[1:], (1.5, 3, 3, 3, 2))
    inner = site.plan.buffer(-1.2, join_style="mitre")
    thick = min(max(0.3 * 2 * deep, 11.0), 17.0) * (0.94 + 0.12 * plot.draw("thickness"))
    wards = shapely.intersection(_plan(word, half, deep, thick), inner, grid_size=0.01)
    parts = [p for p in shapely.get_parts(wards) if p.area > 60.0 and p.geom_type == "Polygon"]
    if not parts:
        return tuple(site.masses(site.plan, 0.0, high, "ward"))
    grown = site.masses(site.plan, 0.0, low, "base")
    body: Any = shapely.multipolygons(np.array(parts, object))
    size = min(0.75 * thick, 11.0)
    at = parts[0].centroid if word != "h" else shapely.Point(0.0, 0.0)
    box = shapely.box(at.x - size / 2, at.y - size / 2, at.x + size / 2, at.y + size / 2)
    core = shapely.Polygon()
    if shapely.intersection(body, box).area > 0.97 * box.area:
        core, body = carve(body, box)
    top = high + 1.3 * storey
    grown += site.masses(core, low, top, "core")
    grown += site.masses(body, low, high, "ward")
    pad = disc(at.x, at.y, PAD, 16)
    padded = helipad and site.plan.area > 1500 and not core.is_empty and site.plan.covers(pad)
    if padded:
        grown += site.masses(pad, top, top + 0.9, "pad")
    plants = _plants(body, site, thick, plot)
    if not core.is_empty:
        plants = shapely.difference(plants, pad if padded else box.buffer(1.0))
    if padded:
        grown += site.masses(plants, high, high + 0.95 * storey, "plant")
    else:
        grown += site.masses(plants, high, high + 1.05 * storey, "plant")
    return tuple(grown)


def _plan(word: str, half: float, deep: float, thick: float) -> Any:
    """Return the outline of the wards on a box."""
    t = thick / 2
    bar = shapely.box(-0.94 * half, -t, 0.94 * half, t)
    if word == "cross":
        return bar | shapely.box(-t, -deep, t, deep)
    if word == "h":
        x = 0.72 * half
        ends = [shapely.box(s * x - 0.9 * t, -deep, s * x + 0.9 * t, deep) for s in (-1, 1)]
        return shapely.union_all([bar, *ends])
    if word == "comb":
        back = shapely.box(-0.96 * half, -deep, 0.96 * half, -deep + 1.7 * t)
        count = max(2, min(4, int(2 * half / (3.6 * t))))
        teeth = []
        for number in range(count):
            x = -0.96 * half + 0.8 * t + (1.92 * half - 1.6 * t) * number / (count - 1)
            teeth.append(shapely.box(x - 0.8 * t, -deep, x + 0.8 * t, 0.8 * deep))
        return shapely.union_all([back, *teeth])
    if word == "tee":
        return bar | shapely.box(-t, -deep, t, 0.0)
    return bar


def _plants(body: Any, site: Site, thick: float, plot: Plot) -> Any:
    """Plant rooms along the middle of the wards' roofs."""
    inner = body.buffer(-0.24 * thick, join_style="mitre")
    half = site.half[0]
    swing = 0.3 * half * (2 * plot.draw("plant") - 1) * min(1.0, 2 * plot.noise)
    zone = shapely.box(swing - 0.55 * half, -999, swing + 0.55 * half, 999)
    cut = shapely.intersection(inner, zone, grid_size=0.01)
    parts = [p for p in shapely.get_parts(cut) if p.geom_type == "Polygon" and p.area > 14.0]
    return shapely.multipolygons(np.array(parts, object))


_WALLS = (
    (4, "plaster", (0xE6E4DE, 0xDCD8CE, 0xD3CFC7, 0xE0DDD2)),
    (3, "metal_panel", (0xDADBD8, 0xC6C8C8, 0xE2E2DE)),
    (2, "brick", (0xA98A70, 0xB49A78, 0x96543F)),
    (2, "concrete", (0xCBC8C0, 0xC2C0BA)),
)
_FRAMES = (0xD9D6CE, 0x4F7FA0, 0x5E9A8C, 0x3F4447, 0xC8C6BE)


def _look(*fixtures: Fixture, walls: Any = _WALLS, **more: Any) -> Look:
    given: dict[str, Any] = {
        "mode": "punched", "bay": 3.7, "windows": (("window_ward", 1),),
        "doors": (("door_auto", 1),), "sill": 0.8, "ground_storey": 4.2, "corner": 0.5,
        "heads": (("coping", 1),), "surrounds": (("", 1),), "back": "",
    } | more  # fmt: skip
    return Look(FacadeStyle(fixtures=fixtures, **given), walls, frames=_FRAMES)


_WARD = _look(
    slabs=(Strip("band_paint", 0.45, 0.06, "trim", share=0.7),),
    fins=(Strip("band_box", 0.22, 0.12, "frame", every=3, share=0.5),),
)
GENERATOR = Generator(
    "hospital",
    "Hospital",
    _WARD,
    zones=MappingProxyType(
        {
            "ward": _WARD,
            "base": _look(
                Fixture("canopy_ambulance", "door"),
                Fixture("letters_hospital", "front", tint="accent", lift=4.6),
                walls=(
                    (3, "metal_panel", (0x8E9498, 0xB9BCBC, 0x4A5056)),
                    (3, "brick", (0x8C4A3A, 0xA98A70, 0x7C4234)),
                    (2, "stone", (0xC4B79C, 0xB8AC97)),
                ),
                mode="strip", bay=3.4, windows=(("window_strip", 1),), sill=0.6,
                scale=(1.0, 1.25),
            ),
            "core": _look(
                Fixture("cross_sign", "edge", lift=-2.6),
                windows=(("window_slit", 1),), bay=4.0, scale=(1.0, 0.8),
            ),
            "plant": _look(
                walls=((1, "metal_panel", (0x8E9498, 0x7C8388, 0xA7AAAB)),),
                scale=(0.0, 1.0),
                fins=(Strip("band_frame", 0.05, 0.09, "wall", 0.75, spacing=0.5, lobby=False),),
            ),
            "pad": _look(Fixture("helipad_marks", "top", lift=-0.2), scale=(0.0, 1.0),
                         walls=((1, "concrete", (0xA3A29E,)),), heads=(("", 1),)),
        }
    ),
    mass=masses,
    flat=((3, "roof_gravel", (0x8B8780, 0x9B978F)), (2, "bitumen", (0x8F8E8A, 0xA2A19C))),
    rooftop=MappingProxyType({"hvac_unit": 9, "condenser": 4, "vent": 4, "lift_house": 2}),
    area=(200.0, 60000.0),
    levels=(1, 16),
    plot=(62.0, 98.0, 40.0, 62.0),
    floors=(5, 9),
    storey=3.9,
    use="hospital",
)  # fmt: skip


@action(
    "building/hospital-v1",
    limits=["Only footprints of a size that admits such a building change."],
    requires=("layout",),
    labels=("hospital", "clinic", "wards", "health", "helipad", "cross"),
)
def hospital(
    city: City,
    *,
    share: Annotated[float, Range(0.0, 1.0)] = 1.0,
    floors: Annotated[int, Range(0, 16)] = 0,
    building: Annotated[str | None, ObjectName()] = None,
    plan: Annotated[str, Choice(*PLANS)] = "any",
    base: Annotated[int, Range(1, 5)] = 2,
    helipad: bool = True,
    noise: Annotated[float, Range(0.0, 1.0)] = 0.5,
) -> City:
    """Build hospitals: slabs of wards on a broad base.

    The base covers the plot, with an ambulance canopy at the entrance; the wards stand on it in a
    slab, a cross, an H, a comb or a T, with a core, plant rooms and, on large ones, a helipad.

    Parameters
    ----------
    share
        Share of the buildings that become one.
    floors
        Storeys, 0 to keep those of each building.
    building
        The one building to change, or None for all.
    plan
        Plan of the wards.
    base
        Storeys of the base.
    helipad
        Whether large ones have a helipad.
    noise
        How far measures vary; 0 is regular.
    """
    mass = partial(masses, plan=plan, base=base, helipad=helipad)
    return redesign(
        city, GENERATOR, share=share, floors=floors, building=building, mass=mass, noise=noise
    )
