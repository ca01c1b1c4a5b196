"""Names of streets, buildings and areas."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated

import numpy as np

from cityx.city import City
from cityx.errors import ActionFailed
from cityx.ids import id_text
from cityx.protocol import ObjectName, Port, Text, action
from cityx.protocol.objects import find_objects

TABLES = ("roads", "buildings", "areas")
LONGEST = 80  # letters of a name


@action(
    "edit/rename-v1",
    limits=["Streets, buildings and areas have names; furniture, trees and people have none."],
    requires=("layout",),
    takes=(Port("object", "complex_geometry"),),
    gives=(Port("object", "complex_geometry"),),
    labels=("name", "rename", "call"),
    serves=("edit=rename",),
    binds={"objects": "objects", "name": "name"},
)
def rename(
    city: City,
    *,
    objects: Annotated[tuple[str, ...], ObjectName()],
    name: Annotated[str, Text(LONGEST)],
) -> City:
    """Give things another name.

    Parameters
    ----------
    city
        The city.
    objects
        Streets, buildings and areas.
    name
        What they are called.

    Raises
    ------
    ActionFailed
        If one of the objects has no name.
    """
    ids = find_objects(city, objects)
    layout, named = city.layout, np.zeros(len(ids), bool)
    for table in TABLES:
        rows = getattr(layout, table)
        own = np.isin(rows["id"].to_numpy(np.uint64), ids)
        if own.any():
            names = np.where(own, name.strip(), rows["name"].to_numpy(str))
            layout = replace(layout, **{table: rows.assign(name=names)})
            named |= np.isin(ids, rows["id"].to_numpy(np.uint64)[own])
    if not named.all():
        raise ActionFailed(f"{id_text(int(ids[~named][0]))} has no name that could be changed.")
    return replace(city, layout=layout)
