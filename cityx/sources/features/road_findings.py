"""What of the streets of a source was ignored or repaired, way by way."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.sources.features import measures
from cityx.sources.features.clipping import Box
from cityx.sources.features.road_features import MAX_LANES, MAX_WIDTH
from cityx.sources.features.tagged import Owner, Report, Tagged, Tags
from cityx.sources.features.vocabulary import CARS

LIMITS = {"lanes": MAX_LANES, "width": MAX_WIDTH}
PER_METRE = 1000.0  # ends meet where they are equal to the millimetre
AT_BORDER = 1.0  # metres; a bridge that leaves the site has its approach outside


def name_repairs(roads: Tagged, box: Box, report: Report) -> None:
    """Name the ways whose tags or form could not be built as they are.

    Parameters
    ----------
    roads
        Lines within the site.
    box
        The site.
    """
    for owner in _owners(roads, np.ones(len(roads.shapes), bool)):
        for text in _tag_repairs(owner.tags):
            _name(owner, text, report)
    for owner in _owners(roads, _crossed(roads.shapes)):
        _name(owner, "crosses itself; it is built as drawn, without a junction there", report)
    for owner in _owners(roads, _bare_bridges(roads, box)):
        _name(owner, "is a bridge that ends where no other way begins", report)


def name_points(owners: Iterable[Owner], report: Report) -> None:
    """Name the ways that have no length and are left out."""
    for owner in owners:
        _name(owner, "has no length; it is left out", report)


def _owners(roads: Tagged, rows: NDArray[np.bool_]) -> Iterator[Owner]:
    return (roads.owners[owner] for owner in np.unique(roads.owner[rows]).tolist())


def _name(owner: Owner, text: str, report: Report) -> None:
    report.fail(owner.id(), f"{owner.source} {text}")


def _tag_repairs(tags: Tags) -> Iterator[str]:
    """Yield what is wrong with the numbers of a street."""
    if tags.get("highway") not in CARS:
        return
    for key, most in LIMITS.items():
        value = measures.measure(tags.get(key), -np.inf, np.inf)
        if value is not None and not 1.0 <= value <= most:
            yield f"has {key}={tags[key]}, outside 1 to {most:g}; what is usual was built"


def _crossed(lines: NDArray[np.object_]) -> NDArray[np.bool_]:
    """(n,) whether a line crosses itself between its points; at a point it makes a junction."""
    crossed = ~shapely.is_simple(lines)
    tried = lines[crossed]
    before, after = (
        shapely.extract_unique_points(tried),
        shapely.extract_unique_points(shapely.node(tried)),
    )
    crossed[crossed] = shapely.get_num_geometries(after) > shapely.get_num_geometries(before)
    return np.asarray(crossed)


def _bare_bridges(roads: Tagged, box: Box) -> NDArray[np.bool_]:
    """(n,) whether a line is a bridge one end of which touches no other line and no border."""
    points, owner = shapely.get_coordinates(roads.shapes, return_index=True)
    place = np.unique(np.rint(points * PER_METRE), axis=0, return_inverse=True)[1].reshape(-1)
    lone = np.bincount(place)[place] == 1
    lone &= np.minimum(points - box[:2], np.array(box[2:]) - points).min(axis=1) > AT_BORDER
    end = np.r_[True, owner[1:] != owner[:-1]] | np.r_[owner[1:] != owner[:-1], True]
    bare = np.zeros(len(roads.shapes), bool)
    np.logical_or.at(bare, owner, lone & end)
    decks = [tags.get("bridge", "no") not in ("no", "") for tags in roads.tags()]
    return np.asarray(bare & np.array(decks, bool))
