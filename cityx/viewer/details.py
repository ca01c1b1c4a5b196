"""Details: what is said of one object beside the city: what it is, whence, by what, what failed."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from cityx.city import City
from cityx.city.content import ContentHash
from cityx.errors import UsageError
from cityx.ids import id_text
from cityx.language.reading import read_brief
from cityx.language.references.naming import names_of
from cityx.language.references.selecting import Open, choose
from cityx.server.layers import Layer, layers_of, plain, shown
from cityx.server.queries import object_record

MOST_FOUND = 500  # objects of an answer
# Action that makes a layer, without its version.
MAKERS: Mapping[str, str] = {
    "meshes/buildings": "building/shell", "meshes/ground": "road/ground",
    "meshes/barriers": "nature/barriers", "meshes/shores": "nature/shores",
    "meshes/garden_paths": "nature/gardens", "instances/windows": "building/facade",
    "instances/doors": "building/facade", "instances/shopfronts": "building/facade",
    "instances/trims": "building/facade", "instances/roof_furniture": "building/facade",
    "instances/trees": "nature/trees", "instances/shore_pieces": "nature/shores",
    "instances/street_furniture": "nature/furniture",
    "instances/street_pieces": "nature/street_pieces", "instances/park_pieces": "nature/parks",
    "instances/street_covers": "road/covers", "instances/walk_covers": "road/covers",
    "instances/vehicles": "road/parked_cars",
}  # fmt: skip


def details(
    city: City,
    content: ContentHash,
    name: str,
    report: Mapping[str, Any],
    layers: Sequence[Layer] | None = None,
) -> dict[str, Any]:
    """Return what is known of an object.

    Parameters
    ----------
    name
        Its id, 16 hexadecimal digits.
    report
        Of the city; {} where there is none.
    layers
        Those of the city, where many objects are asked for.

    Raises
    ------
    UsageError
        If the city holds no such object.
    """
    found = object_record(city, content, name, layers)
    rows = found["in"]
    row = next((item for item in rows if item["layer"].startswith("layout/")), rows[0])
    owners = [item["owner"] for item in rows if item.get("owner")]
    told: dict[str, Any] = {
        "id": name,
        "kind": _kind(rows),
        "name": next((item["name"] for item in rows if item.get("name")), ""),
        "layers": [item["layer"] for item in rows],
        "owner": owners[0] if owners else "",
        "owns": found["owns"],
        "hash": found["hash"],
        "facts": {key: value for item in (row, *rows) for key, value in item.items()
                  if key not in ("layer", "kind", "name", "owner", "source", "generator")
                  and value not in ("", None)},
        "tags": _tags(city, name),
        "source": row.get("source", ""),
        "licence": _licence(city, row.get("source", "")),
        "generator": row.get("generator", ""),
        "made_by": _makers(city, rows),
        "failures": [{"action": f.action, "error": shown(f.error)} for f in city.failures
                     if id_text(f.object_id) == name],
    }  # fmt: skip
    return told | {"checks": failed_checks(report, name)}


def _kind(rows: list[dict[str, Any]]) -> str:
    row = next((item for item in rows if item["layer"].startswith("layout/")), rows[0])
    layer = row["layer"].partition("/")[2]
    return f"{layer.removesuffix('s').replace('_', ' ')}: {row['kind']}".removesuffix(": ")


def _tags(city: City, name: str) -> dict[str, str]:
    wanted = np.uint64(int(name, 16))
    for layer in ("buildings", "roads", "areas", "lines", "points"):
        table = getattr(city.layout, layer)
        found = np.flatnonzero(table["id"].to_numpy(np.uint64) == wanted)
        if len(found):
            text = table["tags"].iloc[int(found[0])]
            tags = json.loads(text) if isinstance(text, str) and text.startswith("{") else {}
            return {shown(str(key)): shown(str(value)) for key, value in tags.items()}
    return {}


def _licence(city: City, source: str) -> str:
    """Return the attribution of what a source belongs to."""
    if source.startswith("osm/"):
        for text in city.attribution:
            if "OpenStreetMap" in text:
                return text
    return "" if not source else "; ".join(city.attribution)


def _makers(city: City, rows: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """Return the actions that made an object, each with its arguments."""
    wanted = list(dict.fromkeys(MAKERS.get(item["layer"], "") for item in rows))
    return [
        {"action": action, "args": {key: plain(value) for key, value in args.items()}}
        for base in wanted if base
        for action, args in city.made.items() if action.partition("-v")[0] == base
    ]  # fmt: skip


def failed_checks(report: Mapping[str, Any], name: str) -> list[dict[str, Any]]:
    """Return the checks of a report that name an object."""
    return [
        {"check": check, "ok": item["ok"], "value": item["value"], "limit": item["limit"],
         "bound": item["bound"], "meaning": item["meaning"]}
        for check, item in report.get("checks", {}).items()
        if name in item.get("ids", ())
    ]  # fmt: skip


def places_of(city: City) -> dict[int, tuple[float, float]]:
    """Return where the objects of a city are, by id: the middle of the plan, metres."""
    places: dict[int, tuple[float, float]] = {}
    for layer in layers_of(city):
        if layer.name.startswith(("layout/", "meshes/")):
            for number, (x, y) in zip(layer.ids.tolist(), layer.places().tolist(), strict=True):
                places.setdefault(number, (round(x, 2), round(y, 2)))
    return places


def find(city: City, text: str) -> dict[str, Any]:
    """Return the objects that words mean: an id, an address, a part of a name, a kind of things.

    Parameters
    ----------
    text
        Such as "1f0c...", "12 church street", "church" or "buildings over 30 m".
    """
    wanted = text.strip().casefold()
    by_address = [
        {"id": name, "name": told[0], "layer": layer, "kind": kind}
        for name, told, layer, kind in addresses(city)
        if " ".join(wanted.replace(",", " ").split()) in map(str.casefold, told)
    ]
    if by_address:
        return {"how": "address", "total": len(by_address), "objects": by_address[:MOST_FOUND]}
    by_name = []
    for layer in layers_of(city):
        for row, name in enumerate(layer.names.tolist()):
            number = id_text(int(layer.ids[row]))
            if number == wanted or (name and wanted and wanted in str(name).casefold()):
                by_name.append({"id": number, "name": shown(str(name)), "layer": layer.name,
                                "kind": shown(str(layer.kinds[row]))})  # fmt: skip
    if by_name:
        return {"how": "name", "total": len(by_name), "objects": by_name[:MOST_FOUND]}
    return _meant(city, text)


def addresses(city: City) -> Iterator[tuple[str, list[str], str, str]]:
    """Yield what has an address: its id, the address both ways round, its layer and its kind."""
    for layer in layers_of(city):
        table = getattr(city.layout, layer.name.removeprefix("layout/"), None)
        if table is None or "tags" not in table:
            continue
        for row, text in enumerate(table["tags"].tolist()):
            if not isinstance(text, str) or '"addr:' not in text:
                continue
            tags = json.loads(text)
            street = tags.get("addr:street", tags.get("addr:place", ""))
            told = [
                " ".join(shown(f"{one} {other}").split())
                for number in re.split(r"[;,]", tags.get("addr:housenumber", ""))
                for one, other in ((number, street), (street, number))
                if number.strip()
            ]
            if street and told:
                yield id_text(int(layer.ids[row])), told, layer.name, shown(str(layer.kinds[row]))


def _meant(city: City, text: str) -> dict[str, Any]:
    """Return the objects that the language of edits understands by some words."""
    brief = read_brief(f"remove {text}", base=True, names=names_of(city, text))
    target = next((edit.target for edit in brief.edits if edit.target is not None), None)
    if target is None:
        raise UsageError(
            f'Nothing is called "{shown(text)}", and no kind of object is understood by it. '
            "Try an id, a part of a name, or words such as: buildings over 30 m."
        )
    try:
        chosen = choose(target, city)
    except Open as question:
        candidates = list(question.question.candidates)
        return {"how": "question", "total": len(candidates), "objects": [],
                "message": str(question), "candidates": candidates}  # fmt: skip
    ids = chosen.layer.ids[chosen.rows].tolist()
    objects = [{"id": id_text(number), "name": "", "layer": chosen.layer.kind,
                "kind": chosen.layer.kind} for number in ids[:MOST_FOUND]]  # fmt: skip
    return {"how": "words", "total": len(ids), "objects": objects}
