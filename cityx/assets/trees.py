"""Trees, shrubs and hedges: grown by space colonisation or in whorls, leaves as small folded cards.

References
----------
Runions, Lane and Prusinkiewicz, "Modeling trees with a space colonization algorithm", 2007.
Weber and Penn, "Creation and rendering of realistic trees", 1995 (whorled habits).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from cityx.assets import shapes
from cityx.city.mesh import MeshBatch
from cityx.city.scene import Prototype
from cityx.geometry.identity import rng_for, stable_id

FloatArray = NDArray[np.float64]

VARIANTS = 3  # individuals per species
FORMS = ("near", "light", "bare", "bare_light", "fine")
# Leaf cards of a tree of middle size; "fine" has leaves of six triangles, smaller and more of them.
CARDS = {"near": 4800, "light": 900, "fine": 9000}
# Large dark cards in the core that close the view through.
FILL = {"near": 220, "light": 60, "fine": 220}
BURIED = 0.4  # metres the trunk reaches into the ground, so that it never floats on a slope
PIPE = 2.4  # exponent of the pipe model: area of a limb is the sum over its branches
TWIG = 0.006  # metres, radius of a branch tip


@dataclass(frozen=True)
class Habit:
    """How a species grows.

    Attributes
    ----------
    height
        Metres of the grown prototype.
    clear
        Metres of stem without branches.
    radius
        Metres, largest radius of the crown.
    profile
        Crown radius as a share of `radius` at equal steps from crown base to top.
    trunk
        Metres, stem radius at breast height.
    leaf
        Metres, length of a leaf card near the viewer.
    tint
        Factor on the colour of the leaf material.
    bark
        Factor on the colour of the bark material.
    whorled
        Grown in whorls about a straight stem, as conifers are.
    evergreen
        Keeps its leaves in winter.
    spread
        Spread of a leaf clump about its twig, metres.
    attractors
        Points the branches grow towards; more make a finer crown.
    """

    height: float
    clear: float
    radius: float
    profile: tuple[float, ...]
    trunk: float
    leaf: float
    tint: tuple[float, float, float]
    bark: tuple[float, float, float] = (1.0, 1.0, 1.0)
    whorled: bool = False
    evergreen: bool = False
    spread: float = 0.55
    attractors: int = 520


# Crown shapes after the field guides' silhouettes; sizes are of grown street trees.
HABITS: Mapping[str, Habit] = MappingProxyType(
    {
        "lime": Habit(13.0, 2.6, 3.7, (0.50, 0.86, 1.0, 0.98, 0.86, 0.62, 0.22), 0.20, 0.40,
                      (1.0, 1.0, 0.9)),
        "plane": Habit(16.0, 3.2, 5.2, (0.42, 0.78, 0.97, 1.0, 0.92, 0.70, 0.28), 0.30, 0.46,
                       (1.12, 1.02, 1.0), (1.9, 1.9, 1.7), spread=0.7),
        "maple": Habit(11.0, 2.3, 4.5, (0.58, 0.92, 1.0, 0.95, 0.80, 0.56, 0.20), 0.19, 0.38,
                       (1.05, 1.0, 0.8), spread=0.6),
        "oak": Habit(15.0, 2.4, 6.0, (0.55, 0.90, 1.0, 0.97, 0.86, 0.64, 0.26), 0.36, 0.44,
                     (0.85, 0.85, 0.8), (0.8, 0.8, 0.8), spread=0.75),
        "poplar": Habit(18.0, 1.8, 1.75, (0.55, 0.90, 1.0, 0.95, 0.80, 0.55, 0.15), 0.24, 0.36,
                        (0.95, 0.95, 0.85), spread=0.4),
        "birch": Habit(13.0, 2.4, 2.7, (0.45, 0.85, 1.0, 0.90, 0.72, 0.48, 0.14), 0.13, 0.30,
                       (1.35, 1.15, 0.95), (5.0, 5.6, 6.6), spread=0.5),
        "cherry": Habit(6.5, 1.7, 2.6, (0.60, 0.95, 1.0, 0.90, 0.72, 0.48, 0.20), 0.10, 0.32,
                        (1.1, 0.95, 0.9), (0.9, 0.7, 0.7), spread=0.45),
        "pine": Habit(15.0, 5.5, 3.3, (0.55, 0.95, 1.0, 0.92, 0.78, 0.55, 0.22), 0.20, 0.40,
                      (0.60, 0.66, 0.95), (1.7, 1.15, 0.9), evergreen=True, attractors=260),
        "spruce": Habit(16.0, 0.9, 3.0, (1.0, 0.93, 0.80, 0.64, 0.46, 0.27, 0.05), 0.20, 0.42,
                        (0.45, 0.55, 0.80), whorled=True, evergreen=True),
        "cypress": Habit(11.0, 0.5, 1.15, (0.62, 0.92, 1.0, 0.95, 0.80, 0.52, 0.08), 0.14, 0.34,
                         (0.50, 0.62, 0.75), evergreen=True, spread=0.3),
    }
)  # fmt: skip
SPECIES = tuple(HABITS)


@dataclass(frozen=True)
class _Skeleton:
    """Nodes of a branching skeleton; node 0 is the foot, parents come before children."""

    position: FloatArray  # (n, 3)
    parent: NDArray[np.int64]  # (n,), -1 for the foot
    radius: FloatArray  # (n,)


def crown_radius(habit: Habit, z: FloatArray) -> FloatArray:
    """Return the radius of the crown at heights `z`, metres; 0 outside the crown."""
    t = (np.asarray(z, float) - habit.clear) / (habit.height - habit.clear)
    share = np.interp(t, np.linspace(0.0, 1.0, len(habit.profile)), habit.profile)
    return np.where((t < 0) | (t > 1), 0.0, share * habit.radius)


def _lobes(rng: np.random.Generator, points: FloatArray) -> FloatArray:
    """Factor on the crown radius by direction and height: the lumps that make a crown alive."""
    azimuth = np.arctan2(points[:, 1], points[:, 0])
    total = np.zeros(len(points))
    for wave in (1, 2, 3, 5):
        phase, tilt = rng.uniform(0, 2 * np.pi), rng.uniform(-0.8, 0.8)
        total += np.sin(wave * azimuth + phase + tilt * points[:, 2]) / wave
    return 1.0 + 0.09 * total


def _attractors(habit: Habit, rng: np.random.Generator) -> FloatArray:
    """Points in the crown, denser towards its surface, where the light is."""
    z = rng.uniform(habit.clear, habit.height, 6 * habit.attractors)
    keep = rng.uniform(size=len(z)) < (crown_radius(habit, z) / habit.radius) ** 1.3
    z = z[keep][: habit.attractors]
    azimuth = rng.uniform(0, 2 * np.pi, len(z))
    reach = np.sqrt(rng.uniform(0.06, 1.0, len(z))) * crown_radius(habit, z)
    points = np.column_stack([reach * np.cos(azimuth), reach * np.sin(azimuth), z])
    points[:, :2] *= _lobes(rng, points)[:, None]
    return points


def _stem(rng: np.random.Generator, top: float, step: float) -> FloatArray:
    z = np.arange(-BURIED, top, step)
    sway = rng.normal(0, 0.010, (2, 2))
    phase = rng.uniform(0, 2 * np.pi, 2)
    free = np.clip(z, 0, None)
    x = sway[0, 0] * free + 0.05 * np.sin(0.8 * free + phase[0]) * np.minimum(free / 2, 1)
    y = sway[1, 0] * free + 0.05 * np.sin(0.7 * free + phase[1]) * np.minimum(free / 2, 1)
    return np.column_stack([x - x[0], y - y[0], z])


def _colonise(habit: Habit, rng: np.random.Generator) -> _Skeleton:
    from scipy.spatial import cKDTree

    targets = _attractors(habit, rng)
    step = 0.045 * habit.radius + 0.016 * habit.height
    slender = habit.radius / habit.height < 0.16
    lead = habit.clear + (habit.height - habit.clear) * (0.85 if slender else 0.45)
    stem = _stem(rng, lead, step)
    position = list(stem)
    parent = [-1, *range(len(stem) - 1)]
    first = int(np.searchsorted(stem[:, 2], habit.clear * 0.92))  # branches grow above this node
    kill, reach = 1.6 * step, 14.0 * step
    alive = targets
    for _ in range(80):
        if not len(alive):
            break
        nodes = np.array(position[first:])
        gap, nearest = cKDTree(nodes).query(alive, distance_upper_bound=reach)
        found = np.isfinite(gap)
        if not found.any():
            reach *= 2.0
            continue
        pull = np.zeros_like(nodes)
        toward = (alive[found] - nodes[nearest[found]]) / np.maximum(gap[found], 1e-6)[:, None]
        np.add.at(pull, nearest[found], toward)
        grown = np.flatnonzero(np.bincount(nearest[found], minlength=len(nodes)))
        way = pull[grown] + [0.0, 0.0, 0.12]  # branches bend to the light
        way /= np.maximum(np.linalg.norm(way, axis=1, keepdims=True), 1e-6)
        fresh = nodes[grown] + step * way + rng.normal(0, 0.06 * step, (len(grown), 3))
        apart, _ = cKDTree(nodes).query(fresh)
        ok = apart > 0.45 * step  # a twig that would grow on the spot is stuck between two pulls
        if not ok.any():
            alive = alive[gap > np.median(gap)]
            continue
        position.extend(fresh[ok])
        parent.extend((first + grown[ok]).tolist())
        gap, _ = cKDTree(fresh[ok]).query(alive)
        alive = alive[gap > kill]
    return _with_radii(np.array(position), np.array(parent), habit.trunk)


def _with_radii(position: FloatArray, parent: NDArray[np.int64], trunk: float) -> _Skeleton:
    """Give every node the radius of the pipe model, scaled so that the stem has its thickness."""
    area = np.zeros(len(parent))
    children = np.bincount(parent[1:], minlength=len(parent))
    area[children == 0] = TWIG**PIPE
    for node in range(len(parent) - 1, 0, -1):
        area[parent[node]] += area[node]
    radius = area ** (1 / PIPE)
    scale = trunk / radius[0]
    # Twigs keep their thickness: scale by a power, so that the foot gets `trunk`.
    power = np.log(trunk / TWIG) / np.log(radius[0] / TWIG) if radius[0] > 1.5 * TWIG else 1.0
    radius = TWIG * (radius / TWIG) ** power if power != 1.0 else radius * scale
    flare = np.exp(-np.clip(position[:, 2], 0, None) / 0.35)  # roots
    stem = radius > 0.55 * trunk
    radius = np.where(stem, radius * (1 + 0.55 * flare * (position[:, 2] < 1.5)), radius)
    return _Skeleton(position, parent, radius)


def _whorls(habit: Habit, rng: np.random.Generator) -> _Skeleton:
    stem = _stem(rng, habit.height, 0.4)
    stem[:, :2] *= 0.4
    position = list(stem)
    parent = [-1, *range(len(stem) - 1)]
    z = habit.clear
    turn = 0.0
    while z < habit.height - 0.3:
        reach = float(crown_radius(habit, np.array([z]))[0])
        at = int(np.argmin(np.abs(stem[:, 2] - z)))
        count = 7 if reach > 1.0 else 5
        turn += 0.9
        for k in range(count):
            azimuth = turn + 2 * np.pi * k / count + rng.normal(0, 0.15)
            length = reach * rng.uniform(0.82, 1.12)
            pieces = max(2, int(np.ceil(length / 0.55)))
            last = at
            for piece in range(1, pieces + 1):
                s = piece / pieces
                droop = -0.10 * length * s - 0.20 * length * s * s + 0.14 * length * s**3
                out = length * s
                position.append(np.array([out * np.cos(azimuth), out * np.sin(azimuth), z + droop]))
                parent.append(last)
                last = len(position) - 1
        z += 0.42 + 0.16 * reach / habit.radius + rng.uniform(0, 0.06)
    return _with_radii(np.array(position), np.array(parent), habit.trunk)


def _wood(skeleton: _Skeleton, habit: Habit, *, thinnest: float, skip: int) -> list[MeshBatch]:
    """Tubes along the limbs: each goes on in its thickest branch, the others start tubes."""
    count = len(skeleton.parent)
    heir = np.full(count, -1)
    for node in range(1, count):
        above = skeleton.parent[node]
        if heir[above] < 0 or skeleton.radius[node] > skeleton.radius[heir[above]]:
            heir[above] = node
    starts = [0, *(n for n in range(1, count) if heir[skeleton.parent[n]] != n)]
    limbs: list[MeshBatch] = []
    thin = 1.6 * TWIG if thinnest == 0.0 else 0.0  # bare twigs must cover pixels by themselves
    for start in starts:
        chain = [] if start == 0 else [int(skeleton.parent[start])]
        node = start
        while node >= 0 and skeleton.radius[node] >= thinnest:
            chain.append(node)
            node = int(heir[node])
        if len(chain) < 2:
            continue
        if node >= 0 and start != 0:
            chain.append(node)
        kept = chain if start == 0 else [*chain[:-1:skip], chain[-1]]
        radius = np.maximum(skeleton.radius[kept], thin)
        if start != 0:
            radius[0] = min(radius[0], 1.15 * radius[1])
        radius[-1] *= 0.6
        thick = float(radius.max())
        sides = 9 if thick > 0.1 else 5 if thick > 0.035 else 3
        shade = habit.bark if thick > 0.03 else tuple(0.25 * b + 0.75 for b in habit.bark)
        limbs.append(
            shapes.tube(skeleton.position[kept], radius, "bark", shade, sides=sides,
                        caps=(False, sides == 9))
        )  # fmt: skip
    return limbs


def _leaves(
    skeleton: _Skeleton,
    habit: Habit,
    rng: np.random.Generator,
    count: int,
    size: float,
    *,
    blades: bool = False,
) -> MeshBatch:
    """Clumps of cards about the twigs, turned outward and up, dark within and light without."""
    children = np.bincount(skeleton.parent[1:], minlength=len(skeleton.parent))
    reach = np.linalg.norm(skeleton.position[:, :2], axis=1)
    shell = reach / np.maximum(crown_radius(habit, skeleton.position[:, 2]), 0.3)
    weight = np.where(skeleton.radius < 2.2 * TWIG, 1.0, 0.25) * (0.35 + np.clip(shell, 0, 1.1))
    weight[(skeleton.radius > 0.06) | (skeleton.position[:, 2] < habit.clear * 0.9)] = 0.0
    weight[children == 0] *= 1.6
    edges = np.cumsum(weight)
    even = (np.arange(count) + rng.uniform(size=count)) / count  # stratified: no bald patches
    home = np.searchsorted(edges, even * edges[-1], side="right").clip(max=len(edges) - 1)
    spread = habit.spread * np.array([1.0, 1.0, 0.62])
    centre = skeleton.position[home] + rng.normal(size=(count, 3)) * spread * 0.62
    limit = crown_radius(habit, np.clip(centre[:, 2], habit.clear, habit.height)) + 0.55
    reach = np.linalg.norm(centre[:, :2], axis=1)
    centre[:, :2] *= np.minimum(1.0, 1.12 * limit / np.maximum(reach, 1e-6))[:, None]
    centre[:, 2] = np.clip(centre[:, 2], habit.clear * 0.85, habit.height + 0.25)

    middle = np.array([0.0, 0.0, habit.clear + 0.42 * (habit.height - habit.clear)])
    outward = (centre - middle) / [habit.radius, habit.radius, 0.5 * (habit.height - habit.clear)]
    depth = np.clip(np.linalg.norm(outward, axis=1), 0, 1.1)  # 0 in the core, 1 at the surface
    outward /= np.maximum(np.linalg.norm(outward, axis=1, keepdims=True), 1e-6)
    local = centre - skeleton.position[home]
    local /= np.maximum(np.linalg.norm(local, axis=1, keepdims=True), 1e-6)
    normal = 0.75 * outward + 0.45 * local + 0.62 * rng.normal(size=(count, 3))
    normal[:, 2] += 0.45
    normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-6)
    # The tip hangs outward and down; whatever of that lies in the card's plane is its axis.
    hang = outward * [1.0, 1.0, 0.2] + [0.0, 0.0, -0.5] + 0.8 * rng.normal(size=(count, 3))
    along = hang - np.sum(hang * normal, axis=1, keepdims=True) * normal
    along /= np.maximum(np.linalg.norm(along, axis=1, keepdims=True), 1e-6)
    across = np.cross(normal, along)
    length = size * rng.uniform(0.75, 1.25, (count, 1)) / 2

    clump = rng.uniform(0.78, 1.22, len(skeleton.parent))[home]
    warm = rng.normal(0, 0.07, len(skeleton.parent))[home]
    low = np.clip((centre[:, 2] - habit.clear) / (habit.height - habit.clear), 0, 1)
    light = (0.34 + 0.66 * depth**2.2) * (0.72 + 0.36 * low) * clump
    light *= rng.uniform(0.85, 1.15, count)
    tint = light[:, None] * habit.tint * (1 + np.outer(warm, [1.0, 0.25, -0.6]))
    draw = shapes.leaf_blades if blades else shapes.cards
    return draw(centre, along * length, across * length * 0.74, "leaf", tint)


def _core(habit: Habit, rng: np.random.Generator, count: int, size: float) -> MeshBatch:
    """Large dark cards deep in the crown, where a real one is too dense to look through."""
    t = np.sqrt(rng.uniform(0.02, 0.80, count))
    z = habit.clear + t * (habit.height - habit.clear)
    reach = 0.60 * np.sqrt(rng.uniform(0, 1, count)) * crown_radius(habit, z)
    azimuth = rng.uniform(0, 2 * np.pi, count)
    centre = np.column_stack([reach * np.cos(azimuth), reach * np.sin(azimuth), z])
    axes = np.linalg.qr(rng.normal(size=(count, 3, 2)))[0]
    length = 0.5 * size * rng.uniform(0.7, 1.3, (count, 1))
    tint = rng.uniform(0.22, 0.40, (count, 1)) * habit.tint
    return shapes.cards(centre, axes[:, :, 0] * length, axes[:, :, 1] * length, "leaf", tint)


@lru_cache(maxsize=64)
def _skeleton(species: str, variant: int) -> _Skeleton:
    habit = HABITS[species]
    rng = rng_for(variant, "assets/trees", stable_id("tree", species))
    return _whorls(habit, rng) if habit.whorled else _colonise(habit, rng)


@lru_cache(maxsize=256)
def tree(species: str, variant: int = 0, form: str = "near") -> Prototype:
    """Grow one tree.

    Parameters
    ----------
    species
        One of `SPECIES`.
    variant
        Which individual, 0 to `VARIANTS` - 1.
    form
        "near", "light" (fewer, larger leaf cards), "bare" or "bare_light" (without leaves), "fine"
        (more, smaller leaves with a blade of their own). Evergreens keep theirs.

    Returns
    -------
    tree
        Prototype of the kind "tree", named ``tree_lime_0_near``.
    """
    habit = HABITS[species]
    light, fine = form.endswith("light"), form == "fine"
    bare = form.startswith("bare") and not habit.evergreen
    skeleton = _skeleton(species, variant)
    rng = rng_for(variant, "assets/leaves", stable_id("tree", species, light))
    thinnest = (0.02 if bare else 0.05) if light else (0.0 if bare else 0.014)
    if fine:
        thinnest = 0.008
    parts = _wood(skeleton, habit, thinnest=thinnest, skip=3 if light else 1 if fine else 2)
    if bare:
        parts.append(_twigs(skeleton, rng, 600 if light else 2600))
    else:
        bulk = np.clip(habit.radius * (habit.height - habit.clear) / 38.0, 0.55, 1.35)
        kind = "light" if light else "fine" if fine else "near"
        count = int(CARDS[kind] * bulk)
        size = habit.leaf * {"light": 2.1, "near": 0.95, "fine": 0.70}[kind]
        parts.append(_leaves(skeleton, habit, rng, count, size, blades=fine))
        fill = int(FILL[kind] * bulk)
        parts.append(_core(habit, rng, fill, 0.28 * min(habit.radius, 3.2)))
    return shapes.prototype(f"tree_{species}_{variant}_{form}", "tree", parts)


def _twigs(skeleton: _Skeleton, rng: np.random.Generator, count: int) -> MeshBatch:
    """Thin cards that stand for the twigs of a bare crown."""
    thin = np.flatnonzero(skeleton.radius < 2.5 * TWIG)
    home = thin[rng.integers(0, len(thin), count)]
    way = skeleton.position[home] - skeleton.position[skeleton.parent[home]]
    way /= np.maximum(np.linalg.norm(way, axis=1, keepdims=True), 1e-6)
    way = way + 0.7 * rng.normal(size=(count, 3)) + [0, 0, 0.25]
    way /= np.maximum(np.linalg.norm(way, axis=1, keepdims=True), 1e-6)
    half = rng.uniform(0.20, 0.55, (count, 1)) * way
    side = np.cross(way, rng.normal(size=(count, 3)))
    side /= np.maximum(np.linalg.norm(side, axis=1, keepdims=True), 1e-6)
    return shapes.cards(skeleton.position[home] + half, half, 0.016 * side, "bark",
                        np.ones((count, 3)), fold=0.0)  # fmt: skip


@lru_cache(maxsize=16)
def shrub(variant: int = 0, form: str = "near") -> Prototype:
    """Make a shrub of 1.4 m: a dome of leaf cards on a few stems."""
    rng = rng_for(variant, "assets/shrub", stable_id("shrub"))
    light = form.endswith("light")
    count = 160 if light else 620
    azimuth, rise = rng.uniform(0, 2 * np.pi, count), rng.uniform(0.02, 1.0, count)
    reach = np.sqrt(1 - rise**2) * rng.uniform(0.55, 1.0, count) * 0.85
    lump = 1 + 0.15 * np.sin(3 * azimuth + variant) + 0.10 * np.sin(5 * azimuth - 2 * rise)
    centre = np.column_stack(
        [reach * lump * np.cos(azimuth), reach * lump * np.sin(azimuth), 0.12 + 1.2 * rise]
    )
    normal = centre * [1, 1, 0.7] + 0.45 * rng.normal(size=(count, 3)) + [0, 0, 0.2]
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    along = np.cross(normal, rng.normal(size=(count, 3)))
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    size = (0.30 if light else 0.16) * rng.uniform(0.8, 1.2, (count, 1))
    light_within = 0.45 + 0.6 * np.clip(np.linalg.norm(centre * [1.1, 1.1, 0.75], axis=1), 0, 1)
    tint = (light_within * rng.uniform(0.8, 1.2, count))[:, None] * [0.95, 0.92, 0.9]
    stems = [
        shapes.tube([[0, 0, -0.2], [0.12 * np.cos(a), 0.12 * np.sin(a), 0.35],
                     [0.4 * np.cos(a), 0.4 * np.sin(a), 0.8]], [0.03, 0.02, 0.01], "bark", sides=3,
                    caps=(False, False))
        for a in 2 * np.pi * np.arange(4) / 4 + variant
    ]  # fmt: skip
    leaves = shapes.cards(centre, along * size, np.cross(normal, along) * size * 0.9, "leaf", tint)
    return shapes.prototype(f"shrub_{variant}_{form}", "tree", [*stems, leaves])


PALM_HEIGHT, PALM_REACH = 9.0, 2.4  # metres


@lru_cache(maxsize=16)
def palm(variant: int = 0, form: str = "near") -> Prototype:
    """Make a palm: a slender curved stem with a head of arching fronds."""
    rng = rng_for(variant, "assets/palm", stable_id("palm"))
    lean = rng.normal(0, 0.35, 2)
    t = np.linspace(0.0, 1.0, 9)
    stem = np.column_stack([lean[0] * t**2, lean[1] * t**2, -BURIED + (7.6 + BURIED) * t])
    radius = np.interp(t, [0, 0.06, 0.15, 1.0], [0.26, 0.20, 0.15, 0.12])
    light = form.endswith("light")
    fronds = 16 if light else 26
    leaflets = 5 if light else 13
    azimuth = 2.4 * np.arange(fronds) + rng.normal(0, 0.1, fronds)  # the golden angle
    rise = np.linspace(1.2, -0.65, fronds) + rng.normal(0, 0.08, fronds)
    s = (np.arange(leaflets) + 0.5) / leaflets
    reach = 2.5 * s[None, :] * np.cos(rise)[:, None] * (1 - 0.15 * s)
    drop = 2.5 * (s[None, :] * np.sin(rise)[:, None] - 0.62 * s[None, :] ** 2)
    way = np.column_stack([np.cos(azimuth), np.sin(azimuth)])
    spine = np.concatenate(
        [way[:, None, :] * reach[:, :, None], drop[:, :, None]], axis=2
    )  # (fronds, leaflets, 3)
    ahead = np.gradient(spine, axis=1)
    ahead /= np.linalg.norm(ahead, axis=2, keepdims=True)
    level = np.stack([-way[:, 1], way[:, 0], np.zeros(fronds)], axis=1)[:, None, :]
    centre, along, across, tint = [], [], [], []
    long = (0.62 * np.sin(np.pi * (0.15 + 0.78 * s)))[None, :, None]
    for side in (-1.0, 1.0):
        out = side * level + 0.75 * ahead + [0, 0, -0.35]
        out /= np.linalg.norm(out, axis=2, keepdims=True)
        half = 0.5 * long * out
        centre.append((spine + half).reshape(-1, 3))
        along.append(half.reshape(-1, 3))
        broad = 0.5 * ahead * (0.42 if light else 0.17)
        across.append(broad.reshape(-1, 3))
        shade = rng.uniform(0.75, 1.15, spine.shape[:2]) * (0.7 + 0.25 * (rise[:, None] + 0.6))
        tint.append((shade[:, :, None] * [1.0, 0.95, 0.9]).reshape(-1, 3))
    leaves = shapes.cards(np.concatenate(centre) + stem[-1], np.concatenate(along),
                          np.concatenate(across), "leaf", np.concatenate(tint))  # fmt: skip
    wood = shapes.tube(stem, radius, "bark", (1.7, 1.6, 1.45), sides=8, caps=(False, True))
    return shapes.prototype(f"palm_{variant}_{form}", "tree", [wood, leaves])


GROVE_EDGE = 22.0  # metres between groves for which the prototype is made
GROVE_TREES = 9
GROVE_HEIGHT = 14.0


@lru_cache(maxsize=16)
def grove(variant: int = 0, form: str = "light") -> Prototype:
    """Make a piece of wood seen from afar: nine sparse trees on deep stems, for slopes too."""
    bare = form.startswith("bare")
    rng = rng_for(variant, "assets/grove", stable_id("grove"))
    needle = (0.15, 0.5, 0.85)[variant % 3]
    parts = []
    for number in range(GROVE_TREES):
        spot = (np.array([number % 3, number // 3]) - 1) * (GROVE_EDGE / 3)
        spot = spot + rng.uniform(-1.8, 1.8, 2)
        conifer = rng.uniform() < needle
        scale = rng.uniform(0.85, 1.25)
        tall, broad = (15.0, 2.9) if conifer else (12.5, 4.2)
        shade = rng.uniform(0.8, 1.2)
        foot = [spot[0], spot[1], -5.0]
        parts.append(shapes.tube([foot, [*spot, 0.85 * tall * scale]], [0.2, 0.06], "bark",
                                 sides=4, caps=(False, False)))  # fmt: skip
        if bare and not conifer:
            parts.append(shapes.moved(_brush(rng, tall * scale, broad * scale), [*spot, 0.0]))
            continue
        parts.append(
            shapes.moved(_tuft(rng, tall * scale, broad * scale, conifer, shade), [*spot, 0.0])
        )
    return shapes.prototype(f"grove_{variant}_{form}", "tree", parts)


def _tuft(
    rng: np.random.Generator, tall: float, broad: float, conifer: bool, shade: float
) -> MeshBatch:
    """Make a crown of few large cards."""
    count = 70
    t = rng.uniform(0.0, 1.0, count)
    share = 1.0 - 0.95 * t if conifer else np.sqrt(np.clip(1 - (1.7 * t - 0.75) ** 2, 0.05, 1))
    base = 0.1 if conifer else 0.28
    azimuth = rng.uniform(0, 2 * np.pi, count)
    out = np.column_stack([np.cos(azimuth), np.sin(azimuth), np.zeros(count)])
    centre = out * (broad * share * rng.uniform(0.6, 1.0, count))[:, None]
    centre[:, 2] = tall * (base + (1 - base) * t)
    normal = out + [0, 0, 0.55] + 0.5 * rng.normal(size=(count, 3))
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    along = np.cross(normal, rng.normal(size=(count, 3)))
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    size = (0.85 if conifer else 1.05) * rng.uniform(0.75, 1.25, (count, 1))
    tone = np.array([0.42, 0.52, 0.72] if conifer else [0.74, 0.78, 0.70])
    tint = (shade * (0.5 + 0.6 * t) * rng.uniform(0.85, 1.15, count))[:, None] * tone
    return shapes.cards(centre, along * size, np.cross(normal, along) * size * 0.8, "leaf", tint)


def _brush(rng: np.random.Generator, tall: float, broad: float) -> MeshBatch:
    """Make the limbs of a bare crown seen from afar."""
    count = 40
    azimuth, t = rng.uniform(0, 2 * np.pi, count), rng.uniform(0.3, 0.85, count)
    way = np.column_stack([np.cos(azimuth), np.sin(azimuth), rng.uniform(0.4, 1.4, count)])
    way = way / np.linalg.norm(way, axis=1, keepdims=True)
    half = 0.42 * broad * way * (1.2 - t)[:, None]
    foot = np.column_stack([np.zeros((count, 2)), tall * t])
    side = np.cross(way, rng.normal(size=(count, 3)))
    side *= 0.06 / np.linalg.norm(side, axis=1, keepdims=True)
    return shapes.cards(foot + half, half, side, "bark", np.ones((count, 3)), fold=0.0)


def plant(name: str, variant: int, form: str) -> Prototype:
    """Make a tree, a shrub, a palm or a grove by name; see `tree` for the forms."""
    if form == "fine" and name not in HABITS:
        form = "near"
    if name == "shrub":
        return shrub(variant, "light" if form.endswith("light") else "near")
    if name == "palm":
        return palm(variant, "light" if form.endswith("light") else "near")
    return grove(variant, form) if name == "grove" else tree(name, variant, form)


def size_of(name: str) -> tuple[float, float]:
    """Return the height and the crown radius of a plant's prototype, metres."""
    own = {"shrub": (1.4, 0.95), "palm": (PALM_HEIGHT, PALM_REACH),
           "grove": (GROVE_HEIGHT, 0.75 * GROVE_EDGE)}  # fmt: skip
    if name in own:
        return own[name]
    return HABITS[name].height, HABITS[name].radius
