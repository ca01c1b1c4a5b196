"""Objects of a city by name."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

import numpy as np

from cityx.errors import nearest
from cityx.geometry.identity import id_text
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


def _has_id(city: City, wanted: int) -> bool:
    number = np.uint64(wanted)
    tables = (getattr(city.layout, table)["id"].to_numpy() for table in TABLES)
    meshes = (batch.object_id for batch in city.scene.meshes.values())
    rows = (instances.object_id for instances in city.scene.instances.values())
    return any(bool(np.any(ids == number)) for group in (tables, meshes, rows) for ids in group)


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
