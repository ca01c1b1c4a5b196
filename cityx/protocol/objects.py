"""Objects of a city by name."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from cityx.errors import nearest
from cityx.ids import UInt64Array, id_text
from cityx.protocol.preconditions import TABLES

if TYPE_CHECKING:
    from cityx.city.city import City

_ID = re.compile(r"[0-9a-f]{16}")
MOST_NAMES = 2000  # beyond, near names are not looked for: the message must stay quick


def find_object(city: City, name: str) -> int | None:
    """Return the id of an object, or None when there is none or several.

    Parameters
    ----------
    city
        The city.
    name
        The id as 16 hexadecimal digits, the source ("osm/way/123"), or the name.
    """
    if _ID.fullmatch(name):
        wanted = int(name, 16)
        return wanted if _has_id(city, wanted) else None
    found: set[int] = set()
    for table in TABLES:
        rows = getattr(city.layout, table)
        for column in ("source", "name"):
            if name and column in rows:
                found |= set(rows.loc[rows[column] == name, "id"].tolist())
    return found.pop() if len(found) == 1 else None


def find_objects(city: City, names: Sequence[str]) -> UInt64Array:
    """Return the ids of objects, (n,) uint64; 0 for a name of none or of several.

    Parameters
    ----------
    city
        The city.
    names
        As of `find_object`; thousands of ids take no longer than a few.
    """
    found = np.zeros(len(names), np.uint64)
    hexadecimal = np.array([bool(_ID.fullmatch(name)) for name in names], bool)
    wanted = np.array([int(name, 16) for name in names if _ID.fullmatch(name)], np.uint64)
    found[hexadecimal] = np.where(_known(city, wanted), wanted, np.uint64(0))
    for row in np.flatnonzero(~hexadecimal).tolist():
        found[row] = find_object(city, names[row]) or 0
    return found


def _has_id(city: City, wanted: int) -> bool:
    return bool(_known(city, np.array([wanted], np.uint64)).all())


def _known(city: City, wanted: UInt64Array) -> NDArray[np.bool_]:
    """(n,) which ids are those of an object of any table, mesh, instance or mover."""
    order = np.argsort(wanted)
    ascending = wanted[order]
    found = np.zeros(len(wanted), bool)
    for ids in _ids_of(city):
        if found.all() or not len(ids):
            continue
        at = np.minimum(np.searchsorted(ascending, ids), len(ascending) - 1)
        found[at[ascending[at] == ids]] = True
    # Of an id that is asked for twice, the search ends at the first.
    first = np.searchsorted(ascending, ascending)
    known = np.zeros(len(wanted), bool)
    known[order] = found[first] if len(first) else found
    return known


def _ids_of(city: City) -> Iterator[UInt64Array]:
    """Yield the ids of a city, the shorter lists first."""
    yield from (getattr(city.layout, table)["id"].to_numpy(np.uint64) for table in TABLES)
    yield from (batch.object_id for batch in city.scene.meshes.values())
    if city.tracks is not None:
        yield city.tracks.object_id
    yield from sorted((rows.object_id for rows in city.scene.instances.values()), key=len)


def name_hint(city: City, name: str) -> str:
    """Return the nearest names, as a hint for a message."""
    known: list[str] = []
    for table in TABLES:
        rows = getattr(city.layout, table)
        for column in ("source", "name"):
            if column in rows:
                known += [str(value) for value in rows[column].head(MOST_NAMES) if value]
    known += [id_text(i) for i in city.layout.buildings["id"].head(MOST_NAMES)]
    return nearest(name, dict.fromkeys(known))
