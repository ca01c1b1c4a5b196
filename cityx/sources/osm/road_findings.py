"""What of the streets of a map was ignored or repaired, way by way."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.geometry.identity import stable_id
from cityx.sources.osm import measures
from cityx.sources.osm.elements import IntArray, OsmMap, Tags
from cityx.sources.osm.outlines import Report
from cityx.sources.osm.site import Box
from cityx.sources.osm.vocabulary import CARS

PER_METRE = 1000.0  # ends meet where they are equal to the millimetre
AT_BORDER = 1.0  # metres; a bridge that leaves the site has its approach outside


def name_repairs(
    osm: OsmMap, lines: NDArray[Any], way: IntArray, box: Box, limits: dict[str, float],
    report: Report,
) -> None:  # fmt: skip
    """Name the ways whose tags or form could not be built as they are.

    Parameters
    ----------
    lines, way
        (n,) LineStrings within the site and the way each is of.
    box
        The site.
    limits
        Greatest value of ``lanes`` and, in metres, ``width``.
    """
    for row in np.unique(way).tolist():
        for text in _tag_repairs(osm.way_tags[row], limits):
            _name(osm, row, text, report)
    for row in np.unique(way[_crossed(lines)]).tolist():
        _name(osm, row, "crosses itself; it is built as drawn, without a junction there", report)
    for row in np.unique(way[_bare_bridges(osm, lines, way, box)]).tolist():
        _name(osm, row, "is a bridge that ends where no other way begins", report)


def name_points(osm: OsmMap, ways: IntArray, report: Report) -> None:
    """Name the ways that have no length and are left out."""
    for row in ways.tolist():
        _name(osm, row, "has no length; it is left out", report)


def _name(osm: OsmMap, row: int, text: str, report: Report) -> None:
    number = int(osm.way_id[row])
    report.fail(stable_id("osm", "way", number), f"osm/way/{number} {text}")


def _tag_repairs(tags: Tags, limits: dict[str, float]) -> Iterator[str]:
    """Yield what is wrong with the numbers of a street."""
    if tags.get("highway") not in CARS:
        return
    for key, most in limits.items():
        value = measures.measure(tags.get(key), -np.inf, np.inf)
        if value is not None and not 1.0 <= value <= most:
            yield f"has {key}={tags[key]}, outside 1 to {most:g}; what is usual was built"


def _crossed(lines: NDArray[Any]) -> NDArray[np.bool_]:
    """(n,) whether a line crosses itself between its points; at a point it makes a junction."""
    crossed = ~shapely.is_simple(lines)
    tried = lines[crossed]
    before, after = (
        shapely.extract_unique_points(tried),
        shapely.extract_unique_points(shapely.node(tried)),
    )
    crossed[crossed] = shapely.get_num_geometries(after) > shapely.get_num_geometries(before)
    return np.asarray(crossed)


def _bare_bridges(osm: OsmMap, lines: NDArray[Any], way: IntArray, box: Box) -> NDArray[np.bool_]:
    """(n,) whether a line is a bridge one end of which touches no other line and no border."""
    points, owner = shapely.get_coordinates(lines, return_index=True)
    place = np.unique(np.rint(points * PER_METRE), axis=0, return_inverse=True)[1].reshape(-1)
    lone = np.bincount(place)[place] == 1
    lone &= np.minimum(points - box[:2], np.array(box[2:]) - points).min(axis=1) > AT_BORDER
    end = np.r_[True, owner[1:] != owner[:-1]] | np.r_[owner[1:] != owner[:-1], True]
    bare = np.zeros(len(lines), bool)
    np.logical_or.at(bare, owner, lone & end)
    decks = [osm.way_tags[row].get("bridge", "no") not in ("no", "") for row in way.tolist()]
    return np.asarray(bare & np.array(decks, bool))
