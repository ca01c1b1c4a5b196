"""Words that installed packages bring, for readers of sentences.

What makes the things is imported only where a package is there at all.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from cityx.system.extensions import points_of, remembered

if TYPE_CHECKING:
    from cityx.assets.furniture.outside_pieces import StreetObject
    from cityx.assets.trees.species import TreeSpecies


@remembered
def outside_pieces() -> Mapping[str, StreetObject]:
    """Return the street objects that packages add, by name."""
    if not points_of("cityx.street_objects"):
        return {}
    from cityx.assets.furniture import street_furniture

    return street_furniture.outside_pieces()


def brings_buildings() -> bool:
    """Return whether packages may add buildings, without a look into any."""
    return bool(points_of("cityx.actions") or points_of("cityx.generators"))


@remembered
def outside_styles() -> frozenset[str]:
    """Return the style words that packages add."""
    if not brings_buildings():
        return frozenset()
    from cityx.assets.styles import style_shares

    return style_shares.outside_styles()


@remembered
def outside_trees() -> Mapping[str, TreeSpecies]:
    """Return the species of trees that packages add, by name."""
    if not points_of("cityx.species"):
        return {}
    from cityx.assets.trees.species import OUTSIDE_TREES

    return OUTSIDE_TREES
