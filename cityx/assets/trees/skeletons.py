"""Skeletons of trees: grown by space colonisation, or in whorls about a straight stem.

Positions are rounded while a tree grows, so that the last bits in which machines differ never
decide where the next twig goes.

References
----------
Runions, Lane and Prusinkiewicz, "Modeling trees with a space colonization algorithm", 2007.
Weber and Penn, "Creation and rendering of realistic trees", 1995.
Shinozaki et al., "A quantitative analysis of plant form: the pipe model theory", 1964.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cityx.assets.trees.species import Species, Whorls
from cityx.geometry.arrays import FloatArray, IntArray
from cityx.geometry.ranges import numbered
from cityx.ids import rng_for, stable_id

BURIED = 0.4  # metres the trunk reaches into the ground, so that it never floats on a slope
PIPE = 2.4  # exponent of the pipe model: area of a limb is the sum over its branches
TWIG = 0.006  # metres, radius of a branch tip
DECIMALS = 4  # of a metre
GOLDEN = 2.399963  # radians between successive branches on a stem
LUMPS = 0.14  # of the crown radius by which lobes stand out and recede
ROUNDS = 80  # of growth at most


@dataclass(frozen=True)
class Skeleton:
    """Nodes of a branching skeleton; node 0 is the foot, parents come before children.

    Attributes
    ----------
    position
        (n, 3) float, metres.
    parent
        (n,) int, -1 for the foot.
    radius
        (n,) float, metres.
    hanging
        (n,) bool, shoots that hang from the twigs.
    """

    position: FloatArray
    parent: IntArray
    radius: FloatArray
    hanging: NDArray[np.bool_]


def crown_radius(habit: Species, z: FloatArray) -> FloatArray:
    """Return the radius of the crown at heights `z`, metres; 0 outside the crown."""
    t = (np.asarray(z, float) - habit.clear) / (habit.height - habit.clear)
    share = np.interp(t, np.linspace(0.0, 1.0, len(habit.profile)), habit.profile)
    return np.where((t < 0) | (t > 1), 0.0, share * habit.radius)


def grow(species: str, habit: Species, variant: int) -> Skeleton:
    """Grow the skeleton of one individual."""
    rng = rng_for(variant, "assets/trees", stable_id("tree", species))
    if habit.whorls is not None:
        position, parent = _whorled(habit, habit.whorls, rng)
    else:
        position, parent = _colonised(habit, rng)
        if habit.sag:
            reach = np.hypot(position[:, 0], position[:, 1]) / habit.radius
            position[:, 2] -= habit.sag * reach**2 * (position[:, 2] > 0)
    hanging = np.zeros(len(parent), bool)
    if habit.strands:
        position, parent, hanging = _with_strands(habit, position, parent, rng)
    position = np.round(position, DECIMALS)
    radius = np.round(_radii(position, parent, habit.trunk), 5)
    return Skeleton(position, parent, radius, hanging)


# --- space colonisation ---------------------------------------------------------------------------


def _lobes(rng: np.random.Generator, points: FloatArray) -> FloatArray:
    """Factor on the crown radius by direction and height: the lumps that make a crown alive."""
    azimuth = np.arctan2(points[:, 1], points[:, 0])
    total = np.zeros(len(points))
    for wave in (1, 2, 3, 5):
        phase, tilt = rng.uniform(0, 2 * np.pi), rng.uniform(-0.8, 0.8)
        total += np.sin(wave * azimuth + phase + tilt * points[:, 2]) / wave
    return 1.0 + LUMPS * total


def _attractors(habit: Species, rng: np.random.Generator) -> FloatArray:
    """Points in the crown, denser towards its surface, where the light is."""
    z = rng.uniform(habit.clear, habit.height, 8 * habit.attractors)
    keep = rng.uniform(size=len(z)) < (crown_radius(habit, z) / habit.radius) ** 1.3
    z = z[keep][: habit.attractors]
    azimuth = rng.uniform(0, 2 * np.pi, len(z))
    reach = np.sqrt(rng.uniform(0.06, 1.0, len(z))) * crown_radius(habit, z)
    points = np.column_stack([reach * np.cos(azimuth), reach * np.sin(azimuth), z])
    points[:, :2] *= _lobes(rng, points)[:, None]
    return np.round(points, DECIMALS)


def _stem(rng: np.random.Generator, top: float, step: float) -> FloatArray:
    z = np.arange(-BURIED, top, step)
    sway = rng.normal(0, 0.010, (2, 2))
    phase = rng.uniform(0, 2 * np.pi, 2)
    free = np.clip(z, 0, None)
    x = sway[0, 0] * free + 0.05 * np.sin(0.8 * free + phase[0]) * np.minimum(free / 2, 1)
    y = sway[1, 0] * free + 0.05 * np.sin(0.7 * free + phase[1]) * np.minimum(free / 2, 1)
    return np.round(np.column_stack([x - x[0], y - y[0], z]), DECIMALS)


def _colonised(habit: Species, rng: np.random.Generator) -> tuple[FloatArray, IntArray]:
    from scipy.spatial import cKDTree

    alive = _attractors(habit, rng)
    step = 0.045 * habit.radius + 0.016 * habit.height
    lead = habit.clear + (habit.height - habit.clear) * habit.lead
    stem = _stem(rng, lead, min(step, 0.6))
    position = stem
    parent = np.arange(-1, len(stem) - 1)
    first = int(np.searchsorted(stem[:, 2], habit.clear * 0.92))  # branches grow above this node
    kill, reach = 1.6 * step, 14.0 * step
    for _ in range(ROUNDS):
        if not len(alive):
            break
        nodes = position[first:]
        gap, nearest = cKDTree(nodes).query(alive, distance_upper_bound=reach)
        found = np.isfinite(gap)
        if not found.any():
            reach *= 2.0
            continue
        pull = np.zeros_like(nodes)
        toward = (alive[found] - nodes[nearest[found]]) / np.maximum(gap[found], 1e-6)[:, None]
        np.add.at(pull, nearest[found], toward)
        grown = np.flatnonzero(np.bincount(nearest[found], minlength=len(nodes)))
        way = pull[grown] + [0.0, 0.0, habit.rise]
        way /= np.maximum(np.linalg.norm(way, axis=1, keepdims=True), 1e-6)
        fresh = nodes[grown] + step * way + rng.normal(0, 0.06 * step, (len(grown), 3))
        fresh = np.round(fresh, DECIMALS)
        apart, _ = cKDTree(nodes).query(fresh)
        ok = apart > 0.45 * step  # a twig that would grow on the spot is stuck between two pulls
        if not ok.any():
            alive = alive[gap > np.median(gap)]
            continue
        position = np.concatenate([position, fresh[ok]])
        parent = np.concatenate([parent, first + grown[ok]])
        gap, _ = cKDTree(fresh[ok]).query(alive)
        alive = alive[gap > kill]
    return position, parent


def _with_strands(
    habit: Species, position: FloatArray, parent: IntArray, rng: np.random.Generator
) -> tuple[FloatArray, IntArray, NDArray[np.bool_]]:
    """Let shoots hang from the outer twigs, none nearer than a metre to the ground."""
    children = np.bincount(parent[1:], minlength=len(parent))
    reach = np.hypot(position[:, 0], position[:, 1])
    outer = reach > 0.35 * crown_radius(habit, position[:, 2])
    roots = np.flatnonzero((position[:, 2] > habit.clear) & ((children == 0) | outer))
    roots = np.repeat(roots, 2)
    pieces = 7
    wish = habit.strands * rng.uniform(0.35, 1.0, len(roots))
    length = np.clip(np.minimum(wish, position[roots, 2] - rng.uniform(0.9, 1.6, len(roots))), 0, 9)
    keep = length > 0.3
    roots, length = roots[keep], length[keep]
    azimuth = np.arctan2(position[roots, 1], position[roots, 0])
    azimuth += rng.normal(0, 0.8, len(roots))
    out = np.column_stack([np.cos(azimuth), np.sin(azimuth)])
    s = np.arange(1, pieces + 1) / pieces
    # An arch outward, then straight down.
    sideways = 0.30 * np.sqrt(length)[:, None] * (1 - (1 - s) ** 3)  # (k, pieces)
    drop = length[:, None] * (s**1.4)
    nodes = position[roots][:, None, :] + np.concatenate(
        [sideways[:, :, None] * out[:, None, :], -drop[:, :, None]], axis=2
    )
    nodes[:, :, :2] += rng.normal(0, 0.02, nodes[:, :, :2].shape)
    count = len(roots) * pieces
    above = len(parent) + np.arange(count) - 1
    above[::pieces] = roots
    hanging = np.concatenate([np.zeros(len(parent), bool), np.ones(count, bool)])
    return (np.concatenate([position, nodes.reshape(-1, 3)]), np.concatenate([parent, above]),
            hanging)  # fmt: skip


# --- whorls ---------------------------------------------------------------------------------------


def _whorled(
    habit: Species, whorls: Whorls, rng: np.random.Generator
) -> tuple[FloatArray, IntArray]:
    """Put branches on a stem and side shoots on the branches, a level at a time."""
    stem = _stem(rng, habit.height - 0.05, 0.35)
    stem[:, :2] *= 0.4
    parent = np.arange(-1, len(stem) - 1)
    places = np.arange(habit.clear + 0.05, habit.height - 0.25, whorls.gap)
    t = (places - habit.clear) / (habit.height - habit.clear)
    places = places + rng.uniform(-0.25, 0.25, len(places)) * whorls.gap
    turn = GOLDEN * np.arange(len(places)) + rng.uniform(0, 6)
    round_ = 2 * np.pi * np.arange(whorls.count) / whorls.count
    z = np.repeat(places, whorls.count)
    azimuth = (turn[:, None] + round_).ravel() + rng.normal(0, 0.16, len(z))
    rise = np.repeat(whorls.low + (whorls.high - whorls.low) * t, whorls.count)
    rise = rise + rng.normal(0, 0.07, len(z))
    # A steep branch ends higher than it starts: its length follows the crown where it ends.
    length = np.maximum(crown_radius(habit, z), 0.1)
    for _ in range(3):
        end = z + length * np.tan(np.clip(rise + 0.5 * whorls.bend, -0.6, 1.35))
        length = np.maximum(crown_radius(habit, np.clip(end, z, habit.height)), 0.08)
    slope = np.clip(rise + 0.5 * whorls.bend, -1.2, 1.35)
    length = np.minimum(length / np.cos(slope), np.maximum(habit.height - z, 0.2) / 0.9)
    length *= rng.uniform(0.80, 1.12, len(z))
    at = np.searchsorted(stem[:, 2], z).clip(max=len(stem) - 1) - 1

    pieces = 6
    s = np.arange(1, pieces + 1) / pieces
    angle = rise[:, None] + whorls.bend * s  # (b, pieces)
    step = np.stack(
        [np.cos(angle) * np.cos(azimuth)[:, None], np.cos(angle) * np.sin(azimuth)[:, None],
         np.sin(angle)], axis=2
    ) * (length / pieces)[:, None, None]  # fmt: skip
    foot = np.column_stack([stem[at, :2], z])
    branch = foot[:, None, :] + np.cumsum(step, axis=1)  # (b, pieces, 3)
    branch += rng.normal(0, 0.012, branch.shape) * length[:, None, None]
    above = len(stem) + np.arange(len(z) * pieces) - 1
    above[::pieces] = at

    # Side shoots leave in turn to the left and to the right, forward and a little down.
    each = np.clip((length * 3.2).astype(int), 1, 9)
    owner = np.repeat(np.arange(len(z)), each)
    number = numbered(each)
    along = (
        whorls.bare
        + (0.97 - whorls.bare) * (number + rng.uniform(0.2, 0.8, len(owner))) / each[owner]
    )
    piece = np.clip((along * pieces).astype(int) - 1, 0, pieces - 1)
    ahead = step[owner, piece]
    ahead = ahead / np.linalg.norm(ahead, axis=1, keepdims=True)
    level = np.column_stack([-np.sin(azimuth), np.cos(azimuth), np.zeros(len(z))])[owner]
    over = np.cross(ahead, level)
    roll = rng.normal(0, 0.45, len(owner)) + np.where(rise[owner] > 0.8, number * GOLDEN, 0.0)
    side = np.where(number % 2 == 0, 1.0, -1.0)[:, None]
    out = side * (np.cos(roll)[:, None] * level + np.sin(roll)[:, None] * over)
    way = 0.62 * ahead + 0.78 * out + [0.0, 0.0, 0.25 * np.sign(whorls.low)]
    way /= np.linalg.norm(way, axis=1, keepdims=True)
    reach = whorls.side * length[owner] * (1.15 - along) + 0.08
    reach *= rng.uniform(0.7, 1.15, len(owner))
    joints = 3
    k = np.arange(1, joints + 1) / joints
    shoot = branch[owner, piece][:, None, :] + way[:, None, :] * (reach[:, None] * k)[:, :, None]
    onto = len(stem) + owner * pieces + piece
    last = len(stem) + len(z) * pieces + np.arange(len(owner) * joints) - 1
    last[::joints] = onto
    position = np.concatenate([stem, branch.reshape(-1, 3), shoot.reshape(-1, 3)])
    return position, np.concatenate([parent, above, last])


# --- thickness ------------------------------------------------------------------------------------


def _radii(position: FloatArray, parent: IntArray, trunk: float) -> FloatArray:
    """Give every node the radius of the pipe model, scaled so that the stem has its thickness."""
    depth = np.zeros(len(parent), np.int64)
    above = parent.tolist()
    deep = [0] * len(above)
    for node in range(1, len(above)):
        deep[node] = deep[above[node]] + 1
    depth = np.array(deep)
    area = np.zeros(len(parent))
    children = np.bincount(parent[1:], minlength=len(parent))
    area[children == 0] = TWIG**PIPE
    order = np.argsort(-depth, kind="stable")
    edges = np.flatnonzero(np.diff(depth[order])) + 1
    for nodes in np.split(order, edges)[:-1]:
        np.add.at(area, parent[nodes], area[nodes])
    radius = area ** (1 / PIPE)
    # Twigs keep their thickness: scale by a power, so that the foot gets `trunk`.
    power = np.log(trunk / TWIG) / np.log(max(radius[0] / TWIG, 1.5))
    radius = TWIG * (radius / TWIG) ** power
    # The stem tapers from the ground on, not only where it branches.
    free = np.clip(position[:, 2], 0.0, None)
    return np.asarray(radius * np.where(radius > 0.5 * trunk, 1.0 - 0.018 * np.minimum(free, 6), 1))
