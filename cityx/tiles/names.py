"""Names: what is called something in tiles, for whoever looks for it in a whole country."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np
import shapely

from cityx.city import City
from cityx.ids import id_text
from cityx.tiles.grid import Tile

TABLES = ("buildings", "areas", "roads", "points")
MOST = 40  # answers to one question


def names_in(city: City) -> list[list[Any]]:
    """Return what has a name in a tile, each name of a kind once.

    Returns
    -------
    names
        For each id, name, kind, and x, y, z in metres of the frame, by name.
    """
    found: dict[tuple[str, str], list[Any]] = {}
    for table in (getattr(city.layout, name) for name in TABLES):
        if "name" not in table or not len(table):
            continue
        rows = np.flatnonzero((table["name"].astype(str) != "").to_numpy())
        spots = shapely.point_on_surface(table.geometry.to_numpy()[rows])
        xy = shapely.get_coordinates(spots)
        z = city.terrain.height_at(xy)
        kinds = table["kind"] if "kind" in table else table["use"]
        for row, (x, y), height in zip(rows.tolist(), xy.tolist(), z.tolist(), strict=True):
            name, kind = str(table["name"].iloc[row]), str(kinds.iloc[row])
            own = [id_text(int(table["id"].iloc[row])), name, kind,
                   *(round(value, 1) + 0.0 for value in (x, y, height))]  # fmt: skip
            found.setdefault((name, kind), own)
    return [found[key] for key in sorted(found)]


def called(records: Mapping[Tile, Mapping[str, Any]], text: str) -> list[tuple[Tile, list[Any]]]:
    """Return what is called by some words, or has an id: the best first.

    Whole names come before those that begin with the words, then others that have all of them.
    What goes on in several tiles under a name, such as a street, is told once.

    Parameters
    ----------
    records
        Of tiles.
    text
        Words of a name in any case, or an id.
    """
    wanted = text.casefold().split()
    if not wanted:
        return []
    whole = " ".join(wanted)
    best: dict[tuple[int, str, str], tuple[Tile, list[Any]]] = {}
    for tile, own in _every(records):
        name = own[1].casefold()
        if own[0] == whole or name == whole:
            rank = 0
        elif name.startswith(whole):
            rank = 1
        elif all(word in name for word in wanted):
            rank = 2
        else:
            continue
        best.setdefault((rank, own[1], own[2]), (tile, own))
    return [best[key] for key in sorted(best)][:MOST]


def _every(records: Mapping[Tile, Mapping[str, Any]]) -> Iterable[tuple[Tile, list[Any]]]:
    return ((tile, own) for tile, record in records.items() for own in record.get("names", ()))
