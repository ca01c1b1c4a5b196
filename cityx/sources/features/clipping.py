"""What is cut at the border of a site, and which buildings stand in it."""

from __future__ import annotations

from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.geometry.arrays import FloatArray, IntArray

Box = tuple[float, float, float, float]

MARGIN = 15.0  # metres of ground kept around buildings that reach over the border
LARGEST = 4000.0  # metres; no building is longer, so one that is was drawn wrongly


def inside_site(polygons: NDArray[Any], box: Box) -> tuple[NDArray[np.bool_], Box]:
    """Choose the buildings that lie in the site or cross its border, and grow the site by them.

    Returns
    -------
    kept
        (n,) bool.
    grown
        The rectangle with `MARGIN` around every building kept, rounded outward to decimetres.
    """
    if len(polygons) == 0:
        return np.zeros(0, bool), _outward(box)
    bounds = shapely.bounds(polygons)
    sane = (bounds[:, 2:] - bounds[:, :2]).max(axis=1) <= LARGEST
    xmin, ymin, xmax, ymax = box
    touching = (
        (bounds[:, 0] < xmax)
        & (bounds[:, 2] > xmin)
        & (bounds[:, 1] < ymax)
        & (bounds[:, 3] > ymin)
    )
    crossing = np.flatnonzero(touching & sane & ~_within(bounds, box))
    touching[crossing] = shapely.intersects(polygons[crossing], shapely.box(*box))
    kept = touching & sane
    if kept.any():
        low = bounds[kept, :2].min(axis=0) - MARGIN
        high = bounds[kept, 2:].max(axis=0) + MARGIN
        box = (
            min(xmin, low[0]), min(ymin, low[1]), max(xmax, high[0]), max(ymax, high[1]),
        )  # fmt: skip
    grown = _outward(box)
    inner = (
        grown[0] + MARGIN, grown[1] + MARGIN, grown[2] - MARGIN, grown[3] - MARGIN,
    )  # fmt: skip
    return (kept | _within(bounds, inner)) & sane, grown


def _within(bounds: FloatArray, box: Box) -> NDArray[np.bool_]:
    return np.asarray(
        (bounds[:, 0] >= box[0])
        & (bounds[:, 1] >= box[1])
        & (bounds[:, 2] <= box[2])
        & (bounds[:, 3] <= box[3])
    )


def _outward(box: Box) -> Box:
    low = np.floor(np.array(box[:2]) * 10 - 1e-6) / 10
    high = np.ceil(np.array(box[2:]) * 10 + 1e-6) / 10
    return float(low[0]), float(low[1]), float(high[0]), float(high[1])


def clip_polygons(polygons: NDArray[Any], box: Box) -> NDArray[Any]:
    """Cut polygons at the border of the site; those outside become empty."""
    if len(polygons) == 0:
        return polygons
    polygons = polygons.copy()
    crossing = np.flatnonzero(~_within(shapely.bounds(polygons), box))
    shapely.prepare(polygons[crossing])
    polygons[crossing] = shapely.intersection(polygons[crossing], shapely.box(*box))
    return polygons


def clip_lines(lines: NDArray[Any], box: Box) -> tuple[NDArray[Any], IntArray]:
    """Cut lines at the border of the site and keep their direction.

    Lines inside are returned as they are, so that their points stay identical.

    Returns
    -------
    pieces
        (m,) lines.
    row
        (m,) which line each is of, ascending.
    """
    if len(lines) == 0:
        return lines, np.zeros(0, np.int64)
    bounds = shapely.bounds(lines)
    within = _within(bounds, box)
    outside = (
        (bounds[:, 0] > box[2]) | (bounds[:, 2] < box[0]) | (bounds[:, 1] > box[3])
        | (bounds[:, 3] < box[1])
    )  # fmt: skip
    crossing = np.flatnonzero(~within & ~outside)
    cut = [(_clip(shapely.get_coordinates(lines[row]), box), row) for row in crossing.tolist()]
    pieces = [shapely.LineString(piece) for found, _ in cut for piece in found]
    rows = np.array([row for found, row in cut for _ in found], np.int64)
    every = np.concatenate([lines[within], np.array(pieces, object)])
    row = np.concatenate([np.flatnonzero(within), rows])
    order = np.argsort(row, kind="stable")
    return every[order], row[order]


def _clip(points: FloatArray, box: Box) -> list[FloatArray]:
    """Cut one line, (n, 2), at a rectangle (Liang and Barsky) into the runs inside."""
    start, step = points[:-1], np.diff(points, axis=0)
    low, high = np.array(box[:2]), np.array(box[2:])
    with np.errstate(divide="ignore", invalid="ignore"):
        first, second = (low - start) / step, (high - start) / step
    still = step == 0
    outside = (still & ((start < low) | (start > high))).any(axis=1)
    enter = np.where(still, 0.0, np.minimum(first, second)).max(axis=1).clip(0.0)
    leave = np.where(still, 1.0, np.maximum(first, second)).min(axis=1).clip(None, 1.0)
    runs: list[list[FloatArray]] = []
    connected = False
    for index in np.flatnonzero(~outside & (enter < leave)).tolist():
        begin = points[index]
        if not connected or enter[index] > 0 or not (runs[-1][-1] == begin).all():
            begin = begin if enter[index] == 0 else start[index] + enter[index] * step[index]
            runs.append([np.clip(np.round(begin, 4), low, high) if enter[index] else begin])
        end = points[index + 1]
        if leave[index] < 1:
            end = np.clip(np.round(start[index] + leave[index] * step[index], 4), low, high)
        runs[-1].append(end)
        connected = bool(leave[index] == 1)
    return [kept for run in runs if len(kept := _distinct(np.array(run))) > 1]


def _distinct(points: FloatArray) -> FloatArray:
    new = np.ones(len(points), bool)
    new[1:] = (points[1:] != points[:-1]).any(axis=1)
    return np.asarray(points[new])
