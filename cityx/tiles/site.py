"""A static site of tiles: the page and what it loads as files that any web server shows."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from cityx.city.content import HASHES, content_hash, read_hash
from cityx.city.store import read_city, replace_folder
from cityx.errors import UsageError
from cityx.ids import id_text
from cityx.projects.results import fresh_staging, result_folder
from cityx.server.layers import layers_of
from cityx.tiles.grid import Tile
from cityx.tiles.order import read_order
from cityx.tiles.page import START, place_in_tileset, start_of
from cityx.tiles.run import TILES, records
from cityx.tiles.tile import CITY, CONTENT
from cityx.tiles.tileset import NAME as TILESET
from cityx.viewer.details import details
from cityx.viewer.page import TILE_FILES, page_folder

NAMES, OBJECTS, RUN = "names.json", "objects", "run"
SHOWN = ("kind", "name", "source", "licence", "tags")  # of an object, on the page


def export_tiles(folder: Path, site: Path, say: Callable[[str], None]) -> dict[str, int]:
    """Write the page of built tiles as a static site; an older site there is replaced.

    Tiles without a store tell ids, layers and names alone.

    Parameters
    ----------
    folder
        Of built tiles.
    site
        Folder to make.
    say
        Called with one line of progress at a time.

    Returns
    -------
    told
        "files" and "bytes".

    Raises
    ------
    InputError, UsageError
        If no tile is built, or the folder to make holds something else.
    MissingDependency
        If the page is not built.
    """
    start = start_of(folder)
    site = result_folder(site)
    if site.exists() and any(site.iterdir()) and not (site / START).is_file():
        raise UsageError(f"{site} holds other files; give a folder that is new or a site of tiles.")
    page = page_folder()
    with fresh_staging(site) as staging:
        for name in TILE_FILES:
            shutil.copyfile(page / name, staging / name)
        (staging / TILE_FILES[0]).rename(staging / "index.html")
        run = staging / RUN
        (staging / OBJECTS).mkdir()
        run.mkdir()
        shutil.copyfile(folder / TILESET, run / TILESET)
        known = records(folder)
        for number, (tile, record) in enumerate(known.items()):
            say(f"{number} of {len(known)} tiles")
            if record["box"]:
                own = folder / TILES / tile.name
                shutil.copytree(own / CONTENT, run / TILES / tile.name / CONTENT)
                shutil.copyfile(own / TILESET, run / TILES / tile.name / TILESET)
            told = _objects_of(folder / TILES / tile.name / CITY)
            (staging / OBJECTS / f"{tile.name}.json").write_text(json.dumps(told))
        (staging / NAMES).write_text(json.dumps(_names_of(folder, known)))
        (staging / START).write_text(json.dumps(start | {"live": False}))
        files = [path for path in staging.rglob("*") if path.is_file()]
        counted = {"files": len(files), "bytes": sum(path.stat().st_size for path in files)}
        replace_folder(staging, site)
    return counted


def _objects_of(store: Path) -> dict[str, dict[str, Any]]:
    """Return what the page tells of the objects of a tile, by id; nothing without a store."""
    if not store.is_dir():
        return {}
    city = read_city(store)
    content = read_hash(store / HASHES) or content_hash(city)
    layers = tuple(layers_of(city))
    names = {id_text(number) for layer in layers if not layer.name.startswith("instances/")
             for number in layer.ids.tolist()}  # fmt: skip
    found = {}
    for name in sorted(names):
        told = details(city, content, name, {}, layers)
        found[name] = {key: told[key] for key in SHOWN if told[key]}
    return found


def _names_of(folder: Path, known: Mapping[Tile, Mapping[str, Any]]) -> list[dict[str, Any]]:
    """Return what has a name in tiles, each name of a kind once, as a search answers."""
    order, _ = read_order(folder)
    found: dict[tuple[str, str], dict[str, Any]] = {}
    for tile, record in known.items():
        fresh = [own for own in record.get("names", ()) if (own[1], own[2]) not in found]
        if not fresh or not record["box"]:
            continue
        places = place_in_tileset(folder, order, tile, [own[3:] for own in fresh])
        for own, place in zip(fresh, places, strict=True):
            found[own[1], own[2]] = {
                "id": own[0], "name": own[1], "kind": own[2], "tile": tile.name, "place": place
            }  # fmt: skip
    return [found[key] for key in sorted(found)]
