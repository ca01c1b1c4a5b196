"""Probes: how far straight ways lead from points before they meet a segment."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely
from numpy.typing import ArrayLike

from cityx.geometry.arrays import FloatArray

FIRST = 3.0  # metres that are looked at first; most ways end there
CLOSE = 1.5  # metres in which the nearest segment is looked for first
ON = 1e-9  # metres behind its start in which a segment still bars a way


@dataclass(frozen=True)
class Segments:
    """Segments that bar ways.

    Attributes
    ----------
    ends
        (k, 2, 2) metres.
    tree
        STRtree over them.
    """

    ends: FloatArray
    tree: Any


def segments_of(lines: ArrayLike) -> Segments:
    """Cut shapely lines into their segments."""
    points, line = shapely.get_coordinates(np.asarray(lines, object), return_index=True)
    first = np.flatnonzero(line[1:] == line[:-1])
    ends = np.stack([points[first], points[first + 1]], axis=1)
    return Segments(ends, shapely.STRtree(shapely.linestrings(ends)))


def nearest_on(segments: Segments, xy: FloatArray) -> FloatArray:
    """(n, 2) points of segments, of which there are some, that are nearest to (n, 2) points."""
    foot = np.zeros_like(xy)
    boxes = shapely.box(*(xy - CLOSE).T, *(xy + CLOSE).T)
    point, near = segments.tree.query(boxes)
    each = _foot(segments.ends[near], xy[point])
    gap = ((each - xy[point]) ** 2).sum(axis=1)
    order = np.lexsort((gap, point))
    first = order[np.diff(point[order], prepend=-1) > 0]
    found = first[gap[first] <= CLOSE**2]
    foot[point[found]] = each[found]
    rest = np.setdiff1d(np.arange(len(xy)), point[found])
    near = segments.tree.query_nearest(shapely.points(xy[rest]), all_matches=False)[1]
    foot[rest] = _foot(segments.ends[near], xy[rest])
    return foot


def _foot(ends: FloatArray, xy: FloatArray) -> FloatArray:
    """(n, 2) points of segments, (n, 2, 2), each the nearest to its point of (n, 2)."""
    span = ends[:, 1] - ends[:, 0]
    square = np.maximum((span**2).sum(axis=1), 1e-18)
    share = np.clip(((xy - ends[:, 0]) * span).sum(axis=1) / square, 0.0, 1.0)
    return np.asarray(ends[:, 0] + share[:, None] * span)


def way_to(segments: Segments, start: FloatArray, way: FloatArray, reach: float) -> FloatArray:
    """Measure how far one gets before a segment is met, or touched.

    Parameters
    ----------
    segments
        What bars the ways.
    start, way
        (n, 2) metres, and (n, 2) unit vectors.
    reach
        Metres that are looked at.

    Returns
    -------
    room
        (n,) metres, at most `reach`.
    """
    room = np.full(len(start), float(reach))
    rows = np.arange(len(start) if len(segments.ends) else 0)
    for far in (FIRST, reach) if reach > FIRST else (reach,):
        if not len(rows):
            break
        stop = start[rows] + far * way[rows]
        # Only boxes are compared: ways that pass beside a segment are told apart below.
        probe, met = segments.tree.query(shapely.linestrings(np.stack([start[rows], stop], axis=1)))
        row = rows[probe]
        offset = segments.ends[met] - start[row][:, None]  # (p, 2, 2)
        ahead = (offset * way[row][:, None]).sum(axis=2)  # (p, 2)
        aside = offset[..., 1] * way[row, :1] - offset[..., 0] * way[row, 1:]
        span = aside[:, 0] - aside[:, 1]
        share = aside[:, 0] / np.where(span == 0.0, 1.0, span)
        at = ahead[:, 0] + share * (ahead[:, 1] - ahead[:, 0])
        # A segment that lies along the way bars it where it begins.
        at = np.where(span == 0.0, np.clip(0.0, ahead.min(axis=1), ahead.max(axis=1)), at)
        bars = (aside.min(axis=1) <= 0.0) & (aside.max(axis=1) >= 0.0)
        bars &= (at >= -ON) & (at <= far)
        np.minimum.at(room, row[bars], np.maximum(at[bars], 0.0))
        rows = rows[room[rows] > far]
    return room
