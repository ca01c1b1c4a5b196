"""Trees and shrubs grown by code, with leaves for every season.

A species is a row of a table; an individual is its skeleton with the places of its leaves, grown
once and kept in the cache; a plant is an individual drawn for a season and a distance.
"""

from cityx.assets.trees.plants import FORMS, SPECIES, plant, size_of, tree, wall_reach
from cityx.assets.trees.skeletons import crown_radius
from cityx.assets.trees.species import (
    PARK_FORMS,
    SEASONS,
    STREET_FORMS,
    TREES,
    WALLED,
    WALLED_FORMS,
    habit,
    individuals,
)

__all__ = ["FORMS", "PARK_FORMS", "SEASONS", "SPECIES", "STREET_FORMS", "TREES", "WALLED",
           "WALLED_FORMS", "crown_radius", "habit", "individuals", "plant", "size_of", "tree",
           "wall_reach"]  # fmt: skip
