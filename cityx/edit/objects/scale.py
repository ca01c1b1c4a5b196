"""Scaling objects, whole."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated

import numpy as np

from cityx.city.city import City
from cityx.city.scene import Instances
from cityx.edit.buildings.resettling import about, middle_of, reshaped
from cityx.edit.objects.footing import check_room
from cityx.edit.targets import targets_of, with_changed_rows
from cityx.protocol import ObjectName, Port, Range, action
from cityx.protocol.serving import Serves


@action(
    "edit/scale-v1",
    limits=[
        "All three axes together; each object grows about the middle of its foot.",
        "Storeys of buildings grow with them; their windows are drawn anew.",
    ],
    takes=(Port("object", "complex_geometry"),),
    gives=(Port("object", "complex_geometry"),),
    labels=("scale", "size", "larger", "smaller"),
    serves=(Serves("edit=scale", "factor"),),
    binds={"objects": "objects", "factor": "factor"},
)
def scale(
    city: City,
    *,
    objects: Annotated[tuple[str, ...], ObjectName()],
    factor: Annotated[float, Range(0.1, 10.0)],
) -> City:
    """Make objects larger or smaller where they stand.

    Parameters
    ----------
    city
        The city.
    objects
        Buildings, and things that stand about.
    factor
        Of their size.
    """
    found = targets_of(city, objects)
    for building in found.buildings.tolist():
        moved = about(middle_of(city, building), np.diag([factor, factor]))
        city = reshaped(city, np.array([building], np.uint64), moved, taller=factor)
    if len(found.pieces):
        city = with_changed_rows(city, found.pieces, lambda rows: _scaled(rows, factor))
        if factor > 1.0:
            check_room(city, found.pieces)
    return city


def _scaled(rows: Instances, factor: float) -> Instances:
    return replace(rows, scale=(rows.scale * np.float32(factor)).astype(np.float32))
