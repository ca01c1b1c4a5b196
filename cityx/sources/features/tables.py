"""Tables of areas, lines that stand, and things at a place."""

from __future__ import annotations

from math import nan
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from cityx.city.layout import make_table
from cityx.ids import uniform
from cityx.sources.features import measures
from cityx.sources.features.kinds import line_kind, point_kind
from cityx.sources.features.tagged import Tagged, Tags
from cityx.sources.features.vocabulary import LINE_HEIGHT, POINT_HEIGHT

if TYPE_CHECKING:
    from geopandas import GeoDataFrame

HIGHEST_LINE = 40.0  # metres; a wall that is higher is a mistake in its unit
HIGHEST_POINT = 90.0  # metres; no tree is higher


def area_table(areas: Tagged, kinds: NDArray[Any]) -> GeoDataFrame:
    """Make the table of areas of given kinds."""
    return make_table("areas", areas.shapes, kind=kinds, **areas.columns())


def line_table(lines: Tagged) -> GeoDataFrame:
    """Make the table of lines that stand: walls, fences, hedges and rows of trees."""
    tags = lines.tags()
    kinds = [line_kind(own) for own in tags]
    heights = [
        measures.measure(own.get("height"), 0.1, HIGHEST_LINE) or LINE_HEIGHT[kind]
        for own, kind in zip(tags, kinds, strict=True)
    ]
    columns = lines.columns()
    del columns["name"]
    return make_table("lines", lines.shapes, kind=kinds, height=heights, **columns)


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
