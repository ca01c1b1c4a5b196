"""Plants as prototypes: trees of every species, season and form, shrubs, palms and groves."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from cityx import ids
from cityx.assets import shapes
from cityx.assets.kept_prototypes import kept
from cityx.assets.trees import bushes, foliage, seasons
from cityx.assets.trees.foliage import Cards
from cityx.assets.trees.seasons import FOLIAGE
from cityx.assets.trees.skeletons import GOLDEN, TWIG, Skeleton, crown_radius, grow
from cityx.assets.trees.species import OUTSIDE_TREES, PARK_FORMS, TREES, WALLED, Species, habit
from cityx.assets.trees.wood import wood
from cityx.city.mesh import MeshBatch
from cityx.city.scene import Prototype
from cityx.geometry.arrays import FloatArray
from cityx.ids import rng_for, stable_id
from cityx.system.cache import Arrays, cached_arrays
from cityx.system.digests import edition_of
from cityx.system.tables import DATA

FORMS = ("fine", "near", "light", "far")
SPECIES = tuple(TREES)
LIGHT_CARDS, LIGHT_CORE, FAR_CARDS = 900, 120, 14
CROWDED = 1.22  # times the cards of a species near the viewer
NEAR_CARDS = 0.41  # share of the cards that the near form draws, larger for it
# Kites grow as they become fewer, a little less than the area asks: gaps close by themselves.
LIGHT_SIZE = 0.85
THINNEST = {"fine": 0.007, "near": 0.014, "light": 0.05}  # metres, limbs drawn under leaves
BARE_THINNEST = {"fine": 0.007, "near": 0.0, "light": 0.02}
SKIP = {"fine": 1, "near": 2, "light": 3}
TWIGS = {"fine": 9000, "near": 4500, "light": 900}  # thin cards of a bare crown
SCALE = {"place": 1e-4, "limb": 1e-5, "leaf": 1e-3, "span": 1e-4}  # metres per stored unit
FAR_SIDES = 6
SMOOTH_LIMB = 0.03  # metres, radius of a limb below which pale bark turns dark
TWIG_BARK = (0.52, 0.46, 0.44)
# Share of its radius at which a crown that is clipped at a wall ends on that side.
WALL_SIDE = 0.40


@dataclass(frozen=True)
class Individual:
    """One grown tree, without colours; ``twig`` is the node of its skeleton next to each leaf."""

    skeleton: Skeleton
    leaves: Cards
    core: Cards
    twig: NDArray[np.int32]


@lru_cache(maxsize=160)
def individual(species: str, variant: int) -> Individual:
    """Return a grown tree, from the cache where an earlier run has left it.

    Numbers from `WALLED` on have grown beside a wall to their +x side.
    """
    if variant >= WALLED:
        return _walled(individual(species, variant - WALLED + PARK_FORMS), habit(species, variant))
    key = f"trees-{_edition()}/{species}-{variant}{_digest(species)}"
    held = cached_arrays(key, lambda: _grown(species, variant))
    return Individual(_skeleton_of(held), _unpacked(held, "leaf"), _unpacked(held, "core"),
                      held["twig"])  # fmt: skip


def _digest(species: str) -> str:
    """Return what tells a species of a package from others of its name, "" for one of CityX."""
    return f"-{stable_id('species', repr(TREES[species]))}" if species in OUTSIDE_TREES else ""


def _walled(grown: Individual, own: Species) -> Individual:
    """Press the half of a crown at x > 0 flat, as one clipped at a wall is."""
    return replace(
        grown,
        skeleton=replace(grown.skeleton, position=_pressed(grown.skeleton.position, own)),
        leaves=replace(grown.leaves, centre=_pressed(grown.leaves.centre, own)),
        core=replace(grown.core, centre=_pressed(grown.core.centre, own)),
    )


def _pressed(place: FloatArray, own: Species) -> FloatArray:
    out = place.copy()
    end = WALL_SIDE * own.radius
    out[:, 0] = np.where(place[:, 0] > 0, end * np.tanh(place[:, 0] / end), place[:, 0])
    return out


def _skeleton_of(held: Arrays) -> Skeleton:
    return Skeleton(held["place"] * SCALE["place"], held["parent"].astype(np.int64),
                    held["limb"] * SCALE["limb"], held["hanging"])  # fmt: skip


def _grown(species: str, variant: int) -> Arrays:
    """Grow a tree and its leaves, as whole numbers: all machines agree on them."""
    own = habit(species, variant)
    skeleton = grow(species, own, variant)
    rng = rng_for(variant, "assets/leaves", stable_id("tree", species))
    park = TREES[species]
    crown = own.radius * (own.height - own.clear) / (park.radius * (park.height - park.clear))
    count = int(CROWDED * own.cards * np.clip(crown, 0.65, 1.1))
    arrays: Arrays = {
        "place": np.round(skeleton.position / SCALE["place"]).astype(np.int32),
        "parent": skeleton.parent.astype(np.int32),
        "limb": np.round(skeleton.radius / SCALE["limb"]).astype(np.int32),
        "hanging": skeleton.hanging,
    }
    arrays |= _packed(foliage.leaf_cards(skeleton, own, rng, count), "leaf")
    twig = foliage.twig_of(_unpacked(arrays, "leaf"), _skeleton_of(arrays))
    arrays["twig"] = twig.astype(np.int32)
    return arrays | _packed(foliage.core_cards(own, rng), "core")


def _packed(cards: Cards, name: str) -> Arrays:
    return {
        f"{name}_centre": np.round(cards.centre / SCALE["leaf"]).astype(np.int16),
        f"{name}_along": np.round(cards.along / SCALE["span"]).astype(np.int16),
        f"{name}_normal": np.round(cards.normal * 127).astype(np.int8),
        f"{name}_light": np.round(cards.light * 200).astype(np.uint8),
        f"{name}_mood": np.round(cards.mood * 255).astype(np.uint8),
    }


def _unpacked(held: Arrays, name: str) -> Cards:
    normal = held[f"{name}_normal"] / 127.0
    along = held[f"{name}_along"] * SCALE["span"]
    normal = normal / np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-6)
    return Cards(held[f"{name}_centre"] * SCALE["leaf"], along, normal,
                 held[f"{name}_light"] / 200.0, held[f"{name}_mood"] / 255.0)  # fmt: skip


@lru_cache(maxsize=1)
def _edition() -> str:
    """Hash of the code and the species, so that a cached tree is never that of others."""
    sources = [*sorted(Path(__file__).parent.glob("*.py")), Path(ids.__file__)]
    return edition_of([*sources, DATA / "assets" / "trees.toml"])


KEPT = ("near", "light")  # forms that are faster to read than to make, by little room


@lru_cache(maxsize=512)
def tree(species: str, variant: int = 0, form: str = "near", season: str = "summer") -> Prototype:
    """Make one tree.

    Parameters
    ----------
    species
        One of `SPECIES`.
    variant
        Which individual: 0 to `PARK_FORMS` - 1 grown in the open, the next `STREET_FORMS` beside a
        street, and the next `WALLED_FORMS` between a street and a wall to their +x side.
    form
        "fine" (every leaf drawn), "near" (two leaves on every other twig), "light" (few, large
        cards), "far" (a mass of under 60 triangles).
    season
        "spring", "summer", "autumn" or "winter"; evergreens change little or not at all.

    Returns
    -------
    tree
        Prototype of the kind "tree", named ``tree_lime_0_near``; the season follows but for
        summer, "bare" stands for no leaves.
    """
    if form in KEPT:
        return _kept(species, variant, form, season, _digest(species))
    return _made(species, variant, form, season)


@kept("tree", least=0)
def _kept(species: str, variant: int, form: str, season: str, _: str) -> Prototype:
    return _made(species, variant, form, season)


def _made(species: str, variant: int, form: str, season: str) -> Prototype:
    own = habit(species, variant)
    grown = individual(species, variant)
    bare = seasons.leafless(own, season)
    if form == "far":
        parts = _far(own, grown, season, bare=bare)
        if variant >= WALLED and not bare:
            parts = [replace(part, vertices=_pressed(part.vertices, own)) for part in parts]
    else:
        rng = rng_for(variant, f"assets/{form}", stable_id("tree", species))
        parts = _limbs(own, grown.skeleton, form, bare=bare)
        parts += [_twigs(grown.skeleton, rng, TWIGS[form])] if bare else _crown(
            own, grown, form, season, rng
        )  # fmt: skip
    return shapes.prototype(_name("tree_" + species, variant, form, season, bare,
                                  changing=not own.evergreen or season == "spring"),
                            "tree", parts)  # fmt: skip


def _name(plant: str, variant: int, form: str, season: str, bare: bool, *, changing: bool) -> str:
    suffix = "_bare" if bare else f"_{season}" if changing and season != "summer" else ""
    return f"{plant}_{variant}_{form}{suffix}"


def _bark(own: Species) -> str:
    return "bark_flaking" if own.flaking else "bark_smooth" if own.smooth else "bark"


def _limbs(own: Species, skeleton: Skeleton, form: str, *, bare: bool) -> list[MeshBatch]:
    """Make the stem and branches; smooth bark is on thick limbs alone, twigs are dark."""
    thinnest = (BARE_THINNEST if bare else THINNEST)[form]
    if form == "fine" and not own.strands:
        thinnest = 0.0  # down to the tips, which bear the leaves that are looked at
    cover = 1.6 * TWIG if bare and form != "light" else 0.0
    skip, fine = SKIP[form], form == "fine"
    if not own.smooth:
        return wood(skeleton, "bark", own.bark, thinnest=thinnest, skip=skip, fine=fine,
                    cover=cover)  # fmt: skip
    return [
        part
        for material, tint, limbs in (
            (_bark(own), own.bark, (SMOOTH_LIMB, np.inf)),
            ("bark", TWIG_BARK, (0.0, SMOOTH_LIMB)),
        )
        for part in wood(skeleton, material, tint, thinnest=thinnest, limbs=limbs, skip=skip,
                         fine=fine, cover=cover)
    ]  # fmt: skip


def _crown(
    own: Species, grown: Individual, form: str, season: str, rng: np.random.Generator
) -> list[MeshBatch]:
    """Make the leaves of a season and the dark core behind them."""
    share = seasons.in_leaf(own, season)
    total = len(grown.leaves.centre)
    count = {"light": LIGHT_CARDS, "near": int(NEAR_CARDS * total)}.get(form, total)
    leaves = grown.leaves.first(int(share * count))
    tint = seasons.colors(own, season, leaves)
    core = grown.core.first(
        int(share * (LIGHT_CORE if form == "light" else len(grown.core.centre)))
    )
    shade = seasons.colors(own, season, core)
    parts = [foliage.kites(core, 0.8, shade, FOLIAGE)]
    if form == "fine":
        twig = grown.skeleton.position[grown.twig[: len(leaves.centre)]]
        stalks = foliage.stalks(leaves, twig, "bark", TWIG_BARK)
        return [*parts, stalks, *foliage.leaves(leaves, own.pattern, tint, FOLIAGE, rng,
                                                lobed=own.lobed)]  # fmt: skip
    if form == "near":
        return [*parts, foliage.few_leaves(leaves, own.pattern, tint, FOLIAGE, rng,
                                           size=NEAR_CARDS**-0.5)]  # fmt: skip
    size = LIGHT_SIZE * np.sqrt(total / LIGHT_CARDS)
    return [*parts, foliage.kites(leaves, max(own.slim, 0.6), tint, FOLIAGE, size=size)]


def _twigs(skeleton: Skeleton, rng: np.random.Generator, count: int) -> MeshBatch:
    """Make thin cards that stand for the twigs of a bare crown."""
    thin = np.flatnonzero((skeleton.radius < 2.5 * TWIG) & (skeleton.parent >= 0))
    home = thin[rng.integers(0, len(thin), count)]
    way = skeleton.position[home] - skeleton.position[skeleton.parent[home]]
    way = way / np.maximum(np.linalg.norm(way, axis=1, keepdims=True), 1e-6)
    hanging = skeleton.hanging[home][:, None]
    way = way + np.where(hanging, 0.25, 0.7) * rng.normal(size=(count, 3))
    way += np.where(hanging, [0.0, 0.0, -0.6], [0.0, 0.0, 0.25])
    way /= np.maximum(np.linalg.norm(way, axis=1, keepdims=True), 1e-6)
    half = rng.uniform(0.18, 0.50, (count, 1)) * way
    side = np.cross(way, rng.normal(size=(count, 3)))
    side /= np.maximum(np.linalg.norm(side, axis=1, keepdims=True), 1e-6)
    broad = 0.016 * np.sqrt(TWIGS["near"] / count) * side
    tint = np.tile(TWIG_BARK, (count, 1))
    return shapes.cards(skeleton.position[home] + half, half, broad, "bark", tint, fold=0.0)


def _far(own: Species, grown: Individual, season: str, *, bare: bool) -> list[MeshBatch]:
    """Make a mass of under 60 triangles: a lumpy hull with a few cards that break its outline."""
    rng = rng_for(0, "assets/far", stable_id(own.height, own.radius))
    foot = np.array([0.0, 0.0, -0.4])
    fork = np.array([0.0, 0.0, own.clear + 0.4 * (own.height - own.clear)])
    stem = shapes.tube([foot, fork], [own.trunk, 0.5 * own.trunk], _bark(own), own.bark, sides=3,
                       caps=(False, False))  # fmt: skip
    if bare:  # limbs from the stem to where leaves were
        tip = grown.leaves.first(26).centre
        low = foot + (fork - foot) * np.linspace(0.55, 1.3, len(tip))[:, None]
        half = 0.5 * (tip - low)
        side = np.cross(half, rng.normal(size=half.shape))
        side *= 0.05 / np.maximum(np.linalg.norm(side, axis=1, keepdims=True), 1e-6)
        return [stem, shapes.cards(low + half, half, side, "bark", np.tile(TWIG_BARK, (26, 1)),
                                   fold=0.0)]  # fmt: skip
    t = np.array([0.02, 0.30, 0.78, 0.985])
    z = own.clear + t * (own.height - own.clear)
    share = np.array([0.35, 0.92, 0.95, 0.0]) * np.array([0.0 if own.strands else 1.0, 1, 1, 1])
    reach = np.maximum(crown_radius(own, z), 0.0) * share
    angle = np.arange(FAR_SIDES) * (2 * np.pi / FAR_SIDES)
    lump = rng.uniform(0.78, 1.08, (len(t), FAR_SIDES))
    ring = np.stack(
        [reach[:, None] * lump * np.cos(angle + 0.5 * np.arange(len(t))[:, None]),
         reach[:, None] * lump * np.sin(angle + 0.5 * np.arange(len(t))[:, None]),
         np.broadcast_to(z[:, None], lump.shape)], axis=2
    )[1:]  # fmt: skip
    low = np.array([0.0, 0.0, z[0]])
    hull = shapes.loft(np.concatenate([np.broadcast_to(low, (1, FAR_SIDES, 3)), ring]), FOLIAGE,
                       caps=(False, False))  # fmt: skip
    middle = hull.vertices[hull.faces[:, :3]].mean(axis=1)
    up = np.clip((middle[:, 2] - own.clear) / (own.height - own.clear), 0, 1)
    light = (0.30 + 0.36 * up) * rng.uniform(0.7, 1.3, len(up))
    face = Cards(middle, middle, middle, light, rng.uniform(0.3, 0.7, len(up)))
    shaded = replace(hull, tint=seasons.colors(own, season, face).astype(np.float32))
    plates = _plates(own, rng)
    slim = max(own.slim, 0.7)
    return [stem, shaded, foliage.kites(plates, slim, seasons.colors(own, season, plates), FOLIAGE)]


def _plates(own: Species, rng: np.random.Generator) -> Cards:
    """Make large cards on the surface of the crown, spread evenly by the golden angle."""
    up = (np.arange(FAR_CARDS) + 0.5) / FAR_CARDS
    azimuth = GOLDEN * np.arange(FAR_CARDS) + rng.uniform(0, 6)
    z = own.clear + (0.06 + 0.86 * up) * (own.height - own.clear)
    out = np.column_stack([np.cos(azimuth), np.sin(azimuth), np.zeros(FAR_CARDS)])
    centre = 0.74 * crown_radius(own, z)[:, None] * out + z[:, None] * [0.0, 0.0, 1.0]
    normal = out + np.outer(up, [0.0, 0.0, 0.8]) + rng.normal(0, 0.25, (FAR_CARDS, 3))
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    along = np.cross(np.cross(normal, [0.0, 0.0, -1.0]), normal)
    along += 0.5 * np.cross(normal, along) * rng.normal(size=(FAR_CARDS, 1))
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    size = np.minimum(0.34 * own.radius, 0.09 * own.height) * rng.uniform(0.8, 1.2, (FAR_CARDS, 1))
    light = (0.40 + 0.45 * up) * rng.uniform(0.8, 1.2, FAR_CARDS)
    return Cards(centre, along * size, normal, light, rng.uniform(0.2, 0.8, FAR_CARDS))


def plant(name: str, variant: int, form: str = "near", season: str = "summer") -> Prototype:
    """Make a tree, a shrub, a boxwood, a palm or a grove by name; see `tree` for the forms."""
    return tree(name, variant, form, season) if name in TREES else bushes.bush(
        name, variant, form, season
    )  # fmt: skip


@lru_cache(maxsize=512)
def size_of(name: str, variant: int = 0) -> tuple[float, float, float]:
    """Return height, reach of the crown and clear stem of a plant's prototype, metres."""
    if name in bushes.SIZES:
        return bushes.SIZES[name]
    own = habit(name, variant)
    leaves = individual(name, variant).leaves
    reach = np.quantile(np.hypot(leaves.centre[:, 0], leaves.centre[:, 1]), 0.995)
    return own.height, round(float(reach) + 0.3 * own.leaf, 2), own.clear


@lru_cache(maxsize=512)
def wall_reach(name: str, variant: int = 0) -> float:
    """Return the reach of a plant's crown to its +x side, metres, where a wall may be."""
    if name in bushes.SIZES or variant < WALLED:
        return size_of(name, variant)[1]
    leaves = individual(name, variant).leaves
    return round(
        float(np.quantile(leaves.centre[:, 0], 0.995)) + 0.3 * habit(name, variant).leaf, 2
    )
