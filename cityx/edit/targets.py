"""Targets: what the names of an edit are in a city, and changes of the rows that show them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from cityx.city.city import City
from cityx.city.rows import leave_rows, take_rows
from cityx.city.scene import Instances
from cityx.edit.buildings.rebuilding import Ids
from cityx.errors import ActionFailed
from cityx.geometry.arrays import BoolArray
from cityx.ids import id_text
from cityx.protocol.objects import find_objects

SHOWN = 4  # ids that a message names
BUILT_ON = ("window", "door", "shopfront", "trim", "roof_furniture")  # kinds that are of buildings


@dataclass(frozen=True)
class Targets:
    """The objects that an edit is about, by what they are; ids ascend.

    Attributes
    ----------
    buildings, pieces, movers
        Uint64 ids of buildings, of what is shown by instances, and of what has a track.
    """

    buildings: Ids
    pieces: Ids
    movers: Ids


def targets_of(city: City, objects: Sequence[str]) -> Targets:
    """Sort the objects that an edit names.

    Raises
    ------
    ActionFailed
        If one is none of these: streets, land and parts of buildings are edited otherwise.
    """
    ids = np.unique(find_objects(city, objects))
    is_building = np.isin(ids, city.layout.buildings["id"].to_numpy(np.uint64))
    is_piece = np.zeros(len(ids), bool)
    of_building = np.zeros(len(ids), bool)
    fixed = np.array([p.kind in BUILT_ON for p in city.scene.prototypes] or [False])
    for rows in city.scene.instances.values():
        mine = np.isin(rows.object_id, ids)
        shown = np.isin(ids, rows.object_id[mine])
        is_piece |= shown
        of_building |= np.isin(ids, rows.object_id[mine & fixed[rows.prototype]])
    moves = city.tracks.object_id if city.tracks is not None else np.zeros(0, np.uint64)
    is_mover = np.isin(ids, moves)
    other = ~(is_building | is_piece | is_mover) | (of_building & ~is_building)
    if other.any():
        named = ", ".join(id_text(int(one)) for one in ids[other][:SHOWN])
        raise ActionFailed(
            f"{int(other.sum())} of the objects ({named}) are no buildings and no things that "
            "stand or move about; streets, land and parts of buildings have edits of their own."
        )
    return Targets(ids[is_building], ids[is_piece & ~is_building], ids[is_mover])


def with_changed_rows(
    city: City, ids: Ids, change: Callable[[Instances], Instances | None]
) -> City:
    """Change the instances of some objects and of what they own, in every layer.

    Parameters
    ----------
    city
        The city.
    ids
        Of the objects.
    change
        Takes their rows of a layer and returns them changed, None to leave them out.
    """
    scene = city.scene
    for layer, rows in city.scene.instances.items():
        mine = np.isin(rows.object_id, ids) | (np.isin(rows.owner, ids) & (rows.owner > 0))
        if not mine.any():
            continue
        made = change(take_rows(rows, mine))
        kept = leave_rows(rows, mine) if made is None else _written(rows, mine, made)
        scene = scene.with_instances(layer, scene.prototypes, kept)
    return replace(city, scene=scene)


def _written(rows: Instances, mine: BoolArray, made: Instances) -> Instances:
    columns = {}
    for name in rows.__dataclass_fields__:
        values = getattr(rows, name).copy()
        values[mine] = getattr(made, name)
        columns[name] = values
    return Instances(**columns)


def buildings_named(city: City, objects: Sequence[str]) -> Ids:
    """Return the ids of buildings, (k,) ascending.

    Raises
    ------
    ActionFailed
        If one of the objects is none.
    """
    found = targets_of(city, objects)
    others = np.concatenate([found.pieces, found.movers])
    if len(others):
        named = ", ".join(id_text(int(one)) for one in others[:SHOWN])
        raise ActionFailed(f"{len(others)} of the objects ({named}) are no buildings.")
    return found.buildings
