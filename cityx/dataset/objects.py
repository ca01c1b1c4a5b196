"""What the ids of a dataset stand for: class, asset, material, provenance and pieces."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from cityx.dataset.classes import CLASSES, class_of_mover
from cityx.ids import id_text

if TYPE_CHECKING:
    from cityx.city.city import City
    from cityx.city.mesh import MeshBatch
    from cityx.dataset.stage import Stage

BY_RULE = "rule"  # the source of what no input shows
OWN_LICENCE = "made by CityX, free of rights of others"
_BITS = 32


def objects_of(city: City, stage: Stage) -> Iterator[dict[str, Any]]:
    """Yield a record for every object of a city, by id.

    Parameters
    ----------
    city
        The city.
    stage
        Its scene, whose ids and classes those of the channels are.

    Yields
    ------
    record
        "id", "class", "name" (of the class), "layer", "asset" (prototype, or None for a shell of
        its own), "materials", "source", "licence", and the number of "pieces" by class.
    """
    base = stage.still or stage
    layer, asset, materials = _origins(city)
    sources, names = _sources(city)
    licence = "; ".join(city.attribution) or OWN_LICENCE
    pieces = _pieces(base)
    first: dict[int, int] = {}
    for row, object_id in enumerate(base.object_id.tolist()):
        first.setdefault(object_id, row)
    records = []
    for object_id, row in first.items():
        kind = CLASSES[int(base.semantic[row])]
        source = sources.get(object_id, BY_RULE)
        own = int(base.whole[row])
        record: dict[str, Any] = {
            "id": id_text(object_id), "class": kind.number, "name": kind.name,
            "layer": layer[own], "asset": asset[own], "materials": materials(own),
            "source": source, "licence": OWN_LICENCE if source == BY_RULE else licence,
        }  # fmt: skip
        if names.get(object_id):
            record["called"] = names[object_id]
        if object_id in pieces:
            record["pieces"] = pieces[object_id]
        records.append(record)
    records += _movers(city, set(first))
    yield from sorted(records, key=lambda record: str(record["id"]))


def _origins(city: City) -> tuple[list[str], list[str | None], Any]:
    """Return layer and asset of every row of the stage, and what gives its materials."""
    layers: list[str] = []
    assets: list[str | None] = []
    made_of: list[Any] = []
    for name, batch in city.scene.meshes.items():
        layers += [name] * batch.count
        assets += [None] * batch.count
        made_of += _materials_of(batch)
    prototypes = city.scene.prototypes
    for name, rows in city.scene.instances.items():
        layers += [name] * rows.count
        assets += [prototypes[row].name for row in rows.prototype.tolist()]
        made_of += rows.prototype.tolist()

    def materials(row: int) -> list[str]:
        held = made_of[row]
        return list(prototypes[held].mesh.materials) if isinstance(held, int) else held

    return layers, assets, materials


def _materials_of(batch: MeshBatch) -> list[list[str]]:
    """Return the materials of each object of a batch."""
    found: list[list[str]] = [[] for _ in range(batch.count)]
    pairs = np.unique(
        (batch.face_object().astype(np.int64) << _BITS) | batch.material.astype(np.int64)
    )
    for owner, material in zip(
        (pairs >> _BITS).tolist(), (pairs & ((1 << _BITS) - 1)).tolist(), strict=True
    ):
        found[owner].append(batch.materials[material])
    return found


def _sources(city: City) -> tuple[dict[int, str], dict[int, str]]:
    """Return where the features of the layout come from, and what they are called."""
    from cityx.city.layout import SCHEMA

    sources: dict[int, str] = {}
    names: dict[int, str] = {}
    for table in SCHEMA:
        rows = getattr(city.layout, table)
        ids = rows["id"].tolist() if "source" in rows else []
        if ids:
            sources |= dict(zip(ids, rows["source"].tolist(), strict=True))
        if ids and "name" in rows:
            names |= {i: n for i, n in zip(ids, rows["name"].tolist(), strict=True) if n}
    return sources, names


def _pieces(stage: Stage) -> dict[int, Mapping[str, int]]:
    """Return how many pieces of each class an object has beyond itself."""
    own: NDArray[np.bool_] = stage.piece == stage.object_id
    counts: dict[int, Counter[str]] = {}
    rows = zip(stage.object_id[~own].tolist(), stage.piece_class[~own].tolist(), strict=True)
    for object_id, kind in rows:
        counts.setdefault(object_id, Counter())[CLASSES[kind].name] += 1
    return {object_id: dict(sorted(count.items())) for object_id, count in counts.items()}


def _movers(city: City, known: set[int]) -> Iterator[dict[str, Any]]:
    tracks = city.tracks
    if tracks is None:
        return
    for object_id, kind in zip(tracks.object_id.tolist(), tracks.kind.tolist(), strict=True):
        if object_id not in known:
            held = CLASSES[class_of_mover(kind)]
            yield {
                "id": id_text(object_id), "class": held.number, "name": held.name,
                "layer": "movers", "asset": None, "materials": [], "source": BY_RULE,
                "licence": OWN_LICENCE,
            }  # fmt: skip
