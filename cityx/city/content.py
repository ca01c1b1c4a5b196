"""Content hashes: one per object and one for the whole city.

Coordinates are hashed in whole millimetres and angles, colours and other numbers in millionths, so
that the last bits of floating point, which differ between machines, do not count. Order of rows and
of objects does not count either.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass, fields
from hashlib import blake2b
from typing import TYPE_CHECKING, Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.city.layout import SCHEMA
from cityx.geometry.identity import UInt64Array, id_text, mix

if TYPE_CHECKING:
    from geopandas import GeoDataFrame

    from cityx.city.city import City
    from cityx.city.mesh import MeshBatch
    from cityx.city.scene import Instances
    from cityx.city.tracks import Tracks

PER_METRE = 1e3  # coordinates count in millimetres
PER_UNIT = 1e6  # other numbers in millionths


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
    """

    total: str
    layers: Mapping[str, tuple[UInt64Array, UInt64Array]]

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
    hasher = blake2b(digest_size=8)
    for part in parts:
        hasher.update(part)
    return int.from_bytes(hasher.digest(), "little")


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
    vertices = np.rint(batch.vertices * PER_METRE).astype(np.int64)
    names = np.array([_digest(name.encode()) for name in batch.materials] or [0], np.uint64)
    material = names[batch.material] if len(batch.material) else np.zeros(0, np.uint64)
    uv = np.rint(batch.uv * PER_METRE).astype(np.int64)
    tint = np.rint(batch.tint * PER_METRE).astype(np.int32)
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
        steps = np.rint(np.asarray(values, float) * PER_METRE).astype(np.int64).view(np.uint64)
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
    order = np.lexsort((hashes, ids))
    return ids[order], hashes[order]


def content_hash(city: City) -> ContentHash:
    """Hash a city: the same for every build order, process and machine."""
    layers: dict[str, tuple[UInt64Array, UInt64Array]] = {}
    for name in SCHEMA:
        layers[f"layout/{name}"] = hash_table(getattr(city.layout, name), name)
    for layer, batch in city.scene.meshes.items():
        layers[f"meshes/{layer}"] = hash_mesh(batch)
    prototypes = np.array(
        [
            _digest(prototype.name.encode(), hash_mesh(prototype.mesh)[1].tobytes())
            for prototype in city.scene.prototypes
        ],
        np.uint64,
    )
    for layer, rows in city.scene.instances.items():
        layers[f"instances/{layer}"] = hash_instances(rows, prototypes)
    if city.tracks is not None:
        layers["tracks"] = hash_tracks(city.tracks)
    terrain = city.terrain
    whole = blake2b(digest_size=32)
    whole.update(_quantised(city.layout.extent, PER_METRE))
    whole.update(_quantised([*terrain.origin, terrain.cell, terrain.datum], PER_METRE))
    whole.update(_quantised(terrain.heights, PER_METRE))
    for value in (city.network, city.heights, city.lanes, city.ground, city.signals):
        for column in fields(value) if value is not None else ():
            values = np.asarray(getattr(value, column.name))
            exact = values.dtype.kind != "f"
            whole.update(values.tobytes() if exact else _quantised(values, PER_METRE))
    whole.update(json.dumps(asdict(city.environment), sort_keys=True).encode())
    for name in sorted(layers):
        ids, hashes = layers[name]
        whole.update(name.encode())
        whole.update(ids.tobytes())
        whole.update(hashes.tobytes())
    return ContentHash(whole.hexdigest(), layers)
