"""The bodies of a city: colliders, masses and friction, from meshes, materials and kinds."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from hashlib import blake2b
from itertools import pairwise
from types import MappingProxyType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cityx.assets.kept_prototypes import edition
from cityx.assets.styles.materials import (
    BUILDING_DENSITY,
    CLASSES,
    LOOSE,
    MOVER_WEIGHTS,
    UPRIGHT,
    VEHICLE_DENSITY,
    WEIGHTS,
    substance,
)
from cityx.assets.vehicles.car_parts import PART
from cityx.assets.vehicles.number_plates import PLATES
from cityx.city.bodies import (
    MOTION,
    Bodies,
    Colliders,
    colliders_of,
    join_bodies,
    join_colliders,
)
from cityx.city.mesh import NO_VERTEX, MeshBatch, joined_apart
from cityx.city.mesh_measures import check_closed
from cityx.city.scene import Instances, Prototype, Scene, in_chunks
from cityx.city.tracks import MOVER_KINDS, Tracks, poses_at
from cityx.geometry.convex import (
    Box,
    Cylinder,
    Hull,
    Solid,
    box_round,
    fewer_corners,
    hull_of,
    hulls_round,
    piece_of_vertices,
    pieces_of_mesh,
    simplest,
    upright_hulls,
)
from cityx.geometry.solids import face_areas, volumes_by_group
from cityx.system.cache import Arrays, cached_arrays

# Colliders are kept from run to run: hulls of thousands of pieces take long to find.

KINDS: Mapping[str, Callable[..., Solid]] = MappingProxyType(
    {kind.__name__: kind for kind in (Hull, Box, Cylinder)}
)
FEW = 64  # faces up to which a collider is found sooner than read
TOGETHER = 32  # objects of a layer in one file: an edit of one of them finds the hulls of all anew
COLUMNS = tuple(column.name for column in fields(Colliders))


def kept_collider(prototype: Prototype, make: Callable[[Prototype], list[Solid]]) -> list[Solid]:
    """Return what `make` finds for a prototype, from the cache where an earlier run has left it."""
    mesh = prototype.mesh
    if len(mesh.faces) <= FEW:
        return make(prototype)
    words = repr((prototype.name, prototype.kind, mesh.materials))
    key = _key("colliders", words, mesh.vertices, mesh.faces, mesh.material)
    return _unpacked(cached_arrays(key, lambda: _packed(make(prototype))))


def _packed(solids: list[Solid]) -> Arrays:
    return {
        f"{number} {type(solid).__name__} {column.name}": np.asarray(getattr(solid, column.name))
        for number, solid in enumerate(solids)
        for column in fields(solid)
    }


def _unpacked(held: Arrays) -> list[Solid]:
    solids: dict[int, tuple[str, Arrays]] = {}
    for name, array in held.items():
        number, kind, column = name.split()
        solids.setdefault(int(number), (kind, {}))[1][column] = array
    return [
        KINDS[kind](**{name: array if array.ndim else float(array) for name, array in own.items()})
        for kind, own in solids.values()
    ]


# A car, then the country and the number of its plates, and whether these are apart.
_CAR = re.compile(rf"(car_\w+?)(?:_(?:{'|'.join(filter(None, PLATES))})?\d*)?(?:_bare)?")
MOST_PARTS = 6  # hulls of one thing
AIR = 0.04  # share of a thing's hull that a part may hold beyond its pieces
MOST_PIECES = 24  # of a thing that are told apart; smaller ones go with the nearest of these
HOLLOW = 1.5  # hulls over the volume of a mesh from which it is taken for hollow, as a tunnel is
FOOT = 0.5  # metres below the ground down to which things have their feet
AFLOAT = 0.1  # metres above the ground up to which a thing stands on it all the same
TRUNK = 1.5  # metres up to which the wood of a tree is its trunk
LEANS = 1.2  # times the radius of a trunk within which it stays, though it leans
CROWN = 0.02  # share of the leaves that hang below what counts as the crown
FLAT_KINDS = frozenset({"window", "trim", "shopfront", "street_cover"})  # a box each
STANDING_KINDS = frozenset({"furniture", "vehicle", "tree"})  # their origin is on the ground
DOORSTEP = frozenset({"step_stone", "concrete", "kerb_stone", "asphalt_light", "stone"})
LAYER_KINDS = {
    "buildings": "building", "garden_paths": "ground", "lawn_edging": "ground", "shores": "ground",
    "decks": "bridge",
    "structures": "bridge", "surroundings": "terrain", "barriers": "barrier",
}  # fmt: skip


def bodies_of(scene: Scene, tracks: Tracks | None = None, moment: float = 0.0) -> Bodies:
    """Return the bodies of everything in a scene, and of what moves in it at a moment.

    Parameters
    ----------
    scene
        Meshes and instances.
    tracks
        What moves by itself, None for nothing.
    moment
        Seconds since the tracks begin.

    Returns
    -------
    bodies
        Layer by layer in the order of the scene, meshes first; movers last.
    """
    tables = [mesh_bodies(name, batch) for name, batch in scene.meshes.items() if batch.count]
    used = [rows.prototype for rows in scene.instances.values()]
    numbers = np.unique(np.concatenate([np.zeros(0, np.int32), *used])).tolist()
    found = things_of([scene.prototypes[number] for number in numbers])
    things = dict(zip(numbers, found, strict=True))
    for rows in scene.instances.values():
        if rows.count:
            tables.append(_instance_bodies(things, rows))
    movers = _mover_bodies(tracks, moment)
    if movers.count or not tables:
        tables.append(movers)
    return join_bodies(tables)


# --- things that are placed -----------------------------------------------------------------------


@dataclass(frozen=True)
class Thing:
    """The body of a prototype at scale 1.

    Attributes
    ----------
    kind
        Semantic class; see `class_of`.
    motion
        "fixed", "free" or "hinge".
    collider
        Convex parts in the prototype's frame; none if it has no shape.
    mass
        Kilograms; times the product of an instance's scale that of the instance.
    friction, restitution
        Of what it stands on.
    """

    kind: str
    motion: str
    collider: tuple[Solid, ...]
    mass: float
    friction: float
    restitution: float

    def to_json(self) -> dict[str, str | float]:
        """Return it without the shape, for files that have a mesh of it."""
        return {
            "kind": self.kind, "motion": self.motion, "mass": round(self.mass, 3),
            "friction": self.friction, "restitution": self.restitution,
        }  # fmt: skip


def things_of(prototypes: Sequence[Prototype]) -> list[Thing]:
    """Return the bodies of prototypes."""
    pairs = zip(prototypes, shapeless(prototypes), strict=True)
    return [replace(thing, collider=tuple(collider_of(one))) for one, thing in pairs]


def shapeless(prototypes: Sequence[Prototype]) -> list[Thing]:
    """Return the bodies of prototypes without their shapes, which take long to find."""
    found = []
    for chunk in in_chunks(prototypes):
        batch = joined_apart(prototype.mesh for prototype in chunk)
        facts = zip(chunk, _masses(chunk, batch), touches_of(batch), strict=True)
        found += [
            Thing(class_of(one), motion_of(one), (), mass, *_sole(one, touch))
            for one, mass, touch in facts
        ]
    return found


def class_of(prototype: Prototype) -> str:
    """Return the semantic class of a prototype: "bench", "car", "tree", "window", ..."""
    for begin, name in CLASSES.items():
        if prototype.name.startswith(begin):
            return name
    if prototype.kind not in ("furniture", "vehicle"):
        return prototype.kind
    return prototype.name.removesuffix("_fine")


def motion_of(prototype: Prototype) -> str:
    """Return how a thing may move: "fixed", "free" or "hinge"."""
    if prototype.kind == "vehicle":
        return "free"
    if prototype.kind == "door":
        return "hinge"
    return "free" if class_of(prototype) in LOOSE else "fixed"


def collider_of(prototype: Prototype) -> list[Solid]:
    """Return the collider of a prototype, in its own frame.

    What stands on the ground has its collider above it: posts and feet reach deeper, but there is
    nothing to push there.
    """
    return kept_collider(prototype, _collider)


def _collider(prototype: Prototype) -> list[Solid]:
    if prototype.kind == PART:  # it goes with its car, whose body is whole without it
        return []
    mesh = prototype.mesh
    vertices = mesh.vertices
    if not len(mesh.faces):
        return [box_round(vertices)] if len(vertices) else []
    if prototype.kind in FLAT_KINDS:
        return [box_round(vertices)]
    if prototype.kind == "door":
        return [box_round(vertices[_leaf(mesh)])]
    if class_of(prototype) in UPRIGHT:
        return [box_round(_on_ground(vertices))]
    if prototype.kind in STANDING_KINDS and vertices[:, 2].min() > -FOOT:
        vertices = _on_ground(vertices)
    if prototype.kind == "tree":
        return _tree(mesh, vertices)
    pieces = [vertices[rows] for rows in pieces_of_mesh(vertices, mesh.faces.astype(np.int64))]
    above = [points for points in pieces if np.ptp(points, axis=0).any() and points[:, 2].max() > 0]
    hulls = hulls_round(_gathered(above or pieces), most=MOST_PARTS, slack=AIR)
    return [simplest(hull) for hull in hulls]


def _on_ground(vertices: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the vertices of what stands on the ground with its feet drawn to the ground."""
    height = np.maximum(vertices[:, 2], 0.0)
    lowest = height.min()
    height = np.where((height <= lowest) & (lowest < AFLOAT), 0.0, height)
    return np.column_stack([vertices[:, :2], height])


def _leaf(mesh: MeshBatch) -> NDArray[np.int64]:
    """Return the rows of the vertices of a door but its steps and its canopy."""
    return _rows_of(mesh, [name not in DOORSTEP for name in mesh.materials])


def _rows_of(mesh: MeshBatch, materials: list[bool]) -> NDArray[np.int64]:
    """Return the rows of the vertices of faces in some materials, of all if there are none."""
    corners = mesh.faces[_faces_of(mesh, materials)]
    return np.asarray(np.unique(corners[corners != NO_VERTEX]), np.int64)


def _faces_of(mesh: MeshBatch, materials: list[bool]) -> NDArray[np.bool_]:
    """(f,) whether each face is of some materials; all are if none is."""
    chosen = np.array(materials, bool)[mesh.material]
    return chosen if chosen.any() else np.ones(len(chosen), bool)


def _tree(mesh: MeshBatch, vertices: NDArray[np.float64]) -> list[Solid]:
    """Return a trunk and a crown; a bush is a crown alone, and so is what has no leaves.

    Boughs that leave the trunk below the leaves belong to the crown.
    """
    green = [substance(name) == substance("leaf") for name in mesh.materials]
    base = float(np.quantile(vertices[_rows_of(mesh, green), 2], CROWN))
    wood = np.setdiff1d(np.flatnonzero(vertices[:, 2] <= base), _rows_of(mesh, green))
    if not any(green) or base < FOOT or len(wood) < 3:  # far off a trunk has three sides
        return [fewer_corners(hull_of(vertices))]
    stem = vertices[wood]
    foot = stem[stem[:, 2] <= max(TRUNK, float(stem[:, 2].min()))]
    axis = (foot.min(axis=0) + foot.max(axis=0))[:2] / 2
    radius = float(np.hypot(*(foot[:, :2] - axis).T).max())
    apart = np.hypot(*(stem[:, :2] - axis).T) > LEANS * radius
    base = float(stem[apart, 2].min(initial=base))
    middle = np.array([*axis, base / 2])
    crown = fewer_corners(hull_of(vertices[vertices[:, 2] >= base]))
    return [Cylinder(middle, radius, base / 2), crown]


def _gathered(pieces: Sequence[NDArray[np.float64]]) -> list[NDArray[np.float64]]:
    """Put the small ones of very many pieces, such as leaves, to the nearest larger one."""
    if len(pieces) <= MOST_PIECES:
        return list(pieces)
    size = np.array([np.linalg.norm(np.ptp(points, axis=0)) for points in pieces])
    order = np.argsort(-size, kind="stable")
    kept = [[pieces[row]] for row in order[:MOST_PIECES].tolist()]
    low = np.array([points[0].min(axis=0) for points in kept])
    high = np.array([points[0].max(axis=0) for points in kept])
    for row in order[MOST_PIECES:].tolist():
        middle = pieces[row].mean(axis=0)
        away = np.linalg.norm(middle - np.clip(middle, low, high), axis=1)
        kept[int(np.argmin(away))].append(pieces[row])
    return [np.concatenate(group) for group in kept]


def _known_mass(prototype: Prototype) -> float | None:
    name = prototype.name.removesuffix("_fine")
    car = _CAR.fullmatch(name)
    known = WEIGHTS.get(car[1] if car else name)
    if known is None and prototype.kind == "vehicle":
        return VEHICLE_DENSITY * sum(solid.volume for solid in collider_of(prototype))
    return known


def _masses(prototypes: Sequence[Prototype], batch: MeshBatch) -> list[float]:
    """Return the weights of prototypes whose meshes a batch joins, kilograms.

    They are what is known of their kinds, else of their pieces. A piece weighs as much as it
    holds, or as its skin does if that is less: posts are hollow.
    """
    known = [_known_mass(prototype) for prototype in prototypes]
    counted = np.array([mass is None for mass in known], bool)[batch.face_object()]
    for row, prototype in enumerate(prototypes):
        if known[row] is None and prototype.kind == "door":
            own = [name not in DOORSTEP for name in prototype.mesh.materials]
            counted[slice(*batch.face_start[row : row + 2])] = _faces_of(prototype.mesh, own)
    faces, material, count = batch.faces[counted], batch.material[counted], len(batch.vertices)
    of_face = piece_of_vertices(faces, count)[faces[:, 0]]
    held = np.abs(volumes_by_group(batch.vertices, faces, of_face, count))
    area = face_areas(batch.vertices, faces)
    skin = np.bincount(of_face, area, minlength=count)
    made = [substance(name) for name in batch.materials]
    density = np.array([item.density for item in made])[material]
    wall = np.array([item.wall for item in made])[material]
    # Spread over its skin a piece is as thick as this; of two materials each has its share.
    thick = np.minimum(wall, (held / np.maximum(skin, 1e-12))[of_face])
    weight = area * thick * density
    start = np.concatenate([[0], np.cumsum(counted)])[batch.face_start].tolist()
    return [
        float(weight[first:end].sum()) if mass is None else mass
        for mass, (first, end) in zip(known, pairwise(start), strict=True)
    ]


def touches_of(batch: MeshBatch) -> list[tuple[float, float]]:
    """Return friction and restitution of each object: of the material it shows most of."""
    area = np.nan_to_num(face_areas(batch.vertices, batch.faces))
    width = max(len(batch.materials), 1)
    place = batch.face_object() * width + batch.material
    shown = np.bincount(place, area, minlength=batch.count * width).reshape(-1, width)
    filled = np.diff(batch.face_start) > 0
    names = np.where(filled, shown.argmax(axis=1), -1).tolist()
    found = [substance(name) for name in (*batch.materials, "concrete")]
    return [(found[number].friction, found[number].restitution) for number in names]


def _sole(prototype: Prototype, touch: tuple[float, float]) -> tuple[float, float]:
    """Return friction and restitution of what a thing stands on: its tyres, its feet.

    Of what stays where it is they are those of the material it shows most of, `touch`.
    """
    mesh = prototype.mesh
    if not len(mesh.faces) or motion_of(prototype) == "fixed":
        return touch
    lowest = mesh.vertices[mesh.faces[:, 0], 2]
    foot = substance(mesh.materials[int(mesh.material[int(np.argmin(lowest))])])
    return foot.friction, foot.restitution


def _instance_bodies(things: Mapping[int, Thing], rows: Instances) -> Bodies:
    """Return the bodies of one layer of instances; those without a shape have none."""
    full = np.array([bool(things[n].collider) for n in rows.prototype.tolist()], bool)
    used, local = np.unique(rows.prototype[full], return_inverse=True)
    own = [things[number] for number in used.tolist()]
    kinds = tuple(dict.fromkeys(thing.kind for thing in own))
    facts = np.array([(t.mass, t.friction, t.restitution) for t in own]).reshape(-1, 3)[local]
    scale = rows.scale[full].astype(float)
    return Bodies(
        rows.object_id[full],
        rows.owner[full],
        np.array([kinds.index(thing.kind) for thing in own], np.int16)[local],
        kinds,
        local.astype(np.int32),
        colliders_of([thing.collider for thing in own]),
        rows.position[full].astype(float),
        rows.rotation[full].astype(float),
        scale,
        facts[:, 0] * np.abs(scale.prod(axis=1)),
        facts[:, 1],
        facts[:, 2],
        np.array([MOTION[thing.motion] for thing in own], np.uint8)[local],
    )


# --- meshes of their own, and what moves ----------------------------------------------------------


def standing_fast(layer: str, batch: MeshBatch) -> list[dict[str, str | float]]:
    """Return the body of each object of a layer of meshes without its shape, as `Thing.to_json`."""
    weights, kind = masses_of(layer, batch).tolist(), kind_of(layer)
    return [
        Thing(kind, "fixed", (), weight, *touch).to_json()
        for weight, touch in zip(weights, touches_of(batch), strict=True)
    ]


def kind_of(layer: str) -> str:
    """Return the semantic class of the objects of a layer of meshes."""
    return LAYER_KINDS.get(layer, layer.removesuffix("s"))


def masses_of(layer: str, batch: MeshBatch) -> NDArray[np.float64]:
    """Return the weight of each object of a layer of meshes, (k,) kilograms; 0 of open ones."""
    return _masses_of(layer, _held(batch, check_closed(batch)))


def _held(batch: MeshBatch, closed: NDArray[np.bool_]) -> NDArray[np.float64]:
    """Return what each object of a batch holds, (k,) cubic metres; 0 of those that are open."""
    owner = batch.face_object()
    own = closed[owner]
    return volumes_by_group(batch.vertices, batch.faces[own], owner[own], batch.count)


def _masses_of(layer: str, held: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the weights of objects that hold so much, (k,) kilograms."""
    building = kind_of(layer) == "building"
    density = BUILDING_DENSITY if building else substance("concrete").density
    return np.nan_to_num(density * held)


def mesh_bodies(layer: str, batch: MeshBatch) -> Bodies:
    """Return the bodies of a layer of meshes: closed ones as convex parts, ground as its faces."""
    rows = np.flatnonzero(np.diff(batch.face_start) > 0)
    closed = check_closed(batch)
    size = _held(batch, closed)
    touch = np.array(touches_of(batch)).reshape(-1, 2)[rows]
    count = len(rows)
    return Bodies(
        batch.object_id[rows],
        np.zeros(count, np.uint64),
        np.zeros(count, np.int16),
        (kind_of(layer),),
        np.arange(count, dtype=np.int32),
        _shapes_of(batch, rows, np.where(closed, size, np.nan)),
        np.zeros((count, 3)),
        np.zeros((count, 3)),
        np.ones((count, 3)),
        _masses_of(layer, size)[rows],
        touch[:, 0],
        touch[:, 1],
        np.full(count, MOTION["fixed"], np.uint8),
    )


def _shapes_of(batch: MeshBatch, rows: NDArray[np.int64], size: NDArray[np.float64]) -> Colliders:
    """Return the shapes of objects of a batch, from the cache where an earlier run has left them.

    Parameters
    ----------
    rows
        Objects that have faces, in rising order.
    size
        (k,) what each object of the batch holds, cubic metres, NaN of open ones, which are shapes
        of their own meshes.
    """
    starts = range(0, len(rows), TOGETHER)
    chunks = [rows[first : first + TOGETHER] for first in starts]
    return join_colliders([_kept_shapes(batch, chunk, size) for chunk in chunks or [rows]])


def _kept_shapes(batch: MeshBatch, rows: NDArray[np.int64], size: NDArray[np.float64]) -> Colliders:
    """Return the shapes of a few objects that follow each other; see `_shapes_of`."""
    held = size[rows]
    if np.isnan(held).all():
        return colliders_of([[]] * len(rows))
    first, last = int(rows[0]), int(rows[-1]) + 1
    near, far = batch.vertex_start[[first, last]].tolist()
    faces = batch.faces[slice(*batch.face_start[[first, last]].tolist())]
    shell = np.repeat(np.arange(last - first), np.diff(batch.face_start[first : last + 1]))
    closed = ~np.isnan(size[first:last])[shell]
    faces, shell = faces[closed], shell[closed]
    faces = np.where(faces == NO_VERTEX, NO_VERTEX, faces - near)
    vertices, place = batch.vertices[near:far], rows - first

    def make() -> Arrays:
        hulls = upright_hulls(vertices, faces, shell, last - first)
        pairs = zip(place.tolist(), held.tolist(), strict=True)
        found = colliders_of([_parts(hulls[number], each) for number, each in pairs])
        return {name: getattr(found, name) for name in COLUMNS}

    key = _key("shapes", "", vertices, faces, shell, place, held)
    return Colliders(**cached_arrays(key, make))


def _key(group: str, words: str, *arrays: NDArray[Any]) -> str:
    """Return the name in the cache of what hulls are found for."""
    import scipy

    hasher = blake2b(words.encode(), digest_size=16)
    for array in arrays:
        hasher.update(np.ascontiguousarray(array).data)
    return f"{group}-{edition()}-{scipy.__version__}/{hasher.hexdigest()}"


def _parts(hulls: list[Hull], size: float) -> list[Solid]:
    """Return the convex parts of a closed mesh; none if they would fill what is hollow."""
    if sum(hull.volume for hull in hulls) > HOLLOW * max(size, 1e-9):
        return []
    return [simplest(hull) for hull in hulls]


def _mover_bodies(tracks: Tracks | None, moment: float) -> Bodies:
    """Return the bodies of what moves: people as cylinders, the others as boxes of their size."""
    unit = np.full(3, 0.5)
    up = np.array([0.0, 0.0, 0.5])
    shapes: Colliders = colliders_of([[Box(up, unit, 0.0)], [Cylinder(up, 0.5, 0.5)]])
    poses = None if tracks is None else poses_at(tracks, moment)
    rows = np.zeros(0, np.int64) if poses is None else poses.row
    kind = np.zeros(0, np.int16) if tracks is None else tracks.kind[rows].astype(np.int16)
    rubber, count = substance("rubber"), len(rows)
    return Bodies(
        np.zeros(0, np.uint64) if tracks is None else tracks.object_id[rows],
        np.zeros(count, np.uint64),
        kind,
        MOVER_KINDS,
        (kind == MOVER_KINDS.index("pedestrian")).astype(np.int32),
        shapes,
        np.zeros((0, 3)) if poses is None else poses.position,
        np.zeros((0, 3)) if poses is None else poses.heading[:, None] * [0.0, 0.0, 1.0],
        np.zeros((0, 3)) if tracks is None else tracks.size[rows].astype(float),
        np.array([MOVER_WEIGHTS[name] for name in MOVER_KINDS])[kind],
        np.full(count, rubber.friction),
        np.full(count, rubber.restitution),
        np.full(count, MOTION["driven"], np.uint8),
    )
