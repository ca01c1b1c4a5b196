"""Looks of ground: what areas are paved with, and in which colour, as their tags say."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import replace
from types import MappingProxyType

import numpy as np

from cityx.assets.furniture.dressed import GROUND, NO_COLOR, Stuff, known_material, stuff_of
from cityx.city import City
from cityx.city.ground import LABEL, SURFACES, UNDRAPED
from cityx.city.mesh import MeshBatch
from cityx.geometry.arrays import IntArray
from cityx.ids import UInt64Array, stable_id
from cityx.sources.features import measures

# Kinds of areas whose surface is told; of others a map means what grows or is parked there.
PAVED = ("pedestrian", "parking", "pitch", "playground", "pier", "bare", "road_area")
# Words of surface=* that say no more of an area than what is built there anyway.
_SAYS_NO_MORE: Mapping[str, tuple[str, ...]] = MappingProxyType(
    {"pedestrian": ("paving_stones", "paved", "asphalt"), "parking": ("asphalt", "paved")}
)
# Labels of faces that are no paving.
_OTHER = ("water", "building", "marking", "marking_yellow", "kerb", "kerb_dropped", "rail",
          "tramway", "bed", "tactile", "tactile_pale", "tactile_buff", "tactile_red")  # fmt: skip


def area_faces(city: City, mesh: MeshBatch, ids: UInt64Array) -> tuple[IntArray, UInt64Array]:
    """Return the faces of the ground that areas are paved with, and the area of each.

    Parameters
    ----------
    city
        City with its ground.
    mesh
        The layer "ground".
    ids
        Of areas.
    """
    ground = city.ground
    none = np.zeros(0, np.int64), np.zeros(0, np.uint64)
    if ground is None:
        return none
    owner = ground.face_object[ground.triangle_face]
    label = ground.face_label[ground.triangle_face]
    mine = np.isin(owner, ids)
    rows, owners = [none[0]], [none[1]]
    for surface in SURFACES:
        if surface.name in (*UNDRAPED, *_OTHER):
            continue
        triangles = np.flatnonzero(label == LABEL[surface.name])
        chosen = np.flatnonzero(mine[triangles])
        own = np.flatnonzero(mesh.object_id == np.uint64(stable_id("ground", surface.name)))
        if len(own) and len(chosen):  # tops come first, in the order of the ground's triangles
            rows.append(mesh.face_start[own[0]] + chosen)
            owners.append(owner[triangles[chosen]])
    return np.concatenate(rows), np.concatenate(owners)


def with_ground_looks(city: City, ids: UInt64Array | None = None) -> City:
    """Return the city with areas paved and painted as their tags say.

    Parameters
    ----------
    city
        City with its ground.
    ids
        Of the areas; all that say so when left out.
    """
    mesh = city.scene.meshes.get("ground")
    told = _told(city, ids)
    if mesh is None or not told:
        return city
    known = np.array(sorted(told), np.uint64)
    faces, owner = area_faces(city, mesh, known)
    if not len(faces):
        return city
    table = list(mesh.materials)
    material, tint = mesh.material.copy(), mesh.tint.copy()
    order = np.argsort(owner, kind="stable")
    numbers, begin = np.unique(owner[order], return_index=True)
    for number, own in zip(numbers.tolist(), np.split(faces[order], begin[1:]), strict=True):
        surface, color = told[number]
        usual = mesh.materials[int(np.bincount(material[own]).argmax())]
        stuff = _stuff(surface, color, usual)
        if stuff.material not in table:
            table.append(stuff.material)
        material[own] = table.index(stuff.material)
        tint[own] = np.asarray(stuff.tint, np.float32)
    made = replace(mesh, material=material, materials=tuple(table), tint=tint)
    return replace(city, scene=city.scene.with_mesh("ground", made))


def _stuff(surface: str, color: int, usual: str) -> Stuff:
    """Return what ground is of; where only a colour is told, it is a coat on hard ground."""
    if color >= 0 and not surface:
        return stuff_of("", color, GROUND, "concrete")
    return stuff_of(surface, color, GROUND, usual)


def _told(city: City, ids: UInt64Array | None) -> Mapping[int, tuple[str, int]]:
    """Return the material and the colour of areas that tell any, by id."""
    areas = city.layout.areas
    rows = areas["kind"].isin(PAVED).to_numpy() & areas["tags"].str.contains(
        '"(?:surface|colour|color|material)"', regex=True
    ).to_numpy(bool)
    if ids is not None:
        rows &= np.isin(areas["id"].to_numpy(np.uint64), ids)
    found = {}
    columns = (areas[name].to_numpy()[rows].tolist() for name in ("id", "kind", "tags"))
    for number, kind, text in zip(*columns, strict=True):
        tags = json.loads(text or "{}")
        said = [str(tags.get(key, "")) for key in ("surface", "material")]
        said = [word for word in said if word not in _SAYS_NO_MORE.get(kind, ())]
        surface = next((one for word in said if (one := known_material(word, GROUND))), "")
        color = measures.color(str(tags.get("colour", tags.get("color", ""))))
        if color != NO_COLOR or surface:
            found[int(number)] = (surface, color)
    return found
