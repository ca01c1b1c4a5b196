"""Dressing: all things of a kind are of a material, a colour and a size."""

from __future__ import annotations

import json
from dataclasses import replace
from typing import Annotated, Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.assets.furniture.dressed import GROUND, NO_COLOR, THINGS, Look, stuff_of
from cityx.checks.predicates.measuring import things_of
from cityx.checks.predicates.vocabulary import KINDS
from cityx.city import City
from cityx.city.mesh import MeshBatch
from cityx.errors import ActionFailed, UsageError
from cityx.geometry.arrays import BoolArray
from cityx.ground.ground_looks import ASKED, with_ground_looks
from cityx.ids import UInt64Array
from cityx.nature.furniture.tagged_looks import LARGEST, SMALLEST, Size, with_looks
from cityx.nature.land.parks import court_id
from cityx.protocol import Choice, Color, Port, Range, action
from cityx.town.elements import ELEMENTS, OTHER_THINGS, SCALE_OF, attributes_of, looked_at

MATERIALS = ("usual", *dict.fromkeys((*THINGS, *GROUND)))
DRESSED = tuple(
    kind for kind in (*ELEMENTS, *OTHER_THINGS)
    if attributes_of(kind) and not looked_at(kind).startswith("building")
)  # fmt: skip
COURTS, MOST_COURTS = "courts", 24  # layer of the surfaces of courts; how many a pitch has
MOST_TURNS = 12  # looks of one kind of things
TOWERS = {"city_wall": "wall_tower"}  # what stands in a line and looks as it does
AROUND = 1.0  # metres from the deck of a bridge to what carries it


@action(
    "edit/dress-v1",
    limits=[
        "What a thing mainly is of changes; panes, lamps, signs and water stay.",
        "Things are between a quarter and six times as large as usual.",
    ],
    after=(
        "nature/furniture-v1",
        "nature/street_pieces-v1",
        "nature/parks-v1",
        "nature/barriers-v1",
        "nature/shores-v1",
        "road/guard_rails-v1",
        "edit/ring-v1",
    ),
    takes=(Port("object", "complex_geometry"),),
    gives=(Port("object", "complex_geometry"),),
    labels=("material", "color", "colour", "height", "bronze", "wooden", "steel", "painted"),
)
def dress(
    city: City,
    *,
    kind: Annotated[str, Choice(*DRESSED)],
    material: Annotated[str, Choice(*MATERIALS)] = "usual",
    color: Annotated[int, Color(), Range(-1, 0xFFFFFF)] = NO_COLOR,
    height: Annotated[float, Range(0.0, 400.0)] = 0.0,
    length: Annotated[float, Range(0.0, 400.0)] = 0.0,
    width: Annotated[float, Range(0.0, 400.0)] = 0.0,
    size: Annotated[str, Choice("usual", *SCALE_OF)] = "usual",
    turn: Annotated[int, Range(0, MOST_TURNS)] = 0,
    turns: Annotated[int, Range(1, MOST_TURNS)] = 1,
) -> City:
    """Give all things of a kind a material, a colour and a size.

    Parameters
    ----------
    city
        The city.
    kind
        Things that stand about, land, walls or bridges.
    material
        What they mainly are of, or what land is paved with.
    color
        0xRRGGBB, sRGB; -1 for that of the material.
    height, length, width
        Metres of things that stand about, 0 for usual ones.
    size
        Of things that stand about.
    turn, turns
        Where several looks take turns: the number of this one, from 0, and how many there are.
    """
    word = "" if material == "usual" else material
    chosen = things_of(looked_at(kind), city)
    named = kind.replace("_", " ")
    if not len(chosen.rows):
        raise ActionFailed(f"The city has no {named} that could be dressed.")
    if turns > 1:
        place = np.argsort(np.argsort(chosen.ids, kind="stable"), kind="stable")
        chosen = chosen.where(place % turns == turn % turns)
    family = KINDS[chosen.layer.kind]
    known = GROUND if family == "land" else THINGS
    if word and word not in known:
        raise UsageError(f"A {named} is not of {word}; it may be of {', '.join(known)}.")
    if family in ("piece", "lamp"):
        told = Size(height, length, width, SCALE_OF.get(size, 1.0))
        return _things(city, chosen.ids, Look(word, color), told, named)
    if not (word or color >= 0):
        return city
    if family == "land":
        return _land(city, chosen.layer.members(chosen.rows), word, color)
    if family == "line":
        towers = things_of(TOWERS[kind], city).ids if kind in TOWERS else np.zeros(0, np.uint64)
        city = _things(city, towers, Look(word, color), Size(), named)
        return _lines(city, chosen.ids, Look(word, color))
    return _bridges(city, chosen.grounds, Look(word, color))


def _things(city: City, ids: UInt64Array, look: Look, size: Size, named: str) -> City:
    notes = city.notes
    for layer, rows in city.scene.instances.items():
        mine = np.isin(rows.object_id, ids)
        if not mine.any():
            continue
        for at in np.unique(rows.prototype[mine]).tolist():
            box = np.ptp(city.scene.prototypes[at].mesh.vertices, axis=0)
            if size.is_beyond(box):
                usual = " x ".join(f"{side:.1f}" for side in box.tolist())
                notes += (
                    f"A {named} is {SMALLEST:g} to {LARGEST:g} times as large as usual at most; "
                    f"it usually measures {usual} m.",
                )
        city = with_looks(city, layer, mine, look, size)
    points = _tagged(city.layout.points, ids, look)
    layout = replace(city.layout, points=points)
    return replace(city, layout=layout, notes=tuple(dict.fromkeys(notes)))


def _tagged(table: Any, ids: UInt64Array, look: Look, key: str = "material") -> Any:
    """Return a table of the layout whose rows of some ids say what they are of."""
    mine = np.isin(table["id"].to_numpy(np.uint64), ids)
    told = {key: look.material} if look.material else {}
    told |= {"colour": f"#{look.color:06x}"} if look.color >= 0 else {}
    if not mine.any() or not told:
        return table
    tags = table["tags"].to_numpy(object).copy()
    for row in np.flatnonzero(mine).tolist():
        tags[row] = json.dumps({**json.loads(tags[row] or "{}"), **told})
    return table.assign(tags=tags.astype(str))


def _land(city: City, ids: UInt64Array, material: str, color: int) -> City:
    areas = _tagged(city.layout.areas, ids, Look(material, color), "surface")
    areas = _tagged(areas, ids, Look(material), ASKED)
    city = with_ground_looks(replace(city, layout=replace(city.layout, areas=areas)), ids)
    courts = [court_id(area, number) for area in ids.tolist() for number in range(MOST_COURTS)]
    mesh = city.scene.meshes.get(COURTS)
    if mesh is None or color < 0:
        return city
    mine = np.isin(mesh.object_id, np.array(courts, np.uint64))[mesh.face_object()]
    painted = _faced(mesh, mine, Look(color=color))
    return replace(city, scene=city.scene.with_mesh(COURTS, painted))


def _lines(city: City, ids: UInt64Array, look: Look) -> City:
    lines = _tagged(city.layout.lines, ids, look)
    city = replace(city, layout=replace(city.layout, lines=lines))
    mesh = city.scene.meshes.get("barriers")
    if mesh is None:
        return city
    mine = np.isin(mesh.object_id, ids)[mesh.face_object()]
    return replace(city, scene=city.scene.with_mesh("barriers", _faced(mesh, mine, look)))


def _bridges(city: City, decks: NDArray[Any], look: Look) -> City:
    mesh = city.scene.meshes.get("structures")
    if mesh is None:
        raise ActionFailed("The city has no bridge whose piers and parapets could be dressed.")
    found = _faced(mesh, faces_at(mesh, decks), look)
    return replace(city, scene=city.scene.with_mesh("structures", found))


def faces_at(mesh: MeshBatch, decks: NDArray[Any]) -> BoolArray:
    """(f,) whether faces of a mesh carry or edge the decks of bridges, as polygons."""
    middle = mesh.vertices[mesh.faces[:, :3]].mean(axis=1)
    area = shapely.buffer(shapely.union_all(decks), AROUND)
    shapely.prepare(area)
    return np.asarray(shapely.contains_xy(area, middle[:, 0], middle[:, 1]))


def _faced(mesh: MeshBatch, faces: BoolArray, look: Look) -> MeshBatch:
    """Return a mesh some of whose faces are of a look."""
    if not faces.any():
        return mesh
    usual = mesh.materials[int(np.bincount(mesh.material[faces]).argmax())]
    stuff = stuff_of(look.material, look.color, THINGS, usual)
    table = tuple(dict.fromkeys((*mesh.materials, stuff.material)))
    material, tint = mesh.material.copy(), mesh.tint.copy()
    material[faces] = table.index(stuff.material)
    tint[faces] = np.asarray(stuff.tint, np.float32)
    return replace(mesh, material=material, materials=table, tint=tint)
