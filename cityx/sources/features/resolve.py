"""From features to a layout in which nothing is missing, the same for every source."""

from __future__ import annotations

from dataclasses import dataclass, field
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
from cityx.sources.features.tables import area_table, line_table, point_table
from cityx.sources.features.tagged import Tagged, nothing
from cityx.sources.features.vertical import read_vertical

if TYPE_CHECKING:
    from geopandas import GeoDataFrame

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
    """

    box: Box
    shells: Shells
    roads: Tagged = field(default_factory=nothing)
    areas: Tagged = field(default_factory=nothing)
    area_kinds: NDArray[Any] = field(default_factory=lambda: np.zeros(0, object))
    lines: Tagged = field(default_factory=nothing)
    points: Tagged = field(default_factory=nothing)
    restrictions: GeoDataFrame = field(default_factory=lambda: empty_table("restrictions"))


def resolve(features: Features, frame: Frame, *, seed: int) -> Layout:
    """Fill in what tags leave open and make the tables of the layout.

    Parameters
    ----------
    frame
        Of the site: which side traffic keeps to and which roofs are usual depend on the place.
    seed
        Key of every draw for what the source does not say.
    """
    density = _density(features)
    profile = profile_of(frame)
    areas = area_table(features.areas, features.area_kinds)
    industrial = areas.geometry.to_numpy()[areas["kind"].to_numpy() == "industrial"]
    buildings, parts = building_tables(
        features.shells, density, industrial, local=profile.buildings, seed=seed
    )
    return Layout(
        features.box,
        buildings=buildings,
        parts=parts,
        roads=road_table(
            features.roads, density, profile.streets, left_hand=profile.drive == "left"
        ),
        areas=areas,
        lines=line_table(features.lines),
        points=point_table(features.points, seed=seed),
        restrictions=features.restrictions,
    )


def _density(features: Features) -> Density:
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
