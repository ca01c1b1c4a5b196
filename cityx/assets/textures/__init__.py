"""Textures made by code: tileable, the same on every machine, free of anybody's licence.

``texture("brick").color`` has row 0 at the top, as image files have it: v = 1, up the wall or up
the slope. The same pattern serves materials of any base colour: see `Texture.mean`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import lru_cache
from io import BytesIO
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cityx import ids
from cityx.assets.textures import grounds, pavements, walls
from cityx.assets.textures.relief import (
    Relief,
    exact_mean,
    linear_from_srgb_bytes,
    neutral_albedo,
    normal_bytes,
    srgb_bytes,
)
from cityx.errors import UsageError, nearest
from cityx.system.cache import Arrays, cached_arrays
from cityx.system.digests import edition_of

__all__ = ["PATTERNS", "Texture", "TextureFiles", "texture", "texture_files"]

# How an image library writes the maps of a form: without chroma subsampling and at these qualities
# blocks do not show, also in normal maps. PNG at its fastest takes a third of the time of the usual
# level for a tenth more bytes.
FORMS: Mapping[str, Mapping[str, Any]] = MappingProxyType(
    {
        "jpeg": {"format": "JPEG", "quality": 92, "subsampling": 0},
        "gltf": {"format": "JPEG", "quality": 90, "subsampling": 0},
        "png": {"format": "PNG", "compress_level": 1},
    }
)
FLAT = 3  # of 255; files of glTF and PNG have no map that varies less over the tile

PATTERNS: Mapping[str, Callable[[int], Relief]] = MappingProxyType(
    {
        pattern.__name__: pattern
        for pattern in (
            walls.plaster, walls.brick, walls.ashlar, walls.concrete, walls.boards, walls.panels,
            walls.curtain, walls.paint,
            walls.roof_tiles, walls.slate, walls.seams, walls.felt, walls.gravel, walls.thatch,
            grounds.asphalt, grounds.setts, grounds.gutter_stones, grounds.gutter_slabs,
            grounds.paving, grounds.plaza_slabs, grounds.grass, grounds.soil,
            grounds.furrows, grounds.ripples,
            pavements.asphalt_worn, pavements.cobbles, pavements.clinker, pavements.road_slabs,
            pavements.flagstones, pavements.mosaic, pavements.slab_walk,
            pavements.walk_blocks, pavements.guided_blocks,
            pavements.domes, pavements.blisters, pavements.ribbed_slabs,
            grounds.bark, grounds.bark_smooth, grounds.bark_flaking,
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
    held = cached_arrays(f"textures-{edition()}/{name}-{size}", lambda: _drawn(name, size))
    color, normal, roughness = (held[key] for key in ("color", "normal", "roughness"))
    for pixels in (color, normal, roughness):
        pixels.setflags(write=False)
    mean, roughness_mean, tile = held["facts"].tolist()
    return Texture(name, tile, color, mean, normal, roughness, roughness_mean)


@dataclass(frozen=True)
class TextureFiles:
    """Maps of one pattern as image files.

    Attributes
    ----------
    mean, roughness_mean
        As of the `Texture`.
    files
        "color", "normal" and "roughness" to the content of a file each.
    """

    mean: float
    roughness_mean: float
    files: Mapping[str, bytes]


@lru_cache(maxsize=64)
def texture_files(name: str, size: int = 512, form: str = "jpeg") -> TextureFiles:
    """Make the maps of a pattern as image files, which are kept from run to run.

    Parameters
    ----------
    name, size
        As for `texture`.
    form
        Key of `FORMS`. In that of glTF the roughness is the green of three channels.

    Raises
    ------
    UsageError
        If there is no such pattern.
    """
    import PIL

    key = f"textures-{edition()}/{name}-{size}-{form}-{PIL.__version__}"
    held = cached_arrays(key, lambda: _encoded(texture(name, size), form))
    mean, roughness_mean = held.pop("facts").tolist()
    files = {part: content.tobytes() for part, content in held.items()}
    return TextureFiles(mean, roughness_mean, MappingProxyType(files))


def _encoded(maps: Texture, form: str) -> Arrays:
    """Encode the maps, each as the bytes of a file."""
    from PIL import Image

    held = {"facts": np.array([maps.mean, maps.roughness_mean])}
    for part in ("color", "normal", "roughness"):
        pixels = getattr(maps, part)
        if form != "jpeg" and np.ptp(pixels, (0, 1)).max() <= FLAT:
            continue
        if form == "gltf" and part == "roughness":  # blue is metalness, left to the factor
            full = np.full_like(pixels, 255)
            pixels = np.stack([full, pixels, full], axis=2)
        target = BytesIO()
        Image.fromarray(pixels).save(target, **FORMS[form])
        held[part] = np.frombuffer(target.getvalue(), np.uint8)
    return held


def _drawn(name: str, size: int) -> Arrays:
    """Draw the maps of a pattern; ``facts`` are mean, mean of the roughness and tile."""
    relief = PATTERNS[name](size)
    color = srgb_bytes(neutral_albedo(relief.albedo.astype(np.float32), relief.brightness))[::-1]
    uneven = np.broadcast_to(np.asarray(relief.roughness, np.float32), (size, size))
    roughness = np.round(uneven / uneven.max() * 255).astype(np.uint8)[::-1]
    mean = exact_mean(linear_from_srgb_bytes(color).astype(np.float32))
    roughness_mean = int(roughness.astype(np.int64).sum()) / (255 * roughness.size)
    normal = normal_bytes(relief.height.astype(np.float32), relief.tile)[::-1]
    maps = {"color": color, "normal": normal, "roughness": roughness}
    return {
        **{key: np.ascontiguousarray(pixels) for key, pixels in maps.items()},
        "facts": np.array([mean, roughness_mean, relief.tile], np.float64),
    }


@lru_cache(maxsize=1)
def edition() -> str:
    """Hash of the code that draws, so that a cached texture is never that of other code."""
    sources = [*sorted(Path(__file__).parent.glob("*.py")), Path(ids.__file__)]
    return edition_of(sources)
