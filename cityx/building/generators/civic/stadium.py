"""Stadiums: tiers in rings down to a pitch, a roof on posts around them, floodlights."""

from __future__ import annotations

import math
from functools import partial
from itertools import pairwise
from types import MappingProxyType
from typing import Annotated, Any

import shapely

from cityx.assets.styles.facade_styles import FacadeStyle, Fixture, Strip
from cityx.assets.styles.generators import Generator, Look
from cityx.building.design import redesign
from cityx.building.massing.massing import GRID, Mass, Plot, Site, carve, disc, site_of
from cityx.city.city import City
from cityx.protocol import Choice, ObjectName, Range, action

LEAST = 26.0  # metres of the shorter side; a smaller plot has no room for a pitch
STEP = 1.9  # metres, the least depth of a ring
SHAPES = ("any", "oval", "rounded", "angular")
TALLEST = 46.0  # metres


def masses(
    plot: Plot, *, shape: str = "any", roof: float = 0.55, masts: int = 4, tiers: int = 9
) -> tuple[Mass, ...]:
    """Draw rings about a pitch, each lower than the one outside it."""
    site = site_of(plot)
    half, deep = site.half
    outer = shapely.Polygon(site.plan.exterior) if site.plan.geom_type == "Polygon" else site.plan
    if 2 * min(half, deep) < LEAST or outer.area < 900:
        return _stand(site, plot, roof, tiers)
    word = shape if shape != "any" else plot.pick("shape", SHAPES[1:], (4, 3, 2))
    outer = _bowl(outer, half, deep, word)
    depth = min(max(0.24 * 2 * deep, 7.0), 42.0)
    field = _field(site, outer, depth)
    reach = outer.exterior.distance(field) if not field.is_empty else 0.0
    if reach < 4.0:
        return _stand(site, plot, roof, tiers)
    high = min(max(plot.height, 0.30 * reach + 3.0), 0.62 * reach + 6.0, TALLEST)
    count = int(min(max(reach / STEP, 2), tiers))
    # A wall about the field, then the rings; the outermost is the concourse and the facade.
    rim = min(max(0.14 * reach, 1.8), 5.0)
    rings = [outer, outer.buffer(-rim, join_style="mitre")]
    for step in range(1, count + 1):
        share = step / count
        rings.append(_between(rings[1], field, share))
    rings = [shapely.set_precision(ring, GRID) for ring in rings]
    grown: list[Mass] = []
    low = 1.1
    for step, (a, b) in enumerate(pairwise(rings)):
        ring = shapely.difference(a, b, grid_size=GRID)
        share = 1.0 - step / max(count, 1)
        top = low + (high - low) * max(share, 0.0) ** 1.15
        top = high + 0.9 if step == 0 else top
        if step:
            grown += site.masses(ring, 0.0, top + 0.3, "tier", "rimmed", 0.3)
        else:
            grown += site.masses(ring, 0.0, top)
    grown += site.masses(rings[-1], 0.0, 0.5, "pitch", walls=False)
    poles = _masts(outer, masts, half, deep)
    if roof > 0 and reach > 7.0:
        inner = _between(rings[1], field, min(roof, 0.9))
        cover = shapely.difference(outer.buffer(-0.25 * rim), inner, grid_size=GRID)
        cover = shapely.difference(cover, shapely.union_all(poles).buffer(0.4), grid_size=GRID)
        lift = min(max(0.1 * reach, 2.4), 5.0)
        grown += site.masses(cover, high + 1.0, high + 1.0 + lift, "cover", walls=False)
    tall = min(0.9 * high + 12.0, 38.0)
    for pole in poles:
        grown += site.masses(pole, high + 0.9, high + tall, "mast")
    return tuple(grown)


def _stand(site: Site, plot: Plot, roof: float, tiers: int) -> tuple[Mass, ...]:
    """Build one grandstand where there is no room for a pitch: steps that fall away from a wall."""
    half, deep = site.half
    high = min(max(plot.height, 4.0), 0.55 * 2 * deep + 4.0)
    if min(half, deep) < 2.5:
        return (plot.body,)
    wall = min(max(0.22 * 2 * deep, 1.6), 5.0)
    count = int(min(max((2 * deep - wall) / STEP, 2), tiers))
    back, rest = carve(site.plan, shapely.box(-999, deep - wall, 999, 999))
    grown = site.masses(back, 0.0, high)
    for step in range(count):
        y1 = deep - wall - (2 * deep - wall) * step / count
        y0 = deep - wall - (2 * deep - wall) * (step + 1) / count
        row = shapely.intersection(rest, shapely.box(-999, y0, 999, y1), grid_size=GRID)
        top = 1.2 + (high - 1.9) * (1.0 - (step + 0.5) / count)
        grown += site.masses(row, 0.0, top + 0.2, "tier", "rimmed", 0.2)
    if roof > 0:
        edge = deep - wall - roof * (2 * deep - wall)
        cover = shapely.intersection(site.plan, shapely.box(-999, edge, 999, 999), grid_size=GRID)
        grown += site.masses(cover, high + 0.1, high + 3.0, "cover", walls=False)
    return tuple(grown)


def _bowl(outer: Any, half: float, deep: float, word: str) -> Any:
    """Round the corners of a plan that is a plain rectangle; a mapped bowl keeps its outline."""
    if shapely.get_num_coordinates(outer) > 9 or outer.area < 0.93 * 4 * half * deep:
        return outer
    if word == "oval":
        circle = shapely.Point(0, 0).buffer(1.0, quad_segs=12)
        power = [
            (math.copysign(abs(x) ** 0.82, x) * half, math.copysign(abs(y) ** 0.82, y) * deep)
            for x, y in circle.exterior.coords[:-1]
        ]
        return shapely.Polygon(power)
    radius = (0.55 if word == "rounded" else 0.3) * min(half, deep)
    inner = outer.buffer(-radius, join_style="mitre")
    segments = 5 if word == "rounded" else 1
    return inner.buffer(radius, quad_segs=segments)


def _field(site: Site, outer: Any, depth: float) -> Any:
    """Field inside the stands: the hole of a mapped ring, or a rounded rectangle within."""
    holes = [shapely.Polygon(ring) for ring in site.plan.interiors]
    large = [hole for hole in holes if hole.area > 0.12 * outer.area]
    if large:
        return max(large, key=lambda hole: hole.area).simplify(0.4)
    inner = outer.buffer(-depth)
    if inner.is_empty or inner.area < 150 or inner.geom_type != "Polygon":
        return shapely.Polygon()
    return inner


def _between(outer: Any, field: Any, share: float) -> Any:
    """Return the outline a share of the way from the stands' outer edge to the field."""
    if share >= 1.0:
        return field
    # Offsets of the field outwards, so that its proportions come out in the lowest rows.
    reach = outer.exterior.distance(field)
    grown = field.buffer((1.0 - share) * reach, quad_segs=4)
    return shapely.intersection(grown, outer.buffer(-0.02), grid_size=GRID)


def _masts(outer: Any, masts: int, half: float, deep: float) -> list[Any]:
    """Plans of masts on the outer ring, from the diagonals on."""
    line = outer.buffer(-1.2, join_style="mitre").exterior
    poles = []
    for number in range(masts):
        turn = 2 * math.pi * (number + 0.5) / masts
        ray = shapely.LineString([(0, 0), (3 * half * math.cos(turn), 3 * deep * math.sin(turn))])
        hit = shapely.intersection(ray, line)
        if not hit.is_empty:
            x, y = shapely.get_coordinates(hit)[0].tolist()
            poles.append(disc(x, y, 0.62, 8))
    return poles


_WALLS = (
    (4, "concrete", (0xC2C0BA, 0xB4B3AF, 0xCBC8C0)),
    (3, "metal_panel", (0xC6C8C8, 0xA7AAAB, 0xDADBD8)),
    (1, "brick", (0x8C4A3A, 0x96543F)),
)
_SEATS = (
    (3, "bitumen", (0x2F4F86, 0x34558C)),
    (3, "bitumen", (0x9A2F2B, 0x8A2A28)),
    (2, "bitumen", (0x2E6B45, 0x3A7A50)),
    (1, "bitumen", (0xB8862C, 0x5A5D5F)),
)
_PLAIN = ((1, "concrete", (0xA3A29E, 0xB4B3AF)),)
_METAL = ((1, "metal_panel", (0xB9BCBC, 0x8C9398)),)


def _plain(*fixtures: Fixture, walls: Any = _PLAIN, head: str = "") -> Look:
    style = FacadeStyle(
        "punched", 6.0, (("window_strip", 1),), (("door_service", 1),), scale=(0.0, 1.0),
        surrounds=(("", 1),), back="", heads=((head, 1),), fixtures=fixtures,
    )  # fmt: skip
    return Look(style, walls)


GENERATOR = Generator(
    "stadium",
    "Stadium",
    Look(
        FacadeStyle(
            "punched", 5.0, (("window_gallery", 1),), (("door_auto", 1),), sill=0.5,
            ground_storey=4.4, corner=0.3, surrounds=(("", 1),), back="", heads=(("coping", 1),),
            fins=(Strip("band_box", 0.32, 0.95, "trim", spacing=5.0, lobby=False),),
            slabs=(Strip("band_box", 0.7, 0.4, "wall", 0.95),),
            fixtures=(
                Fixture("turnstile_gate", "foot", tint="", spacing=10.0, street=True),
                Fixture("letters_arena", "edge", tint="sign", lift=-1.2, street=True,
                        scattered=True, share=0.12),
            ),
        ),
        _WALLS,
        frames=(0xB4B3AF, 0x9DA1A3, 0xC2C0BA),
    ),
    zones=MappingProxyType(
        {
            "tier": _plain(),
            "pitch": _plain(Fixture("pitch_field", "top", stretch="plan", lift=0.02)),
            "cover": _plain(),
            "mast": _plain(Fixture("floodlight", "top"), walls=_METAL),
        }
    ),
    mass=masses,
    pitched=_SEATS,
    flat=((2, "roof_metal", (0xC9CBCB, 0xAEB0AF)), (1, "bitumen", (0xB0AEA6,))),
    area=(150.0, 200000.0),
    levels=(1, 9),
    width=(6.0, 400.0),
    plot=(120.0, 190.0, 95.0, 150.0),
    floors=(4, 6),
    storey=4.6,
    use="stadium",
    covers=False,
)  # fmt: skip


@action(
    "building/stadium-v1",
    limits=[
        "Only footprints of a size that admits such a building change.",
        "The seats of a row are one step; there are no single seats.",
    ],
    requires=("layout",),
    labels=("stadium", "arena", "sport", "football", "grandstand"),
)
def stadium(
    city: City,
    *,
    share: Annotated[float, Range(0.0, 1.0)] = 1.0,
    floors: Annotated[int, Range(0, 9)] = 0,
    building: Annotated[str | None, ObjectName()] = None,
    shape: Annotated[str, Choice(*SHAPES)] = "any",
    roof: Annotated[float, Range(0.0, 0.9)] = 0.55,
    masts: Annotated[int, Range(0, 8)] = 4,
    tiers: Annotated[int, Range(2, 20)] = 9,
    noise: Annotated[float, Range(0.0, 1.0)] = 0.5,
) -> City:
    """Build stadiums: a bowl of tiers about a pitch.

    The outer ring is a facade of fins and gates; tiers step down to a marked pitch; a roof on
    posts covers the upper ones, and floodlights stand on the rim. Where there is no room for a
    pitch one grandstand is built.

    Parameters
    ----------
    share
        Share of the buildings that become one.
    floors
        Storeys, 0 to keep those of each building.
    building
        The one building to change, or None for all.
    shape
        Outline on a plain plot; a mapped bowl keeps its own.
    roof
        Share of the tiers' depth that is roofed; 0 leaves the roof out.
    masts
        Number of floodlight masts.
    tiers
        Number of steps.
    noise
        How far measures vary; 0 is regular.
    """
    mass = partial(masses, shape=shape, roof=roof, masts=masts, tiers=tiers)
    return redesign(
        city, GENERATOR, share=share, floors=floors, building=building, mass=mass, noise=noise
    )
