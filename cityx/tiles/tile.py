"""One tile: a pure function of what the run has in common and of a fragment of the map."""

from __future__ import annotations

import json
import os
import shutil
import socket
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from cityx.city import City
from cityx.city.content import HASHES as STORE_HASHES
from cityx.city.content import ContentHash, content_hash, write_hash
from cityx.city.store import view_of, write_city
from cityx.ids import UInt64Array, id_text
from cityx.protocol.gate import Call
from cityx.sources.osm import city_of
from cityx.sources.osm.elements import OsmMap
from cityx.system.digests import file_sha256
from cityx.tiles.actions import built
from cityx.tiles.content import Cell, cells_of, distance_between, overviews_of
from cityx.tiles.edits import on_overview, on_owned, on_window
from cityx.tiles.grid import Box, Tile
from cityx.tiles.names import names_in
from cityx.tiles.order import Order
from cityx.tiles.ownership import owned
from cityx.tiles.plane import box_in_frame, named_in_plane, origin_of, plane_land
from cityx.tiles.split import read_fragment
from cityx.tiles.tileset import NAME as TILESET
from cityx.tiles.tileset import Seen, tile_tileset, write_tileset

RECORD = "tile.json"
CITY, CONTENT = "city", "content"


@dataclass(frozen=True)
class Made:
    """A tile in memory.

    Attributes
    ----------
    city
        What it owns.
    overview
        What it owns at the lowest level of detail.
    content
        Hashes of the city.
    buildings
        Ids of the buildings that the map has here, whatever edits made of them.
    """

    city: City
    overview: City
    content: ContentHash
    buildings: tuple[str, ...]


def make_tile(order: Order, tile: Tile, fragment: Path, edits: Sequence[Call] = ()) -> Made:
    """Build a tile, with its edits.

    Raises
    ------
    InputError
        If the fragment is damaged.
    """
    land = _map_land(order, tile, fragment) if order.plane is None else plane_land(order, tile)
    land = replace(land, stages_done=land.stages_done | {"terrain"})
    box, origin = box_in_frame(order, tile), origin_of(order, tile)
    overview = owned(built(replace(land, lod=0), order.coarse), box)
    whole = built(replace(land, lod=order.lod), order.items)
    city = owned(whole, box)
    if order.plane is not None:
        overview, city = (named_in_plane(one, land, origin) for one in (overview, city))
    buildings = tuple(sorted(map(id_text, city.layout.buildings["id"].tolist())))
    if edits:
        before = whole if order.plane is None else named_in_plane(whole, land, origin)
        overview = on_overview(overview, edits)
        city = on_owned(on_window(before, edits), box, edits)
        if order.plane is not None:  # what edits made has no sheet in its ids yet
            city = named_in_plane(city, land, origin, named_before=_ids_of(before))
    return Made(city, overview, content_hash(city), buildings)


def _ids_of(city: City) -> UInt64Array:
    """Return the ids of what has any by its place: points, meshes and instances."""
    scene = city.scene
    found = [city.layout.points["id"].to_numpy(np.uint64)]
    found += [batch.object_id for batch in scene.meshes.values()]
    found += [ids for rows in scene.instances.values() for ids in (rows.object_id, rows.owner)]
    return np.asarray(np.unique(np.concatenate(found)), np.uint64)


def _map_land(order: Order, tile: Tile, fragment: Path) -> City:
    """Return the layout of a map about a tile, on its terrain."""
    osm, coverage, terrain = read_fragment(fragment)
    box = tile.box(order.size, order.margin)
    city = land_of(order, osm, coverage, box, str(fragment), f"{order.name} {tile.name}")
    return city if terrain is None else replace(city, terrain=terrain)


def land_of(
    order: Order, osm: OsmMap, coverage: Mapping[str, float], box: Box, source: str, name: str = ""
) -> City:
    """Return the layout of a part of a map, as all tiles of a run read it.

    Parameters
    ----------
    osm, coverage
        As of `cityx.tiles.split.read_fragment`.
    box
        (xmin, ymin, xmax, ymax) metres of what is read.
    source, name
        Of the part, for messages; the name of the run when "".
    """
    return city_of(
        osm, source, seed=order.seed, name=name or order.name, frame=order.frame,
        place=order.frame.place, box=box, bare=True, coverage=coverage,
    )  # fmt: skip


def write_tile(
    order: Order, tile: Tile, made: Made, key: str, folder: Path, *, kept: Path, store: bool = True
) -> dict[str, Any]:
    """Write a tile into a folder and return its record.

    The folder appears when all of it is written; two workers that write the same tile write the
    same bytes, so the second one leaves those of the first.

    Parameters
    ----------
    kept
        Folder of what the stores of all tiles share.
    store
        Whether there is to be one.
    """
    mark = f"{socket.gethostname()}.{os.getpid()}"
    staging = folder.with_name(f".{folder.name}.{mark}.partial")
    shutil.rmtree(staging, ignore_errors=True)
    (staging / CONTENT).mkdir(parents=True)
    try:
        if store:
            write_city(made.city, staging / CITY, kept=kept)
            write_hash(made.content, staging / CITY / STORE_HASHES)
        box, error = _write_content(order, tile, made, staging)
        record = _record(order, tile, made, key) | {"box": box, "error": error}
        record["files"] = _files(staging)
        text = json.dumps(record, indent=1, ensure_ascii=False) + "\n"
        (staging / RECORD).write_text(text)
        _publish(staging, folder, key)
    finally:
        shutil.rmtree(staging, ignore_errors=True)
    return record


def _write_content(
    order: Order, tile: Tile, made: Made, staging: Path
) -> tuple[list[list[float]] | None, float]:
    """Write what a tile shows; returns its bounds, None if that is nothing, and its error."""
    view = view_of(made.city)
    west, south, east, north = box_in_frame(order, tile)
    centre = np.array([(west + east) / 2, (south + north) / 2, 0.0])
    cells = cells_of(view, made.content, centre)
    coarse = view_of(made.overview)
    overviews = overviews_of(coarse, content_hash(made.overview), centre, order.size)
    every = [*cells, *overviews]
    if not every:
        return None, 0.0
    for cell in every:
        (staging / CONTENT / f"{cell.name}.glb").write_bytes(cell.glb)
    error = distance_between(view.scene.meshes, coarse.scene.meshes)
    heights = [np.ptp(p.mesh.vertices, axis=0).max() for p in view.scene.prototypes
               if len(p.mesh.vertices)]  # fmt: skip
    error = round(max(error, float(max(heights, default=0.0))), 2)
    boxes = np.array([cell.box for cell in every])
    seen = [Seen(f"{CONTENT}/{whole.name}.glb", whole.box, error,
                 tuple(_leaf(cell) for cell in cells if whole.holds(cell)))
            for whole in overviews]  # fmt: skip
    seen += [_leaf(cell) for cell in cells if not any(whole.holds(cell) for whole in overviews)]
    document = tile_tileset(
        order.frame if order.plane is None else None, centre, seen, made.city.attribution,
        order.size, datum=order.datum,
    )  # fmt: skip
    write_tileset(document, staging / TILESET)
    bounds = [boxes[:, 0].min(axis=0), boxes[:, 1].max(axis=0)]
    return [np.round(bound, 2).tolist() for bound in bounds], error


def _leaf(cell: Cell) -> Seen:
    return Seen(f"{CONTENT}/{cell.name}.glb", cell.box)


def _record(order: Order, tile: Tile, made: Made, key: str) -> dict[str, Any]:
    city = made.city
    origin = {} if order.plane is None else {"origin": list(origin_of(order, tile))}
    return {
        "tile": tile.name,
        "key": key,
        "hash": made.content.total,
        "extent": list(tile.box(order.size)),
        **origin,
        "attribution": list(city.attribution),
        "counts": {
            "buildings": len(city.layout.buildings),
            "roads": len(city.layout.roads),
            "meshes": sum(batch.count for batch in city.scene.meshes.values()),
            "instances": sum(table.count for table in city.scene.instances.values()),
            "failures": len(city.failures),
        },
        "buildings": list(made.buildings),
        "names": names_in(city),
    }


def _files(staging: Path) -> dict[str, str]:
    """Return the checksum of each file."""
    return {
        str(path.relative_to(staging)): file_sha256(path)
        for path in sorted(staging.rglob("*")) if path.is_file()
    }  # fmt: skip


def _publish(staging: Path, folder: Path, key: str) -> None:
    if folder.exists():
        if read_record(folder).get("key") == key:
            return
        shutil.rmtree(folder)
    try:
        staging.rename(folder)
    except OSError:
        if read_record(folder).get("key") != key:
            raise


def read_record(folder: Path) -> Mapping[str, Any]:
    """Return the record of a tile, nothing if it is not there or not whole."""
    try:
        told: Mapping[str, Any] = json.loads((folder / RECORD).read_text())
    except (OSError, ValueError):
        return {}
    return told


def file_faults(folder: Path) -> list[str]:
    """Return which files of a tile are not as they were written, a sentence each."""
    record = read_record(folder)
    if not record:
        return [f"{folder} holds no tile."]
    found = _files(folder)
    found.pop(RECORD, None)
    faults = [f"{folder / name} is not as it was written." for name, digest
              in record["files"].items() if found.get(name) != digest]  # fmt: skip
    return faults + [f"{folder / name} belongs to no tile." for name in found
                     if name not in record["files"]]  # fmt: skip
