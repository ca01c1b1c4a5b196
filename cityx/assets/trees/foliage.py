"""Leaves: where the leaf cards of a crown are, how they turn, and the leaves drawn for each.

A card stands for the end of a twig with its leaves. Nearby every card becomes the leaves themselves
(`PATTERNS`), farther off some of them, and farther still fewer and larger cards are folded kites.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from cityx.assets import shapes
from cityx.assets.trees.skeletons import TWIG, Skeleton, crown_radius
from cityx.assets.trees.species import Species
from cityx.city.mesh import MeshBatch, one_mesh
from cityx.geometry.arrays import FloatArray

SHORTEST = 1e-6  # metres, of vectors that have a direction
THICKEST_TWIG = 0.06  # metres, radius of a limb beyond which no leaves grow on it
# Leaves of a twig's end, along and across its card in half lengths of the card: foot on the twig,
# angle to it in radians, half length, breadth as a share of the length.
PATTERNS: Mapping[str, tuple[tuple[float, float, float, float], ...]] = MappingProxyType(
    {
        "alternate": ((0.35, 0.0, 0.42, 0.62), (0.20, 0.95, 0.42, 0.62), (-0.05, -0.95, 0.43, 0.62),
                      (-0.35, 1.05, 0.42, 0.62), (-0.62, -1.05, 0.38, 0.62)),
        "fan": ((0.45, 0.0, 0.30, 1.05), (0.25, 1.1, 0.32, 1.05), (0.0, -1.1, 0.32, 1.05),
                (-0.35, 1.2, 0.32, 1.05), (-0.6, -1.2, 0.30, 1.05)),
        "palmate": ((-0.25, 0.0, 0.58, 0.38), (-0.25, 0.75, 0.52, 0.38), (-0.25, -0.75, 0.52, 0.38),
                    (-0.25, 1.6, 0.38, 0.38), (-0.25, -1.6, 0.38, 0.38)),
        "pinnate": ((0.45, 0.0, 0.45, 0.24), (0.25, 0.7, 0.45, 0.24), (0.10, -0.7, 0.45, 0.24),
                    (-0.20, 0.8, 0.45, 0.24), (-0.35, -0.8, 0.45, 0.24), (-0.70, 0.8, 0.4, 0.24)),
        "tuft": ((-0.7, 0.0, 0.82, 0.09), (-0.7, 0.45, 0.80, 0.09), (-0.6, -0.45, 0.80, 0.09),
                 (-0.3, 0.8, 0.62, 0.10), (-0.3, -0.8, 0.62, 0.10), (0.1, 0.25, 0.55, 0.10)),
        "spray": ((-0.2, 0.0, 0.75, 0.15), (0.15, 0.7, 0.42, 0.22), (-0.05, -0.7, 0.45, 0.22),
                  (-0.45, 0.75, 0.50, 0.22), (-0.55, -0.75, 0.50, 0.22)),
    }
)  # fmt: skip
CLOUDS, CLOUD_EDGE = 16, 9.0  # clouds of leaves of a crown, and how sharply each ends
CORE_FOOT = 0.12  # square of the share of the crown's height from which there are any
BARE_TWIGS = 0.09  # share of the twigs that bear next to no leaves
CORE_SHARE = 2.0  # of the dark cards within; many small ones do not show as cards
# Within so much of the crown's radius, and in so much of its height from below, leaves are fewer by
# a share of up to the last: there one sees the limbs fork.
RIM, LOW_SHARE, UNDER = 0.75, 0.5, 0.93
RIM_LEAF = 0.24  # share of its size by which a leaf at the rim is smaller than one within
SMALLER = 0.93  # of the length of a species' cards, which crowd all the more
FULLER = 1.22  # leaves cover less than the kite they stand in for
BROAD = ("alternate", "fan", "palmate")  # patterns of leaves broad enough to show an outline
BLADES = 0.4  # share of the cards, the best lit, whose leaves have the outline of their species
STALK = 0.0035  # metres, half the breadth of the stalk that bears a twig's leaves, at its foot
FEW = 2  # leaves per card in the plainer form
FEW_FULLER, FEW_SLIM = 1.96, 0.30  # they are larger, and never thinner than this


@dataclass(frozen=True)
class Cards:
    """Leaf cards of a crown in random order, so that the first of them are a fair sample.

    Attributes
    ----------
    centre
        (n, 3) float, metres.
    along
        (n, 3) float, metres, from the middle to the tip.
    normal
        (n, 3) float, unit length, the face that looks to the light.
    light
        (n,) float, share of the light that reaches the card: low within the crown.
    mood
        (n,) float, 0 to 1, where a clump stands between the colours of its species.
    """

    centre: FloatArray
    along: FloatArray
    normal: FloatArray
    light: FloatArray
    mood: FloatArray

    def first(self, count: int) -> Cards:
        """Return the first cards."""
        return Cards(self.centre[:count], self.along[:count], self.normal[:count],
                     self.light[:count], self.mood[:count])  # fmt: skip


def _unit(vectors: FloatArray) -> FloatArray:
    return np.asarray(vectors / np.maximum(shapes.lengths(vectors), SHORTEST))


def leaf_cards(skeleton: Skeleton, habit: Species, rng: np.random.Generator, count: int) -> Cards:
    """Put clumps of cards about the twigs, their faces turned away from the crown's middle."""
    children = np.bincount(skeleton.parent[1:], minlength=len(skeleton.parent))
    reach = np.linalg.norm(skeleton.position[:, :2], axis=1)
    shell = reach / np.maximum(crown_radius(habit, skeleton.position[:, 2]), 0.3)
    weight = np.where(skeleton.radius < 2.2 * TWIG, 1.0, 0.25) * (0.35 + np.clip(shell, 0, 1.1))
    weight *= _shaded_out(skeleton.position, shell, habit)
    weight[children == 0] *= 1.6
    weight *= _lit_side(skeleton.position, habit, rng)
    weight[rng.uniform(size=len(weight)) < BARE_TWIGS] *= 0.12
    bare = (skeleton.radius > THICKEST_TWIG) | (skeleton.position[:, 2] < habit.clear * 0.95)
    weight[bare & ~skeleton.hanging] = 0.0
    edges = np.cumsum(weight)
    even = (rng.permutation(count) + rng.uniform(size=count)) / count  # no bald patches
    home = np.searchsorted(edges, even * edges[-1], side="right").clip(max=len(edges) - 1)
    hanging = skeleton.hanging[home]
    foot = skeleton.position[home]

    spread = habit.spread * np.array([0.62, 0.62, 0.40])
    # No twig's end is farther from its twig than a stalk is long.
    offset = np.clip(rng.normal(size=(count, 3)), -1.6, 1.6)
    offset *= np.where(hanging[:, None], 0.09, spread)
    centre = foot + offset
    limit = crown_radius(habit, np.clip(centre[:, 2], habit.clear, habit.height)) + 0.45
    reach = np.linalg.norm(centre[:, :2], axis=1)
    inward = np.where(hanging, 1.0, np.minimum(1.0, 1.10 * limit / np.maximum(reach, 1e-6)))
    centre[:, :2] *= inward[:, None]
    lowest = np.where(hanging, 0.7, habit.clear)
    centre[:, 2] = np.clip(centre[:, 2], lowest, habit.height + 0.2)

    half = 0.5 * (habit.height - habit.clear)
    middle = np.array([0.0, 0.0, habit.clear + 0.84 * half])
    outward = (centre - middle) / [habit.radius, habit.radius, half]
    depth = np.clip(np.linalg.norm(outward, axis=1), 0, 1.1)  # 0 in the core, 1 at the surface
    outward = _unit(outward)
    normal = 1.0 * outward + 0.30 * _unit(offset) + 0.50 * rng.normal(size=(count, 3))
    normal[:, 2] += 0.45
    twig = _unit(foot - skeleton.position[np.maximum(skeleton.parent[home], 0)])
    if habit.whorls is not None and habit.evergreen:  # needles follow their shoot
        way = twig + 0.35 * rng.normal(size=(count, 3))
        normal += [0.0, 0.0, 0.5]
    else:
        # The tip hangs outward and down; whatever of that lies in the card's plane is its axis.
        way = outward * [1.0, 1.0, 0.2] + [0.0, 0.0, -0.5] + 0.8 * rng.normal(size=(count, 3))
        way = np.where(hanging[:, None], [0.0, 0.0, -1.0] + 0.28 * rng.normal(size=(count, 3)),
                       way)  # fmt: skip
    # Leaves lie along their shoot: the axis is kept, the face turns as far to the light as it lets.
    along = _unit(way - 0.75 * np.sum(way * _unit(normal), axis=1, keepdims=True) * _unit(normal))
    normal = _unit(normal - np.sum(normal * along, axis=1, keepdims=True) * along)
    length = 0.5 * SMALLER * habit.leaf * rng.uniform(0.75, 1.25, (count, 1))
    length *= 1.0 + RIM_LEAF * (0.5 - np.clip(depth, 0.3, 1.0))[:, None]

    clump = rng.uniform(0.72, 1.28, len(skeleton.parent))[home]
    mood = np.clip(rng.normal(0.5, 0.28, len(skeleton.parent))[home]
                   + rng.normal(0, 0.10, count), 0, 1)  # fmt: skip
    low = np.clip((centre[:, 2] - habit.clear) / (2 * half), 0, 1)
    light = (0.60 + 0.48 * depth**2.0) * (0.84 + 0.26 * low) * clump
    light = np.where(hanging, np.maximum(light, 0.75 * clump), light)
    light *= rng.uniform(0.85, 1.15, count)
    return Cards(centre, along * length, normal, np.clip(light, 0.15, 1.25), mood)


def _shaded_out(place: FloatArray, shell: FloatArray, habit: Species) -> FloatArray:
    """(n,) how many of the leaves are left: few under the crown, where limbs fork in its shade."""
    low = np.clip((place[:, 2] - habit.clear) / (habit.height - habit.clear), 0, 1)
    inner = 1.0 - np.clip(shell / RIM, 0, 1)
    return np.asarray(1.0 - UNDER * inner * np.clip(1.0 - low / LOW_SHARE, 0, 1))


def _lit_side(place: FloatArray, habit: Species, rng: np.random.Generator) -> FloatArray:
    """(n,) how dense leaves stand at places of a crown: in clouds, with gaps between."""
    middle = np.array([0.0, 0.0, 0.5 * (habit.height + habit.clear)])
    out = _unit((place - middle) / [habit.radius, habit.radius, 0.5 * (habit.height - habit.clear)])
    lobe = _unit(rng.normal(size=(CLOUDS, 3)) * [1.0, 1.0, 0.7])
    strength = rng.uniform(0.4, 1.0, CLOUDS)
    cloud = (strength * np.exp(CLOUD_EDGE * (out @ lobe.T - 1.0))).max(axis=1)
    return np.asarray(0.38 + np.minimum(cloud, 1.0))


def core_cards(habit: Species, rng: np.random.Generator) -> Cards:
    """Put large dark cards deep in the crown, where a real one is too dense to look through."""
    count = int(CORE_SHARE * habit.core)
    t = np.sqrt(rng.uniform(CORE_FOOT, 0.82, count))
    z = habit.clear + t * (habit.height - habit.clear)
    reach = 0.58 * np.sqrt(rng.uniform(0, 1, count)) * crown_radius(habit, z)
    azimuth = rng.uniform(0, 2 * np.pi, count)
    centre = np.column_stack([reach * np.cos(azimuth), reach * np.sin(azimuth), z])
    along = _unit(rng.normal(size=(count, 3)))
    normal = _unit(shapes.crossed(along, rng.normal(size=(count, 3))))
    size = 0.06 * np.clip(habit.radius, 1.4, 3.2) * rng.uniform(0.7, 1.3, (count, 1))
    return Cards(centre, along * size, normal, rng.uniform(0.42, 0.62, count),
                 rng.uniform(0.2, 0.8, count))  # fmt: skip


def kites(
    cards: Cards, slim: float, tint: FloatArray, material: str, *, size: float = 1.0,
    fold: float = 0.25,
) -> MeshBatch:  # fmt: skip
    """Draw each card as one folded kite."""
    along = size * cards.along
    across = shapes.crossed(cards.normal, along) * slim
    return shapes.cards(cards.centre, along, across, material, tint, fold=fold)


def few_leaves(
    cards: Cards,
    pattern: str,
    tint: FloatArray,
    material: str,
    rng: np.random.Generator,
    *,
    size: float = 1.0,
) -> MeshBatch:
    """Draw two flat leaves for each card, a quad each."""
    centre, along, broad, shade = _spread(cards, np.array(PATTERNS[pattern])[:FEW], rng,
                                          size * FEW_FULLER, FEW_SLIM)  # fmt: skip
    middle, tip, side, color = (
        given.reshape(-1, 3) for given in (centre, along, broad, tint[:, None, :] * shade)
    )
    return shapes.cards(middle, tip, side, material, color, fold=0.0)


def leaves(
    cards: Cards, pattern: str, tint: FloatArray, material: str, rng: np.random.Generator,
    *, size: float = 1.0, lobed: bool = False,
) -> list[MeshBatch]:  # fmt: skip
    """Draw the leaves of each card, each turned a little its own way.

    Where the light is they have the outline of their species, deep in the crown they are kites.
    """
    centre, along, broad, shade = _spread(cards, np.array(PATTERNS[pattern]), rng, size * FULLER)
    # A leaf is a little more yellow or blue than its neighbour, and some are pale from below.
    hue = rng.normal(0, 1, (*shade.shape[:2], 1)) * np.array([0.13, 0.05, -0.10])
    hue += 1
    color = tint[:, None, :] * shade
    color *= hue
    np.clip(color, 0.0, 1.0, out=color)
    lit = cards.light >= np.quantile(cards.light, 1 - BLADES * (pattern in BROAD))
    parts = []
    for rows, blades in ((lit, True), (~lit, False)):
        middle, tip, side, own = (given[rows].reshape(-1, 3)
                                  for given in (centre, along, broad, color))  # fmt: skip
        parts.append(
            shapes.leaf_blades(middle, tip, side, material, own, lobed=lobed, fold=0.3)
            if blades
            else shapes.cards(middle, tip, side, material, own, fold=0.22)
        )
    return parts


def twig_of(cards: Cards, skeleton: Skeleton) -> NDArray[np.int64]:
    """Return the node of the skeleton that is nearest to each card, (n,)."""
    from scipy.spatial import cKDTree

    return np.asarray(cKDTree(skeleton.position).query(cards.centre)[1], np.int64)


def stalks(
    cards: Cards, twig: FloatArray, material: str, tint: tuple[float, float, float]
) -> MeshBatch:
    """Draw leaf stalks: a thin wedge from the twig, (n, 3) metres, to each card."""
    tip = cards.centre + 0.3 * cards.along
    side = _unit(shapes.crossed(tip - twig, cards.normal)) * STALK
    corners = np.stack([twig - side, twig + side, tip], axis=1)
    faces = np.arange(corners.size // 3).reshape(-1, 3)
    return one_mesh(0, corners.reshape(-1, 3), faces, materials=(material,), tint=tint)


def _spread(
    cards: Cards, rows: FloatArray, rng: np.random.Generator, size: float, slimmest: float = 0.0
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Middles, half lengths and half breadths of leaves, (n, k, 3) each, and their shades."""
    foot, angle, half, slim = rows.T
    count, each = len(cards.centre), len(rows)
    reach = size * np.linalg.norm(cards.along, axis=1)  # (n,)
    ahead = _unit(cards.along)
    across = shapes.crossed(cards.normal, ahead)
    turn = angle + rng.normal(0, 0.16, (count, each))
    # In place: there are so many leaves that most of the time goes into getting memory for them.
    axis = np.cos(turn)[:, :, None] * ahead[:, None, :]
    axis += np.sin(turn)[:, :, None] * across[:, None, :]
    axis -= rng.uniform(0.05, 0.45, (count, each, 1)) * cards.normal[:, None, :]
    axis /= np.maximum(shapes.lengths(axis), SHORTEST)
    middle = (foot * reach[:, None])[:, :, None] * ahead[:, None, :]
    middle += cards.centre[:, None, :]
    length = half * reach[:, None] * rng.uniform(0.85, 1.12, (count, each))
    face = 0.32 * rng.normal(size=(count, each, 3))
    face += cards.normal[:, None, :]
    broad = shapes.crossed(face, axis)
    broad /= np.maximum(shapes.lengths(broad), SHORTEST)
    broad *= (np.maximum(slim, slimmest) * length)[:, :, None]
    axis *= length[:, :, None]
    middle += axis
    return middle, axis, broad, rng.uniform(0.86, 1.14, (count, each, 1))
