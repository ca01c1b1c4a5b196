"""Other things in the place of things."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated

import numpy as np

from cityx.assets.furniture.outside_pieces import GROUP
from cityx.assets.furniture.street_furniture import MAKERS, furniture
from cityx.city.city import City
from cityx.edit.land.add import WORDS
from cityx.edit.objects.footing import check_room
from cityx.edit.targets import targets_of
from cityx.errors import ActionFailed
from cityx.protocol import Choice, ObjectName, Port, action
from cityx.protocol.serving import Serves


@action(
    "edit/replace_object-v1",
    limits=["What is new keeps the place, the turn and the id of what goes."],
    takes=(Port("object", "complex_geometry"),),
    gives=(Port("object", "complex_geometry"),),
    labels=("replace", "swap", "exchange", "instead"),
    serves=tuple(
        Serves("edit=replace", f"family={family}", f"element={word}", thing=name)
        for family in ("piece", "lamp") for word, name in WORDS.items()
    ),
    binds={"objects": "objects"},
)  # fmt: skip
def replace_object(
    city: City,
    *,
    objects: Annotated[tuple[str, ...], ObjectName()],
    thing: Annotated[str, Choice(*sorted(MAKERS), outside=GROUP)],
) -> City:
    """Put other things in the place of things that stand about.

    Parameters
    ----------
    city
        The city.
    objects
        What goes.
    thing
        Name of the prototype that comes.
    """
    found = targets_of(city, objects)
    if len(found.buildings) or len(found.movers):
        raise ActionFailed("Buildings and what moves are replaced by edits of their own.")
    prototype = furniture(thing, detail=city.lod)
    scene = city.scene
    for layer, rows in city.scene.instances.items():
        mine = np.isin(rows.object_id, found.pieces)
        gone = np.isin(rows.owner, found.pieces) & (rows.owner > 0)
        if not mine.any():
            continue
        number = rows.prototype.copy()
        number[mine] = len(scene.prototypes)
        scale, tint = rows.scale.copy(), rows.tint.copy()
        scale[mine], tint[mine] = 1.0, 1.0
        made = replace(rows, prototype=number, scale=scale, tint=tint)
        made = replace(made, **{
            name: getattr(made, name)[~gone] for name in made.__dataclass_fields__
        })  # fmt: skip
        scene = scene.with_instances(layer, [*scene.prototypes, prototype], made)
    city = replace(city, scene=scene)
    check_room(city, found.pieces)
    return city
