"""What stands in groups on deep forecourts: at walls, along the outer edge and amid them."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from cityx.city import City
from cityx.geometry.clearance import near_any
from cityx.geometry.scatter import Points, thin
from cityx.ground.pieces import (
    Pieces,
    ids_of_places,
    join_pieces,
    pieces,
    places_at_walls,
    room_along,
)
from cityx.ground.street_rules import LEANING, USUAL_GAP, WALL_GAP
from cityx.ids import choose, hash_ids
from cityx.places.profile import Furniture
from cityx.road.surface.kerbs import yaw_facing

PURPOSE = "nature/forecourts"
PAVED = ("frontage", "plaza", "sidewalk", "courtyard")
SPACING, MARGIN = 6.0, 2.0  # metres of wall per group; from the corners of a house
DEEP = 4.5  # metres of paving before a wall that bears groups
PROBE = 1.0  # metres before the wall at which the ground is looked at
DOOR_WAY_HALF = 1.2  # metres beside the way to a door that stay free
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
# Ground of a forecourt, first that before its house; how far from walls its edge is looked for,
# metres.
COURT = ("frontage", "plaza", "courtyard", "gravel")
EDGE_STEP, EDGE_REACH = 1.0, 20.0
LEAST_EDGE, LEAST_MIDDLE = 7.0, 9.5  # metres from the wall to the edge for things there, and amid
GROUP_SPACING = 8.0  # metres from the middle of a group to that of the next
FROM_EDGE = 0.9  # metres from the outer edge to the middle of what stands along it
# Groups along the outer edge and amid a forecourt: piece, metres along the edge, quarter turns.
OPEN_GROUPS: Mapping[str, tuple[tuple[str, float, int], ...]] = MappingProxyType({
    "": (),
    "hedge": tuple(("planter", 1.5 * step, 0) for step in (-1, 0, 1)),
    "racks": (("bicycle_parking", -1.5, 0), ("bicycle_parking", 1.5, 0)),
    "posts": tuple(("bollard", 1.4 * step, 0) for step in (-1.5, -0.5, 0.5, 1.5)),
    "seat": (("planter_round", -1.75, 0), ("bench", 0.0, 0), ("waste_basket", 1.5, 0)),
    "island": (("bench", -1.1, 0), ("planter", 0.9, 1), ("bench", 2.9, 2)),
    "tubs": tuple(("planter_round", 1.3 * step, 0) for step in (-1, 0, 1)),
    "scooters": (("motor_scooter", -2.0, 0), ("motor_scooter_dark", -1.0, 0), ("bicycle", -0.2, 0),
                 ("bicycle", 0.5, 0), ("bicycle", 1.2, 2), ("motor_scooter_red", 2.1, 0)),
    "tables": (("picnic_table", -1.5, 0), ("picnic_table", 1.5, 0)),
})  # fmt: skip


def at_forecourts(
    city: City, rims: NDArray[np.object_], furniture: Furniture, density: float = 1.0
) -> Pieces:
    """Draw groups of things along the walls of houses of towns before which paving is deep.

    Parameters
    ----------
    city
        City with its ground.
    rims
        Segments at which walks end, as of `cityx.ground.pieces.walk_rims`.
    furniture
        Of the profile of the place.
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
    weights = dict(furniture.forecourts)
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


def amid_forecourts(
    city: City, ways: NDArray[np.object_], furniture: Furniture, density: float
) -> tuple[Pieces, NDArray[np.uint64]]:
    """Draw groups along the outer edges of deep forecourts, and amid the deepest, with their ids.

    Parameters
    ----------
    city
        City with its ground.
    ways
        Lines on which one comes to doors; they stay free.
    furniture
        Of the profile of the place.
    density
        Factor of how often there is something.

    Returns
    -------
    found, group
        Things, and the id of the group of each: those of one stand as near as they are drawn.
    """
    foot, out = places_at_walls(city, GROUP_SPACING, MARGIN, LEAST_EDGE / 2, COURT)
    if city.ground is None or not len(foot):
        return join_pieces([]), np.zeros(0, np.uint64)
    deep = np.full(len(foot), EDGE_REACH)
    left = np.arange(len(foot))
    # Few forecourts are that deep, and the others need no closer look.
    for step in np.arange(LEAST_EDGE, EDGE_REACH, EDGE_STEP).tolist():
        paved = city.ground.on(foot[left] + step * out[left], *COURT)
        deep[left[~paved]] = step - EDGE_STEP
        left = left[paved]
    deep[left] = 0.0  # no edge within reach
    found, groups = [], []
    for line, least, away, weights in (
        ("edge", LEAST_EDGE, deep - FROM_EDGE, furniture.forecourt_edges),
        ("middle", LEAST_MIDDLE, 0.52 * deep, furniture.forecourt_middles),
    ):
        rows = np.flatnonzero(deep >= least)
        middle = foot[rows] + away[rows, None] * out[rows]
        ids = ids_of_places(middle, f"{PURPOSE}/{line}")
        # Walls that face each other share the ground between them.
        apart = np.isin(ids, thin(Points(middle, ids), GROUP_SPACING).id)
        rows, middle, ids = rows[apart], middle[apart], ids[apart]
        table = dict(weights)
        table[""] /= max(density, 1e-6)
        word = choose(city.seed, f"{PURPOSE}/{line}", ids, list(table.values()))
        kind = np.array(list(table), object)[word]
        along = np.column_stack([-out[rows, 1], out[rows, 0]])
        for group, members in OPEN_GROUPS.items():
            of = np.flatnonzero(kind == group)
            for number, (name, aside, turns) in enumerate(members):
                own = hash_ids(0, f"{PURPOSE}/{line}/{group}", ids[of], number)
                yaw = yaw_facing(out[rows[of]]) + turns * np.pi / 2
                found.append(pieces(name, middle[of] + aside * along[of], own, yaw))
                groups.append(ids[of])
    drawn, group = join_pieces(found), np.concatenate(groups)
    free = ~near_any(drawn.xy, ways, DOOR_WAY_HALF)
    return drawn.take(free), group[free]
