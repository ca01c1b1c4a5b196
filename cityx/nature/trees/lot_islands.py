"""Trees on the islands of large car parks."""

from __future__ import annotations

import numpy as np
import shapely

from cityx.assets.furniture.tree_pits import LOT_ISLAND, pit
from cityx.city import City, Instances, Prototype
from cityx.geometry.scatter import Points
from cityx.ground.standing import stand_on
from cityx.ids import hash_ids, uniform
from cityx.nature.trees.stands import Stand, draw_species, stand_of
from cityx.road.parking.bays import lot_islands

PURPOSE = "nature/lot_islands"
TALL = (5.5, 9.0)  # metres; their crowns leave headroom over the bays beside them


def island_stands(city: City) -> list[Stand]:
    """Plant a tree in the middle of every island; all trees of a car park are of one species."""
    islands = lot_islands(city)
    if not len(islands.id):
        return []
    low, high = TALL
    height = low + (high - low) * uniform(city.seed, f"{PURPOSE}/height", islands.id)
    areas = city.layout.areas
    lot = shapely.STRtree(areas.geometry.to_numpy()[areas["kind"] == "parking"])
    island, row = lot.query(shapely.points(islands.xy), predicate="within")
    kin = np.zeros(len(islands.id), np.uint64)
    kin[island] = areas["id"].to_numpy()[areas["kind"] == "parking"][row]
    species = draw_species("street", city, kin)
    points = Points(islands.xy, hash_ids(0, f"{PURPOSE}/tree", islands.id))
    # They stand where a bay was, nearer to driven ground than any other tree that a rule plants.
    return [stand_of(points, species, height, mapped=True)]


def island_rows(city: City) -> tuple[Prototype, Instances] | None:
    """Return the islands themselves, as rows of their one prototype; None where there is none."""
    islands = lot_islands(city)
    count = len(islands.id)
    if not count:
        return None
    order = np.argsort(islands.id)
    islands = islands.take(order)
    z = stand_on(city.scene.meshes.get("ground"), islands.xy).z
    rotation = np.zeros((count, 3), np.float32)
    rotation[:, 2] = islands.yaw
    ones = np.ones((count, 3), np.float32)
    return pit(LOT_ISLAND), Instances(
        np.zeros(count, np.int32), hash_ids(0, PURPOSE, islands.id), np.zeros(count, np.uint64),
        np.column_stack([islands.xy, z]), rotation, ones, ones,
    )  # fmt: skip
