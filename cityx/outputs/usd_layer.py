"""The growing USD layer of a city: meshes, prototypes and point instancers."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import degrees
from pathlib import Path
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray
from pxr import Gf, Kind, Sdf, Usd, UsdGeom, Vt

from cityx.assets.colliders import Thing, things_of, touches_of
from cityx.city.environment import Environment
from cityx.city.mesh import MeshBatch
from cityx.city.rooms import lit_scene
from cityx.city.scene import Instances, Prototype
from cityx.geometry.convex import Box
from cityx.ids import id_text
from cityx.outputs.glb import MOST_OBJECTS, merged_by_tile
from cityx.outputs.gltf_instances import illuminance_of, quaternions, sun_light
from cityx.outputs.gltf_material import TWO_SIDED
from cityx.outputs.gltf_mesh import finite, origins, takes_tint
from cityx.outputs.usd_material import Steps, UsdMaterials, as_steps, look_name
from cityx.outputs.usd_mesh import (
    TINT_STEPS,
    Types,
    UsdFaces,
    add_attribute,
    add_prim,
    apply_schemas,
    integers,
    label,
    long_integers,
    move_to,
    packed,
    point_at,
    refer,
    tint_of,
    tint_steps,
    usd_faces,
    vectors,
)
from cityx.version import __version__

# Bodies in a USD layer: collision, mass and friction by the schemas of UsdPhysics.

COLLIDES = ("PhysicsCollisionAPI", "PhysicsMeshCollisionAPI")
MOVES = ("PhysicsRigidBodyAPI", "PhysicsMassAPI")


class UsdPhysics:
    """The physics of a layer in the making: its gravity and its materials."""

    def __init__(self, city: Any) -> None:
        world = add_prim(city, "Physics", "PhysicsScene")
        add_attribute(world, "physics:gravityDirection", Types.Vector3f, Gf.Vec3f(0, 0, -1))
        add_attribute(world, "physics:gravityMagnitude", Types.Float, 9.81)
        self._scope = add_prim(city, "Touch", "Scope")
        self._made: dict[tuple[float, float], Any] = {}

    def fixed(self, mesh: Any, touch: tuple[float, float]) -> None:
        """Add collision by faces to a mesh with the schemas `COLLIDES`."""
        self._collide(mesh, "none", touch)

    def thing(self, mesh: Any, thing: Thing) -> None:
        """Add collision, and rigid-body schemas if loose, to a prototype (see `schemas_of`)."""
        box = len(thing.collider) == 1 and isinstance(thing.collider[0], Box)
        several = "convexDecomposition" if len(thing.collider) > 1 else "convexHull"
        self._collide(mesh, "boundingCube" if box else several, (thing.friction, thing.restitution))
        if thing.motion == "free":
            add_attribute(mesh, "physics:mass", Types.Float, thing.mass)

    def _collide(self, mesh: Any, how: str, touch: tuple[float, float]) -> None:
        add_attribute(mesh, "physics:approximation", Types.Token, how, uniform=True)
        point_at(mesh, "material:binding:physics", [self._material(touch).path])

    def _material(self, touch: tuple[float, float]) -> Any:
        """Return the prim of a friction and a restitution."""
        if touch not in self._made:
            friction, restitution = touch
            prim = add_prim(self._scope, f"touch_{len(self._made)}", "Material")
            apply_schemas(prim, "PhysicsMaterialAPI")
            for name, value in (("staticFriction", friction), ("dynamicFriction", friction),
                                ("restitution", restitution)):  # fmt: skip
                add_attribute(prim, f"physics:{name}", Types.Float, value)
            self._made[touch] = prim
        return self._made[touch]


def schemas_of(thing: Thing) -> tuple[str, ...]:
    """Return the schemas of the body of a prototype; none of what has no shape."""
    if not thing.collider:
        return ()
    return (*MOVES, *COLLIDES) if thing.motion == "free" else COLLIDES


# The sun of a city as USD carries it: a distant light.

DISC = 0.53  # degrees


def add_sun(parent: Any, environment: Environment) -> Any:
    """Add the light ``Sun``, which shines along its own -z, when the sun is up; else None."""
    if illuminance_of(environment) <= 0:
        return None
    light = sun_light(environment)
    sun = add_prim(parent, "Sun", "DistantLight")
    add_attribute(sun, "inputs:intensity", Types.Float, light["intensity"])
    add_attribute(sun, "inputs:angle", Types.Float, DISC)
    add_attribute(sun, "inputs:color", Types.Color3f, Gf.Vec3f(*light["color"]))
    add_attribute(sun, "cityx:lux", Types.Float, light["extras"]["illuminance_lux"])
    turn = Gf.Vec3f(
        90.0 - degrees(environment.sun_elevation), 0.0, 180.0 - degrees(environment.sun_azimuth)
    )
    add_attribute(sun, "xformOp:rotateXYZ", Types.Float3, turn)
    order = Vt.TokenArray(["xformOp:rotateXYZ"])
    add_attribute(sun, "xformOpOrder", Types.TokenArray, order, uniform=True)
    return sun


Look = tuple[str, Steps]  # a material and its tint

_SCHEMAS = ("MaterialBindingAPI", "SemanticsLabelsAPI:class")


@dataclass(frozen=True)
class _Shape:
    """A prototype in the layer: everything but the tint of its instances.

    Attributes
    ----------
    path
        Of its mesh.
    looks
        Material and tint of each run of faces.
    holders
        Names of the subsets that bind a material each, or "" for the mesh itself, to the run
        whose material it is.
    takes_tint
        Whether the tint of an instance changes its look.
    triangles
        Number of them.
    """

    path: Any
    looks: list[Look]
    holders: dict[str, int]
    takes_tint: bool
    triangles: int


class UsdWriter:
    """A layer in the making."""

    def __init__(self, view: Any, textures: Path, texture_size: int) -> None:
        self.view = view
        self.scene = lit_scene(view)
        self.layer = Sdf.Layer.CreateAnonymous("city.usdc")
        self.meshes = self.prototypes = self.instances = 0
        self.triangles_unique = self.triangles_instanced = 0
        self._shapes: dict[str, _Shape | None] = {}
        self._instancers: list[Any] = []
        _write_head(self.layer, view)
        self.city = add_prim(self.layer.pseudoRoot, "City", "Xform")
        self.city.kind = Kind.Tokens.assembly
        scope = add_prim(self.city, "Materials", "Scope")
        self.materials = UsdMaterials(scope, view.environment, textures, texture_size)
        add_sun(self.city, view.environment)
        self.physics = UsdPhysics(self.city)
        self.shared = add_prim(self.city, "Prototypes", "Scope", specifier=Sdf.SpecifierClass)

    def mesh_layer(self, name: str, batch: MeshBatch) -> None:
        """Write one mesh per object that has faces; very many objects are merged by tile."""
        if not len(batch.faces):
            return
        group = add_prim(self.city, name, "Xform")
        group.kind = Kind.Tokens.group
        kind = name.removesuffix("s")
        if batch.count <= MOST_OBJECTS:
            names = [f"{kind}_{id_text(object_id)}" for object_id in batch.object_id.tolist()]
            ids = None
        else:
            batch, ids, tiles = merged_by_tile(batch)
            names = [f"{name}_tile_{column}_{row}" for column, row in tiles.tolist()]
        origin = origins(batch)
        faces = usd_faces(batch, origin)
        looks, touches = _looks(faces, batch.materials), touches_of(batch)
        runs = np.searchsorted(faces.run_object, np.arange(batch.count + 1))
        for number in np.flatnonzero(np.diff(batch.face_start)).tolist():
            mesh = add_prim(group, names[number], "Mesh")
            mesh.kind = Kind.Tokens.component
            if ids is None:
                object_id = int(batch.object_id[number])
                known = {"kind": kind, **self.view.objects.get(object_id, {})}
                self._describe(mesh, {"id": id_text(object_id), **known}, COLLIDES)
            else:
                self._describe(mesh, {"kind": kind}, COLLIDES)
                members = faces.order[slice(*batch.face_start[number : number + 2])]
                owners = long_integers(ids[batch.faces[members, 0]])
                add_attribute(mesh, "primvars:cityx:id", Types.Int64Array, owners, over="uniform")
            move_to(mesh, origin[number])
            self.physics.fixed(mesh, touches[number])
            self._fill(mesh, batch, faces, number, looks[runs[number] : runs[number + 1]])
            self.meshes += 1
        self.triangles_unique += batch.triangle_count
        self.triangles_instanced += batch.triangle_count

    def _describe(self, prim: Any, facts: dict[str, str], schemas: tuple[str, ...]) -> None:
        """Apply the schemas, label the prim with its kind and keep what is known of it."""
        apply_schemas(prim, *_SCHEMAS, *schemas)
        label(prim, facts["kind"])
        for key, value in facts.items():
            if value:
                add_attribute(prim, f"cityx:{key}", Types.String, value, uniform=True)

    def _fill(
        self, mesh: Any, batch: MeshBatch, faces: UsdFaces, number: int, looks: list[Look]
    ) -> dict[str, int]:
        """Write the geometry of object `number`, its colours and its materials.

        Parameters
        ----------
        looks
            Material and tint of each run of the object.

        Returns
        -------
        holders
            What binds a material, see `_Shape`.
        """
        points = faces.points[slice(*batch.vertex_start[number : number + 2])]
        rows = slice(*batch.face_start[number : number + 2])
        corners = slice(*faces.corner_start[number : number + 2])
        extent = vectors(np.stack([points.min(axis=0), points.max(axis=0)]))
        st = Vt.Vec2fArray.FromNumpy(np.ascontiguousarray(faces.st[corners]))
        add_attribute(mesh, "extent", Types.Float3Array, extent)
        add_attribute(mesh, "points", Types.Point3fArray, vectors(points))
        # Programs differ in how they shade a mesh without normals; Blender would round its edges.
        normals = vectors(faces.normals[rows])
        add_attribute(mesh, "normals", Types.Normal3fArray, normals, over="uniform")
        add_attribute(mesh, "faceVertexCounts", Types.IntArray, integers(faces.counts[rows]))
        add_attribute(mesh, "faceVertexIndices", Types.IntArray, integers(faces.indices[corners]))
        add_attribute(mesh, "primvars:st", Types.TexCoord2fArray, st, over="faceVarying")
        add_attribute(mesh, "subdivisionScheme", Types.Token, "none", uniform=True)
        if not TWO_SIDED.isdisjoint(material for material, _ in looks):
            add_attribute(mesh, "doubleSided", Types.Bool, True, uniform=True)
        first = np.searchsorted(faces.run_object, number)
        starts = faces.run_start[first : first + len(looks) + 1] - rows.start
        run = np.repeat(np.arange(len(looks)), np.diff(starts))
        self._paint(mesh, looks)
        add_attribute(mesh, "primvars:displayColor:indices", Types.IntArray, integers(run))
        return self._bind(mesh, looks, starts.tolist())

    def _paint(self, mesh: Any, looks: list[Look]) -> None:
        """Write the colour of each run; the mesh or what it refers to has the runs of the faces."""
        base = np.array([self.materials.seen_color(name) for name, _ in looks])
        colors = vectors(base * tint_of([steps for _, steps in looks]))
        kind = Types.Color3fArray
        add_attribute(mesh, "primvars:displayColor", kind, colors, over="uniform")

    def _bind(self, mesh: Any, looks: list[Look], starts: list[int]) -> dict[str, int]:
        """Bind materials: one to the mesh, several to subsets of its faces."""
        paths = [self.materials.path(*look) for look in looks]
        firsts = [run for run, path in enumerate(paths) if not run or path != paths[run - 1]]
        if len(firsts) == 1:
            point_at(mesh, "material:binding", paths[:1])
            return {"": 0}
        family = "subsetFamily:materialBind:familyType"
        add_attribute(mesh, family, Types.Token, "partition", uniform=True)
        for run, end in zip(firsts, [*firsts[1:], len(looks)], strict=True):
            subset = add_prim(mesh, paths[run].name, "GeomSubset")
            rows = integers(np.arange(starts[run], starts[end]))
            apply_schemas(subset, "MaterialBindingAPI")
            add_attribute(subset, "elementType", Types.Token, "face", uniform=True)
            add_attribute(subset, "familyName", Types.Token, "materialBind", uniform=True)
            add_attribute(subset, "indices", Types.IntArray, rows)
            point_at(subset, "material:binding", [paths[run]])
        return {paths[run].name: run for run in firsts}

    def instance_layer(self, name: str, rows: Instances) -> None:
        """Write a point instancer with a prototype for each shape and tint."""
        numbers = np.unique(rows.prototype).tolist()
        kinds = [self.scene.prototypes[number] for number in numbers]
        shapes = dict(zip(numbers, self.shapes(kinds), strict=True))
        kept = np.array([shapes[number] is not None for number in rows.prototype.tolist()], bool)
        if not kept.any():
            return
        instancer = add_prim(self.city, name, "PointInstancer")
        instancer.kind = Kind.Tokens.component
        self.note_instancer(instancer)
        scope = add_prim(instancer, "Prototypes", "Scope")
        plain = [number for number, shape in shapes.items() if shape and not shape.takes_tint]
        steps = tint_steps(rows.tint)
        steps[np.isin(rows.prototype, plain)] = TINT_STEPS
        members = np.flatnonzero(kept)
        keys = packed(rows.prototype, steps)[members]
        _, first, variant = np.unique(keys, return_index=True, return_inverse=True)
        targets = []
        for row, count in zip(members[first].tolist(), np.bincount(variant).tolist(), strict=True):
            number = int(rows.prototype[row])
            shape = cast(_Shape, shapes[number])
            title = look_name(self.scene.prototypes[number].name, as_steps(steps[row]))
            targets.append(self.variant(scope, title, shape, steps[row]).path)
            self.triangles_instanced += shape.triangles * count
        self.instances += len(members)
        self.prototypes += len(targets)
        point_at(instancer, "prototypes", targets)
        _place(instancer, rows, members, variant)

    def note_instancer(self, instancer: Any) -> None:
        """Remember an instancer, whose extent is worked out when all is written."""
        self._instancers.append(instancer.path)

    def shapes(self, prototypes: Sequence[Prototype]) -> list[_Shape | None]:
        """Write the meshes of prototypes once; None where one has no faces."""
        new = [kind for kind in prototypes if kind.name not in self._shapes]
        for kind, thing in zip(new, things_of(new), strict=True):
            self._shapes[kind.name] = self._base(kind, thing) if len(kind.mesh.faces) else None
        return [self._shapes[kind.name] for kind in prototypes]

    def _base(self, prototype: Prototype, thing: Thing) -> _Shape:
        """Write the mesh of a prototype in the colours it has by itself."""
        batch = prototype.mesh
        faces = usd_faces(batch, np.zeros((batch.count, 3)))
        looks = _looks(faces, batch.materials)
        mesh = add_prim(self.shared, prototype.name, "Mesh")
        self._describe(mesh, {"kind": prototype.kind}, schemas_of(thing))
        if thing.collider:
            self.physics.thing(mesh, thing)
        holders = self._fill(mesh, batch, faces, 0, looks)
        self.triangles_unique += batch.triangle_count
        tinted = bool(takes_tint([material for material, _ in looks]).any())
        return _Shape(mesh.path, looks, holders, tinted, batch.triangle_count)

    def variant(self, scope: Any, title: str, shape: _Shape, tint: NDArray[np.int64]) -> Any:
        """Write a prototype in one tint: it refers to the shape and changes colours alone."""
        mesh = add_prim(scope, title, "Mesh")
        refer(mesh, shape.path)
        if (tint == TINT_STEPS).all():
            return mesh
        tints = tint_steps(tint_of([steps for _, steps in shape.looks]) * tint_of(tint))
        takes = takes_tint([material for material, _ in shape.looks]).tolist()
        looks = [
            (material, as_steps(mixed)) if tinted else (material, steps)
            for (material, steps), mixed, tinted in zip(shape.looks, tints, takes, strict=True)
        ]
        self._paint(mesh, looks)
        for holder, run in shape.holders.items():
            path = self.materials.path(*looks[run])
            if path == self.materials.path(*shape.looks[run]):
                continue  # it has no texture and reads the colours
            over = add_prim(mesh, holder, specifier=Sdf.SpecifierOver) if holder else mesh
            point_at(over, "material:binding", [path])
        return mesh

    def author_extents(self) -> None:
        """Write the extent of each instancer, which USD itself works out from its prototypes."""
        stage = Usd.Stage.Open(self.layer)
        for path in self._instancers:
            instancer = UsdGeom.PointInstancer.Get(stage, path)
            time = Usd.TimeCode.Default()
            instancer.CreateExtentAttr(UsdGeom.Boundable.ComputeExtentFromPlugins(instancer, time))


def _looks(faces: UsdFaces, materials: tuple[str, ...]) -> list[Look]:
    """Material and tint of each run."""
    names = [materials[number] for number in faces.run_material.tolist()]
    return list(zip(names, map(as_steps, faces.run_steps), strict=True))


def _write_head(layer: Any, view: Any) -> None:
    frame = view.frame
    root = layer.pseudoRoot
    root.SetInfo("upAxis", "Z")
    root.SetInfo("metersPerUnit", 1.0)
    root.SetInfo("kilogramsPerUnit", 1.0)
    layer.defaultPrim = "City"
    layer.documentation = f"{view.name}, made by CityX {__version__}"
    layer.customLayerData = {
        "cityx": __version__,
        "name": view.name,
        "seed": getattr(view, "seed", 0),
        "latitude": frame.latitude,
        "longitude": frame.longitude,
        "projection": frame.projection,
        "attribution": Vt.StringArray(list(view.attribution)),
    }


def _place(
    instancer: Any, rows: Instances, kept: NDArray[np.int64], prototype: NDArray[np.int64]
) -> None:
    """Write where the kept rows stand; `prototype` counts the targets of the instancer."""
    position = finite(rows.position[kept])
    origin = np.round(position.mean(axis=0), 2)
    turns = quaternions(rows.rotation[kept])
    move_to(instancer, origin)
    add_attribute(instancer, "protoIndices", Types.IntArray, integers(prototype))
    add_attribute(instancer, "positions", Types.Point3fArray, vectors(position - origin))
    # Half floats turn a cornice of ten metres aside by 5 mm, so exact turns go with them; Blender
    # and older programs read the halves, newer ones prefer the others.
    half = Vt.QuathArray.FromNumpy(turns.astype(np.float16))
    add_attribute(instancer, "orientations", Types.QuathArray, half)
    exact = Vt.QuatfArray.FromNumpy(turns.astype(np.float32))
    add_attribute(instancer, "orientationsf", Types.QuatfArray, exact)
    add_attribute(instancer, "scales", Types.Float3Array, vectors(rows.scale[kept]))
    add_attribute(instancer, "ids", Types.Int64Array, long_integers(rows.object_id[kept]))
    add_attribute(instancer, "cityx:owner", Types.Int64Array, long_integers(rows.owner[kept]))
    tint = vectors(rows.tint[kept])
    add_attribute(instancer, "primvars:cityx:tint", Types.Color3fArray, tint, over="vertex")
