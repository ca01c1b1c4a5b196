"""Copying objects to where there is room for them."""

from __future__ import annotations

from typing import Annotated

import numpy as np

from cityx.city import City
from cityx.edit.objects.move import FURTHEST, move
from cityx.edit.objects.twins import with_twins
from cityx.edit.targets import targets_of
from cityx.errors import ActionFailed
from cityx.ids import id_text
from cityx.protocol import ObjectName, Port, Range, Serves, action

MOST = 20  # copies that one call makes of an object


@action(
    "edit/copy-v1",
    limits=[
        "A copy stands where there is room for it, or none is made.",
        "What moves is not copied.",
    ],
    takes=(Port("object", "complex_geometry"),),
    gives=(Port("object", "complex_geometry"),),
    labels=("copy", "duplicate", "clone", "another one like it"),
    serves=(Serves("edit=copy", "offset"),),
    binds={"objects": "objects", "offset": "offset", "settle": "settle", "count": "count"},
)
def copy(
    city: City,
    *,
    objects: Annotated[tuple[str, ...], ObjectName()],
    offset: Annotated[tuple[float, float], Range(-FURTHEST, FURTHEST)],
    settle: Annotated[float, Range(0.0, 200.0)] = 0.0,
    count: Annotated[int, Range(1, MOST)] = 1,
) -> City:
    """Copy objects, with everything they own, to another place where they have room.

    A copy has an id of its own and no name.

    Parameters
    ----------
    city
        The city.
    objects
        Buildings, and things that stand about.
    offset
        Metres to the east and to the north from the original.
    settle
        Metres from there at which they may stand where there is no room: the nearest is taken.
    count
        Copies of each.
    """
    found = targets_of(city, objects)
    if len(found.movers):
        raise ActionFailed("What moves is not copied; ask for one more of its kind instead.")
    ids = np.sort(np.concatenate([found.buildings, found.pieces]))
    for _ in range(count):
        city, fresh = with_twins(city, ids)
        names = tuple(map(id_text, fresh.tolist()))
        try:
            city = move(city, objects=names, offset=offset, settle=settle)
        except ActionFailed as error:
            raise ActionFailed(
                f"No copy has room within {settle:.0f} m of where it shall stand: {error}"
            ) from error
    return city
