"""The city as a Blender scene: shells as objects, everything else as instances on points."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import bpy
import numpy as np
from numpy.typing import NDArray

from cityx.assets.styles.materials import material_named
from cityx.assets.trees.seasons import LEAF, sheds
from cityx.blender.leaf_fall import undress
from cityx.blender.materials import ROUND, MaterialLibrary
from cityx.city.content import scene_key
from cityx.city.mesh import NO_VERTEX, MeshBatch, feet
from cityx.city.rooms import ROOM_KINDS, room_draws, room_uses
from cityx.city.scene import Instances, Prototype
from cityx.ids import id_text

if TYPE_CHECKING:
    from cityx.city.store import View

MAX_OBJECTS = 20_000  # Blender's own bookkeeping grows faster than the count beyond this
TILE = 2000.0  # metres; a tile's own origin keeps float32 vertices exact to 0.12 mm
INSTANCER = "CityX Instances"  # node group that puts objects on points
LOW_32 = np.uint64(0xFFFFFFFF)
OBJECT_LAYERS = frozenset({"buildings"})  # layers whose things a user wants to pick one by one
# Custom properties by which `cityx.blender.pull` knows what it reads.
ID, LAYER, NAME, SCENE = "cityx_id", "cityx_layer", "cityx_name", "cityx_scene"
HOW_TO_EDIT = """\
This is a view of a city. What you change comes back to it by: cityx pull FOLDER

Buildings are objects: move, turn (about the vertical), scale, copy (Shift D) or delete them; their
windows follow when the city is made anew.
Trees, cars, lamps, benches, windows and all else that repeats are points of one object per layer:
in edit mode move (G), copy (Shift D) or delete (X) points. Select some and use Mesh > Set Attribute
for "rotation" (radians), "scale" and "tint". The object of a layer moves all of it.
Colours: the colour of an object (Object > Viewport Display), a material of your own with a plain
base colour in one of its slots, or the attribute "tint" of its faces.
Land and streets are changed by: cityx edit FOLDER "..."
Objects of your own are named, kept and left alone.
"""
BARK = "bark"  # material of the twigs of trees without leaves
CREASE = math.radians(32.0)  # between faces of a prototype, from which their edge shows
SIGNS = ("sign_", "shop_")  # names of prototypes whose signs shine at night begin so


def title(layer: str) -> str:
    """Return the name of a layer's collection: ``street_furniture`` -> ``Street furniture``."""
    return layer.replace("_", " ").capitalize()


def build_scene(
    view: View, *, objects: bool | None = None, library: MaterialLibrary | None = None
) -> bpy.types.Scene:
    """Fill the empty main file with the city.

    Parameters
    ----------
    view
        The city, read for engines.
    objects
        Whether each building becomes an object of its own; by default up to 20,000 buildings at
        level of detail 1 and above. Otherwise buildings are merged per tile and the faces carry
        the ids (integer attributes ``id_low`` and ``id_high``).
    library
        Gives the materials, also to what is added later; by default one of its own.

    Returns
    -------
    scene
        The scene, without cameras and light.
    """
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"  # first: which passes there are depends on it
    library = library or library_of(view)
    # Blender walks through all objects whenever a mesh is made or gets a material: those of
    # prototypes come before all objects.
    prototypes = {
        index: _prototype_mesh(view.scene.prototypes[index], index, library)
        for index in _used(view)
    }
    for layer, batch in view.scene.meshes.items():
        if not batch.count:
            continue
        own = layer in OBJECT_LAYERS and batch.count <= MAX_OBJECTS and view.lod > 0
        if objects is not None and layer in OBJECT_LAYERS:
            own = objects
        collection = _collection(title(layer), scene.collection)
        made = (
            _separate(layer, batch, view.objects, library)
            if own
            else _tiles(layer, batch, library, plain=view.lod == 0)
        )
        _link(collection, made)
    _instance_layers(view, library, scene, prototypes)
    _describe(scene, view)
    return scene


def library_of(view: View) -> MaterialLibrary:
    """Return the materials of a city in the empty main file."""
    held = view.scene
    wanted = {(name, "") for batch in held.meshes.values() if batch.count
              for name in batch.materials}  # fmt: skip
    for prototype in (held.prototypes[index] for index in _used(view)):
        variant = _variant(prototype)
        wanted |= {(name, variant) for name in prototype.mesh.materials}
        if _sheds(prototype):
            wanted |= {(LEAF, variant), (BARK, variant)}
    return MaterialLibrary(sorted(wanted), textured=view.lod > 0)


def _used(view: View) -> list[int]:
    """Return the numbers of the prototypes that have instances."""
    rows = view.scene.instances.values()
    return sorted({int(n) for each in rows for n in np.unique(each.prototype)})


def _sheds(prototype: Prototype) -> bool:
    return sheds(prototype.kind, prototype.name, prototype.mesh.materials)


def mark_made() -> None:
    """Write its name into every object, to distinguish it from an artist's own."""
    for item in bpy.data.objects:
        item[NAME] = item.name


def _collection(name: str, parent: bpy.types.Collection) -> bpy.types.Collection:
    collection = bpy.data.collections.new(name)
    parent.children.link(collection)
    return collection


def _link(collection: bpy.types.Collection, objects: Iterator[bpy.types.Object]) -> None:
    link = collection.objects.link
    for item in objects:
        link(item)


def _describe(scene: bpy.types.Scene, view: View) -> None:
    scene.name = view.name or "City"
    bpy.data.texts.new("How to edit").write(HOW_TO_EDIT)
    scene["cityx_name"] = view.name
    scene[SCENE] = scene_key(view.scene)
    scene["cityx_projection"] = view.frame.projection
    scene["cityx_latitude"] = view.frame.latitude
    scene["cityx_longitude"] = view.frame.longitude
    scene["cityx_attribution"] = "\n".join(view.attribution)
    scene.unit_settings.system = "METRIC"


# --- shells ---------------------------------------------------------------------------------------


@dataclass(frozen=True)
class _Corners:
    """The faces of a batch as Blender wants them: one flat list of corners."""

    vertex: NDArray[np.int32]  # (c,) into the batch's vertices
    uv: NDArray[np.float32]  # (c, 2)
    start: NDArray[np.int64]  # (f + 1,) first corner of each face


def _corners(batch: MeshBatch) -> _Corners:
    quad = batch.faces[:, 3] != NO_VERTEX  # (f,)
    start = np.concatenate([[0], np.cumsum(np.where(quad, 4, 3))])
    if not quad.any():  # triangles alone
        faces = np.ascontiguousarray(batch.faces[:, :3]).reshape(-1)
        return _Corners(faces, np.ascontiguousarray(batch.uv[:, :3]).reshape(-1, 2), start)
    used = np.flatnonzero(batch.faces != NO_VERTEX)
    # Both coordinates of a corner are copied as one number, three times as fast as a mask of rows.
    uv = np.ascontiguousarray(batch.uv).reshape(-1).view(np.uint64)
    return _Corners(batch.faces.ravel()[used], uv[used].view(np.float32).reshape(-1, 2), start)


def encoded(tint: NDArray[np.float32]) -> NDArray[np.float32]:
    """Encode linear (n, 3) colours for byte storage (sRGB curve), with alpha 1, (n, 4)."""
    linear = np.clip(tint, 0.0, 1.0)
    curve = np.where(
        linear <= 0.0031308, linear * 12.92, 1.055 * np.maximum(linear, 1e-9) ** (1 / 2.4) - 0.055
    )
    return np.column_stack([curve, np.ones(len(curve), np.float32)])


def _about(batch: MeshBatch, origins: NDArray[np.float64]) -> NDArray[np.float32]:
    """Return the vertices of each object about its own origin."""
    return np.asarray(
        batch.vertices - np.repeat(origins, np.diff(batch.vertex_start), axis=0), np.float32
    )


class MeshUploader:
    """Cuts meshes out of one batch and hands them to Blender.

    A class because the flattened arrays of the whole batch are shared by thousands of small meshes.
    Plain meshes have no texture coordinates. With origins, (k, 3) metres, the vertices of each
    object are about its own.
    """

    def __init__(
        self,
        batch: MeshBatch,
        library: MaterialLibrary,
        suffix: str = "",
        *,
        plain: bool = False,
        origins: NDArray[np.float64] | None = None,
    ) -> None:
        corners = _corners(batch)
        self.vertex, self.uv, self.corner_start = corners.vertex, corners.uv, corners.start
        self.points = batch.vertices if origins is None else _about(batch, origins)
        self.material = batch.material.astype(np.int32)
        self.plain = plain
        self.tint = encoded(batch.tint)
        self.materials = [library.get(name, suffix) for name in batch.materials]
        round_ = np.array([material_named(name).root in ROUND for name in batch.materials], bool)
        self.flat = ~round_[self.material]

    def mesh(self, name: str, vertices: slice, faces: slice, origin: Any = None) -> bpy.types.Mesh:
        """Make the mesh of consecutive vertices and faces, about an origin where one is given."""
        mesh = bpy.data.meshes.new(name)
        first, last = int(self.corner_start[faces.start]), int(self.corner_start[faces.stop])
        points = self.points[vertices]
        points = (points if origin is None else points - origin).astype(np.float32, copy=False)
        mesh.vertices.add(len(points))
        mesh.attributes["position"].data.foreach_set("vector", points.ravel())
        mesh.loops.add(last - first)
        # Attributes are filled by one copy, two hundred times as fast as the properties of loops.
        corner = mesh.attributes[".corner_vert"].data
        corner.foreach_set("value", self.vertex[first:last] - np.int32(vertices.start))
        mesh.polygons.add(faces.stop - faces.start)
        starts = self.corner_start[faces.start : faces.stop] - first
        mesh.polygons.foreach_set("loop_start", starts.astype(np.int32))
        material = self.material[faces]
        used = np.flatnonzero(np.bincount(material, minlength=1))
        for slot in used.tolist():
            mesh.materials.append(self.materials[slot])
        if len(used) > 1:
            local = np.searchsorted(used, material).astype(np.int32)
            index = mesh.attributes.new("material_index", "INT", "FACE")
            index.data.foreach_set("value", local)
        if not self.plain:
            layer = mesh.attributes.new("UVMap", "FLOAT2", "CORNER")
            layer.data.foreach_set("vector", self.uv[first:last].ravel())
        color = mesh.attributes.new("tint", "BYTE_COLOR", "FACE")
        color.data.foreach_set("color_srgb", self.tint[faces].ravel())
        flat = mesh.attributes.new("sharp_face", "BOOLEAN", "FACE")
        flat.data.foreach_set("value", self.flat[faces])
        mesh.update(calc_edges=True)
        return mesh


def _separate(
    layer: str, batch: MeshBatch, known: Mapping[int, Mapping[str, str]], library: MaterialLibrary
) -> Iterator[bpy.types.Object]:
    """One object per thing, its origin at the middle of its foot, named by its id."""
    filled = np.flatnonzero(np.diff(batch.vertex_start) > 0)
    feet_of = feet(batch).astype(np.float32).astype(float)  # as Blender keeps it
    upload, origins = MeshUploader(batch, library, origins=feet_of), feet_of[filled]
    kind = layer.removesuffix("s")
    vertex_start, face_start = batch.vertex_start.tolist(), batch.face_start.tolist()
    ids = batch.object_id[filled].tolist()
    # Blender walks through all objects whenever a mesh gets a material: meshes come first.
    meshes = [
        upload.mesh(
            f"{kind}_{id_text(object_id)}",
            slice(vertex_start[index], vertex_start[index + 1]),
            slice(face_start[index], face_start[index + 1]),
        )
        for index, object_id in zip(filled.tolist(), ids, strict=True)
    ]
    make = bpy.data.objects.new
    for object_id, origin, mesh in zip(ids, origins.tolist(), meshes, strict=True):
        item = make(mesh.name, mesh)
        item.location = origin
        item[ID] = id_text(object_id)
        item[LAYER] = layer
        for key, value in known.get(object_id, {"kind": kind}).items():
            if value:
                item[key] = value
        yield item


@dataclass(frozen=True)
class Tile:
    """Objects of a batch that are merged to one: consecutive ones of `batch`."""

    name: str
    batch: MeshBatch
    objects: slice
    origin: NDArray[np.float64]

    @property
    def vertices(self) -> slice:
        """Their rows of the batch's vertices."""
        return slice(*self.batch.vertex_start[[self.objects.start, self.objects.stop]].tolist())

    @property
    def faces(self) -> slice:
        """Their rows of the batch's faces."""
        return slice(*self.batch.face_start[[self.objects.start, self.objects.stop]].tolist())

    @property
    def face_id(self) -> NDArray[np.uint64]:
        """(f,) id of the object of each face."""
        first, last = self.objects.start, self.objects.stop
        sizes = np.diff(self.batch.face_start[first : last + 1])
        return np.repeat(self.batch.object_id[self.objects], sizes)


def tiles_of(layer: str, batch: MeshBatch) -> list[Tile]:
    """Cut a layer into tiles by the middles of its objects."""
    filled = np.flatnonzero(np.diff(batch.vertex_start) > 0)
    if not len(filled):
        return []
    begin = batch.vertex_start[:-1][filled]
    middle = np.minimum.reduceat(batch.vertices, begin) / 2
    middle += np.maximum.reduceat(batch.vertices, begin) / 2
    cell = np.floor(middle[:, :2] / TILE).astype(np.int64)  # (k, 2)
    cells, which = np.unique(cell, axis=0, return_inverse=True)
    order = np.argsort(which, kind="stable")
    chosen = filled[order]
    whole = np.array_equal(chosen, np.arange(batch.count))
    sorted_batch = batch if whole else batch.take(chosen)
    bounds = np.searchsorted(which[order], np.arange(len(cells) + 1))
    return [
        Tile(
            f"{layer}_{i}_{j}" if len(cells) > 1 else layer, sorted_batch,
            slice(int(first), int(last)), np.array([i * TILE, j * TILE, 0.0]),
        )
        for (i, j), first, last in zip(cells.tolist(), bounds[:-1], bounds[1:], strict=True)
    ]  # fmt: skip


def _tiles(
    layer: str, batch: MeshBatch, library: MaterialLibrary, *, plain: bool = False
) -> Iterator[bpy.types.Object]:
    """Objects merged per tile; faces keep the id of the thing they belong to."""
    tiles = tiles_of(layer, batch)
    if not tiles:
        return
    upload = MeshUploader(tiles[0].batch, library, plain=plain)
    made = []
    for tile in tiles:
        mesh = upload.mesh(tile.name, tile.vertices, tile.faces, tile.origin)
        _store_ids(mesh, "id", tile.face_id, "FACE")
        made.append((mesh, tile.origin, tile.batch.object_id[tile.objects]))
    for mesh, origin, ids in made:
        item = bpy.data.objects.new(mesh.name, mesh)
        item.location = origin
        item[LAYER] = layer
        if layer in OBJECT_LAYERS:
            item["cityx_ids"] = "\n".join(map(id_text, ids.tolist()))
        yield item


def _store_ids(mesh: bpy.types.Mesh, name: str, ids: NDArray[np.uint64], domain: str) -> None:
    """Store 64-bit ids as two integer attributes, ``<name>_low`` and ``<name>_high``."""
    for suffix, half in (("low", ids & LOW_32), ("high", ids >> np.uint64(32))):
        attribute = mesh.attributes.new(f"{name}_{suffix}", "INT", domain)
        attribute.data.foreach_set("value", half.astype(np.uint32).view(np.int32))


# --- instances ------------------------------------------------------------------------------------


def _instance_layers(
    view: View, library: MaterialLibrary, scene: bpy.types.Scene,
    meshes: Mapping[int, bpy.types.Mesh],
) -> None:  # fmt: skip
    held = view.scene
    layers = {layer: rows for layer, rows in held.instances.items() if rows.count}
    if not layers:
        return
    store = _collection("Prototypes", scene.collection)
    shared: dict[int, bpy.types.Object] = {}
    for layer, rows in layers.items():
        used, local = np.unique(rows.prototype, return_inverse=True)
        sources = _collection(_sources_of(layer), store)
        for index in used.tolist():
            if index not in shared:
                shared[index] = _prototype(held.prototypes[index], meshes[index], library)
            sources.objects.link(shared[index])
        points = _points(view.seed, held.prototypes, view.objects, layer, rows, local)
        _placed(layer, points, sources, _collection(title(layer), scene.collection))
    # Excluded from the view layer: saved, editable, and shown only through their instances.
    bpy.context.view_layer.layer_collection.children["Prototypes"].exclude = True


def add_layer(
    scene: bpy.types.Scene, layer: str, prototypes: Sequence[Prototype], rows: Instances, seed: int,
    library: MaterialLibrary,
) -> bpy.types.Object:  # fmt: skip
    """Add one layer of instances to a scene that is built already.

    Parameters
    ----------
    scene
        The scene.
    layer
        Name of the layer and its collection.
    prototypes
        What ``rows.prototype`` counts.
    rows
        The instances.
    seed
        Of the random number that each instance carries.
    library
        Gives the materials.
    """
    sources = bpy.data.collections.new(_sources_of(layer))
    for index, prototype in enumerate(prototypes):
        mesh = _prototype_mesh(prototype, index, library)
        sources.objects.link(_prototype(prototype, mesh, library))
    collection = _collection(title(layer), scene.collection)
    points = _points(seed, prototypes, {}, layer, rows, rows.prototype)
    return _placed(layer, points, sources, collection)


def remove_layer(layer: str) -> None:
    """Remove a layer that `add_layer` added, if there is one; materials stay."""
    sources = bpy.data.collections.get(_sources_of(layer))
    points = bpy.data.objects.get(layer)
    for item in [*(sources.objects if sources else ()), *([points] if points else ())]:
        bpy.data.meshes.remove(item.data)  # and the object with it
    for held in (sources, bpy.data.collections.get(title(layer))):
        if held is not None:
            bpy.data.collections.remove(held)


def _sources_of(layer: str) -> str:
    return f"Prototypes {layer}"


def _placed(
    layer: str,
    mesh: bpy.types.Mesh,
    sources: bpy.types.Collection,
    collection: bpy.types.Collection,
) -> bpy.types.Object:
    """Put the objects of a collection on the points of a layer."""
    points = bpy.data.objects.new(layer, mesh)
    points[LAYER] = layer
    modifier = points.modifiers.new("Instances", "NODES")
    modifier.node_group = bpy.data.node_groups.get(INSTANCER) or _instancer()
    modifier["Socket_2"] = sources
    collection.objects.link(points)
    return points


def _variant(prototype: Prototype) -> str:
    """Return the variant of its materials that a prototype has."""
    if prototype.kind in ROOM_KINDS:
        return "room"
    return "sign" if prototype.name.startswith(SIGNS) else "instance"


def _prototype_mesh(prototype: Prototype, index: int, library: MaterialLibrary) -> bpy.types.Mesh:
    """Make the mesh of a prototype; the number in its name keeps Blender's order ours."""
    mesh = prototype.mesh
    upload = MeshUploader(mesh, library, _variant(prototype))
    every = slice(0, len(mesh.vertices)), slice(0, len(mesh.faces))
    made = upload.mesh(f"{index:04d}_{prototype.name}", *every)
    made.attributes.remove(made.attributes["sharp_face"])
    made.set_sharp_from_angle(angle=CREASE)
    return made


def _prototype(
    prototype: Prototype, mesh: bpy.types.Mesh, library: MaterialLibrary
) -> bpy.types.Object:
    """Make the object of a prototype, named as its mesh is."""
    item = bpy.data.objects.new(mesh.name, mesh)
    item["kind"] = prototype.kind
    if _sheds(prototype):
        variant = _variant(prototype)
        undress(item, library.get(LEAF, variant), library.get(BARK, variant))
    return item


def _points(
    seed: int,
    prototypes: Sequence[Prototype],
    objects: Mapping[int, Mapping[str, str]],
    layer: str,
    rows: Instances,
    local: Any,
) -> bpy.types.Mesh:
    """Make the mesh of points that carries the rows of one layer as attributes."""
    mesh = bpy.data.meshes.new(layer)
    mesh.vertices.add(rows.count)
    mesh.attributes["position"].data.foreach_set("vector", rows.position.astype("f4").ravel())
    vectors = {"rotation": rows.rotation, "scale": rows.scale, "tint": rows.tint}
    for name, values in vectors.items():
        attribute = mesh.attributes.new(name, "FLOAT_VECTOR", "POINT")
        attribute.data.foreach_set("vector", values.astype(np.float32).ravel())
    attribute = mesh.attributes.new("prototype", "INT", "POINT")
    attribute.data.foreach_set("value", np.asarray(local, np.int32).ravel())
    numbers: dict[str, NDArray[Any]] = {"seed": room_draws(seed, rows)}
    if any(prototypes[index].kind in ROOM_KINDS for index in np.unique(rows.prototype).tolist()):
        numbers["use"] = room_uses(prototypes, rows, objects)
    for name, drawn in numbers.items():
        attribute = mesh.attributes.new(name, "FLOAT", "POINT")
        attribute.data.foreach_set("value", drawn.astype(np.float32))
    _store_ids(mesh, "id", rows.object_id, "POINT")
    if rows.owner.any():
        _store_ids(mesh, "owner", rows.owner, "POINT")
    return mesh


def _instancer() -> bpy.types.NodeTree:
    """Make the node group that puts a collection's objects on points by their attributes."""
    group = bpy.data.node_groups.new(INSTANCER, "GeometryNodeTree")
    faces = group.interface
    faces.new_socket("Geometry", in_out="INPUT", socket_type="NodeSocketGeometry")
    faces.new_socket("Geometry", in_out="OUTPUT", socket_type="NodeSocketGeometry")
    faces.new_socket("Prototypes", in_out="INPUT", socket_type="NodeSocketCollection")
    nodes, link = group.nodes, group.links.new
    source, sink = nodes.new("NodeGroupInput"), nodes.new("NodeGroupOutput")
    sources = nodes.new("GeometryNodeCollectionInfo")
    sources.inputs["Separate Children"].default_value = True
    sources.inputs["Reset Children"].default_value = True
    place = nodes.new("GeometryNodeInstanceOnPoints")
    place.inputs["Pick Instance"].default_value = True
    euler = nodes.new("FunctionNodeEulerToRotation")
    named = {}
    kinds = {"rotation": "FLOAT_VECTOR", "scale": "FLOAT_VECTOR", "prototype": "INT"}
    for row, (name, kind) in enumerate(kinds.items()):
        named[name] = nodes.new("GeometryNodeInputNamedAttribute")
        named[name].data_type = kind
        named[name].inputs["Name"].default_value = name
        named[name].location = (-500, -200 - 150 * row)
    link(source.outputs["Prototypes"], sources.inputs["Collection"])
    link(source.outputs["Geometry"], place.inputs["Points"])
    link(sources.outputs["Instances"], place.inputs["Instance"])
    link(named["prototype"].outputs["Attribute"], place.inputs["Instance Index"])
    link(named["rotation"].outputs["Attribute"], euler.inputs["Euler"])
    link(euler.outputs["Rotation"], place.inputs["Rotation"])
    link(named["scale"].outputs["Attribute"], place.inputs["Scale"])
    link(place.outputs["Instances"], sink.inputs["Geometry"])
    for node, spot in ((source, (-800, 0)), (sources, (-500, 0)), (euler, (-250, -200)),
                       (place, (0, 0)), (sink, (250, 0))):  # fmt: skip
        node.location = spot
    return group
