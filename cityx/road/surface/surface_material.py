"""Materials of road surfaces: made from a road mesh, by hand or as the map says of each street."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import replace
from types import MappingProxyType
from typing import Annotated, Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.assets.styles.materials import state_of
from cityx.city.city import City
from cityx.city.ground import LABEL
from cityx.city.layout import Layout
from cityx.city.mesh import NO_VERTEX, MeshBatch
from cityx.errors import UsageError
from cityx.geometry.arrays import BoolArray, IntArray
from cityx.ground.ground_looks import with_ground_looks
from cityx.ids import stable_id
from cityx.protocol import Choice, ObjectName, Port, Range, Text, action, has_ground
from cityx.protocol.objects import find_object

MAPPED = "as_mapped"
LEVEL = 0.7  # least upward part of the normal of a face one drives on: 45 degrees
USUAL_AGE, LITTLE = 0.5, 0.25  # age and wear where nothing is known of them
NEAR = 15.0  # metres from a face of a deck to the middle of its street at most
DRIVEN = ("carriageway", "setts", "gravel_road")
ALL_DRIVEN = (*DRIVEN, "junction")
# OpenStreetMap's surface=* to the material, where the usual one of the label is not it.
FAMILIES: Mapping[str, str] = MappingProxyType(
    {
        "asphalt": "asphalt", "paved": "asphalt", "chipseal": "asphalt",
        "concrete": "road_concrete", "concrete:plates": "road_concrete",
        "concrete:lanes": "road_concrete", "cement": "road_concrete",
        "sett": "setts", "cobblestone:flattened": "setts", "stone": "setts",
        "cobblestone": "cobbles", "unhewn_cobblestone": "cobbles", "pebblestone": "cobbles",
        "paving_stones": "pavers", "paving_stones:lanes": "pavers", "bricks": "clinker",
        "brick": "clinker", "gravel": "gravel", "fine_gravel": "gravel", "compacted": "gravel",
        "unpaved": "gravel", "ground": "soil", "dirt": "soil", "earth": "soil", "mud": "soil",
    }
)  # fmt: skip
# OpenStreetMap's smoothness=* as wear.
WEAR: Mapping[str, float] = MappingProxyType(
    {
        "excellent": 0.0, "good": 0.25, "intermediate": 0.5, "bad": 0.75, "very_bad": 1.0,
        "horrible": 1.0, "very_horrible": 1.0, "impassable": 1.0,
    }
)  # fmt: skip
STYLES: Mapping[tuple[str, str], str] = MappingProxyType(
    {
        ("asphalt", "light"): "asphalt_light", ("asphalt", "red"): "asphalt_red",
        ("paving_stones", "slabs"): "paving", ("sett", "round"): "cobbles",
    }
)  # fmt: skip
WORDS = ("asphalt", "concrete", "sett", "cobblestone", "paving_stones", "bricks", "gravel",
         "ground")  # fmt: skip
USUAL = ("", "asphalt", "paved", "sett", "gravel")  # words that the ground has told apart already


@action(
    "road/surface_material-v1",
    limits=[
        "Where the map says neither smoothness nor a special surface the usual material stays.",
        "Age, wear and wetness have five steps each.",
    ],
    requires=("layout", has_ground()),
    takes=(Port("mesh", "complex_geometry", role="ground"),),
    gives=(Port("material", "texture_material", role="road_surface"),),
    labels=("asphalt", "cobblestone", "brick", "concrete", "gravel", "pave", "worn", "pothole"),
)
def surface_material(
    city: City,
    *,
    layer: Annotated[str, Text(60)] = "ground",
    street: Annotated[str | None, ObjectName()] = None,
    surface: Annotated[str, Choice(MAPPED, *WORDS)] = MAPPED,
    style: Annotated[str, Choice("usual", "light", "red", "slabs", "round")] = "usual",
    age: Annotated[float | None, Range(0.0, 1.0)] = None,
    wear: Annotated[float | None, Range(0.0, 1.0)] = None,
    wetness: Annotated[float, Range(0.0, 1.0)] = 0.0,
) -> City:
    """Give the carriageways of a layer a surface: one for all, or what the map says of each street.

    Parameters
    ----------
    city
        City with its ground.
    layer
        Layer of meshes: the ground, "decks" of bridges, or any other, whose upward faces count.
    street
        The one street to surface; all when left out.
    surface
        What it is made of, in OpenStreetMap's words.
    style
        Another make of the surface: light or red asphalt, slabs of stone, round setts.
    age
        0 for new to 1 for decades old.
    wear
        0 for untouched to 1 for worn out.
    wetness
        0 for dry to 1 for a film of water, whatever the weather.
    """
    mesh = city.scene.meshes.get(layer)
    if mesh is None:
        raise UsageError(f'There is no layer "{layer}"; there are {sorted(city.scene.meshes)}.')
    family = family_of(surface, style) if surface != MAPPED or style != "usual" else ""
    faces, road = road_faces(city, mesh, layer, junctions=bool(family) and street is None)
    if street is not None:
        chosen = road == np.uint64(find_object(city, street) or 0)
        faces, road = faces[chosen], road[chosen]
    if family:
        name = state_of(family, age=_or(age, USUAL_AGE), wear=_or(wear, 0.0), wetness=wetness)
        names = np.full(len(faces), name, object)
    else:
        ids, index = np.unique(road, return_inverse=True)
        of_road = _mapped(city.layout, ids, age, wear, wetness)
        names = np.array(of_road, object)[index] if len(ids) else np.zeros(0, object)
    made = surfaced(mesh, faces, names, level=layer != "ground")
    city = replace(city, scene=city.scene.with_mesh(layer, made))
    if layer != "ground" or family or street is not None:
        return city
    city = with_ground_looks(city)
    if "decks" in city.scene.meshes:
        return surface_material(city, layer="decks", age=age, wear=wear, wetness=wetness)
    return city


def _or(value: float | None, usual: float) -> float:
    return usual if value is None else value


def family_of(surface: str, style: str = "usual") -> str:
    """Return the material of a surface in a style.

    Raises
    ------
    UsageError
        If the surface is not made in that style.
    """
    if style == "usual":
        return FAMILIES[surface]
    if (surface, style) not in STYLES:
        known = ", ".join(f"{word} {make}" for word, make in STYLES)
        raise UsageError(f'There is no surface "{surface}" in style "{style}"; there are {known}.')
    return STYLES[surface, style]


def road_faces(
    city: City, mesh: MeshBatch, layer: str, *, junctions: bool
) -> tuple[IntArray, NDArray[np.uint64]]:
    """Return the faces one drives on and the road, or junction, that each belongs to."""
    if layer != "ground":
        faces = np.flatnonzero(_upward(mesh))
        return faces, _nearest_roads(city.layout, mesh, faces)
    ground = city.ground
    assert ground is not None
    label = ground.face_label[ground.triangle_face]
    rows, roads = [], []
    for name in ALL_DRIVEN if junctions else DRIVEN:
        own = np.flatnonzero(mesh.object_id == np.uint64(stable_id("ground", name)))
        triangles = np.flatnonzero(label == LABEL[name])
        if len(own) and len(triangles):  # tops come first, in the order of the ground's triangles
            rows.append(mesh.face_start[own[0]] + np.arange(len(triangles)))
            roads.append(ground.face_object[ground.triangle_face[triangles]])
    none = np.zeros(0, np.int64)
    faces, road = np.concatenate([none, *rows]), np.concatenate([none.astype(np.uint64), *roads])
    return faces[road > 0], road[road > 0]  # gutters and beds of trams belong to no road


def _upward(mesh: MeshBatch) -> BoolArray:
    """(f,) whether one could drive on a face."""
    a, b, c = (mesh.vertices[mesh.faces[:, corner]] for corner in range(3))
    normal = np.cross(b - a, c - a)
    size = np.linalg.norm(normal, axis=1)
    return np.asarray(normal[:, 2] > LEVEL * np.maximum(size, 1e-12))


def _nearest_roads(layout: Layout, mesh: MeshBatch, faces: IntArray) -> NDArray[np.uint64]:
    """(k,) id of the road nearest to each face, 0 where none is near."""
    middle = mesh.vertices[mesh.faces[faces, :3]].mean(axis=1)[:, :2]
    found = np.zeros(len(faces), np.uint64)
    lines = layout.roads.geometry.to_numpy()
    if len(lines) and len(faces):
        row, line = shapely.STRtree(lines).query_nearest(
            shapely.points(middle), max_distance=NEAR, all_matches=False
        )
        found[row] = layout.roads["id"].to_numpy()[line]
    return found


def _mapped(
    layout: Layout, ids: NDArray[np.uint64], age: float | None, wear: float | None, wetness: float
) -> list[str]:
    """Return the material of each road by its tags, "" where the usual one stays."""
    roads = layout.roads
    rows = roads[roads["id"].isin(ids)]
    columns = (rows[name].tolist() for name in ("id", "tags", "surface"))
    known = {
        number: (json.loads(text or "{}"), word)
        for number, text, word in zip(*columns, strict=True)
    }
    forced = age is not None or wear is not None or wetness > 0
    names = []
    for number in ids.tolist():
        tags, resolved = known.get(number, ({}, ""))
        surface, worn = str(tags.get("surface", "")), WEAR.get(str(tags.get("smoothness")))
        special = surface in FAMILIES and surface not in USUAL
        family = FAMILIES.get(surface) or FAMILIES.get(resolved)
        if family is None or not (special or forced or worn is not None):
            names.append("")
            continue
        wear_of = _or(wear, _or(worn, LITTLE))
        names.append(state_of(family, age=_or(age, USUAL_AGE), wear=wear_of, wetness=wetness))
    return names


def surfaced(mesh: MeshBatch, faces: IntArray, names: Any, *, level: bool = True) -> MeshBatch:
    """Return a mesh some of whose faces have other materials.

    Parameters
    ----------
    mesh
        Any mesh.
    faces
        (k,) int, faces to change.
    names
        (k,) materials by name, "" for those that stay as they are.
    level
        Whether the pattern is to be laid out in plan, for meshes without texture coordinates.
    """
    names = np.broadcast_to(np.asarray(names, object), len(faces))
    changed = names != ""
    faces, names = faces[changed], names[changed]
    if not len(faces):
        return mesh
    known, index = np.unique(names.astype(str), return_inverse=True)
    table = list(dict.fromkeys([*mesh.materials, *known.tolist()]))
    material, uv = mesh.material.copy(), mesh.uv.copy()
    material[faces] = np.array([table.index(name) for name in known], np.int16)[index]
    if level:
        corners = mesh.faces[faces]
        uv[faces] = np.where((corners == NO_VERTEX)[..., None], 0, mesh.vertices[corners, :2])
    return replace(mesh, material=material, materials=tuple(table), uv=uv)
