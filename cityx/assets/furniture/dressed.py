"""Dressed things: prototypes of furniture that are of another material or colour.

What a thing mainly is of changes; panes, lights, water and plants stay.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import lru_cache
from types import MappingProxyType

import numpy as np

from cityx.assets.styles.materials import FOLIAGE, SNOWLESS, material_named, srgb_to_linear
from cityx.city.mesh import MeshBatch
from cityx.city.scene import Prototype
from cityx.geometry.arrays import BoolArray, FloatArray
from cityx.geometry.solids import area_vectors
from cityx.system.tables import table


@dataclass(frozen=True)
class Stuff:
    """A material with what its colour is multiplied by."""

    material: str
    tint: tuple[float, float, float] = (1.0, 1.0, 1.0)


THINGS: Mapping[str, Stuff] = table("assets/thing_materials", Stuff, "things")
GROUND: Mapping[str, Stuff] = table("assets/thing_materials", Stuff, "ground")
# Thing -> material that it stands on, or is covered with, and is not itself of.
_APART: Mapping[str, str] = table("assets/thing_materials", str, "apart")
_WORDS: Mapping[str, str] = table("assets/thing_materials", str, "words")
NO_COLOR = -1
BRIGHT = 0.5  # base colour of a material, from which on it takes any colour by a tint
# Material that has too little of a base colour, or takes no tint -> what it is when it is painted.
_PAINTED: Mapping[str, str] = MappingProxyType({
    "bench_wood": "wood", "concrete": "concrete_painted", "glass_wall": "glass_tinted",
    "bronze": "bronze_painted", "copper": "copper_painted",
    **dict.fromkeys(("metal_grey", "metal_dark", "steel", "rail_steel"), "steel_painted"),
})  # fmt: skip
PAINT = "frame_paint"  # of anything else
_FIXED = SNOWLESS | FOLIAGE | {"signal_red", "curtain", "sand", "soil"}


@dataclass(frozen=True)
class Look:
    """What a thing mainly is of.

    Attributes
    ----------
    material
        A key of `THINGS`, "" for its usual one.
    color
        sRGB 0xRRGGBB, `NO_COLOR` for that of the material.
    """

    material: str = ""
    color: int = NO_COLOR

    @property
    def suffix(self) -> str:
        """What tells prototypes of this look from others by name."""
        color = f"{self.color:06x}" if self.color >= 0 else ""
        return "".join(f"_{word}" for word in (self.material, color) if word)


def plain_word(word: str) -> str:
    """Return a word of a tag as tables of materials have it: "Tarmac; gravel" is "asphalt"."""
    word = word.split(";")[0].strip().lower().replace(" ", "_")
    return _WORDS.get(word, word)


def known_material(word: str, known: Mapping[str, Stuff] = THINGS) -> str:
    """Return the material that a word of a tag means, "" for none."""
    word = plain_word(word)
    return word if word in known else ""


def stuff_of(material: str, color: int, known: Mapping[str, Stuff], usual: str = "") -> Stuff:
    """Return the material and the tint that make something look as it is said to.

    Parameters
    ----------
    material
        A key of `known`, or "".
    color
        sRGB, or `NO_COLOR`.
    usual
        Material by its name where none is said.
    """
    own = known[material] if material else Stuff(usual)
    if color < 0:
        return own
    base = material_named(own.material)
    name = own.material
    if not base.takes_tint or min(base.color) < BRIGHT:
        name = _PAINTED.get(base.root, PAINT)
    wanted = np.asarray(srgb_to_linear(color)) / np.asarray(material_named(name).color)
    red, green, blue = np.clip(wanted, 0.0, 1.0).round(5).tolist()
    return Stuff(name, (red, green, blue))


def main_material(name: str, mesh: MeshBatch) -> str:
    """Return the root of the material that a thing mainly is of, apart from cloth; "" for none."""
    return _main(name, mesh, hard=True)[1]


def main_color(name: str, mesh: MeshBatch) -> FloatArray:
    """Return the linear colour of what a thing mainly is of, (3,)."""
    faces, _, area = _main(name, mesh)
    if not faces.any():
        return np.full(3, 0.5)
    known = [material_named(one) for one in mesh.materials]
    base = np.array([one.color for one in known])[mesh.material[faces]]
    takes = np.array([one.takes_tint for one in known])[mesh.material[faces]]
    color = base * np.where(takes[:, None], mesh.tint[faces], 1.0)
    weight = area[faces][:, None]
    return np.asarray((color * weight).sum(axis=0) / np.maximum(weight.sum(), 1e-12))


def _main(name: str, mesh: MeshBatch, *, hard: bool = False) -> tuple[BoolArray, str, FloatArray]:
    """Return the faces of the main material, its root, and the areas of all faces.

    It is the one that most of the thing has; of what stands on a foot of another the table says it.
    """
    area = np.linalg.norm(area_vectors(mesh.vertices, mesh.faces), axis=1)
    known = [material_named(one) for one in mesh.materials]
    roots = np.array([one.root for one in known], dtype=str)
    fixed = np.array([one.root in _FIXED or one.emission > 0 or one.alpha < 1 for one in known])
    own = roots[mesh.material]
    apart = _APART.get(next((one for one in _APART if name.startswith(one)), ""), "")
    found = set(own[~fixed[mesh.material]].tolist())
    soft = {"cloth"} if hard else set()
    left = next((one for one in ({*soft, apart}, {apart}, soft) if found - one), set())
    total = {
        root: float(area[~fixed[mesh.material] & (own == root)].sum())
        for root in sorted(found - left)
    }
    if not total:
        return np.zeros(len(mesh.faces), bool), "", area
    root = max(total, key=lambda one: round(total[one], 6))
    return ~fixed[mesh.material] & (own == root), root, area


@lru_cache(maxsize=256)
def _stuffed(look: Look, usual: str) -> Stuff:
    return stuff_of(look.material, look.color, THINGS, usual)


def dressed(prototype: Prototype, look: Look) -> Prototype:
    """Return a prototype whose main material and colour are those of a look.

    Its name is that of the prototype with the look behind it, so that it is still of its kind.
    """
    mesh = prototype.mesh
    faces = _main(prototype.name, mesh, hard=bool(look.material))[0]
    if not look.suffix or not faces.any():
        return prototype
    seen = _main(prototype.name, mesh)[0] & ~faces
    if not (look.color >= 0 and look.material):
        seen[:] = False
    table, material, tint = mesh.materials, mesh.material.copy(), mesh.tint.copy()
    for some, own in ((faces, look), (seen, Look(color=look.color))):
        if some.any():
            usual = mesh.materials[int(np.bincount(mesh.material[some]).argmax())]
            stuff = _stuffed(own, usual)
            table = tuple(dict.fromkeys((*table, stuff.material)))
            material[some] = table.index(stuff.material)
            tint[some] = np.asarray(stuff.tint, np.float32)
    made = replace(mesh, material=material, materials=table, tint=tint)
    also = _main(prototype.name, made)[0] & ~faces & ~seen
    if look.color >= 0 and also.any():  # a foot of the same material
        usual = table[int(np.bincount(material[also]).argmax())]
        stuff = _stuffed(Look(color=look.color), usual)
        table = tuple(dict.fromkeys((*table, stuff.material)))
        material[also] = table.index(stuff.material)
        tint[also] = np.asarray(stuff.tint, np.float32)
        made = replace(mesh, material=material, materials=table, tint=tint)
    base = prototype.name.removesuffix("_fine")
    name = base + look.suffix + prototype.name[len(base) :]
    return Prototype(name, prototype.kind, made)
