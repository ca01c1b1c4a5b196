"""Grading: the terrain is cut and filled so that roads lie level across and even along."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cityx.city.terrain import Terrain

FloatArray = NDArray[np.float64]

FINEST = 2.0  # metres between heights of a graded terrain, where the site is small enough
MOST = 3_000_000  # heights of a graded terrain; on larger sites they lie farther apart
VERGE = 2.5  # metres beside the carriageway that lie level with it: kerb and walk
SLOPE = 2.0  # metres out for each metre of cut or fill
LEAST_SLOPE = 4.0  # metres over which even a small step is evened out
NEAR = 6  # stations whose heights are weighed at a place
CARRIED = 5.0  # metres along a road to which a station tells its slope: to the next one
FARTHEST = 60.0  # metres from a road at which every terrain is left alone
ROWS = 256  # of the grid that are graded at once


def grade_terrain(
    terrain: Terrain,
    points: FloatArray,
    z: FloatArray,
    climb: FloatArray,
    half: FloatArray,
    extent: tuple[float, float, float, float],
) -> Terrain:
    """Return a terrain that meets roads at their height and eases into the old one beside them.

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
    fine = _refined(terrain, extent)
    heights = fine.heights.copy()
    tree = cKDTree(points)
    columns = heights.shape[1]
    x = fine.origin[0] + fine.cell * np.arange(columns)
    for begin in range(0, len(heights), ROWS):
        y = fine.origin[1] + fine.cell * np.arange(begin, min(begin + ROWS, len(heights)))
        xy = np.column_stack([np.tile(x, len(y)), np.repeat(y, columns)])
        count = min(NEAR, len(points))
        distance, station = tree.query(xy, k=count, distance_upper_bound=FARTHEST)
        distance, station = distance.reshape(-1, count), station.reshape(-1, count)
        rows = np.flatnonzero(np.isfinite(distance[:, 0]))
        if not len(rows):
            continue
        far, near = distance[rows], np.minimum(station[rows], len(points) - 1)
        beyond = np.maximum(far - half[near] - VERGE, 0.0)
        pull = np.where(np.isfinite(far), 1.0 / (0.25 + beyond) ** 2 / (1.0 + far) ** 2, 0.0)
        rise = ((xy[rows][:, None] - points[near]) * climb[near]).sum(axis=2)
        most = CARRIED * np.hypot(*np.moveaxis(climb[near], 2, 0))
        road = (pull * (z[near] + np.clip(rise, -most, most))).sum(axis=1) / pull.sum(axis=1)
        old = heights[begin : begin + len(y)].reshape(-1)
        change = road - old[rows]
        # A slope too long for the room beside the road gets steeper: it ends in no cliff.
        room = FARTHEST - VERGE - half[near[:, 0]]
        reach = np.clip(SLOPE * np.abs(change), LEAST_SLOPE, room)
        share = np.clip(1.0 - beyond.min(axis=1) / reach, 0.0, 1.0)
        old[rows] += change * share
    return Terrain(fine.origin, fine.cell, np.round(heights, 4), fine.datum)


def _refined(terrain: Terrain, extent: tuple[float, float, float, float]) -> Terrain:
    """Return the same terrain with heights close enough together to show a road."""
    xmin, ymin, xmax, ymax = extent
    area = max((xmax - xmin) * (ymax - ymin), 1.0)
    cell = max(FINEST, float(np.ceil(np.sqrt(area / MOST))))
    cell = min(cell, terrain.cell)
    columns = int(np.ceil((xmax - xmin) / cell)) + 3
    rows = int(np.ceil((ymax - ymin) / cell)) + 3
    origin = (xmin - cell, ymin - cell)
    x = origin[0] + cell * np.arange(columns)
    y = origin[1] + cell * np.arange(rows)
    heights = np.empty((rows, columns))
    for begin in range(0, rows, ROWS):
        part = y[begin : begin + ROWS]
        xy = np.column_stack([np.tile(x, len(part)), np.repeat(part, columns)])
        heights[begin : begin + ROWS] = terrain.height_at(xy).reshape(len(part), columns)
    return Terrain(origin, cell, heights, terrain.datum)
