"""Rivers and streams that are drawn as lines."""

from __future__ import annotations

from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.sources.features import measures
from cityx.sources.features.clipping import Box, clip_polygons
from cityx.sources.features.tagged import Tagged, Tags, nothing, number_pieces, polygons_of
from cityx.sources.features.vocabulary import is_underground

# Metres of water that a line without a width stands for.
WATERWAYS = {
    "river": 12.0, "canal": 10.0, "stream": 2.5, "drain": 1.2, "ditch": 1.2, "tidal_channel": 6.0,
    "wadi": 2.5, "brook": 2.0, "rapids": 8.0,
}  # fmt: skip
COVERED = ("culvert", "yes", "flooded", "building_passage")


def waterway_width(tags: Tags) -> float:
    """Return the width of the water along a line in metres; 0 when there is none to be seen."""
    usual = WATERWAYS.get(tags.get("waterway", ""))
    if usual is None or tags.get("tunnel", "no") in COVERED or is_underground(tags):
        return 0.0
    if tags.get("covered") == "yes":
        return 0.0
    return measures.measure(tags.get("width"), 0.3, 500.0) or usual


def waterway_kind(tags: Tags) -> str:
    """Return the kind of land along a line of water: a bed that is dry for a time is bare."""
    return "bare" if tags.get("intermittent") == "yes" else "river"


def waterways(lines: Tagged, water: NDArray[Any], box: Box) -> Tagged:
    """Widen lines of flowing water to polygons, where no other water covers them.

    Parameters
    ----------
    lines
        Lines whose tags give a `waterway_width` above zero.
    water
        Polygons of water.
    box
        The site.
    """
    near = np.flatnonzero(shapely.intersects(lines.shapes, shapely.box(*box)))
    if len(near) == 0:
        return nothing()
    owner = lines.owner[near]
    width = np.array([waterway_width(lines.owners[row].tags) for row in owner.tolist()])
    bands = shapely.buffer(lines.shapes[near], width / 2, cap_style="square", quad_segs=4)
    bands = clip_polygons(bands, box)
    band, other = shapely.STRtree(water).query(bands, predicate="intersects")
    for row in np.unique(band).tolist():
        covered = shapely.union_all(water[other[band == row]])
        bands[row] = shapely.difference(bands[row], covered)
    polygons, piece = polygons_of(bands)
    return Tagged(polygons, owner[piece], number_pieces(owner[piece]), lines.owners)
