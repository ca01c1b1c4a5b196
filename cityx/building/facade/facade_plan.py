"""The plan of facades: what the grammar lays out on every wall, before instances are made."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import shapely

from cityx.assets.styles.palettes import Finishes
from cityx.building.assembly import finishes_of
from cityx.building.facade import grammar as facades
from cityx.building.facade.fronts import (
    Designs,
    designs_of,
    entrances_of,
    fronts_of,
    lowered,
    mapped_doors,
    reserve_of,
    walled_up,
)
from cityx.building.facade.grammar import Fronts, Openings, Storeys, lay_out, storeys_of
from cityx.building.facade.walls import WallTable
from cityx.building.selection import designs_of_parts
from cityx.building.volumes import Volumes, volumes_of, walls_of_volumes
from cityx.city.city import City
from cityx.city.ground import KERB_HEIGHT
from cityx.city.layout import BARE
from cityx.geometry.arrays import FloatArray
from cityx.ground.standing import stand_on
from cityx.sources.features.tagged import named_note
from cityx.sources.features.vocabulary import CLOSED

MISSED = 0.3  # metres by which the ground may miss the terrain before a door follows it
AT_OUTLINE = 0.6  # metres from the outline of a house within which an entrance is one of it
AT_DOOR = 2.0  # metres from an entrance within which a door is meant by it
WINDOW_ROLES = (facades.WINDOW, facades.BACK, facades.GROUND, facades.FRENCH)


@dataclass(frozen=True)
class Facade:
    """Everything known about the facades of a city before instances are made.

    Attributes
    ----------
    volumes, walls, storey_walls
        The volumes, their walls, and the walls up to the ceiling of the last storey.
    finishes, designs
        Per part.
    fronts, storeys
        Per wall.
    openings
        What the grammar placed.
    """

    volumes: Volumes
    walls: WallTable
    storey_walls: WallTable
    finishes: Finishes
    designs: Designs
    fronts: Fronts
    storeys: Storeys
    openings: Openings


def facade_of(city: City, trade: FloatArray | None = None) -> Facade:
    """Work out the openings of every wall of a city; `trade` as of `fronts_of`."""
    volumes = volumes_of(city.layout, city.terrain)
    walls = walls_of_volumes(volumes)
    parts = city.layout.parts
    closed = (parts["zone"].to_numpy(str) == BARE) | parts["use"].isin(CLOSED).to_numpy(bool)
    if closed.any():
        walls = walls.take(~closed[walls.part])
    finishes = finishes_of(city)
    designs = designs_of(designs_of_parts(city), volumes.building, city.seed)
    reserve = reserve_of(volumes, city.layout.parts, city.seed)
    storey_walls = lowered(walls, reserve)
    fronts = fronts_of(city, volumes, storey_walls, designs, finishes.wall_material, trade)
    entrances = entrances_of(city.layout.points)
    mapped = mapped_doors(storey_walls, fronts, entrances) if len(entrances.row) else None
    openings = lay_out(storey_walls, fronts, city.seed, mapped)
    windows = np.flatnonzero(np.isin(openings.role, WINDOW_ROLES))
    table = openings.take(windows)
    shut = walled_up(
        volumes, storey_walls, table.wall, table.along, table.low, table.width, table.height
    )
    openings = openings.take(np.setdiff1d(np.arange(openings.count), windows[shut]))
    openings = _on_the_pavement(city, storey_walls, openings)
    storeys = storeys_of(storey_walls, fronts)
    return Facade(volumes, walls, storey_walls, finishes, designs, fronts, storeys, openings)


def _on_the_pavement(city: City, walls: WallTable, openings: Openings) -> Openings:
    """Set doors and shopfronts on the pavement before them."""
    rows = np.flatnonzero(np.isin(openings.role, [*facades.DOORS, facades.SHOP]))
    wall = openings.wall[rows]
    unit = (walls.end - walls.start)[wall] / walls.length[wall, None]
    at = walls.start[wall] + unit * openings.along[rows, None]
    before = at + 0.4 * walls.normal[wall]
    ground = city.terrain.height_at(before) + KERB_HEIGHT
    # On the steepest slopes the ground as it is meshed misses the terrain.
    built = stand_on(city.scene.meshes.get("ground"), before).z
    ground = np.where(np.abs(built - ground) > MISSED, built, ground)
    low, height = openings.low.copy(), openings.height.copy()
    # Up into the slope before it as far as the wall is high.
    head = walls.z_high[wall] - facades.EAVE_GAP - low[rows] - height[rows]
    drop = np.clip(low[rows] - ground, -np.maximum(head, 0.0), 4.0)
    low[rows] -= drop
    shop = openings.role[rows] == facades.SHOP
    height[rows] += np.where(shop, np.clip(drop, 0.0, 0.8), 0.0)
    return replace(openings, low=low, height=height)


def entrances_without(city: City, found: Facade) -> str:
    """Name the entrances that the map draws at houses and that have got no door."""
    entrances = entrances_of(city.layout.points)
    rows = np.flatnonzero(~entrances.closed)
    if not len(rows):
        return ""
    spots = shapely.points(entrances.places[rows])
    outlines = shapely.boundary(city.layout.buildings.geometry.to_numpy())
    at_house = shapely.STRtree(outlines).query(spots, "dwithin", distance=AT_OUTLINE)[0]
    doors = found.openings.take(np.isin(found.openings.role, facades.DOORS))
    start, along = found.walls.start[doors.wall], doors.along[:, None]
    unit = (found.walls.end[doors.wall] - start) / found.walls.length[doors.wall, None]
    served = shapely.STRtree(shapely.points(start + unit * along)).query(
        spots, "dwithin", distance=AT_DOOR
    )[0]
    left = np.setdiff1d(at_house, served[~entrances.above[rows[served]]])
    names = city.layout.points["source"].to_numpy(str)[entrances.row[rows[left]]]
    return named_note("entrances have no door: no wall at the ground takes one there",
                      sorted(set(names.tolist())))  # fmt: skip
