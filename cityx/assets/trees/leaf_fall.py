"""Leaf fall: which trees stand bare, and what of them is gone then."""

from __future__ import annotations

LEAF = "foliage"  # material of what falls
SNOWED = 0.3  # snow cover from which deciduous trees are bare


def evergreen(name: str) -> bool:
    """Whether the tree that a prototype is named after (``tree_lime_0_near``) keeps its leaves."""
    from cityx.assets.trees.species import TREES

    return any(TREES[word].evergreen for word in name.split("_") if word in TREES)


def sheds(kind: str, name: str, materials: tuple[str, ...]) -> bool:
    """Whether a prototype of a kind loses its leaves under snow."""
    return kind == "tree" and LEAF in materials and not evergreen(name)
