"""Motion: even steps along lines, speeds that bends allow, headings without a jerk."""

from __future__ import annotations

import numpy as np
from scipy.ndimage import gaussian_filter1d

from cityx.geometry.arrays import FloatArray
from cityx.geometry.polylines import Polylines, arc_lengths, locate


def along_line(points: FloatArray, place: FloatArray) -> FloatArray:
    """Return (f, 2) places on one line of (k, 2) points, metres from its start."""
    line = Polylines(points[:, :2], np.array([0, len(points)], np.int64))
    return locate(line, np.zeros(len(place), np.int64), place)[0]


def length_of(points: FloatArray) -> float:
    """Return the metres along (k, 2) points."""
    line = Polylines(points[:, :2], np.array([0, len(points)], np.int64))
    return float(arc_lengths(line)[1][0])


def smoothed(values: FloatArray, spread: float) -> FloatArray:
    """Return (f, ...) values blurred along the first axis; ends go on as they were going.

    Parameters
    ----------
    values
        At even steps.
    spread
        Standard deviation of the blur, in steps.
    """
    if spread < 0.1 or len(values) < 3:
        return values.copy()
    reach = min(int(np.ceil(4 * spread)), len(values) - 1)
    before = 2 * values[0] - values[reach:0:-1]
    after = 2 * values[-1] - values[-2 : -reach - 2 : -1]
    blurred = gaussian_filter1d(np.concatenate([before, values, after]), spread, axis=0)
    return np.asarray(blurred[reach : reach + len(values)])


def headings(way: FloatArray) -> FloatArray:
    """Return (f,) headings of (f, 2) directions, clockwise from north, without a jump between."""
    return np.unwrap(np.arctan2(way[:, 0], way[:, 1]))


def speeds(
    points: FloatArray, limit: FloatArray, step: float, *, sideways: float, faster: float,
    slower: float,
) -> FloatArray:  # fmt: skip
    """Return the (k,) greatest speeds along a line, metres per second.

    Parameters
    ----------
    points
        (k, 2) metres, `step` apart.
    limit
        (k,) metres per second that are allowed.
    sideways, faster, slower
        Metres per second squared across the line, and along it.
    """
    way = np.gradient(points, step, axis=0)
    turn = np.abs(np.gradient(np.unwrap(np.arctan2(way[:, 1], way[:, 0])), step))
    found = np.minimum(limit, np.sqrt(sideways / np.maximum(turn, 1e-6)))
    for row in range(1, len(found)):
        found[row] = min(found[row], np.sqrt(found[row - 1] ** 2 + 2 * faster * step))
    for row in range(len(found) - 2, -1, -1):
        found[row] = min(found[row], np.sqrt(found[row + 1] ** 2 + 2 * slower * step))
    return found
