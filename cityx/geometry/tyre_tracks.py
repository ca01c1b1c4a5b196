"""Where tyres run: the wheel paths of streets as a picture seen from above."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cityx.city.roads import RoadNetwork

LANE = 3.1  # metres; as many lanes as fit between the kerbs
GAUGE = 1.5  # metres between the wheels of a car
WIDTH = 0.42  # metres, of a path that many cars have driven
NARROW = 2.0  # metres; on streets with less than this to either side cars share one lane


def tyre_tracks(
    network: RoadNetwork, corner: tuple[float, float], size: tuple[int, int], cell: float
) -> NDArray[np.uint8]:
    """Draw the wheel paths of all streets.

    Parameters
    ----------
    network
        Centrelines and half widths.
    corner
        South-western corner of the picture, metres.
    size
        Pixels across and up.
    cell
        Metres per pixel.

    Returns
    -------
    picture
        (h, w) uint8, 255 in a wheel path, first row in the south.
    """
    from PIL import Image, ImageDraw, ImageFilter

    picture = Image.new("L", size)
    draw = ImageDraw.Draw(picture)
    for edge in range(network.edge_count):
        points = (network.edge_points(edge) - corner) / cell
        half = float(network.half_width[edge])
        if len(points) < 2 or half < 1.3:  # footways
            continue
        left = _left_of(points)
        for offset in wheel_offsets(half):
            path = points + offset / cell * left
            draw.line([tuple(point) for point in path.tolist()], 255, round(WIDTH / cell), "curve")
    return np.asarray(picture.filter(ImageFilter.GaussianBlur(0.08 / cell)))


def wheel_offsets(half: float) -> list[float]:
    """Return the distances of wheel paths from the middle of a street with `half` its width."""
    lanes = 1 if half < NARROW else max(2, int(2 * half // LANE))
    middles = (np.arange(lanes) - (lanes - 1) / 2) * min(LANE, 2 * half / lanes)
    return [float(m + side * GAUGE / 2) for m in middles for side in (-1, 1)]


def _left_of(points: NDArray[np.float64]) -> NDArray[np.float64]:
    """(n, 2) unit vectors to the left of a line at each of its points."""
    way = np.gradient(points, axis=0)
    way /= np.maximum(np.linalg.norm(way, axis=1, keepdims=True), 1e-9)
    return np.column_stack([-way[:, 1], way[:, 0]])
