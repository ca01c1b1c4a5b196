"""What differs between two states of a city, by the hashes of its objects."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import Any

import numpy as np

from cityx.city import City
from cityx.city.content import ContentHash
from cityx.ids import UInt64Array, id_text

# Parts of a city that are no objects.
PARTS = ("environment", "terrain", "network", "heights", "lanes", "ground")


@dataclass(frozen=True)
class Difference:
    """Ids that differ in one layer, each (n,) uint64."""

    added: UInt64Array
    removed: UInt64Array
    modified: UInt64Array

    @property
    def ids(self) -> UInt64Array:
        """All of them, (n,), sorted."""
        ids: UInt64Array = np.unique(np.concatenate([self.added, self.removed, self.modified]))
        return ids

    def to_json(self) -> dict[str, int]:
        """Return how many there are of each."""
        return {name: len(ids) for name, ids in vars(self).items()}


def difference(before: ContentHash, after: ContentHash) -> dict[str, Difference]:
    """Return the layers that differ, by name."""
    none = np.zeros(0, np.uint64), np.zeros(0, np.uint64)
    found: dict[str, Difference] = {}
    for name in sorted(before.layers.keys() | after.layers.keys()):
        old, new = before.layers.get(name, none), after.layers.get(name, none)
        if np.array_equal(old[0], new[0]) and np.array_equal(old[1], new[1]):
            continue
        gone, come = _others(old, new), _others(new, old)
        added, removed = np.setdiff1d(come, old[0]), np.setdiff1d(gone, new[0])
        both = np.union1d(gone, come)
        modified = np.setdiff1d(both, np.union1d(added, removed))
        found[name] = Difference(added, removed, modified)
    return found


def _others(
    rows: tuple[UInt64Array, UInt64Array], known: tuple[UInt64Array, UInt64Array]
) -> UInt64Array:
    """Return the ids of the (id, hash) pairs that are not among the known ones."""
    kind = np.dtype([("id", np.uint64), ("hash", np.uint64)])
    own, others = (np.rec.fromarrays(columns, dtype=kind) for columns in (rows, known))
    ids: UInt64Array = np.unique(np.setdiff1d(own, others)["id"])
    return ids


def changed_ids(layers: Mapping[str, Difference]) -> list[str]:
    """Return the ids of all objects that differ, 16 hexadecimal digits each, sorted."""
    if not layers:
        return []
    ids = np.unique(np.concatenate([layer.ids for layer in layers.values()]))
    return [id_text(number) for number in ids.tolist()]


def changed_parts(before: City, after: City) -> list[str]:
    """Return the parts that differ, besides objects."""
    return [name for name in PARTS if not _same(getattr(before, name), getattr(after, name))]


def _same(first: Any, second: Any) -> bool:
    """Return whether two parts hold the same values."""
    if first is second or type(first) is not type(second):
        return first is second
    names = [column.name for column in fields(first)]
    return all(np.array_equal(getattr(first, name), getattr(second, name)) for name in names)


def summed(layers: Mapping[str, Difference]) -> dict[str, Any]:
    """Return the counts of every layer that differs."""
    return {name: layer.to_json() for name, layer in layers.items()}
