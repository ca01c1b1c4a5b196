"""From lines: faces, points and rows of the layout."""

from __future__ import annotations

from typing import Annotated

import numpy as np
import shapely

from cityx.city.layout import CURVE, Layout, make_table
from cityx.convert.points import extent_of
from cityx.ids import stable_id
from cityx.places.profiles import usual_lane
from cityx.protocol import Range, action
from cityx.protocol.values import Lines, Points, Surfaces, make_points, make_surfaces

BARRIERS = ("wall", "fence", "hedge", "city_wall", "tree_row", "retaining_wall")
LINES = (*BARRIERS, CURVE)
ROUND = 8  # segments per quarter turn; 0.3 % of the width off a true circle


@action(
    "convert/line_to_face_conversion-v1",
    classname="Line_to_face_conversion",
    lossy=0.1,
    limits=["Loses the direction of the lines; faces of lines that cross overlap."],
)
def line_to_face_conversion(
    lines: Lines, *, width: Annotated[float, Range(0.01, 500.0)] = 6.0
) -> Surfaces:
    """Convert lines to faces: each line becomes the band of its width, ends cut straight.

    Parameters
    ----------
    lines
        Lines, such as the centrelines of roads.
    width
        Width of lines that do not carry their own, metres.
    """
    widths = np.where(np.isnan(lines.width), width, lines.width)
    bands = shapely.buffer(
        lines.geometry, widths / 2, quad_segs=ROUND, cap_style="flat", join_style="round"
    )
    parts, row = shapely.get_parts(bands, return_index=True)
    row = row[~shapely.is_empty(parts)]
    parts = shapely.orient_polygons(parts[~shapely.is_empty(parts)])
    return make_surfaces(parts, lines.kind[row].tolist(), object_id=lines.object_id[row])


@action(
    "convert/line_to_point_conversion-v1",
    classname="Line_to_point_conversion",
    extension=True,
    lossy=0.05,
    limits=["Loses the widths."],
)
def line_to_point_conversion(lines: Lines) -> Points:
    """Convert lines to their vertices, the vertices of one line in one group.

    Parameters
    ----------
    lines
        Lines.
    """
    xy, row = shapely.get_coordinates(lines.geometry, return_index=True)
    return make_points(xy, lines.kind[row].tolist(), row + 1)


@action(
    "convert/line_to_layout_conversion-v1",
    classname="Line_to_layout_conversion",
    extension=True,
    lossy=0.1,
    limits=["Loses nothing of the lines, but lanes are guessed from the width."],
)
def line_to_layout_conversion(
    lines: Lines, *, width: Annotated[float, Range(0.01, 500.0)] = 6.5
) -> Layout:
    """Convert lines to rows of the layout: barriers and curves by class, all else as roads.

    Parameters
    ----------
    lines
        Lines.
    width
        Carriageway of roads that do not carry their own, metres.
    """
    shapes = shapely.force_2d(lines.geometry)
    ids = line_ids(lines)
    barrier = np.isin(lines.kind, LINES)
    road = ~barrier
    wide = np.where(np.isnan(lines.width), width, lines.width)[road]
    lanes = np.maximum(1, np.rint(wide / usual_lane())).astype(np.int16)
    kinds = np.where(lines.kind == "", "residential", lines.kind)
    roads = make_table(
        "roads",
        shapes[road],
        id=ids[road],
        source=np.full(road.sum(), "line"),
        kind=kinds[road].astype(object),
        lanes=lanes,
        lanes_forward=(lanes + 1) // 2,
        lane_width=wide / lanes,
        width=wide,
        oneway=lanes == 1,
        surface=np.full(road.sum(), "asphalt"),
        maxspeed_kmh=np.full(road.sum(), 30.0),
    )
    barriers = make_table(
        "lines",
        shapes[barrier],
        id=ids[barrier],
        source=np.full(barrier.sum(), "line"),
        kind=lines.kind[barrier].astype(object),
        height=np.full(barrier.sum(), 1.5),
    )
    return Layout(extent_of(shapely.get_coordinates(shapes)), roads=roads, lines=barriers)


def line_ids(lines: Lines) -> np.ndarray[tuple[int], np.dtype[np.uint64]]:
    """Ids of the lines: their own, else by their geometry, repeated geometry told apart."""
    ids = lines.object_id.copy()
    seen: dict[bytes, int] = {}
    for row in np.flatnonzero(ids == 0).tolist():
        text = shapely.to_wkb(shapely.set_precision(lines.geometry[row], 0.001))
        seen[text] = seen.get(text, 0) + 1
        ids[row] = stable_id("line", text.hex(), seen[text])
    return ids
