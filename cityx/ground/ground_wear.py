"""How the ground is worn, as a picture seen from above: wheels, repairs, fields of yards."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from cityx.city.lanes import MOVEMENTS, LaneGraph
from cityx.city.mesh import MeshBatch
from cityx.city.roads import RoadNetwork
from cityx.city.section import KIND
from cityx.geometry.arrays import FloatArray, IntArray
from cityx.geometry.polylines import Polylines, arc_lengths, miters, pieces
from cityx.geometry.ranges import ranges
from cityx.ground.street_repairs import SEAM_TONE, lane_seams, mouth_seams, street_repairs
from cityx.ids import choose, uniform

Bytes = NDArray[np.uint8]

CELL = 0.14  # metres per pixel: three across a tyre with its splashes
MOST = 4096  # pixels along an edge; larger sites get coarser ones
FINER = 2  # times as fine as the picture repairs are drawn
NEUTRAL = 128  # as worn as everything else
FORECOURT = 3.0  # metres from a carriageway within which yards are paved as usual
RIM = -0.75  # tone of the bitumen that seals a repair
PURPOSE = "yard field"
BRICK = 0.85  # tone from which a field is laid with brick
REACH = (3.0, 22.0)  # metres of ground on each side of a house that belongs to it
# Tones of asphalt, worn and usual blocks, pale slabs and brick, each a range, and how often.
TONES = (((-1.0, -0.75), 3.0), ((-0.6, -0.15), 3.0), ((-0.1, 0.1), 1.5), ((0.3, 0.65), 3.0),
         ((BRICK, 1.0), 1.6))  # fmt: skip
LEVEL = 0.05  # metres between the ends of an edge of a wall that runs level
SIDES = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)], float)

LANE = 3.1  # metres; as many lanes as fit between the kerbs
GAUGE = 1.5  # metres between the wheels of a car
WIDTH = 0.42  # metres, of a path that many cars have driven
NARROW = 2.0  # metres; on streets with less than this to either side cars share one lane
DRIVEN = ("drive", "bus")
TURNED = 0.55  # of the wear of a lane that a turn from it into another has
WAITING, WAIT_WIDTH, WAITED = 14.0, 0.7, 0.4  # metres before a junction where oil drips, and wear


def ground_wear(
    network: RoadNetwork,
    houses: MeshBatch | None,
    extent: tuple[float, float, float, float],
    lanes: LaneGraph | None = None,
) -> tuple[Bytes, float]:
    """Draw what happened to the ground of a site.

    Parameters
    ----------
    network
        Centrelines and half widths.
    houses
        Shells of the houses, None where there are none.
    extent
        (xmin, ymin, xmax, ymax), metres.
    lanes
        The lane graph, whose lanes and turns tell where wheels run.

    Returns
    -------
    picture
        (h, w, 3) uint8, first row in the south: 255 in a wheel path; tone of repairs of streets;
        tone of the fields of yards. Tones are 128 where nothing was done, more where it is paler.
    cell
        Metres per pixel.
    """
    from PIL import Image, ImageDraw

    xmin, ymin, xmax, ymax = extent
    cell = max(CELL, max(xmax - xmin, ymax - ymin) / MOST)
    size = (max(int((xmax - xmin) / cell), 1), max(int((ymax - ymin) / cell), 1))
    repairs = Image.new("L", (FINER * size[0], FINER * size[1]), NEUTRAL)
    fields = Image.new("L", size, NEUTRAL)
    draw = ImageDraw.Draw(repairs)

    corner = np.array([xmin, ymin])

    def placed(points: FloatArray, finer: int = 1) -> Any:
        """Return x and y of (..., n, 2) points in turn, as Pillow reads them soonest."""
        found = (points - corner) * (finer / cell)
        return found.reshape(*found.shape[:-2], found.shape[-2] * found.shape[-1]).tolist()

    for seam in (*lane_seams(network), *mouth_seams(network)):
        draw.line(placed(seam, FINER), _byte(SEAM_TONE), FINER)
    found = street_repairs(network)
    for outline, tone in zip(found.outline, found.tone.tolist(), strict=True):
        ring = placed(outline, FINER)
        draw.polygon(ring, _byte(tone))
        # A polygon's wide outline takes far longer.
        draw.line([*ring, *ring[:2]], _byte(RIM), FINER)
    repairs = repairs.reduce(FINER)  # so that edges aslant are no stairs
    if houses is not None:
        draw = ImageDraw.Draw(fields)
        outlines, tones = yard_fields(houses)
        for field, tone in zip(placed(outlines), tones.tolist(), strict=True):
            draw.polygon(field, _byte(tone), _byte(RIM))
        # What lies before a house was paved with its street.
        for edge, half in enumerate(network.half_width.tolist()):
            first, last = network.point_start[edge : edge + 2]
            wide = max(round(2 * (half + FORECOURT) / cell), 1)
            draw.line(placed(network.points[first:last]), NEUTRAL, wide, "curve")
    tracks = tyre_tracks(network, lanes, (xmin, ymin), size, cell)
    picture = np.stack([tracks, np.asarray(repairs), np.asarray(fields)], axis=2)
    picture[[0, -1]] = picture[:, [0, -1]] = (0, NEUTRAL, NEUTRAL)  # what goes on beyond the site
    return picture, cell


def _byte(tone: float) -> int:
    """Return a tone from -1 to 1 as it is drawn."""
    return round(NEUTRAL + (NEUTRAL - 1) * tone)


def yard_fields(houses: MeshBatch) -> tuple[FloatArray, FloatArray]:
    """Draw a rectangle of ground about each house, square to its longest wall.

    Parameters
    ----------
    houses
        k shells.

    Returns
    -------
    outline
        (k, 4, 2) float, metres. Fields of neighbours overlap; the later one hides the earlier.
    tone
        (k,) float, how much paler (to 1) or darker (to -1) than the usual paving it is; from
        `BRICK` on it is brick.
    """
    count = houses.count
    if not count:
        return np.zeros((0, 4, 2)), np.zeros(0)
    along = _long_walls(houses)
    frame = np.stack([along, np.column_stack([-along[:, 1], along[:, 0]])], axis=2)  # (k, 2, 2)
    house = np.repeat(np.arange(count), np.diff(houses.vertex_start))
    own = np.einsum("ni,nij->nj", houses.vertices[:, :2], frame[house])
    start = houses.vertex_start[:-1]
    low, high = np.minimum.reduceat(own, start), np.maximum.reduceat(own, start)
    drawn = [
        uniform(0, PURPOSE, houses.object_id, side) for side in range(4)
    ]  # the ground before, behind and beside
    reach = REACH[0] + (REACH[1] - REACH[0]) * np.stack(drawn, axis=1)
    low, high = low - reach[:, :2], high + reach[:, 2:]
    corner = np.where(SIDES[None] < 0, low[:, None], high[:, None])  # (k, 4, 2)
    outline = np.einsum("kcj,kij->kci", corner, frame)
    kind = choose(0, f"{PURPOSE}/kind", houses.object_id, [share for _, share in TONES])
    least, most = np.array([span for span, _ in TONES])[kind].T
    tone = uniform(0, f"{PURPOSE}/tone", houses.object_id)
    return outline, least + (most - least) * tone


def _long_walls(houses: MeshBatch) -> FloatArray:
    """(k, 2) unit vectors along the longest level edge of each shell."""
    first, second = (houses.vertices[houses.faces[:, corner]] for corner in (0, 1))  # (f, 3) each
    edge = second - first
    length = np.hypot(edge[:, 0], edge[:, 1]) * (np.abs(edge[:, 2]) < LEVEL)
    most = np.maximum.reduceat(length, houses.face_start[:-1])
    house = np.repeat(np.arange(houses.count), np.diff(houses.face_start))
    longest = np.zeros(houses.count, np.int64)
    reaching = np.flatnonzero(length == most[house])
    longest[house[reaching]] = reaching  # the last of equal ones
    way = edge[longest, :2]
    size = np.maximum(length[longest], 1e-9)[:, None]
    return np.asarray(np.where(length[longest, None] > 0, way / size, (1.0, 0.0)))


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
            path = points[first:last].ravel().tolist()
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
