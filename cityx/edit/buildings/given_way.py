"""What gives way to a building that stands on other ground than before: trees, benches, bins."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.city.city import City
from cityx.city.layout import Layout
from cityx.city.rows import without_objects
from cityx.geometry.clearance import near_any
from cityx.ids import id_text

Ids = NDArray[np.uint64]

TRUNK_ROOM = 0.3  # metres from a wall to the middle of a trunk, the least
STAYING = ("vehicle", "pedestrian")  # what moves is planned anew, and is no part of the ground


def with_ground_freed(city: City, before: Layout, ids: Ids) -> City:
    """Take away what stands in the walls of buildings that lie elsewhere than they did.

    Parameters
    ----------
    city
        With the buildings as they are now.
    before
        The layout from which they were changed.
    ids
        (k,) of the buildings.
    """
    new, old = _outlines(city.layout, ids), _outlines(before, ids)
    # What stood within the old walls, as in a passage, did so by right.
    taken = shapely.difference(shapely.union_all(new), shapely.union_all(old))
    parts = shapely.get_parts([taken])
    parts = parts[shapely.area(parts) > 0]
    if not len(parts):
        return city
    gone: list[int] = []
    counts: dict[str, int] = {}
    for layer, rows in city.scene.instances.items():
        kinds = np.array([one.kind for one in city.scene.prototypes] or [""])
        loose = (rows.owner == 0) & ~np.isin(kinds[rows.prototype], STAYING)
        at = np.flatnonzero(loose)
        room = TRUNK_ROOM if layer == "trees" else 0.0
        hit = at[near_any(rows.position[at, :2], parts, room)] if len(at) else at
        if len(hit):
            gone += rows.object_id[hit].tolist()
            counts[layer] = len(hit)
    if not gone:
        return city
    points = city.layout.points
    kept = ~np.isin(points["id"].to_numpy(np.uint64), np.array(gone, np.uint64))
    layout = city.layout
    if not kept.all():
        layout = replace(layout, points=points.iloc[np.flatnonzero(kept)].reset_index(drop=True))
    said = ", ".join(f"{layer.replace('_', ' ')} ({count})" for layer, count in counts.items())
    note = f"To {_names(city, ids)} gave way: {said}."
    notes = tuple(dict.fromkeys((*city.notes, note)))
    return replace(city, layout=layout, scene=without_objects(city.scene, gone), notes=notes)


def _outlines(layout: Layout, ids: Ids) -> NDArray[Any]:
    mine = np.isin(layout.buildings["id"].to_numpy(np.uint64), ids)
    return np.asarray(layout.buildings.geometry.to_numpy()[mine], object)


def _names(city: City, ids: Ids) -> str:
    table = city.layout.buildings
    mine = table[np.isin(table["id"].to_numpy(np.uint64), ids)]
    pairs = zip(mine["name"].astype(str), mine["id"].tolist(), strict=True)
    names = [name or id_text(int(number)) for name, number in pairs]
    return ", ".join(names[:4]) + (f" and {len(names) - 4} more" if len(names) > 4 else "")
