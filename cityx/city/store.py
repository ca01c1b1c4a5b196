"""The store: a city on disk, written whole or not at all, read back without loss.

Layout of the folder: ``city.json`` (everything small), ``layout/*.parquet`` (GeoParquet),
``terrain.tif`` (GeoTIFF), ``surroundings.tif`` and ``survey.npz`` (what a height file says),
``network.npz``, ``heights.npz``, ``lanes.npz``, ``ground.npz``, ``tracks.npz``,
``signals.npz``, ``meshes/*.npz``, ``instances/*.npz``,
``prototypes.npz`` (``prototypes-1.npz`` and so on hold those that changes added), ``hashes.npz``
(`cityx.city.content`) and ``objects.json`` (what each building is, for views that load no tables).
"""

from __future__ import annotations

import json
import operator
import os
import shutil
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import asdict, dataclass, fields
from functools import partial
from itertools import groupby
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, NamedTuple
from weakref import WeakValueDictionary

import numpy as np

from cityx.city.city import City, Failure
from cityx.city.environment import Environment
from cityx.city.frame import Frame
from cityx.city.goals import Goal
from cityx.city.ground import Ground
from cityx.city.heights import WayHeights
from cityx.city.lanes import LaneGraph
from cityx.city.layout import SCHEMA, Layout, make_table
from cityx.city.mesh import MeshBatch, empty_batch, joined_columns
from cityx.city.roads import RoadNetwork
from cityx.city.scene import Instances, Prototype, Scene
from cityx.city.signals import Signals
from cityx.city.terrain import Survey, Terrain
from cityx.city.tracks import Tracks
from cityx.errors import InputError
from cityx.ids import id_text
from cityx.system.digests import file_sha256
from cityx.system.packed import read_arrays, write_arrays

if TYPE_CHECKING:
    from geopandas import GeoDataFrame

# Rises when an older program could not read the folder: 5 has prototypes in several files.
FORMAT, IN_CHUNKS = 4, 5
LARGE = 1 << 15  # bytes of a prototype that stores share
MOST_CHUNKS = 8  # files of prototypes, from which they are put together again


@dataclass(frozen=True)
class View:
    """What an engine needs of a city: no feature tables, so nothing heavy is imported.

    Attributes
    ----------
    objects
        Object id to its "kind", "name", "source" and "use".
    """

    name: str
    frame: Frame
    extent: tuple[float, float, float, float]
    seed: int
    lod: int
    scene: Scene
    environment: Environment
    network: RoadNetwork | None
    lanes: LaneGraph | None
    terrain: Terrain
    tracks: Tracks | None
    signals: Signals | None
    moment: float
    attribution: tuple[str, ...]
    objects: Mapping[int, Mapping[str, str]]


def view_of(city: City) -> View:
    """Return the view of a city in memory."""
    return View(
        city.name,
        city.frame,
        city.layout.extent,
        city.seed,
        city.lod,
        city.scene,
        city.environment,
        city.network,
        city.lanes,
        city.terrain,
        city.tracks,
        city.signals,
        city.moment,
        city.attribution,
        {int(key, 16): value for key, value in _objects(city).items()},
    )


def _objects(city: City) -> dict[str, dict[str, str]]:
    table = city.layout.buildings
    rows = zip(table["id"], table["name"], table["source"], table["use"], strict=True)
    return {
        id_text(object_id): {"kind": "building", "name": name, "source": source, "use": use}
        for object_id, name, source, use in rows
    }


def write_city(
    city: City, folder: Path, *, like: tuple[City, Path] | None = None, kept: Path | None = None
) -> None:
    """Write a city to a folder; an older city there is replaced when the new one is complete.

    Parameters
    ----------
    city
        The city.
    folder
        Where to write it.
    like
        A city that is stored already, and where: what the two share is linked, not written again.
    kept
        Folder of what several stores share: large prototypes are kept there by their content and
        linked. The store is the same to the byte where that cannot be done.
    """
    temporary = folder.with_name(folder.name + ".partial")
    shutil.rmtree(temporary, ignore_errors=True)
    for name in ("layout", "meshes", "instances"):
        (temporary / name).mkdir(parents=True)
    held: Mapping[str, _File] = {}
    if like is not None and like[0].frame == city.frame:
        held = _files(like[0])
    for name, file in _files(city).items():
        if name in held and held[name].value is file.value and like is not None:
            _link(like[1] / name, temporary / name)
        else:
            file.write(temporary / name)
    chunks = (
        _write_prototypes(city, temporary, like) if kept is None
        else _keep_prototypes(city.scene.prototypes, temporary, kept)
    )  # fmt: skip
    record = {
        "format": FORMAT if len(chunks) == 1 else IN_CHUNKS,
        "name": city.name,
        "frame": asdict(city.frame),
        "projection": city.frame.projection,
        "extent": city.layout.extent,
        "seed": city.seed,
        "lod": city.lod,
        "style": city.style,
        "moment": city.moment,
        "environment": asdict(city.environment),
        "terrain": _grid_of(city.terrain),
        "survey": _record_of(city.survey) if city.survey is not None else None,
        "attribution": city.attribution,
        "stages_done": sorted(city.stages_done),
        "made": [[action, dict(args)] for action, args in city.made.items()],
        "failures": [
            {"id": id_text(f.object_id), "action": f.action, "error": f.error}
            for f in city.failures
        ],
        "notes": city.notes,
        "goals": [asdict(goal) for goal in city.goals],
        "materials": {layer: mesh.materials for layer, mesh in city.scene.meshes.items()},
        "prototypes": [[p.name, p.kind, p.mesh.materials] for p in city.scene.prototypes],
        "prototype_materials": chunks[0][1],
        "prototype_chunks": chunks,
    }  # fmt: skip
    (temporary / "city.json").write_text(json.dumps(record, indent=1))
    (temporary / "objects.json").write_text(json.dumps(_objects(city)))
    replace_folder(temporary, folder)


def _write_prototypes(
    city: City, folder: Path, like: tuple[City, Path] | None
) -> list[tuple[int, tuple[str, ...]]]:
    """Write the prototypes; files of those that another store has are linked.

    Returns
    -------
    chunks
        For each file how many it holds and the materials that its faces count.
    """
    prototypes = city.scene.prototypes
    chunks: list[tuple[int, tuple[str, ...]]] = []
    done = 0
    if like is not None and (like[1] / "city.json").exists():
        held = like[0].scene.prototypes
        shared = len(held) <= len(prototypes) and all(map(operator.is_, held, prototypes))
        older = _chunks(_record(like[1]))
        if shared and len(older) < MOST_CHUNKS and sum(count for count, _ in older) == len(held):
            chunks, done = list(older), len(held)
            for number in range(len(older)):
                _link(like[1] / _chunk_name(number), folder / _chunk_name(number))
    if done < len(prototypes) or not chunks:
        columns, names = joined_columns(prototype.mesh for prototype in prototypes[done:])
        write_arrays(folder / _chunk_name(len(chunks)), columns or _arrays(empty_batch()))
        chunks.append((len(prototypes) - done, names))
    return chunks


def _keep_prototypes(
    prototypes: Sequence[Prototype], folder: Path, kept: Path
) -> list[tuple[int, tuple[str, ...]]]:
    """Write the prototypes, each large one as a file that other stores have as well.

    Returns
    -------
    chunks
        As of `_write_prototypes`.
    """
    kept.mkdir(parents=True, exist_ok=True)
    chunks: list[tuple[int, tuple[str, ...]]] = []
    for large, run in groupby(prototypes, lambda each: _bytes_of(each) >= LARGE):
        for own in ([each] for each in run) if large else (list(run),):
            path = folder / _chunk_name(len(chunks))
            columns, names = joined_columns(prototype.mesh for prototype in own)
            write_arrays(path, columns or _arrays(empty_batch()))
            if large:
                _keep(path, kept / f"{file_sha256(path)}.npz")
            chunks.append((len(own), names))
    if not chunks:
        write_arrays(folder / _chunk_name(0), _arrays(empty_batch()))
        chunks.append((0, ()))
    return chunks


def _bytes_of(prototype: Prototype) -> int:
    return sum(array.nbytes for array in _arrays(prototype.mesh).values())


def _keep(path: Path, held: Path) -> None:
    """Make a file and the one that is kept of its content the same, if files can have two names."""
    try:
        os.link(path, held)
    except FileExistsError:
        beside = path.with_suffix(".kept")
        with suppress(OSError):
            os.link(held, beside)
            beside.replace(path)
    except OSError:
        return


def forget_prototypes(kept: Path) -> None:
    """Take away what is kept of prototypes that no store has any more; none may be written now."""
    for path in kept.glob("*.npz"):
        if path.stat().st_nlink == 1:
            path.unlink()


def _chunk_name(number: int) -> str:
    return f"prototypes-{number}.npz" if number else "prototypes.npz"


def _chunks(record: Mapping[str, Any]) -> list[tuple[int, tuple[str, ...]]]:
    """Return what the files of prototypes hold; of a store with one, all."""
    whole = [(len(record["prototypes"]), record["prototype_materials"])]
    found = record.get("prototype_chunks", whole)
    return [(int(count), tuple(materials)) for count, materials in found]


class _File(NamedTuple):
    """A file of the store: what it holds, and how that is written."""

    value: object
    write: Callable[[Path], None]


def _files(city: City) -> dict[str, _File]:
    """Return the files of a city but the two texts and the prototypes, by their names."""
    found: dict[str, _File] = {}
    for name in SCHEMA:
        table = getattr(city.layout, name)
        found[f"layout/{name}.parquet"] = _File(table, partial(_write_table, table, city.frame))
    found["terrain.tif"] = _File(city.terrain, partial(_write_terrain, city.terrain, city.frame))
    if city.survey is not None:
        around = city.survey.around
        found["surroundings.tif"] = _File(around, partial(_write_terrain, around, city.frame))
    values: dict[str, Any] = {
        "survey": city.survey, "network": city.network, "heights": city.heights,
        "lanes": city.lanes, "ground": city.ground, "tracks": city.tracks,
        "signals": city.signals,
    }  # fmt: skip
    values |= {f"meshes/{layer}": batch for layer, batch in city.scene.meshes.items()}
    values |= {f"instances/{layer}": rows for layer, rows in city.scene.instances.items()}
    for name, value in values.items():
        if value is not None:
            found[f"{name}.npz"] = _File(value, partial(_write_value, value))
    return found


def _link(source: Path, target: Path) -> None:
    """Give a file a second name; files of the store are never written to, only replaced."""
    try:
        os.link(source, target)
    except OSError:
        shutil.copyfile(source, target)


def replace_folder(temporary: Path, folder: Path) -> None:
    """Put a complete folder in the place of an older one."""
    old = folder.with_name(folder.name + ".old")
    shutil.rmtree(old, ignore_errors=True)
    if folder.exists():
        folder.rename(old)
    temporary.rename(folder)
    shutil.rmtree(old, ignore_errors=True)


def read_city(folder: Path) -> City:
    """Read a city back; large arrays stay in their files until they are looked at.

    Raises
    ------
    InputError
        If the folder holds no city or one of a newer format.
    """
    record = _record(folder)
    layout = Layout(
        tuple(record["extent"]),
        **{name: _read_table(folder / "layout" / f"{name}.parquet", name) for name in SCHEMA},
    )
    return City(
        name=record["name"],
        frame=Frame(**record["frame"]),
        layout=layout,
        seed=record["seed"],
        lod=record["lod"],
        style=record["style"],
        terrain=_read_terrain(folder / "terrain.tif", record["terrain"]),
        survey=_read_survey(folder, record.get("survey")),
        network=_read_value(folder / "network.npz", RoadNetwork),
        heights=_read_value(folder / "heights.npz", WayHeights),
        lanes=_read_value(folder / "lanes.npz", LaneGraph),
        ground=_read_value(folder / "ground.npz", Ground),
        tracks=_read_value(folder / "tracks.npz", Tracks),
        signals=_read_value(folder / "signals.npz", Signals),
        moment=record.get("moment", 0.0),
        scene=_read_scene(folder, record),
        environment=Environment(**record["environment"]),
        attribution=tuple(record["attribution"]),
        stages_done=frozenset(record["stages_done"]),
        made=dict(record.get("made", ())),
        failures=tuple(
            Failure(int(f["id"], 16), f["action"], f["error"]) for f in record["failures"]
        ),
        notes=tuple(record["notes"]),
        goals=tuple(Goal(**goal) for goal in record.get("goals", ())),
    )


def read_view(folder: Path) -> View:
    """Read what an engine needs of a stored city.

    Raises
    ------
    InputError
        If the folder holds no city or one of a newer format.
    """
    record = _record(folder)
    objects = json.loads((folder / "objects.json").read_text())
    return View(
        record["name"],
        Frame(**record["frame"]),
        tuple(record["extent"]),
        record["seed"],
        record["lod"],
        _read_scene(folder, record),
        Environment(**record["environment"]),
        _read_value(folder / "network.npz", RoadNetwork),
        _read_value(folder / "lanes.npz", LaneGraph),
        _read_terrain(folder / "terrain.tif", record["terrain"]),
        _read_value(folder / "tracks.npz", Tracks),
        _read_value(folder / "signals.npz", Signals),
        record.get("moment", 0.0),
        tuple(record["attribution"]),
        {int(key, 16): value for key, value in objects.items()},
    )


def _record(folder: Path) -> dict[str, Any]:
    path = folder / "city.json"
    if not path.is_file():
        raise InputError(f"{folder} holds no city: {path.name} is missing. Build one first.")
    record: dict[str, Any] = json.loads(path.read_text())
    if record.get("format") not in (FORMAT, IN_CHUNKS):
        raise InputError(
            f"{path} has format {record.get('format')}, this program reads formats {FORMAT} and "
            f"{IN_CHUNKS}."
        )
    return record


def _arrays(value: Any) -> dict[str, Any]:
    held = {column.name: getattr(value, column.name) for column in fields(value)}
    return {key: array for key, array in held.items() if isinstance(array, np.ndarray)}


def _write_value(value: Any, path: Path) -> None:
    write_arrays(path, _arrays(value))


def _read_value(path: Path, kind: Any) -> Any:
    if not path.exists():
        return None
    return kind(**read_arrays(path, mapped=True))


def _read_scene(folder: Path, record: Mapping[str, Any]) -> Scene:
    meshes = {}
    for layer, names in record["materials"].items():
        held = read_arrays(folder / "meshes" / f"{layer}.npz", mapped=True)
        meshes[layer] = MeshBatch(**held, materials=tuple(names))
    instances = {
        path.stem: _read_value(path, Instances)
        for path in sorted((folder / "instances").glob("*.npz"))
    }
    meshes_of = []
    for number, (count, names) in enumerate(_chunks(record)):
        shared = _read_chunk(folder / _chunk_name(number), names)
        meshes_of += [shared.one(index) for index in range(count)]
    prototypes = tuple(
        Prototype(name, kind, _own_materials(mesh, tuple(materials)))
        for mesh, (name, kind, materials) in zip(meshes_of, record["prototypes"], strict=True)
    )
    return Scene(MappingProxyType(meshes), prototypes, MappingProxyType(instances))


# What several stores have, by device and file, while anything holds it: read and mapped once.
_HELD: WeakValueDictionary[tuple[int, int], MeshBatch] = WeakValueDictionary()


def _read_chunk(path: Path, names: tuple[str, ...]) -> MeshBatch:
    status = path.stat()
    key = (status.st_dev, status.st_ino)
    held = _HELD.get(key) if status.st_nlink > 1 else None
    if held is None or held.materials != names:
        held = MeshBatch(**read_arrays(path, mapped=True), materials=names)
        if status.st_nlink > 1:
            _HELD[key] = held
    return held


def _own_materials(mesh: MeshBatch, names: tuple[str, ...]) -> MeshBatch:
    """Count materials again by the names the prototype had before it was joined with others."""
    table = np.array([names.index(n) if n in names else 0 for n in mesh.materials], np.int16)
    arrays = _arrays(mesh) | {"material": table[mesh.material]}
    return MeshBatch(**arrays, materials=names)


def _write_table(table: GeoDataFrame, frame: Frame, path: Path) -> None:
    table.set_crs(frame.projection, allow_override=True).to_parquet(path, index=False)


def _read_table(path: Path, name: str) -> GeoDataFrame:
    from geopandas import GeoDataFrame, read_parquet

    table = read_parquet(path)
    schema = SCHEMA[name]
    ids = table["id"].to_numpy()
    if all(table[key].dtype == dtype for key, dtype in schema.items()) and (
        (ids[1:] >= ids[:-1]).all()
    ):
        columns = {key: table[key].array for key in schema}
        return GeoDataFrame(columns, geometry=table.geometry.to_numpy())
    columns = {key: table[key].to_numpy() for key in schema}
    return make_table(name, table.geometry.to_numpy(), **columns)


def _grid_of(terrain: Terrain) -> dict[str, Any]:
    return {"origin": terrain.origin, "cell": terrain.cell, "datum": terrain.datum}


def _record_of(survey: Survey) -> dict[str, Any]:
    return {
        "around": _grid_of(survey.around),
        "bounds": [survey.bound, survey.tolerance, survey.far_tolerance],
    }


def _write_terrain(terrain: Terrain, frame: Frame, path: Path) -> None:
    import rasterio
    from affine import Affine

    rows, columns = terrain.heights.shape
    half = terrain.cell / 2  # heights sit on nodes, GeoTIFF cells are areas around them
    north = terrain.origin[1] + (rows - 1) * terrain.cell + half
    profile = {
        "driver": "GTiff", "width": columns, "height": rows, "count": 1, "dtype": "float64",
        "crs": frame.projection, "compress": "deflate",
        "transform": Affine(terrain.cell, 0, terrain.origin[0] - half, 0, -terrain.cell, north),
    }  # fmt: skip
    with rasterio.open(path, "w", **profile) as dataset:
        dataset.write(terrain.heights[::-1], 1)


def _read_terrain(path: Path, record: Mapping[str, Any]) -> Terrain:
    import rasterio

    with rasterio.open(path) as dataset:
        heights = dataset.read(1)[::-1].copy()
    return Terrain(tuple(record["origin"]), record["cell"], heights, record["datum"])


def _read_survey(folder: Path, record: Mapping[str, Any] | None) -> Survey | None:
    if record is None:
        return None
    with np.load(folder / "survey.npz") as arrays:
        points = arrays["points"]
    around = _read_terrain(folder / "surroundings.tif", record["around"])
    return Survey(points, around, *record["bounds"])
