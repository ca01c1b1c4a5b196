"""How the ground is worn, as a picture seen from above: wheels, repairs, fields of yards."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cityx.city.lanes import LaneGraph
from cityx.city.mesh import MeshBatch
from cityx.city.roads import RoadNetwork
from cityx.ground.street_repairs import SEAM_TONE, lane_seams, mouth_seams, street_repairs
from cityx.ground.tyre_tracks import tyre_tracks
from cityx.ground.yard_fields import yard_fields

FloatArray = NDArray[np.float64]
Bytes = NDArray[np.uint8]

CELL = 0.14  # metres per pixel: three across a tyre with its splashes
MOST = 4096  # pixels along an edge; larger sites get coarser ones
FINER = 2  # times as fine as the picture repairs are drawn
NEUTRAL = 128  # as worn as everything else
FORECOURT = 3.0  # metres from a carriageway within which yards are paved as usual
RIM = -0.75  # tone of the bitumen that seals a repair


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

    def placed(points: FloatArray, finer: int = 1) -> list[tuple[float, ...]]:
        return [tuple(point) for point in ((points - (xmin, ymin)) * (finer / cell)).tolist()]

    for seam in (*lane_seams(network), *mouth_seams(network)):
        draw.line(placed(seam, FINER), _byte(SEAM_TONE), FINER)
    found = street_repairs(network)
    for outline, tone in zip(found.outline, found.tone.tolist(), strict=True):
        ring = placed(outline, FINER)
        draw.polygon(ring, _byte(tone))
        draw.line([*ring, ring[0]], _byte(RIM), FINER)  # a polygon's wide outline takes far longer
    repairs = repairs.reduce(FINER)  # so that edges aslant are no stairs
    if houses is not None:
        draw = ImageDraw.Draw(fields)
        for outline, tone in zip(*yard_fields(houses), strict=True):
            draw.polygon(placed(outline), _byte(float(tone)), _byte(RIM))
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
