"""Materials of the city as glTF materials with embedded textures."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cityx.assets.styles.materials import CARRIAGEWAYS, Material, material_named, wet_look
from cityx.assets.textures import texture_files
from cityx.city.environment import Environment
from cityx.city.rooms import LIT
from cityx.outputs.gltf_buffer import GltfBuffer

# Made of thin sheets that are seen from both sides.
TWO_SIDED = frozenset({"leaf", "foliage", "hedge", "cloth"})
# Ground that snow whitens; roofs and walls share materials with a tint, which would dye the snow.
SNOWED = frozenset(
    {"paving", "grass", "meadow", "forest_floor", "farmland", "soil", "sand", "gravel", "pitch",
     "rail_ballast", "kerb_stone", "yard", "flagstones", "mosaic", "slab_walk", "plaza_slabs",
     "walk_blocks", "guided_blocks", "tactile_yellow", "tactile_pale", "tactile_buff",
     "tactile_red"}
)  # fmt: skip
_SNOW = np.array([0.80, 0.82, 0.86])
SLUSH_SHARE = 0.35  # of snow, where tyres press it


def weather_look(material: Material, environment: Environment) -> tuple[NDArray[np.float64], float]:
    """Return the linear base colour, (3,), and the roughness of a surface in rain and snow."""
    wet, roughness = wet_look(material, environment.wetness)
    color = np.array(wet)
    share = environment.snow * snow_share(material)
    return color + (_SNOW - color) * share, roughness + (0.7 - roughness) * share


def snow_share(material: Material) -> float:
    """Return how much of a surface full snow hides, 0 to 1."""
    driven = SLUSH_SHARE if material.root in CARRIAGEWAYS else 0.0
    return 1.0 if material.root in SNOWED else driven


def shines(material: Material, environment: Environment) -> bool:
    """Whether a surface gives light: lit windows always, lamps and signs when they are on."""
    rooms = material.name == LIT and any(environment.rooms_lit)
    return material.emission > 0 and (rooms or environment.lamps > 0)


@dataclass
class GltfMaterials:
    """The materials used by a file, each made when first asked for.

    Attributes
    ----------
    buffer
        The file.
    environment
        Wetness and night lights change the look.
    size
        Edge of the textures in pixels, 0 for none.
    """

    buffer: GltfBuffer
    environment: Environment
    size: int = 512
    extensions: set[str] = field(default_factory=set)
    _known: dict[str, int] = field(default_factory=dict)
    _maps: dict[str, dict[str, int]] = field(default_factory=dict)

    def number(self, name: str) -> int:
        """Return the position of the material in the file."""
        if name not in self._known:
            self._known[name] = self.buffer.add("materials", self._material(material_named(name)))
        return self._known[name]

    def _material(self, material: Material) -> dict[str, Any]:
        color, roughness = weather_look(material, self.environment)
        surface: dict[str, Any] = {"metallicFactor": material.metallic}
        item: dict[str, Any] = {"name": material.name, "pbrMetallicRoughness": surface}
        if material.texture and self.size:
            maps = texture_files(material.texture, self.size, "gltf")
            numbers = self._textures(material.texture, maps.files)
            if "color" in numbers:
                surface["baseColorTexture"] = {"index": numbers["color"]}
                color = color / maps.mean
            if "roughness" in numbers:
                surface["metallicRoughnessTexture"] = {"index": numbers["roughness"]}
                roughness = roughness / maps.roughness_mean
            if "normal" in numbers:
                item["normalTexture"] = {"index": numbers["normal"]}
        rgb = [round(float(value), 4) for value in np.clip(color, 0, 1)]
        surface["baseColorFactor"] = [*rgb, material.alpha]
        surface["roughnessFactor"] = round(float(np.clip(roughness, 0, 1)), 4)
        if material.alpha < 1:
            item["alphaMode"] = "BLEND"
        if material.name in TWO_SIDED:
            item["doubleSided"] = True
        if shines(material, self.environment):
            brightest = max(material.color)
            item["emissiveFactor"] = [round(value / brightest, 4) for value in material.color]
            item["extensions"] = {
                "KHR_materials_emissive_strength": {"emissiveStrength": material.emission}
            }
            self.extensions.add("KHR_materials_emissive_strength")
        return item

    def _textures(self, name: str, files: Mapping[str, bytes]) -> dict[str, int]:
        if name not in self._maps:
            self._maps[name] = {
                kind: self._texture(f"{name}_{kind}", data) for kind, data in files.items()
            }
        return self._maps[name]

    def _texture(self, name: str, data: bytes) -> int:
        view = self.buffer.view(np.frombuffer(data, np.uint8))
        image = {"name": name, "mimeType": "image/jpeg", "bufferView": view}
        if "samplers" not in self.buffer.document:  # trilinear, repeating
            self.buffer.add("samplers", {"magFilter": 9729, "minFilter": 9987})
        source = self.buffer.add("images", image)
        return self.buffer.add("textures", {"source": source, "sampler": 0})
