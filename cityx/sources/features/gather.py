"""Sorting tagged shapes into buildings, roads, land, lines and things, and cutting out a site."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.geometry.arrays import IntArray
from cityx.sources.features.clipping import Box
from cityx.sources.features.kinds import (
    building_kind,
    is_thick,
    land_kind,
    line_kind,
    name_unseen,
    point_kind,
    road_kind,
)
from cityx.sources.features.resolve import Features
from cityx.sources.features.road_features import name_edges, name_repairs, with_rails
from cityx.sources.features.shells import make_shells
from cityx.sources.features.tagged import (
    MIN_AREA,
    MIN_SOLID,
    Report,
    Tagged,
    Tags,
    clipped_lines,
    clipped_polygons,
    distinct,
    joined,
    number_pieces,
    polygons_of,
)
from cityx.sources.features.vocabulary import WATER_KINDS
from cityx.sources.features.waterways import waterway_kind, waterway_width, waterways

Kind = Callable[[Tags], str]
_TYPES = (0, 1, 3)  # shapely's numbers of points, lines and polygons


def gather(found: Tagged, box: Box, report: Report) -> Features:
    """Sort what a source found by what its tags mean, and keep what lies in the site.

    Parameters
    ----------
    found
        Points, lines and polygons, also in collections, scene frame.
    box
        The site, (xmin, ymin, xmax, ymax), metres; it grows by buildings that cross its border.
    report
        Counts what is dropped: shapes whose tags mean nothing here, buildings drawn twice, ...
    """
    flat = _flattened(found)
    point, line, polygon = (shapely.get_type_id(flat.shapes) == kind for kind in _TYPES)
    tags, of = distinct(flat.tags())
    built, land = (_meant(kind, tags, of, polygon) for kind in (building_kind, land_kind))
    road, flow = (_meant(kind, tags, of, line) for kind in (road_kind, _flow))
    standing = _meant(line_kind, tags, of, line | (polygon & (built == "")))
    thing = _meant(point_kind, tags, of, point)
    used = np.any([kind != "" for kind in (built, land, road, standing, flow, thing)], axis=0)
    report.count("features without a use", int((~used).sum()))

    outlines, parts = (_polygons(flat.take(built == word)) for word in ("building", "part"))
    name_unseen(flat.owners, report)
    shells, box = make_shells(outlines, parts, box, report)
    areas = clipped_polygons(_polygons(flat.take(land != "")), box)
    kinds = _of_owners(flat.take(land != ""), land[land != ""])[areas.owner]
    water = areas.shapes[np.isin(kinds, sorted(WATER_KINDS))]
    rivers = waterways(flat.take(flow != ""), water, box)
    roads = clipped_lines(with_rails(flat.take(road != "")), box)
    name_repairs(roads, box, report)
    lines = _barriers(flat.take(standing != ""), box)
    name_edges(lines, roads, report)
    return Features(
        box,
        shells,
        roads=roads,
        areas=joined(areas, rivers),
        area_kinds=np.concatenate([kinds, [waterway_kind(own) for own in rivers.tags()]]),
        lines=lines,
        points=_inside(flat.take(thing != ""), box),
    )


def _barriers(found: Tagged, box: Box) -> Tagged:
    """Return barriers: lines, outlines of the land that they stand round, and thick ones."""
    area = shapely.get_dimensions(found.shapes) == 2
    thick = area & np.array([is_thick(tags) for tags in found.tags()], bool)
    around = found.take(area & ~thick)
    around = _flattened(replace(around, shapes=shapely.boundary(around.shapes)))
    solid = _polygons(found.take(thick), least=MIN_SOLID)
    lines = clipped_lines(joined(found.take(~area), around), box)
    return joined(lines, clipped_polygons(solid, box, least=MIN_SOLID))


def _inside(points: Tagged, box: Box) -> Tagged:
    x, y = shapely.get_x(points.shapes), shapely.get_y(points.shapes)
    return points.take((x >= box[0]) & (x <= box[2]) & (y >= box[1]) & (y <= box[3]))


def _flow(tags: Tags) -> str:
    return waterway_kind(tags) if waterway_width(tags) > 0 else ""


def _flattened(found: Tagged) -> Tagged:
    """Take collections apart; the pieces of an owner are numbered in their order."""
    shapes, row = shapely.get_parts(found.shapes, return_index=True)
    owner = found.owner[row]
    order = np.argsort(owner, kind="stable")
    return Tagged(shapes[order], owner[order], number_pieces(owner[order]), found.owners)


def _meant(kind: Kind, tags: list[Tags], of: IntArray, rows: NDArray[np.bool_]) -> NDArray[Any]:
    """Return what the tags of some rows mean, "" for the others."""
    word = np.full(len(tags), "", object)
    some = np.unique(of[rows])
    word[some] = [kind(tags[k]) for k in some.tolist()]
    return np.where(rows, word[of], "").astype(object)


def _of_owners(some: Tagged, words: NDArray[Any]) -> NDArray[Any]:
    """Return the word of each owner by those of its shapes, "" where it has none of them."""
    found = np.full(len(some.owners), "", object)
    found[some.owner] = words
    return found


def _polygons(outlines: Tagged, *, least: float = MIN_AREA) -> Tagged:
    """Mend outlines; see `polygons_of`."""
    shapes, row = polygons_of(shapely.force_2d(outlines.shapes), least=least)
    owner = outlines.owner[row]
    return Tagged(shapes, owner, number_pieces(owner), outlines.owners)
