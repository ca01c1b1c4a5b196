"""Descriptions: sentences on assets, made from their facts alone."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cityx.assets.styles.materials import srgb_to_linear

# sRGB of colour words; the nearest by Euclid in the sRGB cube names a colour well enough.
COLORS = {
    "white": 0xF0EEE8, "cream": 0xEDE3C8, "light grey": 0xC0C0BE, "grey": 0x8C8C8A,
    "dark grey": 0x50504F, "black": 0x1C1C1C, "red": 0xA03028, "brick red": 0x96503C,
    "brown": 0x6E4A34, "dark brown": 0x422C20, "beige": 0xC8AF8C, "yellow": 0xDCB95A,
    "ochre": 0xB88638, "orange": 0xC8783C, "olive": 0x6E6E46, "green": 0x5A7D50,
    "dark green": 0x2E4632, "blue": 0x50729B, "dark blue": 0x24406B, "pink": 0xD7A5A0,
}  # fmt: skip
_LINEAR = np.array([srgb_to_linear(value) for value in COLORS.values()])
_NAMES = np.array(list(COLORS))

USES = {
    "house": "detached house", "flats": "apartment building", "office": "office building",
    "retail": "shop building", "industry": "industrial hall", "worship": "church",
    "civic": "public building", "shed": "shed",
}  # fmt: skip
MATERIALS = {
    "plaster": "plaster", "brick": "brick", "stone": "stone", "concrete": "concrete",
    "wood": "timber boards", "metal_panel": "metal cladding", "glass_wall": "glass",
    "roof_tiles": "tiles", "slate": "slate", "roof_metal": "metal", "copper": "copper",
    "bitumen": "felt", "roof_gravel": "gravel", "thatch": "thatch",
}  # fmt: skip
PARTIES = {0: "freestanding", 1: "attached on the left", 2: "attached on the right",
           3: "terraced between neighbours"}  # fmt: skip


def color_words(linear: ArrayLike) -> NDArray[np.str_]:
    """Name (n, 3) linear colours, (n,)."""
    rgb = np.sqrt(np.clip(np.asarray(linear, float).reshape(-1, 3), 0, 1))  # near the sRGB curve
    known = np.sqrt(_LINEAR)
    gap = ((rgb[:, None, :] - known[None]) ** 2).sum(axis=2)
    return np.asarray(_NAMES[gap.argmin(axis=1)])


def building_sentence(
    *,
    use: str,
    style: str,
    generator: str,
    levels: int,
    height: float,
    size: Sequence[float],
    wall: tuple[str, str],
    roof: tuple[str, str],
    party: int,
) -> str:
    """Describe a building.

    Parameters
    ----------
    use, style, generator
        Use group, style family and kind of building.
    levels, height
        Storeys, and metres to the top.
    size
        Front and depth, metres.
    wall
        Colour word and material of the walls.
    roof
        Shape and material of the roof.
    party
        Sides without openings: 1 left, 2 right.
    """
    front, depth = size
    wall_word = MATERIALS.get(wall[1], wall[1].replace("_", " "))
    roof_word = MATERIALS.get(roof[1], roof[1].replace("_", " "))
    return (
        f"{style.capitalize()} {USES.get(use, use)} as {generator}, {levels} "
        f"{'storey' if levels == 1 else 'storeys'}, {height:.0f} m high, {wall[0]} {wall_word} "
        f"walls, {roof[0]} roof of {roof_word}, {PARTIES.get(party, 'attached')}, "
        f"{front:.0f} by {depth:.0f} m."
    )


def thing_sentence(words: str, size: Sequence[float]) -> str:
    """Describe anything else by its words and its (length, width, height)."""
    length, width, height = (f"{value:.0f}" if value >= 10 else f"{value:.1f}" for value in size)
    return f"{words[:1].upper()}{words[1:]}, {length} m long, {width} m wide, {height} m high."
