"""Models: the geometry of assets, shells of their own and fittings shared by many.

A building asset is a shell and rows that place windows, doors and trims on it, so that a library of
thousands stays small and a placed asset is instances throughout.
"""

from __future__ import annotations

import json
import zlib
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from hashlib import blake2b
from pathlib import Path
from typing import Any
from zipfile import BadZipFile

import numpy as np
from numpy.typing import NDArray

from cityx.city.content import hash_mesh
from cityx.city.mesh import MeshBatch, concatenate, empty_batch
from cityx.city.rows import join_rows, take_rows
from cityx.city.scene import Instances, Prototype, Scene, no_instances
from cityx.errors import InputError
from cityx.geometry.arrays import FloatArray, IntArray
from cityx.geometry.ranges import numbered
from cityx.ids import id_text, mix

STEPS = 1e3  # fittings count in millimetres and thousandths
_ROWS = ("position", "rotation", "scale", "tint")


@dataclass(frozen=True)
class Models:
    """Geometry of n assets, each in its own frame: z up, ground at 0.

    Attributes
    ----------
    shells
        n objects; their ids are 0 to n - 1.
    fittings
        (m,) rows; ``owner`` is the number of the asset, 0 to n - 1.
    layer
        (m,) int16 into `layers`.
    prototypes
        Meshes that the fittings place.
    layers
        Layers of a scene that the fittings belong to.
    """

    shells: MeshBatch
    fittings: Instances
    layer: NDArray[np.int16]
    prototypes: tuple[Prototype, ...]
    layers: tuple[str, ...]

    @property
    def count(self) -> int:
        """Number of assets."""
        return self.shells.count

    def triangles(self) -> tuple[IntArray, IntArray]:
        """Count triangles: (n,) of the shells alone, and (n,) with every fitting."""
        quads = self.shells.faces[:, 3] >= 0
        of = self.shells.face_object()
        own = np.bincount(of, weights=1.0 + quads, minlength=self.count).astype(np.int64)
        each = np.array([p.mesh.triangle_count for p in self.prototypes], np.int64)
        fitted = np.zeros(self.count, np.int64)
        if self.fittings.count:
            np.add.at(fitted, self.fittings.owner.astype(np.int64), each[self.fittings.prototype])
        return own, own + fitted

    def take(self, assets: Any) -> Models:
        """Return the models of the given assets, in that order."""
        wanted = np.asarray(assets, np.int64)
        shells = self.shells.take(wanted)
        shells = replace(shells, object_id=np.arange(len(wanted), dtype=np.uint64))
        order = np.argsort(self.fittings.owner, kind="stable")
        owner = self.fittings.owner[order].astype(np.int64)
        begin, end = np.searchsorted(owner, wanted), np.searchsorted(owner, wanted, side="right")
        length = end - begin
        new_owner = np.repeat(np.arange(len(wanted)), length)
        offset = numbered(length)
        rows = order[np.repeat(begin, length) + offset]
        return Models(
            shells,
            replace(take_rows(self.fittings, rows), owner=new_owner.astype(np.uint64)),
            self.layer[rows],
            self.prototypes,
            self.layers,
        )

    def prototype(self, asset: int, name: str, kind: str = "asset") -> Prototype:
        """Return the shell of one asset as a prototype."""
        shell = self.shells.one(asset)
        return Prototype(name, kind, _own_materials(replace(shell, object_id=_ZERO)))

    def realised(self, asset: int) -> MeshBatch:
        """Return one asset as a single mesh, its fittings included."""
        one = self.take([asset])
        parts = [one.shells]
        for number in np.unique(one.fittings.prototype).tolist():
            rows = np.flatnonzero(one.fittings.prototype == number)
            placed = take_rows(one.fittings, rows)
            parts.append(_copies(self.prototypes[number].mesh, placed))
        joined = concatenate(parts)
        return _own_materials(
            replace(
                joined,
                object_id=_ZERO,
                vertex_start=np.array([0, len(joined.vertices)], np.int64),
                face_start=np.array([0, len(joined.faces)], np.int64),
            )
        )


_ZERO = np.zeros(1, np.uint64)


def turns(rotation: NDArray[Any]) -> FloatArray:
    """Return the (n, 3, 3) matrices of XYZ Euler angles, (n, 3) radians."""
    sx, sy, sz = np.sin(np.asarray(rotation, float)).T
    cx, cy, cz = np.cos(np.asarray(rotation, float)).T
    return np.stack(
        [
            np.stack([cy * cz, sx * sy * cz - cx * sz, cx * sy * cz + sx * sz], axis=-1),
            np.stack([cy * sz, sx * sy * sz + cx * cz, cx * sy * sz - sx * cz], axis=-1),
            np.stack([-sy, sx * cy, cx * cy], axis=-1),
        ],
        axis=-2,
    )


def _copies(mesh: MeshBatch, rows: Instances) -> MeshBatch:
    """Return one object of as many copies of a mesh as there are rows."""
    from cityx.assets.styles.materials import MATERIALS

    count = rows.count
    scaled = mesh.vertices[None] * rows.scale[:, None, :].astype(float)
    vertices = np.einsum("nij,nvj->nvi", turns(rows.rotation), scaled) + rows.position[:, None, :]
    shift = np.arange(count)[:, None, None] * len(mesh.vertices)
    faces = np.where(mesh.faces[None] < 0, -1, mesh.faces[None] + shift)
    takes = np.array([name not in MATERIALS or MATERIALS[name].takes_tint
                      for name in mesh.materials] or [True])  # fmt: skip
    factor = np.where(takes[mesh.material][None, :, None], rows.tint[:, None, :], np.float32(1))
    total = count * len(mesh.faces)
    return MeshBatch(
        _ZERO,
        np.array([0, count * len(mesh.vertices)], np.int64),
        np.array([0, total], np.int64),
        vertices.reshape(-1, 3),
        faces.reshape(-1, 4).astype(np.int32),
        np.tile(mesh.material, count),
        mesh.materials,
        np.tile(mesh.uv, (count, 1, 1)),
        (mesh.tint[None] * factor).reshape(total, 3).astype(np.float32),
    )


def _own_materials(mesh: MeshBatch) -> MeshBatch:
    """Leave out names of materials that no face uses."""
    used, number = np.unique(mesh.material, return_inverse=True)
    names = tuple(mesh.materials[index] for index in used.tolist())
    return replace(mesh, material=number.astype(np.int16), materials=names)


def models_of_prototypes(prototypes: Sequence[Prototype]) -> Models:
    """Make models of meshes that have no fittings."""
    shells = concatenate([prototype.mesh for prototype in prototypes])
    shells = replace(shells, object_id=np.arange(len(prototypes), dtype=np.uint64))
    return as_stored(Models(shells, no_instances(), np.zeros(0, np.int16), (), ()))


def models_of_scene(
    scene: Scene, ids: NDArray[np.uint64], origin: FloatArray, layer: str = "buildings"
) -> Models:
    """Cut objects out of a scene, with every instance they own.

    Parameters
    ----------
    scene
        The scene.
    ids
        (n,) ids of objects; one without a mesh gets an empty shell.
    origin
        (n, 3) place of each that becomes the origin of its frame.
    layer
        Mesh layer of the shells.
    """
    batch = scene.meshes.get(layer, empty_batch())
    row = np.minimum(np.searchsorted(batch.object_id, ids), max(batch.count - 1, 0))
    found = np.flatnonzero(batch.object_id[row] == ids) if batch.count else np.zeros(0, np.int64)
    held = batch.take(row[found])
    moved = held.vertices - np.repeat(origin[found], np.diff(held.vertex_start), axis=0)
    sizes = np.zeros((2, len(ids)), np.int64)
    sizes[0, found], sizes[1, found] = np.diff(held.vertex_start), np.diff(held.face_start)
    starts = np.concatenate([np.zeros((2, 1), np.int64), np.cumsum(sizes, axis=1)], axis=1)
    shells = replace(held, object_id=np.arange(len(ids), dtype=np.uint64), vertices=moved,
                     vertex_start=starts[0], face_start=starts[1])  # fmt: skip
    order = np.argsort(ids, kind="stable")
    tables: list[Instances] = []
    layers: list[str] = []
    layer_of: list[NDArray[np.int16]] = []
    for name, rows in scene.instances.items():
        if not rows.count:
            continue
        at = np.minimum(np.searchsorted(ids[order], rows.owner), len(ids) - 1)
        owned = np.flatnonzero((ids[order][at] == rows.owner) & (rows.owner != 0))
        owner = order[at[owned]]
        part = take_rows(rows, owned)
        part = replace(part, owner=owner.astype(np.uint64), position=part.position - origin[owner])
        tables.append(part)
        layer_of.append(np.full(len(owned), len(layers), np.int16))
        layers.append(name)
    fittings = join_rows(tables)
    number = np.concatenate(layer_of) if layer_of else np.zeros(0, np.int16)
    # Sorted by asset, so that each is one slice of the table.
    by_owner = np.lexsort((fittings.object_id, number, fittings.owner))
    fittings = take_rows(fittings, by_owner)
    used, prototype = np.unique(fittings.prototype, return_inverse=True)
    fittings = replace(
        fittings,
        prototype=prototype.astype(np.int32),
        object_id=np.zeros(fittings.count, np.uint64),
    )
    prototypes = tuple(scene.prototypes[index] for index in used.tolist())
    return as_stored(Models(shells, fittings, number[by_owner], prototypes, tuple(layers)))


def join_models(parts: Sequence[Models]) -> Models:
    """Put models one after the other; prototypes of the same name are taken to be the same."""
    if len(parts) == 1:
        return parts[0]
    prototypes = {p.name: p for part in parts for p in part.prototypes}
    layers = list(dict.fromkeys(name for part in parts for name in part.layers))
    number = {name: index for index, name in enumerate(prototypes)}
    tables, layer, first = [], [], 0
    for part in parts:
        table = np.array([number[p.name] for p in part.prototypes] or [0], np.int32)
        rows = part.fittings
        tables.append(
            replace(rows, prototype=table[rows.prototype], owner=rows.owner + np.uint64(first))
        )
        names = np.array([layers.index(name) for name in part.layers] or [0], np.int16)
        layer.append(names[part.layer])
        first += part.count
    shells = concatenate([part.shells for part in parts])
    return Models(
        replace(shells, object_id=np.arange(first, dtype=np.uint64)),
        join_rows(tables),
        np.concatenate(layer) if layer else np.zeros(0, np.int16),
        tuple(prototypes.values()),
        tuple(layers),
    )


def as_stored(models: Models) -> Models:
    """Round geometry to the precision of a pack, so that hashes before and after agree."""
    shells, rows = models.shells, models.fittings
    return replace(
        models,
        shells=replace(shells, vertices=_stored(shells.vertices)),
        fittings=replace(rows, position=_stored(rows.position)),
    )


def _stored(values: FloatArray) -> FloatArray:
    # Tenths of a millimetre: below what is seen, above where machines differ in the last bits.
    return (np.round(values, 4) + 0.0).astype(np.float32).astype(np.float64)


def content_hashes(models: Models) -> NDArray[np.uint64]:
    """Hash every asset by its geometry alone, (n,); order of rows does not count."""
    hashes = np.zeros(models.count, np.uint64)
    ids, shells = hash_mesh(models.shells)
    hashes[ids.astype(np.int64)] = shells
    rows = models.fittings
    if not rows.count:
        return mix(hashes ^ mix(np.zeros(models.count, np.uint64)))
    names = np.array([_prototype_hash(p) for p in models.prototypes], np.uint64)
    total = names[rows.prototype]
    for name in _ROWS:
        steps = np.rint(np.asarray(getattr(rows, name), float) * STEPS).astype(np.int64)
        for column in steps.view(np.uint64).T:
            total = mix(total ^ column)
    fitted = np.zeros(models.count, np.uint64)
    with np.errstate(over="ignore"):
        np.add.at(fitted, rows.owner.astype(np.int64), total)
    return mix(hashes ^ mix(fitted))


def _prototype_hash(prototype: Prototype) -> int:
    text = prototype.name.encode() + hash_mesh(prototype.mesh)[1].tobytes()
    return int.from_bytes(blake2b(text, digest_size=8).digest(), "little")


# --- files ----------------------------------------------------------------------------------------


def write_pack(path: Path, models: Models, names: Sequence[str], fittings: Sequence[str]) -> None:
    """Write models as one NPZ.

    Parameters
    ----------
    path
        File to write.
    names
        (n,) names of the assets in the pack.
    fittings
        Names of the prototypes in the library's file of fittings, one per prototype.
    """
    shells, rows = models.shells, models.fittings
    head = {
        "names": list(names),
        "materials": list(shells.materials),
        "fittings": list(fittings),
        "layers": list(models.layers),
    }
    np.savez_compressed(
        path,
        head=np.frombuffer(json.dumps(head).encode(), np.uint8),
        vertex_start=shells.vertex_start,
        face_start=shells.face_start,
        vertices=shells.vertices.astype(np.float32),
        faces=shells.faces,
        material=shells.material,
        uv=shells.uv,
        tint=shells.tint,
        fitting=rows.prototype,
        owner=rows.owner.astype(np.int32),
        layer=models.layer,
        **{f"row_{name}": getattr(rows, name).astype(np.float32) for name in _ROWS},
    )


def read_pack(path: Path, shared: Mapping[str, Prototype]) -> tuple[Models, tuple[str, ...]]:
    """Read a pack back: the models and their names.

    Parameters
    ----------
    shared
        Prototypes of the library by name.

    Raises
    ------
    InputError
        If the file is missing, cut or no pack.
    """
    try:
        with path.open("rb") as file, np.load(file) as held:
            arrays = {name: held[name] for name in held.files}
        head = json.loads(bytes(arrays["head"]))
        prototypes = tuple(shared[name] for name in head["fittings"])
        count = len(head["names"])
        shells = MeshBatch(
            np.arange(count, dtype=np.uint64), arrays["vertex_start"], arrays["face_start"],
            arrays["vertices"].astype(np.float64), arrays["faces"], arrays["material"],
            tuple(head["materials"]), arrays["uv"], arrays["tint"],
        )  # fmt: skip
        number = len(arrays["owner"])
        rows = Instances(
            arrays["fitting"], np.zeros(number, np.uint64), arrays["owner"].astype(np.uint64),
            arrays["row_position"].astype(np.float64), arrays["row_rotation"],
            arrays["row_scale"], arrays["row_tint"],
        )  # fmt: skip
    except FileNotFoundError:
        raise InputError(f"{path} is missing from the library.") from None
    except (OSError, ValueError, KeyError, EOFError, BadZipFile, zlib.error) as error:
        raise InputError(f"{path} is no pack of assets: {error}.") from None
    layers = tuple(head["layers"])
    return Models(shells, rows, arrays["layer"], prototypes, layers), tuple(head["names"])


def write_prototypes(path: Path, prototypes: Iterable[Prototype]) -> None:
    """Write prototypes, sorted by name, as one NPZ."""
    held = sorted(prototypes, key=lambda prototype: prototype.name)
    shared = concatenate([prototype.mesh for prototype in held])
    head = {
        "names": [prototype.name for prototype in held],
        "kinds": [prototype.kind for prototype in held],
        "materials": list(shared.materials),
    }
    np.savez_compressed(
        path,
        head=np.frombuffer(json.dumps(head).encode(), np.uint8),
        vertex_start=shared.vertex_start,
        face_start=shared.face_start,
        vertices=shared.vertices,
        faces=shared.faces,
        material=shared.material,
        uv=shared.uv,
        tint=shared.tint,
    )


def read_prototypes(path: Path) -> dict[str, Prototype]:
    """Read prototypes back, by name.

    Raises
    ------
    InputError
        If the file is missing or broken.
    """
    try:
        with path.open("rb") as file, np.load(file) as held:
            arrays = {name: held[name] for name in held.files}
        head = json.loads(bytes(arrays.pop("head")))
        count = len(head["names"])
        shared = MeshBatch(np.zeros(count, np.uint64), **arrays, materials=tuple(head["materials"]))
    except FileNotFoundError:
        raise InputError(f"{path} is missing from the library.") from None
    except (OSError, ValueError, KeyError, TypeError, EOFError, BadZipFile, zlib.error) as error:
        raise InputError(f"{path} holds no fittings: {error}.") from None
    return {
        name: Prototype(name, kind, _own_materials(shared.one(row)))
        for row, (name, kind) in enumerate(zip(head["names"], head["kinds"], strict=True))
    }


def fitting_names(
    prototypes: Sequence[Prototype], known: Mapping[str, Prototype]
) -> tuple[tuple[str, ...], dict[str, Prototype]]:
    """Name prototypes for a library: one of another mesh under a known name gets a new name.

    Returns
    -------
    names
        One per prototype.
    added
        Prototypes the library does not hold yet, by that name.
    """
    names: list[str] = []
    added: dict[str, Prototype] = {}
    for prototype in prototypes:
        name = prototype.name
        held = known.get(name) or added.get(name)
        if held is not None and _prototype_hash(held) != _prototype_hash(prototype):
            name = f"{name}_{id_text(_prototype_hash(prototype))[:8]}"
        if name not in known and name not in added:
            added[name] = replace(prototype, name=name)
        names.append(name)
    return tuple(names), added


def models_height(models: Models) -> FloatArray:
    """Return the highest vertex of every shell, (n,) metres; 0 of an empty one."""
    high = np.zeros(models.count)
    filled = np.flatnonzero(np.diff(models.shells.vertex_start) > 0)
    if len(filled):
        z = models.shells.vertices[:, 2]
        high[filled] = np.maximum.reduceat(z, models.shells.vertex_start[:-1][filled])
    return high
