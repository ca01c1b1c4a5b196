"""Volumes: the parts of a layout with absolute heights and clean outlines."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.building.facade.walls import WallTable, party_spans, wall_table
from cityx.building.roofs.shapes import as_shapes
from cityx.city.ground import KERB_HEIGHT
from cityx.city.levels import ground_levels, terrain_at_walls
from cityx.geometry.arrays import FloatArray, IntArray
from cityx.geometry.polygons import clean_polygons
from cityx.ground.building_passages import LINTEL, ceilings, passages

if TYPE_CHECKING:
    from cityx.city.layout import Layout
    from cityx.city.terrain import Terrain

PLINTH = 0.5  # metres a shell reaches below its ground, so that nothing floats
GROUNDED = 0.5  # metres; parts that begin lower stand on the ground
CELLAR = 3.0  # metres of storeys that a slope lays open
MIN_STOREY = 0.5  # metres; a volume is at least this high
MIN_EAVE = 0.1  # metres between the base of a part and its eave
DECK = 1.2  # metres; deeper than any parapet
TOUCH = 0.3  # metres between the top of a part and the foot of what stands on it
HELD = 0.98  # share of a part's plan that others must carry; what overhangs keeps its foot
PIER = 0.05  # square metres; less beside a way carries nothing
MAX_TOP = 1000.0  # metres; higher than any building


@dataclass(frozen=True)
class Volumes:
    """The rows of ``layout.parts`` as volumes, n of them, in the same order.

    Attributes
    ----------
    polygons
        (n,) clean polygons; empty where the outline could not be used.
    building
        (n,) uint64.
    ground
        (n,) float64, level of the building's ground.
    low, base, eave, top
        (n,) float64, absolute: foot of the shell (below ground where the base is the ground), foot
        of the visible wall, eave, and top of the roof.
    walls
        (n,) bool, False for a roof on posts.
    cellars
        (n,) int64, storeys below the ground's level that a slope lays open; they count to the
        visible wall.
    ways
        (n,) what ways on the ground that lead through a part take of its plan and of the ground
        before it, empty where none does.
    way_top
        (n,) float64, the level up to which those are free.
    """

    polygons: NDArray[Any]
    building: NDArray[np.uint64]
    ground: FloatArray
    low: FloatArray
    base: FloatArray
    eave: FloatArray
    top: FloatArray
    walls: NDArray[np.bool_]
    cellars: IntArray
    ways: NDArray[Any]
    way_top: FloatArray

    @property
    def opened(self) -> IntArray:
        """(k,) rows of the parts that ways lead through."""
        return np.flatnonzero(~shapely.is_empty(self.ways) & self.usable)

    def beside_ways(self) -> tuple[NDArray[Any], IntArray]:
        """Return what stands beside the ways through parts, and the row of each: (m,) both."""
        rows = self.opened
        left = shapely.difference(self.polygons[rows], self.ways[rows])
        pieces, of = shapely.get_parts(left, return_index=True)
        pieces = clean_polygons(pieces)
        kept = shapely.area(pieces) > PIER
        return pieces[kept], rows[of[kept]]

    @property
    def usable(self) -> NDArray[np.bool_]:
        """(n,) whether the outline of a part can be raised."""
        return np.asarray(~shapely.is_empty(self.polygons))


def volumes_of(layout: Layout, terrain: Terrain) -> Volumes:
    """Give every part its absolute heights; senseless numbers are brought into order."""
    parts = layout.parts
    polygons = clean_polygons(parts.geometry.to_numpy())
    building = parts["building"].to_numpy(np.uint64)
    ground = ground_levels(layout, terrain)
    base = np.clip(np.nan_to_num(parts["base"].to_numpy(float)), 0.0, MAX_TOP - MIN_STOREY)
    top = np.nan_to_num(parts["top"].to_numpy(float), posinf=MAX_TOP)
    top = np.clip(top, base + MIN_STOREY, MAX_TOP)
    roof = np.nan_to_num(parts["roof_height"].to_numpy(float))
    roof = np.where(as_shapes(parts["roof_shape"].to_numpy()) == "flat", 0.0, roof)
    roof = np.clip(roof, 0.0, np.maximum(top - base - MIN_EAVE, 0.0))
    lowest, _ = terrain_at_walls(layout, terrain)
    drop = np.where(base < GROUNDED, np.round(ground - lowest - KERB_HEIGHT, 6), 0.0)
    drop = np.maximum(drop, 0.0)
    cellars = np.floor(drop / CELLAR).astype(np.int64)
    low = np.where((base > 0) & (drop == 0), base, -drop - PLINTH)
    # What stands on another part reaches down past its parapet to its deck.
    low = np.where(_resting(polygons, building, base, top), base - DECK, low)
    ways, way_top = _ways(layout, terrain, ground + low, ground + top)
    # A roof gives way to the headroom below it, and a house that is too low leaves a lintel.
    roof = np.where(
        shapely.is_empty(ways), roof, np.clip(ground + top - way_top - LINTEL, 0.0, roof)
    )
    return Volumes(
        polygons,
        building,
        ground,
        ground + low,
        ground + base - cellars * CELLAR,
        ground + top - roof,
        ground + top,
        parts["walls"].to_numpy(bool),
        cellars,
        ways,
        way_top,
    )


def _ways(
    layout: Layout, terrain: Terrain, low: FloatArray, top: FloatArray
) -> tuple[NDArray[Any], FloatArray]:
    """Return the ways through each part and up to where they are free, (n,) both."""
    found = passages(layout)
    ways, free = found.by_part(len(low)), low.copy()
    if not len(found.part):
        return ways, free
    np.maximum.at(free, found.part, ceilings(layout, terrain, found))
    return ways, np.where(shapely.is_empty(ways), low, np.minimum(free, top - LINTEL))


def _resting(
    polygons: NDArray[Any], building: NDArray[np.uint64], base: FloatArray, top: FloatArray
) -> NDArray[np.bool_]:
    """Return which parts stand on another part of their building, (n,)."""
    resting = np.zeros(len(base), bool)
    rows = np.flatnonzero(base > DECK + MIN_STOREY)
    if not len(rows):
        return resting
    inner = shapely.buffer(polygons[rows], -0.05)
    row, other = shapely.STRtree(polygons).query(inner, predicate="intersects")
    row = rows[row]
    under = (building[row] == building[other]) & (np.abs(top[other] - base[row]) < TOUCH)
    under &= base[other] < base[row] - DECK
    shared = shapely.area(shapely.intersection(polygons[row[under]], polygons[other[under]]))
    held = np.bincount(row[under], shared, minlength=len(base))
    area = np.where(shapely.is_empty(polygons), 1.0, shapely.area(polygons))
    return np.asarray(held > HELD * area)


def walls_of(layout: Layout, terrain: Terrain) -> WallTable:
    """List the walls of every part of a layout, absolute heights, party walls marked.

    Roofs on posts have no walls. The rectangles reach from the part's base to its eave.
    """
    volumes = volumes_of(layout, terrain)
    return walls_of_volumes(volumes)


def walls_of_volumes(volumes: Volumes) -> WallTable:
    """List the walls of volumes; see `walls_of`."""
    walled = np.where(volumes.walls, volumes.polygons, shapely.Polygon())
    walls = wall_table(walled, volumes.base, volumes.eave)
    # A plinth covers too, and the mouth of a way has no wall as a neighbour would leave none.
    rows = volumes.opened
    covers = np.concatenate([walled, volumes.ways[rows]])
    low = np.concatenate([volumes.low, volumes.low[rows]])
    return party_spans(walls, covers, low, np.concatenate([volumes.eave, volumes.way_top[rows]]))


def covered(
    volumes: Volumes, part: IntArray, x: FloatArray, y: FloatArray, reach: FloatArray, z: FloatArray
) -> NDArray[np.bool_]:
    """(k,) whether a part other than `part` rises through a place or hangs over it.

    Parameters
    ----------
    x, y, z, reach
        (k,) metres: the place, and the radius round it that must be free.
    """
    row, other = shapely.STRtree(volumes.polygons).query(
        shapely.buffer(shapely.points(x, y), reach, quad_segs=2), predicate="intersects"
    )
    hit = (other != part[row]) & (volumes.top[other] > z[row] + 0.05)
    found = np.zeros(len(part), bool)
    found[row[hit]] = True
    return found
