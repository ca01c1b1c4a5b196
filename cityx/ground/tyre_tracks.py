"""Where tyres run: the wheel paths of lanes and of turns as a picture seen from above."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cityx.city.lanes import MOVEMENTS, LaneGraph
from cityx.city.roads import RoadNetwork
from cityx.city.section import KIND
from cityx.geometry.polylines import Polylines, arc_lengths, miters, pieces
from cityx.geometry.ranges import ranges

IntArray = NDArray[np.int64]

LANE = 3.1  # metres; as many lanes as fit between the kerbs
GAUGE = 1.5  # metres between the wheels of a car
WIDTH = 0.42  # metres, of a path that many cars have driven
NARROW = 2.0  # metres; on streets with less than this to either side cars share one lane
DRIVEN = ("drive", "bus")
TURNED = 0.55  # of the wear of a lane that a turn from it into another has
WAITING, WAIT_WIDTH, WAITED = 14.0, 0.7, 0.4  # metres before a junction where oil drips, and wear


def tyre_tracks(
    network: RoadNetwork, lanes: LaneGraph | None, corner: tuple[float, float],
    size: tuple[int, int], cell: float,
) -> NDArray[np.uint8]:  # fmt: skip
    """Draw the wheel paths of all streets.

    Parameters
    ----------
    network
        Centrelines and half widths; what counts where there are no lanes.
    lanes
        Their lanes and the ways across junctions.
    corner
        South-western corner of the picture, metres.
    size
        Pixels across and up.
    cell
        Metres per pixel.

    Returns
    -------
    picture
        (h, w) uint8, 255 in a wheel path, less where turns cross or cars wait; first row in the
        south.
    """
    from PIL import Image, ImageDraw, ImageFilter

    picture = Image.new("L", size)
    draw = ImageDraw.Draw(picture)

    def paint(lines: Polylines, offset: float, wear: float, width: float) -> None:
        if not lines.count:
            return
        points = (lines.points + offset * miters(lines) - corner) / cell
        for first, last in zip(lines.start[:-1].tolist(), lines.start[1:].tolist(), strict=True):
            path = [tuple(point) for point in points[first:last].tolist()]
            draw.line(path, round(255 * wear), max(round(width / cell), 1), "curve")

    if lanes is None:
        for half, street in _streets(network):
            for offset in wheel_offsets(half):
                paint(street, offset, 1.0, WIDTH)
    else:
        own = _driven(lanes)
        waiting, turning, onward = _ways(lanes, own)
        paint(waiting, 0.0, WAITED, WAIT_WIDTH)
        for lines, wear in ((turning, TURNED), (onward, 1.0), (_lines_of(lanes, own), 1.0)):
            for side in (-0.5, 0.5):
                paint(lines, side * GAUGE, wear, WIDTH)
    return np.asarray(picture.filter(ImageFilter.GaussianBlur(0.08 / cell)))


def _lines_of(lanes: LaneGraph, rows: IntArray) -> Polylines:
    """Middles of some lanes."""
    index, start = ranges(lanes.point_start, rows)
    return Polylines(lanes.points[index], start)


def _driven(lanes: LaneGraph) -> IntArray:
    """Lanes in which cars drive."""
    cars = np.isin(lanes.kind, [KIND[name] for name in DRIVEN]) & (lanes.direction != 0)
    return np.flatnonzero(cars & (np.diff(lanes.point_start) > 1))


def _ways(lanes: LaneGraph, own: IntArray) -> tuple[Polylines, Polylines, Polylines]:
    """Last stretches of lanes that end at junctions, ways of those who turn, and straight on."""
    driven = np.isin(lanes.connection, own).all(axis=1)
    straight = lanes.movement == MOVEMENTS.index("through")
    found = []
    for chosen in (driven & ~straight, driven & straight):
        index, start = ranges(lanes.curve_start, np.flatnonzero(chosen))
        found.append(Polylines(lanes.curve[index], start))
    ends = np.intersect1d(lanes.connection[driven, 0], own).astype(np.int64)
    length = arc_lengths(lanes.lines)[1][ends]
    waiting = pieces(lanes.lines, ends, np.maximum(length - WAITING, 0.0), length)
    return waiting, found[0], found[1]


def _streets(network: RoadNetwork) -> list[tuple[float, Polylines]]:
    """Half widths and centrelines of all but footways."""
    found = []
    for edge, half in enumerate(network.half_width.tolist()):
        points = network.edge_points(edge)
        if len(points) > 1 and half >= 1.3:
            found.append((half, Polylines(points, np.array([0, len(points)]))))
    return found


def wheel_offsets(half: float) -> list[float]:
    """Return the distances of wheel paths from the middle of a street with `half` its width."""
    lanes = 1 if half < NARROW else max(2, int(2 * half // LANE))
    middles = (np.arange(lanes) - (lanes - 1) / 2) * min(LANE, 2 * half / lanes)
    return [float(m + side * GAUGE / 2) for m in middles for side in (-1, 1)]
