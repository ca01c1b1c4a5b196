"""Levels: where the ground of a building lies."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.city.ground import KERB_HEIGHT

if TYPE_CHECKING:
    from cityx.city.layout import Layout
    from cityx.city.terrain import Terrain

SUNK = 1.5  # metres a building may stand in the slope behind it, half a storey
EVERY = 4.0  # metres between the places along a wall at which the terrain is looked up


def ground_levels(layout: Layout, terrain: Terrain) -> NDArray[np.float64]:
    """Return the level that the heights of each part count from, (n,) metres.

    It is the lowest terrain at the walls of the part's building, plus the kerb; on a slope so much
    higher that no side stands more than `SUNK` in the ground.
    """
    lowest, highest = terrain_at_walls(layout, terrain)
    return np.asarray(np.maximum(lowest, highest - SUNK) + KERB_HEIGHT)


def terrain_at_walls(
    layout: Layout, terrain: Terrain
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the lowest and the highest terrain at the walls of each part's building, (n,)."""
    building = layout.parts["building"].to_numpy(np.uint64)
    shapes = np.concatenate([
        layout.buildings.geometry.to_numpy(), layout.parts.geometry.to_numpy(),
    ])  # fmt: skip
    known, of_row = np.unique(
        np.concatenate([layout.buildings["id"].to_numpy(np.uint64), building]), return_inverse=True
    )
    if not terrain.is_flat:
        shapes = shapely.segmentize(shapes, EVERY)
    points, row = shapely.get_coordinates(shapes, return_index=True)
    finite = np.isfinite(points).all(axis=1)
    height, row = terrain.height_at(points[finite]), of_row[row[finite]]
    found = []
    for extreme, start in ((np.minimum, np.inf), (np.maximum, -np.inf)):
        value = np.full(len(known), start)
        extreme.at(value, row, height)
        value[~np.isfinite(value)] = 0.0
        found.append(value[of_row[len(layout.buildings) :]])
    return found[0], found[1]
