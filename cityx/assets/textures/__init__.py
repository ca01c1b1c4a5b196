"""Textures made by code: tileable, the same on every machine, free of anybody's licence.

``texture("brick").color`` has row 0 at the top, as image files have it: v = 1, up the wall or up
the slope. The same pattern serves materials of any base colour: see `Texture.mean`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import lru_cache
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from cityx.assets.textures import grounds, roofs, walls
from cityx.assets.textures.relief import (
    Relief,
    exact_mean,
    linear_from_srgb_bytes,
    neutral_albedo,
    normal_bytes,
    srgb_bytes,
)
from cityx.errors import UsageError, nearest

__all__ = ["PATTERNS", "Texture", "texture"]

PATTERNS: Mapping[str, Callable[[int], Relief]] = MappingProxyType(
    {
        pattern.__name__: pattern
        for pattern in (
            walls.plaster, walls.brick, walls.ashlar, walls.concrete, walls.boards, walls.panels,
            walls.curtain, walls.paint,
            roofs.roof_tiles, roofs.slate, roofs.seams, roofs.felt, roofs.gravel, roofs.thatch,
            grounds.asphalt, grounds.setts, grounds.paving, grounds.grass, grounds.soil,
            grounds.furrows, grounds.ripples, grounds.bark,
        )
    }
)  # fmt: skip


@dataclass(frozen=True, eq=False)
class Texture:
    """Maps of one pattern, all tileable; arrays are read-only, row 0 is the top (v = 1).

    Attributes
    ----------
    name
        Pattern.
    tile
        Edge in metres the pattern is drawn for.
    color
        (s, s, 3) uint8, sRGB-encoded.
    mean
        Mean of `color` in linear light, the same for all three channels. A view multiplies the
        linear map by ``min(1, base / mean)``, so that the surface has the material's base colour
        on average.
    normal
        (s, s, 3) uint8, tangent space, +x right (u), +y up (v), +z out (the OpenGL form).
    roughness
        (s, s) uint8, 255 = 1, linear: multiplies ``min(1, roughness / roughness_mean)``.
    roughness_mean
        Mean of `roughness`, 0 to 1.
    """

    name: str
    tile: float
    color: NDArray[np.uint8]
    mean: float
    normal: NDArray[np.uint8]
    roughness: NDArray[np.uint8]
    roughness_mean: float


@lru_cache(maxsize=64)
def texture(name: str, size: int = 512) -> Texture:
    """Make the maps of a pattern.

    Parameters
    ----------
    name
        Key of `PATTERNS`.
    size
        Edge in pixels.

    Raises
    ------
    UsageError
        If there is no such pattern.
    """
    if name not in PATTERNS:
        raise UsageError(f"there is no texture {name!r}.{nearest(name, PATTERNS)}")
    relief = PATTERNS[name](size)
    color = srgb_bytes(neutral_albedo(relief.albedo.astype(np.float32), relief.brightness))[::-1]
    uneven = np.broadcast_to(np.asarray(relief.roughness, np.float32), (size, size))
    roughness = np.round(uneven / uneven.max() * 255).astype(np.uint8)[::-1]
    maps = (color, normal_bytes(relief.height.astype(np.float32), relief.tile)[::-1], roughness)
    color, normal, roughness = (np.ascontiguousarray(pixels) for pixels in maps)
    for pixels in (color, normal, roughness):
        pixels.setflags(write=False)
    return Texture(
        name,
        relief.tile,
        color,
        exact_mean(linear_from_srgb_bytes(color).astype(np.float32)),
        normal,
        roughness,
        int(roughness.astype(np.int64).sum()) / (255 * roughness.size),
    )
