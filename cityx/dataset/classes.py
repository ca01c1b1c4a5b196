"""Semantic classes: what datasets call the things of a city.

Every object has one class, the same in all channels, boxes, sweeps and files. The table is fixed:
numbers mean the same in every city and are only ever added to. Pieces of a whole (windows, trims,
wheels, riders) are of the class of the whole; their own class is kept beside it (`Stage.piece`).

References
----------
M. Cordts et al., "The Cityscapes dataset for semantic urban scene understanding", CVPR 2016.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from cityx.assets.colliders import class_of, kind_of
from cityx.assets.styles.materials import material_named
from cityx.city.ground import SURFACES
from cityx.city.mesh import MeshBatch
from cityx.city.scene import Prototype
from cityx.city.tracks import MOVER_KINDS
from cityx.geometry.solids import face_areas
from cityx.ids import stable_id
from cityx.system.tables import table

IGNORED = 255  # train id of what Cityscapes does not rate
SKY = 0


@dataclass(frozen=True)
class Class:
    """One class.

    Attributes
    ----------
    number
        In the semantic channel.
    name
        Its word.
    color
        sRGB, 0 to 255, for people to look at.
    thing
        Whether its objects are counted one by one; stuff is one segment per picture.
    train_id
        Number in Cityscapes' evaluation, 255 where it rates none.
    """

    number: int
    name: str
    color: tuple[int, int, int]
    thing: bool
    train_id: int


# Name -> colour, whether a thing, train id.
_ROWS = table("dataset/classes", tuple[int, bool, int], "classes")
CLASSES: tuple[Class, ...] = tuple(
    Class(number, name, (c >> 16, c >> 8 & 255, c & 255), thing, train)
    for number, (name, (c, thing, train)) in enumerate(_ROWS.items())
)
CLASS: Mapping[str, int] = MappingProxyType({held.name: held.number for held in CLASSES})
THING: NDArray[np.bool_] = np.array([held.thing for held in CLASSES])

_SURFACE = table("dataset/classes", str, "surfaces")
# Layers of meshes whose objects are all of one class.
_LAYER = table("dataset/classes", str, "layers")
# By the material that most of an object is made of: ground beyond the labels, barriers.
_MATERIAL = table("dataset/classes", str, "materials")
_BARRIER = table("dataset/classes", str, "barriers")
# What `cityx.assets.colliders.class_of` says of pieces where the word is not that of a class.
_PIECE = table("dataset/classes", str, "pieces")
_KIND = table("dataset/classes", str, "kinds")


def class_of_piece(prototype: Prototype) -> int:
    """Return the class of what a prototype shows by itself."""
    for word in (class_of(prototype), prototype.name.removesuffix("_fine"), prototype.kind):
        name = _PIECE.get(word, word)
        if name in CLASS and name != "sky":
            return CLASS[name]
    return CLASS[_KIND.get(prototype.kind, "other")]


def class_of_mover(kind: int) -> int:
    """Return the class of a mover of a kind of `cityx.city.tracks.MOVER_KINDS`."""
    return CLASS[_PIECE.get(MOVER_KINDS[kind], MOVER_KINDS[kind])]


def classes_of_layer(layer: str, batch: MeshBatch) -> NDArray[np.uint8]:
    """Return the class of each object of a layer of meshes, (k,) uint8."""
    name = _LAYER.get(layer, "")
    if name:
        return np.full(batch.count, CLASS[name], np.uint8)
    found = np.full(batch.count, CLASS["other"], np.uint8)
    labels = _surfaces(layer)
    table = _BARRIER if kind_of(layer) == "barrier" else _MATERIAL
    usual = "wall" if kind_of(layer) == "barrier" else "other"
    for row, object_id in enumerate(batch.object_id.tolist()):
        surface = labels.get(object_id)
        known = _SURFACE[surface] if surface is not None else None
        found[row] = CLASS[known or table.get(_most(batch.one(row)), usual)]
    return found


@cache
def _surfaces(layer: str) -> Mapping[int, str]:
    """Return the surfaces of the ground by the ids of their objects."""
    return {stable_id(layer, surface.name): surface.name for surface in SURFACES}


def _most(mesh: MeshBatch) -> str:
    """Return the root of the material that most of a mesh is made of."""
    if not len(mesh.faces):
        return ""
    area = face_areas(mesh.vertices, mesh.faces)
    shown = np.bincount(mesh.material, np.nan_to_num(area), minlength=len(mesh.materials))
    return material_named(mesh.materials[int(np.argmax(shown))]).root
