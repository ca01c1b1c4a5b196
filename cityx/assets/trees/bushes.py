"""Plants that are no trees: shrubs, clipped boxwood, palms, and groves for far slopes."""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache
from types import MappingProxyType

import numpy as np

from cityx.assets import shapes
from cityx.assets.styles.materials import MATERIALS
from cityx.assets.trees.seasons import FOLIAGE
from cityx.assets.trees.species import GREEN
from cityx.city.mesh import MeshBatch
from cityx.city.scene import Prototype
from cityx.geometry.arrays import FloatArray
from cityx.ids import rng_for, stable_id

BURIED = 0.4  # metres a stem reaches into the ground
PALM_HEIGHT, PALM_REACH = 9.0, 2.4  # metres
GROVE_EDGE = 22.0  # metres between groves for which the prototype is made
GROVE_TREES = 9
GROVE_HEIGHT = 14.0
# Height, crown radius and clear stem, metres.
SIZES: Mapping[str, tuple[float, float, float]] = MappingProxyType(
    {"shrub": (1.4, 0.95, 0.0), "boxwood": (1.0, 0.55, 0.0), "palm": (PALM_HEIGHT, PALM_REACH, 6.4),
     "grove": (GROVE_HEIGHT, 0.75 * GROVE_EDGE, 0.0)}
)  # fmt: skip
# Greens as factors on the colour of the material "leaf".
AUTUMN_WOOD = ((2.6, 1.15, 0.7), (3.6, 1.45, 0.8), (1.5, 1.05, 0.9))  # russet, yellow, late green
SPRING_WOOD = (1.35, 1.2, 0.85)
LEAF_AS_TINT = np.array(GREEN) / np.array(MATERIALS[FOLIAGE].color)


def bush(name: str, variant: int, form: str, season: str) -> Prototype:
    """Make a shrub, a boxwood, a palm or a grove; all but groves look alike in every season."""
    light = form in ("light", "far")
    if name == "shrub":
        return shrub(variant, light=light)
    if name == "boxwood":
        return boxwood(variant, light=light)
    return palm(variant, light=light) if name == "palm" else grove(variant, season)


@lru_cache(maxsize=16)
def shrub(variant: int = 0, *, light: bool = False) -> Prototype:
    """Make a shrub of 1.4 m: a dome of leaf cards on a few stems."""
    rng = rng_for(variant, "assets/shrub", stable_id("shrub"))
    count = 160 if light else 1100
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
    size = (0.30 if light else 0.11) * rng.uniform(0.8, 1.2, (count, 1))
    light_within = 0.45 + 0.6 * np.clip(np.linalg.norm(centre * [1.1, 1.1, 0.75], axis=1), 0, 1)
    tint = (light_within * rng.uniform(0.8, 1.2, count))[:, None] * [0.95, 0.92, 0.9]
    stems = [
        shapes.tube([[0, 0, -0.2], [0.12 * np.cos(a), 0.12 * np.sin(a), 0.35],
                     [0.4 * np.cos(a), 0.4 * np.sin(a), 0.8]], [0.03, 0.02, 0.01], "bark", sides=3,
                    caps=(False, False))
        for a in 2 * np.pi * np.arange(4) / 4 + variant
    ]  # fmt: skip
    leaves = shapes.cards(centre, along * size, np.cross(normal, along) * size * 0.9, "leaf", tint)
    return shapes.prototype(
        f"shrub_{variant}_{'light' if light else 'near'}", "tree", [*stems, leaves]
    )


@lru_cache(maxsize=16)
def boxwood(variant: int = 0, *, light: bool = False) -> Prototype:
    """Make a boxwood of a metre, clipped to a ball, a cone or a block by its number."""
    rng = rng_for(variant, "assets/boxwood", stable_id("boxwood"))
    count = 140 if light else 1500
    azimuth, rise = rng.uniform(0, 2 * np.pi, count), rng.uniform(-0.85, 1.0, count)
    out = np.column_stack([np.cos(azimuth), np.sin(azimuth), np.zeros(count)])
    kind = variant % 3
    if kind == 0:
        normal = np.sqrt(1 - rise**2)[:, None] * out + np.column_stack(
            [*np.zeros((2, count)), rise]
        )
        centre = 0.5 * normal + [0, 0, 0.5]
    elif kind == 1:
        t = (rise + 0.85) / 1.85
        centre = (0.46 * (1 - t) + 0.05)[:, None] * out + np.column_stack(
            [*np.zeros((2, count)), t]
        )
        normal = out + np.array([0.0, 0.0, 0.45])
    else:  # the larger of the two offsets from the axis is the wall of the block
        wall = np.abs(out[:, :2]).max(axis=1, keepdims=True)
        top = rng.uniform(size=(count, 1)) < 0.25
        spread = np.where(top, np.sqrt(rng.uniform(size=(count, 1))), 1.0)
        centre = np.where(
            top,
            [0, 0, 0.96],
            np.column_stack([*np.zeros((2, count)), 0.05 + 0.9 * rng.uniform(size=count)]),
        )
        centre = centre + 0.46 * spread * out / wall
        normal = np.where(top, [0.0, 0.0, 1.0], out)
    centre = centre * (1 + rng.normal(0, 0.015, (count, 1)))
    normal = normal + 0.40 * rng.normal(size=(count, 3)) + [0, 0, 0.15]
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    along = np.cross(normal, rng.normal(size=(count, 3)))
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    size = (0.16 if light else 0.055) * rng.uniform(0.8, 1.2, (count, 1))
    shade = rng.uniform(0.6, 1.05, (count, 1)) * (0.6 + 0.4 * centre[:, 2:])
    leaves = shapes.cards(centre, along * size, np.cross(normal, along) * size * 0.9, "leaf",
                          shade * [0.72, 0.80, 0.70])  # fmt: skip
    profile = (
        [(0.3, -0.1), (0.42, 0.4), (0.30, 0.82), (0.0, 0.90)],
        [(0.38, -0.1), (0.36, 0.1), (0.0, 0.92)],
        [(0.36, -0.1), (0.40, 0.1), (0.40, 0.9), (0.0, 0.91)],
    )[kind]
    core = shapes.lathe(profile, "hedge", (0.35, 0.35, 0.35), sides=8)
    name = f"boxwood_{variant}_{'light' if light else 'near'}"
    return shapes.prototype(name, "tree", [core, leaves])


@lru_cache(maxsize=16)
def palm(variant: int = 0, *, light: bool = False) -> Prototype:
    """Make a palm: a slender curved stem with a head of arching fronds."""
    rng = rng_for(variant, "assets/palm", stable_id("palm"))
    lean = rng.normal(0, 0.35, 2)
    t = np.linspace(0.0, 1.0, 9)
    stem = np.column_stack([lean[0] * t**2, lean[1] * t**2, -BURIED + (7.6 + BURIED) * t])
    radius = np.interp(t, [0, 0.06, 0.15, 1.0], [0.26, 0.20, 0.15, 0.12])
    fronds = 16 if light else 30
    leaflets = 5 if light else 24
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
        broad = 0.5 * ahead * (0.42 if light else 0.10)
        across.append(broad.reshape(-1, 3))
        shade = rng.uniform(0.75, 1.15, spine.shape[:2]) * (0.7 + 0.25 * (rise[:, None] + 0.6))
        tint.append((shade[:, :, None] * [1.0, 0.95, 0.9]).reshape(-1, 3))
    leaves = shapes.cards(np.concatenate(centre) + stem[-1], np.concatenate(along),
                          np.concatenate(across), "leaf", np.concatenate(tint))  # fmt: skip
    wood = shapes.tube(stem, radius, "bark", (1.7, 1.6, 1.45), sides=8, caps=(False, True))
    return shapes.prototype(
        f"palm_{variant}_{'light' if light else 'near'}", "tree", [wood, leaves]
    )


@lru_cache(maxsize=16)
def grove(variant: int = 0, season: str = "summer") -> Prototype:
    """Make a piece of wood seen from afar: nine sparse trees on deep stems, for slopes too."""
    bare = season == "winter"
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
        tone = shade * _wood_tone(rng, conifer, season)
        if bare and not conifer:
            parts.append(shapes.moved(_brush(rng, tall * scale, broad * scale), [*spot, 0.0]))
            continue
        crown = _tuft(rng, tall * scale, broad * scale, tone, conifer=conifer)
        parts.append(shapes.moved(crown, [*spot, 0.0]))
    suffix = "_bare" if bare else "" if season == "summer" else f"_{season}"
    return shapes.prototype(f"grove_{variant}_light{suffix}", "tree", parts)


def _wood_tone(rng: np.random.Generator, conifer: bool, season: str) -> FloatArray:
    """Factor on the leaf colour of one tree of a wood."""
    pick = int(rng.integers(0, len(AUTUMN_WOOD)))
    if conifer:
        return np.array([0.42, 0.52, 0.72])
    green = np.array([0.74, 0.78, 0.70])
    if season == "autumn":
        return green * AUTUMN_WOOD[pick]
    return green * SPRING_WOOD if season == "spring" else green


def _tuft(
    rng: np.random.Generator, tall: float, broad: float, tone: FloatArray, *, conifer: bool
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
    light = (0.5 + 0.6 * t) * rng.uniform(0.85, 1.15, count)
    tint = light[:, None] * tone * LEAF_AS_TINT
    return shapes.cards(centre, along * size, np.cross(normal, along) * size * 0.8, FOLIAGE, tint)


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
