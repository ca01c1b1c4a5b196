"""Things that hug the walls of houses where walks are too narrow for anything else, in Japan."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.assets.furniture.wall_pieces import GAPS
from cityx.city import City
from cityx.geometry.arrays import FloatArray
from cityx.geometry.clearance import near_any
from cityx.ground.pieces import (
    Pieces,
    ids_of_places,
    join_pieces,
    pieces,
    places_at_walls,
    room_along,
)
from cityx.ground.street_rules import BICYCLE_GAP
from cityx.ground.walking.passage import FREE
from cityx.ids import choose
from cityx.road.surface.kerbs import yaw_facing

PURPOSE = "nature/wall_things"
WALKS = ("sidewalk", "frontage", "furnishing", "courtyard")
SPACING, MARGIN = 3.2, 0.8  # metres of wall per draw; from the corners of a house
PROBE = 0.3  # metres before the wall at which the ground is looked at
BEFORE = 0.05  # metres before the wall at which the walk begins to be measured
REACH = 4.0  # metres; no walk is looked at farther than this
WIDE = 3.0  # metres of walk from which other rules put larger things at walls
# What stands at a wall, with weights; bicycles stand along it, and need more room.
NOTHING = "nothing"
WEIGHTS: Mapping[str, float] = MappingProxyType({
    NOTHING: 1.8, "wall_trough": 2.0, "wall_pots": 2.2, "wall_tree": 4.4, "wall_olive": 3.4,
    "green_curtain": 1.6, "furled_banner": 0.9, "wall_meters": 1.2, "wall_crates": 0.8,
    "broom_and_pail": 0.6, "bicycle": 1.6,
})  # fmt: skip
# The same where nothing may stand; some walks are half a metre wide.
BARE: Mapping[str, float] = MappingProxyType(
    {NOTHING: 1.2, "hanging_basket": 2.2, "drain_cover": 1.0, "wall_ivy": 3.2}
)
TO_SHOP = 0.9  # metres from the middle of a shopfront, where one goes in
CLIMBED = ("wall_ivy", 1.9, 4.0)  # what windows have none of: metres beside them, and below


def along_walls(city: City, rims: NDArray[np.object_], density: float) -> Pieces:
    """Draw things along the walls of houses of towns, where `FREE` metres stay free before them.

    Parameters
    ----------
    city
        City with its ground.
    rims
        Segments at which walks end, as of `cityx.ground.pieces.walk_rims`.
    density
        Factor of how often there is something.
    """
    foot, out = places_at_walls(city, SPACING, MARGIN, PROBE, WALKS)
    if city.ground is None or not len(foot):
        return join_pieces([])
    ids = ids_of_places(foot, PURPOSE)
    room = BEFORE + room_along(foot + BEFORE * out, out, rims, REACH)
    name, bare = (_drawn(city.seed, ids, weights, density) for weights in (WEIGHTS, BARE))
    public = city.ground.on(foot + PROBE * out, "sidewalk")
    bare = np.where(public, bare, NOTHING)
    name = np.where(room >= 2 * _gaps(name) + FREE, name, bare)
    gap = _gaps(name)
    fits = (name != NOTHING) & (room < WIDE)
    shops = city.scene.instances.get("shopfronts")
    if shops is not None:
        fits &= ~near_any(foot, shapely.points(shops.position[:, :2]), TO_SHOP)
    climber, beside, below = CLIMBED
    low = _low_windows(city, below)
    fits[name == climber] &= ~near_any(foot[name == climber], low, beside)
    yaw = yaw_facing(out) + np.where(name == "bicycle", np.pi / 2, 0.0)
    return pieces(name, foot + gap[:, None] * out, ids, yaw).take(fits)


def _low_windows(city: City, below: float) -> NDArray[np.object_]:
    """Return points of windows and doors that lie less than so many metres above the ground."""
    found = [np.zeros((0, 3))]
    for layer in ("windows", "doors", "shopfronts"):
        rows = city.scene.instances.get(layer)
        if rows is not None:
            found.append(rows.position)
    at = np.concatenate(found)
    at = at[at[:, 2] < city.terrain.height_at(at[:, :2]) + below] if len(at) else at
    return np.asarray(shapely.points(at[:, :2]), object)


def _drawn(
    seed: int, ids: NDArray[np.uint64], weights: Mapping[str, float], density: float
) -> NDArray[np.object_]:
    share = np.array(list(weights.values()))
    share[0] /= max(density, 1e-6)
    return np.asarray(np.array(list(weights), object)[choose(seed, PURPOSE, ids, share.tolist())])


def _gaps(names: NDArray[np.object_]) -> FloatArray:
    return np.array([GAPS.get(str(name), BICYCLE_GAP) for name in names], float)
