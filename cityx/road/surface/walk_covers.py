"""Utility covers in walks, and asphalt patches of former trenches."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from types import MappingProxyType

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.assets.furniture.covers import cover
from cityx.city.city import City
from cityx.city.ground import LABEL
from cityx.city.scene import Instances
from cityx.geometry.clearance import near_any
from cityx.ground.standing import stand_on
from cityx.ids import choose, hash_ids, uniform
from cityx.road.surface.kerbs import join_places, places_along

PURPOSE, LAYER = "road/covers-v1/walk", "walk_covers"
SPACING, MARGIN = 6.5, 4.0  # metres of kerb per draw; behind junctions
# What lies there, with weights; "" is nothing.
WEIGHTS: Mapping[str, float] = MappingProxyType({
    "": 3.0, "inspection_cover": 1.6, "recessed_cover": 1.3, "stop_tap": 2.2, "walk_patch": 0.9,
})  # fmt: skip
HALF: Mapping[str, tuple[float, float]] = MappingProxyType({
    "inspection_cover": (0.34, 0.26), "recessed_cover": (0.32, 0.32), "stop_tap": (0.15, 0.15),
    "walk_patch": (0.45, 0.29),
})  # fmt: skip
FROM_KERB = (0.55, 2.6)  # metres from the carriageway to its middle, drawn
TO_PIT = 1.6  # metres from the middle of a tree pit
STEP = 0.004  # metres by which its corners may lie above or below its middle beyond the slope
WALKS = ("sidewalk", "frontage", "furnishing")


def with_walk_covers(city: City, edges: NDArray[np.int64]) -> City:
    """Return the city with covers in the walks of some edges, square to the kerb.

    Parameters
    ----------
    city
        City with its draped ground; without it nothing changes.
    edges
        Edges of the network on the ground; where there is no walk beside them nothing is laid.
    """
    network, mesh = city.network, city.scene.meshes.get("ground")
    if network is None or mesh is None or not len(edges):
        return city
    near = FROM_KERB[0]
    places = join_places(*(
        places_along(network, edges, side, spacing=SPACING, beyond=near, margin=MARGIN,
                     phase=0.5 * (side > 0))
        for side in (1, -1)
    ))  # fmt: skip
    ids = hash_ids(0, PURPOSE, network.edge_id[places.edge], 2 * places.number + (places.side > 0))
    words = np.array(list(WEIGHTS), object)
    name = words[choose(city.seed, PURPOSE, ids, list(WEIGHTS.values()))]
    rows = np.flatnonzero(name != "")
    places, ids, name = places.take(rows), ids[rows], name[rows]
    across = (FROM_KERB[1] - near) * uniform(city.seed, f"{PURPOSE}/across", ids)
    along = (uniform(city.seed, f"{PURPOSE}/along", ids) - 0.5) * SPACING / 2
    ahead, out = places.ahead, -places.toward_road
    xy = np.round(places.xy + across[:, None] * out + along[:, None] * ahead, 3)
    half = np.array([HALF[str(word)] for word in name]).reshape(-1, 2)
    corners = np.stack(
        [
            xy + i * half[:, :1] * ahead + j * half[:, 1:] * out
            for i, j in ((0, 0), (1, 1), (1, -1), (-1, -1), (-1, 1))
        ],
        axis=1,
    )  # (n, 5, 2)
    under = stand_on(mesh, corners.reshape(-1, 2))
    label, z = under.label.reshape(-1, 5), under.z.reshape(-1, 5)
    # It lies within one surface: not on an edging, a ramp or the ribs before a crossing.
    fits = np.isin(label[:, 0], [LABEL[word] for word in WALKS])
    fits &= (label == label[:, :1]).all(axis=1) & np.isfinite(z).all(axis=1)
    rise = (z[:, 1] + z[:, 2] - z[:, 3] - z[:, 4]) / 2
    cross = (z[:, 1] + z[:, 4] - z[:, 2] - z[:, 3]) / 2
    fits &= np.abs(z[:, 1:].mean(axis=1) - z[:, 0]) < STEP
    pits = city.scene.instances.get("tree_pits")
    if pits is not None:
        fits &= ~near_any(xy, shapely.points(pits.position[:, :2]), TO_PIT)
    rows = np.flatnonzero(fits)
    rows = rows[np.argsort(ids[rows], kind="stable")]
    if not len(rows):
        return city
    # The columns of ``out`` lie left of ``ahead`` on one side of the street, right on the other.
    hand = np.sign(ahead[:, 0] * out[:, 1] - ahead[:, 1] * out[:, 0])
    turn = np.column_stack([
        np.arctan2(hand * cross, 2 * half[:, 1]), -np.arctan2(rise, 2 * half[:, 0]),
        np.arctan2(ahead[:, 1], ahead[:, 0]),
    ])  # fmt: skip
    kinds = list(HALF)
    number = np.array([kinds.index(str(word)) for word in name[rows]], np.int32)
    ones = np.ones((len(rows), 3), np.float32)
    shade = 0.85 + 0.3 * uniform(city.seed, f"{PURPOSE}/shade", ids[rows])
    found = Instances(
        number, ids[rows], np.zeros(len(rows), np.uint64),
        np.column_stack([xy[rows], z[rows, 1:].mean(axis=1)]), turn[rows].astype(np.float32),
        ones, (ones * shade[:, None]).astype(np.float32),
    )  # fmt: skip
    scene = city.scene.with_instances(LAYER, [cover(kind) for kind in kinds], found)
    return replace(city, scene=scene)
