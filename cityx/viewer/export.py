"""A static site: the page and the city as files that any web server shows, from any folder."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

from cityx.city.content import content_hash
from cityx.city.store import read_city, replace_folder
from cityx.errors import InputError, UsageError
from cityx.ids import id_text
from cityx.projects.desk import STORE, Desk
from cityx.projects.instructions import is_built
from cityx.projects.results import fresh_staging, result_folder
from cityx.server.layers import layers_of, shown
from cityx.viewer.details import addresses, details, places_of
from cityx.viewer.geojson import layout_geojson
from cityx.viewer.page import FILES, page_folder
from cityx.viewer.provenance import provenance
from cityx.viewer.scenery import read_scenery

BUCKETS = 256  # files that tell of objects, by the first two digits of their ids
MARK = "scene.json"  # by which an older site is known


def export_site(folder: Path, site: Path, say: Callable[[str], None]) -> dict[str, int]:
    """Write the page of a city as a static site; an older site there is replaced.

    Parameters
    ----------
    folder
        Of a built city.
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
        If there is no city, or the folder holds something else.
    MissingDependency
        If the page is not built.
    """
    if not is_built(folder):
        raise InputError(f"{folder} holds no city; build one with: cityx build ... -o {folder}")
    site = result_folder(site)
    if site.exists() and any(site.iterdir()) and not (site / MARK).is_file():
        raise UsageError(f"{site} holds other files; give a folder that is new or a site.")
    page = page_folder()
    with fresh_staging(site) as staging:
        for name in FILES:
            shutil.copyfile(page / name, staging / name)
        scenery = read_scenery(folder / STORE)
        names = scenery.names()
        for number, name in enumerate(names):
            if number % 50 == 0:
                say(f"{number} of {len(names)} files")
            path = staging / name
            path.parent.mkdir(exist_ok=True)
            path.write_bytes(scenery.file(name))
        report_path = folder / "report.json"
        report = json.loads(report_path.read_text()) if report_path.is_file() else {}
        say("what is known of objects")
        _write_objects(folder, staging, report)
        (staging / "report.json").write_text(json.dumps(report))
        _write_provenance(folder, staging)
        layout = layout_geojson(read_city(folder / STORE))
        (staging / "layout.geojson").write_text(json.dumps(layout))
        told = scenery.to_json() | {"live": False, "revision": report.get("revision", 1)}
        (staging / MARK).write_text(json.dumps(told))
        files = [path for path in staging.rglob("*") if path.is_file()]
        counted = {"files": len(files), "bytes": sum(path.stat().st_size for path in files)}
        replace_folder(staging, site)
    return counted


def _write_provenance(folder: Path, staging: Path) -> None:
    """Write where objects are from; what was edited is other than in the first revision kept."""
    with Desk(folder) as desk:
        city, content = desk.city, content_hash(desk.city)
        known = min((each.number for each in desk.revisions()), default=desk.revision)
        first = None if known == desk.revision else content_hash(desk.at(known))
    (staging / "provenance.json").write_text(json.dumps(provenance(city, content, first)))


def _write_objects(folder: Path, staging: Path, report: dict[str, Any]) -> None:
    """Write what is known of the objects of map and meshes, and an index of names to search."""
    city = read_city(folder / STORE)
    content = read_scenery(folder / STORE).content
    places = places_of(city)
    buckets: dict[str, dict[str, Any]] = {f"{n:02x}": {} for n in range(BUCKETS)}
    index = []
    layers = tuple(layers_of(city))
    for layer in layers:
        if layer.name.startswith("instances/"):
            continue
        for row, number in enumerate(layer.ids.tolist()):
            name = id_text(number)
            bucket = buckets[name[:2]]
            if name not in bucket:
                told = details(city, content, name, report, layers)
                bucket[name] = told | {"place": places.get(number)}
            said = str(layer.names[row])
            if said:
                kind = shown(str(layer.kinds[row]))
                index.append([name, shown(said), layer.name, kind, places.get(number)])
    for name, texts, layer_name, kind in addresses(city):
        place = places.get(int(name, 16))
        index += [[name, text, layer_name, kind, place] for text in dict.fromkeys(texts)]
    (staging / "objects").mkdir()
    for name, bucket in buckets.items():
        (staging / "objects" / f"{name}.json").write_text(json.dumps(bucket))
    (staging / "names.json").write_text(json.dumps(index))
