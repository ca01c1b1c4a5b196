"""Looks of things: instances that are of another material, colour or size than usual."""

from __future__ import annotations

import json
from dataclasses import dataclass, replace

import numpy as np

from cityx.assets.furniture.dressed import NO_COLOR, Look, dressed, known_material
from cityx.city import City
from cityx.geometry.arrays import BoolArray, FloatArray
from cityx.sources.features import measures

SMALLEST, LARGEST = 0.25, 6.0  # times as large as usual that a thing is built
TOLD = '"(?:material|colour|color)"'  # keys of tags of a look


@dataclass(frozen=True)
class Size:
    """Metres of a thing, 0 for its usual ones, and how many times as large it is.

    Attributes
    ----------
    height, length, width
        Of its box; where the height alone is told it grows as a whole.
    scale
        Times its usual size.
    """

    height: float = 0.0
    length: float = 0.0
    width: float = 0.0
    scale: float = 1.0

    @property
    def is_told(self) -> bool:
        """Whether it is another than usual."""
        return bool(self.height or self.length or self.width) or self.scale != 1.0

    def factors(self, box: FloatArray) -> FloatArray:
        """Return the scale along each axis, (3,), of a thing whose box measures so much, (3,)."""
        return np.clip(self._asked(box), SMALLEST, LARGEST)

    def is_beyond(self, box: FloatArray) -> bool:
        """Return whether a thing with such a box, (3,), is asked to be larger than it is built."""
        return bool(np.any(np.abs(self._asked(box) - self.factors(box)) > 1e-9))

    def _asked(self, box: FloatArray) -> FloatArray:
        box = np.maximum(box, 1e-3)
        long = int(box[1] > box[0])
        factor = np.full(3, self.scale)
        if self.height:
            factor[:] = self.height / box[2]
        if (self.length or self.width) and not self.height:
            factor[:] = 1.0
        if self.length:
            factor[long] = self.length / box[long]
        if self.width:
            factor[1 - long] = self.width / box[1 - long]
        return factor


def with_looks(
    city: City, layer: str, rows: BoolArray, look: Look, size: Size | None = None
) -> City:
    """Return a city in which some instances of a layer are of a look and a size.

    Parameters
    ----------
    city
        The city.
    layer
        Of instances.
    rows
        (n,) which of them.
    look, size
        What they are of, and how large; nothing changes where nothing is said.
    """
    held, scene = city.scene.instances[layer], city.scene
    prototypes = list(scene.prototypes)
    prototype, scale, tint = held.prototype.copy(), held.scale.copy(), held.tint.copy()
    for at in np.unique(held.prototype[rows]).tolist():
        own = rows & (held.prototype == at)
        if look.suffix:
            made = dressed(prototypes[at], look)
            if made is not prototypes[at]:
                prototypes.append(made)
                prototype[own] = len(prototypes) - 1
                tint[own] = 1.0
        if size is not None and size.is_told:
            box = np.ptp(prototypes[at].mesh.vertices, axis=0)
            scale[own] = size.factors(box).astype(np.float32)
    changed = replace(held, prototype=prototype, scale=scale, tint=tint)
    return replace(city, scene=scene.with_instances(layer, prototypes, changed))


def look_of_tags(text: str) -> Look:
    """Return the look that the tags of a thing tell."""
    tags = json.loads(text or "{}")
    color = measures.color(str(tags.get("colour", tags.get("color", ""))))
    return Look(known_material(str(tags.get("material", ""))), color)


def with_tagged_looks(city: City, layer: str) -> City:
    """Return a city whose things of a layer are of the material and colour that a map tells."""
    points, held = city.layout.points, city.scene.instances.get(layer)
    told = points["tags"].str.contains(TOLD, regex=True).to_numpy(bool)
    if held is None or not told.any():
        return city
    ids, tags = points["id"].to_numpy(np.uint64)[told], points["tags"].to_numpy(object)[told]
    looks = {number: look_of_tags(text) for number, text in zip(ids.tolist(), tags, strict=True)}
    for look in sorted(set(looks.values()), key=lambda one: one.suffix):
        if look.material or look.color != NO_COLOR:
            own = np.array([number for number, one in looks.items() if one == look], np.uint64)
            city = with_looks(city, layer, np.isin(held.object_id, own), look)
    return city
