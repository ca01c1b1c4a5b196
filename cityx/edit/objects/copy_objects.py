"""Copying objects: another of the same, with all it owns, at another place."""

from __future__ import annotations

from typing import Annotated

import numpy as np

from cityx.city import City
from cityx.edit.objects.place_objects import place_objects
from cityx.edit.objects.twins import with_twins
from cityx.ids import id_text
from cityx.protocol import ObjectName, Port, Range, action
from cityx.protocol.objects import find_objects

Vector = tuple[float, float, float]


@action(
    "edit/copy_objects-v1",
    limits=["Copies may reach into their neighbours; nothing is pushed aside."],
    takes=(Port("object", "complex_geometry"),),
    gives=(Port("object", "complex_geometry"),),
    labels=("copy", "duplicate", "repeat"),
)
def copy_objects(
    city: City,
    *,
    objects: Annotated[tuple[str, ...], ObjectName()],
    move: Annotated[Vector, Range(-1e6, 1e6)] = (0.0, 0.0, 0.0),
    turn: Annotated[Vector, Range(-7.0, 7.0)] = (0.0, 0.0, 0.0),
    factor: Annotated[Vector, Range(0.01, 100.0)] = (1.0, 1.0, 1.0),
) -> City:
    """Add a copy of each object, with what it owns, and place it as `edit/place_objects-v1` does.

    A copy has an id of its own and no name.

    Parameters
    ----------
    city
        City that holds the objects.
    objects
        the objects
    move
        metres to the east, to the north and up from the original
    turn
        radians about the axes to the east, to the north and up, in that order
    factor
        factors of length, width and height
    """
    ids = np.unique(find_objects(city, objects))
    city, fresh = with_twins(city, ids)
    names = tuple(map(id_text, fresh.tolist()))
    return place_objects(city, objects=names, move=move, turn=turn, factor=factor)
