"""Tree pits where trees stand on paving: soil in a stone edging, or under an iron grate."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.assets.tree_pits import OTHERS, PITS, pit
from cityx.city import City, Instances, Prototype
from cityx.geometry.identity import hash_ids, uniform
from cityx.geometry.polylines import to_linestrings

PAVED = ("sidewalk", "furnishing", "plaza", "frontage", "courtyard")
BUSHES = ("shrub_", "boxwood_", "grove_")  # prototypes that need no pit
PLANTED = 0.35  # share of the pits that have plants
YOUNG = 0.62  # of its grown height, below which a tree is held by stakes
STREET_REACH = 20.0  # metres to the street a pit is square to


def with_pits(city: City, trees: Instances) -> City:
    """Put a pit under every tree that stands on paving.

    Parameters
    ----------
    city
        City with its trees; without a ground it is returned as it is.
    trees
        Rows of its trees, counting the scene's prototypes or the offered ones.
    """
    counted = replace(trees, prototype=city.scene.instances["trees"].prototype)
    found = pits_of(city, counted)
    if found is None:
        return city
    kinds, pits = found
    return replace(city, scene=city.scene.with_instances("tree_pits", kinds, pits))


def pits_of(city: City, trees: Instances) -> tuple[list[Prototype], Instances] | None:
    """Return the pits of trees that stand on paving, with their kinds; None where none does.

    Parameters
    ----------
    city
        City with its ground.
    trees
        Rows that count the scene's prototypes.
    """
    if city.ground is None or not trees.count:
        return None
    bush = np.array([p.name.startswith(BUSHES) for p in city.scene.prototypes])
    on = city.ground.on(trees.position[:, :2], *PAVED)
    chosen = np.flatnonzero(on & ~bush[trees.prototype])
    if not len(chosen):
        return None
    # One kind for the whole place, as a city buys its grates once; residents plant some of them.
    kind = list(PITS)[int(uniform(city.seed, "nature/tree_pits", np.uint64(1)) * len(PITS))]
    ids = hash_ids(0, "nature/tree_pits", trees.object_id[chosen])
    order = np.argsort(ids)
    chosen, ids = chosen[order], ids[order]
    count = len(chosen)
    rotation = np.zeros((count, 3), np.float32)
    rotation[:, 2] = _along_street(city, trees.position[chosen, :2])
    planted = uniform(city.seed, "nature/tree_pits/planted", trees.object_id[chosen]) < PLANTED
    young = trees.scale[chosen, 2] < YOUNG
    number = np.where(young, 2, np.where(planted, 1, 0)).astype(np.int32)
    return [pit(name) for name in (kind, *OTHERS)], Instances(
        number, ids, trees.object_id[chosen], trees.position[chosen], rotation,
        np.ones((count, 3), np.float32), np.ones((count, 3), np.float32),
    )  # fmt: skip


def _along_street(city: City, xy: NDArray[np.float64]) -> NDArray[np.float64]:
    """(n,) angle of the nearest street, radians counter-clockwise from east; 0 far from any."""
    angle = np.zeros(len(xy))
    network = city.network
    if network is None or not network.edge_count:
        return angle
    lines = to_linestrings(network.lines)
    spots = shapely.points(xy)
    spot, edge = shapely.STRtree(lines).query_nearest(spots, max_distance=STREET_REACH,
                                                      all_matches=False)  # fmt: skip
    at = shapely.line_locate_point(lines[edge], spots[spot])
    ends = [shapely.get_coordinates(shapely.line_interpolate_point(lines[edge], at + shift))
            for shift in (-0.5, 0.5)]  # fmt: skip
    way = ends[1] - ends[0]
    angle[spot] = np.arctan2(way[:, 1], way[:, 0])
    return angle
