"""Stadiums: tiers in rings down to a pitch, a roof on posts around them, floodlights."""

from __future__ import annotations

import math
from itertools import pairwise
from typing import Annotated, Any

import shapely

from cityx.building.generators import action_of, generator
from cityx.building.massing.massing import GRID, Mass, Plot, Site, carve, disc, site_of
from cityx.protocol import Choice, Range

LEAST = 26.0  # metres of the shorter side; a smaller plot has no room for a pitch
STEP = 1.9  # metres, the least depth of a ring
SHAPES = ("any", "oval", "rounded", "angular")
TALLEST = 46.0  # metres


def masses(
    plot: Plot,
    *,
    shape: Annotated[str, Choice(*SHAPES)] = "any",
    roof: Annotated[float, Range(0.0, 0.9)] = 0.55,
    masts: Annotated[int, Range(0, 8)] = 4,
    tiers: Annotated[int, Range(2, 20)] = 9,
) -> tuple[Mass, ...]:
    """Build stadiums: a bowl of tiers about a pitch.

    The outer ring is a facade of fins and gates; tiers step down to a marked pitch; a roof on
    posts covers the upper ones, and floodlights stand on the rim. Where there is no room for a
    pitch one grandstand is built.

    Draw rings about a pitch, each lower than the one outside it.

    Parameters
    ----------
    shape
        Outline on a plain plot; a mapped bowl keeps its own.
    roof
        Share of the tiers' depth that is roofed; 0 leaves the roof out.
    masts
        Number of floodlight masts.
    tiers
        Number of steps.
    """
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


GENERATOR = generator(masses)
stadium = action_of("building/stadium-v1", GENERATOR, masses)
