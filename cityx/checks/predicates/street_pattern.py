"""The pattern of a street network, from its geometry alone: grid, radial, organic or ring.

A piece of street belongs to a *grid* where the streets around it run along two axes at right
angles, which the resultant of bearings folded to 90 degrees measures; it is *radial* where it
points at, or runs around, a hub that streets from many sides lead to. What is neither is
*organic*. Length decides.

References
----------
Boeing, "Urban spatial order: street network orientation, configuration, and entropy", Applied
Network Science 4, 2019, for the orientation order of a whole network.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.geometry.arrays import BoolArray, FloatArray

PIECE = 25.0  # metres of the pieces that bearings are taken of; shorter bends are drawing
REACH = 160.0  # metres around a piece that tell its grid, two blocks
ALIGNED = 0.72  # resultant of folded bearings from which streets run along two axes
# Measured on towns of every pattern and on maps: grids have 0.99 or more of such streets, others at
# most 0.73; towns of radial districts have 0.24 or more around hubs, grids and bent streets at
# most 0.10.
GRID_SHARE, RADIAL_SHARE = 0.75, 0.22
HUB_REACHES = (150.0, 200.0, 300.0, 500.0)  # metres around a hub whose streets are looked at
HUB_EVERY = 40.0  # metres between the places that may be hubs
HUB_LEAST = 40.0  # metres; nearer, every street is as good as radial
HUB_LENGTH = 800.0  # metres of street that can tell a hub
CENTRED = 0.4  # mean of cos(4 x angle to the radius) from which streets share a centre; 0 by chance
SECTORS, SPOKES = 8, 5  # directions around a hub, and from how many streets must come
INWARD = np.radians(20.0)  # off the radius, of a street that leads to a hub
SPOKE_LENGTH = 30.0  # metres of street in a direction that make it a spoke
BINS = 36  # of bearings, for the entropy of all


@dataclass(frozen=True)
class Pattern:
    """What a network looks like.

    Attributes
    ----------
    word
        "grid", "radial", "organic", "ring", or "" without streets.
    grid, radial
        Shares of the length.
    order
        Orientation order of the whole, 0 (all directions alike) to 1 (one grid).
    """

    word: str
    grid: float
    radial: float
    order: float


def pieces_of(lines: NDArray[Any]) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Cut lines into straight pieces: middles (n, 2), bearings (n,) in [0, pi) and lengths (n,)."""
    cut = shapely.segmentize(shapely.simplify(lines, 1.0), PIECE)
    points, line = shapely.get_coordinates(cut, return_index=True)
    along = np.diff(points, axis=0)
    kept = (np.diff(line) == 0) & (np.hypot(*along.T) > 0)
    along, start = along[kept], points[:-1][kept]
    bearing = np.arctan2(along[:, 1], along[:, 0]) % np.pi
    return start + along / 2, bearing, np.hypot(*along.T)


def orientation_order(bearing: FloatArray, length: FloatArray) -> float:
    """Return how far bearings keep to two axes, 0 to 1, from their entropy (Boeing 2019)."""
    both = np.concatenate([bearing, bearing + np.pi])
    width = 2 * np.pi / BINS
    number = np.floor((both + width / 2) / width).astype(int) % BINS
    share = np.bincount(number, np.tile(length, 2), minlength=BINS)
    share = share[share > 0] / share.sum()
    entropy = -float((share * np.log(share)).sum())
    least, most = np.log(4), np.log(BINS)
    return float(1 - (max(entropy - least, 0.0) / (most - least)) ** 2)


def gridlike(middle: FloatArray, bearing: FloatArray, length: FloatArray) -> BoolArray:
    """(n,) whether the pieces around each one run along two axes, and it along one of them."""
    folded = length * np.exp(4j * bearing)
    tree = shapely.STRtree(shapely.points(middle))
    near, of = tree.query(shapely.points(middle), predicate="dwithin", distance=REACH)
    total = np.bincount(near, length[of], minlength=len(middle))
    real = np.bincount(near, folded.real[of], minlength=len(middle))
    imaginary = np.bincount(near, folded.imag[of], minlength=len(middle))
    resultant = (real + 1j * imaginary) / np.maximum(total, 1e-9)
    own = np.cos(4 * bearing - np.angle(resultant))
    return np.asarray((np.abs(resultant) >= ALIGNED) & (own > 0))


def around_hubs(middle: FloatArray, bearing: FloatArray, length: FloatArray) -> BoolArray:
    """(n,) whether a piece points at, or runs around, a hub that streets from all sides lead to."""
    found = np.zeros(len(middle), bool)
    for places in np.array_split(_lattice(middle), 8):
        away = (middle - places[:, None]).astype(np.float32)  # (h, n, 2)
        far = np.hypot(away[..., 0], away[..., 1])
        angle = np.arctan2(away[..., 1], away[..., 0])
        along = np.cos(4 * (bearing.astype(np.float32) - angle))
        spoke = _sectors(angle, bearing)
        for reach in HUB_REACHES:
            near = (far > HUB_LEAST) & (far < reach)
            weight = near * length.astype(np.float32)
            total = weight.sum(axis=1)
            score = (weight * along).sum(axis=1) / np.maximum(total, 1.0)
            maybe = np.flatnonzero((score >= CENTRED) & (total >= HUB_LENGTH))
            for h in maybe.tolist():
                led = np.bincount(spoke[h], weight[h], minlength=SECTORS + 1)[:SECTORS]
                if np.count_nonzero(led > SPOKE_LENGTH) >= SPOKES:
                    found |= near[h] & (along[h] > 0)
    return found


def _lattice(middle: FloatArray) -> FloatArray:
    low, high = middle.min(axis=0), middle.max(axis=0)
    axes = [np.arange(a, b + HUB_EVERY, HUB_EVERY) for a, b in zip(low, high, strict=True)]
    x, y = np.meshgrid(*axes)
    return np.column_stack([x.ravel(), y.ravel()])


def _sectors(angle: NDArray[np.float32], bearing: FloatArray) -> NDArray[np.int64]:
    """(h, n) direction that each piece leads to a hub from, `SECTORS` for one that does not."""
    off = np.abs((bearing - angle + np.pi / 2) % np.pi - np.pi / 2)
    sector = np.floor((angle + np.pi) / (2 * np.pi) * SECTORS).astype(np.int64) % SECTORS
    return np.where(off < INWARD, sector, SECTORS)


def pattern_of(lines: NDArray[Any], *, rings: int = 0) -> Pattern:
    """Return the pattern of streets, (n,) linestrings.

    Parameters
    ----------
    rings
        Roads that run all the way round a centre, for streets that are neither grid nor radial.
    """
    if not len(lines) or shapely.length(lines).sum() <= 0:
        return Pattern("", 0.0, 0.0, 0.0)
    middle, bearing, length = pieces_of(lines)
    grid = float(length[gridlike(middle, bearing, length)].sum() / length.sum())
    order = orientation_order(bearing, length)
    if grid >= GRID_SHARE:
        return Pattern("grid", grid, 0.0, order)
    radial = float(length[around_hubs(middle, bearing, length)].sum() / length.sum())
    word = "radial" if radial >= RADIAL_SHARE else "ring" if rings else "organic"
    return Pattern(word, grid, radial, order)
