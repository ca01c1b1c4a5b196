"""From features to a layout in which nothing is missing, the same for every source."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.city import Frame, Layout
from cityx.city.layout import empty_table
from cityx.places.profiles import profile_of
from cityx.sources.features.clipping import Box
from cityx.sources.features.density import Density, measure_density
from cityx.sources.features.parts import building_tables, known_levels
from cityx.sources.features.road_features import road_table
from cityx.sources.features.shells import Shells
from cityx.sources.features.tagged import Tagged, nothing, told_apart
from cityx.sources.features.vertical import read_vertical

if TYPE_CHECKING:
    from geopandas import GeoDataFrame


from math import nan
from typing import TYPE_CHECKING

from cityx.city.layout import make_table
from cityx.ids import uniform
from cityx.sources.features import measures
from cityx.sources.features.kinds import line_kind, point_kind
from cityx.sources.features.tagged import Tags
from cityx.sources.features.vocabulary import BARRIER_HEIGHT, LINE_HEIGHT, POINT_HEIGHT

if TYPE_CHECKING:
    from geopandas import GeoDataFrame

# Tables of areas, lines that stand, and things at a place.

HIGHEST_LINE = 40.0  # metres; a wall that is higher is a mistake in its unit
EDGE = 0.6  # metres from a street to a barrier that is drawn as one with it
HIGHEST_POINT = 90.0  # metres; no tree is higher


def area_table(areas: Tagged, kinds: NDArray[Any]) -> GeoDataFrame:
    """Make the table of areas of given kinds."""
    return make_table("areas", areas.shapes, kind=kinds, **areas.columns())


def line_table(lines: Tagged) -> GeoDataFrame:
    """Make the table of lines that stand: walls, fences, hedges and rows of trees."""
    tags = lines.tags()
    kinds = [line_kind(own) for own in tags]
    heights = [
        measures.measure(own.get("height"), 0.1, HIGHEST_LINE)
        or BARRIER_HEIGHT.get(own.get("barrier") or own.get("power", ""), LINE_HEIGHT[kind])
        for own, kind in zip(tags, kinds, strict=True)
    ]
    columns = lines.columns()
    del columns["name"]
    return make_table("lines", lines.shapes, kind=kinds, height=heights, **columns)


def beside_streets(lines: GeoDataFrame, roads: GeoDataFrame) -> GeoDataFrame:
    """Move barriers that are drawn as one with a street to its right edge, behind the walk."""
    width = roads["width"] / 2 + roads["sidewalk_right"] + EDGE
    room = dict(zip(roads["source"], width, strict=True))
    drawn = shapely.get_type_id(lines.geometry.to_numpy()) == 1
    rows = np.flatnonzero(lines["source"].isin(room) & drawn)
    shapes = lines.geometry.to_numpy().copy()
    for row in rows.tolist():
        moved = shapely.offset_curve(shapes[row], -room[lines["source"].iloc[row]])
        parts = shapely.get_parts(moved)
        if len(parts):
            shapes[row] = max(parts, key=shapely.length)
    return lines.set_geometry(shapes) if len(rows) else lines


def point_table(points: Tagged, *, seed: int) -> GeoDataFrame:
    """Make the table of things at a place: trees, furniture, crossings and entrances."""
    tags = points.tags()
    kinds = [point_kind(own) for own in tags]
    columns = points.columns()
    del columns["name"]
    usual = np.array([POINT_HEIGHT.get(kind, (1.0, 1.0)) for kind in kinds], float).reshape(-1, 2)
    drawn = uniform(seed, "osm/point-height", columns["id"])
    height = usual[:, 0] + drawn * (usual[:, 1] - usual[:, 0])
    known = np.array([_height(own) for own in tags], float)
    return make_table(
        "points",
        points.shapes,
        kind=kinds,
        height=np.where(np.isnan(known), height, known),
        direction=[measures.direction(own.get("direction")) for own in tags],
        **columns,
    )


def _height(tags: Tags) -> float:
    value = measures.measure(tags.get("height") or tags.get("est_height"), 0.2, HIGHEST_POINT)
    if value is None and tags.get("natural") == "tree":
        crown = measures.measure(tags.get("diameter_crown"), 0.5, 40.0)
        value = None if crown is None else 1.5 * crown + 1.0
    return nan if value is None else value


STREETS = frozenset({"residential", "living_street", "tertiary", "secondary", "unclassified"})


@dataclass(frozen=True)
class Features:
    """What a source found within a site, every shape in the scene frame.

    Attributes
    ----------
    box
        The site.
    shells
        Buildings and their parts; `make_shells` makes them.
    roads, areas, lines, points
        The rest, cut at the border of the site.
    area_kinds
        (areas,) kind of each area, a word of `cityx.city.layout.AREA_KINDS`.
    restrictions
        Table of forbidden turns.
    coverage
        Source of roads to the share of the ground about the middle of each that is built over,
        where the site holds too little of a road to tell: a tile of a larger map.
    """

    box: Box
    shells: Shells
    roads: Tagged = field(default_factory=nothing)
    areas: Tagged = field(default_factory=nothing)
    area_kinds: NDArray[Any] = field(default_factory=lambda: np.zeros(0, object))
    lines: Tagged = field(default_factory=nothing)
    points: Tagged = field(default_factory=nothing)
    restrictions: GeoDataFrame = field(default_factory=lambda: empty_table("restrictions"))
    coverage: Mapping[str, float] = field(default_factory=lambda: MappingProxyType({}))


def resolve(features: Features, frame: Frame, *, seed: int) -> Layout:
    """Fill in what tags leave open and make the tables of the layout.

    Parameters
    ----------
    frame
        Of the site: which side traffic keeps to and which roofs are usual depend on the place.
    seed
        Key of every draw for what the source does not say.
    """
    density = density_of(features)
    profile = profile_of(frame)
    land = told_apart(features.areas, "area", features.roads)
    standing = told_apart(features.lines, "barrier", features.roads, land)
    areas = area_table(land, features.area_kinds)
    industrial = areas.geometry.to_numpy()[areas["kind"].to_numpy() == "industrial"]
    buildings, parts = building_tables(
        features.shells, density, industrial, local=profile.buildings, seed=seed
    )
    roads = road_table(
        features.roads, density, profile.streets, features.coverage,
        left_hand=profile.drive == "left",
    )  # fmt: skip
    return Layout(
        features.box,
        buildings=buildings,
        parts=parts,
        roads=roads,
        areas=areas,
        lines=beside_streets(line_table(standing), roads),
        points=point_table(features.points, seed=seed),
        restrictions=features.restrictions,
    )


def density_of(features: Features) -> Density:
    """Measure how densely a site is built."""
    outlines, roads = features.shells.outlines, features.roads
    street = np.array([tags.get("highway") in STREETS for tags in roads.tags()], bool)
    said = read_vertical(outlines.tags())
    return measure_density(
        features.box,
        shapely.get_coordinates(shapely.centroid(outlines.shapes)),
        shapely.area(outlines.shapes),
        known_levels(said, np.zeros(len(outlines.shapes), np.int64)),
        roads.shapes[street],
    )
