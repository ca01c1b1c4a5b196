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


def ground_levels(layout: Layout, terrain: Terrain) -> NDArray[np.float64]:
    """Return the level that the heights of each part count from, (n,) metres.

    It is the lowest terrain under the outline of the part's building, plus the kerb.
    """
    building = layout.parts["building"].to_numpy(np.uint64)
    polygons = layout.parts.geometry.to_numpy()
    outlines = layout.buildings.geometry.to_numpy()
    described = layout.buildings["id"].to_numpy(np.uint64)
    ids = np.concatenate([described, building])
    known, of_row = np.unique(ids, return_inverse=True)
    alone = np.where(np.isin(building, described), shapely.Polygon(), polygons)
    shapes = np.concatenate([outlines, alone])
    points, row = shapely.get_coordinates(shapes, return_index=True)
    finite = np.isfinite(points).all(axis=1)
    lowest = np.full(len(known), np.inf)
    np.minimum.at(lowest, of_row[row[finite]], terrain.height_at(points[finite]))
    lowest[~np.isfinite(lowest)] = 0.0
    return np.asarray(lowest[of_row[len(outlines) :]] + KERB_HEIGHT)
