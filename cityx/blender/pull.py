"""What an artist changed: ``python -m cityx.blender.pull JOB.json``.

Opens a .blend without running anything in it, compares every object with the stored city that it
shows, and writes the differences to the file that the job names. Nothing is decided here: see
`cityx.projects.pull`.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

import bpy
import numpy as np
from numpy.typing import NDArray

from cityx.assets.styles.materials import material_named
from cityx.blender.curves import lines_of, opened, world_of
from cityx.blender.scene import (
    ID,
    LAYER,
    MAX_OBJECTS,
    NAME,
    OBJECT_LAYERS,
    SCENE,
    Tile,
    encoded,
    tiles_of,
)
from cityx.city.content import scene_key
from cityx.city.mesh import MeshBatch, feet
from cityx.city.scene import Instances
from cityx.geometry.arrays import FloatArray
from cityx.geometry.turns import euler_of, matrices
from cityx.ids import id_text
from cityx.system.parents import end_with_parent

if TYPE_CHECKING:
    from cityx.city.store import View

NEAR = 1e-3  # metres; float32 is exact to less within 8 km
EQUAL = 1e-4  # of turns, in radians, and of factors
SHADE = 2.5 / 255  # of a colour's channel; stored colours are bytes
WHITE = (1.0, 1.0, 1.0)
CURVES = "cityx_curves"  # property of a scene: names of the artist's curves that came into it
REMOVABLE = OBJECT_LAYERS | {"barriers"}  # land, streets and bridges are one piece each
# What an artist sees of a city, and cannot lose: cameras and lights are tools, not objects.
TOOLS = frozenset({"CAMERA", "LIGHT", "LIGHT_PROBE", "SPEAKER", "EMPTY"})


class Differences:
    """The changes found so far; a class because they add up."""

    def __init__(self) -> None:
        self.moved: list[dict[str, Any]] = []
        self.copied: list[dict[str, Any]] = []
        self.removed: list[str] = []
        self.painted: list[dict[str, Any]] = []
        self.untaken: list[str] = []
        self.drawn: list[dict[str, Any]] = []
        self.erased: list[str] = []

    def pose(self, object_id: int, change: FloatArray, scale: FloatArray, *, copy: bool) -> None:
        """Add a move, if it is one: a rigid change (4, 4) about the foot, and factors."""
        move, turn = change[:3, 3], euler_of(change[None, :3, :3])[0]
        still = np.abs(move).max() < NEAR * max(1.0, float(np.abs(move).max()) * 1e-4)
        if still and np.abs(turn).max() < EQUAL and np.abs(scale - 1).max() < EQUAL and not copy:
            return
        record = {
            "id": id_text(object_id),
            "move": np.where(np.abs(move) < NEAR, 0.0, move).round(4).tolist(),
            "turn": np.where(np.abs(turn) < EQUAL, 0.0, turn).round(6).tolist(),
            "factor": np.where(np.abs(scale - 1) < EQUAL, 1.0, scale).round(5).tolist(),
        }
        (self.copied if copy else self.moved).append(record)

    def paint(self, object_id: int, surface: str, tint: FloatArray) -> None:
        """Add a colour."""
        color = np.clip(tint, 0.0, 1.0).round(4).tolist()
        self.painted.append({"id": id_text(object_id), "surface": surface, "tint": color})


def compare(view: View, scene: bpy.types.Scene) -> dict[str, Any]:
    """Compare a scene of the open file with the city it shows; returns what differs."""
    found = Differences()
    shown = {item.as_pointer(): item for item in scene.objects}.values()
    names = {item.name for item in shown}
    known: dict[str, list[bpy.types.Object]] = {}
    foreign = []
    for item in shown:
        if LAYER in item:
            known.setdefault(str(item[LAYER]), []).append(item)
        elif item.type not in TOOLS and item.get(NAME, "") in {"", *names} - {item.name}:
            foreign.append({"name": item.name, "type": item.type.lower()})
            _draw(item, scene.unit_settings.scale_length, found)
    found.erased = sorted({*json.loads(scene.get(CURVES, "[]"))} - names)
    for layer, batch in view.scene.meshes.items():
        items = known.pop(layer, [])
        own = layer in OBJECT_LAYERS and batch.count <= MAX_OBJECTS and view.lod > 0
        (_compare_shells if own else _compare_tiles)(layer, batch, items, found)
    for layer, rows in view.scene.instances.items():
        if rows.count:
            _compare_rows(rows, known.pop(layer, []), found)
    foreign += [{"name": i.name, "type": "object"} for items in known.values() for i in items]
    return {**vars(found), "foreign": sorted(foreign, key=lambda item: item["name"])}


def _draw(item: bpy.types.Object, metres: float, found: Differences) -> None:
    """Take the line of an artist's own curve, if it is one that somebody may go along."""
    if item.type == "CURVE":
        lines = lines_of(item, metres)
        if len(lines) == 1:
            found.drawn.append({"name": item.name, "points": lines[0]})
        else:
            found.untaken.append(f"{item.name}: a curve of {len(lines)} lines; a path is one")


def _parts(matrix: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Split an affine matrix into a rigid one, (4, 4), and the factors along its own axes."""
    scale = np.linalg.norm(matrix[:3, :3], axis=0)
    rigid = matrix.copy()
    rigid[:3, :3] = matrix[:3, :3] / np.maximum(scale, 1e-9)
    return rigid, scale


# --- shells ---------------------------------------------------------------------------------------


def _compare_shells(
    layer: str, batch: MeshBatch, items: list[bpy.types.Object], found: Differences
) -> None:
    """Compare objects of their own, such as buildings."""
    foot = feet(batch).astype(np.float32).astype(float)
    held: dict[str, list[bpy.types.Object]] = {}
    for item in items:
        held.setdefault(str(item.get(ID, "")), []).append(item)
    for row in np.flatnonzero(np.diff(batch.vertex_start) > 0).tolist():
        object_id = int(batch.object_id[row])
        mine = held.pop(id_text(object_id), [])
        if not mine:
            found.removed.append(id_text(object_id))
        mine.sort(key=lambda item: (item.get(NAME) != item.name, item.name))
        for place, item in enumerate(mine):
            rigid, scale = _parts(world_of(item))
            rigid[:3, 3] -= foot[row]
            found.pose(object_id, _upright(rigid, item, found), scale, copy=place > 0)
        if mine:
            _compare_faces(batch, row, foot[row], mine[0], found)
    for items in held.values():
        names = ", ".join(item.name for item in items)
        found.untaken.append(f"{names}: an object of the layer {layer} without an id of it")


def _upright(rigid: FloatArray, item: bpy.types.Object, found: Differences) -> FloatArray:
    """Return a change without what of its turn is not about the vertical; that is told."""
    angles = euler_of(rigid[None, :3, :3])[0]
    if np.abs(angles[:2]).max() > EQUAL:
        found.untaken.append(f"{item.name}: it leans; what is built turns about the vertical only")
    level = rigid.copy()
    level[:3, :3] = matrices([[0.0, 0.0, angles[2]]])[0]
    return level


def _compare_faces(
    batch: MeshBatch, row: int, foot: FloatArray, item: bpy.types.Object, found: Differences
) -> None:
    """Compare form and colours of one shell."""
    object_id = int(batch.object_id[row])
    vertices = slice(*batch.vertex_start[row : row + 2].tolist())
    faces = slice(*batch.face_start[row : row + 2].tolist())
    expected = (batch.vertices[vertices] - foot).astype(np.float32)
    positions = _attribute(item.data, "position", 3)
    tint = _attribute(item.data, "tint", 4, "color_srgb")
    if positions is None or tint is None or len(positions) != len(expected):
        found.untaken.append(f"{item.name}: its mesh has other corners or faces now")
        return
    if np.abs(positions - expected).max() > NEAR:
        found.untaken.append(f"{item.name}: its mesh was reshaped")
    if len(tint) != faces.stop - faces.start:
        found.untaken.append(f"{item.name}: its mesh has other corners or faces now")
        return
    material = batch.material[faces]
    changed = np.abs(tint - encoded(batch.tint[faces])).max(axis=1) > SHADE
    for number in np.unique(material[changed]).tolist():
        color = _linear(tint[changed & (material == number), :3]).mean(axis=0)
        found.paint(object_id, batch.materials[number], color)
    slots = np.unique(material).tolist()
    for number, slot in zip(slots, item.data.materials, strict=False):
        _compare_slot(object_id, batch.materials[number], slot, found)
    if np.abs(np.array(item.color[:3]) - WHITE).max() > SHADE:
        surface = _walls(batch.vertices, batch.faces[faces], material, batch.materials)
        found.paint(object_id, surface, np.array(item.color[:3]))


def _compare_slot(object_id: int, name: str, slot: Any, found: Differences) -> None:
    """Compare the material of a slot with the one it had."""
    if slot is None:
        found.untaken.append(f"{id_text(object_id)}: it has no material instead of {name}")
        return
    color = _base_color(slot)
    if color is not None:
        base = np.maximum(material_named(name).color, 1e-3)
        found.paint(object_id, name, color / base)
    elif slot.name != name:
        found.untaken.append(
            f"{id_text(object_id)}: {slot.name} instead of {name}; a material with a plain base "
            "colour would be taken for a colour"
        )


def _base_color(material: bpy.types.Material) -> FloatArray | None:
    """Return the plain base colour of a material, None where nodes make it."""
    if not material.use_nodes or material.node_tree is None:
        return np.array(material.diffuse_color[:3])
    for node in material.node_tree.nodes:
        if node.type == "BSDF_PRINCIPLED" and not node.inputs["Base Color"].is_linked:
            return np.array(node.inputs["Base Color"].default_value[:3])
    return None


def _walls(
    vertices: FloatArray, faces: NDArray[Any], material: NDArray[Any], names: tuple[str, ...]
) -> str:
    """Return the material that most of the upright faces are made of."""
    from cityx.geometry.solids import area_vectors

    area = area_vectors(vertices, faces)
    upright = np.where(np.abs(area[:, 2]) < 0.5 * np.linalg.norm(area, axis=1), 1.0, 0.0)
    share = np.bincount(material, upright * np.linalg.norm(area, axis=1), minlength=len(names))
    return names[int(np.argmax(share))]


# --- tiles ----------------------------------------------------------------------------------------


def _compare_tiles(
    layer: str, batch: MeshBatch, items: list[bpy.types.Object], found: Differences
) -> None:
    """Compare objects that are merged per tile, such as the ground."""
    by_name = {item.get(NAME, item.name): item for item in items if item.get(NAME) == item.name}
    for tile in tiles_of(layer, batch):
        item = by_name.get(tile.name)
        if item is None:
            _gone(layer, np.unique(tile.face_id), found)
            continue
        rigid, scale = _parts(world_of(item))
        rigid[:3, 3] -= tile.origin
        if np.abs(rigid - np.eye(4)).max() > NEAR or np.abs(scale - 1).max() > EQUAL:
            found.untaken.append(f"{item.name}: {layer} is one piece, which cannot be moved")
        _compare_tile(layer, tile, item, found)


def _gone(layer: str, ids: NDArray[np.uint64], found: Differences) -> None:
    """Add what is gone from a layer, if it can be."""
    if layer in REMOVABLE:
        found.removed += map(id_text, ids.tolist())
    elif len(ids):
        found.untaken.append(f"{len(ids)} surfaces of {layer} are gone, which cannot be removed")


def _compare_tile(layer: str, tile: Tile, item: bpy.types.Object, found: Differences) -> None:
    """Find the things of a tile that are gone or were moved as a whole."""
    ids, held = tile.face_id, _ids(item.data, "id")
    kept = np.isin(ids, held if held is not None else ids)
    _gone(layer, np.unique(ids[~kept]), found)
    positions = _attribute(item.data, "position", 3)
    expected = (tile.batch.vertices[tile.vertices] - tile.origin).astype(np.float32)
    if positions is None or len(positions) != len(expected):
        if kept.all():
            found.untaken.append(f"{item.name}: its mesh has other corners or faces now")
        return
    gone = positions - expected
    start = tile.batch.vertex_start[tile.objects.start : tile.objects.stop + 1]
    for number in range(len(start) - 1):
        own = gone[slice(*(start[number : number + 2] - start[0]).tolist())]
        if np.abs(own).max() < NEAR:
            continue
        object_id = int(tile.batch.object_id[tile.objects.start + number])
        if np.ptp(own, axis=0).max() > NEAR:
            found.untaken.append(f"{id_text(object_id)}: its mesh was reshaped")
            continue
        change = np.eye(4)
        change[:3, 3] = own.mean(axis=0)
        found.pose(object_id, change, np.ones(3), copy=False)


# --- instances ------------------------------------------------------------------------------------


def _compare_rows(rows: Instances, items: list[bpy.types.Object], found: Differences) -> None:
    """Compare the points that carry instances."""
    items = [item for item in items if item.get(NAME) == item.name] or items[:1]
    held = None if not items else _ids(items[0].data, "id")
    if not items:
        found.removed += map(id_text, np.unique(rows.object_id).tolist())
        return
    item, mesh = items[0], items[0].data
    columns = [_attribute(mesh, name, 3) for name in ("position", "rotation", "scale", "tint")]
    if held is None or any(column is None for column in columns):
        found.untaken.append(
            f"{item.name}: its points lost their attributes, so that nothing on them can be told"
        )
        return
    position, rotation, scale, tint = (np.asarray(c, float) for c in columns)
    position, rotation, scale = _carried(world_of(item), position, rotation, scale)
    old, copy = _matched(rows.object_id, held)
    if (old < 0).any():
        found.untaken.append(f"{item.name}: {int((old < 0).sum())} new points of no object")
    lost = np.setdiff1d(rows.object_id, held)
    found.removed += map(id_text, lost.tolist())
    known = np.flatnonzero(old >= 0)
    old = old[known]
    before = [np.asarray(c[old], np.float32) for c in (rows.position, rows.rotation, rows.scale)]
    away = np.abs(position[known] - before[0]).max(axis=1) > NEAR
    away |= np.abs(rotation[known] - before[1]).max(axis=1) > EQUAL
    away |= np.abs(scale[known] - before[2]).max(axis=1) > EQUAL
    for place in np.flatnonzero(away | copy[known]).tolist():
        change = np.eye(4)
        turn = matrices(rotation[known[place]]) @ matrices(before[1][place]).transpose(0, 2, 1)
        change[:3, :3], change[:3, 3] = turn[0], position[known[place]] - before[0][place]
        factor = scale[known[place]] / before[2][place]
        found.pose(int(held[known[place]]), change, factor, copy=bool(copy[known[place]]))
    tinted = np.abs(tint[known] - rows.tint[old]).max(axis=1) > SHADE
    for place in np.flatnonzero(tinted & ~copy[known]).tolist():
        found.paint(int(held[known[place]]), "", tint[known[place]])


def _matched(
    ids: NDArray[np.uint64], held: NDArray[np.uint64]
) -> tuple[NDArray[np.int64], NDArray[np.bool_]]:
    """Pair what is found with what there was, the k-th of an id with the k-th.

    Returns
    -------
    old
        (m,) the row that each was, or a copy's original; -1 for an id that there was not.
    copy
        (m,) whether there are more of its id than there were.
    """
    order = np.argsort(ids, kind="stable")
    ascending = ids[order]
    turn = np.argsort(held, kind="stable")
    number = np.empty(len(held), np.int64)  # of the same id, counted from 0
    number[turn] = np.arange(len(held)) - np.searchsorted(held[turn], held[turn])
    first = np.searchsorted(ascending, held)
    last = np.searchsorted(ascending, held, side="right")
    copy = (first + number >= last) & (first < last)
    at = np.where(copy, first, first + number)
    known = first < last
    return np.where(known, order[np.where(known, at, 0)], -1), copy


def _carried(
    world: FloatArray, position: FloatArray, rotation: FloatArray, scale: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return places, angles and factors as an object carries them that was itself moved."""
    if np.abs(world - np.eye(4)).max() < 1e-9:
        return position, rotation, scale
    whole = world[:3, :3] @ (matrices(rotation) * scale[:, None, :])
    size = np.linalg.norm(whole, axis=1)
    turns = whole / np.maximum(size, 1e-9)[:, None, :]
    return position @ world[:3, :3].T + world[:3, 3], euler_of(turns), size


# --- attributes -----------------------------------------------------------------------------------


def _attribute(mesh: Any, name: str, width: int, key: str = "vector") -> FloatArray | None:
    """Read an attribute, (n, width), or None where it is gone or of another kind."""
    attribute = mesh.attributes.get(name)
    if attribute is None or (len(attribute.data) and not hasattr(attribute.data[0], key)):
        return None
    values = np.zeros(len(attribute.data) * width, np.float32)
    attribute.data.foreach_get(key, values)
    return values.reshape(-1, width).astype(float)


def _ids(mesh: Any, name: str) -> NDArray[np.uint64] | None:
    """Read ids that `cityx.blender.scene` stored, or None where they are gone."""
    halves = []
    for suffix in ("low", "high"):
        attribute = mesh.attributes.get(f"{name}_{suffix}")
        if attribute is None or attribute.data_type != "INT":
            return None
        words = np.zeros(len(attribute.data), np.int32)
        attribute.data.foreach_get("value", words)
        halves.append(words.view(np.uint32).astype(np.uint64))
    return halves[1] << np.uint64(32) | halves[0]


def _linear(stored: FloatArray) -> FloatArray:
    """Decode colours as they are stored, sRGB, to linear ones."""
    return np.where(stored <= 0.04045, stored / 12.92, ((stored + 0.055) / 1.055) ** 2.4)


# --- the process ----------------------------------------------------------------------------------


def perform(job: dict[str, Any]) -> dict[str, Any]:
    """Open the file of a job and compare it."""
    from cityx.city.store import read_view

    fault = opened(Path(job["blend"]))
    if fault:
        return {"unreadable": fault}
    shown = next((s for s in bpy.data.scenes if SCENE in s), None)
    if shown is None:
        return {"unreadable": "it holds no city, or one saved by an older CityX"}
    stores = [Path(path) for path in job["stores"]]  # the newest first
    for number, store in enumerate(stores):
        view = read_view(store)
        if scene_key(view.scene) != shown[SCENE]:
            continue
        return {"state": number, **(compare(view, shown) if number == 0 else {})}
    return {"name": shown.get("cityx_name", "")}


def main(arguments: list[str]) -> int:
    """Run one job."""
    job = json.loads(Path(arguments[0]).read_text())
    end_with_parent(job["parent"])
    result = perform(job)
    target = Path(job["result"])
    temporary = target.with_suffix(".partial")
    temporary.write_text(json.dumps(result))
    temporary.replace(target)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
