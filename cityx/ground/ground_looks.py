"""Looks of ground: what areas are paved with, and in which colour, as their tags say."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import replace
from types import MappingProxyType

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.assets.furniture.dressed import (
    GROUND,
    NO_COLOR,
    Stuff,
    known_material,
    plain_word,
    stuff_of,
)
from cityx.city import City
from cityx.city.ground import LABEL, SURFACES, UNDRAPED
from cityx.city.mesh import NO_VERTEX, MeshBatch
from cityx.geometry.arrays import FloatArray, IntArray
from cityx.ids import UInt64Array, stable_id
from cityx.sources.features import measures

# Kinds of areas whose surface is told; of others a map means what grows or is parked there.
PAVED = ("pedestrian", "parking", "pitch", "playground", "pier", "bare", "road_area")
ASKED = "cityx:surface"  # tag of an area with what somebody wants it paved with
# Plain words of a map that say no more of an area than what is built there anyway.
_SAYS_NO_MORE: Mapping[str, tuple[str, ...]] = MappingProxyType(
    {"pedestrian": ("pavers", "paved", "asphalt"), "parking": ("asphalt", "paved")}
)
# Labels of faces that are no paving.
_OTHER = ("water", "building", "marking", "marking_yellow", "kerb", "kerb_dropped", "rail",
          "tramway", "bed", "tactile", "tactile_pale", "tactile_buff", "tactile_red")  # fmt: skip


def area_faces(city: City, mesh: MeshBatch, ids: UInt64Array) -> tuple[IntArray, UInt64Array]:
    """Return the faces of the ground that areas are paved with, and the area of each.

    Lots where buildings stood belong to the smallest area round them.

    Parameters
    ----------
    city
        City with its ground.
    mesh
        The layer "ground".
    ids
        Of areas.

    Returns
    -------
    faces, owner
        (k,) faces of the mesh and (k,) ids; triangles of the ground that the mesh lacks are left
        out.
    """
    ground = city.ground
    none = np.zeros(0, np.int64), np.zeros(0, np.uint64)
    if ground is None:
        return none
    top = mesh.faces[:, 3] == NO_VERTEX
    surface_of = mesh.object_id[mesh.face_object()]
    owner = ground.face_object[ground.triangle_face]
    label = ground.face_label[ground.triangle_face]
    mine = np.isin(owner, ids)
    rows, owners = [none[0]], [none[1]]
    for surface in SURFACES:
        if surface.name in (*UNDRAPED, *_OTHER):
            continue
        triangles = np.flatnonzero(label == LABEL[surface.name])
        chosen = np.flatnonzero(mine[triangles])
        if not len(chosen):
            continue
        chosen = triangles[chosen]
        own = np.flatnonzero(top & (surface_of == np.uint64(stable_id("ground", surface.name))))
        _, at, held = np.intersect1d(
            _place(ground.vertices[ground.triangles[chosen]]),
            _place(mesh.vertices[mesh.faces[own, :3], :2]),
            return_indices=True,
        )
        rows.append(own[held])
        owners.append(owner[chosen[at]])
    known = np.array([stable_id("ground", surface.name) for surface in SURFACES], np.uint64)
    lots = np.flatnonzero(top & ~np.isin(surface_of, known))
    around = _area_round(city, mesh.vertices[mesh.faces[lots, :3], :2].mean(axis=1))
    mine = np.isin(around, ids)
    return np.concatenate([*rows, lots[mine]]), np.concatenate([*owners, around[mine]])


def _place(corners: FloatArray) -> NDArray[np.complex128]:
    """Return by what triangles (n, 3, 2) are told apart, (n,): three times the middle, in mm."""
    x, y = np.round(corners.sum(axis=1), 3).T
    return np.asarray(x + 1j * y)


def _area_round(city: City, spots: FloatArray) -> UInt64Array:
    """Return the id of the smallest area that each of (n, 2) spots lies in, (n,), 0 for none."""
    areas = city.layout.areas
    found = np.zeros(len(spots), np.uint64)
    if len(spots) and len(areas):
        shapes = areas.geometry.to_numpy()
        spot, row = shapely.STRtree(shapes).query(shapely.points(spots), predicate="within")
        order = np.argsort(-shapely.area(shapes[row]), kind="stable")
        found[spot[order]] = areas["id"].to_numpy(np.uint64)[row[order]]  # the smallest comes last
    return found


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
        '"(?:surface|cityx:surface|colour|color|material)"', regex=True
    ).to_numpy(bool)
    if ids is not None:
        rows &= np.isin(areas["id"].to_numpy(np.uint64), ids)
    found = {}
    columns = (areas[name].to_numpy()[rows].tolist() for name in ("id", "kind", "tags"))
    for number, kind, text in zip(*columns, strict=True):
        tags = json.loads(text or "{}")
        said = [str(tags.get(key, "")) for key in ("surface", "material")]
        said = [word for word in said if plain_word(word) not in _SAYS_NO_MORE.get(kind, ())]
        said.insert(0, str(tags.get(ASKED, "")))
        surface = next((one for word in said if (one := known_material(word, GROUND))), "")
        color = measures.color(str(tags.get("colour", tags.get("color", ""))))
        if color != NO_COLOR or surface:
            found[int(number)] = (surface, color)
    return found
