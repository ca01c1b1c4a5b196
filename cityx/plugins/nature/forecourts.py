"""What stands in groups at the walls of deep forecourts: bicycles, machines, benches, pots."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.city import City
from cityx.city.layout import in_town
from cityx.geometry.identity import choose, hash_ids
from cityx.geometry.polylines import arc_lengths, every, locate, pack
from cityx.plugins.nature.pieces import Pieces, inside_extent, join_pieces, pieces, room_along
from cityx.plugins.nature.street_rules import LEANING, USUAL_GAP, WALL_GAP
from cityx.plugins.road.kerbs import yaw_facing

PURPOSE = "nature/forecourts"
PAVED = ("frontage", "plaza", "sidewalk", "courtyard")
SPACING, MARGIN = 6.0, 2.0  # metres of wall per group; from the corners of a house
DEEP = 4.5  # metres of paving before a wall that bears groups
PROBE = 1.0  # metres before the wall at which the ground is looked at
REACH = 12.0  # metres; no forecourt is looked at farther than this
# Pieces of a group, with metres along the wall from its middle.
GROUPS: Mapping[str, tuple[tuple[str, float], ...]] = MappingProxyType({
    "": (),
    "stand": (("bicycle_parking", 0.0),),
    "seat": (("bench", 0.0), ("planter_round", -1.75), ("planter_round", 1.75)),
    "tubs": (("planter", -0.9), ("planter", 0.9)),
    "pots": (("pot_row", -0.97), ("pot_row", 0.97)),
    "riders": (("motor_scooter", -1.1), ("bicycle", 1.1)),
    "machines": (("vending_machine", -0.76), ("vending_machine", 0.76)),
    "bins": (("wheelie_bins", -0.8), ("cartons", 0.9)),
})  # fmt: skip
# How often there is each, by the kind of place.
USUAL: Mapping[str, float] = MappingProxyType(
    {"": 2.4, "stand": 1.1, "seat": 1.8, "tubs": 2.0, "bins": 0.5, "riders": 0.5, "pots": 0.9}
)
SHARES: Mapping[str, Mapping[str, float]] = MappingProxyType({
    "japan": {"": 1.4, "stand": 1.6, "seat": 0.8, "tubs": 1.2, "pots": 2.4, "riders": 1.4,
              "machines": 1.8, "bins": 0.5},
})  # fmt: skip


def at_forecourts(
    city: City, rims: NDArray[np.object_], place: str, density: float = 1.0
) -> Pieces:
    """Draw groups of things along the walls of houses of towns before which paving is deep.

    Parameters
    ----------
    city
        City with its ground.
    rims
        Segments at which walks end, as of `cityx.plugins.nature.pieces.walk_rims`.
    place
        As of `cityx.plugins.nature.street_rules.place_of`.
    density
        Factor of how often there is something.
    """
    buildings = city.layout.buildings
    houses = buildings.geometry.to_numpy()[in_town(buildings)]
    none = join_pieces([])
    if city.ground is None or not len(houses):
        return none
    rings = shapely.get_exterior_ring(shapely.orient_polygons(shapely.get_parts(houses)))
    walls = pack(rings)
    ends = np.delete(np.arange(len(walls.points)), walls.start[1:] - 1)
    sides = pack(
        shapely.linestrings(np.stack([walls.points[ends], walls.points[ends + 1]], axis=1))
    )
    row, at = every(arc_lengths(sides)[1], SPACING, MARGIN)
    foot, along = locate(sides, row, at)
    out = np.column_stack([along[:, 1], -along[:, 0]])  # outlines run counter-clockwise
    near = inside_extent(city, foot, 0.5)
    near[near] = city.ground.on(foot[near] + PROBE * out[near], *PAVED)
    foot, along, out = foot[near], along[near], out[near]
    deep = room_along(foot + 0.1 * out, out, rims, REACH) >= DEEP
    foot, along, out = foot[deep], along[deep], out[deep]
    if not len(foot):
        return none
    spot = np.round(foot * 10).astype(np.int64).view(np.uint64)
    ids = hash_ids(0, PURPOSE, spot[:, 0], spot[:, 1])
    weights = dict(SHARES.get(place, USUAL))
    weights[""] /= max(density, 1e-6)
    kind = np.array(list(weights), object)[choose(city.seed, PURPOSE, ids, list(weights.values()))]
    found = []
    for group, members in GROUPS.items():
        rows = np.flatnonzero(kind == group)
        for number, (name, aside) in enumerate(members):
            gap = WALL_GAP.get(name, USUAL_GAP)
            xy = foot[rows] + gap * out[rows] + aside * along[rows]
            own = hash_ids(0, f"{PURPOSE}/{group}", ids[rows], number)
            yaw = yaw_facing(out[rows]) + np.pi / 2 * (name in LEANING)
            found.append(pieces(name, xy, own, yaw))
    return join_pieces(found)
