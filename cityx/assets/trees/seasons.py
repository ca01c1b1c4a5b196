"""Leaves through the year: their colours by species, and which trees stand bare."""

from __future__ import annotations

import numpy as np

from cityx.assets.styles.materials import MATERIALS
from cityx.assets.trees.foliage import Cards
from cityx.assets.trees.species import Species
from cityx.geometry.arrays import FloatArray

FOLIAGE = "foliage"  # material of leaves, near white, so that the tint is their colour
FRESH = np.array([1.42, 1.24, 0.85])  # young leaves against grown ones
SHED = 0.80  # share of the leaves that still hang at the height of autumn
YOUNG = 0.90  # share of the cards in leaf in spring
BLOSSOM_LIGHT = 0.45  # share of the light in the crown's shade that blossom keeps, thin as it is
LEAF = "foliage"  # material of what falls
SNOWED = 0.3  # snow cover from which deciduous trees are bare


def leafless(habit: Species, season: str) -> bool:
    """Return whether a species has no leaves in a season."""
    return season == "winter" and not habit.evergreen


def in_leaf(habit: Species, season: str) -> float:
    """Return the share of the cards that hang in a season."""
    if habit.evergreen or season == "summer":
        return 1.0
    if season == "winter":
        return 0.0
    return SHED if season == "autumn" else YOUNG + (1 - YOUNG) * habit.flowering


def colors(habit: Species, season: str, cards: Cards) -> FloatArray:
    """Return the tint of cards on the material `FOLIAGE`, (n, 3) float."""
    mood = cards.mood[:, None]
    light = cards.light[:, None]
    summer = np.asarray(habit.summer) * (1 + 0.46 * (mood - 0.5) * np.array([1.0, 0.30, -0.6]))
    color = summer
    if season == "autumn" and not habit.evergreen:
        first, second = (np.asarray(each) for each in habit.autumn)
        turned = np.clip(1.5 * mood - 0.25, 0, 1)
        color = first * (1 - turned) + second * turned
        late = mood < 0.12  # clumps that have not turned yet
        color = np.where(late, 0.5 * color + 0.5 * summer, color)
    elif season == "spring":
        fresh = 0.55 if habit.evergreen else 1.0
        color = summer * (1 + fresh * (FRESH - 1))
    if season == "spring" and habit.flowering:
        # The first cards are a fair sample: those bloom.
        bloom = np.arange(len(cards.mood)) < habit.flowering * len(cards.mood)
        petals = np.asarray(habit.flower) * (0.86 + 0.28 * mood)
        color = np.where(bloom[:, None], petals, color)
        light = np.where(bloom[:, None], BLOSSOM_LIGHT + (1 - BLOSSOM_LIGHT) * light, light)
    tint = color * light / np.asarray(MATERIALS[FOLIAGE].color)
    return np.asarray(np.minimum(tint, 1.0))


def evergreen(name: str) -> bool:
    """Whether the tree that a prototype is named after (``tree_lime_0_near``) keeps its leaves."""
    from cityx.assets.trees.species import TREES

    return any(TREES[word].evergreen for word in name.split("_") if word in TREES)


def sheds(kind: str, name: str, materials: tuple[str, ...]) -> bool:
    """Whether a prototype of a kind loses its leaves under snow."""
    return kind == "tree" and LEAF in materials and not evergreen(name)
