"""What stands in groups at the walls of deep forecourts: bicycles, machines, benches, pots."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from cityx.city import City
from cityx.geometry.identity import choose, hash_ids
from cityx.plugins.nature.pieces import (
    Pieces,
    ids_of_places,
    join_pieces,
    pieces,
    places_at_walls,
    room_along,
)
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
    foot, out = places_at_walls(city, SPACING, MARGIN, PROBE, PAVED)
    if not len(foot):
        return join_pieces([])
    deep = room_along(foot + 0.1 * out, out, rims, REACH) >= DEEP
    foot, out = foot[deep], out[deep]
    along = np.column_stack([-out[:, 1], out[:, 0]])
    ids = ids_of_places(foot, PURPOSE)
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
