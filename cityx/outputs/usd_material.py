"""Materials of the city as UsdPreviewSurface, with textures in files beside the layer."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pxr import Gf, Sdf

from cityx.assets.styles.materials import Material, material_named
from cityx.assets.textures import TextureFiles, texture_files
from cityx.city.environment import Environment
from cityx.outputs.gltf_material import shines, weather_look
from cityx.outputs.usd_mesh import (
    TINT_STEPS,
    Types,
    add_attribute,
    add_prim,
    connect,
    refer,
    tint_of,
)
from cityx.system.atomic import replaced

_WHITE = (TINT_STEPS,) * 3

Steps = tuple[int, int, int]


@dataclass
class UsdMaterials:
    """The materials used by a layer, each made when first asked for.

    A textured material has one variant per tint; the others read the colour of the face, which
    is exact.

    Attributes
    ----------
    scope
        Prim that holds them.
    environment
        Wetness and night lights change the look.
    folder
        Folder of the textures, beside the layer; made with the first of them.
    size
        Edge of the textures in pixels, 0 for none.
    """

    scope: Any
    environment: Environment
    folder: Path
    size: int = 512
    textures: int = 0
    _known: dict[str, Any] = field(default_factory=dict)
    _paths: dict[tuple[str, Steps], Any] = field(default_factory=dict)
    _seen: dict[str, NDArray[np.float64]] = field(default_factory=dict)
    _maps: dict[str, dict[str, str]] = field(default_factory=dict)

    def __len__(self) -> int:
        """Count the materials made."""
        return len(self._known)

    def path(self, name: str, steps: Steps = _WHITE) -> Any:
        """Return the path of a material in a tint."""
        look = name, steps
        found = self._paths.get(look)
        if found is None:  # tens of thousands of faces ask for a few hundred
            found = self._paths[look] = self._path(name, steps)
        return found

    def _path(self, name: str, steps: Steps) -> Any:
        if name not in self._known:
            self._known[name] = self._material(material_named(name))
        base = self._known[name]
        if steps == _WHITE or "Color" not in base.nameChildren:
            return base.path
        tinted = look_name(name, steps)
        if tinted not in self._known:
            prim = self._known[tinted] = add_prim(self.scope, tinted, "Material")
            refer(prim, base.path)
            over = add_prim(prim, "Color", specifier=Sdf.SpecifierOver)
            scale = self._texture_scale(material_named(name)) * tint_of(steps)
            add_attribute(over, "inputs:scale", Types.Float4, _four(scale))
        return self._known[tinted].path

    def seen_color(self, name: str) -> NDArray[np.float64]:
        """(3,) linear colour of a material from afar, without tint."""
        if name not in self._seen:
            self._seen[name] = weather_look(material_named(name), self.environment)[0]
        return self._seen[name]

    def _texture_scale(self, material: Material) -> NDArray[np.float64]:
        mean = self._drawn(material).mean
        return np.clip(self.seen_color(material.name) / mean, 0, 1)

    def _drawn(self, material: Material) -> TextureFiles:
        return texture_files(material.texture, self.size, "png")

    def _material(self, material: Material) -> Any:
        prim = add_prim(self.scope, material.name, "Material")
        surface = add_shader(prim, "Surface", "UsdPreviewSurface", "surface", Types.Token)
        connect(prim, "outputs:surface", Types.Token, surface, "surface")
        maps = self._files(material) if material.texture and self.size else {}
        place = None
        if maps:
            place = add_shader(prim, "Place", "UsdPrimvarReader_float2", "result", Types.Float2)
            add_attribute(place, "inputs:varname", Types.String, "st")
        self._color(prim, surface, material, maps.get("color"), place)
        roughness = weather_look(material, self.environment)[1]
        if "roughness" in maps:
            ratio = roughness / self._drawn(material).roughness_mean
            node = _texture(prim, "Roughness", maps["roughness"], place, "r", Types.Float)
            add_attribute(node, "inputs:scale", Types.Float4, _four([min(ratio, 1.0)] * 3))
            connect(surface, "inputs:roughness", Types.Float, node, "r")
        else:
            add_attribute(surface, "inputs:roughness", Types.Float, roughness)
        if "normal" in maps:
            node = _texture(prim, "Normal", maps["normal"], place, "rgb", Types.Float3)
            add_attribute(node, "inputs:scale", Types.Float4, Gf.Vec4f(2, 2, 2, 1))
            add_attribute(node, "inputs:bias", Types.Float4, Gf.Vec4f(-1, -1, -1, 0))
            connect(surface, "inputs:normal", Types.Normal3f, node, "rgb")
        add_attribute(surface, "inputs:metallic", Types.Float, material.metallic)
        if material.alpha < 1:
            add_attribute(surface, "inputs:opacity", Types.Float, material.alpha)
        if shines(material, self.environment):
            glow = np.array(material.color) / max(material.color) * material.emission
            add_attribute(surface, "inputs:emissiveColor", Types.Color3f, Gf.Vec3f(*glow.tolist()))
        return prim

    def _color(self, prim: Any, surface: Any, material: Material, file: Any, place: Any) -> None:
        """Take the colour from the texture, from the faces where they have tints, or set it."""
        if file is not None:
            node = _texture(prim, "Color", file, place, "rgb", Types.Float3, space="sRGB")
            scale = self._texture_scale(material)
            add_attribute(node, "inputs:scale", Types.Float4, _four(scale))
            connect(surface, "inputs:diffuseColor", Types.Color3f, node, "rgb")
            return
        color = Gf.Vec3f(*self.seen_color(material.name).tolist())
        if material.takes_tint:
            node = add_shader(prim, "Paint", "UsdPrimvarReader_float3", "result", Types.Float3)
            add_attribute(node, "inputs:varname", Types.String, "displayColor")
            add_attribute(node, "inputs:fallback", Types.Float3, color)
            connect(surface, "inputs:diffuseColor", Types.Color3f, node, "result")
        else:
            add_attribute(surface, "inputs:diffuseColor", Types.Color3f, color)

    def _files(self, material: Material) -> dict[str, str]:
        """Write the maps of the texture of a material and return their places by kind."""
        name = material.texture
        if name not in self._maps:
            self._maps[name] = {}
            for kind, data in self._drawn(material).files.items():
                file = self.folder / f"{name}_{kind}.png"
                with replaced(file) as temporary:
                    temporary.write_bytes(data)
                self._maps[name][kind] = f"./{self.folder.name}/{file.name}"
                self.textures += 1
        return self._maps[name]


def as_steps(row: NDArray[np.int64]) -> Steps:
    """Turn a row of `tint_steps` to a tuple."""
    red, green, blue = row.tolist()
    return red, green, blue


def look_name(material: str, steps: Steps) -> str:
    """Name of a material in a tint, such as ``brick_24_20_11``."""
    return material if steps == _WHITE else "_".join([material, *map(str, steps)])


def add_shader(prim: Any, name: str, identifier: str, output: str, kind: Any) -> Any:
    """Add a shader with one output to a material."""
    shader = add_prim(prim, name, "Shader")
    add_attribute(shader, "info:id", Types.Token, identifier, uniform=True)
    add_attribute(shader, f"outputs:{output}", kind)
    return shader


def _texture(
    prim: Any, name: str, file: str, place: Any, output: str, kind: Any, *, space: str = "raw"
) -> Any:
    node = add_shader(prim, name, "UsdUVTexture", output, kind)
    add_attribute(node, "inputs:file", Types.Asset, Sdf.AssetPath(file))
    add_attribute(node, "inputs:sourceColorSpace", Types.Token, space)
    for wrap in ("inputs:wrapS", "inputs:wrapT"):
        add_attribute(node, wrap, Types.Token, "repeat")
    connect(node, "inputs:st", Types.Float2, place, "result")
    return node


def _four(color: Any) -> Any:
    return Gf.Vec4f(*map(float, color), 1.0)
