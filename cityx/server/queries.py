"""Queries: list the objects of a city, page by page, and describe one."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cityx.city import City
from cityx.city.content import ContentHash
from cityx.errors import UsageError, nearest
from cityx.ids import id_text
from cityx.projects.desk import Revision
from cityx.server.layers import Layer, layers_of, owned, plain, shown
from cityx.server.seen import Seen

PAGE = 50  # rows of a page unless told otherwise
MOST_ROWS = 200  # of a page
SUMMARY_BYTES = 2000
_ID = re.compile(r"[0-9a-f]{16}")


def query(city: City, selector: Mapping[str, Any], page: int, size: int) -> dict[str, Any]:
    """Return the objects that a selector names, one page of them.

    Parameters
    ----------
    selector
        Any of "layer", "kind", "ids", "name" and "near"; an object must suit all that are given.
    page, size
        Page from 1, and its rows.

    Raises
    ------
    UsageError
        If there is no such layer or page.
    """
    chosen = _chosen(list(layers_of(city)), selector)
    rows = [_suiting(layer, selector) for layer in chosen]
    head, parts = _page([len(index) for index in rows], page, size)
    objects = [
        record
        for layer, index, part in zip(chosen, rows, parts, strict=True)
        for record in _records(layer, index[part])
    ]
    return head | {"objects": objects}


def _chosen(layers: Sequence[Layer], selector: Mapping[str, Any]) -> list[Layer]:
    """Return the layers to look in: the named ones, else the layout, or all for ids."""
    wanted = selector.get("layer")
    if wanted is None:
        everywhere = "ids" in selector
        return [item for item in layers if everywhere or item.name.startswith("layout/")]
    found = [item for item in layers if wanted in (item.name, item.name.partition("/")[2])]
    if not found:
        names = [item.name for item in layers]
        hint = nearest(wanted, names) or f" It has {', '.join(names)}."
        raise UsageError(f'The city has no layer "{shown(wanted)}".{hint}')
    return found


def _suiting(layer: Layer, selector: Mapping[str, Any]) -> NDArray[np.intp]:
    suits = np.ones(len(layer.ids), bool)
    if "ids" in selector:
        suits &= np.isin(layer.ids, np.array([int(i, 16) for i in selector["ids"]], np.uint64))
    if "kind" in selector:
        suits &= layer.kinds == selector["kind"]
    if "name" in selector:
        wanted = selector["name"].casefold()
        suits &= np.array([wanted in str(name).casefold() for name in layer.names], bool)
    if "near" in selector:
        near = selector["near"]
        away = np.hypot(*(layer.places() - [near["x"], near["y"]]).T)
        suits &= away <= near["radius"]
    return np.flatnonzero(suits)


def _records(layer: Layer, rows: NDArray[np.intp]) -> list[dict[str, Any]]:
    if not len(rows):
        return []
    places = layer.places()[rows].tolist()
    return [
        {
            "id": id_text(int(layer.ids[row])),
            "layer": layer.name,
            "kind": shown(str(layer.kinds[row])),
            "name": shown(str(layer.names[row])),
            "x": plain(x),
            "y": plain(y),
        }
        for row, (x, y) in zip(rows.tolist(), places, strict=True)
    ]


def _page(counts: Sequence[int], page: int, size: int) -> tuple[dict[str, int], list[slice]]:
    """Return where a page stands among all rows, and which rows of each group are on it.

    Raises
    ------
    UsageError
        If there is no such page.
    """
    total = sum(counts)
    pages = max(1, -(-total // size))
    if not 1 <= page <= pages:
        raise UsageError(f"There is no page {page}; there are {pages}.")
    parts, begin = [], (page - 1) * size
    for count in counts:
        parts.append(slice(max(begin, 0), max(begin + size, 0)))
        begin -= count
    return {"total": total, "page": page, "pages": pages}, parts


def paged(rows: Sequence[Any], page: int, size: int) -> dict[str, Any]:
    """Return one page of rows, and how many there are.

    Raises
    ------
    UsageError
        If there is no such page.
    """
    head, (part,) = _page([len(rows)], page, size)
    return head | {"rows": list(rows[part])}


def object_record(
    city: City, content: ContentHash, name: str, layers: Sequence[Layer] | None = None
) -> dict[str, Any]:
    """Return everything known of an object besides its geometry.

    Parameters
    ----------
    name
        Its id, 16 hexadecimal digits.
    layers
        Those of the city, where many objects are asked for; looked up when left out.

    Raises
    ------
    UsageError
        If the city holds no such object.
    """
    found = []
    if _ID.fullmatch(name):
        wanted = np.uint64(int(name, 16))
        for layer in layers_of(city) if layers is None else layers:
            for row in np.flatnonzero(layer.ids == wanted).tolist():
                kind = shown(str(layer.kinds[row]))
                own = layer.record(row)
                if "layer" in own:  # that of a bridge or a tunnel, as the map counts them
                    own["way_layer"] = own.pop("layer")
                found.append({"layer": layer.name, "kind": kind} | own)
    if not found:
        raise UsageError(f'The city holds no object "{shown(name)}"; scene_query finds them.')
    number = int(name, 16)
    return {
        "id": name, "hash": content.of_object(number), "in": found,
        "owns": dict(owned(city, number)),
    }  # fmt: skip


def summary(seen: Seen) -> dict[str, Any]:
    """Return what a city is, in less than `SUMMARY_BYTES` of JSON."""
    city = seen.city
    if city is None:
        return {"revision": 0, "message": "There is no city yet; build one with run_brief."}
    environment = city.environment
    layers = {layer.name: len(layer.ids) for layer in layers_of(city)}
    found: dict[str, Any] = {
        "revision": seen.revision,
        "content": seen.revisions[-1].content[:16],
        "name": shown(city.name),
        "latitude": round(city.frame.latitude, 6),
        "longitude": round(city.frame.longitude, 6),
        "extent_m": [round(value, 1) for value in city.layout.extent],
        "lod": city.lod,
        "seed": city.seed,
        "style": shown(city.style),
        "weather": environment.weather,
        "hour": environment.hour,
        "date": environment.date,
        "stages": sorted(city.stages_done),
        "failures": len(city.failures),
        "notes": len(city.notes),
        "layers": layers,
    }
    while len(json.dumps(found)) >= SUMMARY_BYTES:
        layers.pop(min(layers, key=lambda name: layers[name]))
        found["layers_left_out"] = found.get("layers_left_out", 0) + 1
    return found


def state(content: ContentHash, page: int, size: int) -> dict[str, Any]:
    """Return layer, id and hash of objects, one page of all.

    Raises
    ------
    UsageError
        If there is no such page.
    """
    layers = sorted(content.layers.items())
    head, parts = _page([len(ids) for _, (ids, _) in layers], page, size)
    rows = [
        [name, id_text(number), id_text(value)]
        for (name, (ids, hashes)), part in zip(layers, parts, strict=True)
        for number, value in zip(ids[part].tolist(), hashes[part].tolist(), strict=True)
    ]
    return head | {"columns": ["layer", "id", "hash"], "rows": rows}


def revision_record(revision: Revision) -> dict[str, Any]:
    """Return a revision as a plain dictionary."""
    return {
        "revision": revision.number, "text": shown(revision.text),
        "actions": list(revision.actions), "content": revision.content,
    }  # fmt: skip
