"""Packs of prototypes, which rows of chunks place, and of materials, which all of them show.

The forms of a tree for other distances are made here: a page draws thousands of trees only if those
far off have few triangles.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from hashlib import sha256
from typing import Any

import numpy as np

from cityx.assets.styles.materials import material_named
from cityx.assets.trees.plants import tree
from cityx.assets.trees.species import TREES
from cityx.city.content import ContentHash, hash_mesh
from cityx.city.rooms import LIT, ROOM_KINDS
from cityx.city.scene import Prototype
from cityx.city.store import View
from cityx.outputs.packing import codec
from cityx.version import __version__
from cityx.viewer.chunks import FORMAT
from cityx.viewer.movers import KIND as MOVERS
from cityx.viewer.movers import models_of

_TREE = re.compile(r"tree_([a-z_]+)_(\d+)_(fine|near|light|far)(?:_(spring|autumn|winter|bare))?")
# Metres from which a tree shows as another form.
TREE_FORMS = (("near", 0.0), ("light", 35.0), ("far", 240.0))
_ORDER = ("fine", "near", "light", "far")


@dataclass(frozen=True)
class Shape:
    """A prototype in a pack.

    Attributes
    ----------
    prototype
        The mesh.
    of
        Name that rows know it by.
    beyond
        Metres from which it is shown in the place of the nearer forms of that name.
    """

    prototype: Prototype
    of: str
    beyond: float


@dataclass(frozen=True)
class Pack:
    """Prototypes of one kind.

    Attributes
    ----------
    name
        32 hexadecimal digits, a hash of the content.
    kind
        Of the prototypes.
    beyond
        Metres from which its forms are shown; those far off are small, and are loaded first.
    shapes
        In the order of their names.
    """

    name: str
    kind: str
    beyond: float
    shapes: tuple[Shape, ...]

    def to_json(self) -> dict[str, Any]:
        """Return the pack as the page lists it."""
        return {"name": self.name, "kind": self.kind, "beyond": self.beyond}


def forms_of(prototype: Prototype) -> list[Shape]:
    """Return a prototype and the coarser forms that stand for it further off."""
    found = _TREE.fullmatch(prototype.name)
    if found is None or found[1] not in TREES:
        return [Shape(prototype, prototype.name, 0.0)]
    species, variant, own = found[1], int(found[2]), found[3]
    season = {"bare": "winter", None: "summer"}.get(found[4], found[4])
    shapes = [Shape(prototype, prototype.name, 0.0)]
    for form, beyond in TREE_FORMS:
        if _ORDER.index(form) > _ORDER.index(own):
            shapes.append(Shape(tree(species, variant, form, season), prototype.name, beyond))
    return shapes


def packs_of(view: View, content: ContentHash) -> tuple[Pack, ...]:
    """Return the packs of the prototypes that a city places, those for far off first."""
    used: set[int] = set()
    for table in view.scene.instances.values():
        used.update(np.unique(table.prototype).tolist())
    packs: dict[tuple[float, str], list[tuple[int, Shape]]] = {}
    for number in sorted(used, key=lambda number: view.scene.prototypes[number].name):
        prototype = view.scene.prototypes[number]
        if not len(prototype.mesh.faces):
            continue
        for shape in forms_of(prototype):
            key = -shape.beyond, prototype.kind
            packs.setdefault(key, []).append((int(content.prototypes[number]), shape))
    found = []
    for (beyond, kind), members in sorted(packs.items()):
        told = ",".join(f"{number:016x} {shape.prototype.name}" for number, shape in members)
        name = _name(f"{__version__} {FORMAT} {codec() is not None} {TREE_FORMS} {kind} {told}")
        found.append(Pack(name, kind, -beyond, tuple(shape for _, shape in members)))
    models = models_of(view.tracks)
    if models:
        told = f"{[m.name for m in models]} {_mesh_hash(models)}"
        shapes = tuple(Shape(model, model.name, 0.0) for model in models)
        found.append(Pack(_name(f"{__version__} {FORMAT} {told}"), MOVERS, 0.0, shapes))
    return tuple(found)


def _mesh_hash(models: Sequence[Prototype]) -> str:
    return sha256(b"".join(hash_mesh(model.mesh)[1].tobytes() for model in models)).hexdigest()


@dataclass(frozen=True)
class Paints:
    """The materials of a city, dry: the page shows them in a weather.

    Attributes
    ----------
    name
        32 hexadecimal digits, a hash of the content.
    names
        Of the materials.
    """

    name: str
    names: tuple[str, ...]


def paints_of(view: View, packs: Sequence[Pack]) -> Paints:
    """Return the materials that chunks and packs of a city use."""
    names = {name for batch in view.scene.meshes.values() for name in batch.materials}
    for pack in packs:
        for shape in pack.shapes:
            names.update(shape.prototype.mesh.materials)
        if pack.kind in ROOM_KINDS:
            names.add(LIT)
    told = {name: repr(material_named(name)) for name in sorted(names)}
    return Paints(_name(f"{__version__} {FORMAT} {told}"), tuple(sorted(names)))


def _name(key: str) -> str:
    return sha256(key.encode()).hexdigest()[:32]
