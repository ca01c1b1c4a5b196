"""The stage: a city at a moment, ready for rays, with tables of what each triangle belongs to.

It holds what the pictures show: shells, instances, movers at their moment, trees without leaves
under snow. It leaves out what is strewn before a camera when a picture is made and belongs to no
object of the city: blades of grass (a lawn is its level surface, which they rise above by some
centimetres), falling rain and snow, and air.

Meshes are float32 about origins of their own: exact to 0.01 mm for a building, and to 0.03 mm per
kilometre from the origin for the ground, which is one mesh.
"""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cityx.assets.colliders import kind_of
from cityx.assets.styles.materials import MATERIALS
from cityx.assets.trees.seasons import LEAF, SNOWED, sheds
from cityx.assets.vehicles.moving import PEOPLE, TRAFFIC, with_movers
from cityx.city.mesh import MeshBatch
from cityx.city.scene import Instances, Prototype, Scene
from cityx.city.tracks import Tracks
from cityx.dataset.classes import (
    CLASS,
    class_of_mover,
    class_of_piece,
    classes_of_layer,
)
from cityx.geometry.arrays import FloatArray, IntArray
from cityx.geometry.raycast import (
    Hits,
    Masks,
    RayScene,
    Shapes,
    cast,
    joined,
    placed,
    shapes_of,
    together,
)
from cityx.geometry.turns import matrices

if TYPE_CHECKING:
    from cityx.city.store import View

MOVING = (TRAFFIC, PEOPLE)
OWNERS = ("building", "car")  # classes of what has its pieces' ids
SPREAD = ("ground", "terrain")  # kinds of layers whose objects lie among each other: one mesh
KEPT = 256  # meshes of movers whose trees are kept, of some 0.2 MB each
SKY_MATERIAL = "sky"


@dataclass(frozen=True)
class CutOut:
    """Where a material is cut out: leaves on a card, the mesh of a fence.

    Attributes
    ----------
    image
        (rows, columns) bool, True where there is something; the first row is the upper one.
    tile
        Metres of texture coordinates that it covers, repeated beyond.
    """

    image: NDArray[np.bool_]
    tile: float = 1.0


@dataclass(frozen=True)
class Stage:
    """A city at a moment: n instances of meshes of t triangles in all, o objects.

    Attributes
    ----------
    view
        What it was made from, with the movers of the moment.
    moment
        Seconds since the tracks begin.
    rays
        For `cityx.geometry.raycast.cast`; instances of movers come last.
    first_mover
        First instance that moves.
    materials
        Names of materials by number; the sky is 0.
    object_id
        (o,) uint64, the City's id: of the building for its windows, of a vehicle for its wheels.
    semantic
        (o,) uint8 into `cityx.dataset.classes.CLASSES`, one for all rows of an object id.
    piece, piece_class
        (o,) uint64 and uint8, id and class of the piece itself.
    whole
        (o,) int64, the one row that stands for all rows of an object id.
    instance_object
        (n,) int64, first row of the objects of each instance.
    instance_triangle
        (n,) int64, first row of the triangles of its mesh.
    part
        (t,) int32, which object of its mesh a triangle belongs to.
    material
        (t,) uint16 into ``materials``.
    still
        The stage without movers, itself if it has none.
    tint
        (t, 3) float32, linear RGB that multiplies the colour of the material, of the triangles of
        what stands still, where tints were asked for.
    """

    view: View
    moment: float
    rays: RayScene
    first_mover: int
    materials: tuple[str, ...]
    object_id: NDArray[np.uint64]
    semantic: NDArray[np.uint8]
    piece: NDArray[np.uint64]
    piece_class: NDArray[np.uint8]
    whole: IntArray
    instance_object: IntArray
    instance_triangle: IntArray
    part: NDArray[np.int32]
    material: NDArray[np.uint16]
    still: Stage | None
    tint: NDArray[np.float32] | None = None

    @cached_property
    def outlines(self) -> dict[int, FloatArray]:
        """Points around meshes by first triangle, as far as somebody asked for them."""
        return {}

    def cast(
        self, origins: ArrayLike, directions: ArrayLike, *, reach: ArrayLike = np.inf,
        threads: int | None = None,
    ) -> Hits:  # fmt: skip
        """Return what rays meet first; see `cityx.geometry.raycast.cast`."""
        return cast(self.rays, origins, directions, reach=reach, threads=threads)

    def rows(self, hits: Hits) -> IntArray:
        """Return the (r,) row of the object that each ray met, -1 for the sky."""
        met = hits.instance >= 0
        triangle = self.instance_triangle[hits.instance] + hits.triangle
        found = self.instance_object[hits.instance] + self.part[np.where(met, triangle, 0)]
        return np.where(met, found, -1)

    def materials_at(self, hits: Hits) -> NDArray[np.uint16]:
        """Return the (r,) number of the material of each face that was met, 0 for the sky."""
        met = hits.instance >= 0
        triangle = self.instance_triangle[hits.instance] + hits.triangle
        return np.where(met, self.material[np.where(met, triangle, 0)], 0).astype(np.uint16)


def stage_of(
    view: View,
    moment: float | None = None,
    *,
    still: Stage | None = None,
    cut_outs: Mapping[str, CutOut] | None = None,
    tints: bool = False,
) -> Stage:
    """Prepare a city for rays.

    Parameters
    ----------
    view
        The city, in the light in which it is shown: under snow trees stand bare.
    moment
        Seconds since the tracks begin; the city's own when left out.
    still
        A stage of the same city, of which all that does not move is taken over.
    cut_outs
        By the name of a material, where it lets rays through. None of the materials of CityX
        does: their leaves, railings and fences are cut in the mesh. Panes count as themselves.
    tints
        Whether the tints of triangles are wanted.
    """
    shown = view.moment if moment is None else moment
    view = replace(view, moment=shown, scene=_without_movers(view.scene))
    bare = view.environment.snow > SNOWED
    base = still.still or still if still is not None else None
    if base is None or (base.view.environment.snow > SNOWED) != bare:
        base = _still(view, bare, cut_outs or {}, tints)
    moved = with_movers(view)
    if moved is view:
        return replace(base, view=view, moment=shown)
    return _with_movers(base, moved)


def _without_movers(scene: Scene) -> Scene:
    kept = {layer: rows for layer, rows in scene.instances.items() if layer not in MOVING}
    return scene if len(kept) == len(scene.instances) else replace(scene, instances=kept)


# --- what stands still ----------------------------------------------------------------------------


class _Meshes:
    """Meshes in the making; a class because their arrays and tables gather together."""

    def __init__(
        self, numbers: Mapping[str, int], cut_outs: Mapping[str, CutOut], tints: bool
    ) -> None:
        self.numbers, self.cut_outs, self.tints = numbers, cut_outs, tints
        self.vertices: list[FloatArray] = []
        self.triangles: list[NDArray[np.int32]] = []
        self.part: list[NDArray[np.int32]] = []
        self.material: list[NDArray[np.uint16]] = []
        self.uv: list[NDArray[np.float32]] = []
        self.tint: list[NDArray[np.float32]] = []

    def add(
        self, points: FloatArray, triangles: NDArray[np.int32], part: NDArray[np.int32],
        batch: MeshBatch, face: IntArray,
    ) -> int:  # fmt: skip
        """Add a mesh of some faces of a batch; returns its number."""
        table = np.array([self.numbers[name] for name in batch.materials], np.uint16)
        self.vertices.append(points)
        self.triangles.append(triangles)
        self.part.append(part)
        self.material.append(table[batch.material[face]] if len(face) else np.zeros(0, np.uint16))
        if self.cut_outs:
            self.uv.append(_triangle_uv(batch, triangles, face))
        if self.tints:
            self.tint.append(np.asarray(batch.tint[face], np.float32))
        return len(self.vertices) - 1

    def masks(self, names: Sequence[str]) -> Masks | None:
        """Return the cut-outs of all triangles."""
        used = [name for name in self.cut_outs if name in self.numbers]
        if not used or not self.uv:
            return None
        number = np.full(len(names), -1, np.int32)
        tile = np.ones(len(names))
        for at, name in enumerate(used):
            number[self.numbers[name]] = at
            tile[self.numbers[name]] = self.cut_outs[name].tile
        material = np.concatenate(self.material)
        uv = np.concatenate(self.uv) / tile[material][:, None, None]
        images = tuple(np.asarray(self.cut_outs[name].image, bool) for name in used)
        return Masks(number[material], uv.astype(np.float32), images)


def _triangle_uv(
    batch: MeshBatch, triangles: NDArray[np.int32], face: IntArray
) -> NDArray[np.float32]:
    """(t, 3, 2) texture coordinates of triangles of a mesh, as `MeshBatch.triangles` cuts faces."""
    seen = np.zeros(len(batch.faces), bool)
    corner = np.tile([0, 1, 2], (len(triangles), 1))
    for row, number in enumerate(face.tolist()):
        if seen[number]:
            corner[row] = (0, 2, 3)
        seen[number] = True
    return np.asarray(batch.uv[face[:, None], corner], np.float32)


def _still(view: View, bare: bool, cut_outs: Mapping[str, CutOut], tints: bool) -> Stage:
    scene = view.scene
    names = _material_names(scene)
    meshes = _Meshes({name: number for number, name in enumerate(names)}, cut_outs, tints)
    mesh, place, first_object = [], [], []
    object_id, piece_class = [], []
    count = 0
    for layer, batch in scene.meshes.items():
        classes = classes_of_layer(layer, batch)
        for number, origin, objects in _shells(layer, batch, meshes):
            mesh.append(number)
            place.append(np.column_stack([np.eye(3), origin]))
            first_object.append(count + objects)
        object_id.append(batch.object_id)
        piece_class.append(classes)
        count += batch.count
    shells = len(mesh)
    layers = [rows for rows in scene.instances.values() if rows.count]
    used = np.unique(np.concatenate([np.zeros(0, np.int32), *(r.prototype for r in layers)]))
    number_of = np.full(len(scene.prototypes) + 1, -1, np.int32)
    class_of = np.zeros(len(scene.prototypes) + 1, np.uint8)
    for row in used.tolist():
        number_of[row] = _add_prototype(meshes, scene.prototypes[row], bare)
        class_of[row] = class_of_piece(scene.prototypes[row])
    transform = [np.array(place).reshape(-1, 3, 4)]
    owner = [np.zeros(count, np.uint64)]
    of_instance = [np.array(mesh, np.int32)]
    for rows in layers:
        of_instance.append(number_of[rows.prototype])
        transform.append(ways_of(rows))
        object_id.append(rows.object_id)
        owner.append(rows.owner)
        piece_class.append(class_of[rows.prototype])
    piece = np.concatenate([np.zeros(0, np.uint64), *object_id])
    kinds = np.concatenate([np.zeros(0, np.uint8), *piece_class])
    owning = np.isin(kinds, [CLASS[name] for name in OWNERS])
    whole = _wholes(piece, np.concatenate(owner), owning)
    sizes = [len(part) for part in meshes.part]
    start = np.concatenate([[0], np.cumsum(sizes)]).astype(np.int64)
    which = np.concatenate(of_instance)
    instances = len(which) - shells
    rays = placed(
        shapes_of(meshes.vertices, meshes.triangles, masks=meshes.masks(names)),
        which,
        np.concatenate(transform),
    )
    return Stage(
        view=view,
        moment=view.moment,
        rays=rays,
        first_mover=len(which),
        materials=names,
        object_id=piece[whole],
        semantic=kinds[whole],
        piece=piece,
        piece_class=kinds,
        whole=whole,
        instance_object=np.concatenate(
            [np.array(first_object, np.int64), count + np.arange(instances, dtype=np.int64)]
        ),
        instance_triangle=start[which],
        part=np.concatenate([np.zeros(1, np.int32)[:0], *meshes.part, np.zeros(1, np.int32)]),
        material=np.concatenate([*meshes.material, np.zeros(1, np.uint16)]),
        still=None,
        tint=np.concatenate([*meshes.tint, np.ones((1, 3), np.float32)]) if tints else None,
    )


def _material_names(scene: Scene) -> tuple[str, ...]:
    """Return the sky, the table of materials, and what a scene has beyond it."""
    held = {name for batch in scene.meshes.values() for name in batch.materials}
    held |= {name for prototype in scene.prototypes for name in prototype.mesh.materials}
    return (SKY_MATERIAL, *MATERIALS, *sorted(held - set(MATERIALS)))


def _shells(layer: str, batch: MeshBatch, meshes: _Meshes) -> Iterator[tuple[int, FloatArray, int]]:
    """Add the meshes of a layer; yields their numbers, origins and first objects."""
    if not batch.count:
        return
    triangles, face = batch.triangles()
    owner = batch.face_object()[face]
    if kind_of(layer) in SPREAD:
        origin = np.round(batch.vertices.mean(axis=0)) if len(batch.vertices) else np.zeros(3)
        part = owner.astype(np.int32)
        yield meshes.add(batch.vertices - origin, triangles, part, batch, face), origin, 0
        return
    order = np.argsort(owner, kind="stable")
    triangles, face = triangles[order], face[order]
    start = np.searchsorted(owner[order], np.arange(batch.count + 1))
    first = batch.vertex_start
    for row in range(batch.count):
        own = slice(int(start[row]), int(start[row + 1]))
        if own.start == own.stop:
            continue
        points = batch.vertices[first[row] : first[row + 1]]
        origin = np.round((points.min(axis=0) + points.max(axis=0)) / 2, 3)
        part = np.zeros(own.stop - own.start, np.int32)
        corners = triangles[own] - np.int32(first[row])
        yield meshes.add(points - origin, corners, part, batch, face[own]), origin, row


def _add_prototype(meshes: _Meshes, prototype: Prototype, bare: bool) -> int:
    mesh = prototype.mesh
    triangles, face = mesh.triangles()
    if bare and sheds(prototype.kind, prototype.name, mesh.materials):
        kept = mesh.material[face] != mesh.materials.index(LEAF)
        triangles, face = triangles[kept], face[kept]
    return meshes.add(mesh.vertices, triangles, np.zeros(len(face), np.int32), mesh, face)


def ways_of(rows: Instances) -> FloatArray:
    """Return the (n, 3, 4) transforms of instances."""
    turned = matrices(rows.rotation) * rows.scale[:, None, :].astype(float)
    return np.concatenate([turned, rows.position[:, :, None]], axis=2)


def _wholes(
    piece: NDArray[np.uint64], owner: NDArray[np.uint64], owning: NDArray[np.bool_]
) -> IntArray:
    """(o,) the row that each piece belongs to: that of its owner, if it may own, or its own.

    Rows of the same id are one object; its first row stands for it.
    """
    order = np.argsort(piece, kind="stable")
    ids = piece[order]
    whole = order[np.searchsorted(ids, piece)]
    held = np.flatnonzero(owner)
    at = np.minimum(np.searchsorted(ids, owner[held]), max(len(ids) - 1, 0))
    known = ids[at] == owner[held]
    known &= owning[order[at]]
    whole[held[known]] = order[at[known]]
    return np.asarray(whole, np.int64)


# --- what moves -----------------------------------------------------------------------------------

_TREES: OrderedDict[int, tuple[MeshBatch, Shapes]] = OrderedDict()  # by the mesh they are of


def _shape(mesh: MeshBatch) -> Shapes:
    """Return the tree of a mover's mesh; the last ones are kept, since poses come again."""
    found = _TREES.pop(id(mesh), None)
    if found is None:
        triangles, _ = mesh.triangles()
        found = (mesh, shapes_of([mesh.vertices], [triangles]))
    _TREES[id(mesh)] = found
    while len(_TREES) > KEPT:
        _TREES.popitem(last=False)
    return found[1]


def _with_movers(still: Stage, view: View) -> Stage:
    scene = view.scene
    layers = [scene.instances[layer] for layer in MOVING if scene.instances[layer].count]
    if not layers or view.tracks is None:
        return replace(still, view=view, moment=view.moment)
    used = np.unique(np.concatenate([rows.prototype for rows in layers]))
    prototypes = [scene.prototypes[row] for row in used.tolist()]
    names, material, sizes = list(still.materials), [], []
    for prototype in prototypes:
        names += [name for name in prototype.mesh.materials if name not in names]
        table = np.array([names.index(name) for name in prototype.mesh.materials], np.uint16)
        _, face = prototype.mesh.triangles()
        material.append(table[prototype.mesh.material[face]])
        sizes.append(len(face))
    piece = np.concatenate([rows.object_id for rows in layers])
    owner = np.concatenate([rows.owner for rows in layers])
    mesh = np.searchsorted(used, np.concatenate([rows.prototype for rows in layers]))
    whole = _wholes(piece, owner, np.ones(len(piece), bool))
    kinds = _mover_classes(view.tracks, piece, whole)
    rays = placed(
        together([_shape(prototype.mesh) for prototype in prototypes]),
        mesh,
        np.concatenate([ways_of(rows) for rows in layers]),
    )
    own = np.array([class_of_piece(prototype) for prototype in prototypes], np.uint8)[mesh]
    objects, triangles = len(still.object_id), len(still.material)
    start = triangles + np.concatenate([[0], np.cumsum(sizes)])
    return replace(
        still,
        view=view,
        moment=view.moment,
        rays=joined(still.rays, rays),
        materials=tuple(names),
        object_id=np.concatenate([still.object_id, piece[whole]]),
        semantic=np.concatenate([still.semantic, kinds]),
        piece=np.concatenate([still.piece, piece]),
        piece_class=np.concatenate([still.piece_class, own]),
        whole=np.concatenate([still.whole, objects + whole]),
        instance_object=np.concatenate(
            [still.instance_object, objects + np.arange(len(piece), dtype=np.int64)]
        ),
        instance_triangle=np.concatenate([still.instance_triangle, start[mesh]]),
        part=np.concatenate([still.part, np.zeros(sum(sizes), np.int32)]),
        material=np.concatenate([still.material, *material]),
        still=still,
    )


def _mover_classes(tracks: Tracks, piece: NDArray[np.uint64], whole: IntArray) -> NDArray[np.uint8]:
    """(o,) class of each row of movers: that of its track."""
    at = np.minimum(np.searchsorted(tracks.object_id, piece[whole]), tracks.count - 1)
    kinds = np.array([class_of_mover(kind) for kind in range(int(tracks.kind.max()) + 1)], np.uint8)
    return np.asarray(kinds[tracks.kind[at]])
