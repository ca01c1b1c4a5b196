"""Trees of one kind in the place of trees that stand."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated

import numpy as np

from cityx.city import City
from cityx.city.rows import take_rows
from cityx.edit.land.planting import KINDS, species_rows
from cityx.edit.objects.layer_rows import with_rows, without_rows
from cityx.edit.targets import targets_of
from cityx.errors import ActionFailed
from cityx.geometry.scatter import Points
from cityx.nature.furniture.furnishing import lamp_places
from cityx.nature.trees.stands import rows_of, stand_of
from cityx.nature.trees.tree_room import Room, room_of
from cityx.protocol import Choice, ObjectName, Port, action
from cityx.protocol.serving import Serves

ACTION = "edit/replant-v1"
LAYER = "trees"


@action(
    ACTION,
    limits=["A tree stands where the other stood, as high as its kind grows there."],
    requires=("layout",),
    takes=(Port("object", "complex_geometry"),),
    gives=(Port("trees", "point", role="tree"),),
    serves=(Serves("edit=replace", "family=piece", "nature=tree", "species"),),
    binds={"objects": "objects", "species": "species"},
    labels=("replace trees", "other trees", "species"),
)
def replant(
    city: City,
    *,
    objects: Annotated[tuple[str, ...], ObjectName()],
    species: Annotated[str, Choice(*KINDS, outside="cityx.species")],
) -> City:
    """Put trees of a kind in the place of trees that stand.

    Parameters
    ----------
    city
        The city.
    objects
        Trees that go.
    species
        Kind of tree that comes.

    Raises
    ------
    ActionFailed
        If one of the objects is no tree.
    """
    found = targets_of(city, objects)
    held = city.scene.instances.get(LAYER)
    rows = None if held is None else take_rows(held, np.isin(held.object_id, found.pieces))
    if rows is None or len(rows.object_id) < len(objects):
        raise ActionFailed("Only trees give way to trees of another kind.")
    ids, xy = rows.object_id, rows.position[:, :2].astype(float)
    stand = stand_of(Points(xy, ids), species_rows(city, species, ids, street=False), mapped=True)
    city = replace(city, scene=without_rows(city.scene, LAYER, ids))
    _, _, room = room_of(city, xy, np.ones(len(ids), bool), lamp_places(city))
    prototypes, made = rows_of(city, stand, Room(room.facade, room.road, room.path))
    return replace(city, scene=with_rows(city.scene, LAYER, prototypes, made))
