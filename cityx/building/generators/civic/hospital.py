"""Hospitals: slabs of wards in a cross, an H or a comb on a broad base, plant and a helipad."""

from __future__ import annotations

from typing import Annotated, Any

import numpy as np
import shapely

from cityx.building.generators import action_of, generator
from cityx.building.massing.massing import Mass, Plot, Site, carve, disc, site_of
from cityx.protocol import Choice, Range

LEAST_AREA = 450.0  # square metres from which wards stand on a base
PAD = 9.2  # metres, radius of a helipad
PLANS = ("any", "slab", "cross", "h", "comb", "tee")


def masses(
    plot: Plot,
    *,
    plan: Annotated[str, Choice(*PLANS)] = "any",
    base: Annotated[int, Range(1, 5)] = 2,
    helipad: bool = True,
) -> tuple[Mass, ...]:
    """Build hospitals: slabs of wards on a broad base.

    The base covers the plot, with an ambulance canopy at the entrance; the wards stand on it in a
    slab, a cross, an H, a comb or a T, with a core, plant rooms and, on large ones, a helipad.

    Set the wards on the base, a core through them, and plant and a pad on top.

    Parameters
    ----------
    plan
        Plan of the wards.
    base
        Storeys of the base.
    helipad
        Whether large ones have a helipad.
    """
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


GENERATOR = generator(masses)
hospital = action_of("building/hospital-v1", GENERATOR, masses)
