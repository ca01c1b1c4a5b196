"""From points: faces, lines and rows of the layout."""

from __future__ import annotations

from typing import Annotated

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.city.layout import POINT_KINDS, Layout, make_table
from cityx.ids import stable_id
from cityx.protocol import Port, Range, action
from cityx.protocol.values import Lines, Points, Surfaces, make_lines, make_surfaces

MARGIN = 10.0  # metres around what a layout is made of, so that no object lies on its border


@action(
    "convert/point_to_face_conversion-v1",
    classname="Point_to_face_conversion",
    lossy=0.2,
    limits=[
        "Loses heights and positions finer than the spacing; of two classes in one cell the first "
        "in the alphabet stays."
    ],
)
def point_to_face_conversion(
    points: Points, *, spacing: Annotated[float, Range(0.0, 1000.0)] = 0.0
) -> Surfaces:
    """Convert points to faces: neighbours of one class become one polygon.

    Each point stands for a square cell. Cells of one class that share a side are joined, so points
    on a square grid give exactly their area.

    Parameters
    ----------
    points
        Points with classes, such as those of a semantic map.
    spacing
        Edge of a cell, metres; 0 for the distance between neighbouring points.
    """
    if points.count == 0:
        return make_surfaces([])
    xy = points.position[:, :2]
    low = xy.min(axis=0)
    step = spacing or _spacing(xy)
    cells = np.rint((xy - low) / step).astype(np.int64)
    order = np.lexsort((points.kind, cells[:, 0], cells[:, 1]))
    cells, kinds = cells[order], points.kind[order]
    first = np.ones(len(cells), bool)
    first[1:] = np.any(cells[1:] != cells[:-1], axis=1)
    shapes: list[shapely.Polygon] = []
    names: list[str] = []
    for kind in np.unique(kinds).tolist():
        for shape in _joined(cells[first & (kinds == kind)]):
            shapes.append(shape)
            names.append(kind)
    # Whole cells until here, so that runs share corners exactly.
    faces = shapely.transform(np.array(shapes, object), lambda p: low + (p - 0.5) * step)
    return make_surfaces(shapely.orient_polygons(faces), names)


def _spacing(xy: NDArray[np.float64]) -> float:
    """Return the least distance of two rows or columns of points, a metre where there is none."""
    steps = [np.diff(np.unique(np.round(axis, 4))) for axis in xy.T]
    return float(min((step.min() for step in steps if len(step)), default=1.0))


def _joined(cells: NDArray[np.int64]) -> list[shapely.Polygon]:
    """Join (n, 2) cells, sorted by row and column, to polygons in whole cells."""
    if len(cells) == 0:
        return []
    starts = np.ones(len(cells), bool)
    starts[1:] = (np.diff(cells[:, 1]) != 0) | (np.diff(cells[:, 0]) != 1)
    begin = np.flatnonzero(starts)
    end = np.append(begin[1:], len(cells)) - 1
    runs = shapely.box(cells[begin, 0], cells[begin, 1], cells[end, 0] + 1, cells[end, 1] + 1)
    return list(shapely.get_parts(shapely.simplify(shapely.union_all(runs), 0)))


@action(
    "convert/point_to_line_conversion-v1",
    classname="Point_to_line_conversion",
    lossy=0.1,
    limits=["Loses heights and points that are alone in their group."],
)
def point_to_line_conversion(points: Annotated[Points, Port("points", "point", "path")]) -> Lines:
    """Convert points to lines: the points of one group, in order, become one polyline.

    Parameters
    ----------
    points
        Points; those of one group follow each other, which pixels of a map do not.
    """
    order = np.argsort(points.group, kind="stable")
    groups, index, size = np.unique(points.group[order], return_inverse=True, return_counts=True)
    long_enough = (size > 1)[index]
    if not len(groups) or not long_enough.any():
        return make_lines([])
    _, part = np.unique(index[long_enough], return_inverse=True)
    rows = order[long_enough]
    lines = shapely.linestrings(points.position[rows, :2], indices=part)
    heads = rows[np.unique(part, return_index=True)[1]]
    return make_lines(lines, points.kind[heads].tolist())


@action(
    "convert/point_to_layout_conversion-v1",
    classname="Point_to_layout_conversion",
    extension=True,
    lossy=0.2,
    limits=["Loses heights and points whose class is no thing of the layout."],
)
def point_to_layout_conversion(
    points: Annotated[Points, Port("points", "point", "thing")],
) -> Layout:
    """Convert points to rows of the layout's table of things.

    Parameters
    ----------
    points
        Points whose class is a word such as "tree" or "bench".
    """
    known = np.isin(points.kind, POINT_KINDS)
    xy = points.position[known, :2]
    kinds = points.kind[known].tolist()
    ids = [stable_id("point", k, *np.round(p, 3)) for k, p in zip(kinds, xy, strict=True)]
    _, unique = np.unique(np.array(ids, np.uint64), return_index=True)
    table = make_table(
        "points",
        shapely.points(xy[unique]),
        id=np.array(ids, np.uint64)[unique],
        source=np.full(len(unique), "point"),
        kind=np.array(kinds, object)[unique],
        height=np.full(len(unique), np.nan),
        direction=np.full(len(unique), np.nan),
    )
    return Layout(extent_of(points.position[:, :2]), points=table)


def extent_of(xy: NDArray[np.float64]) -> tuple[float, float, float, float]:
    """Return the rectangle around (n, 2) points with a margin; around the origin for none."""
    if len(xy) == 0:
        return (-MARGIN, -MARGIN, MARGIN, MARGIN)
    low, high = xy.min(axis=0) - MARGIN, xy.max(axis=0) + MARGIN
    return (float(low[0]), float(low[1]), float(high[0]), float(high[1]))
