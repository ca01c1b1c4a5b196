"""Levels: where the ground of a building lies."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.city.ground import KERB_HEIGHT
from cityx.city.layout import BAY

if TYPE_CHECKING:
    from collections.abc import Callable

    from cityx.city.layout import Layout
    from cityx.city.terrain import Terrain

SUNK = 1.5  # metres a building may always stand in the slope behind it, half a storey
ROOM = 2.3  # metres of wall below its eave that a part keeps above the slope behind it, a door
ALIGNED = 0.4  # metres by which the ground of a bay may be moved so that floors meet
SETTLES = 3  # times that heights and the ground they count from are worked out from each other
EVERY = 4.0  # metres between the places along a wall at which the terrain is looked up


def ground_levels(layout: Layout, terrain: Terrain) -> NDArray[np.float64]:
    """Return the level that the heights of each part count from, (n,) metres.

    It is the lowest terrain at the walls of the part's building, plus the kerb: heights of
    OpenStreetMap count from the lowest place where a building meets the ground. Where the slope
    behind a part would leave less than `ROOM` of its wall free, the building stands so much higher,
    but no side more than `SUNK` in the ground. A bay of a stepped house counts from its own walls;
    bays stand whole half storeys above the lowest where that moves them little.
    """
    group, lowest, highest = _extremes(layout, terrain)
    deep = deepest(layout)
    level = np.full(int(group.max(initial=-1)) + 1, -np.inf)
    np.maximum.at(level, group, np.maximum(lowest, highest - deep))
    return np.asarray(_aligned(layout, level[group]) + KERB_HEIGHT)


def deepest(layout: Layout) -> NDArray[np.float64]:
    """Return how deep in the slope behind it each part may stand, (n,) metres."""
    parts = layout.parts
    top, rise = (np.nan_to_num(parts[name].to_numpy(float)) for name in ("top", "roof_height"))
    return np.asarray(np.maximum(SUNK, top - rise - ROOM))


def terrain_at_walls(
    layout: Layout, terrain: Terrain
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the lowest and the highest terrain at the walls of each part's building, (n,).

    A bay of a stepped house has walls of its own.
    """
    group, lowest, highest = _extremes(layout, terrain)
    most = np.full(int(group.max(initial=-1)) + 1, -np.inf)
    np.maximum.at(most, group, highest)
    return lowest, most[group]


def _extremes(
    layout: Layout, terrain: Terrain
) -> tuple[NDArray[np.int64], NDArray[np.float64], NDArray[np.float64]]:
    """Return which parts stand together, the lowest terrain at these and the highest at each."""
    parts = layout.parts
    building = parts["building"].to_numpy(np.uint64)
    own = parts["zone"].to_numpy(str) == BAY
    known, of = np.unique(
        np.concatenate([layout.buildings["id"].to_numpy(np.uint64), building]), return_inverse=True
    )
    outlines = len(layout.buildings)
    # Bays are numbered after the buildings.
    group = np.where(own, len(known) + np.arange(len(building)), of[outlines:])
    shapes = np.concatenate([layout.buildings.geometry.to_numpy(), parts.geometry.to_numpy()])
    if not terrain.is_flat:
        shapes = shapely.segmentize(shapes, EVERY)
    points, row = shapely.get_coordinates(shapes, return_index=True)
    finite = np.isfinite(points).all(axis=1)
    height, row = terrain.height_at(points[finite]), row[finite]
    low = np.full(len(known) + len(building), np.inf)
    np.minimum.at(low, np.concatenate([of[:outlines], group])[row], height)
    high = np.full(outlines + len(building), -np.inf)
    np.maximum.at(high, row, height)
    high = high[outlines:]
    lowest = np.where(np.isfinite(low), low, 0.0)[group]
    return group, lowest, np.where(np.isfinite(high), high, 0.0)


def _aligned(layout: Layout, level: NDArray[np.float64]) -> NDArray[np.float64]:
    """Move the grounds of bays by little so that their floors meet those of the lowest."""
    bays = np.flatnonzero(layout.parts["zone"].to_numpy(str) == BAY)
    if not len(bays):
        return level
    building = layout.parts["building"].to_numpy(np.uint64)[bays]
    _, of = np.unique(building, return_inverse=True)
    foot = np.full(int(of.max()) + 1, np.inf)
    np.minimum.at(foot, of, level[bays])
    risen = level[bays] - foot[of]
    wanted = SUNK * np.round(risen / SUNK)
    level = level.copy()
    level[bays] = foot[of] + np.where(np.abs(risen - wanted) <= ALIGNED, wanted, risen)
    return level


def at_heights(
    layout: Layout,
    terrain: Terrain,
    part: NDArray[np.bool_],
    over: Callable[[NDArray[np.float64], str], NDArray[np.float64]],
) -> Layout:
    """Let parts of a layout begin and end at other heights; what stands on the ground does so.

    Parameters
    ----------
    part
        (n,) bool, which parts: k of them.
    over
        Of the levels that heights count from, (k,), and "base" or "top": the heights, (k,) metres.
    """
    parts = layout.parts.copy()
    old = {name: parts.loc[part, name].to_numpy(float) for name in ("base", "top")}
    for _ in range(SETTLES):
        level = ground_levels(replace(layout, parts=parts), terrain)[part]
        for name, height in old.items():
            parts.loc[part, name] = np.where(height > 0, over(level, name), 0.0)
    return replace(layout, parts=parts)
