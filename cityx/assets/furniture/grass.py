"""Clumps of grass for near views: blades of a lawn, of a meadow, and with daisies."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from cityx.assets.shapes import cards, prototype
from cityx.city.mesh import MeshBatch, one_mesh
from cityx.city.scene import Prototype
from cityx.ids import rng_for

CLUMPS = ("lawn_0", "lawn_1", "lawn_daisies", "meadow_0", "meadow_1")
BLADES = 34
# Radius of a clump, least and greatest height, width of a blade; metres.
LAWN, MEADOW = (0.17, 0.035, 0.085, 0.0045), (0.20, 0.12, 0.36, 0.006)
GREEN = (0.92, 0.82, 0.80)  # tints that bring leaves to the colour of the lawn below them
STRAW = (1.0, 0.70, 0.9)


def _blades(name: str, size: tuple[float, float, float, float]) -> MeshBatch:
    """Make bent blades of three triangles each."""
    radius, low, high, wide = size
    rng = rng_for(0, f"assets/grass/{name}", 1)
    turn = rng.uniform(0, 2 * np.pi, BLADES)
    foot = radius * np.sqrt(rng.uniform(0, 1, BLADES))[:, None]
    foot = foot * np.column_stack([np.cos(turn), np.sin(turn)])
    height = rng.uniform(low, high, BLADES)
    lean = rng.normal(size=(BLADES, 2)) * 0.35 * height[:, None]
    across = rng.uniform(0, np.pi, BLADES)
    half = wide / 2 * np.column_stack([np.cos(across), np.sin(across)])
    waist = foot + 0.35 * lean
    tip = foot + lean
    z0, z1, z2 = np.full(BLADES, -0.02), 0.6 * height, height
    corners = np.stack([
        np.column_stack([foot - half, z0]), np.column_stack([foot + half, z0]),
        np.column_stack([waist - 0.7 * half, z1]), np.column_stack([waist + 0.7 * half, z1]),
        np.column_stack([tip, z2]),
    ], axis=1)  # fmt: skip
    base = 5 * np.arange(BLADES)[:, None]
    faces = np.vstack([base + np.array(each) for each in ((0, 1, 3), (0, 3, 2), (2, 3, 4))])
    dry = (rng.uniform(size=(BLADES, 1)) < 0.12).astype(float)
    tint = (dry * STRAW + (1 - dry) * GREEN) * rng.uniform(0.72, 1.0, (BLADES, 1))
    return one_mesh(
        0, corners.reshape(-1, 3), faces, materials=("leaf",), tint=np.tile(tint, (3, 1))
    )


def _daisies() -> MeshBatch:
    rng = rng_for(0, "assets/grass/daisies", 1)
    count = 4
    centre = np.column_stack([rng.normal(size=(count, 2)) * 0.09, rng.uniform(0.06, 0.1, count)])
    along = np.tile([0.011, 0.0, 0.002], (count, 1))
    across = np.tile([0.0, 0.011, 0.001], (count, 1))
    return cards(centre, along, across, "sign", np.tile([1.0, 1.0, 0.92], (count, 1)), fold=0.1)


@lru_cache(maxsize=16)
def grass_clump(name: str) -> Prototype:
    """Make one clump; `name` is one of `CLUMPS`."""
    shapes = [_blades(name, MEADOW if name.startswith("meadow") else LAWN)]
    if name == "lawn_daisies":
        shapes.append(_daisies())
    return prototype(f"grass_{name}", "grass", shapes)
