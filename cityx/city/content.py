"""Content hashes: one per object and one for the whole city.

Coordinates are hashed in whole millimetres and angles, colours and other numbers in millionths, so
that the last bits of floating point, which differ between machines, do not count. Order of rows and
of objects does not count either.
"""

from __future__ import annotations

import json
import operator
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field, fields
from hashlib import blake2b, sha256
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any
from zlib import crc32

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.city.layout import SCHEMA
from cityx.city.mesh import same_objects
from cityx.city.rows import take_rows
from cityx.geometry.ranges import equal_rows
from cityx.ids import UInt64Array, id_text, mix

if TYPE_CHECKING:
    from geopandas import GeoDataFrame

    from cityx.city.city import City
    from cityx.city.mesh import MeshBatch
    from cityx.city.scene import Instances, Scene
    from cityx.city.tracks import Tracks

HASHES = "hashes.npz"  # file of a store: the hash of the city in it
PER_METRE = 1e3  # coordinates count in millimetres
METHOD = 3  # of hashing; a file of hashes by another one says nothing


@dataclass(frozen=True)
class ContentHash:
    """Hashes of a city.

    Attributes
    ----------
    total
        64 hexadecimal digits over features, terrain, ground, meshes, instances, tracks and
        environment.
    layers
        Layer name (``layout/roads``, ``meshes/buildings``, ...) to its object ids and their hashes,
        both (n,) uint64, sorted by id.
    parts
        Hash of what holds no objects of its own, by name: "terrain", "ground".
    prototypes
        (p,) uint64, of the prototypes of the scene.
    """

    total: str
    layers: Mapping[str, tuple[UInt64Array, UInt64Array]]
    parts: Mapping[str, str] = field(default_factory=lambda: MappingProxyType({}))
    prototypes: UInt64Array = field(default_factory=lambda: np.zeros(0, np.uint64))

    def of_object(self, object_id: int) -> str:
        """Return the hash over every layer that holds the object, 16 hexadecimal digits."""
        found = np.zeros(1, np.uint64)
        for name in sorted(self.layers):
            ids, hashes = self.layers[name]
            rows = slice(*np.searchsorted(ids, [object_id, object_id + 1]).tolist())
            for value in hashes[rows]:
                found = mix(found ^ value)
        return id_text(int(found[0]))


def _digest(*parts: bytes) -> int:
    hasher = sha256()  # processors have instructions for it: two to three times as fast as blake2b
    for part in parts:
        hasher.update(part)
    return int.from_bytes(hasher.digest()[:8], "little")


def _millimetres(values: NDArray[Any]) -> NDArray[np.int32]:
    """Whole millimetres; what lies within 2,147 km, as every city does, fits."""
    return np.asarray(np.rint(values * PER_METRE), np.int32)


def _quantised(values: Any, steps: float) -> bytes:
    scaled = np.nan_to_num(np.asarray(values, dtype=float) * steps, nan=-9.0e15)
    return np.rint(scaled).astype(np.int64).tobytes()


def hash_table(table: GeoDataFrame, name: str) -> tuple[UInt64Array, UInt64Array]:
    """Hash the rows of a feature table; returns ids and hashes, sorted by id."""
    import pandas as pd

    schema = SCHEMA[name]
    columns = pd.DataFrame(
        {
            key: np.round(table[key], 6) + 0.0 if dtype == "float64" else table[key]
            for key, dtype in schema.items()
        }
    )
    attributes = pd.util.hash_pandas_object(columns, index=False).to_numpy(np.uint64)
    geometry = shapely.transform(table.geometry.to_numpy(), lambda c: np.round(c, 3) + 0.0)
    shapes = np.array([_digest(wkb) for wkb in shapely.to_wkb(geometry)], np.uint64)
    ids = table["id"].to_numpy(np.uint64)
    return _sorted(ids, mix(attributes ^ mix(shapes)))


def hash_mesh(batch: MeshBatch) -> tuple[UInt64Array, UInt64Array]:
    """Hash the objects of a mesh layer; returns ids and hashes, sorted by id."""
    vertices = _millimetres(batch.vertices)
    names = np.array([_digest(name.encode()) for name in batch.materials] or [0], np.uint64)
    material = names[batch.material] if len(batch.material) else np.zeros(0, np.uint64)
    uv, tint = _millimetres(batch.uv), _millimetres(batch.tint)
    shift = np.repeat(batch.vertex_start[:-1], np.diff(batch.face_start)).astype(np.int32)
    faces = np.where(batch.faces < 0, -1, batch.faces - shift[:, None]).astype(np.int32)
    hashes = np.zeros(batch.count, np.uint64)
    vertex_start, face_start = batch.vertex_start.tolist(), batch.face_start.tolist()
    for index in range(batch.count):
        v = slice(vertex_start[index], vertex_start[index + 1])
        f = slice(face_start[index], face_start[index + 1])
        parts = (vertices[v], faces[f], material[f], uv[f], tint[f])
        hashes[index] = _digest(*(part.tobytes() for part in parts))
    return _sorted(batch.object_id, hashes)


def hash_instances(rows: Instances, names: NDArray[np.uint64]) -> tuple[UInt64Array, UInt64Array]:
    """Hash instance rows; `names` are hashes of the prototypes' names and meshes."""
    total = mix(rows.object_id ^ mix(rows.owner))
    if rows.count:
        total = mix(total ^ names[rows.prototype])
    for values in (rows.position, rows.rotation, rows.scale, rows.tint):
        # Measures of half a millimetre are usual: the last bits must not decide where they go.
        whole = np.round(np.asarray(values, float), 6)
        steps = np.rint(whole * PER_METRE).astype(np.int64).view(np.uint64)
        for column in steps.T:
            total = mix(total ^ column)
    return _sorted(rows.object_id, total)


def hash_tracks(tracks: Tracks) -> tuple[UInt64Array, UInt64Array]:
    """Hash the movers of tracks; returns ids and hashes, sorted by id."""
    hashes = np.zeros(tracks.count, np.uint64)
    texts = (tracks.look.astype("U64"), tracks.origin.astype("U64"))
    own: tuple[NDArray[Any], ...] = (
        tracks.kind, *texts, _steps(tracks.tint), _steps(tracks.size)
    )  # fmt: skip
    ways = (tracks.time, tracks.position, tracks.heading, tracks.speed)
    samples: tuple[NDArray[Any], ...] = (*map(_steps, ways), tracks.gait, tracks.place)
    start = tracks.sample_start.tolist()
    for row in range(tracks.count):
        part = slice(start[row], start[row + 1])
        held = [values[row].tobytes() for values in own]
        hashes[row] = _digest(*held, *(values[part].tobytes() for values in samples))
    return _sorted(tracks.object_id, hashes)


def _steps(values: Any) -> NDArray[np.int64]:
    return np.asarray(np.rint(np.asarray(values, float) * PER_METRE), np.int64)


def _sorted(ids: UInt64Array, hashes: UInt64Array) -> tuple[UInt64Array, UInt64Array]:
    """Sort by id, and by the hash where an id occurs again."""
    if (ids[1:] > ids[:-1]).all():
        return ids, hashes
    if (ids[1:] < ids[:-1]).any():
        order = np.argsort(ids, kind="stable")  # quick where runs are in order already
        ids, hashes = ids[order], hashes[order]
    tied = np.flatnonzero(_shared(ids))
    hashes = hashes.copy()
    hashes[tied] = hashes[tied[np.lexsort((hashes[tied], ids[tied]))]]
    return ids, hashes


def _shared(ids: UInt64Array) -> NDArray[np.bool_]:
    """(n,) whether an id stands beside its like; ids are sorted."""
    again = ids[1:] == ids[:-1]
    found = np.append(again, False)[: len(ids)] | np.append(False, again)[: len(ids)]
    return np.asarray(found, bool)


def scene_key(scene: Scene) -> str:
    """Return a key of a scene as it is stored, 32 hexadecimal digits: other bytes, another key.

    It tells a view which state of a city it shows; `content_hash` is the one to compare builds by.
    Of each array 32 bits count, which take a fifth of the time of a hash of all its bytes.
    """
    hasher = blake2b(digest_size=16)
    shared = ((prototype.name, prototype.mesh) for prototype in scene.prototypes)
    tables: list[tuple[str, MeshBatch | Instances]] = [*scene.meshes.items(), *shared]
    tables += scene.instances.items()
    for name, value in tables:
        hasher.update(name.encode())
        for column in fields(value):
            held = getattr(value, column.name)
            if isinstance(held, np.ndarray):
                held = (held.dtype.str, held.shape, crc32(np.ascontiguousarray(held).data))
            hasher.update(repr(held).encode())
    return hasher.hexdigest()


def differing_ids(
    old: tuple[UInt64Array, UInt64Array], new: tuple[UInt64Array, UInt64Array]
) -> UInt64Array:
    """Return the ids whose hashes, as of `hash_mesh`, are not the same in any order, sorted."""
    ids = np.unique(np.concatenate([old[0], new[0]]))
    sums = []
    for owner, hashes in (old, new):
        total = np.zeros(len(ids), np.uint64)
        np.add.at(total, np.searchsorted(ids, owner), mix(hashes))
        sums.append(total)
    return np.asarray(ids[sums[0] != sums[1]])


def content_hash(city: City, like: tuple[City, ContentHash] | None = None) -> ContentHash:
    """Hash a city: the same for every build order, process and machine.

    Parameters
    ----------
    city
        The city.
    like
        Another city with its hash: what the two share is not hashed again.
    """
    prototypes = _hash_prototypes(city, like)
    layers = {name: _hash_layer(name, value, prototypes, like)
              for name, value in _layers(city).items()}  # fmt: skip
    parts = {}
    for name, value in _parts(city).items():
        known = like is not None and name in like[1].parts and _parts(like[0])[name] is value
        parts[name] = like[1].parts[name] if like is not None and known else _part(value)
    whole = blake2b(digest_size=32)
    whole.update(_quantised(city.layout.extent, PER_METRE))
    whole.update(json.dumps(asdict(city.environment), sort_keys=True).encode())
    for name in sorted(parts):
        whole.update(f"{name} {parts[name]}".encode())
    for name in sorted(layers):
        ids, hashes = layers[name]
        whole.update(name.encode())
        whole.update(ids.tobytes())
        whole.update(hashes.tobytes())
    return ContentHash(whole.hexdigest(), layers, parts, prototypes)


def _layers(city: City) -> dict[str, Any]:
    """Return what holds objects, by layer."""
    found: dict[str, Any] = {f"layout/{name}": getattr(city.layout, name) for name in SCHEMA}
    found |= {f"meshes/{layer}": batch for layer, batch in city.scene.meshes.items()}
    found |= {f"instances/{layer}": rows for layer, rows in city.scene.instances.items()}
    return found if city.tracks is None else {**found, "tracks": city.tracks}


def _hash_layer(
    name: str, value: Any, prototypes: UInt64Array, like: tuple[City, ContentHash] | None
) -> tuple[UInt64Array, UInt64Array]:
    old = _layers(like[0]).get(name) if like is not None else None
    same = like is not None and old is value
    kind, _, own = name.partition("/")
    if kind == "instances":
        used = np.flatnonzero(np.bincount(value.prototype))
        first = like[1].prototypes if like is not None else prototypes[:0]
        same &= not len(used) or (
            used[-1] < len(first) and np.array_equal(first[used], prototypes[used])
        )
        if like is None or old is None or name not in like[1].layers:
            return hash_instances(value, prototypes)
        if same:
            return like[1].layers[name]
        return _hash_changed_instances(value, old, prototypes, like[1].layers[name], first)
    if like is not None and same:
        return like[1].layers[name]
    if kind == "layout":
        if like is not None and old is not None:
            return _hash_changed_rows(value, old, own, like[1].layers[name])
        return hash_table(value, own)
    if kind == "tracks":
        return hash_tracks(value)
    if like is not None and old is not None and name in like[1].layers:
        return _hash_changed(value, old, like[1].layers[name])
    return hash_mesh(value)


def _hash_prototypes(city: City, like: tuple[City, ContentHash] | None) -> UInt64Array:
    """Hash the names and meshes of prototypes, (p,)."""
    known: dict[int, int] = {}
    if like is not None and len(like[1].prototypes) == len(like[0].scene.prototypes):
        hashes = like[1].prototypes.tolist()
        known = {id(p): one for p, one in zip(like[0].scene.prototypes, hashes, strict=True)}
    found = [
        known[id(prototype)] if id(prototype) in known else
        _digest(prototype.name.encode(), hash_mesh(prototype.mesh)[1].tobytes())
        for prototype in city.scene.prototypes
    ]  # fmt: skip
    return np.array(found, np.uint64)


def _hash_changed_rows(
    table: GeoDataFrame, old: GeoDataFrame, name: str, held: tuple[UInt64Array, UInt64Array]
) -> tuple[UInt64Array, UInt64Array]:
    """Hash the rows of a table that another state of it has not just so; both sorted by id."""
    ids, known = (each["id"].to_numpy(np.uint64) for each in (table, old))
    if not len(known) or not np.array_equal(known, held[0]) or len(np.unique(known)) < len(known):
        return hash_table(table, name)
    same, at = same_features(table, old, name)
    fresh = hash_table(table.iloc[np.flatnonzero(~same)], name)
    return _sorted(
        np.concatenate([ids[same], fresh[0]]), np.concatenate([held[1][at[same]], fresh[1]])
    )


def _hash_changed(
    batch: MeshBatch, old: MeshBatch, held: tuple[UInt64Array, UInt64Array]
) -> tuple[UInt64Array, UInt64Array]:
    """Hash the objects of a layer that another state of it has not just so."""
    same = same_objects(batch, old)
    fresh = batch.take(np.flatnonzero(~same))
    ids, hashes = hash_mesh(fresh)
    kept = np.isin(held[0], batch.object_id[same])
    if np.count_nonzero(kept) != np.count_nonzero(same):  # ids that are not unique
        return hash_mesh(batch)
    return _sorted(np.concatenate([held[0][kept], ids]), np.concatenate([held[1][kept], hashes]))


def _hash_changed_instances(
    rows: Instances,
    old: Instances,
    prototypes: UInt64Array,
    held: tuple[UInt64Array, UInt64Array],
    before: UInt64Array,
) -> tuple[UInt64Array, UInt64Array]:
    """Hash the rows of a layer that another state of it has not just so.

    Only rows whose id is theirs alone count as the same; `before` are the prototypes' hashes then.
    """
    own, ids = old.object_id, rows.object_id
    told = old.count > 0 and len(before) > old.prototype.max() and np.array_equal(own, held[0])
    if not told or (ids[1:] < ids[:-1]).any():
        return hash_instances(rows, prototypes)
    same, at = same_rows(rows, old, prototypes, before)
    fresh = hash_instances(take_rows(rows, ~same), prototypes)
    return _sorted(
        np.concatenate([ids[same], fresh[0]]), np.concatenate([held[1][at[same]], fresh[1]])
    )


def same_features(
    table: GeoDataFrame, old: GeoDataFrame, name: str
) -> tuple[NDArray[np.bool_], NDArray[np.int64]]:
    """Find the rows of a feature table that another state of it, with rows, has just so.

    Both are sorted by id, of which each is there once; shapes count as the same where they are one
    object.

    Returns
    -------
    same, at
        (n,) whether a row is the same, and the row of the other state.
    """
    ids, known = (each["id"].to_numpy(np.uint64) for each in (table, old))
    at = np.minimum(np.searchsorted(known, ids), len(known) - 1)
    same = known[at] == ids
    shapes, others = table.geometry.to_numpy(), old.geometry.to_numpy()[at]
    same &= np.fromiter(map(operator.is_, shapes, others), bool, len(ids))
    for column in SCHEMA[name]:
        own, other = table[column].to_numpy(), old[column].to_numpy()[at]
        same &= (own == other) | ((own != own) & (other != other))  # NaN is NaN
    return same, at


def same_rows(
    rows: Instances, old: Instances, prototypes: NDArray[Any], before: NDArray[Any]
) -> tuple[NDArray[np.bool_], NDArray[np.int64]]:
    """Find the rows of a layer that another state of it has just so; both are sorted by id.

    Parameters
    ----------
    rows, old
        The layer, and another state of it with rows.
    prototypes, before
        What tells the prototypes apart that each counts.

    Returns
    -------
    same
        (n,) whether a row is the same; only those whose id is theirs alone are.
    at
        (n,) the row of the other state.
    """
    own, ids = old.object_id, rows.object_id
    at = np.minimum(np.searchsorted(own, ids), old.count - 1)
    same = (own[at] == ids) & ~_shared(ids) & ~_shared(own)[at]
    same &= prototypes[rows.prototype] == before[old.prototype][at]
    same &= rows.owner == old.owner[at]
    for name in ("position", "rotation", "scale", "tint"):
        same &= equal_rows(getattr(rows, name), getattr(old, name)[at])
    return same, at


def _parts(city: City) -> dict[str, Any]:
    """Return what holds no objects of its own, by name."""
    held = {"terrain": city.terrain, "network": city.network, "heights": city.heights,
            "lanes": city.lanes, "ground": city.ground, "signals": city.signals}  # fmt: skip
    return {name: value for name, value in held.items() if value is not None}


def _part(value: Any) -> str:
    """Hash the columns of a part, 32 hexadecimal digits."""
    hasher = blake2b(digest_size=16)
    for held in (getattr(value, column.name) for column in fields(value)):
        if held is None:
            continue
        values = np.asarray(held)
        exact = values.dtype.kind != "f"
        hasher.update(values.tobytes() if exact else _quantised(values, PER_METRE))
    return hasher.hexdigest()


def write_hash(found: ContentHash, path: Path) -> None:
    """Write a hash to a file (.npz), so that what changes later need not be hashed whole."""
    arrays: dict[str, NDArray[Any]] = {"prototypes": found.prototypes}
    for name, (ids, hashes) in found.layers.items():
        arrays[f"ids {name}"], arrays[f"hashes {name}"] = ids, hashes
    arrays["parts"] = np.array([f"{name} {value}" for name, value in found.parts.items()] or [""])
    arrays["total"], arrays["method"] = np.array([found.total]), np.array([METHOD])
    np.savez(path, **{key.replace("/", "|"): value for key, value in arrays.items()})


def stored_hash(store: Path) -> str:
    """Return the hash of a stored city; it is measured where none is kept."""
    held = read_hash(store / HASHES)
    if held is not None:
        return held.total
    from cityx.city.store import read_city

    return content_hash(read_city(store)).total


def read_hash(path: Path) -> ContentHash | None:
    """Read a hash back; None where there is none, or one by another method."""
    if not path.exists():
        return None
    with np.load(path) as held:
        arrays = {name.replace("|", "/"): held[name] for name in held.files}
    if arrays.get("method") != METHOD:
        return None
    layers = {
        name.removeprefix("ids "): (values, arrays[f"hashes {name.removeprefix('ids ')}"])
        for name, values in arrays.items() if name.startswith("ids ")
    }  # fmt: skip
    parts = dict(text.split(" ") for text in arrays["parts"].tolist() if text)
    return ContentHash(str(arrays["total"][0]), layers, parts, arrays["prototypes"])
