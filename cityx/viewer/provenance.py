"""Provenance: where each object of a city is from, for its colour on the page.

A map or a drawing tells of it, a rule made it, an edit made or changed it, or it is an asset of a
library. What belongs to an object, such as its windows, is from where that is.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np

from cityx.building.asset_placement import LAYER as ASSETS
from cityx.city import City
from cityx.city.content import ContentHash
from cityx.city.layout import CURVE
from cityx.ids import id_text

ORIGINS = ("map", "made", "edited", "asset")
MAP, MADE, EDITED, ASSET = range(len(ORIGINS))
MAPS = ("osm", "drawn", "semantic", "satellite", "image", "heights")  # first words of sources
TABLES = ("buildings", "roads", "areas", "lines", "points")
# Layers of meshes that are the ground of what the tables hold.
GROUND = ("ground", "decks", "structures", "shores")
OWN_KIND = "asset"  # of prototypes of a user


def provenance(city: City, content: ContentHash, first: ContentHash | None) -> dict[str, Any]:
    """Return where the objects of a city are from.

    Parameters
    ----------
    city, content
        The city and its hashes.
    first
        Hashes of the city as it was built; None where that is not kept.

    Returns
    -------
    told
        "origins", their names; "ids", by each the ids of objects; "layers", the number of the
        origin of what is in a layer and no object says.
    """
    origin: dict[int, int] = {}
    mapped = False
    for table in (getattr(city.layout, name) for name in TABLES):
        kinds = table["kind"].to_numpy() if "kind" in table else np.full(len(table), "")
        for number, source, kind in zip(
            table["id"].tolist(), table["source"].tolist(), kinds.tolist(), strict=True
        ):
            told = is_map(str(source)) and kind != CURVE
            origin[number] = MAP if told else MADE
            mapped |= told
    for rows in city.scene.instances.values():
        own = np.array([each.kind == OWN_KIND for each in city.scene.prototypes], bool)
        if own.any() and rows.count:
            origin |= dict.fromkeys(rows.object_id[own[rows.prototype]].tolist(), ASSET)
    placed = city.scene.instances.get(ASSETS)
    if placed is not None:
        origin |= dict.fromkeys([*placed.owner.tolist(), *placed.object_id.tolist()], ASSET)
    origin |= dict.fromkeys(_edited(content, first), EDITED)
    ids: dict[str, list[str]] = {name: [] for name in ORIGINS}
    for number, which in sorted(origin.items()):
        ids[ORIGINS[which]].append(id_text(number))
    layers = {layer: MAP if layer in GROUND and mapped else MADE
              for layer in sorted({*city.scene.meshes, *city.scene.instances})}  # fmt: skip
    return {"origins": list(ORIGINS), "ids": ids, "layers": layers}


def is_map(source: str) -> bool:
    """Return whether a source of a row is a map, a drawing, an image or another file."""
    return source.partition("/")[0] in MAPS


def _edited(now: ContentHash, first: ContentHash | None) -> Iterable[int]:
    """Yield the objects that were not so in the city as it was built."""
    if first is None or first.total == now.total:
        return
    for layer, (ids, hashes) in now.layers.items():
        before = first.layers.get(layer)
        known = set() if before is None else set(zip(*map(_numbers, before), strict=True))
        for number, told in zip(_numbers(ids), _numbers(hashes), strict=True):
            if (number, told) not in known:
                yield number


def _numbers(values: Any) -> list[Any]:
    found: list[Any] = np.asarray(values).tolist()
    return found
