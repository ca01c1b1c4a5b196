"""What grows in the beds behind walks."""

from __future__ import annotations

import numpy as np

from cityx.city import City
from cityx.geometry.scatter import Points
from cityx.ids import choose, hash_ids, uniform
from cityx.nature.trees.stands import INDEX, Stand, draw_species, stand_of
from cityx.road.ground.beds import CORNER, LENGTH, Beds, bed_slots
from cityx.road.heights.tiers import level_network

PURPOSE = "nature/bed_plants"
# What grows in a bed, with weights, and metres between its plants.
BEDS = (("tree", 7, 0.8), ("shrub", 2, 1.4), ("boxwood", 1, 0.8))
CORNER_TREES = 0.65  # of the beds at corners have a tree
FREE_END = 0.55  # metres of a bed beyond its last plant
TREE_GAP = 1.0  # metres round a trunk without bushes
TREES = (4.5, 7.5)  # metres
LOW = {"boxwood": (0.6, 0.9), "shrub": (0.7, 1.2)}  # metres; over these one sees


def bed_stands(city: City) -> list[Stand]:
    """Plant the beds that lie on the ground: hedges, bushes and single trees."""
    if city.ground is None or city.network is None or not city.network.edge_count:
        return []
    beds = bed_slots(city.layout, level_network(city.network, city.heights))
    beds = beds.take(city.ground.on(beds.middle, "bed"))
    kind = choose(city.seed, PURPOSE, beds.id, [weight for _, weight, _ in BEDS])
    corner = beds.half[:, 0] <= CORNER
    stands = _at_corners(city, beds.take(corner))
    beds, kind = beds.take(~corner), kind[~corner]
    for number, (name, _, spacing) in enumerate(BEDS):
        rows = np.flatnonzero(kind == number)
        if not len(rows):
            continue
        bush = "boxwood" if name == "tree" else name
        count = int((LENGTH - 2 * FREE_END) / spacing) + 1
        aside = (np.arange(count) - (count - 1) / 2) * spacing
        if name == "tree":
            aside = aside[np.abs(aside) > TREE_GAP]
            trees = Points(beds.middle[rows], hash_ids(0, PURPOSE, beds.id[rows]))
            stands.append(_small_trees(city, trees))
        row, place = np.repeat(rows, len(aside)), np.tile(np.arange(len(aside)), len(rows))
        ids = hash_ids(0, PURPOSE, beds.id[row], place + 1)
        xy = beds.middle[row] + beds.along[row] * aside[place][:, None]
        on = city.ground.on(xy, "bed")
        stands.append(_bushes(city, bush, Points(xy[on], ids[on])))
    return stands


def _at_corners(city: City, beds: Beds) -> list[Stand]:
    """Four bushes in each square bed, and amid most a tree, which drivers see past and below."""
    aside = np.array([(x, y) for x in (-0.5, 0.5) for y in (-0.5, 0.5)]) * CORNER
    across = np.column_stack([-beds.along[:, 1], beds.along[:, 0]])
    axes = np.stack([beds.along, across], axis=1)  # (b, 2, 2)
    xy = (beds.middle[:, None] + aside @ axes).reshape(-1, 2)
    ids = hash_ids(0, PURPOSE, np.repeat(beds.id, len(aside)), np.tile(range(4), len(beds.id)))
    amid = np.flatnonzero(uniform(city.seed, f"{PURPOSE}/corner", beds.id) < CORNER_TREES)
    trees = Points(beds.middle[amid], hash_ids(0, PURPOSE, beds.id[amid], len(aside)))
    return [_bushes(city, "boxwood", Points(xy, ids)), _small_trees(city, trees)]


def _small_trees(city: City, points: Points) -> Stand:
    """Trees that a bed has room for; behind a walk they may stand as near things as mapped ones."""
    low, high = TREES
    height = low + (high - low) * uniform(city.seed, f"{PURPOSE}/tree", points.id)
    species = draw_species("street", city, points.id)
    return stand_of(points, species, height, mapped=True)


def _bushes(city: City, name: str, points: Points) -> Stand:
    """Low bushes; they hide nobody, so that they may stand near junctions as mapped ones do."""
    low, high = LOW[name]
    height = low + (high - low) * uniform(city.seed, f"{PURPOSE}/height", points.id)
    return stand_of(points, INDEX[name], height, mapped=True, light=True)
