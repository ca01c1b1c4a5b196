"""A coast: the sea along one side of a city or all round it, a beach, and a promenade behind it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Annotated, Any

import numpy as np
import shapely

from cityx.city import City, Layout
from cityx.city.asked_goals import asked, with_goal
from cityx.errors import ActionFailed
from cityx.ids import draw
from cityx.places.profiles import profile_of
from cityx.protocol import Choice, Port, Range, action
from cityx.sources.features.tagged import Owner, Tags
from cityx.town.cutting import strip_of, with_streets
from cityx.town.procedural_streets import half_width, shore_tags
from cityx.town.rebuilding import WET, with_area

# Outward of each side: x east, y north.
SIDES: Mapping[str, tuple[float, float]] = {
    "north": (0.0, 1.0), "east": (1.0, 0.0), "south": (0.0, -1.0), "west": (-1.0, 0.0),
}  # fmt: skip
SWING, WAVE = 9.0, 260.0  # metres that a shore swings by, and of its waves
STEP = 15.0  # metres between the points of a shore
ALL = "all"  # the sea all round: the city is an island
ROUND, WAVES = 0.3, 5  # of an island's shorter side, radius of its corners; waves of its shore
LEAST_LAND = 60.0  # metres of the site that the sea leaves


@action(
    "layout/coast-v1",
    limits=["What lies in the sea's way is taken down; streets end on the promenade."],
    requires=("layout",),
    after=("layout/infill-v1",),
    takes=(Port("layout", "scene_layout"),),
    gives=(Port("layout", "scene_layout"),),
    labels=("sea", "beach", "shore", "coast", "ocean", "island"),
)
def coast(
    city: City,
    *,
    side: Annotated[str, Choice(*SIDES, ALL)] = "south",
    share: Annotated[float, Range(0.05, 0.8)] = 0.25,
    beach: Annotated[float, Range(0.0, 200.0)] = 35.0,
    quay: Annotated[float, Range(0.0, 120.0)] = 0.0,
) -> City:
    """Put the sea along one side of a city or all round it, behind a beach and a promenade.

    Parameters
    ----------
    city
        City with streets.
    side
        Where the sea lies; "all" makes the city an island.
    share
        Of the site's depth that way which is sea, about; of its area where the sea is all round.
    beach
        Metres of sand between the promenade and the water; 0 for a quay.
    quay
        Metres of paving there instead of sand, for cranes and goods.
    """
    beach = 0.0 if quay else beach
    tags = shore_tags(city.seed, "promenade", 0)
    walk = half_width(tags, profile_of(city.frame))
    apron = quay or beach
    if side == ALL:
        return _island(city, tags, share, apron, walk, paved=bool(quay))
    xmin, ymin, xmax, ymax = city.layout.extent
    out = np.array(SIDES[side])
    size = np.array([xmax - xmin, ymax - ymin])
    deep = float(abs(size @ out))
    land = deep * (1 - share) - apron - 2 * walk
    if land < LEAST_LAND:
        raise ActionFailed(
            f"A sea over {share:g} of {deep:.0f} m and a beach or quay of {apron:g} m leave "
            f"{max(land, 0.0):.0f} m of land; {LEAST_LAND:.0f} m are needed. "
            "Ask for less sea or a larger site."
        )
    shore = _shore(city, out, deep / 2 - share * deep, 1.0)
    street = _shore(city, out, deep / 2 - share * deep - apron - walk, 0.6)
    site = shapely.box(*city.layout.extent)
    beyond = _outside(street, out, deep)
    sea = _outside(shore, out, deep).intersection(site)
    rivers = city.layout.areas[city.layout.areas["kind"] == "river"].geometry.to_numpy()
    if shapely.intersects(rivers, beyond).any():
        raise ActionFailed(f"A river flows to the {side}; a coast there has to come before it.")
    line = shapely.LineString(np.round(shapely.get_coordinates(street.intersection(site)), 3))
    ground = shapely.union(beyond, strip_of(street, tags, city)).intersection(site)
    owner = Owner(("made", "promenade"), tags)
    city = with_streets(city, [(line, owner)], ground)
    sand = beyond.difference(strip_of(street, tags, city)).intersection(site).difference(sea)
    layout = _with_land(city.layout, "sea", sea)
    if apron:
        layout = _with_land(layout, "pedestrian" if quay else "sand", sand)
    city = asked(replace(city, layout=layout), f"the sea in the {side}", "n(sea)", least=1)
    return asked(city, f"a beach in the {side}", "n(beach)", least=1) if beach else city


def _island(
    city: City, tags: Tags, share: float, apron: float, walk: float, *, paved: bool
) -> City:
    """Put the sea all round a city."""
    xmin, ymin, xmax, ymax = city.layout.extent
    site = shapely.box(*city.layout.extent)
    wide, deep = xmax - xmin, ymax - ymin
    # (wide - 2 a) (deep - 2 a) = (1 - share) wide deep, the rounded corners aside.
    half = (wide + deep) / 4
    inset = half - np.sqrt(half**2 - share * wide * deep / 4)
    land = min(wide, deep) - 2 * (inset + apron + 2 * walk)
    if land < LEAST_LAND:
        raise ActionFailed(
            f"A sea over {share:g} of {wide:.0f} m by {deep:.0f} m and a beach or quay of "
            f"{apron:g} m round an island leave {max(land, 0.0):.0f} m of land; "
            f"{LEAST_LAND:.0f} m are needed. Ask for less sea or a larger site."
        )
    wet = city.layout.areas["kind"].isin(WET)
    if (
        wet.any()
        and shapely.intersects(
            city.layout.areas.geometry.to_numpy()[wet.to_numpy()], site.exterior
        ).any()
    ):
        raise ActionFailed("Water flows out of the site; an island has to come before it.")
    shore = _closed_shore(city, inset, min(SWING, inset / 2))
    street = _closed_shore(city, inset + apron + walk, 0.6 * min(SWING, inset / 2))
    inner = shapely.Polygon(street)
    line = shapely.LineString(np.round(shapely.get_coordinates(street), 3))
    strip = strip_of(line, tags, city)
    beyond = shapely.difference(site, inner)
    owner = Owner(("made", "promenade"), tags)
    city = with_streets(city, [(line, owner)], shapely.union(beyond, strip))
    sea = shapely.difference(site, shapely.Polygon(shore))
    layout = _with_land(city.layout, "sea", sea)
    sand = shapely.difference(shapely.difference(beyond, strip), sea)
    layout = _with_land(layout, "pedestrian" if paved else "sand", sand)
    city = asked(replace(city, layout=layout), "a town on an island", "n(island)", least=1)
    city = with_goal(city, "all houses on the island", "n(building) == n(building, in=island)")
    return asked(city, "a beach", "n(beach)", least=1) if apron and not paved else city


def _closed_shore(city: City, inset: float, swing: float) -> Any:
    """Return a ring round the middle of the site, so far from its border."""
    site = shapely.box(*city.layout.extent)
    inner = shapely.buffer(site, -inset, join_style="mitre")
    radius = ROUND * float(np.ptp(shapely.get_coordinates(inner), axis=0).min())
    ring = shapely.buffer(shapely.buffer(inner, -radius, join_style="mitre"), radius).exterior
    share = np.linspace(0.0, 1.0, int(ring.length / STEP) + 2)
    at = shapely.get_coordinates(shapely.line_interpolate_point(ring, share, normalized=True))
    middle = shapely.get_coordinates(site.centroid)[0]
    turn = np.arctan2(*(at - middle).T[::-1])
    phase = 2 * np.pi * draw(city.seed, "layout/coast", 1)
    out = (at - middle) / np.hypot(*(at - middle).T)[:, None]
    points = at + (swing * np.sin(phase + WAVES * turn))[:, None] * out
    return shapely.LinearRing(np.concatenate([points[:-1], points[:1]]))


def _shore(city: City, out: Any, at: float, swing: float) -> Any:
    """Return a line along the shore, from beyond one border to beyond the other."""
    xmin, ymin, xmax, ymax = city.layout.extent
    middle = np.array([(xmin + xmax) / 2, (ymin + ymax) / 2])
    along = np.array([-out[1], out[0]])
    half = float(abs(np.array([xmax - xmin, ymax - ymin]) @ along)) / 2 + WAVE
    t = np.linspace(-half, half, int(2 * half / STEP) + 2)
    phase = 2 * np.pi * draw(city.seed, "layout/coast", 1)
    away = at + swing * SWING * np.sin(phase + 2 * np.pi * t / WAVE)
    return shapely.LineString(middle + t[:, None] * along + away[:, None] * out)


def _outside(line: Any, out: Any, far: float) -> Any:
    """Return what lies seaward of a line."""
    points = shapely.get_coordinates(line)
    return shapely.Polygon(np.concatenate([points, (points + far * out)[::-1]]))


def _with_land(layout: Layout, kind: str, shape: Any) -> Layout:
    for k, part in enumerate(shapely.get_parts(shape)):
        owner = Owner(("made", kind, k), {})
        layout = with_area(layout, kind, shapely.orient_polygons(part), owner)
    return layout
