"""Layers: the tables, meshes and instances of a city as rows of objects, without their geometry."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from cityx.city import City
from cityx.city.layout import SCHEMA
from cityx.city.mesh import MeshBatch
from cityx.ids import UInt64Array, id_text

if TYPE_CHECKING:
    from geopandas import GeoDataFrame

    from cityx.city.scene import Instances, Prototype

MOST_LETTERS = 80  # of a text that came with a file: a name, never prose
_KIND_COLUMNS = ("kind", "use")
_HIDDEN = ("id", "tags")  # the id is told apart; tags are the file's own words
_MILLIMETRES = 3  # decimals


def shown(text: str) -> str:
    """Return a text of a file as data: one line, of bounded length, without control characters."""
    line = " ".join("".join(c if c.isprintable() else " " for c in text).split())
    return line if len(line) <= MOST_LETTERS else line[: MOST_LETTERS - 1] + "…"


@dataclass(frozen=True)
class Layer:
    """One layer of a city.

    Attributes
    ----------
    name
        Such as "layout/roads", "meshes/buildings" or "instances/trees".
    ids
        (n,) uint64.
    kinds, names
        (n,) texts; of meshes and instances names are "".
    places
        Called for the (n, 2) middles of the objects, metres.
    record
        Called with the index of a row for what else is known of it.
    """

    name: str
    ids: UInt64Array
    kinds: NDArray[Any]
    names: NDArray[Any]
    places: Callable[[], NDArray[np.float64]]
    record: Callable[[int], dict[str, Any]]


def layers_of(city: City) -> Iterator[Layer]:
    """Yield every layer of a city that holds objects."""
    for name in SCHEMA:
        table = getattr(city.layout, name)
        if len(table):
            yield _table_layer(name, table)
    for name, batch in city.scene.meshes.items():
        if batch.count:
            yield _mesh_layer(name, batch)
    for name, rows in city.scene.instances.items():
        if rows.count:
            yield _instance_layer(name, rows, city.scene.prototypes)


def _table_layer(name: str, table: GeoDataFrame) -> Layer:
    column = next((c for c in _KIND_COLUMNS if c in table), None)
    none = np.full(len(table), "", object)
    return Layer(
        f"layout/{name}",
        table["id"].to_numpy(np.uint64),
        none if column is None else table[column].to_numpy(object),
        table["name"].to_numpy(object) if "name" in table else none,
        partial(_table_places, table),
        partial(_table_record, table),
    )


def _table_places(table: GeoDataFrame) -> NDArray[np.float64]:
    bounds = table.geometry.bounds.to_numpy(float)  # (n, 4)
    middles: NDArray[np.float64] = (bounds[:, :2] + bounds[:, 2:]) / 2
    return middles


def _table_record(table: GeoDataFrame, row: int) -> dict[str, Any]:
    values = table.iloc[row]
    found = {name: plain(values[name]) for name in table.columns.drop("geometry")
             if name not in _HIDDEN}  # fmt: skip
    shape = values["geometry"]
    return found | {"geometry": shape.geom_type, "bounds": _rounded(shape.bounds)}


def _mesh_layer(name: str, batch: MeshBatch) -> Layer:
    return Layer(
        f"meshes/{name}",
        batch.object_id,
        np.full(batch.count, name, object),
        np.full(batch.count, "", object),
        lambda: np.array([_box(batch, row)[:, :2].mean(0) for row in range(batch.count)]),
        partial(_mesh_record, batch),
    )


def _box(batch: MeshBatch, row: int) -> NDArray[np.float64]:
    """Return the lowest and the highest coordinates of an object, (2, 3)."""
    points = batch.vertices[batch.vertex_start[row] : batch.vertex_start[row + 1]]
    if not len(points):
        return np.full((2, 3), np.nan)
    return np.stack([points.min(0), points.max(0)])


def _mesh_record(batch: MeshBatch, row: int) -> dict[str, Any]:
    one = batch.take([row])
    used = sorted({one.materials[number] for number in np.unique(one.material).tolist()})
    return {
        "triangles": one.triangle_count,
        "materials": used,
        "bounds": _rounded(_box(batch, row).ravel()),
    }


def _instance_layer(name: str, rows: Instances, prototypes: tuple[Prototype, ...]) -> Layer:
    names = np.array([prototype.name for prototype in prototypes], object)
    return Layer(
        f"instances/{name}",
        rows.object_id,
        names[rows.prototype],
        np.full(rows.count, "", object),
        lambda: rows.position[:, :2],
        partial(_instance_record, rows),
    )


def _instance_record(rows: Instances, row: int) -> dict[str, Any]:
    owner = int(rows.owner[row])
    return {
        "position": _rounded(rows.position[row]),
        "rotation": _rounded(rows.rotation[row]),
        "scale": _rounded(rows.scale[row]),
        "owner": id_text(owner) if owner else "",
    }


def owned(city: City, object_id: int) -> Mapping[str, int]:
    """Return how many instances belong to an object, by layer."""
    counts = {
        name: int(np.count_nonzero(rows.owner == np.uint64(object_id)))
        for name, rows in city.scene.instances.items()
    }
    return {name: count for name, count in counts.items() if count}


def _rounded(values: Any) -> list[float | None]:
    return [plain(float(value)) for value in values]


def plain(value: Any) -> Any:
    """Return a JSON value: texts of files as `shown`, no number that JSON cannot write."""
    if isinstance(value, str):
        return shown(value)
    if isinstance(value, np.generic):
        value = value.item()
    if isinstance(value, float):
        return round(value, _MILLIMETRES) if np.isfinite(value) else None
    return value
