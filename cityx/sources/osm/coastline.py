"""The sea: what lies to the right of the coastline."""

from __future__ import annotations

from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.sources.features.clipping import Box, clip_lines
from cityx.sources.features.tagged import MIN_AREA

PROBE = 0.05  # metres beside a coast segment at which its two sides are looked up
# An extract cuts ways at the last node inside it; the next one lies about a segment further.
REACH = 120.0
REACH_SHARE = 0.1  # of the site's shorter side, where that is less
# Of the coast along a face, the share by which one side must win: a coastline that ends within a
# face has both sides in it and decides nothing.
MARGIN = 0.2


def sea_polygons(coast: NDArray[Any], box: Box) -> NDArray[Any]:
    """Return the polygons of the site that are sea.

    Land lies to the left of a coastline. The lines and the border of the site divide it into
    faces; each face asks the coast segments along it on which side it lies, and the longer side
    wins. A coastline cut off near the border is taken to reach it; one that ends farther within
    the site divides nothing.

    Parameters
    ----------
    coast
        (n,) lines in the direction of their ways.
    """
    lines, _ = clip_lines(coast, box)
    if len(lines) == 0:
        return np.zeros(0, object)
    frame = shapely.box(*box)
    lines = np.array([*lines, *_to_border(lines, frame)], object)
    noded = shapely.node(shapely.geometrycollections([*lines, frame.exterior]))
    faces = shapely.get_parts(shapely.polygonize(shapely.get_parts(noded)))
    points, row = shapely.get_coordinates(lines, return_index=True)
    step = np.diff(points, axis=0)
    length = np.hypot(*step.T)
    usable = (row[1:] == row[:-1]) & (length > 2 * PROBE)
    step, length = step[usable], length[usable]
    middle = ((points[1:] + points[:-1]) / 2)[usable]
    left = np.column_stack([-step[:, 1], step[:, 0]]) / length[:, None] * PROBE
    tree = shapely.STRtree(faces)
    votes, heard = np.zeros(len(faces)), np.zeros(len(faces))
    for side, sign in ((left, -1.0), (-left, 1.0)):
        probe, face = tree.query(shapely.points(middle + side), predicate="within")
        np.add.at(votes, face, sign * length[probe])
        np.add.at(heard, face, length[probe])
    sea = (votes > MARGIN * heard) & (shapely.area(faces) > MIN_AREA)
    return np.asarray(faces[sea], object)


def _to_border(lines: NDArray[Any], frame: shapely.Polygon) -> list[shapely.LineString]:
    """Return straight pieces from the loose ends of the coastline to a border close by."""
    merged = shapely.get_parts(shapely.line_merge(shapely.multilinestrings(lines)))
    loose = merged[~shapely.is_closed(merged)]
    ends = np.concatenate([shapely.get_point(loose, 0), shapely.get_point(loose, -1)])
    gap = shapely.distance(ends, frame.exterior)
    xmin, ymin, xmax, ymax = frame.bounds
    reach = min(REACH, REACH_SHARE * min(xmax - xmin, ymax - ymin))
    near = ends[(gap > 0) & (gap <= reach)]
    return list(shapely.shortest_line(near, frame.exterior))
