"""Grading: the terrain is cut and filled so that roads lie level across and even along."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from cityx.city.terrain import Terrain
from cityx.geometry.arrays import BoolArray, FloatArray, IntArray
from cityx.ground.grades import Slopes, graded
from cityx.places.profiles import usual_lane

if TYPE_CHECKING:
    from scipy.spatial import cKDTree

FINEST = 2.0  # metres between heights of a graded terrain, where the site is small enough
MOST = 3_000_000  # heights of a graded terrain; on larger sites they lie farther apart
VERGE = 2.5  # metres beside the carriageway that lie level with it: kerb and walk
SOIL = 1 / 1.5  # rise over run of slopes above and below a road
CORRIDOR = 15.0  # metres beside the strip in which they meet the land
HIGHEST_WALL = 6.0  # metres
ROCK = 2.0  # rise over run behind the corridor, where no wall is high enough
NEAR = 6  # stations whose heights are weighed at a place
MOST_TIED = 24  # stations as far from a place that are told apart
# Where two roads overlap the wider one is level farther from its axis: as if both were of one lane
# to a side.
LEAST_HALF = 1.0  # metres
CARRIED = 5.0  # metres along a road to which a station tells its slope: to the next one
FARTHEST = 60.0  # metres from a road at which every terrain is left alone
ROWS = 256  # of the grid that are graded at once
SPREAD = 30.0  # metres about a slope too steep in which it may lie flatter instead
EASED = 10.0  # metres before the farthest in which that ends


def grade_terrain(
    terrain: Terrain,
    points: FloatArray,
    z: FloatArray,
    climb: FloatArray,
    half: FloatArray,
    extent: tuple[float, float, float, float],
) -> Terrain:
    """Return a terrain that meets roads at their height and eases into the old one beside them.

    Beside roads soil lies no steeper than 1 in 1.5, or than it lay: what height is left between a
    road and such a slope is a step at the edge of the road's level strip, for a retaining wall.

    Parameters
    ----------
    terrain
        The terrain as measured.
    points, z, climb, half
        (p, 2), (p,), (p, 2) and (p,) float: stations of roads, their heights, the slope of the
        road there as a vector along it, rise over run, and half widths; metres.
    extent
        (xmin, ymin, xmax, ymax) of the site, metres.

    Returns
    -------
    terrain
        Heights on a finer grid over the site and what the old grid covers beyond it.
    """
    from scipy.spatial import cKDTree

    if not len(points):
        return terrain
    # By place and what they say, so that of stations as far away the same are taken on any site.
    order = np.lexsort((half, *climb.T, z, *points.T))
    points, z, climb, half = points[order], z[order], climb[order], half[order]
    fine = _refined(terrain, extent)
    heights = fine.heights.copy()
    apart = np.full(heights.shape, np.inf)  # metres from the nearest level strip
    tree = cKDTree(points)
    columns = heights.shape[1]
    x = fine.origin[0] + fine.cell * np.arange(columns)
    lane = usual_lane()
    for begin in range(0, len(heights), ROWS):
        y = fine.origin[1] + fine.cell * np.arange(begin, min(begin + ROWS, len(heights)))
        xy = np.column_stack([np.tile(x, len(y)), np.repeat(y, columns)])
        distance, station = _nearest(tree, xy)
        rows = np.flatnonzero(np.isfinite(distance[:, 0]))
        if not len(rows):
            continue
        far, near = distance[rows], np.minimum(station[rows], len(points) - 1)
        beyond = np.maximum(far - half[near] - VERGE, 0.0)
        axis = 1.0 + lane * far / np.maximum(half[near], LEAST_HALF)
        pull = np.where(np.isfinite(far), 1.0 / (0.25 + beyond) ** 2 / axis**2, 0.0)
        rise = ((xy[rows][:, None] - points[near]) * climb[near]).sum(axis=2)
        most = CARRIED * np.hypot(*np.moveaxis(climb[near], 2, 0))
        road = (pull * (z[near] + np.clip(rise, -most, most))).sum(axis=1) / pull.sum(axis=1)
        old = heights[begin : begin + len(y)].reshape(-1)
        least = beyond.min(axis=1)
        ahead = (xy[rows] - points[near[:, 0]]) / np.maximum(far[:, :1], fine.cell / 2)
        strip = half[near[:, 0]] + VERGE
        rim = points[near[:, 0]] + ahead * (strip + CORRIDOR)[:, None]
        low, high = _slopes(least, terrain.height_at(rim) - road)
        old[rows] = np.clip(old[rows], road + low, road + high)
        apart[begin : begin + len(y)].reshape(-1)[rows] = least
    heights = _standing(fine, heights, apart)
    return Terrain(fine.origin, fine.cell, np.round(heights, 4), fine.datum)


def _nearest(tree: cKDTree, xy: FloatArray) -> tuple[FloatArray, IntArray]:
    """Return (k, n) distances and stations nearest to places, at most `NEAR`, by their number.

    Stations of several ways at a junction are as far from a place: of those the first are taken.
    """
    count = min(NEAR, tree.n)
    distance, station = (
        part.reshape(len(xy), -1)
        for part in tree.query(xy, k=min(count + 1, tree.n), distance_upper_bound=FARTHEST)
    )
    last = distance[:, -1]
    tied = np.flatnonzero((last == distance[:, count - 1]) & np.isfinite(last))
    distance, station = distance[:, :count].copy(), station[:, :count].copy()
    if tree.n > count and len(tied):
        most = min(MOST_TIED, tree.n)
        far, every = tree.query(xy[tied], k=most, distance_upper_bound=FARTHEST)
        order = np.lexsort((every, far))[:, :count]
        distance[tied] = np.take_along_axis(far, order, axis=1)
        station[tied] = np.take_along_axis(every, order, axis=1)
    return distance, station


def _slopes(apart: FloatArray, rise: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return how far soil may lie below and above a road: (k,) metres each, the first negative.

    Slopes start at the road's strip and meet the land within the corridor; where it is too steep
    or too far off for that, a wall at the strip takes what is missing, and behind the corridor
    they get steeper.

    Parameters
    ----------
    apart
        (k,) metres from the strip.
    rise
        (k,) metres that the land at the rim of the corridor lies above the road.
    """
    climb = SOIL * np.minimum(apart, CORRIDOR) + ROCK * np.maximum(apart - CORRIDOR, 0.0)
    walls = [np.clip(sign * rise - SOIL * CORRIDOR, 0.0, HIGHEST_WALL) for sign in (-1, 1)]
    below, above = (climb + np.where(apart > 0, wall, 0.0) for wall in walls)
    return -below, above


def _standing(before: Terrain, heights: FloatArray, apart: FloatArray) -> FloatArray:
    """Flatten slopes beside roads that are steeper than soil stands, and than they were.

    Parameters
    ----------
    before
        The terrain before roads were laid, on the same grid.
    heights, apart
        (rows, columns) heights with roads, and metres from their level strips; metres.
    """
    from scipy.ndimage import maximum_filter

    soil = (apart > 0) & np.isfinite(apart)
    pairs, run = _neighbours(soil)
    z, old = heights.ravel(), before.heights.ravel()
    rise = np.maximum(run * before.cell * SOIL, np.abs(old[pairs[:, 0]] - old[pairs[:, 1]]))
    steep = np.abs(z[pairs[:, 0]] - z[pairs[:, 1]]) > rise
    if not steep.any():
        return heights
    near = np.zeros(heights.shape, bool)
    near.ravel()[pairs[steep]] = True
    near = maximum_filter(near, 2 * int(np.ceil(SPREAD / before.cell)) + 1) & soil
    node = np.flatnonzero(near.ravel())
    inside = near.ravel()[pairs].all(axis=1)
    slopes = Slopes(np.searchsorted(node, pairs[inside]), rise[inside])
    share = np.clip((FARTHEST - apart.ravel()[node]) / EASED, 0.0, 1.0)
    flat = z.copy()
    flat[node] += share * (graded(slopes, z[node]) - z[node])
    return flat.reshape(heights.shape)


def _neighbours(chosen: BoolArray) -> tuple[IntArray, FloatArray]:
    """Pair chosen nodes of a grid with those beside and across: (k, 2) nodes, (k,) steps apart."""
    number = np.arange(chosen.size).reshape(chosen.shape)
    rows, columns = chosen.shape
    pairs, run = [], []
    for down, right in ((0, 1), (1, 0), (1, 1), (1, -1)):
        left = max(-right, 0)
        here = (slice(0, rows - down), slice(left, columns - max(right, 0)))
        there = (slice(down, rows), slice(left + right, columns - max(right, 0) + right))
        both = chosen[here] & chosen[there]
        pairs.append(np.column_stack([number[here][both], number[there][both]]))
        run.append(np.full(len(pairs[-1]), np.hypot(down, right)))
    return np.concatenate(pairs), np.concatenate(run)


def _refined(terrain: Terrain, extent: tuple[float, float, float, float]) -> Terrain:
    """Return the same terrain with heights close enough together to show a road.

    They lie at multiples of their distance, whatever the extent.
    """
    xmin, ymin, xmax, ymax = extent
    cell = FINEST
    while (xmax - xmin) * (ymax - ymin) > MOST * cell**2:
        cell *= 2
    cell = min(cell, terrain.cell)
    low, high = (np.floor(np.array(side) / cell).astype(int) for side in (extent[:2], extent[2:]))
    columns, rows = (high - low + 4).tolist()
    origin = (float(cell * (low[0] - 1)), float(cell * (low[1] - 1)))
    x = origin[0] + cell * np.arange(columns)
    y = origin[1] + cell * np.arange(rows)
    heights = np.empty((rows, columns))
    for begin in range(0, rows, ROWS):
        part = y[begin : begin + ROWS]
        xy = np.column_stack([np.tile(x, len(part)), np.repeat(part, columns)])
        heights[begin : begin + ROWS] = terrain.height_at(xy).reshape(len(part), columns)
    return Terrain(origin, cell, heights, terrain.datum)
